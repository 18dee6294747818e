//! The tree of nodes, walked without recursion and each node once: files from strangers have
//! cycles, and graphs that are no trees.

use std::collections::HashSet;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::json::{self, Node};

use super::animation::AnimationClip;
use super::vectors::unit_quaternion;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::load::gltf::json::{Document, NodeTransform, at_path, error_at, lookup};
use crate::load::limits::Limit;
use crate::load::sandbox::Sandbox;
use crate::scene::animation::NodeId;

/// A node of the file with its transforms.
pub struct SceneNode<'a> {
    /// The node.
    pub node: &'a Node,
    /// Its index in the file.
    pub index: usize,
    /// The transform from its space to world space, as the file has it.
    pub to_world: DAffine3,
    /// The nearest node of the animation, this one or an ancestor, that it moves with.
    pub animated: Option<NodeId>,
    /// The transform from its space to that of `animated`, or to world space if there is none.
    pub to_animated: DAffine3,
    /// True if the scene shows it; others are needed as joints of skins.
    pub is_shown: bool,
}

impl SceneNode<'_> {
    /// Returns the node as it is in the space of its animated node.
    pub fn in_animated_space(&self) -> Self {
        Self { to_world: self.to_animated, ..*self }
    }

    /// Returns the own name of what the node carries, or else the name of the node.
    pub fn name_of(&self, own: &Option<String>) -> String {
        own.as_ref().or(self.node.name.as_ref()).cloned().unwrap_or_default()
    }
}

/// The parent of a node, or by default what stands above nodes that are not shown; the fields are as
/// in [`SceneNode`].
#[derive(Clone, Copy, Default)]
struct Parent {
    to_world: DAffine3,
    animated: Option<NodeId>,
    to_animated: DAffine3,
    is_shown: bool,
    /// The number of nodes above its children.
    depth: u64,
}

/// Returns the nodes of the scene that is shown (the default one, else the first, else all nodes)
/// in the order of the file, and those that may be joints. Nodes that move are added to the
/// animation.
///
/// # Errors
/// When a node refers to a missing one, is its own ancestor, or has numbers that are not finite.
pub fn collect_nodes<'a>(
    document: &'a Document,
    sandbox: &Sandbox,
    clip: &mut AnimationClip,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<SceneNode<'a>>> {
    let root = &document.root;
    sandbox.consume(Limit::Nodes, root.nodes.len() as u64).map_err(at_path("nodes"))?;
    let parents = parents(root)?;
    let mut roots = scene_roots(root, &parents)?;
    // A child that is listed among the roots as well is placed by its parent.
    roots.sort_by_key(|&(i, _)| parents.get(i).is_some_and(Option::is_some));

    // The stack begins with the roots of the scene, the first on top; below them are the roots of
    // what the scene does not show, since joints are posed whether they are shown or not.
    // Each node has its index, the JSON path of the reference to it, and its parent.
    let mut stack: Vec<(usize, String, Parent)> = Vec::new();
    let shown: HashSet<usize> = roots.iter().map(|(i, _)| *i).collect();
    if !root.skins.is_empty() {
        let hidden = (0..parents.len()).filter(|i| parents[*i].is_none() && !shown.contains(i));
        stack.extend(hidden.map(|index| (index, String::new(), Parent::default())));
    }
    let scene = Parent { is_shown: true, ..Parent::default() };
    stack.extend(roots.into_iter().rev().map(|(index, by)| (index, by, scene)));

    // Each node is visited once, so that cycles end and no node is drawn twice.
    let mut nodes = Vec::new();
    let mut is_visited = vec![false; root.nodes.len()];
    while let Some((index, by, parent)) = stack.pop() {
        let node = lookup(&root.nodes, index, "node", &by)?;
        let path = format!("nodes[{index}]");
        let depth = parent.depth + 1;
        sandbox.check(Limit::Depth, depth).map_err(at_path(&path))?;
        if std::mem::replace(&mut is_visited[index], true) {
            if parent.is_shown {
                let reason = "{} nodes stand twice in the tree and are drawn once";
                diagnostics.add(reason, 1, || by);
            }
            continue;
        }

        // The transforms of the node.
        let transform = lookup(&document.transforms.nodes, index, "node", &path)?;
        let local = local_transform(transform, &path, diagnostics)?;
        let to_world = parent.to_world * local;
        if !to_world.is_finite() {
            let message = "the transforms of the node and those above it overflow";
            return Err(error_at(&path, message));
        }
        // A node that moves begins a space of its own; others stand still in that of an ancestor.
        let (animated, to_animated) =
            match clip.add_node(index, transform, parent.animated, parent.to_animated) {
                Some(own) => (Some(own), DAffine3::IDENTITY),
                None => (parent.animated, parent.to_animated * local),
            };
        let is_shown = parent.is_shown && !is_hidden(node);

        // The children come next, the first of them on top of the stack.
        let parent = Parent { to_world, animated, to_animated, is_shown, depth };
        let children = node.children.as_deref().unwrap_or_default().iter().enumerate().rev();
        let path = |i: usize| format!("{path}.children[{i}]");
        stack.extend(children.map(|(i, child)| (child.value(), path(i), parent)));
        nodes.push(SceneNode { node, index, to_world, animated, to_animated, is_shown });
    }
    Ok(nodes)
}

