//! What makes an animation valid.

use glam::DAffine3;

use super::{
    AimTarget, Animated, Animation, Curve, Deformation, MAX_FPS, MAX_FRAMES, Motion, Node, NodeId,
    Rotation, prefixed,
};
use crate::error::{Error, Result};
use crate::scene::Scene;

impl Animation {
    /// Checks what the rest of the program takes for granted, for the objects of `scene`;
    /// `Scene::check` calls it.
    ///
    /// # Errors
    /// The first thing that is not so.
    pub(in crate::scene) fn check(&self, scene: &Scene) -> Result<()> {
        check_frames(self.frames)?;
        check_fps(self.fps)?;
        for (i, node) in self.nodes.iter().enumerate() {
            check_node(i, node).map_err(|e| prefixed(&format!("animation node {i}"), &e))?;
        }
        for mover in &self.objects {
            check_object(mover, self.nodes.len(), scene)?;
        }
        Ok(())
    }
}

/// Checks the number of frames of an animation.
///
/// # Errors
/// When there are none or more than [`MAX_FRAMES`].
fn check_frames(frames: u32) -> Result<()> {
    if (1..=MAX_FRAMES).contains(&frames) {
        return Ok(());
    }
    Err(Error::input(format!("an animation of {frames} frames cannot be made"))
        .help(format!("from 1 to {MAX_FRAMES}")))
}

/// Checks how many frames are in a second.
///
/// # Errors
/// When that is not above 0, or above [`MAX_FPS`].
fn check_fps(fps: f64) -> Result<()> {
    if (1e-6..=MAX_FPS).contains(&fps) {
        return Ok(());
    }
    Err(Error::input(format!("{fps} frames a second cannot be made"))
        .help(format!("a number above 0 (and at most {MAX_FPS})")))
}

fn check_node(index: usize, node: &Node) -> Result<()> {
    let require = |holds: bool, what: &str| match holds {
        true => Ok(()),
        false => Err(Error::input(what)),
    };
    let before = |id: &Option<NodeId>| id.is_none_or(|NodeId(id)| (id as usize) < index);
    require(before(&node.parent), "its parent does not stand before it")?;
    require(node.base.is_finite(), "its place is not finite")?;
    match &node.motion {
        Motion::Keyframes(keys) => {
            keys.translation.check()?;
            match &keys.rotation {
                Rotation::Angles(curve) => curve.check()?,
                Rotation::Quaternions(curve) => curve.check()?,
            }
            keys.scale.check()?;
            require(keys.period.is_none_or(|p| p > 0.0), "it repeats after no time")
        }
        Motion::Orbit(orbit) => {
            require(before(&orbit.around.node), "its centre does not stand before it")?;
            let alone = node.parent.is_none() && node.base == DAffine3::IDENTITY;
            require(alone, "an orbit has neither parent nor place")?;
            let points = [orbit.around.point, orbit.center, orbit.start];
            require(points.iter().all(|p| p.is_finite()), "its centre is not finite")?;
            require((orbit.axis.length() - 1.0).abs() < 1e-6, "its axis must have length 1")?;
            require(orbit.period != 0.0 && !orbit.period.is_nan(), "its period must not be 0")
        }
    }
}

fn check_deformation(
    deformation: &Deformation,
    node: impl Fn(&Option<NodeId>) -> Result<()>,
) -> Result<()> {
    let require = |holds: bool, what: &str| match holds {
        true => Ok(()),
        false => Err(Error::input(what)),
    };
    let Deformation { base, morph_targets: morphs, weights, period: repeats, skin } = deformation;
    require(weights.len() == morphs.len(), "there must be a weight for each morph")?;
    weights.iter().try_for_each(Curve::check)?;
    require(repeats.is_none_or(|p| p > 0.0), "it repeats after no time")?;
    let Some(skin) = skin else { return Ok(()) };
    node(&skin.space.node)?;
    skin.joints.iter().try_for_each(|joint| node(&joint.node))?;
    let numbers = base.positions.len() * skin.influences.per_vertex;
    let fits = [skin.influences.joints.len(), skin.influences.weights.len()] == [numbers; 2];
    require(fits, "the joints are not as many for each vertex")
}

fn check_object(mover: &Animated, nodes: usize, scene: &Scene) -> Result<()> {
    let there = |what: &str, index: usize, count: usize| {
        if index < count {
            return Ok(());
        }
        Err(Error::input(format!("the animation moves {what} {index}, of {count}")))
    };
    let node = |id: &Option<NodeId>| id.map_or(Ok(()), |id| there("node", id.0 as usize, nodes));
    match mover {
        Animated::Sphere { sphere, node: of, radius, .. } => {
            there("sphere", *sphere, scene.spheres.len())?;
            node(of)?;
            radius.iter().try_for_each(Curve::check)
        }
        Animated::Instance { instance, node: of, .. } => {
            there("instance", *instance, scene.instances.len())?;
            node(&Some(*of))
        }
        Animated::Mesh { mesh, deformation } => {
            there("mesh", *mesh, scene.meshes.len())?;
            check_deformation(deformation, node)
                .map_err(|e| prefixed(&format!("the deformation of mesh {mesh}"), &e))
        }
        Animated::Light { light, node: of, direction, intensity, .. } => {
            there("light", *light, scene.lights.len())?;
            node(of)?;
            direction.iter().try_for_each(Curve::check)?;
            intensity.iter().try_for_each(Curve::check)
        }
        Animated::Camera { camera, node: of, aim, lens, .. } => {
            there("camera", *camera, scene.cameras.len())?;
            node(of)?;
            lens.iter().try_for_each(Curve::check)?;
            match aim.as_ref().map(|aim| &aim.target) {
                Some(AimTarget::Anchor(anchor)) => node(&anchor.node),
                Some(AimTarget::Points(curve) | AimTarget::Directions(curve)) => curve.check(),
                None => Ok(()),
            }
        }
    }
}
