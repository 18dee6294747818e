//! How a placed model moves: by its own animation, and with the space that it is placed in.

use super::{Firsts, MergedModel, Placement};
use crate::scene::animation::{Animated, Animation, Node, NodeId};

impl MergedModel {
    /// Adds how the placed model moves: as its own animation says, all of it with the placement's
    /// node.
    pub(super) fn animate(
        &self,
        animation: &mut Animation,
        placement: &Placement,
        first: &Firsts,
        cameras: &[Option<usize>],
    ) {
        let shift = animation.nodes.len() as u32;
        let (nodes, movers) =
            self.animation.as_ref().map_or((&[][..], &[][..]), |own| (&own.nodes, &own.objects));
        animation.nodes.extend(nodes.iter().map(|node| match node.parent {
            Some(NodeId(parent)) => Node { parent: Some(NodeId(parent + shift)), ..node.clone() },
            None => Node {
                parent: placement.node,
                base: placement.transform * node.base,
                motion: node.motion.clone(),
            },
        }));
        let mut moves = Moves {
            instances: vec![false; self.instances.len()],
            spheres: vec![false; self.spheres.len()],
            lights: vec![false; self.lights.len()],
            cameras: vec![false; self.cameras.len()],
        };
        let shifted = |node: &NodeId| NodeId(node.0 + shift);
        for mover in movers {
            let mut mover = mover.clone();
            match &mut mover {
                Animated::Sphere { sphere, node, .. } => {
                    moves.spheres[*sphere] = true;
                    (*sphere, *node) = (*sphere + first.sphere, node.as_ref().map(shifted));
                }
                Animated::Instance { instance, node, .. } => {
                    moves.instances[*instance] = true;
                    (*instance, *node) = (*instance + first.instance, shifted(node));
                }
                Animated::Mesh { mesh, deformation } => {
                    *mesh += self.first_mesh;
                    // Placed a second time it has the same shape.
                    let same =
                        |m: &Animated| matches!(m, Animated::Mesh { mesh: m, .. } if m == mesh);
                    if animation.objects.iter().any(same) {
                        continue;
                    }
                    let Some(skin) = &mut deformation.skin else {
                        animation.objects.push(mover);
                        continue;
                    };
                    for joint in skin.joints.iter_mut().chain([&mut skin.space]) {
                        match &mut joint.node {
                            Some(node) => *node = shifted(node),
                            None => {
                                joint.transform = placement.transform * joint.transform;
                                joint.node = placement.node;
                            }
                        }
                    }
                }
                Animated::Light { light, node, .. } => {
                    moves.lights[*light] = true;
                    (*light, *node) = (*light + first.light, node.as_ref().map(shifted));
                    if !placement.lights {
                        continue;
                    }
                }
                Animated::Camera { camera, node, .. } => {
                    moves.cameras[*camera] = true;
                    let Some(index) = cameras[*camera] else { continue };
                    (*camera, *node) = (index, node.as_ref().map(shifted));
                }
            }
            animation.objects.push(mover);
        }
        if let Some(node) = placement.node {
            self.carry(animation, placement, node, first, cameras, &moves);
        }
    }

    /// Makes what does not move by itself move with the placement's node.
    fn carry(
        &self,
        animation: &mut Animation,
        placement: &Placement,
        node: NodeId,
        first: &Firsts,
        cameras: &[Option<usize>],
        moves: &Moves,
    ) {
        let transform = placement.transform;
        for (i, instance) in self.instances.iter().enumerate().filter(|(i, _)| !moves.instances[*i])
        {
            let transform = transform * instance.transform;
            let instance = first.instance + i;
            animation.objects.push(Animated::Instance { instance, node, transform });
        }
        for (i, sphere) in self.spheres.iter().enumerate().filter(|(i, _)| !moves.spheres[*i]) {
            let (center, radius) = (transform.transform_point3(sphere.center), None);
            let (sphere, node) = (first.sphere + i, Some(node));
            animation.objects.push(Animated::Sphere { sphere, node, center, radius });
        }
        let lights = self.lights.iter().enumerate().filter(|(i, _)| !moves.lights[*i]);
        for (i, light) in lights.filter(|_| placement.lights) {
            animation.objects.push(Animated::Light {
                light: first.light + i,
                node: Some(node),
                rest: light.transformed(&transform),
                direction: None,
                intensity: None,
            });
        }
        for (i, camera) in self.cameras.iter().enumerate().filter(|(i, _)| !moves.cameras[*i]) {
            if let Some((index, rest)) = cameras[i].zip(camera.transformed(&transform)) {
                let (aim, lens) = (None, None);
                let node = Some(node);
                animation.objects.push(Animated::Camera { camera: index, node, rest, aim, lens });
            }
        }
    }
}

/// Which of a model's objects move by its own animation.
struct Moves {
    instances: Vec<bool>,
    spheres: Vec<bool>,
    lights: Vec<bool>,
    cameras: Vec<bool>,
}
