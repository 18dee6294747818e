//! Meshes in object space: an instance is a user primitive that takes the exact ray into the object
//! space in f64, and traces the BLAS of the mesh with the f32 copy made there. (Embree's own instances transform the f32 ray, in f32.)
//!
//! A mesh is in object space when it has several instances, and when it is so small in the scene that
//! the scene's padding would drown its triangles.

use std::sync::Arc;

use embree4_sys::RTCSceneFlags;
use glam::DVec3;

use crate::error::Result;
use crate::geometry::{Bounds, PrimitiveId};
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::{
    CallbackPacket, CommittedScene, LaneMask, PrimitiveTable, RayHitRecord, UserPrimitive,
    UserPrimitives, new_geometry,
};
use crate::intersect::embree::packet::{Approach, PacketRays, QueryContext};
use crate::intersect::embree::scene_builder::SceneBuilder;
use crate::intersect::embree::user_meshes::triangle_table::TriangleTable;
use crate::intersect::object_space::ObjectSpace;
use crate::scene::Instance;

/// The BLAS of a mesh.
pub struct Blas {
    scene: CommittedScene,
    /// The space of its f32 vertices.
    space: F32Space,
    /// The table that the callbacks read; dropped after the scene that calls them.
    _table: Box<TriangleTable>,
}

impl Blas {
    /// Builds the BLAS of the mesh with this index, whose triangles are tested as `P`.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn new<P>(builder: &SceneBuilder<'_>, mesh: usize) -> Result<Self>
    where
        P: UserPrimitives<Table = TriangleTable>,
    {
        let SceneBuilder { device, quality, .. } = builder;
        let space = F32Space::from_bounds(builder.mesh_bounds[mesh]);
        let table = TriangleTable::in_object_space(builder.scene, mesh as u32, space);
        let geometry = new_geometry::<P>(device, *quality, &table)?;
        let scene = CommittedScene::new(device, *quality, RTCSceneFlags::NONE, &geometry)?;
        Ok(Self { scene, space, _table: table })
    }
}

/// The instances whose meshes are in object space, by ascending index.
pub struct InstanceTable {
    space: F32Space,
    entries: Vec<InstanceEntry>,
}

/// An instance whose mesh is in object space.
pub struct InstanceEntry {
    instance: u32,
    blas: Arc<Blas>,
    object_space: ObjectSpace,
    /// The box in world space.
    bounds: Bounds,
}

impl InstanceTable {
    pub fn new(space: F32Space) -> Self {
        Self { space, entries: Vec::new() }
    }

    /// Adds the instance with this index, whose box in world space is `bounds`.
    pub fn push(&mut self, index: u32, instance: &Instance, bounds: Bounds, blas: Arc<Blas>) {
        let object_space = ObjectSpace::new(instance, &bounds);
        self.entries.push(InstanceEntry { instance: index, blas, object_space, bounds });
    }

    /// Moves the instance with this index, if it is in the table.
    pub fn update(&mut self, index: u32, instance: &Instance, bounds: Bounds) {
        if let Ok(i) = self.entries.binary_search_by_key(&index, |entry| entry.instance) {
            let entry = &mut self.entries[i];
            entry.object_space = ObjectSpace::new(instance, &bounds);
            entry.bounds = bounds;
        }
    }

    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}

impl PrimitiveTable for InstanceTable {
    fn len(&self) -> usize {
        self.entries.len()
    }

    fn bounds(&self, index: u32) -> (Bounds, &F32Space) {
        (self.entries[index as usize].bounds, &self.space)
    }
}

/// The packet before and after its BLAS was traced.
struct Traced<const W: usize> {
    /// The ends of the f32 rays in world space.
    world_tfar: [f32; W],
    /// The rays that were traced.
    active: LaneMask<W>,
    /// The rays that f64 cannot transform well enough; they are to be tested with every triangle.
    brute_force: [bool; W],
}

