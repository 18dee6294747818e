//! `envers render --adaptive`.

use super::*;

#[test]
fn stats_say_where_pixels_got_more_samples() {
    let folder = Folder::with(SPHERE);
    let run = folder.run("render scene.toml -o a.png --adaptive 1..25 --threshold 0.2 --stats -");
    let stats = run.good().json();
    let adaptive = &stats["adaptive"];
    assert_eq!((&stats["spp"], &adaptive["max"]), (&1.into(), &25.into()));
    assert_eq!(adaptive["steps"], serde_json::json!([1, 5, 25]));
    let refined = [0, 1].map(|step| adaptive["refined"][step].as_u64().unwrap());
    assert!(refined[0] >= refined[1] && refined[1] > 0, "{adaptive}");
    let taken = 64 * 48 + 4 * refined[0] + 20 * refined[1];
    assert_eq!(stats["rays"]["primary"], taken);
}

#[test]
fn stats_of_regular_samples_have_none() {
    let stats = Folder::with(SPHERE).run("render scene.toml -o a.png --stats -").good().json();
    assert_eq!(stats["adaptive"], Value::Null);
}

#[test]
fn an_exr_says_how_its_samples_were_taken() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.exr --adaptive 4..36 --threshold 0.25").good();
    let bytes = folder.read("a.exr");
    let says = |line: &str| bytes.windows(line.len()).any(|part| part == line.as_bytes());
    assert!(says("spp: 4\nadaptive: 4..36\nthreshold: 0.25\n"));
    folder.run("render scene.toml -o a.exr").good();
    let bytes = folder.read("a.exr");
    assert!(!bytes.windows(9).any(|part| part == b"adaptive:"));
}

#[test]
fn the_command_line_comes_before_the_scenes_samples() {
    let scene = SPHERE.replace("[film]\n", "[film]\nadaptive = [1, 9]\nthreshold = 0.5\n");
    let folder = Folder::with(&scene);
    let steps = |flags: &str| {
        let stats = folder.run(&format!("render scene.toml -o a.png --stats - {flags}")).good();
        let adaptive = &stats.json()["adaptive"];
        (adaptive["max"].as_u64(), adaptive["threshold"].as_f64())
    };
    assert_eq!(steps(""), (Some(9), Some(0.5)));
    assert_eq!(steps("--adaptive 1..25"), (Some(25), Some(0.5)));
    assert_eq!(steps("--threshold 0.25"), (Some(9), Some(0.25)));
    assert_eq!(steps("--spp 4"), (None, None));
    assert_eq!(steps("--view normal"), (None, None));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = Folder::with(&endless());
    for (flags, why) in [
        ("--adaptive 4", "MIN..MAX"),
        ("--adaptive 0..4", "from 1 to 65536"),
        ("--adaptive 9..4", "fewer than the fewest"),
        ("--adaptive 1..65537", "from 1 to 65536"),
        ("--adaptive 1..9 --spp 4", "--spp"),
        ("--adaptive 1..9 --threshold 2", "from 0 to 1"),
        ("--threshold 0.1", "--adaptive 1..25"),
        ("--adaptive 1..9 --view normal", "--adaptive applies to the beauty view only"),
    ] {
        let message = folder.run(&format!("render scene.toml -o a.png {flags}")).refused();
        assert!(message.contains(why), "{flags}: {message}");
    }
}

#[test]
fn info_says_from_how_many_to_how_many_samples() {
    let scene = SPHERE.replace("[film]\n", "[film]\nadaptive = [1, 9]\n");
    let told = Folder::with(&scene).run("info scene.toml").good().stdout;
    assert!(told.contains("1 to 9 samples per pixel"), "{told}");
}
