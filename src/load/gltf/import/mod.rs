//! The import of a file's nodes, and of all they refer to, into a scene.

mod animation;
mod asset;
mod cameras;
mod deformation;
mod implicit_shapes;
mod instancing;
mod lights;
mod material;
mod mesh;
mod morph_targets;
mod nodes;
mod placement;
mod provenance;
mod skin;
mod texture;
mod texture_reference;
mod variants;
mod vectors;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use gltf::json;

use self::animation::AnimationClip;
use self::material::Materials;
use self::mesh::{PrimitiveMesh, PrimitiveReader};
use self::nodes::{SceneNode, collect_nodes};
use self::skin::SkinJoints;
use self::texture::Textures;
use self::variants::Variants;
use super::accessor::Accessors;
use super::buffers::Buffers;
use super::json::{Document, at_path, lookup};
use crate::error::Result;
use crate::load::ModelOptions;
use crate::load::diagnostics::Diagnostics;
use crate::load::limits::Limit;
use crate::load::report::{LoadReport, Loaded};
use crate::load::sandbox::Sandbox;
use crate::scene::animation::Animated;
use crate::scene::{MaterialId, Mesh, MeshId, Scene, ShadingModel};

/// Imports the scene that a file shows.
///
/// # Errors
/// When something that is shown refers to what is missing or cannot be read, or there is no
/// animation of the chosen name.
pub fn import(
    path: &Path,
    document: &Document,
    bin: Option<&[u8]>,
    sandbox: &Sandbox,
    options: &ModelOptions,
    mut diagnostics: Diagnostics,
) -> Result<Loaded> {
    // The readers of the parts of the file, each by way of the one before.
    let root = &document.root;
    let buffers = Buffers::new(root, sandbox, path, bin);
    let accessors = Accessors::new(&buffers);
    let mut clip = AnimationClip::read(&accessors, options.animation, &mut diagnostics)?;
    let nodes = collect_nodes(document, sandbox, &mut clip, &mut diagnostics)?;

    // Nodes are added in the order of the file; joints of skins refer to any of them.
    let shown: Vec<usize> = nodes.iter().filter(|n| n.is_shown).map(|n| n.index).collect();
    let nodes: HashMap<usize, SceneNode> = nodes.into_iter().map(|n| (n.index, n)).collect();
    let textures = Textures::new(&buffers, options.needs_images);
    let provenance = options.provenance.then(|| provenance::new_table(path, root));
    let mut importer = Importer {
        root,
        value: document.value.as_ref(),
        accessors,
        materials: Materials::new(
            root,
            textures,
            options.geometry_only,
            options.shading.unwrap_or(ShadingModel::Pbr),
        ),
        variants: Variants::read(root, options.variant),
        meshes: HashMap::new(),
        mesh_ids: HashMap::new(),
        colored: HashMap::new(),
        nodes: &nodes,
        joints: HashMap::new(),
        scene: Scene { provenance, ..Scene::default() },
        clip,
        diagnostics,
    };
    for index in shown {
        importer.add_node(&nodes[&index])?;
    }
    Ok(importer.into_loaded(path))
}

/// A primitive that is imported.
#[derive(Clone)]
struct ImportedPrimitive {
    mesh: PrimitiveMesh,
    material: MaterialId,
    /// The index of the material in the file, if it has one.
    material_index: Option<usize>,
    /// The indices of the mesh and of the primitive; none for an implicit shape.
    indices: Option<[u32; 2]>,
}

/// The state of an import, node by node.
struct Importer<'a> {
    root: &'a json::Root,
    /// The values of the JSON, unless they are too large.
    value: Option<&'a json::Value>,
    accessors: Accessors<'a>,
    materials: Materials<'a>,
    variants: Variants<'a>,
    /// The primitives of the file's meshes so far, which nodes share.
    meshes: HashMap<usize, Vec<ImportedPrimitive>>,
    /// The ids of meshes that are in the scene as they were modelled, by their address.
    mesh_ids: HashMap<*const Mesh, MeshId>,
    /// The materials in the colours of instances, by the bits of these.
    colored: HashMap<(MaterialId, [u32; 4]), MaterialId>,
    /// The nodes, by their index in the file.
    nodes: &'a HashMap<usize, SceneNode<'a>>,
    /// The joints of the skins so far.
    joints: HashMap<usize, SkinJoints>,
    scene: Scene,
    clip: AnimationClip,
    diagnostics: Diagnostics,
}

