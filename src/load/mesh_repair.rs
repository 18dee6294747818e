//! The repair of a mesh that an importer has read: it makes the mesh valid, and counts the losses.

use glam::Vec3;
use rayon::prelude::*;

use super::diagnostics::Diagnostics;
use crate::load::report::DropReason;
use crate::scene::{GRAIN, Mesh};

/// Drops invalid triangles, and replaces invalid normals, texture coordinates and colours, so that the
/// mesh is valid.
pub fn repair(mesh: &mut Mesh, diagnostics: &mut Diagnostics, place: &str) {
    let first_place = || place.to_owned();
    let count = mesh.positions.len();
    // Triangles without a vertex, without a place or without an area.
    if !mesh.has_all_vertices() {
        let before = mesh.triangles.len();
        mesh.triangles.retain(|t| t.iter().all(|&i| (i as usize) < count));
        let dropped = (before - mesh.triangles.len()) as u64;
        diagnostics.drop(DropReason::IndexOutOfRange, dropped, first_place);
    }
    if !mesh.is_finite() {
        let finite: Vec<bool> =
            mesh.positions.iter().map(|p| p.iter().all(|x| x.is_finite())).collect();
        let before = mesh.triangles.len();
        mesh.triangles.retain(|t| t.iter().all(|&i| finite.get(i as usize) == Some(&true)));
        let dropped = (before - mesh.triangles.len()) as u64;
        diagnostics.drop(DropReason::NotFinite, dropped, first_place);
        for (position, finite) in mesh.positions.iter_mut().zip(finite) {
            if !finite {
                *position = [0.0; 3];
            }
        }
    }
    drop_degenerate(mesh, diagnostics, place);
    for length in [mesh.normals.len(), mesh.uvs.len(), mesh.colors.len(), mesh.tangents.len()] {
        debug_assert!(length == 0 || length == count);
    }
    // Attributes of vertices.
    repair_normals(mesh, diagnostics, place);
    let bad = repair_uvs(&mut mesh.uvs) + repair_uvs(&mut mesh.second_uvs);
    diagnostics.add("{} texture coordinates are not finite and become 0", bad, first_place);
    let mut bad = 0;
    let colors = mesh.colors.iter_mut().flatten().chain(&mut mesh.alphas);
    for color in colors.filter(|x| !(x.is_finite() && **x >= 0.0)) {
        *color = 0.0;
        bad += 1;
    }
    diagnostics.add("{} vertex colours are negative or not finite and become 0", bad, first_place);
    let is_valid = |t: &[f32; 4]| {
        let [x, y, z, sign] = *t;
        let length = Vec3::new(x, y, z).length_squared();
        length > 0.0 && length.is_finite() && sign.abs() == 1.0
    };
    let bad = mesh.tangents.iter().filter(|t| !is_valid(t)).count();
    diagnostics.add(
        "{} tangents have no direction or no sign; all of the mesh are made anew",
        bad as u64,
        first_place,
    );
    if bad > 0 {
        mesh.tangents.clear();
    }
}

/// Replaces texture coordinates that are not finite with 0, and counts them.
fn repair_uvs(uvs: &mut [[f32; 2]]) -> u64 {
    // Nearly always all are finite, which a parallel test tells fast.
    let finite =
        |uvs: &[[f32; 2]]| uvs.as_flattened().iter().fold(true, |all, x| all & x.is_finite());
    if uvs.par_chunks(GRAIN).all(finite) {
        return 0;
    }
    let bad = uvs.iter_mut().flatten().filter(|x| !x.is_finite());
    bad.map(|x| *x = 0.0).count() as u64
}

/// Drops triangles with two corners at one place. Those whose corners only stand in line are kept:
/// they close the seams between large faces and several small ones.
fn drop_degenerate(mesh: &mut Mesh, diagnostics: &mut Diagnostics, place: &str) {
    let Mesh { positions, triangles, .. } = mesh;
    let is_degenerate = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        (a == b) | (b == c) | (c == a)
    };
    if triangles.par_chunks(GRAIN).any(|t| t.iter().any(is_degenerate)) {
        let before = triangles.len();
        triangles.retain(|t| !is_degenerate(t));
        let dropped = (before - triangles.len()) as u64;
        diagnostics.drop(DropReason::Degenerate, dropped, || place.to_owned());
    }
}

