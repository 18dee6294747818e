//! The secondary rays of a wave: light that mirrors reflect, and that glass refracts.

use glam::{DVec3, Vec3};

use crate::geometry::{Departure, Hit, Ray, Side};
use crate::integrator::nested_dielectrics::InterfaceMedia;
use crate::integrator::pbr_surfaces::TracedLobes;
use crate::integrator::wave::{PathState, Wave};
use crate::integrator::wave_surfaces::{SpecularHit, WaveSurfaces};
use crate::integrator::{Counts, Integrator};
use crate::scene::ShadingParams;
use crate::shading::{DielectricInterface, reflect};
use crate::surface::Surface;

/// The greatest throughput that changes no sum: times the greatest f32 it is less than half of the
/// least one.
const NEGLIGIBLE: f64 = 1.0 / (1u128 << 127) as f64 / (1u128 << 127) as f64 / (1u64 << 26) as f64;

/// The most surfaces that a path goes straight through, as through what alpha leaves uncovered; beyond
/// these the colour is black.
pub const MAX_LAYERS: u32 = 256;

/// Spawns the rays that the mirrors and the glass of a wave send on, in the order in which they were
/// hit.
pub(super) fn spawn(
    integrator: &Integrator<'_>,
    wave: &Wave,
    surfaces: &WaveSurfaces,
    next: &mut Wave,
    counts: &mut Counts,
) {
    // Compiled for scenes with physically based materials, and for those without.
    if integrator.features.pbr {
        spawn_all::<true>(integrator, wave, surfaces, next, counts);
    } else {
        spawn_all::<false>(integrator, wave, surfaces, next, counts);
    }
}

fn spawn_all<const PBR: bool>(
    integrator: &Integrator<'_>,
    wave: &Wave,
    surfaces: &WaveSurfaces,
    next: &mut Wave,
    counts: &mut Counts,
) {
    let mut traced = surfaces.pbr.traced.iter().peekable();
    for specular in &surfaces.specular {
        let pbr = if PBR { traced.next_if(|lobes| lobes.ray == specular.ray) } else { None };
        let i = specular.ray as usize;
        let Some(hit) = wave.hits.get(i) else { continue };
        let path = wave.path(i, integrator);
        let ray = wave.rays.ray(i);
        spawn_at_hit(integrator, &ray, &hit, specular, pbr, &path, |ray, is_refracted, path| {
            if path.layers > MAX_LAYERS {
                counts.beyond_layers += 1;
                return;
            }
            let count = &mut counts.rays;
            *(if is_refracted { &mut count.refraction } else { &mut count.reflection }) += 1;
            next.rays.push(ray);
            next.paths.push(path);
        });
    }
}

