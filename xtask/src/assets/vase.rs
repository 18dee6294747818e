//! The vase: an OBJ file with two materials, one of them painted.

use std::fmt::Write;

use glam::{DVec2, DVec3};

use super::paint;
use crate::shape::{Shape, smooth};

const SEGMENTS: u32 = 48;

/// The outside from the foot up to the rim, in metres: 1 high.
fn outline() -> Vec<DVec2> {
    let points = [
        (0.115, 0.06),
        (0.135, 0.11),
        (0.215, 0.27),
        (0.285, 0.45),
        (0.29, 0.58),
        (0.215, 0.69),
        (0.125, 0.76),
        (0.105, 0.85),
        (0.125, 0.94),
        (0.165, 0.985),
    ];
    let points = points.map(|(r, y)| DVec3::new(r, y, 0.0));
    smooth(&points, 5).into_iter().map(DVec3::truncate).collect()
}

/// The body, whose texture runs from the rim down to the foot.
pub fn body() -> Shape {
    Shape::default().lathe(&outline(), SEGMENTS, [1.0, 0.0])
}

/// Foot, lip, inside and handles.
pub fn fittings() -> Shape {
    let at = |points: &[(f64, f64)]| points.iter().map(|&p| DVec2::from(p)).collect::<Vec<_>>();
    let mut shape = Shape::default()
        .disc(0.15, 0.0, false, SEGMENTS)
        .lathe(&at(&[(0.15, 0.0), (0.158, 0.015), (0.15, 0.035)]), SEGMENTS, [0.0, 1.0])
        .lathe(&at(&[(0.15, 0.035), (0.125, 0.045), (0.115, 0.06)]), SEGMENTS, [0.0, 1.0])
        .lathe(
            &at(&[(0.165, 0.985), (0.172, 0.992), (0.168, 1.0), (0.155, 0.998)]),
            SEGMENTS,
            [0.0, 1.0],
        )
        .lathe(
            &at(&[(0.155, 0.998), (0.115, 0.94), (0.09, 0.85), (0.11, 0.75), (0.0, 0.7)]),
            SEGMENTS,
            [0.0, 1.0],
        );
    for side in [-1.0, 1.0] {
        let points = [(0.09, 0.86), (0.19, 0.91), (0.262, 0.87), (0.28, 0.77), (0.235, 0.63)];
        let points = points.map(|(r, y)| DVec3::new(r * side, y, 0.0));
        shape = shape.tube(&smooth(&points, 8), 0.021, 16);
    }
    shape
}

/// `vase.obj`, `vase.mtl` and `vase.png`.
pub fn files() -> Vec<(&'static str, Vec<u8>)> {
    let mut obj = "# A vase with handles, 1 m high. Made by xtask make-assets.\n".to_owned();
    obj += "mtllib vase.mtl\n";
    let mut first = 1;
    for (name, material, shape) in [("body", "painted", body()), ("fittings", "glaze", fittings())]
    {
        write(&mut obj, name, material, &shape, first);
        first += shape.positions.len() as u32;
    }
    let mtl = "\
# Made by xtask make-assets.
newmtl painted
Kd 1 1 1
Ks 0.25 0.24 0.22
Ns 60
map_Kd vase.png

newmtl glaze
Kd 0.018 0.016 0.020
Ks 0.4 0.38 0.36
Ns 90
";
    vec![("vase.obj", obj.into_bytes()), ("vase.mtl", mtl.into()), ("vase.png", paint::vase())]
}

/// Appends an object whose first corner has the number `first`.
fn write(obj: &mut String, name: &str, material: &str, shape: &Shape, first: u32) {
    let mut line = |text: std::fmt::Arguments<'_>| {
        writeln!(obj, "{text}").expect("ok: a String takes all that is written");
    };
    // Adding 0 turns a negative zero into a positive one.
    let round = |x: f64| (x * 1e4).round() / 1e4 + 0.0;
    line(format_args!("o {name}\nusemtl {material}"));
    for p in &shape.positions {
        line(format_args!("v {} {} {}", round(p.x), round(p.y), round(p.z)));
    }
    for uv in &shape.uvs {
        // In OBJ, v runs up.
        line(format_args!("vt {} {}", round(uv.x), round(1.0 - uv.y)));
    }
    for n in &shape.normals {
        line(format_args!("vn {} {} {}", round(n.x), round(n.y), round(n.z)));
    }
    for face in &shape.faces {
        let corners: Vec<_> =
            face.iter().map(|i| i + first).map(|i| format!("{i}/{i}/{i}")).collect();
        line(format_args!("f {}", corners.join(" ")));
    }
}
