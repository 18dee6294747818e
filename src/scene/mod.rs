//! The scene: plain, validated data with typed indices, and nothing that parses or traces.

pub mod animation;
mod camera;
pub mod check;
mod coverage;
mod features;
mod film;
mod image;
mod light;
mod material;
mod mesh;
mod metallic;
mod mipmap;
pub mod precision_warnings;
mod shapes;
mod texels;
mod texture;
mod tone;
mod triangles;
pub mod watertight;

pub use camera::{Camera, Projection, RayGenerator};
pub use features::{Feature, SceneFeatures};
pub use film::{Adaptive, FilmSettings, SamplePosition, Transfer};
pub use image::Image;
pub use light::{Falloff, IncidentLight, Light, LightKind, Shadow};
pub use material::{
    AlphaMode, Coverage, Material, MaterialId, NormalMap, OcclusionMap, ShininessMap,
};
pub(crate) use mesh::GRAIN;
pub use mesh::{Mesh, MeshId};
pub use metallic::{Metallic, MetallicMaps, ShadingParams, sharpness, shininess};
pub use mipmap::{MipLevel, Mipmap};
pub use shapes::{Checker, Instance, Plane, Sphere};
pub use texels::{Texel, Texels};
pub use texture::{Channel, Filter, Texture, TextureId, TexturePoint, Wrap};
pub use tone::Tone;
pub use triangles::Triangles;

use std::sync::Arc;

use crate::geometry::{Bounds, Geometry, PrimitiveId};
use animation::Animation;

/// Everything that determines the picture.
///
/// What `load` returns is complete and checked. A scene built by hand is checked when a renderer
/// is made of it.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Size, samples, background and transfer of the picture.
    pub film: FilmSettings,
    /// The cameras; the first one is used unless another is asked for.
    pub cameras: Vec<Camera>,
    /// The materials that objects refer to.
    pub materials: Vec<Material>,
    /// The textures that materials refer to.
    pub textures: Vec<Texture>,
    /// The analytic spheres.
    pub spheres: Vec<Sphere>,
    /// The infinite planes.
    pub planes: Vec<Plane>,
    /// The meshes, each stored once; a scene shares them with itself at another time.
    pub meshes: Vec<Arc<Mesh>>,
    /// Where the meshes stand.
    pub instances: Vec<Instance>,
    /// The lights.
    pub lights: Vec<Light>,
    /// How the scene changes with time. What is above is the scene as its files place it;
    /// [`Scene::at`] says how it is at a time.
    pub animation: Option<Animation>,
}

impl Scene {
    /// Adds a material.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a texture.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Adds a mesh; it is seen only where an [`Instance`] of it stands.
    pub fn add_mesh(&mut self, mesh: Mesh) -> MeshId {
        self.meshes.push(Arc::new(mesh));
        MeshId(self.meshes.len() as u32 - 1)
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

    /// Whether a primitive keeps all light from what lies behind it: whether it casts a shadow, and
    /// lets nothing through.
    ///
    /// # Panics
    /// When the primitive is not one of this scene.
    #[inline(always)]
    pub fn blocks_light(&self, id: PrimitiveId) -> bool {
        let material = || self.materials.get(self.material_of(id).0 as usize);
        self.casts_shadow(id) && material().is_none_or(|m| !m.may_transmit())
    }

    /// Whether a primitive keeps light from what lies behind it, or some of it.
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

    /// The materials that anything is made of, each once.
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

    /// The corners, in world space, of the triangle that `id` names.
    ///
    /// This is the one function that bakes vertices: whoever tests a triangle in f64 tests these.
    ///
    /// # Panics
    /// When `id` is not a triangle of this scene.
    #[inline]
    pub fn triangle_vertices(&self, id: PrimitiveId) -> [glam::DVec3; 3] {
        let instance = &self.instances[id.instance as usize];
        let mesh = &self.meshes[instance.mesh.0 as usize];
        mesh.triangle_vertices(id.primitive).map(|p| instance.to_world(p))
    }

    /// The box around all that is finite: spheres and instances, not planes.
    pub fn bounds(&self) -> Bounds {
        self.bounds_with(&self.mesh_bounds())
    }

    /// The box of each mesh, in its own space. It takes a look at every triangle.
    pub fn mesh_bounds(&self) -> Vec<Bounds> {
        self.meshes.iter().map(|mesh| mesh.bounds()).collect()
    }

    /// As [`Scene::bounds`], where the boxes of the meshes are known.
    ///
    /// # Panics
    /// When a mesh that stands in the scene has no box.
    pub fn bounds_with(&self, mesh_bounds: &[Bounds]) -> Bounds {
        let spheres = self.spheres.iter().map(Sphere::bounds);
        let placed = |i: &Instance| mesh_bounds[i.mesh.0 as usize].transformed(&i.transform);
        spheres.chain(self.instances.iter().map(placed)).fold(Bounds::EMPTY, Bounds::union)
    }

    /// How many primitives trees are built of: spheres, instances, and the triangles of each mesh.
    pub(crate) fn primitive_count(&self) -> u64 {
        let triangles: usize = self.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        (triangles + self.spheres.len() + self.instances.len()) as u64
    }

    /// How many triangles a ray can meet, counting each instance of a mesh.
    pub fn triangle_count(&self) -> u64 {
        self.instances.iter().map(|i| self.meshes[i.mesh.0 as usize].triangles.len() as u64).sum()
    }
}
