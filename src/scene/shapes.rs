//! The objects of a scene: spheres, planes and instances of meshes.

use glam::{DAffine3, DVec3, Vec3};

use crate::geometry::Bounds;
use crate::scene::{MaterialId, MeshId};

/// An analytic sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre, in world space.
    pub center: DVec3,
    /// The radius, above 0.
    pub radius: f64,
    /// The material.
    pub material: MaterialId,
    /// True if it casts a shadow.
    pub casts_shadow: bool,
}

impl Sphere {
    /// A sphere that casts a shadow.
    pub fn new(center: DVec3, radius: f64, material: MaterialId) -> Self {
        Self { center, radius, material, casts_shadow: true }
    }

    /// The bounding box.
    pub fn bounds(&self) -> Bounds {
        Bounds { lower: self.center - self.radius, upper: self.center + self.radius }
    }
}

/// An infinite plane, such as the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point of the plane, in world space.
    pub point: DVec3,
    /// The normal, of length 1.
    pub normal: DVec3,
    /// The material.
    pub material: MaterialId,
    /// A checkerboard in place of the material's diffuse colour.
    pub checker: Option<Checker>,
    /// The side of the square that a texture covers before it repeats, above 0, in world units.
    pub texture_size: f64,
    /// True if it casts a shadow.
    pub casts_shadow: bool,
}

impl Plane {
    /// A plane without checkerboard that casts a shadow; `normal` may have any length but zero.
    pub fn new(point: DVec3, normal: DVec3, material: MaterialId) -> Self {
        let normal = normal.normalize();
        Self { point, normal, material, checker: None, texture_size: 1.0, casts_shadow: true }
    }

    /// Two unit vectors that span the plane: the axes of its checkerboard and of its texture
    /// coordinates u and v. Seen from the front, u points right where v points down. On a wall u is
    /// horizontal and v points down, along −Y; on the ground, and on planes within 26° of it, u follows
    /// X (for normal ±Y, v is then ±Z).
    pub fn axes(&self) -> (DVec3, DVec3) {
        let across = if self.normal.y.abs() > 0.9 {
            DVec3::X - self.normal * self.normal.x
        } else {
            DVec3::Y.cross(self.normal)
        };
        let across = across.normalize();
        (across, across.cross(self.normal))
    }
}

/// A checkerboard on a plane, with a corner of its squares at the plane's point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checker {
    /// The two diffuse colours, linear Rec. 709.
    pub colors: [Vec3; 2],
    /// The side of a square, above 0, in world units.
    pub size: f64,
}

/// An instance: one placement of a mesh in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The mesh.
    pub mesh: MeshId,
    /// The transform from the mesh's space to world space; invertible.
    pub transform: DAffine3,
    /// The material.
    pub material: MaterialId,
    /// True if it casts a shadow.
    pub casts_shadow: bool,
}

impl Instance {
    /// An instance that casts a shadow.
    pub fn new(mesh: MeshId, transform: DAffine3, material: MaterialId) -> Self {
        Self { mesh, transform, material, casts_shadow: true }
    }

    /// True if its transform scales some direction to 0, and so cannot be inverted.
    pub fn is_flat(&self) -> bool {
        let determinant = self.transform.matrix3.determinant();
        determinant == 0.0 || !determinant.is_finite()
    }

    /// Transforms a vertex of the mesh to world space, in f64 and a fixed order of operations.
    #[inline(always)]
    pub fn to_world(&self, p: impl Into<DVec3>) -> DVec3 {
        self.transform.transform_point3(p.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn level_ground_has_axes_along_x_and_z() {
        let ground = Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0));
        assert_eq!(ground.axes(), (DVec3::X, DVec3::Z));
    }

    #[test]
    fn textures_on_a_wall_are_upright_seen_from_its_front() {
        let wall = |normal| Plane::new(DVec3::ZERO, normal, MaterialId(0)).axes();
        assert_eq!(wall(DVec3::Z), (DVec3::X, DVec3::NEG_Y));
        assert_eq!(wall(DVec3::NEG_X), (DVec3::Z, DVec3::NEG_Y));
    }

    #[test]
    fn plane_axes_are_orthonormal_for_any_normal() {
        for normal in [DVec3::ONE, DVec3::Z, DVec3::new(0.1, -5.0, 0.3), -DVec3::X] {
            let plane = Plane::new(DVec3::ZERO, normal, MaterialId(0));
            let (a, b) = plane.axes();
            let dots = [a.dot(b), a.dot(plane.normal), b.dot(plane.normal)];
            assert!(dots.iter().all(|d| d.abs() < 1e-15), "{normal}: {dots:?}");
        }
    }
}
