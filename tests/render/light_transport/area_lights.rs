//! Lights with an extent and surfaces that illuminate, held to closed forms of the light of diffuse
//! emitters.

use envers::internals::Tiling;
use envers::{
    Instance, Light, Material, MaterialId, Mesh, Plane, Projection, RenderOptions, Renderer, Scene,
    Sphere,
};
use glam::{DAffine3, DVec3, Vec3};

use super::one_pixel::*;

/// White ground at y = 0, seen at the origin from the side.
fn ground() -> Scene {
    let mut scene = seen_from(DVec3::new(0.0, 1.0, 9.0), DVec3::ZERO);
    let white = scene.add_material(Material::matte(Vec3::ONE));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, white));
    scene
}

/// The relative error of what the ground reflects, which its light makes `expected`.
fn error(scene: &Scene, expected: f64) -> f64 {
    f64::from(radiance(scene)[0]) / expected - 1.0
}

/// Asserts that the relative error is below these bounds with 16, 64 and 1024 samples of a light.
#[track_caller]
fn assert_converges(light: Light, expected: f64, bounds: [f64; 3]) {
    for (samples, bound) in [16, 64, 1024].into_iter().zip(bounds) {
        let mut scene = ground();
        scene.lights.push(light.clone().with_samples(samples));
        let error = error(&scene, expected);
        println!("{samples} samples: relative error {error:.1e}, bound {bound:.0e}");
        assert!(error.abs() < bound, "{samples} samples: {error:e}");
    }
}

/// The light that a white surface at the origin, of normal y, reflects of a rectangle above it, of radiance 1:
/// Lambert's formula for a polygon.
fn lambert_polygon(center: DVec3, u: DVec3, v: DVec3) -> f64 {
    let corners = [center - u - v, center + u - v, center + u + v, center - u + v];
    let edges = (0..4).map(|i| {
        let [a, b] = [corners[i].normalize(), corners[(i + 1) % 4].normalize()];
        a.dot(b).acos() * a.cross(b).normalize().y
    });
    (edges.sum::<f64>() / std::f64::consts::TAU).abs()
}

#[test]
fn ground_under_a_rectangle_reflects_lamberts_polygon() {
    let (center, u, v) = (DVec3::new(0.5, 1.0, -0.25), DVec3::X, DVec3::Z * 0.5);
    let expected = lambert_polygon(center, u, v);
    assert_converges(Light::rectangle(center, u, v), expected, [1e-3, 1e-3, 1e-5]);
}

#[test]
fn ground_under_a_disk_reflects_r2_over_r2_plus_d2() {
    let light = Light::disk(DVec3::Y * 2.0, DVec3::NEG_Y, 1.0);
    assert_converges(light, 1.0 / 5.0, [2e-2, 3e-3, 2e-4]);
}

#[test]
fn ground_under_a_sphere_reflects_r2_over_d2_times_the_cosine() {
    let light = Light::sphere(DVec3::new(3.0, 4.0, 0.0), 2.5);
    assert_converges(light, 0.25 * 0.8, [1e-2, 1e-3, 3e-5]);
}

#[test]
fn ground_under_a_sun_reflects_its_intensity_times_the_cosine_whatever_its_angle() {
    for angle in [1e-6, 0.01, 0.5] {
        let light = Light::sun(DVec3::new(0.6, -0.8, 0.0)).with_angle(angle);
        // Of a wide sun, the mean of the samples is not quite in its middle.
        assert_converges(light, 0.8, [1e-2, 2e-3, 3e-5].map(|bound| bound * angle + 1e-6));
    }
}

