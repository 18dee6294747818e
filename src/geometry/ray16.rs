//! Many rays, sixteen side by side: as processors and packet tracers want them.

use glam::DVec3;

use crate::geometry::{Continuation, Departure, PrimitiveId16, Ray, Side};

/// How many rays stand side by side: a multiple of every packet width there is.
pub const LANES: usize = 16;

/// One number for each of sixteen rays.
pub type Lanes<T> = [T; LANES];

/// Sixteen half-lines; see [`Ray`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Ray16 {
    /// Where they start, axis by axis.
    pub origin: [Lanes<f64>; 3],
    /// Where they go, axis by axis.
    pub direction: [Lanes<f64>; 3],
    /// Where they end.
    pub tmax: Lanes<f64>,
}

impl Ray16 {
    const EMPTY: Self =
        Self { origin: [[0.0; LANES]; 3], direction: [[0.0; LANES]; 3], tmax: [0.0; LANES] };

    /// Origin and direction in lane `i`.
    #[inline(always)]
    pub fn origin_and_direction(&self, i: usize) -> (DVec3, DVec3) {
        let at = |v: &[Lanes<f64>; 3]| DVec3::new(v[0][i], v[1][i], v[2][i]);
        (at(&self.origin), at(&self.direction))
    }
}

/// What sixteen rays left; see [`Departure`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Departure16 {
    /// The primitives.
    pub id: PrimitiveId16,
    /// Whether each went to the side that the geometric normal does not point to.
    pub is_back: Lanes<bool>,
}

impl Departure16 {
    const NONE: Self = Self { id: PrimitiveId16::EMPTY, is_back: [false; LANES] };

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
pub struct RayBatch {
    blocks: Vec<Ray16>,
    len: usize,
    /// What each left; empty while none left anything.
    departures: Vec<Departure16>,
    /// How far each has come; empty while none went through anything.
    continuations: Vec<Option<Continuation>>,
}

impl RayBatch {
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
        self.departures.clear();
        self.continuations.clear();
    }

    /// Makes it `blocks` times sixteen rays that left nothing, to be set to whatever they are.
    pub fn resize_blocks(&mut self, blocks: usize) -> &mut [Ray16] {
        self.clear();
        self.reserve(blocks);
        self.len = blocks * LANES;
        &mut self.blocks[..blocks]
    }

    /// Forgets all but the first `count`.
    pub fn truncate(&mut self, count: usize) {
        self.len = self.len.min(count);
        self.departures.truncate(count.div_ceil(LANES));
        self.continuations.truncate(count);
    }

    fn reserve(&mut self, blocks: usize) {
        if self.blocks.len() < blocks {
            self.blocks.resize(blocks, Ray16::EMPTY);
        }
    }

    /// Adds a ray.
    #[inline]
    pub fn push(&mut self, ray: &Ray) {
        let i = self.len;
        self.reserve(i / LANES + 1);
        self.len += 1;
        if ray.departure.is_some() || !self.departures.is_empty() {
            self.departures.resize(i / LANES + 1, Departure16::NONE);
            self.departures[i / LANES].set(i % LANES, ray.departure);
        }
        if ray.continuation.is_some() || !self.continuations.is_empty() {
            self.continuations.resize(i, None);
            self.continuations.push(ray.continuation);
        }
        self.set_ray(i, ray);
    }

    /// Adds sixteen rays that left surfaces, and went through none, to be set to whatever they are.
    ///
    /// # Panics
    /// When the sixteens before are not full, or are rays of another kind.
    #[inline(always)]
    pub fn push_block(&mut self) -> (&mut Ray16, &mut Departure16) {
        let block = self.len / LANES;
        let alike = self.len.is_multiple_of(LANES)
            && self.departures.len() == block
            && self.continuations.is_empty();
        assert!(alike, "rays of another kind");
        self.reserve(block + 1);
        self.departures.resize(block + 1, Departure16::NONE);
        self.len += LANES;
        (&mut self.blocks[block], &mut self.departures[block])
    }

