//! The check of the extensions that a file uses: files that require an unknown one are refused.

use gltf::json;

use super::json::error_at;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;

/// The extensions that are accepted.
#[rustfmt::skip]
const ACCEPTED: [&str; 39] = [
    // Those that are read.
    "EXT_meshopt_compression", "KHR_draco_mesh_compression", "KHR_implicit_shapes",
    "EXT_mesh_gpu_instancing", "EXT_texture_webp", "KHR_lights_punctual",
    "KHR_materials_anisotropy", "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission", "KHR_materials_dispersion",
    "KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness", "KHR_materials_sheen", "KHR_materials_specular",
    "KHR_materials_transmission", "KHR_materials_unlit", "KHR_materials_variants",
    "KHR_materials_volume", "KHR_mesh_quantization", "KHR_node_visibility", "KHR_texture_basisu",
    "KHR_texture_transform",
    // Those that do not change the image: metadata, physics, sound, interaction, and coarser levels
    // of detail.
    "EXT_feature_metadata", "EXT_instance_features", "EXT_mesh_features",
    "EXT_structural_metadata", "FB_ngon_encoding", "GODOT_single_root", "KHR_audio_emitter",
    "KHR_interactivity", "KHR_node_hoverability", "KHR_node_selectability",
    "KHR_physics_rigid_bodies", "KHR_xmp", "KHR_xmp_json_ld", "MSFT_lod", "MSFT_physics",
];
/// The prefixes of the names of further extensions that do not change the image.
const ACCEPTED_PREFIXES: [&str; 6] =
    ["OMI_collider", "OMI_physics_", "OMI_seat", "OMI_spawn_point", "OMI_vehicle_", "OMI_link"];

/// Refuses a file that requires (`extensionsRequired`) an extension that is not accepted, and warns
/// of others that it uses (`extensionsUsed`).
pub fn check(root: &json::Root, diagnostics: &mut Diagnostics) -> Result<()> {
    let is_accepted = |name: &str| {
        ACCEPTED.contains(&name) || ACCEPTED_PREFIXES.iter().any(|prefix| name.starts_with(prefix))
    };
    for (i, name) in root.extensions_required.iter().enumerate() {
        if !is_accepted(name) {
            let path = format_args!("extensionsRequired[{i}]");
            let error = error_at(path, format!("the file requires {name}, which is not read"));
            return Err(error.help(advice(name)));
        }
    }
    for name in root.extensions_used.iter().filter(|name| !is_accepted(name)) {
        diagnostics.unsupported(&format!("the extension {name} is not read"), 1, String::new);
    }
    Ok(())
}

/// The advice on a file that requires an extension.
fn advice(name: &str) -> &'static str {
    match name {
        "KHR_meshopt_compression" => {
            "`npx @gltf-transform/cli copy IN.glb OUT.glb` writes it uncompressed"
        }
        "EXT_texture_avif" => {
            "`npx @gltf-transform/cli png IN.glb OUT.glb` turns its images into PNG"
        }
        "KHR_techniques_webgl" | "KHR_technique_webgl" => "export it with glTF's own materials",
        _ => {
            "export it without the extension; `npx @gltf-transform/cli inspect IN.glb` lists what \
             uses it"
        }
    }
}