#[test]
fn a_half_of_a_light_behind_a_wall_gives_half_of_its_light() {
    // The wall, seen from the origin, covers the half x > 0 of a panel that faces the ground.
    let panel = Light::rectangle(DVec3::Y * 2.0, DVec3::X, DVec3::Z);
    let mut scene = ground();
    let mesh = scene.add_mesh(quad());
    let wall = DAffine3::from_translation(DVec3::new(5.0, 1.0, 0.0))
        * DAffine3::from_scale(DVec3::splat(5.0))
        * DAffine3::from_rotation_x(std::f64::consts::FRAC_PI_2);
    scene.instances.push(Instance::new(mesh, wall, MaterialId(0)));
    for samples in [4, 16, 64] {
        scene.lights = vec![panel.clone().with_samples(samples)];
        let lit = radiance(&scene)[0];
        let instances = std::mem::take(&mut scene.instances);
        let whole = radiance(&scene)[0];
        scene.instances = instances;
        assert!((lit / whole - 0.5).abs() < 0.02, "{samples}: {lit} of {whole}");
    }
}

#[test]
fn samples_of_a_pixel_have_samples_of_a_light_of_their_own() {
    let mut scene = ground();
    // So small a pixel that its samples see one point.
    scene.cameras[0].projection = Projection::FovY(1e-7);
    scene.lights.push(Light::disk(DVec3::Y * 2.0, DVec3::NEG_Y, 1.0).with_samples(16));
    let expected = 1.0 / 5.0;
    let one = error(&scene, expected).abs();
    scene.film.spp = 16;
    let sixteen = error(&scene, expected).abs();
    assert!(sixteen < 0.3 * one, "{sixteen:e} after {one:e}");
}

