//! The query context: the state of a packet that Embree's callbacks read and write.

use std::cell::RefCell;

use glam::DVec3;

use crate::geometry::{Estimate, Geometry, Hit16, PrimitiveId, PrimitiveId16, RayBatch};
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::{CommittedScene, INVALID, RayHitRecord};
use crate::intersect::embree::packet::Packet;
use crate::intersect::embree::packet::rays::{PacketRays, TracedLanes};
use crate::intersect::primitive::Primitives;
use crate::intersect::ray_ends::{max_corner_distance, max_tolerance};
use crate::intersect::{BruteForce, Crossing, Precision};
use crate::scene::Scene;

/// A scene as its queries see it.
pub struct QueryScene<'a> {
    pub scene: &'a Scene,
    pub precision: Precision,
    /// The Embree scene that rays are traced in.
    pub top: &'a CommittedScene,
    /// The space of the f32 rays.
    pub space: &'a F32Space,
    /// The instance of each geometry of the Embree scene, in precision `fast`.
    pub instance_of: &'a [u32],
    /// The largest absolute coordinate in the scene.
    pub max_coordinate: f64,
    /// True if every triangle blocks light.
    pub all_block_light: bool,
    /// True for each instance whose alpha is tested; empty where there is none.
    pub masked: &'a [bool],
}

#[cfg(test)]
thread_local! {
    /// The number of rays that were tested by brute force, with a scene or with an instance.
    pub static BRUTE_FORCED: std::cell::Cell<u32> = const { std::cell::Cell::new(0) };
}

impl QueryScene<'_> {
    /// The tests of one ray against one primitive.
    #[inline(always)]
    pub fn primitives(&self) -> Primitives<'_> {
        Primitives { scene: self.scene, precision: self.precision }
    }

    /// The intersector for rays that no f32 ray can stand for.
    pub fn brute_force(&self) -> BruteForce<'_> {
        #[cfg(test)]
        BRUTE_FORCED.with(|count| count.set(count.get() + 1));
        BruteForce::new(self.scene, self.precision)
    }

    /// True if the alpha of an instance is tested.
    #[inline(always)]
    pub fn is_masked(&self, instance: u32) -> bool {
        !self.masked.is_empty() && self.masked[instance as usize]
    }
}

/// The closest hit of each ray of a packet so far, in f64, while Embree is still tracing.
///
/// A distance is known to within an error; it is rounded once, when the packet is done.
pub struct PacketHits<const W: usize> {
    /// The distances, or the ends of the rays.
    pub t: [f64; W],
    /// The bounds on the errors of the distances.
    pub error: [f64; W],
    /// The index of the sphere or triangle; `INVALID` while there is no hit.
    pub primitive: [u32; W],
    /// The instance of the triangle; `INVALID` for a sphere.
    pub instance: [u32; W],
}

impl<const W: usize> PacketHits<W> {
    /// Makes hits on nothing, for rays that end at `tmax`.
    #[inline(always)]
    fn new(tmax: [f64; W]) -> Self {
        Self { t: tmax, error: [0.0; W], primitive: [INVALID; W], instance: [INVALID; W] }
    }

    /// Forgets the hits, for rays that end at `tmax`.
    #[inline(always)]
    fn reset(&mut self, tmax: &[f64; W]) {
        self.t = *tmax;
        self.error = [0.0; W];
        self.primitive = [INVALID; W];
        self.instance = [INVALID; W];
    }

    /// The distance beyond which nothing is closer than the hit of ray `i`.
    #[inline(always)]
    pub fn upper(&self, i: usize) -> f64 {
        self.t[i] + self.error[i]
    }

    /// The primitive that ray `i` hits, if any so far.
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

    /// Sets the hit of ray `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, distance: Estimate, id: PrimitiveId) {
        self.t[i] = distance.t;
        self.error[i] = distance.error;
        self.primitive[i] = id.primitive;
        let is_sphere = id.geometry == Geometry::Spheres;
        self.instance[i] = if is_sphere { INVALID } else { id.instance };
    }

    /// True if the hit of ray `i` so far is on a sphere.
    #[inline(always)]
    fn is_sphere(&self, i: usize) -> bool {
        (self.primitive[i] != INVALID) & (self.instance[i] == INVALID)
    }

    /// Merges the spheres that the callbacks of precision `fast` found into the hits on triangles,
    /// from lane `first` on.
    #[inline(always)]
    pub fn merge_spheres_into(&self, hits: &mut Hit16, first: usize) {
        let mut any = false;
        for i in 0..W {
            any |= self.is_sphere(i);
        }
        if any {
            let mut ts = [f64::NAN; W];
            for i in 0..W {
                ts[i] = if self.is_sphere(i) { self.t[i] } else { f64::NAN };
            }
            hits.merge_closer(PrimitiveId16::SPHERES, &self.primitive, &ts, first);
        }
    }
}

/// The surfaces that the rays of a packet left.
pub struct PacketDepartures<const W: usize> {
    /// True if any ray of the batch left a surface, or went straight through one.
    pub any: bool,
    /// True if any ray of the batch is a continuation ray.
    pub any_continuation: bool,
    /// The sphere that each ray left outward, and so does not hit; `INVALID` for none.
    pub outward: [u32; W],
    /// The sphere that each ray left inward; `INVALID` for none.
    inward: [u32; W],
    /// The greatest distance from a surface at which a ray starts on it to within rounding.
    pub tolerance: f64,
    /// The greatest distance from the line of a shadow ray at which a surface may block it at its origin.
    pub corner_distance: f64,
}

