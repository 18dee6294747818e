//! Spheres and triangles as user geometry of precision `certified`: each that Embree offers is tested in
//! f64 with an error bound, and exactly where that cannot tell.
//!
//! The tests change nothing of Embree's own ray but `tfar`: they lower it, with slack, so that what
//! lies behind is skipped.

use glam::DVec3;

use crate::geometry::incidence::are_on_one_side;
use crate::geometry::{Estimate, PrimitiveId, sphere, triangle};
use crate::intersect::embree::fast::{SphereEntry, SphereTable};
use crate::intersect::embree::ffi::{CallbackPacket, UserPrimitive, UserPrimitives};
use crate::intersect::embree::packet::QueryContext;
use crate::intersect::embree::user_meshes::TriangleTable;
use crate::intersect::ray_ends::{RayEnds, SphereDeparture};

/// A primitive as the callbacks of precision `certified` test it.
pub struct CertifiedPrimitive<S> {
    pub id: PrimitiveId,
    pub shape: S,
    blocks_light: bool,
    /// True if a mask may cut holes into it, so that only the exact weights of a hit tell.
    pub is_masked: bool,
}

/// The shape of a primitive. All functions are to be inlined always.
pub trait Shape {
    /// False if a line certainly passes it at more than a distance.
    fn may_pass_within(
        &self,
        distance: f64,
        origin: DVec3,
        direction: DVec3,
        inverse_length_squared: f64,
    ) -> bool;

    /// False if a point certainly lies farther off than `distance`, at least 128 u times the largest
    /// coordinate; `true` may be wrong.
    fn may_contain(&self, point: DVec3, distance: f64) -> bool;

    /// The estimate of the first t > 0, for a ray that left no surface.
    fn estimate(&self, origin: DVec3, direction: DVec3, inverse_length_squared: f64) -> Estimate;

    /// False if two directions certainly go to one side of it at a point on it.
    fn may_separate(&self, point: DVec3, a: DVec3, b: DVec3) -> bool;

    /// True if a ray that left a surface, and that by its estimate hits it,
    /// starts on it and so may not hit it.
    fn may_start_on<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool;
}

impl<S: Shape> UserPrimitive for CertifiedPrimitive<S> {
    #[inline(always)]
    fn intersect<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>) {
        let (context, active, tfar) = packet.parts();
        context.keep_closest(self, active, tfar);
    }

    #[inline(always)]
    fn intersect_lane<const W: usize>(&self, context: &mut QueryContext<'_, W>, lane: usize) {
        context.resolve_exactly(lane, self.id);
    }

    #[inline(always)]
    fn occluded<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>) {
        let (context, active, tfar) = packet.parts();
        if self.blocks_light {
            context.mark_occluded(self, active, tfar);
        } else if context.collects_crossings() {
            context.note_crossings(self, active);
        }
    }

    #[inline(always)]
    fn occluded_lane<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        if !self.blocks_light {
            context.note_crossing(lane, self.id);
            return false;
        }
        context.exact_hit(lane, self.id).is_some()
    }
}

/// A sphere, tested with a bound.
pub struct CertifiedSphere {
    index: u32,
    center: DVec3,
    radius: f64,
}

impl UserPrimitives for CertifiedSphere {
    type Table = SphereTable;
    type Primitive<'t> = CertifiedPrimitive<Self>;

    #[inline(always)]
    fn get<const W: usize>(
        table: &SphereTable,
        index: u32,
        _: &QueryContext<'_, W>,
    ) -> CertifiedPrimitive<Self> {
        let SphereEntry { center, radius, blocks_light } = table.spheres[index as usize];
        let shape = Self { index, center, radius };
        let id = PrimitiveId::sphere(index);
        CertifiedPrimitive { id, shape, blocks_light, is_masked: false }
    }
}

impl Shape for CertifiedSphere {
    #[inline(always)]
    fn may_pass_within(
        &self,
        distance: f64,
        origin: DVec3,
        direction: DVec3,
        inverse: f64,
    ) -> bool {
        let radius = self.radius + distance;
        sphere::certified::QuadraticBound::new(self.center, radius, origin, direction, inverse)
            .may_cross()
    }

    #[inline(always)]
    fn may_contain(&self, point: DVec3, distance: f64) -> bool {
        let power = (point - self.center).length_squared() - self.radius * self.radius;
        // Negated for what is not a number.
        let apart = power.abs() > distance * (2.0 * self.radius + distance);
        !apart
    }

    #[inline(always)]
    fn may_separate(&self, point: DVec3, a: DVec3, b: DVec3) -> bool {
        let normal = point - self.center;
        !are_on_one_side(normal, normal.abs(), a, b)
    }

    #[inline(always)]
    fn estimate(&self, origin: DVec3, direction: DVec3, inverse: f64) -> Estimate {
        sphere::certified::estimate(self.center, self.radius, origin, direction, inverse)
    }

    #[inline(always)]
    fn may_start_on<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        let f = context.rays.origin_and_direction(lane).0 - self.center;
        let power = f.length_squared() - self.radius * self.radius;
        context.departures.may_start_on_sphere(lane, self.index, self.radius, power)
            && RayEnds::new(context.scene, &context.packet.ray(lane)).sphere_departure(self.index)
                != SphereDeparture::No
    }
}

/// A triangle, tested with a bound.
pub struct CertifiedTriangle {
    id: PrimitiveId,
    vertices: [DVec3; 3],
}

impl UserPrimitives for CertifiedTriangle {
    type Table = TriangleTable;
    type Primitive<'t> = CertifiedPrimitive<Self>;

    #[inline(always)]
    fn get<const W: usize>(
        table: &TriangleTable,
        index: u32,
        context: &QueryContext<'_, W>,
    ) -> CertifiedPrimitive<Self> {
        let id = table.id(index, context);
        let scene = context.scene;
        CertifiedPrimitive {
            id,
            shape: Self { id, vertices: scene.triangle_vertices(id) },
            blocks_light: scene.blocks_light(id),
            is_masked: context.query.is_masked(id.instance),
        }
    }
}

impl Shape for CertifiedTriangle {
    #[inline(always)]
    fn may_pass_within(&self, distance: f64, origin: DVec3, direction: DVec3, _: f64) -> bool {
        triangle::certified::EdgeBounds::new(self.vertices, origin, direction)
            .may_pass_within(distance)
    }

    #[inline(always)]
    fn may_contain(&self, point: DVec3, distance: f64) -> bool {
        // With the product w of the sides' largest components, the normal is at most 2 √3 w long, and
        // the height off by 64 u w times a coordinate, of which the distance is 128 u.
        let [a, b, c] = self.vertices;
        let (first, second) = (b - a, c - a);
        let area = first.abs().max_element() * second.abs().max_element();
        let height = first.cross(second).dot(point - a).abs();
        // Negated for what is not a number.
        let apart = height > 5.0 * area * distance;
        !apart
    }

    #[inline(always)]
    fn may_separate(&self, _: DVec3, a: DVec3, b: DVec3) -> bool {
        let (first, second) =
            (self.vertices[1] - self.vertices[0], self.vertices[2] - self.vertices[0]);
        let area = first.abs().max_element() * second.abs().max_element();
        !are_on_one_side(first.cross(second), DVec3::splat(2.0 * area), a, b)
    }

    #[inline(always)]
    fn estimate(&self, origin: DVec3, direction: DVec3, _: f64) -> Estimate {
        triangle::certified::estimate(self.vertices, origin, direction)
    }

    fn may_start_on<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        RayEnds::new(context.scene, &context.packet.ray(lane))
            .starts_on_triangle(self.id, self.vertices)
    }
}
