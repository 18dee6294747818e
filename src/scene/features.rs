//! What work a scene needs, and why the rest can be left out.

use glam::Vec3;

use crate::scene::{Image, Material, Mesh, Scene, TextureId};

/// A kind of work that not every scene needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Feature {
    /// A geometry of spheres, which every ray is tried against.
    Spheres,
    /// Spaces of their own for meshes.
    Instances,
    /// Planes, which every ray is tried against.
    Planes,
    /// Reading and decoding pictures.
    Pictures,
    /// Texture coordinates.
    Uv,
    /// How much of a picture each ray sees.
    Mipmaps,
    /// Normals from pictures.
    NormalMaps,
    /// Alpha, where a mask cuts holes into a mesh.
    AlphaTests,
    /// Checkers on planes.
    Checkers,
    /// Colours of vertices.
    VertexColors,
    /// Normals of vertices.
    SmoothNormals,
    /// Phong's highlights.
    Highlights,
    /// Rays to lights.
    Shadows,
    /// Rays off mirrors and glass.
    Reflection,
    /// Rays through glass, and the bodies that they are in.
    Refraction,
}

impl Feature {
    /// All kinds, in the order in which they are listed.
    pub const ALL: [Self; 15] = [
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
    ];

    /// What it is called in flags and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Spheres => "spheres",
            Self::Instances => "instances",
            Self::Planes => "planes",
            Self::Pictures => "pictures",
            Self::Uv => "uv",
            Self::Mipmaps => "mipmaps",
            Self::NormalMaps => "normal-maps",
            Self::AlphaTests => "alpha-tests",
            Self::Checkers => "checkers",
            Self::VertexColors => "vertex-colors",
            Self::SmoothNormals => "smooth-normals",
            Self::Highlights => "highlights",
            Self::Shadows => "shadows",
            Self::Reflection => "reflection",
            Self::Refraction => "refraction",
        }
    }
}

/// What of the work a scene needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFeatures {
    /// For each kind of work, how many things need it, and of how many.
    counts: [(u64, u64); Feature::ALL.len()],
}

impl SceneFeatures {
    /// What a checked scene needs.
    pub fn from_scene(scene: &Scene) -> Self {
        let materials: Vec<&Material> = scene.materials_in_use().collect();
        let mut uses = vec![0u64; scene.meshes.len()];
        scene.instances.iter().for_each(|i| uses[i.mesh.0 as usize] += 1);
        let standing = || scene.meshes.iter().zip(&uses).filter(|(_, uses)| **uses > 0);
        let shown = images_in(scene, materials.iter().copied()).len() as u64;
        let made_of = |is: fn(&Material) -> bool| {
            (materials.iter().filter(|m| is(m)).count() as u64, materials.len() as u64)
        };
        let count = |n: usize| (n as u64, n as u64);
        let among = |some: usize, all: usize| (some as u64, all as u64);
        let meshes = standing().count();
        let counts = Feature::ALL.map(|work| match work {
            Feature::Spheres => count(scene.spheres.len()),
            Feature::Instances => among(uses.iter().filter(|&&n| n > 1).count(), meshes),
            Feature::Planes => count(scene.planes.len()),
            Feature::Pictures => (shown, images_in(scene, scene.materials.iter()).len() as u64),
            Feature::Uv => made_of(Material::is_textured),
            Feature::Mipmaps => {
                let averaged = |id: TextureId| scene.textures[id.0 as usize].mipmap;
                let some = materials.iter().filter(|m| m.textures().any(averaged)).count();
                among(some, materials.len())
            }
            Feature::NormalMaps => made_of(|m| m.normal_map.is_some()),
            Feature::AlphaTests => made_of(Material::is_masked),
            Feature::Checkers => {
                let checkers = scene.planes.iter().filter(|p| p.checker.is_some());
                among(checkers.count(), scene.planes.len())
            }
            Feature::VertexColors => {
                let has = |mesh: &Mesh| !(mesh.colors.is_empty() && mesh.alphas.is_empty());
                among(standing().filter(|(mesh, _)| has(mesh)).count(), meshes)
            }
            Feature::SmoothNormals => {
                among(standing().filter(|(mesh, _)| !mesh.normals.is_empty()).count(), meshes)
            }
            Feature::Highlights => made_of(|m| m.specular != Vec3::ZERO || m.metallic.is_some()),
            Feature::Shadows => {
                let casting = scene.lights.iter().filter(|light| light.casts_shadow());
                among(casting.count(), scene.lights.len())
            }
            Feature::Reflection => made_of(Material::spawns_rays),
            Feature::Refraction => made_of(Material::may_transmit),
        });
        Self { counts }
    }

    /// Whether the scene needs a kind of work.
    pub fn uses(&self, work: Feature) -> bool {
        self.counts[work as usize].0 > 0
    }

    /// The work that is done though the scene may have no need of it, with what it is done for.
    pub fn used(&self) -> impl Iterator<Item = (Feature, String)> {
        self.filtered(true)
    }

    /// The work that is left out, with why it may be.
    pub fn skipped(&self) -> impl Iterator<Item = (Feature, String)> {
        self.filtered(false)
    }

    fn filtered(&self, done: bool) -> impl Iterator<Item = (Feature, String)> {
        let chosen = Feature::ALL.into_iter().filter(move |&work| self.uses(work) == done);
        chosen.map(|work| (work, self.reason(work)))
    }

    /// How many things of the scene need it.
    fn reason(&self, work: Feature) -> String {
        let (some, all) = self.counts[work as usize];
        let of = |what: &str, does: &str| match all {
            0 => format!("there are no {what}"),
            _ => format!("{some} of {all} {what} {does}"),
        };
        match work {
            Feature::Spheres => of("spheres", "are user geometry"),
            Feature::Instances => of("meshes", "stand more than once"),
            Feature::Planes => of("planes", "are tried"),
            Feature::Pictures => of("pictures", "are on a material in use"),
            Feature::Uv => of("materials in use", "have a picture"),
            Feature::Mipmaps => of("materials in use", "have a picture with mipmaps"),
            Feature::NormalMaps => of("materials in use", "have a normal map"),
            Feature::AlphaTests => of("materials in use", "have a mask"),
            Feature::Checkers => of("planes", "have a checker"),
            Feature::VertexColors => of("meshes", "have colours"),
            Feature::SmoothNormals => of("meshes", "have normals"),
            Feature::Highlights => of("materials in use", "have a highlight"),
            Feature::Shadows => of("lights", "cast shadows"),
            Feature::Reflection => of("materials in use", "are mirrors or glass"),
            Feature::Refraction => of("materials in use", "let light through"),
        }
    }
}

/// The pictures that materials show, each once.
pub(in crate::scene) fn images_in<'a>(
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
    fn each_kind_has_its_own_place_and_name() {
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
