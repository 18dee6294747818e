//! The scene: plain, validated data with typed indices, without any parsing or tracing.
//!
//! ```
//! use envers::scene::{Camera, Light, Material, Plane, Projection, Scene, Sphere};
//! use glam::{DVec3, Vec3};
//!
//! let mut scene = Scene::default();
//! let red = scene.add_material(Material::matte(Vec3::new(0.8, 0.1, 0.1)));
//! let mirror = scene.add_material(Material::mirror(Vec3::splat(0.9)));
//! scene.spheres.push(Sphere::new(DVec3::Y, 1.0, mirror));
//! scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, red));
//! scene.lights.push(Light::point(DVec3::new(2.0, 5.0, 3.0)));
//! let projection = Projection::FovY(45f64.to_radians());
//! scene.cameras.push(Camera::look_at(DVec3::new(0.0, 2.0, 8.0), DVec3::Y, DVec3::Y, projection)?);
//! scene.check()?;
//! # Ok::<(), envers::Error>(())
//! ```

pub mod animation;
mod camera;
pub(crate) mod check;
mod coincidence;
mod coverage;
mod environment;
mod features;
mod film_settings;
mod image;
mod light;
mod material;
mod mesh;
mod metallic_roughness;
mod mipmap;
mod positions;
mod precision_warnings;
mod provenance;
mod shading_params;
mod shapes;
mod texels;
mod texture;
mod tone;
mod triangles;
pub(crate) mod watertight;

pub(crate) use camera::RayGenerator;
pub use camera::{Camera, Projection, ThinLens};
pub use coincidence::coincident_meshes;
pub use coverage::{AlphaMode, Coverage};
pub(crate) use environment::SHARPEST_REFLECTION;
pub use environment::{Environment, FilteredEnvironment, Sky};
pub use features::{Feature, SceneFeatures};
pub use film_settings::{AdaptiveSampling, FilmSettings, IntegratorKind, SamplePosition, Transfer};
pub use image::Image;
pub(crate) use light::{DEFAULT_LIGHT_SAMPLES, MIN_SUN_ANGLE};
pub use light::{Falloff, Light, LightKind, LightShape, MAX_LIGHT_SAMPLES, Shadow};
#[doc(hidden)]
pub use light::{IncidentLight, LightSample};
pub use material::{Material, MaterialId, NormalMap, OcclusionMap, ShadingModel, ShininessMap};
pub use mesh::{Mesh, MeshId};
pub use metallic_roughness::{MetallicRoughness, MetallicRoughnessMaps};
pub(crate) use metallic_roughness::{mirror_share, ray_share, shininess};
pub(crate) use positions::GRAIN;
pub use positions::Positions;
pub use precision_warnings::{PrecisionWarning, precision_warnings};
pub(crate) use provenance::{
    FaceMap, FileContents, GltfNames, MeshProvenance, NodeProvenance, ObjFaces, ObjLabels,
    ObjectProvenance,
};
pub use provenance::{
    GltfElement, GltfTriangle, ModelElement, ModelProvenance, ObjFace, Provenance, ProvenanceTable,
    TableKind, TableProvenance,
};
#[doc(hidden)]
pub use shading_params::ShadingParams;
pub use shapes::{Checker, Instance, Plane, Sphere};
pub use texels::{Texel, Texels};
pub(crate) use texture::TexturePoint;
pub use texture::{Channel, Filter, Texture, TextureId, Wrap};
pub use tone::Tone;
pub(crate) use triangles::Triangles;

use std::sync::Arc;

use crate::geometry::{Bounds, Geometry, PrimitiveId};
use animation::Animation;

/// A scene: everything that determines the picture.
///
/// A scene from `load` is complete and checked. One that is built by hand is checked when it is
/// rendered.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The size, samples, background and transfer function of the picture.
    pub film: FilmSettings,
    /// The cameras; the first one is the default.
    pub cameras: Vec<Camera>,
    /// The materials that objects refer to.
    pub materials: Vec<Material>,
    /// The textures that materials refer to.
    pub textures: Vec<Texture>,
    /// The analytic spheres.
    pub spheres: Vec<Sphere>,
    /// The infinite planes.
    pub planes: Vec<Plane>,
    /// The meshes, each stored once, and shared by the scenes at different times of an animation.
    pub meshes: Vec<Arc<Mesh>>,
    /// The instances of the meshes.
    pub instances: Vec<Instance>,
    /// The lights.
    pub lights: Vec<Light>,
    /// The environment, if there is one.
    pub environment: Option<Environment>,
    /// The animation, if there is one. The other fields are the scene before it is moved;
    /// [`Scene::at_time`] gives the scene at a time.
    pub animation: Option<Animation>,
    /// The places in the files that primitives come from, if a load was asked to record them
    /// (`LoadOptions::provenance`); see [`Scene::provenance_of`].
    pub provenance: Option<Arc<ProvenanceTable>>,
}

