//! Runs what the chapters tell their readers to run, once for all tests.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use image::codecs::gif::GifDecoder;
use image::{AnimationDecoder, RgbImage};

use super::book::{all, root, tutorial};

/// The most that a channel may differ, of 255.
const TOLERANCE: u8 = 1;

/// The folder of a reader who has typed every command, and what each answered.
struct Session {
    folder: tempfile::TempDir,
    answers: BTreeMap<String, Output>,
}

static SESSION: LazyLock<Session> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder can be made");
    for part in ["assets", "docs/tutorial"] {
        copy(&root().join(part), &folder.path().join(part));
    }
    let mut answers = BTreeMap::new();
    for chapter in all() {
        for line in chapter.commands().into_iter().filter(|line| !lacks_embree(line)) {
            let answer = |line: &String| run(line, folder.path(), &chapter.place());
            answers.entry(line).or_insert_with_key(answer);
        }
    }
    Session { folder, answers }
});

/// True if a command holds Embree against something in a build that has none.
fn lacks_embree(line: &str) -> bool {
    let compares = line.starts_with("envers validate ") && !line.contains("--ray");
    compares && !cfg!(feature = "embree")
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder can be made");
    for entry in fs::read_dir(from).unwrap_or_else(|e| panic!("{}: {e}", from.display())) {
        let path = entry.expect("the folder can be read").path();
        let target = to.join(path.file_name().expect("ok: it is in a folder"));
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).expect("a file can be copied");
        }
    }
}

/// Types one line in a folder.
fn run(line: &str, folder: &Path, place: &str) -> Output {
    assert!(!line.contains(['\'', '"', '|', '>', '\\', '$']), "{place}: {line}: needs a shell");
    let words: Vec<_> = line.split_whitespace().collect();
    let (program, arguments) = match *words {
        ["envers", ref rest @ ..] => (PathBuf::from(env!("CARGO_BIN_EXE_envers")), rest),
        ["python3", ref rest @ ..] => (PathBuf::from("python3"), rest),
        ["cargo", "run", "--example", name, "--", ref rest @ ..] => (example(name), rest),
        ["cargo", "run", "--release", "--example", name, "--", ref rest @ ..] => {
            (example(name), rest)
        }
        ["cargo", "run", "--release", "--example", name] | ["cargo", "run", "--example", name] => {
            (example(name), &[][..])
        }
        _ => panic!("{place}: no test runs `{line}`"),
    };
    let mut command = Command::new(&program);
    command.args(arguments).current_dir(folder);
    command.env("PYTHONDONTWRITEBYTECODE", "1").env("PYTHONUTF8", "1");
    command.output().unwrap_or_else(|e| panic!("{place}: {line}: {}: {e}", program.display()))
}

/// Builds an example with the features of this build; where it is.
fn example(name: &str) -> PathBuf {
    let mut build = Command::new(env!("CARGO"));
    build.current_dir(root()).args(["build", "--quiet", "--example", name]);
    if !cfg!(feature = "embree") {
        build.args(["--no-default-features", "--features", "cli"]);
    }
    if !cfg!(debug_assertions) {
        build.arg("--release");
    }
    assert!(build.status().expect("cargo starts").success(), "the example {name} does not build");
    let envers = Path::new(env!("CARGO_BIN_EXE_envers"));
    envers.with_file_name("examples").join(name).with_extension(std::env::consts::EXE_EXTENSION)
}

#[test]
fn every_command_succeeds() {
    for (line, answer) in &SESSION.answers {
        let said = String::from_utf8_lossy(&answer.stderr);
        assert!(answer.status.success(), "{line}: {}\n{said}", answer.status);
    }
}

#[test]
fn every_printed_text_is_what_its_command_prints() {
    for chapter in all() {
        for block in chapter.blocks.iter().filter(|block| block.language == "text") {
            let place = chapter.place();
            let command = block.comment.strip_prefix("printed by ").unwrap_or_else(|| {
                panic!("{place}: no `<!-- printed by COMMAND -->` before\n{}", block.text)
            });
            let answer = SESSION.answers.get(command);
            let answer = answer.unwrap_or_else(|| panic!("{place}: `{command}` is not shown"));
            let lines = |text: &str| {
                text.lines().map(|line| line.trim_end().to_owned() + "\n").collect::<String>()
            };
            let printed = lines(&String::from_utf8_lossy(&answer.stdout));
            assert!(
                printed.contains(&lines(&block.text)),
                "{place}: `{command}` printed\n{printed}\nand the chapter shows\n{}",
                block.text
            );
        }
    }
}

/// The most by which a channel of any pixel differs; 255 where the sizes do.
fn difference(a: &RgbImage, b: &RgbImage) -> u8 {
    if a.dimensions() != b.dimensions() {
        return 255;
    }
    a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn every_picture_is_what_its_command_makes() {
    let mut blessed = Vec::new();
    for chapter in all() {
        for name in chapter.pictures().into_iter().filter(|name| name.ends_with(".png")) {
            let (place, committed) = (chapter.place(), tutorial().join("images").join(name));
            let output = format!("-o {name}");
            let made = chapter.commands().iter().any(|line| line.ends_with(&output));
            assert!(made, "{place}: no command ends with `{output}`");
            let made = SESSION.folder.path().join(name);
            let pictures = [&committed, &made].map(|path| image::open(path).map(|i| i.into_rgb8()));
            let same = match &pictures {
                [Ok(committed), Ok(made)] => difference(committed, made) <= TOLERANCE,
                [Err(_), Ok(_)] => false,
                [_, Err(e)] => panic!("{place}: {name}: {e}"),
            };
            if !same && std::env::var_os("ENVERS_BLESS").is_some() {
                fs::copy(&made, &committed).expect("the picture can be written");
                blessed.push(name.to_owned());
            } else {
                assert!(same, "{place}: {name} is not what its command makes; ENVERS_BLESS=1 does");
            }
        }
    }
    assert!(blessed.is_empty(), "written anew, look at them and run again: {blessed:?}");
}

/// The size and the delay of each frame of an animated picture.
fn frames(path: &Path) -> Vec<((u32, u32), (u32, u32))> {
    let file = fs::File::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let decoder = GifDecoder::new(std::io::BufReader::new(file)).expect("it is a GIF");
    let frames = decoder.into_frames().map(|frame| frame.expect("its frames can be read"));
    frames.map(|f| (f.buffer().dimensions(), f.delay().numer_denom_ms())).collect()
}

/// Their pixels are not compared: a value that is off by 1 may change a frame's whole palette.
#[test]
fn every_animated_picture_has_the_frames_of_its_command() {
    for chapter in all() {
        for name in chapter.pictures().into_iter().filter(|name| name.ends_with(".gif")) {
            let [committed, made] = [tutorial().join("images"), SESSION.folder.path().into()]
                .map(|folder| frames(&folder.join(name)));
            assert_eq!(committed, made, "{}: {name}", chapter.place());
            assert!(committed.len() > 1, "{}: {name}", chapter.place());
        }
    }
}

#[test]
fn every_committed_picture_is_small() {
    for entry in fs::read_dir(tutorial().join("images")).expect("the folder is there") {
        let entry = entry.expect("it can be read");
        let bytes = entry.metadata().expect("it has a size").len();
        assert!(bytes <= 100_000, "{}: {bytes} bytes", entry.file_name().display());
    }
}
