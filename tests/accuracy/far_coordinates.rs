//! Models in surveyed coordinates: what stands millions of units from the origin is hit and seen as it
//! is at the origin.

use std::fmt::Write;

use envers::{
    Backend, BruteForce, Bvh, Coherence, Hit, Intersector, Precision, Ray, Renderer, Scene, View,
};
use envers_testing::Folder;
use glam::DVec3;

/// UTM coordinates in millimetres.
const UTM: [i64; 3] = [388_096_123, 5_412_345_750, 12_500];
/// Geocentric coordinates in millimetres.
const ECEF: [i64; 3] = [4_156_789_123, 671_234_567, 4_774_321_987];

/// Loads an OBJ file with vertices in millimetres and triangles of three vertices each, written in
/// metres.
fn obj(millimetres: &[[i64; 3]], offset: [i64; 3], triangles: &[[u32; 3]]) -> Scene {
    let mut text = String::new();
    for vertex in millimetres {
        text.push('v');
        for axis in 0..3 {
            let x = vertex[axis] + offset[axis];
            let sign = if x < 0 { "-" } else { "" };
            write!(text, " {sign}{}.{:03}", x.abs() / 1000, x.abs() % 1000).unwrap();
        }
        text.push('\n');
    }
    for [a, b, c] in triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    let folder = Folder::new();
    let path = folder.write("model.obj", text);
    envers::load(&path).unwrap().scene
}

/// A toothed wheel of radius 1 m and thickness 0.2 m, whose teeth stand out by a millimetre.
fn wheel(offset: [i64; 3]) -> Scene {
    const STEPS: u32 = 90;
    let rim = |i: u32| {
        let radius = if i.is_multiple_of(2) { 1000.0 } else { 999.0 };
        let angle = f64::from(i) * std::f64::consts::TAU / f64::from(STEPS);
        [radius * angle.cos(), radius * angle.sin()].map(|x| x.round() as i64)
    };
    let mut vertices = vec![[0, 0, 100], [0, 0, -100]];
    for i in 0..STEPS {
        let [x, y] = rim(i);
        vertices.extend([[x, y, 100], [x, y, -100]]);
    }
    let mut triangles = Vec::new();
    for i in 0..STEPS {
        let [a, b] = [2 + 2 * i, 2 + 2 * ((i + 1) % STEPS)];
        triangles.extend([[0, a, b], [1, b + 1, a + 1], [a, a + 1, b + 1], [a, b + 1, b]]);
    }
    obj(&vertices, offset, &triangles)
}

fn intersectors(scene: &Scene) -> Vec<(String, Box<dyn Intersector + '_>)> {
    let mut found: Vec<(String, Box<dyn Intersector + '_>)> = Vec::new();
    for precision in [Precision::Certified, Precision::Fast] {
        found.push((format!("brute {precision:?}"), Box::new(BruteForce::new(scene, precision))));
        found.push((format!("rust {precision:?}"), Box::new(Bvh::build(scene, precision))));
        #[cfg(feature = "embree")]
        found.push((
            format!("embree {precision:?}"),
            Box::new(envers::Embree::build(scene, precision, 1).unwrap()),
        ));
    }
    found
}

fn closest(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    intersector.closest(rays, Coherence::Incoherent, &mut hits);
    hits
}

#[test]
fn a_ray_ten_centimetres_within_the_edge_of_a_surveyed_roof_hits_it() {
    // The edge is at y = 5412345.75, which f32 would round to 5412346.
    let corners = [[0, 0, 0], [4000, 0, 0], [4000, 10_000, 0], [0, 10_000, 0]];
    let scene = obj(&corners, UTM, &[[0, 1, 2], [0, 2, 3]]);
    let down = |y: f64| Ray::new(DVec3::new(388_098.0, y, 100.0), DVec3::NEG_Z);
    let rays = [down(5_412_345.85), down(5_412_345.65)];
    for (name, intersector) in intersectors(&scene) {
        let hits = closest(&*intersector, &rays).iter().map(|h| h.map(|h| h.t)).collect::<Vec<_>>();
        assert_eq!(hits, [Some(87.5), None], "{name}");
    }
}

#[cfg(feature = "measure")]
#[test]
fn certified_hits_of_surveyed_meshes_are_those_of_the_oracle() {
    let mut random = envers_testing::Random(7);
    for offset in [UTM, ECEF] {
        // Triangles of a few millimetres strewn over half a metre.
        let mut vertices = Vec::new();
        for _ in 0..200 {
            let middle = random.cube(250.0);
            vertices.extend([(); 3].map(|()| (middle + random.cube(40.0)).to_array()));
        }
        let vertices: Vec<[i64; 3]> =
            vertices.into_iter().map(|v| v.map(|x| x.round() as i64)).collect();
        let triangles: Vec<[u32; 3]> = (0..200).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let scene = obj(&vertices, offset, &triangles);
        // Rays at vertices, at edges and anywhere.
        let mut rays = Vec::new();
        for i in 0..scene.meshes[0].triangles.len() as u32 {
            let [a, b, c] = scene.meshes[0].triangle_vertices(i);
            for target in [a, (a + b) / 2.0, (a + b + c) / 3.0] {
                let origin = scene.bounds().center() + random.cube(2.0);
                rays.push(Ray::new(origin, target - origin));
            }
        }
        let expected = closest(&envers::measure::oracle::Oracle::new(&scene), &rays);
        assert!(expected.iter().flatten().count() > rays.len() / 2);
        for (name, intersector) in intersectors(&scene) {
            let found = closest(&*intersector, &rays);
            if name.contains("Certified") {
                let key = |hit: &Option<Hit>| hit.map(|hit| (hit.id, hit.t.to_bits()));
                let differing = found.iter().zip(&expected).position(|(a, b)| key(a) != key(b));
                assert_eq!(differing, None, "{name}");
            } else {
                // Only rays through vertices and edges may differ: of three one is aimed at a face.
                let id = |hit: Option<Hit>| hit.map(|hit| hit.id);
                let mut at_faces = (2..rays.len()).step_by(3);
                assert_eq!(at_faces.find(|&i| id(found[i]) != id(expected[i])), None, "{name}");
            }
        }
    }
}

#[test]
fn a_surveyed_model_has_the_silhouette_that_it_has_at_the_origin() {
    for (backend, precision) in [
        (Backend::default(), Precision::Fast),
        (Backend::default(), Precision::Certified),
        (Backend::Rust, Precision::Fast),
    ] {
        let pictures = [[0; 3], UTM, ECEF].map(|offset| {
            let mut scene = wheel(offset);
            scene.film.size = [200, 150];
            let faces = scene.triangle_count();
            let rendering = Renderer::new(&scene)
                .backend(backend)
                .precision(precision)
                .view(View::Id)
                .render()
                .unwrap();
            let [background, ..] = rendering.film.pixels[..] else { panic!("no pixels") };
            let seen = rendering.film.pixels.iter().map(|p| *p != background);
            (faces, seen.collect::<Vec<bool>>())
        });
        let [(faces, near), utm, ecef] = pictures;
        assert_eq!(faces, 360);
        assert!(near.iter().filter(|seen| **seen).count() > 5000);
        for (what, (count, seen)) in [("UTM", utm), ("ECEF", ecef)] {
            assert_eq!(count, faces, "{what}");
            let differing = near.iter().zip(&seen).filter(|(a, b)| a != b).count();
            assert_eq!(differing, 0, "{what}, {backend:?}, {precision:?}");
        }
    }
}
