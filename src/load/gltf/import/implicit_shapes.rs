//! KHR_implicit_shapes: spheres and planes as what they are, boxes, cylinders and capsules as
//! meshes.
//!
//! The extension lists shapes, for any use. A node shows the shape that its own
//! `extensions.KHR_implicit_shapes.shape` names, of the `material` beside it.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DAffine3, DVec3};
use gltf::json::{self, Value};

use super::nodes::SceneNode;
use crate::error::{Error, Result};
use crate::load::gltf::json::{as_index, at_path, error_at, list};
use crate::scene::Mesh;

const EXTENSION: &str = "KHR_implicit_shapes";

/// The shape of a node, about its origin.
#[derive(Clone, Debug, PartialEq)]
pub enum ImplicitShape {
    /// A sphere, by its radius in world space.
    Sphere(f64),
    /// The infinite plane whose normal is Y.
    Plane,
    /// A shape that has to be a mesh.
    Mesh(Box<Mesh>),
}

/// Returns the shape of a node, if it has one, and the index of its material, if it names one.
///
/// # Errors
/// When the file has no such shape, or it is damaged.
pub fn shape(
    root: &json::Root,
    node: &SceneNode,
) -> Result<Option<(ImplicitShape, Option<usize>)>> {
    let extensions = node.node.extensions.as_ref();
    let Some(own) = extensions.and_then(|e| e.others.get(EXTENSION)) else { return Ok(None) };

    // The shape in the list of the root that the node names.
    let of_root = root.extensions.as_ref().and_then(|e| e.others.get(EXTENSION));
    let shapes = of_root.map_or(&[][..], |extension| list(extension, "shapes"));
    let index = own.get("shape").and_then(as_index);
    let (index, source) = index.and_then(|i| Some((i, shapes.get(i)?))).ok_or_else(|| {
        let path = format!("nodes[{}].extensions.{EXTENSION}.shape", node.index);
        error_at(path, format!("there is no such shape: the file has {}", shapes.len()))
    })?;
    let path = format_args!("extensions.{EXTENSION}.shapes[{index}]");
    let shape = match parse(source).map_err(at_path(path))? {
        // A sphere that becomes an ellipsoid has to be a mesh.
        ImplicitShape::Sphere(radius) => match transformed_radius(&node.to_world, radius) {
            Some(radius) => ImplicitShape::Sphere(radius),
            None => {
                let profile = capsule_profile(0.0, radius, radius);
                ImplicitShape::Mesh(surface_of_revolution(&profile).into())
            }
        },
        shape => shape,
    };
    Ok(Some((shape, own.get("material").and_then(as_index))))
}

/// Parses a shape of the list of the root.
fn parse(source: &Value) -> Result<ImplicitShape> {
    let kind = source.get("type").and_then(Value::as_str).unwrap_or_default();
    let parameters = source.get(kind);
    // Parameters that are missing have a default; others must be lengths.
    let number = |name: &str, default: f64| {
        let found = parameters.and_then(|p| p.get(name)).map_or(Some(default), Value::as_f64);
        found
            .filter(|x| x.is_finite() && *x >= 0.0 && *x < 1e30)
            .ok_or_else(|| Error::input(format!("`{kind}.{name}` must be a number from 0 on")))
    };

    // Spheres and infinite planes are kept as what they are, all others become meshes.
    let mesh = |mesh: Mesh| Ok(ImplicitShape::Mesh(mesh.into()));
    match kind {
        "sphere" => match number("radius", 0.5)? {
            0.0 => Err(Error::input("the radius of a sphere must be above 0")),
            radius => Ok(ImplicitShape::Sphere(radius)),
        },
        // A plane without a size has no end.
        "plane" => match [number("sizeX", 0.0)?, number("sizeZ", 0.0)?] {
            [0.0, 0.0] => Ok(ImplicitShape::Plane),
            [x, z] => mesh(rectangle(x, z)),
        },
        "box" => {
            let size = parameters.and_then(|p| p.get("size")).and_then(Value::as_array);
            let side = |i: usize| size.map_or(Some(1.0), |size| size.get(i)?.as_f64());
            match [0, 1, 2].map(|i| side(i).filter(|x| x.is_finite())) {
                [Some(x), Some(y), Some(z)] => mesh(box_mesh(DVec3::new(x, y, z))),
                _ => Err(Error::input("`box.size` must be three numbers")),
            }
        }
        "cylinder" | "capsule" => {
            let (bottom, top) = (number("radiusBottom", 0.25)?, number("radiusTop", 0.25)?);
            let half = number("height", 0.5)? / 2.0;
            let profile = if kind == "cylinder" { cylinder_profile } else { capsule_profile };
            mesh(surface_of_revolution(&profile(half, bottom, top)))
        }
        _ => Err(Error::input(format!("a shape of type `{kind}` is not known"))
            .help("sphere, plane, box, cylinder or capsule")),
    }
}

