//! The rays of a packet in f64, and the f32 copies that Embree traverses with.

use glam::DVec3;

use crate::geometry::sphere;
use crate::intersect::brute_force::is_extreme;
use crate::intersect::embree::f32_space::{F32Space, MAX_MOVED_DISTANCE, MAX_ORIGIN_DISTANCE};
use crate::intersect::embree::ffi::RayHitRecord;
use crate::intersect::embree::packet::{Approach, Packet};

/// Components of an f32 direction below this share of the largest are set to 0: over any
/// distance in the scene they move the ray by far less than the rounding above, and their
/// reciprocals would overflow products.
const NEGLIGIBLE: f64 = 1.0 / (1u64 << 50) as f64;

/// A packet of rays in f64, side by side.
#[repr(C, align(64))]
pub struct PacketRays<const W: usize> {
    pub origin: [[f64; W]; 3],
    pub direction: [[f64; W]; 3],
    pub tmax: [f64; W],
    /// 1 / |direction|².
    pub inverse_length_squared: [f64; W],
    /// The intervals of the rays that their f32 copies cover.
    pub interval: RayInterval<W>,
}

/// The intervals of the rays of a packet that their f32 copies cover.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct RayInterval<const W: usize> {
    /// The t at which the f32 ray starts.
    pub start: [f64; W],
    /// The number of units of the f32 ray's t in a unit of t: a power of two.
    pub scale: [f64; W],
}

impl<const W: usize> RayInterval<W> {
    /// Converts a t of the f32 ray `i` into one of the f64 ray.
    #[inline(always)]
    pub fn f64_t(&self, i: usize, t: f32) -> f64 {
        self.start[i] + f64::from(t) / self.scale[i]
    }

    /// Converts a t of ray `i` into one of its f32 copy, with more slack than the f32 arithmetic on
    /// both sides of a comparison with it can use up; never below 0.
    #[inline(always)]
    pub fn f32_t(&self, i: usize, t: f64) -> f32 {
        let t = (t - self.start[i]) * self.scale[i];
        round_up(t.max(0.0) * (1.0 + 1.0 / (1 << 20) as f64))
    }
}

/// The lanes of a packet that are traced, and those that are tested by brute force.
pub struct TracedLanes<const W: usize> {
    /// The rays that enter the scene's box.
    pub traced: [bool; W],
    /// The rays that no f32 ray can stand for: their direction is too short or too long for f64, or
    /// they start 2¹⁰⁰ L away. They are not traced.
    pub brute_force: [bool; W],
    /// True if there is any of the latter.
    pub any_brute_force: bool,
    /// True if f64 does not tell where any of the f32 rays ends.
    pub any_open_end: bool,
}

impl<const W: usize> PacketRays<W> {
    pub fn new() -> Self {
        Self {
            origin: [[0.0; W]; 3],
            direction: [[0.0; W]; 3],
            tmax: [0.0; W],
            inverse_length_squared: [0.0; W],
            interval: RayInterval { start: [0.0; W], scale: [1.0; W] },
        }
    }

    /// The origin and direction in lane `i`.
    #[inline(always)]
    pub fn origin_and_direction(&self, i: usize) -> (DVec3, DVec3) {
        let vector = |v: &[[f64; W]; 3]| DVec3::new(v[0][i], v[1][i], v[2][i]);
        (vector(&self.origin), vector(&self.direction))
    }

