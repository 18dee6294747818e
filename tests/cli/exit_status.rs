//! The exit status where the work fails: 1, and what was there stays.

use super::*;

/// A script that runs the command when no file can be written to, as on a full disk.
#[cfg(unix)]
fn on_a_full_disk(command: &str) -> String {
    format!("ulimit -f 0; envers {command}")
}

/// The file that a failed write is told with; everything in the folder stays as it was.
#[cfg(unix)]
#[track_caller]
fn assert_full_disk_is_told(folder: &Folder, command: &str, file: &str) {
    let contents = || folder.names().into_iter().map(|name| (folder.read(&name), name));
    let before: Vec<_> = contents().collect();
    let run = folder.run_script(&on_a_full_disk(command));
    assert_eq!(run.status, Some(1), "{command}: {}", run.stderr);
    let start = format!("error: {file}: cannot write it: ");
    assert!(run.stderr.starts_with(&start), "{command}: {}", run.stderr);
    assert!(contents().eq(before), "{command}");
}

#[test]
#[cfg(unix)]
fn a_full_disk_fails_the_picture_and_the_old_one_stays() {
    let folder = Folder::with(SPHERE);
    for name in ["a.png", "a.jpg", "a.webp", "a.exr"] {
        folder.write(name, "old");
        assert_full_disk_is_told(&folder, &format!("render scene.toml -o {name}"), name);
    }
}

#[test]
#[cfg(unix)]
fn a_full_disk_fails_the_animation_and_the_old_one_stays() {
    let folder = Folder::with(&moving());
    for name in ["a.gif", "a.apng"] {
        folder.write(name, "old");
        assert_full_disk_is_told(&folder, &format!("render scene.toml -o {name}"), name);
    }
    assert_full_disk_is_told(&folder, "render scene.toml -o f##.png", "f01.png");
}

#[test]
#[cfg(unix)]
fn a_full_disk_fails_the_reports() {
    let folder = Folder::with(SPHERE);
    folder.write("a.json", "old");
    assert_full_disk_is_told(&folder, "info scene.toml --json a.json", "a.json");
    folder.run("render scene.toml -o a.png").good();
    let command = "diff a.png a.png --heatmap heat.png";
    assert_full_disk_is_told(&folder, command, "heat.png");
    let command = "stress --quick --goal G2 --resume r.jsonl";
    folder.write("r.jsonl", "");
    assert_full_disk_is_told(&folder, command, "r.jsonl");
}

#[test]
#[cfg(target_os = "linux")]
fn what_cannot_be_printed_fails() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.png").good();
    let commands = [
        "--help",
        "render --help",
        "--version",
        "info scene.toml",
        "info scene.toml --json -",
        "render scene.toml",
        "render scene.toml --stats -",
        "diff a.png a.png",
    ];
    for command in commands {
        let message = folder.run_script(&format!("envers {command} >/dev/full")).failed();
        assert!(message.contains("cannot write to standard output"), "{command}: {message}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn files_are_written_though_the_summary_cannot_be_printed() {
    let folder = Folder::with(SPHERE);
    folder.run_script("envers render scene.toml --stats s.json >/dev/full").failed();
    assert_eq!(folder.names(), ["s.json", "scene.png", "scene.toml"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_picture_that_does_not_fit_into_memory_fails() {
    let folder = Folder::with(SPHERE);
    let render = "envers render scene.toml --size 16384x16384 --backend rust --threads 2";
    let message = folder.run_script(&format!("ulimit -v 2500000; {render}")).failed();
    assert!(message.contains("not enough memory for 16384x16384"), "{message}");
    assert_eq!(folder.names(), ["scene.toml"]);
}
