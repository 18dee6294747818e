//! KHR_implicit_shapes: spheres and planes as what they are, boxes, cylinders and capsules as
//! meshes.
//!
//! The extension lists shapes and leaves it to others what they are for. A node shows the shape
//! that its own `extensions.KHR_implicit_shapes.shape` names, of the `material` beside it.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DAffine3, DVec3};
use gltf::json;
use gltf::json::Value;

use super::nodes::Placed;
use crate::error::{Error, Place, Result};
use crate::scene::Mesh;

/// A shape about the origin of its node.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A sphere of this radius.
    Sphere(f64),
    /// The infinite plane that faces Y.
    Plane,
    /// What has to be a mesh.
    Mesh(Box<Mesh>),
}

/// The shape that a node shows, and the material that it names.
///
/// # Errors
/// When there is no such shape, or it is no shape.
pub fn of(root: &json::Root, placed: &Placed) -> Result<Option<(Shape, Option<usize>)>> {
    let extension = placed.node.extensions.as_ref();
    let Some(own) = extension.and_then(|e| e.others.get("KHR_implicit_shapes")) else {
        return Ok(None);
    };
    let by = format!("nodes[{}].extensions.KHR_implicit_shapes", placed.index);
    let all = root.extensions.as_ref().and_then(|e| e.others.get("KHR_implicit_shapes"));
    let all = all.and_then(|e| e.get("shapes")).and_then(Value::as_array);
    let whole = |name: &str| own.get(name).and_then(Value::as_u64).map(|i| i as usize);
    let index = whole("shape");
    let source = index.and_then(|i| all?.get(i)).ok_or_else(|| {
        let count = all.map_or(0, Vec::len);
        Error::input(format!("there is no such shape: the file has {count}"))
            .place(Place::Json(format!("{by}.shape")))
    })?;
    let at = format!("extensions.KHR_implicit_shapes.shapes[{}]", index.unwrap_or_default());
    let shape = read(source).map_err(|e| e.place(Place::Json(at)))?;
    Ok(Some((shape, whole("material"))))
}

fn read(source: &Value) -> Result<Shape> {
    let kind = source.get("type").and_then(Value::as_str).unwrap_or_default();
    let number = |name: &str, default: f64| {
        let found = source.get(kind).and_then(|s| s.get(name));
        let found = found.map_or(Some(default), Value::as_f64);
        found
            .filter(|x| x.is_finite() && *x >= 0.0 && *x < 1e30)
            .ok_or_else(|| Error::input(format!("`{kind}.{name}` must be a number from 0 on")))
    };
    let shape = match kind {
        "sphere" => Shape::Sphere(number("radius", 0.5)?),
        "plane" => match [number("sizeX", 0.0)?, number("sizeZ", 0.0)?] {
            // Without a size it has no end.
            [0.0, 0.0] => Shape::Plane,
            [x, z] => Shape::Mesh(sheet(x, z).into()),
        },
        "box" => {
            let size = source.get(kind).and_then(|s| s.get("size")).and_then(Value::as_array);
            let side = |i: usize| size.map_or(Some(1.0), |size| size.get(i)?.as_f64());
            let sides = [side(0), side(1), side(2)].map(|side| side.filter(|x| x.is_finite()));
            match sides {
                [Some(x), Some(y), Some(z)] => Shape::Mesh(cuboid(DVec3::new(x, y, z)).into()),
                _ => return Err(Error::input("`box.size` must be three numbers")),
            }
        }
        "cylinder" | "capsule" => {
            let (bottom, top) = (number("radiusBottom", 0.25)?, number("radiusTop", 0.25)?);
            let half = number("height", 0.5)? / 2.0;
            Shape::Mesh(
                turned(&match kind {
                    "cylinder" => cylinder(half, bottom, top),
                    _ => capsule(half, bottom, top),
                })
                .into(),
            )
        }
        _ => {
            return Err(Error::input(format!("a shape of type `{kind}` is not known"))
                .help("sphere, plane, box, cylinder or capsule"));
        }
    };
    match shape {
        Shape::Sphere(radius) if radius <= 0.0 => {
            Err(Error::input("the radius of a sphere must be above 0"))
        }
        shape => Ok(shape),
    }
}

/// A sphere under a transform: its centre and radius, or nothing where that makes it an ellipsoid.
pub fn sphere_under(transform: &DAffine3, radius: f64) -> Option<(DVec3, f64)> {
    let [x, y, z] = [0, 1, 2].map(|i| transform.matrix3.col(i));
    let scale = x.length();
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * scale;
    let is_even = near(y.length(), scale) && near(z.length(), scale);
    let is_square = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|d| d.abs() <= 1e-6 * scale * scale);
    (is_even && is_square && scale > 0.0).then_some((transform.translation, radius * scale))
}

/// A sphere as a mesh, for transforms that make it an ellipsoid.
pub fn ball(radius: f64) -> Mesh {
    turned(&capsule(0.0, radius, radius))
}

/// A point of an outline: distance from the axis, height, and the normal in this plane.
type Point = [f64; 4];

/// Segments of a whole turn.
const AROUND: usize = 64;
/// Segments from the rim of a cap to its pole.
const UP: usize = 16;

fn cylinder(half: f64, bottom: f64, top: f64) -> Vec<[Point; 2]> {
    let slope = (bottom - top) / (2.0 * half).max(f64::MIN_POSITIVE);
    let length = slope.hypot(1.0);
    let (nr, ny) = (1.0 / length, slope / length);
    vec![
        [[0.0, -half, 0.0, -1.0], [bottom, -half, 0.0, -1.0]],
        [[bottom, -half, nr, ny], [top, half, nr, ny]],
        [[top, half, 0.0, 1.0], [0.0, half, 0.0, 1.0]],
    ]
}

