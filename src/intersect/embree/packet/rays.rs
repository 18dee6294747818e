//! A packet's share of a batch.

use crate::geometry::{Departure, LANES, PrimitiveId16, Ray, Ray16, RayBatch};
use crate::intersect::embree::ffi::handles::INVALID;

/// Neighbouring rays of a batch that are traced together: as many as a packet is wide, or fewer
/// at the batch's end. They never stand in two sixteens.
#[derive(Clone, Copy)]
pub struct Packet<'a> {
    rays: &'a RayBatch,
    /// The first ray's place in the batch.
    pub first: usize,
    /// How many there are.
    pub count: usize,
}

impl<'a> Packet<'a> {
    /// The packets of a batch, each of `W` rays.
    pub fn all<const W: usize>(rays: &'a RayBatch) -> impl Iterator<Item = Self> {
        const { assert!(LANES.is_multiple_of(W)) };
        (0..rays.len()).step_by(W).map(move |first| Self {
            rays,
            first,
            count: W.min(rays.len() - first),
        })
    }

    /// The sixteen that they stand in, and the lane of the first.
    #[inline(always)]
    pub fn lines(&self) -> (&'a Ray16, usize) {
        (&self.rays.blocks()[self.first / LANES], self.first % LANES)
    }

    /// The ray in a lane, if there is one.
    #[inline]
    pub fn get(&self, lane: usize) -> Option<Ray> {
        (lane < self.count).then(|| self.rays.ray(self.first + lane))
    }

    /// The ray in a lane.
    ///
    /// # Panics
    /// When there is none.
    #[inline]
    pub fn ray(&self, lane: usize) -> Ray {
        self.rays.ray(self.first + lane)
    }

    /// What the ray in a lane left.
    #[inline(always)]
    pub fn from(&self, lane: usize) -> Option<Departure> {
        self.rays.departure(self.first + lane)
    }

    /// The sphere that each ray left toward its outside, and toward its inside; [`INVALID`] where
    /// there is none.
    #[inline(always)]
    pub fn spheres_left<const W: usize>(&self) -> ([u32; W], [u32; W]) {
        let (mut outward, mut inward) = ([INVALID; W], [INVALID; W]);
        let Some(left) = self.rays.departures().get(self.first / LANES) else {
            return (outward, inward);
        };
        let at = self.first % LANES;
        for i in 0..W {
            let is_sphere = left.id.geometry[at + i] == PrimitiveId16::SPHERES;
            let primitive = if is_sphere { left.id.primitive[at + i] } else { INVALID };
            outward[i] = if left.is_back[at + i] { INVALID } else { primitive };
            inward[i] = if left.is_back[at + i] { primitive } else { INVALID };
        }
        (outward, inward)
    }

    /// Whether each ray left plane `index`, and so does not meet it.
    #[inline(always)]
    pub fn left_plane<const W: usize>(&self, index: u32) -> [bool; W] {
        let mut gone = [false; W];
        let Some(left) = self.rays.departures().get(self.first / LANES) else { return gone };
        let at = self.first % LANES;
        for i in 0..W {
            gone[i] = (left.id.geometry[at + i] == PrimitiveId16::PLANES)
                & (left.id.primitive[at + i] == index);
        }
        gone
    }

    /// Whether none left a surface, nor went through one.
    #[inline(always)]
    pub fn is_fresh(&self) -> bool {
        self.rays.have_no_departures()
    }

    /// Whether none went straight through a surface.
    #[inline(always)]
    pub fn is_unbroken(&self) -> bool {
        self.rays.have_no_continuations()
    }
}
