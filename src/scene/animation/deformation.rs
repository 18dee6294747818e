//! The deformation of meshes: morph targets, and skinning by joints.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::{Curve, NodeId};
use crate::scene::{GRAIN, Mesh};

/// The deformation of a mesh: first by morph targets, then by skinning, as in glTF 2.0 (parts 3.7.2.2
/// and 3.7.3.3).
#[derive(Clone, Debug, PartialEq)]
pub struct Deformation {
    /// The undeformed mesh.
    pub base: Arc<Mesh>,
    /// The morph targets.
    pub morph_targets: Arc<[MorphTarget]>,
    /// The weights of the morph targets: one curve for each.
    pub weights: Vec<Curve<f64>>,
    /// The time in seconds after which the weights repeat, above 0; none if they do not.
    pub period: Option<f64>,
    /// The skin, if it has one.
    pub skin: Option<Skin>,
}

/// A morph target: what is added to the vertices at full weight. Each list is empty, or as long as
/// the mesh's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    /// The displacements of the positions.
    pub positions: Vec<[f32; 3]>,
    /// The changes of the normals.
    pub normals: Vec<[f32; 3]>,
}

/// A skin: joints, and their influences on the vertices of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// The joints, which all meshes of a skin share.
    pub joints: Arc<[Joint]>,
    /// The influences of the joints; meshes of the same glTF primitive share them.
    pub influences: Arc<Influences>,
    /// The space of the skinned mesh's instances, as a joint without a bind matrix: skinning gives
    /// positions in world space, which are then taken into this space.
    pub space: Joint,
}

/// A joint of a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// The node that it is attached to; none for the world.
    pub node: Option<NodeId>,
    /// The transform from the joint's space to the node's.
    pub transform: DAffine3,
    /// The inverse bind matrix: from the space of the undeformed mesh to the joint's.
    pub inverse_bind: DAffine3,
}

/// The joints that influence each vertex, with their weights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Influences {
    /// The number of joints of each vertex.
    pub per_vertex: usize,
    /// The indices of the joints, vertex by vertex.
    pub joints: Vec<u16>,
    /// The weights of the joints, vertex by vertex, of any sum; where that is 0 the vertex moves with
    /// its first joint.
    pub weights: Vec<f32>,
}

/// The pose of a deformation: all values that its shape depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pose {
    weights: Vec<f64>,
    /// For each joint the transform from the base's space to the deformed mesh's.
    joints: Vec<DAffine3>,
}

impl Joint {
    /// The transform from the joint's space to world space.
    fn world_transform(&self, worlds: &[DAffine3]) -> DAffine3 {
        let in_world = |NodeId(node)| worlds[node as usize] * self.transform;
        self.node.map_or(self.transform, in_world)
    }
}

impl Deformation {
    /// The deformed mesh at a time in seconds, given the nodes' transforms to world space then.
    ///
    /// # Panics
    /// When a joint's node does not exist.
    pub fn deform(&self, time: f64, worlds: &[DAffine3]) -> Mesh {
        self.deform_to(&self.pose(time, worlds))
    }

    /// The pose at a time in seconds, given the nodes' transforms to world space then.
    pub(super) fn pose(&self, time: f64, worlds: &[DAffine3]) -> Pose {
        let time = self.period.map_or(time, |period| time.rem_euclid(period));
        let weights = self.weights.iter().map(|curve| curve.sample(time)).collect();
        let joints = self.skin.as_ref().map_or(Vec::new(), |skin| {
            // Not finite where the space is flat, and its instances invisible.
            let space = skin.space.world_transform(worlds).inverse();
            let bound_to_world = |joint: &Joint| joint.world_transform(worlds) * joint.inverse_bind;
            // Joints that no vertex names, which may be many, are not posed.
            let is_named = skin.influences.named_joints(skin.joints.len());
            let posed = skin.joints.iter().zip(is_named).map(|(joint, is_named)| {
                if is_named { space * bound_to_world(joint) } else { DAffine3::IDENTITY }
            });
            posed.collect()
        });
        Pose { weights, joints }
    }

    /// The mesh deformed to a pose.
    pub(super) fn deform_to(&self, pose: &Pose) -> Mesh {
        let mut mesh = Mesh::clone(&self.base);
        let targets = self.morph_targets.iter().zip(pose.weights.iter().copied());
        let targets: Vec<(&MorphTarget, f64)> = targets.filter(|(_, w)| *w != 0.0).collect();
        // Positions, in f64, and normals.
        let displacements = fitting(mesh.positions.len(), &targets, |target| &target.positions);
        if !displacements.is_empty() {
            mesh.positions = mesh.positions.map(|i, p| displaced(p, i, &displacements));
        }
        let changes = fitting(mesh.normals.len(), &targets, |target| &target.normals);
        if !changes.is_empty() {
            let normals = mesh.normals.par_iter_mut().with_min_len(GRAIN).enumerate();
            normals.for_each(|(i, normal)| {
                let sum = displaced(DVec3::from(normal.map(f64::from)), i, &changes);
                *normal = sum.as_vec3().to_array();
            });
        }
        if let Some(skin) = &self.skin {
            skin.influences.skin(&mut mesh, &pose.joints);
        }
        mesh
    }
}

