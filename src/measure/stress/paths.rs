//! G3: the trees find what trying every primitive finds, to the bit.

use glam::{DAffine3, DVec3};

use super::cell::Cell;
use super::random::Random;
use super::shapes::{INTERSECTORS, closest, icosphere, intersectors, occluded, torus};
use crate::geometry::Ray;
use crate::intersect::{BruteForce, Precision};
use crate::scene::{Instance, Material, Plane, Scene, Sphere};

const OFFSETS: [f64; 4] = [0.0, 1e3, 1e5, 1e7];
/// Half the side of the cube in which the scene stands.
const SIZE: f64 = 4.0;

/// The cells.
pub fn cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    for (precision, meshes, what) in [
        (Precision::Certified, false, "spheres"),
        (Precision::Certified, true, "spheres, planes, instances"),
        (Precision::Fast, false, "spheres"),
    ] {
        for (offset, tangent) in OFFSETS.into_iter().flat_map(|o| [(o, false), (o, true)]) {
            let rays = if tangent { "axis-tangent" } else { "random" };
            let name = format!("{what}, {rays} rays, offset {offset:.0e}");
            let method = format!("{}, {INTERSECTORS}", precision.name());
            cells.push(Cell::new(name, method, move |draw| {
                let scene = scene(offset, meshes, &mut draw.shared());
                let brute = BruteForce::new(&scene, precision);
                let trees = intersectors(&scene, precision)?;
                let ray = |_, random: &mut Random| ray(&scene, offset, tangent, random);
                Ok(draw.batch(ray, |rays, tally| {
                    let (truth, shadow) = (closest(&brute, rays), occluded(&brute, rays));
                    for tree in &trees {
                        let found = closest(&**tree, rays);
                        for (found, truth) in found.iter().zip(&truth) {
                            match (found, truth) {
                                (Some(a), Some(b)) if a.id == b.id => {
                                    tally.ulp(a.t.to_bits().abs_diff(b.t.to_bits()) as f64);
                                }
                                (a, b) => tally.wrong_if(a.is_some() || b.is_some()),
                            }
                        }
                        for (found, truth) in occluded(&**tree, rays).iter().zip(&shadow) {
                            tally.wrong_if(found != truth);
                        }
                    }
                }))
            }));
        }
    }
    cells
}

fn away(offset: f64) -> DVec3 {
    DVec3::new(offset, -0.7 * offset, 0.3 * offset)
}

fn scene(offset: f64, meshes: bool, random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let center = away(offset);
    for _ in 0..60 {
        let radius = random.power_of_ten(-3.0, 0.0);
        scene.spheres.push(Sphere::new(center + random.in_ball() * SIZE, radius, material));
    }
    if meshes {
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
                DAffine3::from_scale_rotation_translation(stretch, random.turn(), place);
            scene.instances.push(Instance::new(mesh, transform, material));
        }
    }
    scene
}

fn ray(scene: &Scene, offset: f64, tangent: bool, random: &mut Random) -> Ray {
    let center = away(offset);
    let length = random.power_of_ten(-3.0, 3.0);
    let ray = if tangent {
        let sphere = random.pick(&scene.spheres);
        let axis = random.below(3);
        let (along, across) = (DVec3::AXES[axis], DVec3::AXES[(axis + 1 + random.below(2)) % 3]);
        let side = random.pick(&[1.0, -1.0]);
        let back = if random.coin() { -along } else { along } * SIZE * random.range(0.5, 3.0);
        let origin = sphere.center + across * (side * sphere.radius) + back;
        Ray::new(origin, -back.normalize() * length)
    } else {
        let reach = if random.below(4) == 0 { 20.0 } else { 1.5 };
        let origin = center + random.in_ball() * (SIZE * reach);
        let target = center + random.in_ball() * SIZE;
        Ray::new(origin, (target - origin) * length)
    };
    // Some rays end, within the scene or before it.
    if random.below(4) == 0 {
        Ray { tmax: SIZE * random.range(0.0, 4.0) / ray.direction.length(), ..ray }
    } else {
        ray
    }
}
