//! Exact distances: roots of linear and quadratic equations with integer coefficients.

use std::cmp::Ordering;

use dashu_int::ops::{BitTest, SquareRoot, UnsignedAbs};
use dashu_int::{IBig, Sign, UBig};

use dashu_ratio::RBig;

use super::integers::{decode, significand};

/// The least number of bits of an approximation.
const BITS: usize = 130;

/// A positive number (p ± √q) / a · 2^k, stored as its integers.
#[derive(Clone, Debug)]
pub struct ExactNumber {
    /// p.
    pub(super) rational: IBig,
    /// The sign of the root; without meaning when q is 0.
    pub(super) root: Sign,
    /// q.
    pub(super) radicand: UBig,
    /// a, above 0.
    pub(super) denominator: IBig,
    /// k.
    pub(super) exponent: i64,
}

impl ExactNumber {
    /// Returns numerator / denominator · 2^exponent.
    pub(in crate::measure) fn quotient(numerator: IBig, denominator: IBig, exponent: i64) -> Self {
        let (rational, denominator) = match denominator.sign() {
            Sign::Negative => (-numerator, -denominator),
            Sign::Positive => (numerator, denominator),
        };
        Self { rational, root: Sign::Positive, radicand: UBig::ZERO, denominator, exponent }
    }

    /// Returns p + √q, or p − √q unless `is_far`, for fractions p and q of which q is not negative.
    pub(in crate::measure) fn root_of(p: &RBig, q: &RBig, is_far: bool) -> Self {
        // With p = k/l and q = m/n it is (k n ± √(l² m n)) / (l n).
        let (l, n) = (p.denominator(), q.denominator());
        let m = q.numerator().clone().unsigned_abs();
        Self {
            rational: p.numerator() * IBig::from(n.clone()),
            root: if is_far { Sign::Positive } else { Sign::Negative },
            radicand: l * l * m * n,
            denominator: IBig::from(l * n),
            exponent: 0,
        }
    }

    /// Returns the least positive float.
    pub(super) fn least() -> Self {
        Self::quotient(IBig::from(1), IBig::from(1), -1074)
    }

    /// Compares the number with `x`, exactly; infinities lie beyond every number.
    ///
    /// # Panics
    /// When `x` is NaN.
    pub fn compare(&self, x: f64) -> Ordering {
        if x.is_infinite() {
            return if x > 0.0 { Ordering::Less } else { Ordering::Greater };
        }
        let (mantissa, exponent) = decode(x);
        self.compare_dyadic(&IBig::from(mantissa), exponent)
    }

    /// Compares the number with mantissa · 2^exponent, exactly.
    fn compare_dyadic(&self, mantissa: &IBig, exponent: i64) -> Ordering {
        // The result is the sign of (p − x·a) ± √q, in the scale that keeps all terms integers.
        let shift = self.exponent - exponent;
        let scaled = &self.denominator * mantissa;
        let (rest, radicand) = if shift >= 0 && !mantissa.is_zero() {
            let shift = shift as usize;
            ((&self.rational << shift) - scaled, &self.radicand << (2 * shift))
        } else {
            let shift = if mantissa.is_zero() { 0 } else { -shift as usize };
            (&self.rational - (scaled << shift), self.radicand.clone())
        };
        let zero = IBig::ZERO;
        if radicand.is_zero() {
            return rest.cmp(&zero);
        }
        let below = match self.root {
            Sign::Positive if rest >= zero => return Ordering::Greater,
            Sign::Negative if rest <= zero => return Ordering::Less,
            root => root == Sign::Positive,
        };
        // The two terms have opposite signs: the larger square decides.
        let square = (&rest * &rest).unsigned_abs();
        if below { radicand.cmp(&square) } else { square.cmp(&radicand) }
    }

    /// Compares two numbers, exactly.
    ///
    /// With a common denominator the difference is D = k ± √p ± √q in integers. The product of D and its
    /// three conjugates, which are at most M = |k| + √p + √q, is an integer; so D is 0 or at least
    /// M⁻³ (also where a conjugate is 0: then D is twice k, √p or √q, or 0), and an approximation to
    /// more digits than that decides.
    pub fn compare_with(&self, other: &Self) -> Ordering {
        // Over both denominators, in the unit of the lesser exponent.
        let low = self.exponent.min(other.exponent);
        let terms = |number: &Self, denominator: &IBig| {
            let factor = denominator << (number.exponent - low) as usize;
            let square = (&factor * &factor).unsigned_abs();
            (&number.rational * factor, &number.radicand * square)
        };
        let (a, p) = terms(self, &other.denominator);
        let (b, q) = terms(other, &self.denominator);
        let k = a - b;
        // Each root is rounded down, by less than 1.
        let bits = k.bit_len().max(p.bit_len() / 2 + 1).max(q.bit_len() / 2 + 1) + 2;
        let shift = 3 * bits + 3;
        let root = |radicand: UBig, sign: Sign| {
            let root = IBig::from((radicand << (2 * shift)).sqrt());
            if sign == Sign::Negative { -root } else { root }
        };
        let difference = (k << shift) + root(p, self.root) - root(q, other.root);
        let four = IBig::from(4);
        if difference >= four {
            Ordering::Greater
        } else if difference <= -four {
            Ordering::Less
        } else {
            Ordering::Equal
        }
    }

