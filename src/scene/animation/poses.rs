//! A scene as it is at one time after another.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::deform::Pose;
use super::{Aim, Animated, Toward, naming, node};
use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::scene::check::check_extent;
use crate::scene::{Camera, Instance, LightKind, Scene};

/// A scene as it is at one time after another: of what stands still nothing is copied or checked
/// again.
#[derive(Debug)]
pub struct Poses<'a> {
    scene: &'a Scene,
    posed: Scene,
    /// Whether instances are left out of it, since they are flat at that time.
    lacks_flat: bool,
    /// The boxes of the meshes, once they were asked for, and none for those that have a new shape.
    mesh_bounds: Vec<Option<Bounds>>,
    /// For each mover of a mesh, the pose that the mesh has.
    shapes: Vec<Option<Pose>>,
}

impl<'a> Poses<'a> {
    /// The scene as its files place it, for a start.
    pub fn new(scene: &'a Scene) -> Self {
        // All but the animation, whose keys may be many.
        let posed = Scene {
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
        };
        let mesh_bounds = vec![None; scene.meshes.len()];
        Self { scene, posed, lacks_flat: false, mesh_bounds, shapes: Vec::new() }
    }

    /// The scene as it is at a time in seconds; see [`Scene::at`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Panics
    /// When the animation was not [checked](Scene::check).
    pub fn pose(&mut self, time: f64) -> Result<&Scene> {
        let Some(animation) = &self.scene.animation else { return Ok(&self.posed) };
        let scene = &mut self.posed;
        if std::mem::take(&mut self.lacks_flat) {
            scene.instances.clone_from(&self.scene.instances);
        }
        let worlds = node::worlds(&animation.nodes, time);
        self.shapes.resize(animation.movers.len(), None);
        for (mover, shape) in animation.movers.iter().zip(&mut self.shapes) {
            let Animated::Mesh { mesh, deformation } = mover else {
                self.lacks_flat |= pose(mover, time, &worlds, scene)?;
                continue;
            };
            // A mesh that keeps its shape stays the same one, of which nothing is built again.
            let new = Some(deformation.pose(time, &worlds));
            if *shape != new {
                *shape = new;
                self.mesh_bounds[*mesh] = None;
                if let Some(pose) = shape {
                    scene.meshes[*mesh] = Arc::new(deformation.shape(pose));
                }
            }
        }
        if self.lacks_flat {
            scene.instances.retain(|instance| !instance.is_flat());
        }
        Ok(scene)
    }

    /// Checks what moves, as it is now, of a scene that was [checked](Scene::check) before it
    /// moved.
    ///
    /// # Errors
    /// The first thing that is not valid.
    pub fn check(&mut self) -> Result<()> {
        let posed = &self.posed;
        for mover in self.scene.animation.iter().flat_map(|animation| &animation.movers) {
            match *mover {
                Animated::Sphere { sphere, .. } => posed.check_sphere(sphere)?,
                Animated::Instance { instance, .. } if !self.lacks_flat => {
                    posed.check_instance(instance, false)?;
                }
                Animated::Mesh { mesh, .. } => posed.check_mesh(mesh)?,
                Animated::Instance { .. } | Animated::Light { .. } | Animated::Camera { .. } => {}
            }
        }
        if self.lacks_flat {
            // They have other indices now.
            (0..posed.instances.len()).try_for_each(|i| posed.check_instance(i, false))?;
        }
        posed.check_lights_and_cameras()?;
        check_extent(&self.bounds())
    }

    /// The box around the scene as it is now.
    pub fn bounds(&mut self) -> Bounds {
        let meshes = self.posed.meshes.iter().zip(&mut self.mesh_bounds);
        let boxes: Vec<Bounds> =
            meshes.map(|(mesh, known)| *known.get_or_insert_with(|| mesh.bounds())).collect();
        self.posed.bounds_with(&boxes)
    }

    /// The scene as it is now.
    pub fn scene(&self) -> &Scene {
        &self.posed
    }

    /// The scene as it is now, to keep.
    pub fn into_scene(self) -> Scene {
        self.posed
    }
}

/// Moves what a mover moves; says whether that made an instance flat.
fn pose(mover: &Animated, time: f64, worlds: &[DAffine3], scene: &mut Scene) -> Result<bool> {
    let world = |node: &Option<super::NodeId>| {
        node.map_or(DAffine3::IDENTITY, |node| worlds[node.0 as usize])
    };
    match mover {
        Animated::Sphere { sphere, node, center, radius } => {
            let sphere = &mut scene.spheres[*sphere];
            sphere.center = world(node).transform_point3(*center);
            if let Some(radius) = radius {
                sphere.radius = radius.at(time);
            }
        }
        Animated::Instance { instance, node, transform } => {
            let instance: &mut Instance = &mut scene.instances[*instance];
            instance.transform = world(&Some(*node)) * *transform;
            return Ok(instance.is_flat());
        }
        Animated::Mesh { .. } => {}
        Animated::Light { light, node, rest, direction: way, intensity } => {
            let mut rest = rest.clone();
            if let (
                LightKind::Directional { direction } | LightKind::Spot { direction, .. },
                Some(way),
            ) = (&mut rest.kind, way)
            {
                // Halfway between opposite directions there is none.
                *direction = way.at(time).try_normalize().unwrap_or(*direction);
            }
            if let Some(intensity) = intensity {
                rest.intensity *= intensity.at(time) as f32;
            }
            scene.lights[*light] = rest.placed(&world(node));
        }
        Animated::Camera { camera, node, rest, aim, lens } => {
            let posed = pose_camera(&world(node), rest, aim.as_ref(), worlds, time);
            let posed = posed.map_err(|e| {
                let name = match &*rest.name {
                    "" => camera.to_string(),
                    name => format!("`{name}`"),
                };
                naming(&format!("at {time:.3} s, camera {name}"), &e)
            })?;
            let kind = lens.as_ref().map_or(rest.lens, |v| rest.lens.with(v.at(time)));
            scene.cameras[*camera] = Camera { lens: kind, ..posed };
        }
    }
    Ok(false)
}

fn pose_camera(
    world: &DAffine3,
    rest: &Camera,
    aim: Option<&Aim>,
    worlds: &[DAffine3],
    time: f64,
) -> Result<Camera> {
    let Some(Aim { toward, up }) = aim else {
        return rest.placed(world).ok_or_else(|| {
            Error::input("its transform is too uneven to leave it an upward direction")
        });
    };
    let position = world.transform_point3(rest.position);
    let forward = match toward {
        Toward::Anchor(anchor) => anchor.at(worlds) - position,
        Toward::Points(points) => points.at(time) - position,
        Toward::Directions(directions) => directions.at(time),
    };
    // From the origin, so that a position far out does not round the direction.
    let posed = Camera::look_at(DVec3::ZERO, forward, *up, rest.lens)?;
    Ok(Camera { name: rest.name.clone(), position, ..posed })
}
