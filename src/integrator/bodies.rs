//! Bodies that light goes through, and which of them a ray is in.

use glam::{DVec3, Vec3};

use crate::geometry::{Geometry, PrimitiveId, Ray, Side};
use crate::intersect::{Coherence, Intersector};
use crate::scene::{Instance, MaterialId, Scene};
use crate::surface::Surface;

/// What fills a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Its index of refraction.
    pub ior: f64,
    /// What it absorbs for each unit of length.
    pub absorption: Vec3,
}

/// Where there is no body.
const EMPTY_SPACE: Medium = Medium { ior: 1.0, absorption: Vec3::ZERO };

/// A place in the order of the bodies: where two overlap, the one with the lesser rank holds.
type PriorityRank = u32;

/// What has no rank: it is no body.
const NONE: PriorityRank = PriorityRank::MAX;

/// The bodies that hold a point, in their order; one stands twice where two parts of one mesh
/// overlap. The first fills the place.
#[derive(Clone, Debug)]
pub struct InteriorList(Ranks);

/// A few ranks in place, which is quick to copy, or many.
#[derive(Clone, Debug)]
enum Ranks {
    Few { len: u8, ranks: [PriorityRank; FEW] },
    Many(Vec<PriorityRank>),
}

/// So many bodies seldom fill one point.
const FEW: usize = 4;

impl Default for InteriorList {
    fn default() -> Self {
        Self(Ranks::Few { len: 0, ranks: [NONE; FEW] })
    }
}

impl PartialEq for InteriorList {
    fn eq(&self, other: &Self) -> bool {
        self.ranks() == other.ranks()
    }
}

impl Eq for InteriorList {}

impl InteriorList {
    /// The ranks, in order.
    #[inline]
    fn ranks(&self) -> &[PriorityRank] {
        match &self.0 {
            Ranks::Few { len, ranks } => &ranks[..usize::from(*len)],
            Ranks::Many(ranks) => ranks,
        }
    }

    #[inline]
    fn first(&self) -> Option<PriorityRank> {
        self.ranks().first().copied()
    }

    fn with(&self, rank: PriorityRank) -> Self {
        let at = self.ranks().partition_point(|&r| r <= rank);
        match &self.0 {
            &Ranks::Few { len, mut ranks } if usize::from(len) < FEW => {
                ranks.copy_within(at..usize::from(len), at + 1);
                ranks[at] = rank;
                Self(Ranks::Few { len: len + 1, ranks })
            }
            _ => {
                let mut all = self.ranks().to_vec();
                all.insert(at, rank);
                Self(Ranks::Many(all))
            }
        }
    }

    fn without(&self, rank: PriorityRank) -> Self {
        let Some(at) = self.ranks().iter().position(|&r| r == rank) else { return self.clone() };
        match &self.0 {
            &Ranks::Few { len, mut ranks } => {
                ranks.copy_within(at + 1..usize::from(len), at);
                Self(Ranks::Few { len: len - 1, ranks })
            }
            Ranks::Many(ranks) => {
                let mut all = ranks.clone();
                all.remove(at);
                Self(Ranks::Many(all))
            }
        }
    }
}

/// The bodies of a scene: spheres, half-spaces behind planes and closed meshes whose material
/// lets light through.
///
/// What fills a point depends on which bodies hold it, and not on how a ray came there: so a path
/// of light is the same both ways. Of several the one with the greatest priority fills it; of
/// equal ones the one with the smallest bounding box, so that a bubble is in its glass and the
/// glass in the water; then the first in the scene.
#[derive(Debug)]
pub struct NestedDielectrics {
    media: Vec<Medium>,
    spheres: Vec<PriorityRank>,
    planes: Vec<PriorityRank>,
    instances: Vec<PriorityRank>,
    /// Whether the fronts of a body's triangles are inside: it is mirrored, or was made so.
    turned: Vec<bool>,
}

impl NestedDielectrics {
    /// The bodies of a checked scene.
    pub fn of(scene: &Scene) -> Self {
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
        let all: Vec<(MaterialId, f64)> = spheres.chain(planes).chain(instances).collect();
        let mut order: Vec<usize> =
            (0..all.len()).filter(|&i| material(all[i].0).is_dielectric()).collect();
        order.sort_by(|&a, &b| {
            let ((a, size_of_a), (b, size_of_b)) = (all[a], all[b]);
            let priority = material(b).priority.cmp(&material(a).priority);
            priority.then(size_of_a.total_cmp(&size_of_b))
        });
        if order.is_empty() {
            let (media, spheres, planes, instances, turned) = Default::default();
            return Self { media, spheres, planes, instances, turned };
        }
        let mut ranks = vec![NONE; all.len()];
        let mut media = Vec::with_capacity(order.len());
        for (rank, i) in order.into_iter().enumerate() {
            ranks[i] = rank as PriorityRank;
            let of = material(all[i].0);
            media.push(Medium { ior: of.ior, absorption: of.absorption });
        }
        let instances = ranks.split_off(scene.spheres.len() + scene.planes.len());
        let planes = ranks.split_off(scene.spheres.len());
        let is_turned = |(&rank, instance): (&PriorityRank, &Instance)| {
            if rank == NONE {
                return false;
            }
            let inward = scene.meshes[instance.mesh.0 as usize].volume() < 0.0;
            inward != (instance.transform.matrix3.determinant() < 0.0)
        };
        let turned = instances.iter().zip(&scene.instances).map(is_turned).collect();
        Self { media, spheres: ranks, planes, instances, turned }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.media.is_empty()
    }

