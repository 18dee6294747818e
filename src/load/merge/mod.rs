//! The merging of a model's scene into another scene, in which it can have any number of instances.

mod animation;

use glam::{DAffine3, DVec3};

use self::animation::InstanceAnimation;
use crate::geometry::Bounds;
use crate::scene::animation::{Animation, NodeId};
use crate::scene::{
    Camera, Instance, Light, LightKind, Material, MaterialId, Plane, Scene, Sphere,
};

/// A model whose meshes, materials and textures are in a scene, where it can have any number of
/// instances without being stored again.
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
    /// The box around all of it, its lights and cameras too, in its own space.
    bounds: Bounds,
}

/// The parameters of an instance of a model.
#[derive(Clone, Copy, Debug)]
pub struct ModelInstance {
    /// The transform from the model's space to the world's, or to that of `node`; invertible.
    pub transform: DAffine3,
    /// The space that it moves with, into which `transform` leads; none for the world.
    pub node: Option<NodeId>,
    /// The material that replaces all of the model's own.
    pub material: Option<MaterialId>,
    /// True if the instance casts shadows.
    pub casts_shadow: bool,
    /// True if the model's own lights shine.
    pub has_lights: bool,
}

impl MergedModel {
    /// Merges what a model is made of into a scene; nothing of it is seen before it has an instance.
    ///
    /// The model's film is dropped.
    pub fn merge(scene: &mut Scene, mut model: Scene) -> Self {
        if scene.animation.is_none() {
            // What is flat as the file places it would be there at another time only.
            model.instances.retain(|instance| !instance.is_flat());
        }
        let bounds = bounds(&model);
        // Everything that has an index in the model gets that of the scene.
        let first_texture = scene.textures.len() as u32;
        let first_material = scene.materials.len() as u32;
        let first_mesh = scene.meshes.len();
        for texture in model.materials.iter_mut().flat_map(Material::textures_mut) {
            texture.0 += first_texture;
        }
        for instance in &mut model.instances {
            instance.mesh.0 += first_mesh as u32;
            instance.material.0 += first_material;
        }
        model.spheres.iter_mut().for_each(|sphere| sphere.material.0 += first_material);
        model.planes.iter_mut().for_each(|plane| plane.material.0 += first_material);
        // What instances share is stored in the scene, the rest is kept to be instantiated.
        scene.textures.append(&mut model.textures);
        scene.meshes.append(&mut model.meshes);
        scene.materials.append(&mut model.materials);
        let Scene { instances, spheres, planes, lights, cameras, animation, .. } = model;
        Self { instances, spheres, planes, lights, cameras, animation, first_mesh, bounds }
    }

    /// Returns the number of objects that each instance adds to a scene.
    pub fn object_count(&self) -> u64 {
        let moving = self.animation.as_ref().map_or(0, |a| a.nodes.len() + a.objects.len());
        (self.instances.len() + self.lights.len() + self.cameras.len() + moving) as u64
    }

    /// Returns a bound on the coordinates of an instance with this transform.
    pub fn max_coordinate(&self, transform: &DAffine3) -> f64 {
        self.bounds.transformed(transform).max_abs()
    }

    /// Adds an instance of the model to the scene that it was merged into. The model's own animation
    /// is played where the scene has one. `warnings` gets a sentence for all that cannot be as the model
    /// has it.
    pub fn instantiate(
        &self,
        scene: &mut Scene,
        instance: &ModelInstance,
        warnings: &mut Vec<String>,
    ) {
        let transform = &instance.transform;
        let mut indices = SceneIndices {
            first_instance: scene.instances.len(),
            first_sphere: scene.spheres.len(),
            first_light: scene.lights.len(),
            cameras: Vec::with_capacity(self.cameras.len()),
        };
        self.add_spheres(scene, instance, warnings);
        self.add_planes(scene, instance, warnings);
        // Meshes, lights and cameras.
        scene.instances.extend(self.instances.iter().map(|own| Instance {
            transform: *transform * own.transform,
            material: instance.material.unwrap_or(own.material),
            casts_shadow: instance.casts_shadow && own.casts_shadow,
            mesh: own.mesh,
        }));
        if instance.has_lights {
            scene.lights.extend(self.lights.iter().map(|light| light.transformed(transform)));
        }
        for camera in &self.cameras {
            let placed = camera.transformed(transform);
            indices.cameras.push(placed.is_some().then_some(scene.cameras.len()));
            if placed.is_none() {
                warnings.push(format!(
                    "the model's camera `{}` is left out: its scale leaves it no upward direction",
                    camera.name
                ));
            }
            scene.cameras.extend(placed);
        }
        // The animation of all of them.
        if let Some(animation) = &mut scene.animation {
            InstanceAnimation { model: self, instance, indices: &indices, animation }.add();
        }
    }