impl InstanceEntry {
    /// Traces the BLAS with the active rays of a packet, as far as `limits`. Afterwards `tfar` of
    /// those that were traced is that of the f32 rays in object space.
    #[inline(always)]
    fn trace<const W: usize>(
        &self,
        packet: &mut CallbackPacket<'_, W>,
        limits: [f64; W],
    ) -> Traced<W> {
        let (context, active, tfar) = packet.parts();
        // Transform the rays into object space, in f64.
        let mut rays = PacketRays::<W>::new();
        rays.tmax = limits;
        let (mut imprecise, mut any_imprecise) = ([false; W], false);
        for i in 0..W {
            let (o, d) = context.rays.origin_and_direction(i);
            rays.set_lane(i, self.object_space.object_ray(o, d));
            imprecise[i] = !self.is_precise(o) & (active[i] != 0);
            any_imprecise |= imprecise[i];
        }
        // Those that start too far away for that are transformed from where they come near.
        let (mut starts, mut passes) = ([0.0; W], [false; W]);
        if any_imprecise {
            for i in 0..W {
                if !imprecise[i] {
                    continue;
                }
                let (o, d) = context.rays.origin_and_direction(i);
                let near = F32Space::from_bounds(self.bounds);
                match Approach::new(o, d, &near) {
                    Approach::Near { t, point } if self.is_precise(near.center + point) => {
                        starts[i] = Approach::least_t(t);
                        rays.set_lane(i, self.object_space.object_ray(near.center + point, d));
                        rays.tmax[i] = limits[i] - starts[i];
                        imprecise[i] = false;
                    }
                    Approach::Passes => passes[i] = true,
                    Approach::Near { .. } | Approach::Lost => {}
                }
            }
        }
        // Set up the f32 rays there.
        let mut record = RayHitRecord::<W>::new();
        let lanes = rays.set_up_f32_rays(&self.blas.space, &mut record);
        let mut traced =
            Traced { world_tfar: *tfar, active: LaneMask([0; W]), brute_force: [false; W] };
        let mut any = false;
        for i in 0..W {
            let may_hit = (active[i] != 0) & !passes[i];
            let brute_force = imprecise[i] | lanes.brute_force[i];
            let is_traced = may_hit & lanes.traced[i] & !brute_force;
            traced.active.0[i] = if is_traced { -1 } else { 0 };
            traced.brute_force[i] = may_hit & brute_force;
            any |= is_traced;
            rays.interval.start[i] += starts[i];
        }
        for i in 0..W {
            if traced.active.0[i] != 0 {
                tfar[i] = record.tfar[i];
            }
        }
        // Trace them; meanwhile the context has the intervals of these rays.
        if any {
            let interval = std::mem::replace(&mut context.rays.interval, rays.interval);
            context.instance = self.instance;
            packet.forward(&self.blas.scene, self.instance, &traced.active, &mut record);
            packet.parts().0.rays.interval = interval;
        }
        traced
    }

    /// True if f64 transforms a ray from `origin` well enough into object space.
    #[inline(always)]
    fn is_precise(&self, origin: DVec3) -> bool {
        self.object_space.error(origin) <= self.blas.space.max_transform_error()
    }

    /// True if the triangles of the instance block light.
    fn blocks_light<const W: usize>(&self, context: &QueryContext<'_, W>) -> bool {
        let scene = context.scene;
        let mesh = scene.instances[self.instance as usize].mesh.0;
        scene.blocks_light(PrimitiveId::triangle(mesh, 0, self.instance))
    }
}

impl UserPrimitives for InstanceTable {
    type Table = Self;
    type Primitive<'t> = &'t InstanceEntry;

    #[inline(always)]
    fn get<'t, const W: usize>(
        table: &'t Self,
        index: u32,
        _: &QueryContext<'_, W>,
    ) -> &'t InstanceEntry {
        &table.entries[index as usize]
    }
}

impl UserPrimitive for &InstanceEntry {
    #[inline(always)]
    fn intersect<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>) {
        let context = packet.parts().0;
        let mut limits = [0.0; W];
        for i in 0..W {
            limits[i] = context.hits.upper(i);
        }
        let traced = self.trace(packet, limits);
        let (context, _, tfar) = packet.parts();
        for i in 0..W {
            if traced.brute_force[i] {
                context.resolve_instance(i, self.instance);
            }
        }
        for i in 0..W {
            tfar[i] = context.closest_tfar(i).min(traced.world_tfar[i]);
        }
    }

    #[inline(always)]
    fn intersect_lane<const W: usize>(&self, context: &mut QueryContext<'_, W>, lane: usize) {
        context.resolve_instance(lane, self.instance);
    }

    #[inline(always)]
    fn occluded<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>) {
        let context = packet.parts().0;
        let blocks_light = self.blocks_light(context);
        if !blocks_light && !context.collects_crossings() {
            return;
        }
        let limits = context.rays.tmax;
        let traced = self.trace(packet, limits);
        let (context, _, tfar) = packet.parts();
        for i in 0..W {
            let occluded = if traced.brute_force[i] && !blocks_light {
                context.note_instance(i, self.instance);
                false
            } else if traced.brute_force[i] {
                context.hits_instance(i, self.instance)
            } else {
                traced.active.0[i] != 0 && tfar[i] == f32::NEG_INFINITY
            };
            tfar[i] = if occluded { f32::NEG_INFINITY } else { traced.world_tfar[i] };
        }
    }

    #[inline(always)]
    fn occluded_lane<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        if !self.blocks_light(context) {
            if context.collects_crossings() {
                context.note_instance(lane, self.instance);
            }
            return false;
        }
        context.hits_instance(lane, self.instance)
    }
}
