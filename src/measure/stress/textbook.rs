//! The textbook formula for ray and sphere, b² − 4ac without any care for rounding: a baseline that
//! shows the errors that the other formulas avoid.

use glam::{DVec3, Vec3};
use num_traits::Float;

use crate::geometry::Ray;

/// Returns the first t with 0 < t < `ray.tmax`, computed in f64.
pub fn sphere(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    let from_center = ray.origin - center;
    let a = ray.direction.dot(ray.direction);
    let b = 2.0 * from_center.dot(ray.direction);
    let c = from_center.dot(from_center) - radius * radius;
    first_root(a, b, c).filter(|t| *t < ray.tmax)
}

/// Returns the first t > 0, computed in f32 from arguments rounded to f32.
pub fn sphere_f32(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    let from_center: Vec3 = ray.origin.as_vec3() - center.as_vec3();
    let direction: Vec3 = ray.direction.as_vec3();
    let a = direction.dot(direction);
    let b = 2.0 * from_center.dot(direction);
    let c = from_center.dot(from_center) - (radius * radius) as f32;
    first_root(a, b, c).map(f64::from)
}

/// Returns the first root above 0 of a t² + b t + c, in the arithmetic of the coefficients.
fn first_root<F: Float>(a: F, b: F, c: F) -> Option<F> {
    let two = F::one() + F::one();
    let discriminant = b * b - two * two * a * c;
    if discriminant < F::zero() {
        return None;
    }
    let root = discriminant.sqrt();
    let (near, far) = ((-b - root) / (two * a), (-b + root) / (two * a));
    Some(if near > F::zero() { near } else { far }).filter(|t| *t > F::zero())
}
