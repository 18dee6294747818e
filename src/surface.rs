//! What a hit means: position, normals, texture coordinates, material, side; and the rays that
//! leave it.

#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};

use crate::geometry::{Departure, Geometry, Hit, PrimitiveId, Ray, Side, triangle};
use crate::scene::{Arrival, MaterialId, Scene};

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
    /// Texture coordinates, v running down.
    pub uv: [f32; 2],
    /// What the material's diffuse colour is multiplied with: a mesh's vertex colour, or white.
    pub tint: Vec3,
    /// The diffuse colour in place of the material's: a plane's checker.
    pub checker: Option<Vec3>,
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
        if surface.geometric_normal.dot(ray.direction) > 0.0 {
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
    pub fn shadow_ray(&self, arrival: &Arrival) -> Ray {
        let front = self.geometric_normal.dot(arrival.toward) > 0.0;
        let side = if front { Side::Front } else { Side::Back };
        Ray {
            origin: self.position,
            direction: arrival.toward,
            tmax: if arrival.bounded { 1.0 } else { f64::INFINITY },
            from: Some(Departure { id: self.id, side }),
            past: None,
        }
    }
}

fn base(id: PrimitiveId, position: DVec3, normal: DVec3, material: MaterialId) -> Surface {
    Surface {
        position,
        geometric_normal: normal,
        normal,
        side: Side::Front,
        uv: [0.0; 2],
        tint: Vec3::ONE,
        checker: None,
        material,
        id,
    }
}

fn on_sphere(scene: &Scene, ray: &Ray, hit: &Hit) -> Surface {
    let sphere = &scene.spheres[hit.id.primitive as usize];
    let normal = (ray.at(hit.t) - sphere.center).normalize_or(DVec3::Y);
    // Put back on the sphere: the point along the ray is off by rounding of the whole distance.
    let position = sphere.center + normal * sphere.radius;
    let mut surface = base(hit.id, position, normal, sphere.material);
    if scene.materials[sphere.material.0 as usize].is_textured() {
        surface.uv = longitude_latitude(normal);
    }
    surface
}

/// The texture coordinates of a sphere: u around the y axis, from −z through +x (the picture's
/// middle is +z), v from the pole +y down.
fn longitude_latitude(normal: DVec3) -> [f32; 2] {
    use std::f64::consts::{PI, TAU};
    let u = 0.5 + normal.x.atan2(normal.z) / TAU;
    let v = normal.y.clamp(-1.0, 1.0).acos() / PI;
    [u as f32, v as f32]
}

fn on_plane(scene: &Scene, ray: &Ray, hit: &Hit) -> Surface {
    let plane = &scene.planes[hit.id.primitive as usize];
    let position = ray.at(hit.t);
    // Put back on the plane, as with the sphere.
    let position = position - plane.normal * plane.normal.dot(position - plane.point);
    let mut surface = base(hit.id, position, plane.normal, plane.material);
    let textured = scene.materials[plane.material.0 as usize].is_textured();
    if textured || plane.checker.is_some() {
        let (a, b) = plane.axes();
        let from = position - plane.point;
        let (x, y) = (from.dot(a), from.dot(b));
        // The whole part is taken off in f64, so that the pattern stays sharp far out.
        if textured {
            surface.uv = [x, y].map(|x| {
                let repeats = x / plane.texture_size;
                (repeats - repeats.floor()) as f32
            });
        }
        surface.checker = plane.checker.map(|checker| {
            let odd = |x: f64| {
                let half = (x / checker.size).floor() * 0.5;
                half != half.floor()
            };
            checker.colors[usize::from(odd(x) != odd(y))]
        });
    }
    surface
}

fn on_triangle(scene: &Scene, hit: &Hit) -> Surface {
    let instance = &scene.instances[hit.id.instance as usize];
    let mesh = &scene.meshes[instance.mesh.0 as usize];
    let corners = scene.triangle(hit.id);
    let area = triangle::area_normal(corners);
    // A degenerate triangle is never hit; the fallback only keeps the type honest.
    let geometric = area.normalize_or(DVec3::Y);
    let mut surface =
        base(hit.id, triangle::point(corners, hit.u, hit.v), geometric, instance.material);
    let vertices = mesh.triangles[hit.id.primitive as usize];
    let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
    if !mesh.normals.is_empty() {
        let local: DVec3 = vertices
            .iter()
            .zip(weights)
            .map(|(&i, w)| DVec3::from(mesh.normals[i as usize].map(f64::from)) * w)
            .sum();
        // Normals go with the inverse transpose; its columns are, up to the determinant, the
        // cross products of the matrix's columns.
        let m = &instance.transform.matrix3;
        let cofactor = glam::DMat3::from_cols(
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        );
        let smooth = (cofactor * local).normalize_or(geometric);
        // Files disagree about winding; the interpolated normal only bends the geometric one.
        surface.normal = if smooth.dot(geometric) < 0.0 { -smooth } else { smooth };
    }
    let mix = |of: &[[f32; 2]]| {
        let mut sum = [0.0f32; 2];
        for (&i, w) in vertices.iter().zip(weights) {
            sum = std::array::from_fn(|k| sum[k] + of[i as usize][k] * w as f32);
        }
        sum
    };
    let textured = scene.materials[instance.material.0 as usize].is_textured();
    if textured && !mesh.uvs.is_empty() {
        surface.uv = mix(&mesh.uvs);
    }
    if !mesh.colors.is_empty() {
        surface.tint = vertices
            .iter()
            .zip(weights)
            .map(|(&i, w)| Vec3::from(mesh.colors[i as usize]) * w as f32)
            .sum();
    }
    surface
}
