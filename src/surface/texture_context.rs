//! What only textures, checkers and colours of vertices ask of a surface.

use glam::{DVec3, Vec3};

use super::{Footprint, Surface};
use crate::geometry::{Geometry, Hit};
use crate::scene::{Mesh, Plane, Scene, TexturePoint};

/// What only textures, checkers and vertex colours ask of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureContext {
    /// Texture coordinates, v running down, and how they change across what is seen as one.
    pub point: TexturePoint,
    /// What the material's diffuse colour is multiplied with: a mesh's vertex colour, or white.
    pub tint: Vec3,
    /// What the material's alpha is multiplied with: that of a mesh's vertices, or 1.
    pub alpha: f32,
    /// The diffuse colour in place of the material's: a plane's checker.
    pub checker: Option<Vec3>,
}

impl Default for TextureContext {
    /// That of a surface without any.
    fn default() -> Self {
        Self { point: TexturePoint::default(), tint: Vec3::ONE, alpha: 1.0, checker: None }
    }
}

impl TextureContext {
    /// The detail of `hit` on `surface`; with texture coordinates if it is `textured`, and with
    /// their change over an area of the surface if that is known.
    ///
    /// # Panics
    /// When the hit is not one of this scene.
    pub fn new(
        scene: &Scene,
        hit: &Hit,
        [position, normal]: [DVec3; 2],
        textured: bool,
        area: Option<&Footprint>,
    ) -> Self {
        let mut detail = Self::default();
        match hit.id.geometry {
            Geometry::Spheres if textured => detail.point.uv = [longitude_latitude(normal); 2],
            Geometry::Spheres => {}
            Geometry::Planes => {
                let plane = &scene.planes[hit.id.primitive as usize];
                detail.of_plane(plane, position, textured);
            }
            Geometry::Mesh(mesh) => {
                let mesh = &scene.meshes[mesh as usize];
                detail.of_mesh(mesh, hit, textured);
            }
        }
        if let Some(area) = area.filter(|_| textured) {
            detail.point.across = area.in_texture(scene, hit, normal);
        }
        detail
    }

    /// The detail of `hit` on `surface` as [`TextureContext::new`] gives it, at a mere point.
    pub fn of(scene: &Scene, hit: &Hit, surface: &Surface, textured: bool) -> Self {
        Self::new(scene, hit, [surface.position, surface.geometric_normal], textured, None)
    }

    fn of_plane(&mut self, plane: &Plane, position: DVec3, textured: bool) {
        if !textured && plane.checker.is_none() {
            return;
        }
        let (a, b) = plane.axes();
        let from = position - plane.point;
        let (x, y) = (from.dot(a), from.dot(b));
        // The whole part is taken off in f64, so that the pattern stays sharp far out.
        if textured {
            let uv = [x, y].map(|x| {
                let repeats = x / plane.texture_size;
                (repeats - repeats.floor()) as f32
            });
            self.point.uv = [uv; 2];
        }
        self.checker = plane.checker.map(|checker| {
            let odd = |x: f64| {
                let half = (x / checker.size).floor() * 0.5;
                half != half.floor()
            };
            checker.colors[usize::from(odd(x) != odd(y))]
        });
    }

    fn of_mesh(&mut self, mesh: &Mesh, hit: &Hit, textured: bool) {
        let (triangle, weights) = (hit.id.primitive, [1.0 - hit.u - hit.v, hit.u, hit.v]);
        if textured {
            self.point.uv = mesh.uv(triangle, weights);
        }
        if !mesh.colors.is_empty() {
            self.tint = mesh.interpolate(&mesh.colors, triangle, weights).into();
        }
        self.alpha = mesh.alpha(triangle, weights);
    }
}

/// The texture coordinates of a sphere: u around the y axis, from −z through +x (the picture's
/// middle is +z), v from the pole +y down.
fn longitude_latitude(normal: DVec3) -> [f32; 2] {
    use std::f64::consts::{PI, TAU};
    let u = 0.5 + normal.x.atan2(normal.z) / TAU;
    let v = normal.y.clamp(-1.0, 1.0).acos() / PI;
    [u as f32, v as f32]
}