    /// Returns a mantissa of at least [`BITS`] bits and an exponent, so that the mantissa is within 2
    /// of the number divided by 2^exponent.
    fn approximate(&self) -> (UBig, i64) {
        let p = self.rational.clone().unsigned_abs();
        let a = self.denominator.clone().unsigned_abs();
        // |p| + √q, with enough fractional bits of the root.
        let bits = p.bit_len().max(self.radicand.bit_len() / 2);
        let fraction_bits = (BITS + 10).saturating_sub(bits);
        let sum = (&p << fraction_bits) + (&self.radicand << (2 * fraction_bits)).sqrt();
        let adds_up = self.radicand.is_zero() || self.rational.sign() == self.root || p.is_zero();
        let (numerator, denominator) = if adds_up {
            (sum, a << fraction_bits)
        } else {
            // p ± √q = (p² − q) / (p ∓ √q), which cancels nothing.
            let product = (&self.rational * &self.rational) - IBig::from(self.radicand.clone());
            (product.unsigned_abs() << fraction_bits, a * sum)
        };
        let shift = (BITS + 1 + denominator.bit_len()).saturating_sub(numerator.bit_len());
        ((numerator << shift) / denominator, self.exponent - shift as i64)
    }

    /// Returns the number correctly rounded: to nearest, ties to even. Underflow gives the least
    /// positive float, overflow the greatest one.
    pub fn to_f64(&self) -> f64 {
        let (mantissa, exponent) = self.approximate();
        // The approximation gives a first guess; exact comparisons decide.
        let mut below = truncate(&mantissa, exponent).min(f64::MAX);
        while self.compare(below) == Ordering::Less {
            below = below.next_down();
        }
        while below < f64::MAX && self.compare(below.next_up()) != Ordering::Less {
            below = below.next_up();
        }
        if below == f64::MAX {
            return below;
        }
        // The middle between the two neighbours, which has one bit more.
        let (mantissa, exponent) = significand(below);
        let middle = IBig::from(2 * mantissa + 1);
        let up = match self.compare_dyadic(&middle, exponent - 1) {
            Ordering::Less => false,
            Ordering::Greater => true,
            Ordering::Equal => mantissa % 2 == 1,
        };
        let rounded = if up { below.next_up() } else { below };
        rounded.clamp(f64::from_bits(1), f64::MAX)
    }

    /// Returns the exponent of the unit in the last place of a number that is about
    /// mantissa · 2^exponent: of the spacing of floats around it.
    fn ulp_exponent((mantissa, exponent): &(UBig, i64)) -> i64 {
        (exponent + mantissa.bit_len() as i64 - 53).max(-1074)
    }

    /// Returns the unit in the last place of this number.
    pub(in crate::measure) fn ulp(&self) -> f64 {
        truncate(&UBig::ONE, Self::ulp_exponent(&self.approximate()))
    }

    /// Returns the distance from `x`, in units in the last place of this number (the spacing of
    /// floats around it), to about 15 digits.
    ///
    /// # Panics
    /// When `x` is not finite.
    pub fn ulps_from(&self, x: f64) -> f64 {
        let approximation = self.approximate();
        let ulp = Self::ulp_exponent(&approximation);
        let (mantissa, exponent) = approximation;
        // Both numbers in units of the smaller power of two.
        let (x, x_exponent) = decode(x);
        let low = exponent.min(if x == 0 { exponent } else { x_exponent });
        let shift = if x == 0 { 0 } else { (x_exponent - low) as usize };
        let difference =
            (IBig::from(x) << shift) - (IBig::from(mantissa) << (exponent - low) as usize);
        truncate(&difference.unsigned_abs(), low - ulp)
    }
}

