//! Many rays and what they hit, sixteen side by side: as processors and packet tracers want them.

use glam::DVec3;

use crate::geometry::{Departure, Hit, Passage, PrimitiveId, Ray};

/// How many rays stand side by side: a multiple of every packet width there is.
pub const LANES: usize = 16;

/// One number for each of sixteen rays.
pub type Lanes<T> = [T; LANES];

/// Sixteen half-lines; see [`Ray`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Lines {
    /// Where they start, axis by axis.
    pub origin: [Lanes<f64>; 3],
    /// Where they go, axis by axis.
    pub direction: [Lanes<f64>; 3],
    /// Where they end.
    pub tmax: Lanes<f64>,
}

impl Lines {
    const NONE: Self =
        Self { origin: [[0.0; LANES]; 3], direction: [[0.0; LANES]; 3], tmax: [0.0; LANES] };

    /// Origin and direction in lane `i`.
    #[inline(always)]
    pub fn line(&self, i: usize) -> (DVec3, DVec3) {
        let at = |v: &[Lanes<f64>; 3]| DVec3::new(v[0][i], v[1][i], v[2][i]);
        (at(&self.origin), at(&self.direction))
    }
}

/// A batch of rays. Its memory is kept when it is cleared.
///
/// In the last sixteen the lanes beyond the batch's end hold any numbers.
#[derive(Clone, Debug, Default)]
pub struct Rays {
    lines: Vec<Lines>,
    len: usize,
    /// What each left; empty while none left anything.
    from: Vec<Option<Departure>>,
    /// How far each has come; empty while none went through anything.
    past: Vec<Option<Passage>>,
}

