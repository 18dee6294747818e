//! The tutorial's formula, b² − 4ac, as it stands: to show beside the others what it loses.

use glam::{DVec3, Vec3};

use crate::geometry::Ray;

/// The first t with 0 < t < `ray.tmax`, in f64.
pub fn sphere(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    let from = ray.origin - center;
    let a = ray.direction.dot(ray.direction);
    let b = 2.0 * from.dot(ray.direction);
    let c = from.dot(from) - radius * radius;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let (near, far) = ((-b - root) / (2.0 * a), (-b + root) / (2.0 * a));
    let t = if near > 0.0 { near } else { far };
    (t > 0.0 && t < ray.tmax).then_some(t)
}

/// The first t > 0, in f32; what is given is rounded to f32 first.
pub fn sphere_f32(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    let (from, direction): (Vec3, Vec3) =
        (ray.origin.as_vec3() - center.as_vec3(), ray.direction.as_vec3());
    let a = direction.dot(direction);
    let b = 2.0 * from.dot(direction);
    let c = from.dot(from) - (radius * radius) as f32;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let (near, far) = ((-b - root) / (2.0 * a), (-b + root) / (2.0 * a));
    let t = if near > 0.0 { near } else { far };
    (t > 0.0).then_some(f64::from(t))
}
