//! The radiance along the rays of a wave, and its way to samples.

use glam::{DVec3, Vec3};

use crate::geometry::{LANES, Lanes};
use crate::integrator::counts::NotFiniteCause;
use crate::integrator::wave::Wave;
use crate::integrator::{Counts, simd};

/// The radiance along sixteen rays, channel by channel; also other colours of sixteen points.
pub(super) type Radiance16 = [Lanes<f32>; 3];

/// Zero radiance along all sixteen rays.
pub(super) const DARK: Radiance16 = [[0.0; LANES]; 3];

/// The sums of groups of radiance along sixteen rays: f64, so that their number costs no digit of f32.
pub(super) type GroupSums16 = [Lanes<f64>; 3];

/// The number of lights, or of samples, whose radiance is added in f32 before it joins that of other such
/// groups in f64. Four equal terms add up exactly, whatever they are.
pub(super) const GROUP: usize = 4;

/// Adds the sums of a group to those of the groups before, of which there may be none, and makes them
/// zero; those that are NaN stay so.
pub(super) fn end_group(arch: pulp::Arch, group: &mut [Radiance16], sums: &mut Vec<GroupSums16>) {
    sums.resize(group.len(), [[0.0; LANES]; 3]);
    simd::dispatch(
        arch,
        #[inline(always)]
        || {
            for (group, sums) in group.iter_mut().zip(&mut *sums) {
                for channel in 0..3 {
                    for i in 0..LANES {
                        sums[channel][i] += f64::from(group[channel][i]);
                        let is_nan = group[channel][i].is_nan();
                        group[channel][i] = if is_nan { group[channel][i] } else { 0.0 };
                    }
                }
            }
        },
    );
}

/// Returns the colour in lane `i`.
#[inline(always)]
pub(super) fn lane(colors: &Radiance16, i: usize) -> Vec3 {
    Vec3::new(colors[0][i], colors[1][i], colors[2][i])
}

/// Sets the colour in lane `i`.
#[inline(always)]
pub(super) fn set_lane(colors: &mut Radiance16, i: usize, color: Vec3) {
    for channel in 0..3 {
        colors[channel][i] = color[channel];
    }
}

/// True if any lane is set.
#[inline(always)]
pub(super) fn any(lanes: &Lanes<bool>) -> bool {
    // As numbers: compilers fold these side by side, and truth values one by one.
    let mut any = 0;
    for i in 0..LANES {
        any |= u8::from(lanes[i]);
    }
    any != 0
}

/// True if every channel of every lane is finite.
#[inline(always)]
pub(super) fn all_finite(colors: &Radiance16) -> bool {
    const EXPONENT: u32 = f32::INFINITY.to_bits();
    let mut not_finite = [0; LANES];
    for i in 0..LANES {
        for channel in colors {
            not_finite[i] |= u32::from(channel[i].to_bits() & EXPONENT == EXPONENT);
        }
    }
    not_finite.iter().fold(0, |all, one| all | one) == 0
}

/// The radiance along the rays of a wave, except what mirrors and glass show.
#[derive(Default)]
pub(super) struct WaveRadiance {
    /// The radiance, sixteen rays to a block; while there are groups of lights, that of the last.
    pub blocks: Vec<Radiance16>,
    /// The sums of the groups of lights before; empty where there is one only.
    groups: Vec<GroupSums16>,
    /// The rays whose radiance is not finite; it is NaN in `blocks`. Each stands here once.
    pub not_finite: Vec<NotFiniteRay>,
}

/// A ray whose radiance is not finite.
pub(super) struct NotFiniteRay {
    /// The number of the ray in its wave.
    pub ray: u32,
    /// The first cause.
    pub cause: NotFiniteCause,
}

impl WaveRadiance {
    /// Resets to `blocks` blocks, each to be set before it is read.
    pub fn reset(&mut self, blocks: usize) {
        self.blocks.resize(blocks, DARK);
        self.groups.clear();
        self.not_finite.clear();
    }

    /// Begins a group of lights.
    pub fn begin_group(&mut self, arch: pulp::Arch) {
        end_group(arch, &mut self.blocks, &mut self.groups);
    }

