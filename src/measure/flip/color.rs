//! The colour spaces of FLIP, from linear Rec. 709 in \[0, 1\]: YCxCz, in which the eye's
//! resolution is known, and L\*a\*b\*, in which perceived distances are known.

use glam::{Mat3, Vec3};

/// The matrix from linear Rec. 709 to XYZ, by the exact chromaticities of ITU-R BT.709 and D65.
const TO_XYZ: Mat3 = Mat3::from_cols(
    Vec3::new(10_135_552.0 / 24_577_794.0, 2_613_072.0 / 12_288_897.0, 1_425_312.0 / 73_733_382.0),
    Vec3::new(8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0),
    Vec3::new(4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0),
);

/// Returns XYZ relative to white.
fn relative_xyz(linear: Vec3) -> Vec3 {
    TO_XYZ * linear / (TO_XYZ * Vec3::ONE)
}

/// Returns YCxCz, the linearised L\*a\*b\*.
pub fn linear_to_ycxcz(linear: Vec3) -> Vec3 {
    let Vec3 { x, y, z } = relative_xyz(linear);
    Vec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

/// Returns linear Rec. 709: the inverse of [`linear_to_ycxcz`].
pub fn ycxcz_to_linear(color: Vec3) -> Vec3 {
    let y = (color.x + 16.0) / 116.0;
    let xyz = Vec3::new(y + color.y / 500.0, y, y - color.z / 200.0);
    TO_XYZ.inverse() * (xyz * (TO_XYZ * Vec3::ONE))
}

/// Returns the L\*a\*b\* (CIE 1976) of a linear colour, with a\* and b\* in proportion to L\*: the
/// darker a colour is, the less colourful it looks (the Hunt effect).
pub fn linear_to_hunt_lab(linear: Vec3) -> Vec3 {
    const DELTA: f32 = 6.0 / 29.0;
    let f = |t: f32| {
        if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [x, y, z] = relative_xyz(linear).to_array().map(f);
    let lightness = 116.0 * y - 16.0;
    let colorfulness = 0.01 * lightness;
    Vec3::new(lightness, 500.0 * (x - y) * colorfulness, 200.0 * (y - z) * colorfulness)
}

/// Returns the HyAB distance of two colours in L\*a\*b\*: the difference of the lightnesses, plus the
/// Euclidean distance of the rest (Abasi, Amani Tehran, Fairchild, *Distance metrics for very large color differences*).
pub fn hyab_distance(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}