/// Hands on the reflected and then the refracted ray that a surface, which `ray` hit, sends on: each
/// with whether it is refracted, and the path that it continues.
#[inline(always)]
pub(super) fn spawn_at_hit(
    integrator: &Integrator<'_>,
    ray: &Ray,
    hit: &Hit,
    specular: &SpecularHit,
    pbr: Option<&TracedLobes>,
    path: &PathState,
    mut emit: impl FnMut(&Ray, bool, PathState),
) {
    let (scene, surface) = (integrator.scene, &specular.surface);
    // At the greatest depth only a layer, which does not count for it, sends light on.
    let is_thin = scene.materials[surface.material.0 as usize].thin;
    if path.depth >= scene.film.max_depth && !is_thin {
        return;
    }
    // The directions, and the shares of the light.
    let media = integrator.media.dielectrics.interface(surface.id, surface.side, &path.interior);
    let incoming = ray.direction.normalize();
    let scattered = scatter(integrator, specular, pbr, &media, incoming, 1);
    // Where media disperse light, each colour that is left goes its own way.
    let by_color = if integrator.media.dielectrics.may_disperse() {
        scatter_by_color(integrator, specular, pbr, &media, incoming)
    } else {
        None
    };
    // Rays that leave the surface, or go straight on through it.
    let departing = |direction: DVec3, side: Side| Ray {
        departure: Some(Departure { id: surface.id, side }),
        ..Ray::new(surface.position, direction)
    };
    let opposite = surface.side.opposite();
    let reflected = departing(scattered.reflected, surface.side);
    let refracted = |scattered: &Scattered| match scattered.refracted {
        Some(direction) => departing(direction, opposite),
        None => ray.continue_past(hit, opposite),
    };
    let length = hit.t * ray.direction.length();
    // What is only left uncovered counts for itself, so that a tree of many leaves does not turn black.
    let is_uncovered = scattered.is_uncovered;
    let mut emit = |ray: &Ray, share: DVec3, is_refracted: bool, interior, roughness: f32| {
        let is_layer = is_refracted && is_uncovered;
        let (depth, layers) =
            (path.depth + u32::from(!is_layer), path.layers + u32::from(is_layer));
        if depth > scene.film.max_depth {
            return;
        }
        // A ray whose light would change no pixel is not traced.
        let throughput = path.throughput * share;
        if throughput.max_element() <= scene.film.cutoff.max(NEGLIGIBLE) {
            return;
        }
        let lod = &integrator.texture_lod;
        let cone = if ray.continuation.is_some() {
            path.cone
        } else {
            lod.spawned_cone(&path.cone, length, scene, surface, is_refracted)
        };
        let sample = path.sample;
        let roughness = path.roughness.max(roughness);
        let state = PathState { sample, depth, layers, throughput, interior, cone, roughness };
        emit(ray, is_refracted, state);
    };
    // A clearcoat mirrors on its own.
    if let Some(lobes) = pbr.filter(|lobes| lobes.clearcoat != Vec3::ZERO) {
        let mirrored = mirrored(incoming, lobes.clearcoat_normal, surface);
        let (share, interior) = (lobes.clearcoat.as_dvec3(), media.incident.clone());
        let roughness = lobes.clearcoat_roughness;
        emit(&departing(mirrored, surface.side), share, false, interior, roughness);
    }
    let roughness = pbr.map_or(0.0, |lobes| lobes.roughness);
    let reflected_share = match &by_color {
        None => scattered.reflected_share,
        Some(colors) => by_channel(|channel| colors[channel].reflected_share),
    };
    emit(&reflected, reflected_share, false, media.incident, roughness);
    let is_blurred = pbr.is_some_and(|lobes| lobes.transmissive > 0.0);
    let roughness = if is_blurred { roughness } else { 0.0 };
    let Some(colors) = by_color else {
        let share = scattered.refracted_share;
        emit(&refracted(&scattered), share, true, media.transmitted, roughness);
        return;
    };
    for (channel, scattered) in colors.iter().enumerate() {
        let mut share = DVec3::ZERO;
        share[channel] = scattered.refracted_share[channel];
        emit(&refracted(scattered), share, true, media.transmitted.clone(), roughness);
    }
}

/// Scatters each colour for itself, where media disperse light.
#[cold]
#[inline(never)]
fn scatter_by_color(
    integrator: &Integrator<'_>,
    specular: &SpecularHit,
    pbr: Option<&TracedLobes>,
    media: &InterfaceMedia,
    incoming: DVec3,
) -> Option<[Scattered; 3]> {
    let dielectrics = &integrator.media.dielectrics;
    let disperses = |interior| {
        let [red, _, blue] = dielectrics.medium(interior).iors;
        red != blue
    };
    let is_dispersive = disperses(&media.incident) || disperses(&media.transmitted);
    let of = |channel| scatter(integrator, specular, pbr, media, incoming, channel);
    is_dispersive.then(|| [0, 1, 2].map(of))
}

/// Returns a colour whose channels are each that of another one.
fn by_channel(color: impl Fn(usize) -> DVec3) -> DVec3 {
    DVec3::new(color(0).x, color(1).y, color(2).z)
}

/// Returns the direction into which a mirror with this normal, turned to the viewer, sends light that comes
/// along `incoming`; with the surface's own normal where the other would send it into the surface.
fn mirrored(incoming: DVec3, normal: DVec3, surface: &Surface) -> DVec3 {
    let facing = surface.facing_normal();
    let mirrored = reflect(incoming, normal);
    let is_wrong_side = mirrored.dot(facing) <= 0.0;
    (if is_wrong_side { reflect(incoming, facing) } else { mirrored }).normalize()
}

/// The shares of the light that a surface mirrors and lets through.
struct SpecularShares {
    /// The share that is mirrored.
    reflect: Vec3,
    /// The share that is let through, of which Fresnel's law takes a part.
    transmit: Vec3,
    /// The share of which Fresnel's law mirrors that part.
    fresnel: Vec3,
}

