//! Placing a model's scene within another one.

mod animation;
mod shapes;

use glam::DAffine3;

use crate::geometry::Bounds;
use crate::scene::animation::{Animation, NodeId};
use crate::scene::{Camera, Instance, Light, LightKind, MaterialId, MeshId, Plane, Scene, Sphere};

/// A model whose meshes, materials and textures are in a scene, where it can be placed any number
/// of times without being stored again.
#[derive(Debug)]
pub struct MergedModel {
    instances: Vec<Instance>,
    spheres: Vec<Sphere>,
    planes: Vec<Plane>,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
    animation: Option<Animation>,
    /// The index in the scene of its first mesh.
    first_mesh: usize,
    /// Around all of it, its lights and cameras too, before it is placed.
    bounds: Bounds,
}

/// How a model is to stand.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// From the model's space to the world's, or to that of `node`; invertible.
    pub transform: DAffine3,
    /// The space that it moves with, in which `transform` places it; none for the world.
    pub node: Option<NodeId>,
    /// A material for all of it, in place of its own.
    pub material: Option<MaterialId>,
    /// Whether it keeps light from what lies behind it.
    pub casts_shadow: bool,
    /// Whether its own lights shine.
    pub lights: bool,
}

impl MergedModel {
    /// Adds what a model is made of to a scene; nothing of it is seen before it is placed.
    ///
    /// The model's film is dropped.
    pub fn add(scene: &mut Scene, mut model: Scene) -> Self {
        if scene.animation.is_none() {
            // What is flat as the file places it would be there at another time only.
            model.instances.retain(|instance| !instance.is_flat());
        }
        let bounds = bounds(&model);
        let first_texture = scene.textures.len() as u32;
        let first_material = scene.materials.len() as u32;
        let first_mesh = scene.meshes.len() as u32;
        scene.textures.extend(model.textures);
        scene.meshes.append(&mut model.meshes);
        scene.materials.extend(model.materials.into_iter().map(|mut material| {
            material.textures_mut().for_each(|texture| texture.0 += first_texture);
            material
        }));
        let mut instances = model.instances;
        for instance in &mut instances {
            instance.mesh = MeshId(instance.mesh.0 + first_mesh);
            instance.material = MaterialId(instance.material.0 + first_material);
        }
        let (mut spheres, mut planes) = (model.spheres, model.planes);
        spheres.iter_mut().for_each(|s| s.material.0 += first_material);
        planes.iter_mut().for_each(|p| p.material.0 += first_material);
        let (lights, cameras) = (model.lights, model.cameras);
        let first_mesh = first_mesh as usize;
        let animation = model.animation;
        Self { instances, spheres, planes, lights, cameras, animation, first_mesh, bounds }
    }

    /// How many things are added to a scene each time that the model is placed.
    pub fn count(&self) -> u64 {
        let moving = self.animation.as_ref().map_or(0, |a| a.nodes.len() + a.movers.len());
        (self.instances.len() + self.lights.len() + self.cameras.len() + moving) as u64
    }

    /// How far from the origin something of it may be once it is placed.
    pub fn reach(&self, transform: &DAffine3) -> f64 {
        self.bounds.transformed(transform).max_abs()
    }

    /// Places the model in the scene that it was added to. Its own animation is played where the
    /// scene has one. What cannot be placed as it should be is added to `warnings`.
    pub fn place(&self, scene: &mut Scene, placement: &Placement, warnings: &mut Vec<String>) {
        let transform = &placement.transform;
        let first = Firsts {
            instance: scene.instances.len(),
            sphere: scene.spheres.len(),
            light: scene.lights.len(),
        };
        self.place_shapes(scene, placement, warnings);
        scene.instances.extend(self.instances.iter().map(|instance| Instance {
            transform: *transform * instance.transform,
            material: placement.material.unwrap_or(instance.material),
            casts_shadow: placement.casts_shadow && instance.casts_shadow,
            mesh: instance.mesh,
        }));
        if placement.lights {
            scene.lights.extend(self.lights.iter().map(|light| light.placed(transform)));
        }
        // A camera that is left out has no index.
        let mut cameras = Vec::with_capacity(self.cameras.len());
        for camera in &self.cameras {
            match camera.placed(transform) {
                Some(placed) => {
                    cameras.push(Some(scene.cameras.len()));
                    scene.cameras.push(placed);
                }
                None => {
                    cameras.push(None);
                    warnings.push(format!(
                        "the model's camera `{}` is left out: its scale leaves it no upward \
                         direction",
                        camera.name
                    ));
                }
            }
        }
        if let Some(mut animation) = scene.animation.take() {
            self.animate(&mut animation, placement, &first, &cameras);
            scene.animation = Some(animation);
        }
    }
}

