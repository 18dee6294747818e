//! The sampling of lights: directions and points that are spread by a known density, from points of
//! the unit square.
//!
//! Everything is a pure function in f64, so that a fixed set of points gives a picture without noise
//! and random ones an unbiased estimate.

mod cone;
mod disk;
mod low_discrepancy;
mod rectangle;

pub use cone::Cone;
pub use disk::{concentric_disk, disk_point};
pub use low_discrepancy::{sobol_point, triangle_weights};
pub use rectangle::SphericalRectangle;

use glam::DVec3;

/// Two unit vectors that form a right-handed orthonormal basis with `normal`, of length 1 (Duff et al.,
/// *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017).
pub fn tangents(normal: DVec3) -> [DVec3; 2] {
    let DVec3 { x, y, z } = normal;
    let sign = 1f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [DVec3::new(1.0 + sign * x * x * a, sign * b, -sign * x), DVec3::new(b, sign + y * y * a, -y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_and_normal_are_a_right_handed_basis() {
        for normal in [DVec3::Z, -DVec3::Z, DVec3::X, -DVec3::Y, DVec3::new(0.48, -0.6, 0.64)] {
            let [a, b] = tangents(normal);
            assert!((a.cross(b) - normal).length() < 1e-15, "{normal}");
            assert!((a.length() - 1.0).abs() < 1e-15 && a.dot(normal).abs() < 1e-15, "{normal}");
        }
    }
}
