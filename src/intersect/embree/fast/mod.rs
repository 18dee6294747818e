//! Precision `fast`: Embree's own triangles, intersected again in f64, and spheres in f64.

pub mod filter;
pub mod meshes;
pub mod refine;
pub mod spheres;
