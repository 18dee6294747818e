//! The camera of model files that bring none.

use glam::DVec3;

use super::extents::{box_extent, extents};
use super::surroundings;
use super::view_direction::{ViewDirection, view_direction};
use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::load::framing::Framing;
use crate::scene::animation::Animated;
use crate::scene::check::MAX_COORDINATE;
use crate::scene::{Camera, Projection, Scene};

/// Half the vertical field of view of the automatic camera, in radians: 35° in all, about that of a
/// portrait lens, which does not distort.
const HALF_FOV: f64 = 17.5 * std::f64::consts::PI / 180.0;
/// The share of the image, from its middle to its edge, that the model fills.
const FILL_RATIO: f64 = 0.88;
/// The least size of what is framed, as a share of how far it is from the origin: what is smaller is a
/// point in f64.
const MIN_SIZE: f64 = 1e-12;
/// The least size of the box around a point.
const POINT_SIZE: f64 = 1e-6;
/// The least distance of the model from the plane of the eye, as a share of its size: a tip that points at
/// the eye would reach it.
const CLEARANCE: f64 = 0.1;
/// Adds a camera that frames the scene, if it has none: a three-quarter view, as near as the whole
/// model fits, in the middle of the image. What encloses the model, as a sky does, is not framed if the
/// camera is within it. A camera of a given direction comes before the others of the scene.
///
/// # Errors
/// When the scene is so large that such a camera would stand beyond the coordinates that are supported.
pub fn add_camera(scene: &mut Scene, framing: &Framing) -> Result<()> {
    if !scene.cameras.is_empty() && !framing.has_direction() {
        return Ok(());
    }
    let within = surroundings::find(scene).and_then(|surroundings| {
        let camera = framing_camera(&surroundings.without(scene), framing)?;
        surroundings.have_within(scene, camera.position).then_some(camera)
    });
    let camera = within.or_else(|| framing_camera(scene, framing));
    // What is itself too large `Scene::check` refuses.
    let extent = scene.bounds_over_time().max_abs();
    let is_too_far = |c: &Camera| c.position.abs().max_element() > MAX_COORDINATE;
    if extent <= MAX_COORDINATE && camera.as_ref().is_some_and(is_too_far) {
        return Err(Error::input(format!(
            "the scene reaches out to {extent:e}: a camera that sees all of it would stand beyond the \
             {MAX_COORDINATE:e} supported; scale the scene down, or give it a camera of its own"
        )));
    }
    insert_first(scene, camera);
    Ok(())
}

/// Makes a camera the first of the scene.
fn insert_first(scene: &mut Scene, camera: Option<Camera>) {
    let Some(camera) = camera else { return };
    scene.cameras.insert(0, camera);
    // The animation knows the others by their indices.
    let animated = scene.animation.iter_mut().flat_map(|animation| &mut animation.objects);
    for object in animated {
        if let Animated::Camera { camera, .. } = object {
            *camera += 1;
        }
    }
}

/// Returns the camera that frames a scene; none if that is not finite.
fn framing_camera(scene: &Scene, framing: &Framing) -> Option<Camera> {
    // The box to be framed, which must have a size.
    let mut bounds = scene.bounds_over_time();
    if bounds.is_empty() {
        // Nothing finite to frame: look at the origin from a little above.
        bounds = Bounds { lower: DVec3::NEG_ONE, upper: DVec3::ONE };
    }
    let least = MIN_SIZE * bounds.max_abs();
    let is_point = bounds.diagonal() <= least;
    if is_point {
        bounds = bounds.padded(least.max(POINT_SIZE));
    }
    // The direction, which fails only where the scene is not finite; `Scene::check` says that then.
    let ViewDirection { direction, up } = view_direction(scene, bounds.size(), framing);
    let lens = Projection::FovY(2.0 * HALF_FOV);
    let mut camera = Camera::look_at(direction, DVec3::ZERO, up, lens).ok()?;
    if !bounds.max_abs().is_finite() {
        return None;
    }
    // The position, as near as all of the model is within the edges of the image.
    let [width, height] = scene.film.size.map(f64::from);
    let tangent = HALF_FOV.tan() * FILL_RATIO;
    let tangents = [tangent * width / height, tangent];
    let [a, b, c, d] = edge_normals(&camera, tangents);
    let directions = [a, b, c, d, -camera.forward];
    let [a, b, c, d, nearest] = if is_point {
        directions.map(|direction| box_extent(&bounds, direction))
    } else {
        extents(scene, &bounds, directions)
    };
    camera.position = framing_position([a, b, c, d], bounds.center(), &camera, tangents);
    // Farther back, where the model would reach the eye.
    let clearance = -nearest - camera.position.dot(camera.forward);
    let missing = CLEARANCE * bounds.diagonal() - clearance;
    if missing > 0.0 && missing.is_finite() {
        camera.position -= camera.forward * missing;
    }
    camera.name = "framing".to_owned();
    Some(camera)
}

