//! Shading models: Lambert and Phong, mirrors, the interfaces of dielectrics, and glTF's physically based
//! materials. Traces nothing.

mod bsdf;
mod dielectric;
mod phong_bsdf;

use glam::{DVec3, Vec3};

pub use bsdf::{Bsdf, BsdfSample, LobeAlbedos, OpaqueBsdf, OpaqueBsdf16};
pub use dielectric::{DielectricInterface, indices_by_color, transmittance};
pub use phong_bsdf::PhongBsdf;

/// The greatest exponent for which a power is computed by products.
const MAX_EXPONENT: f32 = 1024.0;

/// The range of squared lengths in which normalization in f32 keeps its digits.
const MIN_SQUARE: f64 = 1.0 / MAX_SQUARE;
const MAX_SQUARE: f64 = (1u128 << 100) as f64;

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

/// Normalizes vectors that are stored side by side, axis by axis, to length 1 to within 1e-13. The
/// result for a vector that is zero or not active is undefined.
///
/// This takes no square roots and divisions of f64, which cost as much as the rest of direct lighting,
/// but one step of Newton's method for 1/√x from a first guess y in f32, y (3 − x y²) / 2: a guess
/// with a relative error e becomes one with 3 e²/2, and three roundings in f32 make e less than
/// 1.8e-7.
#[inline(always)]
pub fn normalize_lanes<const N: usize>(v: &[[f64; N]; 3], is_active: &[bool; N]) -> [[f64; N]; 3] {
    let is_in_range = |square: f64| (MIN_SQUARE < square) & (square < MAX_SQUARE);
    let (mut square, mut factor, mut out_of_range) = ([0.0; N], [0.0; N], [0u64; N]);
    for i in 0..N {
        let x = DVec3::new(v[0][i], v[1][i], v[2][i]).length_squared();
        let y = f64::from(1.0 / (x as f32).sqrt());
        square[i] = x;
        factor[i] = y * (1.5 - (0.5 * x) * (y * y));
        out_of_range[i] = u64::from(is_active[i] & !is_in_range(x));
    }
    if out_of_range.iter().fold(0, |all, one| all | one) != 0 {
        for i in (0..N).filter(|&i| !is_in_range(square[i])) {
            factor[i] = 1.0 / square[i].sqrt();
        }
    }
    let mut unit = *v;
    for axis in 0..3 {
        for i in 0..N {
            unit[axis][i] *= factor[i];
        }
    }
    unit
}

/// Returns `x`^`exponent` for `x` in \[0, 1\] and an exponent of at least 0.
///
/// Integer exponents up to 1024, which nearly all are, take products of squares: of n factors with an
/// error of at most half an ulp each, the error is less than n ulp, which is below 1e-12 relative.
#[inline]
pub fn power(x: f64, exponent: f32) -> f64 {
    match integer_exponent(exponent) {
        Some(exponent) => power_lanes([x], exponent)[0],
        None => x.powf(f64::from(exponent)),
    }
}

/// Returns the exponent as a number of factors, if it is an integer of at most 1024.
#[inline(always)]
pub fn integer_exponent(exponent: f32) -> Option<u32> {
    ((0.0..=MAX_EXPONENT).contains(&exponent) && exponent.fract() == 0.0).then_some(exponent as u32)
}

/// Raises the numbers of several lanes to the same integer power.
#[inline(always)]
pub fn power_lanes<const N: usize>(mut x: [f64; N], mut exponent: u32) -> [f64; N] {
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

    fn normalize(v: DVec3) -> DVec3 {
        normalize_lanes(&v.to_array().map(|x| [x]), &[true]).map(|[x]| x).into()
    }

    proptest! {
        #[test]
        fn normalized_vectors_have_length_1(
            v in prop::array::uniform3(-1.0..1.0f64),
            scale in -300..300i32,
        ) {
            let v = DVec3::from(v);
            prop_assume!(v.length() > 1e-3);
            let unit = normalize(v * 2f64.powi(scale));
            prop_assert!((unit.length() - 1.0).abs() < 1e-13, "{}", unit.length() - 1.0);
            prop_assert!((unit - v.normalize()).length() < 1e-13);
        }

        #[test]
        fn vectors_side_by_side_equal_those_normalized_alone(
            v in prop::array::uniform16(prop::array::uniform3(-1.0..1.0f64)),
            scale in prop::array::uniform16(-60..60i32),
        ) {
            let v: Vec<_> = v.iter().zip(scale).map(|(v, s)| DVec3::from(*v) * 2f64.powi(s)).collect();
            let side_by_side = std::array::from_fn(|axis| std::array::from_fn(|i| v[i][axis]));
            let all = normalize_lanes::<16>(&side_by_side, &[true; 16]);
            for (i, &v) in v.iter().enumerate() {
                prop_assert_eq!(DVec3::new(all[0][i], all[1][i], all[2][i]), normalize(v));
            }
        }

        #[test]
        fn integer_powers_agree_with_the_library(x in 0.0..=1.0f64, exponent in 0u32..=1024) {
            let expected = x.powi(exponent as i32);
            let got = power(x, exponent as f32);
            // Below the least normal number there are fewer digits.
            prop_assert!((got - expected).abs() <= 1e-12 * expected + 1e-300, "{got:e} {expected:e}");
        }

        #[test]
        fn other_powers_are_those_of_the_library(x in 0.0..=1.0f64, exponent in 0.0f32..2000.0) {
            prop_assume!(integer_exponent(exponent).is_none());
            prop_assert_eq!(power(x, exponent), x.powf(f64::from(exponent)));
        }
    }

    #[test]
    fn zero_to_the_power_of_zero_is_one() {
        assert_eq!((power(0.0, 0.0), power(0.0, 3.0), power(1.0, 1024.0)), (1.0, 0.0, 1.0));
    }
}
