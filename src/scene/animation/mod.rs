//! What moves in a scene, and how: plain data, and the scene as it is at one time.

mod check;
mod curve;
mod deform;
mod node;
mod poses;

use glam::{DAffine3, DVec3};

use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::scene::{Camera, Light, Scene};

pub use curve::{Curve, Interpolate, Interpolation};
pub use deform::{Deformation, Influences, Joint, MorphTarget, Skin};
pub use node::{Anchor, Keyframes, Motion, Node, NodeId, Orbit, Rotation};
pub use poses::PosedScene;

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
    pub objects: Vec<Animated>,
}

/// Something of the scene that changes.
#[derive(Clone, Debug, PartialEq)]
pub enum Animated {
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
    /// The shape of a mesh, wherever it stands.
    Mesh {
        /// Its index.
        mesh: usize,
        /// What gives it its shape.
        deformation: Box<Deformation>,
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
    pub target: AimTarget,
    /// What is upward in its picture.
    pub up: DVec3,
}

/// What a camera looks at.
#[derive(Clone, Debug, PartialEq)]
pub enum AimTarget {
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
        Self { frames, fps, nodes: Vec::new(), objects: Vec::new() }
    }

    /// The time of a frame, in seconds; frames count from 1, and the first is at time 0.
    pub fn time(&self, frame: u32) -> f64 {
        (f64::from(frame) - 1.0) / self.fps
    }

    /// How long it is, in seconds: to where a frame after the last would be.
    pub fn duration(&self) -> f64 {
        f64::from(self.frames) / self.fps
    }

    /// Whether anything moves that rays can meet, rather than lights and cameras alone.
    pub fn moves_geometry(&self) -> bool {
        self.objects.iter().any(|m| match m {
            Animated::Sphere { .. } | Animated::Instance { .. } | Animated::Mesh { .. } => true,
            Animated::Light { .. } | Animated::Camera { .. } => false,
        })
    }

    /// Whether it moves each of so many instances.
    pub(in crate::scene) fn moved_instances(&self, count: usize) -> Vec<bool> {
        let mut moved = vec![false; count];
        for mover in &self.objects {
            if let Animated::Instance { instance, .. } = mover
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
    pub fn at_time(&self, time: f64) -> Result<Scene> {
        let mut poses = PosedScene::new(self);
        poses.pose(time)?;
        Ok(poses.into_scene())
    }

    /// The box around the scene wherever it moves, as seen at some moments of its animation.
    ///
    /// # Panics
    /// When the animation was not [checked](Scene::check).
    pub fn bounds_over_time(&self) -> Bounds {
        if self.animation.is_none() {
            return self.bounds();
        }
        let mut bounds = Bounds::EMPTY;
        self.sample_over_time(|poses| bounds = bounds.union(poses.bounds()));
        bounds
    }

    /// Looks at the scene at some moments of its animation, from its start to its end.
    pub(crate) fn sample_over_time(&self, mut look: impl FnMut(&mut PosedScene<'_>)) {
        /// At how many times an animation is looked at, besides its start.
        const MOMENTS: u32 = 24;
        let Some(animation) = &self.animation else { return };
        let mut poses = PosedScene::new(self);
        for i in 0..=MOMENTS {
            let time = animation.duration() * f64::from(i) / f64::from(MOMENTS);
            if poses.pose(time).is_ok() {
                look(&mut poses);
            }
        }
    }
}

/// The same error, with what it is about before it.
fn prefixed(what: &str, error: &Error) -> Error {
    let named = Error::input(format!("{what}: {}", error.message()));
    match error.advice() {
        Some(help) => named.help(help),
        None => named,
    }
}