/// Returns the normals, of any length, of the planes that the eye and the right, left, upper and lower
/// edge of the image span; `tangents` are those of half the angles to the side and up.
fn edge_normals(camera: &Camera, [side, up]: [f64; 2]) -> [DVec3; 4] {
    let edges = [(camera.right, side), (-camera.right, side), (camera.up, up), (-camera.up, up)];
    edges.map(|(axis, tangent)| axis - camera.forward * tangent)
}

/// Returns the position from which a camera sees all of a model that has these extents along the
/// normals of the image's edges, as near as that is.
///
/// With the camera's axes as x, y, and z into the image, all of the model is within the right edge
/// where px − s·pz ≤ cx − s·cz for each of its points p, the eye being c and s the tangent; and so for
/// the other edges. Only the greatest px − s·pz counts, the model's extent along the normal of the
/// edge's plane: the plane then touches the model.
fn framing_position(
    extents: [f64; 4],
    middle: DVec3,
    camera: &Camera,
    tangents: [f64; 2],
) -> DVec3 {
    let normals = edge_normals(camera, tangents);
    // From the middle, so that less is rounded.
    let [right, left, above, below] = std::array::from_fn(|i| extents[i] - middle.dot(normals[i]));
    let [side, up] = tangents;
    let depth = ((right + left) / side).max((above + below) / up) / 2.0;
    let [x, y] = [(right - left) / 2.0, (above - below) / 2.0];
    middle + camera.right * x + camera.up * y - camera.forward * depth
}

#[cfg(test)]
mod tests {
    use super::super::view_direction::{MIN_VISIBLE, VIEW_DIRECTION, visible_shares};
    use super::*;
    use crate::scene::{Instance, MaterialId, Mesh, Sphere};
    use glam::DAffine3;

    /// Returns the position of a point in the image, from −1 to 1 across it and upwards.
    fn project(camera: &Camera, size: [u32; 2], point: DVec3) -> [f64; 2] {
        let to = point - camera.position;
        let depth = to.dot(camera.forward);
        assert!(depth > 0.0, "{point} is behind the camera");
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let [x, y] = [camera.right, camera.up].map(|axis| to.dot(axis) / depth / HALF_FOV.tan());
        [x / aspect, y]
    }

    fn mesh(positions: &[[f64; 3]]) -> Scene {
        let triangles = (0..positions.len() as u32).map(|i| [i; 3]).collect();
        let mesh = Mesh { positions: positions.into(), triangles, ..Mesh::default() };
        let mut scene = Scene::default();
        let mesh = scene.add_mesh(mesh);
        let material = scene.add_material(Default::default());
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
        scene
    }

    const BOX: [[f64; 3]; 4] = [[0., 0., 0.], [3., 0., 0.], [0., 1., 0.], [0., 0., 2.]];

    /// Returns the greatest distance, to the side and up, of a model's corners from the middle.
    fn filled(scene: &mut Scene) -> [f64; 2] {
        add_camera(scene, &Framing::default()).unwrap();
        let camera = &scene.cameras[0];
        let placed = |p| scene.instances[0].to_world(p);
        let points = scene.meshes[0].positions.iter().map(placed);
        points
            .map(|p| project(camera, scene.film.size, p))
            .fold([0.0f64; 2], |most, at| std::array::from_fn(|k| most[k].max(at[k].abs())))
    }

    #[test]
    fn a_model_fills_the_image_one_way_and_stays_within_it_the_other() {
        for size in [[400, 300], [300, 900], [1000, 100]] {
            for transform in [
                DAffine3::IDENTITY,
                DAffine3::from_scale(DVec3::splat(1e-20)),
                DAffine3::from_scale(DVec3::splat(1e20)),
                DAffine3::from_translation(DVec3::new(1e4, -1e5, 3e4)),
            ] {
                let mut scene = mesh(&BOX);
                scene.film.size = size;
                scene.instances[0].transform = transform;
                let [x, y] = filled(&mut scene);
                assert!((x.max(y) - FILL_RATIO).abs() < 1e-6, "{size:?} {transform:?}: {x} {y}");
            }
        }
    }

