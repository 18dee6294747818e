//! Time, of a thread or of the world.

use std::time::Instant;

/// Seconds that `work` takes: on one thread the thread's own, where the system tells it.
pub fn time(threads: usize, work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    let own = if threads == 1 { own_seconds() } else { None };
    work();
    match (own, own_seconds()) {
        (Some(before), Some(after)) if threads == 1 => after - before,
        _ => start.elapsed().as_secs_f64(),
    }
}

/// Seconds that this thread has run. (What Linux tells of it under `/proc` moves only at the ticks of
/// its scheduler, milliseconds apart.)
#[cfg(unix)]
fn own_seconds() -> Option<f64> {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

#[cfg(not(unix))]
fn own_seconds() -> Option<f64> {
    None
}

/// The median.
///
/// # Panics
/// When there is nothing.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
