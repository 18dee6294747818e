//! The repair of meshes that importers read: it makes them valid, and counts what that changes.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::diagnostics::Diagnostics;
use super::report::DropReason;
use crate::scene::{FaceMap, GRAIN, Mesh, Positions};

/// Drops triangles that are not valid, from the map of their `faces`, too, and repairs normals, texture
/// coordinates, colours and tangents, so that the mesh is valid.
pub fn repair(mesh: &mut Mesh, faces: &mut FaceMap, diagnostics: &mut Diagnostics, path: &str) {
    let place = || path.to_owned();
    let count = mesh.positions.len();
    for length in [mesh.normals.len(), mesh.uvs.len(), mesh.colors.len(), mesh.tangents.len()] {
        debug_assert!(length == 0 || length == count);
    }

    // Triangles whose corners are missing or not finite.
    if !mesh.has_all_vertices() {
        let is_there = |t: &[u32; 3]| t.iter().all(|&i| (i as usize) < count);
        let dropped = retain(&mut mesh.triangles, faces, is_there);
        diagnostics.drop(DropReason::IndexOutOfRange, dropped, place);
    }
    if !mesh.positions.are_finite() {
        let is_finite: Vec<bool> = mesh.positions.iter().map(DVec3::is_finite).collect();
        let all_finite = |t: &[u32; 3]| t.iter().all(|&i| is_finite[i as usize]);
        let dropped = retain(&mut mesh.triangles, faces, all_finite);
        diagnostics.drop(DropReason::NotFinite, dropped, place);
        mesh.positions =
            mesh.positions.map(|i, position| if is_finite[i] { position } else { DVec3::ZERO });
    }

    // Triangles with two corners at one position.
    let dropped = match &mesh.positions {
        Positions::F32(positions) => drop_degenerate(positions, &mut mesh.triangles, faces),
        Positions::F64(positions) => drop_degenerate(positions, &mut mesh.triangles, faces),
    };
    diagnostics.drop(DropReason::Degenerate, dropped, place);

    // Attributes.
    let bad = repair_normals(mesh);
    let reason = "{} normals have no direction; the surface's own take their place";
    diagnostics.add(reason, bad, place);

    // Texture coordinates.
    let bad = repair_uvs(&mut mesh.uvs) + repair_uvs(&mut mesh.second_uvs);
    diagnostics.add("{} texture coordinates are not finite and become 0", bad, place);

    // Colours and alphas.
    let colors = mesh.colors.iter_mut().flatten().chain(&mut mesh.alphas);
    let bad = colors.filter(|x| !(x.is_finite() && **x >= 0.0)).map(|x| *x = 0.0).count();
    let reason = "{} vertex colours are negative or not finite and become 0";
    diagnostics.add(reason, bad as u64, place);

    // Tangents, which can be derived from the other attributes.
    let is_valid = |&[x, y, z, sign]: &[f32; 4]| {
        let length = Vec3::new(x, y, z).length_squared();
        length > 0.0 && length.is_finite() && sign.abs() == 1.0
    };
    let bad = mesh.tangents.iter().filter(|t| !is_valid(t)).count();
    let reason = "{} tangents have no direction or no sign; all of the mesh are made anew";
    diagnostics.add(reason, bad as u64, place);
    if bad > 0 {
        mesh.tangents.clear();
    }
}

/// Retains some of the triangles, and returns the number of the others.
fn retain(
    triangles: &mut Vec<[u32; 3]>,
    faces: &mut FaceMap,
    is_retained: impl Fn(&[u32; 3]) -> bool,
) -> u64 {
    let before = triangles.len();
    faces.retain(triangles.iter().map(&is_retained));
    triangles.retain(is_retained);
    (before - triangles.len()) as u64
}

/// Drops triangles with two corners at one position, and returns their number. Those whose corners
/// are only collinear remain: they close the seams between large faces and several small ones.
fn drop_degenerate<T: Copy + PartialEq + Sync>(
    positions: &[[T; 3]],
    triangles: &mut Vec<[u32; 3]>,
    faces: &mut FaceMap,
) -> u64 {
    let is_degenerate = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        (a == b) | (b == c) | (c == a)
    };
    // Nearly always there are none, which is found in parallel.
    if !triangles.par_chunks(GRAIN).any(|t| t.iter().any(is_degenerate)) {
        return 0;
    }
    retain(triangles, faces, |t| !is_degenerate(t))
}

