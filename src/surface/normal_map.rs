//! Normal mapping: shading normals that a texture perturbs.

use glam::{Affine2, DVec3, Vec2, Vec3};

use super::footprint::weight_gradients;
use super::{Surface, cofactor};
use crate::geometry::{Geometry, Hit};
use crate::scene::{NormalMap, Scene, Texture, TextureId, TexturePoint};

/// Returns the shading normal of a surface, perturbed by the normal map of its material, if there is
/// one.
///
/// Where the map is flat or the surface has no tangent space, this is the surface's own normal, to the
/// bit.
pub fn mapped_normal(scene: &Scene, surface: &Surface, hit: &Hit, point: &TexturePoint) -> DVec3 {
    let map = &scene.materials[surface.material.0 as usize].normal_map;
    map.map_or(surface.normal, |map| perturbed_normal(scene, surface, hit, point, &map))
}

/// Returns the shading normal of a surface, perturbed by a normal map, as [`mapped_normal`] does.
pub fn perturbed_normal(
    scene: &Scene,
    surface: &Surface,
    hit: &Hit,
    point: &TexturePoint,
    map: &NormalMap,
) -> DVec3 {
    let texture = &scene.textures[map.texture.0 as usize];
    let color = texture.sample(point).truncate();
    let [x, y, z] = decode_normal(color, map.scale).to_array().map(f64::from);
    if x == 0.0 && y == 0.0 {
        return surface.normal;
    }
    let Some(TangentSpace { tangent, bitangent, normal }) =
        TangentSpace::new(scene, surface, hit, &TextureCoordinates::of(texture))
    else {
        return surface.normal;
    };
    let mapped = (tangent * x + bitangent * y + normal * z).normalize_or(surface.normal);
    // Turned to the viewer if the surface's own normal is.
    if normal.dot(surface.normal) < 0.0 { -mapped } else { mapped }
}

/// Returns the tangent of a surface, along which the u of a texture grows; of a mesh's own tangents where no
/// texture is given. `None` where there is no tangent space.
pub fn tangent(
    scene: &Scene,
    surface: &Surface,
    hit: &Hit,
    texture: Option<TextureId>,
) -> Option<DVec3> {
    let coordinates = texture.map_or(TextureCoordinates::FIRST, |id| {
        TextureCoordinates::of(&scene.textures[id.0 as usize])
    });
    TangentSpace::new(scene, surface, hit, &coordinates).map(|space| space.tangent)
}

/// Decodes a colour to a vector in tangent space. In 8 bits neither 127 nor 128 is exactly 0; both count
/// as 0.
fn decode_normal(color: Vec3, scale: f32) -> Vec3 {
    let v = color * 2.0 - 1.0;
    const FLAT: f32 = 1.01 / 255.0;
    let flat = |x: f32| if x.abs() < FLAT { 0.0 } else { x * scale };
    Vec3::new(flat(v.x), flat(v.y), v.z)
}

/// The texture coordinates of a map: their set, and their transform.
struct TextureCoordinates {
    set: u8,
    transform: Affine2,
}

impl TextureCoordinates {
    /// The first set, as it is.
    const FIRST: Self = Self { set: 0, transform: Affine2::IDENTITY };

    fn of(texture: &Texture) -> Self {
        Self { set: texture.set, transform: texture.transform }
    }
}

/// The tangent space of a normal map on a surface: three vectors of length 1. The normal is that of the
/// surface as modelled, not turned to the viewer.
struct TangentSpace {
    tangent: DVec3,
    bitangent: DVec3,
    normal: DVec3,
}

impl TangentSpace {
    fn new(
        scene: &Scene,
        surface: &Surface,
        hit: &Hit,
        coordinates: &TextureCoordinates,
    ) -> Option<Self> {
        let normal = surface.geometric_normal;
        let from_tangent = |tangent: DVec3| {
            let tangent = tangent.try_normalize()?;
            let space = Self { tangent, bitangent: normal.cross(tangent), normal };
            let uv_transform = coordinates.transform.matrix2;
            space.transformed(uv_transform.x_axis, uv_transform.y_axis)
        };
        match hit.id.geometry {
            Geometry::Spheres => from_tangent(DVec3::new(normal.z, 0.0, -normal.x)),
            Geometry::Planes => from_tangent(scene.planes[hit.id.primitive as usize].axes().0),
            Geometry::Mesh(_) => Self::on_mesh(scene, surface, hit, coordinates),
        }
    }

