//! Animation: the eclipses of the tutorial's VI.4, and frames that share what was built.

use std::path::Path;

use envers::internals::{BuildStats, IntersectorBuilder};
use envers::scene::animation::{
    Anchor, Animated, Animation, Curve, Interpolation, Keyframes, Motion, Node, Orbit,
};
use envers::{
    Backend, Bounds, Camera, Coherence, Instance, Intersector, Light, LightKind, MaterialId, Mesh,
    Precision, Projection, Ray, RenderOptions, Renderer, Scene, Sphere,
};
use glam::{DAffine3, DVec3};

/// The spheres of the tutorial's scene.
const SUN: usize = 0;
const PLANET: usize = 1;
const MOON: usize = 2;

fn orbit() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/tutorial/6-4-orbit.toml");
    let mut scene = envers::load(&path).unwrap().scene;
    scene.film.size = [100, 50];
    scene.film.spp = 1;
    scene
}

/// Every frame of an animated scene, as a scene of its own.
fn frames(scene: &Scene) -> impl Iterator<Item = (u32, Scene)> {
    let animation = scene.animation.as_ref().unwrap();
    (1..=animation.frames).map(|frame| (frame, scene.at_time(animation.time(frame)).unwrap()))
}

/// Returns the position of the light, from which the shadows fall.
fn light(scene: &Scene) -> DVec3 {
    let LightKind::Point { position, .. } = scene.lights[0].kind else { panic!("a point light") };
    position
}

/// Returns the overlap of the cones of two spheres, seen from the light: the sum of their angular
/// radii less the angle between their centres, in radians.
fn overlap(scene: &Scene, a: usize, b: usize) -> f64 {
    let seen = |s: &Sphere| {
        let to = s.center - light(scene);
        (to.normalize(), (s.radius / to.length()).asin())
    };
    let ((a, alpha), (b, beta)) = (seen(&scene.spheres[a]), seen(&scene.spheres[b]));
    alpha + beta - a.dot(b).clamp(-1.0, 1.0).acos()
}

/// Whether, by geometry, the shadow of `near` touches the surface of `far`.
fn eclipses(scene: &Scene, near: usize, far: usize) -> bool {
    let distance = |i: usize| (scene.spheres[i].center - light(scene)).length();
    let overlap = overlap(scene, near, far);
    // No frame is so close that rounding could decide it.
    assert!(overlap.abs() > 1e-6, "{overlap}");
    overlap > 0.0 && distance(near) < distance(far)
}

/// Points of sphere `of` that face the light: many all over it, and the one nearest to the shadow
/// of `by`, which is in the shadow if any is.
fn points(scene: &Scene, of: usize, by: usize) -> Vec<DVec3> {
    let (sphere, light) = (&scene.spheres[of], light(scene));
    let toward = |other: usize| (scene.spheres[other].center - light).normalize();
    let (axis, to_center) = (toward(of), sphere.center - light);
    // A little within the sphere's outline, towards the other one, and no farther than that is.
    let outline = (sphere.radius / to_center.length()).asin();
    let angle = axis.dot(toward(by)).clamp(-1.0, 1.0).acos();
    let across = (toward(by) - axis * axis.dot(toward(by))).normalize_or_zero();
    let turned = angle.min(outline * (1.0 - 1e-9));
    let direction = axis * turned.cos() + across * turned.sin();
    let along = to_center.dot(direction);
    let depth = (sphere.radius.powi(2) - to_center.length_squared() + along.powi(2)).max(0.0);
    let nearest = light + direction * (along - depth.sqrt());
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let spread = (0..2000).map(|i| {
        let z = 1.0 - (f64::from(i) + 0.5) / 1000.0;
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        let flat = (1.0 - z * z).sqrt();
        sphere.center + DVec3::new(flat * cos, flat * sin, z) * sphere.radius
    });
    let faces = |p: &DVec3| (light - *p).dot(*p - sphere.center) > 0.0;
    spread.filter(faces).chain([nearest]).collect()
}

