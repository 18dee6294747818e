//! glTF 2.0 files, text and binary.
//!
//! The `gltf` crate gives the types of the JSON; whatever follows an index, an offset or a URI is
//! done here, checked, since the crate's own readers trust the file. What is read, and how it maps
//! to a scene, stands in docs/formats.md.

mod accessor;
mod animation;
mod buffers;
mod compact;
mod container;
mod document;
mod extensions;
mod lights;
mod material;
mod nodes;
mod optics;
mod packed;
mod primitive;
mod texture;
mod topology;
mod validation;

use std::collections::HashMap;
use std::path::Path;

use gltf::json;

use self::accessor::Accessors;
use self::animation::Clip;
use self::buffers::{Buffers, get};
use self::material::Materials;
use self::nodes::Placed;
use self::texture::Textures;
use crate::error::{Place, Result};
use crate::load::guard::{Guard, Opened};
use crate::load::limits::Limit;
use crate::load::tally::Tally;
use crate::scene::animation::Mover;
use crate::scene::{Instance, MaterialId, MeshId, Scene};

/// Loads a `.gltf` or `.glb` file, with the animation of that name or the first; its pictures are
/// read where they are `wanted`.
///
/// # Errors
/// When it cannot be read, is damaged, or requires an extension that isn't read; the error names
/// the place in the JSON. When there is no such animation.
pub fn load(file: Opened, guard: &Guard, animation: Option<&str>, wanted: bool) -> Result<Scene> {
    let path = file.path.clone();
    let bytes = file.read(guard)?;
    import(&path, &bytes, guard, animation, wanted).map_err(|e| e.at(&path))
}

fn import(
    path: &Path,
    bytes: &[u8],
    guard: &Guard,
    animation: Option<&str>,
    wanted: bool,
) -> Result<Scene> {
    let (json, bin) = container::split(bytes)?;
    let (root, value) = document::parse(json)?;
    let mut tally = Tally::default();
    validation::validate(&value, bin.map(<[u8]>::len), &mut tally);
    extensions::check(&root, &mut tally)?;
    let buffers = Buffers::new(&root, guard, path, bin);
    let accessors = Accessors::new(&root, guard, &buffers);
    let mut clip = Clip::read(&root, guard, &accessors, animation, &mut tally)?;
    let nodes = nodes::walk(&root, guard, &mut clip, &mut tally)?;
    let mut importer = Importer {
        root: &root,
        guard,
        accessors,
        materials: Materials::new(&root, Textures::new(&root, guard, &buffers, wanted)),
        meshes: HashMap::new(),
        scene: Scene::default(),
        clip,
        tally,
    };
    for placed in nodes {
        importer.node(&placed)?;
    }
    Ok(importer.finish(path))
}

struct Importer<'a> {
    root: &'a json::Root,
    guard: &'a Guard,
    accessors: Accessors<'a>,
    materials: Materials<'a>,
    /// What the primitives of a mesh became, so that nodes share it.
    meshes: HashMap<usize, Vec<(MeshId, MaterialId)>>,
    scene: Scene,
    clip: Clip,
    tally: Tally,
}

impl Importer<'_> {
    fn node(&mut self, placed: &Placed) -> Result<()> {
        if let Some(camera) = lights::camera(self.root, placed, &mut self.tally)? {
            self.move_camera(placed)?;
            self.scene.cameras.push(camera);
        }
        if let Some(light) = lights::light(self.root, placed, &mut self.tally)? {
            self.move_light(placed)?;
            self.scene.lights.push(light);
        }
        let Some(mesh) = placed.node.mesh else { return Ok(()) };
        let by = format!("nodes[{}].mesh", placed.index);
        let parts = self.mesh(mesh.value(), &by)?;
        if placed.node.skin.is_some() {
            let reason = "{} skinned meshes stand as they were modelled, not as posed";
            self.tally.unsupported(reason, 1, || by.clone());
        }
        let place = || Place::Json(by.clone());
        let count = self.scene.instances.len() + parts.len();
        self.guard.check(Limit::Instances, count as u64).map_err(|e| e.place(place()))?;
        let made: Vec<Instance> = parts
            .into_iter()
            .map(|(mesh, material)| Instance::new(mesh, placed.world, material))
            .collect();
        // What moves may be flat at one time and not at another.
        if placed.mover.is_none() && made.iter().any(Instance::is_flat) {
            let reason = "{} meshes are not drawn where their scale is 0 along some direction";
            self.tally.add(reason, 1, || by);
            return Ok(());
        }
        for instance in made {
            if let Some(node) = placed.mover {
                let (instance, transform) = (self.scene.instances.len(), placed.rest);
                self.clip.movers.push(Mover::Instance { instance, node, transform });
            }
            self.scene.instances.push(instance);
        }
        Ok(())
    }

    /// Makes the next camera of the scene move with its node.
    fn move_camera(&mut self, placed: &Placed) -> Result<()> {
        // What there is to say of it was said of it as the file places it.
        let mut quiet = Tally::default();
        if placed.mover.is_some()
            && let Some(rest) = lights::camera(self.root, &placed.at_rest(), &mut quiet)?
        {
            let (camera, node) = (self.scene.cameras.len(), placed.mover);
            let (aim, lens) = (None, None);
            self.clip.movers.push(Mover::Camera { camera, node, rest, aim, lens });
        }
        Ok(())
    }

    /// Makes the next light of the scene move with its node.
    fn move_light(&mut self, placed: &Placed) -> Result<()> {
        let mut quiet = Tally::default();
        if placed.mover.is_some()
            && let Some(rest) = lights::light(self.root, &placed.at_rest(), &mut quiet)?
        {
            let (light, node) = (self.scene.lights.len(), placed.mover);
            let (direction, intensity) = (None, None);
            self.clip.movers.push(Mover::Light { light, node, rest, direction, intensity });
        }
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
            let read =
                primitive::read(primitive, &self.accessors, &made.asks, &mut self.tally, &at)?;
            if primitive.targets.as_ref().is_some_and(|t| !t.is_empty()) {
                let reason = "{} meshes with morph targets keep their base shape";
                self.tally.unsupported(reason, 1, || at);
            }
            if let Some(mut mesh) = read {
                let size = [
                    (Limit::Vertices, mesh.positions.len()),
                    (Limit::Triangles, mesh.triangles.len()),
                ];
                for (limit, count) in size {
                    let place = || Place::Json(format!("meshes[{index}].primitives[{i}]"));
                    self.guard.take(limit, count as u64).map_err(|e| e.place(place()))?;
                }
                mesh.name = source.name.clone().unwrap_or_default();
                parts.push((self.scene.add_mesh(mesh), made.id));
            }
        }
        self.meshes.insert(index, parts.clone());
        Ok(parts)
    }

    fn finish(mut self, path: &Path) -> Scene {
        self.scene.animation = self.clip.finish();
        self.materials.decode(&mut self.scene, &mut self.tally);
        if self.scene.instances.is_empty() {
            self.tally.say("there is no triangle in the scene that the file shows");
        }
        self.tally.finish(path, &mut self.scene);
        self.scene
    }
}
