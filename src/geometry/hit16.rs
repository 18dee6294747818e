//! Hits in sixteen lanes, and batches of them.

use crate::geometry::{Geometry, Hit, LANES, Lanes, PrimitiveId};

/// Sixteen primitive ids side by side, any of which may name no primitive; see [`PrimitiveId`].
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub struct PrimitiveId16 {
    /// The geometries: [`PrimitiveId16::NONE`], [`PrimitiveId16::SPHERES`],
    /// [`PrimitiveId16::PLANES`], or [`PrimitiveId16::MESHES`] plus the mesh's index.
    pub geometry: Lanes<u32>,
    /// The indices of the primitives.
    pub primitive: Lanes<u32>,
    /// The indices of the instances; 0 for anything but a triangle.
    pub instance: Lanes<u32>,
}

impl PrimitiveId16 {
    /// The geometry code of no primitive.
    pub const NONE: u32 = 0;
    /// The geometry code of a sphere.
    pub const SPHERES: u32 = 1;
    /// The geometry code of a plane.
    pub const PLANES: u32 = 2;
    /// The geometry code of a triangle of mesh 0; that of mesh i is greater by i.
    pub const MESHES: u32 = 3;

    /// The id in lane `i`, if there is one.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Option<PrimitiveId> {
        let geometry = match self.geometry[i] {
            Self::NONE => return None,
            Self::SPHERES => Geometry::Spheres,
            Self::PLANES => Geometry::Planes,
            mesh => Geometry::Mesh(mesh - Self::MESHES),
        };
        Some(PrimitiveId { geometry, primitive: self.primitive[i], instance: self.instance[i] })
    }

    /// Sets the id in lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, id: Option<PrimitiveId>) {
        self.geometry[i] = match id.map(|id| id.geometry) {
            None => Self::NONE,
            Some(Geometry::Spheres) => Self::SPHERES,
            Some(Geometry::Planes) => Self::PLANES,
            Some(Geometry::Mesh(mesh)) => Self::MESHES + mesh,
        };
        self.primitive[i] = id.map_or(0, |id| id.primitive);
        self.instance[i] = id.map_or(0, |id| id.instance);
    }
}

/// The hits of sixteen rays side by side; see [`Hit`].
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub struct Hit16 {
    /// The distances; infinite where nothing is hit.
    pub t: Lanes<f64>,
    /// The weights of the triangles' second vertices; any number where nothing is hit.
    pub u: Lanes<f64>,
    /// The weights of the triangles' third vertices; any number where nothing is hit.
    pub v: Lanes<f64>,
    /// The primitives that are hit.
    pub id: PrimitiveId16,
}

impl Hit16 {
    /// The hit in lane `i`, if there is one.
    #[inline(always)]
    pub fn hit(&self, i: usize) -> Option<Hit> {
        self.id.get(i).map(|id| Hit { t: self.t[i], u: self.u[i], v: self.v[i], id })
    }

    /// Replaces the hits of `W` lanes from lane `start` on by hits on spheres or planes where these
    /// come first. `geometry` is the code of either, and `ts` are the distances, NaN for a miss. No
    /// lane may hold a hit on this geometry at the same distance.
    #[inline(always)]
    pub fn merge_closer<const W: usize>(
        &mut self,
        geometry: u32,
        primitive: &[u32; W],
        ts: &[f64; W],
        start: usize,
    ) {
        for i in 0..W {
            let (lane, t, id) = (start + i, ts[i], &mut self.id);
            let best = self.t[lane];
            // The tie rule: a sphere comes before a plane, and a plane before a mesh.
            let first = (t < best) | ((t == best) & (id.geometry[lane] >= PrimitiveId16::MESHES));
            // Selects rather than a branch, so that the loop vectorises.
            self.t[lane] = if first { t } else { best };
            self.u[lane] = if first { 0.0 } else { self.u[lane] };
            self.v[lane] = if first { 0.0 } else { self.v[lane] };
            id.geometry[lane] = if first { geometry } else { id.geometry[lane] };
            id.primitive[lane] = if first { primitive[i] } else { id.primitive[lane] };
            id.instance[lane] = if first { 0 } else { id.instance[lane] };
        }
    }

