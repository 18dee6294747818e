//! The shape of a mesh at a node: as it was modelled, morphed, or skinned.

use std::sync::Arc;

use glam::DAffine3;

use super::mesh::PrimitiveMesh;
use super::nodes::SceneNode;
use super::skin::{self, SkinJoints};
use super::{ImportedPrimitive, Importer, provenance};
use crate::error::Result;
use crate::load::gltf::json::at_path;
use crate::load::limits::Limit;
use crate::scene::MeshId;
use crate::scene::animation::{Animated, Curve, Deformation, Joint, Skin};

/// The number of morph targets that take as long to add to a vertex as it takes to skin it.
const TARGETS_PER_VERTEX: usize = 16;

impl Importer<'_> {
    /// Returns the mesh of a primitive as it is at a node, which is added to the scene if it is
    /// new; and true if joints determine its position, whatever the transform of the node.
    pub(super) fn mesh_at_node(
        &mut self,
        primitive: &ImportedPrimitive,
        node: &SceneNode,
    ) -> Result<(MeshId, bool)> {
        let PrimitiveMesh { mesh: base, morph_targets, influences, .. } = &primitive.mesh;

        // The joints of the skin, if there is one.
        let by = format!("nodes[{}].skin", node.index);
        let skin = match (node.node.skin, influences) {
            (Some(skin), Some(influences)) => {
                let joints = self.joints(skin.value(), &by)?;
                let stray = influences.count_out_of_range(joints.still.len());
                let reason = "{} corners hang on joints that their skin does not have";
                self.diagnostics.add(reason, stray, || by);
                Some((joints, influences.clone()))
            }
            _ => None,
        };

        // The weights of the morph targets: those of the node, or else of the mesh.
        let mesh = node.node.mesh.and_then(|mesh| self.root.meshes.get(mesh.value()));
        let of_mesh = mesh.and_then(|mesh| mesh.weights.as_ref());
        let own = node.node.weights.as_ref().or(of_mesh);
        let weight = |i: usize| own.and_then(|w| w.get(i)).map_or(0.0, |w| f64::from(*w));
        let weights: Vec<_> = (0..morph_targets.len()).map(weight).collect();
        let curves = self.clip.weights.get(&node.index).filter(|c| c.len() == morph_targets.len());
        let is_morphed = curves.is_some() || weights.iter().any(|weight| *weight != 0.0);
        // Without either the mesh is shared by all nodes that show it.
        if skin.is_none() && !is_morphed {
            return Ok((self.add_mesh_once(primitive), false));
        }

        // The mesh as it is deformed at rest.
        let path = format_args!("nodes[{}]", node.index);
        let sandbox = self.accessors.buffers.sandbox;
        let targets = match curves {
            Some(curves) => curves.len(),
            None => weights.iter().filter(|weight| **weight != 0.0).count(),
        };
        let sets = influences.as_ref().filter(|_| skin.is_some()).map_or(0, |i| i.per_vertex / 4);
        let work = 1.max(sets) + targets / TARGETS_PER_VERTEX;
        let joints = skin.as_ref().map_or(0, |(joints, _)| joints.still.len());
        let count = (base.positions.len() as u64).saturating_mul(work as u64) + joints as u64;
        sandbox.consume(Limit::Deformed, count).map_err(at_path(path))?;
        let mut deformation = Deformation {
            base: base.clone(),
            morph_targets: morph_targets.clone(),
            weights: weights.into_iter().map(Curve::constant).collect(),
            period: None,
            // The joints stand as the file places them, in world space.
            skin: skin.as_ref().map(|(joints, influences)| Skin {
                joints: joints.still.clone(),
                influences: influences.clone(),
                space: Joint {
                    node: None,
                    transform: DAffine3::IDENTITY,
                    inverse_bind: DAffine3::IDENTITY,
                },
            }),
        };
        let id = self.scene.add_mesh(deformation.deform(0.0, &[]));
        provenance::record_mesh(&mut self.scene, primitive);
        // Each shape is stored, and counted as read.
        self.diagnostics.read(base.triangles.len() as u64);

        // The same as it moves.
        if curves.is_some() || skin.as_ref().is_some_and(|(joints, _)| joints.is_animated) {
            // Weights without curves stay as they are.
            if let Some(curves) = curves {
                deformation.weights.clone_from(curves);
            }
            deformation.period = self.clip.period();
            if let (Some(skin), Some((joints, _))) = (&mut deformation.skin, &skin) {
                skin.joints = joints.animated.clone();
            }
            let (mesh, deformation) = (id.0 as usize, Box::new(deformation));
            self.clip.objects.push(Animated::Mesh { mesh, deformation });
        }
        Ok((id, skin.is_some()))
    }

    /// Returns the joints of a skin, which are read once.
    fn joints(&mut self, skin: usize, by: &str) -> Result<SkinJoints> {
        if let Some(known) = self.joints.get(&skin) {
            return Ok(known.clone());
        }
        let joints = skin::read_joints(&self.accessors, self.nodes, skin, by)?;
        self.joints.insert(skin, joints.clone());
        Ok(joints)
    }

    /// Adds a mesh to the scene as it was modelled, once for all nodes that show it.
    fn add_mesh_once(&mut self, primitive: &ImportedPrimitive) -> MeshId {
        let mesh = &primitive.mesh.mesh;
        if let Some(known) = self.mesh_ids.get(&Arc::as_ptr(mesh)) {
            return *known;
        }
        self.diagnostics.read(mesh.triangles.len() as u64);
        self.scene.meshes.push(mesh.clone());
        provenance::record_mesh(&mut self.scene, primitive);
        let id = MeshId(self.scene.meshes.len() as u32 - 1);
        self.mesh_ids.insert(Arc::as_ptr(mesh), id);
        id
    }
}