/// True if anything stands between the light and a point of the sphere, a millionth above it.
fn is_shadowed(intersector: &dyn Intersector, scene: &Scene, of: usize, points: &[DVec3]) -> bool {
    let center = scene.spheres[of].center;
    let above = |p: &DVec3| center + (*p - center) * (1.0 + 1e-6);
    let rays: Vec<Ray> = points.iter().map(|p| Ray::segment(above(p), light(scene))).collect();
    let mut blocked = vec![false; rays.len()];
    intersector.occluded(&rays, Coherence::Coherent, &mut blocked);
    blocked.contains(&true)
}

/// Holds the frames of an eclipse, traced by every backend, to those computed by geometry.
fn assert_eclipses(near: usize, far: usize) -> Vec<u32> {
    let scene = orbit();
    let mut found = Vec::new();
    for (frame, scene) in frames(&scene) {
        let expected = eclipses(&scene, near, far);
        let points = points(&scene, far, near);
        for backend in [Backend::default(), Backend::Rust] {
            for precision in [Precision::Fast, Precision::Certified] {
                let intersector = backend.build(&scene, precision, 1).unwrap();
                let traced = is_shadowed(&*intersector, &scene, far, &points);
                assert_eq!(traced, expected, "frame {frame}, {}", intersector.name());
            }
        }
        if expected {
            found.push(frame);
        }
    }
    found
}

#[test]
fn the_moons_shadow_touches_the_planet_in_the_frames_that_geometry_says() {
    let frames = assert_eclipses(MOON, PLANET);
    assert!(frames.contains(&31) && frames.len() < 40, "{frames:?}");
}

#[test]
fn the_planets_shadow_touches_the_moon_in_the_frames_that_geometry_says() {
    let frames = assert_eclipses(PLANET, MOON);
    assert!([11, 51, 91].iter().all(|f| frames.contains(f)) && frames.len() < 60, "{frames:?}");
}

#[test]
fn the_picture_shows_a_shadow_of_the_moon_in_no_other_frame() {
    let scene = orbit();
    let mut seen = Vec::new();
    for (frame, scene) in frames(&scene) {
        let mut without = scene.clone();
        without.spheres[MOON].casts_shadow = false;
        let [a, b] = [&scene, &without].map(|scene| {
            let options =
                RenderOptions { precision: Precision::Certified, ..RenderOptions::default() };
            Renderer::new(scene).options(options.clone()).render().unwrap().film
        });
        if a != b {
            assert!(eclipses(&scene, MOON, PLANET), "frame {frame}");
            seen.push(frame);
        }
    }
    assert!(seen.contains(&31), "{seen:?}");
}

#[test]
fn the_light_inside_the_sun_reaches_the_planet() {
    let scene = orbit();
    let mut dark = scene.clone();
    dark.spheres[SUN].casts_shadow = true;
    let lit = |scene: &Scene| {
        let points = points(scene, PLANET, MOON);
        let intersector = Backend::Rust.build(scene, Precision::Certified, 1).unwrap();
        !is_shadowed(&*intersector, scene, PLANET, &points)
    };
    assert_eq!([&scene, &dark].map(|s| lit(&s.at_time(0.0).unwrap())), [true, false]);
}

#[test]
fn the_loop_ends_where_it_began() {
    let scene = orbit();
    let seconds = scene.animation.as_ref().unwrap().duration();
    let [first, after] = [0.0, seconds].map(|time| scene.at_time(time).unwrap());
    for (a, b) in first.spheres.iter().zip(&after.spheres) {
        assert!((a.center - b.center).length() < 1e-12, "{} {}", a.center, b.center);
    }
}

