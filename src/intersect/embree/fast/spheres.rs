//! The spheres as one user geometry, and the tests of precision `fast` for it.
//!
//! The tests compute in f64 from the rays that travel in the query context; of Embree's own ray they
//! only lower `tfar`, rounded up, so that what lies behind is skipped. The closest sphere stays in the
//! context.

use glam::DVec3;

use crate::geometry::{Bounds, PrimitiveId, Ray, sphere};
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::callbacks::{CallbackPacket, PrimitiveTests};
use crate::intersect::embree::ffi::user_geometry::PrimitiveTable;
use crate::intersect::embree::packet::context::QueryContext;
use crate::intersect::primitive::{SphereDeparture, sphere_departure};
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

/// The tests of precision `fast`.
pub struct FastSpheres;

impl PrimitiveTests for FastSpheres {
    type Table = SphereTable;

    #[inline(always)]
    fn intersect<const W: usize>(
        table: &SphereTable,
        index: u32,
        packet: &mut CallbackPacket<'_, W>,
    ) {
        let (context, active, tfar) = packet.parts();
        let Some(ts) = distances(context, table, index, active) else { return };
        for i in 0..W {
            let closer = is_closer(context, index, i, ts[i]);
            if closer {
                context.hits.t[i] = ts[i];
                context.hits.primitive[i] = index;
            }
            let end = context.rays.interval.to_f32_t(i, ts[i]);
            if closer && end < tfar[i] {
                tfar[i] = end;
            }
        }
    }

    #[inline(always)]
    fn intersect_lane<const W: usize>(
        table: &SphereTable,
        index: u32,
        context: &mut QueryContext<'_, W>,
        lane: usize,
    ) {
        let t = distance(context, table, index, lane);
        if is_closer(context, index, lane, t) {
            context.hits.t[lane] = t;
            context.hits.primitive[lane] = index;
        }
    }

    #[inline(always)]
    fn occluded<const W: usize>(
        table: &SphereTable,
        index: u32,
        packet: &mut CallbackPacket<'_, W>,
    ) {
        let (context, active, tfar) = packet.parts();
        if !table.spheres[index as usize].blocks_light {
            return;
        }
        let Some(ts) = distances(context, table, index, active) else { return };
        for i in 0..W {
            if ts[i] < context.rays.tmax[i] {
                tfar[i] = f32::NEG_INFINITY;
            }
        }
    }

    #[inline(always)]
    fn occluded_lane<const W: usize>(
        table: &SphereTable,
        index: u32,
        context: &mut QueryContext<'_, W>,
        lane: usize,
    ) -> bool {
        table.spheres[index as usize].blocks_light
            && distance(context, table, index, lane) < context.rays.tmax[lane]
    }
}

/// True if sphere `index` at distance `t` is closer than the hit of ray `i` so far; at the same
/// distance the lesser index counts.
#[inline(always)]
fn is_closer<const W: usize>(context: &QueryContext<'_, W>, index: u32, i: usize, t: f64) -> bool {
    let hits = &context.hits;
    (t < hits.t[i] || (t == hits.t[i] && index < hits.primitive[i])) && t < context.rays.tmax[i]
}

/// The first t > 0 at which each active ray hits sphere `index`, or infinity; `None` if no ray does.
#[inline(always)]
fn distances<const W: usize>(
    context: &QueryContext<'_, W>,
    table: &SphereTable,
    index: u32,
    active: &[i32; W],
) -> Option<[f64; W]> {
    let sphere = &table.spheres[index as usize];
    // The next hit of a continuation ray is not always the first root: test one by one.
    if context.departures.any_continuation {
        let mut ts = [f64::INFINITY; W];
        for i in (0..W).filter(|&i| active[i] != 0) {
            ts[i] = distance(context, table, index, i);
        }
        return Some(ts);
    }
    // See whether any line crosses the sphere: most do not.
    let mut crosses = [false; W];
    let mut any = false;
    for i in 0..W {
        crosses[i] = quadratic(context, sphere, i).crosses() & (active[i] != 0);
        any |= crosses[i];
    }
    if !any {
        return None;
    }
    // Solve for the first root ahead.
    let mut ts = [f64::INFINITY; W];
    let mut on_surface = [false; W];
    let mut any_on_surface = false;
    for i in 0..W {
        let quadratic = quadratic(context, sphere, i);
        let (near, far) = quadratic.roots();
        let t = if near > 0.0 { near } else { far };
        let hits = crosses[i] & (t > 0.0) & (context.departures.outward[i] != index);
        ts[i] = if hits { t } else { f64::INFINITY };
        let power = quadratic.power();
        on_surface[i] =
            hits & context.departures.may_start_on_sphere(i, index, sphere.radius, power);
        any_on_surface |= on_surface[i];
    }
    // Rays that start on the sphere are few: test them one by one.
    if context.departures.any & any_on_surface {
        for i in (0..W).filter(|&i| on_surface[i]) {
            ts[i] = distance(context, table, index, i);
        }
    }
    Some(ts)
}

/// The first t > 0 at which ray `i` hits sphere `index`, or infinity.
#[inline(always)]
fn distance<const W: usize>(
    context: &QueryContext<'_, W>,
    table: &SphereTable,
    index: u32,
    i: usize,
) -> f64 {
    let quadratic = quadratic(context, &table.spheres[index as usize], i);
    if !quadratic.crosses() {
        return f64::INFINITY;
    }
    if let Some(ray) = context.packet.get(i).filter(|ray| ray.continuation.is_some()).as_ref() {
        let inverse = context.rays.inverse_length_squared[i];
        let hit = context.scene.primitives().sphere(index, ray, inverse, f64::INFINITY);
        return hit.map_or(f64::INFINITY, |hit| hit.t);
    }
    let root = |inward| sphere::first_root(quadratic.roots(), f64::INFINITY, inward);
    let departure = |ray: Ray| sphere_departure(context.scene.scene, index, &ray);
    let t = match (root(false), context.packet.get(i).map_or(SphereDeparture::No, departure)) {
        (None, _) | (_, SphereDeparture::Outward) => None,
        (t, SphereDeparture::No) => t,
        (_, SphereDeparture::Inward) => root(true),
    };
    t.unwrap_or(f64::INFINITY)
}

/// The quadratic equation of ray `i` and a sphere.
#[inline(always)]
fn quadratic<const W: usize>(
    context: &QueryContext<'_, W>,
    sphere: &SphereEntry,
    i: usize,
) -> sphere::Quadratic {
    let (origin, direction) = context.rays.origin_and_direction(i);
    let inverse = context.rays.inverse_length_squared[i];
    sphere::Quadratic::new(sphere.center, sphere.radius, origin, direction, inverse)
}
