//! The page for library users: a crate of its own depends on envers as the page says, and runs the page's
//! program.

use std::fs;
use std::path::Path;
#[cfg(feature = "embree")]
use std::{path::PathBuf, process::Command};

/// Two quads of which the middle ray hits the nearer.
#[cfg(feature = "embree")]
const MODEL: &str = "o near\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n\
                     o far\nv -2 -2 -1\nv 2 -2 -1\nv 2 2 -1\nv -2 2 -1\nf 5 6 7 8\n";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn page() -> String {
    fs::read_to_string(root().join("docs/library.md")).unwrap()
}

/// The blocks of the page in a language.
#[cfg(feature = "embree")]
fn blocks<'p>(page: &'p str, language: &str) -> Vec<&'p str> {
    let fence = format!("```{language}\n");
    let blocks = page.split(&fence).skip(1);
    blocks.map(|block| block.split("```").next().unwrap()).collect()
}

/// Builds a crate that depends on envers by the lines of the page's block with this index, runs the page's
/// program in it, and returns what that prints.
#[cfg(feature = "embree")]
fn run_downstream(dependency: usize) -> String {
    let page = page();
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    let dependency = blocks(&page, "toml")[dependency];
    let dependency = dependency.replace("../envers", &root().display().to_string());
    assert!(dependency.contains(&*root().display().to_string()));
    let package = "[package]\nname = \"downstream\"\nversion = \"0.0.0\"\nedition = \"2024\"\n";
    write("Cargo.toml", &format!("{package}{dependency}"));
    write("src/main.rs", blocks(&page, "rust,no_run")[0]);
    write("model.obj", MODEL);
    // The same versions as here, so that nothing is downloaded.
    fs::copy(root().join("Cargo.lock"), folder.path().join("Cargo.lock")).unwrap();

    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["run", "--quiet", "--offline"]);
    // What `scripts/setup` found, which cargo does not read of a dependency.
    let config = root().join(".cargo/config.toml");
    if config.exists() {
        cargo.arg("--config").arg(config);
    }
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("downstream");
    let output = cargo
        .args(["--", "model.obj"])
        .env("CARGO_TARGET_DIR", target)
        .env("CARGO_PROFILE_DEV_DEBUG", "0")
        .current_dir(folder.path())
        .output()
        .unwrap();
    let [stdout, stderr] = [output.stdout, output.stderr].map(|b| String::from_utf8(b).unwrap());
    assert!(output.status.success() && stderr.is_empty(), "{stderr}");
    let picture = image::open(folder.path().join("picture.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (320, 180));
    stdout
}

/// Asserts that the program has traced on a backend and found the faces of the model.
#[cfg(feature = "embree")]
fn assert_traced(stdout: &str, backend: &str) {
    let lines: Vec<&str> = stdout.lines().collect();
    assert_eq!((lines.len(), lines[0]), (4, backend), "{stdout}");
    let found = "model.obj, object `near`, face 0 in line 6";
    assert!(lines[1..].iter().all(|line| line.ends_with(found)), "{stdout}");
}

/// One after the other, since the second build finds most of its dependencies compiled; and only where Embree
/// is built in, which one run of the tests is.
#[test]
#[cfg(feature = "embree")]
fn crates_that_depend_on_envers_with_and_without_embree_run_the_program_of_the_page() {
    assert_traced(&run_downstream(0), "embree");
    assert_traced(&run_downstream(1), "rust");
}

#[test]
fn files_that_the_page_links_are_there() {
    for link in page().split("](").skip(1) {
        let target = link.split([')', '#']).next().unwrap();
        if !target.is_empty() && !target.starts_with("http") {
            assert!(root().join("docs").join(target).exists(), "{target}");
        }
    }
}
