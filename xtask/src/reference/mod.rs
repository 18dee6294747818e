//! The reference scenes S and M of the benches: their content, and their files.

pub mod knot;
pub mod spheres;
