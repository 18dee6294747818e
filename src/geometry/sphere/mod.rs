//! The intersection of a ray with a sphere.
//!
//! The tutorial's discriminant b² − 4ac loses its digits when the sphere is small and far: c has
//! been rounded to the size of the distance squared before the difference is formed. This is the
//! formulation of Haines, Günther and Akenine-Möller, *Precision Improvements for Ray/Sphere
//! Intersection* (Ray Tracing Gems, ch. 7): the discriminant is r² minus the squared distance of
//! the centre from the line, and the root that would cancel comes from the other one's quotient.
//!
//! ```
//! use envers::internals::sphere::{first_root, inverse_length_squared, roots};
//! use glam::DVec3;
//!
//! let (origin, direction) = (DVec3::Z * 5.0, -DVec3::Z);
//! let both = roots(DVec3::ZERO, 1.0, origin, direction, inverse_length_squared(direction));
//! assert_eq!(both, Some((4.0, 6.0)));
//! assert_eq!(first_root(both.unwrap(), f64::INFINITY, false), Some(4.0));
//! ```

pub mod certified;

use glam::DVec3;

/// The two distances, lesser first, at which a line crosses a sphere.
///
/// The line is `origin + t·direction` and `inverse_length_squared` is that of its direction, by
/// [`inverse_length_squared`]. `None` when the line misses the sphere; a tangent has two equal
/// roots. Either root may be negative (behind the origin).
#[inline(always)]
pub fn roots(
    center: DVec3,
    radius: f64,
    origin: DVec3,
    direction: DVec3,
    inverse_length_squared: f64,
) -> Option<(f64, f64)> {
    let line = Quadratic::new(center, radius, origin, direction, inverse_length_squared);
    line.crosses().then(|| line.roots())
}

/// The reciprocal 1 / |direction|², an argument of [`Quadratic`] and of its certified counterpart,
/// computed once per ray.
///
/// NaN where |direction|² is beyond f64, since 0 would lose the direction: then nothing about the ray
/// is certain, and the plain formulas report a miss.
#[inline(always)]
pub fn inverse_length_squared(direction: DVec3) -> f64 {
    let square = direction.length_squared();
    if square < f64::INFINITY { 1.0 / square } else { f64::NAN }
}

/// The quadratic equation of a line and a sphere, without its roots.
///
/// [`Quadratic::crosses`] needs no square root, so that a packet can stop early when no ray of it
/// crosses the sphere.
#[derive(Clone, Copy)]
pub struct Quadratic {
    /// Half the negative linear coefficient: −f·d, with f from the centre to the origin.
    half_b: f64,
    /// The constant coefficient, |f|² − r².
    c: f64,
    /// The reciprocal of the leading coefficient, 1 / |d|².
    inverse_a: f64,
    /// The discriminant (r² − squared distance of the centre from the line) / |d|²: a quarter of the
    /// tutorial's Δ divided by a².
    discriminant: f64,
}

impl Quadratic {
    /// Builds the equation; see [`roots`] for the arguments.
    #[inline(always)]
    pub fn new(
        center: DVec3,
        radius: f64,
        origin: DVec3,
        direction: DVec3,
        inverse_length_squared: f64,
    ) -> Self {
        let f = origin - center;
        let half_b = -f.dot(direction);
        let nearest = f + direction * (half_b * inverse_length_squared);
        let r2 = radius * radius;
        Self {
            half_b,
            c: f.dot(f) - r2,
            inverse_a: inverse_length_squared,
            discriminant: (r2 - nearest.dot(nearest)) * inverse_length_squared,
        }
    }

    /// True if the line crosses or touches the sphere.
    #[inline(always)]
    pub fn crosses(&self) -> bool {
        self.discriminant >= 0.0
    }

    /// The power of the origin with respect to the sphere, |f|² − r² with f from the centre to the
    /// origin: above 0 outside, below 0 inside.
    #[inline(always)]
    pub fn power(&self) -> f64 {
        self.c
    }

    /// The two roots, lesser first; not meaningful unless [`Quadratic::crosses`].
    #[inline(always)]
    pub fn roots(&self) -> (f64, f64) {
        // With m = half_b / a and s = √discriminant the roots are m ∓ s. The one that is farther
        // from 0 adds two numbers of the same sign; the other is c / (a · that one).
        let middle = self.half_b * self.inverse_a;
        let far = middle + self.discriminant.sqrt().copysign(middle);
        let product = self.c * self.inverse_a;
        let near = if far == 0.0 { 0.0 } else { product / far };
        (near.min(far), near.max(far))
    }
}

/// The first root with 0 < t < `tmax`, if there is one.
///
/// With `leaving_inward` the origin is on this sphere and the ray goes into it: then the root at the
/// origin, which rounding puts on either side of 0, is left out, and only the far one counts.
#[inline(always)]
pub fn first_root(roots: (f64, f64), tmax: f64, leaving_inward: bool) -> Option<f64> {
    let (near, far) = roots;
    let t = if near > 0.0 && !leaving_inward { near } else { far };
    (t > 0.0 && t < tmax).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn first(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Option<f64> {
        let inverse = 1.0 / direction.length_squared();
        first_root(roots(center, radius, origin, direction, inverse)?, f64::INFINITY, false)
    }

    #[test]
    fn hits_the_near_side_from_outside() {
        assert_eq!(first(DVec3::Z * 10.0, 1.0, DVec3::ZERO, DVec3::Z), Some(9.0));
    }

    #[test]
    fn hits_the_far_side_from_inside() {
        assert_eq!(first(DVec3::ZERO, 2.0, DVec3::ZERO, DVec3::X), Some(2.0));
    }

    #[test]
    fn misses_a_sphere_behind() {
        assert_eq!(first(-DVec3::Z * 10.0, 1.0, DVec3::ZERO, DVec3::Z), None);
    }

    #[test]
    fn tangent_is_a_hit() {
        assert_eq!(first(DVec3::new(1.0, 0.0, 5.0), 1.0, DVec3::ZERO, DVec3::Z), Some(5.0));
    }

    #[test]
    fn t_is_in_units_of_the_direction() {
        assert_eq!(first(DVec3::Z * 10.0, 1.0, DVec3::ZERO, DVec3::Z * 500.0), Some(9.0 / 500.0));
    }

    #[test]
    fn far_root_when_leaving_inward() {
        let (origin, direction) = (DVec3::X, -DVec3::X);
        let both = roots(DVec3::ZERO, 1.0, origin, direction, 1.0).unwrap();
        assert_eq!(first_root(both, f64::INFINITY, true), Some(2.0));
    }

    proptest! {
        #[test]
        fn hit_lies_on_the_sphere(
            center in prop::array::uniform3(-1e3..1e3f64),
            radius in 1e-2..1e2f64,
            target in prop::array::uniform3(-1.0..1.0f64),
            origin in prop::array::uniform3(-1e3..1e3f64),
        ) {
            let (center, origin) = (DVec3::from(center), DVec3::from(origin));
            let direction = center + DVec3::from(target) * radius * 0.5 - origin;
            prop_assume!(direction.length() > 1e-6);
            let t = first(center, radius, origin, direction).expect("aimed at the inside");
            let distance = (origin + direction * t - center).length();
            prop_assert!((distance - radius).abs() < 1e-11 * (1e3 + radius), "{distance} {radius}");
        }
    }
}