/// A bumpy floor that stands still, twice a wheel that moves, a sphere on an orbit.
fn workshop() -> Scene {
    let mut scene = Scene::default();
    scene.film.size = [48, 32];
    let material = scene.add_material(Default::default());
    let floor = scene.add_mesh(grid(12));
    let wheel = scene.add_mesh(grid(3));
    let below = DAffine3::from_translation(DVec3::new(0.0, -1.0, 0.0));
    scene.instances.push(Instance::new(floor, below, material));
    for x in [-1.0, 1.0] {
        let beside = DAffine3::from_translation(DVec3::X * x);
        scene.instances.push(Instance::new(wheel, beside, material));
    }
    scene.spheres.push(Sphere::new(DVec3::new(2.0, 0.0, 0.0), 0.4, MaterialId(0)));
    scene.lights.push(Light::new(LightKind::Directional {
        direction: DVec3::new(-0.3, -1.0, -0.2).normalize(),
        angle: 0.0,
    }));
    let eye = DVec3::new(0.5, 2.0, 6.0);
    scene.cameras.push(Camera::look_at(eye, DVec3::ZERO, DVec3::Y, Projection::FovY(0.8)).unwrap());
    let mut animation = Animation::new(6, 24.0);
    let mut keys = Keyframes::identity();
    keys.translation = Curve {
        times: vec![0.0, 0.25],
        values: vec![DVec3::new(-1.0, 0.0, 0.0), DVec3::new(-1.3, 0.7, 0.4)],
        interpolation: Interpolation::Linear,
    };
    let place = DAffine3::IDENTITY;
    let node =
        animation.add_node(Node { parent: None, base: place, motion: Motion::Keyframes(keys) });
    let transform = DAffine3::IDENTITY;
    animation.objects.push(Animated::Instance { instance: 1, node, transform });
    let round = Orbit {
        around: Anchor::fixed(DVec3::ZERO),
        center: DVec3::ZERO,
        start: scene.spheres[0].center,
        axis: DVec3::Y,
        period: 0.25,
        turns_with_orbit: false,
    };
    let node = animation.add_node(Node { parent: None, base: place, motion: Motion::Orbit(round) });
    let (center, radius) = (scene.spheres[0].center, None);
    animation.objects.push(Animated::Sphere { sphere: 0, node: Some(node), center, radius });
    scene.animation = Some(animation);
    scene
}

/// A square of bumps, two triangles each cell, from −2 to 2.
fn grid(n: u32) -> Mesh {
    let at = |i: u32| 4.0 * i as f32 / n as f32 - 2.0;
    let row = n + 1;
    let point = |i: u32| {
        let (x, z) = (at(i % row), at(i / row));
        [x * 0.5, (x * 5.0).sin() * (z * 4.0).cos() * 0.2, z * 0.5]
    };
    let cell = |i: u32| {
        let corner = i / n * row + i % n;
        [[corner, corner + row, corner + 1], [corner + 1, corner + row, corner + row + 1]]
    };
    Mesh {
        positions: (0..row * row).map(point).collect(),
        triangles: (0..n * n).flat_map(cell).collect(),
        ..Mesh::default()
    }
}

fn backends() -> Vec<(Backend, Precision)> {
    let precisions = [Precision::Fast, Precision::Certified];
    let mut all: Vec<_> = precisions.map(|p| (Backend::Rust, p)).into();
    if Backend::default() != Backend::Rust {
        all.extend(precisions.map(|p| (Backend::default(), p)));
    }
    all
}

/// The films of all frames, and what was built for them.
fn rendered(
    scene: &Scene,
    times: &[f64],
    options: &RenderOptions,
) -> (Vec<Vec<[f32; 3]>>, BuildStats) {
    let (mut films, mut built) = (Vec::new(), BuildStats::default());
    Renderer::new(scene)
        .options(options.clone())
        .render_frames(times, |_, frame| {
            built += frame.statistics.built;
            films.push(frame.film.pixels);
            Ok(())
        })
        .unwrap();
    (films, built)
}

fn times(scene: &Scene) -> Vec<f64> {
    let animation = scene.animation.as_ref().unwrap();
    (1..=animation.frames).map(|frame| animation.time(frame)).collect()
}