    /// Puts another ray in the place of ray `i`.
    ///
    /// # Panics
    /// When there is no ray `i`.
    pub fn set(&mut self, i: usize, ray: &Ray) {
        assert!(i < self.len, "ray {i} of {}", self.len);
        if ray.departure.is_some() && self.departures.is_empty() {
            self.departures.resize(self.len.div_ceil(LANES), Departure16::NONE);
        }
        if let Some(left) = self.departures.get_mut(i / LANES) {
            left.set(i % LANES, ray.departure);
        }
        if ray.continuation.is_some() && self.continuations.is_empty() {
            self.continuations.resize(self.len, None);
        }
        if let Some(past) = self.continuations.get_mut(i) {
            *past = ray.continuation;
        }
        self.set_ray(i, ray);
    }

    #[inline(always)]
    fn set_ray(&mut self, i: usize, ray: &Ray) {
        let (lines, lane) = (&mut self.blocks[i / LANES], i % LANES);
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
        let (lines, lane) = (&self.blocks[i / LANES], i % LANES);
        let (origin, direction) = lines.origin_and_direction(lane);
        Ray {
            origin,
            direction,
            tmax: lines.tmax[lane],
            departure: self.departure(i),
            continuation: self.continuation(i),
        }
    }

    /// All rays.
    pub fn iter(&self) -> impl Iterator<Item = Ray> {
        (0..self.len).map(|i| self.ray(i))
    }

    /// The sixteens, of which the last may be partly filled.
    #[inline(always)]
    pub fn blocks(&self) -> &[Ray16] {
        &self.blocks[..self.len.div_ceil(LANES)]
    }

    /// What ray `i` left, if anything.
    #[inline(always)]
    pub fn departure(&self, i: usize) -> Option<Departure> {
        let left = self.departures.get(i / LANES)?;
        let side = if left.is_back[i % LANES] { Side::Back } else { Side::Front };
        left.id.get(i % LANES).map(|id| Departure { id, side })
    }

    /// What the rays left, sixteen by sixteen; nothing where none left anything.
    #[inline(always)]
    pub fn departures(&self) -> &[Departure16] {
        &self.departures
    }

    /// How far ray `i` has come, if it went through anything.
    #[inline(always)]
    pub fn continuation(&self, i: usize) -> Option<Continuation> {
        self.continuations.get(i).copied().flatten()
    }

    /// Whether no ray left a surface, nor went through one.
    #[inline(always)]
    pub fn have_no_departures(&self) -> bool {
        self.departures.is_empty() && self.continuations.is_empty()
    }

    /// Whether no ray went straight through a surface.
    #[inline(always)]
    pub fn have_no_continuations(&self) -> bool {
        self.continuations.is_empty()
    }
}

impl<'a> Extend<&'a Ray> for RayBatch {
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
            departure: (i % 3 == 1).then_some(Departure { id, side: Side::Front }),
            continuation: (i % 5 == 3).then_some(Continuation { t: 0.5, crossed: through }),
            ..Ray::new(DVec3::splat(i as f64), DVec3::X * i as f64)
        }
    }

    #[test]
    fn a_batch_gives_back_the_rays_that_it_was_given() {
        let all: Vec<Ray> = (0..100).map(ray).collect();
        let mut rays = RayBatch::default();
        for _ in 0..2 {
            rays.clear();
            rays.extend(&all);
            assert_eq!(rays.iter().collect::<Vec<_>>(), all);
        }
    }

    #[test]
    fn rays_that_left_nothing_are_fresh_after_others() {
        let mut rays = RayBatch::default();
        rays.extend(&(0..20).map(ray).collect::<Vec<_>>());
        assert!(!rays.have_no_departures() && !rays.have_no_continuations());
        let tmax = |(block, lines): (usize, &mut Ray16)| lines.tmax = [block as f64; LANES];
        rays.resize_blocks(2).iter_mut().enumerate().for_each(tmax);
        rays.truncate(17);
        assert!(rays.have_no_departures() && rays.have_no_continuations());
        assert_eq!((rays.ray(16).tmax, rays.ray(15).departure), (1.0, None));
    }

    #[test]
    fn a_ray_is_replaced_whole() {
        let mut rays = RayBatch::default();
        rays.resize_blocks(1)[0].tmax = [1.0; LANES];
        rays.set(4, &ray(13));
        assert_eq!(
            (rays.ray(4), rays.ray(3).departure, rays.ray(3).continuation),
            (ray(13), None, None)
        );
    }
}