impl Importer<'_> {
    /// Adds the camera, the light, the shape and the mesh of a node to the scene.
    ///
    /// # Errors
    /// When it refers to what is missing or cannot be read.
    fn add_node(&mut self, node: &SceneNode) -> Result<()> {
        // What moves is also needed in the space of the node that moves it; warnings about it are
        // those of the first time.
        let mut ignored = Diagnostics::default();
        let at_rest = node.animated.map(|_| node.in_animated_space());

        // Camera, light and shape.
        if let Some(camera) = cameras::camera(self.root, node, &mut self.diagnostics)? {
            if let Some(at_rest) = &at_rest
                && let Some(rest) = cameras::camera(self.root, at_rest, &mut ignored)?
            {
                let (camera, node) = (self.scene.cameras.len(), node.animated);
                let animated = Animated::Camera { camera, node, rest, aim: None, lens: None };
                self.clip.objects.push(animated);
            }
            self.scene.cameras.push(camera);
        }
        if let Some(light) = lights::light(self.root, node, &mut self.diagnostics)? {
            if let Some(at_rest) = &at_rest
                && let Some(rest) = lights::light(self.root, at_rest, &mut ignored)?
            {
                let (light, node) = (self.scene.lights.len(), node.animated);
                let (direction, intensity) = (None, None);
                self.clip.objects.push(Animated::Light { light, node, rest, direction, intensity });
            }
            self.scene.lights.push(light);
        }
        if let Some((shape, material)) = implicit_shapes::shape(self.root, node)? {
            self.add_shape(shape, material, node)?;
        }

        // The mesh, at each of the instances that an extension may give it.
        let Some(mesh) = node.node.mesh else { return Ok(()) };
        let by = format!("nodes[{}].mesh", node.index);
        let primitives = self.primitives(mesh.value(), &by)?;
        let instances = instancing::instances(node, &self.accessors, &mut self.diagnostics)?;
        if instances.is_empty() {
            return Ok(());
        }

        // Each primitive has an instance at each transform; the number is limited before they are
        // added.
        let added = (primitives.len() * instances.len()) as u64;
        let count = self.scene.instances.len() as u64 + added;
        let Buffers { sandbox, .. } = self.accessors.buffers;
        sandbox.check(Limit::Instances, count).map_err(at_path(&by))?;
        primitives.iter().try_for_each(|primitive| self.add_mesh(primitive, node, &instances, &by))
    }

    /// Returns the primitives of a mesh, each with its material.
    fn primitives(&mut self, index: usize, by: &str) -> Result<Vec<ImportedPrimitive>> {
        if let Some(known) = self.meshes.get(&index) {
            return Ok(known.clone());
        }
        // Each primitive is a mesh of its own, since it has its own material.
        let source = lookup(&self.root.meshes, index, "mesh", by)?;
        let mut primitives = Vec::new();
        for (i, primitive) in source.primitives.iter().enumerate() {
            let path = format!("meshes[{index}].primitives[{i}]");
            // The material says which attributes are read.
            let (material_index, by) = self.variants.material(primitive, &path);
            let (scene, diagnostics) = (&mut self.scene, &mut self.diagnostics);
            let records_faces = scene.provenance.is_some();
            let (material, needed) =
                self.materials.material(material_index, &by, scene, diagnostics)?;

            // The mesh, and what of it cannot be shown.
            let (accessors, path) = (&self.accessors, &*path);
            let reader = PrimitiveReader { primitive, accessors, path, diagnostics, records_faces };
            let read = reader.read(&needed)?;
            let unsupported = morph_targets::unsupported_attributes(self.value, index, i);
            let reason = "{} texture coordinates and colours of morph targets are not morphed";
            self.diagnostics.unsupported(reason, unsupported, || format!("{path}.targets"));

            // It is stored once, whatever the number of nodes that show it.
            let Some(mut read) = read else { continue };
            let (vertices, triangles) = (read.mesh.positions.len(), read.mesh.triangles.len());
            for (limit, count) in [(Limit::Vertices, vertices), (Limit::Triangles, triangles)] {
                accessors.buffers.sandbox.consume(limit, count as u64).map_err(at_path(path))?;
            }
            if let (Some(name), Some(mesh)) = (&source.name, Arc::get_mut(&mut read.mesh)) {
                mesh.name.clone_from(name);
            }
            let indices = Some([index as u32, i as u32]);
            primitives.push(ImportedPrimitive { mesh: read, material, material_index, indices });
        }
        self.meshes.insert(index, primitives.clone());
        Ok(primitives)
    }

    /// Returns the scene and the load report, once all nodes are added.
    fn into_loaded(mut self, path: &Path) -> Loaded {
        self.scene.animation = self.clip.into_animation();
        self.materials.textures.decode_images(&mut self.scene, &mut self.diagnostics);
        let Scene { instances, spheres, planes, .. } = &self.scene;
        if instances.is_empty() && spheres.is_empty() && planes.is_empty() {
            self.diagnostics.note("there is no triangle in the scene that the file shows");
        }
        let report = self.diagnostics.into_report(path, &self.scene);
        let variants = self.variants.names();
        let assets = vec![asset::read(path, self.root)];
        Loaded { scene: self.scene, report: LoadReport { variants, assets, ..report } }
    }
}