#[test]
fn each_mesh_is_built_once_for_all_frames() {
    let scene = workshop();
    for (backend, precision) in backends() {
        let options =
            RenderOptions { backend: Some(backend), precision, ..RenderOptions::default() };
        let (_, built) = rendered(&scene, &times(&scene), &options);
        assert_eq!((built.meshes_built, built.meshes_reused), (2, 10), "{backend:?} {precision:?}");
    }
}

#[test]
fn nothing_is_built_again_where_only_the_camera_moves() {
    let mut scene = workshop();
    let animation = scene.animation.as_mut().unwrap();
    animation.objects = vec![Animated::Camera {
        camera: 0,
        node: Some(envers::scene::animation::NodeId(1)),
        rest: scene.cameras[0].clone(),
        aim: None,
        lens: None,
    }];
    for (backend, precision) in backends() {
        let options =
            RenderOptions { backend: Some(backend), precision, ..RenderOptions::default() };
        let (films, built) = rendered(&scene, &times(&scene), &options);
        assert_eq!((built.meshes_built, built.meshes_reused), (2, 10), "{backend:?} {precision:?}");
        assert_eq!((built.tlas_built, built.tlas_updated), (1, 5), "{backend:?} {precision:?}");
        assert_ne!(films[0], films[1]);
    }
}

/// The counts of what was placed, in the first frame and again.
fn tlas_counts(built: BuildStats) -> [u64; 5] {
    [
        built.tlas_built,
        built.tlas_updated,
        built.instances_built,
        built.instances_moved,
        built.spheres_moved,
    ]
}

#[test]
#[cfg(feature = "embree")]
fn embree_places_again_only_what_moved() {
    let scene = workshop();
    for precision in [Precision::Fast, Precision::Certified] {
        let options =
            RenderOptions { backend: Some(Backend::Embree), precision, ..RenderOptions::default() };
        let (_, built) = rendered(&scene, &times(&scene), &options);
        assert_eq!(tlas_counts(built), [1, 5, 3, 5, 5], "{precision:?}");
    }
}

#[test]
fn nothing_is_placed_again_where_nothing_moved() {
    let scene = workshop();
    for (backend, precision) in backends() {
        let options =
            RenderOptions { backend: Some(backend), precision, ..RenderOptions::default() };
        let (_, built) = rendered(&scene, &[0.1; 4], &options);
        assert_eq!(tlas_counts(built), [1, 3, 3, 0, 0], "{backend:?} {precision:?}");
    }
}

/// Asserts that certified frames are those that stand alone; says how often the level above the
/// meshes was built.
#[track_caller]
fn assert_alone(scene: &Scene) -> Vec<u64> {
    let mut tops = Vec::new();
    for (backend, precision) in backends() {
        if precision != Precision::Certified {
            continue;
        }
        let options =
            RenderOptions { backend: Some(backend), precision, ..RenderOptions::default() };
        let (films, built) = rendered(scene, &times(scene), &options);
        for (film, time) in films.iter().zip(times(scene)) {
            let alone = Renderer::new(&scene.at_time(time).unwrap())
                .options(options.clone())
                .render()
                .unwrap();
            assert!(*film == alone.film.pixels, "{backend:?} at {time}");
        }
        tops.push(built.tlas_built);
    }
    tops
}

#[test]
fn a_frame_that_shares_meshes_is_the_frame_that_stands_alone() {
    assert_alone(&workshop());
}

#[test]
fn a_scene_that_grows_is_placed_anew() {
    let mut scene = workshop();
    let movers = &mut scene.animation.as_mut().unwrap().objects;
    let Animated::Sphere { radius, .. } = &mut movers[1] else { panic!("the sphere") };
    let (times, values) = (vec![0.0, 0.2], vec![0.4, 40.0]);
    *radius = Some(Curve { times, values, interpolation: Interpolation::Linear });
    assert!(assert_alone(&scene).iter().all(|&tops| tops > 1));
}

