//! A model that uses most of what is read.

use serde_json::json;

use super::{Model, png};

/// A model that uses most of what is read: indices, normals, texture coordinates, colours, a
/// sparse accessor, a texture in a buffer, a camera, lights and a tree of nodes.
pub fn model() -> Model {
    let mut model = Model::parabola(5);
    let normals = model.floats("VEC3", &[0.0, 0.6, 0.8].repeat(5));
    let uvs = model.floats("VEC2", &[0., 0., 1., 0., 0., 1., 1., 1., 0.5, 0.5]);
    let colors = model.typed(5121, "VEC4", 1, &[200; 20]);
    model.accessor_mut(colors)["normalized"] = true.into();
    let indices = model.shorts(&[0, 1, 2, 2, 3, 4]);
    let at = model.view(&[1, 0]);
    let values = model.view(&[0; 12]);
    model.accessor_mut(0)["sparse"] = json!({"count": 1,
        "indices": {"bufferView": at, "componentType": 5123}, "values": {"bufferView": values}});
    let picture = model.view(&png(&[[255, 0, 0, 255], [0, 255, 0, 255]]));
    model.json["images"] = json!([{"bufferView": picture, "mimeType": "image/png"},
                                  {"uri": "picture.png"}]);
    model.json["samplers"] = json!([{"wrapS": 33071, "magFilter": 9728}]);
    model.json["textures"] = json!([{"source": 0, "sampler": 0}, {"source": 1}]);
    model.material(json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 1, 1], "roughnessFactor": 0.4,
            "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {
                "offset": [0.5, 0.25], "rotation": 1.5, "scale": [2, 2]}}}},
        "emissiveFactor": [0.1, 0, 0], "emissiveTexture": {"index": 1},
        "alphaMode": "BLEND", "alphaCutoff": 0.5, "extensions": {
            "KHR_materials_transmission": {
                "transmissionFactor": 0.5, "transmissionTexture": {"index": 1}},
            "KHR_materials_ior": {"ior": 1.25},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0.5,
                "attenuationColor": [0.5, 0.25, 1]}}}));
    let primitive = model.primitive();
    primitive["indices"] = indices.into();
    primitive["mode"] = 4.into();
    primitive["attributes"]["NORMAL"] = normals.into();
    primitive["attributes"]["TEXCOORD_0"] = uvs.into();
    primitive["attributes"]["COLOR_0"] = colors.into();
    model.json["cameras"] = json!([{"type": "perspective",
        "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.5}}]);
    model.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_texture_transform"]);
    model.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "color": [1, 1, 0.5], "intensity": 30, "range": 20,
         "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}}]}});
    model.json["nodes"] = json!([
        {"mesh": 0, "children": [1, 2], "translation": [1, 2, 3], "rotation": [0, 0, 0, 1]},
        {"mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1], "children": [3]},
        {"camera": 0, "translation": [0, 1, 9]},
        {"scale": [1, 1, -1], "extensions": {"KHR_lights_punctual": {"light": 0}}}]);
    model
}