/// Returns mantissa · 2^exponent, truncated to 53 bits; at most `f64::MAX`.
pub(super) fn truncate(mantissa: &UBig, exponent: i64) -> f64 {
    let bits = mantissa.bit_len() as i64;
    if bits == 0 {
        return 0.0;
    }
    // The exponent of the last of these bits.
    let last = (exponent + bits - 53).max(-1074);
    if last > 971 {
        return f64::MAX;
    }
    let shift = last - exponent;
    let bits = if shift >= 0 { mantissa >> shift as usize } else { mantissa << -shift as usize };
    let bits = u64::try_from(bits).unwrap_or(u64::MAX);
    if bits < 1 << 52 {
        return f64::from_bits(bits); // Subnormal: last is -1074.
    }
    f64::from_bits(((last + 1075) as u64) << 52 | (bits & ((1 << 52) - 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quotient(n: i64, d: i64, exponent: i64) -> ExactNumber {
        ExactNumber::quotient(IBig::from(n), IBig::from(d), exponent)
    }

    fn root(rational: IBig, root: Sign, radicand: UBig) -> ExactNumber {
        ExactNumber { rational, root, radicand, denominator: IBig::from(1), exponent: 0 }
    }

    #[test]
    fn quotients_round_as_the_processor_rounds() {
        for (n, d) in [(1, 3), (2, 3), (10, 7), (1, 1 << 40), (i64::MAX >> 11, 3), (-5, -9)] {
            assert_eq!(quotient(n, d, 0).to_f64(), n as f64 / d as f64, "{n} / {d}");
        }
    }

    #[test]
    fn square_root_rounds_as_the_processor_rounds() {
        for n in [2u64, 3, 5, 1 << 50, (1 << 53) - 1] {
            let root = root(IBig::ZERO, Sign::Positive, UBig::from(n));
            assert_eq!(root.to_f64(), (n as f64).sqrt(), "{n}");
        }
    }

    #[test]
    fn ties_go_to_even() {
        let (one, even) = ((1 << 53) + 1, 1i64 << 53);
        assert_eq!(quotient(one, 1, 0).to_f64(), even as f64);
        assert_eq!(quotient(one + 2, 1, 0).to_f64(), (even + 4) as f64);
    }

    #[test]
    fn a_tie_missed_by_a_hair_goes_to_the_nearer() {
        // 1 + 2^-53 ± 2^-200.
        let tie = (IBig::from(1) << 200) + (IBig::from(1) << 147);
        let number = |n: IBig| ExactNumber::quotient(n, IBig::from(1), -200).to_f64();
        assert_eq!(number(tie.clone()), 1.0);
        assert_eq!(number(tie.clone() - IBig::from(1)), 1.0);
        assert_eq!(number(tie + IBig::from(1)), 1.0 + f64::EPSILON);
    }

    #[test]
    fn cancelling_root_keeps_its_digits() {
        // 10^17 − √(10^34 − 1) = 5·10^-18 (1 + 2.5·10^-35 …).
        let p = IBig::from(10u64).pow(17);
        let q = (&p * &p - IBig::from(1)).unsigned_abs();
        let root = root(p, Sign::Negative, q);
        assert_eq!(root.to_f64(), 5e-18);
    }

    #[test]
    fn too_small_and_too_large_stay_positive_and_finite() {
        assert_eq!(quotient(1, 3, -2000).to_f64(), f64::from_bits(1));
        assert_eq!(quotient(1, 3, 2000).to_f64(), f64::MAX);
        assert_eq!(quotient(3, 1, -1075).to_f64(), f64::from_bits(2));
    }

    #[test]
    fn ulps_are_counted_from_the_exact_value() {
        let third = quotient(1, 3, 0);
        let near = 1.0 / 3.0;
        assert!((third.ulps_from(near) - 1.0 / 3.0).abs() < 1e-12);
        assert!((third.ulps_from(f64::next_up(near)) - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!(quotient(1, 1, 0).ulps_from(1.0 + 5.0 * f64::EPSILON), 5.0);
    }

    #[test]
    fn two_numbers_compare_exactly_where_they_round_alike() {
        let root = |p: i64, sign, q: u64, a: i64, k| ExactNumber {
            rational: IBig::from(p),
            root: sign,
            radicand: UBig::from(q),
            denominator: IBig::from(a),
            exponent: k,
        };
        let (plus, minus) = (Sign::Positive, Sign::Negative);
        let pairs = [
            (root(0, plus, 8, 2, 0), root(0, plus, 2, 1, 0), Ordering::Equal),
            (root(0, plus, 8, 1, -1), root(0, plus, 2, 1, 0), Ordering::Equal),
            (root(3, minus, 4, 1, 0), root(7, plus, 0, 7, 0), Ordering::Equal),
            (root(5, minus, 24, 1, 0), root(10, minus, 96, 2, 0), Ordering::Equal),
            (quotient(1 << 60, (1 << 60) + 1, 0), quotient(1, 1, 0), Ordering::Less),
            (root(0, plus, (1 << 62) + 1, 1, 0), quotient(1 << 31, 1, 0), Ordering::Greater),
            (
                root(1 << 40, minus, 1 << 62, 1, 0),
                root(1 << 40, minus, (1 << 62) + 1, 1, 0),
                Ordering::Greater,
            ),
        ];
        for (a, b, order) in pairs {
            assert_eq!(
                (a.compare_with(&b), b.compare_with(&a)),
                (order, order.reverse()),
                "{a:?} {b:?}"
            );
        }
    }

    #[test]
    fn comparison_sees_what_rounding_hides() {
        let third = quotient(1, 3, 0);
        assert_eq!(third.compare(1.0 / 3.0), Ordering::Greater);
        assert_eq!(third.compare(f64::INFINITY), Ordering::Less);
        assert_eq!(third.compare(0.0), Ordering::Greater);
        assert_eq!(quotient(1, 2, 0).compare(0.5), Ordering::Equal);
    }
}
