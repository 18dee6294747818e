//! Defaults for what a file leaves out: camera, lights, tangents, alpha and mipmaps.

pub mod auto_camera;
pub mod auto_lighting;
pub mod materials;
mod tangents;
