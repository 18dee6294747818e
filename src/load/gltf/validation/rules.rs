//! Rules between properties, and between objects.

use std::collections::HashSet;

use gltf::json::Value;

use super::attributes::{format_of, is_semantic, may_be};
use super::{Fault, Faults, follow, list, whole};

/// Looks at what each object says beside what others say.
pub fn check(root: &Value, faults: &mut Faults) {
    let mut check = Check { root, faults };
    check.root();
    for (i, camera) in list(root, "cameras").iter().enumerate() {
        check.camera(camera, i);
    }
    for (i, image) in list(root, "images").iter().enumerate() {
        let (uri, view) = (image.get("uri").is_some(), image.get("bufferView").is_some());
        check.rule(
            uri != view,
            || format!("images[{i}]"),
            "either a uri or a bufferView is needed",
        );
        let typed = !view || image.get("mimeType").is_some();
        check.rule(typed, || format!("images[{i}]"), "a bufferView needs a mimeType");
    }
    for (i, mesh) in list(root, "meshes").iter().enumerate() {
        check.mesh(mesh, i);
    }
    check.nodes();
    for (i, skin) in list(root, "skins").iter().enumerate() {
        let joints = list(skin, "joints").len() as u64;
        let matrices = follow(root, skin, "inverseBindMatrices", "accessors");
        let enough = matrices.and_then(|m| whole(m, "count")).is_none_or(|n| n >= joints);
        check.rule(enough, || format!("skins[{i}].inverseBindMatrices"), "fewer than joints");
    }
    for (i, animation) in list(root, "animations").iter().enumerate() {
        check.animation(animation, i);
    }
    let lights = extension(root, "KHR_lights_punctual").map_or(&[][..], |e| list(e, "lights"));
    for (i, light) in lights.iter().enumerate() {
        check.light(light, &format!("extensions.KHR_lights_punctual.lights[{i}]"));
    }
}

struct Check<'v, 'f> {
    root: &'v Value,
    faults: &'f mut Faults,
}

impl Check<'_, '_> {
    fn rule(&mut self, holds: bool, path: impl FnOnce() -> String, what: &str) {
        self.faults.rule(holds, path, what);
    }

    fn root(&mut self) {
        let names = |list_name| {
            list(self.root, list_name).iter().filter_map(Value::as_str).collect::<HashSet<_>>()
        };
        let (used, required) = (names("extensionsUsed"), names("extensionsRequired"));
        self.rule(
            required.is_subset(&used),
            || "extensionsRequired".to_owned(),
            "names what extensionsUsed does not",
        );
        let quantization = "KHR_mesh_quantization";
        self.rule(
            !used.contains(quantization) || required.contains(quantization),
            || "extensionsRequired".to_owned(),
            &format!("{quantization} is used and not in it"),
        );
        let version = |name| {
            let text = self.root.get("asset")?.get(name)?.as_str()?;
            let (major, minor) = text.split_once('.')?;
            Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
        };
        let fits = version("minVersion").is_none_or(|least| version("version") >= Some(least));
        self.rule(fits, || "asset.minVersion".to_owned(), "above its version");
    }

    fn camera(&mut self, camera: &Value, i: usize) {
        let both = camera.get("perspective").is_some() && camera.get("orthographic").is_some();
        self.rule(!both, || format!("cameras[{i}]"), "both perspective and orthographic");
        let kind = camera.get("type").and_then(Value::as_str).unwrap_or_default();
        let Some(lens) = camera.get(kind) else {
            return self.rule(
                kind.is_empty(),
                || format!("cameras[{i}]"),
                &format!("has no `{kind}`"),
            );
        };
        let of = |name: &str| lens.get(name).and_then(Value::as_f64);
        let (near, far) = (of("znear"), of("zfar"));
        self.rule(
            far.is_none() || far > near,
            || format!("cameras[{i}]"),
            "zfar is not above znear",
        );
        let flat = of("xmag") == Some(0.0) || of("ymag") == Some(0.0);
        self.rule(!flat, || format!("cameras[{i}]"), "a magnification of 0");
    }