impl Rays {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.len = 0;
        self.from.clear();
        self.past.clear();
    }

    /// Makes it `blocks` times sixteen rays that left nothing, to be set to whatever they are.
    pub fn fill(&mut self, blocks: usize) -> &mut [Lines] {
        self.clear();
        self.reserve(blocks);
        self.len = blocks * LANES;
        &mut self.lines[..blocks]
    }

    /// Forgets all but the first `count`.
    pub fn truncate(&mut self, count: usize) {
        self.len = self.len.min(count);
        self.from.truncate(count);
        self.past.truncate(count);
    }

    fn reserve(&mut self, blocks: usize) {
        if self.lines.len() < blocks {
            self.lines.resize(blocks, Lines::NONE);
        }
    }

    /// Adds a ray.
    #[inline]
    pub fn push(&mut self, ray: &Ray) {
        let i = self.len;
        self.reserve(i / LANES + 1);
        self.len += 1;
        if ray.from.is_some() && self.from.len() < i {
            self.from.resize(i, None);
        }
        if ray.from.is_some() || !self.from.is_empty() {
            self.from.push(ray.from);
        }
        if ray.past.is_some() && self.past.len() < i {
            self.past.resize(i, None);
        }
        if ray.past.is_some() || !self.past.is_empty() {
            self.past.push(ray.past);
        }
        self.set_line(i, ray);
    }

    /// Adds a ray that left a surface, and went through none.
    ///
    /// # Panics
    /// When there are rays that left none, or went through one.
    #[inline(always)]
    pub fn push_spawned(
        &mut self,
        origin: DVec3,
        direction: DVec3,
        tmax: f64,
        from: Departure,
    ) {
        let (block, lane) = (self.len / LANES, self.len % LANES);
        assert!(self.from.len() == self.len && self.past.is_empty(), "rays of another kind");
        self.reserve(block + 1);
        let lines = &mut self.lines[block];
        for axis in 0..3 {
            lines.origin[axis][lane] = origin[axis];
            lines.direction[axis][lane] = direction[axis];
        }
        lines.tmax[lane] = tmax;
        self.from.push(Some(from));
        self.len += 1;
    }

    /// Puts another ray in the place of ray `i`.
    ///
    /// # Panics
    /// When there is no ray `i`.
    pub fn set(&mut self, i: usize, ray: &Ray) {
        assert!(i < self.len, "ray {i} of {}", self.len);
        if ray.from.is_some() && self.from.is_empty() {
            self.from.resize(self.len, None);
        }
        if let Some(from) = self.from.get_mut(i) {
            *from = ray.from;
        }
        if ray.past.is_some() && self.past.is_empty() {
            self.past.resize(self.len, None);
        }
        if let Some(past) = self.past.get_mut(i) {
            *past = ray.past;
        }
        self.set_line(i, ray);
    }

    #[inline(always)]
    fn set_line(&mut self, i: usize, ray: &Ray) {
        let (lines, lane) = (&mut self.lines[i / LANES], i % LANES);
        for axis in 0..3 {
            lines.origin[axis][lane] = ray.origin[axis];
            lines.direction[axis][lane] = ray.direction[axis];
        }
        lines.tmax[lane] = ray.tmax;
    }

    /// Ray `i`.
    ///
    /// # Panics
    /// When there is none.
    #[inline]
    pub fn ray(&self, i: usize) -> Ray {
        assert!(i < self.len, "ray {i} of {}", self.len);
        let (lines, lane) = (&self.lines[i / LANES], i % LANES);
        let (origin, direction) = lines.line(lane);
        Ray { origin, direction, tmax: lines.tmax[lane], from: self.from(i), past: self.past(i) }
    }

    /// All rays.
    pub fn iter(&self) -> impl Iterator<Item = Ray> {
        (0..self.len).map(|i| self.ray(i))
    }

    /// The sixteens, of which the last may be partly filled.
    #[inline(always)]
    pub fn lines(&self) -> &[Lines] {
        &self.lines[..self.len.div_ceil(LANES)]
    }

    /// What ray `i` left, if anything.
    #[inline(always)]
    pub fn from(&self, i: usize) -> Option<Departure> {
        self.from.get(i).copied().flatten()
    }

    /// How far ray `i` has come, if it went through anything.
    #[inline(always)]
    pub fn past(&self, i: usize) -> Option<Passage> {
        self.past.get(i).copied().flatten()
    }

    /// Whether no ray left a surface, nor went through one.
    #[inline(always)]
    pub fn are_fresh(&self) -> bool {
        self.from.is_empty() && self.past.is_empty()
    }

    /// Whether no ray went straight through a surface.
    #[inline(always)]
    pub fn are_unbroken(&self) -> bool {
        self.past.is_empty()
    }
}

impl<'a> Extend<&'a Ray> for Rays {
    fn extend<I: IntoIterator<Item = &'a Ray>>(&mut self, rays: I) {
        rays.into_iter().for_each(|ray| self.push(ray));
    }
}

/// What sixteen rays hit; see [`Hit`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Found {
    /// Distances; infinite where nothing is hit.
    pub t: Lanes<f64>,
    /// Weights of triangles' second vertices; any number where nothing is hit.
    pub u: Lanes<f64>,
    /// Weights of triangles' third vertices; any number where nothing is hit.
    pub v: Lanes<f64>,
    /// What is hit.
    pub id: Lanes<Option<PrimitiveId>>,
}

impl Found {
    const NOTHING: Self = Self {
        t: [f64::INFINITY; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
        id: [None; LANES],
    };

    /// The hit in lane `i`.
    #[inline(always)]
    pub fn hit(&self, i: usize) -> Option<Hit> {
        self.id[i].map(|id| Hit { t: self.t[i], u: self.u[i], v: self.v[i], id })
    }

    /// Sets lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, hit: Option<Hit>) {
        self.id[i] = hit.map(|hit| hit.id);
        self.t[i] = hit.map_or(f64::INFINITY, |hit| hit.t);
        self.u[i] = hit.map_or(0.0, |hit| hit.u);
        self.v[i] = hit.map_or(0.0, |hit| hit.v);
    }
}

/// What a batch of rays hits. In the last sixteen the lanes beyond its end hit nothing.
#[derive(Clone, Debug, Default)]
pub struct Hits {
    found: Vec<Found>,
    len: usize,
}

