//! The decimals of a scene's files: how far an answer lies from that of numbers that nobody rounded.
//!
//! A scene is defined by f64 numbers, which are the roundings of a file's decimals (docs/accuracy.md). This
//! module reads the files again by code of its own, forms the f64 numbers by the documented expressions,
//! and finds by them which decimals an object of the scene comes from. With those, as exact fractions,
//! it computes the distance of a hit once more.

mod files;
mod number;

use std::collections::HashMap;
use std::fmt;
use std::path::Path;

use dashu_ratio::RBig;
use glam::DVec3;
use serde::Serialize;

use self::files::{SceneDecimals, Transform};
use self::number::{Vector, cross, dot, floats, nearest, sub};
use crate::geometry::{Geometry, Hit, Ray};
use crate::measure::oracle::ExactNumber;
use crate::scene::{Positions, Scene};

/// The answer for a ray by the decimals of the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DecimalAnswer {
    /// The ray hits the same primitive.
    Hit {
        /// The distance by the decimals, in units of the ray's |direction|, correctly rounded.
        t: f64,
        /// The distance of the scene's hit less this one.
        error: f64,
    },
    /// The ray misses the primitive that it hits in the scene.
    Missed,
    /// The decimals of the primitive are not known, for this reason.
    Unknown(String),
}

/// Returns the answer for a ray and its hit in a scene by the decimals of the file that the scene was
/// loaded from, and of the models that this names.
///
/// # Panics
/// When the hit is not one of a primitive of the scene.
pub fn answer_by_decimals(path: &Path, scene: &Scene, ray: &Ray, hit: &Hit) -> DecimalAnswer {
    // Only the vertices of the triangle that was hit are looked for: models are large.
    let vertices = match hit.id.geometry {
        Geometry::Mesh(_) => {
            let instance = &scene.instances[hit.id.instance as usize];
            let mesh = &scene.meshes[instance.mesh.0 as usize];
            mesh.triangle_vertices(hit.id.primitive).to_vec()
        }
        _ => Vec::new(),
    };
    Decimals::read(path, &vertices).answer(scene, ray, hit)
}

/// The decimals of the files of a scene, as far as a hit needs them.
struct Decimals {
    /// The positions of OBJ files, by the f64 numbers that they are rounded to.
    positions: HashMap<[u64; 3], Vector>,
    /// The transforms that instances may have.
    transforms: Vec<Transform>,
    scene: SceneDecimals,
}

impl Decimals {
    /// Reads the decimals of the file that a scene was loaded from, and of the models that it names; of
    /// positions those of some `vertices`.
    fn read(path: &Path, vertices: &[DVec3]) -> Self {
        let mut decimals =
            Self { positions: HashMap::new(), transforms: vec![], scene: SceneDecimals::default() };
        match extension(path).as_str() {
            "toml" => {
                let text = std::fs::read_to_string(path).unwrap_or_default();
                decimals.scene = files::scene_decimals(&text).unwrap_or_default();
                let folder = path.parent().unwrap_or(Path::new(""));
                for (file, transform) in std::mem::take(&mut decimals.scene.models) {
                    decimals.add_model(&folder.join(file), &transform, vertices);
                }
            }
            _ => decimals.add_model(path, &Transform::identity(), vertices),
        }
        decimals
    }

    /// Adds the positions and the transforms of a model that stands at `place`.
    fn add_model(&mut self, path: &Path, place: &Transform, vertices: &[DVec3]) {
        let Ok(bytes) = std::fs::read(path) else { return };
        if extension(path) == "obj" {
            for position in files::obj_positions(&String::from_utf8_lossy(&bytes), vertices) {
                let key = key(DVec3::from_array([0, 1, 2].map(|i| nearest(&position[i]))));
                self.positions.insert(key, position);
            }
            self.transforms.push(place.clone());
        } else {
            let nodes = files::gltf_transforms(&bytes).unwrap_or_default();
            self.transforms.extend(nodes.iter().map(|node| place.after(node)));
        }
    }

    /// Returns the answer for a ray and its hit in the scene.
    fn answer(&self, scene: &Scene, ray: &Ray, hit: &Hit) -> DecimalAnswer {
        let distance = match hit.id.geometry {
            Geometry::Spheres => self.sphere(scene, ray, hit),
            Geometry::Planes => self.plane(scene, ray, hit),
            Geometry::Mesh(_) => self.triangle(scene, ray, hit),
        };
        match distance {
            Err(reason) => DecimalAnswer::Unknown(reason.to_owned()),
            Ok(None) => DecimalAnswer::Missed,
            Ok(Some(exact)) => {
                let t = exact.to_f64();
                let ulps = exact.ulps_from(hit.t);
                let sign = if exact.compare(hit.t).is_gt() { -1.0 } else { 1.0 };
                DecimalAnswer::Hit { t, error: sign * ulps * exact.ulp() }
            }
        }
    }