/// The indices in the scene of a placed model's first objects.
struct Firsts {
    instance: usize,
    sphere: usize,
    light: usize,
}

fn bounds(model: &Scene) -> Bounds {
    let lights = model.lights.iter().filter_map(|light| match light.kind {
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } => Some(position),
        LightKind::Ambient | LightKind::Directional { .. } => None,
    });
    let cameras = model.cameras.iter().map(|camera| camera.position);
    model.bounds().union(Bounds::of(lights.chain(cameras)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Falloff, Image, Material, Mesh, Projection, Shadow, Texture, TextureId};
    use glam::{DMat3, DVec3, Vec3};
    use std::sync::Arc;

    /// One triangle with a textured material, a spot light and a camera.
    fn model() -> Scene {
        let mut model = Scene::default();
        let image = Image::bytes("", [1, 1], vec![[9; 4]]);
        let texture = model.add_texture(Texture::new(Arc::new(image)));
        let material = Material { diffuse_map: Some(texture), ..Material::default() };
        let material = model.add_material(material);
        let mesh = model.add_mesh(Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        });
        model.instances.push(Instance::new(mesh, DAffine3::from_translation(DVec3::X), material));
        model.lights.push(Light {
            name: "lamp".to_owned(),
            kind: LightKind::Spot {
                position: DVec3::X,
                direction: DVec3::X,
                falloff: Falloff::InverseSquare,
                range: 5.0,
                inner_angle: 0.1,
                outer_angle: 0.2,
            },
            intensity: Vec3::ONE,
            shadow: Shadow::default(),
        });
        let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, Projection::OrthoHeight(2.0));
        model.cameras.push(camera.unwrap());
        model
    }

    fn placed(transform: DAffine3) -> Placement {
        Placement { transform, node: None, material: None, casts_shadow: true, lights: true }
    }

    /// A quarter turn about z, twice as large, moved by 10 along x.
    fn turned() -> DAffine3 {
        DAffine3 {
            matrix3: DMat3::from_cols(DVec3::Y * 2.0, DVec3::X * -2.0, DVec3::Z * 2.0),
            translation: DVec3::X * 10.0,
        }
    }

    #[test]
    fn indices_are_moved_past_what_the_scene_has() {
        let mut scene = model();
        let part = MergedModel::add(&mut scene, model());
        part.place(&mut scene, &placed(DAffine3::IDENTITY), &mut Vec::new());
        let instance = &scene.instances[1];
        assert_eq!((instance.mesh, instance.material), (MeshId(1), MaterialId(1)));
        assert_eq!(scene.materials[1].diffuse_map, Some(TextureId(1)));
        scene.check().unwrap();
    }

    #[test]
    fn placing_twice_stores_the_mesh_once() {
        let mut scene = Scene::default();
        let part = MergedModel::add(&mut scene, model());
        part.place(&mut scene, &placed(DAffine3::IDENTITY), &mut Vec::new());
        part.place(&mut scene, &placed(turned()), &mut Vec::new());
        assert_eq!((scene.meshes.len(), scene.materials.len(), scene.textures.len()), (1, 1, 1));
        assert_eq!((scene.instances.len(), scene.lights.len(), scene.cameras.len()), (2, 2, 2));
        scene.check().unwrap();
    }

    #[test]
    fn a_part_that_is_not_placed_is_not_seen() {
        let mut scene = Scene::default();
        MergedModel::add(&mut scene, model());
        assert!(scene.instances.is_empty() && scene.lights.is_empty() && scene.cameras.is_empty());
    }

    #[test]
    fn the_placement_comes_after_the_models_own_transform() {
        let mut scene = Scene::default();
        MergedModel::add(&mut scene, model()).place(&mut scene, &placed(turned()), &mut Vec::new());
        // (1, 0, 0) by the model, then turned to y, doubled and moved.
        assert_eq!(scene.instances[0].to_world([0.0; 3]), DVec3::new(10.0, 2.0, 0.0));
    }

    #[test]
    fn a_light_moves_and_turns_and_keeps_its_strength() {
        let mut scene = Scene::default();
        MergedModel::add(&mut scene, model()).place(&mut scene, &placed(turned()), &mut Vec::new());
        let light = &scene.lights[0];
        let LightKind::Spot { position, direction, range, .. } = light.kind else {
            panic!("a spot");
        };
        assert_eq!((position, direction), (DVec3::new(10.0, 2.0, 0.0), DVec3::Y));
        assert_eq!((range, light.intensity), (5.0, Vec3::ONE));
    }

    #[test]
    fn lights_can_be_left_out() {
        let mut scene = Scene::default();
        let dark = Placement { lights: false, ..placed(DAffine3::IDENTITY) };
        MergedModel::add(&mut scene, model()).place(&mut scene, &dark, &mut Vec::new());
        assert!(scene.lights.is_empty());
    }

    #[test]
    fn a_material_can_be_put_in_place_of_the_models_own() {
        let mut scene = Scene::default();
        let gold = scene.add_material(Material::default());
        let golden = Placement { material: Some(gold), ..placed(DAffine3::IDENTITY) };
        MergedModel::add(&mut scene, model()).place(&mut scene, &golden, &mut Vec::new());
        assert_eq!(scene.instances[0].material, gold);
    }

    #[test]
    fn shadows_are_cast_unless_the_model_or_its_placement_says_no() {
        let casts = |model_casts: bool, casts_shadow: bool| {
            let (mut scene, mut model) = (Scene::default(), model());
            model.instances[0].casts_shadow = model_casts;
            let placement = Placement { casts_shadow, ..placed(DAffine3::IDENTITY) };
            MergedModel::add(&mut scene, model).place(&mut scene, &placement, &mut Vec::new());
            scene.instances[0].casts_shadow
        };
        let all = [casts(true, true), casts(true, false), casts(false, true)];
        assert_eq!(all, [true, false, false]);
    }

    #[test]
    fn a_camera_goes_with_its_model_and_sees_as_much_of_it() {
        let mut scene = Scene::default();
        MergedModel::add(&mut scene, model()).place(&mut scene, &placed(turned()), &mut Vec::new());
        let camera = &scene.cameras[0];
        assert_eq!(camera.position, DVec3::new(10.0, 0.0, 2.0));
        assert_eq!((camera.forward, camera.up), (-DVec3::Z, -DVec3::X));
        assert_eq!(camera.lens, Projection::OrthoHeight(4.0));
    }

    #[test]
    fn a_camera_in_a_mirrored_model_is_no_mirror() {
        let mut scene = Scene::default();
        let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        MergedModel::add(&mut scene, model()).place(&mut scene, &placed(mirror), &mut Vec::new());
        let camera = &scene.cameras[0];
        assert_eq!(camera.right.cross(camera.forward), camera.up);
        scene.check().unwrap();
    }

    #[test]
    fn a_camera_that_loses_its_up_is_a_warning() {
        let (mut scene, mut model) = (Scene::default(), model());
        let tilted = Camera::look_at(DVec3::Z, DVec3::Y, DVec3::Y, Projection::FovY(1.0)).unwrap();
        model.cameras = vec![tilted];
        let flat = DAffine3::from_scale(DVec3::new(1.0, 1e-12, 1.0));
        let mut warnings = Vec::new();
        MergedModel::add(&mut scene, model).place(&mut scene, &placed(flat), &mut warnings);
        assert_eq!((scene.cameras.len(), warnings.len()), (0, 1));
    }
}