/// The hull of two spheres about (0, ±half): two caps, and the cone that touches both.
fn capsule(half: f64, bottom: f64, top: f64) -> Vec<[Point; 2]> {
    // Where the cone touches, the normal rises by this angle.
    let rise = ((bottom - top) / (2.0 * half).max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0).asin();
    let on = |center: f64, radius: f64, angle: f64| {
        let (sin, cos) = angle.sin_cos();
        [radius * cos, center + radius * sin, cos, sin]
    };
    let cap = |center: f64, radius: f64, from: f64, to: f64| {
        let angle = move |i: usize| from + (to - from) * i as f64 / UP as f64;
        (0..UP).map(move |i| [on(center, radius, angle(i)), on(center, radius, angle(i + 1))])
    };
    let mut outline: Vec<[Point; 2]> = cap(-half, bottom, -FRAC_PI_2, rise).collect();
    if half > 0.0 {
        outline.push([on(-half, bottom, rise), on(half, top, rise)]);
    }
    outline.extend(cap(half, top, rise, FRAC_PI_2));
    outline
}

/// The surface that an outline makes, from bottom to top, when it is turned about Y.
fn turned(outline: &[[Point; 2]]) -> Mesh {
    let mut mesh = Mesh::default();
    for piece in outline {
        let first = mesh.positions.len() as u32;
        for i in 0..=AROUND {
            // The seam is one place.
            let (sin, cos) = (TAU * (i % AROUND) as f64 / AROUND as f64).sin_cos();
            for [r, y, nr, ny] in piece {
                mesh.positions.push([r * cos, *y, r * sin].map(|x| x as f32));
                mesh.normals.push([nr * cos, *ny, nr * sin].map(|x| x as f32));
            }
        }
        for i in 0..AROUND as u32 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| first + 2 * i + k);
            let [low, high] = piece.map(|[r, ..]| r > 1e-12);
            mesh.triangles.extend(high.then_some([a, b, d]));
            mesh.triangles.extend(low.then_some([a, d, c]));
        }
    }
    mesh
}

fn sheet(x: f64, z: f64) -> Mesh {
    let (x, z) = ((x / 2.0) as f32, (z / 2.0) as f32);
    Mesh {
        positions: vec![[-x, 0.0, -z], [-x, 0.0, z], [x, 0.0, z], [x, 0.0, -z]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

fn cuboid(size: DVec3) -> Mesh {
    let half = (size / 2.0).as_vec3();
    let corner = |i: usize| {
        let side = |bit: usize, half: f32| if i & bit == 0 { -half } else { half };
        [side(1, half.x), side(2, half.y), side(4, half.z)]
    };
    let triangles = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: triangles.to_vec(),
        ..Mesh::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gltf::json::serialize::to_value;

    fn mesh(source: Value) -> Mesh {
        match read(&source).unwrap() {
            Shape::Mesh(mesh) => *mesh,
            other => panic!("{other:?}"),
        }
    }

    fn shape(kind: &str, numbers: &[(&str, f64)]) -> Value {
        let inner: std::collections::BTreeMap<_, _> = numbers.iter().copied().collect();
        let mut all = std::collections::BTreeMap::new();
        all.insert(kind, to_value(inner).unwrap());
        all.insert("type", to_value(kind).unwrap());
        to_value(all).unwrap()
    }

    /// Six times the volume within a closed mesh that winds outward.
    fn volume(mesh: &Mesh) -> f64 {
        let corner = |i: u32| DVec3::from(mesh.positions[i as usize].map(f64::from));
        let tetrahedra = mesh.triangles.iter().map(|t| t.map(corner));
        tetrahedra.map(|[a, b, c]| a.dot(b.cross(c))).sum::<f64>() / 6.0
    }

    #[test]
    fn box_has_its_volume_and_winds_outward() {
        assert!((volume(&cuboid(DVec3::new(1.0, 2.0, 3.0))) - 6.0).abs() < 1e-6);
    }

    #[test]
    fn cylinder_has_its_volume_and_winds_outward() {
        let source =
            shape("cylinder", &[("height", 2.0), ("radiusBottom", 1.0), ("radiusTop", 1.0)]);
        let prism = AROUND as f64 / 2.0 * (TAU / AROUND as f64).sin() * 2.0;
        assert!((volume(&mesh(source)) - prism).abs() < 1e-5);
    }

    #[test]
    fn capsule_has_nearly_its_volume() {
        let source =
            shape("capsule", &[("height", 1.0), ("radiusBottom", 0.5), ("radiusTop", 0.5)]);
        let whole = TAU / 8.0 + 4.0 / 3.0 * TAU / 2.0 / 8.0;
        let found = volume(&mesh(source));
        assert!((0.99 * whole..whole).contains(&found), "{found} of {whole}");
    }

    #[test]
    fn sphere_stays_one_where_all_directions_are_scaled_alike() {
        let turned = DAffine3::from_rotation_x(1.0) * DAffine3::from_scale(DVec3::splat(2.0));
        assert!(sphere_under(&turned, 1.5).is_some_and(|(_, r)| (r - 3.0).abs() < 1e-12));
        assert_eq!(sphere_under(&DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0)), 1.0), None);
    }

    #[test]
    fn a_shape_that_is_none_is_an_error() {
        assert!(read(&shape("teapot", &[])).is_err());
        assert!(read(&shape("sphere", &[("radius", -1.0)])).is_err());
    }
}