/// Replaces texture coordinates that are not finite with 0, and returns their number.
fn repair_uvs(uvs: &mut [[f32; 2]]) -> u64 {
    // Nearly always there are none, which is found in parallel.
    let all_finite =
        |uvs: &[[f32; 2]]| uvs.as_flattened().iter().fold(true, |all, x| all & x.is_finite());
    if uvs.par_chunks(GRAIN).all(all_finite) {
        return 0;
    }
    let bad = uvs.iter_mut().flatten().filter(|x| !x.is_finite());
    bad.map(|x| *x = 0.0).count() as u64
}

/// Replaces normals without a direction with the mean normal of the triangles at their vertex, and
/// returns their number; if no normal has a direction, the mesh has none afterwards.
fn repair_normals(mesh: &mut Mesh) -> u64 {
    let is_bad = |n: &[f32; 3]| {
        let length = Vec3::from(*n).length_squared();
        !(length > 0.0 && length.is_finite())
    };
    // Nearly always all are good, which is found in parallel.
    if !mesh.normals.par_chunks(GRAIN).any(|normals| normals.iter().any(is_bad)) {
        return 0;
    }
    // An unnormalised normal can be tiny or huge and still have a direction.
    for normal in mesh.normals.iter_mut().filter(|n| is_bad(n)) {
        let largest = normal.iter().fold(0f32, |m, x| m.max(x.abs()));
        if largest > 0.0 && normal.iter().all(|x| x.is_finite()) {
            *normal = normal.map(|x| x / largest);
        }
    }

    // What is left has no direction of its own.
    let bad = mesh.normals.iter().filter(|n| is_bad(n)).count();
    if bad == mesh.normals.len() {
        mesh.normals.clear();
    } else if bad > 0 {
        // Sums of the triangles' normals, weighted by area.
        let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
        for triangle in &mesh.triangles {
            let [a, b, c] = mesh.corners(triangle);
            let normal = (b - a).cross(c - a);
            triangle.iter().for_each(|&i| sums[i as usize] += normal);
        }
        for (normal, sum) in mesh.normals.iter_mut().zip(sums).filter(|(n, _)| is_bad(n)) {
            *normal = sum.try_normalize().unwrap_or(DVec3::Y).as_vec3().to_array();
        }
    }
    bad as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn square() -> Mesh {
        Mesh {
            positions: vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]].into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    fn repaired(mut mesh: Mesh) -> (Mesh, Vec<String>) {
        let mut diagnostics = Diagnostics::default();
        repair(&mut mesh, &mut FaceMap::Unrecorded, &mut diagnostics, "here");
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
        mesh.positions = mesh.positions.map(|i, p| if i == 3 { DVec3::NAN } else { p });
        let (mesh, said) = repaired(mesh);
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert!(mesh.positions.are_finite());
        assert_eq!(said.len(), 1);
    }

    #[test]
    fn triangle_with_two_corners_at_one_place_is_dropped_and_counted() {
        let mut mesh = square();
        let positions = mesh.positions.to_vec();
        mesh.positions = [&*positions, &[[-0.0, 1.0, 0.0]]].concat().into();
        mesh.triangles = vec![[0, 1, 2], [2, 3, 4], [1, 1, 2]];
        let mut diagnostics = Diagnostics::default();
        repair(&mut mesh, &mut FaceMap::Unrecorded, &mut diagnostics, "here");
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        let report = diagnostics.into_report(std::path::Path::new("m"), &Scene::default());
        assert_eq!(report.dropped, [(DropReason::Degenerate, 2)].into());
        assert_eq!(report.warnings, [""; 0], "nothing that could be seen is lost");
    }

    #[test]
    fn triangle_whose_corners_stand_in_line_is_kept() {
        let mut mesh = square();
        mesh.positions = mesh.positions.map(|i, p| if i == 2 { DVec3::X * 2.0 } else { p });
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
