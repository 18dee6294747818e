//! Many rays, sixteen side by side: as processors and packet tracers want them.

use glam::DVec3;

use crate::geometry::{Departure, Ids, Passage, Ray, Side};

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

/// What sixteen rays left; see [`Departure`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Left {
    /// The primitives.
    pub id: Ids,
    /// Whether each went to the side that the geometric normal does not point to.
    pub is_back: Lanes<bool>,
}

impl Left {
    const NOTHING: Self = Self { id: Ids::NOTHING, is_back: [false; LANES] };

    fn set(&mut self, i: usize, from: Option<Departure>) {
        self.id.set(i, from.map(|from| from.id));
        self.is_back[i] = from.is_some_and(|from| from.side == Side::Back);
    }
}

/// A batch of rays. Its memory is kept when it is cleared.
///
/// In the last sixteen the lanes beyond the batch's end hold any numbers. A ray whose `tmax` is not
/// above 0 only holds its place: it meets nothing, and its other numbers may be any.
#[derive(Clone, Debug, Default)]
pub struct Rays {
    lines: Vec<Lines>,
    len: usize,
    /// What each left; empty while none left anything.
    from: Vec<Left>,
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
        self.from.truncate(count.div_ceil(LANES));
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
        if ray.from.is_some() || !self.from.is_empty() {
            self.from.resize(i / LANES + 1, Left::NOTHING);
            self.from[i / LANES].set(i % LANES, ray.from);
        }
        if ray.past.is_some() || !self.past.is_empty() {
            self.past.resize(i, None);
            self.past.push(ray.past);
        }
        self.set_line(i, ray);
    }

    /// Adds sixteen rays that left surfaces, and went through none, to be set to whatever they are.
    ///
    /// # Panics
    /// When the sixteens before are not full, or are rays of another kind.
    #[inline(always)]
    pub fn push_sixteen(&mut self) -> (&mut Lines, &mut Left) {
        let block = self.len / LANES;
        let alike =
            self.len.is_multiple_of(LANES) && self.from.len() == block && self.past.is_empty();
        assert!(alike, "rays of another kind");
        self.reserve(block + 1);
        self.from.resize(block + 1, Left::NOTHING);
        self.len += LANES;
        (&mut self.lines[block], &mut self.from[block])
    }

    /// Puts another ray in the place of ray `i`.
    ///
    /// # Panics
    /// When there is no ray `i`.
    pub fn set(&mut self, i: usize, ray: &Ray) {
        assert!(i < self.len, "ray {i} of {}", self.len);
        if ray.from.is_some() && self.from.is_empty() {
            self.from.resize(self.len.div_ceil(LANES), Left::NOTHING);
        }
        if let Some(left) = self.from.get_mut(i / LANES) {
            left.set(i % LANES, ray.from);
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
        let left = self.from.get(i / LANES)?;
        let side = if left.is_back[i % LANES] { Side::Back } else { Side::Front };
        left.id.get(i % LANES).map(|id| Departure { id, side })
    }

    /// What the rays left, sixteen by sixteen; nothing where none left anything.
    #[inline(always)]
    pub fn left(&self) -> &[Left] {
        &self.from
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::PrimitiveId;

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
}
