//! The power in Phong's highlight.

/// Above this, exponents are left to the library.
const GREATEST: f32 = 1024.0;

/// `x`^`exponent` for `x` in \[0, 1\] and an exponent of at least 0.
///
/// Whole exponents up to 1024, which nearly all are, take products of squares: of n factors with an
/// error of at most half an ulp each, the error is less than n ulp, which is below 1e-12 relative.
#[inline]
pub fn power(x: f64, exponent: f32) -> f64 {
    match integer_exponent(exponent) {
        Some(exponent) => power16([x], exponent)[0],
        None => x.powf(f64::from(exponent)),
    }
}

/// The exponent as a number of factors, if it is whole and not too great.
#[inline(always)]
pub fn integer_exponent(exponent: f32) -> Option<u32> {
    ((0.0..=GREATEST).contains(&exponent) && exponent.fract() == 0.0).then_some(exponent as u32)
}

/// Many numbers to one whole power.
#[inline(always)]
pub fn power16<const N: usize>(mut x: [f64; N], mut exponent: u32) -> [f64; N] {
    let mut product = [1.0; N];
    loop {
        if exponent & 1 != 0 {
            for i in 0..N {
                product[i] *= x[i];
            }
        }
        exponent >>= 1;
        if exponent == 0 {
            return product;
        }
        for i in 0..N {
            x[i] *= x[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn whole_powers_agree_with_the_library(x in 0.0..=1.0f64, exponent in 0u32..=1024) {
            let expected = x.powi(exponent as i32);
            let got = power(x, exponent as f32);
            // Below the least normal number there are fewer digits.
            prop_assert!((got - expected).abs() <= 1e-12 * expected + 1e-300, "{got:e} {expected:e}");
        }

        #[test]
        fn other_powers_are_the_librarys(x in 0.0..=1.0f64, exponent in 0.0f32..2000.0) {
            prop_assume!(integer_exponent(exponent).is_none());
            prop_assert_eq!(power(x, exponent), x.powf(f64::from(exponent)));
        }
    }

    #[test]
    fn nothing_to_the_power_of_nothing_is_one() {
        assert_eq!((power(0.0, 0.0), power(0.0, 3.0), power(1.0, 1024.0)), (1.0, 0.0, 1.0));
    }
}
