//! Hundreds of files that were made to do harm, each named after what it tries. The command looks at
//! each in a process of its own that may take 10 seconds of processors and 1 GiB: it must say what is wrong, or
//! show what is left, and neither panic, abort nor hang.
//!
//! `ENVERS_HOSTILE=DIR` keeps the files there, each case in a folder with its name.

mod compressed;
mod deform;
mod encode;
mod glb;
mod gltf;
mod gltf_edits;
mod growth;
mod links;
mod mtl;
mod obj;
mod pictures;
mod scene;

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{self, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The expected outcome of loading a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Expect {
    /// Exit status 2, and this on stderr.
    Error(&'static str),
    /// The file loads, with this on stderr.
    Warning(&'static str),
    /// The file loads without a word on stderr.
    Loads,
    /// The file loads, or exit status 2 tells why not: numbers that mean little, and what is not read yet.
    Any,
}
use Expect::{Error, Loads, Warning};

/// A file that does harm, with those beside it.
struct Case {
    name: String,
    /// The names and bytes of the files; the first is the one that is loaded.
    files: Vec<(String, Vec<u8>)>,
    /// The further preparation of the folder.
    prepare: fn(&Path),
    command: Command,
    expect: Expect,
}

/// The command that a file is given to.
#[derive(Clone, Copy)]
enum Command {
    Info,
    /// Rendered at 64 × 48 pixels, with the default number of samples.
    Render,
    /// Compared with itself.
    Diff,
}

impl Case {
    fn new(name: impl Into<String>, file: &str, bytes: impl AsRef<[u8]>, expect: Expect) -> Self {
        let files = vec![(file.to_owned(), bytes.as_ref().to_vec())];
        Self { name: name.into(), files, prepare: |_| {}, command: Command::Info, expect }
    }

    /// Returns the same case with another text in its file.
    fn instead(mut self, text: &str) -> Self {
        self.files[0].1 = text.as_bytes().to_vec();
        self
    }

    /// Returns the same case with another file beside it.
    fn with(mut self, file: &str, bytes: impl AsRef<[u8]>) -> Self {
        self.files.push((file.to_owned(), bytes.as_ref().to_vec()));
        self
    }

    /// Returns the same case in a folder to which this is done.
    fn after(mut self, prepare: fn(&Path)) -> Self {
        self.prepare = prepare;
        self
    }

    fn write(&self, folder: &Path) -> PathBuf {
        std::fs::create_dir_all(folder).unwrap();
        for (name, bytes) in &self.files {
            std::fs::write(folder.join(name), bytes).unwrap();
        }
        (self.prepare)(folder);
        folder.join(&self.files[0].0)
    }
}

fn cases() -> Vec<Case> {
    let all = [
        gltf::cases(),
        gltf_edits::cases(),
        growth::cases(),
        deform::cases(),
        links::cases(),
        glb::cases(),
        obj::cases(),
        mtl::cases(),
        scene::cases(),
        pictures::cases(),
        compressed::cases(),
    ];
    all.into_iter().flatten().collect()
}

/// After how long a process that waits for something is taken to wait for ever. It is long since the
/// machine may be busy: what is limited to 10 s is the time of the processor.
const HANGS: Duration = Duration::from_secs(300);

/// Runs the command on a file, within 10 s and 1 GiB; returns its exit status and its messages.
fn run(command: Command, file: &Path) -> Result<(i32, String), String> {
    // Seconds of processors, and the data segment, which since Linux 4.7 is all memory of one's own,
    // in KiB.
    let done = match command {
        Command::Info => "info \"$1\"",
        Command::Render => "render \"$1\" --size 64x48 -o \"$1.png\"",
        Command::Diff => "diff \"$1\" \"$1\"",
    };
    let limited = format!("ulimit -t 10; ulimit -d 1048576; ulimit -c 0; exec \"$0\" {done}");
    let mut child = process::Command::new("sh")
        .args(["-c", &limited, env!("CARGO_BIN_EXE_envers")])
        .arg(file)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    fn text(mut pipe: impl Read + Send + 'static) -> JoinHandle<String> {
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            pipe.read_to_end(&mut bytes).unwrap();
            String::from_utf8_lossy(&bytes).into_owned()
        })
    }
    let stdout = text(child.stdout.take().unwrap());
    let stderr = text(child.stderr.take().unwrap());
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > HANGS {
            child.kill().unwrap();
            child.wait().unwrap();
            return Err("it hangs".to_owned());
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let (said, shown) = (stderr.join().unwrap(), stdout.join().unwrap());
    let is_code = |c: char| match c {
        '\n' => false,
        '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{feff}' => true,
        c => c.is_control(),
    };
    if [&said, &shown].iter().any(|text| text.contains(is_code)) {
        return Err(format!("it sends codes to the terminal: {said:?}"));
    }
    if [&said, &shown].iter().any(|text| text.lines().any(|line| line.starts_with("error: forged")))
    {
        return Err(format!("a name looks like a message: {said:?}"));
    }
    if let Some(long) = said.lines().find(|line| line.chars().count() > 3000) {
        return Err(format!("a message has {} bytes", long.len()));
    }
    match status.code() {
        Some(code) => Ok((code, said)),
        None => Err(format!("{status}: {said}")),
    }
}

/// Returns what is wrong with an outcome.
fn fault(expect: Expect, outcome: Result<(i32, String), String>) -> Option<String> {
    let (code, said) = match outcome {
        Ok(outcome) => outcome,
        Err(fault) => return Some(fault),
    };
    let is_right = match expect {
        Error(part) => code == 2 && said.starts_with("error: ") && said.contains(part),
        Warning(part) => code == 0 && said.starts_with("warning: ") && said.contains(part),
        Loads => code == 0 && said.is_empty(),
        Expect::Any => code == 0 || code == 2 && said.starts_with("error: "),
    };
    let said: String = said.chars().take(400).collect();
    (!is_right).then(|| format!("{code}, not {expect:?}: {said}"))
}

#[test]
fn hostile_files_are_refused_or_shown_as_far_as_they_go() {
    let kept = std::env::var_os("ENVERS_HOSTILE").map(PathBuf::from);
    let folder = tempfile::tempdir().unwrap();
    let mut faults = Vec::new();
    let mut slowest = Vec::new();
    let cases = cases();
    for case in &cases {
        let place =
            kept.as_deref().unwrap_or(folder.path()).join(case.name.replace(['/', ' ', '\\'], "-"));
        let file = case.write(&place);
        let start = Instant::now();
        let outcome = run(case.command, &file);
        slowest.push((start.elapsed(), &case.name));
        if let Some(fault) = fault(case.expect, outcome) {
            faults.push(format!("{}: {fault}", case.name));
        }
        if kept.is_none() {
            std::fs::remove_dir_all(&place).unwrap();
        }
    }
    slowest.sort();
    slowest.iter().rev().take(20).for_each(|(time, name)| println!("{time:?} {name}"));
    assert!(faults.is_empty(), "{} of {}:\n{}", faults.len(), cases.len(), faults.join("\n"));
}

#[test]
fn there_are_at_least_773_hostile_files_and_each_has_its_name() {
    let mut names: Vec<String> = cases().into_iter().map(|case| case.name).collect();
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), count, "two have the same name");
    assert!(count >= 773, "{count}");
}
