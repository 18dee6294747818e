//! The reference arithmetic of the tests: exact sums and products of floats, and rounding by
//! bisection. It shares only the big integers with the certified functions that it checks.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use glam::DVec3;
use num_bigint::{BigInt, Sign};

/// A dyadic rational, m · 2ᵉ.
#[derive(Clone, Debug)]
pub struct Dyadic {
    m: BigInt,
    e: i64,
}

impl Dyadic {
    pub fn new(x: f64) -> Self {
        // 2¹⁰⁷⁴ x is an integer, which the bits spell.
        let bits = x.to_bits();
        let (field, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
        let m = if field == 0 { fraction } else { fraction + (1 << 52) };
        let m = BigInt::from(m);
        Self { m: if x < 0.0 { -m } else { m }, e: field.max(1) - 1075 }
    }

    pub fn power_of_two(e: i64) -> Self {
        Self { m: BigInt::from(1), e }
    }

    pub fn sign(&self) -> Ordering {
        match self.m.sign() {
            Sign::Minus => Ordering::Less,
            Sign::NoSign => Ordering::Equal,
            Sign::Plus => Ordering::Greater,
        }
    }

    pub fn cmp(&self, other: &Self) -> Ordering {
        (self.clone() - other.clone()).sign()
    }
}

impl Add for Dyadic {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let e = self.e.min(other.e);
        Self { m: (self.m << (self.e - e)) + (other.m << (other.e - e)), e }
    }
}

impl Sub for Dyadic {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self { m: -other.m, e: other.e }
    }
}

impl Mul for Dyadic {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { m: self.m * other.m, e: self.e + other.e }
    }
}

pub type Vector = [Dyadic; 3];

pub fn vector(v: DVec3) -> Vector {
    v.to_array().map(Dyadic::new)
}

pub fn zip(a: &Vector, b: &Vector, f: impl Fn(Dyadic, Dyadic) -> Dyadic) -> Vector {
    [0, 1, 2].map(|i| f(a[i].clone(), b[i].clone()))
}

pub fn dot(a: &Vector, b: &Vector) -> Dyadic {
    let [x, y, z] = zip(a, b, |x, y| x * y);
    x + y + z
}

/// The determinant of the matrix with rows a, b and c.
pub fn determinant(a: &Vector, b: &Vector, c: &Vector) -> Dyadic {
    let minor = |i: usize, j: usize| b[i].clone() * c[j].clone() - b[j].clone() * c[i].clone();
    dot(a, &[minor(1, 2), minor(2, 0), minor(0, 1)])
}

/// Returns the f64 nearest to a positive number, ties to even, but neither 0 nor infinity. The
/// number is given by `compare`, which compares it with its argument.
pub fn round(compare: impl Fn(&Dyadic) -> Ordering) -> f64 {
    let (mut low, mut high) = (0u64, f64::MAX.to_bits() + 1);
    // The number is at least the float with the bits `low` and below that with the bits `high`.
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        match compare(&Dyadic::new(f64::from_bits(middle))) {
            Ordering::Less => high = middle,
            _ => low = middle,
        }
    }
    if high > f64::MAX.to_bits() {
        return f64::MAX;
    }
    let sum = Dyadic::new(f64::from_bits(low)) + Dyadic::new(f64::from_bits(high));
    let up = match compare(&(sum * Dyadic::power_of_two(-1))) {
        Ordering::Greater => true,
        Ordering::Equal => low & 1 == 1,
        Ordering::Less => false,
    };
    f64::from_bits(if up || low == 0 { high } else { low })
}
