//! Normals from a picture.

use glam::{DVec3, Vec2, Vec3};

use super::footprint::change_of_weights;
use super::{Surface, cofactor};
use crate::geometry::{Geometry, Hit};
use crate::scene::{Scene, Texture, TexturePoint};

/// The normal to shade with where the normal map of its material, if it has one, bends that of
/// `surface`, which `hit` made.
///
/// It stays the surface's own where the map says so, to the bit, and where nothing says how the
/// picture lies.
pub fn mapped_normal(scene: &Scene, surface: &Surface, hit: &Hit, point: &TexturePoint) -> DVec3 {
    let Some(map) = &scene.materials[surface.material.0 as usize].normal_map else {
        return surface.normal;
    };
    let texture = &scene.textures[map.texture.0 as usize];
    let color = texture.sample(point).truncate();
    let [x, y, z] = unpacked(color, map.scale).to_array().map(f64::from);
    if x == 0.0 && y == 0.0 {
        return surface.normal;
    }
    let Some(Frame { tangent, bitangent, normal }) = Frame::of(scene, surface, hit, texture) else {
        return surface.normal;
    };
    let mapped = (tangent * x + bitangent * y + normal * z).normalize_or(surface.normal);
    // Turned to the viewer as the surface's own is.
    if normal.dot(surface.normal) < 0.0 { -mapped } else { mapped }
}

/// The vector in tangent space that a colour means. Of 8 bits neither 127 nor 128 is exactly 0; who
/// paints a flat surface writes either.
fn unpacked(color: Vec3, scale: f32) -> Vec3 {
    let v = color * 2.0 - 1.0;
    const FLAT: f32 = 1.01 / 255.0;
    let flat = |x: f32| if x.abs() < FLAT { 0.0 } else { x * scale };
    Vec3::new(flat(v.x), flat(v.y), v.z)
}

/// How the picture of a normal map lies on a surface: unit vectors, of which the normal is that of
/// the surface as modelled, whoever looks.
struct Frame {
    tangent: DVec3,
    bitangent: DVec3,
    normal: DVec3,
}

impl Frame {
    fn of(scene: &Scene, surface: &Surface, hit: &Hit, texture: &Texture) -> Option<Self> {
        let normal = surface.geometric_normal;
        let upright = |tangent: DVec3| {
            let tangent = tangent.try_normalize()?;
            let placed = texture.transform.matrix2;
            let own = Self { tangent, bitangent: normal.cross(tangent), normal };
            own.turned(placed.x_axis, placed.y_axis)
        };
        match hit.id.geometry {
            Geometry::Spheres => upright(DVec3::new(normal.z, 0.0, -normal.x)),
            Geometry::Planes => upright(scene.planes[hit.id.primitive as usize].axes().0),
            Geometry::Mesh(_) => Self::on_mesh(scene, surface, hit, texture),
        }
    }

    /// The frame of a picture whose coordinates are a linear map of this frame's own, with these
    /// columns; v runs down, and the bitangent up.
    fn turned(self, x: Vec2, y: Vec2) -> Option<Self> {
        let [a, c, b, d] = [x.x, x.y, y.x, y.y].map(f64::from);
        let determinant = a * d - b * c;
        // The directions in which the picture's own u and v grow: the columns of the inverse.
        let u = (self.tangent * d + self.bitangent * c) * determinant.signum();
        let up = (self.tangent * b + self.bitangent * a) * determinant.signum();
        (determinant != 0.0).then(|| {
            Some(Self { tangent: u.try_normalize()?, bitangent: up.try_normalize()?, ..self })
        })?
    }

    fn on_mesh(scene: &Scene, surface: &Surface, hit: &Hit, texture: &Texture) -> Option<Self> {
        let instance = &scene.instances[hit.id.instance as usize];
        let mesh = &scene.meshes[instance.mesh.0 as usize];
        let m = &instance.transform.matrix3;
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let handedness = m.determinant().signum();
        // A mirrored mesh keeps its outside, though its triangles wind the other way.
        let normal = match mesh.normals.is_empty() {
            true => surface.geometric_normal * handedness,
            false => {
                let local =
                    mesh.interpolate(&mesh.normals, hit.id.primitive, weights).map(f64::from);
                (cofactor(m) * DVec3::from(local) * handedness).try_normalize()?
            }
        };
        let across = |v: DVec3| (v - normal * normal.dot(v)).try_normalize();
        if !mesh.tangents.is_empty() {
            let corners = mesh.triangles[hit.id.primitive as usize];
            let sign = f64::from(mesh.tangents[corners[0] as usize][3]);
            let [x, y, z, _] =
                mesh.interpolate(&mesh.tangents, hit.id.primitive, weights).map(f64::from);
            let tangent = across(*m * DVec3::new(x, y, z))?;
            let bitangent = normal.cross(tangent) * (sign * handedness);
            return Some(Self { tangent, bitangent, normal });
        }
        let [u, v] = gradients(scene, hit, texture)?;
        // u grows along the tangent, and v against the bitangent.
        let along = v.cross(surface.geometric_normal);
        let tangent = across(along * along.dot(u).signum())?;
        let bitangent = normal.cross(tangent);
        let sign = -bitangent.dot(v).signum();
        Some(Self { tangent, bitangent: bitangent * sign, normal })
    }
}

/// The gradients of a texture's coordinates on a triangle.
fn gradients(scene: &Scene, hit: &Hit, texture: &Texture) -> Option<[DVec3; 2]> {
    let instance = &scene.instances[hit.id.instance as usize];
    let mesh = &scene.meshes[instance.mesh.0 as usize];
    let uvs = if texture.set == 0 { &mesh.uvs } else { &mesh.second_uvs };
    if uvs.is_empty() {
        return None;
    }
    let corners = mesh.triangles[hit.id.primitive as usize];
    let [a, b, c] = corners.map(|i| {
        texture.transform.transform_point2(Vec2::from(uvs[i as usize])).to_array().map(f64::from)
    });
    let weights = change_of_weights(scene.triangle_vertices(hit.id))?;
    let gradient = |k: usize| weights[0] * (b[k] - a[k]) + weights[1] * (c[k] - a[k]);
    Some([gradient(0), gradient(1)])
}
