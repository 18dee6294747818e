//! Intersection mathematics: pure functions in f64 that trace, load and shade nothing.
//!
//! Both backends call these functions, so that a hit is the same number whoever found its
//! primitive. None of them uses a fused multiply-add: the results must not depend on whether the
//! compiler vectorised the caller.

mod bounds;
mod double_double;
#[cfg(test)]
mod dyadic;
mod estimate;
mod hit;
mod hit16;
mod integer;
pub mod plane;
mod ray;
mod ray16;
pub mod sphere;
pub mod triangle;

pub use bounds::Bounds;
pub use estimate::Estimate;
pub use hit::{Geometry, Hit, PrimitiveId};
pub use hit16::{Hit16, HitBatch, PrimitiveId16};
pub use ray::{Continuation, Departure, Ray, Side};
pub use ray16::{Departure16, LANES, Lanes, Ray16, RayBatch};
