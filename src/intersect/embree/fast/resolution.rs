//! The meshes that f32 does not resolve: their triangles are too small for the scene, or needles.

use glam::DVec3;

use crate::geometry::triangle::area_normal;
use crate::intersect::embree::f32_space::F32Space;
use crate::scene::{Mesh, Scene};

/// The greatest ratio of the longest side of the scene's box to the detail of a mesh that is left to f32.
///
/// Its f32 rays may be off by 40 · 2⁻²⁴ = 1 / 420,000 of that side (`f32_space.rs` derives it), so that finer
/// detail could not be told apart at all; but some rays hit a neighbour already where triangles are larger.
/// Measured on a ball at the end of its scene, the share of rays that do is 1.2e-5 at a ratio of 1e3, 7.6e-5
/// at 1e4 and 1.5e-3 at 1e5; `fast` promises 1e-4.
const FAST_RATIO: f64 = 1e4;
/// The ratio of a triangle's height to its longest side below which it is a needle.
const NEEDLE: f64 = 1.0 / 512.0;
/// The share of needles from which on a mesh is not left to f32.
const NEEDLE_SHARE: f64 = 1.0 / 8.0;
/// The number of triangles by which a mesh is judged.
const SAMPLES: usize = 256;

/// Returns for each mesh whether precision `fast` must test its triangles in f64 alone, as f32 does not
/// tell which one a ray hits.
pub fn unresolved_meshes(scene: &Scene, space: &F32Space) -> Vec<bool> {
    let shapes: Vec<Shape> = scene.meshes.iter().map(|mesh| Shape::of(mesh)).collect();
    let mut unresolved: Vec<bool> = shapes.iter().map(|shape| shape.has_needles).collect();
    for instance in &scene.instances {
        let mesh = instance.mesh.0 as usize;
        // The mean scale; exact where it is the same along all axes.
        let scale = instance.transform.matrix3.determinant().abs().cbrt();
        unresolved[mesh] |= shapes[mesh].detail * scale * FAST_RATIO < space.extent;
    }
    unresolved
}

/// The detail of a mesh and whether it has needles, by a sample of its triangles.
struct Shape {
    /// The square root of their mean area.
    detail: f64,
    has_needles: bool,
}

impl Shape {
    fn of(mesh: &Mesh) -> Self {
        let count = mesh.triangles.len();
        // An odd step, as triangles often come in pairs.
        let samples = (0..count).step_by((count / SAMPLES) | 1);
        let (mut area, mut needles, mut seen) = (0.0, 0, 0_usize);
        for index in samples {
            let [a, b, c] = mesh.triangle_vertices(index as u32);
            let double_area = area_normal([a, b, c]).length();
            let squared = |side: DVec3| side.length_squared();
            let longest = squared(b - a).max(squared(c - b)).max(squared(a - c));
            area += 0.5 * double_area;
            // Nothing hits a triangle without a height.
            needles += usize::from(double_area > 0.0 && double_area < NEEDLE * longest);
            seen += 1;
        }
        let has_needles = needles as f64 > NEEDLE_SHARE * seen as f64;
        Self { detail: (area / seen.max(1) as f64).sqrt(), has_needles }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Bounds;
    use crate::scene::{Instance, MaterialId};
    use glam::DAffine3;

    /// Tells whether a mesh of two triangles, this wide and long, is unresolved in a scene of size 1.
    fn is_unresolved(width: f32, length: f32) -> bool {
        let mut scene = Scene::default();
        let positions =
            vec![[0.; 3], [length, 0., 0.], [0., width, 0.], [length, width, 0.]].into();
        let triangles = vec![[0, 1, 2], [1, 3, 2]];
        let mesh = scene.add_mesh(Mesh { positions, triangles, ..Mesh::default() });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
        let space = F32Space::from_bounds(Bounds { lower: DVec3::ZERO, upper: DVec3::ONE });
        unresolved_meshes(&scene, &space) == [true]
    }

    #[test]
    fn needles_and_tiny_triangles_are_not_resolved() {
        for (width, length) in [(1e-3, 1.0), (1e-12, 1.0), (1e-5, 1e-5), (1e-30, 1e-20)] {
            assert!(is_unresolved(width, length), "{width} {length}");
        }
    }

    #[test]
    fn ordinary_triangles_are_resolved() {
        for (width, length) in [(1.0, 1.0), (1e-3, 1e-3), (0.01, 1.0)] {
            assert!(!is_unresolved(width, length), "{width} {length}");
        }
    }
}