    /// Sets the origin and direction in lane `i`.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, (origin, direction): (DVec3, DVec3)) {
        for axis in 0..3 {
            self.origin[axis][i] = origin[axis];
            self.direction[axis][i] = direction[axis];
        }
    }

    /// Loads the rays of a packet; the lanes left over repeat the first one.
    #[inline(always)]
    pub fn load(&mut self, packet: &Packet<'_>) {
        let (rays, first) = (packet.ray16(), packet.first_lane());
        for axis in 0..3 {
            self.origin[axis].copy_from_slice(&rays.origin[axis][first..first + W]);
            self.direction[axis].copy_from_slice(&rays.direction[axis][first..first + W]);
        }
        self.tmax.copy_from_slice(&rays.tmax[first..first + W]);
        for i in packet.count..W {
            self.set_lane(i, self.origin_and_direction(0));
            self.tmax[i] = self.tmax[0];
        }
        for i in 0..W {
            let direction = self.origin_and_direction(i).1;
            self.inverse_length_squared[i] = sphere::inverse_length_squared(direction);
        }
    }

    /// The largest absolute coordinate of the origins.
    #[inline(always)]
    pub fn max_origin_coordinate(&self) -> f64 {
        // Positive floats are ordered as their bits, which compilers fold side by side.
        let mut largest = [0u64; W];
        for axis in 0..3 {
            for i in 0..W {
                largest[i] = largest[i].max(self.origin[axis][i].abs().to_bits());
            }
        }
        f64::from_bits(largest.into_iter().fold(0, u64::max))
    }

    /// Sets the origins, directions and ends of the f32 rays in `record`.
    #[inline(always)]
    pub fn set_up_f32_rays(
        &mut self,
        space: &F32Space,
        record: &mut RayHitRecord<W>,
    ) -> TracedLanes<W> {
        let RayHitRecord { org, dir, tfar, .. } = record;
        let mut lanes = TracedLanes {
            traced: [true; W],
            brute_force: [false; W],
            any_brute_force: false,
            any_open_end: false,
        };
        for i in 0..W {
            lanes.traced[i] = self.tmax[i] > 0.0;
        }
        // See whether any ray starts too far away for the padding of the boxes.
        let mut any_far = false;
        for i in 0..W {
            let (o, d) = self.origin_and_direction(i);
            let distance = (o - space.center).abs().max_element();
            let far = (distance > MAX_ORIGIN_DISTANCE * space.extent) | is_extreme(o, d);
            any_far |= far & (self.tmax[i] > 0.0);
        }
        // If so, let all rays start where they enter the box.
        self.interval.start = [0.0; W];
        let mut very_far = [false; W];
        if any_far {
            for i in 0..W {
                let (o, d) = self.origin_and_direction(i);
                let distance = (o - space.center).abs().max_element();
                let (start, enters) = self.enter_bounds(i, space);
                very_far[i] = distance > MAX_MOVED_DISTANCE * space.extent;
                lanes.brute_force[i] = is_extreme(o, d) & lanes.traced[i];
                lanes.any_brute_force |= lanes.brute_force[i];
                self.interval.start[i] = start;
                // A ray that passes the box certainly does so, however far away it starts.
                lanes.traced[i] &= enters & !lanes.brute_force[i];
            }
        }
        // Recentre, scale and round.
        for i in 0..W {
            let (o, d) = self.origin_and_direction(i);
            // 2^e with 2^e <= |d| < 2^(e+1), by the bits, clamped so that the inverse is normal.
            let largest = d.abs().max_element();
            let exponent = (largest.to_bits() >> 52).clamp(1, 2045);
            let scale = f64::from_bits(exponent << 52);
            let inverse_scale = f64::from_bits((2046 - exponent) << 52);
            self.interval.scale[i] = scale * space.scale;
            let start = (o - space.center) * space.scale;
            for axis in 0..3 {
                let component = d[axis] * inverse_scale;
                dir[axis][i] = if component.abs() < NEGLIGIBLE { 0.0 } else { component as f32 };
                org[axis][i] = start[axis] as f32;
            }
            tfar[i] = round_up(self.tmax[i] * self.interval.scale[i]);
        }
        // Move the origins to the box.
        if any_far {
            for i in 0..W {
                let (o, d) = self.origin_and_direction(i);
                let start = (o - space.center + d * self.interval.start[i]) * space.scale;
                for axis in 0..3 {
                    org[axis][i] = start[axis] as f32;
                }
                let length = self.tmax[i] - self.interval.start[i];
                tfar[i] = round_up(length * self.interval.scale[i]);
            }
            for i in 0..W {
                if very_far[i] & lanes.traced[i] {
                    self.approach(i, space, record, &mut lanes);
                }
            }
        }
        lanes
    }

    /// Sets up the f32 ray in lane `i`, which starts too far away for f64.
    #[cold]
    #[inline(never)]
    fn approach(
        &mut self,
        i: usize,
        space: &F32Space,
        record: &mut RayHitRecord<W>,
        lanes: &mut TracedLanes<W>,
    ) {
        let (o, d) = self.origin_and_direction(i);
        match Approach::new(o, d, space) {
            Approach::Near { t, point } => {
                self.interval.start[i] = Approach::least_t(t);
                for axis in 0..3 {
                    record.org[axis][i] = (point[axis] * space.scale) as f32;
                }
                let length = self.tmax[i] - self.interval.start[i];
                record.tfar[i] = round_up(length * self.interval.scale[i]);
                lanes.traced[i] = length > 0.0;
                lanes.any_open_end = true;
            }
            Approach::Passes => lanes.traced[i] = false,
            Approach::Lost => {
                lanes.traced[i] = false;
                lanes.brute_force[i] = true;
                lanes.any_brute_force = true;
            }
        }
    }

    /// The t at which ray `i` enters the scene's box, and whether it does before it ends.
    fn enter_bounds(&self, i: usize, space: &F32Space) -> (f64, bool) {
        let (o, d) = self.origin_and_direction(i);
        let rounding = 64.0 * f64::EPSILON * (o - space.center).abs().max_element();
        let bounds = space.bounds.padded(space.margin() + rounding);
        let (start, end) = bounds.crossing(o, d);
        let (start, end) = (start.max(0.0), end.min(self.tmax[i]));
        if start <= end { (start, true) } else { (0.0, false) }
    }
}

