//! The validity checks of an animation.

use glam::DAffine3;

use super::{
    AimTarget, Animated, Animation, Curve, Deformation, MAX_FPS, MAX_FRAMES, Motion, Node, NodeId,
    Rotation, prefixed,
};
use crate::error::Result;
use crate::scene::{Scene, check::require};

impl Animation {
    /// Checks that frames, curves and indices into `scene` are valid; `Scene::check` calls it.
    ///
    /// # Errors
    /// The first condition that does not hold.
    pub(in crate::scene) fn check(&self, scene: &Scene) -> Result<()> {
        require((1..=MAX_FRAMES).contains(&self.frames), || {
            format!("an animation of {} frames cannot be made", self.frames)
        })
        .map_err(|e| e.help(format!("from 1 to {MAX_FRAMES}")))?;
        require((1e-6..=MAX_FPS).contains(&self.fps), || {
            format!("{} frames a second cannot be made", self.fps)
        })
        .map_err(|e| e.help(format!("a number above 0 (and at most {MAX_FPS})")))?;
        for (i, node) in self.nodes.iter().enumerate() {
            check_node(i, node).map_err(|e| prefixed(&format!("animation node {i}"), &e))?;
        }
        self.objects.iter().try_for_each(|object| check_object(object, self.nodes.len(), scene))
    }
}

/// Requires a condition whose message has nothing to fill in.
fn require_that(holds: bool, message: &str) -> Result<()> {
    require(holds, || message.to_owned())
}

/// Checks node `index`.
fn check_node(index: usize, node: &Node) -> Result<()> {
    let is_before = |id: &Option<NodeId>| id.is_none_or(|NodeId(id)| (id as usize) < index);
    // What all nodes have, and then the keyframes or the orbit.
    require_that(is_before(&node.parent), "its parent does not come before it")?;
    require_that(node.base.is_finite(), "its base transform is not finite")?;
    match &node.motion {
        Motion::Keyframes(keys) => {
            keys.translation.check()?;
            match &keys.rotation {
                Rotation::Angles(curve) => curve.check()?,
                Rotation::Quaternions(curve) => curve.check()?,
            }
            keys.scale.check()?;
            require_that(keys.period.is_none_or(|p| p > 0.0), "its period must be above 0")
        }
        Motion::Orbit(orbit) => {
            require_that(is_before(&orbit.around.node), "its centre does not come before it")?;
            let is_root = node.parent.is_none() && node.base == DAffine3::IDENTITY;
            require_that(is_root, "an orbit must have neither a parent nor a base transform")?;
            let points = [orbit.around.point, orbit.center, orbit.start];
            require_that(points.iter().all(|p| p.is_finite()), "its centre is not finite")?;
            let has_unit_axis = (orbit.axis.length() - 1.0).abs() < 1e-6;
            require_that(has_unit_axis, "its axis must have length 1")?;
            let has_period = orbit.period != 0.0 && !orbit.period.is_nan();
            require_that(has_period, "its period must not be 0")
        }
    }
}

/// Checks the deformation of a mesh, whose nodes `check_node_id` checks.
fn check_deformation(
    deformation: &Deformation,
    check_node_id: impl Fn(&Option<NodeId>) -> Result<()>,
) -> Result<()> {
    let Deformation { base, morph_targets, weights, period, skin } = deformation;
    let is_weighted = weights.len() == morph_targets.len();
    require_that(is_weighted, "there must be a weight for each morph target")?;
    weights.iter().try_for_each(Curve::check)?;
    require_that(period.is_none_or(|p| p > 0.0), "its period must be above 0")?;
    let Some(skin) = skin else { return Ok(()) };
    check_node_id(&skin.space.node)?;
    skin.joints.iter().try_for_each(|joint| check_node_id(&joint.node))?;
    let count = base.positions.len() * skin.influences.per_vertex;
    let fits = [skin.influences.joints.len(), skin.influences.weights.len()] == [count; 2];
    require_that(fits, "all vertices must have the same number of joints")
}

/// Checks the indices and the curves of an animated object.
fn check_object(object: &Animated, nodes: usize, scene: &Scene) -> Result<()> {
    // The index of an object or a node must be that of one.
    let check_index = |kind: &str, index: usize, count: usize| {
        require(index < count, || format!("the animation moves {kind} {index}, of {count}"))
    };
    let check_node_id =
        |id: &Option<NodeId>| id.map_or(Ok(()), |id| check_index("node", id.0 as usize, nodes));
    match object {
        Animated::Sphere { sphere, node, radius, .. } => {
            check_index("sphere", *sphere, scene.spheres.len())?;
            check_node_id(node)?;
            radius.iter().try_for_each(Curve::check)
        }
        Animated::Instance { instance, node, .. } => {
            check_index("instance", *instance, scene.instances.len())?;
            check_node_id(&Some(*node))
        }
        Animated::Mesh { mesh, deformation } => {
            check_index("mesh", *mesh, scene.meshes.len())?;
            check_deformation(deformation, check_node_id)
                .map_err(|e| prefixed(&format!("the deformation of mesh {mesh}"), &e))
        }
        Animated::Light { light, node, direction, intensity, .. } => {
            check_index("light", *light, scene.lights.len())?;
            check_node_id(node)?;
            direction.iter().try_for_each(Curve::check)?;
            intensity.iter().try_for_each(Curve::check)
        }
        Animated::Camera { camera, node, aim, lens, .. } => {
            check_index("camera", *camera, scene.cameras.len())?;
            check_node_id(node)?;
            lens.iter().try_for_each(Curve::check)?;
            match aim.as_ref().map(|aim| &aim.target) {
                Some(AimTarget::Anchor(anchor)) => check_node_id(&anchor.node),
                Some(AimTarget::Points(curve) | AimTarget::Directions(curve)) => curve.check(),
                None => Ok(()),
            }
        }
    }
}