    #[test]
    fn a_sphere_touches_the_margin() {
        let mut scene = Scene::default();
        scene.film.size = [400, 300];
        scene.spheres.push(Sphere::new(DVec3::new(5.0, -3.0, 2.0), 2.0, MaterialId(0)));
        add_camera(&mut scene, &Framing::default()).unwrap();
        let camera = &scene.cameras[0];
        let to = scene.spheres[0].center - camera.position;
        let half = (2.0 / to.length()).asin();
        assert!((half.tan() - HALF_FOV.tan() * FILL_RATIO).abs() < 1e-9);
        assert!(to.normalize().dot(camera.forward) > 1.0 - 1e-12);
    }

    #[test]
    fn what_moves_touches_the_margin_somewhere_on_its_way() {
        use crate::scene::animation::{Animated, Animation, Curve, Keyframes, Motion, Node};
        let mut scene = Scene::default();
        scene.film.size = [300, 300];
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
        // Away from the camera: the box of its way has corners far from all that is seen.
        let mut keys = Keyframes::identity();
        keys.translation =
            Curve::<DVec3>::smooth(vec![0.0, 1.0], vec![DVec3::ZERO, -VIEW_DIRECTION * 8.0]);
        let mut animation = Animation::new(24, 24.0);
        let motion = Motion::Keyframes(keys);
        let node = animation.add_node(Node { parent: None, base: DAffine3::IDENTITY, motion });
        let (center, radius) = (DVec3::ZERO, None);
        animation.objects.push(Animated::Sphere { sphere: 0, node: Some(node), center, radius });
        scene.animation = Some(animation);
        add_camera(&mut scene, &Framing::default()).unwrap();
        let to = -scene.cameras[0].position;
        let half = (1.0 / to.length()).asin();
        assert!((half.tan() - HALF_FOV.tan() * FILL_RATIO).abs() < 1e-9, "{half}");
    }

    #[test]
    fn flat_models_are_seen_from_their_broad_side() {
        for flat in [DVec3::X, DVec3::Y, DVec3::Z] {
            let corner = |p: &[f64; 3]| DVec3::from(*p) * (1.0 - flat);
            let mut scene = mesh(&BOX.map(|p| corner(&p).to_array()));
            add_camera(&mut scene, &Framing::default()).unwrap();
            assert!(scene.cameras[0].forward.dot(flat).abs() > 0.6, "{flat}");
        }
    }

    #[test]
    fn a_scene_too_large_to_be_framed_is_refused_by_its_own_size() {
        let mut scene = mesh(&BOX);
        scene.instances[0].transform = DAffine3::from_scale(DVec3::splat(3e14));
        let error = add_camera(&mut scene, &Framing::default()).unwrap_err().to_string();
        assert!(error.contains("the scene reaches out to 9e14"), "{error}");
        assert_eq!(scene.cameras, []);
    }

    #[test]
    fn a_line_and_a_point_are_framed_too() {
        let mut line = mesh(&[[0., 0., 0.], [0., 5., 0.]]);
        let [x, y] = filled(&mut line);
        assert!((x.max(y) - FILL_RATIO).abs() < 1e-6);
        let mut point = mesh(&[[1., 2., 3.]]);
        assert!(filled(&mut point).iter().all(|x| x.abs() < FILL_RATIO));
        let mut origin = mesh(&[[0., 0., 0.]]);
        assert!(filled(&mut origin).iter().all(|x| x.abs() < FILL_RATIO));
    }

    /// Returns the distance of the nearest corner from the plane of the eye, as a share of the model's size,
    /// and the share of its area that is seen.
    fn view_of(scene: &mut Scene) -> [f64; 2] {
        add_camera(scene, &Framing::default()).unwrap();
        let camera = &scene.cameras[0];
        let points = scene.meshes[0].positions.iter().map(|p| scene.instances[0].to_world(p));
        let depths = points.map(|p| (p - camera.position).dot(camera.forward));
        let nearest = depths.fold(f64::INFINITY, f64::min);
        [nearest / scene.bounds().diagonal(), visible_shares(scene, [camera.forward])[0]]
    }

