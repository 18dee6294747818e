//! The triangle mesh.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::positions::{GRAIN, Positions};
use crate::geometry::Bounds;

/// The index of a mesh in `Scene::meshes`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MeshId(pub u32);

/// A triangle mesh in its own space, with the vertices as the file has them.
///
/// The optional attributes are empty, or as long as `positions`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The name, which may be empty.
    pub name: String,
    /// The positions of the vertices; all finite.
    pub positions: Positions,
    /// The three vertices of each triangle, as indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// The normal of each vertex, of any length but zero, for smooth shading; flat shading if empty.
    pub normals: Vec<[f32; 3]>,
    /// The texture coordinates of each vertex, v pointing down the image as in glTF.
    pub uvs: Vec<[f32; 2]>,
    /// The second set of texture coordinates.
    pub second_uvs: Vec<[f32; 2]>,
    /// The colour of each vertex, multiplied with the diffuse colour, linear Rec. 709.
    pub colors: Vec<[f32; 3]>,
    /// The alpha of each vertex, multiplied with that of the material, where this has a
    /// [`Coverage`](crate::scene::Coverage).
    pub alphas: Vec<f32>,
    /// The tangent of each vertex, along which u of a normal map grows, and the sign of the bitangent
    /// normal × tangent · sign, which points up in the image, as in glTF. Without tangents a normal map
    /// follows the texture coordinates of each triangle.
    pub tangents: Vec<[f32; 4]>,
}

impl Mesh {
    /// The vertices of a triangle, in the mesh's space.
    ///
    /// # Panics
    /// When there is no such triangle.
    #[inline(always)]
    pub fn triangle_vertices(&self, triangle: u32) -> [DVec3; 3] {
        self.corners(&self.triangles[triangle as usize])
    }

    /// The positions of the corners of a triangle with these vertices.
    ///
    /// # Panics
    /// When there is no such vertex.
    #[inline(always)]
    pub(crate) fn corners(&self, vertices: &[u32; 3]) -> [DVec3; 3] {
        // Asked once whether they are f32, not for each of the three.
        match &self.positions {
            Positions::F32(p) => vertices.map(|i| DVec3::from(p[i as usize].map(f64::from))),
            Positions::F64(p) => vertices.map(|i| DVec3::from(p[i as usize])),
        }
    }

    /// Interpolates a vertex attribute at a point of a triangle, by the weights of its vertices.
    #[inline]
    pub(crate) fn interpolate<const N: usize>(
        &self,
        attribute: &[[f32; N]],
        triangle: u32,
        weights: [f64; 3],
    ) -> [f32; N] {
        let mut mean = [0.0; N];
        for (&i, w) in self.triangles[triangle as usize].iter().zip(weights) {
            mean = std::array::from_fn(|k| mean[k] + attribute[i as usize][k] * w as f32);
        }
        mean
    }

    /// The texture coordinates, in both sets, at a point of a triangle; 0 in a set that the mesh does
    /// not have.
    #[inline]
    pub(crate) fn uv(&self, triangle: u32, weights: [f64; 3]) -> [[f32; 2]; 2] {
        [&self.uvs, &self.second_uvs].map(|uvs| {
            if uvs.is_empty() { [0.0; 2] } else { self.interpolate(uvs, triangle, weights) }
        })
    }

    /// The alpha at a point of a triangle; 1 if the vertices have none.
    #[inline]
    pub(crate) fn alpha(&self, triangle: u32, weights: [f64; 3]) -> f32 {
        if self.alphas.is_empty() {
            return 1.0;
        }
        let vertices = self.triangles[triangle as usize].iter().zip(weights);
        vertices.map(|(&i, w)| self.alphas[i as usize] * w as f32).sum()
    }

    /// True if all indices of the triangles are those of vertices.
    pub(crate) fn has_all_vertices(&self) -> bool {
        let greatest = |t: &[[u32; 3]]| t.as_flattened().iter().copied().max();
        let count = self.positions.len();
        self.triangles.par_chunks(GRAIN).all(|t| greatest(t).is_none_or(|v| (v as usize) < count))
    }

    /// The bounding box of the vertices that triangles use.
    pub fn bounds(&self) -> Bounds {
        // In the kind of number that the positions have, which rounds nothing: the extremes are
        // coordinates of vertices.
        let (nothing, wide_nothing) =
            ([Vec3A::INFINITY, Vec3A::NEG_INFINITY], [DVec3::INFINITY, DVec3::NEG_INFINITY]);
        let [lower, upper] = match &self.positions {
            Positions::F32(positions) => {
                let around = |[lower, upper]: [Vec3A; 2], i: u32| {
                    let p = Vec3A::from(positions[i as usize]);
                    [lower.min(p), upper.max(p)]
                };
                let union = |a: [Vec3A; 2], b: [Vec3A; 2]| [a[0].min(b[0]), a[1].max(b[1])];
                self.fold_vertices(nothing, around, union).map(Vec3A::as_dvec3)
            }
            Positions::F64(positions) => {
                let around = |[lower, upper]: [DVec3; 2], i: u32| {
                    let p = DVec3::from(positions[i as usize]);
                    [lower.min(p), upper.max(p)]
                };
                let union = |a: [DVec3; 2], b: [DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
                self.fold_vertices(wide_nothing, around, union)
            }
        };
        // −0 becomes 0, so that the box does not depend on the order of vertices.
        Bounds { lower: lower + DVec3::ZERO, upper: upper + DVec3::ZERO }
    }

    /// Folds the vertices of all triangles, part by part in parallel.
    fn fold_vertices<T: Copy + Send + Sync>(
        &self,
        start: T,
        fold: impl Fn(T, u32) -> T + Sync,
        union: impl Fn(T, T) -> T + Sync + Send,
    ) -> T {
        let part = |triangles: &[[u32; 3]]| {
            triangles.as_flattened().iter().fold(start, |sum, &i| fold(sum, i))
        };
        self.triangles.par_chunks(GRAIN).map(part).reduce(|| start, union)
    }
}
