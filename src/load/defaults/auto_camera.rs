//! A camera for model files that bring none.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::Bounds;
use crate::scene::{Camera, GRAIN, Instance, Mesh, Projection, Scene, Sphere};

/// Half the vertical field of view of the framing camera, in radians: 35° in all, about that of a
/// portrait lens, which does not distort.
const HALF_FOV: f64 = 17.5 * std::f64::consts::PI / 180.0;
/// The share of the picture, from its middle to its edge, that the model fills.
const FILLED: f64 = 0.88;
/// From where the camera looks: to the right, from above, and mostly from the front, where +Z is
/// the front and +Y is up, as in glTF.
const VIEW: DVec3 = DVec3::new(0.55, 0.45, 1.0);
/// The least size of what is framed, as a share of how far it is from the origin: a single point
/// has none.
const LEAST: f64 = 1e-6;
/// A model is flat along an axis where it is this much thinner than it is long.
const FLAT: f64 = 0.02;

/// Gives a scene a camera that frames it, when it has none: a three-quarter view, as near as the
/// whole model fits, in the middle of the picture.
pub fn frame(scene: &mut Scene) {
    if !scene.cameras.is_empty() {
        return;
    }
    let bounds = match scene.bounds_over_time() {
        // Nothing finite to frame: look at the origin from a little above.
        b if b.is_empty() => Bounds { lower: DVec3::NEG_ONE, upper: DVec3::ONE },
        b => b,
    };
    let least = LEAST * bounds.max_abs();
    let is_point = bounds.diagonal() <= least;
    let bounds = if is_point { bounds.padded(least.max(LEAST)) } else { bounds };
    let view = direction(bounds.size());
    let lens = Projection::FovY(2.0 * HALF_FOV);
    // Fails only where the scene is not finite, which `Scene::check` then says.
    let Ok(mut camera) = Camera::look_at(view, DVec3::ZERO, DVec3::Y, lens) else { return };
    if !bounds.max_abs().is_finite() {
        return;
    }
    let [width, height] = scene.film.size.map(f64::from);
    let tangent = HALF_FOV.tan() * FILLED;
    let extents = |along: [DVec3; 4]| match is_point {
        true => along.map(|along| extent_of_box(&bounds, along)),
        false => extents(scene, &bounds, along),
    };
    camera.position = stand(extents, bounds.center(), &camera, [tangent * width / height, tangent]);
    camera.name = "framing".to_owned();
    scene.cameras.push(camera);
}

/// From where to look at a model of a size: what is flat, more from its broad side.
fn direction(size: DVec3) -> DVec3 {
    let flat = size.cmplt(DVec3::splat(FLAT * size.max_element()));
    match [flat.x, flat.y, flat.z] {
        // A card that stands sideways.
        [true, false, false] => DVec3::new(VIEW.z, VIEW.y, VIEW.x),
        // A floor.
        [false, true, false] => DVec3::new(VIEW.x, VIEW.z, VIEW.z),
        _ => VIEW,
    }
    .normalize()
}

/// Where a camera must stand to see all of what has this extent, with these tangents of half its angles to the
/// side and up.
///
/// An edge of the picture and the eye span a plane. With the camera's axes as x, y, and z into the
/// picture, all of the model is within the right edge where px − s·pz ≤ cx − s·cz for each of its
/// points p, the eye being c and s the tangent; and so for the other edges. The greatest px − s·pz
/// is all that counts of the model: the plane then touches it.
fn stand(
    extents: impl Fn([DVec3; 4]) -> [f64; 4],
    middle: DVec3,
    camera: &Camera,
    [side, up]: [f64; 2],
) -> DVec3 {
    let [right, top] = [camera.right, camera.up];
    let edges = [(right, side), (-right, side), (top, up), (-top, up)];
    let normals = edges.map(|(axis, tangent)| axis - camera.forward * tangent);
    let reached = extents(normals);
    // From the middle, so that less is rounded.
    let [right, left, above, below] = std::array::from_fn(|i| reached[i] - middle.dot(normals[i]));
    let depth = ((right + left) / side).max((above + below) / up) / 2.0;
    let [x, y] = [(right - left) / 2.0, (above - below) / 2.0];
    middle + camera.right * x + camera.up * y - camera.forward * depth
}

/// How far a scene reaches along some directions, which are of any length, wherever it moves; with
/// its box, where it has nothing else.
pub fn extents<const N: usize>(scene: &Scene, bounds: &Bounds, along: [DVec3; N]) -> [f64; N] {
    let mut most = [f64::NEG_INFINITY; N];
    match scene.animation {
        Some(_) => {
            scene.sample_over_time(|poses| most = greater(most, extents_now(poses.scene(), along)))
        }
        None => most = extents_now(scene, along),
    }
    match most.iter().all(|most| most.is_finite()) {
        true => most,
        false => along.map(|along| extent_of_box(bounds, along)),
    }
}

fn extents_now<const N: usize>(scene: &Scene, along: [DVec3; N]) -> [f64; N] {
    let sphere = |s: &Sphere| along.map(|a| s.center.dot(a) + s.radius * a.length());
    let meshes = scene.instances.iter().filter_map(|instance| {
        let mesh = scene.meshes.get(instance.mesh.0 as usize)?;
        Some(mesh_extents(mesh, instance, along))
    });
    scene.spheres.iter().map(sphere).chain(meshes).fold([f64::NEG_INFINITY; N], greater)
}

fn greater<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i].max(b[i]))
}