/// Returns the f32 above `x`.
#[inline(always)]
fn round_up(x: f64) -> f32 {
    let rounded = x as f32;
    // Positive finite floats are ordered as their bits; infinity stays.
    if rounded.is_finite() && rounded >= 0.0 {
        f32::from_bits(rounded.to_bits() + 1)
    } else {
        rounded
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Bounds, Ray, RayBatch};
    use crate::intersect::embree::f32_space::BOX_PADDING;
    use proptest::prelude::*;

    fn single(space: &F32Space, ray: Ray) -> (PacketRays<1>, [f32; 3], [f32; 3], f32, bool) {
        let mut exact = PacketRays::<1>::new();
        let mut rays = RayBatch::default();
        rays.push(&ray);
        exact.load(&Packet::split::<1>(&rays).next().unwrap());
        let mut record = RayHitRecord::<1>::new();
        let traced = exact.set_up_f32_rays(space, &mut record).traced[0];
        let RayHitRecord { org, dir, tfar, .. } = record;
        (exact, org.map(|a| a[0]), dir.map(|a| a[0]), tfar[0], traced)
    }

    fn unit_space(offset: DVec3) -> F32Space {
        F32Space::from_bounds(Bounds { lower: offset - 0.5, upper: offset + 0.5 })
    }

    #[test]
    fn far_ray_is_moved_to_the_box() {
        let space = unit_space(DVec3::splat(1e7));
        let ray = Ray::new(DVec3::ZERO, DVec3::ONE);
        let (_, org, _, _, traced) = single(&space, ray);
        assert!(traced && org.iter().all(|x| x.abs() <= 0.51), "{org:?}");
    }

    #[test]
    fn far_ray_beside_the_box_is_not_traced() {
        let space = unit_space(DVec3::ZERO);
        assert!(!single(&space, Ray::new(DVec3::X * 99.0, DVec3::Y)).4);
    }

    #[test]
    fn direction_of_any_length_becomes_about_one() {
        let space = unit_space(DVec3::ZERO);
        for length in [1e-300, 1e-9, 1.0, 777.0, 1e250] {
            let ray = Ray::new(DVec3::Z, DVec3::new(0.3, 0.2, -1.0) * length);
            let (_, _, dir, _, _) = single(&space, ray);
            let largest = dir.iter().fold(0.0f32, |m, c| m.max(c.abs()));
            assert!((1.0..=2.0).contains(&largest), "{length}: {dir:?}");
        }
    }

    #[test]
    fn end_of_a_segment_rounds_up() {
        let space = unit_space(DVec3::ZERO);
        let ray = Ray::segment(DVec3::ZERO, DVec3::X * 0.1);
        let (exact, _, _, tfar, _) = single(&space, ray);
        assert!((1.0..1.000001).contains(&exact.interval.f64_t(0, tfar)));
    }

    #[test]
    fn slight_components_become_zero() {
        let space = unit_space(DVec3::ZERO);
        let (_, _, dir, _, _) = single(&space, Ray::new(DVec3::Z, DVec3::new(1e-20, 0.0, -1.0)));
        assert_eq!(dir, [0.0, 0.0, -1.0]);
    }

    proptest! {
        #[test]
        fn f32_ray_stays_within_the_padding(
            offset in prop::array::uniform3(-1e7..1e7f64),
            origin in prop::array::uniform3(-30.0..30.0f64),
            target in prop::array::uniform3(-0.5..0.5f64),
            scale in -200i32..200,
        ) {
            let offset = DVec3::from(offset);
            let space = unit_space(offset);
            let (from, to) = (DVec3::from(origin), DVec3::from(target));
            let direction = (to - from) * 2f64.powi(scale);
            let ray = Ray::new(offset + from, direction);
            let (exact, org, dir, _, traced) = single(&space, ray);
            prop_assert!(traced);
            // The exact point of the ray nearest the target, and the f32 ray there.
            let t = (offset + to - ray.origin).dot(direction) / direction.length_squared();
            let along = (t - exact.interval.start[0]) * exact.interval.scale[0];
            let p = DVec3::from(org.map(f64::from)) + DVec3::from(dir.map(f64::from)) * along;
            let exact = (ray.position(t) - space.center) * space.scale;
            let error = (p - exact).abs().max_element();
            prop_assert!(error <= 0.5 * BOX_PADDING, "{error:e}");
        }
    }
}
