//! From the nodes of a file to what stands in the scene.

mod place;
mod shape;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use glam::DAffine3;
use gltf::json;
use gltf::json::Value;

use super::accessor::Accessors;
use super::animation::Clip;
use super::buffers::get;
use super::deform::{self, Joints};
use super::material::Materials;
use super::nodes::Placed;
use super::primitive::{self, Part};
use super::variants::Variants;
use super::{instancing, lights, shapes};
use crate::error::{Error, Place, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::limits::Limit;
use crate::load::report::{LoadReport, Loaded};
use crate::load::sandbox::Sandbox;
use crate::scene::animation::Animated;
use crate::scene::{MaterialId, MeshId, Scene};

/// A primitive in the scene.
#[derive(Clone)]
pub struct Made {
    part: Part,
    material: MaterialId,
    /// The mesh as it was modelled, where it stands like that.
    stored: Option<MeshId>,
}

/// A file on its way to a scene, node by node.
pub struct Importer<'a> {
    pub(super) root: &'a json::Root,
    pub(super) guard: &'a Sandbox,
    /// The same as it stands in the file.
    pub(super) json: &'a Value,
    pub(super) accessors: Accessors<'a>,
    pub(super) materials: Materials<'a>,
    pub(super) variants: Variants<'a>,
    /// What the primitives of a mesh became, so that nodes share it.
    pub(super) meshes: HashMap<usize, Vec<Made>>,
    pub(super) nodes: &'a HashMap<usize, Placed<'a>>,
    /// The joints of the skins so far.
    pub(super) joints: HashMap<usize, Joints>,
    pub(super) scene: Scene,
    pub(super) clip: Clip,
    pub(super) tally: Diagnostics,
}

impl Importer<'_> {
    /// Adds what a node shows.
    ///
    /// # Errors
    /// When it refers to what is not there or cannot be read.
    pub fn node(&mut self, placed: &Placed) -> Result<()> {
        if let Some(camera) = lights::camera(self.root, placed, &mut self.tally)? {
            self.move_camera(placed)?;
            self.scene.cameras.push(camera);
        }
        if let Some(light) = lights::light(self.root, placed, &mut self.tally)? {
            self.move_light(placed)?;
            self.scene.lights.push(light);
        }
        if let Some((shape, material)) = shapes::of(self.root, placed)? {
            self.implicit(shape, material, placed)?;
        }
        let Some(mesh) = placed.node.mesh else { return Ok(()) };
        let by = format!("nodes[{}].mesh", placed.index);
        let parts = self.mesh(mesh.value(), &by)?;
        let places = instancing::places(placed, self.guard, &self.accessors, &mut self.tally)?;
        let places = places.unwrap_or_else(|| vec![DAffine3::IDENTITY]);
        if places.is_empty() {
            return Ok(());
        }
        let count = self.scene.instances.len() as u64 + (parts.len() * places.len()) as u64;
        let at = |e: Error| e.place(Place::Json(by.clone()));
        self.guard.check(Limit::Instances, count).map_err(at)?;
        parts.iter().try_for_each(|part| self.place(part, placed, &places, &by))
    }

    /// Makes the next camera of the scene move with its node.
    fn move_camera(&mut self, placed: &Placed) -> Result<()> {
        // What there is to say of it was said of it as the file places it.
        let mut quiet = Diagnostics::default();
        if placed.mover.is_some()
            && let Some(rest) = lights::camera(self.root, &placed.at_rest(), &mut quiet)?
        {
            let (camera, node) = (self.scene.cameras.len(), placed.mover);
            let (aim, lens) = (None, None);
            self.clip.movers.push(Animated::Camera { camera, node, rest, aim, lens });
        }
        Ok(())
    }

    /// Makes the next light of the scene move with its node.
    fn move_light(&mut self, placed: &Placed) -> Result<()> {
        let mut quiet = Diagnostics::default();
        if placed.mover.is_some()
            && let Some(rest) = lights::light(self.root, &placed.at_rest(), &mut quiet)?
        {
            let (light, node) = (self.scene.lights.len(), placed.mover);
            let (direction, intensity) = (None, None);
            self.clip.movers.push(Animated::Light { light, node, rest, direction, intensity });
        }
        Ok(())
    }

    /// The meshes that the primitives of a mesh become, each with its material.
    fn mesh(&mut self, index: usize, by: &str) -> Result<Vec<Made>> {
        if let Some(parts) = self.meshes.get(&index) {
            return Ok(parts.clone());
        }
        let source = get(&self.root.meshes, index, "mesh", by)?;
        let mut parts = Vec::new();
        for (i, primitive) in source.primitives.iter().enumerate() {
            let at = format!("meshes[{index}].primitives[{i}]");
            let (material, place) = self.variants.material(primitive, &at);
            let made = self.materials.get(material, &place, &mut self.scene, &mut self.tally)?;
            let read =
                primitive::read(primitive, &self.accessors, &made.asks, &mut self.tally, &at)?;
            let lost = deform::not_morphed(self.json, index, i);
            let reason = "{} texture coordinates and colours of morph targets are not morphed";
            self.tally.unsupported(reason, lost, || format!("{at}.targets"));
            if let Some(mut part) = read {
                let size = [
                    (Limit::Vertices, part.mesh.positions.len()),
                    (Limit::Triangles, part.mesh.triangles.len()),
                ];
                for (limit, count) in size {
                    let place = || Place::Json(at.clone());
                    self.guard.take(limit, count as u64).map_err(|e| e.place(place()))?;
                }
                if let (Some(name), Some(mesh)) = (&source.name, Arc::get_mut(&mut part.mesh)) {
                    mesh.name.clone_from(name);
                }
                parts.push(Made { part, material: made.id, stored: None });
            }
        }
        self.meshes.insert(index, parts.clone());
        Ok(parts)
    }

    /// The scene and the load report, once all nodes are added.
    pub fn finish(mut self, path: &Path) -> Loaded {
        self.scene.animation = self.clip.finish();
        self.materials.decode(&mut self.scene, &mut self.tally);
        let Scene { instances, spheres, planes, .. } = &self.scene;
        if instances.is_empty() && spheres.is_empty() && planes.is_empty() {
            self.tally.say("there is no triangle in the scene that the file shows");
        }
        let report = self.tally.finish(path, &self.scene);
        let variants = self.variants.names();
        Loaded { scene: self.scene, report: LoadReport { variants, ..report } }
    }
}
