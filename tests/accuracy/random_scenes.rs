//! Random scenes and rays that are the same every time.

use envers::{Instance, Material, Mesh, Plane, Ray, Scene, Sphere};
use envers_testing::Random;
use glam::{DAffine3, DQuat, DVec3, EulerRot};

/// A closed ball of triangles: an octahedron, divided `level` times.
pub fn ball(level: u32) -> Mesh {
    let mut positions: Vec<DVec3> =
        vec![DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    for _ in 0..level {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let p = (positions[a as usize] + positions[b as usize]).normalize();
                positions.push(p);
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    Mesh {
        name: "ball".into(),
        positions: positions.iter().map(|p| p.as_vec3().to_array()).collect(),
        triangles,
        ..Mesh::default()
    }
}

/// Triangles strewn about the cube [-1, 1]³.
pub fn soup(random: &mut Random, count: u32) -> Mesh {
    let mut positions: Vec<[f32; 3]> = Vec::new();
    for _ in 0..count {
        let center = random.cube(1.0);
        for _ in 0..3 {
            positions.push((center + random.cube(0.3)).as_vec3().to_array());
        }
    }
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { name: "soup".into(), positions: positions.into(), triangles, ..Mesh::default() }
}

/// A scene of spheres, planes, meshes that stand once and meshes that stand several times, about
/// `offset` and of about `size`.
pub fn random_scene(seed: u64, offset: DVec3, size: f64) -> Scene {
    let mut r = Random(seed);
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    for _ in 0..10 + r.below(30) {
        let center = offset + r.cube(size);
        scene.spheres.push(Sphere::new(center, size * r.range(0.01, 0.3), material));
    }
    for _ in 0..r.below(3) {
        scene.planes.push(Plane::new(offset + r.cube(size), r.cube(1.0), material));
    }
    let single = scene.add_mesh(soup(&mut r, 30));
    // Modelled away from its own origin, as files often are.
    let away = [300.0, -200.0, 100.0];
    let mut many = ball(1);
    many.positions = many.positions.map(|_, p| p + DVec3::from(away));
    let many = scene.add_mesh(many);
    for mesh in [single, many, many, many] {
        let turn =
            DQuat::from_euler(EulerRot::XYZ, r.range(0., 6.), r.range(0., 6.), r.range(0., 6.));
        let stretch = DVec3::new(r.range(0.1, 0.6), r.range(0.1, 0.6), r.range(-0.6, -0.1)) * size;
        let transform =
            DAffine3::from_scale_rotation_translation(stretch, turn, offset + r.cube(size));
        let back = if mesh == many { -DVec3::from(away) } else { DVec3::ZERO };
        let transform = transform * DAffine3::from_translation(back);
        scene.instances.push(Instance::new(mesh, transform, material));
    }
    scene.check().expect("the generator makes valid scenes");
    scene
}

/// Rays about a scene of `random_scene`: from within and from outside, of any length.
pub fn random_rays(seed: u64, offset: DVec3, size: f64, count: usize) -> Vec<Ray> {
    let mut r = Random(seed);
    (0..count)
        .map(|i| {
            let reach = if i % 4 == 0 { 20.0 } else { 1.5 };
            let origin = offset + r.cube(size * reach);
            let target = offset + r.cube(size);
            Ray::new(origin, (target - origin) * r.range(-3.0, 3.0).exp2())
        })
        .collect()
}
