//! Null interfaces: surfaces that light passes as if nothing were there.
//!
//! They are hidden in another dielectric, or clear and with the same index of refraction on both
//! sides. A ray that hits one goes straight on in the same wave.

use std::collections::HashMap;

use glam::Vec3;

use crate::geometry::{HitBatch, RayBatch};
use crate::integrator::nested_dielectrics::InterfaceMedia;
use crate::integrator::radiance::{DARK, Radiance16};
use crate::integrator::surface_evaluation::shading_params_at;
use crate::integrator::wave::Wave;
use crate::integrator::{Counts, Integrator};
use crate::intersect::Coherence;
use crate::scene::{Material, Scene, ShadingParams};
use crate::surface::Surface;

/// True if a scene may have clear surfaces with the same index of refraction on both sides.
pub(super) fn may_match_indices(scene: &Scene) -> bool {
    // How many media have each index of refraction: empty space, and the dielectrics.
    let mut counts = HashMap::from([(1f64.to_bits(), 1)]);
    for material in scene.materials_in_use().filter(|material| material.is_dielectric()) {
        *counts.entry(material.ior.to_bits()).or_insert(0) += 1;
    }
    scene.materials_in_use().any(|material| {
        // The material's own index is among them once, and counts where another one is the same.
        let matches = counts.get(&material.ior.to_bits()).copied().unwrap_or(0);
        material.is_clear_in(material.ior) && matches > usize::from(material.is_dielectric())
    })
}

/// True if a surface of a material is a null interface.
pub(super) fn is_null_interface(
    integrator: &Integrator<'_>,
    material: &Material,
    params: &ShadingParams,
    media: &InterfaceMedia,
) -> bool {
    let iors = |interior| integrator.media.dielectrics.medium(interior).iors;
    let behind = if material.thin { [material.ior; 3] } else { iors(&media.transmitted) };
    let is_clear = params.transmit == Vec3::ONE && params.emission == Vec3::ZERO;
    media.is_hidden || (is_clear && iors(&media.incident) == behind)
}

/// Gives each camera ray of a wave a path, and sets its sample to black.
pub(super) fn begin_paths(
    integrator: &Integrator<'_>,
    wave: &mut Wave,
    samples: &mut Vec<Radiance16>,
) {
    wave.paths = (0..wave.rays.len()).map(|i| wave.path(i, integrator)).collect();
    samples.clear();
    samples.resize(wave.rays.blocks().len(), DARK);
}

/// Takes the rays of a wave through null interfaces, and multiplies their throughput by the
/// transmittance of the media on their way.
///
/// The rays stay in the wave, with the hits beyond: later stages cannot tell that there was anything.
pub(super) fn cross(integrator: &Integrator<'_>, wave: &mut Wave, counts: &mut Counts) {
    // Camera rays without paths start in empty space, and hit no null interfaces.
    if wave.paths.is_empty() {
        return;
    }
    let (scene, dielectrics) = (integrator.scene, &integrator.media.dielectrics);
    let Wave { rays, hits, paths, .. } = wave;
    let (mut continued, mut continued_hits) = (RayBatch::default(), HitBatch::default());
    let mut crossed = Vec::new();
    let mut active: Vec<usize> = (0..rays.len()).collect();
    while !active.is_empty() {
        crossed.clear();
        continued.clear();
        for &i in &active {
            // The medium before the surface absorbs.
            let (ray, hit, path) = (rays.ray(i), hits.get(i), &mut paths[i]);
            let end = hit.map_or(f64::INFINITY, |hit| hit.t);
            path.throughput *= dielectrics.transmittance(&ray, end, &path.interior);
            let Some(hit) = &hit else { continue };
            let material = &scene.materials[scene.material_of(hit.id).0 as usize];
            if !material.may_transmit() {
                continue;
            }
            // Through a null interface the ray goes straight on.
            let surface = Surface::new(scene, &ray, hit);
            let media = dielectrics.interface(hit.id, surface.side, &path.interior);
            let params = shading_params_at(integrator, &ray, hit, &surface, &path.cone);
            if is_null_interface(integrator, material, &params, &media) {
                let continuation = ray.continue_past(hit, surface.side.opposite());
                rays.set(i, &continuation);
                path.interior = media.transmitted;
                crossed.push(i);
                continued.push(&continuation);
            }
        }
        // These rays find their next hits, which may be null interfaces again.
        integrator.visible_hits(&continued, Coherence::Incoherent, &mut continued_hits, counts);
        counts.rays.refraction += continued.len() as u64;
        for (&i, hit) in crossed.iter().zip(continued_hits.iter()) {
            hits.set(i, hit);
        }
        std::mem::swap(&mut active, &mut crossed);
    }
}
