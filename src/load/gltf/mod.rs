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
mod deform;
mod document;
mod draco;
mod extensions;
mod instancing;
mod lights;
mod material;
mod meshopt;
mod nodes;
mod optics;
mod packed;
mod primitive;
mod shapes;
mod texture;
mod topology;
mod validation;
mod variants;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use gltf::json;
use gltf::json::Value;

use self::accessor::Accessors;
use self::animation::Clip;
use self::buffers::{Buffers, get};
use self::deform::Joints;
use self::material::Materials;
use self::nodes::Placed;
use self::primitive::Part;
use self::shapes::Shape;
use self::texture::Textures;
use self::variants::Variants;
use crate::error::{Error, Place, Result};
use crate::load::Choice;
use crate::load::guard::{Guard, Opened};
use crate::load::limits::Limit;
use crate::load::tally::Tally;
use crate::scene::animation::{Curve, Deformation, Joint, Mover, Skin};
use crate::scene::{Instance, MaterialId, MeshId, Plane, Scene, Sphere};

/// Loads a `.gltf` or `.glb` file.
///
/// # Errors
/// When it cannot be read, is damaged, or requires an extension that isn't read; the error names
/// the place in the JSON. When there is no such animation.
pub fn load(file: Opened, guard: &Guard, choice: &Choice) -> Result<Scene> {
    let path = file.path.clone();
    let bytes = file.read(guard)?;
    import(&path, &bytes, guard, choice).map_err(|e| e.at(&path))
}

fn import(path: &Path, bytes: &[u8], guard: &Guard, choice: &Choice) -> Result<Scene> {
    let (json, bin) = container::split(bytes)?;
    guard.check(Limit::Json, document::memory(json))?;
    let (root, value) = document::parse(json)?;
    let mut tally = Tally::default();
    match value {
        Value::Null => tally.say("the JSON is too large to be held against the standard"),
        _ => validation::validate(&value, bin.map(<[u8]>::len), &mut tally),
    }
    extensions::check(&root, &mut tally)?;
    let buffers = Buffers::new(&root, guard, path, bin);
    let accessors = Accessors::new(&root, guard, &buffers);
    let mut clip = Clip::read(&root, guard, &accessors, choice.animation, &mut tally)?;
    let nodes = nodes::walk(&root, guard, &mut clip, &mut tally)?;
    let order: Vec<usize> = nodes.iter().filter(|n| n.is_shown).map(|n| n.index).collect();
    let by_index: HashMap<usize, Placed> = nodes.into_iter().map(|n| (n.index, n)).collect();
    let mut importer = Importer {
        root: &root,
        guard,
        json: &value,
        accessors,
        materials: Materials::new(&root, Textures::new(&root, guard, &buffers, choice.pictures)),
        variants: Variants::read(&root, choice.variant),
        meshes: HashMap::new(),
        nodes: &by_index,
        joints: HashMap::new(),
        scene: Scene::default(),
        clip,
        tally,
    };
    for index in order {
        importer.node(&by_index[&index])?;
    }
    Ok(importer.finish(path))
}

/// A primitive in the scene.
#[derive(Clone)]
struct Made {
    part: Part,
    material: MaterialId,
    /// The mesh as it was modelled, where it stands like that.
    stored: Option<MeshId>,
}

