//! The light of next-event estimation on its way: what nothing blocks, and what layers let through.

use glam::Vec3;

use crate::geometry::{HitBatch, LANES, Ray, RayBatch};
use crate::integrator::counts::NotFiniteCause;
use crate::integrator::radiance::{Radiance16, lane, set_lane};
use crate::integrator::secondary_rays::MAX_LAYERS;
use crate::integrator::surface_evaluation::shading_params_at;
use crate::integrator::{Counts, Integrator};
use crate::intersect::Coherence;
use crate::scene::{AlphaMode, Material};
use crate::surface::{RayCone, Surface};

/// Light that waits on shadow rays.
#[derive(Default)]
pub(super) struct LightQueue {
    rays: RayBatch,
    /// The sample and the light of each ray.
    pending: Vec<(u32, Vec3)>,
    /// Light that no ray is traced for.
    free: Vec<(u32, Vec3)>,
    occluded: Vec<bool>,
}

impl LightQueue {
    /// Removes all.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.pending.clear();
        self.free.clear();
    }

    /// Adds light that a sample gets if nothing blocks it.
    pub fn push(&mut self, ray: &Ray, sample: u32, light: Vec3, casts_shadow: bool) {
        if casts_shadow {
            self.rays.push(ray);
            self.pending.push((sample, light));
        } else {
            self.free.push((sample, light));
        }
    }

    /// Adds the light that arrives to the samples.
    pub fn add_light(
        &mut self,
        integrator: &Integrator<'_>,
        samples: &mut [Radiance16],
        not_finite: &mut Vec<(u32, NotFiniteCause)>,
        counts: &mut Counts,
    ) {
        if !self.rays.is_empty() {
            counts.rays.shadow += self.rays.len() as u64;
            integrator.occluded(&self.rays, &mut self.occluded, counts);
            if integrator.scene.materials_in_use().any(is_layer) {
                self.pass_layers(integrator, counts);
            }
        }
        let lit = self.pending.iter().zip(&self.occluded).filter(|(_, occluded)| !**occluded);
        for &(sample, light) in lit.map(|(pending, _)| pending).chain(&self.free) {
            let (block, i) = (sample as usize / LANES, sample as usize % LANES);
            let sum = lane(&samples[block], i) + light;
            if sum.is_finite() {
                set_lane(&mut samples[block], i, sum);
            } else {
                not_finite.push((sample, NotFiniteCause::Sum));
            }
        }
    }

    /// Follows the rays that something occludes through layers, which dim their light.
    fn pass_layers(&mut self, integrator: &Integrator<'_>, counts: &mut Counts) {
        let (mut rays, mut hits) = (RayBatch::default(), HitBatch::default());
        let mut active: Vec<usize> = (0..self.rays.len()).filter(|&i| self.occluded[i]).collect();
        let mut current: Vec<Ray> = active.iter().map(|&i| self.rays.ray(i)).collect();
        for _ in 0..MAX_LAYERS {
            if active.is_empty() {
                return;
            }
            rays.clear();
            current.iter().for_each(|ray| rays.push(ray));
            integrator.closest_hits(&rays, Coherence::Incoherent, &mut hits, counts);
            let (mut still, mut next) = (Vec::new(), Vec::new());
            for (k, (&i, ray)) in active.iter().zip(&current).enumerate() {
                let Some(hit) = hits.get(k) else {
                    self.occluded[i] = false;
                    continue;
                };
                let surface = Surface::new(integrator.scene, ray, &hit);
                let material = &integrator.scene.materials[surface.material.0 as usize];
                if !is_layer(material) {
                    continue;
                }
                let cone = RayCone::default();
                let params = shading_params_at(integrator, ray, &hit, &surface, &cone);
                self.pending[i].1 *= params.transmit;
                if self.pending[i].1 != Vec3::ZERO {
                    still.push(i);
                    next.push(ray.continue_past(&hit, surface.side.opposite()));
                }
            }
            (active, current) = (still, next);
        }
    }
}

/// True if light goes straight through what a material leaves uncovered, as if there were nothing.
pub(super) fn is_layer(material: &Material) -> bool {
    let is_blended = material.coverage.is_some_and(|coverage| coverage.mode == AlphaMode::Blend);
    let is_pbr_glass = material.is_pbr() && !is_blended;
    material.may_transmit() && material.thin && material.ior == 1.0 && !is_pbr_glass
        || (is_blended && material.is_pbr())
}
