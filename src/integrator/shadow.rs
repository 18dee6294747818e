//! Light on its way to a surface through glass.
//!
//! It goes straight on, since a path that bends would have to be searched for: each surface takes
//! off what Fresnel's law reflects, at the angle in the thinner of the two media, and tints the
//! rest by its share of transmission; each body absorbs along the way.

use glam::DVec3;

use crate::geometry::{Hit, HitBatch, LANES, Ray, RayBatch, Side};
use crate::integrator::bodies::InteriorList;
use crate::integrator::shade::ShadowQueue;
use crate::integrator::{Counts, Integrator, Wave};
use crate::intersect::Coherence;
use crate::scene::Shadow;
use crate::shading::{DielectricInterface, transmittance};
use crate::surface::{RayCone, Surface};

/// Room for shadow rays that may go through glass.
#[derive(Default)]
pub(super) struct TransmissiveShadows {
    /// Whether each certainly meets none.
    clear: Vec<bool>,
    beams: Vec<Beam>,
    ahead: RayBatch,
    traced: RayBatch,
    hits: HitBatch,
}

/// A shadow ray that nothing blocks, on its way.
struct Beam {
    /// Which of the shadow rays it is.
    at: usize,
    inside: InteriorList,
    left: DVec3,
}

impl Integrator<'_> {
    /// The bodies in which a shadow ray begins that leaves the surface that ray `i` of a wave hit.
    fn starts_in(&self, shadow: &Ray, wave: &Wave, i: usize) -> InteriorList {
        let (ray, hit, path) = (wave.rays.ray(i), wave.hits.get(i), self.path(wave, i));
        let (Some(hit), Some(from)) = (hit, shadow.departure) else { return path.inside };
        let seen = Surface::new(self.scene, &ray, &hit).side;
        let around = self.bodies.around(hit.id, seen, &path.inside);
        if from.side == seen { around.before } else { around.behind }
    }

    /// Works out what is left of the light along each shadow ray, of which it is known whether
    /// anything blocks it.
    pub(super) fn let_through(
        &self,
        shadow: Shadow,
        wave: &Wave,
        shadows: &mut ShadowQueue,
        counts: &mut Counts,
    ) {
        let ShadowQueue { rays, waiting, blocked, left, through } = shadows;
        let TransmissiveShadows { clear, beams, ahead, traced, hits } = through;
        self.clearance.of_all(rays, self.arch, clear);
        left.clear();
        beams.clear();
        ahead.clear();
        for (at, blocked) in blocked.iter_mut().enumerate() {
            if *blocked || clear[at] {
                continue;
            }
            let ray = rays.ray(at);
            if ray.tmax <= 0.0 {
                continue;
            }
            *blocked = true; // What is left of it is added by itself.
            let met = waiting[at / LANES].block * LANES + at % LANES;
            beams.push(Beam { at, inside: self.starts_in(&ray, wave, met), left: DVec3::ONE });
            ahead.push(&ray);
        }
        while !beams.is_empty() {
            self.closest(ahead, Coherence::Incoherent, hits, counts);
            counts.rays.shadow += ahead.len() as u64;
            counts.work.glass += ahead.len() as u64;
            std::mem::swap(traced, ahead);
            ahead.clear();
            let mut answers = traced.iter().zip(hits.iter());
            beams.retain_mut(|beam| {
                let Some((ray, hit)) = answers.next() else { return false };
                let end = hit.map_or(ray.tmax, |hit| hit.t);
                beam.left *= self.absorbed(&ray, end, &beam.inside);
                let Some(hit) = hit else {
                    left.push((beam.at, beam.left));
                    return false;
                };
                let side = self.pass(&ray, &hit, beam);
                let goes_on = match shadow {
                    Shadow::Tinted | Shadow::None => beam.left != DVec3::ZERO,
                    Shadow::Opaque => beam.left == DVec3::ONE,
                };
                if goes_on {
                    ahead.push(&ray.continue_past(&hit, side));
                }
                goes_on
            });
        }
        if shadow == Shadow::Opaque {
            left.retain(|(_, left)| *left == DVec3::ONE);
        }
    }

    /// What is left of light after the way of a ray, from where it starts to `end`.
    pub(super) fn absorbed(&self, ray: &Ray, end: f64, inside: &InteriorList) -> DVec3 {
        let absorption = self.bodies.medium(inside).absorption;
        if absorption == glam::Vec3::ZERO {
            return DVec3::ONE;
        }
        transmittance(absorption, (end - ray.start_t()) * ray.direction.length())
    }

    /// Takes a beam through the surface that it met; says on which side it goes on.
    fn pass(&self, ray: &Ray, hit: &Hit, beam: &mut Beam) -> Side {
        let surface = Surface::new(self.scene, ray, hit);
        let material = &self.scene.materials[surface.material.0 as usize];
        let around = self.bodies.around(surface.id, surface.side, &beam.inside);
        let onward = surface.side.opposite();
        if !self.scene.casts_shadow(hit.id) {
            // It is not there for the light; only one who was in it must get out.
            if self.bodies.outer(hit.id, surface.side) == Side::Back {
                beam.inside = around.behind;
            }
            return onward;
        }
        if !around.is_hidden {
            let cosine = surface.normal.dot(ray.direction).abs() / ray.direction.length();
            let ior = self.bodies.medium(&beam.inside).ior;
            let interface = if material.thin {
                DielectricInterface::sheet(cosine, ior.min(material.ior), ior.max(material.ior))
            } else {
                let [a, b] = [&around.before, &around.behind].map(|i| self.bodies.medium(i).ior);
                DielectricInterface::new(cosine, a.min(b), a.max(b))
            };
            let finish = self.finish_at(ray, hit, &surface, &RayCone::default());
            beam.left *= finish.transmit.as_dvec3() * (1.0 - interface.reflected);
        }
        beam.inside = around.behind;
        onward
    }
}