    /// Returns the tangent space after the matrix with these columns has transformed the texture
    /// coordinates; v runs down, and the bitangent up.
    fn transformed(self, x: Vec2, y: Vec2) -> Option<Self> {
        let [a, c, b, d] = [x.x, x.y, y.x, y.y].map(f64::from);
        let determinant = a * d - b * c;
        // The directions in which the mapped u and v grow: the columns of the inverse.
        let u = (self.tangent * d + self.bitangent * c) * determinant.signum();
        let up = (self.tangent * b + self.bitangent * a) * determinant.signum();
        if determinant == 0.0 {
            return None;
        }
        Some(Self { tangent: u.try_normalize()?, bitangent: up.try_normalize()?, ..self })
    }

    /// Returns the tangent space on a mesh.
    fn on_mesh(
        scene: &Scene,
        surface: &Surface,
        hit: &Hit,
        coordinates: &TextureCoordinates,
    ) -> Option<Self> {
        let instance = &scene.instances[hit.id.instance as usize];
        let mesh = &scene.meshes[instance.mesh.0 as usize];
        let m = &instance.transform.matrix3;
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let handedness = m.determinant().signum();
        // A mirrored mesh keeps its outside, though its triangles wind the other way.
        let normal = if mesh.normals.is_empty() {
            surface.geometric_normal * handedness
        } else {
            let local = mesh.interpolate(&mesh.normals, hit.id.primitive, weights).map(f64::from);
            (cofactor(m) * DVec3::from(local) * handedness).try_normalize()?
        };
        let orthogonalize = |v: DVec3| (v - normal * normal.dot(v)).try_normalize();
        // The mesh's own tangents, where it has them.
        if !mesh.tangents.is_empty() {
            let corners = mesh.triangles[hit.id.primitive as usize];
            let sign = f64::from(mesh.tangents[corners[0] as usize][3]);
            let [x, y, z, _] =
                mesh.interpolate(&mesh.tangents, hit.id.primitive, weights).map(f64::from);
            let tangent = orthogonalize(*m * DVec3::new(x, y, z))?;
            let bitangent = normal.cross(tangent) * (sign * handedness);
            return Some(Self { tangent, bitangent, normal });
        }
        // Otherwise the gradients of the texture coordinates.
        let [u, v] = uv_gradients(scene, hit, coordinates)?;
        // u grows along the tangent, and v against the bitangent.
        let along = v.cross(surface.geometric_normal);
        let tangent = orthogonalize(along * along.dot(u).signum())?;
        let bitangent = normal.cross(tangent);
        let sign = -bitangent.dot(v).signum();
        Some(Self { tangent, bitangent: bitangent * sign, normal })
    }
}

/// Returns the gradients of texture coordinates on a triangle; `None` if the mesh has none, or the
/// triangle is degenerate.
fn uv_gradients(scene: &Scene, hit: &Hit, coordinates: &TextureCoordinates) -> Option<[DVec3; 2]> {
    let instance = &scene.instances[hit.id.instance as usize];
    let mesh = &scene.meshes[instance.mesh.0 as usize];
    let uvs = if coordinates.set == 0 { &mesh.uvs } else { &mesh.second_uvs };
    if uvs.is_empty() {
        return None;
    }
    let corners = mesh.triangles[hit.id.primitive as usize];
    let [a, b, c] = corners.map(|i| {
        coordinates
            .transform
            .transform_point2(Vec2::from(uvs[i as usize]))
            .to_array()
            .map(f64::from)
    });
    let weights = weight_gradients(scene.triangle_vertices(hit.id))?;
    let gradient = |k: usize| weights[0] * (b[k] - a[k]) + weights[1] * (c[k] - a[k]);
    Some([gradient(0), gradient(1)])
}
