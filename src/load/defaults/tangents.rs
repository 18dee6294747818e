//! The tangents of meshes with normal maps, by Mikkelsen's method: the one that programs paint the
//! maps for.

use std::collections::HashMap;
use std::sync::Arc;

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Affine2, DVec3, Vec2};
use rayon::prelude::*;

use crate::scene::{Mesh, Positions, Scene};

/// Adds tangents to the meshes whose material has a normal map and which have normals and texture
/// coordinates, but no tangents. Without normals a mesh is flat, and needs none.
pub fn add_tangents(scene: &mut Scene) {
    // The texture coordinates of the first normal map on each mesh: their set and their transform.
    let mut maps = vec![None; scene.meshes.len()];
    for instance in &scene.instances {
        let Some(material) = scene.materials.get(instance.material.0 as usize) else { continue };
        let (Some(map), Some(slot)) = (material.normal_map, maps.get_mut(instance.mesh.0 as usize))
        else {
            continue;
        };
        if let Some(texture) = scene.textures.get(map.texture.0 as usize) {
            slot.get_or_insert((texture.set, texture.transform));
        }
    }

    // Each mesh by itself, if it has what tangents are made from.
    scene.meshes.par_iter_mut().zip(maps).for_each(|(mesh, map)| {
        let Some((set, transform)) = map else { return };
        let has_uvs = if set == 0 { !mesh.uvs.is_empty() } else { !mesh.second_uvs.is_empty() };
        if has_uvs && mesh.tangents.is_empty() && !mesh.normals.is_empty() {
            add_to_mesh(Arc::make_mut(mesh), set, transform);
        }
    });
}

/// Adds tangents to a mesh. Vertices at which they differ from triangle to triangle are split.
fn add_to_mesh(mesh: &mut Mesh, set: u8, transform: Affine2) {
    let tangents = vec![None; mesh.triangles.len() * 3];
    // Far from its origin a mesh loses its detail in f32, in which tangents are computed.
    let center = match mesh.positions {
        Positions::F32(_) => DVec3::ZERO,
        Positions::F64(_) => mesh.bounds().center(),
    };
    let mut corners = Corners { mesh, center, set, transform, tangents };
    // It cannot fail: the error has no values.
    let _ = generate_tangents(&mut corners);
    let tangents = corners.tangents;

    // A vertex has one tangent, but the corners at it may have several.
    let count = mesh.positions.len();
    // The first tangent of a vertex stays with it; others get copies of the vertex.
    let mut first: Vec<Option<[f32; 4]>> = vec![None; count];
    let mut copies: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    let mut copied = Vec::new();
    for (index, tangent) in mesh.triangles.as_flattened_mut().iter_mut().zip(&tangents) {
        let Some(tangent) = *tangent else { continue };
        let at = *index as usize;
        if *first[at].get_or_insert(tangent) != tangent {
            *index = *copies.entry((*index, tangent.map(f32::to_bits))).or_insert_with(|| {
                copied.push((at, tangent));
                (count + copied.len() - 1) as u32
            });
        }
    }
    // Nothing shades by a tangent of what no triangle with texture coordinates uses.
    const UNUSED: [f32; 4] = [1.0, 0.0, 0.0, 1.0];
    mesh.tangents = first.into_iter().map(|tangent| tangent.unwrap_or(UNUSED)).collect();
    mesh.tangents.extend(copied.iter().map(|(_, tangent)| tangent));

    // The copies of the vertices, with all their attributes.
    let from: Vec<usize> = copied.into_iter().map(|(at, _)| at).collect();
    mesh.positions.append_copies(&from);
    append_copies(&mut mesh.normals, &from);
    append_copies(&mut mesh.uvs, &from);
    append_copies(&mut mesh.second_uvs, &from);
    append_copies(&mut mesh.colors, &from);
    append_copies(&mut mesh.alphas, &from);
}

/// Appends copies of an attribute's values, if the mesh has the attribute.
fn append_copies<T: Copy>(values: &mut Vec<T>, from: &[usize]) {
    if !values.is_empty() {
        values.extend(from.iter().map(|&i| values[i]).collect::<Vec<_>>());
    }
}

/// The corners of a mesh's triangles, and their tangents.
struct Corners<'m> {
    mesh: &'m Mesh,
    /// The point that positions are relative to.
    center: DVec3,
    set: u8,
    transform: Affine2,
    tangents: Vec<Option<[f32; 4]>>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        (self.mesh.positions.at(self.vertex(face, corner)) - self.center).as_vec3().to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let normal = glam::Vec3::from(self.mesh.normals[self.vertex(face, corner)]);
        normal.normalize_or(glam::Vec3::Y).to_array()
    }

    /// Returns texture coordinates whose v runs upward, since the third direction of the tangent space points up in the image.
    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uvs = if self.set == 0 { &self.mesh.uvs } else { &self.mesh.second_uvs };
        let uv = self.transform.transform_point2(Vec2::from(uvs[self.vertex(face, corner)]));
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        self.tangents[face * 3 + corner] = tangent.map(|t| t.tangent_encoded());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square in the plane z = 0, seen from +z, whose image is upright.
    fn square() -> Mesh {
        Mesh {
            positions: vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]].into(),
            normals: vec![[0., 0., 1.]; 4],
            uvs: vec![[0., 1.], [1., 1.], [1., 0.], [0., 0.]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn tangents_run_along_the_image_and_the_third_direction_up() {
        let mut mesh = square();
        add_to_mesh(&mut mesh, 0, Affine2::IDENTITY);
        // z × x · 1 is y, which is up in the image.
        assert_eq!(mesh.tangents, [[1., 0., 0., 1.]; 4]);
    }

    #[test]
    fn a_mirrored_image_changes_the_sign() {
        let mut mesh = square();
        mesh.uvs.iter_mut().for_each(|uv| uv[0] = 1.0 - uv[0]);
        add_to_mesh(&mut mesh, 0, Affine2::IDENTITY);
        assert_eq!(mesh.tangents, [[-1., 0., 0., -1.]; 4]);
    }

    #[test]
    fn a_turned_image_turns_the_tangents() {
        let mut mesh = square();
        (mesh.uvs, mesh.second_uvs) = (Vec::new(), mesh.uvs);
        // u on the image is v of the mesh, which runs down.
        let quarter = Affine2::from_cols_array(&[0., -1., 1., 0., 0., 0.]);
        add_to_mesh(&mut mesh, 1, quarter);
        assert_eq!(mesh.tangents, [[0., -1., 0., 1.]; 4]);
    }

    #[test]
    fn a_vertex_between_two_ways_to_lie_is_split() {
        let mut mesh = square();
        // The second triangle has the image mirrored about its diagonal.
        mesh.positions =
            mesh.positions.iter().chain([DVec3::new(-1., 1., 0.)]).map(|p| p.to_array()).collect();
        mesh.normals.push([0., 0., 1.]);
        mesh.uvs.push([1., 1.]);
        mesh.triangles = vec![[0, 1, 2], [0, 2, 4]];
        add_to_mesh(&mut mesh, 0, Affine2::IDENTITY);
        assert!(mesh.positions.len() > 5, "{:?}", mesh.tangents);
        assert_eq!(mesh.tangents.len(), mesh.positions.len());
        assert_eq!(mesh.triangles[0], [0, 1, 2]);
        assert!(mesh.has_all_vertices());
    }
}
