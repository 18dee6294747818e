//! Files that are malicious, damaged, or name files that they must not reach.

#[cfg(all(target_os = "linux", feature = "cli"))]
mod cases;
mod damaged;
#[cfg(target_os = "linux")]
mod sandbox;