    /// Whether a medium may absorb, or a surface be hidden in a body: in another one, or in its own
    /// mesh where that runs through itself. A single sphere or plane hides nothing.
    pub fn may_hide(&self) -> bool {
        let absorbs = self.media.iter().any(|medium| medium.absorption != Vec3::ZERO);
        absorbs || self.media.len() > 1 || self.instances.iter().any(|&rank| rank != NONE)
    }

    /// What fills a point that these bodies hold.
    #[inline]
    pub fn medium(&self, inside: &InteriorList) -> Medium {
        inside.first().map_or(EMPTY_SPACE, |rank| self.media[rank as usize])
    }

    fn rank(&self, id: PrimitiveId) -> Option<PriorityRank> {
        let ranks = match id.geometry {
            Geometry::Spheres => self.spheres.get(id.primitive as usize),
            Geometry::Planes => self.planes.get(id.primitive as usize),
            Geometry::Mesh(_) => self.instances.get(id.instance as usize),
        };
        ranks.copied().filter(|&rank| rank != NONE)
    }

    /// The side of its body from which a surface is seen whose geometric normal says `side`:
    /// another one where the fronts of the triangles are inside.
    pub fn outer(&self, id: PrimitiveId, side: Side) -> Side {
        let is_mesh = matches!(id.geometry, Geometry::Mesh(_));
        if is_mesh && self.turned[id.instance as usize] { side.opposite() } else { side }
    }

    /// What lies before and behind a surface that is seen from its `side` by a ray in `inside`.
    ///
    /// A ray that comes out of a body that it never went into, through a hole in its mesh or from
    /// the very surface of another, was in it.
    pub fn around(&self, id: PrimitiveId, side: Side, inside: &InteriorList) -> InterfaceMedia {
        let Some(rank) = self.rank(id) else {
            return InterfaceMedia {
                before: inside.clone(),
                behind: inside.clone(),
                is_hidden: false,
            };
        };
        let (before, behind) = match self.outer(id, side) {
            Side::Front => (inside.clone(), inside.with(rank)),
            Side::Back if inside.ranks().contains(&rank) => (inside.clone(), inside.without(rank)),
            Side::Back => (inside.with(rank), inside.clone()),
        };
        let is_hidden = before.first() == behind.first();
        InterfaceMedia { before, behind, is_hidden }
    }

    /// The bodies that hold a point.
    ///
    /// Spheres and half-spaces are known by their equations; of meshes, those that a ray from the
    /// point comes out of more often than it goes in.
    pub fn holding(
        &self,
        point: DVec3,
        scene: &Scene,
        intersector: &dyn Intersector,
    ) -> InteriorList {
        let mut inside = InteriorList::default();
        for (sphere, &rank) in scene.spheres.iter().zip(&self.spheres) {
            if rank != NONE
                && (point - sphere.center).length_squared() < sphere.radius * sphere.radius
            {
                inside = inside.with(rank);
            }
        }
        for (plane, &rank) in scene.planes.iter().zip(&self.planes) {
            if rank != NONE && plane.normal.dot(point - plane.point) < 0.0 {
                inside = inside.with(rank);
            }
        }
        if self.instances.iter().all(|&rank| rank == NONE) {
            return inside;
        }
        let mut depth = vec![0i64; self.instances.len()];
        // Along no axis, so that it seldom runs along a face; any direction would do.
        let mut ray = Ray::new(point, DVec3::new(0.537_7, 0.243_1, 0.807_4));
        let mut hit = [None];
        loop {
            intersector.closest(&[ray], Coherence::Incoherent, &mut hit);
            let Some(hit) = &hit[0] else { break };
            let surface = Surface::new(scene, &ray, hit);
            if let Geometry::Mesh(_) = hit.id.geometry {
                depth[hit.id.instance as usize] += match self.outer(hit.id, surface.side) {
                    Side::Front => -1,
                    Side::Back => 1,
                };
            }
            ray = ray.continue_past(hit, surface.side.opposite());
        }
        for (&rank, depth) in self.instances.iter().zip(depth) {
            for _ in 0..depth.max(0) {
                if rank != NONE {
                    inside = inside.with(rank);
                }
            }
        }
        inside
    }
}

/// What lies on the two sides of a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterfaceMedia {
    /// The bodies on the side that the ray comes from.
    pub before: InteriorList,
    /// Those on the other side.
    pub behind: InteriorList,
    /// Whether the same body fills both, so that the surface is none: it lies within a body that
    /// goes before its own.
    pub is_hidden: bool,
}

#[cfg(test)]
mod tests;
