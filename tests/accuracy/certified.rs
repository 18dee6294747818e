//! Precision `certified`: brute force, BVH and Embree give the same hits to the bit.
//!
//! The rays are adversarial: aimed exactly (as f64 can) at vertices, edges, diagonals and tangents,
//! along axes, with zeros and negative zeros in the direction.

use std::path::{Path, PathBuf};

use envers::{
    BruteForce, Bvh, Coherence, Departure, Hit, Instance, Intersector, Material, Mesh, Plane,
    Precision, PrimitiveId, Ray, Scene, Side, Sphere,
};
use envers_testing::Random;
use glam::{DAffine3, DQuat, DVec3};
use rayon::prelude::*;

use crate::random_scenes::{ball, random_rays, random_scene};

fn closest(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    rays.par_chunks(1000)
        .zip(hits.par_chunks_mut(1000))
        .for_each(|(rays, hits)| intersector.closest(rays, Coherence::Incoherent, hits));
    hits
}

fn occluded(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<bool> {
    let mut blocked = vec![false; rays.len()];
    rays.par_chunks(1000)
        .zip(blocked.par_chunks_mut(1000))
        .for_each(|(rays, blocked)| intersector.occluded(rays, Coherence::Incoherent, blocked));
    blocked
}

/// A hit's numbers by their bits: −0 is not 0, and nothing is "about the same".
fn bits(hit: &Option<Hit>) -> Option<(u64, u64, u64, PrimitiveId)> {
    hit.map(|h| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.id))
}

/// Holds BVH and Embree, in packets and ray by ray, against brute force, which tries at most
/// `budget` primitives; beyond that many rays the BVH is the judge. Returns how many rays hit.
fn all_agree(what: &str, scene: &Scene, rays: &[Ray], budget: usize) -> usize {
    let judge = Bvh::build(scene, Precision::Certified);
    let expected = closest(&judge, rays);
    let segments: Vec<Ray> =
        rays.iter().map(|r| Ray { tmax: 0.7, ..*r }).chain(rays.iter().copied()).collect();
    let blocked = occluded(&judge, &segments);
    let same = |name: &str, rays: &[Ray], found: &[Option<Hit>]| {
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(bits(&found[i]), bits(&expected[i]), "{what}, {name}: {ray:?}");
        }
    };
    let same_shadow = |name: &str, rays: &[Ray], found: &[bool]| {
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(found[i], blocked[i], "{what}, {name}, occlusion: {ray:?}");
        }
    };
    let primitives = scene.triangle_count() as usize + scene.spheres.len() + scene.planes.len() + 1;
    let few = (budget / primitives).min(rays.len());
    let brute = BruteForce::new(scene, Precision::Certified);
    same("brute force", &rays[..few], &closest(&brute, &rays[..few]));
    same_shadow("brute force", &segments[..few], &occluded(&brute, &segments[..few]));
    #[cfg(feature = "embree")]
    {
        use envers::Embree;
        let packets = Embree::build(scene, Precision::Certified, 0).unwrap();
        let single = Embree::build_single(scene, Precision::Certified, 0).unwrap();
        for (name, embree) in [("Embree", &packets), ("Embree ray by ray", &single)] {
            same(name, rays, &closest(embree, rays));
            same_shadow(name, &segments, &occluded(embree, &segments));
        }
    }
    expected.iter().flatten().count()
}

const BUDGET: usize = 20_000_000;

/// A point on the line from `origin` in a random direction or along an axis, from which `target`
/// is seen exactly: the differences are small integers times a power of two.
fn toward(r: &mut Random, target: DVec3, size: f64) -> Ray {
    let unit = size.log2().round().exp2() / 8.0;
    let mut step = || (r.below(33) as f64 - 16.0) * unit;
    let mut d = DVec3::new(step(), step(), step());
    match r.below(6) {
        0 => d = DVec3::new(d.x, 0.0, -0.0),
        1 => d = DVec3::new(-0.0, d.y, 0.0),
        2 => d = DVec3::new(0.0, -0.0, d.z),
        3 => d.x = -0.0,
        _ => {}
    }
    if d == DVec3::ZERO {
        d = DVec3::Z * unit;
    }
    // `origin + t·d` goes through the target exactly only where this does not round; both kinds
    // are wanted.
    let origin = target - d * 2.0;
    Ray::new(origin, d * (r.range(-8.0, 8.0).round()).exp2())
}

