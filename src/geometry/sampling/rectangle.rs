//! Uniform directions to a rectangle (Ureña, Fajardo and King, *An Area-Preserving Parametrization for
//! Spherical Rectangles*, EGSR 2013).

use std::f64::consts::TAU;

use glam::DVec3;

/// The solid angle below which points are uniform in the area of the rectangle: the sum of the angles,
/// less 2π, keeps ten digits of it.
const LEAST_SOLID_ANGLE: f64 = 1e-5;

/// A rectangle seen from a point in front of it.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle {
    /// The unit vectors along the sides, and the normal.
    axes: [DVec3; 3],
    /// The corners, from the point, along the first two axes.
    lower: [f64; 2],
    upper: [f64; 2],
    /// The plane, from the point along the normal; below 0.
    z: f64,
    /// The z of the normals of the planes through the point and the lower and upper side along the second
    /// axis.
    b: [f64; 2],
    /// 2π less the angles at the corners on the lower side along the first axis.
    k: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// The rectangle with this centre and these half-sides, which are orthogonal and not 0, seen from
    /// `point`; none from behind it or from its plane. It faces along `half_u` × `half_v`.
    pub fn new(center: DVec3, [half_u, half_v]: [DVec3; 2], point: DVec3) -> Option<Self> {
        let (x_length, y_length) = (half_u.length(), half_v.length());
        let (x, y) = (half_u / x_length, half_v / y_length);
        let normal = x.cross(y);
        let toward = center - point;
        let (middle, z) = ([toward.dot(x), toward.dot(y)], toward.dot(normal));
        if z >= 0.0 {
            return None;
        }
        let half = [x_length, y_length];
        let lower = [0, 1].map(|i| middle[i] - half[i]);
        let upper = [0, 1].map(|i| middle[i] + half[i]);
        // The angles at the corners, between the planes through the point and two sides. Their normals
        // have z in common alone; the arc tangent keeps the digits that the arc cosine would lose.
        let ([x0, y0], [x1, y1]) = (lower, upper);
        let angle = |a: f64, b: f64| (-z * (a * a + b * b + z * z).sqrt()).atan2(a * b);
        let [g0, g1] = [angle(y0, x1), angle(-x1, y1)];
        let [g2, g3] = [angle(y1, x0), angle(-x0, y0)];
        let k = TAU - g2 - g3;
        let (axes, b) = ([x, y, normal], [-y0 / y0.hypot(z), y1 / y1.hypot(z)]);
        Some(Self { axes, lower, upper, z, b, k, solid_angle: g0 + g1 - k })
    }

    /// The vector from the point to a point of the rectangle, and its density per steradian, for `u`
    /// uniform in the unit square.
    pub fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let at = if self.is_small() { self.uniform_in_area(u) } else { self.uniform_in_angle(u) };
        (at, self.pdf_at(at))
    }

    /// The density per steradian of a direction, of any length but zero, among those of
    /// [`sample`](Self::sample); 0 beside the rectangle.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let [x, y, normal] = self.axes;
        let slope = direction.dot(normal);
        if slope >= 0.0 {
            return 0.0;
        }
        let scale = self.z / slope;
        let at = [direction.dot(x) * scale, direction.dot(y) * scale];
        let is_within = (0..2).all(|i| self.lower[i] <= at[i] && at[i] <= self.upper[i]);
        if is_within { self.pdf_at(direction * scale) } else { 0.0 }
    }

    /// True if it is so small that directions are not uniform in solid angle.
    fn is_small(&self) -> bool {
        self.solid_angle <= LEAST_SOLID_ANGLE
    }

    /// The density at the end of this vector, on the rectangle.
    fn pdf_at(&self, at: DVec3) -> f64 {
        if !self.is_small() {
            return 1.0 / self.solid_angle;
        }
        let area = (self.upper[0] - self.lower[0]) * (self.upper[1] - self.lower[1]);
        let distance_squared = at.length_squared();
        distance_squared * distance_squared.sqrt() / (area * -self.z)
    }

    fn uniform_in_area(&self, [u, v]: [f64; 2]) -> DVec3 {
        let [x, y, normal] = self.axes;
        let along = |i: usize, u: f64| self.lower[i] + u * (self.upper[i] - self.lower[i]);
        x * along(0, u) + y * along(1, v) + normal * self.z
    }

    fn uniform_in_angle(&self, [u, v]: [f64; 2]) -> DVec3 {
        let Self { axes: [x, y, normal], lower, upper, z, b: [b0, b1], k, solid_angle } = *self;
        // The x at which the part left of it has the share u of the solid angle.
        let (sin, cos) = (u * solid_angle + k).sin_cos();
        let f = (cos * b0 - b1) / sin;
        let c = (1f64.copysign(f) / (f * f + b0 * b0).sqrt()).clamp(-1.0, 1.0);
        let at_x = (-c * z / (1.0 - c * c).max(f64::MIN_POSITIVE).sqrt()).clamp(lower[0], upper[0]);
        // The y along the line there.
        let d_squared = at_x * at_x + z * z;
        let height = |y: f64| y / (d_squared + y * y).sqrt();
        let [h0, h1] = [height(lower[1]), height(upper[1])];
        let h = h0 + v * (h1 - h0);
        let at_y = (h * (d_squared / (1.0 - h * h).max(f64::MIN_POSITIVE)).sqrt())
            .clamp(lower[1], upper[1]);
        x * at_x + y * at_y + normal * z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The solid angle of a rectangle, by the corner formula: arctan(x y / (z √(x² + y² + z²))), summed
    /// with the signs of the corners.
    fn solid_angle([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: f64) -> f64 {
        let corner = |x: f64, y: f64| (x * y / (z * (x * x + y * y + z * z).sqrt())).atan();
        corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)
    }

    fn seen(center: DVec3, half: [f64; 2]) -> SphericalRectangle {
        // It faces down, to the point at the origin.
        let sides = [DVec3::X * half[0], DVec3::NEG_Y * half[1]];
        SphericalRectangle::new(center, sides, DVec3::ZERO).unwrap()
    }

    const CASES: [([f64; 3], [f64; 2]); 6] = [
        ([0.0, 0.0, 1.0], [1.0, 1.0]),
        ([0.5, -0.25, 0.01], [2.0, 1.0]),
        ([5.0, 3.0, 0.5], [1.0, 2.0]),
        ([0.0, 0.0, 30.0], [0.5, 0.1]),
        ([3e4, -1e4, 2e4], [1.0, 3.0]),
        ([2.0, 0.0, 1e-5], [1.0, 1.0]),
    ];

    #[test]
    fn the_solid_angle_is_that_of_the_corner_formula() {
        for (center, half) in CASES {
            let [x, y, z] = center;
            let rectangle = seen(center.into(), half);
            let expected = solid_angle([x - half[0], x + half[0]], [y - half[1], y + half[1]], z);
            let error = (rectangle.solid_angle - expected).abs();
            assert!(error < 1e-14, "{center:?}: {} {expected}", rectangle.solid_angle);
        }
    }

    #[test]
    fn samples_are_on_the_rectangle_and_their_densities_make_up_its_solid_angle() {
        for (center, half) in CASES {
            let [x, y, z] = center;
            let rectangle = seen(center.into(), half);
            let n = 64;
            let mut sum = 0.0;
            for i in 0..n * n {
                let u = [i % n, i / n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                let (at, pdf) = rectangle.sample(u);
                let offset = at - DVec3::from(center);
                let slack = 1e-12 * DVec3::from(center).length().max(1.0);
                assert!(offset.x.abs() <= half[0] + slack && offset.y.abs() <= half[1] + slack);
                assert!(offset.z.abs() <= slack);
                // A direction at the very rim may be beside it to within rounding.
                let inner = rectangle.pdf(at * 7.0);
                assert!((inner / pdf - 1.0).abs() < 1e-9, "{center:?} {u:?}");
                sum += 1.0 / (pdf * f64::from(n * n));
            }
            let expected = solid_angle([x - half[0], x + half[0]], [y - half[1], y + half[1]], z);
            assert!((sum / expected - 1.0).abs() < 2e-4, "{center:?}: {sum} {expected}");
            assert_eq!(rectangle.pdf(-DVec3::from(center)), 0.0);
        }
    }

    #[test]
    fn each_quarter_of_the_square_has_a_quarter_of_the_solid_angle() {
        // Where directions are uniform, as many of them are within a part as its share of the angle.
        let rectangle = seen(DVec3::new(0.5, -0.25, 0.4), [2.0, 1.0]);
        let n = 200;
        let mut within = 0;
        for i in 0..n * n {
            let u = [i % n, i / n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
            let (at, _) = rectangle.sample(u);
            within += u32::from(at.x < 0.3 && at.y > 0.1);
        }
        let part = solid_angle([-1.5, 0.3], [0.1, 0.75], 0.4);
        let share = part / rectangle.solid_angle;
        assert!((f64::from(within) / f64::from(n * n) - share).abs() < 5e-3, "{within} {share}");
    }

    #[test]
    fn nothing_is_seen_from_behind_or_from_the_plane() {
        let sides = [DVec3::X, DVec3::NEG_Y];
        for point in [DVec3::new(0.1, 0.2, 2.0), DVec3::new(5.0, 0.0, 1.0)] {
            assert!(SphericalRectangle::new(DVec3::Z, sides, point).is_none());
        }
    }
}
