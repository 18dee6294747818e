//! The merging of a model's scene into another scene, in which it can have any number of instances.

mod animation;
#[cfg(test)]
mod tests;

use glam::{DAffine3, DVec3};

use self::animation::InstanceAnimation;
use crate::geometry::Bounds;
use crate::scene::animation::NodeId;
use crate::scene::{Instance, Light, Material, MaterialId, ObjectProvenance, Plane, Scene, Sphere};

/// A model whose meshes, materials and textures are in a scene, where it can have any number of
/// instances without being stored again.
#[derive(Debug)]
pub struct MergedModel {
    /// The objects that each instance gets: all but meshes, materials and textures.
    model: Scene,
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
    /// The provenance of the instance: its table, if that is recorded.
    pub provenance: ObjectProvenance,
}

impl MergedModel {
    /// Merges what a model is made of into a scene; nothing of it is seen before it has an instance.
    ///
    /// The model's film is dropped.
    pub fn merge(scene: &mut Scene, mut model: Scene) -> Self {
        if scene.animation.is_none() {
            // What is flat as the file places it would be there at another time only.
            model.retain_instances(|instance| !instance.is_flat());
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
        if let (Some(all), Some(own)) = (scene.provenance_mut(), model.provenance_mut()) {
            all.merge(own);
        }
        Self { model, first_mesh, bounds }
    }

    /// Returns the number of objects that each instance adds to a scene.
    pub fn object_count(&self) -> u64 {
        let Scene { instances, lights, cameras, animation, .. } = &self.model;
        let moving = animation.as_ref().map_or(0, |a| a.nodes.len() + a.objects.len());
        (instances.len() + lights.len() + cameras.len() + moving) as u64
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
        // The animation refers to the objects of this instance by their indices in the scene.
        let mut indices = SceneIndices {
            first_instance: scene.instances.len(),
            first_sphere: scene.spheres.len(),
            first_light: scene.lights.len(),
            cameras: Vec::with_capacity(self.model.cameras.len()),
        };
        self.add_spheres(scene, instance, warnings);
        self.add_planes(scene, instance, warnings);

        // Meshes, lights and cameras.
        scene.instances.extend(self.model.instances.iter().map(|own| Instance {
            transform: *transform * own.transform,
            material: instance.material.unwrap_or(own.material),
            casts_shadow: instance.casts_shadow && own.casts_shadow,
            mesh: own.mesh,
        }));
        if instance.has_lights {
            scene.lights.extend(self.model.lights.iter().map(|light| light.transformed(transform)));
        }
        for camera in &self.model.cameras {
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

        if let (Some(all), Some(own)) = (scene.provenance_mut(), &self.model.provenance) {
            all.instantiate(own, instance.provenance);
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
        // The mean scale is that which keeps the volume.
        let axes = [0, 1, 2].map(|i| transform.matrix3.col(i).length());
        let mean = transform.matrix3.determinant().abs().cbrt();
        let is_uneven = axes.iter().any(|axis| (axis - mean).abs() > 1e-6 * mean);
        if is_uneven && !self.model.spheres.is_empty() {
            let count = self.model.spheres.len();
            warnings.push(format!(
                "{count} spheres of a model that is scaled unevenly stay spheres, of its mean scale"
            ));
        }
        scene.spheres.extend(self.model.spheres.iter().map(|sphere| Sphere {
            center: transform.transform_point3(sphere.center),
            radius: sphere.radius * mean,
            material: instance.material.unwrap_or(sphere.material),
            casts_shadow: instance.casts_shadow && sphere.casts_shadow,
        }));
    }

    /// Adds the planes of an instance, which do not move with it.
    fn add_planes(&self, scene: &mut Scene, instance: &ModelInstance, warnings: &mut Vec<String>) {
        let transform = &instance.transform;
        if instance.node.is_some() && !self.model.planes.is_empty() {
            warnings.push("planes of a model that moves stand still".to_owned());
        }
        // Normals are transformed by the inverse transpose, so that they stay perpendicular.
        let cofactors = transform.matrix3.inverse().transpose();
        scene.planes.extend(self.model.planes.iter().map(|plane| Plane {
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
    let lights = model.lights.iter().filter_map(Light::position);
    let cameras = model.cameras.iter().map(|camera| camera.position);
    model.bounds().union(Bounds::from_points(lights.chain(cameras)))
}
