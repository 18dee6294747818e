//! The animation of a scene as plain data, and the scene at one time.
//!
//! ```
//! use envers::scene::animation::{Animated, Animation, Curve, Interpolation, Keyframes, Motion, Node};
//! use envers::scene::{Material, Scene, Sphere};
//! use glam::{DAffine3, DVec3};
//!
//! let mut scene = Scene::default();
//! let material = scene.add_material(Material::default());
//! scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, material));
//!
//! // Two seconds at 24 frames a second, in which a node rises by 4.
//! let mut animation = Animation::new(48, 24.0);
//! let translation = Curve {
//!     times: vec![0.0, 2.0],
//!     values: vec![DVec3::ZERO, DVec3::Y * 4.0],
//!     interpolation: Interpolation::Linear,
//! };
//! let motion = Motion::Keyframes(Keyframes { translation, ..Keyframes::identity() });
//! let node = animation.add_node(Node { parent: None, base: DAffine3::IDENTITY, motion });
//! let center = DVec3::ZERO;
//! animation.objects.push(Animated::Sphere { sphere: 0, node: Some(node), center, radius: None });
//! scene.animation = Some(animation);
//! assert_eq!(scene.at_time(0.5)?.spheres[0].center, DVec3::Y);
//! # Ok::<(), envers::Error>(())
//! ```

mod check;
mod curve;
mod deformation;
mod node;
mod posed_scene;

use std::collections::HashSet;

use glam::{DAffine3, DVec3};

use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::scene::{Camera, Light, Scene};

pub use curve::{Curve, Interpolate, Interpolation};
pub use deformation::{Deformation, Influences, Joint, MorphTarget, Skin};
pub use node::{Anchor, Keyframes, Motion, Node, NodeId, Orbit, Rotation};
pub use posed_scene::PosedScene;

/// The greatest number of frames of an animation: eleven hours at 24 a second.
pub const MAX_FRAMES: u32 = 1_000_000;
/// The greatest frame rate, in frames per second.
pub const MAX_FPS: f64 = 1000.0;

/// An animation: how the objects of a scene change with time.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// The number of frames, from 1 to [`MAX_FRAMES`].
    pub frames: u32,
    /// The frame rate in frames per second, above 0.
    pub fps: f64,
    /// The nodes, each after those that it depends on.
    pub nodes: Vec<Node>,
    /// The objects of the scene that change.
    pub objects: Vec<Animated>,
}

/// An animated object of a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Animated {
    /// A sphere that moves or grows.
    Sphere {
        /// Its index in the scene.
        sphere: usize,
        /// The node that it is attached to; none for the world.
        node: Option<NodeId>,
        /// Its centre in the node's space. The node does not scale its radius.
        center: DVec3,
        /// Its radius, if that changes.
        radius: Option<Curve<f64>>,
    },
    /// An instance that moves.
    Instance {
        /// Its index in the scene.
        instance: usize,
        /// The node that it is attached to.
        node: NodeId,
        /// The transform from the mesh's space to the node's.
        transform: DAffine3,
    },
    /// A mesh that changes its shape, in all its instances.
    Mesh {
        /// Its index in the scene.
        mesh: usize,
        /// The deformation that gives it its shape.
        deformation: Box<Deformation>,
    },
    /// A light that moves, turns or changes its intensity.
    Light {
        /// Its index in the scene.
        light: usize,
        /// The node that it is attached to; none for the world.
        node: Option<NodeId>,
        /// The light in the node's space.
        rest: Light,
        /// The direction in which its light travels in the node's space, if that changes; of any
        /// length but zero.
        direction: Option<Curve<DVec3>>,
        /// The factor of its intensity, if that changes; 0 or above.
        intensity: Option<Curve<f64>>,
    },
    /// A camera that moves, turns or zooms.
    Camera {
        /// Its index in the scene.
        camera: usize,
        /// The node that it is attached to; none for the world.
        node: Option<NodeId>,
        /// The camera in the node's space.
        rest: Camera,
        /// Its aim; `None` leaves it the direction of `rest`.
        aim: Option<Aim>,
        /// The value of its projection (angle, focal length or height), if that changes.
        lens: Option<Curve<f64>>,
    },
}

