//! The features that a scene uses; work for all others is left out.

use std::sync::Arc;

use glam::Vec3;

use crate::scene::{Image, Light, Material, Mesh, Scene, TextureId};

/// A feature that not every scene uses, and that costs work where one does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Feature {
    /// Spheres, a user geometry.
    Spheres,
    /// Meshes with more than one instance.
    Instances,
    /// Planes, which every ray is tested against.
    Planes,
    /// Images, which are read and decoded.
    Pictures,
    /// Texture coordinates.
    Uv,
    /// Mipmaps, for which every ray has a footprint.
    Mipmaps,
    /// Normal maps.
    NormalMaps,
    /// Alpha tests, where a mask cuts holes into a mesh.
    AlphaTests,
    /// Checkerboards on planes.
    Checkers,
    /// Vertex colours.
    VertexColors,
    /// Smooth shading by vertex normals.
    SmoothNormals,
    /// Phong's highlights.
    Highlights,
    /// Shadow rays.
    Shadows,
    /// Reflected rays.
    Reflection,
    /// Refracted rays, and the dielectrics that they are in.
    Refraction,
    /// Back-face culling, for which the side of every hit is looked at.
    Culling,
    /// Lights with an extent, for which several samples stand.
    AreaLights,
    /// Surfaces that emit light and illuminate others, for which many samples stand.
    EmissiveLights,
    /// Physically based materials, whose BSDFs are evaluated point by point.
    Pbr,
    /// The environment.
    Environment,
}

impl Feature {
    /// All features, in the order of reports.
    pub const ALL: [Self; 20] = [
        Self::Spheres,
        Self::Instances,
        Self::Planes,
        Self::Pictures,
        Self::Uv,
        Self::Mipmaps,
        Self::NormalMaps,
        Self::AlphaTests,
        Self::Checkers,
        Self::VertexColors,
        Self::SmoothNormals,
        Self::Highlights,
        Self::Shadows,
        Self::Reflection,
        Self::Refraction,
        Self::Culling,
        Self::AreaLights,
        Self::EmissiveLights,
        Self::Pbr,
        Self::Environment,
    ];

    /// The name in reports.
    pub const fn name(self) -> &'static str {
        self.words().0
    }

    /// The words for it in reports: its name, the objects that may use it, and the predicate of those
    /// that do.
    const fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Spheres => ("spheres", "spheres", "are user geometry"),
            Self::Instances => ("instances", "meshes", "stand more than once"),
            Self::Planes => ("planes", "planes", "are tried"),
            Self::Pictures => ("pictures", "pictures", "are on a material in use"),
            Self::Uv => ("uv", "materials in use", "have a picture"),
            Self::Mipmaps => ("mipmaps", "materials in use", "have a picture with mipmaps"),
            Self::NormalMaps => ("normal-maps", "materials in use", "have a normal map"),
            Self::AlphaTests => ("alpha-tests", "materials in use", "have a mask"),
            Self::Checkers => ("checkers", "planes", "have a checker"),
            Self::VertexColors => ("vertex-colors", "meshes", "have colours"),
            Self::SmoothNormals => ("smooth-normals", "meshes", "have normals"),
            Self::Highlights => ("highlights", "materials in use", "have a highlight"),
            Self::Shadows => ("shadows", "lights", "cast shadows"),
            Self::Reflection => ("reflection", "materials in use", "are mirrors or glass"),
            Self::Refraction => ("refraction", "materials in use", "let light through"),
            Self::Culling => ("culling", "materials in use", "are one-sided"),
            Self::AreaLights => ("area-lights", "lights", "have an extent"),
            Self::EmissiveLights => ("emissive-lights", "materials in use", "illuminate"),
            Self::Pbr => ("pbr", "materials in use", "are physically based"),
            Self::Environment => ("environment", "environments", "surround the scene"),
        }
    }
}

/// The features that a scene uses; what is absent costs nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFeatures {
    usage: [Usage; Feature::ALL.len()],
}

/// The number of objects that use a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Usage {
    users: usize,
    /// The number of objects that could.
    total: usize,
}

impl Usage {
    /// Counts the objects that use a feature.
    fn count<T>(objects: &[T], uses: impl Fn(&T) -> bool) -> Self {
        Self { users: objects.iter().filter(|object| uses(object)).count(), total: objects.len() }
    }
}

