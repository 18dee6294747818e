//! Shading models: Lambert and Phong, mirrors, and the interfaces of dielectrics. Traces nothing.

mod dielectric;
mod normalize;

use glam::{DVec3, Vec3};

pub use dielectric::{DielectricInterface, transmittance};
pub use normalize::normalize16;

/// The greatest exponent that is computed by products.
const MAX_EXPONENT: f32 = 1024.0;

/// The reflectance of a surface toward lights at one point, with its textures applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflectance {
    /// The share of light scattered to all sides.
    pub diffuse: Vec3,
    /// The share of light in the highlight.
    pub specular: Vec3,
    /// Phong's exponent, the tutorial's α.
    pub shininess: f32,
}

/// Returns Lambert's cosine n·l of the angle between a normal and the direction to a light, both of
/// length 1.
#[inline(always)]
pub fn lambert(normal: DVec3, light: DVec3) -> f64 {
    normal.dot(light)
}

/// Returns Phong's cosine max(0, r·l) of the angle between the mirrored view direction and the
/// direction to a light; all of length 1.
#[inline(always)]
pub fn phong(normal: DVec3, view: DVec3, light: DVec3) -> f64 {
    reflect(view, normal).dot(light).clamp(0.0, 1.0)
}

/// Returns the direction u − 2(u·n)n in which a mirror with unit normal `normal` sends `incoming`.
#[inline(always)]
pub fn reflect(incoming: DVec3, normal: DVec3) -> DVec3 {
    incoming - normal * (2.0 * incoming.dot(normal))
}

/// Returns `x`^`exponent` for `x` in \[0, 1\] and an exponent of at least 0.
///
/// Integer exponents up to 1024, which nearly all are, take products of squares: of n factors with an
/// error of at most half an ulp each, the error is less than n ulp, which is below 1e-12 relative.
#[inline]
pub fn power(x: f64, exponent: f32) -> f64 {
    match integer_exponent(exponent) {
        Some(exponent) => power16([x], exponent)[0],
        None => x.powf(f64::from(exponent)),
    }
}

/// Returns the exponent as a number of factors, if it is an integer of at most 1024.
#[inline(always)]
pub fn integer_exponent(exponent: f32) -> Option<u32> {
    ((0.0..=MAX_EXPONENT).contains(&exponent) && exponent.fract() == 0.0).then_some(exponent as u32)
}

/// Raises several numbers to the same integer power.
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
        fn integer_powers_agree_with_the_library(x in 0.0..=1.0f64, exponent in 0u32..=1024) {
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
    fn zero_to_the_power_of_zero_is_one() {
        assert_eq!((power(0.0, 0.0), power(0.0, 3.0), power(1.0, 1024.0)), (1.0, 0.0, 1.0));
    }
}