impl Scene {
    /// Adds a material and returns its id.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a texture and returns its id.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Adds a mesh and returns its id; only an [`Instance`] makes it visible.
    pub fn add_mesh(&mut self, mesh: Mesh) -> MeshId {
        self.meshes.push(Arc::new(mesh));
        MeshId(self.meshes.len() as u32 - 1)
    }

    /// The table of provenance, if it is recorded, to be changed.
    pub(crate) fn provenance_mut(&mut self) -> Option<&mut ProvenanceTable> {
        self.provenance.as_mut().map(Arc::make_mut)
    }

    /// Retains some of the instances; the others after them get new indices.
    pub(crate) fn retain_instances(&mut self, is_kept: impl Fn(&Instance) -> bool) {
        let instances = &self.instances;
        if let Some(table) = self.provenance.as_mut().map(Arc::make_mut) {
            let mut kept = instances.iter().map(&is_kept);
            table.instances.retain(|_| kept.next().unwrap_or(true));
        }
        self.instances.retain(is_kept);
    }

    /// The material of a primitive.
    ///
    /// # Panics
    /// When the primitive is not one of this scene.
    #[inline]
    pub fn material_of(&self, id: PrimitiveId) -> MaterialId {
        match id.geometry {
            Geometry::Spheres => self.spheres[id.primitive as usize].material,
            Geometry::Planes => self.planes[id.primitive as usize].material,
            Geometry::Mesh(_) => self.instances[id.instance as usize].material,
        }
    }

    /// True if a primitive blocks all light: it casts a shadow and transmits nothing.
    ///
    /// # Panics
    /// When the primitive is not one of this scene.
    #[inline(always)]
    pub fn blocks_light(&self, id: PrimitiveId) -> bool {
        let material = || self.materials.get(self.material_of(id).0 as usize);
        self.casts_shadow(id) && material().is_none_or(Material::blocks_light)
    }

    /// True if a primitive blocks all or some light.
    ///
    /// # Panics
    /// When the primitive is not one of this scene.
    #[inline]
    pub fn casts_shadow(&self, id: PrimitiveId) -> bool {
        match id.geometry {
            Geometry::Spheres => self.spheres[id.primitive as usize].casts_shadow,
            Geometry::Planes => self.planes[id.primitive as usize].casts_shadow,
            Geometry::Mesh(_) => self.instances[id.instance as usize].casts_shadow,
        }
    }

    /// The materials that some object has, each once.
    ///
    /// # Panics
    /// When an object has none.
    pub fn materials_in_use(&self) -> impl Iterator<Item = &Material> {
        let mut used = vec![false; self.materials.len()];
        let spheres = self.spheres.iter().map(|s| s.material);
        let planes = self.planes.iter().map(|p| p.material);
        let instances = self.instances.iter().map(|i| i.material);
        spheres.chain(planes).chain(instances).for_each(|id| used[id.0 as usize] = true);
        self.materials.iter().zip(used).filter_map(|(material, used)| used.then_some(material))
    }

    /// The vertices, in world space, of the triangle with this id.
    ///
    /// All intersections in f64 are with these vertices, which this function alone transforms.
    ///
    /// # Panics
    /// When `id` is not a triangle of this scene.
    #[inline]
    pub fn triangle_vertices(&self, id: PrimitiveId) -> [glam::DVec3; 3] {
        let instance = &self.instances[id.instance as usize];
        let mesh = &self.meshes[instance.mesh.0 as usize];
        mesh.triangle_vertices(id.primitive).map(|p| instance.to_world(p))
    }

    /// The bounding box of everything finite: spheres and instances, not planes.
    pub fn bounds(&self) -> Bounds {
        self.bounds_with(&self.mesh_bounds())
    }

    /// The bounding box of each mesh, in its own space; this visits every triangle.
    pub fn mesh_bounds(&self) -> Vec<Bounds> {
        self.meshes.iter().map(|mesh| mesh.bounds()).collect()
    }

    /// The box of [`Scene::bounds`], given the boxes of the meshes.
    ///
    /// # Panics
    /// When a mesh that has an instance has no box.
    pub fn bounds_with(&self, mesh_bounds: &[Bounds]) -> Bounds {
        let spheres = self.spheres.iter().map(Sphere::bounds);
        let instance = |i: &Instance| mesh_bounds[i.mesh.0 as usize].transformed(&i.transform);
        spheres.chain(self.instances.iter().map(instance)).fold(Bounds::EMPTY, Bounds::union)
    }

    /// The number of primitives that acceleration structures hold: spheres, instances, and the
    /// triangles of each mesh.
    pub(crate) fn primitive_count(&self) -> u64 {
        let triangles: usize = self.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        (triangles + self.spheres.len() + self.instances.len()) as u64
    }

    /// The number of triangles that rays can hit, counted for each instance of a mesh.
    pub fn triangle_count(&self) -> u64 {
        self.instances.iter().map(|i| self.meshes[i.mesh.0 as usize].triangles.len() as u64).sum()
    }
}