/// Returns the radius of a sphere about the origin under a transform; `None` if that makes it an
/// ellipsoid.
fn transformed_radius(transform: &DAffine3, radius: f64) -> Option<f64> {
    let [x, y, z] = [0, 1, 2].map(|i| transform.matrix3.col(i));
    let scale = x.length();
    // A sphere stays one if the axes are still equally long, and perpendicular.
    let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * scale;
    let is_uniform = is_near(y.length(), scale) && is_near(z.length(), scale);
    let is_orthogonal =
        [x.dot(y), y.dot(z), z.dot(x)].iter().all(|d| d.abs() <= 1e-6 * scale * scale);
    (is_uniform && is_orthogonal && scale > 0.0).then_some(radius * scale)
}

/// A point of a profile: distance from the axis, height, and the normal in this plane.
type ProfilePoint = [f64; 4];

/// Segments of a whole turn.
const AROUND: usize = 64;
/// Segments from the rim of a cap to its pole.
const UP: usize = 16;

fn cylinder_profile(half: f64, bottom: f64, top: f64) -> Vec<[ProfilePoint; 2]> {
    // The normal of the side leans by as much as the radius changes over the height.
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
fn capsule_profile(half: f64, bottom: f64, top: f64) -> Vec<[ProfilePoint; 2]> {
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
    // From bottom to top: a cap, the cone between the caps if there is room for one, and a cap.
    let mut profile: Vec<[ProfilePoint; 2]> = cap(-half, bottom, -FRAC_PI_2, rise).collect();
    if half > 0.0 {
        profile.push([on(-half, bottom, rise), on(half, top, rise)]);
    }
    profile.extend(cap(half, top, rise, FRAC_PI_2));
    profile
}

/// Returns the surface that a profile, from bottom to top, makes when it is turned about Y.
fn surface_of_revolution(profile: &[[ProfilePoint; 2]]) -> Mesh {
    let mut mesh = Mesh::default();
    let mut positions: Vec<[f64; 3]> = Vec::new();
    for segment in profile {
        let first = positions.len() as u32;
        for i in 0..=AROUND {
            // Each step around the axis has a vertex at either end of the segment. The last step is
            // at the place of the first, so that the seam is closed.
            let (sin, cos) = (TAU * (i % AROUND) as f64 / AROUND as f64).sin_cos();
            for [r, y, nr, ny] in segment {
                positions.push([r * cos, *y, r * sin]);
                mesh.normals.push([nr * cos, *ny, nr * sin].map(|x| x as f32));
            }
        }

        // Two triangles join two steps; at a pole one of them would have no area.
        for i in 0..AROUND as u32 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| first + 2 * i + k);
            let [low, high] = segment.map(|[r, ..]| r > 1e-12);
            mesh.triangles.extend(high.then_some([a, b, d]));
            mesh.triangles.extend(low.then_some([a, d, c]));
        }
    }
    mesh.positions = positions.into();
    mesh
}

/// Returns a rectangle in the plane of X and Z.
fn rectangle(x: f64, z: f64) -> Mesh {
    let (x, z) = (x / 2.0, z / 2.0);
    Mesh {
        positions: vec![[-x, 0.0, -z], [-x, 0.0, z], [x, 0.0, z], [x, 0.0, -z]].into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

fn box_mesh(size: DVec3) -> Mesh {
    let half = size / 2.0;
    let corner = |i: usize| {
        let side = |bit: usize, half: f64| if i & bit == 0 { -half } else { half };
        [side(1, half.x), side(2, half.y), side(4, half.z)]
    };
    #[rustfmt::skip]
    let triangles = [
        [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
        [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
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
        match parse(&source).unwrap() {
            ImplicitShape::Mesh(mesh) => *mesh,
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
        let tetrahedra = mesh.triangles.iter().map(|t| mesh.corners(t));
        tetrahedra.map(|[a, b, c]| a.dot(b.cross(c))).sum::<f64>() / 6.0
    }

    #[test]
    fn box_has_its_volume_and_winds_outward() {
        assert!((volume(&box_mesh(DVec3::new(1.0, 2.0, 3.0))) - 6.0).abs() < 1e-6);
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
        let rotated = DAffine3::from_rotation_x(1.0) * DAffine3::from_scale(DVec3::splat(2.0));
        assert!(transformed_radius(&rotated, 1.5).is_some_and(|r| (r - 3.0).abs() < 1e-12));
        assert_eq!(transformed_radius(&DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0)), 1.0), None);
    }

    #[test]
    fn a_shape_that_is_none_is_an_error() {
        assert!(parse(&shape("teapot", &[])).is_err());
        assert!(parse(&shape("sphere", &[("radius", -1.0)])).is_err());
    }
}
