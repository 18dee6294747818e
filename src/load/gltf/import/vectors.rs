//! Vectors and rotations of a file, which stores f32, in f64.

use glam::{DQuat, DVec3};

/// Returns a vector of a file in f64.
pub fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// Returns a rotation of a file in f64 and of length 1, from which f32 rounding makes it differ a
/// little, so that it would shear; `None` if its length is 0.
pub fn unit_quaternion(q: [f32; 4]) -> Option<DQuat> {
    let rotation = DQuat::from_array(q.map(f64::from));
    let length = rotation.length();
    (length > 0.0).then(|| rotation / length)
}
