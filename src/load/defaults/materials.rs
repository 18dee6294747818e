//! What is settled once a scene and its pictures are there: tangents, what alpha amounts to, and the
//! smaller copies of pictures.

use rayon::prelude::*;

use super::tangents;
use crate::scene::{AlphaMode, Coverage, Material, MaterialId, Scene};

/// Settles it for a scene that is loaded.
pub fn settle(scene: &mut Scene) {
    tangents::complete(scene);
    settle_alpha(scene);
    blend_what_is_no_mesh(scene);
    reduce(scene);
}

/// Leaves out the alpha of materials that cover all of what they cover anyway, so that nothing is
/// asked for it.
fn settle_alpha(scene: &mut Scene) {
    let mut fades = vec![false; scene.materials.len()];
    for instance in &scene.instances {
        if let Some(fades) = fades.get_mut(instance.material.0 as usize) {
            let mesh = scene.meshes.get(instance.mesh.0 as usize);
            *fades |= mesh.is_some_and(|mesh| !mesh.alphas.is_empty());
        }
    }
    for (material, fades) in scene.materials.iter_mut().zip(fades) {
        let Some(coverage) = &mut material.coverage else { continue };
        coverage.map = coverage.map.filter(|map| {
            let image = scene.textures.get(map.texture.0 as usize).map(|texture| &texture.image);
            image.is_some_and(|image| {
                !(image.is_read() && image.is_channel_full(usize::from(map.channel & 3)))
            })
        });
        let is_whole = match coverage.mode {
            AlphaMode::Blend => coverage.alpha >= 1.0,
            AlphaMode::Mask { cutoff } => coverage.alpha >= cutoff,
        };
        if coverage.map.is_none() && !fades && is_whole {
            material.coverage = None;
        }
    }
}

/// Gives spheres and planes that have a mask a copy of their material that is blended: masks are for
/// meshes.
fn blend_what_is_no_mesh(scene: &mut Scene) {
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
            materials.push(match masked.may_transmit() {
                true => Material { coverage: None, ..masked.clone() },
                false => Material {
                    coverage: masked.coverage.map(blend),
                    thin: true,
                    ior: 1.0,
                    ..masked.clone()
                },
            });
            MaterialId(materials.len() as u32 - 1)
        });
    }
}

/// Makes the smaller copies of the pictures that are seen with mipmaps, side by side.
fn reduce(scene: &Scene) {
    let mut shown = vec![false; scene.textures.len()];
    for id in scene.materials_in_use().flat_map(Material::textures) {
        if let Some(shown) = shown.get_mut(id.0 as usize) {
            *shown = true;
        }
    }
    scene.textures.par_iter().zip(shown).for_each(|(texture, shown)| {
        if shown && texture.mipmap && texture.image.is_read() {
            texture.image.mipmap(texture.transfer);
        }
    });
}
