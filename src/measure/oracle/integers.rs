//! Floats as integers times powers of two, and vectors of integers.

use dashu_int::IBig;
use glam::DVec3;

/// A vector of integers, in units of a power of two that is stored elsewhere.
pub type IntegerVector = [IBig; 3];

/// Returns vectors of integers and one exponent `e`, so that each coordinate is its n · 2^e.
///
/// # Panics
/// When a value is not finite.
pub fn common_scale<const N: usize>(vectors: [DVec3; N]) -> ([IntegerVector; N], i64) {
    // The least exponent of the coordinates that are not 0, of which all others are multiples.
    let coordinates = vectors.iter().flat_map(|v| v.to_array()).filter(|x| *x != 0.0);
    let exponent = coordinates.map(|x| decode(x).1).min().unwrap_or(0);
    (vectors.map(|v| v.to_array().map(|x| integer(x, exponent))), exponent)
}

/// Returns x / 2^exponent, for an exponent that makes this an integer.
fn integer(x: f64, exponent: i64) -> IBig {
    let (mantissa, e) = decode(x);
    if mantissa == 0 { IBig::ZERO } else { IBig::from(mantissa) << (e - exponent) as usize }
}

/// Returns the odd (or zero) integer m and the exponent e with x = m · 2^e.
///
/// # Panics
/// When `x` is not finite.
pub fn decode(x: f64) -> (i64, i64) {
    assert!(x.is_finite(), "the oracle needs finite numbers, not {x}");
    let (mantissa, exponent) = significand(x.abs());
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    let sign = if x < 0.0 { -1 } else { 1 };
    (sign * (mantissa >> zeros) as i64, exponent + i64::from(zeros))
}

/// Returns the significand, hidden bit included, and the exponent of a float ≥ 0.
pub fn significand(x: f64) -> (u64, i64) {
    let (stored, fraction) = (x.to_bits() >> 52, x.to_bits() & ((1 << 52) - 1));
    // A subnormal has no hidden bit, and the exponent of the least normal number.
    if stored == 0 { (fraction, -1074) } else { (fraction | 1 << 52, stored as i64 - 1075) }
}

/// Returns a − b.
pub fn sub(a: &IntegerVector, b: &IntegerVector) -> IntegerVector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

/// Returns a · b.
pub fn dot(a: &IntegerVector, b: &IntegerVector) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Returns a × b.
pub fn cross(a: &IntegerVector, b: &IntegerVector) -> IntegerVector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}
