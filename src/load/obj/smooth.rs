//! The normals of a smoothing group whose faces bring none.

use glam::DVec3;
use rayon::prelude::*;

use crate::scene::Mesh;

/// Into how many shares triangles are cut, each with sums of its own: a fixed number, so that sums
/// are the same on any number of threads.
const SHARES: usize = 4;
/// Triangles that are worth a share.
const FEW: usize = 1 << 14;

/// At each place the mean of the normals of the triangles that meet there, weighted by their
/// angles, so that it doesn't matter how polygons were cut (G. Thürmer and C. Wüthrich,
/// "Computing vertex normals from polygonal facets", 1998), and however many vertices stand there
/// for the sake of textures.
pub fn normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let (places, count) = places(&mesh.positions);
    let share = mesh.triangles.len().div_ceil(SHARES).max(FEW);
    let sum = |triangles: &[[u32; 3]]| {
        let mut sums = vec![DVec3::ZERO; count];
        for triangle in triangles {
            let corners = triangle.map(|i| super::position(&mesh.positions, i));
            for (i, weighted) in triangle.iter().zip(weighted(corners)) {
                let place = places.get(*i as usize).and_then(|&place| sums.get_mut(place as usize));
                if let Some(sum) = place {
                    *sum += weighted;
                }
            }
        }
        sums
    };
    let shares: Vec<Vec<DVec3>> = mesh.triangles.par_chunks(share).map(sum).collect();
    let normal = |&place: &u32| {
        let sums = shares.iter().filter_map(|share| share.get(place as usize));
        sums.sum::<DVec3>().normalize_or_zero().as_vec3().to_array()
    };
    places.par_iter().map(normal).collect()
}

/// The number of the place where each vertex stands, and how many places there are.
fn places(positions: &[[f32; 3]]) -> (Vec<u32>, usize) {
    // Zero has two signs.
    let bits = |p: &[f32; 3]| p.map(|x| (x + 0.0).to_bits());
    let mut sorted: Vec<([u32; 3], u32)> =
        (0..).zip(positions).map(|(i, p)| (bits(p), i)).collect();
    sorted.par_sort_unstable();
    let mut places = vec![0; positions.len()];
    let mut count = 0;
    for group in sorted.chunk_by(|a, b| a.0 == b.0) {
        for &(_, i) in group {
            places[i as usize] = count;
        }
        count += 1;
    }
    (places, count as usize)
}

/// A triangle's unit normal times its angle at each corner.
fn weighted(corners: [DVec3; 3]) -> [DVec3; 3] {
    let [a, b, c] = corners;
    let edges = [b - a, c - b, a - c].map(DVec3::normalize_or_zero);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let angle = |from: DVec3, to: DVec3| (-from.dot(to)).clamp(-1.0, 1.0).acos();
    let [at_a, at_b] = [angle(edges[2], edges[0]), angle(edges[0], edges[1])];
    let at_c = std::f64::consts::PI - at_a - at_b;
    [at_a, at_b, at_c].map(|angle| if normal.is_finite() { normal * angle } else { DVec3::ZERO })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_of_a_triangle_weigh_its_normal() {
        let [a, b, c] = weighted([DVec3::ZERO, DVec3::X * 2.0, DVec3::new(0.0, 2.0, 0.0)]);
        let quarter = std::f64::consts::FRAC_PI_4;
        assert!((a - DVec3::Z * 2.0 * quarter).length() < 1e-15);
        assert!((b - DVec3::Z * quarter).length() < 1e-15);
        assert!((c - DVec3::Z * quarter).length() < 1e-15);
    }

    #[test]
    fn vertices_at_one_place_share_it() {
        let (places, count) = places(&[[0.0; 3], [1.0; 3], [-0.0, 0.0, -0.0], [1.0; 3], [2.0; 3]]);
        assert_eq!((places, count), (vec![0, 1, 0, 1, 2], 3));
    }
}
