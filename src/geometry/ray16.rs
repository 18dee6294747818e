//! Rays in sixteen lanes, component by component, and batches of them.

use glam::DVec3;

use crate::geometry::{
    Continuation, Departure, LANES, Lanes, PrimitiveId16, Ray, ShadowEnds, Side,
};

/// Sixteen rays side by side, without their departures; see [`Ray`].
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub struct Ray16 {
    /// The origins, axis by axis.
    pub origin: [Lanes<f64>; 3],
    /// The directions, axis by axis.
    pub direction: [Lanes<f64>; 3],
    /// The ends.
    pub tmax: Lanes<f64>,
}

impl Ray16 {
    /// The origin and the direction in lane `i`.
    #[inline(always)]
    pub fn origin_and_direction(&self, i: usize) -> (DVec3, DVec3) {
        let vector = |v: &[Lanes<f64>; 3]| DVec3::new(v[0][i], v[1][i], v[2][i]);
        (vector(&self.origin), vector(&self.direction))
    }
}

/// The departures of sixteen rays side by side; see [`Departure`].
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub struct Departure16 {
    /// The primitives.
    pub id: PrimitiveId16,
    /// True where the ray goes into the back side.
    pub is_back: Lanes<bool>,
}

impl Departure16 {
    fn set(&mut self, i: usize, departure: Option<Departure>) {
        self.id.set(i, departure.map(|d| d.id));
        self.is_back[i] = departure.is_some_and(|d| d.side == Side::Back);
    }
}

/// A batch of rays, in blocks of sixteen lanes. Clearing it keeps its memory.
///
/// In the last block the lanes beyond the batch's end hold any values. A ray whose `tmax` is not
/// above 0 is inactive: it hits nothing, and its other components may have any value.
#[derive(Clone, Debug, Default)]
pub struct RayBatch {
    blocks: Vec<Ray16>,
    len: usize,
    /// The departures; empty while no ray has one.
    departures: Vec<Departure16>,
    /// The continuations; empty while no ray has one.
    continuations: Vec<Option<Continuation>>,
    /// The directions toward the viewers of shadow rays, axis by axis; empty for other rays.
    viewers: Vec<[Lanes<f64>; 3]>,
}

impl RayBatch {
    /// The number of rays.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Removes all rays.
    pub fn clear(&mut self) {
        self.len = 0;
        self.departures.clear();
        self.continuations.clear();
        self.viewers.clear();
    }

    /// Resizes the batch to `blocks` blocks of rays without departure, and returns them to be filled.
    pub fn resize_blocks(&mut self, blocks: usize) -> &mut [Ray16] {
        self.clear();
        self.reserve(blocks);
        self.len = blocks * LANES;
        &mut self.blocks[..blocks]
    }

    /// Removes all but the first `count` rays.
    pub fn truncate(&mut self, count: usize) {
        self.len = self.len.min(count);
        self.departures.truncate(count.div_ceil(LANES));
        self.continuations.truncate(count);
        self.viewers.truncate(count.div_ceil(LANES));
    }

    fn reserve(&mut self, blocks: usize) {
        if self.blocks.len() < blocks {
            self.blocks.resize(blocks, Ray16::default());
        }
    }

    /// Appends a ray.
    ///
    /// # Panics
    /// When it is a shadow ray and the rays before it are not, or the reverse.
    #[inline]
    pub fn push(&mut self, ray: &Ray) {
        let i = self.len;
        if ray.shadow.is_some() && (i == 0 || self.are_shadow_rays()) {
            self.viewers.resize(i / LANES + 1, [[0.0; LANES]; 3]);
        }
        self.set_viewer(i, ray);
        self.reserve(i / LANES + 1);
        self.len += 1;
        if ray.departure.is_some() || !self.departures.is_empty() {
            self.departures.resize(i / LANES + 1, Departure16::default());
            self.departures[i / LANES].set(i % LANES, ray.departure);
        }
        if ray.continuation.is_some() || !self.continuations.is_empty() {
            self.continuations.resize(i, None);
            self.continuations.push(ray.continuation);
        }
        self.set_ray(i, ray);
    }

    /// Appends a block of sixteen shadow rays that have departures but no continuations, and returns
    /// it to be filled. `viewers` are the directions toward their viewers.
    ///
    /// # Panics
    /// When a block before it is not full, or holds rays of another kind.
    #[inline(always)]
    pub fn push_shadow_block(
        &mut self,
        viewers: [Lanes<f64>; 3],
    ) -> (&mut Ray16, &mut Departure16) {
        let block = self.len / LANES;
        let alike = self.len.is_multiple_of(LANES)
            && self.departures.len() == block
            && self.continuations.is_empty()
            && self.viewers.len() == block;
        assert!(alike, "rays of another kind");
        self.viewers.push(viewers);
        self.reserve(block + 1);
        self.departures.resize(block + 1, Departure16::default());
        self.len += LANES;
        (&mut self.blocks[block], &mut self.departures[block])
    }

