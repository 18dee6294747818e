//! The simplification of alpha coverage, once the images of a scene are there.

use crate::scene::{AlphaMode, Coverage, Material, MaterialId, Scene};

/// Removes the coverage of materials that are opaque everywhere all the same, so that nothing is
/// looked up for it.
pub fn remove_opaque_coverage(scene: &mut Scene) {
    // The materials of meshes whose vertices have alphas.
    let mut has_vertex_alpha = vec![false; scene.materials.len()];
    for instance in &scene.instances {
        if let Some(has_alpha) = has_vertex_alpha.get_mut(instance.material.0 as usize) {
            let mesh = scene.meshes.get(instance.mesh.0 as usize);
            *has_alpha |= mesh.is_some_and(|mesh| !mesh.alphas.is_empty());
        }
    }

    // Coverage that neither a factor, a map nor a vertex makes less than 1 is removed.
    for (material, has_vertex_alpha) in scene.materials.iter_mut().zip(has_vertex_alpha) {
        let Some(coverage) = &mut material.coverage else { continue };
        // An image whose alpha is 1 everywhere says nothing.
        coverage.map = coverage.map.filter(|map| {
            let image = scene.textures.get(map.texture.0 as usize).map(|texture| &texture.image);
            image.is_some_and(|image| {
                !(image.is_read() && image.is_channel_full(usize::from(map.channel & 3)))
            })
        });
        let is_opaque = match coverage.mode {
            AlphaMode::Blend => coverage.alpha >= 1.0,
            AlphaMode::Mask { cutoff } => coverage.alpha >= cutoff,
        };
        if coverage.map.is_none() && !has_vertex_alpha && is_opaque {
            material.coverage = None;
        }
    }
}

/// Gives masked spheres and planes a copy of their material that is blended instead: masks are for
/// meshes.
pub fn blend_masked_shapes(scene: &mut Scene) {
    // Each masked material is copied once, for all shapes that have it.
    let mut copies = vec![None; scene.materials.len()];
    let Scene { materials, spheres, planes, .. } = scene;
    let spheres = spheres.iter_mut().map(|sphere| &mut sphere.material);
    for id in spheres.chain(planes.iter_mut().map(|plane| &mut plane.material)) {
        let at = id.0 as usize;
        if !materials.get(at).is_some_and(Material::is_masked) {
            continue;
        }
        *id = *copies[at].get_or_insert_with(|| {
            let masked = &materials[at];
            let blend = |coverage| Coverage { mode: AlphaMode::Blend, ..coverage };
            // What transmits light is left to its glass; all else becomes as thin as a blended
            // mesh.
            materials.push(if masked.may_transmit() {
                Material { coverage: None, ..masked.clone() }
            } else {
                let coverage = masked.coverage.map(blend);
                Material { coverage, thin: true, ior: 1.0, ..masked.clone() }
            });
            MaterialId(materials.len() as u32 - 1)
        });
    }
}