/// Rays at the vertices, the middles of edges, diagonals and insides of random triangles.
fn at_triangles(scene: &Scene, seed: u64, count: usize) -> Vec<Ray> {
    let mut r = Random(seed);
    let standing: Vec<u32> = (0..scene.instances.len() as u32)
        .filter(|&i| {
            let mesh = scene.instances[i as usize].mesh.0;
            !scene.meshes[mesh as usize].triangles.is_empty()
        })
        .collect();
    let size = scene.bounds().diagonal();
    (0..count)
        .map(|i| {
            let instance = standing[r.below(standing.len())];
            let mesh = scene.instances[instance as usize].mesh.0;
            let count = scene.meshes[mesh as usize].triangles.len();
            let id = PrimitiveId::triangle(mesh, r.below(count) as u32, instance);
            let [a, b, c] = scene.triangle_vertices(id);
            match i % 6 {
                0 => toward(&mut r, a, size),
                1 => toward(&mut r, b.midpoint(c), size),
                2 => toward(&mut r, a.midpoint(b.midpoint(c)), size),
                // Along an edge, and within the plane.
                3 => Ray::new(a - (b - a), b - a),
                4 => Ray::new(a - (b - a) + (c - a) * 0.25, b - a),
                _ => Ray::segment(a + r.cube(size), c),
            }
        })
        .collect()
}

/// Rays that touch spheres as exactly as f64 lets them, and some that start on them.
fn at_spheres(scene: &Scene, seed: u64, count: usize) -> Vec<Ray> {
    let mut r = Random(seed);
    (0..count)
        .map(|i| {
            let s = scene.spheres[r.below(scene.spheres.len())];
            let axis = [DVec3::X, DVec3::Y, DVec3::Z];
            let (a, b) = (axis[i % 3], axis[(i + 1) % 3]);
            let touching = s.center + a * s.radius;
            match i % 4 {
                0 => Ray::new(touching - b * 3.0 * s.radius, b),
                1 => Ray::new(touching - b * s.radius * r.range(1.0, 9.0), b * 0.3),
                2 => Ray::new(touching, r.cube(1.0)),
                _ => Ray::new(s.center - b * 9.0 * s.radius + a * s.radius.next_up(), b * 7.0),
            }
        })
        .collect()
}

#[test]
fn all_agree_on_random_scenes_near_and_far_from_the_origin() {
    for seed in 0..9 {
        let offset =
            [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2), DVec3::splat(1e7)][seed as usize % 3];
        let size = [1.0, 100.0, 1e-2][(seed / 3) as usize % 3];
        let scene = random_scene(seed, offset, size);
        let what = format!("scene {seed}");
        let rays = random_rays(seed + 1000, offset, size, 20_000);
        let hits = all_agree(&what, &scene, &rays, BUDGET);
        assert!(hits > 2000, "{what}: too few hits to compare, {hits}");
        all_agree(&what, &scene, &at_triangles(&scene, seed, 6000), BUDGET);
        all_agree(&what, &scene, &at_spheres(&scene, seed, 6000), BUDGET);
    }
}