    fn mesh(&mut self, mesh: &Value, i: usize) {
        let primitives = list(mesh, "primitives");
        let targets = |p: &Value| list(p, "targets").len();
        let first = primitives.first().map_or(0, targets);
        self.rule(
            primitives.iter().all(|p| targets(p) == first),
            || format!("meshes[{i}]"),
            "its primitives have different numbers of morph targets",
        );
        let weights = mesh.get("weights").and_then(Value::as_array);
        self.rule(
            weights.is_none_or(|w| w.len() == first),
            || format!("meshes[{i}].weights"),
            "not one for each morph target",
        );
        for (j, primitive) in primitives.iter().enumerate() {
            let at = format!("meshes[{i}].primitives[{j}]");
            self.primitive(primitive, &at);
            self.variants(primitive, &at);
        }
    }

    fn primitive(&mut self, primitive: &Value, at: &str) {
        let attributes = primitive.get("attributes").and_then(Value::as_object);
        let count = |name: &str| {
            let of = follow(self.root, primitive.get("attributes")?, name, "accessors")?;
            whole(of, "count")
        };
        let vertices = count("POSITION");
        for name in attributes.into_iter().flat_map(|a| a.keys()) {
            let place = || format!("{at}.attributes.{name}");
            let same = vertices.is_none() || count(name).is_none_or(|n| Some(n) == vertices);
            self.faults.rule(same, place, "not as many as positions");
            self.faults.rule(is_semantic(name), place, "no known attribute");
            // TEXCOORD_1 without TEXCOORD_0, and joints without weights.
            let needs = match name.rsplit_once('_') {
                Some((set @ ("TEXCOORD" | "COLOR"), n)) => {
                    n.parse::<u32>().ok().filter(|n| *n > 0).map(|n| format!("{set}_{}", n - 1))
                }
                Some(("JOINTS", n)) => Some(format!("WEIGHTS_{n}")),
                Some(("WEIGHTS", n)) => Some(format!("JOINTS_{n}")),
                _ => None,
            };
            let there = needs.is_none_or(|n| attributes.is_some_and(|a| a.contains_key(&n)));
            self.faults.rule(there, place, "without those that go with it");
            let accessor = primitive.get("attributes");
            let accessor = accessor.and_then(|a| follow(self.root, a, name, "accessors"));
            let format = accessor.and_then(format_of);
            let fits = format.is_none_or(|f| may_be(name, f));
            self.faults.rule(fits, place, "of a type that it cannot have");
        }
        let indices = follow(self.root, primitive, "indices", "accessors").and_then(format_of);
        let fits = indices.is_none_or(|(kind, component, normalized)| {
            kind == "SCALAR" && matches!(component, 5121 | 5123 | 5125) && !normalized
        });
        self.rule(fits, || format!("{at}.indices"), "no unsigned integers");
        for (k, target) in list(primitive, "targets").iter().enumerate() {
            for name in target.as_object().into_iter().flat_map(|t| t.keys()) {
                let place = || format!("{at}.targets[{k}].{name}");
                let known = ["POSITION", "NORMAL", "TANGENT"].contains(&&**name)
                    || name.starts_with("TEXCOORD_")
                    || name.starts_with("COLOR_")
                    || name.starts_with('_');
                self.rule(known, place, "no attribute that morphs");
                let base = attributes.is_some_and(|a| a.contains_key(name));
                self.rule(base || name.starts_with('_'), place, "without one to morph");
                let own = follow(self.root, target, name, "accessors");
                let own = own.and_then(|accessor| whole(accessor, "count"));
                let same = vertices.is_none() || own.is_none() || own == vertices;
                self.rule(same, place, "not as many as positions");
            }
        }
    }

    fn variants(&mut self, primitive: &Value, at: &str) {
        let Some(variants) = extension(primitive, "KHR_materials_variants") else { return };
        let mut met = HashSet::new();
        for mapping in list(variants, "mappings") {
            let new = list(mapping, "variants").iter().all(|v| met.insert(v.to_string()));
            self.rule(new, || at.to_owned(), "one variant has two materials");
        }
    }

