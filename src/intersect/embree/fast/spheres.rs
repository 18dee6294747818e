//! The spheres as one user geometry, and the tests of precision `fast` for it.
//!
//! The tests compute in f64 from the rays that travel in the query context; of Embree's own ray they
//! only lower `tfar`, rounded up, so that what lies behind is skipped. The closest sphere stays in the
//! context.

use glam::DVec3;

use crate::geometry::{Bounds, Hit, PrimitiveId, sphere};
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::{
    CallbackPacket, INVALID, PrimitiveTable, UserPrimitive, UserPrimitives,
};
use crate::intersect::embree::packet::QueryContext;
use crate::intersect::ray_ends::{RayEnds, SphereDeparture};
use crate::scene::{Scene, Sphere};

/// The spheres of a scene, as callbacks of either precision read them.
pub struct SphereTable {
    space: F32Space,
    pub spheres: Vec<SphereEntry>,
}

/// A sphere without what only shading needs.
#[derive(Clone, Copy)]
pub struct SphereEntry {
    pub center: DVec3,
    pub radius: f64,
    pub blocks_light: bool,
}

impl SphereTable {
    /// Makes the table, on the heap since Embree keeps its address.
    pub fn new(scene: &Scene, space: F32Space) -> Box<Self> {
        let mut table = Box::new(Self { space, spheres: Vec::new() });
        table.update(scene);
        table
    }

    /// Copies the spheres of a scene. If they moved, or are more or fewer, Embree must be told.
    pub fn update(&mut self, scene: &Scene) {
        let entry = |(i, s): (u32, &Sphere)| SphereEntry {
            center: s.center,
            radius: s.radius,
            blocks_light: scene.blocks_light(PrimitiveId::sphere(i)),
        };
        self.spheres.clear();
        self.spheres.extend((0..).zip(&scene.spheres).map(entry));
    }
}

impl PrimitiveTable for SphereTable {
    fn len(&self) -> usize {
        self.spheres.len()
    }

    fn bounds(&self, index: u32) -> (Bounds, &F32Space) {
        let s = &self.spheres[index as usize];
        (Bounds { lower: s.center - s.radius, upper: s.center + s.radius }, &self.space)
    }
}

/// The spheres as precision `fast` tests them.
pub struct FastSpheres;

/// A sphere as precision `fast` tests it.
pub struct FastSphere<'t> {
    index: u32,
    sphere: &'t SphereEntry,
}

impl UserPrimitives for FastSpheres {
    type Table = SphereTable;
    type Primitive<'t> = FastSphere<'t>;

    #[inline(always)]
    fn get<'t, const W: usize>(
        table: &'t SphereTable,
        index: u32,
        _: &QueryContext<'_, W>,
    ) -> FastSphere<'t> {
        FastSphere { index, sphere: &table.spheres[index as usize] }
    }
}

impl UserPrimitive for FastSphere<'_> {
    #[inline(always)]
    fn intersect<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>) {
        let (context, active, tfar) = packet.parts();
        let Some(ts) = self.distances(context, active) else { return };
        for i in 0..W {
            let closer = self.is_closer(context, i, ts[i]);
            if closer {
                context.hits.t[i] = ts[i];
                context.hits.primitive[i] = self.index;
                context.hits.instance[i] = INVALID;
            }
            let end = context.rays.interval.f32_t(i, ts[i]);
            if closer && end < tfar[i] {
                tfar[i] = end;
            }
        }
    }

    #[inline(always)]
    fn intersect_lane<const W: usize>(&self, context: &mut QueryContext<'_, W>, lane: usize) {
        let t = self.distance(context, lane);
        if self.is_closer(context, lane, t) {
            context.hits.t[lane] = t;
            context.hits.primitive[lane] = self.index;
            context.hits.instance[lane] = INVALID;
        }
    }

    #[inline(always)]
    fn occluded<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>) {
        if !self.sphere.blocks_light {
            return;
        }
        let (context, active, tfar) = packet.parts();
        let Some(mut ts) = self.distances(context, active) else { return };
        // Nearly always no light lies on the sphere.
        let (mut may_end, mut any_may_end) = ([false; W], false);
        if context.are_shadow_rays {
            for i in 0..W {
                may_end[i] = self.may_end(context, i) & (ts[i] < context.rays.tmax[i]);
                any_may_end |= may_end[i];
            }
        }
        if any_may_end {
            for i in (0..W).filter(|&i| may_end[i]) {
                ts[i] = if self.ends_at(context, i, ts[i]) { f64::INFINITY } else { ts[i] };
            }
        }
        for i in 0..W {
            tfar[i] = if ts[i] < context.rays.tmax[i] { f32::NEG_INFINITY } else { tfar[i] };
        }
    }

    #[inline(always)]
    fn occluded_lane<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        let t = self.distance(context, lane);
        self.sphere.blocks_light && t < context.rays.tmax[lane] && !self.ends_at(context, lane, t)
    }
}