/// Replaces a normal of length 0, or one that is not finite, by the mean of the triangles around its
/// vertex.
fn repair_normals(mesh: &mut Mesh, diagnostics: &mut Diagnostics, place: &str) {
    let is_bad = |n: &[f32; 3]| {
        let length = Vec3::from(*n).length_squared();
        !(length > 0.0 && length.is_finite())
    };
    if !mesh.normals.par_chunks(GRAIN).any(|normals| normals.iter().any(is_bad)) {
        return;
    }
    // An unnormalised normal can be tiny or huge and still have a direction.
    for normal in mesh.normals.iter_mut().filter(|n| is_bad(n)) {
        let largest = normal.iter().fold(0f32, |m, x| m.max(x.abs()));
        if largest > 0.0 && normal.iter().all(|x| x.is_finite()) {
            *normal = normal.map(|x| x / largest);
        }
    }
    let bad = mesh.normals.iter().filter(|n| is_bad(n)).count();
    if bad == 0 {
        return;
    }
    let reason = "{} normals have no direction; the surface's own take their place";
    diagnostics.add(reason, bad as u64, || place.to_owned());
    if bad == mesh.normals.len() {
        mesh.normals.clear();
        return;
    }
    // The sums of the triangles' normals, weighted by area.
    let mut sums = vec![glam::DVec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let corners = triangle.map(|i| {
            let p = mesh.positions.get(i as usize).copied().unwrap_or_default();
            glam::DVec3::from(p.map(f64::from))
        });
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        for &i in triangle {
            if let Some(sum) = sums.get_mut(i as usize) {
                *sum += normal;
            }
        }
    }
    for (normal, sum) in mesh.normals.iter_mut().zip(sums).filter(|(n, _)| is_bad(n)) {
        *normal = sum.try_normalize().unwrap_or(glam::DVec3::Y).as_vec3().to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Mesh {
        Mesh {
            positions: vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    fn repaired(mut mesh: Mesh) -> (Mesh, Vec<String>) {
        let mut diagnostics = Diagnostics::default();
        repair(&mut mesh, &mut diagnostics, "here");
        (mesh, diagnostics.warnings(std::path::Path::new("m")))
    }

    #[test]
    fn a_sound_mesh_is_left_as_it_is() {
        assert_eq!(repaired(square()), (square(), vec![]));
    }

    #[test]
    fn triangle_with_an_index_out_of_range_is_dropped_and_counted() {
        let (mesh, said) =
            repaired(Mesh { triangles: vec![[0, 1, 2], [0, 2, 4], [u32::MAX, 1, 2]], ..square() });
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert!(said.len() == 1 && said[0].contains("2 faces"), "{said:?}");
    }

    #[test]
    fn triangle_with_a_corner_that_is_no_number_is_dropped_and_counted() {
        let mut mesh = square();
        mesh.positions[3][1] = f32::NAN;
        let (mesh, said) = repaired(mesh);
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert!(mesh.positions.as_flattened().iter().all(|x| x.is_finite()));
        assert_eq!(said.len(), 1);
    }

    #[test]
    fn triangle_with_two_corners_at_one_place_is_dropped_and_counted() {
        let mut mesh = square();
        mesh.positions.push([-0.0, 1.0, 0.0]);
        mesh.triangles = vec![[0, 1, 2], [2, 3, 4], [1, 1, 2]];
        let (mesh, said) = repaired(mesh);
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert!(said.len() == 1 && said[0].contains("2 faces"), "{said:?}");
    }

    #[test]
    fn triangle_whose_corners_stand_in_line_is_kept() {
        let mut mesh = square();
        mesh.positions[2] = [2.0, 0.0, 0.0];
        assert_eq!(repaired(mesh.clone()), (mesh, vec![]));
    }

    #[test]
    fn normal_of_length_zero_becomes_the_surfaces() {
        let normals = vec![[1., 0., 0.], [0.; 3], [f32::NAN; 3], [1e-30, 0., 0.]];
        let (mesh, _) = repaired(Mesh { normals, ..square() });
        assert_eq!(mesh.normals, [[1., 0., 0.], [0., 0., 1.], [0., 0., 1.], [1., 0., 0.]]);
    }

    #[test]
    fn normals_all_of_length_zero_mean_flat_shading() {
        let (mesh, _) = repaired(Mesh { normals: vec![[0.; 3]; 4], ..square() });
        assert!(mesh.normals.is_empty());
    }
}
