//! Shadow rays through glass, which dims and tints light on its way to a surface.
//!
//! The light goes straight on, since a refracted path would have to be searched for: each surface
//! takes off what Fresnel's law reflects, at the angle in the optically thinner of the two media, and
//! tints the rest by its share of transmission; each dielectric absorbs along the way.

use glam::DVec3;

use crate::geometry::{Hit, HitBatch, LANES, Ray, RayBatch, Side};
use crate::integrator::nested_dielectrics::InteriorList;
use crate::integrator::shadow_rays::{AttenuatedRay, ShadowQueue};
use crate::integrator::surface_evaluation::shading_params_at;
use crate::integrator::wave::Wave;
use crate::integrator::{Counts, Integrator};
use crate::intersect::{Coherence, Crossing, Query};
use crate::scene::Shadow;
use crate::shading::DielectricInterface;
use crate::surface::{RayCone, Surface};

/// Memory for tracing shadow rays through glass.
#[derive(Default)]
pub(super) struct TransmissiveShadows {
    /// True for each shadow ray that certainly hits no glass.
    misses_glass: Vec<bool>,
    /// The paths of the shadow rays that may hit glass.
    paths: Vec<ShadowPath>,
    /// The rays of these paths that are traced, and their hits.
    rays: RayBatch,
    hits: HitBatch,
    /// The continuation rays beyond these hits, which are traced next.
    continued: RayBatch,
    /// The layers that shadow rays may cross.
    crossings: Vec<Crossing>,
}

/// The state of a shadow ray that nothing occludes, on its way to the light.
struct ShadowPath {
    /// The number of the shadow ray.
    ray: usize,
    /// The dielectrics that it is in.
    interior: InteriorList,
    /// The share of the light that is left.
    transmittance: DVec3,
}

/// Works out the transmittance along the shadow rays of a queue that nothing opaque occludes.
///
/// A ray that may hit glass is marked as occluded, and, if any light is left, listed among the
/// attenuated rays instead.
pub(super) fn attenuate(
    integrator: &Integrator<'_>,
    shadow: Shadow,
    wave: &Wave,
    queue: &mut ShadowQueue,
    memory: &mut TransmissiveShadows,
    counts: &mut Counts,
) {
    let ShadowQueue { rays: shadow_rays, pending, occluded, attenuated } = queue;
    let TransmissiveShadows { misses_glass, paths, rays, hits, continued, .. } = memory;
    // Rays that miss the boxes of all glass stay as they are.
    integrator.media.bounds.find_misses(integrator.arch, shadow_rays, misses_glass);
    paths.clear();
    continued.clear();
    for (i, occluded) in occluded.iter_mut().enumerate() {
        if *occluded || misses_glass[i] {
            continue;
        }
        let ray = shadow_rays.ray(i);
        if ray.tmax <= 0.0 {
            continue;
        }
        *occluded = true;
        let hit = pending[i / LANES].block * LANES + i % LANES;
        let interior = interior_at_origin(integrator, &ray, wave, hit);
        paths.push(ShadowPath { ray: i, interior, transmittance: DVec3::ONE });
        continued.push(&ray);
    }
    // The others go from surface to surface, all together.
    while !paths.is_empty() {
        integrator.closest_hits(continued, Coherence::Incoherent, hits, counts);
        counts.rays.shadow += continued.len() as u64;
        counts.work.glass += continued.len() as u64;
        std::mem::swap(rays, continued);
        continued.clear();
        let mut traced = rays.iter().zip(hits.iter());
        paths.retain_mut(|path| {
            let Some((ray, hit)) = traced.next() else { return false };
            let end = hit.map_or(ray.tmax, |hit| hit.t);
            let dielectrics = &integrator.media.dielectrics;
            path.transmittance *= dielectrics.transmittance(&ray, end, &path.interior);
            let Some(hit) = hit else {
                // The ray arrives at the light. With opaque shadows, dimmed light counts as none.
                let &mut ShadowPath { ray, transmittance, .. } = path;
                if shadow != Shadow::Opaque || transmittance == DVec3::ONE {
                    attenuated.push(AttenuatedRay { ray, transmittance });
                }
                return false;
            };
            let side = cross_surface(integrator, &ray, &hit, path);
            let is_lit = is_lit(shadow, path.transmittance);
            if is_lit {
                continued.push(&ray.continue_past(&hit, side));
            }
            is_lit
        });
    }
}

