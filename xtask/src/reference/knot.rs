//! M: a torus knot of a million triangles, with a mirror sphere and a glass sphere beside it.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::glb::{Glb, at};

/// A triangle mesh.
pub struct Mesh {
    /// The positions of its vertices.
    pub positions: Vec<[f32; 3]>,
    /// The indices of each triangle's vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// The number of triangles of the knot of M.
pub const TRIANGLES: usize = 1_000_000;

/// Returns the number of rings, and of vertices of each, of the knot that has about `triangles`, at least
/// 18: the steps along it are about as long as those around it. For 1,000,000 that is exact.
pub fn resolution(triangles: usize) -> [u32; 2] {
    let sides = (triangles as f64 / 16.0).sqrt().round().max(3.0);
    let rings = (triangles as f64 / (2.0 * sides)).round().max(3.0);
    [rings as u32, sides as u32]
}

/// A torus knot about the z axis with a displaced surface, of `rings · sides · 2` triangles: one
/// set of vertices, within 1.8 of the origin, and no normals. Sine and cosine are the platform's:
/// another one's may differ in a last digit.
pub fn mesh([rings, sides]: [u32; 2]) -> Mesh {
    let center = |s: f64| {
        let (p, q) = (2.0 * s, 3.0 * s);
        let radius = 1.0 + 0.45 * q.cos();
        DVec3::new(radius * p.cos(), radius * p.sin(), 0.45 * q.sin())
    };
    let mut positions = Vec::with_capacity(rings as usize * sides as usize);
    for i in 0..rings {
        let s = TAU * f64::from(i) / f64::from(rings);
        let along = (center(s + 1e-4) - center(s - 1e-4)).normalize();
        let across = along.cross(DVec3::Z).normalize();
        let up = across.cross(along);
        for k in 0..sides {
            let a = TAU * f64::from(k) / f64::from(sides);
            let bump = 0.02 * ((s * 40.0).sin() * (a * 9.0).sin() + (s * 131.0).cos() * 0.3);
            let p = center(s) + (across * a.cos() + up * a.sin()) * (0.3 + bump);
            positions.push(p.as_vec3().to_array());
        }
    }
    let at = |i: u32, k: u32| (i % rings) * sides + k % sides;
    let triangles = (0..rings)
        .flat_map(|i| (0..sides).map(move |k| (i, k)))
        .flat_map(|(i, k)| {
            let (a, b, c, d) = (at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh { positions, triangles }
}

/// The model file that [`TOML`] names.
pub fn glb(mesh: &Mesh) -> Vec<u8> {
    let mut glb = Glb::default();
    let id = glb.triangles("knot", &mesh.positions, &mesh.triangles);
    glb.add_node("knot", None, id, at(0.0, 0.0, 0.0));
    glb.finish("envers xtask make-reference")
}

/// The scene file.
pub const TOML: &str = r##"# M: a torus knot of a million triangles, a mirror and glass. Made by xtask make-reference.
[film]
size = [1000, 500]
background = "#a9c4e4"

[camera]
position = [0, 1.4, 3.5]
look_at = [0, 0.6, 0]
fov_x = 61

[[plane]]
point = [0, 0, 0]
normal = [0, 1, 0]
material = "ground"

[[model]]
file = "m.glb"
translate = [0, 1.3, 0]
rotate = [-50, 0, 0]
material = "clay"

[[sphere]]                   # the mirror
center = [-1.37, 0.2, 0.9]
radius = 0.2
material = "mirror"

[[sphere]]                   # the glass
center = [1.34, 0.2, 0.85]
radius = 0.2
material = "glass"

[[light]]
kind = "point"
position = [-4, 7, 9]

[[material]]
name = "ground"
diffuse = [0.55, 0.5, 0.42]

[[material]]
name = "clay"
diffuse = [0.8, 0.36, 0.22]
specular = 0.4
shininess = 50

[[material]]
name = "mirror"
diffuse = 0
reflect = 0.9

[[material]]
name = "glass"
transmit = 1
ior = 1.5
"##;
