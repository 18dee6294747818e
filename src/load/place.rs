//! Placing a model's scene within another one.

use glam::{DAffine3, DVec3};

use crate::scene::{
    Camera, Instance, Lens, Light, LightKind, MaterialId, MeshId, Scene, TextureId,
};

/// A model whose meshes, materials and textures are in a scene, where it can be placed any number
/// of times without being stored again.
#[derive(Debug)]
pub struct Part {
    instances: Vec<Instance>,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
}

/// How a model is to stand.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// From the model's space to the world's; invertible.
    pub transform: DAffine3,
    /// A material for all of it, in place of its own.
    pub material: Option<MaterialId>,
    /// Whether it keeps light from what lies behind it.
    pub casts_shadow: bool,
    /// Whether its own lights shine.
    pub lights: bool,
}

impl Part {
    /// Adds what a model is made of to a scene; nothing of it is seen before it is placed.
    ///
    /// The model's film and warnings are dropped, and so are spheres and planes, which no model
    /// file has.
    pub fn add(scene: &mut Scene, model: Scene) -> Self {
        let first_texture = scene.textures.len() as u32;
        let first_material = scene.materials.len() as u32;
        let first_mesh = scene.meshes.len() as u32;
        scene.textures.extend(model.textures);
        scene.meshes.extend(model.meshes);
        scene.materials.extend(model.materials.into_iter().map(|mut material| {
            for map in [&mut material.diffuse_map, &mut material.emission_map] {
                *map = map.map(|texture| TextureId(texture.0 + first_texture));
            }
            material
        }));
        let mut instances = model.instances;
        for instance in &mut instances {
            instance.mesh = MeshId(instance.mesh.0 + first_mesh);
            instance.material = MaterialId(instance.material.0 + first_material);
        }
        Self { instances, lights: model.lights, cameras: model.cameras }
    }

    /// Places the model in the scene that it was added to.
    pub fn place(&self, scene: &mut Scene, placement: &Placement) {
        let transform = &placement.transform;
        scene.instances.extend(self.instances.iter().map(|instance| Instance {
            transform: *transform * instance.transform,
            material: placement.material.unwrap_or(instance.material),
            casts_shadow: placement.casts_shadow && instance.casts_shadow,
            mesh: instance.mesh,
        }));
        if placement.lights {
            scene.lights.extend(self.lights.iter().map(|light| place_light(light, transform)));
        }
        for camera in &self.cameras {
            match place_camera(camera, transform) {
                Some(placed) => scene.cameras.push(placed),
                None => scene.warnings.push(format!(
                    "the model's camera `{}` is left out: its scale leaves it no upward direction",
                    camera.name
                )),
            }
        }
    }
}

/// Moves and turns a light. Its intensity and its range stay as they are under any scale, as
/// KHR_lights_punctual has it.
fn place_light(light: &Light, transform: &DAffine3) -> Light {
    let turned = |v: DVec3| transform.transform_vector3(v).normalize();
    let mut light = light.clone();
    match &mut light.kind {
        LightKind::Ambient => {}
        LightKind::Directional { direction } => *direction = turned(*direction),
        LightKind::Point { position, .. } => *position = transform.transform_point3(*position),
        LightKind::Spot { position, direction, .. } => {
            *position = transform.transform_point3(*position);
            *direction = turned(*direction);
        }
    }
    light
}

/// Moves and turns a camera, so that it sees the placed model as it saw the model; only a mirror
/// or a shear it does not follow. None when the transform is too uneven to leave it an up.
fn place_camera(camera: &Camera, transform: &DAffine3) -> Option<Camera> {
    let forward = transform.transform_vector3(camera.forward).try_normalize()?;
    let up = transform.transform_vector3(camera.up);
    let lens = match camera.lens {
        Lens::OrthoHeight(height) => Lens::OrthoHeight(height * up.length()),
        lens => lens,
    };
    let placed = Camera::look_at(DVec3::ZERO, forward, up, lens).ok()?;
    let position = transform.transform_point3(camera.position);
    Some(Camera { name: camera.name.clone(), position, ..placed })
}
