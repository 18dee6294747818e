//! The rules between properties of an object, and between objects.

use std::collections::HashSet;
use std::f64::consts::FRAC_PI_4;
use std::fmt::Display;

use gltf::json::Value;

use super::attributes::{ElementType, is_attribute, prerequisite};
use super::{REFERENCE, RULE, Validator, extension, integer, list, names, referenced};

impl Validator<'_> {
    /// Checks what the objects of a file say of each other.
    pub(super) fn check_rules(&mut self) {
        self.check_extension_lists_and_versions();
        self.each("cameras", Self::check_camera);
        self.each("images", Self::check_image);
        self.each("meshes", Self::check_mesh);
        // A node has at most one parent, and the roots of a scene have none.
        let mut has_parent = HashSet::new();
        self.each("nodes", |validator, node, path| {
            validator.check_node(node, path, &mut has_parent);
        });
        self.each("scenes", |validator, scene, path| {
            let is_root = |node: &Value| !has_parent.contains(&node.to_string());
            let holds = list(scene, "nodes").iter().all(is_root);
            validator.rule(holds, format_args!("{path}.nodes"), "one has a parent");
        });
        self.each("skins", Self::check_skin);
        self.each("animations", Self::check_animation);
        let lights = extension(self.root, "KHR_lights_punctual");
        for (i, light) in lights.map_or(&[][..], |e| list(e, "lights")).iter().enumerate() {
            self.check_light(light, &format!("extensions.KHR_lights_punctual.lights[{i}]"));
        }
    }

    /// Reports a breach of a rule, unless it holds.
    fn rule(&mut self, holds: bool, path: impl Display, message: impl Display) {
        self.check(RULE, holds, path, message);
    }

    fn check_extension_lists_and_versions(&mut self) {
        // What is required is used, and quantised meshes cannot be read without their extension.
        let (path, required) = ("extensionsRequired", names(self.root, "extensionsRequired"));
        let holds = required.is_subset(&self.used);
        self.rule(holds, path, "names what extensionsUsed does not");
        let name = "KHR_mesh_quantization";
        let holds = !self.used.contains(name) || required.contains(name);
        self.rule(holds, path, format_args!("{name} is used and not in it"));

        // The least version that a reader needs is not above the file's own.
        let version = |key| {
            let text = self.root.get("asset")?.get(key)?.as_str()?;
            let (major, minor) = text.split_once('.')?;
            Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
        };
        let holds = version("minVersion").is_none_or(|least| version("version") >= Some(least));
        self.rule(holds, "asset.minVersion", "above its version");
    }

    fn check_camera(&mut self, camera: &Value, path: &str) {
        let has_both = has(camera, "perspective") && has(camera, "orthographic");
        self.rule(!has_both, path, "both perspective and orthographic");
        let kind = camera.get("type").and_then(Value::as_str).unwrap_or_default();
        let Some(projection) = camera.get(kind) else {
            return self.rule(kind.is_empty(), path, format_args!("has no `{kind}`"));
        };
        // The planes and the size of the frustum.
        let number = |key: &str| projection.get(key).and_then(Value::as_f64);
        let (near, far) = (number("znear"), number("zfar"));
        self.rule(far.is_none() || far > near, path, "zfar is not above znear");
        let is_flat = number("xmag") == Some(0.0) || number("ymag") == Some(0.0);
        self.rule(!is_flat, path, "a magnification of 0");
    }

    fn check_image(&mut self, image: &Value, path: &str) {
        let (has_uri, has_view) = (has(image, "uri"), has(image, "bufferView"));
        self.rule(has_uri != has_view, path, "either a uri or a bufferView is needed");
        let is_typed = !has_view || has(image, "mimeType");
        self.rule(is_typed, path, "a bufferView needs a mimeType");
    }

    fn check_mesh(&mut self, mesh: &Value, path: &str) {
        // All primitives morph together, by the weights of the mesh.
        let primitives = list(mesh, "primitives");
        let first = target_count(mesh);
        let are_alike = primitives.iter().all(|p| list(p, "targets").len() == first);
        self.rule(are_alike, path, "its primitives have different numbers of morph targets");
        self.check_weights(mesh, first, path);
        for (i, primitive) in primitives.iter().enumerate() {
            self.check_primitive(primitive, &format!("{path}.primitives[{i}]"));
        }
    }

    /// Checks the weights of a mesh's or a node's morph targets.
    fn check_weights(&mut self, object: &Value, targets: usize, path: &str) {
        let weights = object.get("weights").and_then(Value::as_array);
        let holds = weights.is_none_or(|w| w.len() == targets);
        self.rule(holds, format_args!("{path}.weights"), "not one for each morph target");
    }

    fn check_primitive(&mut self, primitive: &Value, path: &str) {
        let root = self.root;
        let attributes = primitive.get("attributes").unwrap_or(&Value::Null);
        let accessor = |name: &str| referenced(root, attributes, name, "accessors");
        let count = |name: &str| integer(accessor(name)?, "count");
        let vertices = count("POSITION");
        let is_count = |found: Option<u64>| vertices.zip(found).is_none_or(|(v, n)| v == n);

        // All attributes have a value for each position, of a type that the standard allows.
        for name in attributes.as_object().into_iter().flat_map(|a| a.keys()) {
            let path = format_args!("{path}.attributes.{name}");
            self.rule(is_count(count(name)), path, "not as many as positions");
            self.rule(is_attribute(name), path, "no known attribute");
            let is_whole = prerequisite(name).is_none_or(|name| has(attributes, &name));
            self.rule(is_whole, path, "without those that go with it");
            let element = accessor(name).and_then(ElementType::from_accessor);
            let is_valid = element.is_none_or(|e| e.is_valid_for(name));
            self.rule(is_valid, path, "of a type that it cannot have");
        }

        // Indices are unsigned integers.
        let indices = referenced(root, primitive, "indices", "accessors");
        let element = indices.and_then(ElementType::from_accessor);
        let is_valid = element.is_none_or(ElementType::is_valid_for_indices);
        self.rule(is_valid, format_args!("{path}.indices"), "no unsigned integers");

        // Morph targets move attributes that the primitive has.
        for (i, target) in list(primitive, "targets").iter().enumerate() {
            for name in target.as_object().into_iter().flat_map(|t| t.keys()) {
                let path = format_args!("{path}.targets[{i}].{name}");
                let is_own = name.starts_with('_');
                let can_morph = ["POSITION", "NORMAL", "TANGENT"].contains(&&**name)
                    || name.starts_with("TEXCOORD_")
                    || name.starts_with("COLOR_");
                self.rule(can_morph || is_own, path, "no attribute that morphs");
                self.rule(has(attributes, name) || is_own, path, "without one to morph");
                let accessor = referenced(root, target, name, "accessors");
                let count = accessor.and_then(|accessor| integer(accessor, "count"));
                self.rule(is_count(count), path, "not as many as positions");
            }
        }

        // Each variant has one material.
        let mut mapped = HashSet::new();
        let variants = extension(primitive, "KHR_materials_variants");
        for mapping in variants.map_or(&[][..], |variants| list(variants, "mappings")) {
            let are_new = list(mapping, "variants").iter().all(|v| mapped.insert(v.to_string()));
            self.rule(are_new, path, "one variant has two materials");
        }
    }

    fn check_node(&mut self, node: &Value, path: &str, has_parent: &mut HashSet<String>) {
        // A transform is a matrix, or the parts that one is made of.
        let has_parts = ["translation", "rotation", "scale"].iter().any(|key| has(node, key));
        let has_both = has(node, "matrix") && has_parts;
        self.rule(!has_both, path, "a matrix beside what it is made of");
        for key in ["skin", "weights"] {
            let holds = !has(node, key) || has(node, "mesh");
            self.rule(holds, format_args!("{path}.{key}"), "without a mesh");
        }
        for child in list(node, "children") {
            let is_new = has_parent.insert(child.to_string());
            let message = format_args!("node {child} has a parent");
            self.rule(is_new, format_args!("{path}.children"), message);
        }
        let rotation = node.get("rotation").and_then(Value::as_array).filter(|q| q.len() == 4);
        let square = |q: &Vec<Value>| q.iter().filter_map(Value::as_f64).map(|x| x * x).sum();
        let is_unit = rotation.is_none_or(|q| (f64::sqrt(square(q)) - 1.0).abs() < 0.005);
        self.rule(is_unit, format_args!("{path}.rotation"), "not of length 1");

        // What the node says of its mesh.
        let Some(mesh) = referenced(self.root, node, "mesh", "meshes") else { return };
        self.check_weights(node, target_count(mesh), path);
        let has_joints = |p: &Value| p.get("attributes").is_some_and(|a| has(a, "JOINTS_0"));
        let holds = !has(node, "skin") || list(mesh, "primitives").iter().all(has_joints);
        self.rule(holds, format_args!("{path}.skin"), "of a mesh without joints");
    }

    fn check_skin(&mut self, skin: &Value, path: &str) {
        let joints = list(skin, "joints").len() as u64;
        let matrices = referenced(self.root, skin, "inverseBindMatrices", "accessors");
        let is_enough = matrices.and_then(|m| integer(m, "count")).is_none_or(|n| n >= joints);
        self.rule(is_enough, format_args!("{path}.inverseBindMatrices"), "fewer than joints");
    }

    fn check_animation(&mut self, animation: &Value, path: &str) {
        let samplers = list(animation, "samplers").len();
        let mut targets = HashSet::new();
        for (i, channel) in list(animation, "channels").iter().enumerate() {
            let path = format!("{path}.channels[{i}]");
            // The sampler is one of the same animation.
            let is_there = integer(channel, "sampler").is_none_or(|s| s < samplers as u64);
            let sampler = format_args!("{path}.sampler");
            let message = format_args!("there are {samplers} samplers");
            self.check(REFERENCE, is_there, sampler, message);

            // The target: a pointer, or the property of a node.
            let Some(target) = channel.get("target") else { continue };
            let path = format!("{path}.target");
            let property = target.get("path").and_then(Value::as_str);
            let has_pointer = extension(target, "KHR_animation_pointer").is_some();
            let holds = !has_pointer || property == Some("pointer") && !has(target, "node");
            self.rule(holds, &path, "a pointer beside a node or another path");
            // A property of a node has one channel, and there is something that it can move.
            let Some(node) = target.get("node") else { continue };
            let is_new =
                targets.insert((node.to_string(), target.get("path").map(Value::to_string)));
            self.rule(is_new, &path, "another channel has the same");
            let Some(node) = referenced(self.root, target, "node", "nodes") else { continue };
            if property == Some("weights") {
                let mesh = referenced(self.root, node, "mesh", "meshes");
                self.rule(mesh.is_some_and(|m| target_count(m) > 0), &path, "nothing there morphs");
            } else {
                self.rule(!has(node, "matrix"), &path, "a node with a matrix");
            }
        }
    }

    fn check_light(&mut self, light: &Value, path: &str) {
        if light.get("type").and_then(Value::as_str) != Some("spot") {
            return;
        }
        let Some(spot) = light.get("spot") else {
            return self.rule(false, path, "has no `spot`");
        };
        // Either cone has a default.
        let angle = |key: &str, default| spot.get(key).map_or(Some(default), Value::as_f64);
        let holds = angle("innerConeAngle", 0.0) < angle("outerConeAngle", FRAC_PI_4);
        self.rule(holds, format_args!("{path}.spot"), "the outer cone is not the wider one");
    }
}

fn has(object: &Value, key: &str) -> bool {
    object.get(key).is_some()
}

/// The number of morph targets of a mesh's first primitive.
fn target_count(mesh: &Value) -> usize {
    list(mesh, "primitives").first().map_or(0, |p| list(p, "targets").len())
}