impl SpecularShares {
    fn new(params: &ShadingParams, pbr: Option<&TracedLobes>) -> Self {
        let ShadingParams { reflect, transmit, .. } = *params;
        match pbr {
            None => Self { reflect, transmit, fresnel: transmit },
            // Only what is transmitted is tinted.
            Some(lobes) if lobes.transmissive > 0.0 => Self {
                reflect: lobes.reflection,
                transmit: lobes.transmission_color * lobes.transmissive,
                fresnel: Vec3::splat(lobes.transmissive),
            },
            Some(lobes) => Self { reflect: lobes.reflection, transmit, fresnel: Vec3::ZERO },
        }
    }
}

/// The directions into which a surface sends light, and the shares that go there.
pub(super) struct Scattered {
    pub reflected: DVec3,
    /// `None` for light that goes straight on, and under total reflection.
    pub refracted: Option<DVec3>,
    pub reflected_share: DVec3,
    pub refracted_share: DVec3,
    /// True if light only goes on as if there were no surface: none is reflected or refracted. Where a
    /// surface does both, paths fork, and their number must stay bounded.
    is_uncovered: bool,
    /// True under total reflection.
    is_total: bool,
}

/// Scatters light that comes along `incoming`, of length 1, at a surface of Lambert's and Phong's model.
pub(super) fn scatter_light(
    integrator: &Integrator<'_>,
    specular: &SpecularHit,
    media: &InterfaceMedia,
    incoming: DVec3,
) -> Scattered {
    scatter(integrator, specular, None, media, incoming, 1)
}

/// Scatters light of one colour that comes along `incoming`, of length 1; where media disperse nothing, all colours
/// are alike.
#[inline(always)]
fn scatter(
    integrator: &Integrator<'_>,
    SpecularHit { surface, params, .. }: &SpecularHit,
    pbr: Option<&TracedLobes>,
    media: &InterfaceMedia,
    incoming: DVec3,
    channel: usize,
) -> Scattered {
    let material = &integrator.scene.materials[surface.material.0 as usize];
    let ior = |interior| integrator.media.dielectrics.medium(interior).iors[channel];
    let SpecularShares { reflect: mirrored_share, transmit, fresnel } =
        SpecularShares::new(params, pbr);
    let facing = surface.facing_normal();
    let is_rough = pbr.is_some_and(|lobes| lobes.transmissive > 0.0 && lobes.roughness > 0.0);
    let is_blurred_sheet = material.thin && is_rough;
    let scatter_at = |normal: DVec3| {
        let cosine = -normal.dot(incoming);
        let interface = if transmit == Vec3::ZERO {
            DielectricInterface::new(cosine, 1.0, 1.0)
        } else if material.thin {
            DielectricInterface::thin_sheet(cosine, ior(&media.incident), material.ior)
        } else {
            DielectricInterface::new(cosine, ior(&media.incident), ior(&media.transmitted))
        };
        let is_straight = interface.is_straight();
        Scattered {
            reflected: reflect(incoming, normal).normalize(),
            refracted: if is_blurred_sheet {
                // Light goes straight on, as blurred as what is mirrored.
                let mirrored = reflect(incoming, normal);
                Some((mirrored - facing * (2.0 * mirrored.dot(facing))).normalize())
            } else if is_straight {
                None
            } else {
                interface.refract(incoming, normal)
            },
            reflected_share: mirrored_share.as_dvec3() + fresnel.as_dvec3() * interface.reflected,
            refracted_share: transmit.as_dvec3() * (1.0 - interface.reflected),
            is_uncovered: is_straight && interface.reflected == 0.0 && mirrored_share == Vec3::ZERO,
            is_total: interface.reflected >= 1.0,
        }
    };
    let normal = pbr.map_or(surface.normal, |lobes| lobes.microfacet);
    let shading = normal * -normal.dot(incoming).signum();
    let scattered = scatter_at(shading);
    if shading == facing {
        return scattered;
    }
    // An interpolated normal may send light to the wrong side of the surface itself.
    let is_wrong_side = scattered.reflected.dot(facing) <= 0.0
        || scattered.refracted.is_some_and(|refracted| refracted.dot(facing) >= 0.0);
    if is_wrong_side {
        return scatter_at(facing);
    }
    // In a body of few faces, interpolated normals may reflect light totally at each of its hits, so that it
    // never leaves: where the face lets it out, it goes.
    if scattered.is_total {
        let by_face = scatter_at(facing);
        return if by_face.is_total { scattered } else { by_face };
    }
    scattered
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negligible_throughput_makes_the_greatest_f32_less_than_half_of_the_least() {
        assert_eq!(NEGLIGIBLE, 2f64.powi(-280));
        assert_eq!((NEGLIGIBLE * f64::from(f32::MAX)) as f32, 0.0);
    }
}
