//! The filters of decompressed attributes (appendix B).

use std::f32::consts::FRAC_1_SQRT_2;

/// Decodes octahedral unit vectors, each of four numbers of 8 or 16 bits, in place.
pub fn octahedral(bytes: &mut [u8], stride: usize) {
    for element in bytes.chunks_exact_mut(stride) {
        if let Ok(four) = <&mut [u8; 4]>::try_from(&mut *element) {
            let [x, y, one, _] = four.map(|b| f32::from(b as i8));
            let unit = unfold(x / one, y / one).map(|v| (v * 127.0).round() as i8 as u8);
            four[..3].copy_from_slice(&unit);
        } else if let Ok(eight) = <&mut [u8; 8]>::try_from(&mut *element) {
            let [x, y, one, _] = components(eight).map(f32::from);
            let unit = unfold(x / one, y / one).map(|v| (v * 32767.0).round() as i16);
            for (to, v) in eight.chunks_exact_mut(2).zip(unit) {
                to.copy_from_slice(&v.to_le_bytes());
            }
        }
    }
}

/// Returns the unit vector of a point of the unfolded octahedron.
fn unfold(x: f32, y: f32) -> [f32; 3] {
    // The lower half of the octahedron is folded outward over the corners of the square.
    let z = 1.0 - x.abs() - y.abs();
    let t = z.min(0.0);
    let (x, y) = (x - t.abs().copysign(x), y - t.abs().copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|v| v / length)
}

/// Decodes unit quaternions that are stored without their largest component, in place.
pub fn quaternion(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [a, b, c, last] = components(element);
        let one = f32::from(last | 3);
        let [x, y, z] = [a, b, c].map(|v| f32::from(v) / one * FRAC_1_SQRT_2);
        // The component that is missing follows from the length, which is 1.
        let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let largest = usize::from(last as u16 & 3);
        for (i, v) in [w, x, y, z].into_iter().enumerate() {
            let at = 2 * ((largest + i) % 4);
            let v = (v * 32767.0).round() as i16;
            element[at..at + 2].copy_from_slice(&v.to_le_bytes());
        }
    }
}

/// Decodes floats that are stored as an integer of 24 bits and an exponent of 8, in place.
pub fn exponential(bytes: &mut [u8]) {
    for number in bytes.as_chunks_mut::<4>().0 {
        let packed = i32::from_le_bytes(*number);
        let (exponent, mantissa) = (packed >> 24, packed << 8 >> 8);
        let value = f64::from(exponent).exp2() * f64::from(mantissa);
        *number = (value as f32).to_le_bytes();
    }
}

fn components(bytes: &[u8; 8]) -> [i16; 4] {
    let [a, b, c, d, e, f, g, h] = *bytes;
    [[a, b], [c, d], [e, f], [g, h]].map(i16::from_le_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_of_both_hemispheres_unfold() {
        assert_eq!(unfold(0.0, 0.0), [0.0, 0.0, 1.0]);
        // The corner of the square is straight down.
        assert_eq!(unfold(1.0, 1.0), [0.0, 0.0, -1.0]);
        let [x, y, z] = unfold(-0.75, 0.75);
        assert!((x + y).abs() < 1e-6 && x < 0.0 && z < 0.0, "{x} {y} {z}");
    }

    #[test]
    fn quaternion_gets_its_largest_part_back() {
        // One is 0x7fff with the number of the part in its lowest bits: the fourth.
        let mut bytes = [0, 0, 0, 0, 0, 0, 0xff, 0x7f];
        quaternion(&mut bytes);
        assert_eq!(components(&bytes), [0, 0, 0, 32767]);
    }

    #[test]
    fn floats_are_a_number_times_a_power_of_two() {
        let mut bytes = [3, 0, 0, 0xff, 0xff, 0xff, 0xff, 2];
        exponential(&mut bytes);
        let floats: Vec<f32> = bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        assert_eq!(floats, [1.5, -4.0]);
    }
}
