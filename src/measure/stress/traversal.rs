//! G3: the traversal of a BVH finds the same hits as brute force, to the bit.

use glam::{DAffine3, DVec3};

use super::backends::{intersector_names, intersectors};
use super::meshes::{icosphere, torus};
use super::{case::Case, random::Random};
use crate::geometry::Ray;
use crate::intersect::{BruteForce, Coherence::Incoherent, Precision};
use crate::measure::trace::{closest, occluded, ulps_between};
use crate::scene::{Instance, Material, Plane, Scene, Sphere};

/// The distances of the scene from the world's origin.
const OFFSETS: [f64; 4] = [0.0, 1e3, 1e5, 1e7];
/// Half the side of the cube that contains the scene.
const SIZE: f64 = 4.0;

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (precision, meshes, what) in [
        (Precision::Certified, false, "spheres"),
        (Precision::Certified, true, "spheres, planes, instances"),
        (Precision::Fast, false, "spheres"),
    ] {
        for (offset, tangent) in OFFSETS.into_iter().flat_map(|o| [(o, false), (o, true)]) {
            let rays = if tangent { "axis-tangent" } else { "random" };
            let name = format!("{what}, {rays} rays, offset {offset:.0e}");
            let method = format!("{}, {}", precision.name(), intersector_names());
            cases.push(Case::new(name, method, move |sampler| {
                let center = DVec3::new(offset, -0.7 * offset, 0.3 * offset);
                let scene = scene(center, meshes, &mut sampler.shared_random());
                let brute = BruteForce::new(&scene, precision);
                let intersectors = intersectors(&scene, precision)?;
                // Closest hits and occlusion of each batch of rays, by brute force and by each tree.
                let ray = |random: &mut Random| sample_ray(&scene, center, tangent, random);
                Ok(sampler.for_each_batch(ray, |rays, stats| {
                    let expected = closest(&brute, rays, Incoherent);
                    let expected_occlusion = occluded(&brute, rays, Incoherent);
                    for intersector in &intersectors {
                        let found = closest(&**intersector, rays, Incoherent);
                        for (found, expected) in found.iter().zip(&expected) {
                            match (found, expected) {
                                (Some(a), Some(b)) if a.id == b.id => {
                                    stats.count_ulp(ulps_between(a.t, b.t) as f64);
                                }
                                (a, b) => stats.count_wrong(a.is_some() || b.is_some()),
                            }
                        }
                        let found = occluded(&**intersector, rays, Incoherent);
                        stats.count_different(&found, &expected_occlusion);
                    }
                }))
            }));
        }
    }
    cases
}

/// Returns a scene of spheres and, if asked for, planes and meshes.
fn scene(center: DVec3, has_meshes: bool, random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    // Spheres of very different sizes.
    for _ in 0..60 {
        let radius = random.power_of_ten(-3.0, 0.0);
        scene.spheres.push(Sphere::new(center + random.in_ball() * SIZE, radius, material));
    }
    // Two planes, a mesh with one instance and one with several.
    if has_meshes {
        for _ in 0..2 {
            let point = center + random.in_ball() * SIZE;
            scene.planes.push(Plane::new(point, random.direction(), material));
        }
        let single = scene.add_mesh(torus(6, 5));
        let many = scene.add_mesh(icosphere(0));
        for mesh in [single, many, many, many] {
            let stretch = DVec3::from_array(std::array::from_fn(|_| random.range(0.3, 1.5)));
            let place = center + random.in_ball() * SIZE;
            let transform =
                DAffine3::from_scale_rotation_translation(stretch, random.rotation(), place);
            scene.instances.push(Instance::new(mesh, transform, material));
        }
    }
    scene
}

/// Returns a random ray through the scene, or one parallel to an axis that is a tangent of a sphere.
fn sample_ray(scene: &Scene, center: DVec3, tangent: bool, random: &mut Random) -> Ray {
    let length = random.power_of_ten(-3.0, 3.0);
    let ray = if tangent {
        // A ray beside a sphere at exactly its radius, starting at the point of contact or before it.
        let sphere = random.pick(&scene.spheres);
        let axis = random.below(3);
        let (along, across) = (DVec3::AXES[axis], DVec3::AXES[(axis + 1 + random.below(2)) % 3]);
        let side = random.pick(&[1.0, -1.0]);
        let back = if random.coin() { -along } else { along } * SIZE * random.range(0.5, 3.0);
        let origin = sphere.center + across * (side * sphere.radius) + back;
        Ray::new(origin, -back.normalize() * length)
    } else {
        // A ray from within the scene or, one of four, from further away.
        let reach = if random.below(4) == 0 { 20.0 } else { 1.5 };
        let origin = center + random.in_ball() * (SIZE * reach);
        let target = center + random.in_ball() * SIZE;
        Ray::new(origin, (target - origin) * length)
    };
    // Some rays end within the scene or before it.
    if random.below(4) == 0 {
        Ray { tmax: SIZE * random.range(0.0, 4.0) / ray.direction.length(), ..ray }
    } else {
        ray
    }
}
