//! The debug views: pictures of hits instead of radiance.

use glam::Vec3;

use crate::film::View;
use crate::geometry::{Geometry, Hit, LANES, Ray};
use crate::integrator::radiance::{DARK, Radiance16, set_lane};
use crate::integrator::wave::Wave;
use crate::scene::Scene;
use crate::surface::Surface;

/// Sets the pixels of a tile to the values of a debug view.
pub(super) fn set_pixels(scene: &Scene, view: View, wave: &Wave, pixels: &mut Vec<Radiance16>) {
    pixels.resize(wave.rays.blocks().len(), DARK);
    for i in 0..wave.rays.len() {
        let value = pixel_value(scene, view, &wave.rays.ray(i), wave.hits.get(i).as_ref());
        set_lane(&mut pixels[i / LANES], i % LANES, value);
    }
}

/// Returns the value of a debug view for one camera ray.
fn pixel_value(scene: &Scene, view: View, ray: &Ray, hit: Option<&Hit>) -> Vec3 {
    match (view, hit) {
        (View::Depth, None) => Vec3::INFINITY,
        (_, None) | (View::Beauty, _) => Vec3::ZERO,
        (View::Normal, Some(hit)) => Surface::new(scene, ray, hit).normal.as_vec3(),
        (View::Depth, Some(hit)) => {
            // A hit has a finite depth, also beyond f32: infinity means that there is none.
            Vec3::splat((hit.t * ray.direction.length()).min(f64::from(f32::MAX)) as f32)
        }
        (View::Id, Some(hit)) => {
            let geometry = match hit.id.geometry {
                Geometry::Spheres => 1.0,
                Geometry::Planes => 2.0,
                Geometry::Mesh(i) => 3.0 + i as f32,
            };
            Vec3::new(geometry, hit.id.primitive as f32, hit.id.instance as f32)
        }
    }
}
