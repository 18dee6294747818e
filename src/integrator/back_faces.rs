//! Back-face culling: rays pass through the back faces of one-sided surfaces as if nothing were there.
//!
//! Culling belongs to pictures: queries and the validation of hits find every face. All rays of this
//! integrator come from the camera by way of sharp mirrors and clear surfaces only, and so are culled;
//! shadow rays are not.

use crate::geometry::{
    Geometry, Hit, HitBatch, LANES, PrimitiveId, PrimitiveId16, Ray, RayBatch, Side, triangle,
};
use crate::integrator::{Counts, Integrator, simd};
use crate::intersect::Coherence;
use crate::scene::{Scene, Triangles};

/// The sides from which the instances of a scene are not seen.
#[derive(Debug, Default)]
pub(super) struct BackFaces {
    /// The culled side of each instance, if it has one; empty if none has.
    culled: Vec<Option<Side>>,
}

impl BackFaces {
    /// Finds the culled sides of a scene.
    pub fn new(scene: &Scene) -> Self {
        if !scene.materials_in_use().any(|material| material.cull_back_faces) {
            return Self::default();
        }
        let culled = scene.instances.iter().map(|instance| {
            let is_culled = scene.materials[instance.material.0 as usize].cull_back_faces;
            // A mirrored instance has its front where its vertices run clockwise (glTF 2.0, 3.7.4).
            let is_mirrored = instance.transform.matrix3.determinant() < 0.0;
            is_culled.then_some(if is_mirrored { Side::Front } else { Side::Back })
        });
        Self { culled: culled.collect() }
    }

    /// True if no instance has a culled side.
    pub fn is_empty(&self) -> bool {
        self.culled.is_empty()
    }

    /// Returns the side from which a triangle is not seen, if there is one.
    pub fn culled_side(&self, id: PrimitiveId) -> Option<Side> {
        let is_triangle = matches!(id.geometry, Geometry::Mesh(_));
        self.culled.get(id.instance as usize).copied().flatten().filter(|_| is_triangle)
    }

    /// Sets `culled` to the numbers of the rays of a batch that hit a culled side, and `continued` to
    /// their continuations. Returns the number of hits on surfaces that have such a side. `is_first` says
    /// that none of the rays has passed a back face yet.
    #[inline(always)]
    fn find_culled(
        &self,
        scene: &Scene,
        rays: &RayBatch,
        hits: &HitBatch,
        is_first: bool,
        culled: &mut Vec<usize>,
        continued: &mut RayBatch,
    ) -> u64 {
        let mut count = 0;
        culled.clear();
        continued.clear();
        for (block, (ray16, hit16)) in rays.blocks().iter().zip(hits.blocks()).enumerate() {
            let PrimitiveId16 { geometry, primitive, instance } = &hit16.id;
            let Some(triangles) = Triangles::from_ids(scene, geometry, primitive, instance) else {
                continue;
            };
            // The side that each ray sees, as surfaces decide it.
            let mut sees_back = [false; LANES];
            for i in 0..LANES {
                let normal = triangle::area_normal(triangles.vertices(i));
                sees_back[i] = normal.dot(ray16.origin_and_direction(i).1) > 0.0;
            }
            for i in (0..LANES).filter(|&i| geometry[i] >= PrimitiveId16::MESHES) {
                let side = if sees_back[i] { Side::Back } else { Side::Front };
                let Some(culled_side) = self.culled[instance[i] as usize] else { continue };
                count += 1;
                if culled_side == side
                    && let Some(hit) = hit16.hit(i)
                {
                    culled.push(block * LANES + i);
                    let ray = rays.ray(block * LANES + i);
                    continued.push(&beyond(&ray, &hit, side.opposite(), is_first));
                }
            }
        }
        count
    }
}

/// The relative distance within which a face may lie at the same place as another: twice that within
/// which precision `fast` may find two in either order.
const COINCIDENCE: f64 = 1.0 / (1u64 << 31) as f64;

/// Returns the continuation of a ray past a back face that it hit, on whose `side` it goes on.
///
/// A leaf is often two faces at one place, of which Embree in precision `fast` finds either. The first
/// continuation begins just before them, so that it finds the other one, whichever comes first by its id.
fn beyond(ray: &Ray, hit: &Hit, side: Side, is_first: bool) -> Ray {
    let before = hit.t * (1.0 - COINCIDENCE);
    let hit = if is_first && before > ray.start_t() { Hit { t: before, ..*hit } } else { *hit };
    ray.continue_past(&hit, side)
}

/// Replaces the hits of rays on culled sides by their next hits on anything else.
pub(super) fn pass_back_faces(
    integrator: &Integrator<'_>,
    rays: &RayBatch,
    hits: &mut HitBatch,
    counts: &mut Counts,
) {
    let Integrator { scene, intersector, arch, .. } = *integrator;
    let mut is_first = true;
    let mut find =
        |rays: &RayBatch, hits: &HitBatch, culled: &mut Vec<usize>, to: &mut RayBatch| {
            simd::dispatch(
                arch,
                #[inline(always)]
                || {
                    let found =
                        integrator.back_faces.find_culled(scene, rays, hits, is_first, culled, to);
                    counts.work.culling += found;
                },
            );
            is_first = false;
        };
    let (mut passing, mut continued) = (Vec::new(), RayBatch::default());
    find(rays, hits, &mut passing, &mut continued);
    // What lies beyond may be culled again.
    let (mut next_hits, mut culled, mut next) =
        (HitBatch::default(), Vec::new(), RayBatch::default());
    let mut passes = 0;
    while !passing.is_empty() {
        intersector.closest_batch(&continued, Coherence::Incoherent, &mut next_hits);
        passes += continued.len() as u64;
        for (&i, hit) in passing.iter().zip(next_hits.iter()) {
            hits.set(i, hit);
        }
        find(&continued, &next_hits, &mut culled, &mut next);
        passing = culled.iter().map(|&i| passing[i]).collect();
        std::mem::swap(&mut continued, &mut next);
    }
    counts.rays.refraction += passes;
}
