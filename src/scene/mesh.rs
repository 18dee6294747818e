//! Triangle meshes.

use glam::Vec3A;
use rayon::prelude::*;

use crate::geometry::Bounds;

/// How many vertices or triangles a thread looks at before another is asked to help.
pub(crate) const GRAIN: usize = 1 << 14;

/// The box that holds nothing.
const EMPTY_BOX: [Vec3A; 2] = [Vec3A::INFINITY, Vec3A::NEG_INFINITY];

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
    /// A second set of texture coordinates.
    pub second_uvs: Vec<[f32; 2]>,
    /// A colour for each vertex, multiplied with the diffuse colour, linear Rec. 709.
    pub colors: Vec<[f32; 3]>,
    /// The alpha of each vertex, multiplied with that of the material, where this has a
    /// [`Coverage`](crate::scene::Coverage).
    pub alphas: Vec<f32>,
    /// For each vertex the direction along which u grows on the picture of a normal map, and the
    /// sign of the third direction: normal × tangent · sign points up in the picture, as in glTF.
    /// Without them a normal map is laid on by the texture coordinates of each triangle.
    pub tangents: Vec<[f32; 4]>,
}

impl Mesh {
    /// The corners of a triangle, in the mesh's space.
    ///
    /// # Panics
    /// When there is no such triangle.
    #[inline(always)]
    pub fn triangle_vertices(&self, triangle: u32) -> [[f32; 3]; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }

    /// The mean of what the corners of a triangle have, by their weights.
    #[inline]
    pub(crate) fn interpolate<const N: usize>(
        &self,
        of_vertices: &[[f32; N]],
        triangle: u32,
        weights: [f64; 3],
    ) -> [f32; N] {
        let mut mean = [0.0; N];
        for (&i, w) in self.triangles[triangle as usize].iter().zip(weights) {
            mean = std::array::from_fn(|k| mean[k] + of_vertices[i as usize][k] * w as f32);
        }
        mean
    }

    /// The texture coordinates, in both sets, of a triangle's point by the weights of its corners;
    /// 0 in a set that the mesh does not have.
    #[inline]
    pub(crate) fn uv(&self, triangle: u32, weights: [f64; 3]) -> [[f32; 2]; 2] {
        [&self.uvs, &self.second_uvs].map(|uvs| match uvs.is_empty() {
            true => [0.0; 2],
            false => self.interpolate(uvs, triangle, weights),
        })
    }

    /// The alpha of a triangle's point.
    #[inline]
    pub(crate) fn alpha(&self, triangle: u32, weights: [f64; 3]) -> f32 {
        match self.alphas.is_empty() {
            true => 1.0,
            false => {
                let corners = self.triangles[triangle as usize].iter().zip(weights);
                corners.map(|(&i, w)| self.alphas[i as usize] * w as f32).sum()
            }
        }
    }

    /// Whether all positions are finite.
    pub(crate) fn is_finite(&self) -> bool {
        // Each chunk is gone through to its end, which lets the compiler take several at a time.
        let finite =
            |p: &[[f32; 3]]| p.as_flattened().iter().fold(true, |all, x| all & x.is_finite());
        self.positions.par_chunks(GRAIN).all(finite)
    }

    /// Whether all vertices that triangles name are there.
    pub(crate) fn has_all_vertices(&self) -> bool {
        let greatest = |t: &[[u32; 3]]| t.as_flattened().iter().copied().max();
        let count = self.positions.len();
        self.triangles.par_chunks(GRAIN).all(|t| greatest(t).is_none_or(|v| (v as usize) < count))
    }

    /// The box around the vertices that triangles use.
    pub fn bounds(&self) -> Bounds {
        // In f32, which rounds nothing: the extremes are coordinates of vertices.
        let around = |triangles: &[[u32; 3]]| {
            triangles.as_flattened().iter().fold(EMPTY_BOX, |[lower, upper], &i| {
                let p = Vec3A::from(self.positions[i as usize]);
                [lower.min(p), upper.max(p)]
            })
        };
        let union = |a: [Vec3A; 2], b: [Vec3A; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let [lower, upper] =
            self.triangles.par_chunks(GRAIN).map(around).reduce(|| EMPTY_BOX, union);
        // So that 0 has one sign, whichever vertex it came from.
        let [lower, upper] = [lower, upper].map(|p| (p + Vec3A::ZERO).as_dvec3());
        Bounds { lower, upper }
    }
}