    /// Adds the spheres of an instance. They stay spheres: where they are scaled unevenly they get
    /// the mean scale, with a warning.
    fn add_spheres(&self, scene: &mut Scene, instance: &ModelInstance, warnings: &mut Vec<String>) {
        let transform = &instance.transform;
        let axes = [0, 1, 2].map(|i| transform.matrix3.col(i).length());
        let mean = transform.matrix3.determinant().abs().cbrt();
        let is_uneven = axes.iter().any(|axis| (axis - mean).abs() > 1e-6 * mean);
        if is_uneven && !self.spheres.is_empty() {
            let count = self.spheres.len();
            warnings.push(format!(
                "{count} spheres of a model that is scaled unevenly stay spheres, of its mean scale"
            ));
        }
        scene.spheres.extend(self.spheres.iter().map(|sphere| Sphere {
            center: transform.transform_point3(sphere.center),
            radius: sphere.radius * mean,
            material: instance.material.unwrap_or(sphere.material),
            casts_shadow: instance.casts_shadow && sphere.casts_shadow,
        }));
    }

    /// Adds the planes of an instance, which do not move with it.
    fn add_planes(&self, scene: &mut Scene, instance: &ModelInstance, warnings: &mut Vec<String>) {
        let transform = &instance.transform;
        if instance.node.is_some() && !self.planes.is_empty() {
            warnings.push("planes of a model that moves stand still".to_owned());
        }
        let cofactors = transform.matrix3.inverse().transpose();
        scene.planes.extend(self.planes.iter().map(|plane| Plane {
            point: transform.transform_point3(plane.point),
            normal: (cofactors * plane.normal).try_normalize().unwrap_or(DVec3::Y),
            material: instance.material.unwrap_or(plane.material),
            casts_shadow: instance.casts_shadow && plane.casts_shadow,
            ..*plane
        }));
    }
}

/// The indices in the scene of the objects of an instance of a model.
struct SceneIndices {
    first_instance: usize,
    first_sphere: usize,
    first_light: usize,
    /// The index of each camera; none for one that is left out.
    cameras: Vec<Option<usize>>,
}

