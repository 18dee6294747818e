//! The signals that end the command: its temporary files are removed first.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::error::{Error, Result};
use crate::write;

/// Has SIGINT, SIGTERM and SIGHUP remove the temporary files before they end the process, except for
/// those that are ignored.
///
/// # Errors
/// When the system does not allow it.
pub fn handle() -> Result<()> {
    let ignored = ignored();
    let handled = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| !ignored.contains(signal));
    let failed = |e: std::io::Error| Error::failed(format!("cannot handle signals: {e}"));
    // To grow a file beyond what `ulimit -f` allows is then an error of writing it.
    signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false))).map_err(failed)?;
    let mut signals = Signals::new(handled).map_err(failed)?;
    // A thread of its own, since a signal handler may hardly do anything. It waits for a file that is
    // just being renamed, and then no other is created or renamed.
    let end = move || {
        if let Some(signal) = signals.forever().next() {
            write::remove_temporaries();
            let _ = emulate_default_handler(signal);
            std::process::abort(); // Not reached: the default of all three is to end the process.
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(end).map_err(failed)?;
    Ok(())
}

/// Returns the signals that the command ignores because its caller does: `nohup` ignores SIGHUP, and a
/// script SIGINT for what it runs in the background.
#[cfg(any(target_os = "linux", target_os = "android"))]
fn ignored() -> Vec<i32> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|digits| u64::from_str_radix(digits.trim(), 16).ok()).unwrap_or(0);
    // The lowest bit is signal 1.
    (1..=64).filter(|signal| mask >> (signal - 1) & 1 == 1).collect()
}

/// Returns the signals that the command may have to ignore: no safe function tells here whether `nohup`
/// runs it, and then a terminal that is closed must not end it.
#[cfg(not(any(target_os = "linux", target_os = "android")))]
fn ignored() -> Vec<i32> {
    vec![SIGHUP]
}
