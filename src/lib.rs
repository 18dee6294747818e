//! A scene renderer and ray caster.
//!
//! A [`Scene`] holds analytic spheres, infinite planes and triangle meshes, and is [loaded](load) from
//! glTF, OBJ or a scene file, or built by hand. A [`Renderer`] makes a picture of it, which is saved as
//! PNG, JPEG, WebP or EXR. An [`Intersector`] finds hits without a picture: [Intel Embree], or [`Bvh`], in pure
//! Rust; in [`Precision::Certified`] every hit is the one that exact arithmetic finds.
//!
//! Render a scene that is built by hand:
//!
//! ```
//! use envers::glam::{DVec3, Vec3};
//! use envers::{Camera, Light, Material, Projection, Renderer, Scene, Sphere};
//!
//! let mut scene = Scene::default();
//! let red = scene.add_material(Material::matte(Vec3::new(0.8, 0.2, 0.1)));
//! scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, red));
//! scene.lights.push(Light::sun(DVec3::NEG_Z));
//! let projection = Projection::FovY(45f64.to_radians());
//! scene.cameras.push(Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, projection)?);
//! let rendering = Renderer::new(&scene).size([64, 32]).samples(4).render()?;
//! assert!(rendering.film.pixel(32, 16)[0] > 0.5);
//! # Ok::<(), envers::Error>(())
//! ```
//!
//! Cast rays without a picture:
//!
//! ```
//! use envers::glam::DVec3;
//! use envers::{Backend, Coherence, Material, Precision, Ray, Scene, Sphere};
//!
//! let mut scene = Scene::default();
//! let material = scene.add_material(Material::default());
//! scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, material));
//! let intersector = Backend::default().build(&scene, Precision::Certified, 0)?;
//! let rays = [Ray::new(DVec3::Z * 5.0, DVec3::NEG_Z), Ray::new(DVec3::Z * 5.0, DVec3::Y)];
//! let mut hits = [None; 2];
//! intersector.closest(&rays, Coherence::Coherent, &mut hits);
//! assert_eq!(hits[0].map(|hit| hit.t), Some(4.0));
//! assert_eq!(hits[1], None);
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
//! - `embree`: Intel Embree 4 as an intersector; needs libclang to build. Embree's library is opened when it is
//!   first used, from the folder that the environment variable `EMBREE_DIR` names, or else from beside the
//!   program or from the system.
//! - `measure`: holding one backend against the other, and one picture against another.
//! - `cli`: the `envers` command.
//!
//! docs/library.md shows how a program depends on envers, and how it casts rays, step by step.
//!
//! A program that uses the library alone takes none, and then builds without Embree, clap and plotters:
//! `envers = { path = "../envers", default-features = false }`.
//!
//! [Intel Embree]: https://www.embree.org

mod error;
mod film;
mod geometry;
mod integrator;
mod intersect;
mod load;
mod render;
pub mod scene;
mod shading;
mod surface;
mod write;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[cfg(feature = "measure")]
#[doc(hidden)]
pub mod measure;

pub use glam;

pub use error::{Error, ErrorKind, Location, Remedy, Result};
pub use film::{Film, View};
pub use geometry::{
    Bounds, Continuation, Departure, Geometry, Hit, HitBatch, PrimitiveId, Ray, RayBatch,
    ShadowEnds, Side,
};
#[cfg(feature = "embree")]
pub use intersect::Embree;
pub use intersect::{Backend, BruteForce, BuildQuality, Bvh, Coherence, Intersector, Precision};
pub use load::{
    Asset, AssetAnimation, DropReason, EnvironmentSource, Framing, Limit, Limits, LoadOptions,
    LoadReport, Loaded, UpAxis, add_ground, load,
};
pub use render::{Elapsed, RenderOptions, Renderer, Rendering, Statistics};
pub use scene::{
    AdaptiveSampling, AlphaMode, Camera, Checker, Falloff, FilmSettings, Image, Instance, Light,
    LightKind, Material, MaterialId, Mesh, MeshId, Plane, Projection, Provenance, Scene, Shadow,
    Sphere, Texture, TextureId, Tone,
};
pub use surface::Surface;

/// The parts that the project's own tests, benches and tools use beside the API. They may change at
/// any time.
#[doc(hidden)]
pub mod internals {
    pub use crate::geometry::{plane, sphere, triangle};
    pub use crate::integrator::{
        Counts, FeatureCounts, NotFinite, RayCounts, Tiling, sample_steps,
    };
    #[cfg(feature = "embree")]
    pub use crate::intersect::embree_version;
    pub use crate::intersect::{BuildStats, IntersectorBuilder};
    pub use crate::load::schema;
    pub use crate::render::Traced;
    pub use crate::scene::{IncidentLight, ShadingParams};
    pub use crate::shading::{Bsdf, BsdfSample};
    pub use crate::surface::{TextureContext, ambient_occlusion, shading_params};
    pub use crate::write::{Settings, png_bytes, write};
}

/// The README's program, compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The programs of the page for library users.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct LibraryPage;
