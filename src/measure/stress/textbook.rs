//! The textbook formula for ray and sphere, b² − 4ac without any care for rounding: a baseline that
//! shows the errors that the other formulas avoid.

use glam::{DVec3, Vec3};

use crate::geometry::Ray;

/// Returns the first t with 0 < t < `ray.tmax`, computed in f64.
pub fn sphere(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    let from_center = ray.origin - center;
    let a = ray.direction.dot(ray.direction);
    let b = 2.0 * from_center.dot(ray.direction);
    let c = from_center.dot(from_center) - radius * radius;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let (near, far) = ((-b - root) / (2.0 * a), (-b + root) / (2.0 * a));
    let t = if near > 0.0 { near } else { far };
    (t > 0.0 && t < ray.tmax).then_some(t)
}

/// Returns the first t > 0, computed in f32 from arguments rounded to f32.
pub fn sphere_f32(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    let from_center: Vec3 = ray.origin.as_vec3() - center.as_vec3();
    let direction: Vec3 = ray.direction.as_vec3();
    let a = direction.dot(direction);
    let b = 2.0 * from_center.dot(direction);
    let c = from_center.dot(from_center) - (radius * radius) as f32;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let (near, far) = ((-b - root) / (2.0 * a), (-b + root) / (2.0 * a));
    let t = if near > 0.0 { near } else { far };
    (t > 0.0).then_some(f64::from(t))
}
