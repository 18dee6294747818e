//! Exact rational numbers: decimals of files, floats, and affine transforms of them.

use dashu_int::{IBig, Sign, UBig};
use dashu_ratio::RBig;

use crate::measure::oracle::ExactNumber;

/// A vector of exact numbers.
pub type Vector = [RBig; 3];

/// Returns the exact value of a decimal such as `-12.5e-3`; none if it is none, or has an exponent of
/// more than three digits.
pub fn decimal(text: &str) -> Option<RBig> {
    let (number, exponent) = match text.split_once(['e', 'E']) {
        Some((number, exponent)) => (number, exponent.parse::<i16>().ok()?),
        None => (text, 0),
    };
    if exponent.unsigned_abs() > 999 {
        return None;
    }
    let (sign, digits) = match number.strip_prefix('-') {
        Some(digits) => (Sign::Negative, digits),
        None => (Sign::Positive, number.strip_prefix('+').unwrap_or(number)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let all = format!("{whole}{fraction}");
    if all.is_empty() || !all.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let mantissa = IBig::from_parts(sign, UBig::from_str_radix(&all, 10).ok()?);
    let power = i64::from(exponent) - fraction.len() as i64;
    let ten = UBig::from(10u8).pow(power.unsigned_abs() as usize);
    Some(if power < 0 {
        RBig::from_parts(mantissa, ten)
    } else {
        RBig::from(mantissa * IBig::from(ten))
    })
}

/// Returns the exact value of a float; none if it is not finite.
pub fn float(x: f64) -> Option<RBig> {
    RBig::try_from(x).ok()
}

/// Returns the exact coordinates of a vector of floats; none if one is not finite.
pub fn floats(v: [f64; 3]) -> Option<Vector> {
    let [x, y, z] = v.map(float);
    Some([x?, y?, z?])
}

/// Returns the float nearest to a number.
pub fn nearest(x: &RBig) -> f64 {
    let rounded = |x: &RBig| {
        ExactNumber::quotient(x.numerator().clone(), x.denominator().clone().into(), 0).to_f64()
    };
    match x.numerator() {
        n if n.is_zero() => 0.0,
        n if n.sign() == Sign::Negative => -rounded(&-x.clone()),
        _ => rounded(x),
    }
}

/// Returns a · b.
pub fn dot(a: &Vector, b: &Vector) -> RBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Returns a − b.
pub fn sub(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

/// Returns a × b.
pub fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}

/// An affine transform: the three columns of its matrix, and the translation.
#[derive(Clone, Debug)]
pub struct Affine {
    pub columns: [Vector; 3],
    pub translation: Vector,
}

impl Affine {
    /// Returns the transform that changes nothing.
    pub fn identity() -> Self {
        let column = |i: usize| std::array::from_fn(|j| RBig::from(u8::from(i == j)));
        Self { columns: [0, 1, 2].map(column), translation: [RBig::ZERO; 3] }
    }

    /// Returns the product of the matrix with a vector.
    pub fn turn(&self, v: &Vector) -> Vector {
        let [x, y, z] = &self.columns;
        std::array::from_fn(|i| &x[i] * &v[0] + &y[i] * &v[1] + &z[i] * &v[2])
    }

    /// Returns the transform of a point.
    pub fn point(&self, p: &Vector) -> Vector {
        let turned = self.turn(p);
        std::array::from_fn(|i| &turned[i] + &self.translation[i])
    }

    /// Returns the transform that does `first` before this one.
    pub fn after(&self, first: &Self) -> Self {
        Self {
            columns: [0, 1, 2].map(|i| self.turn(&first.columns[i])),
            translation: self.point(&first.translation),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact_and_round_as_the_standard_library_does() {
        for text in
            ["0.1", "-5412345.75", "1e-30", "+12.5E+3", "7.", ".5", "0", "123456789.987654321"]
        {
            assert_eq!(nearest(&decimal(text).unwrap()), text.parse::<f64>().unwrap(), "{text}");
        }
        assert_eq!(decimal("0.1").unwrap() * RBig::from(10u8), RBig::ONE);
        for text in ["", ".", "-", "1e", "1e9999", "0x10", "nan", "1_0"] {
            assert_eq!(decimal(text), None, "{text}");
        }
    }

    #[test]
    fn transforms_are_applied_from_the_right() {
        let three = |x: i8| [RBig::from(x), RBig::from(x), RBig::from(x)];
        let mut double = Affine::identity();
        double.columns = double.columns.map(|c| c.map(|x| x * RBig::from(2u8)));
        let shift = Affine { translation: three(1), ..Affine::identity() };
        assert_eq!(shift.after(&double).point(&three(5)), three(11));
        assert_eq!(double.after(&shift).point(&three(5)), three(12));
    }
}
