//! The exact rays of a packet, and the f32 copies that Embree traverses with.

use glam::DVec3;

use crate::intersect::brute_force::is_extreme;
use crate::intersect::embree::f32_space::{F32Space, FAR, PAD, REACH};
use crate::intersect::embree::packet::Packet;

/// Components of an f32 direction below this share of the largest are set to 0: over any
/// distance in the scene they move the ray by far less than the rounding above, and their
/// reciprocals would overflow products.
const NEGLIGIBLE: f64 = 1.0 / (1u64 << 50) as f64;

/// A packet of rays, exactly, side by side.
#[repr(C, align(64))]
pub struct PacketRays<const W: usize> {
    pub origin: [[f64; W]; 3],
    pub direction: [[f64; W]; 3],
    pub tmax: [f64; W],
    /// 1 / |direction|².
    pub inverse_length_squared: [f64; W],
    /// Where on them the f32 rays lie.
    pub clip: RayInterval<W>,
}

/// Where on the exact rays of a packet their f32 copies lie.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct RayInterval<const W: usize> {
    /// t at which the f32 ray starts.
    pub start: [f64; W],
    /// What a unit of t is along the f32 ray: a power of two.
    pub unit: [f64; W],
}

impl<const W: usize> RayInterval<W> {
    /// The exact t of an f32 ray's t.
    #[inline(always)]
    pub fn widen(&self, i: usize, t: f32) -> f64 {
        self.start[i] + f64::from(t) / self.unit[i]
    }

    /// An exact t along the f32 ray, with more slack than the f32 arithmetic on both sides of a
    /// comparison with it can use up; never below 0.
    #[inline(always)]
    pub fn narrow(&self, i: usize, t: f64) -> f32 {
        let t = (t - self.start[i]) * self.unit[i];
        round_up(t.max(0.0) * (1.0 + 1.0 / (1 << 20) as f64))
    }
}

/// Which rays of a packet to trace.
pub struct TracedLanes<const W: usize> {
    /// Those that come into the box at all.
    pub inside: [bool; W],
    /// Those that no f32 ray can stand for: they start too far away, or their direction is so
    /// short or long that f64 loses its way. They count as not inside.
    pub astray: [bool; W],
    /// Whether there is one of these.
    pub any_astray: bool,
}

impl<const W: usize> PacketRays<W> {
    pub fn new() -> Self {
        Self {
            origin: [[0.0; W]; 3],
            direction: [[0.0; W]; 3],
            tmax: [0.0; W],
            inverse_length_squared: [0.0; W],
            clip: RayInterval { start: [0.0; W], unit: [1.0; W] },
        }
    }

    /// The ray in lane `i`: its origin and direction.
    #[inline(always)]
    pub fn line(&self, i: usize) -> (DVec3, DVec3) {
        let at = |v: &[[f64; W]; 3]| DVec3::new(v[0][i], v[1][i], v[2][i]);
        (at(&self.origin), at(&self.direction))
    }

    /// Sets the ray in lane `i`: its origin and direction.
    #[inline(always)]
    pub fn set_line(&mut self, i: usize, (origin, direction): (DVec3, DVec3)) {
        for axis in 0..3 {
            self.origin[axis][i] = origin[axis];
            self.direction[axis][i] = direction[axis];
        }
    }

    /// Takes up the rays of a packet; the lanes left over repeat the first one.
    #[inline(always)]
    pub fn load(&mut self, packet: &Packet<'_>) {
        let (lines, at) = packet.lines();
        for axis in 0..3 {
            self.origin[axis].copy_from_slice(&lines.origin[axis][at..at + W]);
            self.direction[axis].copy_from_slice(&lines.direction[axis][at..at + W]);
        }
        self.tmax.copy_from_slice(&lines.tmax[at..at + W]);
        for i in packet.count..W {
            self.set_line(i, self.line(0));
            self.tmax[i] = self.tmax[0];
        }
        for i in 0..W {
            let d = self.line(i).1;
            self.inverse_length_squared[i] = crate::geometry::sphere::inverse_length_squared(d);
        }
    }

    /// The largest absolute coordinate of the rays' origins.
    #[inline(always)]
    pub fn farthest(&self) -> f64 {
        // Positive floats are ordered as their bits, which compilers fold side by side.
        let mut farthest = [0u64; W];
        for axis in 0..3 {
            for i in 0..W {
                farthest[i] = farthest[i].max(self.origin[axis][i].abs().to_bits());
            }
        }
        f64::from_bits(farthest.into_iter().fold(0, u64::max))
    }

