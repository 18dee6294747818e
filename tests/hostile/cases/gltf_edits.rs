//! A sound glTF file in which one value is not what it should be.

use serde_json::{Value, json};

use super::{Case, Error, Expect, Warning};
use envers_testing::{data_uri, png, whole};

/// Where, what stands there instead, and what comes of it. Text between `@` is written as it is.
type Edit = (&'static str, &'static str, Expect);

const EDITS: &[Edit] = &[
    ("/asset", "@null@", Error("asset.version")),
    ("/asset", "[]", Error("asset.version")),
    ("/asset/version", "\"3.0\"", Error("version `3.0`")),
    ("/asset/version", "\"\"", Error("version")),
    ("/asset/version", "2.0", Error("version")),
    ("/asset/minVersion", "\"9.9\"", Expect::Any),
    ("/scene", "1", Error("scene 1")),
    ("/scene", "-1", Error("")),
    ("/scene", "4294967295", Error("")),
    ("/scene", "4294967296", Error("")),
    ("/scene", "@1e999@", Error("")),
    ("/scene", "\"0\"", Error("")),
    ("/scenes", "{}", Error("")),
    ("/scenes/0/nodes", "[0, 0, 0]", Warning("stand twice")),
    ("/scenes/0/nodes", "[9]", Error("scenes[0].nodes[0]")),
    ("/scenes/0/nodes", "[4294967296]", Error("")),
    ("/scenes/0/nodes", "[-1]", Error("")),
    ("/scenes/0/nodes", "[[0]]", Error("")),
    ("/nodes", "[]", Error("node 0")),
    ("/nodes", "[null]", Error("")),
    ("/nodes/0/mesh", "1", Error("nodes[0].mesh")),
    ("/nodes/0/mesh", "18446744073709551616", Error("")),
    ("/nodes/0/children", "[0]", Error("its own ancestor")),
    ("/nodes/0/children", "[1, 1, 1]", Warning("")),
    ("/nodes/0/children", "[99]", Error("nodes[0].children[0]")),
    ("/nodes/3/children", "[0]", Error("its own ancestor")),
    ("/nodes/0/translation", "[1e39, 0, 0]", Error("")),
    ("/nodes/0/translation", "[3e38, 3e38, 3e38]", Error("")),
    ("/nodes/0/translation", "[0, 0]", Error("")),
    ("/nodes/0/rotation", "[0, 0, 0, 0]", Warning("length 0")),
    ("/nodes/0/rotation", "[1e-45, 0, 0, 0]", Expect::Any),
    ("/nodes/0/rotation", "[3e38, 3e38, 3e38, 3e38]", Expect::Any),
    ("/nodes/0/scale", "[0, 0, 0]", Warning("scale is 0")),
    ("/nodes/0/scale", "[1e-30, 1e-30, 1e-30]", Warning("")),
    ("/nodes/0/scale", "[1e38, 1e38, 1e38]", Error("")),
    ("/nodes/1/matrix", "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]", Warning("")),
    ("/nodes/1/matrix", "[1, 2, 3]", Error("")),
    ("/nodes/2/camera", "7", Error("nodes[2].camera")),
    ("/nodes/3/extensions/KHR_lights_punctual/light", "7", Error("light")),
    ("/cameras/0/perspective/yfov", "0", Expect::Any),
    ("/cameras/0/perspective/yfov", "-1", Expect::Any),
    ("/cameras/0/perspective/yfov", "7", Expect::Any),
    ("/cameras/0/perspective/yfov", "1e-45", Expect::Any),
    ("/cameras/0/perspective", "null", Expect::Any),
    ("/cameras/0/type", "\"fisheye\"", Expect::Any),
    ("/extensions/KHR_lights_punctual/lights", "[]", Error("light")),
    ("/extensions/KHR_lights_punctual/lights/0/intensity", "1e38", Expect::Any),
    ("/extensions/KHR_lights_punctual/lights/0/intensity", "-5", Expect::Any),
    ("/extensions/KHR_lights_punctual/lights/0/range", "0", Expect::Any),
    ("/extensions/KHR_lights_punctual/lights/0/range", "-1", Expect::Any),
    ("/extensions/KHR_lights_punctual/lights/0/color", "[1e38, -1, 0]", Expect::Any),
    ("/extensions/KHR_lights_punctual/lights/0/type", "\"moon\"", Expect::Any),
    ("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", "0", Expect::Any),
    ("/extensions/KHR_lights_punctual/lights/0/spot/innerConeAngle", "9", Expect::Any),
    ("/extensionsRequired", "[\"EXT_texture_avif\"]", Error("EXT_texture_avif")),
    ("/extensionsRequired", "[\"\\u001b[2J\"]", Error("requires")),
    ("/extensionsRequired", "[\"../../x\"]", Error("requires")),
    ("/meshes/0/primitives", "[]", Expect::Any),
    ("/meshes/0/primitives/0/mode", "7", Error("mode")),
    ("/meshes/0/primitives/0/mode", "255", Error("mode")),
    ("/meshes/0/primitives/0/mode", "0", Warning("points")),
    ("/meshes/0/primitives/0/indices", "99", Error("accessor 99")),
    ("/meshes/0/primitives/0/indices", "0", Error("")),
    ("/meshes/0/primitives/0/material", "9", Error("material")),
    ("/meshes/0/primitives/0/attributes/POSITION", "4", Error("")),
    ("/meshes/0/primitives/0/attributes/POSITION", "4294967296", Error("")),
    ("/meshes/0/primitives/0/attributes/NORMAL", "2", Error("")),
    ("/meshes/0/primitives/0/attributes/TEXCOORD_0", "0", Error("")),
    ("/meshes/0/primitives/0/attributes/COLOR_0", "4", Expect::Any),
    ("/meshes/0/primitives/0/targets", "[{\"POSITION\": 99}]", Expect::Any),
    ("/meshes/0/weights", "[1e38, 1e38]", Expect::Any),
    ("/accessors/0/count", "0", Expect::Any),
    ("/accessors/0/count", "6", Expect::Any),
    ("/accessors/0/count", "4294967295", Error("accessors[0]")),
    ("/accessors/0/count", "18446744073709551615", Error("accessors[0]")),
    ("/accessors/0/count", "@1e19@", Error("")),
    ("/accessors/0/count", "-1", Error("")),
    ("/accessors/0/count", "2.5", Error("")),
    ("/accessors/0/byteOffset", "1", Expect::Any),
    ("/accessors/0/byteOffset", "18446744073709551615", Error("accessors[0]")),
    ("/accessors/0/bufferView", "99", Error("accessors[0].bufferView")),
    ("/accessors/0/componentType", "5124", Error("componentType")),
    ("/accessors/0/componentType", "0", Error("componentType")),
    ("/accessors/0/componentType", "4294972422", Error("")),
    ("/accessors/0/type", "\"MAT4\"", Error("accessors[0].type")),
    ("/accessors/0/type", "\"VEC5\"", Error("accessors[0].type")),
    ("/accessors/0/sparse/count", "4000000000", Error("sparse")),
    ("/accessors/0/sparse/count", "18446744073709551615", Error("sparse")),
    ("/accessors/0/sparse/count", "0", Expect::Any),
    ("/accessors/0/sparse/indices/componentType", "5126", Error("sparse")),
    ("/accessors/0/sparse/indices/bufferView", "99", Error("sparse")),
    ("/accessors/0/sparse/indices/byteOffset", "18446744073709551615", Error("sparse")),
    ("/accessors/0/sparse/values/bufferView", "99", Error("sparse")),
    ("/accessors/0/sparse/values/byteOffset", "18446744073709551612", Error("sparse")),
    ("/accessors/0/sparse/values", "null", Expect::Any),
    ("/accessors/3/normalized", "false", Expect::Any),
    ("/accessors/4/componentType", "5126", Error("indices")),
    ("/accessors/4/count", "7", Error("accessors[4]")),
    ("/bufferViews/0/byteOffset", "18446744073709551615", Error("bufferViews[0]")),
    ("/bufferViews/0/byteOffset", "9223372036854775808", Error("bufferViews[0]")),
    ("/bufferViews/0/byteLength", "18446744073709551615", Error("bufferViews[0]")),
    ("/bufferViews/0/byteLength", "0", Error("")),
    ("/bufferViews/0/byteStride", "18446744073709551615", Error("accessors[0]")),
    ("/bufferViews/0/byteStride", "1", Expect::Any),
    ("/bufferViews/0/byteStride", "0", Expect::Any),
    ("/bufferViews/0/buffer", "1", Error("bufferViews[0].buffer")),
    ("/buffers", "[]", Error("buffer")),
    ("/buffers/0/byteLength", "18446744073709551615", Expect::Any),
    ("/buffers/0/byteLength", "1", Expect::Any),
    ("/buffers/0/byteLength", "-1", Error("")),
    ("/buffers/0/uri", "\"\"", Error("buffers[0].uri")),
    ("/buffers/0/uri", "\"data:\"", Error("comma")),
    ("/buffers/0/uri", "\"data:;base64,!!!!\"", Error("base64")),
    ("/buffers/0/uri", "\"data:,\"", Error("bufferViews")),
    ("/buffers/0/uri", "\"data:;base64,AAAA\"", Error("bufferViews")),
    ("/buffers/0/uri", "\"%FF%FE\"", Error("buffers[0].uri")),
    ("/buffers/0/uri", "\"%\"", Error("buffers[0].uri")),
    ("/buffers/0/uri", "\"a%00.bin\"", Error("buffers[0].uri")),
    ("/buffers/0/uri", "\"\\u0000\"", Error("buffers[0].uri")),
    ("/buffers/0/uri", "\"hostile.gltf\"", Error("accessors[0]")),
    ("/materials", "[]", Error("material 0")),
    ("/materials/0/pbrMetallicRoughness/baseColorFactor", "[1e38, -1, 2, 5]", Expect::Any),
    ("/materials/0/pbrMetallicRoughness/roughnessFactor", "-3", Expect::Any),
    ("/materials/0/pbrMetallicRoughness/metallicFactor", "1e30", Expect::Any),
    ("/materials/0/pbrMetallicRoughness/baseColorTexture/index", "9", Error("texture 9")),
    ("/materials/0/pbrMetallicRoughness/baseColorTexture/texCoord", "4294967295", Expect::Any),
    ("/materials/0/emissiveFactor", "[1e38, 1e38, 1e38]", Expect::Any),
    ("/materials/0/emissiveTexture/index", "-1", Error("")),
    ("/materials/0/alphaMode", "\"SOLID\"", Expect::Any),
    ("/materials/0/alphaCutoff", "-1e38", Expect::Any),
    ("/materials/0/extensions/KHR_materials_ior/ior", "0.001", Expect::Any),
    ("/materials/0/extensions/KHR_materials_ior/ior", "-1", Expect::Any),
    ("/materials/0/extensions/KHR_materials_volume/attenuationDistance", "0", Expect::Any),
    ("/materials/0/extensions/KHR_materials_volume/attenuationColor", "[-1, 0, 9]", Expect::Any),
    ("/materials/0/extensions/KHR_materials_volume/thicknessFactor", "-1", Expect::Any),
    ("/materials/0/extensions/KHR_materials_transmission/transmissionFactor", "1e30", Expect::Any),
    ("/textures/0/source", "99", Error("image 99")),
    ("/textures/0/source", "4294967295", Expect::Any),
    ("/textures/0/sampler", "99", Error("sampler 99")),
    ("/samplers/0/wrapS", "0", Expect::Any),
    ("/samplers/0/magFilter", "4294967295", Expect::Any),
    ("/images/0", "{}", Warning("neither a URI nor a buffer view")),
    ("/images/0/bufferView", "99", Warning("images[0].bufferView")),
    ("/images/0/bufferView", "0", Warning("images[0]")),
    ("/images/1/uri", "\"gone.png\"", Warning("gone.png")),
    ("/images/1/uri", "\".\"", Warning("a folder")),
    ("/images/1/uri", "\"data:image/png;base64,\"", Warning("images[1]")),
    ("/images/1/uri", "\"hostile.gltf\"", Warning("images[1]")),
];

