//! Precision `certified`: every primitive is user geometry, tested with a proven bound or exactly.

mod instances;
mod meshes;
mod primitives;
mod resolve;
mod rounding;

pub use instances::Blas;
pub use meshes::Meshes;
pub use primitives::CertifiedSphere;
pub use rounding::round_hits;
