//! The positions of a mesh's vertices.

use glam::DVec3;
use rayon::prelude::*;

/// The grain size of parallel loops over vertices or triangles: the least number for one thread.
pub(crate) const GRAIN: usize = 1 << 14;

/// The positions of a mesh's vertices, in f32 or in f64.
///
/// Both are the same to all who read them: a position is a vector in f64. Positions in f64 that f32
/// holds exactly, all of them, are stored in f32, which takes half the memory.
///
/// ```
/// use envers::scene::Positions;
///
/// let near = Positions::from(vec![[0.0, 0.5, 3.0]]);
/// assert!(matches!(near, Positions::F32(_)));
/// let surveyed = Positions::from(vec![[388096.123, 5412345.75, 12.5]]);
/// assert_eq!(surveyed.at(0).y, 5412345.75);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Positions {
    /// Positions in f32.
    F32(Vec<[f32; 3]>),
    /// Positions in f64.
    F64(Vec<[f64; 3]>),
}

impl Default for Positions {
    fn default() -> Self {
        Self::F32(Vec::new())
    }
}

impl From<Vec<[f32; 3]>> for Positions {
    fn from(positions: Vec<[f32; 3]>) -> Self {
        Self::F32(positions)
    }
}

impl From<Vec<[f64; 3]>> for Positions {
    /// Stores the positions in f32 if that holds each of them exactly.
    fn from(positions: Vec<[f64; 3]>) -> Self {
        in_f32(&positions).unwrap_or(Self::F64(positions))
    }
}

impl FromIterator<[f32; 3]> for Positions {
    fn from_iter<I: IntoIterator<Item = [f32; 3]>>(positions: I) -> Self {
        Self::F32(positions.into_iter().collect())
    }
}

impl FromIterator<[f64; 3]> for Positions {
    /// Stores the positions in f32 if that holds each of them exactly.
    fn from_iter<I: IntoIterator<Item = [f64; 3]>>(positions: I) -> Self {
        Vec::from_iter(positions).into()
    }
}

impl<const N: usize> PartialEq<[[f64; 3]; N]> for Positions {
    fn eq(&self, other: &[[f64; 3]; N]) -> bool {
        self.to_vec() == *other
    }
}

impl From<&[[f64; 3]]> for Positions {
    /// Stores the positions in f32 if that holds each of them exactly.
    fn from(positions: &[[f64; 3]]) -> Self {
        in_f32(positions).unwrap_or_else(|| Self::F64(positions.to_vec()))
    }
}

/// Returns the positions in f32 if that holds each of them exactly.
fn in_f32(positions: &[[f64; 3]]) -> Option<Positions> {
    // A fold without early exit, which vectorises; what is not a number fits as well.
    let fits = |p: &[[f64; 3]]| {
        let is_f32 = |x: &f64| (f64::from(*x as f32) == *x) | x.is_nan();
        p.as_flattened().iter().fold(true, |all, x| all & is_f32(x))
    };
    let narrow = || positions.iter().map(|p| p.map(|x| x as f32)).collect();
    positions.par_chunks(GRAIN).all(fits).then(|| Positions::F32(narrow()))
}

impl Positions {
    /// The number of vertices.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(positions) => positions.len(),
            Self::F64(positions) => positions.len(),
        }
    }

    /// True if there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The position of a vertex.
    ///
    /// # Panics
    /// When there is no such vertex.
    #[inline(always)]
    pub fn at(&self, vertex: usize) -> DVec3 {
        match self {
            Self::F32(positions) => DVec3::from(positions[vertex].map(f64::from)),
            Self::F64(positions) => DVec3::from(positions[vertex]),
        }
    }

    /// The positions of all vertices, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = DVec3> + Clone {
        (0..self.len()).map(|vertex| self.at(vertex))
    }

    /// The positions of all vertices as arrays of f64.
    pub fn to_vec(&self) -> Vec<[f64; 3]> {
        self.iter().map(|p| p.to_array()).collect()
    }

    /// Returns other positions: what `moved` makes of each vertex and its position.
    pub fn map(&self, moved: impl Fn(usize, DVec3) -> DVec3 + Sync) -> Self {
        let vertices = (0..self.len()).into_par_iter().with_min_len(GRAIN);
        let positions: Vec<[f64; 3]> =
            vertices.map(|vertex| moved(vertex, self.at(vertex)).to_array()).collect();
        positions.into()
    }

    /// Returns the positions of some vertices, in the order given.
    ///
    /// # Panics
    /// When there is no such vertex.
    pub(crate) fn select(&self, vertices: &[usize]) -> Self {
        match self {
            Self::F32(positions) => Self::F32(vertices.iter().map(|&i| positions[i]).collect()),
            Self::F64(positions) => Self::F64(vertices.iter().map(|&i| positions[i]).collect()),
        }
    }

    /// Appends the positions of some vertices once more.
    ///
    /// # Panics
    /// When there is no such vertex.
    pub(crate) fn append_copies(&mut self, vertices: &[usize]) {
        match self {
            Self::F32(positions) => vertices.iter().for_each(|&i| positions.push(positions[i])),
            Self::F64(positions) => vertices.iter().for_each(|&i| positions.push(positions[i])),
        }
    }

    /// True if all positions are finite.
    pub(crate) fn are_finite(&self) -> bool {
        // Folds without early exit, which vectorise.
        let f32 = |p: &[[f32; 3]]| p.as_flattened().iter().fold(true, |all, x| all & x.is_finite());
        let f64 = |p: &[[f64; 3]]| p.as_flattened().iter().fold(true, |all, x| all & x.is_finite());
        match self {
            Self::F32(positions) => positions.par_chunks(GRAIN).all(f32),
            Self::F64(positions) => positions.par_chunks(GRAIN).all(f64),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_f32_holds_exactly_is_stored_in_f32() {
        let fitting = vec![[1.0, -0.5, 2f64.powi(100)], [f64::NAN, f64::INFINITY, -0.0]];
        assert!(matches!(Positions::from(fitting), Positions::F32(_)));
        for number in [0.1, 5412345.75, 16777217.0, 1e-60, 1e300] {
            let positions = Positions::from(vec![[0.0; 3], [0.0, number, 0.0]]);
            assert!(matches!(positions, Positions::F64(_)), "{number}");
            assert_eq!(positions.at(1).y, number);
        }
    }

    #[test]
    fn either_kind_selects_copies_and_maps_alike() {
        for scale in [1.0, 0.1] {
            let points = [[0.0; 3], [scale; 3], [2.0 * scale; 3]];
            let mut positions = Positions::from(points.to_vec());
            assert_eq!(
                positions.select(&[2, 0]).iter().map(|p| p.x).collect::<Vec<_>>(),
                [2.0 * scale, 0.0]
            );
            positions.append_copies(&[1]);
            assert_eq!((positions.len(), positions.at(3).x), (4, scale));
            let moved = positions.map(|vertex, p| p + vertex as f64);
            assert_eq!(moved.at(3), DVec3::splat(scale + 3.0));
            assert!(moved.are_finite() && !moved.map(|_, p| p / 0.0).are_finite());
        }
    }
}