#[test]
fn all_agree_on_instances_turned_and_stretched() {
    let mut r = Random(3);
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let mesh = scene.add_mesh(ball(2));
    for i in 0..12 {
        let turn = DQuat::from_axis_angle(r.cube(1.0).normalize(), r.range(0.0, 6.0));
        let stretch = DVec3::new(r.range(0.01, 2.0), r.range(0.1, 30.0), r.range(-1.0, -0.3));
        let place = r.cube(40.0) + DVec3::splat(if i < 6 { 0.0 } else { 5e6 });
        let transform = DAffine3::from_scale_rotation_translation(stretch, turn, place);
        scene.instances.push(Instance::new(mesh, transform, material));
    }
    let hits = all_agree("instances", &scene, &at_triangles(&scene, 1, 30_000), BUDGET);
    assert!(hits > 10_000, "{hits}");
}

/// A planet, and beside the camera on its surface a mesh and a sphere of a millimetre.
fn planet() -> (Scene, DVec3) {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let radius = 6.4e6;
    scene.spheres.push(Sphere::new(DVec3::ZERO, radius, material));
    let site = DVec3::new(0.6, 0.8, 0.0) * radius;
    scene.spheres.push(Sphere::new(site + DVec3::new(0.002, 0.003, 0.001), 5e-4, material));
    let mesh = scene.add_mesh(ball(3));
    let transform = DAffine3::from_translation(site) * DAffine3::from_scale(DVec3::splat(1e-3));
    scene.instances.push(Instance::new(mesh, transform, material));
    (scene, site)
}

#[test]
fn all_agree_on_a_millimetre_beside_a_planet() {
    let (scene, site) = planet();
    let mut r = Random(8);
    let rays: Vec<Ray> = (0..20_000)
        .map(|_| {
            let origin = site + r.cube(0.01);
            Ray::new(origin, site + r.cube(0.002) - origin)
        })
        .collect();
    all_agree("planet, near", &scene, &rays, BUDGET);
    let met = closest(&Bvh::build(&scene, Precision::Certified), &rays);
    let small = met.iter().flatten().filter(|h| h.id != PrimitiveId::sphere(0)).count();
    assert!(small > 2000, "the millimetre is seen: {small}");
    all_agree("planet, at its triangles", &scene, &at_triangles(&scene, 5, 1200), BUDGET);
}

#[test]
fn all_agree_on_rays_from_so_far_that_f32_is_lost() {
    let scene = random_scene(4, DVec3::ZERO, 1.0);
    let mut r = Random(5);
    let rays: Vec<Ray> = (0..4000)
        .map(|i| {
            let origin = r.cube(1.0).normalize() * [1e5, 1e9, 1e12][i % 3];
            Ray::new(origin, r.cube(1.0) - origin)
        })
        .collect();
    let hits = all_agree("far rays", &scene, &rays, BUDGET);
    assert!(hits > 100, "{hits}");
}

#[test]
fn all_agree_on_directions_of_any_length() {
    // Of any that leaves t representable.
    let scene = random_scene(5, DVec3::ZERO, 1.0);
    let mut r = Random(6);
    let rays: Vec<Ray> = random_rays(9, DVec3::ZERO, 1.0, 6000)
        .into_iter()
        .map(|ray| Ray::new(ray.origin, ray.direction * r.range(-1015.0, 990.0).exp2()))
        .collect();
    let hits = all_agree("lengths", &scene, &rays, BUDGET);
    assert!(hits > 1000, "{hits}");
}

#[test]
fn all_agree_on_directions_so_short_or_long_that_reciprocals_or_t_overflow() {
    let scene = random_scene(5, DVec3::ZERO, 1.0);
    let mut r = Random(7);
    let rays: Vec<Ray> = random_rays(9, DVec3::ZERO, 1.0, 900)
        .into_iter()
        .enumerate()
        .map(|(i, ray)| {
            let (low, high) = [(-1060.0, -1010.0), (990.0, 1015.0)][i % 2];
            Ray::new(ray.origin, ray.direction * r.range(low, high).exp2())
        })
        .filter(|ray| ray.direction != DVec3::ZERO)
        .collect();
    let hits = all_agree("extreme lengths", &scene, &rays, BUDGET);
    assert!(hits > 300, "{hits}");
}

