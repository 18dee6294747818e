//! Nested dielectrics: which of several overlapping dielectrics fills a point (C. Schmidt and B. Budge,
//! *Simple Nested Dielectrics in Ray Traced Images*, Journal of Graphics Tools, 2002).

#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::geometry::{Geometry, PrimitiveId, Ray, Side};
use crate::intersect::{Coherence, Intersector};
use crate::scene::{Instance, MaterialId, Scene};
use crate::shading;
use crate::surface::Surface;

/// A medium that light goes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// The indices of refraction for red, green and blue.
    pub iors: [f64; 3],
    /// The absorption for each unit of length.
    pub absorption: Vec3,
}

impl Medium {
    /// The index of refraction for green.
    pub fn ior(&self) -> f64 {
        self.iors[1]
    }
}

/// The medium outside all dielectrics.
const EMPTY_SPACE: Medium = Medium { iors: [1.0; 3], absorption: Vec3::ZERO };

/// The rank of a dielectric in the order of priority. Where dielectrics overlap, the one with the
/// least rank fills the point.
type PriorityRank = u32;

/// The rank of an object that is not a dielectric.
const NO_DIELECTRIC: PriorityRank = PriorityRank::MAX;

/// The dielectrics that contain a point, by rank. The first one fills the point. A dielectric is listed
/// twice where two parts of its mesh overlap.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct InteriorList(SmallVec<[PriorityRank; 4]>);

impl Clone for InteriorList {
    #[inline]
    fn clone(&self) -> Self {
        Self(SmallVec::from_slice(&self.0))
    }
}

impl InteriorList {
    /// Returns the rank of the dielectric that fills the point.
    #[inline]
    fn first(&self) -> Option<PriorityRank> {
        self.0.first().copied()
    }

    /// Returns the list with another dielectric.
    fn inserted(&self, rank: PriorityRank) -> Self {
        let mut list = self.clone();
        list.0.insert(self.0.partition_point(|&r| r <= rank), rank);
        list
    }

    /// Returns the list without one entry of a dielectric, if it has any.
    fn removed(&self, rank: PriorityRank) -> Self {
        let mut list = self.clone();
        if let Some(i) = self.0.iter().position(|&r| r == rank) {
            list.0.remove(i);
        }
        list
    }
}

/// The dielectrics of a scene: spheres, half-spaces behind planes and closed meshes of a transmissive
/// material that is not thin.
///
/// The medium at a point depends on which dielectrics contain it, and not on how a ray came there: so a
/// path of light is the same both ways. If there are several, the one with the greatest priority fills
/// the point; among equal ones the one with the smallest bounding box, so that a bubble is in its glass
/// and the glass in the water; then the first in the scene.
#[derive(Debug, Default)]
pub struct NestedDielectrics {
    /// The medium of each dielectric, by rank.
    media: Vec<Medium>,
    /// The rank of each sphere.
    spheres: Vec<PriorityRank>,
    /// The rank of each plane.
    planes: Vec<PriorityRank>,
    /// The rank of each instance.
    instances: Vec<PriorityRank>,
    /// True for each instance whose triangles have their fronts inside: it is mirrored, or its mesh
    /// winds inward.
    is_inverted: Vec<bool>,
    /// True if a medium refracts each colour by its own index.
    may_disperse: bool,
}

impl NestedDielectrics {
    /// Ranks the dielectrics of a checked scene.
    pub fn new(scene: &Scene) -> Self {
        // All objects with their material and the volume of their box.
        let material = |id: MaterialId| &scene.materials[id.0 as usize];
        let meshes: Vec<_> = scene.meshes.iter().map(|mesh| mesh.bounds()).collect();
        let volume = |size: DVec3| size.x * size.y * size.z;
        let spheres =
            scene.spheres.iter().map(|s| (s.material, volume(DVec3::splat(2.0 * s.radius))));
        let planes = scene.planes.iter().map(|p| (p.material, f64::INFINITY));
        let instances = scene.instances.iter().map(|i| {
            let bounds = meshes[i.mesh.0 as usize].transformed(&i.transform);
            (i.material, volume(bounds.upper - bounds.lower))
        });
        let objects: Vec<(MaterialId, f64)> = spheres.chain(planes).chain(instances).collect();
        // The dielectrics among them, by rank.
        let mut order: Vec<usize> =
            (0..objects.len()).filter(|&i| material(objects[i].0).is_dielectric()).collect();
        if order.is_empty() {
            return Self::default();
        }
        order.sort_by(|&a, &b| {
            let ((a, volume_of_a), (b, volume_of_b)) = (objects[a], objects[b]);
            let priority = material(b).priority.cmp(&material(a).priority);
            priority.then(volume_of_a.total_cmp(&volume_of_b))
        });
        let mut ranks = vec![NO_DIELECTRIC; objects.len()];
        let mut media = Vec::with_capacity(order.len());
        for (rank, i) in order.into_iter().enumerate() {
            ranks[i] = rank as PriorityRank;
            let material = material(objects[i].0);
            let iors = shading::indices_by_color(material.ior, material.dispersion());
            media.push(Medium { iors, absorption: material.absorption });
        }
        // The ranks by kind of object.
        let instances = ranks.split_off(scene.spheres.len() + scene.planes.len());
        let planes = ranks.split_off(scene.spheres.len());
        let is_inverted = |(&rank, instance): (&PriorityRank, &Instance)| {
            if rank == NO_DIELECTRIC {
                return false;
            }
            let winds_inward = scene.meshes[instance.mesh.0 as usize].volume() < 0.0;
            winds_inward != (instance.transform.matrix3.determinant() < 0.0)
        };
        let is_inverted = instances.iter().zip(&scene.instances).map(is_inverted).collect();
        let may_disperse = media.iter().any(|medium: &Medium| medium.iors[0] != medium.iors[2]);
        Self { media, spheres: ranks, planes, instances, is_inverted, may_disperse }
    }

