//! Double-double arithmetic: numbers that are the unevaluated sum of two f64s, about 106 bits.
//!
//! The algorithms and their bounds are those of Joldes, Muller and Popescu, *Tight and Rigorous
//! Error Bounds for Basic Building Blocks of Double-Word Arithmetic* (ACM TOMS 2017). Sums and
//! differences of two f64s are exact, and so are products that neither overflow nor underflow.
//! The operators `+`, `-` and `*` have a relative error below [`OMEGA`].
//!
//! This is the only file that uses `mul_add`: the rounding error of a product is itself a float, so
//! that every machine computes the same one.

use std::ops::{Add, Mul, Neg, Sub};

/// The unit roundoff of f64, 2⁻⁵³.
pub const U: f64 = f64::EPSILON / 2.0;

/// The bound of the relative error of one operation: 8 u², where the paper's worst is 7 u².
pub const OMEGA: f64 = 8.0 * U * U;

/// A double-double number: `hi + lo`, with |lo| at most half an ulp of `hi`.
#[derive(Clone, Copy, Debug)]
pub struct DoubleDouble {
    /// The sum, rounded to nearest.
    pub hi: f64,
    /// The rounding error of `hi`.
    pub lo: f64,
}

impl DoubleDouble {
    /// The exact sum a + b (Knuth's two-sum).
    #[inline(always)]
    pub fn sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let b_part = hi - a;
        Self { hi, lo: (a - (hi - b_part)) + (b - b_part) }
    }

    /// The exact difference a − b.
    #[inline(always)]
    pub fn difference(a: f64, b: f64) -> Self {
        Self::sum(a, -b)
    }

    /// The exact product a · b.
    #[inline(always)]
    pub fn product(a: f64, b: f64) -> Self {
        let hi = a * b;
        Self { hi, lo: a.mul_add(b, -hi) }
    }

    /// The exact sum a + b where |a| ≥ |b| or a = 0 (Dekker's fast two-sum).
    #[inline(always)]
    fn ordered_sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        Self { hi, lo: b - (hi - a) }
    }

    /// True if every number within `error` of this one rounds to `hi`, by Ziv's test.
    #[inline(always)]
    pub fn rounds_to_hi(self, error: f64) -> bool {
        // The second term makes up for the rounding of the sums with `lo`.
        let error = error + 4.0 * U * self.lo.abs();
        (self.hi + (self.lo + error) == self.hi) & (self.hi + (self.lo - error) == self.hi)
    }

    /// The quotient N / D and a bound of its error, where `self` and `divisor` lie within
    /// `error` and `divisor_error` of N and D.
    ///
    /// Holds when `divisor_error` is at least 2u² and at most half of |divisor|, relatively. The
    /// remainder N − q·D of the rounded quotient q leaves 32 u² |q| at most, and the operands
    /// (error + |q|·divisor_error) / |D| with |D| ≥ |divisor| / 2; the factor 4 covers both.
    #[inline(always)]
    pub fn quotient(self, error: f64, divisor: Self, divisor_error: f64) -> (Self, f64) {
        let inverse = 1.0 / divisor.hi;
        let q = self.hi / divisor.hi;
        let rest = self - divisor * q;
        let quotient = Self::ordered_sum(q, rest.hi * inverse);
        (quotient, 4.0 * (error + q.abs() * divisor_error) * inverse.abs())
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (s, t) = (Self::sum(self.hi, other.hi), Self::sum(self.lo, other.lo));
        let v = Self::ordered_sum(s.hi, s.lo + t.hi);
        Self::ordered_sum(v.hi, t.lo + v.lo)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let p = Self::product(self.hi, other.hi);
        Self::ordered_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Mul<f64> for DoubleDouble {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        let p = Self::product(self.hi, other);
        Self::ordered_sum(p.hi, p.lo + self.lo * other)
    }
}

/// The dot product of a vector of double-doubles with one of double-doubles or f64s.
#[inline(always)]
pub fn dot<T: Copy>(a: [DoubleDouble; 3], b: [T; 3]) -> DoubleDouble
where
    DoubleDouble: Mul<T, Output = DoubleDouble>,
{
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product of a vector of double-doubles with one of double-doubles or f64s.
#[inline(always)]
pub fn cross<T: Copy>(a: [DoubleDouble; 3], b: [T; 3]) -> [DoubleDouble; 3]
where
    DoubleDouble: Mul<T, Output = DoubleDouble>,
{
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The exact difference a − b of two vectors.
#[inline(always)]
pub fn difference(a: glam::DVec3, b: glam::DVec3) -> [DoubleDouble; 3] {
    [
        DoubleDouble::difference(a.x, b.x),
        DoubleDouble::difference(a.y, b.y),
        DoubleDouble::difference(a.z, b.z),
    ]
}

/// True if 2⁻²⁰⁰ ≤ x ≤ 2²⁰⁰: neither a few products of such numbers nor the rounding errors of these
/// products can overflow or underflow.
#[inline(always)]
pub fn in_range(x: f64) -> bool {
    const END: f64 = f64::from_bits((1023 + 200) << 52);
    (1.0 / END..=END).contains(&x)
}
