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

/// Seconds that this thread has run, as Linux tells it.
fn own_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
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
