//! Pictures rendered by the library: radiance worked out by hand, mirrors and glass, textures,
//! animation, adaptive sampling, and the committed golden pictures.

mod adaptive_sampling;
mod animation;
mod gallery;
mod golden;
mod not_finite;
mod optics;
mod radiance;
mod textures;
