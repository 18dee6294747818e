//! The random numbers of paths: an Owen-scrambled Sobol' sequence for each pixel.
//!
//! A number is a function of the seed, the pixel, the sample and the dimension alone. So a picture is the same on any
//! number of threads and in any tiles.

/// The number of samples, and of sets of four dimensions, of one sequence; beyond them another one begins.
const SAMPLES: u32 = 1 << 16;
const SETS: u32 = sobol_burley::NUM_DIMENSION_SETS_4D;

/// The sets of dimensions of the camera ray, and of each surface on its path.
const CAMERA_SETS: u32 = 1;
const SETS_PER_SURFACE: u32 = 2;

/// The numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    seed: u32,
    sample: u32,
}

/// The numbers for one surface on a path, each in \[0, 1).
#[derive(Clone, Copy, Debug)]
pub struct SurfaceNumbers {
    /// The choice of a lobe, and the direction within it.
    pub lobe: f64,
    pub direction: [f64; 2],
    /// The chance by which the path goes on or ends.
    pub roulette: f64,
    /// The choice of a light, and the direction to it.
    pub light: f64,
    pub light_direction: [f64; 2],
    /// The choice of a part of the light.
    pub light_part: f64,
}

impl Sampler {
    /// The numbers of a sample of a pixel.
    pub fn new(seed: u32, [x, y]: [u32; 2], sample: u32) -> Self {
        let pixel = mix(mix(mix(seed) ^ x).wrapping_add(y));
        // Beyond the length of a sequence, another one.
        Self { seed: mix(pixel ^ (sample / SAMPLES)), sample: sample % SAMPLES }
    }

    /// Returns the place in the pixel, and that on the lens.
    pub fn camera(&self) -> [[f64; 2]; 2] {
        let [x, y, u, v] = self.set(0);
        [[x, y], [u, v]]
    }

    /// Returns the numbers for the surface that is `index` surfaces from the camera.
    pub fn surface(&self, index: u32) -> SurfaceNumbers {
        let first = CAMERA_SETS + SETS_PER_SURFACE * index;
        let [lobe, x, y, roulette] = self.set(first);
        let [light, u, v, light_part] = self.set(first + 1);
        let (direction, light_direction) = ([x, y], [u, v]);
        SurfaceNumbers { lobe, direction, roulette, light, light_direction, light_part }
    }

    fn set(&self, index: u32) -> [f64; 4] {
        // Beyond the dimensions of a sequence, those of another one.
        let seed = if index < SETS { self.seed } else { mix(self.seed ^ (index / SETS)) };
        sobol_burley::sample_4d(self.sample, index % SETS, seed).map(f64::from)
    }
}

/// Returns a number in which each bit depends on all bits of another one (Wellons, *Prospecting for Hash Functions*, 2018).
fn mix(mut x: u32) -> u32 {
    x = x.wrapping_add(0x9e37_79b9);
    x ^= x >> 16;
    x = x.wrapping_mul(0x21f0_aaad);
    x ^= x >> 15;
    x = x.wrapping_mul(0xd35a_2d97);
    x ^ (x >> 15)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the numbers of all dimensions that a path of a few surfaces takes.
    fn numbers(sampler: &Sampler) -> Vec<f64> {
        (0..200).flat_map(|set| sampler.set(set)).collect()
    }

    #[test]
    fn numbers_are_in_the_unit_interval_and_the_same_for_the_same_sample() {
        for sample in [0, 1, 65_535, 65_536, 65_537, 1_000_000, u32::MAX] {
            let all = numbers(&Sampler::new(3, [5, 7], sample));
            assert!(all.iter().all(|x| (0.0..1.0).contains(x)));
            assert_eq!(all, numbers(&Sampler::new(3, [5, 7], sample)));
        }
    }

    #[test]
    fn samples_pixels_seeds_and_dimensions_differ_also_beyond_the_length_of_a_sequence() {
        let base = numbers(&Sampler::new(0, [0, 0], 0));
        let others = [(0, [0, 0], 65_536), (0, [0, 0], 131_072), (1, [0, 0], 0), (0, [1, 0], 0)];
        for (seed, pixel, sample) in others.into_iter().chain([(0, [0, 1], 0), (0, [0, 0], 1)]) {
            let other = numbers(&Sampler::new(seed, pixel, sample));
            let equal = base.iter().zip(&other).filter(|(a, b)| a == b).count();
            assert!(equal < 4, "{seed} {pixel:?} {sample}: {equal}");
        }
        // The dimensions of the next sequence are others.
        let sampler = Sampler::new(0, [0, 0], 5);
        assert!((0..SETS).all(|set| sampler.set(set) != sampler.set(set + SETS)));
    }

    #[test]
    fn each_dimension_is_even_on_either_side_of_the_length_of_a_sequence() {
        for first in [0u32, 65_536 - 128, 65_536, 1_000_000] {
            for set in [0, 1, 2, SETS - 1, SETS, SETS + 1] {
                let mut sum = [0.0; 4];
                for sample in first..first + 256 {
                    let numbers = Sampler::new(9, [2, 3], sample).set(set);
                    (0..4).for_each(|i| sum[i] += numbers[i] / 256.0);
                }
                // 256 points of one sequence have a mean within 1/512 of ½, those of two within a few hundredths.
                assert!(sum.iter().all(|x| (x - 0.5).abs() < 0.06), "{first} {set}: {sum:?}");
            }
        }
    }
}