/// Returns an attribute of the morph targets that have it for all vertices, with their weights.
fn fitting<'m>(
    count: usize,
    targets: &[(&'m MorphTarget, f64)],
    attribute: impl Fn(&'m MorphTarget) -> &'m Vec<[f32; 3]>,
) -> Vec<(&'m [[f32; 3]], f64)> {
    let values = targets.iter().map(|(target, weight)| (&**attribute(target), *weight));
    values.filter(|(values, _)| values.len() == count).collect()
}

/// Adds the weighted displacements of a vertex to a vector.
fn displaced(vector: DVec3, vertex: usize, displacements: &[(&[[f32; 3]], f64)]) -> DVec3 {
    displacements
        .iter()
        .fold(vector, |sum, (by, weight)| sum + DVec3::from(by[vertex].map(f64::from)) * *weight)
}

impl Influences {
    /// The number of influences, of weights other than 0, by joints beyond the first `count`.
    pub(crate) fn count_out_of_range(&self, count: usize) -> u64 {
        let named = self.joints.iter().zip(&self.weights);
        named.filter(|(joint, w)| **w != 0.0 && usize::from(**joint) >= count).count() as u64
    }

    /// Tells for each of the first `count` joints whether a vertex names it.
    fn named_joints(&self, count: usize) -> Vec<bool> {
        let mut is_named = vec![false; count];
        for &joint in &self.joints {
            if let Some(is_named) = is_named.get_mut(usize::from(joint)) {
                *is_named = true;
            }
        }
        is_named
    }

    /// Reduces the influences to those of some vertices, in the order given.
    pub(crate) fn retain_vertices(&mut self, vertices: &[usize]) {
        let joints = vertices.iter().flat_map(|&v| &self.joints[self.range(v)]).copied().collect();
        self.weights =
            vertices.iter().flat_map(|&v| &self.weights[self.range(v)]).copied().collect();
        self.joints = joints;
    }

    /// The range of a vertex's influences.
    fn range(&self, vertex: usize) -> std::ops::Range<usize> {
        vertex * self.per_vertex..(vertex + 1) * self.per_vertex
    }

    /// Applies linear blend skinning, in f64: each vertex and its tangent are transformed by the
    /// weighted mean of its joints' transforms, and its normal by the cofactors of that mean, which
    /// keeps it perpendicular under any scale.
    fn skin(&self, mesh: &mut Mesh, joints: &[DAffine3]) {
        // Positions.
        let vertices = (0..mesh.positions.len()).into_par_iter().with_min_len(GRAIN);
        let transforms: Vec<DAffine3> =
            vertices.map(|i| self.blended_transform(i, joints)).collect();
        mesh.positions = mesh.positions.map(|i, p| transforms[i].transform_point3(p));

        // Tangents, whose sign changes where the transform mirrors.
        let tangents = mesh.tangents.par_iter_mut().with_min_len(GRAIN).zip(&transforms);
        tangents.for_each(|([x, y, z, hand], m)| {
            let m = &m.matrix3;
            let turned = *m * DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z));
            if let Some(turned) = turned.try_normalize() {
                [*x, *y, *z] = turned.as_vec3().to_array();
                *hand *= m.determinant().signum() as f32;
            }
        });

        // Normals, where the transform leaves them a direction.
        let normals = mesh.normals.par_iter_mut().with_min_len(GRAIN).zip(transforms);
        normals.for_each(|(normal, m)| {
            let m = m.matrix3;
            let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
            let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
            let turned = cofactors * DVec3::from(normal.map(f64::from)) * m.determinant().signum();
            if let Some(turned) = turned.try_normalize() {
                *normal = turned.as_vec3().to_array();
            }
        });
    }

    /// The weighted mean of the transforms of a vertex's joints.
    fn blended_transform(&self, vertex: usize, joints: &[DAffine3]) -> DAffine3 {
        let range = self.range(vertex);
        let (ids, weights) = (&self.joints[range.clone()], &self.weights[range]);
        let joint = |id: u16| joints.get(usize::from(id)).copied().unwrap_or_default();
        let total: f64 = weights.iter().map(|w| f64::from(*w)).sum();
        if total <= 0.0 {
            return ids.first().map_or(DAffine3::IDENTITY, |id| joint(*id));
        }
        let mut mean = DAffine3::ZERO;
        for (&id, &weight) in ids.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            let (joint, share) = (joint(id), f64::from(weight) / total);
            mean.matrix3 += joint.matrix3 * share;
            mean.translation += joint.translation * share;
        }
        mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three vertices along x, with normals along y.
    fn base() -> Arc<Mesh> {
        Arc::new(Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]].into(),
            normals: vec![[0.0, 1.0, 0.0]; 3],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        })
    }

    fn joint(place: DAffine3) -> Joint {
        Joint { node: None, transform: place, inverse_bind: DAffine3::IDENTITY }
    }

    fn bent(joints: Vec<Joint>, space: DAffine3, ids: [u16; 6], weights: [f32; 6]) -> Mesh {
        let influences =
            Influences { per_vertex: 2, joints: ids.to_vec(), weights: weights.to_vec() };
        let (joints, influences) = (joints.into(), Arc::new(influences));
        let skin = Skin { joints, influences, space: joint(space) };
        let (morphs, weights) = ([].into(), vec![]);
        Deformation { base: base(), morph_targets: morphs, weights, period: None, skin: Some(skin) }
            .deform(0.0, &[])
    }

    fn morphed(weight: f64) -> Mesh {
        let morph =
            MorphTarget { positions: vec![[0.0, 0.0, 4.0]; 3], normals: vec![[2.0, 0.0, 0.0]; 3] };
        let weights = vec![Curve::constant(weight)];
        let morphs = [morph].into();
        Deformation { base: base(), morph_targets: morphs, weights, period: None, skin: None }
            .deform(0.0, &[])
    }

    #[test]
    fn tangents_turn_with_their_joints_and_change_hands_in_a_mirror() {
        let bent = |by: DMat3| {
            let base = Mesh { tangents: vec![[1.0, 0.0, 0.0, 1.0]; 3], ..Mesh::clone(&base()) };
            let influences =
                Influences { per_vertex: 1, joints: vec![0; 3], weights: vec![1.0; 3] };
            let joints = [joint(DAffine3::from_mat3(by))].into();
            let skin =
                Skin { joints, influences: Arc::new(influences), space: joint(DAffine3::IDENTITY) };
            let (base, morphs) = (Arc::new(base), [].into());
            let deformation = Deformation {
                base,
                morph_targets: morphs,
                weights: vec![],
                period: None,
                skin: Some(skin),
            };
            deformation.deform(0.0, &[]).tangents[1]
        };
        let quarter = DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z);
        assert_eq!(bent(quarter), [0.0, 1.0, 0.0, 1.0]);
        assert_eq!(bent(DMat3::from_diagonal(DVec3::new(-2.0, 1.0, 1.0))), [-1.0, 0.0, 0.0, -1.0]);
    }

    #[test]
    fn morphs_add_their_share_to_positions_and_normals() {
        let mesh = morphed(0.5);
        assert_eq!(mesh.positions.at(1), DVec3::new(1.0, 0.0, 2.0));
        assert_eq!(mesh.normals[1], [1.0, 1.0, 0.0]);
    }

    #[test]
    fn morphs_of_no_weight_change_nothing() {
        assert_eq!(morphed(0.0), *base());
    }

    #[test]
    fn vertices_go_by_the_mean_of_their_joints() {
        let up = DAffine3::from_translation(DVec3::Y * 2.0);
        let joints = vec![joint(DAffine3::IDENTITY), joint(up)];
        let weights = [1.0, 0.0, 0.5, 0.5, 0.0, 1.0];
        let mesh = bent(joints, DAffine3::IDENTITY, [0, 1, 0, 1, 0, 1], weights);
        assert_eq!(mesh.positions, [[0., 0., 0.], [1., 1., 0.], [2., 2., 0.]]);
    }

    #[test]
    fn weights_count_by_their_share_of_the_sum() {
        let up = DAffine3::from_translation(DVec3::Y * 4.0);
        let joints = vec![joint(DAffine3::IDENTITY), joint(up)];
        let weights = [1.0, 3.0, 3.0, 1.0, 0.0, 0.0];
        let mesh = bent(joints, DAffine3::IDENTITY, [0, 1, 0, 1, 1, 0], weights);
        let heights: Vec<f64> = mesh.positions.iter().map(|p| p.y).collect();
        assert_eq!(heights, [3.0, 1.0, 4.0]);
    }

    #[test]
    fn normals_stay_upright_on_what_is_stretched() {
        let stretched = DAffine3::from_scale(DVec3::new(3.0, 0.5, 1.0));
        let turned = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let joints = vec![joint(turned * stretched); 2];
        let mesh = bent(joints, DAffine3::IDENTITY, [0; 6], [1.0; 6]);
        let [x, y, _] = mesh.normals[0];
        assert!((x + 1.0).abs() < 1e-6 && y.abs() < 1e-6, "{x} {y}");
    }

    #[test]
    fn the_space_of_the_instances_is_taken_out_again() {
        let space = DAffine3::from_translation(DVec3::X * 7.0);
        let joints = vec![joint(space); 2];
        assert_eq!(bent(joints, space, [0; 6], [1.0; 6]).positions, base().positions);
    }
}