#[test]
fn all_agree_on_a_touching_sphere_that_a_ray_enters_from_just_outside() {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, material));
    // So far out that what counts as rounding, 7e-10, is much to a ball of radius 1.
    let contact = DVec3::X * 1e5;
    scene.spheres.push(Sphere::new(contact + DVec3::Y, 1.0, material));
    let from = Some(Departure { id: PrimitiveId::plane(0), side: Side::Front });
    let rays = [3e-11, 1e-10, 5e-10].map(|below| Ray {
        departure: from,
        ..Ray::new(contact - DVec3::Y * below, DVec3::new(0.01, 1.0, 0.0))
    });
    assert_eq!(all_agree("touching", &scene, &rays, BUDGET), rays.len());
    let met = closest(&Bvh::build(&scene, Precision::Certified), &rays);
    assert!(met.iter().flatten().all(|hit| hit.t > 1.9), "{met:?}");
}

/// Two balls whose mesh has vertices of 1e20, shrunk to the size of 1.
fn outsized() -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let mut mesh = ball(1);
    mesh.positions = mesh.positions.map(|_, p| p * 1e20);
    let mesh = scene.add_mesh(mesh);
    for place in [DVec3::ZERO, DVec3::X * 3.0] {
        let transform =
            DAffine3::from_translation(place) * DAffine3::from_scale(DVec3::splat(1e-20));
        scene.instances.push(Instance::new(mesh, transform, material));
    }
    scene
}

#[test]
fn all_agree_on_instances_whose_own_space_is_beyond_what_embree_takes() {
    let scene = outsized();
    let hits = all_agree("outsized", &scene, &at_triangles(&scene, 4, 3000), BUDGET);
    assert!(hits > 1000, "{hits}");
}

#[test]
#[cfg(feature = "embree")]
fn fast_sees_instances_whose_own_space_is_beyond_what_embree_takes() {
    let scene = outsized();
    let embree = envers::Embree::build(&scene, Precision::Fast, 0).unwrap();
    let rays = [0.0, 3.0].map(|x| Ray::new(DVec3::new(x + 0.1, 0.2, 5.0), DVec3::NEG_Z));
    let instances = closest(&embree, &rays).into_iter().map(|hit| hit.map(|h| h.id.instance));
    assert_eq!(instances.collect::<Vec<_>>(), [Some(0), Some(1)]);
}