/// The aim of a camera, in world space whatever node it is attached to.
#[derive(Clone, Debug, PartialEq)]
pub struct Aim {
    /// The target that it looks at.
    pub target: AimTarget,
    /// The direction that is upward in its picture.
    pub up: DVec3,
}

/// The target of a camera's aim.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum AimTarget {
    /// A point, which may be attached to a node.
    Anchor(Anchor),
    /// A point that moves along a curve.
    Points(Curve<DVec3>),
    /// A direction, of any length but zero, that changes along a curve.
    Directions(Curve<DVec3>),
}

impl Animation {
    /// An animation of `frames` frames in which nothing moves yet.
    pub fn new(frames: u32, fps: f64) -> Self {
        Self { frames, fps, nodes: Vec::new(), objects: Vec::new() }
    }

    /// The time of a frame, in seconds; frames count from 1, and the first is at time 0.
    pub fn time(&self, frame: u32) -> f64 {
        (f64::from(frame) - 1.0) / self.fps
    }

    /// The duration in seconds: the time at which a frame after the last would be.
    pub fn duration(&self) -> f64 {
        f64::from(self.frames) / self.fps
    }

    /// True if anything moves that rays can hit, rather than lights and cameras alone.
    pub fn moves_geometry(&self) -> bool {
        !self.objects.iter().all(|o| matches!(o, Animated::Light { .. } | Animated::Camera { .. }))
    }

    /// The indices of the instances that move.
    pub(in crate::scene) fn moved_instances(&self) -> HashSet<usize> {
        let instance = |object: &Animated| match object {
            Animated::Instance { instance, .. } => Some(*instance),
            _ => None,
        };
        self.objects.iter().filter_map(instance).collect()
    }

    /// Adds a node and returns its id.
    pub fn add_node(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        NodeId(self.nodes.len() as u32 - 1)
    }
}

impl Scene {
    /// The scene at a time in seconds, without animation.
    ///
    /// Instances that are scaled flat at that time are left out.
    ///
    /// # Errors
    /// When a camera then looks at its own position, or along its own up direction.
    ///
    /// # Panics
    /// When the animation was not [checked](Scene::check).
    pub fn at_time(&self, time: f64) -> Result<Scene> {
        let mut posed = PosedScene::new(self);
        posed.pose(time)?;
        Ok(posed.into_scene())
    }

    /// The bounding box of the scene over its whole animation, sampled at some moments.
    ///
    /// # Panics
    /// When the animation was not [checked](Scene::check).
    pub fn bounds_over_time(&self) -> Bounds {
        if self.animation.is_none() {
            return self.bounds();
        }
        let mut bounds = Bounds::EMPTY;
        self.sample_over_time(|posed| bounds = bounds.union(posed.bounds()));
        bounds
    }

    /// Calls `visit` with the scene at evenly spaced moments of its animation, from start to end.
    pub(crate) fn sample_over_time(&self, mut visit: impl FnMut(&mut PosedScene<'_>)) {
        /// The number of moments, besides the start.
        const MOMENTS: u32 = 24;
        let Some(animation) = &self.animation else { return };
        let mut posed = PosedScene::new(self);
        for i in 0..=MOMENTS {
            let time = animation.duration() * f64::from(i) / f64::from(MOMENTS);
            if posed.pose(time).is_ok() {
                visit(&mut posed);
            }
        }
    }
}

/// Puts the object that an error is about before its message.
fn prefixed(label: &str, error: &Error) -> Error {
    let named = Error::input(format!("{label}: {}", error.message()));
    match error.advice() {
        Some(help) => named.help(help),
        None => named,
    }
}
