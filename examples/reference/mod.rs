//! The reference scenes S and M: what stands in them, and their files. Benches and tests include
//! this module.
#![allow(dead_code)] // Each of these uses a part of it.

#[path = "../make_assets/glb.rs"]
mod glb;
#[path = "../make_assets/shape.rs"]
mod shape;

pub mod knot;
pub mod spheres;
