//! A scene renderer that follows the light backwards.

pub mod error;
pub mod film;
pub mod geometry;
pub mod integrator;
pub mod intersect;
pub mod load;
pub mod render;
pub mod scene;
pub mod shading;
pub mod surface;
