//! A scene renderer that follows the light backwards, from the eye to the source.
//!
//! Analytic spheres, planes and triangle meshes from glTF and OBJ stand in one [`scene::Scene`].
//! An [`intersect::Intersector`] finds what rays meet: [Intel Embree], or a pure-Rust BVH in f64
//! that checks it. A Whitted [`integrator`] shades what is hit with Lambert and Phong; the picture
//! is a [`film::Film`], written as PNG or EXR.
//!
//! ```
//! use envers::glam::{DVec3, Vec3};
//! use envers::{Camera, Material, Projection, Renderer, Scene, Sphere};
//!
//! let mut scene = Scene::default();
//! let glow = Material { emission: Vec3::ONE, ..Material::default() };
//! let glow = scene.add_material(glow);
//! scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, glow));
//! let projection = Projection::FovY(45f64.to_radians());
//! scene.cameras.push(Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, projection)?);
//! let rendering = Renderer::new(&scene).size([64, 32]).render()?;
//! assert_eq!(rendering.film.pixel(32, 16), [1.0; 3]);
//! # Ok::<(), envers::Error>(())
//! ```
//!
//! # Conventions
//!
//! World space is right-handed. Positions, directions and distances are f64, in any one unit
//! (metres for glTF); radiance is f32, linear Rec. 709. Angles are radians in the library and
//! degrees in files and flags. `t` is in units of the ray's |direction|, and a ray meets what it
//! crosses at 0 < t < `tmax`, both strictly. Geometric normals have length 1.
//!
//! # Features
//!
//! All three are on by default; a library user can take none.
//!
//! - `embree`: Intel Embree 4 as an intersector; needs libembree4 to link and libclang to build.
//! - `measure`: holding one backend against the other, and one picture against another.
//! - `cli`: the `envers` command.
//!
//! # Modules
//!
//! Each uses only those above it: [`error`], [`geometry`], [`scene`], [`load`], [`intersect`],
//! [`surface`], [`shading`], [`film`], [`mod@write`], [`integrator`], [`render`], `measure`,
//! `cli`.
//!
//! [Intel Embree]: https://www.embree.org

pub use glam;

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

pub use error::{Error, ErrorKind, Result};
pub use film::{Film, View};
pub use geometry::{
    Bounds, Continuation, Departure, Geometry, Hit, HitBatch, PrimitiveId, Ray, RayBatch, Side,
};
#[cfg(feature = "embree")]
pub use intersect::Embree;
pub use intersect::{Backend, BruteForce, BuildQuality, Bvh, Coherence, Intersector, Precision};
pub use load::{DropReason, Limit, Limits, LoadOptions, LoadReport, Loaded, load};
pub use render::{RenderOptions, Renderer, Rendering, Statistics};
pub use scene::{
    AdaptiveSampling, AlphaMode, Camera, Checker, Falloff, FilmSettings, Image, Instance, Light,
    LightKind, Material, MaterialId, Mesh, MeshId, Plane, Projection, Scene, Shadow, Sphere,
    Texture, TextureId, Tone,
};
pub use surface::Surface;

/// The README's program, compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
