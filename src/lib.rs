//! A scene renderer that follows the light backwards.

#[cfg(feature = "cli")]
pub mod cli;
pub mod error;
pub mod film;
pub mod geometry;
pub mod integrator;
pub mod intersect;
pub mod load;
#[cfg(feature = "measure")]
pub mod measure;
pub mod render;
pub mod scene;
pub mod shading;
pub mod surface;
pub mod write;
