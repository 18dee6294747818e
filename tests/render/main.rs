//! Pictures rendered by the library: radiance worked out by hand, mirrors and glass, textures,
//! animation, adaptive sampling, and the committed golden pictures.

mod adaptive_sampling;
mod animation;
mod gallery;
mod golden;
mod light_transport;
mod not_finite;
mod radiance;
mod textures;
mod transparent;
