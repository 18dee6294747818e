//! What moves in a scene, and how: plain data, and the scene as it is at one time.

mod check;
mod curve;
mod node;

use glam::{DAffine3, DVec3};

use crate::error::{Error, Result};
use crate::scene::{Camera, Light, LightKind, Scene};

pub use curve::{Curve, Interpolation, Value};
pub use node::{Anchor, Keys, Motion, Node, NodeId, Orbit, Rotation};

/// The most frames that an animation can have: eleven hours at 24 a second.
pub const MAX_FRAMES: u32 = 1_000_000;
/// The most frames in a second.
pub const MAX_FPS: f64 = 1000.0;

/// How a scene changes with time.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// How many frames it has, from 1 to [`MAX_FRAMES`].
    pub frames: u32,
    /// How many of them are in a second, above 0.
    pub fps: f64,
    /// The spaces that move, each after those that it depends on.
    pub nodes: Vec<Node>,
    /// What of the scene changes.
    pub movers: Vec<Mover>,
}

/// Something of the scene that changes.
#[derive(Clone, Debug, PartialEq)]
pub enum Mover {
    /// A sphere.
    Sphere {
        /// Its index.
        sphere: usize,
        /// The space that it moves with; none for the world.
        node: Option<NodeId>,
        /// Its centre in that space. The space does not scale its radius.
        center: DVec3,
        /// Its radius, where that changes.
        radius: Option<Curve<f64>>,
    },
    /// An instance of a mesh.
    Instance {
        /// Its index.
        instance: usize,
        /// The space that it moves with.
        node: NodeId,
        /// From the mesh's space to that one.
        transform: DAffine3,
    },
    /// A light.
    Light {
        /// Its index.
        light: usize,
        /// The space that it moves with; none for the world.
        node: Option<NodeId>,
        /// The light as it stands in that space.
        rest: Light,
        /// Where it travels, in that space, where that changes; of any length but zero.
        direction: Option<Curve<DVec3>>,
        /// By what its intensity is multiplied, where that changes; 0 or above.
        intensity: Option<Curve<f64>>,
    },
    /// A camera.
    Camera {
        /// Its index.
        camera: usize,
        /// The space that it moves with; none for the world.
        node: Option<NodeId>,
        /// The camera as it stands in that space.
        rest: Camera,
        /// Where it looks, unless that is as it stands in that space.
        aim: Option<Aim>,
        /// The value of its lens, where that changes.
        lens: Option<Curve<f64>>,
    },
}

/// Where a camera looks, in world space, whatever space it moves with.
#[derive(Clone, Debug, PartialEq)]
pub struct Aim {
    /// What it looks at.
    pub toward: Toward,
    /// What is upward in its picture.
    pub up: DVec3,
}

/// What a camera looks at.
#[derive(Clone, Debug, PartialEq)]
pub enum Toward {
    /// A point, which may move with something.
    Anchor(Anchor),
    /// A point that goes from key to key.
    Points(Curve<DVec3>),
    /// A direction, of any length but zero, that goes from key to key.
    Directions(Curve<DVec3>),
}

impl Animation {
    /// An animation of so many frames in which nothing moves yet.
    pub fn new(frames: u32, fps: f64) -> Self {
        Self { frames, fps, nodes: Vec::new(), movers: Vec::new() }
    }

    /// The time of a frame, in seconds; frames count from 1, and the first is at time 0.
    pub fn time(&self, frame: u32) -> f64 {
        (f64::from(frame) - 1.0) / self.fps
    }

    /// How long it is, in seconds: to where a frame after the last would be.
    pub fn seconds(&self) -> f64 {
        f64::from(self.frames) / self.fps
    }

    /// Whether anything moves that rays can meet, rather than lights and cameras alone.
    pub fn moves_geometry(&self) -> bool {
        self.movers.iter().any(|m| matches!(m, Mover::Sphere { .. } | Mover::Instance { .. }))
    }

    /// Whether it moves each of so many instances.
    pub(in crate::scene) fn moved_instances(&self, count: usize) -> Vec<bool> {
        let mut moved = vec![false; count];
        for mover in &self.movers {
            if let Mover::Instance { instance, .. } = mover
                && let Some(moved) = moved.get_mut(*instance)
            {
                *moved = true;
            }
        }
        moved
    }

    /// Adds a node.
    pub fn add_node(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        NodeId(self.nodes.len() as u32 - 1)
    }
}

impl Scene {
    /// The scene as it is at a time in seconds: one like any other, in which nothing moves.
    ///
    /// A mesh that is squeezed flat at that time is left out.
    ///
    /// # Errors
    /// When a camera then looks at where it stands, or along its own up.
    ///
    /// # Panics
    /// When the animation was not [checked](Scene::check).
    pub fn at(&self, time: f64) -> Result<Scene> {
        let mut scene = self.clone();
        let Some(animation) = scene.animation.take() else { return Ok(scene) };
        let worlds = node::worlds(&animation.nodes, time);
        let world = |node: &Option<NodeId>| {
            node.map_or(DAffine3::IDENTITY, |NodeId(node)| worlds[node as usize])
        };
        let mut any_flat = false;
        for mover in &animation.movers {
            match mover {
                Mover::Sphere { sphere, node, center, radius } => {
                    let sphere = &mut scene.spheres[*sphere];
                    sphere.center = world(node).transform_point3(*center);
                    if let Some(radius) = radius {
                        sphere.radius = radius.at(time);
                    }
                }
                Mover::Instance { instance, node, transform } => {
                    let instance = &mut scene.instances[*instance];
                    instance.transform = world(&Some(*node)) * *transform;
                    any_flat |= instance.is_flat();
                }
                Mover::Light { light, node, rest, direction: way, intensity } => {
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
                Mover::Camera { camera, node, rest, aim, lens } => {
                    let posed = pose_camera(&world(node), rest, aim.as_ref(), &worlds, time)
                        .map_err(|e| {
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
        }
        if any_flat {
            scene.instances.retain(|instance| !instance.is_flat());
        }
        Ok(scene)
    }
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

/// The same error, with what it is about before it.
fn naming(what: &str, error: &Error) -> Error {
    let named = Error::input(format!("{what}: {}", error.message()));
    match error.advice() {
        Some(help) => named.help(help),
        None => named,
    }
}
