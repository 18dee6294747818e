//! Exact integer arithmetic on floats: every f64 is an integer times a power of two.
//!
//! Coordinates are brought to a common exponent, after which all arithmetic is on integers: i128
//! where the products fit, big integers otherwise. The range of the exponents does not matter.

use std::cmp::Ordering;
use std::ops::Shl;

use glam::DVec3;
use num_bigint::BigInt;
use num_traits::Signed;

/// The integer types of the exact predicates: [`i128`] or [`BigInt`].
pub trait Integer: Signed + Clone + From<i64> + Shl<usize, Output = Self> {}

impl Integer for i128 {}
impl Integer for BigInt {}

/// Compares an integer with 0.
pub fn sign<I: Integer>(x: &I) -> Ordering {
    (x.is_positive() as i8).cmp(&(x.is_negative() as i8))
}

/// Decodes a finite f64 as (m, e) with the value m·2ᵉ and m odd; (0, 0) for zero.
fn decode(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let (biased, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let (m, e) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    if m == 0 {
        return (0, 0);
    }
    let zeros = m.trailing_zeros();
    let m = (m >> zeros) as i64;
    (if x < 0.0 { -m } else { m }, e + zeros as i32)
}

/// A scale that a set of numbers has in common: each is an integer times 2^`exponent`.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// The exponent of the unit.
    pub exponent: i32,
    /// The number of bits of the largest of the integers.
    pub bits: u32,
}

impl Scale {
    /// The coarsest scale on which all the numbers are integers.
    pub fn common(numbers: impl IntoIterator<Item = f64>) -> Self {
        let (mut low, mut high) = (i32::MAX, i32::MIN);
        for (m, e) in numbers.into_iter().map(decode).filter(|&(m, _)| m != 0) {
            low = low.min(e);
            high = high.max(e + 64 - m.unsigned_abs().leading_zeros() as i32);
        }
        if low == i32::MAX {
            return Self { exponent: 0, bits: 0 };
        }
        Self { exponent: low, bits: (high - low) as u32 }
    }

    /// The integer that represents a number of the set.
    pub fn integer<I: Integer>(self, x: f64) -> I {
        match decode(x) {
            (0, _) => I::from(0),
            (m, e) => I::from(m) << (e - self.exponent) as usize,
        }
    }

    /// The vector of integers that represents a vector of the set.
    pub fn vector<I: Integer>(self, v: DVec3) -> [I; 3] {
        v.to_array().map(|x| self.integer(x))
    }
}

/// The dot product a · b.
pub fn dot<I: Integer>(a: &[I; 3], b: &[I; 3]) -> I {
    let [x, y, z] = [0, 1, 2].map(|i| a[i].clone() * b[i].clone());
    x + y + z
}

/// The cross product a × b.
pub fn cross<I: Integer>(a: &[I; 3], b: &[I; 3]) -> [I; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].clone() * b[j].clone() - a[j].clone() * b[i].clone())
}

/// The difference a − b.
pub fn minus<I: Integer>(a: &[I; 3], b: &[I; 3]) -> [I; 3] {
    [0, 1, 2].map(|i| a[i].clone() - b[i].clone())
}

/// A positive number, correctly rounded, with the direction in which it was rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounded {
    /// The nearest f64 (ties to even), but never 0 nor infinite.
    pub nearest: f64,
    /// The order of the exact number relative to `nearest`.
    pub exact: Ordering,
}

impl Rounded {
    /// True if the exact number is below `limit`.
    pub fn is_below(self, limit: f64) -> bool {
        self.nearest < limit || (self.nearest == limit && self.exact.is_lt())
    }

    /// Rounds the quotient of two integers of the same sign, times 2^`exponent`.
    pub fn quotient(numerator: &BigInt, denominator: &BigInt, exponent: i64) -> Self {
        let shift = (66 + denominator.bits()).saturating_sub(numerator.bits());
        let scaled = numerator.magnitude() << shift;
        let floor = &scaled / denominator.magnitude();
        let more = &floor * denominator.magnitude() != scaled;
        Self::from_floor(floor.into(), more, exponent - shift as i64)
    }

    /// Rounds the number x·2^`exponent` with ⌊x⌋ = `floor` ≥ 2⁶³, and x > `floor` where `more` is set.
    pub fn from_floor(floor: BigInt, more: bool, exponent: i64) -> Self {
        // Keep the leading 64 bits; `more` says whether anything but zeros follows them.
        let cut = floor.bits() - 64;
        let more = more || floor.trailing_zeros().is_some_and(|zeros| zeros < cut);
        let lead = (floor >> cut).iter_u64_digits().next().unwrap_or(0);
        let exponent = exponent + cut as i64;

        // The exponent of the last place: of 53 bits, or of the subnormals.
        let last_place = (exponent + 11).max(-1074);
        let drop = (last_place - exponent).min(100) as u32;
        let (lead, half) = (u128::from(lead), 1u128 << (drop - 1));
        let (kept, rest) = (lead >> drop, lead & ((half << 1) - 1));

        // Round to nearest, ties to even.
        let to_half = rest.cmp(&half).then(if more { Ordering::Greater } else { Ordering::Equal });
        let up = to_half.is_gt() || (to_half.is_eq() && kept & 1 == 1);
        let mantissa = kept as u64 + up as u64;
        let exact = if up {
            Ordering::Less
        } else if rest == 0 && !more {
            Ordering::Equal
        } else {
            Ordering::Greater
        };

        // Neither 0 nor infinity is returned for what lies beyond the range of f64.
        if mantissa == 0 {
            return Self { nearest: f64::from_bits(1), exact: Ordering::Less };
        }
        if last_place > 971 || (last_place == 971 && mantissa == 1 << 53) {
            return Self { nearest: f64::MAX, exact: Ordering::Greater };
        }
        let unit = match last_place {
            -1074..-1022 => f64::from_bits(1 << (last_place + 1074)),
            _ => f64::from_bits(((last_place + 1023) as u64) << 52),
        };
        Self { nearest: mantissa as f64 * unit, exact }
    }
}