/// Returns the box around a model, its lights and cameras too.
fn bounds(model: &Scene) -> Bounds {
    let lights = model.lights.iter().filter_map(|light| match light.kind {
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } => Some(position),
        LightKind::Ambient | LightKind::Directional { .. } => None,
    });
    let cameras = model.cameras.iter().map(|camera| camera.position);
    model.bounds().union(Bounds::from_points(lights.chain(cameras)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Falloff, Image, Mesh, MeshId, Projection, Shadow, Texture, TextureId};
    use glam::{DMat3, DVec3, Vec3};
    use std::sync::Arc;

    /// One triangle with a textured material, a spot light and a camera.
    fn model() -> Scene {
        let mut model = Scene::default();
        let image = Image::from_bytes("", [1, 1], vec![[9; 4]]);
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

    fn instance(transform: DAffine3) -> ModelInstance {
        ModelInstance {
            transform,
            node: None,
            material: None,
            casts_shadow: true,
            has_lights: true,
        }
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
        let merged = MergedModel::merge(&mut scene, model());
        merged.instantiate(&mut scene, &instance(DAffine3::IDENTITY), &mut Vec::new());
        let second = &scene.instances[1];
        assert_eq!((second.mesh, second.material), (MeshId(1), MaterialId(1)));
        assert_eq!(scene.materials[1].diffuse_map, Some(TextureId(1)));
        scene.check().unwrap();
    }

    #[test]
    fn two_instances_share_one_mesh() {
        let mut scene = Scene::default();
        let merged = MergedModel::merge(&mut scene, model());
        merged.instantiate(&mut scene, &instance(DAffine3::IDENTITY), &mut Vec::new());
        merged.instantiate(&mut scene, &instance(turned()), &mut Vec::new());
        assert_eq!((scene.meshes.len(), scene.materials.len(), scene.textures.len()), (1, 1, 1));
        assert_eq!((scene.instances.len(), scene.lights.len(), scene.cameras.len()), (2, 2, 2));
        scene.check().unwrap();
    }

    #[test]
    fn a_model_without_an_instance_is_not_seen() {
        let mut scene = Scene::default();
        MergedModel::merge(&mut scene, model());
        assert!(scene.instances.is_empty() && scene.lights.is_empty() && scene.cameras.is_empty());
    }

    #[test]
    fn the_instances_transform_comes_after_the_models_own() {
        let mut scene = Scene::default();
        MergedModel::merge(&mut scene, model()).instantiate(
            &mut scene,
            &instance(turned()),
            &mut Vec::new(),
        );
        // (1, 0, 0) by the model, then turned to y, doubled and moved.
        assert_eq!(scene.instances[0].to_world([0.0; 3]), DVec3::new(10.0, 2.0, 0.0));
    }

    #[test]
    fn a_light_moves_and_turns_and_keeps_its_strength() {
        let mut scene = Scene::default();
        MergedModel::merge(&mut scene, model()).instantiate(
            &mut scene,
            &instance(turned()),
            &mut Vec::new(),
        );
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
        let dark = ModelInstance { has_lights: false, ..instance(DAffine3::IDENTITY) };
        MergedModel::merge(&mut scene, model()).instantiate(&mut scene, &dark, &mut Vec::new());
        assert!(scene.lights.is_empty());
    }

    #[test]
    fn an_instances_material_replaces_the_models_own() {
        let mut scene = Scene::default();
        let gold = scene.add_material(Material::default());
        let golden = ModelInstance { material: Some(gold), ..instance(DAffine3::IDENTITY) };
        MergedModel::merge(&mut scene, model()).instantiate(&mut scene, &golden, &mut Vec::new());
        assert_eq!(scene.instances[0].material, gold);
    }

    #[test]
    fn shadows_are_cast_unless_the_model_or_its_instance_says_no() {
        let casts = |model_casts: bool, casts_shadow: bool| {
            let (mut scene, mut model) = (Scene::default(), model());
            model.instances[0].casts_shadow = model_casts;
            let instance = ModelInstance { casts_shadow, ..instance(DAffine3::IDENTITY) };
            MergedModel::merge(&mut scene, model).instantiate(
                &mut scene,
                &instance,
                &mut Vec::new(),
            );
            scene.instances[0].casts_shadow
        };
        let all = [casts(true, true), casts(true, false), casts(false, true)];
        assert_eq!(all, [true, false, false]);
    }

    #[test]
    fn a_camera_goes_with_its_model_and_sees_as_much_of_it() {
        let mut scene = Scene::default();
        MergedModel::merge(&mut scene, model()).instantiate(
            &mut scene,
            &instance(turned()),
            &mut Vec::new(),
        );
        let camera = &scene.cameras[0];
        assert_eq!(camera.position, DVec3::new(10.0, 0.0, 2.0));
        assert_eq!((camera.forward, camera.up), (-DVec3::Z, -DVec3::X));
        assert_eq!(camera.projection, Projection::OrthoHeight(4.0));
    }

    #[test]
    fn a_camera_in_a_mirrored_model_is_no_mirror() {
        let mut scene = Scene::default();
        let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        MergedModel::merge(&mut scene, model()).instantiate(
            &mut scene,
            &instance(mirror),
            &mut Vec::new(),
        );
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
        MergedModel::merge(&mut scene, model).instantiate(
            &mut scene,
            &instance(flat),
            &mut warnings,
        );
        assert_eq!((scene.cameras.len(), warnings.len()), (0, 1));
    }
}