    #[test]
    fn the_eye_keeps_clear_of_what_points_at_it() {
        // A tip that points at the eye, and one that does almost.
        let tip = VIEW_DIRECTION * 5.0;
        for (tip, side) in [
            (tip.to_array(), [0., 0.1, 0.]),
            ([5.0; 3], [0., 1., 0.]),
            (tip.to_array(), [0.3, 0., 0.]),
        ] {
            let mut scene = mesh(&[[0.; 3], tip, side]);
            scene.meshes =
                vec![Mesh { triangles: vec![[0, 1, 2]], ..Mesh::clone(&scene.meshes[0]) }.into()];
            let [nearest, shown] = view_of(&mut scene);
            assert!(nearest >= 0.099 && shown >= MIN_VISIBLE, "{tip:?}: {nearest} {shown}");
        }
    }

    #[test]
    fn what_stands_on_edge_or_points_away_is_seen_from_another_side() {
        let along = VIEW_DIRECTION.normalize();
        let across = along.any_orthonormal_vector();
        for width in [across, along.cross(across)] {
            let corners = [DVec3::ZERO, along * 9.0, along * 9.0 + width, width];
            let mut scene = mesh(&corners.map(|p| p.to_array()));
            let triangles = vec![[0, 1, 2], [0, 2, 3]];
            scene.meshes = vec![Mesh { triangles, ..Mesh::clone(&scene.meshes[0]) }.into()];
            let [_, shown] = view_of(&mut scene);
            assert!(shown > 0.2, "{shown}");
        }
    }

    /// A box around a point, of four squares, and two more if it has a floor and a top.
    fn walls(center: [f32; 3], half: f32, has_top: bool, has_floor: bool) -> Mesh {
        let corner = |i: usize| {
            let side = |k: usize| center[k] + if i >> k & 1 == 1 { half } else { -half };
            [side(0), side(1), side(2)]
        };
        let square = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        let mut triangles: Vec<[u32; 3]> = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
            .into_iter()
            .flat_map(square)
            .collect();
        if has_top {
            triangles.extend(square([2, 3, 7, 6]));
        }
        if has_floor {
            triangles.extend(square([0, 1, 5, 4]));
        }
        Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() }
    }

    /// Returns how far the camera of these meshes stands from the origin.
    fn distance(meshes: Vec<Mesh>) -> f64 {
        let mut scene = Scene::default();
        for mesh in meshes {
            let mesh = scene.add_mesh(mesh);
            scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
        }
        add_camera(&mut scene, &Framing::default()).unwrap();
        scene.cameras[0].position.length()
    }

    #[test]
    fn what_encloses_a_model_is_not_framed_if_the_camera_is_within_it() {
        let model = || walls([0.1, 0.0, 0.0], 1.0, true, true);
        let alone = distance(vec![model()]);
        let sky = |has_floor| walls([0.0; 3], 1000.0, true, has_floor);
        assert_eq!(distance(vec![sky(true), model()]), alone);
        assert_eq!(distance(vec![model(), sky(false)]), alone, "a dome needs no floor");
        // Six squares, each a mesh of its own, and a wide floor within.
        let sides = sky(true)
            .triangles
            .chunks(2)
            .map(|two| Mesh { triangles: two.to_vec(), ..sky(true) })
            .collect::<Vec<_>>();
        let mut all = vec![model()];
        all.extend(sides);
        assert_eq!(distance(all), alone);
        let floor = Mesh {
            positions: sky(true).positions.iter().map(|p| [p.x * 0.9, -1.0, p.z * 0.9]).collect(),
            triangles: vec![[0, 1, 5], [0, 5, 4]],
            ..Mesh::default()
        };
        assert_eq!(distance(vec![sky(true), floor, model()]), alone);
    }

    #[test]
    fn rooms_and_hills_are_framed_with_what_is_in_them() {
        let model = || walls([0.1, 0.0, 0.0], 1.0, true, true);
        let alone = distance(vec![model()]);
        // A room that the camera would stand outside of; walls without a roof; a plain.
        for around in [walls([0.0; 3], 3.0, true, true), walls([0.0; 3], 1000.0, false, true)] {
            assert!(distance(vec![around, model()]) > 1.5 * alone);
        }
    }

    #[test]
    fn a_scene_that_is_not_finite_gets_no_camera() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::INFINITY, 2.0, MaterialId(0)));
        add_camera(&mut scene, &Framing::default()).unwrap();
        assert_eq!(scene.cameras, []);
    }

    #[test]
    fn a_files_own_camera_is_kept() {
        let mut scene = mesh(&BOX);
        add_camera(&mut scene, &Framing::default()).unwrap();
        let camera = scene.cameras.clone();
        add_camera(&mut scene, &Framing::default()).unwrap();
        assert_eq!(camera, scene.cameras);
    }
}
