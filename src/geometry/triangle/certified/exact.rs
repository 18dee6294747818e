//! The crossing of a ray and a triangle in integer arithmetic, with the tie rule: the last stage, which
//! decides all cases.

use std::cmp::Ordering::{self, Equal};

use glam::DVec3;
use num_bigint::BigInt;

use crate::geometry::integer::{Integer, Rounded, Scale, cross, dot, minus, sign};
use crate::geometry::triangle::TriangleHit;

/// The scales of a triangle's and a ray's positions, and of the ray's direction.
struct Scales {
    positions: Scale,
    direction: Scale,
}

impl Scales {
    fn new(triangle: [DVec3; 3], origin: DVec3, direction: DVec3) -> Self {
        let [a, b, c] = triangle;
        Self {
            positions: Scale::common([a, b, c, origin].into_iter().flat_map(|p| p.to_array())),
            direction: Scale::common(direction.to_array()),
        }
    }

    /// True if i128 can hold d·(p × q) for differences of positions: a difference has one bit more
    /// than a position, and the six products of the sum have three more.
    fn fits_i128(&self) -> bool {
        self.direction.bits + 2 * (self.positions.bits + 1) + 3 <= 127
    }

    /// The vertices relative to the origin, and the direction, as integers.
    fn integers<I: Integer>(
        &self,
        triangle: [DVec3; 3],
        origin: DVec3,
        direction: DVec3,
    ) -> ([[I; 3]; 3], [I; 3]) {
        let origin = self.positions.vector(origin);
        (
            triangle.map(|p| minus(&self.positions.vector(p), &origin)),
            self.direction.vector(direction),
        )
    }
}

/// True if the line crosses the triangle, by the tie rule. `known` holds the signs of the edge
/// functions that are known, and `Equal` for the others. All the numbers must be finite.
#[cold]
pub(super) fn crosses(
    triangle: [DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    known: [Ordering; 3],
) -> bool {
    let scales = Scales::new(triangle, origin, direction);
    if scales.fits_i128() {
        let (relative, d) = scales.integers::<i128>(triangle, origin, direction);
        have_one_sign(&relative, &d, known)
    } else {
        let (relative, d) = scales.integers::<BigInt>(triangle, origin, direction);
        have_one_sign(&relative, &d, known)
    }
}

/// True if the line is on the same side of the three edges of a triangle whose vertices are relative
/// to the line's origin.
fn have_one_sign<I: Integer>([a, b, c]: &[[I; 3]; 3], d: &[I; 3], known: [Ordering; 3]) -> bool {
    let edges = [(b, c), (c, a), (a, b)];
    let signs = [0, 1, 2].map(|i| match (known[i], edges[i]) {
        (Equal, (p, q)) => sign(&dot(d, &cross(p, q))),
        (decided, _) => decided,
    });
    // The sum of the three is d·n, which is 0 for a parallel line. For any other line whose three
    // functions have one sign, the sum has it too.
    if signs == [Equal; 3] {
        return false;
    }
    let [x, y, z] = [0, 1, 2].map(|i| match signs[i] {
        Equal => perturbed_sign(d, edges[i]),
        decided => decided,
    });
    x == y && y == z && x != Equal
}

/// The sign of the edge function for an origin moved by (ε, ε², ε³); `Equal` for an edge along the
/// direction, whose triangle is parallel to the line.
fn perturbed_sign<I: Integer>(d: &[I; 3], (p, q): (&[I; 3], &[I; 3])) -> Ordering {
    let [x, y, z] = cross(d, &minus(q, p));
    sign(&x).then(sign(&y)).then(sign(&z))
}

/// The crossing, with 0 < t < `tmax`, of a line that is known to cross the triangle.
#[cold]
pub(super) fn crossing(
    triangle: [DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
) -> Option<TriangleHit> {
    let scales = Scales::new(triangle, origin, direction);
    let ([a, b, c], d) = scales.integers::<BigInt>(triangle, origin, direction);
    // n, n·d and q of `round.rs`.
    let (first, second) = (minus(&b, &a), minus(&c, &a));
    let normal = cross(&first, &second);
    let divisor = dot(&normal, &d);
    let moment = cross(&a, &d);

    let numerator = dot(&normal, &a);
    if sign(&numerator) == Equal || sign(&numerator) != sign(&divisor) {
        return None;
    }
    let exponent = i64::from(scales.positions.exponent) - i64::from(scales.direction.exponent);
    let t = Rounded::quotient(&numerator, &divisor, exponent);
    let weight = |x: BigInt| {
        if sign(&x) == Equal { 0.0 } else { Rounded::quotient(&x, &divisor, 0).nearest }
    };
    let (u, v) = (weight(dot(&moment, &second)), weight(-dot(&moment, &first)));
    t.is_below(tmax).then_some(TriangleHit { t: t.nearest, u, v })
}