impl<const W: usize> PacketDepartures<W> {
    /// True if ray `i`, which did not leave the sphere outward, may start on it, so that
    /// `sphere_departure` must be asked; `power` is |f|² − r² with f from the centre to the origin.
    #[inline(always)]
    pub fn may_start_on_sphere(&self, i: usize, sphere: u32, radius: f64, power: f64) -> bool {
        // Negated for what is not a number.
        let apart = power.abs() > self.tolerance * (2.0 * radius + self.tolerance);
        (self.inward[i] == sphere) | !apart
    }
}

/// The query context: Embree's own room first, then what our callbacks need.
///
/// Embree hands the callbacks the pointer that it was given, so that they find the rest behind it.
#[repr(C, align(64))]
pub struct QueryContext<'a, const W: usize> {
    /// `RTCRayQueryContext`, larger than any version's; all ones means "in no instance".
    embree: [u32; 16],
    pub query: &'a QueryScene<'a>,
    pub scene: &'a Scene,
    /// The rays as they were asked; fewer than `W` in the last packet.
    pub packet: Packet<'a>,
    /// The same in f64, and where on them the f32 rays lie that are being traced; within an instance
    /// these lie in its object space.
    pub rays: PacketRays<W>,
    pub departures: PacketDepartures<W>,
    /// True if the rays are shadow rays, which both their ends may exempt from hits.
    pub are_shadow_rays: bool,
    /// The directions toward the viewers of shadow rays.
    viewer: [[f64; W]; 3],
    /// The hits that the callbacks found: in precision `fast` spheres and what f32 does not resolve, in
    /// `certified` everything.
    pub hits: PacketHits<W>,
    /// The ends of the f32 rays, before anything was hit.
    pub f32_tmax: [f32; W],
    /// The distance along the f32 rays, from either end, within which a candidate triangle is tested
    /// again in f64.
    pub t_uncertainty: f32,
    /// The instance whose BLAS is being traced.
    pub instance: u32,
    /// The triangles that let light through and that the rays of an occlusion query may cross, if the query
    /// asks for them.
    crossings: Option<RefCell<Vec<Crossing>>>,
}

const _: () = {
    assert!(size_of::<embree4_sys::RTCRayQueryContext>() <= size_of::<[u32; 16]>());
    assert!(std::mem::offset_of!(QueryContext<'static, 16>, embree) == 0);
};

impl<'a, const W: usize> QueryContext<'a, W> {
    /// Makes the context for the packets of a batch, of which none is loaded yet.
    pub fn new(query: &'a QueryScene<'a>, batch: &'a RayBatch) -> Self {
        Self {
            embree: [INVALID; 16],
            query,
            scene: query.scene,
            packet: Packet { rays: batch, first: 0, count: 0 },
            rays: PacketRays::new(),
            departures: PacketDepartures {
                any: !batch.have_no_departures(),
                any_continuation: !batch.have_no_continuations(),
                outward: [INVALID; W],
                inward: [INVALID; W],
                tolerance: 0.0,
                corner_distance: 0.0,
            },
            are_shadow_rays: batch.are_shadow_rays(),
            viewer: [[0.0; W]; 3],
            hits: PacketHits::new([0.0; W]),
            f32_tmax: [0.0; W],
            t_uncertainty: query.space.t_uncertainty(),
            instance: INVALID,
            crossings: None,
        }
    }

    /// Makes a context that collects what rays may cross.
    pub fn with_crossings(self) -> Self {
        Self { crossings: Some(RefCell::default()), ..self }
    }

    /// True if the query asks what its rays cross.
    #[inline(always)]
    pub fn collects_crossings(&self) -> bool {
        self.crossings.is_some()
    }

    /// Notes that the ray in `lane` may cross a triangle that lets light through.
    #[cold]
    #[inline(never)]
    pub fn note_crossing(&self, lane: usize, id: PrimitiveId) {
        if let Some(crossings) = &self.crossings
            && lane < self.packet.count
        {
            let ray = self.packet.ray_index(lane) as u32;
            crossings.borrow_mut().push(Crossing { ray, id });
        }
    }

    /// Returns what was noted.
    pub fn into_crossings(self) -> Vec<Crossing> {
        self.crossings.map_or_else(Vec::new, RefCell::into_inner)
    }

    /// Loads another packet of the batch, and sets up its f32 rays in `record`.
    #[inline(always)]
    pub fn load_packet(
        &mut self,
        packet: Packet<'a>,
        record: &mut RayHitRecord<W>,
    ) -> TracedLanes<W> {
        self.packet = packet;
        self.rays.load(&packet);
        let lanes = self.rays.set_up_f32_rays(self.query.space, record);
        self.f32_tmax = record.tfar;
        if lanes.any_open_end {
            // So that no hit seems to lie certainly before the end.
            self.f32_tmax = [0.0; W];
        }
        self.hits.reset(&self.rays.tmax);
        if self.query.precision == Precision::Certified
            && let Some(viewers) = packet.viewers()
        {
            self.viewer = viewers;
        }
        if self.departures.any {
            let max_coordinate = self.rays.max_origin_coordinate().max(self.query.max_coordinate);
            self.departures.tolerance = max_tolerance(max_coordinate);
            self.departures.corner_distance = max_corner_distance(max_coordinate);
            (self.departures.outward, self.departures.inward) = packet.departed_spheres();
        }
        lanes
    }

    /// The direction toward the viewer of the shadow ray in a lane.
    #[inline(always)]
    pub fn viewer(&self, lane: usize) -> DVec3 {
        DVec3::new(self.viewer[0][lane], self.viewer[1][lane], self.viewer[2][lane])
    }

    /// The end of the f32 ray in a lane, as the closest hit so far bounds it.
    #[inline(always)]
    pub fn closest_tfar(&self, lane: usize) -> f32 {
        self.rays.interval.f32_t(lane, self.hits.upper(lane))
    }
}