impl SceneFeatures {
    /// Detects the features of a checked scene.
    pub fn from_scene(scene: &Scene) -> Self {
        // What is in use: materials that some object has, and meshes with an instance.
        let materials: Vec<&Material> = scene.materials_in_use().collect();
        let mut instances = vec![0; scene.meshes.len()];
        scene.instances.iter().for_each(|i| instances[i.mesh.0 as usize] += 1);
        let meshes = scene.meshes.iter().zip(instances).filter(|(_, count)| *count > 0);
        let (meshes, instances): (Vec<&Arc<Mesh>>, Vec<usize>) = meshes.unzip();

        // The number of these that use each feature.
        let of_materials =
            |uses: &dyn Fn(&Material) -> bool| Usage::count(&materials, |material| uses(material));
        let is_mipmapped = |id: TextureId| scene.textures[id.0 as usize].mipmap;
        let usage = Feature::ALL.map(|feature| match feature {
            Feature::Spheres => Usage::count(&scene.spheres, |_| true),
            Feature::Instances => Usage::count(&instances, |count| *count > 1),
            Feature::Planes => Usage::count(&scene.planes, |_| true),
            Feature::Pictures => Usage {
                users: images_in(scene, materials.iter().copied()).len(),
                total: images_in(scene, scene.materials.iter()).len(),
            },
            Feature::Uv => of_materials(&Material::is_textured),
            Feature::Mipmaps => of_materials(&|m| m.textures().any(is_mipmapped)),
            Feature::NormalMaps => of_materials(&|m| m.normal_map.is_some()),
            Feature::AlphaTests => of_materials(&Material::is_masked),
            Feature::Checkers => Usage::count(&scene.planes, |plane| plane.checker.is_some()),
            Feature::VertexColors => {
                Usage::count(&meshes, |m| !(m.colors.is_empty() && m.alphas.is_empty()))
            }
            Feature::SmoothNormals => Usage::count(&meshes, |mesh| !mesh.normals.is_empty()),
            Feature::Highlights => {
                of_materials(&|m| !m.is_pbr() && (m.specular != Vec3::ZERO || m.metallic.is_some()))
            }
            Feature::Shadows => Usage::count(&scene.lights, Light::casts_shadow),
            Feature::Reflection => of_materials(&Material::spawns_rays),
            Feature::Refraction => of_materials(&Material::may_transmit),
            Feature::Culling => of_materials(&|m| m.cull_back_faces),
            Feature::AreaLights => Usage::count(&scene.lights, Light::has_extent),
            Feature::EmissiveLights => of_materials(&Material::is_light),
            Feature::Pbr => of_materials(&Material::is_pbr),
            Feature::Environment => Usage::count(scene.environment.as_slice(), |_| true),
        });
        Self { usage }
    }

    /// True if the scene uses a feature.
    pub fn uses(&self, feature: Feature) -> bool {
        self.usage[feature as usize].users > 0
    }

    /// The features that the scene uses, with the number of objects that do.
    pub fn used(&self) -> impl Iterator<Item = (Feature, String)> {
        self.filtered(true)
    }

    /// The features that the scene does not use, with the reason.
    pub fn skipped(&self) -> impl Iterator<Item = (Feature, String)> {
        self.filtered(false)
    }

    /// The features that are used, or those that are not.
    fn filtered(&self, used: bool) -> impl Iterator<Item = (Feature, String)> {
        let chosen = Feature::ALL.into_iter().filter(move |&feature| self.uses(feature) == used);
        chosen.map(|feature| (feature, self.reason(feature)))
    }

    /// A sentence with the number of objects that use a feature.
    fn reason(&self, feature: Feature) -> String {
        let Usage { users, total } = self.usage[feature as usize];
        let (_, objects, predicate) = feature.words();
        if total == 0 {
            return format!("there are no {objects}");
        }
        format!("{users} of {total} {objects} {predicate}")
    }
}

/// The images of some materials, each once.
fn images_in<'a>(
    scene: &'a Scene,
    materials: impl Iterator<Item = &'a Material>,
) -> Vec<&'a Image> {
    let maps = materials.flat_map(Material::textures);
    let mut found: Vec<&Image> = maps.map(|map| &*scene.textures[map.0 as usize].image).collect();
    found.sort_by_key(|image| std::ptr::from_ref(*image));
    found.dedup_by_key(|image| std::ptr::from_ref(*image));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, Plane, Sphere};
    use glam::{DAffine3, DVec3};

    fn skipped(scene: &Scene) -> Vec<&'static str> {
        SceneFeatures::from_scene(scene).skipped().map(|(work, _)| work.name()).collect()
    }

    fn ball() -> Scene {
        let mut scene = Scene::default();
        let material = scene.add_material(Material::default());
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, material));
        scene
    }

    #[test]
    fn each_feature_has_its_own_index_and_name() {
        let mut names = std::collections::BTreeSet::new();
        for (i, work) in Feature::ALL.into_iter().enumerate() {
            assert_eq!(work as usize, i);
            assert!(names.insert(work.name()), "{}", work.name());
        }
    }

    #[test]
    fn an_empty_scene_needs_nothing() {
        assert_eq!(SceneFeatures::from_scene(&Scene::default()).used().count(), 0);
    }

    #[test]
    fn a_ball_needs_user_geometry_and_no_more() {
        let needs = SceneFeatures::from_scene(&ball());
        let done: Vec<_> = needs.used().collect();
        assert_eq!(done, [(Feature::Spheres, "1 of 1 spheres are user geometry".to_owned())]);
    }

    #[test]
    fn materials_that_nothing_is_made_of_need_nothing() {
        let mut scene = ball();
        let glass = Material { transmit: Vec3::ONE, specular: Vec3::ONE, ..Material::default() };
        let glass = scene.add_material(glass);
        assert!(skipped(&scene).contains(&"refraction"));
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, glass));
        for name in ["refraction", "reflection", "highlights", "planes"] {
            assert!(!skipped(&scene).contains(&name), "{name}");
        }
    }

    #[test]
    fn a_mesh_that_stands_twice_needs_an_instance_level() {
        let mut scene = ball();
        let mesh = scene.add_mesh(Mesh::default());
        let material = scene.spheres[0].material;
        for expected in [true, false] {
            scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
            assert_eq!(skipped(&scene).contains(&"instances"), expected);
        }
    }
}
