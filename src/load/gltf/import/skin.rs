//! Skins: joints, and their influence on vertices.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DAffine3, DMat4};
use gltf::json::mesh::Semantic;

use super::mesh::PrimitiveReader;
use super::nodes::SceneNode;
use crate::error::Result;
use crate::load::gltf::accessor::Accessors;
use crate::load::gltf::json::{at_path, error_at, lookup};
use crate::load::limits::Limit;
use crate::scene::animation::{Influences, Joint};

/// The number of deformed vertices that take as much memory as a joint.
const JOINT_WEIGHT: u64 = 4;

impl PrimitiveReader<'_> {
    /// Reads how joints influence the `count` vertices of a primitive, if they do.
    ///
    /// # Errors
    /// When an accessor cannot be read, or is not as long as the positions.
    pub(super) fn influences(&mut self, count: usize) -> Result<Option<Influences>> {
        let Self { accessors, path, .. } = *self;
        let index = |semantic| self.accessor(semantic);
        let sets = (0..).map_while(|n| index(Semantic::Joints(n)).zip(index(Semantic::Weights(n))));

        // The sets side by side for each vertex: each has four joints. They are kept in less memory than
        // they are read in, set by set.
        let sets: Vec<_> = sets.collect();
        let per_vertex = 4 * sets.len();
        accessors.count_influences(sets.len(), count).map_err(at_path(path))?;
        let mut influences = Influences {
            per_vertex,
            joints: vec![0; per_vertex * count],
            weights: vec![0.0; per_vertex * count],
        };
        let mut bad = 0;
        for (n, (joints, weights)) in sets.into_iter().enumerate() {
            let path = |name: &str| format!("{path}.attributes.{name}_{n}");
            let joints = accessors.floats::<4>(joints, &path("JOINTS"))?;
            let weights = accessors.normalized_floats::<4>(weights, &path("WEIGHTS"))?;
            for (found, name) in [(joints.len(), "JOINTS"), (weights.len(), "WEIGHTS")] {
                if found != count {
                    let message = format!("{found} values for {count} vertices");
                    return Err(error_at(path(name), message));
                }
            }
            let to = influences.joints.chunks_exact_mut(per_vertex).zip(joints);
            to.for_each(|(to, joints)| to[4 * n..][..4].copy_from_slice(&joints.map(|j| j as u16)));
            let to = influences.weights.chunks_exact_mut(per_vertex).zip(weights);
            to.for_each(|(to, weights)| {
                to[4 * n..][..4].copy_from_slice(&weights.map(|weight| {
                    let is_valid = weight.is_finite() && weight >= 0.0;
                    bad += u64::from(!is_valid);
                    if is_valid { weight } else { 0.0 }
                }));
            });
        }
        // Without joints and weights the mesh is rigid.
        if per_vertex == 0 {
            return Ok(None);
        }

        // A vertex without any weight hangs on its first joint.
        let is_weightless = |weights: &&[f32]| weights.iter().all(|weight| *weight == 0.0);
        let without_weight =
            influences.weights.chunks_exact(per_vertex).filter(is_weightless).count();
        let path = || format!("{path}.attributes.WEIGHTS_0");
        self.diagnostics.add(
            "{} weights of joints are negative or not finite and become 0",
            bad,
            path,
        );
        let reason = "{} vertices have no weight at any joint and hang on their first";
        self.diagnostics.add(reason, without_weight as u64, path);
        Ok(Some(influences))
    }
}

/// The joints of a skin, which all nodes that it deforms a mesh at share.
#[derive(Clone)]
pub struct SkinJoints {
    /// The joints with the transforms that the file gives them.
    pub still: Arc<[Joint]>,
    /// The joints as they move with the nodes of the animation.
    pub animated: Arc<[Joint]>,
    /// True if any of them moves.
    pub is_animated: bool,
}

/// Reads the joints of a skin, to which the JSON path `by` refers.
///
/// # Errors
/// When a reference leads nowhere, or the matrices cannot be read.
pub fn read_joints(
    accessors: &Accessors,
    nodes: &HashMap<usize, SceneNode>,
    skin: usize,
    by: &str,
) -> Result<SkinJoints> {
    let root = accessors.buffers.root;
    let source = lookup(&root.skins, skin, "skin", by)?;
    let count = source.joints.len();
    let charged = JOINT_WEIGHT * count as u64;
    accessors.buffers.sandbox.consume(Limit::Deformed, charged).map_err(at_path(by))?;
    let path = format!("skins[{skin}].inverseBindMatrices");
    // The inverse bind matrices take the space of the mesh to that of each joint.
    let matrices = match source.inverse_bind_matrices {
        Some(index) => accessors.floats::<16>(index.value(), &path)?,
        None => vec![DMat4::IDENTITY.as_mat4().to_cols_array(); count],
    };
    if matrices.len() < count {
        return Err(error_at(path, format!("{} matrices for {count} joints", matrices.len())));
    }
    if !matrices.as_flattened().iter().all(|x| x.is_finite()) {
        return Err(error_at(path, "a matrix has a number that is not finite"));
    }
    let (mut still_joints, mut animated_joints) = (Vec::new(), Vec::new());
    let mut is_animated = false;

    // Each joint as the file places it, and as it moves with the animation.
    for (i, (joint, matrix)) in source.joints.iter().zip(&matrices).enumerate() {
        let by = format_args!("skins[{skin}].joints[{i}]");
        lookup(&root.nodes, joint.value(), "node", by)?;
        let inverse_bind = DAffine3::from_mat4(DMat4::from_cols_array(&matrix.map(f64::from)));
        // A node that no scene has stands at the origin.
        let mut still = Joint { node: None, transform: DAffine3::IDENTITY, inverse_bind };
        let mut animated = still;
        if let Some(node) = nodes.get(&joint.value()) {
            still.transform = node.to_world;
            (animated.node, animated.transform) = (node.animated, node.to_animated);
        }
        is_animated |= animated.node.is_some();
        still_joints.push(still);
        animated_joints.push(animated);
    }
    Ok(SkinJoints { still: still_joints.into(), animated: animated_joints.into(), is_animated })
}
