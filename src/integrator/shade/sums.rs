//! The sums of what comes back along the rays.

use glam::Vec3;

use crate::geometry::{LANES, Lanes};
use crate::integrator::counts::NotFiniteCause;
use crate::integrator::radiance::{Radiance, all_finite, at, put};
use crate::integrator::shade::{PendingLight, ShadowQueue};

/// The radiance along the rays of a wave, and which of it is spoilt.
pub(super) struct RadianceSums<'a> {
    pub radiance: &'a mut [Radiance],
    pub spoilt: &'a mut Vec<(u32, NotFiniteCause)>,
}

impl RadianceSums<'_> {
    /// Adds to the radiance along the rays that are `here`, unless it is spoilt already.
    #[inline(always)]
    pub fn add_all(&mut self, block: usize, with: &Radiance, here: &Lanes<bool>) {
        let radiance = &mut self.radiance[block];
        let mut sum = *radiance;
        for axis in 0..3 {
            for i in 0..LANES {
                let more = sum[axis][i] + with[axis][i];
                sum[axis][i] = if here[i] { more } else { sum[axis][i] };
            }
        }
        if all_finite(&sum) {
            *radiance = sum;
            return;
        }
        for i in (0..LANES).filter(|&i| here[i]) {
            self.add(block, i, at(with, i));
        }
    }

    /// Adds to the radiance along one ray, unless it is spoilt already.
    pub fn add(&mut self, block: usize, i: usize, with: Vec3) {
        let sum = at(&self.radiance[block], i) + with;
        if sum.is_finite() {
            put(&mut self.radiance[block], i, sum);
        } else if with.is_nan() {
            self.spoil(block, i, NotFiniteCause::Light);
        } else {
            self.spoil(block, i, NotFiniteCause::Sum);
        }
    }

    /// Makes the radiance along one ray NaN, so that it stays out of the picture, and keeps what
    /// did it first.
    #[cold]
    pub fn spoil(&mut self, block: usize, i: usize, cause: NotFiniteCause) {
        if !at(&self.radiance[block], i).is_nan() {
            self.spoilt.push(((block * LANES + i) as u32, cause));
        }
        put(&mut self.radiance[block], i, Vec3::NAN);
    }
}

/// Adds what waits on shadow rays that nothing blocks.
pub(super) struct Settle<'a, 'b> {
    pub shadow: &'a ShadowQueue,
    pub to: &'a mut RadianceSums<'b>,
}

impl pulp::WithSimd for Settle<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let ShadowQueue { waiting, blocked, .. } = self.shadow;
        for (PendingLight { block, with, here }, blocked) in
            waiting.iter().zip(blocked.chunks(LANES))
        {
            let mut open = *here;
            for (open, blocked) in open.iter_mut().zip(blocked) {
                *open &= !blocked;
            }
            self.to.add_all(*block, with, &open);
        }
    }
}