#[test]
fn pixel_aligned_grid_is_crossed_once_by_every_ray() {
    // A level field of squares with corners at whole numbers, seen from above at whole and half
    // numbers: every ray goes through a vertex, an edge or a diagonal.
    let side = 40u32;
    let mut mesh = Mesh::default();
    let row = |z: u32| (0..=side).map(move |x| [x as f32, 0.0, z as f32]);
    mesh.positions = (0..=side).flat_map(row).collect();
    let at = |x: u32, z: u32| z * (side + 1) + x;
    for z in 0..side {
        for x in 0..side {
            let [a, b, c, d] = [at(x, z), at(x + 1, z), at(x + 1, z + 1), at(x, z + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let mesh = scene.add_mesh(mesh);
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
    let rays: Vec<Ray> = (0..4 * side * side)
        .map(|i| (i % (2 * side), i / (2 * side)))
        .filter(|&(x, z)| x > 0 && z > 0)
        .map(|(x, z)| DVec3::new(f64::from(x) / 2.0, 3.0, f64::from(z) / 2.0))
        .map(|origin| Ray::new(origin, DVec3::NEG_Y))
        .collect();
    assert_eq!(all_agree("grid", &scene, &rays, BUDGET), rays.len(), "holes in the grid");
    let brute = BruteForce::new(&scene, Precision::Certified);
    for ray in &rays {
        assert_eq!(brute.all_hits(ray).count(), 1, "{ray:?}");
    }
}

fn demo_scenes() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes");
    let folders = [root.clone(), root.join("tutorial")];
    let mut found: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    found.sort();
    assert!(found.len() >= 5, "{found:?}");
    found
}

/// The primary rays of a scene's first camera, on a film of `width` columns.
fn primary(scene: &Scene, width: u32) -> Vec<Ray> {
    let [w, h] = scene.film.size;
    let size = [width, (width * h / w).max(1)];
    let maker = scene.cameras[0].ray_generator(size);
    (0..size[1])
        .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
        .map(|(x, y)| maker.ray(f64::from(x) + 0.5, f64::from(y) + 0.5))
        .collect()
}

#[test]
fn all_agree_on_the_demo_scenes() {
    for path in demo_scenes() {
        let scene = envers::load(&path).unwrap().scene;
        let what = path.display().to_string();
        all_agree(&what, &scene, &primary(&scene, 200), BUDGET);
        if scene.triangle_count() > 0 {
            all_agree(&what, &scene, &at_triangles(&scene, 2, 6000), BUDGET);
        }
        if !scene.spheres.is_empty() {
            all_agree(&what, &scene, &at_spheres(&scene, 2, 2000), BUDGET);
        }
    }
}

/// The OBJ files of the corpus's meshes that load and have triangles.
fn corpus_meshes(corpus: &Path) -> Vec<PathBuf> {
    let mut folders = vec![corpus.join("meshes")];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "obj")
                && envers::load(&path).is_ok_and(|scene| scene.scene.triangle_count() > 0)
            {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(found.len() >= 10, "{found:?}");
    found
}

#[test]
fn all_agree_on_the_corpus_meshes() {
    let Some(corpus) = std::env::var_os("ENVERS_CORPUS") else { return };
    for path in corpus_meshes(Path::new(&corpus)) {
        let scene = envers::load(&path).unwrap().scene;
        let what = path.display().to_string();
        all_agree(&what, &scene, &primary(&scene, 120), BUDGET / 8);
        all_agree(&what, &scene, &at_triangles(&scene, 3, 3000), BUDGET / 8);
    }
}

/// The picture of a scene's first camera on a film of `width` columns, by the default backend in
/// precision `certified` and by the oracle.
#[cfg(feature = "measure")]
fn equals_the_oracles(what: &str, scene: &Scene, width: u32) {
    use envers::Backend;
    use envers::RenderOptions;
    use envers::Renderer;
    use envers::View;
    use envers::measure::oracle::Oracle;
    let mut scene = scene.clone();
    let [w, h] = scene.film.size;
    scene.film.size = [width, (width * h / w).max(1)];
    scene.film.spp = 1;
    scene.film.max_depth = 16;
    let certified = Backend::default().build(&scene, Precision::Certified, 0).unwrap();
    let oracle = Oracle::new(&scene);
    for view in [View::Id, View::Depth, View::Beauty] {
        let options = RenderOptions { view, ..RenderOptions::default() };
        let film = |by: &dyn Intersector| {
            let film = Renderer::new(&scene).options(options.clone()).render_with(by).film;
            film.pixels.iter().flatten().map(|x| x.to_bits()).collect::<Vec<u32>>()
        };
        let (found, expected) = (film(&*certified), film(&oracle));
        let differing = found.iter().zip(&expected).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "{what}, {view:?}: values of {}", expected.len());
    }
}

#[test]
#[cfg(feature = "measure")]
fn pictures_of_the_demo_scenes_equal_the_oracles_to_the_bit() {
    for path in demo_scenes() {
        equals_the_oracles(&path.display().to_string(), &envers::load(&path).unwrap().scene, 120);
    }
}

#[test]
#[cfg(feature = "measure")]
fn pictures_of_the_corpus_meshes_equal_the_oracles_to_the_bit() {
    let Some(corpus) = std::env::var_os("ENVERS_CORPUS") else { return };
    for path in corpus_meshes(Path::new(&corpus)) {
        equals_the_oracles(&path.display().to_string(), &envers::load(&path).unwrap().scene, 60);
    }
}
