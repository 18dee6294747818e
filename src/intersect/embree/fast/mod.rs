//! Precision `fast`: Embree's own triangles, intersected again in f64, and spheres and what f32 does
//! not resolve in f64 alone.

pub mod filter;
mod meshes;
mod refine;
mod resolution;
mod spheres;
mod triangles;

pub use meshes::{Blas, Meshes};
pub use refine::refine;
pub use resolution::unresolved_meshes;
pub use spheres::{FastSpheres, SphereEntry, SphereTable};
pub use triangles::{FastTriangle, merge_triangles};
