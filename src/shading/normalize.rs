//! Normalization of vectors without the square roots and divisions of f64, which take as long as
//! the rest of direct lighting.

use glam::DVec3;

/// The range of squared lengths in which the guess and its refinement keep their digits.
const LEAST: f64 = 1.0 / GREATEST;
const GREATEST: f64 = (1u128 << 100) as f64;

/// Returns 1/√x.
#[inline]
fn inverse_root(x: f64) -> f64 {
    if is_in_range(x) { refined(x) } else { 1.0 / x.sqrt() }
}

#[inline(always)]
fn is_in_range(x: f64) -> bool {
    (LEAST < x) & (x < GREATEST)
}

/// Returns 1/√x for an x in range.
#[inline(always)]
fn refined(x: f64) -> f64 {
    let y = f64::from(1.0 / (x as f32).sqrt());
    y * (1.5 - (0.5 * x) * (y * y))
}

/// Normalizes vectors that are stored side by side, axis by axis: the result has length 1 to within
/// 1e-13. Vectors that are zero or not active may become anything.
///
/// By one step of Newton's method for 1/√x from a first guess y in f32, y (3 − x y²) / 2: a guess
/// with a relative error e becomes one with 3 e²/2, and three roundings in f32 make e less than
/// 1.8e-7.
#[inline(always)]
pub fn normalize16<const N: usize>(v: &[[f64; N]; 3], is_active: &[bool; N]) -> [[f64; N]; 3] {
    let (mut square, mut factor, mut out_of_range) = ([0.0; N], [0.0; N], [0u64; N]);
    for i in 0..N {
        square[i] = DVec3::new(v[0][i], v[1][i], v[2][i]).length_squared();
        factor[i] = refined(square[i]);
        out_of_range[i] = u64::from(is_active[i] & !is_in_range(square[i]));
    }
    if out_of_range.iter().fold(0, |all, one| all | one) != 0 {
        factor = square.map(inverse_root);
    }
    let mut unit = *v;
    for axis in 0..3 {
        for i in 0..N {
            unit[axis][i] *= factor[i];
        }
    }
    unit
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn normalize(v: DVec3) -> DVec3 {
        normalize16(&v.to_array().map(|x| [x]), &[true]).map(|[x]| x).into()
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
            let all = normalize16::<16>(&side_by_side, &[true; 16]);
            for (i, &v) in v.iter().enumerate() {
                prop_assert_eq!(DVec3::new(all[0][i], all[1][i], all[2][i]), normalize(v));
            }
        }
    }
}
