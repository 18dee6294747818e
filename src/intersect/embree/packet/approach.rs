//! The approach of a ray from far away: the point near a box at which its f32 copy starts.
//!
//! The head of [`f32_space`](crate::intersect::embree::f32_space) derives how precise it is.

use glam::DVec3;

use crate::geometry::Bounds;
use crate::geometry::double_double::{DoubleDouble, difference};
use crate::intersect::embree::f32_space::{F32Space, MAX_APPROACH, MAX_ORIGIN_DISTANCE};

/// The result of following a ray to the box of an f32 space.
pub enum Approach {
    /// At this t, at a point that is given from the centre of the space.
    Near { t: f64, point: DVec3 },
    /// Nowhere: the ray passes the box, or leads away from it.
    Passes,
    /// Unknown: the ray starts too far away for double-double numbers.
    Lost,
}

impl Approach {
    /// Follows a ray, which is not extreme, to the box of a space.
    #[cold]
    #[inline(never)]
    pub fn new(origin: DVec3, direction: DVec3, space: &F32Space) -> Self {
        let mut point = difference(origin, space.center);
        let bounds = Bounds {
            lower: space.bounds.lower - space.center,
            upper: space.bounds.upper - space.center,
        };
        let mut t = 0.0;
        loop {
            let from = DVec3::from(point.map(|x| x.hi));
            let distance = from.abs().max_element();
            if distance <= MAX_ORIGIN_DISTANCE * space.extent {
                return Self::Near { t, point: from };
            }
            let is_reached = distance <= MAX_APPROACH * space.extent;
            if !is_reached {
                return Self::Lost;
            }
            // Go to the box. How far that is, f64 tells to within 2⁻⁴⁵ of the way; so repeat it.
            let rounding = 64.0 * f64::EPSILON * distance;
            let (start, end) = bounds.padded(space.margin() + rounding).crossing(from, direction);
            let enters = start <= end && t + start > 0.0;
            if !enters {
                return Self::Passes;
            }
            for axis in 0..3 {
                point[axis] = point[axis] + DoubleDouble::product(direction[axis], start);
            }
            t += start;
        }
    }

    /// The least t that a hit near `t` may be given: f64 does not resolve the distances within a box
    /// that is far away, where those of two hits may come out in the wrong order.
    ///
    /// Precision `certified` knows t to a few ulp, `fast` to some hundreds.
    #[inline(always)]
    pub fn least_t(t: f64) -> f64 {
        t - 1024.0 * f64::EPSILON * t.abs()
    }
}

#[cfg(test)]
mod tests {
    use std::cmp::Ordering;

    use super::*;
    use crate::geometry::dyadic::Dyadic;
    use proptest::prelude::*;

    /// Compares |(p − o) × d| · 2²⁵, in its largest component, with L |d|, all without rounding.
    fn distance_from_line(point: [DVec3; 2], origin: DVec3, direction: DVec3, l: f64) -> Ordering {
        let [center, offset] = point.map(|p| p.to_array().map(Dyadic::new));
        let [o, d] = [origin, direction].map(|v| v.to_array().map(Dyadic::new));
        let from: [Dyadic; 3] =
            std::array::from_fn(|i| center[i].clone() + offset[i].clone() - o[i].clone());
        let product = |i: usize, j: usize| {
            let cross = from[i].clone() * d[j].clone() - from[j].clone() * d[i].clone();
            let cross = if cross.sign().is_lt() { Dyadic::new(0.0) - cross } else { cross };
            cross * Dyadic::power_of_two(25)
        };
        let bound = Dyadic::new(l) * Dyadic::new(direction.abs().max_element());
        let products = [product(1, 2), product(2, 0), product(0, 1)];
        products.into_iter().map(|p| p.cmp(&bound)).max().unwrap()
    }

    proptest! {
        #[test]
        fn the_point_lies_on_the_ray_to_within_half_a_rounding_of_f32(
            middle in prop::array::uniform3(-1.0..1.0f64),
            offset in -9..7i32,
            target in prop::array::uniform3(-0.25..0.25f64),
            from in prop::array::uniform3(-1.0..1.0f64),
            away in 28..100i32,
            length in -400..400i32,
        ) {
            let middle = DVec3::from(middle) * 10f64.powi(offset);
            let space = F32Space::from_bounds(Bounds { lower: middle - 0.5, upper: middle + 0.5 });
            let origin = space.center + DVec3::from(from).normalize() * f64::from(away).exp2();
            let direction = (space.center + DVec3::from(target) - origin) * f64::from(length).exp2();
            let Approach::Near { t, point } = Approach::new(origin, direction, &space) else {
                // A direction of 53 bits aims to within 2⁻⁵³ of the way: beyond this it may miss the box.
                prop_assert!(away > 48, "2^{} away", away);
                return Ok(());
            };
            prop_assert!(t > 0.0 && point.abs().max_element() <= 4.0 * space.extent);
            let far = distance_from_line([space.center, point], origin, direction, space.extent);
            prop_assert!(far.is_lt());
        }
    }

    #[test]
    fn a_ray_away_from_the_box_or_beside_it_passes() {
        let space = F32Space::from_bounds(Bounds { lower: DVec3::NEG_ONE, upper: DVec3::ONE });
        for direction in [DVec3::X, DVec3::new(-1.0, 1e-11, 0.0), DVec3::Y] {
            assert!(matches!(Approach::new(DVec3::X * 1e12, direction, &space), Approach::Passes));
        }
    }
}
