//! What a hit means: position, normals, texture coordinates, material, side; and the rays that
//! leave it.

mod footprint;
mod normal_map;
mod shading_params;
mod surface16;
#[cfg(test)]
mod tests;
mod texture_context;

use glam::{DMat3, DVec3};

use crate::geometry::{Departure, Geometry, Hit, PrimitiveId, Ray, Side, triangle};
use crate::scene::{IncidentLight, MaterialId, Scene};
pub use footprint::{Footprint, RayCone, curvature};
pub use normal_map::mapped_normal;
pub use shading_params::{occlusion, shading_params};
pub use surface16::{GeometryKinds, Surface16};
pub use texture_context::TextureContext;

/// The point of a surface that a ray hit.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The point, in world space, as near to the surface as f64 can say.
    pub position: DVec3,
    /// The surface's own normal, of length 1, whoever looks: outward for a sphere, by the
    /// right-hand rule for a triangle.
    pub geometric_normal: DVec3,
    /// The normal to shade with, of length 1: interpolated where the mesh has normals, and turned
    /// to the viewer except on a sphere that is lit on its outside only.
    pub normal: DVec3,
    /// The side that the viewer sees.
    pub side: Side,
    /// What it is made of.
    pub material: MaterialId,
    /// What was hit.
    pub id: PrimitiveId,
}

impl Surface {
    /// Works out what `hit`, which `ray` made in `scene`, means.
    ///
    /// # Panics
    /// When the hit is not one of this scene.
    pub fn new(scene: &Scene, ray: &Ray, hit: &Hit) -> Self {
        let id = hit.id;
        let mut surface = match id.geometry {
            Geometry::Spheres => on_sphere(scene, ray, hit),
            Geometry::Planes => on_plane(scene, ray, hit),
            Geometry::Mesh(_) => on_triangle(scene, hit),
        };
        // A sphere that was gone into is left, though a ray that only touches it does both at one
        // point, where its direction tells nothing.
        let is_left = id.geometry == Geometry::Spheres
            && ray
                .continuation
                .is_some_and(|past| past.crossed == Departure { id, side: Side::Back });
        if is_left || surface.geometric_normal.dot(ray.direction) > 0.0 {
            surface.side = Side::Back;
            let outside_only = id.geometry == Geometry::Spheres
                && !scene.materials[surface.material.0 as usize].double_sided;
            if !outside_only {
                surface.normal = -surface.normal;
            }
        }
        surface
    }

    /// The geometric normal, turned to the viewer.
    pub fn facing_normal(&self) -> DVec3 {
        match self.side {
            Side::Front => self.geometric_normal,
            Side::Back => -self.geometric_normal,
        }
    }

    /// The ray that asks whether the light of `arrival` is in sight; it leaves the surface on the
    /// light's side.
    pub fn shadow_ray(&self, arrival: &IncidentLight) -> Ray {
        let front = self.geometric_normal.dot(arrival.toward) > 0.0;
        let side = if front { Side::Front } else { Side::Back };
        Ray {
            origin: self.position,
            direction: arrival.toward,
            tmax: if arrival.is_bounded { 1.0 } else { f64::INFINITY },
            departure: Some(Departure { id: self.id, side }),
            continuation: None,
        }
    }
}

fn base(id: PrimitiveId, position: DVec3, normal: DVec3, material: MaterialId) -> Surface {
    Surface { position, geometric_normal: normal, normal, side: Side::Front, material, id }
}

fn on_sphere(scene: &Scene, ray: &Ray, hit: &Hit) -> Surface {
    let sphere = &scene.spheres[hit.id.primitive as usize];
    let normal = normal_of_sphere(sphere.center, ray.position(hit.t));
    // Put back on the sphere: the point along the ray is off by rounding of the whole distance.
    let position = sphere.center + normal * sphere.radius;
    base(hit.id, position, normal, sphere.material)
}

/// The outward normal of a sphere near `point`.
#[inline(always)]
fn normal_of_sphere(center: DVec3, point: DVec3) -> DVec3 {
    (point - center).normalize_or(DVec3::Y)
}

fn on_plane(scene: &Scene, ray: &Ray, hit: &Hit) -> Surface {
    let plane = &scene.planes[hit.id.primitive as usize];
    let position = on_the_plane(plane.point, plane.normal, ray.position(hit.t));
    base(hit.id, position, plane.normal, plane.material)
}

/// A point put back on a plane, as with the sphere.
#[inline(always)]
fn on_the_plane(point: DVec3, normal: DVec3, position: DVec3) -> DVec3 {
    position - normal * normal.dot(position - point)
}

fn on_triangle(scene: &Scene, hit: &Hit) -> Surface {
    let material = scene.instances[hit.id.instance as usize].material;
    let (position, geometric) = flat_face(scene.triangle_vertices(hit.id), hit.u, hit.v);
    let normal = smooth_normal(scene, hit, geometric).unwrap_or(geometric);
    Surface { normal, ..base(hit.id, position, geometric, material) }
}

/// A point of a triangle, and the triangle's normal.
#[inline(always)]
fn flat_face(corners: [DVec3; 3], u: f64, v: f64) -> (DVec3, DVec3) {
    // A degenerate triangle is never hit; the fallback only keeps the type honest.
    let normal = triangle::area_normal(corners).normalize_or(DVec3::Y);
    (triangle::point(corners, u, v), normal)
}

/// The interpolated normal of a triangle whose own one is `geometric`, if its mesh has normals.
#[inline]
fn smooth_normal(scene: &Scene, hit: &Hit, geometric: DVec3) -> Option<DVec3> {
    let instance = &scene.instances[hit.id.instance as usize];
    let mesh = &scene.meshes[instance.mesh.0 as usize];
    if mesh.normals.is_empty() {
        return None;
    }
    let vertices = mesh.triangles[hit.id.primitive as usize];
    let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
    let local: DVec3 = vertices
        .iter()
        .zip(weights)
        .map(|(&i, w)| DVec3::from(mesh.normals[i as usize].map(f64::from)) * w)
        .sum();
    let smooth = (cofactor(&instance.transform.matrix3) * local).normalize_or(geometric);
    // Files disagree about winding; the interpolated normal only bends the geometric one.
    Some(if smooth.dot(geometric) < 0.0 { -smooth } else { smooth })
}

/// What normals go with: the inverse transpose, whose columns are, up to the determinant, the cross
/// products of the matrix's columns.
#[inline]
fn cofactor(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}
