//! Meshes that coincide: copies at one place, and flat ones that overlap in one plane.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use crate::geometry::{Bounds, PrimitiveId};
use crate::scene::Scene;

/// The number of instances with which each is compared.
const MAX_COMPARED: usize = 256;
/// The number of triangles by which two instances are compared.
const MAX_TRIANGLES: usize = 1024;

/// Returns a sentence about two instances that coincide; none if there seem to be none. Instances
/// coincide that have the same vertices, or that are flat along the same axis, at the same coordinate, if
/// a triangle of one reaches into one of the other.
///
/// Triangles that coincide are those between which precision `fast` on Embree chooses ray by ray.
///
/// # Panics
/// When the scene is not valid.
pub fn coincident_meshes(scene: &Scene) -> Option<String> {
    if scene.instances.len() < 2 {
        return None;
    }
    let mesh_bounds = scene.mesh_bounds();
    let instances = (0..).zip(&scene.instances).map(|(i, instance)| {
        let mesh = instance.mesh.0 as usize;
        let bounds = mesh_bounds[mesh].transformed(&instance.transform);
        Placed { index: i, triangles: scene.meshes[mesh].triangles.len(), bounds }
    });
    let mut placed: Vec<Placed> = instances.filter(|placed| !placed.bounds.is_empty()).collect();
    let pair = copies(scene, &mut placed)
        .or_else(|| (0..3).find_map(|axis| overlap(scene, &placed, axis)))?;
    let name = |i: u32| {
        let mesh = scene.instances[i as usize].mesh.0 as usize;
        match &*scene.meshes[mesh].name {
            "" => i.to_string(),
            name => format!("{i} (mesh `{name}`)"),
        }
    };
    let [first, second] = [pair[0].min(pair[1]), pair[0].max(pair[1])].map(name);
    Some(format!("instances {first} and {second} coincide"))
}

/// An instance and its box in world space.
struct Placed {
    index: u32,
    triangles: usize,
    bounds: Bounds,
}

/// The first triangles of an instance, in world space.
fn triangles<'s>(scene: &'s Scene, placed: &Placed) -> impl Iterator<Item = [DVec3; 3]> + use<'s> {
    let index = placed.index;
    let mesh = scene.instances[index as usize].mesh.0;
    let count = placed.triangles.min(MAX_TRIANGLES) as u32;
    (0..count).map(move |t| scene.triangle_vertices(PrimitiveId::triangle(mesh, t, index)))
}

/// Returns two instances with the same vertices. Sorts the instances by their boxes.
fn copies(scene: &Scene, placed: &mut [Placed]) -> Option<[u32; 2]> {
    let numbers = |p: &Placed| [p.bounds.lower.to_array(), p.bounds.upper.to_array()];
    let compare = |a: &Placed, b: &Placed| {
        let (a_numbers, b_numbers) = (numbers(a), numbers(b));
        let mut pairs = a_numbers.as_flattened().iter().zip(b_numbers.as_flattened());
        let order = pairs.find_map(|(a, b)| Some(a.total_cmp(b)).filter(|order| order.is_ne()));
        order.unwrap_or(Ordering::Equal).then(a.triangles.cmp(&b.triangles))
    };
    placed.sort_by(compare);
    let are_copies = |two: &&[Placed]| {
        compare(&two[0], &two[1]).is_eq() && triangles(scene, &two[0]).eq(triangles(scene, &two[1]))
    };
    placed.windows(2).find(are_copies).map(|two| [two[0].index, two[1].index])
}

/// Returns two instances that are flat along an axis, at the same coordinate, and overlap.
fn overlap(scene: &Scene, placed: &[Placed], axis: usize) -> Option<[u32; 2]> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let is_flat = |p: &&Placed| p.bounds.lower[axis] == p.bounds.upper[axis];
    let mut flat: Vec<&Placed> = placed.iter().filter(is_flat).collect();
    flat.sort_by(|a, b| {
        let height = a.bounds.lower[axis].total_cmp(&b.bounds.lower[axis]);
        height.then(a.bounds.lower[u].total_cmp(&b.bounds.lower[u]))
    });
    flat.iter().enumerate().find_map(|(i, a)| {
        let (from, to) = (&a.bounds.lower, &a.bounds.upper);
        let in_plane = flat[i + 1..].iter().take(MAX_COMPARED);
        let mut near = in_plane
            .take_while(|b| b.bounds.lower[axis] == from[axis] && b.bounds.lower[u] < to[u]);
        let overlaps = |b: &&&Placed| {
            let boxes_overlap = b.bounds.lower[v] < to[v] && b.bounds.upper[v] > from[v];
            boxes_overlap
                && (reaches_into(scene, a, b, [u, v]) || reaches_into(scene, b, a, [u, v]))
        };
        near.find(overlaps).map(|b| [a.index, b.index])
    })
}

/// True if a triangle of `a` reaches into one of `b`, in a plane with axes u and v: its middle or a
/// point near a corner lies within.
fn reaches_into(scene: &Scene, a: &Placed, b: &Placed, [u, v]: [usize; 2]) -> bool {
    let flat = |p: DVec3| DVec2::new(p[u], p[v]);
    let others: Vec<[DVec2; 3]> = triangles(scene, b).map(|t| t.map(flat)).collect();
    let contains = |[a, b, c]: &[DVec2; 3], p: DVec2| {
        let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(p - from));
        sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
    };
    triangles(scene, a).take(MAX_COMPARED).any(|corners| {
        let corners = corners.map(flat);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let points = corners.map(|corner| corner.lerp(middle, 0.01)).into_iter().chain([middle]);
        points.into_iter().any(|p| others.iter().any(|other| contains(other, p)))
    })
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::scene::{Instance, MaterialId, Mesh};

    /// Returns what is said of squares of side 1 in the plane y = 0, moved and turned.
    fn said(transforms: &[DAffine3]) -> Option<String> {
        let mut scene = Scene::default();
        let mesh = scene.add_mesh(Mesh {
            name: "square".into(),
            positions: vec![[0., 0., 0.], [1., 0., 0.], [1., 0., 1.], [0., 0., 1.]].into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        });
        let instance = |&transform| Instance::new(mesh, transform, MaterialId(0));
        scene.instances.extend(transforms.iter().map(instance));
        coincident_meshes(&scene)
    }

    #[test]
    fn copies_at_one_place_are_named() {
        let turned = DAffine3::from_rotation_x(0.5);
        let away = DAffine3::from_translation(DVec3::splat(9.0));
        let found = said(&[turned, away, turned]).unwrap();
        assert_eq!(found, "instances 0 (mesh `square`) and 2 (mesh `square`) coincide");
    }

    #[test]
    fn flat_meshes_that_overlap_in_one_plane_are_named() {
        let moved = |x: f64, y: f64, z: f64| DAffine3::from_translation(DVec3::new(x, y, z));
        assert!(said(&[moved(0.0, 0.0, 0.0), moved(0.5, 0.0, -0.5)]).is_some());
        for apart in [moved(0.5, 1e-9, -0.5), moved(1.0, 0.0, 0.0), moved(0.5, 0.0, 1.0)] {
            assert_eq!(said(&[moved(0.0, 0.0, 0.0), apart]), None, "{apart}");
        }
    }
}
