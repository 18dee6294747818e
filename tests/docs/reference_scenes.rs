//! The reference scenes of the benches are what their descriptions say.

use envers::{Loaded, Mesh, load};
use glam::DVec3;
use xtask::reference::{knot, spheres};

/// The scene of a file made by the generator, which is written into a folder for it.
fn loaded(name: &str, files: &[(&str, Vec<u8>)]) -> Loaded {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).expect("the folder takes files");
    }
    load(folder.path().join(name)).expect(name)
}

fn s() -> Loaded {
    loaded("s.toml", &[("s.toml", spheres::toml().into_bytes())])
}

/// M with a knot of about `triangles`.
fn m(triangles: usize) -> Loaded {
    let model = knot::glb(&knot::mesh(knot::resolution(triangles)));
    loaded("m.toml", &[("m.toml", knot::TOML.as_bytes().to_vec()), ("m.glb", model)])
}

#[test]
fn s_has_the_tutorials_sphere_and_500_others_within_their_ranges() {
    let scene = s().scene;
    let (first, others) = scene.spheres.split_first().expect("S has spheres");
    assert_eq!((first.center, first.radius), (DVec3::new(0.0, 0.0, 10.0), 1.0));
    assert_eq!(others.len(), 500);
    for sphere in others {
        let DVec3 { x, y, z } = sphere.center;
        assert!(x.abs() <= 8.0 && y.abs() <= 4.0 && (6.0..=30.0).contains(&z), "{sphere:?}");
        assert!((0.1..=0.6).contains(&sphere.radius), "{sphere:?}");
    }
}

/// The last sphere, as a program in another language computes it: no platform and no change makes
/// another scene unseen.
#[test]
fn s_is_the_same_one_everywhere() {
    let last = spheres::balls(spheres::COUNT, 1.0)[spheres::COUNT];
    let center = DVec3::new(0.4649590723961605, -1.0197771029673977, 29.119476775517228);
    assert_eq!((last.center, last.radius), (center, 0.5419775846735838));
}

#[test]
fn s_spreads_over_the_ranges() {
    let scene = s().scene;
    let others = &scene.spheres[1..];
    let span = |of: fn(DVec3) -> f64| {
        let values = others.iter().map(|s| of(s.center));
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    };
    assert!(span(|c| c.x) > 15.5 && span(|c| c.y) > 7.8 && span(|c| c.z) > 23.5);
}

/// The knot of M.
fn knot_mesh() -> Mesh {
    let knot::Mesh { positions, triangles } = knot::mesh(knot::resolution(knot::TRIANGLES));
    Mesh { name: "knot".into(), positions: positions.into(), triangles, ..Mesh::default() }
}

#[test]
fn m_has_a_million_triangles() {
    assert_eq!(knot_mesh().triangles.len(), 1_000_000);
}

#[test]
fn other_sizes_of_m_are_about_what_was_asked_for() {
    for asked in [18, 100, 1_000, 30_000, 4_000_000, 10_000_000] {
        let [rings, sides] = knot::resolution(asked).map(f64::from);
        let share = 2.0 * rings * sides / asked as f64;
        assert!((share - 1.0).abs() < 0.05, "{asked}: {rings} rings of {sides}");
    }
}

#[test]
fn the_knot_is_closed_and_winds_outward() {
    let mesh = knot_mesh();
    assert_eq!(mesh.open_edges(), 0);
    assert!(mesh.volume() > 0.0, "{}", mesh.volume());
}

#[test]
fn no_triangle_of_the_knot_is_degenerate() {
    let mesh = knot_mesh();
    for i in 0..mesh.triangles.len() as u32 {
        let [a, b, c] = mesh.triangle_vertices(i);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let height = (b - a).cross(c - a).length() / longest;
        assert!(height > 1e-4, "triangle {i} is {longest} long and {height} high");
    }
}

#[test]
fn the_knot_stands_above_the_ground_and_beside_the_spheres() {
    let scene = m(30_000).scene;
    let instance = &scene.instances[0];
    for p in scene.meshes[0].positions.iter() {
        let p = instance.to_world(p);
        assert!(p.y > 0.0, "{p}");
        for sphere in &scene.spheres {
            assert!(p.distance(sphere.center) > sphere.radius, "{p} is in {sphere:?}");
        }
    }
}

#[test]
fn m_has_a_mirror_a_glass_sphere_a_ground_and_one_light() {
    let scene = m(1_000).scene;
    let of = |i: usize| &scene.materials[scene.spheres[i].material.0 as usize];
    assert_eq!(scene.spheres.len(), 2);
    assert!(of(0).reflect.min_element() > 0.5 && of(1).transmit.min_element() > 0.5);
    assert_eq!((scene.planes.len(), scene.lights.len()), (1, 1));
}

#[test]
fn neither_warns() {
    assert_eq!(s().report.warnings, [""; 0]);
    assert_eq!(m(1_000).report.warnings, [""; 0]);
}
