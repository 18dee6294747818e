//! Files that are malicious, damaged, or name files that they must not reach.

// What a file asks for does not depend on the backend: one run of the tests is enough.
#[cfg(all(target_os = "linux", feature = "cli", feature = "embree"))]
mod cases;
mod damaged;
#[cfg(target_os = "linux")]
mod sandbox;
