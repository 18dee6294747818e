//! The roots of a ray and a sphere in integer arithmetic: the last stage, which decides all cases.
//!
//! On the scales of the lengths and of the direction the roots are (B ∓ √Δ)/A with integers
//! A = |d|², B = −f·d, C = |f|² − r² and Δ = B² − AC.

use std::cmp::Ordering::{Equal, Greater, Less};

use glam::DVec3;
use num_bigint::BigInt;

use crate::geometry::integer::{Rounded, Scale, dot, minus, sign};

/// The first root above 0, or with `inward` the far root if it is above 0.
#[cold]
pub(super) fn first_root(
    center: DVec3,
    radius: f64,
    origin: DVec3,
    direction: DVec3,
    inward: bool,
) -> Option<Rounded> {
    let finite = center.is_finite() && radius.is_finite();
    if !(finite && origin.is_finite() && direction.is_finite()) || direction == DVec3::ZERO {
        return None;
    }
    let lengths = origin.to_array().into_iter().chain(center.to_array()).chain([radius]);
    let (lengths, directions) = (Scale::common(lengths), Scale::common(direction.to_array()));
    let f = minus::<BigInt>(&lengths.vector(origin), &lengths.vector(center));
    let (d, r) = (directions.vector::<BigInt>(direction), lengths.integer::<BigInt>(radius));

    let a = dot(&d, &d);
    let b = -dot(&f, &d);
    let c = dot(&f, &f) - &r * &r;
    let discriminant = &b * &b - &a * &c;
    if sign(&discriminant) == Less {
        return None;
    }
    // The product of the roots has the sign of c, their sum that of b.
    let far = match (sign(&c), sign(&b)) {
        (Greater, Greater) => inward,
        (Less, _) | (Equal, Greater) => true,
        _ => return None,
    };
    let exponent = i64::from(lengths.exponent) - i64::from(directions.exponent);
    Some(rounded(&a, b, discriminant, far, exponent))
}

/// Rounds the positive number (b ± √discriminant)/a, + for the far root, times 2^`exponent`.
fn rounded(a: &BigInt, b: BigInt, discriminant: BigInt, far: bool, exponent: i64) -> Rounded {
    // With S = 2ᵏ√Δ and s = ⌊S⌋: ⌊(X + S)/a⌋ = ⌊(X + s)/a⌋ for integers X and a > 0, and
    // ⌊(X − S)/a⌋ = ⌊(X − ⌈S⌉)/a⌋. So the floor is exact however much the difference cancels; k
    // grows until enough of it is left.
    let mut k = 64 + a.bits();
    loop {
        let square = &discriminant << (2 * k);
        let root = square.sqrt();
        let beyond = &root * &root != square;
        let sum = (&b << k) + if far { root } else { -root - BigInt::from(beyond as u8) };
        let floor = &sum / a;
        if floor.bits() >= 64 {
            let more = beyond || &floor * a != sum;
            return Rounded::from_floor(floor, more, exponent - k as i64);
        }
        k *= 2;
    }
}
