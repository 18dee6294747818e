//! glTF 2.0 files, text and binary.
//!
//! The `gltf` crate gives the types of the JSON; whatever follows an index, an offset or a URI is
//! done here, checked, since the crate's own readers trust the file. What is read, and how it maps
//! to a scene, stands in docs/formats.md.

mod accessor;
mod buffers;
mod compact;
mod container;
mod document;
mod extensions;
mod lights;
mod material;
mod nodes;
mod optics;
mod primitive;
mod texture;
mod topology;

use std::collections::HashMap;
use std::path::Path;

use gltf::json;

use self::accessor::Accessors;
use self::buffers::{Buffers, get};
use self::material::Materials;
use self::nodes::Placed;
use self::texture::Textures;
use crate::error::Result;
use crate::load::tally::Tally;
use crate::scene::{Instance, MaterialId, MeshId, Scene};

/// Loads a `.gltf` or `.glb` file.
///
/// # Errors
/// When it cannot be read, is damaged, or requires an extension that isn't read; the error names
/// the place in the JSON.
pub fn load(path: &Path) -> Result<Scene> {
    let bytes = super::read(path)?;
    import(path, &bytes).map_err(|e| e.at(path))
}

fn import(path: &Path, bytes: &[u8]) -> Result<Scene> {
    let (json, bin) = container::split(bytes)?;
    let root = document::parse(json)?;
    let mut tally = Tally::default();
    extensions::check(&root, &mut tally)?;
    let buffers = Buffers::new(&root, path, bin);
    let mut importer = Importer {
        root: &root,
        accessors: Accessors::new(&root, &buffers),
        materials: Materials::new(&root, Textures::new(&root, &buffers)),
        meshes: HashMap::new(),
        scene: Scene::default(),
        tally,
    };
    for placed in nodes::walk(&root, &mut importer.tally)? {
        importer.node(&placed)?;
    }
    Ok(importer.finish(path))
}

struct Importer<'a> {
    root: &'a json::Root,
    accessors: Accessors<'a>,
    materials: Materials<'a>,
    /// What the primitives of a mesh became, so that nodes share it.
    meshes: HashMap<usize, Vec<(MeshId, MaterialId)>>,
    scene: Scene,
    tally: Tally,
}

impl Importer<'_> {
    fn node(&mut self, placed: &Placed) -> Result<()> {
        if let Some(camera) = lights::camera(self.root, placed, &mut self.tally)? {
            self.scene.cameras.push(camera);
        }
        if let Some(light) = lights::light(self.root, placed, &mut self.tally)? {
            self.scene.lights.push(light);
        }
        let Some(mesh) = placed.node.mesh else { return Ok(()) };
        let by = format!("nodes[{}].mesh", placed.index);
        let parts = self.mesh(mesh.value(), &by)?;
        if placed.node.skin.is_some() {
            let reason = "{} skinned meshes stand as they were modelled, not as posed";
            self.tally.add(reason, 1, || by.clone());
        }
        let determinant = placed.world.matrix3.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            let reason = "{} meshes are not drawn: their scale is 0 along some direction";
            self.tally.add(reason, 1, || by);
            return Ok(());
        }
        let instances =
            parts.into_iter().map(|(mesh, material)| Instance::new(mesh, placed.world, material));
        self.scene.instances.extend(instances);
        Ok(())
    }

    /// The meshes that the primitives of a mesh become, each with its material.
    fn mesh(&mut self, index: usize, by: &str) -> Result<Vec<(MeshId, MaterialId)>> {
        if let Some(parts) = self.meshes.get(&index) {
            return Ok(parts.clone());
        }
        let source = get(&self.root.meshes, index, "mesh", by)?;
        let mut parts = Vec::new();
        for (i, primitive) in source.primitives.iter().enumerate() {
            let at = format!("meshes[{index}].primitives[{i}]");
            let material = primitive.material.map(|m| m.value());
            let place = format!("{at}.material");
            let made = self.materials.get(material, &place, &mut self.scene, &mut self.tally)?;
            let read = primitive::read(
                primitive,
                &self.accessors,
                made.uv.as_ref(),
                &mut self.tally,
                &at,
            )?;
            if primitive.targets.as_ref().is_some_and(|t| !t.is_empty()) {
                let reason = "{} meshes with morph targets keep their base shape";
                self.tally.add(reason, 1, || at);
            }
            if let Some(mut mesh) = read {
                mesh.name = source.name.clone().unwrap_or_default();
                parts.push((self.scene.add_mesh(mesh), made.id));
            }
        }
        self.meshes.insert(index, parts.clone());
        Ok(parts)
    }

    fn finish(mut self, path: &Path) -> Scene {
        if !self.root.animations.is_empty() {
            self.tally.say("animations are not played: the nodes stand as the file places them");
        }
        if self.scene.instances.is_empty() {
            self.tally.say("there is no triangle in the scene that the file shows");
        }
        self.scene.warnings = self.tally.sentences(path);
        self.scene
    }
}
