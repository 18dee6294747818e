//! The intersection mathematics: rays, hits, bounding boxes, and pure functions in f64 that
//! intersect a ray with a sphere, a plane or a triangle; and the sampling of lights.
//!
//! All backends call these functions, so that they find hits at the same distances. No function
//! uses a fused multiply-add: results must not depend on whether the compiler vectorised the caller.
//! The `certified` submodules hold the same intersections in exact arithmetic.
//!
//! ```
//! use envers::Ray;
//! use envers::internals::plane;
//! use glam::DVec3;
//!
//! let ray = Ray::new(DVec3::Y * 3.0, DVec3::new(1.0, -2.0, 0.0));
//! let t = plane::intersect(DVec3::ZERO, DVec3::Y, ray.origin, ray.direction).unwrap();
//! assert_eq!(ray.position(t), DVec3::X * 1.5);
//! ```

mod bounds;
pub(crate) mod double_double;
#[cfg(test)]
pub(crate) mod dyadic;
mod estimate;
pub mod exact_order;
mod hit;
mod hit16;
pub mod incidence;
mod integer;
mod lanes;
pub mod plane;
mod ray;
mod ray16;
pub mod sampling;
pub mod sphere;
pub mod triangle;

pub use bounds::Bounds;
pub use estimate::Estimate;
pub use hit::{Geometry, Hit, PrimitiveId};
pub use hit16::{Hit16, HitBatch, PrimitiveId16};
pub use lanes::{LANES, Lanes};
pub use ray::{Continuation, Departure, Ray, ShadowEnds, Side};
pub use ray16::{Ray16, RayBatch};
