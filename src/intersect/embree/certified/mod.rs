//! Precision `certified`: every primitive is user geometry, tested with a proven bound or exactly.

mod primitives;
mod resolve;
mod rounding;

pub use primitives::{CertifiedSphere, CertifiedTriangle};
pub use rounding::round_hits;
