//! Precision `certified`: every primitive is user geometry, tested with a proven bound or exactly.

pub mod instances;
pub mod meshes;
pub mod primitives;
mod resolve;
pub mod rounding;
