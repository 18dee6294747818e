//! What a ray met.

/// The set that a primitive belongs to.
///
/// The order of the variants is part of the tie rule: of two hits at the same `t` the one with
/// the lesser ([`Geometry`], primitive, instance) counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Geometry {
    /// The scene's analytic spheres; a primitive is an index into `Scene::spheres`.
    Spheres,
    /// The scene's infinite planes; a primitive is an index into `Scene::planes`.
    Planes,
    /// A triangle mesh, by its index in `Scene::meshes`; a primitive is one of its triangles.
    Mesh(u32),
}

/// One sphere, plane, or triangle of an instance.
///
/// Ordered by geometry, then primitive, then instance: the order that decides between hits at
/// the same distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimitiveId {
    /// The set it belongs to.
    pub geometry: Geometry,
    /// Its index in that set.
    pub primitive: u32,
    /// The index in `Scene::instances` for triangles; 0 for spheres and planes.
    pub instance: u32,
}

impl PrimitiveId {
    /// The sphere with index `primitive`.
    pub const fn sphere(primitive: u32) -> Self {
        Self { geometry: Geometry::Spheres, primitive, instance: 0 }
    }

    /// The plane with index `primitive`.
    pub const fn plane(primitive: u32) -> Self {
        Self { geometry: Geometry::Planes, primitive, instance: 0 }
    }

    /// Triangle `primitive` of mesh `mesh`, as it stands in `instance`.
    pub const fn triangle(mesh: u32, primitive: u32, instance: u32) -> Self {
        Self { geometry: Geometry::Mesh(mesh), primitive, instance }
    }
}

/// The closest intersection of a ray, and nothing that can be worked out from it later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's |direction|, above 0.
    pub t: f64,
    /// Barycentric weight of a triangle's second vertex, in \[0, 1\]; 0 for spheres and planes.
    pub u: f64,
    /// Barycentric weight of a triangle's third vertex, in \[0, 1\]; 0 for spheres and planes.
    pub v: f64,
    /// What was hit.
    pub id: PrimitiveId,
}

impl Hit {
    /// Whether this hit counts rather than `other`: the least (t, geometry, primitive, instance).
    #[inline]
    pub fn is_before(&self, other: &Hit) -> bool {
        self.t < other.t || (self.t == other.t && self.id < other.id)
    }

    /// Keeps in `best` whichever of the two counts.
    #[inline]
    pub fn keep_closest(best: &mut Option<Hit>, candidate: Hit) {
        if best.is_none_or(|b| candidate.is_before(&b)) {
            *best = Some(candidate);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(t: f64, id: PrimitiveId) -> Hit {
        Hit { t, u: 0.0, v: 0.0, id }
    }

    #[test]
    fn nearer_hit_counts() {
        let near = hit(1.0, PrimitiveId::triangle(9, 9, 9));
        assert!(near.is_before(&hit(2.0, PrimitiveId::sphere(0))));
    }

    #[test]
    fn tie_is_decided_by_geometry_then_primitive_then_instance() {
        let order = [
            PrimitiveId::sphere(7),
            PrimitiveId::plane(0),
            PrimitiveId::triangle(0, 1, 5),
            PrimitiveId::triangle(0, 2, 0),
            PrimitiveId::triangle(0, 2, 1),
            PrimitiveId::triangle(1, 0, 0),
        ];
        for pair in order.windows(2) {
            assert!(hit(1.0, pair[0]).is_before(&hit(1.0, pair[1])), "{pair:?}");
        }
    }

    #[test]
    fn optional_hit_costs_no_more_than_a_hit() {
        assert_eq!(size_of::<Option<Hit>>(), size_of::<Hit>());
    }
}
