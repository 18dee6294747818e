//! The tree of nodes, walked without recursion and each node once: files from strangers have
//! loops, and trees that are none.

use std::collections::HashSet;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::json;
use gltf::json::Node;

use super::animation::Clip;
use super::buffers::get;
use crate::error::{Error, Place, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::limits::Limit;
use crate::load::sandbox::Sandbox;
use crate::scene::animation::NodeId;

/// A node of the scene that is shown, with its place in the world.
pub struct Placed<'a> {
    /// The node.
    pub node: &'a Node,
    /// Its number in the file.
    pub index: usize,
    /// From its space to the world's, as the file places it.
    pub world: DAffine3,
    /// The nearest node of the animation that it moves with, itself or one above it.
    pub mover: Option<NodeId>,
    /// From its space to that of `mover`, or to the world's.
    pub rest: DAffine3,
    /// Whether the scene shows it; others are here for the sake of skins.
    pub is_shown: bool,
}

impl Placed<'_> {
    /// The same as it stands in the space of its mover.
    pub fn at_rest(&self) -> Self {
        Self { world: self.rest, ..*self }
    }
}

/// The nodes of the scene that is shown: the default one, else the first, else all nodes. Those
/// that move get nodes of the animation.
///
/// # Errors
/// When a node names one that isn't there, is its own ancestor, or has numbers that are not
/// finite.
pub fn walk<'a>(
    root: &'a json::Root,
    guard: &Sandbox,
    clip: &mut Clip,
    tally: &mut Diagnostics,
) -> Result<Vec<Placed<'a>>> {
    let place = || Place::Json("nodes".to_owned());
    guard.take(Limit::Nodes, root.nodes.len() as u64).map_err(|e| e.place(place()))?;
    let parents = parents(root)?;
    let mut roots = roots(root, &parents)?;
    // So that a child that stands among the roots as well is placed by its parent.
    roots.sort_by_key(|&(i, _)| parents.get(i).is_some_and(Option::is_some));
    let mut placed = Vec::new();
    let mut seen = vec![false; root.nodes.len()];
    let world = Above {
        world: DAffine3::IDENTITY,
        mover: None,
        rest: DAffine3::IDENTITY,
        is_shown: true,
        depth: 0,
    };
    // Joints are posed whether the scene shows them or not.
    let is_shown: HashSet<usize> = roots.iter().map(|(i, _)| *i).collect();
    let orphans = (0..parents.len()).filter(|i| parents[*i].is_none() && !is_shown.contains(i));
    let hidden = orphans.filter(|_| !root.skins.is_empty());
    let hidden = hidden.map(|i| (i, String::new(), Above { is_shown: false, ..world }));
    let mut open: Vec<(usize, String, Above)> = hidden.collect();
    open.extend(roots.iter().rev().map(|(i, by)| (*i, by.clone(), world)));
    while let Some((index, by, above)) = open.pop() {
        let node = get(&root.nodes, index, "node", &by)?;
        let depth = above.depth + 1;
        guard
            .check(Limit::Depth, depth)
            .map_err(|e| e.place(Place::Json(format!("nodes[{index}]"))))?;
        match seen.get_mut(index) {
            Some(seen) if !*seen => *seen = true,
            _ if !above.is_shown => continue,
            _ => {
                tally.add("{} nodes stand twice in the tree and are drawn once", 1, || by);
                continue;
            }
        }
        let local = local(node, index, tally)?;
        let world = above.world * local;
        if !world.is_finite() {
            return Err(Error::input("the transforms of the node and those above it overflow")
                .place(Place::Json(format!("nodes[{index}]"))));
        }
        let own = clip.node(index, node, above.mover, above.rest);
        let (mover, rest) = match own {
            Some(_) => (own, DAffine3::IDENTITY),
            None => (above.mover, above.rest * local),
        };
        let is_shown = above.is_shown && !is_hidden(node);
        let here = Above { world, mover, rest, is_shown, depth };
        let children = node.children.iter().flatten().enumerate();
        let children = children
            .map(|(i, child)| (child.value(), format!("nodes[{index}].children[{i}]"), here));
        let first = open.len();
        open.extend(children);
        if let Some(new) = open.get_mut(first..) {
            // So that nodes come out in the file's order.
            new.reverse();
        }
        placed.push(Placed { node, index, world, mover, rest, is_shown });
    }
    Ok(placed)
}

