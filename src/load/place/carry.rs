//! How a placed model moves: by its own animation, and with the space that it is placed in.

use super::{Firsts, Part, Placement};
use crate::scene::animation::{Animation, Mover, Node, NodeId};

impl Part {
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
            self.animation.as_ref().map_or((&[][..], &[][..]), |own| (&own.nodes, &own.movers));
        animation.nodes.extend(nodes.iter().map(|node| match node.parent {
            Some(NodeId(parent)) => Node { parent: Some(NodeId(parent + shift)), ..node.clone() },
            None => Node {
                parent: placement.node,
                place: placement.transform * node.place,
                motion: node.motion.clone(),
            },
        }));
        let mut moves = Moves {
            instances: vec![false; self.instances.len()],
            lights: vec![false; self.lights.len()],
            cameras: vec![false; self.cameras.len()],
        };
        let shifted = |node: &NodeId| NodeId(node.0 + shift);
        for mover in movers {
            let mut mover = mover.clone();
            match &mut mover {
                Mover::Sphere { .. } => continue,
                Mover::Instance { instance, node, .. } => {
                    moves.instances[*instance] = true;
                    (*instance, *node) = (*instance + first.instance, shifted(node));
                }
                Mover::Light { light, node, .. } => {
                    moves.lights[*light] = true;
                    (*light, *node) = (*light + first.light, node.as_ref().map(shifted));
                    if !placement.lights {
                        continue;
                    }
                }
                Mover::Camera { camera, node, .. } => {
                    moves.cameras[*camera] = true;
                    let Some(index) = cameras[*camera] else { continue };
                    (*camera, *node) = (index, node.as_ref().map(shifted));
                }
            }
            animation.movers.push(mover);
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
            animation.movers.push(Mover::Instance { instance, node, transform });
        }
        let lights = self.lights.iter().enumerate().filter(|(i, _)| !moves.lights[*i]);
        for (i, light) in lights.filter(|_| placement.lights) {
            animation.movers.push(Mover::Light {
                light: first.light + i,
                node: Some(node),
                rest: light.placed(&transform),
                direction: None,
                intensity: None,
            });
        }
        for (i, camera) in self.cameras.iter().enumerate().filter(|(i, _)| !moves.cameras[*i]) {
            if let Some((index, rest)) = cameras[i].zip(camera.placed(&transform)) {
                let (aim, lens) = (None, None);
                let node = Some(node);
                animation.movers.push(Mover::Camera { camera: index, node, rest, aim, lens });
            }
        }
    }
}

/// Which of a model's objects move by its own animation.
struct Moves {
    instances: Vec<bool>,
    lights: Vec<bool>,
    cameras: Vec<bool>,
}
