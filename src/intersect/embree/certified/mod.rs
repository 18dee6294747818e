//! Precision `certified`: every primitive is user geometry, tested with a proven bound or exactly.

pub mod callbacks;
pub mod instances;
pub mod meshes;
mod resolve;
mod rounding;
mod triangles;
