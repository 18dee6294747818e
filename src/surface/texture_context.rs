//! The context of a texture lookup: texture coordinates, vertex colours and checkers at a point.

use glam::{DVec3, Vec3};

use super::{Footprint, Surface};
use crate::geometry::{Geometry, Hit};
use crate::scene::{Mesh, Plane, Scene, TexturePoint};

/// The values at a point that textures, checkers and vertex colours depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureContext {
    /// The texture coordinates, v running down, and their change across the footprint.
    pub point: TexturePoint,
    /// The factor of the material's diffuse colour: a mesh's vertex colour, or white.
    pub vertex_color: Vec3,
    /// The factor of the material's alpha: a mesh's vertex alpha, or 1.
    pub alpha: f32,
    /// The colour of a plane's checker, which replaces the material's diffuse colour.
    pub checker: Option<Vec3>,
}

impl Default for TextureContext {
    /// Returns the context of a surface without texture coordinates, vertex colours and checker.
    fn default() -> Self {
        Self { point: TexturePoint::default(), vertex_color: Vec3::ONE, alpha: 1.0, checker: None }
    }
}

impl TextureContext {
    /// Computes the context of `hit` on `surface`: with texture coordinates if it `is_textured`, and
    /// with their change across a footprint, if there is one.
    ///
    /// # Panics
    /// When the hit is not one of this scene.
    pub fn new(
        scene: &Scene,
        hit: &Hit,
        surface: &Surface,
        is_textured: bool,
        footprint: Option<&Footprint>,
    ) -> Self {
        let mut context = Self::default();
        let normal = surface.geometric_normal;
        match hit.id.geometry {
            Geometry::Spheres => {
                if is_textured {
                    context.point.uv = [sphere_uv(normal); 2];
                }
            }
            Geometry::Planes => {
                let plane = &scene.planes[hit.id.primitive as usize];
                context.set_plane(plane, surface.position, is_textured);
            }
            Geometry::Mesh(mesh) => {
                context.set_triangle(&scene.meshes[mesh as usize], hit, is_textured);
            }
        }
        if let Some(footprint) = footprint.filter(|_| is_textured) {
            context.point.across = footprint.uv_change(scene, hit, normal);
        }
        context
    }

    /// Sets the values at a position on a plane.
    fn set_plane(&mut self, plane: &Plane, position: DVec3, is_textured: bool) {
        if !is_textured && plane.checker.is_none() {
            return;
        }
        let (a, b) = plane.axes();
        let offset = position - plane.point;
        let (x, y) = (offset.dot(a), offset.dot(b));
        // The integer part is taken off in f64, so that the pattern stays sharp far out.
        if is_textured {
            let uv = [x, y].map(|x| {
                let repeats = x / plane.texture_size;
                (repeats - repeats.floor()) as f32
            });
            self.point.uv = [uv; 2];
        }
        self.checker = plane.checker.map(|checker| {
            let is_odd = |x: f64| {
                let half = (x / checker.size).floor() * 0.5;
                half != half.floor()
            };
            checker.colors[usize::from(is_odd(x) != is_odd(y))]
        });
    }

    /// Sets the values at a hit on a mesh.
    fn set_triangle(&mut self, mesh: &Mesh, hit: &Hit, is_textured: bool) {
        let (triangle, weights) = (hit.id.primitive, [1.0 - hit.u - hit.v, hit.u, hit.v]);
        if is_textured {
            self.point.uv = mesh.uv(triangle, weights);
        }
        if !mesh.colors.is_empty() {
            self.vertex_color = mesh.interpolate(&mesh.colors, triangle, weights).into();
        }
        self.alpha = mesh.alpha(triangle, weights);
    }
}

/// Returns the texture coordinates on a sphere, longitude and latitude: u around the y axis, from −z
/// through +x (the texture's middle is +z), v from the pole +y down.
fn sphere_uv(normal: DVec3) -> [f32; 2] {
    use std::f64::consts::{PI, TAU};
    let u = 0.5 + normal.x.atan2(normal.z) / TAU;
    let v = normal.y.clamp(-1.0, 1.0).acos() / PI;
    [u as f32, v as f32]
}
