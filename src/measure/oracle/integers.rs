//! Floats as what they are: integers times powers of two.

use dashu_int::IBig;
use glam::DVec3;

/// A vector of integers; in units that its owner knows.
pub type Vector = [IBig; 3];

/// The integers `n` and the exponent `e` with value = n · 2^e for each of some floats.
///
/// # Panics
/// When a value is not finite.
pub fn common_scale<const N: usize>(values: [f64; N]) -> ([IBig; N], i64) {
    let exponent = least_exponent(values.into_iter());
    (values.map(|x| integer(x, exponent)), exponent)
}

/// The same for vectors.
///
/// # Panics
/// When a value is not finite.
pub fn common_scale_of<const N: usize>(vectors: [DVec3; N]) -> ([Vector; N], i64) {
    let exponent = least_exponent(vectors.iter().flat_map(|v| v.to_array()));
    (vectors.map(|v| v.to_array().map(|x| integer(x, exponent))), exponent)
}

fn least_exponent(values: impl Iterator<Item = f64>) -> i64 {
    values.filter(|x| *x != 0.0).map(|x| decode(x).1).min().unwrap_or(0)
}

/// x / 2^exponent, which the exponent makes an integer.
fn integer(x: f64, exponent: i64) -> IBig {
    let (mantissa, e) = decode(x);
    if mantissa == 0 { IBig::ZERO } else { IBig::from(mantissa) << (e - exponent) as usize }
}

/// The odd (or zero) integer m and the exponent e with x = m · 2^e.
///
/// # Panics
/// When `x` is not finite.
pub fn decode(x: f64) -> (i64, i64) {
    assert!(x.is_finite(), "the oracle knows finite numbers, not {x}");
    let bits = x.to_bits();
    let stored = (bits >> 52 & 0x7ff) as i64;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    // A subnormal has no hidden bit, and the exponent of the least normal number.
    let (mantissa, exponent) =
        if stored == 0 { (fraction, -1074) } else { (fraction | 1 << 52, stored - 1075) };
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    let sign = if x < 0.0 { -1 } else { 1 };
    (sign * (mantissa >> zeros), exponent + i64::from(zeros))
}

/// a − b.
pub fn sub(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

/// a · b.
pub fn dot(a: &Vector, b: &Vector) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// a × b.
pub fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}
