//! A scene renderer that follows the light backwards.

pub mod error;
pub mod geometry;
pub mod intersect;
pub mod load;
pub mod scene;