    /// Returns the distance of a triangle by its decimals, if the ray hits it.
    fn triangle(&self, scene: &Scene, ray: &Ray, hit: &Hit) -> Distance {
        // The transform of the instance.
        let instance = &scene.instances[hit.id.instance as usize];
        let mut transforms = self.transforms.iter();
        let transform = transforms
            .find(|transform| transform.rounded == instance.transform)
            .ok_or("no transform of the file is that of the instance")?;
        // The vertices: those of a binary buffer are exact, those of a text have decimals.
        let mesh = &scene.meshes[instance.mesh.0 as usize];
        let corners = mesh.triangle_vertices(hit.id.primitive);
        let vertex = |p: DVec3| {
            let decimals = self.positions.get(&key(p)).cloned();
            let is_f32 = matches!(mesh.positions, Positions::F32(_));
            let own = decimals.or_else(|| floats(p.to_array()).filter(|_| is_f32));
            own.map(|p| transform.exact.point(&p))
                .ok_or("no vertex of the file is that of the mesh")
        };
        let [a, b, c] = [vertex(corners[0])?, vertex(corners[1])?, vertex(corners[2])?];
        // The plane, and the sides on which the line passes the edges; on an edge it hits.
        let (origin, direction) = exact_ray(ray)?;
        let [a, b, c] = [sub(&a, &origin), sub(&b, &origin), sub(&c, &origin)];
        let normal = cross(&sub(&b, &a), &sub(&c, &a));
        let toward = dot(&normal, &direction);
        if toward.is_zero() {
            return Ok(None);
        }
        let edges = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| dot(&direction, &cross(p, q)));
        let is_inside = |sign: i8| edges.iter().all(|e| e.is_zero() || signum(e) == sign);
        let t = dot(&normal, &a) / toward;
        Ok(((is_inside(1) || is_inside(-1)) && signum(&t) > 0).then(|| quotient(&t)))
    }

    /// Returns the distance of a plane by its decimals, if the ray hits it.
    fn plane(&self, scene: &Scene, ray: &Ray, hit: &Hit) -> Distance {
        let index = hit.id.primitive as usize;
        let (point, normal) =
            self.scene.planes.get(index).ok_or("it is no plane of the scene file")?;
        if rounded(point) != scene.planes[index].point {
            return Err("the plane does not stand where the scene file has it");
        }
        let (origin, direction) = exact_ray(ray)?;
        let toward = dot(normal, &direction);
        if toward.is_zero() {
            return Ok(None);
        }
        let t = dot(normal, &sub(point, &origin)) / toward;
        Ok((signum(&t) > 0).then(|| quotient(&t)))
    }

    /// Returns the distance of a sphere by its decimals, if the ray hits it.
    fn sphere(&self, scene: &Scene, ray: &Ray, hit: &Hit) -> Distance {
        let index = hit.id.primitive as usize;
        let sphere = &scene.spheres[index];
        let (center, radius) = match self.scene.spheres.get(index) {
            Some((center, radius)) => (center, radius),
            None => return Err("it is no sphere of the scene file"),
        };
        if rounded(center) != sphere.center || nearest(radius) != sphere.radius {
            return Err("the sphere does not stand where the scene file has it");
        }
        // a t² − 2 h t + c = 0.
        let (origin, direction) = exact_ray(ray)?;
        let to_center = sub(center, &origin);
        let (a, h) = (dot(&direction, &direction), dot(&to_center, &direction));
        let c = dot(&to_center, &to_center) - radius * radius;
        let discriminant = &h * &h - &a * &c;
        if signum(&discriminant) < 0 {
            return Ok(None);
        }
        // The near root, or the far one from within.
        let is_far = signum(&c) <= 0;
        let root = ExactNumber::root_of(&(h / &a), &(discriminant / (&a * &a)), is_far);
        Ok(Some(root).filter(|t| t.compare(0.0).is_gt()))
    }
}

/// The distance by decimals, none if the ray misses; or the reason why they are not known.
type Distance = Result<Option<ExactNumber>, &'static str>;

fn exact_ray(ray: &Ray) -> Result<(Vector, Vector), &'static str> {
    let vector = |v: DVec3| floats(v.to_array()).ok_or("the ray is not finite");
    Ok((vector(ray.origin)?, vector(ray.direction)?))
}

fn rounded(v: &Vector) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| nearest(&v[i])))
}

fn signum(x: &RBig) -> i8 {
    if x.is_zero() {
        0
    } else if *x > RBig::ZERO {
        1
    } else {
        -1
    }
}

fn quotient(t: &RBig) -> ExactNumber {
    ExactNumber::quotient(t.numerator().clone(), t.denominator().clone().into(), 0)
}

/// Returns the bits of a position; zero has one sign here.
fn key(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

impl fmt::Display for DecimalAnswer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hit { t, error } => {
                write!(f, "t {t:?} by the decimals of the file; the oracle's t is {error:+.2e} off")
            }
            Self::Missed => write!(f, "the ray misses this primitive by the decimals of the file"),
            Self::Unknown(reason) => write!(f, "not known: {reason}"),
        }
    }
}
