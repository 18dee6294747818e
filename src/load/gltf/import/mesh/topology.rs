//! The triangles of a primitive, by its mode and indices.

use gltf::json::mesh::Mode;

use crate::scene::FaceMap;

/// Returns the triangles of `vertices`, in the order in which a primitive names them.
///
/// Strips and fans wind as part 3.7.2.1 of the standard says. Vertices that don't fill a last
/// triangle are left out, as are all points and lines. A strip names a vertex twice to go on
/// elsewhere, which makes no triangle.
pub fn triangles(mode: Mode, vertices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
        Mode::Triangles => vertices.as_chunks().0.to_vec(),
        Mode::TriangleStrip => {
            // Every other triangle has its last two corners swapped, so that all wind alike.
            let wind = |(i, [a, b, c]): (usize, [u32; 3])| {
                if i % 2 == 0 { [a, b, c] } else { [a, c, b] }
            };
            let windows = vertices.windows(3).map(|w| [w[0], w[1], w[2]]);
            windows.enumerate().map(wind).filter(is_face).collect()
        }
        Mode::TriangleFan => match vertices {
            [first, rest @ ..] => rest.windows(2).map(|w| [w[0], w[1], *first]).collect(),
            [] => Vec::new(),
        },
    }
}

/// True if three corners of a strip make a triangle.
fn is_face([a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Returns the map from the [triangles] of `vertices` to their numbers in the primitive: in a strip, the
/// corners that join its parts count as triangles.
pub fn face_map(mode: Mode, vertices: &[u32]) -> FaceMap {
    if mode != Mode::TriangleStrip {
        return FaceMap::Consecutive(0);
    }
    let windows = (0..).zip(vertices.windows(3));
    let faces = windows.filter_map(|(i, w)| is_face(&[w[0], w[1], w[2]]).then_some(i));
    FaceMap::from_numbers(faces.collect())
}

/// Returns the number of points, lines or triangles that corners make; a last one that they do not
/// fill counts.
pub fn face_count(mode: Mode, corners: u64) -> u64 {
    match mode {
        Mode::Points | Mode::LineLoop => corners,
        Mode::Lines => corners.div_ceil(2),
        Mode::LineStrip => corners.saturating_sub(1),
        Mode::Triangles => corners.div_ceil(3),
        Mode::TriangleStrip | Mode::TriangleFan => corners.saturating_sub(2),
    }
}

/// True if corners do not fill a last triangle, or a first one.
pub fn is_incomplete(mode: Mode, corners: usize) -> bool {
    match mode {
        Mode::Triangles => !corners.is_multiple_of(3),
        _ => (1..3).contains(&corners),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strip_goes_on_elsewhere_by_naming_vertices_twice() {
        let made = triangles(Mode::TriangleStrip, &[0, 1, 2, 2, 3, 3, 4, 5]);
        assert_eq!(made, [[0, 1, 2], [3, 5, 4]]);
    }

    #[test]
    fn triangles_of_a_strip_keep_their_numbers() {
        let map = face_map(Mode::TriangleStrip, &[0, 1, 2, 2, 3, 3, 4, 5]);
        assert_eq!(map, FaceMap::Listed(vec![0, 5]));
        assert_eq!(face_map(Mode::TriangleStrip, &[0, 1, 2, 3]), FaceMap::Consecutive(0));
    }

    #[test]
    fn strip_turns_every_other_triangle() {
        let made = triangles(Mode::TriangleStrip, &[0, 1, 2, 3, 4]);
        assert_eq!(made, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
    }

    #[test]
    fn fan_goes_around_its_first_vertex() {
        assert_eq!(triangles(Mode::TriangleFan, &[7, 1, 2, 3]), [[1, 2, 7], [2, 3, 7]]);
    }

    #[test]
    fn too_few_vertices_make_no_triangle() {
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            for vertices in [&[][..], &[0], &[0, 1]] {
                assert!(triangles(mode, vertices).is_empty());
            }
        }
    }
}
