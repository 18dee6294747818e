//! Surfaces: hits worked out to positions, normals, sides and materials; and what textures say there.

mod footprint;
mod normal_map;
mod shading_params;
mod surface16;
#[cfg(test)]
mod tests;
mod texture_context;

use glam::{DMat3, DVec3};

use crate::geometry::{
    Departure, Geometry, Hit, PrimitiveId, Ray, ShadowEnds, Side, plane, triangle,
};
use crate::scene::{IncidentLight, MaterialId, Scene};
pub use footprint::{Footprint, RayCone, curvature};
pub use normal_map::{mapped_normal, perturbed_normal, tangent};
pub use shading_params::{PbrParams, ambient_occlusion, pbr_params, shading_params};
pub use surface16::Surface16;
pub use texture_context::TextureContext;

/// A point of a surface that a ray hit.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The position in world space, as near to the surface as f64 can say.
    pub position: DVec3,
    /// The geometric normal, of length 1, not turned to the viewer: outward for a sphere, by the
    /// right-hand rule for a triangle.
    pub geometric_normal: DVec3,
    /// The shading normal, of length 1: interpolated where the mesh has normals, and turned to the
    /// viewer except on a sphere that is lit on its outside only.
    pub normal: DVec3,
    /// The side that the viewer sees.
    pub side: Side,
    /// The material.
    pub material: MaterialId,
    /// The primitive.
    pub id: PrimitiveId,
}

impl Surface {
    /// Computes the surface at a hit of a ray.
    ///
    /// # Panics
    /// When the hit is not one of this scene.
    pub fn new(scene: &Scene, ray: &Ray, hit: &Hit) -> Self {
        let id = hit.id;
        let mut surface = match id.geometry {
            Geometry::Spheres => sphere_surface(scene, ray, hit),
            Geometry::Planes => plane_surface(scene, ray, hit),
            Geometry::Mesh(_) => triangle_surface(scene, hit),
        };
        // A continuation ray that went into a sphere leaves it: a ray that only touches it does both
        // at one point, where its direction tells nothing.
        let is_left = id.geometry == Geometry::Spheres
            && ray.continuation.is_some_and(|continuation| {
                continuation.crossed == Departure { id, side: Side::Back }
            });
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

    /// Returns the geometric normal, turned to the viewer.
    pub fn facing_normal(&self) -> DVec3 {
        match self.side {
            Side::Front => self.geometric_normal,
            Side::Back => -self.geometric_normal,
        }
    }

    /// Returns the shadow ray toward incident light; it leaves the surface, which a ray along `incoming`
    /// hit, on the light's side.
    pub fn shadow_ray(&self, incoming: DVec3, incident: &IncidentLight) -> Ray {
        let is_in_front = self.geometric_normal.dot(incident.toward) > 0.0;
        let side = if is_in_front { Side::Front } else { Side::Back };
        Ray {
            origin: self.position,
            direction: incident.toward,
            tmax: if incident.is_bounded { 1.0 } else { f64::INFINITY },
            departure: Some(Departure { id: self.id, side }),
            continuation: None,
            shadow: Some(ShadowEnds { viewer: -incoming }),
        }
    }
}

/// Returns a surface that is seen from its front, and has no other shading normal.
fn flat_surface(id: PrimitiveId, position: DVec3, normal: DVec3, material: MaterialId) -> Surface {
    Surface { position, geometric_normal: normal, normal, side: Side::Front, material, id }
}

fn sphere_surface(scene: &Scene, ray: &Ray, hit: &Hit) -> Surface {
    let sphere = &scene.spheres[hit.id.primitive as usize];
    let normal = sphere_normal(sphere.center, ray.position(hit.t));
    // Put back on the sphere: the point along the ray is off by rounding of the whole distance.
    let position = sphere.center + normal * sphere.radius;
    flat_surface(hit.id, position, normal, sphere.material)
}

/// Returns the outward normal of a sphere near `point`.
#[inline(always)]
fn sphere_normal(center: DVec3, point: DVec3) -> DVec3 {
    (point - center).normalize_or(DVec3::Y)
}

fn plane_surface(scene: &Scene, ray: &Ray, hit: &Hit) -> Surface {
    let plane = &scene.planes[hit.id.primitive as usize];
    let position = project_to_plane(plane.point, plane.normal, ray.position(hit.t));
    flat_surface(hit.id, position, plane.normal, plane.material)
}

/// Returns a position put back on a plane, as with the sphere.
#[inline(always)]
fn project_to_plane(point: DVec3, normal: DVec3, position: DVec3) -> DVec3 {
    position - normal * plane::height(point, normal, position)
}

fn triangle_surface(scene: &Scene, hit: &Hit) -> Surface {
    let material = scene.instances[hit.id.instance as usize].material;
    let (position, geometric) = triangle_point(scene.triangle_vertices(hit.id), hit.u, hit.v);
    let normal = smooth_normal(scene, hit, geometric).unwrap_or(geometric);
    Surface { normal, ..flat_surface(hit.id, position, geometric, material) }
}

/// Returns a point of a triangle, and the triangle's normal.
#[inline(always)]
fn triangle_point(corners: [DVec3; 3], u: f64, v: f64) -> (DVec3, DVec3) {
    // A degenerate triangle is never hit; the fallback only keeps the type honest.
    let normal = triangle::area_normal(corners).normalize_or(DVec3::Y);
    (triangle::point(corners, u, v), normal)
}

/// Returns the interpolated normal of a triangle with this geometric normal, if its mesh has normals.
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

/// Returns the spread of the normals of a triangle, which has some: the tangents of their angles to its
/// face at the vertices, interpolated.
///
/// Angles from 20° on count less and less, and from 45° on not at all: there a mesh does not approximate
/// something round, but has its edges smoothed.
#[inline]
fn normal_spread(scene: &Scene, hit: &Hit, face: DVec3) -> f64 {
    const FULL: f64 = 0.939_692_620_785_908_4; // cos 20°
    const NONE: f64 = std::f64::consts::FRAC_1_SQRT_2; // cos 45°
    let instance = &scene.instances[hit.id.instance as usize];
    let mesh = &scene.meshes[instance.mesh.0 as usize];
    // With the matrix C of normals, (C n)·face is n·(Cᵀ face); lengths are those of a rigid transform.
    let local = (cofactor(&instance.transform.matrix3).transpose() * face).normalize_or(face);
    let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
    let spread_at = |vertex: u32| {
        let normal = DVec3::from(mesh.normals[vertex as usize].map(f64::from));
        let cosine = normal.dot(local).abs().clamp(NONE, 1.0);
        let share = ((cosine - NONE) / (FULL - NONE)).min(1.0);
        share * (1.0 - cosine * cosine).sqrt() / cosine
    };
    let vertices = mesh.triangles[hit.id.primitive as usize];
    vertices.iter().zip(weights).map(|(&vertex, weight)| spread_at(vertex) * weight).sum()
}

/// Returns the matrix that transforms normals: the inverse transpose, whose columns are, up to the
/// determinant, the cross products of the matrix's columns.
#[inline]
fn cofactor(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}