fn extent_of_box(bounds: &Bounds, along: DVec3) -> f64 {
    bounds.upper.dot(along.max(DVec3::ZERO)) + bounds.lower.dot(along.min(DVec3::ZERO))
}

fn mesh_extents<const N: usize>(mesh: &Mesh, instance: &Instance, along: [DVec3; N]) -> [f64; N] {
    let none = [f64::NEG_INFINITY; N];
    let local = along.map(|along| instance.transform.matrix3.transpose() * along);
    // Each vertex once, though several triangles have it.
    let used: Vec<AtomicBool> = mesh.positions.iter().map(|_| AtomicBool::new(false)).collect();
    mesh.triangles.par_chunks(GRAIN).for_each(|triangles| {
        let used = triangles.as_flattened().iter().filter_map(|&i| used.get(i as usize));
        used.for_each(|used| used.store(true, Ordering::Relaxed));
    });
    let reach = |(positions, used): (&[[f32; 3]], &[AtomicBool])| {
        let used = positions.iter().zip(used).filter(|(_, used)| used.load(Ordering::Relaxed));
        used.fold(none, |most, (position, _)| {
            let position = DVec3::from(position.map(f64::from));
            greater(most, local.map(|local| position.dot(local)))
        })
    };
    let parts = mesh.positions.par_chunks(GRAIN).zip(used.par_chunks(GRAIN));
    let most = parts.map(reach).reduce(|| none, greater);
    std::array::from_fn(|i| instance.transform.translation.dot(along[i]) + most[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MaterialId;
    use glam::DAffine3;

    /// Where a point falls in the picture, from −1 to 1 across it and upwards.
    fn seen(camera: &Camera, size: [u32; 2], point: DVec3) -> [f64; 2] {
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

    /// The greatest distance, to the side or up, of a model's corners from the middle.
    fn fill(scene: &mut Scene) -> [f64; 2] {
        frame(scene);
        let camera = &scene.cameras[0];
        let placed = |p: &[f32; 3]| scene.instances[0].to_world(*p);
        let points = scene.meshes[0].positions.iter().map(placed);
        points
            .map(|p| seen(camera, scene.film.size, p))
            .fold([0.0f64; 2], |most, at| std::array::from_fn(|k| most[k].max(at[k].abs())))
    }

    #[test]
    fn a_model_fills_the_picture_one_way_and_stays_within_it_the_other() {
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
                let [x, y] = fill(&mut scene);
                assert!((x.max(y) - FILLED).abs() < 1e-6, "{size:?} {transform:?}: {x} {y}");
            }
        }
    }

    #[test]
    fn a_sphere_touches_the_margin() {
        let mut scene = Scene::default();
        scene.film.size = [400, 300];
        scene.spheres.push(Sphere::new(DVec3::new(5.0, -3.0, 2.0), 2.0, MaterialId(0)));
        frame(&mut scene);
        let camera = &scene.cameras[0];
        let to = scene.spheres[0].center - camera.position;
        let half = (2.0 / to.length()).asin();
        assert!((half.tan() - HALF_FOV.tan() * FILLED).abs() < 1e-9);
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
        keys.translation = Curve::<DVec3>::smooth(vec![0.0, 1.0], vec![DVec3::ZERO, -VIEW * 8.0]);
        let mut animation = Animation::new(24, 24.0);
        let motion = Motion::Keyframes(keys);
        let node = animation.add_node(Node { parent: None, base: DAffine3::IDENTITY, motion });
        let (center, radius) = (DVec3::ZERO, None);
        animation.objects.push(Animated::Sphere { sphere: 0, node: Some(node), center, radius });
        scene.animation = Some(animation);
        frame(&mut scene);
        let to = -scene.cameras[0].position;
        let half = (1.0 / to.length()).asin();
        assert!((half.tan() - HALF_FOV.tan() * FILLED).abs() < 1e-9, "{half}");
    }

    #[test]
    fn flat_models_are_seen_from_their_broad_side() {
        for flat in [DVec3::X, DVec3::Y, DVec3::Z] {
            let corner = |p: &[f32; 3]| (DVec3::from(p.map(f64::from)) * (1.0 - flat)).as_vec3();
            let mut scene = mesh(&BOX.map(|p| corner(&p).to_array()));
            frame(&mut scene);
            assert!(scene.cameras[0].forward.dot(flat).abs() > 0.6, "{flat}");
        }
    }

    #[test]
    fn a_line_and_a_point_are_framed_too() {
        let mut line = mesh(&[[0., 0., 0.], [0., 5., 0.]]);
        let [x, y] = fill(&mut line);
        assert!((x.max(y) - FILLED).abs() < 1e-6);
        let mut point = mesh(&[[1., 2., 3.]]);
        assert!(fill(&mut point).iter().all(|x| x.abs() < FILLED));
        let mut origin = mesh(&[[0., 0., 0.]]);
        assert!(fill(&mut origin).iter().all(|x| x.abs() < FILLED));
    }

    #[test]
    fn a_scene_that_is_not_finite_gets_no_camera() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::INFINITY, 2.0, MaterialId(0)));
        frame(&mut scene);
        assert_eq!(scene.cameras, []);
    }

    #[test]
    fn a_files_own_camera_is_kept() {
        let mut scene = mesh(&BOX);
        frame(&mut scene);
        let camera = scene.cameras.clone();
        frame(&mut scene);
        assert_eq!(camera, scene.cameras);
    }
}
