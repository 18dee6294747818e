//! The vertex normals of a smoothing group whose faces bring none.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use crate::scene::{Mesh, Positions};

/// The number of shares of triangles, each with sums of its own: a fixed number, so that sums are the
/// same on any number of threads.
const SHARES: usize = 4;
/// The number of triangles whose angles are computed together.
const BLOCK: usize = 32;
/// The least number of triangles in a share.
const MIN_SHARE: usize = 1 << 14;
/// The multiplier of a hash: 2⁶⁴ divided by the golden ratio, odd (D. Knuth, "The Art of Computer Programming", 6.4).
const MIX: u64 = 0x9E37_79B9_7F4A_7C15;

/// Returns a normal for each vertex of a mesh: the mean of the normals of the triangles around its
/// position, weighted by their angles there, so that it doesn't matter how polygons were cut
/// (G. Thürmer and C. Wüthrich, "Computing vertex normals from polygonal facets", 1998), nor how many
/// vertices are at one position for the sake of textures.
pub fn smooth_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let welded = weld(&mesh.positions);
    // A face may name a vertex that is not there; it is dropped later.
    let position = |i: u32| match (i as usize) < welded.len() {
        true => mesh.positions.at(i as usize),
        false => DVec3::ZERO,
    };
    let count = welded.len();
    let share = mesh.triangles.len().div_ceil(SHARES).max(MIN_SHARE);
    // The weighted sums of a share of the triangles.
    let sum = |triangles: &[[u32; 3]]| {
        let mut sums = vec![DVec3::ZERO; count];
        for block in triangles.chunks(BLOCK) {
            let corners = block.iter().map(|t| t.map(position));
            let (normals, angles) = normals_and_angles(corners);
            for (k, triangle) in block.iter().enumerate() {
                for (i, angles) in triangle.iter().zip(&angles) {
                    let vertex = welded.get(*i as usize);
                    if let Some(sum) = vertex.and_then(|&vertex| sums.get_mut(vertex as usize)) {
                        *sum += normals[k] * angles[k];
                    }
                }
            }
        }
        sums
    };
    let shares: Vec<Vec<DVec3>> = mesh.triangles.par_chunks(share).map(sum).collect();
    // Their directions, the shares always added in the same order.
    let normal = |&vertex: &u32| {
        let sums = shares.iter().filter_map(|share| share.get(vertex as usize));
        sums.sum::<DVec3>().normalize_or_zero().as_vec3().to_array()
    };
    welded.par_iter().map(normal).collect()
}

/// Returns for each vertex the first one at the same position: vertices that are neighbours in a mesh
/// then have sums that are neighbours in memory.
fn weld(positions: &Positions) -> Vec<u32> {
    // Zero has two signs.
    let bits =
        |vertex: u32| (positions.at(vertex as usize) + DVec3::ZERO).to_array().map(f64::to_bits);
    let key = |vertex: u32| u64::from(hash(bits(vertex))) << 32 | u64::from(vertex);
    // Vertices sorted by the hashes of their positions.
    let vertices = 0..positions.len() as u32;
    let mut sorted: Vec<u64> = vertices.clone().into_par_iter().map(key).collect();
    sorted.par_sort_unstable();
    // Among those with the same hash, groups at the same position.
    let mut welded: Vec<u32> = vertices.collect();
    let mut group = Vec::new();
    for alike in sorted.chunk_by(|a, b| a >> 32 == b >> 32).filter(|alike| alike.len() > 1) {
        group.clear();
        group.extend(alike.iter().map(|&key| key as u32));
        group.sort_by_key(|&vertex| bits(vertex));
        for same in group.chunk_by(|&a, &b| bits(a) == bits(b)) {
            same.iter().for_each(|&vertex| welded[vertex as usize] = same[0]);
        }
    }
    welded
}

/// Returns the hash of a position: the product with an odd constant carries each bit of a sum up into
/// the upper half.
fn hash(position: [u64; 3]) -> u32 {
    let mix = |sum: u64, x: u64| (sum ^ x).wrapping_mul(MIX).rotate_left(32);
    position.into_iter().fold(0, mix) as u32
}