impl Hits {
    /// Makes it `count` hits on nothing.
    pub fn reset(&mut self, count: usize) {
        let blocks = count.div_ceil(LANES);
        if self.found.len() < blocks {
            self.found.resize(blocks, Found::NOTHING);
        }
        self.len = count;
        for found in &mut self.found[..blocks] {
            found.t = [f64::INFINITY; LANES];
            found.id = [None; LANES];
        }
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
        self.found[i / LANES].hit(i % LANES)
    }

    /// Sets what ray `i` hits.
    ///
    /// # Panics
    /// When there is no ray `i`.
    #[inline]
    pub fn set(&mut self, i: usize, hit: Option<Hit>) {
        assert!(i < self.len, "hit {i} of {}", self.len);
        self.found[i / LANES].set(i % LANES, hit);
    }

    /// How many rays hit anything.
    pub fn count(&self) -> usize {
        let hits = |found: &Found| -> usize {
            found.t.iter().map(|&t| usize::from(t < f64::INFINITY)).sum()
        };
        self.found().iter().map(hits).sum()
    }

    /// All hits.
    pub fn iter(&self) -> impl Iterator<Item = Option<Hit>> {
        (0..self.len).map(|i| self.get(i))
    }

    /// The sixteens, of which the last may be partly filled.
    #[inline(always)]
    pub fn found(&self) -> &[Found] {
        &self.found[..self.len.div_ceil(LANES)]
    }

    /// The sixteens, to be set.
    #[inline(always)]
    pub fn found_mut(&mut self) -> &mut [Found] {
        &mut self.found[..self.len.div_ceil(LANES)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Side;

    fn ray(i: usize) -> Ray {
        let id = PrimitiveId::sphere(i as u32);
        let through = Departure { id, side: Side::Back };
        Ray {
            tmax: i as f64,
            from: (i % 3 == 1).then_some(Departure { id, side: Side::Front }),
            past: (i % 5 == 3).then_some(Passage { t: 0.5, through }),
            ..Ray::new(DVec3::splat(i as f64), DVec3::X * i as f64)
        }
    }

    #[test]
    fn a_batch_gives_back_the_rays_that_it_was_given() {
        let all: Vec<Ray> = (0..100).map(ray).collect();
        let mut rays = Rays::default();
        for _ in 0..2 {
            rays.clear();
            rays.extend(&all);
            assert_eq!(rays.iter().collect::<Vec<_>>(), all);
        }
    }

    #[test]
    fn rays_that_left_nothing_are_fresh_after_others() {
        let mut rays = Rays::default();
        rays.extend(&(0..20).map(ray).collect::<Vec<_>>());
        assert!(!rays.are_fresh() && !rays.are_unbroken());
        let tmax = |(block, lines): (usize, &mut Lines)| lines.tmax = [block as f64; LANES];
        rays.fill(2).iter_mut().enumerate().for_each(tmax);
        rays.truncate(17);
        assert!(rays.are_fresh() && rays.are_unbroken());
        assert_eq!((rays.ray(16).tmax, rays.ray(15).from), (1.0, None));
    }

    #[test]
    fn a_ray_is_replaced_whole() {
        let mut rays = Rays::default();
        rays.fill(1)[0].tmax = [1.0; LANES];
        rays.set(4, &ray(13));
        assert_eq!((rays.ray(4), rays.ray(3).from, rays.ray(3).past), (ray(13), None, None));
    }

    #[test]
    fn hits_are_nothing_until_they_are_set() {
        let mut hits = Hits::default();
        hits.reset(18);
        let hit = Hit { t: 2.0, u: 0.5, v: 0.25, id: PrimitiveId::plane(1) };
        hits.set(17, Some(hit));
        assert_eq!((hits.get(17), hits.get(16)), (Some(hit), None));
        hits.reset(18);
        assert!(hits.iter().all(|hit| hit.is_none()));
    }
}
