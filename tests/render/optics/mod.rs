//! Mirrors and glass, held to what can be worked out by hand.

#[path = "optics/common.rs"]
mod common;

#[path = "optics/bodies.rs"]
mod bodies;
#[path = "optics/clear.rs"]
mod clear;
#[path = "optics/depth.rs"]
mod depth;
#[path = "optics/glass.rs"]
mod glass;
#[path = "optics/mirrors.rs"]
mod mirrors;
#[path = "optics/shadows.rs"]
mod shadows;
