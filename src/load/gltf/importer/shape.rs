//! The shape of a mesh at a node: as it was modelled, morphed, or bent by joints.

use std::sync::Arc;

use glam::DAffine3;

use super::{Importer, Made};
use crate::error::{Error, Place, Result};
use crate::load::gltf::deform::{self, Joints};
use crate::load::gltf::nodes::Placed;
use crate::load::gltf::primitive::Part;
use crate::load::limits::Limit;
use crate::scene::MeshId;
use crate::scene::animation::{Animated, Curve, Deformation, Joint, Skin};

impl Importer<'_> {
    /// The mesh of a part as it stands at a node, and whether joints have bent it.
    pub(super) fn shape(&mut self, made: &Made, placed: &Placed) -> Result<(MeshId, bool)> {
        let Part { mesh: base, morphs, influences } = &made.part;
        let by = format!("nodes[{}].skin", placed.index);
        let skin = match (placed.node.skin, influences) {
            (Some(skin), Some(influences)) => {
                let joints = self.joints(skin.value(), &by)?;
                let stray = influences.count_out_of_range(joints.still.len());
                let reason = "{} corners hang on joints that their skin does not have";
                self.tally.add(reason, stray, || by.clone());
                Some((joints, influences.clone()))
            }
            _ => None,
        };
        let mesh = placed.node.mesh.map_or(usize::MAX, |mesh| mesh.value());
        let of_mesh = self.root.meshes.get(mesh).and_then(|mesh| mesh.weights.as_ref());
        let own = placed.node.weights.as_ref().or(of_mesh);
        let weight = |i: usize| own.and_then(|w| w.get(i)).map_or(0.0, |w| f64::from(*w));
        let weights: Vec<_> = (0..morphs.len()).map(weight).collect();
        let curves = self.clip.weights(placed.index).filter(|c| c.len() == morphs.len());
        let is_morphed = curves.is_some() || weights.iter().any(|weight| *weight != 0.0);
        if skin.is_none() && !is_morphed {
            return Ok((self.store(made, mesh), false));
        }
        let count = base.positions.len() as u64;
        let at = |e: Error| e.place(Place::Json(format!("nodes[{}]", placed.index)));
        self.guard.take(Limit::Deformed, count).map_err(at)?;
        let mut deformation = Deformation {
            base: base.clone(),
            morph_targets: morphs.clone(),
            weights: weights.into_iter().map(Curve::constant).collect(),
            period: None,
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
        // Read once, and stored as often as it has shapes.
        self.tally.read(base.triangles.len() as u64);
        let moves = skin.as_ref().is_some_and(|(joints, _)| joints.moves);
        if curves.is_some() || moves {
            if let Some(curves) = curves {
                deformation.weights = curves.to_vec();
            }
            deformation.period = self.clip.repeats();
            if let (Some(skin), Some((joints, _))) = (&mut deformation.skin, &skin) {
                skin.joints.clone_from(&joints.moving);
            }
            let (mesh, deformation) = (id.0 as usize, Box::new(deformation));
            self.clip.movers.push(Animated::Mesh { mesh, deformation });
        }
        Ok((id, skin.is_some()))
    }

    fn joints(&mut self, skin: usize, by: &str) -> Result<Joints> {
        if let Some(known) = self.joints.get(&skin) {
            return Ok(known.clone());
        }
        let joints = deform::joints(self.root, &self.accessors, self.nodes, skin, by)?;
        self.joints.insert(skin, joints.clone());
        Ok(joints)
    }

    /// Stores a part as it was modelled, once for all nodes.
    fn store(&mut self, made: &Made, mesh: usize) -> MeshId {
        let mut all = self.meshes.get_mut(&mesh).into_iter().flatten();
        let stored = all.find(|m| Arc::ptr_eq(&m.part.mesh, &made.part.mesh));
        match stored.as_ref().and_then(|m| m.stored) {
            Some(id) => id,
            None => {
                self.tally.read(made.part.mesh.triangles.len() as u64);
                self.scene.meshes.push(made.part.mesh.clone());
                let id = MeshId(self.scene.meshes.len() as u32 - 1);
                stored.into_iter().for_each(|m| m.stored = Some(id));
                id
            }
        }
    }
}
