//! The direction from which a model is seen by the camera that frames it.

use glam::{DMat3, DVec3};

use crate::geometry::triangle;
use crate::load::framing::Framing;
use crate::scene::Scene;

/// The direction from the model to the camera: to the right, from above, and mostly from the front,
/// where +Z is the front and +Y is up, as in glTF.
pub const VIEW_DIRECTION: DVec3 = DVec3::new(0.55, 0.45, 1.0);
/// The ratio of thickness to length below which a model counts as flat.
const FLATNESS: f64 = 0.02;
/// The share of a model's area that its view shows, below which it is seen from another side: its faces
/// are then seen on their edges.
pub const MIN_VISIBLE: f64 = 0.05;
/// The greatest number of triangles of a mesh, and of instances, by which a view is judged.
const SAMPLE: usize = 1024;

/// A direction from a model to the camera, and the direction that is upward in the picture.
pub struct ViewDirection {
    pub direction: DVec3,
    pub up: DVec3,
}

/// Returns the direction from a model of a size to the camera: the one that is asked for, or else as the
/// model's shape suggests.
pub fn view_direction(scene: &Scene, size: DVec3, framing: &Framing) -> ViewDirection {
    let axes = framing.axes();
    let suggested = suggested_direction(scene, size, axes);
    if !framing.has_direction() {
        return ViewDirection { direction: suggested, up: axes.y_axis };
    }
    // The angle that is not given is that of the suggestion.
    let DVec3 { x, y, z } = axes.transpose() * suggested;
    let azimuth = framing.azimuth.unwrap_or(x.atan2(z));
    let elevation = framing.elevation.unwrap_or(y.asin());
    let ((sin_a, cos_a), (sin_e, cos_e)) = (azimuth.sin_cos(), elevation.sin_cos());
    // The upward direction is at a right angle to the view, also from straight above.
    ViewDirection {
        direction: axes * DVec3::new(sin_a * cos_e, sin_e, cos_a * cos_e),
        up: axes * DVec3::new(-sin_a * sin_e, cos_e, -cos_a * sin_e),
    }
}

/// Returns the direction from a model of a size to the camera, where `axes` are its right, up and front: flat
/// models are seen from their broad side, whatever way they are turned.
fn suggested_direction(scene: &Scene, size: DVec3, axes: DMat3) -> DVec3 {
    let usual = axes * usual_direction((axes.transpose() * size).abs());
    let DVec3 { x, y, z } = VIEW_DIRECTION;
    let others = [[-x, y, z], [z, y, x], [-z, y, x], [x, z, y]];
    let others = others.map(|other| axes * DVec3::from(other).normalize());
    let shares = visible_shares(scene, [usual, others[0], others[1], others[2], others[3]]);
    if shares[0] >= MIN_VISIBLE {
        return usual;
    }
    let best = others.into_iter().zip(&shares[1..]).max_by(|a, b| a.1.total_cmp(b.1));
    best.filter(|(_, share)| **share > shares[0]).map_or(usual, |(direction, _)| direction)
}

/// Returns the share of the area of a model's faces that each view shows; 1 if it has none.
pub fn visible_shares<const N: usize>(scene: &Scene, directions: [DVec3; N]) -> [f64; N] {
    let (mut total, mut shown) = (0.0, [0.0; N]);
    let mut add = |area: f64, projected: [f64; N]| {
        total += area;
        shown = std::array::from_fn(|k| shown[k] + projected[k]);
    };
    // Some of many triangles and instances tell enough.
    for instance in scene.instances.iter().step_by(scene.instances.len() / SAMPLE + 1) {
        let Some(mesh) = scene.meshes.get(instance.mesh.0 as usize) else { continue };
        let count = mesh.triangles.len();
        for i in (0..count).step_by(count / SAMPLE + 1) {
            let corners = mesh.triangle_vertices(i as u32).map(|p| instance.to_world(p));
            let normal = triangle::area_normal(corners);
            add(normal.length(), directions.map(|direction| normal.dot(direction).abs()));
        }
    }
    // A sphere shows a quarter of its area, and hides as much that faces away.
    for sphere in scene.spheres.iter().step_by(scene.spheres.len() / SAMPLE + 1) {
        let area = sphere.radius * sphere.radius;
        add(area, [area / 2.0; N]);
    }
    if total > 0.0 && total.is_finite() { shown.map(|shown| shown / total) } else { [1.0; N] }
}

/// Returns the direction from a model of a size to the camera, by its box alone.
fn usual_direction(size: DVec3) -> DVec3 {
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