    /// Sets up the f32 rays: where they start, how long their directions are, where they end.
    #[inline(always)]
    pub fn set_up(
        &mut self,
        frame: &F32Space,
        org: &mut [[f32; W]; 3],
        dir: &mut [[f32; W]; 3],
        tfar: &mut [f32; W],
    ) -> TracedLanes<W> {
        let mut lanes = TracedLanes { inside: [true; W], astray: [false; W], any_astray: false };
        for i in 0..W {
            lanes.inside[i] = self.tmax[i] > 0.0;
        }
        let mut far = false;
        for i in 0..W {
            let (o, d) = self.line(i);
            let p = (o - frame.center).abs();
            let away = (p.max_element() > REACH * frame.extent) | is_extreme(o, d);
            far |= away & (self.tmax[i] > 0.0);
        }
        self.clip.start = [0.0; W];
        if far {
            for i in 0..W {
                let (o, d) = self.line(i);
                let distance = (o - frame.center).abs().max_element();
                let (start, enters) = self.enter(i, frame);
                // Where one that starts far away passes the box is certain even so.
                let lost = (distance > FAR * frame.extent) & enters;
                lanes.astray[i] = (lost | is_extreme(o, d)) & lanes.inside[i];
                lanes.any_astray |= lanes.astray[i];
                self.clip.start[i] = start;
                lanes.inside[i] &= enters & !lanes.astray[i];
            }
        }
        for i in 0..W {
            let (o, d) = self.line(i);
            // 2^e with 2^e <= |d| < 2^(e+1), by the bits, clamped so that the inverse is normal.
            let largest = d.abs().max_element();
            let exponent = (largest.to_bits() >> 52).clamp(1, 2045);
            let unit = f64::from_bits(exponent << 52);
            let shrink = f64::from_bits((2046 - exponent) << 52);
            self.clip.unit[i] = unit;
            let start = o - frame.center;
            for axis in 0..3 {
                let component = d[axis] * shrink;
                dir[axis][i] = if component.abs() < NEGLIGIBLE { 0.0 } else { component as f32 };
                org[axis][i] = start[axis] as f32;
            }
            tfar[i] = round_up(self.tmax[i] * unit);
        }
        if far {
            for i in 0..W {
                let (o, d) = self.line(i);
                let start = o - frame.center + d * self.clip.start[i];
                for axis in 0..3 {
                    org[axis][i] = start[axis] as f32;
                }
                tfar[i] = round_up((self.tmax[i] - self.clip.start[i]) * self.clip.unit[i]);
            }
        }
        lanes
    }

    /// t at which ray `i` enters the scene's box, and whether it does before it ends.
    fn enter(&self, i: usize, frame: &F32Space) -> (f64, bool) {
        let (o, d) = self.line(i);
        let pad = PAD * frame.extent + 64.0 * f64::EPSILON * (o - frame.center).abs().max_element();
        let bounds = frame.bounds.padded(pad);
        let (a, b) = ((bounds.lower - o) / d, (bounds.upper - o) / d);
        // `min` and `max` pass over the NaN of 0/0.
        let (near, far) = (a.min(b), a.max(b));
        let start = near.max_element().max(0.0);
        let end = far.min_element().min(self.tmax[i]);
        if start <= end { (start, true) } else { (0.0, false) }
    }
}

/// The f32 above `x`.
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
    use proptest::prelude::*;

    fn single(frame: &F32Space, ray: Ray) -> (PacketRays<1>, [f32; 3], [f32; 3], f32, bool) {
        let mut exact = PacketRays::<1>::new();
        let mut rays = RayBatch::default();
        rays.push(&ray);
        exact.load(&Packet::all::<1>(&rays).next().unwrap());
        let (mut org, mut dir, mut tfar) = ([[0.0]; 3], [[0.0]; 3], [0.0]);
        let inside = exact.set_up(frame, &mut org, &mut dir, &mut tfar).inside[0];
        (exact, org.map(|a| a[0]), dir.map(|a| a[0]), tfar[0], inside)
    }

    fn unit_frame(offset: DVec3) -> F32Space {
        F32Space::around(Bounds { lower: offset - 0.5, upper: offset + 0.5 })
    }

    #[test]
    fn far_ray_is_moved_to_the_box() {
        let frame = unit_frame(DVec3::splat(1e7));
        let ray = Ray::new(DVec3::ZERO, DVec3::ONE);
        let (_, org, _, _, inside) = single(&frame, ray);
        assert!(inside && org.iter().all(|x| x.abs() <= 0.51), "{org:?}");
    }

    #[test]
    fn far_ray_beside_the_box_is_not_traced() {
        let frame = unit_frame(DVec3::ZERO);
        assert!(!single(&frame, Ray::new(DVec3::X * 99.0, DVec3::Y)).4);
    }

    #[test]
    fn direction_of_any_length_becomes_about_one() {
        let frame = unit_frame(DVec3::ZERO);
        for length in [1e-300, 1e-9, 1.0, 777.0, 1e250] {
            let ray = Ray::new(DVec3::Z, DVec3::new(0.3, 0.2, -1.0) * length);
            let (_, _, dir, _, _) = single(&frame, ray);
            let largest = dir.iter().fold(0.0f32, |m, c| m.max(c.abs()));
            assert!((1.0..=2.0).contains(&largest), "{length}: {dir:?}");
        }
    }

    #[test]
    fn end_of_a_segment_rounds_up() {
        let frame = unit_frame(DVec3::ZERO);
        let ray = Ray::segment(DVec3::ZERO, DVec3::X * 0.1);
        let (exact, _, _, tfar, _) = single(&frame, ray);
        assert!((1.0..1.000001).contains(&exact.clip.widen(0, tfar)));
    }

    #[test]
    fn slight_components_become_zero() {
        let frame = unit_frame(DVec3::ZERO);
        let (_, _, dir, _, _) = single(&frame, Ray::new(DVec3::Z, DVec3::new(1e-20, 0.0, -1.0)));
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
            let frame = unit_frame(offset);
            let (from, to) = (DVec3::from(origin), DVec3::from(target));
            let direction = (to - from) * 2f64.powi(scale);
            let ray = Ray::new(offset + from, direction);
            let (exact, org, dir, _, inside) = single(&frame, ray);
            prop_assert!(inside);
            // The exact point of the ray nearest the target, and the f32 ray there.
            let t = (offset + to - ray.origin).dot(direction) / direction.length_squared();
            let along = (t - exact.clip.start[0]) * exact.clip.unit[0];
            let p = DVec3::from(org.map(f64::from)) + DVec3::from(dir.map(f64::from)) * along;
            let error = (p - (ray.position(t) - frame.center)).abs().max_element();
            prop_assert!(error <= 0.5 * PAD, "{error:e}");
        }
    }
}
