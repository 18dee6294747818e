//! The scene at one time after another.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::{Aim, AimTarget, Animated, NodeId, deformation::Pose, node, prefixed};
use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::scene::{Camera, LightKind, Scene, check::check_extent};

/// An animated scene at one time after another; objects that do not move are neither copied nor
/// checked again.
#[derive(Debug)]
pub struct PosedScene<'a> {
    scene: &'a Scene,
    posed: Scene,
    /// True if instances are left out of it, since they are flat at that time.
    omits_flat: bool,
    /// The bounding boxes of the meshes; none before they are asked for and after a mesh changed.
    mesh_bounds: Vec<Option<Bounds>>,
    /// For each animated object that is a mesh, the pose that the mesh has.
    mesh_poses: Vec<Option<Pose>>,
}

impl<'a> PosedScene<'a> {
    /// The scene as its files describe it, before it is posed.
    pub fn new(scene: &'a Scene) -> Self {
        // A copy of all but the animation, which may have many keyframes.
        let posed = Scene {
            environment: scene.environment.clone(),
            film: scene.film.clone(),
            cameras: scene.cameras.clone(),
            materials: scene.materials.clone(),
            textures: scene.textures.clone(),
            spheres: scene.spheres.clone(),
            planes: scene.planes.clone(),
            meshes: scene.meshes.clone(),
            instances: scene.instances.clone(),
            lights: scene.lights.clone(),
            animation: None,
            provenance: scene.provenance.clone(),
        };
        let mesh_bounds = vec![None; scene.meshes.len()];
        Self { scene, posed, omits_flat: false, mesh_bounds, mesh_poses: Vec::new() }
    }

    /// Moves the scene to a time in seconds; see [`Scene::at_time`].
    ///
    /// # Errors
    /// When a camera then looks at its own position, or along its own up direction.
    ///
    /// # Panics
    /// When the animation was not [checked](Scene::check).
    pub fn pose(&mut self, time: f64) -> Result<&Scene> {
        let Some(animation) = &self.scene.animation else { return Ok(&self.posed) };
        // Instances that were flat at the time before come back.
        let scene = &mut self.posed;
        if std::mem::take(&mut self.omits_flat) {
            scene.instances.clone_from(&self.scene.instances);
            scene.provenance.clone_from(&self.scene.provenance);
        }

        // Every object moves with its node.
        let worlds = node::world_transforms(&animation.nodes, time);
        self.mesh_poses.resize(animation.objects.len(), None);
        for (object, mesh_pose) in animation.objects.iter().zip(&mut self.mesh_poses) {
            let Animated::Mesh { mesh, deformation } = object else {
                self.omits_flat |= pose_object(object, time, &worlds, scene)?;
                continue;
            };
            // A mesh that keeps its pose stays the same one, and so does its acceleration structure.
            let pose = deformation.pose(time, &worlds);
            if mesh_pose.as_ref() != Some(&pose) {
                scene.meshes[*mesh] = Arc::new(deformation.deform_to(&pose));
                self.mesh_bounds[*mesh] = None;
                *mesh_pose = Some(pose);
            }
        }

        // Flat instances cannot be intersected.
        if self.omits_flat {
            scene.retain_instances(|instance| !instance.is_flat());
        }
        Ok(scene)
    }

    /// Checks the objects that move, as they are now, of a scene that was [checked](Scene::check)
    /// before.
    ///
    /// # Errors
    /// The first condition that does not hold.
    pub fn check(&mut self) -> Result<()> {
        let posed = &self.posed;
        for object in self.scene.animation.iter().flat_map(|animation| &animation.objects) {
            match *object {
                Animated::Sphere { sphere, .. } => posed.check_sphere(sphere)?,
                Animated::Instance { instance, .. } if !self.omits_flat => {
                    posed.check_instance(instance, false)?;
                }
                Animated::Mesh { mesh, .. } => posed.check_mesh(mesh)?,
                Animated::Instance { .. } | Animated::Light { .. } | Animated::Camera { .. } => {}
            }
        }
        if self.omits_flat {
            // Without the flat ones, the others have other indices.
            (0..posed.instances.len()).try_for_each(|i| posed.check_instance(i, false))?;
        }
        posed.check_lights_and_cameras()?;
        check_extent(&self.bounds())
    }

