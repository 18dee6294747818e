//! Random numbers that are determined by the seed, the case and the ray.

use glam::{DQuat, DVec3};

/// The generator SplitMix64 (Steele, Lea and Flood, *Fast Splittable Pseudorandom Number Generators*, 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Creates the generator of ray `index` in a case.
    pub fn new(seed: u64, case: &str, index: u64) -> Self {
        // FNV-1a hashes the name; a step of the generator mixes in seed and index.
        let name = case.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let mut random = Self(seed);
        random.0 = random.bits() ^ name;
        random.0 = random.bits() ^ index;
        random.bits();
        random
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number in \[0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a number in \[low, high).
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns an integer from 0 to n − 1.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Returns one of the items.
    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }

    /// Returns true with probability one half.
    pub fn coin(&mut self) -> bool {
        self.bits() >> 63 == 1
    }

    /// Returns ten to a power between `low` and `high`.
    pub fn power_of_ten(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.range(low, high))
    }

    /// Returns a point in the ball of radius 1.
    pub fn in_ball(&mut self) -> DVec3 {
        loop {
            let p = DVec3::from_array(std::array::from_fn(|_| self.range(-1.0, 1.0)));
            if p.length_squared() <= 1.0 {
                return p;
            }
        }
    }

    /// Returns a uniformly distributed direction of length about 1.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let p = self.in_ball();
            if p.length_squared() > 1e-4 {
                return p.normalize();
            }
        }
    }

    /// Returns a direction of length about 1, perpendicular to another.
    pub fn perpendicular(&mut self, axis: DVec3) -> DVec3 {
        loop {
            let perpendicular = axis.cross(self.direction());
            if perpendicular.length_squared() > 1e-4 * axis.length_squared() {
                return perpendicular.normalize();
            }
        }
    }

    /// Returns a rotation.
    pub fn rotation(&mut self) -> DQuat {
        DQuat::from_axis_angle(self.direction(), self.range(0.0, std::f64::consts::TAU))
    }
}