/// True if KHR_node_visibility hides a node, and with it all its descendants.
fn is_hidden(node: &Node) -> bool {
    let extension = node.extensions.as_ref().and_then(|e| e.others.get("KHR_node_visibility"));
    extension.and_then(|object| object.get("visible")) == Some(&json::Value::Bool(false))
}

/// Returns the parent of each node.
///
/// # Errors
/// When a child is missing, or a node is its own ancestor.
fn parents(root: &json::Root) -> Result<Vec<Option<usize>>> {
    // A node with several parents belongs to the first.
    let mut parents: Vec<Option<usize>> = vec![None; root.nodes.len()];
    for (index, node) in root.nodes.iter().enumerate() {
        for (i, child) in node.children.iter().flatten().enumerate() {
            let by = format_args!("nodes[{index}].children[{i}]");
            lookup(&root.nodes, child.value(), "node", by)?;
            parents[child.value()].get_or_insert(index);
        }
    }
    // Each chain of parents is followed to its end, or to a node that an earlier chain has visited.
    let mut visited_from = vec![usize::MAX; root.nodes.len()];
    for start in 0..parents.len() {
        let mut next = Some(start);
        while let Some(node) = next {
            if visited_from[node] == start {
                let path = format_args!("nodes[{node}]");
                let error = error_at(path, "the node is its own ancestor");
                return Err(error.help("nodes must form a tree"));
            }
            if visited_from[node] != usize::MAX {
                break;
            }
            visited_from[node] = start;
            next = parents[node];
        }
    }
    Ok(parents)
}

/// Returns the indices of the root nodes of the scene that is shown, each with its JSON path.
fn scene_roots(root: &json::Root, parents: &[Option<usize>]) -> Result<Vec<(usize, String)>> {
    let index = match root.scene {
        Some(scene) => scene.value(),
        None if root.scenes.is_empty() => {
            let orphans = (0..parents.len()).filter(|&i| parents[i].is_none());
            return Ok(orphans.map(|i| (i, format!("nodes[{i}]"))).collect());
        }
        None => 0,
    };
    // The scene that the file names, or else the first.
    let scene = lookup(&root.scenes, index, "scene", "scene")?;
    let path = |i: usize| format!("scenes[{index}].nodes[{i}]");
    Ok(scene.nodes.iter().enumerate().map(|(i, node)| (node.value(), path(i))).collect())
}

/// Returns the transform from a node's space to that of its parent.
///
/// # Errors
/// When a number is beyond f32, in which most programs would read it.
fn local_transform(
    node: &NodeTransform,
    path: &str,
    diagnostics: &mut Diagnostics,
) -> Result<DAffine3> {
    for (key, numbers) in node.numbers() {
        if numbers.iter().any(|x| x.abs() > f64::from(f32::MAX)) {
            let error = error_at(format_args!("{path}.{key}"), "a number is too large");
            return Err(error.help("at most about 3.4e38"));
        }
    }
    // A matrix, by columns.
    if let Some(m) = &node.matrix {
        // The last row of an affine transform is 0 0 0 1.
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            let reason = "{} matrices have a last row other than 0 0 0 1, which is ignored";
            diagnostics.add(reason, 1, || format!("{path}.matrix"));
        }
        let [x, y, z, translation] = [0, 4, 8, 12].map(|i| DVec3::new(m[i], m[i + 1], m[i + 2]));
        return Ok(DAffine3::from_mat3_translation(DMat3::from_cols(x, y, z), translation));
    }

    // Or scale, rotation and translation, in this order.
    let rotation = node.rotation.map_or(Some(DQuat::IDENTITY), unit_quaternion);
    let rotation = rotation.unwrap_or_else(|| {
        let reason = "{} rotations have length 0 and turn nothing";
        diagnostics.add(reason, 1, || format!("{path}.rotation"));
        DQuat::IDENTITY
    });
    let (scale, translation) = (node.scale(), node.translation());
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
}