    /// The bounding box of the scene as it is now.
    pub fn bounds(&mut self) -> Bounds {
        let meshes = self.posed.meshes.iter().zip(&mut self.mesh_bounds);
        let boxes: Vec<Bounds> =
            meshes.map(|(mesh, cached)| *cached.get_or_insert_with(|| mesh.bounds())).collect();
        self.posed.bounds_with(&boxes)
    }

    /// The scene as it is now.
    pub fn scene(&self) -> &Scene {
        &self.posed
    }

    /// Returns the scene as it is now.
    pub fn into_scene(self) -> Scene {
        self.posed
    }
}

/// Moves an object that is not a mesh; returns whether that made an instance flat.
fn pose_object(
    object: &Animated,
    time: f64,
    worlds: &[DAffine3],
    scene: &mut Scene,
) -> Result<bool> {
    let world =
        |node: &Option<NodeId>| node.map_or(DAffine3::IDENTITY, |node| worlds[node.0 as usize]);
    match object {
        Animated::Sphere { sphere, node, center, radius } => {
            let sphere = &mut scene.spheres[*sphere];
            sphere.center = world(node).transform_point3(*center);
            if let Some(radius) = radius {
                sphere.radius = radius.sample(time);
            }
        }
        Animated::Instance { instance, node, transform } => {
            let instance = &mut scene.instances[*instance];
            instance.transform = world(&Some(*node)) * *transform;
            return Ok(instance.is_flat());
        }
        Animated::Mesh { .. } => {}
        Animated::Light { light, node, rest, direction: curve, intensity } => {
            // Its direction and intensity change in its own space, which then moves.
            let mut rest = rest.clone();
            if let LightKind::Directional { direction, .. } | LightKind::Spot { direction, .. } =
                &mut rest.kind
                && let Some(curve) = curve
            {
                // Halfway between opposite directions the curve has length 0.
                *direction = curve.sample(time).try_normalize().unwrap_or(*direction);
            }
            if let Some(intensity) = intensity {
                rest.intensity *= intensity.sample(time) as f32;
            }
            scene.lights[*light] = rest.transformed(&world(node));
        }
        Animated::Camera { camera, node, rest, aim, lens } => {
            let posed = pose_camera(&world(node), rest, aim.as_ref(), worlds, time);
            let posed = posed.map_err(|e| {
                let name = match &*rest.name {
                    "" => camera.to_string(),
                    name => format!("`{name}`"),
                };
                prefixed(&format!("at {time:.3} s, camera {name}"), &e)
            })?;
            let zoomed = lens.as_ref().map(|lens| rest.projection.with_value(lens.sample(time)));
            let projection = zoomed.unwrap_or(rest.projection);
            scene.cameras[*camera] = Camera { projection, ..posed };
        }
    }
    Ok(false)
}

/// The camera in world space, looking at its aim if it has one.
fn pose_camera(
    world: &DAffine3,
    rest: &Camera,
    aim: Option<&Aim>,
    worlds: &[DAffine3],
    time: f64,
) -> Result<Camera> {
    let Some(Aim { target, up }) = aim else {
        return rest.transformed(world).ok_or_else(|| {
            Error::input("its transform is too uneven to leave it an upward direction")
        });
    };
    // The position moves with the node; the direction is toward the aim.
    let position = world.transform_point3(rest.position);
    let forward = match target {
        AimTarget::Anchor(anchor) => anchor.position(worlds) - position,
        AimTarget::Points(points) => points.sample(time) - position,
        AimTarget::Directions(directions) => directions.sample(time),
    };
    // From the origin, so that a position far out does not round the direction.
    let posed = Camera::look_at(DVec3::ZERO, forward, *up, rest.projection)?;
    Ok(Camera { name: rest.name.clone(), position, lens: rest.lens, ..posed })
}
