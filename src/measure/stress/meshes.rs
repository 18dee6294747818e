//! Closed meshes.

use std::collections::HashMap;

use glam::DVec3;

use crate::scene::Mesh;

/// Returns a mesh of vertices rounded to f32.
fn mesh(name: &str, positions: &[DVec3], triangles: Vec<[u32; 3]>) -> Mesh {
    let positions = positions.iter().map(|p| p.as_vec3().to_array()).collect();
    Mesh { name: name.into(), positions, triangles, ..Mesh::default() }
}

/// Returns a sphere of radius 1: an icosahedron whose triangles are divided in four, `level` times.
pub fn icosphere(level: u32) -> Mesh {
    // The twelve vertices of an icosahedron: the corners of three golden rectangles.
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions: Vec<DVec3> = [0, 1, 2]
        .into_iter()
        .flat_map(|axis| [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|s| (axis, s)))
        .map(|(axis, (a, b))| {
            let mut p = [0.0; 3];
            (p[axis], p[(axis + 1) % 3]) = (a, b * golden);
            DVec3::from(p).normalize()
        })
        .collect();
    // The faces are the triples of vertices that are neighbours.
    let near = |a: usize, b: usize| positions[a].dot(positions[b]) > 0.4;
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let normal = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
                    let outward = normal.dot(positions[a]) > 0.0;
                    let (b, c) = if outward { (b, c) } else { (c, b) };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    // Each triangle becomes four, by the middles of its edges, which its neighbours share.
    for _ in 0..level {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    mesh("icosphere", &positions, triangles)
}

/// Returns the cube from −1 to 1, each face divided into 2 n² triangles. The coordinates are
/// multiples of 1/n, which f32 represents exactly if n is a power of two.
pub fn cube(n: u32) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut indices = HashMap::new();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, n)]) {
        // The vertices of a face, of which those on the cube's edges belong to its neighbours as well.
        let mut vertex = |i: u32, j: u32| {
            let mut at = [0; 3];
            (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (side, i, j);
            *indices.entry(at).or_insert_with(|| {
                let p = at.map(|x| f64::from(x) / f64::from(n) * 2.0 - 1.0);
                positions.push(DVec3::from(p));
                positions.len() as u32 - 1
            })
        };
        // The squares of a face, each two triangles that wind counterclockwise seen from outside.
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] =
                [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| vertex(i, j));
            triangles.extend(if side == 0 {
                [[a, c, b], [a, d, c]]
            } else {
                [[a, b, c], [a, c, d]]
            });
        }
    }
    mesh("cube", &positions, triangles)
}

/// Returns a torus about the y axis, with radii 0.75 and 0.25 and 2 · `around` · `across` triangles.
pub fn torus(around: u32, across: u32) -> Mesh {
    let angle = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..around {
        let (sin, cos) = angle(i, around).sin_cos();
        for j in 0..across {
            let (up, out) = angle(j, across).sin_cos();
            let r = 0.75 + 0.25 * out;
            positions.push(DVec3::new(r * cos, 0.25 * up, r * sin));
            let index = |i: u32, j: u32| i % around * across + j % across;
            let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh("torus", &positions, triangles)
}

/// Returns an upright prism of radius and half height 1, whose base has `sides` corners.
pub fn prism(sides: u32) -> Mesh {
    // The middle of each end, and its corners.
    let mut positions = vec![DVec3::NEG_Y, DVec3::Y];
    let mut triangles = Vec::new();
    for i in 0..sides {
        let (sin, cos) = (f64::from(i) / f64::from(sides) * std::f64::consts::TAU).sin_cos();
        positions.extend([-1.0, 1.0].map(|y| DVec3::new(cos, y, sin)));
        let corner = |i: u32| 2 + i % sides * 2;
        let [a, b, c, d] = [corner(i), corner(i + 1), corner(i + 1) + 1, corner(i) + 1];
        triangles.extend([[0, a, b], [1, c, d], [a, c, b], [a, d, c]]);
    }
    mesh("prism", &positions, triangles)
}

/// Returns a pyramid over the square from −1 to 1 in the ground, whose apex is this high.
pub fn pyramid(height: f64) -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mut positions: Vec<DVec3> = corners.map(|(x, z)| DVec3::new(x, 0.0, z)).into();
    positions.push(DVec3::Y * height);
    let sides = (0..4).map(|i| [i, 4, (i + 1) % 4]);
    mesh("pyramid", &positions, sides.chain([[0, 1, 2], [0, 2, 3]]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_closed() {
        for mesh in [icosphere(2), cube(4), torus(24, 12), prism(7), pyramid(1e-9)] {
            let mut edges = HashMap::new();
            for t in &mesh.triangles {
                for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                    *edges.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
                    assert!(a != b);
                }
            }
            assert!(edges.values().all(|sum| *sum == 0), "{}", mesh.name);
            let (v, e, f) = (mesh.positions.len(), edges.len(), mesh.triangles.len());
            let euler = v as i64 - e as i64 + f as i64;
            assert_eq!(euler, if mesh.name == "torus" { 0 } else { 2 }, "{}", mesh.name);
        }
    }
}