/// Whether KHR_node_visibility hides a node, and with it all that hangs on it.
fn is_hidden(node: &Node) -> bool {
    let others = node.extensions.as_ref().map(|extensions| &extensions.others);
    let visibility = others.and_then(|others| others.get("KHR_node_visibility"));
    visibility.and_then(|object| object.get("visible")) == Some(&json::Value::Bool(false))
}

/// Where the children of a node stand; as in [`Placed`].
#[derive(Clone, Copy)]
struct Above {
    world: DAffine3,
    mover: Option<NodeId>,
    rest: DAffine3,
    /// How many nodes are above them.
    depth: u64,
    is_shown: bool,
}

/// The parent of each node; an error where a node is its own ancestor.
fn parents(root: &json::Root) -> Result<Vec<Option<usize>>> {
    let mut parents: Vec<Option<usize>> = vec![None; root.nodes.len()];
    for (index, node) in root.nodes.iter().enumerate() {
        for (i, child) in node.children.iter().flatten().enumerate() {
            let by = || format!("nodes[{index}].children[{i}]");
            get(&root.nodes, child.value(), "node", &by())?;
            if let Some(parent) = parents.get_mut(child.value()) {
                parent.get_or_insert(index);
            }
        }
    }
    // Each chain of parents is followed until it meets what an earlier one has cleared.
    let mut cleared_by = vec![usize::MAX; root.nodes.len()];
    for start in 0..parents.len() {
        let mut at = Some(start);
        while let Some(node) = at {
            match cleared_by.get_mut(node) {
                Some(by) if *by == start => {
                    return Err(Error::input("the node is its own ancestor")
                        .place(Place::Json(format!("nodes[{node}]")))
                        .help("nodes must form a tree"));
                }
                Some(by) if *by == usize::MAX => *by = start,
                _ => break,
            }
            at = parents.get(node).copied().flatten();
        }
    }
    Ok(parents)
}

fn roots(root: &json::Root, parents: &[Option<usize>]) -> Result<Vec<(usize, String)>> {
    let index = match root.scene {
        Some(scene) => scene.value(),
        None if root.scenes.is_empty() => {
            let orphans = parents.iter().enumerate().filter(|(_, parent)| parent.is_none());
            return Ok(orphans.map(|(i, _)| (i, format!("nodes[{i}]"))).collect());
        }
        None => 0,
    };
    let scene = get(&root.scenes, index, "scene", "scene")?;
    let name = |i: usize| format!("scenes[{index}].nodes[{i}]");
    Ok(scene.nodes.iter().enumerate().map(|(i, node)| (node.value(), name(i))).collect())
}

fn local(node: &Node, index: usize, tally: &mut Diagnostics) -> Result<DAffine3> {
    let finite = |numbers: &[f32], key: &str| {
        if numbers.iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        Err(Error::input("a number is too large")
            .place(Place::Json(format!("nodes[{index}].{key}")))
            .help("at most about 3.4e38"))
    };
    if let Some(m) = &node.matrix {
        finite(m, "matrix")?;
        let [x, y, z, t] = [0, 4, 8, 12]
            .map(|i| DVec3::new(f64::from(m[i]), f64::from(m[i + 1]), f64::from(m[i + 2])));
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            tally.add(
                "{} matrices have a last row other than 0 0 0 1, which is ignored",
                1,
                || format!("nodes[{index}].matrix"),
            );
        }
        return Ok(DAffine3::from_mat3_translation(DMat3::from_cols(x, y, z), t));
    }
    let vector =
        |v: Option<[f32; 3]>, default: DVec3| v.map_or(default, |v| DVec3::from(v.map(f64::from)));
    let rotation = node.rotation.unwrap_or_default().0;
    finite(&rotation, "rotation")?;
    finite(&node.scale.unwrap_or_default(), "scale")?;
    finite(&node.translation.unwrap_or_default(), "translation")?;
    let rotation = DQuat::from_array(rotation.map(f64::from));
    // f32 rounding leaves quaternions a little off length 1, and shear would follow.
    let length = rotation.length();
    let rotation = if length > 0.0 {
        rotation / length
    } else {
        tally.add("{} rotations have length 0 and turn nothing", 1, || {
            format!("nodes[{index}].rotation")
        });
        DQuat::IDENTITY
    };
    Ok(DAffine3::from_scale_rotation_translation(
        vector(node.scale, DVec3::ONE),
        rotation,
        vector(node.translation, DVec3::ZERO),
    ))
}
