//! Triangle meshes.

use glam::DVec3;

use crate::geometry::Bounds;

/// The index of a mesh in `Scene::meshes`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MeshId(pub u32);

/// A triangle mesh in its own space, with the vertices as the file has them.
///
/// The optional attributes are empty, or as long as `positions`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Its name, or nothing.
    pub name: String,
    /// The vertices; all finite.
    pub positions: Vec<[f32; 3]>,
    /// Three indices into `positions` a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// A normal for each vertex, for smooth shading; of any length but zero. Empty: flat.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates for each vertex, v running down the image as in glTF.
    pub uvs: Vec<[f32; 2]>,
    /// A colour for each vertex, multiplied with the diffuse colour, linear Rec. 709.
    pub colors: Vec<[f32; 3]>,
}

impl Mesh {
    /// The corners of a triangle, in the mesh's space.
    ///
    /// # Panics
    /// When there is no such triangle.
    #[inline(always)]
    pub fn corners(&self, triangle: u32) -> [[f32; 3]; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }

    /// The box around the vertices that triangles use.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.triangles.iter().flatten().map(|&i| {
            let [x, y, z] = self.positions[i as usize];
            DVec3::new(x as f64, y as f64, z as f64)
        }))
    }
}