    /// Makes `W` lanes from lane `start` on miss.
    #[inline(always)]
    pub fn clear<const W: usize>(&mut self, start: usize) {
        for i in start..start + W {
            self.t[i] = f64::INFINITY;
            self.id.geometry[i] = PrimitiveId16::NONE;
        }
    }

    /// Sets the hit in lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, hit: Option<Hit>) {
        self.id.set(i, hit.map(|hit| hit.id));
        self.t[i] = hit.map_or(f64::INFINITY, |hit| hit.t);
        self.u[i] = hit.map_or(0.0, |hit| hit.u);
        self.v[i] = hit.map_or(0.0, |hit| hit.v);
    }
}

/// The hits of a batch of rays. In the last block the lanes beyond the batch's end miss.
#[derive(Clone, Debug, Default)]
pub struct HitBatch {
    blocks: Vec<Hit16>,
    len: usize,
}

impl HitBatch {
    /// Resizes the batch to `count` misses.
    pub fn reset_to_misses(&mut self, count: usize) {
        self.resize(count).iter_mut().for_each(|block| block.clear::<LANES>(0));
    }

    /// Resizes the batch to `count` hits of any value, and returns the blocks to be filled.
    pub fn resize(&mut self, count: usize) -> &mut [Hit16] {
        let blocks = count.div_ceil(LANES);
        if self.blocks.len() < blocks {
            self.blocks.resize(blocks, Hit16::default());
        }
        self.len = count;
        let all = &mut self.blocks[..blocks];
        if let Some(last) = all.last_mut() {
            // Packets narrower than a block may leave lanes beyond the batch's end untouched.
            last.clear::<LANES>(0);
        }
        all
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The hit of ray `i`, if there is one.
    ///
    /// # Panics
    /// When there is no ray `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Option<Hit> {
        assert!(i < self.len, "hit {i} of {}", self.len);
        self.blocks[i / LANES].hit(i % LANES)
    }

    /// Sets the hit of ray `i`.
    ///
    /// # Panics
    /// When there is no ray `i`.
    #[inline]
    pub fn set(&mut self, i: usize, hit: Option<Hit>) {
        assert!(i < self.len, "hit {i} of {}", self.len);
        self.blocks[i / LANES].set(i % LANES, hit);
    }

    /// The number of rays that hit something.
    pub fn count(&self) -> usize {
        let distances = self.blocks().iter().flat_map(|block| block.t);
        distances.filter(|&t| t < f64::INFINITY).count()
    }

    /// An iterator over the hits of all rays.
    pub fn iter(&self) -> impl Iterator<Item = Option<Hit>> {
        (0..self.len).map(|i| self.get(i))
    }

    /// The blocks of sixteen hits; the last may be partly filled.
    #[inline(always)]
    pub fn blocks(&self) -> &[Hit16] {
        &self.blocks[..self.len.div_ceil(LANES)]
    }

    /// The blocks of sixteen hits, mutable.
    #[inline(always)]
    pub fn blocks_mut(&mut self) -> &mut [Hit16] {
        &mut self.blocks[..self.len.div_ceil(LANES)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hits_are_nothing_until_they_are_set() {
        let mut hits = HitBatch::default();
        hits.reset_to_misses(18);
        let hit = Hit { t: 2.0, u: 0.5, v: 0.25, id: PrimitiveId::plane(1) };
        hits.set(17, Some(hit));
        assert_eq!((hits.get(17), hits.get(16)), (Some(hit), None));
        hits.reset_to_misses(18);
        assert!(hits.iter().all(|hit| hit.is_none()));
    }
}