    fn nodes(&mut self) {
        let nodes = list(self.root, "nodes");
        let mut has_parent = HashSet::new();
        for (i, node) in nodes.iter().enumerate() {
            let has = |name: &str| node.get(name).is_some();
            let both = has("matrix") && (has("translation") || has("rotation") || has("scale"));
            self.rule(!both, || format!("nodes[{i}]"), "a matrix beside what it is made of");
            for name in ["skin", "weights"] {
                let fits = !has(name) || has("mesh");
                self.rule(fits, || format!("nodes[{i}].{name}"), "without a mesh");
            }
            for child in list(node, "children") {
                let new = has_parent.insert(child.to_string());
                self.rule(
                    new,
                    || format!("nodes[{i}].children"),
                    &format!("node {child} has a parent"),
                );
            }
            let turn = node.get("rotation").and_then(Value::as_array).filter(|q| q.len() == 4);
            let length = turn.map(|q| q.iter().filter_map(Value::as_f64).map(|x| x * x).sum());
            let unit = length.is_none_or(|square: f64| (square.sqrt() - 1.0).abs() < 0.005);
            self.rule(unit, || format!("nodes[{i}].rotation"), "not of length 1");
            let Some(mesh) = follow(self.root, node, "mesh", "meshes") else { continue };
            let primitives = list(mesh, "primitives");
            let targets = primitives.first().map_or(0, |p| list(p, "targets").len());
            let weights = node.get("weights").and_then(Value::as_array);
            let fits = weights.is_none_or(|w| w.len() == targets);
            self.rule(fits, || format!("nodes[{i}].weights"), "not one for each morph target");
            let skinned =
                |p: &Value| p.get("attributes").is_some_and(|a| a.get("JOINTS_0").is_some());
            let fits = !has("skin") || primitives.iter().all(skinned);
            self.rule(fits, || format!("nodes[{i}].skin"), "of a mesh without joints");
        }
        for (i, scene) in list(self.root, "scenes").iter().enumerate() {
            let is_root = |node: &Value| !has_parent.contains(&node.to_string());
            let roots = list(scene, "nodes").iter().all(is_root);
            self.rule(roots, || format!("scenes[{i}].nodes"), "one has a parent");
        }
    }

    fn animation(&mut self, animation: &Value, i: usize) {
        let samplers = list(animation, "samplers");
        let mut targets = HashSet::new();
        for (j, channel) in list(animation, "channels").iter().enumerate() {
            let at = format!("animations[{i}].channels[{j}]");
            let there = whole(channel, "sampler").is_none_or(|s| s < samplers.len() as u64);
            if !there {
                let what = format!("there are {} samplers", samplers.len());
                self.faults.add(Fault::Reference, || (format!("{at}.sampler"), what));
            }
            let Some(target) = channel.get("target") else { continue };
            let pointer = extension(target, "KHR_animation_pointer");
            let points = target.get("path").and_then(Value::as_str) == Some("pointer");
            let fits = pointer.is_none() || points && target.get("node").is_none();
            self.rule(fits, || format!("{at}.target"), "a pointer beside a node or another path");
            let Some(node) = target.get("node") else { continue };
            let new = targets.insert((node.to_string(), target.get("path").map(Value::to_string)));
            self.rule(new, || format!("{at}.target"), "another channel has the same");
            let Some(node) = follow(self.root, target, "node", "nodes") else { continue };
            if target.get("path").and_then(Value::as_str) == Some("weights") {
                let mesh = follow(self.root, node, "mesh", "meshes");
                let primitive = mesh.and_then(|m| list(m, "primitives").first());
                let morphs = primitive.is_some_and(|p| !list(p, "targets").is_empty());
                self.rule(morphs, || format!("{at}.target"), "nothing there morphs");
            } else {
                let moves = node.get("matrix").is_none();
                self.rule(moves, || format!("{at}.target"), "a node with a matrix");
            }
        }
    }

    fn light(&mut self, light: &Value, at: &str) {
        if light.get("type").and_then(Value::as_str) != Some("spot") {
            return;
        }
        let Some(spot) = light.get("spot") else {
            return self.rule(false, || at.to_owned(), "has no `spot`");
        };
        let angle = |name: &str, default| spot.get(name).map_or(Some(default), Value::as_f64);
        let inner = angle("innerConeAngle", 0.0);
        let outer = angle("outerConeAngle", std::f64::consts::FRAC_PI_4);
        self.rule(inner < outer, || format!("{at}.spot"), "the outer cone is not the wider one");
    }
}

fn extension<'v>(object: &'v Value, name: &str) -> Option<&'v Value> {
    object.get("extensions")?.get(name)
}
