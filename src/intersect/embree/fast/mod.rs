//! Precision `fast`: Embree's own triangles, intersected again in f64, and spheres in f64.

pub mod filter;
mod meshes;
mod refine;
mod spheres;

pub use meshes::{Blas, Meshes};
pub use refine::refine;
pub use spheres::{FastSpheres, SphereEntry, SphereTable};