/// A square from −1 to 1 in the plane z = 0, with its front toward +z.
fn quad() -> Mesh {
    Mesh {
        positions: vec![[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]].into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A material that illuminates, one-sided.
fn lamp(radiance: f32) -> Material {
    let emission = Material::emissive(Vec3::splat(radiance));
    Material { illuminates: true, cull_back_faces: true, ..emission }
}

/// The ground under a square lamp of half-side 0.5 at height 2, turned about x by this angle from
/// facing up.
fn under_square(angle: f64, material: Material) -> Scene {
    let mut scene = ground();
    let material = scene.add_material(material);
    let mesh = scene.add_mesh(quad());
    let transform = DAffine3::from_translation(DVec3::Y * 2.0)
        * DAffine3::from_rotation_x(angle - std::f64::consts::FRAC_PI_2)
        * DAffine3::from_scale(DVec3::splat(0.5));
    scene.instances.push(Instance::new(mesh, transform, material));
    scene
}

#[test]
fn an_emissive_square_lights_the_ground_as_lamberts_polygon() {
    let expected = lambert_polygon(DVec3::Y * 2.0, DVec3::X * 0.5, DVec3::Z * 0.5) * 3.0;
    let down = std::f64::consts::PI;
    let scene = under_square(down, lamp(3.0));
    let once = error(&scene, expected);
    println!("64 points: relative error {once:.1e}");
    assert!(once.abs() < 3e-3, "{once:e}");
    // Upside down it is dark, unless both of its sides emit.
    assert_eq!(radiance(&under_square(0.0, lamp(3.0))), [0.0; 3]);
    let both = Material { cull_back_faces: false, ..lamp(3.0) };
    for angle in [0.0, down] {
        assert!(error(&under_square(angle, both.clone()), expected).abs() < 3e-3);
    }
    // What does not illuminate lights nothing.
    let dark = Material { illuminates: false, ..lamp(3.0) };
    assert_eq!(radiance(&under_square(down, dark)), [0.0; 3]);
}

#[test]
fn an_emissive_sphere_lights_the_ground_as_a_sphere_light() {
    let mut scene = ground();
    let material = scene.add_material(lamp(2.0));
    scene.spheres.push(Sphere::new(DVec3::new(3.0, 4.0, 0.0), 2.5, material));
    let error = error(&scene, 2.0 * 0.25 * 0.8);
    assert!(error.abs() < 3e-3, "{error:e}");
}

#[test]
fn an_emissive_mesh_of_a_million_triangles_lights_the_ground_as_its_square() {
    let expected = lambert_polygon(DVec3::Y * 2.0, DVec3::X * 0.5, DVec3::Z * 0.5) * 3.0;
    let mut scene = under_square(std::f64::consts::PI, lamp(3.0));
    let n = 708;
    let at = |i: u32| 2.0 * i as f32 / n as f32 - 1.0;
    let vertices = (0..=n).flat_map(|y| (0..=n).map(move |x| [at(x), at(y), 0.0]));
    let cells = (0..n).flat_map(|y| (0..n).map(move |x| y * (n + 1) + x));
    let mesh = scene.add_mesh(Mesh {
        positions: vertices.collect::<Vec<_>>().into(),
        triangles: cells.flat_map(|i| [[i, i + 1, i + n + 2], [i, i + n + 2, i + n + 1]]).collect(),
        ..Mesh::default()
    });
    scene.instances[0].mesh = mesh;
    assert!(scene.triangle_count() > 1_000_000);
    let options = RenderOptions { threads: 1, ..RenderOptions::default() };
    let film = Renderer::new(&scene).options(options).render().unwrap().film;
    let error = f64::from(film.pixel(0, 0)[0]) / expected - 1.0;
    assert!(error.abs() < 1e-2, "{error:e}");
}

#[test]
fn an_emissive_ball_of_triangles_does_not_shade_the_ground_from_itself() {
    // Latitudes and longitudes of a ball of radius 1 at height 3, wound outward.
    let (rows, columns) = (24u32, 48u32);
    let at = |row: u32, column: u32| {
        let polar = f64::from(row) / f64::from(rows) * std::f64::consts::PI;
        let around = f64::from(column) / f64::from(columns) * std::f64::consts::TAU;
        let (sin, cos) = polar.sin_cos();
        [sin * around.cos(), cos, -sin * around.sin()].map(|x| x as f32)
    };
    let grid = (0..=rows).flat_map(|row| (0..columns).map(move |column| at(row, column)));
    let index = |row: u32, column: u32| row * columns + column % columns;
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let triangles = cells.flat_map(|(row, column)| {
        let [a, b] = [index(row, column), index(row + 1, column)];
        let [c, d] = [index(row + 1, column + 1), index(row, column + 1)];
        [[a, b, c], [a, c, d]]
    });
    let mesh = Mesh {
        positions: grid.collect::<Vec<_>>().into(),
        triangles: triangles.collect(),
        ..Mesh::default()
    };
    for two_sided in [false, true] {
        let mut scene = ground();
        let material = Material { cull_back_faces: !two_sided, ..lamp(1.0) };
        let material = scene.add_material(material);
        let mesh = scene.add_mesh(mesh.clone());
        let up = DAffine3::from_translation(DVec3::Y * 3.0);
        scene.instances.push(Instance::new(mesh, up, material));
        scene.film.spp = 16;
        // A polyhedron in the unit ball has a little less than its (r/d)².
        let error = error(&scene, 1.0 / 9.0);
        println!("two-sided {two_sided}: relative error {error:.1e}");
        assert!(error < 0.01 && error > -0.03, "two-sided {two_sided}: {error:e}");
    }
}

#[test]
fn pictures_with_area_lights_do_not_depend_on_tiles_or_threads() {
    let mut scene = under_square(2.5, lamp(3.0));
    scene.film.size = [70, 40];
    scene.film.spp = 3;
    let projection = Projection::FovY(1.0);
    scene.cameras[0] =
        envers::Camera::look_at(DVec3::new(0.0, 2.0, 5.0), DVec3::ZERO, DVec3::Y, projection)
            .unwrap();
    scene.lights.push(Light::sphere(DVec3::new(2.0, 3.0, 0.0), 0.5).with_samples(7));
    scene.lights.push(Light::point(DVec3::new(-2.0, 3.0, 0.0)));
    scene.lights.push(Light::sun(DVec3::new(0.3, -1.0, 0.2)).with_angle(0.1));
    let picture = |threads, tiling| {
        let options = RenderOptions { threads, tiling, ..RenderOptions::default() };
        Renderer::new(&scene).options(options).render().unwrap().film
    };
    let whole = picture(1, Tiling::default());
    for (rows, columns, block) in [(3, 17, 1), (16, 64, 2), (40, 70, 4)] {
        assert!(picture(2, Tiling { rows, columns, block }) == whole, "{rows} {columns} {block}");
    }
}
