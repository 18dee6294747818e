//! `envers bench`.

use super::*;

const FILES: [&str; 4] = ["bench.csv", "bench.json", "report.html", "time-vs-error.svg"];

/// The number of setups: Embree's with two kinds of trees.
const SETUPS: usize = if cfg!(feature = "embree") { 6 } else { 2 };

/// A folder in which `bench` was run with these flags, with what it left in `out`.
#[track_caller]
fn benched(scene: &str, flags: &str) -> Folder {
    let folder = Folder::with(scene);
    folder.run(&format!("bench scene.toml --out out --runs 1 {flags}")).good();
    folder
}

fn json(folder: &Folder) -> Value {
    serde_json::from_slice(&folder.read("out/bench.json")).unwrap()
}

fn report_rows(report: &Value) -> &[Value] {
    report["modes"].as_array().unwrap()
}

#[test]
fn bench_writes_four_files_into_a_folder_that_it_makes() {
    let folder = Folder::with_everything();
    let stdout = folder.run("bench scene.toml --out new/out --quick").good().stdout;
    assert!(stdout.contains("embree") == cfg!(feature = "embree"), "{stdout}");
    assert!(stdout.contains("\nreference: ") && stdout.ends_with("report.html\n"), "{stdout}");
    let mut names: Vec<_> = std::fs::read_dir(folder.path("new/out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, FILES);
    assert!(folder.read("new/out/time-vs-error.svg").starts_with(b"<svg"));
}

#[test]
fn bench_json_has_every_field() {
    let report = json(&benched(SPHERE, "--quick"));
    assert_eq!((&report["scene"], &report["camera"]), (&"scene.toml".into(), &0.into()));
    assert_eq!(report["size"], serde_json::json!([64, 48]));
    for name in ["processor", "cores", "threads", "features", "system", "envers", "embree"] {
        assert!(report["machine"].get(name).is_some(), "{name}");
    }
    assert_eq!(report["reference"]["spp"], 16);
    assert!(report["reference"]["mode"].as_str().unwrap().contains("certified"));
    let samples: Vec<_> =
        report_rows(&report).iter().map(|row| row["samples"].as_str().unwrap()).collect();
    assert_eq!(samples, ["1", "4", "1..9"].repeat(SETUPS));
    for row in report_rows(&report) {
        for name in ["build_ms", "render_ms", "total_ms", "rmse", "max", "flip"] {
            assert!(row[name].as_f64().is_some_and(|x| x >= 0.0), "{name} in {row}");
        }
        assert!(row["runs"] == 1 && row["hits_wrong"] == 0, "{row}");
        assert_eq!(row["quality"] == "", row["backend"] == "rust", "{row}");
        let dominated = row["standing"] == "dominated";
        assert_eq!(row["dominated_by"].is_string(), dominated, "{row}");
    }
    assert!(report_rows(&report).iter().any(|row| row["standing"] == "front"));
    assert_eq!(report["left_out"], serde_json::json!([]));
}

#[test]
fn bench_csv_has_the_rows_of_the_json() {
    let folder = benched(SPHERE, "--quick");
    let csv = String::from_utf8(folder.read("out/bench.csv")).unwrap();
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = lines.next().unwrap();
    let report = json(&folder);
    assert_eq!(lines.clone().count(), report_rows(&report).len());
    for (line, row) in lines.zip(report_rows(&report)) {
        assert_eq!(line.len(), names.len());
        for (name, value) in names.iter().zip(line) {
            match &row[*name] {
                Value::String(text) => assert_eq!(value, text),
                number => assert_eq!(value.parse::<f64>().ok(), number.as_f64(), "{name}"),
            }
        }
    }
}

#[test]
fn bench_finds_no_error_in_the_reference_itself() {
    let report = json(&benched(SPHERE, "--spp 1,4 --reference-spp 4"));
    for row in report_rows(&report).iter().filter(|row| row["precision"] == "certified") {
        let errors = ["rmse", "max", "flip"].map(|name| row[name].as_f64().unwrap());
        let itself = row["samples"] == "4";
        assert!(errors.iter().all(|error| (*error == 0.0) == itself), "{row}");
    }
}

#[test]
fn bench_errors_are_those_that_diff_tells() {
    let folder = Folder::with_everything();
    folder.run("bench scene.toml --out out --runs 1 --spp 1 --reference-spp 4").good();
    folder.run("render scene.toml -o a.png -o a.exr --spp 1 --bvh medium").good();
    folder.run("render scene.toml -o b.png -o b.exr --spp 4 --precision certified").good();
    let diff = |arguments: &str| folder.run(&format!("diff {arguments} --json -")).json();
    let (exr, png) = (diff("a.exr b.exr"), diff("a.png b.png"));
    let report = json(&folder);
    let row = &report_rows(&report)[0];
    assert_eq!((&row["precision"], &row["samples"]), (&"fast".into(), &"1".into()));
    assert!(row["rmse"].as_f64().unwrap() > 0.0);
    let told = [&exr["rmse"], &exr["max"], &png["flip"]].map(|x| x.as_f64().unwrap());
    let found = [&row["rmse"], &row["max"], &row["flip"]].map(|x| x.as_f64().unwrap());
    for (told, found) in told.iter().zip(found) {
        // Which picture is the first changes the order of no sum but that of an EXR's channels.
        assert!((told - found).abs() <= 1e-12 * found, "{told} {found}");
    }
}

#[test]
fn bench_is_the_same_but_for_times() {
    let untimed = || {
        let mut report = json(&benched(SPHERE, "--quick"));
        let timed = ["build_ms", "render_ms", "total_ms", "standing", "dominated_by"];
        let forget = |value: &mut Value| {
            let fields = value.as_object_mut().unwrap();
            timed.iter().for_each(|name| drop(fields.remove(*name)));
        };
        forget(&mut report["reference"]);
        report["modes"].as_array_mut().unwrap().iter_mut().for_each(forget);
        report
    };
    assert_eq!(untimed(), untimed());
}

#[test]
fn bench_page_needs_nothing_but_itself() {
    let html = String::from_utf8(benched(SPHERE, "--quick").read("out/report.html")).unwrap();
    for there in ["<svg", "data:image/png;base64,", "<h2>Machine</h2>", "<h2>Reference</h2>"] {
        assert!(html.contains(there), "{there}");
    }
    for outside in ["http:", "https:", "<script", "<link", "@import", "src=\"/", "src=\"."] {
        assert!(!html.contains(outside), "{outside}");
    }
}

/// Spheres and planes are the same on every backend in either precision: one picture for each
/// number of samples, and the reference.
#[test]
fn bench_page_shows_equal_pictures_once() {
    let html = String::from_utf8(benched(SPHERE, "--quick").read("out/report.html")).unwrap();
    assert_eq!(html.matches("<figure>").count(), 1 + 3);
}

/// No processor traces a million rays in a millisecond.
#[test]
fn bench_leaves_out_what_has_no_time_and_says_why() {
    let flags = "--size 1024x1024 --spp 1 --reference-spp 1 --budget 0.001";
    let folder = benched(SPHERE, flags);
    let report = json(&folder);
    assert!(report_rows(&report).is_empty());
    let left_out = report["left_out"].as_array().unwrap();
    assert_eq!(left_out.len(), SETUPS);
    for mode in left_out {
        assert!(mode["reason"].as_str().unwrap().contains("would take about"), "{mode}");
    }
    let html = String::from_utf8(folder.read("out/report.html")).unwrap();
    assert!(html.contains("<h2>Skipped modes</h2>"));
}

/// Embree's f32 rays find either of two floors in one plane.
#[test]
#[cfg(feature = "embree")]
fn bench_counts_hits_that_are_not_the_certified_ones() {
    let folder = Folder::new();
    folder.write("floor.obj", "v -9 0 9\nv 9 0 9\nv 9 0 -9\nv -9 0 -9\nf 1 2 3 4\n");
    let scene = "[camera]\nposition = [0, 3, 5]\nlook_at = [0, 0, 0]\n\
                 [[model]]\nfile = \"floor.obj\"\n\
                 [[model]]\nfile = \"floor.obj\"\nrotate = [0, 33, 0]\n";
    folder.write("floors.toml", scene);
    let run = folder.run("bench floors.toml --out out --quick --runs 1 --size 100x50");
    assert!(run.status == Some(0) && run.stderr.contains("coincide"), "{}", run.stderr);
    let report = json(&folder);
    let wrong = |setup: [&str; 2]| {
        let row = report_rows(&report)
            .iter()
            .find(|r| setup == [&r["backend"], &r["precision"]])
            .unwrap();
        row["hits_wrong"].as_u64().unwrap()
    };
    assert!(wrong(["embree", "fast"]) > 100);
    assert_eq!(wrong(["embree", "certified"]) + wrong(["rust", "certified"]), 0);
}

#[test]
fn bench_tries_only_the_backend_asked_for() {
    let report = json(&benched(SPHERE, "--quick --backend rust"));
    assert!(report_rows(&report).iter().all(|row| row["backend"] == "rust"));
    assert!(report["reference"]["mode"].as_str().unwrap().starts_with("rust certified"));
}

#[test]
fn bench_refuses_flags_that_make_no_sense_before_it_makes_anything() {
    let folder = Folder::with(&endless());
    for (flags, why) in [
        ("", "--out"),
        ("--out out --spp 0", "--spp"),
        ("--out out --spp 1,x", "--spp"),
        ("--out out --adaptive 4", "--adaptive"),
        ("--out out --adaptive 1..225", "--reference-spp 900"),
        ("--out out --runs 0", "--runs"),
        ("--out out --budget -1", "--budget"),
        ("--out out --camera back", "no camera `back`"),
        ("--out out --spp 64 --reference-spp 16", "--reference-spp 256"),
        ("--out scene.toml", "a file, not a folder"),
        ("--out scene.toml/out", "scene.toml/out"),
    ] {
        let message = folder.run(&format!("bench scene.toml {flags}")).refused();
        assert!(message.contains(why), "{flags}: {message}");
        assert_eq!(folder.names(), ["scene.toml"], "{flags}");
    }
    assert!(folder.run("bench no.toml --out out").refused().contains("no such file"));
}
