use super::*;
use crate::scene::{Checker, Image, Instance, Material, Mesh, Plane, Sphere, Texture};
use glam::{DAffine3, Vec3};

fn scene() -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    scene.spheres.push(Sphere::new(DVec3::Z * 5.0, 1.0, material));
    let mut plane = Plane::new(DVec3::ZERO, DVec3::Y, material);
    plane.checker = Some(Checker { colors: [Vec3::ZERO, Vec3::ONE], size: 0.5 });
    scene.planes.push(plane);
    let mesh = scene.add_mesh(Mesh {
        positions: vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]].into(),
        triangles: vec![[0, 1, 2]],
        normals: vec![[0., 0., 1.], [1., 0., 1.], [0., 1., 1.]],
        uvs: vec![[0., 0.], [1., 0.], [0., 1.]],
        colors: vec![[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
        ..Mesh::default()
    });
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
    scene
}

/// Gives the material a texture, so that texture coordinates are computed.
fn add_texture(scene: &mut Scene) {
    let image = Image::from_bytes("", [1, 1], vec![[255; 4]]);
    let texture = scene.add_texture(Texture::new(image.into()));
    scene.materials[0].diffuse_map = Some(texture);
}

fn hit(t: f64, u: f64, v: f64, id: PrimitiveId) -> Hit {
    Hit { t, u, v, id }
}

fn context(scene: &Scene, ray: &Ray, hit: &Hit) -> TextureContext {
    let surface = Surface::new(scene, ray, hit);
    let is_textured = scene.materials[surface.material.0 as usize].is_textured();
    TextureContext::new(scene, hit, &surface, is_textured, None)
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
        context(&scene(), &ray, &hit(1.0, 0.0, 0.0, id)).checker.unwrap().x
    };
    assert_eq!([color(0.1, 0.1), color(0.6, 0.1), color(-0.1, 0.1)], [0.0, 1.0, 1.0]);
    assert_eq!([color(-0.1, -0.1), color(1.1, 0.1)], [0.0, 0.0]);
}

#[test]
fn a_texture_on_a_plane_repeats_by_its_size_from_the_planes_point() {
    let uv = |x: f64, z: f64| {
        let mut scene = scene();
        add_texture(&mut scene);
        (scene.planes[0].point, scene.planes[0].texture_size) = (DVec3::new(1.0, 0.0, 2.0), 4.0);
        let ray = Ray::new(DVec3::new(x, 1.0, z), DVec3::NEG_Y);
        context(&scene, &ray, &hit(1.0, 0.0, 0.0, PrimitiveId::plane(0))).point.uv[0]
    };
    assert_eq!([uv(1.0, 2.0), uv(2.0, 5.0)], [[0.0, 0.0], [0.25, 0.75]]);
    assert_eq!([uv(6.0, 1.0), uv(-3.0, -2.0)], [[0.25, 0.75], [0.0, 0.0]]);
}

#[test]
fn attributes_are_interpolated_by_the_weights() {
    let mut scene = scene();
    add_texture(&mut scene);
    let ray = Ray::new(DVec3::new(0.25, 0.5, 1.0), DVec3::NEG_Z);
    let id = PrimitiveId::triangle(0, 0, 0);
    let surface = Surface::new(&scene, &ray, &hit(1.0, 0.25, 0.5, id));
    let context = context(&scene, &ray, &hit(1.0, 0.25, 0.5, id));
    assert_eq!(context.point.uv[0], [0.25, 0.5]);
    assert_eq!(context.vertex_color, Vec3::new(0.25, 0.25, 0.5));
    let expected = DVec3::new(0.25, 0.5, 1.0).normalize();
    assert!((surface.normal - expected).length() < 1e-15);
}

#[test]
fn normal_of_a_stretched_mesh_stays_perpendicular_to_its_surface() {
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
    let toward = |toward: DVec3| IncidentLight { toward, is_bounded: true, intensity: Vec3::ONE };
    let side = |d: DVec3| surface.shadow_ray(ray.direction, &toward(d)).departure.unwrap().side;
    assert_eq!((side(DVec3::NEG_Z), side(DVec3::Z)), (Side::Front, Side::Back));
}

#[test]
fn sixteen_surfaces_equal_those_of_one_at_a_time() {
    let mut scene = scene();
    scene.spheres.push(Sphere::new(DVec3::new(0.3, -0.2, 9.0), 2.0, MaterialId(1)));
    scene.add_material(Material { double_sided: true, ..Material::default() });
    let ids = [
        Some(PrimitiveId::sphere(0)),
        Some(PrimitiveId::plane(0)),
        None,
        Some(PrimitiveId::triangle(0, 0, 0)),
        Some(PrimitiveId::sphere(1)),
    ];
    // The first three batches have hits of one kind each; the last has a mixture.
    for of in [[0; 5], [1; 5], [3; 5], [0, 1, 2, 3, 4]] {
        let (mut rays, mut hits) = (crate::geometry::RayBatch::default(), Default::default());
        let count = 13;
        for i in 0..count {
            let x = i as f64 / 7.0 - 0.9;
            let mut ray = Ray::new(DVec3::new(x, 0.1, -1.0), DVec3::new(0.3, x, 2.0 - x));
            let through = Departure { id: PrimitiveId::sphere(0), side: Side::Back };
            ray.continuation =
                (i == 5).then_some(crate::geometry::Continuation { t: 0.1, crossed: through });
            rays.push(&ray);
        }
        crate::geometry::HitBatch::reset_to_misses(&mut hits, count);
        for i in 0..count {
            let t = 2.0 + i as f64;
            hits.set(i, ids[of[i % 5]].map(|id| hit(t, 0.1, 0.02 * t, id)));
        }
        let mut surfaces = Surface16::default();
        surfaces.set::<true>(&scene, &rays, 0, &hits.blocks()[0]);
        for i in 0..count {
            let Some(hit) = hits.get(i) else { continue };
            let one = Surface::new(&scene, &rays.ray(i), &hit);
            assert_eq!(surfaces.position(i), one.position);
            assert_eq!(surfaces.geometric_normal(i), one.geometric_normal);
            assert_eq!((surfaces.normal(i), surfaces.side(i)), (one.normal, one.side));
            assert_eq!(surfaces.material[i], one.material);
        }
    }
}