    /// Replaces ray `i`.
    ///
    /// # Panics
    /// When there is no ray `i`, or one of the two is a shadow ray and the other is not.
    pub fn set(&mut self, i: usize, ray: &Ray) {
        assert!(i < self.len, "ray {i} of {}", self.len);
        self.set_viewer(i, ray);
        if ray.departure.is_some() && self.departures.is_empty() {
            self.departures.resize(self.len.div_ceil(LANES), Departure16::default());
        }
        if let Some(departures) = self.departures.get_mut(i / LANES) {
            departures.set(i % LANES, ray.departure);
        }
        if ray.continuation.is_some() && self.continuations.is_empty() {
            self.continuations.resize(self.len, None);
        }
        if let Some(continuation) = self.continuations.get_mut(i) {
            *continuation = ray.continuation;
        }
        self.set_ray(i, ray);
    }

    #[inline(always)]
    fn set_viewer(&mut self, i: usize, ray: &Ray) {
        assert!(ray.shadow.is_some() == self.are_shadow_rays(), "shadow rays and others");
        if let Some(ends) = ray.shadow {
            for axis in 0..3 {
                self.viewers[i / LANES][axis][i % LANES] = ends.viewer[axis];
            }
        }
    }

    #[inline(always)]
    fn set_ray(&mut self, i: usize, ray: &Ray) {
        let (block, lane) = (&mut self.blocks[i / LANES], i % LANES);
        for axis in 0..3 {
            block.origin[axis][lane] = ray.origin[axis];
            block.direction[axis][lane] = ray.direction[axis];
        }
        block.tmax[lane] = ray.tmax;
    }

    /// The ray with index `i`.
    ///
    /// # Panics
    /// When there is no ray `i`.
    #[inline(always)]
    pub fn ray(&self, i: usize) -> Ray {
        assert!(i < self.len, "ray {i} of {}", self.len);
        let (block, lane) = (&self.blocks[i / LANES], i % LANES);
        let (origin, direction) = block.origin_and_direction(lane);
        Ray {
            origin,
            direction,
            tmax: block.tmax[lane],
            departure: self.departure(i),
            continuation: self.continuation(i),
            shadow: self
                .viewers
                .get(i / LANES)
                .map(|viewers| ShadowEnds { viewer: viewers.map(|axis| axis[lane]).into() }),
        }
    }

    /// The directions toward the viewers of shadow rays, in blocks of sixteen; empty for other rays.
    #[inline(always)]
    pub fn viewers(&self) -> &[[Lanes<f64>; 3]] {
        &self.viewers
    }

    /// True if the rays are shadow rays.
    #[inline(always)]
    pub fn are_shadow_rays(&self) -> bool {
        !self.viewers.is_empty()
    }

    /// An iterator over all rays.
    pub fn iter(&self) -> impl Iterator<Item = Ray> {
        (0..self.len).map(|i| self.ray(i))
    }

    /// The blocks of sixteen rays; the last may be partly filled.
    #[inline(always)]
    pub fn blocks(&self) -> &[Ray16] {
        &self.blocks[..self.len.div_ceil(LANES)]
    }

    /// The departure of ray `i`, if it has one.
    #[inline(always)]
    pub fn departure(&self, i: usize) -> Option<Departure> {
        let departures = self.departures.get(i / LANES)?;
        let side = if departures.is_back[i % LANES] { Side::Back } else { Side::Front };
        departures.id.get(i % LANES).map(|id| Departure { id, side })
    }

    /// The departures in blocks of sixteen; empty while no ray has one.
    #[inline(always)]
    pub fn departures(&self) -> &[Departure16] {
        &self.departures
    }

    /// The continuation of ray `i`, if it has one.
    #[inline(always)]
    pub fn continuation(&self, i: usize) -> Option<Continuation> {
        self.continuations.get(i).copied().flatten()
    }

    /// True if no ray has a departure or a continuation.
    #[inline(always)]
    pub fn have_no_departures(&self) -> bool {
        self.departures.is_empty() && self.continuations.is_empty()
    }

    /// True if no ray has a continuation.
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
    fn a_reused_batch_has_no_departures_of_earlier_rays() {
        let mut rays = RayBatch::default();
        rays.extend(&(0..20).map(ray).collect::<Vec<_>>());
        assert!(!rays.have_no_departures() && !rays.have_no_continuations());
        let tmax = |(i, block): (usize, &mut Ray16)| block.tmax = [i as f64; LANES];
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
