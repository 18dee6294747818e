//! Ray cones and their footprints: the areas of surfaces over which textures are averaged.

use glam::{DVec3, Vec2};

use super::Surface;
use crate::geometry::{Geometry, Hit, Side};
use crate::scene::Scene;

/// The cone around a ray that covers what a pixel's sample sees (J. Amanatides, *Ray Tracing
/// with Cones*, SIGGRAPH 1984; T. Akenine-Möller et al., *Texture Level of Detail Strategies for
/// Real-Time Ray Tracing*, Ray Tracing Gems, 2019, chapter 20).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayCone {
    /// The width where the ray starts, in world units.
    pub width: f32,
    /// The widening for each unit of length; below 0 for a cone that narrows.
    pub spread: f32,
}

impl RayCone {
    /// Returns the width after a length.
    #[inline]
    pub fn width_at(&self, length: f64) -> f32 {
        (self.width + self.spread * length as f32).abs()
    }

    /// Returns the cone that goes on after a `length` from a surface of this curvature: a mirror
    /// widens it by twice the angle between the normals at its ends.
    pub fn spawn(&self, length: f64, curvature: f64) -> Self {
        let width = self.width + self.spread * length as f32;
        Self { width, spread: self.spread + 2.0 * (curvature as f32) * width }
    }
}

/// The ellipse in which a ray cone cuts a surface: the vectors along its greatest and its least extent,
/// from end to end, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint([DVec3; 2]);

impl Footprint {
    /// Computes the ellipse in which a cone of a `width` around `direction`, of length 1, cuts a
    /// surface of this normal (T. Akenine-Möller et al., *Improved Shader and Texture Level of Detail Using Ray Cones*, JCGT
    /// 2021, listing 1): the greater extent runs as the ray does, and is longer by the cosine.
    pub fn new(direction: DVec3, normal: DVec3, width: f32) -> Self {
        let cosine = direction.dot(normal);
        let along = (direction - normal * cosine).normalize_or(normal.any_orthonormal_vector());
        let width = f64::from(width);
        // A ray as good as along the surface has an ellipse long enough for any texture.
        let major = along * (width / cosine.abs().max(1e-6));
        Self([major, along.cross(normal) * width])
    }

    /// Returns the change of the texture coordinates of both sets across it, at a hit where the
    /// geometric normal is `normal`.
    pub(super) fn uv_change(&self, scene: &Scene, hit: &Hit, normal: DVec3) -> [[Vec2; 2]; 2] {
        let change = |gradients: [DVec3; 2]| {
            self.0.map(|x| Vec2::new(gradients[0].dot(x) as f32, gradients[1].dot(x) as f32))
        };
        match hit.id.geometry {
            Geometry::Spheres => {
                let radius = scene.spheres[hit.id.primitive as usize].radius;
                [change(sphere_uv_gradients(normal, radius)); 2]
            }
            Geometry::Planes => {
                let plane = &scene.planes[hit.id.primitive as usize];
                let (a, b) = plane.axes();
                [change([a / plane.texture_size, b / plane.texture_size]); 2]
            }
            Geometry::Mesh(mesh) => {
                let mesh = &scene.meshes[mesh as usize];
                let Some(weights) = weight_gradients(scene.triangle_vertices(hit.id)) else {
                    return [[Vec2::ZERO; 2]; 2];
                };
                let corners = mesh.triangles[hit.id.primitive as usize];
                [&mesh.uvs, &mesh.second_uvs].map(|uvs| {
                    if uvs.is_empty() {
                        return [Vec2::ZERO; 2];
                    }
                    let [a, b, c] = corners.map(|i| uvs[i as usize].map(f64::from));
                    let gradient =
                        |k: usize| weights[0] * (b[k] - a[k]) + weights[1] * (c[k] - a[k]);
                    change([gradient(0), gradient(1)])
                })
            }
        }
    }
}

/// Returns the gradients of the texture coordinates on a sphere.
fn sphere_uv_gradients(normal: DVec3, radius: f64) -> [DVec3; 2] {
    use std::f64::consts::{PI, TAU};
    // At the poles u is undefined; its change is limited to once around.
    let across = normal.x.hypot(normal.z).max(1e-6);
    let east = DVec3::new(normal.z, 0.0, -normal.x) / across;
    let south = east.cross(normal);
    [east / (TAU * radius * across), south / (PI * radius)]
}