#[test]
fn what_is_flat_for_a_while_comes_back() {
    let mut scene = workshop();
    let animation = scene.animation.as_mut().unwrap();
    let Motion::Keyframes(keys) = &mut animation.nodes[0].motion else { panic!("keys") };
    keys.scale = Curve {
        times: vec![0.0, 2.0 / 24.0, 4.0 / 24.0],
        values: vec![DVec3::ONE, DVec3::ZERO, DVec3::ONE],
        interpolation: Interpolation::Linear,
    };
    let counts: Vec<usize> = frames(&scene).map(|(_, scene)| scene.instances.len()).collect();
    assert_eq!(counts, [3, 3, 2, 3, 3, 3]);
    assert_alone(&scene);
}

#[test]
fn a_scene_that_is_still_traced_is_left_as_it_is() {
    let scene = workshop();
    let [first, second] = [0.0, 0.1].map(|time| scene.at_time(time).unwrap());
    let ray = |scene: &Scene| {
        let ball = scene.spheres[0].center;
        [Ray::new(ball + DVec3::Y * 5.0, DVec3::NEG_Y)]
    };
    for (backend, precision) in backends() {
        let mut builder = IntersectorBuilder::for_frames(backend, precision, 1, Bounds::EMPTY);
        let [one, two] = [&first, &second].map(|scene| builder.build(scene).unwrap());
        for (intersector, scene) in [(one, &first), (two, &second)] {
            let mut hits = [None];
            intersector.closest(&ray(scene), Coherence::Coherent, &mut hits);
            assert!(hits[0].is_some_and(|hit| (hit.t - 4.6).abs() < 1e-6), "{hits:?}");
        }
    }
}

#[test]
fn a_frame_is_the_same_bytes_whichever_frames_come_before_it() {
    let scene = workshop();
    for (backend, precision) in backends() {
        let options =
            RenderOptions { backend: Some(backend), precision, ..RenderOptions::default() };
        let (all, _) = rendered(&scene, &times(&scene), &options);
        let (last, _) = rendered(&scene, &times(&scene)[5..], &options);
        assert!(all[5] == last[0], "{backend:?} {precision:?}");
    }
}

#[test]
fn the_backends_agree_on_every_frame_to_the_bit() {
    let scene = workshop();
    let films = |backend| {
        let options = RenderOptions {
            backend: Some(backend),
            precision: Precision::Certified,
            ..RenderOptions::default()
        };
        rendered(&scene, &times(&scene), &options).0
    };
    assert!(films(Backend::default()) == films(Backend::Rust));
}

#[test]
fn a_mesh_in_the_place_of_another_is_not_taken_for_it() {
    let mut scene = workshop().at_time(0.0).unwrap();
    scene.instances.truncate(1);
    let ray = [Ray::new(DVec3::new(0.1, 5.0, 0.1), DVec3::NEG_Y)];
    for (backend, precision) in backends() {
        let mut builder = IntersectorBuilder::for_frames(backend, precision, 1, Bounds::EMPTY);
        let mut hit = |scene: &Scene| {
            let mut hits = [None];
            builder.build(scene).unwrap().closest(&ray, Coherence::Coherent, &mut hits);
            hits[0].unwrap().t
        };
        let before = hit(&scene);
        let old = scene.meshes[0].clone();
        let mesh = std::sync::Arc::make_mut(&mut scene.meshes[0]);
        mesh.positions = mesh.positions.map(|_, p| p - DVec3::Y);
        let after = hit(&scene);
        assert!((after - before - 1.0).abs() < 1e-3, "{backend:?} {precision:?}");
        scene.meshes[0] = old;
    }
}

#[test]
fn a_frame_that_cannot_be_written_ends_the_rendering() {
    let scene = workshop();
    let mut count = 0;
    let result = Renderer::new(&scene).render_frames(&times(&scene), |_, _| {
        count += 1;
        Err(envers::Error::failed("the disk is full"))
    });
    assert!(result.is_err() && count == 1);
}
