//! G9: a lamp that lies exactly on a surface lights what it sees, and nothing behind the surface.

use glam::{DAffine3, DMat3, DVec3};

use super::backends::{BothPrecisions, on_each_backend};
use super::case::{Case, RaySampler};
use super::meshes::cube;
use super::self_shadow::incident_light;
use super::{CaseStats, random::Random};
use crate::error::Result;
use crate::geometry::{PrimitiveId, Ray};
use crate::intersect::{Backend, Coherence::Incoherent};
use crate::measure::trace::closest;
use crate::scene::{Instance, Material, Plane, Scene, Sphere};
use crate::surface::Surface;

/// The exponents of the powers of two by which everything is scaled.
const SCALE_EXPONENTS: [i32; 3] = [-40, 0, 40];
/// The radius of the room in which everything is, a sphere.
const ROOM: f64 = 16.0;
/// Whole numbers (a, b, c, d) with a² + b² + c² = d².
const QUADRUPLES: [[f64; 4]; 5] = [
    [1.0, 2.0, 2.0, 3.0],
    [2.0, 3.0, 6.0, 7.0],
    [1.0, 4.0, 8.0, 9.0],
    [4.0, 4.0, 7.0, 9.0],
    [2.0, 6.0, 9.0, 11.0],
];
/// The least sine of the angle at which light is seen over a surface: closer ones are not sampled.
const MIN_SINE: f64 = 1e-6;

/// The place of the lamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    LevelPlane,
    TiltedPlane,
    Sphere,
    Face,
    Edge,
    Vertex,
}

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let places = [
        (Place::LevelPlane, "a level plane"),
        (Place::TiltedPlane, "a tilted plane"),
        (Place::Sphere, "a sphere"),
        (Place::Face, "a face"),
        (Place::Edge, "an edge"),
        (Place::Vertex, "a vertex"),
    ];
    let scaled = places.into_iter().flat_map(|place| SCALE_EXPONENTS.map(|k| (place, k)));
    scaled
        .flat_map(|((place, name), k)| {
            let name = format!("a lamp on {name}, scaled by 2^{k}");
            on_each_backend(&name, move |sampler, backend| {
                check_lamps(&Lamps::new(place, k, &mut sampler.shared_random()), backend, sampler)
            })
        })
        .collect()
}

/// A room with a surface on which lamps lie.
struct Lamps {
    place: Place,
    scale: f64,
    scene: Scene,
}

impl Lamps {
    fn new(place: Place, k: i32, random: &mut Random) -> Self {
        let scale = f64::powi(2.0, k);
        let mut scene = Scene::default();
        let material = scene.add_material(Material::default());
        scene.spheres.push(Sphere::new(DVec3::ZERO, ROOM * scale, material));
        match place {
            Place::LevelPlane => {
                let point = random.in_ball() * (2.0 * scale);
                let axis = random.pick(&DVec3::AXES);
                scene.planes.push(Plane::new(point, axis, material));
            }
            Place::TiltedPlane => {
                let point = random.in_ball() * (2.0 * scale);
                scene.planes.push(Plane::new(point, random.direction(), material));
            }
            Place::Sphere => {
                let radius = random.pick(&QUADRUPLES)[3];
                let center = DVec3::new(1.0, -2.0, 0.5) * scale;
                scene.spheres.push(Sphere::new(center, radius * scale, material));
            }
            Place::Face | Place::Edge | Place::Vertex => {
                // A cube that is sheared by whole numbers, so that all its points stay exact.
                let shear = DMat3::from_cols_array(&[2., 0., 1., 1., 2., 0., 0., 1., 2.]);
                let (shear, at) = (shear * scale, DVec3::new(0.5, -1.0, 0.25) * scale);
                let mesh = scene.add_mesh(cube(4));
                let transform = DAffine3 { matrix3: shear, translation: at };
                scene.instances.push(Instance::new(mesh, transform, material));
            }
        }
        Self { place, scale, scene }
    }

