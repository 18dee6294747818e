//! Signals that end the command: no temporary file stays, and each output is whole.

use std::os::unix::process::ExitStatusExt;
use std::process::{Child, ExitStatus, Stdio};
use std::time::Instant;

use rustix::process::{Pid, Signal, kill_process};

use super::*;

/// A process of the command, in a folder.
fn start(folder: &Folder, arguments: &str) -> Child {
    std::process::Command::new(env!("CARGO_BIN_EXE_envers"))
        .args(arguments.split_whitespace())
        .current_dir(folder.0.path())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// The status of a process that is sent a signal.
fn end(mut child: Child, signal: Signal) -> ExitStatus {
    kill_process(Pid::from_child(&child), signal).unwrap();
    child.wait().unwrap()
}

fn has_temporary_files(folder: &Folder) -> bool {
    folder.names().iter().any(|name| name.ends_with(".part"))
}

/// The signals of these that end a process which this one starts: what it ignores itself, as when it
/// runs in the background of a script, the process ignores, too.
fn effective(signals: &[Signal]) -> Vec<Signal> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:\t")).unwrap_or("0");
    let mask = u64::from_str_radix(mask, 16).unwrap();
    let is_ignored = |signal: &Signal| mask >> (signal.as_raw() - 1) & 1 == 1;
    signals.iter().copied().filter(|signal| !is_ignored(signal)).collect()
}

#[test]
fn a_signal_removes_the_temporary_file_and_ends_the_process() {
    let scene = moving().replace("size = [64, 48]", "size = [4096, 4096]\nspp = 65536");
    let folder = Folder::with(&scene);
    folder.write("a.gif", "old");
    // SIGHUP keeps its default action elsewhere.
    let signals = [Signal::INT, Signal::TERM, Signal::HUP];
    let count = if cfg!(target_os = "linux") { 3 } else { 2 };
    for signal in effective(&signals[..count]) {
        let mut child = start(&folder, "render scene.toml -o a.gif");
        while !has_temporary_files(&folder) {
            assert!(child.try_wait().unwrap().is_none(), "it does not end by itself");
            std::thread::sleep(Duration::from_millis(1));
        }
        let status = end(child, signal);
        assert_eq!(status.signal(), Some(signal.as_raw()), "{status}");
        assert_eq!(folder.names(), ["a.gif", "scene.toml"]);
        assert_eq!(folder.read("a.gif"), b"old");
    }
}

#[test]
fn at_whatever_moment_a_signal_comes_each_output_is_the_old_or_the_new_one() {
    // What the outputs are when nobody interrupts, and how long that takes.
    let folder = Folder::with(&moving());
    let commands = [
        "render scene.toml -o f##.png -o f##.exr -o a.gif -o a.apng --stats s.json",
        "render scene.toml -o still.png --stats s.json --frames 1",
    ];
    let mut times = [Duration::ZERO; 2];
    for (time, command) in times.iter_mut().zip(commands) {
        let before = Instant::now();
        folder.run(command).good();
        *time = before.elapsed();
    }
    let outputs: Vec<(String, Vec<u8>)> = folder
        .names()
        .into_iter()
        .filter(|name| name != "scene.toml")
        .map(|name| (name.clone(), folder.read(name)))
        .collect();
    assert_eq!(outputs.len(), 24);

    // Both commands, stopped by both signals at random moments of that time.
    let signals = effective(&[Signal::INT, Signal::TERM]);
    let mut random = envers_testing::Random(7);
    let mut stopped = 0;
    for i in 0..200 {
        outputs.iter().for_each(|(name, _)| folder.write(name, "old"));
        let which = i / 2 % 2;
        let child = start(&folder, commands[which]);
        std::thread::sleep(times[which].mul_f64(random.unit()));
        let signal = signals[i % signals.len()];
        let status = end(child, signal);
        let was_stopped = status.signal() == Some(signal.as_raw());
        assert!(was_stopped || status.code() == Some(0), "run {i}: {status}");
        stopped += usize::from(was_stopped);
        assert_eq!(folder.names().len(), outputs.len() + 1, "run {i}: {:?}", folder.names());
        for (name, new) in &outputs {
            let found = folder.read(name);
            // Statistics tell times, which no two runs share.
            let is_new = match name.as_str() {
                "s.json" => serde_json::from_slice::<Value>(&found).is_ok(),
                _ => found == *new,
            };
            assert!(is_new || found == b"old", "run {i}: {name}, {} bytes", found.len());
        }
    }
    assert!(stopped > 0, "no run was stopped before its end");
}

#[test]
#[cfg(target_os = "linux")]
fn a_signal_that_the_caller_ignores_does_not_end_the_process() {
    let folder = Folder::with(&moving());
    let render = "\"$0\" render scene.toml -o a.gif --quiet & \
                  while kill -HUP $! 2>/dev/null; do :; done; wait $!";
    folder.run_script(&format!("trap '' HUP; {render}")).good();
    assert_eq!(folder.names(), ["a.gif", "scene.toml"]);
}

#[test]
fn a_shell_shows_143_for_sigterm() {
    let folder = Folder::with(&endless());
    let render = "\"$0\" render scene.toml -o a.png & \
                  while kill -TERM $! 2>/dev/null; do :; done; wait $!";
    assert_eq!(folder.run_script(render).status, Some(143));
    assert_eq!(folder.names(), ["scene.toml"]);
}
