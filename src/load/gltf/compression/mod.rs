//! Compressed vertex data: Draco and meshoptimizer.

pub mod draco;
pub mod meshopt;