/// Finds which shadow rays of a queue are occluded, and the transmittance of the layers that the others
/// cross, in one traversal, whatever their number. Returns false, and does nothing, if the scene has more
/// than layers or the intersector does not find crossings.
pub(super) fn find_layers(
    integrator: &Integrator<'_>,
    shadow: Shadow,
    queue: &mut ShadowQueue,
    memory: &mut TransmissiveShadows,
    counts: &mut Counts,
) -> bool {
    let Integrator { scene, intersector, media, .. } = integrator;
    let ShadowQueue { rays, occluded, attenuated, .. } = queue;
    let crossings = &mut memory.crossings;
    if !media.are_layers
        || !intersector.occluded_with_crossings(rays, Coherence::Coherent, occluded, crossings)
    {
        return false;
    }
    let has_filter = intersector.uses_filter(Query::Occluded, rays);
    counts.work.add_extra_tests(scene, has_filter, rays);
    // The layers of each ray, each once, in their order along it.
    crossings.sort_unstable();
    crossings.dedup();
    let mut ids = Vec::new();
    for crossings in crossings.chunk_by(|a, b| a.ray == b.ray) {
        let number = crossings[0].ray as usize;
        if occluded[number] {
            continue;
        }
        let ray = rays.ray(number);
        ids.clear();
        ids.extend(crossings.iter().map(|crossing| crossing.id));
        let interior = InteriorList::default();
        let mut path = ShadowPath { ray: number, interior, transmittance: DVec3::ONE };
        for hit in intersector.hits_on(&ray, &ids) {
            counts.work.glass += 1;
            cross_surface(integrator, &ray, &hit, &mut path);
            if !is_lit(shadow, path.transmittance) {
                break;
            }
        }
        if path.transmittance != DVec3::ONE {
            occluded[number] = true;
            if is_lit(shadow, path.transmittance) {
                attenuated.push(AttenuatedRay { ray: number, transmittance: path.transmittance });
            }
        }
    }
    true
}

/// True if light of this transmittance counts.
fn is_lit(shadow: Shadow, transmittance: DVec3) -> bool {
    match shadow {
        Shadow::Tinted | Shadow::None => transmittance != DVec3::ZERO,
        Shadow::Opaque => transmittance == DVec3::ONE,
    }
}

/// Returns the interior list at the origin of a shadow ray, which leaves the surface that ray `i` of
/// a wave hit.
fn interior_at_origin(
    integrator: &Integrator<'_>,
    shadow_ray: &Ray,
    wave: &Wave,
    i: usize,
) -> InteriorList {
    let (ray, hit, path) = (wave.rays.ray(i), wave.hits.get(i), wave.path(i, integrator));
    let (Some(hit), Some(departure)) = (hit, shadow_ray.departure) else { return path.interior };
    let side = Surface::new(integrator.scene, &ray, &hit).side;
    let media = integrator.media.dielectrics.interface(hit.id, side, &path.interior);
    if departure.side == side { media.incident } else { media.transmitted }
}

/// Takes a shadow path through the surface that its ray hit; returns the side on which it goes on.
fn cross_surface(integrator: &Integrator<'_>, ray: &Ray, hit: &Hit, path: &mut ShadowPath) -> Side {
    let (scene, dielectrics) = (integrator.scene, &integrator.media.dielectrics);
    let surface = Surface::new(scene, ray, hit);
    let material = &scene.materials[surface.material.0 as usize];
    let media = dielectrics.interface(surface.id, surface.side, &path.interior);
    let opposite = surface.side.opposite();
    if !scene.casts_shadow(hit.id) {
        // The object is not there for the light; only a ray that was in it must get out.
        if dielectrics.oriented_side(hit.id, surface.side) == Side::Back {
            path.interior = media.transmitted;
        }
        return opposite;
    }
    if material.passes_light_from_behind()
        && integrator.back_faces.culled_side(hit.id) == Some(opposite)
    {
        return opposite;
    }
    if !media.is_hidden {
        let cosine = surface.normal.dot(ray.direction).abs() / ray.direction.length();
        let interface = if material.thin {
            let ior = dielectrics.medium(&path.interior).ior();
            DielectricInterface::thin_sheet(cosine, ior.min(material.ior), ior.max(material.ior))
        } else {
            let sides = [&media.incident, &media.transmitted];
            let [a, b] = sides.map(|interior| dielectrics.medium(interior).ior());
            DielectricInterface::new(cosine, a.min(b), a.max(b))
        };
        let params = shading_params_at(integrator, ray, hit, &surface, &RayCone::default());
        path.transmittance *= params.transmit.as_dvec3() * (1.0 - interface.reflected);
    }
    path.interior = media.transmitted;
    opposite
}
