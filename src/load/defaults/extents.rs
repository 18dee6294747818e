//! The extents of a scene: its greatest coordinates along given directions.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::Bounds;
use crate::scene::{GRAIN, Instance, Mesh, Scene, Sphere};

/// Returns the extents of a scene along directions of any length, wherever it moves; those of its
/// `bounds` where it has no others.
pub fn extents<const N: usize>(scene: &Scene, bounds: &Bounds, directions: [DVec3; N]) -> [f64; N] {
    let mut extents = [f64::NEG_INFINITY; N];
    if scene.animation.is_some() {
        scene.sample_over_time(|poses| {
            extents = max(extents, still_extents(poses.scene(), directions))
        });
    } else {
        extents = still_extents(scene, directions);
    }
    if extents.iter().all(|extent| extent.is_finite()) {
        extents
    } else {
        directions.map(|direction| box_extent(bounds, direction))
    }
}

/// Returns the extent of a box along a direction.
pub fn box_extent(bounds: &Bounds, direction: DVec3) -> f64 {
    bounds.upper.dot(direction.max(DVec3::ZERO)) + bounds.lower.dot(direction.min(DVec3::ZERO))
}

/// Returns the extents of the spheres and instances of a scene that does not move.
fn still_extents<const N: usize>(scene: &Scene, directions: [DVec3; N]) -> [f64; N] {
    let sphere = |s: &Sphere| directions.map(|d| s.center.dot(d) + s.radius * d.length());
    let meshes = scene.instances.iter().filter_map(|instance| {
        let mesh = scene.meshes.get(instance.mesh.0 as usize)?;
        Some(mesh_extents(mesh, instance, directions))
    });
    scene.spheres.iter().map(sphere).chain(meshes).fold([f64::NEG_INFINITY; N], max)
}

/// Returns the extents of an instance of a mesh.
fn mesh_extents<const N: usize>(
    mesh: &Mesh,
    instance: &Instance,
    directions: [DVec3; N],
) -> [f64; N] {
    // The directions are taken into the space of the mesh, which saves transforming each vertex.
    let none = [f64::NEG_INFINITY; N];
    let local = directions.map(|direction| instance.transform.matrix3.transpose() * direction);
    // Each vertex counts once, though several triangles have it, and only if one has it.
    let is_used: Vec<AtomicBool> = mesh.positions.iter().map(|_| AtomicBool::new(false)).collect();
    mesh.triangles.par_chunks(GRAIN).for_each(|triangles| {
        let used = triangles.as_flattened().iter().filter_map(|&i| is_used.get(i as usize));
        used.for_each(|is_used| is_used.store(true, Ordering::Relaxed));
    });

    // The greatest coordinates of the vertices in use, chunk by chunk in parallel.
    let vertices = (0..is_used.len()).into_par_iter().with_min_len(GRAIN);
    let used = vertices.filter(|&i| is_used[i].load(Ordering::Relaxed));
    let extents_of = |i: usize| local.map(|local| mesh.positions.at(i).dot(local));
    let extents = used.map(extents_of).reduce(|| none, max);
    std::array::from_fn(|i| instance.transform.translation.dot(directions[i]) + extents[i])
}

fn max<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i].max(b[i]))
}
