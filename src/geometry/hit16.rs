//! What many rays hit, sixteen side by side.

use crate::geometry::{Geometry, Hit, LANES, Lanes, PrimitiveId};

/// Which primitives sixteen ids name, or none; see [`PrimitiveId`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct PrimitiveId16 {
    /// The geometries: [`PrimitiveId16::NONE`], [`PrimitiveId16::SPHERES`], [`PrimitiveId16::PLANES`], or [`PrimitiveId16::MESHES`] and the
    /// mesh's index.
    pub geometry: Lanes<u32>,
    /// The primitives' indices.
    pub primitive: Lanes<u32>,
    /// The instances' indices; 0 where it is no triangle.
    pub instance: Lanes<u32>,
}

impl PrimitiveId16 {
    /// No primitive.
    pub const NONE: u32 = 0;
    /// A sphere.
    pub const SPHERES: u32 = 1;
    /// A plane.
    pub const PLANES: u32 = 2;
    /// A triangle of the first mesh.
    pub const MESHES: u32 = 3;

    pub(super) const NOTHING: Self =
        Self { geometry: [0; LANES], primitive: [0; LANES], instance: [0; LANES] };

    /// The id in lane `i`.
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

    /// Sets lane `i`.
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

/// What sixteen rays hit; see [`Hit`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Hit16 {
    /// Distances; infinite where nothing is hit.
    pub t: Lanes<f64>,
    /// Weights of triangles' second vertices; any number where nothing is hit.
    pub u: Lanes<f64>,
    /// Weights of triangles' third vertices; any number where nothing is hit.
    pub v: Lanes<f64>,
    /// What is hit.
    pub id: PrimitiveId16,
}

impl Hit16 {
    const NOTHING: Self = Self {
        t: [f64::INFINITY; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
        id: PrimitiveId16::NOTHING,
    };

    /// The hit in lane `i`.
    #[inline(always)]
    pub fn hit(&self, i: usize) -> Option<Hit> {
        self.id.get(i).map(|id| Hit { t: self.t[i], u: self.u[i], v: self.v[i], id })
    }

    /// Merges hits on spheres or on planes into `W` lanes from lane `at` on: `geometry` is the code of
    /// either, and `ts` are the distances, NaN where there is no hit. No lane may hold a hit on another
    /// primitive of this geometry at the same distance.
    #[inline(always)]
    pub fn merge_closer<const W: usize>(
        &mut self,
        geometry: u32,
        primitive: &[u32; W],
        ts: &[f64; W],
        at: usize,
    ) {
        for i in 0..W {
            let (t, best) = (ts[i], self.t[at + i]);
            // At the same distance a sphere counts before a plane, and that before a mesh.
            let first =
                (t < best) | ((t == best) & (self.id.geometry[at + i] >= PrimitiveId16::MESHES));
            self.t[at + i] = if first { t } else { best };
            self.u[at + i] = if first { 0.0 } else { self.u[at + i] };
            self.v[at + i] = if first { 0.0 } else { self.v[at + i] };
            let id = &mut self.id;
            id.geometry[at + i] = if first { geometry } else { id.geometry[at + i] };
            id.primitive[at + i] = if first { primitive[i] } else { id.primitive[at + i] };
            id.instance[at + i] = if first { 0 } else { id.instance[at + i] };
        }
    }

    /// Makes `W` lanes from lane `at` on hit nothing.
    #[inline(always)]
    pub fn clear<const W: usize>(&mut self, at: usize) {
        for i in at..at + W {
            self.t[i] = f64::INFINITY;
            self.id.geometry[i] = PrimitiveId16::NONE;
        }
    }

    /// Sets lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, hit: Option<Hit>) {
        self.id.set(i, hit.map(|hit| hit.id));
        self.t[i] = hit.map_or(f64::INFINITY, |hit| hit.t);
        self.u[i] = hit.map_or(0.0, |hit| hit.u);
        self.v[i] = hit.map_or(0.0, |hit| hit.v);
    }
}

/// What a batch of rays hits. In the last sixteen the lanes beyond its end hit nothing.
#[derive(Clone, Debug, Default)]
pub struct HitBatch {
    blocks: Vec<Hit16>,
    len: usize,
}

impl HitBatch {
    /// Makes it `count` hits on nothing.
    pub fn reset_to_misses(&mut self, count: usize) {
        self.resize(count).iter_mut().for_each(|found| found.clear::<LANES>(0));
    }

    /// Makes it `count` hits, to be set to whatever they are, sixteen by sixteen.
    pub fn resize(&mut self, count: usize) -> &mut [Hit16] {
        let blocks = count.div_ceil(LANES);
        if self.blocks.len() < blocks {
            self.blocks.resize(blocks, Hit16::NOTHING);
        }
        self.len = count;
        let all = &mut self.blocks[..blocks];
        if let Some(last) = all.last_mut() {
            // Narrow packets need not reach the lanes beyond the batch's end.
            last.clear::<LANES>(0);
        }
        all
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// What ray `i` hits.
    ///
    /// # Panics
    /// When there is no ray `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Option<Hit> {
        assert!(i < self.len, "hit {i} of {}", self.len);
        self.blocks[i / LANES].hit(i % LANES)
    }

    /// Sets what ray `i` hits.
    ///
    /// # Panics
    /// When there is no ray `i`.
    #[inline]
    pub fn set(&mut self, i: usize, hit: Option<Hit>) {
        assert!(i < self.len, "hit {i} of {}", self.len);
        self.blocks[i / LANES].set(i % LANES, hit);
    }

    /// How many rays hit anything.
    pub fn count(&self) -> usize {
        let hits = |found: &Hit16| -> usize {
            found.t.iter().map(|&t| usize::from(t < f64::INFINITY)).sum()
        };
        self.blocks().iter().map(hits).sum()
    }

    /// All hits.
    pub fn iter(&self) -> impl Iterator<Item = Option<Hit>> {
        (0..self.len).map(|i| self.get(i))
    }

    /// The sixteens, of which the last may be partly filled.
    #[inline(always)]
    pub fn blocks(&self) -> &[Hit16] {
        &self.blocks[..self.len.div_ceil(LANES)]
    }

    /// The sixteens, to be set.
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
