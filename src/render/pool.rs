//! The threads that a rendering runs on.

use crate::error::{Error, Result};

/// Runs `work` on `threads` threads; 0 means all there are. The current rayon pool is used if it has
/// as many, and a new pool otherwise.
///
/// # Errors
/// When the threads cannot be started, and the errors of `work`.
pub fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    if threads == 0 || threads == rayon::current_num_threads() {
        return work();
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Error::failed(format!("cannot start {threads} threads: {e}")))?
        .install(work)
}