    /// Adds up the groups of lights, if there are several.
    pub fn add_groups(&mut self) {
        for block in 0..self.groups.len() {
            for i in 0..LANES {
                let sums = &self.groups[block];
                let before = DVec3::new(sums[0][i], sums[1][i], sums[2][i]);
                let total = (before + lane(&self.blocks[block], i).as_dvec3()).as_vec3();
                // A sum that is NaN has its cause already.
                if total.is_finite() || total.is_nan() {
                    set_lane(&mut self.blocks[block], i, total);
                } else {
                    self.mark_not_finite(block, i, NotFiniteCause::Sum);
                }
            }
        }
        self.groups.clear();
    }

    /// Adds radiance to the active lanes of a block, except where theirs is already NaN.
    #[inline(always)]
    pub fn add_block(&mut self, block: usize, radiance: &Radiance16, is_active: &Lanes<bool>) {
        let sums = &mut self.blocks[block];
        let mut total = *sums;
        for channel in 0..3 {
            for i in 0..LANES {
                let sum = total[channel][i] + radiance[channel][i];
                total[channel][i] = if is_active[i] { sum } else { total[channel][i] };
            }
        }
        if all_finite(&total) {
            *sums = total;
            return;
        }
        for i in (0..LANES).filter(|&i| is_active[i]) {
            self.add(block, i, lane(radiance, i));
        }
    }

    /// Adds radiance along one ray, except where its own is already NaN.
    pub fn add(&mut self, block: usize, i: usize, radiance: Vec3) {
        let sum = lane(&self.blocks[block], i) + radiance;
        if sum.is_finite() {
            set_lane(&mut self.blocks[block], i, sum);
        } else if radiance.is_nan() {
            self.mark_not_finite(block, i, NotFiniteCause::Light);
        } else {
            self.mark_not_finite(block, i, NotFiniteCause::Sum);
        }
    }

    /// Makes the radiance along one ray NaN, so that it stays out of the picture, and records the
    /// cause if it is the first.
    #[cold]
    pub fn mark_not_finite(&mut self, block: usize, i: usize, cause: NotFiniteCause) {
        if !lane(&self.blocks[block], i).is_nan() {
            self.not_finite.push(NotFiniteRay { ray: (block * LANES + i) as u32, cause });
        }
        set_lane(&mut self.blocks[block], i, Vec3::NAN);
    }

    /// Adds the radiance along the rays of the wave to their samples, by their throughput.
    pub fn add_to_samples(
        &mut self,
        wave: &Wave,
        samples: &mut Vec<Radiance16>,
        counts: &mut Counts,
    ) {
        // Without paths each ray is a whole sample.
        if wave.paths.is_empty() {
            std::mem::swap(&mut self.blocks, samples);
            self.not_finite.drain(..).for_each(|ray| ray.cause.count(counts));
            return;
        }
        // A sample that is NaN stays so.
        for (i, path) in wave.paths.iter().enumerate() {
            let radiance = lane(&self.blocks[i / LANES], i % LANES);
            let (sample, i) = path.sample_lane();
            let sum = lane(&samples[sample], i);
            if !sum.is_nan() && !radiance.is_nan() {
                let weighted = (path.throughput * radiance.as_dvec3()).as_vec3();
                set_lane(&mut samples[sample], i, sum + weighted);
            }
        }
        // Each sample counts once, for the first of its rays that is not finite.
        for not_finite in self.not_finite.drain(..) {
            let (sample, i) = wave.paths[not_finite.ray as usize].sample_lane();
            if !lane(&samples[sample], i).is_nan() {
                not_finite.cause.count(counts);
                set_lane(&mut samples[sample], i, Vec3::NAN);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_of_equal_terms_adds_up_exactly() {
        let mut bits = 0x3f80_0000u32;
        for _ in 0..100_000 {
            let x = f32::from_bits(bits);
            assert_eq!((0..GROUP).fold(0.0, |sum, _| sum + x), GROUP as f32 * x, "{x}");
            bits = 0x3f80_0000 | (bits.wrapping_mul(0x9e37_79b9).wrapping_add(1) & 0x7f_ffff);
        }
    }
}
