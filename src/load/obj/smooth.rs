//! The normals of a smoothing group whose faces bring none.

use std::collections::HashMap;

use glam::DVec3;

use crate::scene::Mesh;

/// At each place the mean of the normals of the triangles that meet there, weighted by their
/// angles, so that it doesn't matter how polygons were cut (G. Thürmer and C. Wüthrich,
/// "Computing vertex normals from polygonal facets", 1998), and however many vertices stand there
/// for the sake of textures.
pub fn normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let key = |p: &[f32; 3]| p.map(|x| (x + 0.0).to_bits());
    let mut sums: HashMap<[u32; 3], DVec3> = HashMap::new();
    for triangle in &mesh.triangles {
        let corners = triangle.map(|i| super::position(&mesh.positions, i));
        for k in 0..3 {
            let [here, next, last] = [0, 1, 2].map(|j| corners[(k + j) % 3]);
            let normal = (next - here).cross(last - here).normalize_or_zero();
            let angle = (next - here).angle_between(last - here);
            let weighted = if angle.is_finite() { normal * angle } else { DVec3::ZERO };
            if let Some(p) = mesh.positions.get(triangle[k] as usize) {
                *sums.entry(key(p)).or_default() += weighted;
            }
        }
    }
    let normal = |p: &[f32; 3]| sums.get(&key(p)).copied().unwrap_or_default();
    mesh.positions.iter().map(|p| normal(p).normalize_or_zero().as_vec3().to_array()).collect()
}