    /// True if the scene has no dielectrics.
    pub fn is_empty(&self) -> bool {
        self.media.is_empty()
    }

    /// True if a medium may absorb light, or a surface be hidden in a dielectric: in another one, or in
    /// its own mesh where that intersects itself. A single sphere or plane hides nothing.
    pub fn may_absorb_or_hide(&self) -> bool {
        let absorbs = self.media.iter().any(|medium| medium.absorption != Vec3::ZERO);
        absorbs || self.media.len() > 1 || self.instances.iter().any(|&rank| rank != NO_DIELECTRIC)
    }

    /// True if a medium refracts each colour by its own index.
    #[inline]
    pub fn may_disperse(&self) -> bool {
        self.may_disperse
    }

    /// Returns the medium at a point with an interior list.
    #[inline]
    pub fn medium(&self, interior: &InteriorList) -> Medium {
        interior.first().map_or(EMPTY_SPACE, |rank| self.media[rank as usize])
    }

    /// Returns the share of light that the medium lets pass along a ray, from its start to `end`.
    pub fn transmittance(&self, ray: &Ray, end: f64, interior: &InteriorList) -> DVec3 {
        let absorption = self.medium(interior).absorption;
        if absorption == Vec3::ZERO {
            return DVec3::ONE;
        }
        shading::transmittance(absorption, (end - ray.start_t()) * ray.direction.length())
    }

    fn rank(&self, id: PrimitiveId) -> Option<PriorityRank> {
        let ranks = match id.geometry {
            Geometry::Spheres => self.spheres.get(id.primitive as usize),
            Geometry::Planes => self.planes.get(id.primitive as usize),
            Geometry::Mesh(_) => self.instances.get(id.instance as usize),
        };
        ranks.copied().filter(|&rank| rank != NO_DIELECTRIC)
    }

    /// Converts a side of a surface to the side of the outward normal of its object: `Front` is outside,
    /// `Back` inside. The two differ where the triangles of a mesh have their fronts inside.
    pub fn oriented_side(&self, id: PrimitiveId, side: Side) -> Side {
        let is_mesh = matches!(id.geometry, Geometry::Mesh(_));
        if is_mesh && self.is_inverted[id.instance as usize] { side.opposite() } else { side }
    }

    /// Returns the dielectrics on both sides of a surface that a ray in `interior` hits from `side`.
    ///
    /// A ray that comes out of a dielectric without having gone into it, through a hole in its mesh or
    /// from the very surface of another, counts as having been in it.
    pub fn interface(
        &self,
        id: PrimitiveId,
        side: Side,
        interior: &InteriorList,
    ) -> InterfaceMedia {
        let Some(rank) = self.rank(id) else {
            let [incident, transmitted] = [interior.clone(), interior.clone()];
            return InterfaceMedia { incident, transmitted, is_hidden: false };
        };
        let (incident, transmitted) = match self.oriented_side(id, side) {
            Side::Front => (interior.clone(), interior.inserted(rank)),
            Side::Back if interior.0.contains(&rank) => (interior.clone(), interior.removed(rank)),
            Side::Back => (interior.inserted(rank), interior.clone()),
        };
        let is_hidden = incident.first() == transmitted.first();
        InterfaceMedia { incident, transmitted, is_hidden }
    }

    /// Returns the dielectrics that contain a point.
    ///
    /// Spheres and half-spaces are found by their equations; a mesh contains the point if a ray from
    /// there leaves it more often than it enters.
    pub fn interior_at(
        &self,
        point: DVec3,
        scene: &Scene,
        intersector: &dyn Intersector,
    ) -> InteriorList {
        let mut interior = InteriorList::default();
        for (sphere, &rank) in scene.spheres.iter().zip(&self.spheres) {
            if rank != NO_DIELECTRIC
                && (point - sphere.center).length_squared() < sphere.radius * sphere.radius
            {
                interior = interior.inserted(rank);
            }
        }
        for (plane, &rank) in scene.planes.iter().zip(&self.planes) {
            if rank != NO_DIELECTRIC && plane.normal.dot(point - plane.point) < 0.0 {
                interior = interior.inserted(rank);
            }
        }
        if self.instances.iter().all(|&rank| rank == NO_DIELECTRIC) {
            return interior;
        }
        // Along no axis, so that the ray seldom runs along a face; any direction would do.
        let mut ray = Ray::new(point, DVec3::new(0.537_7, 0.243_1, 0.807_4));
        let mut exits = vec![0i64; self.instances.len()];
        let mut hit = [None];
        loop {
            intersector.closest(&[ray], Coherence::Incoherent, &mut hit);
            let Some(hit) = &hit[0] else { break };
            let surface = Surface::new(scene, &ray, hit);
            if let Geometry::Mesh(_) = hit.id.geometry {
                exits[hit.id.instance as usize] += match self.oriented_side(hit.id, surface.side) {
                    Side::Front => -1,
                    Side::Back => 1,
                };
            }
            ray = ray.continue_past(hit, surface.side.opposite());
        }
        for (&rank, exits) in self.instances.iter().zip(exits) {
            for _ in 0..exits.max(0) {
                if rank != NO_DIELECTRIC {
                    interior = interior.inserted(rank);
                }
            }
        }
        interior
    }
}

/// The dielectrics on the two sides of a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterfaceMedia {
    /// The dielectrics on the side that the ray comes from.
    pub incident: InteriorList,
    /// The dielectrics on the other side.
    pub transmitted: InteriorList,
    /// True if the same dielectric fills both sides: the surface lies within one of higher priority, and
    /// light passes it as if nothing were there.
    pub is_hidden: bool,
}
