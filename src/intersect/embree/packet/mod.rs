//! The packet loop: rays of a batch, traced through Embree as many at a time as a packet is wide.

mod approach;
mod context;
mod planes;
mod query;
mod rays;

pub use approach::Approach;
#[cfg(test)]
pub use context::BRUTE_FORCED;
pub use context::{QueryContext, QueryScene};
pub use query::{ClosestQuery, OcclusionQuery};
pub use rays::PacketRays;

use crate::geometry::{Departure, LANES, PrimitiveId16, Ray, Ray16, RayBatch};
use crate::intersect::embree::ffi::INVALID;

/// Neighbouring rays of a batch that are traced together: as many as a packet is wide, or fewer
/// at the batch's end. They all lie in one block of sixteen lanes.
#[derive(Clone, Copy)]
pub struct Packet<'a> {
    rays: &'a RayBatch,
    /// The index of the first ray in the batch.
    first: usize,
    /// The number of rays.
    pub count: usize,
}

impl<'a> Packet<'a> {
    /// Returns the packets of a batch, each of `W` rays.
    pub fn split<const W: usize>(rays: &'a RayBatch) -> impl Iterator<Item = Self> {
        const { assert!(LANES.is_multiple_of(W)) };
        (0..rays.len()).step_by(W).map(move |first| Self {
            rays,
            first,
            count: W.min(rays.len() - first),
        })
    }

    /// The index of the block of sixteen that the rays lie in.
    #[inline(always)]
    pub fn block(&self) -> usize {
        self.first / LANES
    }

    /// The lane of the first ray in its block of sixteen.
    #[inline(always)]
    pub fn first_lane(&self) -> usize {
        self.first % LANES
    }

    /// The block of sixteen that the rays lie in.
    #[inline(always)]
    pub fn ray16(&self) -> &'a Ray16 {
        &self.rays.blocks()[self.block()]
    }

    /// The ray in a lane of the packet.
    ///
    /// # Panics
    /// When there is none.
    #[inline(always)]
    pub fn ray(&self, lane: usize) -> Ray {
        self.rays.ray(self.first + lane)
    }

    /// The number in the batch of the ray in a lane.
    #[inline(always)]
    pub fn ray_index(&self, lane: usize) -> usize {
        self.first + lane
    }

    /// The directions toward the viewers of shadow rays.
    #[inline(always)]
    pub fn viewers<const W: usize>(&self) -> Option<[[f64; W]; 3]> {
        let viewers = self.rays.viewers().get(self.block())?;
        let mut lanes = [[0.0; W]; 3];
        for axis in 0..3 {
            lanes[axis].copy_from_slice(&viewers[axis][self.first_lane()..][..W]);
        }
        Some(lanes)
    }

    /// The departure of the ray in a lane.
    #[inline(always)]
    pub fn departure(&self, lane: usize) -> Option<Departure> {
        self.rays.departure(self.first + lane)
    }

    /// The spheres that the rays left outward and inward; [`INVALID`] where there is none.
    #[inline(always)]
    pub fn departed_spheres<const W: usize>(&self) -> ([u32; W], [u32; W]) {
        let (mut outward, mut inward) = ([INVALID; W], [INVALID; W]);
        let Some(departures) = self.rays.departures().get(self.block()) else {
            return (outward, inward);
        };
        let first = self.first_lane();
        for i in 0..W {
            let is_sphere = departures.id.geometry[first + i] == PrimitiveId16::SPHERES;
            let sphere = if is_sphere { departures.id.primitive[first + i] } else { INVALID };
            outward[i] = if departures.is_back[first + i] { INVALID } else { sphere };
            inward[i] = if departures.is_back[first + i] { sphere } else { INVALID };
        }
        (outward, inward)
    }

    /// True for each ray that left plane `index`, and so does not hit it.
    #[inline(always)]
    pub fn departed_plane<const W: usize>(&self, index: u32) -> [bool; W] {
        let mut departed = [false; W];
        let Some(departures) = self.rays.departures().get(self.block()) else { return departed };
        let first = self.first_lane();
        for i in 0..W {
            departed[i] = (departures.id.geometry[first + i] == PrimitiveId16::PLANES)
                & (departures.id.primitive[first + i] == index);
        }
        departed
    }
}
