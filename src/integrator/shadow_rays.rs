//! The shadow rays from the surfaces of a wave to one light, and the light that waits on them.

use glam::DVec3;

use crate::geometry::{LANES, Lanes, RayBatch};
use crate::integrator::radiance::{Radiance16, WaveRadiance, lane};
use crate::integrator::simd;

/// The shadow rays to one light, in the lanes of the rays that hit the surfaces.
#[derive(Default)]
pub(super) struct ShadowQueue {
    /// The shadow rays.
    pub rays: RayBatch,
    /// The light that waits on each block of them.
    pub pending: Vec<PendingLight>,
    /// True for each ray that is occluded, or is among `attenuated`.
    pub occluded: Vec<bool>,
    /// The rays that only transparent surfaces cross.
    pub attenuated: Vec<AttenuatedRay>,
}

/// The radiance that waits on sixteen shadow rays.
#[repr(C, align(64))]
pub(super) struct PendingLight {
    /// The block of the wave.
    pub block: usize,
    /// The radiance, if nothing is in between.
    pub radiance: Radiance16,
    /// True in each lane that has a shadow ray.
    pub is_active: Lanes<bool>,
}

/// A shadow ray through glass.
pub(super) struct AttenuatedRay {
    /// The number of the shadow ray.
    pub ray: usize,
    /// The share of the light that arrives.
    pub transmittance: DVec3,
}

impl ShadowQueue {
    /// Removes all rays.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.pending.clear();
        self.attenuated.clear();
    }

    /// Returns the number of shadow rays.
    pub fn count(&self) -> u64 {
        let count = |pending: &PendingLight| pending.is_active.iter().filter(|&&is| is).count();
        self.pending.iter().map(count).sum::<usize>() as u64
    }

    /// Adds the light that arrives along the rays, which are resolved, to the radiance of the wave.
    pub fn add_light(&self, arch: pulp::Arch, radiance: &mut WaveRadiance) {
        // Light that nothing occludes.
        simd::dispatch(
            arch,
            #[inline(always)]
            || {
                for (pending, occluded) in self.pending.iter().zip(self.occluded.chunks(LANES)) {
                    let mut is_lit = pending.is_active;
                    for (is_lit, occluded) in is_lit.iter_mut().zip(occluded) {
                        *is_lit &= !occluded;
                    }
                    radiance.add_block(pending.block, &pending.radiance, &is_lit);
                }
            },
        );
        // Light through transparent surfaces.
        for &AttenuatedRay { ray, transmittance } in &self.attenuated {
            if transmittance != DVec3::ZERO {
                let pending = &self.pending[ray / LANES];
                let light = lane(&pending.radiance, ray % LANES).as_dvec3() * transmittance;
                radiance.add(pending.block, ray % LANES, light.as_vec3());
            }
        }
    }
}
