//! Rays without a picture: what a range finder on a planet would measure, by each backend.
//!
//! The origin is a planet's radius away, where f32 can no longer tell half a metre.
//!
//! `cargo run --release --example rays`

use envers::{
    Backend, Bvh, Coherence, Intersector, Material, Precision, Ray, Result, Scene, Sphere,
};
use glam::DVec3;

fn main() -> Result<()> {
    let mut scene = Scene::default();
    let rock = scene.add_material(Material::default());
    let radius = 6.371e6;
    scene.spheres.push(Sphere::new(DVec3::ZERO, radius, rock));
    scene.spheres.push(Sphere::new(DVec3::Y * (radius + 0.25), 0.25, rock));
    scene.check()?;

    let eye = DVec3::new(-10.0, radius + 2.0, 0.0);
    let rays: Vec<Ray> = (0..5)
        .map(|i| Ray::new(eye, DVec3::new(10.0, -2.0 + 0.125 * f64::from(i), 0.0).normalize()))
        .collect();
    let backends: [Box<dyn Intersector>; 2] = [
        Backend::default().build(&scene, Precision::Fast, 0)?,
        Box::new(Bvh::build(&scene, Precision::Fast)),
    ];
    for backend in backends {
        let mut hits = vec![None; rays.len()];
        backend.closest(&rays, Coherence::Coherent, &mut hits);
        println!("{} {}", backend.name(), backend.version());
        for hit in hits {
            match hit {
                Some(hit) => println!("  {:.15} m, sphere {}", hit.t, hit.id.primitive),
                None => println!("  nothing"),
            }
        }
    }
    Ok(())
}