/// The values that must not be trusted, by what they make of a scene, and others by what they are.
pub fn cases() -> Vec<Case> {
    let edit = |&(pointer, value, expect): &Edit| {
        let mut model = whole::model();
        let bin = data_uri(model.bin());
        model.material(model.json["materials"][0].clone());
        let mut json = model.to_json(Some(&bin));
        let raw = value.contains('@');
        let new = match raw {
            true => Value::from(value),
            false => serde_json::from_str(value).unwrap(),
        };
        set(&mut json, pointer, new);
        let text = json.to_string().replace("\"@", "").replace("@\"", "");
        Case::new(format!("gltf {pointer} {value}"), "hostile.gltf", text, expect)
            .with("picture.png", png(&[[255, 255, 255, 255]]))
    };
    EDITS.iter().map(edit).chain(rest()).collect()
}

/// Extensions and lists of which there is none in the model.
fn rest() -> Vec<Case> {
    let with = |name: &str, expect, change: fn(&mut Value)| {
        let model = whole::model();
        let mut json = model.to_json(Some(&data_uri(model.bin())));
        change(&mut json);
        Case::new(name, "hostile.gltf", json.to_string(), expect)
            .with("picture.png", png(&[[255, 255, 255, 255]]))
    };
    vec![
        with("gltf skin of joints that are not there", Expect::Any, |json| {
            json["skins"] = json!([{"joints": [99, 4294967295u32], "inverseBindMatrices": 99}]);
            json["nodes"][0]["skin"] = 0.into();
        }),
        with("gltf skin that is not there", Expect::Any, |json| {
            json["nodes"][0]["skin"] = 7.into()
        }),
        with("gltf webp picture that is not there", Expect::Any, |json| {
            json["textures"][0]["extensions"] = json!({"EXT_texture_webp": {"source": 1e18}});
        }),
        with("gltf unlit that is no object", Expect::Any, |json| {
            json["materials"][0]["extensions"] = json!({"KHR_materials_unlit": 3});
        }),
        with("gltf instancing of attributes that are not there", Expect::Any, |json| {
            json["nodes"][0]["extensions"] =
                json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 99}}});
        }),
        with("gltf instancing by a count beyond all memory", Expect::Any, |json| {
            let accessors = json["accessors"].as_array_mut().unwrap();
            let huge = json!({"componentType": 5126, "type": "VEC3", "count": 1u64 << 40});
            accessors.push(huge);
            let index = accessors.len() - 1;
            json["nodes"][0]["extensions"] =
                json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": index}}});
        }),
        with("gltf implicit shapes of no size", Expect::Any, |json| {
            json["extensions"]["KHR_implicit_shapes"] = json!({"shapes": [
                {"type": "sphere", "sphere": {"radius": -1}}, {"type": "cone"}, {}]});
            json["nodes"][0]["extensions"] = json!({"KHR_implicit_shapes": {"shape": 9}});
        }),
        with("gltf variants of materials that are not there", Expect::Any, |json| {
            json["extensions"]["KHR_materials_variants"] = json!({"variants": []});
            json["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_materials_variants":
                {"mappings": [{"material": 99, "variants": [4294967295u32]}]}});
        }),
        with("gltf meshopt with lying lengths", Expect::Any, |json| {
            json["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": {
                "buffer": 9, "byteLength": u64::MAX, "byteStride": 256, "count": u64::MAX,
                "mode": "ATTRIBUTES"}});
        }),
    ]
}

/// Puts a value in a place, which need not be there.
fn set(json: &mut Value, pointer: &str, new: Value) {
    let (above, key) = pointer.rsplit_once('/').unwrap();
    let above = json.pointer_mut(above).unwrap_or_else(|| panic!("{pointer}"));
    match above {
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = new,
        Value::Object(map) => drop(map.insert(key.to_owned(), new)),
        other => panic!("{pointer}: {other}"),
    }
}
