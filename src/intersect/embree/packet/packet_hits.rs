//! The nearest hit of each ray of a packet, while Embree is still looking.

use crate::geometry::{Estimate, Geometry, PrimitiveId};
use crate::intersect::embree::ffi::handles::INVALID;
use crate::scene::Scene;

/// The nearest hit of each ray so far.
///
/// A distance is known to within an error; it is rounded once, when the ray is done.
pub struct PacketHits<const W: usize> {
    /// Its distance, or the ray's end.
    pub t: [f64; W],
    /// How far off that may be.
    pub error: [f64; W],
    /// The sphere's or triangle's index; `INVALID` while there is no hit.
    pub primitive: [u32; W],
    /// The triangle's instance; `INVALID` for a sphere.
    pub instance: [u32; W],
}

impl<const W: usize> PacketHits<W> {
    /// No hits yet, on rays that end at `tmax`.
    #[inline(always)]
    pub fn new(tmax: [f64; W]) -> Self {
        Self { t: tmax, error: [0.0; W], primitive: [INVALID; W], instance: [INVALID; W] }
    }

    /// Forgets the hits, for rays that end at `tmax`.
    #[inline(always)]
    pub fn begin(&mut self, tmax: &[f64; W]) {
        self.t = *tmax;
        self.error = [0.0; W];
        self.primitive = [INVALID; W];
        self.instance = [INVALID; W];
    }

    /// Beyond this there is nothing to look for.
    #[inline(always)]
    pub fn upper(&self, i: usize) -> f64 {
        self.t[i] + self.error[i]
    }

    /// What ray `i` hits, if anything so far.
    pub fn id(&self, scene: &Scene, i: usize) -> Option<PrimitiveId> {
        let (primitive, instance) = (self.primitive[i], self.instance[i]);
        match instance {
            _ if primitive == INVALID => None,
            INVALID => Some(PrimitiveId::sphere(primitive)),
            _ => {
                let mesh = scene.instances[instance as usize].mesh.0;
                Some(PrimitiveId::triangle(mesh, primitive, instance))
            }
        }
    }

    /// Ray `i` hits `id`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, at: Estimate, id: PrimitiveId) {
        self.t[i] = at.t;
        self.error[i] = at.error;
        self.primitive[i] = id.primitive;
        let sphere = id.geometry == Geometry::Spheres;
        self.instance[i] = if sphere { INVALID } else { id.instance };
    }
}
