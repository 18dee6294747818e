//! Mirrors and glass, held to what can be worked out by hand.

mod area_lights;
mod depth;
mod environment;
mod glass;
mod invisible_surfaces;
mod mirrors;
mod nested_dielectrics;
mod one_pixel;
mod one_sided;
mod path;
mod shadows;
mod smooth_meshes;
