//! The camera of model files that bring none.

use glam::DVec3;

use super::extents::{box_extent, extents};
use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::scene::check::MAX_COORDINATE;
use crate::scene::{Camera, Projection, Scene};

/// Half the vertical field of view of the automatic camera, in radians: 35° in all, about that of a
/// portrait lens, which does not distort.
const HALF_FOV: f64 = 17.5 * std::f64::consts::PI / 180.0;
/// The share of the image, from its middle to its edge, that the model fills.
const FILL_RATIO: f64 = 0.88;
/// The direction from the model to the camera: to the right, from above, and mostly from the front,
/// where +Z is the front and +Y is up, as in glTF.
const VIEW_DIRECTION: DVec3 = DVec3::new(0.55, 0.45, 1.0);
/// The least size of what is framed, as a share of how far it is from the origin: a single point
/// has none.
const MIN_SIZE: f64 = 1e-6;
/// The ratio of thickness to length below which a model counts as flat.
const FLATNESS: f64 = 0.02;

/// Adds a camera that frames the scene, if it has none: a three-quarter view, as near as the whole
/// model fits, in the middle of the image.
///
/// # Errors
/// When the scene is so large that such a camera would stand beyond the coordinates that are supported.
pub fn add_camera(scene: &mut Scene) -> Result<()> {
    if !scene.cameras.is_empty() {
        return Ok(());
    }
    // The box to be framed, which must have a size.
    let mut bounds = scene.bounds_over_time();
    if bounds.is_empty() {
        // Nothing finite to frame: look at the origin from a little above.
        bounds = Bounds { lower: DVec3::NEG_ONE, upper: DVec3::ONE };
    }
    let least = MIN_SIZE * bounds.max_abs();
    let is_point = bounds.diagonal() <= least;
    if is_point {
        bounds = bounds.padded(least.max(MIN_SIZE));
    }
    // The direction, which fails only where the scene is not finite; `Scene::check` says that then.
    let direction = view_direction(bounds.size());
    let lens = Projection::FovY(2.0 * HALF_FOV);
    let Ok(mut camera) = Camera::look_at(direction, DVec3::ZERO, DVec3::Y, lens) else {
        return Ok(());
    };
    let extent = bounds.max_abs();
    if !extent.is_finite() {
        return Ok(());
    }
    // The position, as near as all of the model is within the edges of the image.
    let [width, height] = scene.film.size.map(f64::from);
    let tangent = HALF_FOV.tan() * FILL_RATIO;
    let tangents = [tangent * width / height, tangent];
    let normals = edge_normals(&camera, tangents);
    let extents = if is_point {
        normals.map(|normal| box_extent(&bounds, normal))
    } else {
        extents(scene, &bounds, normals)
    };
    camera.position = framing_position(extents, bounds.center(), &camera, tangents);
    // What is itself too large `Scene::check` refuses.
    if extent <= MAX_COORDINATE && camera.position.abs().max_element() > MAX_COORDINATE {
        return Err(Error::input(format!(
            "the scene reaches out to {extent:e}: a camera that sees all of it would stand beyond the \
             {MAX_COORDINATE:e} supported; scale the scene down, or give it a camera of its own"
        )));
    }
    camera.name = "framing".to_owned();
    scene.cameras.push(camera);
    Ok(())
}

/// Returns the direction from a model of a size to the camera: flat models are seen from their broad
/// side.
fn view_direction(size: DVec3) -> DVec3 {
    let flat = size.cmplt(DVec3::splat(FLATNESS * size.max_element()));
    match [flat.x, flat.y, flat.z] {
        // A card that stands sideways.
        [true, false, false] => DVec3::new(VIEW_DIRECTION.z, VIEW_DIRECTION.y, VIEW_DIRECTION.x),
        // A floor.
        [false, true, false] => DVec3::new(VIEW_DIRECTION.x, VIEW_DIRECTION.z, VIEW_DIRECTION.z),
        _ => VIEW_DIRECTION,
    }
    .normalize()
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

    fn mesh(positions: &[[f32; 3]]) -> Scene {
        let triangles = (0..positions.len() as u32).map(|i| [i; 3]).collect();
        let mesh = Mesh { positions: positions.to_vec(), triangles, ..Mesh::default() };
        let mut scene = Scene::default();
        let mesh = scene.add_mesh(mesh);
        let material = scene.add_material(Default::default());
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
        scene
    }

    const BOX: [[f32; 3]; 4] = [[0., 0., 0.], [3., 0., 0.], [0., 1., 0.], [0., 0., 2.]];

    /// Returns the greatest distance, to the side and up, of a model's corners from the middle.
    fn filled(scene: &mut Scene) -> [f64; 2] {
        add_camera(scene).unwrap();
        let camera = &scene.cameras[0];
        let placed = |p: &[f32; 3]| scene.instances[0].to_world(*p);
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
        add_camera(&mut scene).unwrap();
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
        add_camera(&mut scene).unwrap();
        let to = -scene.cameras[0].position;
        let half = (1.0 / to.length()).asin();
        assert!((half.tan() - HALF_FOV.tan() * FILL_RATIO).abs() < 1e-9, "{half}");
    }

    #[test]
    fn flat_models_are_seen_from_their_broad_side() {
        for flat in [DVec3::X, DVec3::Y, DVec3::Z] {
            let corner = |p: &[f32; 3]| (DVec3::from(p.map(f64::from)) * (1.0 - flat)).as_vec3();
            let mut scene = mesh(&BOX.map(|p| corner(&p).to_array()));
            add_camera(&mut scene).unwrap();
            assert!(scene.cameras[0].forward.dot(flat).abs() > 0.6, "{flat}");
        }
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

    #[test]
    fn a_scene_too_large_to_be_framed_is_refused_by_its_own_size() {
        let mut scene = mesh(&BOX);
        scene.instances[0].transform = DAffine3::from_scale(DVec3::splat(3e14));
        let error = add_camera(&mut scene).unwrap_err().to_string();
        assert!(error.contains("the scene reaches out to 9e14"), "{error}");
        assert_eq!(scene.cameras, []);
    }

    #[test]
    fn a_scene_that_is_not_finite_gets_no_camera() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::INFINITY, 2.0, MaterialId(0)));
        add_camera(&mut scene).unwrap();
        assert_eq!(scene.cameras, []);
    }

    #[test]
    fn a_files_own_camera_is_kept() {
        let mut scene = mesh(&BOX);
        add_camera(&mut scene).unwrap();
        let camera = scene.cameras.clone();
        add_camera(&mut scene).unwrap();
        assert_eq!(camera, scene.cameras);
    }
}