    /// Returns a lamp, exactly on the surface.
    fn lamp(&self, random: &mut Random) -> DVec3 {
        let scale = self.scale;
        match self.place {
            Place::LevelPlane => {
                let Plane { point, normal, .. } = self.scene.planes[0];
                let aside = random.in_ball() * (4.0 * scale);
                DVec3::select(normal.cmpeq(DVec3::ZERO), aside, point)
            }
            // The one point that is known to lie on it exactly.
            Place::TiltedPlane => self.scene.planes[0].point,
            Place::Sphere => {
                let Sphere { center, radius, .. } = self.scene.spheres[1];
                let fits = |q: &&[f64; 4]| q[3] * scale == radius;
                let all: Vec<&[f64; 4]> = QUADRUPLES.iter().filter(fits).collect();
                let [a, b, c, _] = *random.pick(&all);
                let turned = random.pick(&[[a, b, c], [b, c, a], [c, a, b], [a, c, b], [c, b, a]]);
                center + DVec3::from(turned.map(|x| x * random.pick(&[scale, -scale])))
            }
            Place::Face | Place::Edge | Place::Vertex => {
                let mesh = &self.scene.meshes[0];
                let triangle = random.below(mesh.triangles.len()) as u32;
                let [a, b, c] = mesh.triangle_vertices(triangle);
                // Weights that are multiples of 1/16.
                let first = 1 + random.below(14);
                let second = 1 + random.below(15 - first);
                let [v, w] = match self.place {
                    Place::Vertex => [0, 0],
                    Place::Edge => [first, 0],
                    _ => [first, second],
                }
                .map(|x| x as f64 / 16.0);
                let local = a + (b - a) * v + (c - a) * w;
                self.scene.instances[0].transform.transform_point3(local)
            }
        }
    }

    /// True if a point of the room sees a lamp; none where this is a matter of rounding.
    fn sees(&self, point: DVec3, lamp: DVec3) -> Option<bool> {
        let way = (point - lamp).normalize();
        let is_above = |normal: DVec3| {
            let sine = normal.normalize().dot(way);
            (sine.abs() > MIN_SINE).then_some(sine > 0.0)
        };
        match self.place {
            Place::LevelPlane | Place::TiltedPlane => Some(true),
            Place::Sphere => is_above(lamp - self.scene.spheres[1].center),
            Place::Face | Place::Edge | Place::Vertex => {
                // Over one of the sides of the cube on which the lamp lies, whose normals are those of
                // the inverse transform.
                let inverse = self.scene.instances[0].transform.inverse();
                let local = inverse.transform_point3(lamp);
                let normals = inverse.matrix3.transpose();
                let sides = (0..3).filter(|&axis| (local[axis].abs() - 1.0).abs() < 1e-9);
                let mut sees = false;
                for axis in sides {
                    sees |= is_above(normals.col(axis) * local[axis])?;
                }
                Some(sees)
            }
        }
    }
}

/// Checks shadow rays from points of the room to lamps.
fn check_lamps(lamps: &Lamps, backend: Backend, sampler: &RaySampler) -> Result<CaseStats> {
    let (scene, scale) = (&lamps.scene, lamps.scale);
    let intersectors = BothPrecisions::build(scene, backend)?;
    // Rays outward, a little before the wall.
    let ray = |random: &mut Random| {
        let out = random.direction();
        let direction = (out + random.in_ball() * 0.5) * scale;
        (Ray::new(out * (0.999 * ROOM * scale), direction), lamps.lamp(random))
    };
    Ok(sampler.for_each_batch(ray, |rays, stats| {
        let (rays, lamp_places): (Vec<Ray>, Vec<DVec3>) = rays.iter().copied().unzip();
        let hits = closest(&*intersectors.certified, &rays, Incoherent);
        let (mut shadow, mut expected) = (Vec::new(), Vec::new());
        for ((ray, &lamp), hit) in rays.iter().zip(&lamp_places).zip(hits) {
            // Where a plane crosses the room, it may be hit before the wall.
            let Some(hit) = hit.filter(|hit| hit.id == PrimitiveId::sphere(0)) else { continue };
            let surface = Surface::new(scene, ray, &hit);
            let Some(sees) = lamps.sees(surface.position, lamp) else { continue };
            let toward = lamp - surface.position;
            shadow.push(surface.shadow_ray(ray.direction, &incident_light(toward)));
            expected.push(!sees);
        }
        intersectors.count_occluded(&shadow, &expected, stats);
    }))
}
