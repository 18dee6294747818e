//! Light on its way to a surface through glass.
//!
//! It goes straight on, since a path that bends would have to be searched for: each surface takes
//! off what Fresnel's law reflects, at the angle in the thinner of the two media, and tints the
//! rest by its share of transmission; each body absorbs along the way.

use glam::DVec3;

use crate::geometry::{Hit, Ray, Side};
use crate::integrator::bodies::Interiors;
use crate::integrator::shade::Shadows;
use crate::integrator::{Counts, Integrator};
use crate::intersect::Coherence;
use crate::scene::Shadow;
use crate::shading::{Interface, transmittance};
use crate::surface::Surface;

/// A shadow ray that nothing blocks, on its way.
struct Beam {
    /// Which of the shadow rays it is.
    at: usize,
    inside: Interiors,
    left: DVec3,
}

impl Integrator<'_> {
    /// The bodies in which a shadow ray begins that leaves a surface, seen by a ray in `inside`.
    pub(super) fn starts_in(&self, surface: &Surface, ray: &Ray, inside: &Interiors) -> Interiors {
        let around = self.bodies.around(surface.id, surface.side, inside);
        match ray.from {
            Some(from) if from.side != surface.side => around.behind,
            _ => around.before,
        }
    }

    /// Works out what is left of the light along each shadow ray, of which it is known whether
    /// anything blocks it.
    pub(super) fn let_through(&self, shadow: Shadow, shadows: &mut Shadows, counts: &mut Counts) {
        let Shadows { rays, inside, blocked, left, .. } = shadows;
        left.clear();
        let mut beams = Vec::new();
        let mut ahead = Vec::new();
        for (at, (ray, inside)) in rays.iter().zip(inside).enumerate() {
            left.push(DVec3::ZERO);
            if !blocked[at] {
                let inside = std::mem::take(inside);
                beams.push(Beam { at, inside, left: DVec3::ONE });
                ahead.push(*ray);
            }
        }
        let mut hits = Vec::new();
        while !beams.is_empty() {
            hits.clear();
            hits.resize(ahead.len(), None);
            self.intersector.closest(&ahead, Coherence::Incoherent, &mut hits);
            counts.rays.shadow += ahead.len() as u64;
            let mut hits = hits.iter();
            let mut rays = std::mem::take(&mut ahead).into_iter();
            beams.retain_mut(|beam| {
                let (Some(ray), Some(hit)) = (rays.next(), hits.next()) else { return false };
                let end = hit.map_or(ray.tmax, |hit| hit.t);
                beam.left *= self.absorbed(&ray, end, &beam.inside);
                let Some(hit) = hit else {
                    left[beam.at] = beam.left;
                    return false;
                };
                let side = self.pass(&ray, hit, beam);
                let goes_on = match shadow {
                    Shadow::Tinted | Shadow::None => beam.left != DVec3::ZERO,
                    Shadow::Opaque => beam.left == DVec3::ONE,
                };
                if goes_on {
                    ahead.push(ray.beyond(hit, side));
                }
                goes_on
            });
        }
        if shadow == Shadow::Opaque {
            left.iter_mut()
                .filter(|left| **left != DVec3::ONE)
                .for_each(|left| *left = DVec3::ZERO);
        }
    }

    /// What is left of light after the way of a ray, from where it starts to `end`.
    pub(super) fn absorbed(&self, ray: &Ray, end: f64, inside: &Interiors) -> DVec3 {
        let absorption = self.bodies.medium(inside).absorption;
        if absorption == glam::Vec3::ZERO {
            return DVec3::ONE;
        }
        transmittance(absorption, (end - ray.start()) * ray.direction.length())
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
                Interface::sheet(cosine, ior.min(material.ior), ior.max(material.ior))
            } else {
                let [a, b] = [&around.before, &around.behind].map(|i| self.bodies.medium(i).ior);
                Interface::new(cosine, a.min(b), a.max(b))
            };
            beam.left *= material.transmit.as_dvec3() * (1.0 - interface.reflected);
        }
        beam.inside = around.behind;
        onward
    }
}