/// Computes the unit normals of up to [`BLOCK`] triangles, 0 where there is none, and their angles at
/// each corner: roots and angles of several at a time.
fn normals_and_angles(
    triangles: impl Iterator<Item = [DVec3; 3]>,
) -> ([DVec3; BLOCK], [[f64; BLOCK]; 3]) {
    let mut normals = [DVec3::ZERO; BLOCK];
    let mut angles = [[0.0; BLOCK]; 3];
    let mut squares = [[0.0; BLOCK]; 2];
    // Cosines of two angles, as a product and the square of the lengths to divide it by.
    for (k, [a, b, c]) in triangles.take(BLOCK).enumerate() {
        let [ab, bc, ca] = [b - a, c - b, a - c];
        normals[k] = ca.cross(ab).normalize_or_zero();
        let [square_ab, square_bc, square_ca] = [ab, bc, ca].map(DVec3::length_squared);
        (angles[0][k], squares[0][k]) = (-ca.dot(ab), square_ca * square_ab);
        (angles[1][k], squares[1][k]) = (-ab.dot(bc), square_ab * square_bc);
    }
    let [at_a, at_b, at_c] = &mut angles;
    for (angles, squares) in [&mut *at_a, &mut *at_b].into_iter().zip(&squares) {
        for (angle, square) in angles.iter_mut().zip(squares) {
            // Finite whatever the corners are.
            let cosine = *angle / square.max(f64::MIN_POSITIVE).sqrt();
            *angle = arc_cosine(if cosine > -1.0 { cosine.min(1.0) } else { -1.0 });
        }
    }
    // The third angle is what the others leave of 180°.
    for ((at_a, at_b), at_c) in at_a.iter().zip(at_b.iter()).zip(at_c) {
        *at_c = PI - at_a - at_b;
    }
    (normals, angles)
}

/// Returns the arc cosine of a number from −1 to 1, to within 2.2·10⁻⁸, several at a time (M. Abramowitz and I. Stegun,
/// "Handbook of Mathematical Functions", 4.4.46).
fn arc_cosine(x: f64) -> f64 {
    const A: [f64; 8] = [
        1.570_796_305_0,
        -0.214_598_801_6,
        0.088_978_987_4,
        -0.050_174_304_6,
        0.030_891_881_0,
        -0.017_088_125_6,
        0.006_670_090_1,
        -0.001_262_491_1,
    ];
    let size = x.abs();
    let angle = A.iter().rev().fold(0.0, |sum, a| sum * size + a) * (1.0 - size).sqrt();
    if x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_normal_of_a_triangle() {
        let corners = [DVec3::ZERO, DVec3::X * 2.0, DVec3::new(0.0, 2.0, 0.0)];
        let (normals, angles) = normals_and_angles([[DVec3::ZERO; 3], corners].into_iter());
        assert_eq!(normals[..2], [DVec3::ZERO, DVec3::Z]);
        for (angles, angle) in angles.iter().zip([PI / 2.0, PI / 4.0, PI / 4.0]) {
            assert!((angles[1] - angle).abs() < 5e-8, "{} {angle}", angles[1]);
        }
    }

    #[test]
    fn corners_that_are_not_finite_have_angles_and_no_normal() {
        for bad in [f64::NAN, f64::INFINITY] {
            let corners = [DVec3::ZERO, DVec3::X, DVec3::splat(bad)];
            let (normals, angles) = normals_and_angles([corners].into_iter());
            assert_eq!(normals[0], DVec3::ZERO);
            assert!(angles.iter().all(|angles| angles[0].is_finite()));
        }
    }

    #[test]
    fn arc_cosine_is_as_near_as_it_says() {
        for i in -10_000..=10_000 {
            let x = f64::from(i) * 1e-4;
            assert!((arc_cosine(x) - x.acos()).abs() <= 2.2e-8, "{x}");
        }
    }

    #[test]
    fn vertices_at_one_position_are_welded() {
        for scale in [1.0, 0.1] {
            let x = [0.0, 1.0, -0.0, 1.0, 2.0].map(|x| [x * scale; 3]);
            assert_eq!(weld(&x.to_vec().into()), [0, 1, 0, 1, 4]);
        }
    }

    #[test]
    fn different_positions_with_the_same_hash_are_not_welded() {
        // Among 2¹⁹ positions some of 2³² hashes come twice, almost surely.
        let mut seen = std::collections::HashMap::new();
        let positions = (1..1 << 19).map(|i| [3.0, 7.0, 11.0].map(|by| f64::from(i).sqrt() / by));
        let pair = { positions }.find_map(|p| {
            let other = seen.insert(hash(p.map(f64::to_bits)), p)?;
            Some([other, p])
        });
        let [a, b] = pair.expect("two positions with the same hash");
        assert_eq!(weld(&vec![a, b, a, b, [0.0; 3]].into()), [0, 1, 0, 1, 4]);
    }
}
