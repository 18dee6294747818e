//! The hit of a ray, and the ids of primitives.

/// The geometry that a primitive belongs to.
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

/// The id of one primitive: a sphere, a plane, or a triangle of an instance.
///
/// Ordered by geometry, then primitive, then instance: the order that decides between hits at
/// the same distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimitiveId {
    /// The geometry that it belongs to.
    pub geometry: Geometry,
    /// Its index in that geometry.
    pub primitive: u32,
    /// The index in `Scene::instances` for triangles; 0 for spheres and planes.
    pub instance: u32,
}

impl PrimitiveId {
    /// The id of the sphere with index `primitive`.
    pub const fn sphere(primitive: u32) -> Self {
        Self { geometry: Geometry::Spheres, primitive, instance: 0 }
    }

    /// The id of the plane with index `primitive`.
    pub const fn plane(primitive: u32) -> Self {
        Self { geometry: Geometry::Planes, primitive, instance: 0 }
    }

    /// The id of triangle `primitive` of mesh `mesh` in instance `instance`.
    pub const fn triangle(mesh: u32, primitive: u32, instance: u32) -> Self {
        Self { geometry: Geometry::Mesh(mesh), primitive, instance }
    }
}

/// The intersection of a ray with a primitive, without anything that can be derived from it later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The distance in units of the ray's |direction|, above 0.
    pub t: f64,
    /// The barycentric weight of a triangle's second vertex, in \[0, 1\]; 0 for spheres and planes.
    pub u: f64,
    /// The barycentric weight of a triangle's third vertex, in \[0, 1\]; 0 for spheres and planes.
    pub v: f64,
    /// The primitive that was hit.
    pub id: PrimitiveId,
}

#[cfg(test)]
mod tests {
    use super::*;

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
            assert!(pair[0] < pair[1], "{pair:?}");
        }
    }

    #[test]
    fn optional_hit_costs_no_more_than_a_hit() {
        assert_eq!(size_of::<Option<Hit>>(), size_of::<Hit>());
    }
}