/// Returns the gradients, on a triangle, of the weights of its second and third vertex; `None` if it
/// is degenerate.
pub(super) fn weight_gradients(corners: [DVec3; 3]) -> Option<[DVec3; 2]> {
    let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
    let (a, b, c) = (e1.dot(e1), e1.dot(e2), e2.dot(e2));
    let determinant = a * c - b * b;
    (determinant > 0.0).then(|| [(e1 * c - e2 * b) / determinant, (e2 * a - e1 * b) / determinant])
}

/// Returns the curvature of a surface, the turn of the shading normal for each unit of length: 0 where
/// it is flat, 1/r on a sphere, and on a smooth mesh the mean over the edges of the triangle of
/// (n₁ − n₀)·(p₁ − p₀) / |p₁ − p₀|². It is above 0 where the surface is convex on the side that it is
/// seen from.
pub fn curvature(scene: &Scene, surface: &Surface) -> f64 {
    let curvature = match surface.id.geometry {
        Geometry::Planes => return 0.0,
        Geometry::Spheres => 1.0 / scene.spheres[surface.id.primitive as usize].radius,
        Geometry::Mesh(mesh) => {
            let mesh = &scene.meshes[mesh as usize];
            if mesh.normals.is_empty() {
                return 0.0;
            }
            let corners = scene.triangle_vertices(surface.id);
            let m = &scene.instances[surface.id.instance as usize].transform.matrix3;
            let cofactor = super::cofactor(m);
            let normals = mesh.triangles[surface.id.primitive as usize].map(|i| {
                let normal = DVec3::from(mesh.normals[i as usize].map(f64::from));
                let normal = (cofactor * normal).normalize_or_zero();
                normal * normal.dot(surface.geometric_normal).signum()
            });
            let along = |i: usize, j: usize| {
                let edge = corners[j] - corners[i];
                (normals[j] - normals[i]).dot(edge) / edge.length_squared()
            };
            let mean = (along(0, 1) + along(1, 2) + along(2, 0)) / 3.0;
            if mean.is_finite() { mean } else { 0.0 }
        }
    };
    match surface.side {
        Side::Front => curvature,
        Side::Back => -curvature,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_widens_with_its_length() {
        let cone = RayCone { width: 0.5, spread: 0.25 };
        assert_eq!(cone.width_at(2.0), 1.0);
        assert_eq!(cone.spawn(2.0, 0.0), RayCone { width: 1.0, spread: 0.25 });
    }

    #[test]
    fn a_convex_mirror_widens_a_cone_by_twice_the_turn_of_its_normal() {
        let cone = RayCone { width: 0.1, spread: 0.0 };
        // On a sphere of radius 2, 0.1 is 0.05 of a radian.
        assert!((cone.spawn(1.0, 0.5).spread - 0.1).abs() < 1e-7);
    }

    #[test]
    fn a_footprint_is_longer_the_flatter_the_ray() {
        let direction = DVec3::new(3f64.sqrt() / 2.0, -0.5, 0.0);
        let Footprint([along, across]) = Footprint::new(direction, DVec3::Y, 0.25);
        assert!((along - DVec3::X * 0.5).length() < 1e-12, "{along}");
        assert!((across.length() - 0.25).abs() < 1e-12 && across.dot(along).abs() < 1e-12);
    }

    #[test]
    fn weights_change_by_their_gradients() {
        let corners = [DVec3::X, DVec3::new(3.0, 1.0, 0.0), DVec3::new(0.0, 2.0, 2.0)];
        let [v, w] = weight_gradients(corners).unwrap();
        for (corner, expected) in [(1, [1.0, 0.0]), (2, [0.0, 1.0])] {
            let edge = corners[corner] - corners[0];
            assert!((v.dot(edge) - expected[0]).abs() < 1e-12);
            assert!((w.dot(edge) - expected[1]).abs() < 1e-12);
        }
    }

    #[test]
    fn texture_coordinates_on_a_sphere_change_by_their_gradients() {
        let at = |p: DVec3| {
            let n = p.normalize();
            use std::f64::consts::{PI, TAU};
            [0.5 + n.x.atan2(n.z) / TAU, n.y.acos() / PI]
        };
        let normal = DVec3::new(0.4, 0.3, 0.7).normalize();
        let (radius, step) = (3.0, 1e-6);
        let gradients = sphere_uv_gradients(normal, radius);
        for along in
            [normal.any_orthonormal_vector(), normal.cross(normal.any_orthonormal_vector())]
        {
            let (before, after) = (at(normal * radius), at(normal * radius + along * step));
            for k in 0..2 {
                let slope = (after[k] - before[k]) / step;
                assert!((gradients[k].dot(along) - slope).abs() < 1e-6, "{k}: {slope}");
            }
        }
    }
}
