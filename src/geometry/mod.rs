//! Intersection mathematics: pure functions in f64 that trace, load and shade nothing.
//!
//! Both backends call these functions, so that a hit is the same number whoever found its
//! primitive. None of them uses a fused multiply-add: the results must not depend on whether the
//! compiler vectorised the caller.

mod bounds;
mod double;
#[cfg(test)]
mod dyadic;
mod estimate;
mod exact;
mod found;
mod hit;
pub mod plane;
mod ray;
mod rays;
pub mod sphere;
pub mod triangle;

pub use bounds::Bounds;
pub use estimate::Estimate;
pub use found::{Found, Hits, Ids};
pub use hit::{Geometry, Hit, PrimitiveId};
pub use ray::{Departure, Passage, Ray, Side};
pub use rays::{LANES, Lanes, Left, Lines, Rays};
