//! What a hit means: position, normals, texture coordinates, material, side; and the rays that
//! leave it.

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
        // A sphere that was gone into is left, though a ray that only touches it does both at one
        // point, where its direction tells nothing.
        let is_left = id.geometry == Geometry::Spheres
            && ray.past.is_some_and(|past| past.through == Departure { id, side: Side::Back });
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Checker, Instance, Material, Mesh, Plane, Sphere};
    use glam::DAffine3;

    fn scene() -> Scene {
        let mut scene = Scene::default();
        let material = scene.add_material(Material::default());
        scene.spheres.push(Sphere::new(DVec3::Z * 5.0, 1.0, material));
        let mut plane = Plane::new(DVec3::ZERO, DVec3::Y, material);
        plane.checker = Some(Checker { colors: [Vec3::ZERO, Vec3::ONE], size: 0.5 });
        scene.planes.push(plane);
        let mesh = scene.add_mesh(Mesh {
            positions: vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]],
            triangles: vec![[0, 1, 2]],
            normals: vec![[0., 0., 1.], [1., 0., 1.], [0., 1., 1.]],
            uvs: vec![[0., 0.], [1., 0.], [0., 1.]],
            colors: vec![[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
        scene
    }

    fn hit(t: f64, u: f64, v: f64, id: PrimitiveId) -> Hit {
        Hit { t, u, v, id }
    }

    #[test]
    fn sphere_normal_points_outward() {
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        let surface = Surface::new(&scene(), &ray, &hit(4.0, 0.0, 0.0, PrimitiveId::sphere(0)));
        assert_eq!((surface.position, surface.normal), (DVec3::Z * 4.0, DVec3::NEG_Z));
        assert_eq!(surface.side, Side::Front);
    }

    #[test]
    fn sphere_seen_from_inside_keeps_its_outward_normal() {
        let ray = Ray::new(DVec3::Z * 5.0, DVec3::Z);
        let surface = Surface::new(&scene(), &ray, &hit(1.0, 0.0, 0.0, PrimitiveId::sphere(0)));
        assert_eq!((surface.normal, surface.side), (DVec3::Z, Side::Back));
    }

    #[test]
    fn double_sided_sphere_turns_its_normal_inward() {
        let mut scene = scene();
        scene.materials[0].double_sided = true;
        let ray = Ray::new(DVec3::Z * 5.0, DVec3::Z);
        let surface = Surface::new(&scene, &ray, &hit(1.0, 0.0, 0.0, PrimitiveId::sphere(0)));
        assert_eq!(surface.normal, DVec3::NEG_Z);
    }

    #[test]
    fn plane_turns_its_normal_to_the_viewer() {
        let ray = Ray::new(-DVec3::Y, DVec3::Y);
        let surface = Surface::new(&scene(), &ray, &hit(1.0, 0.0, 0.0, PrimitiveId::plane(0)));
        assert_eq!((surface.normal, surface.geometric_normal), (DVec3::NEG_Y, DVec3::Y));
    }

    #[test]
    fn checker_alternates_across_the_origin() {
        let color = |x: f64, z: f64| {
            let ray = Ray::new(DVec3::new(x, 1.0, z), DVec3::NEG_Y);
            let id = PrimitiveId::plane(0);
            Surface::new(&scene(), &ray, &hit(1.0, 0.0, 0.0, id)).checker.unwrap().x
        };
        assert_eq!([color(0.1, 0.1), color(0.6, 0.1), color(-0.1, 0.1)], [0.0, 1.0, 1.0]);
        assert_eq!([color(-0.1, -0.1), color(1.1, 0.1)], [0.0, 0.0]);
    }

    #[test]
    fn a_picture_on_a_plane_repeats_by_its_size_from_the_planes_point() {
        let uv = |x: f64, z: f64| {
            let mut scene = scene();
            (scene.planes[0].point, scene.planes[0].texture_size) =
                (DVec3::new(1.0, 0.0, 2.0), 4.0);
            let ray = Ray::new(DVec3::new(x, 1.0, z), DVec3::NEG_Y);
            Surface::new(&scene, &ray, &hit(1.0, 0.0, 0.0, PrimitiveId::plane(0))).uv
        };
        assert_eq!([uv(1.0, 2.0), uv(2.0, 5.0)], [[0.0, 0.0], [0.25, 0.75]]);
        assert_eq!([uv(6.0, 1.0), uv(-3.0, -2.0)], [[0.25, 0.75], [0.0, 0.0]]);
    }

    #[test]
    fn attributes_are_interpolated_by_the_weights() {
        let mut scene = scene();
        let image = crate::scene::Image {
            name: String::new(),
            width: 1,
            height: 1,
            texels: vec![[255; 4]],
        };
        let texture = scene.add_texture(crate::scene::Texture {
            image: image.into(),
            transfer: crate::scene::Transfer::None,
            wrap: Default::default(),
            filter: Default::default(),
        });
        scene.materials[0].diffuse_map = Some(texture);
        let ray = Ray::new(DVec3::new(0.25, 0.5, 1.0), DVec3::NEG_Z);
        let id = PrimitiveId::triangle(0, 0, 0);
        let surface = Surface::new(&scene, &ray, &hit(1.0, 0.25, 0.5, id));
        assert_eq!(surface.uv, [0.25, 0.5]);
        assert_eq!(surface.tint, Vec3::new(0.25, 0.25, 0.5));
        let expected = DVec3::new(0.25, 0.5, 1.0).normalize();
        assert!((surface.normal - expected).length() < 1e-15);
    }

    #[test]
    fn normal_of_a_stretched_mesh_stays_across_its_surface() {
        let mut scene = scene();
        std::sync::Arc::make_mut(&mut scene.meshes[0]).normals = vec![[1., 0., 1.]; 3];
        scene.instances[0].transform = DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0));
        let ray = Ray::new(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z);
        let id = PrimitiveId::triangle(0, 0, 0);
        let surface = Surface::new(&scene, &ray, &hit(1.0, 0.1, 0.2, id));
        let expected = DVec3::new(0.5, 0.0, 1.0).normalize();
        assert!((surface.normal - expected).length() < 1e-15, "{}", surface.normal);
    }

    #[test]
    fn shadow_ray_leaves_on_the_lights_side() {
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        let surface = Surface::new(&scene(), &ray, &hit(4.0, 0.0, 0.0, PrimitiveId::sphere(0)));
        let toward = |toward: DVec3| Arrival { toward, bounded: true, intensity: Vec3::ONE };
        let side = |d: DVec3| surface.shadow_ray(&toward(d)).from.unwrap().side;
        assert_eq!((side(DVec3::NEG_Z), side(DVec3::Z)), (Side::Front, Side::Back));
    }
}
