//! Vectors and rotations of a file in f64.

use glam::{DQuat, DVec3};

/// Returns a vector of a file in f64.
pub fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// Returns a rotation of a file at length 1, from which rounding makes it differ a little, so that it
/// would shear; `None` if its length is 0.
pub fn unit_quaternion(q: [f64; 4]) -> Option<DQuat> {
    let rotation = DQuat::from_array(q);
    let length = rotation.length();
    (length > 0.0).then(|| rotation / length)
}
