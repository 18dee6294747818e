//! The removal of unused vertices. Some exporters let all primitives of a model share one large
//! array of vertices; the mesh of each must not keep all of them.

use crate::scene::Mesh;

/// Drops the vertices that no triangle uses, if they are more than half of all, and then returns
/// the former indices of the others.
pub fn compact(mesh: &mut Mesh) -> Option<Vec<usize>> {
    if uses_half(mesh) {
        return None;
    }
    // The vertices in use get new indices, in the order in which triangles first name them.
    const UNUSED: u32 = u32::MAX;
    let mut new_index = vec![UNUSED; mesh.positions.len()];
    let mut kept: Vec<usize> = Vec::new();
    for &i in mesh.triangles.as_flattened() {
        if let Some(new) = new_index.get_mut(i as usize).filter(|new| **new == UNUSED) {
            *new = kept.len() as u32;
            kept.push(i as usize);
        }
    }

    // The triangles are renumbered, and the attributes reordered to match.
    for i in mesh.triangles.as_flattened_mut() {
        *i = new_index.get(*i as usize).copied().unwrap_or(UNUSED);
    }
    mesh.positions = mesh.positions.select(&kept);
    retain_vertices(&mut mesh.normals, &kept);
    retain_vertices(&mut mesh.uvs, &kept);
    retain_vertices(&mut mesh.second_uvs, &kept);
    retain_vertices(&mut mesh.colors, &kept);
    retain_vertices(&mut mesh.alphas, &kept);
    retain_vertices(&mut mesh.tangents, &kept);
    Some(kept)
}

/// True if triangles use half of the vertices or more.
fn uses_half(mesh: &Mesh) -> bool {
    let mut is_used = vec![false; mesh.positions.len()];
    let mut missing = mesh.positions.len().div_ceil(2);
    for &i in mesh.triangles.as_flattened() {
        if missing == 0 {
            break;
        }
        if let Some(used) = is_used.get_mut(i as usize) {
            missing -= usize::from(!*used);
            *used = true;
        }
    }
    missing == 0
}

/// Retains the values of some vertices, in this order; an attribute that is missing stays empty.
pub fn retain_vertices<T: Copy>(values: &mut Vec<T>, kept: &[usize]) {
    if !values.is_empty() {
        *values = kept.iter().filter_map(|&i| values.get(i)).copied().collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unused_vertices_go_when_they_are_many() {
        let positions = (0..9).map(|i| [i as f32; 3]).collect();
        let uvs: Vec<_> = (0..9).map(|i| [i as f32; 2]).collect();
        let mut mesh = Mesh { positions, uvs, triangles: vec![[8, 2, 4]], ..Mesh::default() };
        compact(&mut mesh);
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert_eq!(mesh.positions, [[8.; 3], [2.; 3], [4.; 3]]);
        assert_eq!(mesh.uvs, [[8.; 2], [2.; 2], [4.; 2]]);
        assert!(mesh.normals.is_empty());
    }

    #[test]
    fn vertices_stay_as_they_are_when_most_are_used() {
        let positions = (0..4).map(|i| [i as f32; 3]).collect();
        let mesh = Mesh { positions, triangles: vec![[3, 2, 0]], ..Mesh::default() };
        let mut same = mesh.clone();
        compact(&mut same);
        assert_eq!(same, mesh);
    }
}