impl FastSphere<'_> {
    /// True if ray `i` may end on the sphere, to within rounding.
    #[inline(always)]
    fn may_end<const W: usize>(&self, context: &QueryContext<'_, W>, i: usize) -> bool {
        let (origin, direction) = context.rays.origin_and_direction(i);
        let (radius, tolerance) = (self.sphere.radius, context.departures.tolerance);
        let offset = origin + direction * context.rays.tmax[i] - self.sphere.center;
        let power = offset.length_squared() - radius * radius;
        power.abs() <= tolerance * (2.0 * radius + tolerance)
    }

    /// True if ray `i`, a shadow ray that hits the sphere at `t`, ends on it there: its light lies on it.
    fn ends_at<const W: usize>(&self, context: &QueryContext<'_, W>, i: usize, t: f64) -> bool {
        if !context.are_shadow_rays || i >= context.packet.count || !self.may_end(context, i) {
            return false;
        }
        let ray = context.packet.ray(i);
        let hit = Hit { t, u: 0.0, v: 0.0, id: PrimitiveId::sphere(self.index) };
        RayEnds::new(context.scene, &ray).ends_at(&hit)
    }

    /// True if the sphere at distance `t` is closer than the hit of ray `i` so far; at the same distance
    /// the lesser index counts.
    #[inline(always)]
    fn is_closer<const W: usize>(&self, context: &QueryContext<'_, W>, i: usize, t: f64) -> bool {
        let QueryContext { hits, rays, .. } = context;
        // A sphere comes before a triangle.
        let is_less = (self.index < hits.primitive[i]) | (hits.instance[i] != INVALID);
        let is_first = t < hits.t[i] || (t == hits.t[i] && is_less);
        is_first && t < rays.tmax[i]
    }

    /// The first t > 0 at which each active ray hits the sphere, or infinity; `None` if no ray does.
    #[inline(always)]
    fn distances<const W: usize>(
        &self,
        context: &QueryContext<'_, W>,
        active: &[i32; W],
    ) -> Option<[f64; W]> {
        // The next hit of a continuation ray is not always the first root: test one by one.
        let mut ts = [f64::INFINITY; W];
        if context.departures.any_continuation {
            for i in (0..W).filter(|&i| active[i] != 0) {
                ts[i] = self.distance(context, i);
            }
            return Some(ts);
        }
        // See whether any line crosses the sphere: most do not.
        let mut crosses = [false; W];
        let mut any = false;
        for i in 0..W {
            crosses[i] = self.quadratic(context, i).crosses() & (active[i] != 0);
            any |= crosses[i];
        }
        if !any {
            return None;
        }
        // Solve for the first root ahead.
        let departures = &context.departures;
        let mut on_surface = [false; W];
        let mut any_on_surface = false;
        for i in 0..W {
            let quadratic = self.quadratic(context, i);
            let (near, far) = quadratic.roots();
            let t = if near > 0.0 { near } else { far };
            let hits = crosses[i] & (t > 0.0) & (departures.outward[i] != self.index);
            ts[i] = if hits { t } else { f64::INFINITY };
            let (radius, power) = (self.sphere.radius, quadratic.power());
            on_surface[i] = hits & departures.may_start_on_sphere(i, self.index, radius, power);
            any_on_surface |= on_surface[i];
        }
        // Rays that start on the sphere are few: test them one by one.
        if departures.any & any_on_surface {
            for i in (0..W).filter(|&i| on_surface[i]) {
                ts[i] = self.distance(context, i);
            }
        }
        Some(ts)
    }

    /// The first t > 0 at which ray `i` hits the sphere, or infinity.
    #[inline(always)]
    fn distance<const W: usize>(&self, context: &QueryContext<'_, W>, i: usize) -> f64 {
        let quadratic = self.quadratic(context, i);
        if !quadratic.crosses() {
            return f64::INFINITY;
        }
        if i >= context.packet.count {
            return f64::INFINITY;
        }
        let ray = context.packet.ray(i);
        if ray.continuation.is_some() {
            let tests = context.query.primitives().with_ray(&ray);
            let hit = tests.sphere(self.index, f64::INFINITY);
            return hit.map_or(f64::INFINITY, |hit| hit.t);
        }
        let root = |inward| sphere::first_root(quadratic.roots(), f64::INFINITY, inward);
        let departure = RayEnds::new(context.scene, &ray).sphere_departure(self.index);
        let t = match (root(false), departure) {
            (None, _) | (_, SphereDeparture::Outward) => None,
            (t, SphereDeparture::No) => t,
            (_, SphereDeparture::Inward) => root(true),
        };
        t.unwrap_or(f64::INFINITY)
    }

    /// The quadratic equation of the sphere and ray `i`.
    #[inline(always)]
    fn quadratic<const W: usize>(
        &self,
        context: &QueryContext<'_, W>,
        i: usize,
    ) -> sphere::Quadratic {
        let (origin, direction) = context.rays.origin_and_direction(i);
        let inverse = context.rays.inverse_length_squared[i];
        sphere::Quadratic::new(self.sphere.center, self.sphere.radius, origin, direction, inverse)
    }
}