struct Importer<'a> {
    root: &'a json::Root,
    guard: &'a Guard,
    /// The same as it stands in the file.
    json: &'a Value,
    accessors: Accessors<'a>,
    materials: Materials<'a>,
    variants: Variants<'a>,
    /// What the primitives of a mesh became, so that nodes share it.
    meshes: HashMap<usize, Vec<Made>>,
    nodes: &'a HashMap<usize, Placed<'a>>,
    /// The joints of the skins so far.
    joints: HashMap<usize, Joints>,
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

    /// Puts a mesh at some places of a node.
    fn place(&mut self, part: &Made, placed: &Placed, places: &[DAffine3], by: &str) -> Result<()> {
        let (mesh, is_bent) = self.shape(part, placed)?;
        if is_bent {
            let once = u64::from(places.len() > 1);
            let reason = "{} skinned meshes stand once, whatever the instances of their node";
            self.tally.unsupported(reason, once, || by.to_owned());
            // Its joints say where it is, whatever node it hangs on.
            let stands = Instance::new(mesh, DAffine3::IDENTITY, part.material);
            self.scene.instances.push(stands);
            return Ok(());
        }
        for place in places {
            let instance = Instance::new(mesh, placed.world * *place, part.material);
            // What moves may be flat at one time and not at another.
            if let Some(node) = placed.mover {
                let (instance, transform) = (self.scene.instances.len(), placed.rest * *place);
                self.clip.movers.push(Mover::Instance { instance, node, transform });
            } else if instance.is_flat() {
                let reason = "{} meshes are not drawn where their scale is 0 along some direction";
                self.tally.add(reason, 1, || by.to_owned());
                continue;
            }
            self.scene.instances.push(instance);
        }
        Ok(())
    }

    /// Puts a shape where its node is.
    fn implicit(&mut self, shape: Shape, material: Option<usize>, placed: &Placed) -> Result<()> {
        let at = format!("nodes[{}].extensions.KHR_implicit_shapes", placed.index);
        let by = format!("{at}.material");
        let material = self.materials.get(material, &by, &mut self.scene, &mut self.tally)?.id;
        let mesh = match shape {
            Shape::Sphere(radius) => match shapes::sphere_under(&placed.world, radius) {
                Some((center, radius)) => {
                    if let Some(node) = placed.mover {
                        let (sphere, center) = (self.scene.spheres.len(), placed.rest.translation);
                        let (node, radius) = (Some(node), None);
                        self.clip.movers.push(Mover::Sphere { sphere, node, center, radius });
                    }
                    self.scene.spheres.push(Sphere::new(center, radius, material));
                    return Ok(());
                }
                None => shapes::ball(radius),
            },
            Shape::Plane => {
                let normal = placed.world.matrix3.inverse().transpose() * DVec3::Y;
                let still = u64::from(placed.mover.is_some());
                self.tally
                    .unsupported("{} planes stand still on nodes that move", still, || at.clone());
                match normal.try_normalize() {
                    Some(normal) => {
                        let point = placed.world.translation;
                        self.scene.planes.push(Plane::new(point, normal, material));
                    }
                    None => self.tally.add("{} planes have no direction", 1, || at),
                }
                return Ok(());
            }
            Shape::Mesh(mesh) => *mesh,
        };
        let part = Part { mesh: Arc::new(mesh), morphs: [].into(), influences: None };
        let made = Made { part, material, stored: None };
        self.place(&made, placed, &[DAffine3::IDENTITY], &at)
    }

    /// The mesh of a part as it stands at a node, and whether joints have bent it.
    fn shape(&mut self, made: &Made, placed: &Placed) -> Result<(MeshId, bool)> {
        let Part { mesh: base, morphs, influences } = &made.part;
        let by = format!("nodes[{}].skin", placed.index);
        let skin = match (placed.node.skin, influences) {
            (Some(skin), Some(influences)) => {
                let joints = self.joints(skin.value(), &by)?;
                let stray = influences.beyond(joints.still.len());
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
            morphs: morphs.clone(),
            weights: weights.into_iter().map(Curve::constant).collect(),
            repeats: None,
            skin: skin.as_ref().map(|(joints, influences)| Skin {
                joints: joints.still.clone(),
                influences: influences.clone(),
                space: Joint { node: None, place: DAffine3::IDENTITY, bind: DAffine3::IDENTITY },
            }),
        };
        let id = self.scene.add_mesh(deformation.mesh(0.0, &[]));
        // Read once, and stored as often as it has shapes.
        self.tally.read(base.triangles.len() as u64);
        let moves = skin.as_ref().is_some_and(|(joints, _)| joints.moves);
        if curves.is_some() || moves {
            if let Some(curves) = curves {
                deformation.weights = curves.to_vec();
            }
            deformation.repeats = self.clip.repeats();
            if let (Some(skin), Some((joints, _))) = (&mut deformation.skin, &skin) {
                skin.joints.clone_from(&joints.moving);
            }
            let (mesh, deformation) = (id.0 as usize, Box::new(deformation));
            self.clip.movers.push(Mover::Mesh { mesh, deformation });
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

    fn finish(mut self, path: &Path) -> Scene {
        self.scene.animation = self.clip.finish();
        self.materials.decode(&mut self.scene, &mut self.tally);
        let Scene { instances, spheres, planes, .. } = &self.scene;
        if instances.is_empty() && spheres.is_empty() && planes.is_empty() {
            self.tally.say("there is no triangle in the scene that the file shows");
        }
        self.tally.finish(path, &mut self.scene);
        self.scene.report.variants = self.variants.names();
        self.scene
    }
}
