//! Uniform directions within a cone, such as those to a sphere or a sun.

use std::f64::consts::TAU;

use glam::DVec3;

use super::tangents;

/// A cone of directions about an axis.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    /// The axis, of length 1.
    axis: DVec3,
    /// 1 − cos α for the half-angle α.
    height: f64,
}

impl Cone {
    /// The cone of this half-angle, in radians, in (0, π/2\].
    pub fn from_half_angle(axis: DVec3, half_angle: f64) -> Self {
        let sine = (0.5 * half_angle).sin();
        // 1 − cos α = 2 sin² (α/2), which does not cancel.
        Self { axis, height: 2.0 * sine * sine }
    }

    /// The cone that a sphere fills, seen from `point`; none within or on the sphere.
    pub fn to_sphere(center: DVec3, radius: f64, point: DVec3) -> Option<Self> {
        let toward = center - point;
        let distance = toward.length();
        if distance <= radius {
            return None;
        }
        let sine = radius / distance;
        // 1 − cos α = sin² α / (1 + cos α), which does not cancel for spheres far away.
        let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
        Some(Self { axis: toward / distance, height: sine * sine / (1.0 + cosine) })
    }

    /// The solid angle 2π (1 − cos α), in steradian.
    pub fn solid_angle(&self) -> f64 {
        TAU * self.height
    }

    /// True if a direction, of any length but zero, is within the cone.
    pub fn contains(&self, direction: DVec3) -> bool {
        // 1 − cos θ = |d − a|²/2, for unit vectors.
        (direction.normalize() - self.axis).length_squared() * 0.5 <= self.height
    }

    /// A direction of length 1, uniform in solid angle for `u` uniform in the unit square; `u[0]` grows
    /// from the axis to the rim (pbrt-v4, A.5.4).
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        let below = u[0] * self.height;
        let sine = (below * (2.0 - below)).max(0.0).sqrt();
        let [a, b] = tangents(self.axis);
        let (sin, cos) = (TAU * u[1]).sin_cos();
        self.axis * (1.0 - below) + (a * cos + b * sin) * sine
    }

    /// The vector from `point` to where a direction from [`sample`](Self::sample) meets the sphere whose
    /// cone this is, by the angle at its centre (pbrt-v4, 6.2.4): on the sphere to within rounding, however
    /// far it is.
    pub fn sample_sphere(&self, center: DVec3, radius: f64, point: DVec3, u: [f64; 2]) -> DVec3 {
        let distance = (center - point).length();
        let below = u[0] * self.height;
        let (cosine, sine) = (1.0 - below, (below * (2.0 - below)).max(0.0).sqrt());
        // The distance of the line from the centre, and half of the chord, in units of the radius.
        let foot = distance * sine / radius;
        let chord = ((1.0 - foot) * (1.0 + foot)).max(0.0).sqrt();
        // The angle at the centre is the difference of those at the point on the sphere and at `point`.
        let cos_at_center = foot * sine + chord * cosine;
        let sin_at_center = foot * cosine - chord * sine;
        let [a, b] = tangents(self.axis);
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let normal = -self.axis * cos_at_center + (a * cos + b * sin) * sin_at_center;
        center + normal * radius - point
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn directions_are_within_the_cone_and_their_mean_is_that_of_a_uniform_one() {
        for half_angle in [1e-5, 0.3, 1.0, PI / 2.0] {
            let axis = DVec3::new(0.48, -0.6, 0.64);
            let cone = Cone::from_half_angle(axis, half_angle);
            let n = 64;
            let mut sum = DVec3::ZERO;
            for i in 0..n * n {
                let u = [i % n, i / n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                let direction = cone.sample(u);
                assert!((direction.length() - 1.0).abs() < 1e-15);
                assert!(cone.contains(direction));
                sum += direction / f64::from(n * n);
            }
            // The mean of the cosine is (1 + cos α)/2.
            let mean = axis * (1.0 + half_angle.cos()) / 2.0;
            assert!((sum - mean).length() < 1e-14, "{half_angle}");
        }
    }

    #[test]
    fn the_solid_angle_of_a_sphere_far_away_is_that_of_its_disk() {
        let (radius, distance) = (1.0, 1e9);
        let cone = Cone::to_sphere(DVec3::X * distance, radius, DVec3::ZERO).unwrap();
        let expected = PI * radius * radius / (distance * distance);
        assert!((cone.solid_angle() / expected - 1.0).abs() < 1e-15);
    }

    #[test]
    fn points_of_a_sphere_are_on_it_and_in_the_direction_of_the_same_sample() {
        for distance in [1.5001, 2.0, 1e3, 1e9] {
            let (center, radius) = (DVec3::new(0.0, distance, 0.0), 1.5);
            let cone = Cone::to_sphere(center, radius, DVec3::ZERO).unwrap();
            for u in [[0.0, 0.0], [0.5, 0.3], [0.999_999, 0.8]] {
                let p = cone.sample_sphere(center, radius, DVec3::ZERO, u);
                let error = ((p - center).length() - radius).abs();
                assert!(error < 4.0 * f64::EPSILON * distance, "{distance}: {error}");
                let miss = (p / p.length() - cone.sample(u)).length();
                // The rounding of the point, seen from as near as it may be.
                let bound = 16.0 * f64::EPSILON * (distance + radius) / p.length();
                assert!(miss < bound, "{distance} {u:?}: {miss}");
            }
        }
        assert!(Cone::to_sphere(DVec3::ZERO, 2.0, DVec3::X).is_none());
        assert!(Cone::to_sphere(DVec3::ZERO, 2.0, DVec3::X * 2.0).is_none());
    }
}
