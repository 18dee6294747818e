//! The removal of what stands at one place again and again: a ray that meets it must try every copy, and
//! the copies behind the first show nothing.

use std::collections::hash_map::DefaultHasher;
use std::collections::{HashMap, HashSet};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use glam::DVec3;

use crate::geometry::Bounds;
use crate::load::report::{DropReason, LoadReport};
use crate::scene::animation::Animated;
use crate::scene::{Mesh, MeshProvenance, Scene};

/// The most copies that stay at one place: more than the layers of a blended surface that a path sees,
/// and few enough for a ray to try.
const MAX_COPIES: usize = 32;
/// The number of triangles of a mesh, evenly taken, among which copies are looked for.
const SAMPLE: usize = 4096;
/// The number of copies among these from which on all triangles are looked at, in a mesh that has more.
const SUSPICIOUS: usize = 3;

/// The bits of the coordinates of a triangle's corners, from the least corner on.
type TriangleKey = [[u64; 3]; 3];

/// Removes copies of triangles, instances, spheres and planes beyond [`MAX_COPIES`] at one place, and says
/// so. What moves is left as it is.
pub fn remove_duplicates(scene: &mut Scene, report: &mut LoadReport) {
    let had_instance = meshes_in_use(scene);
    let triangles = remove_triangles(scene, &had_instance);
    let [moved_instances, moved_spheres] = moved(scene);

    let is_copy = copied_instances(scene, &moved_instances);
    // Spheres and planes.
    let spheres =
        scene.spheres.iter().map(|s| [s.center.x, s.center.y, s.center.z, s.radius, 0.0, 0.0]);
    let mut is_copied_sphere = copies(spheres.map(|numbers| numbers.map(bits)));
    moved_spheres.iter().for_each(|&i| is_copied_sphere[i] = false);
    let planes = scene.planes.iter().map(|p| {
        let [a, b] = [p.point.to_array(), p.normal.to_array()];
        [a[0], a[1], a[2], b[0], b[1], b[2]].map(bits)
    });
    let is_copied_plane = copies(planes);

    // The objects that stay get new indices.
    let new_instances = retain(&mut scene.instances, &is_copy);
    let new_spheres = retain(&mut scene.spheres, &is_copied_sphere);
    retain(&mut scene.planes, &is_copied_plane);
    if let Some(table) = scene.provenance_mut() {
        retain(&mut table.instances, &is_copy);
        retain(&mut table.spheres, &is_copied_sphere);
        retain(&mut table.planes, &is_copied_plane);
    }
    for object in scene.animation.iter_mut().flat_map(|animation| &mut animation.objects) {
        match object {
            Animated::Instance { instance, .. } => *instance = new_instances[*instance],
            Animated::Sphere { sphere, .. } => *sphere = new_spheres[*sphere],
            _ => {}
        }
    }

    // The account of faces: those of meshes that have no instance left are dropped, too.
    let has_instance = meshes_in_use(scene);
    let lost = had_instance.iter().zip(&has_instance).zip(&scene.meshes);
    let lost = lost.filter(|((had, has), _)| **had && !**has);
    let faces = triangles + lost.map(|(_, mesh)| mesh.triangles.len() as u64).sum::<u64>();
    if faces > 0 {
        *report.dropped.entry(DropReason::Duplicate).or_default() += faces;
        report.handed_over = report.handed_over.saturating_sub(faces);
    }
    let count = |copies: &[bool]| copies.iter().filter(|is_copy| **is_copy).count() as u64;
    for (count, what) in [
        (triangles, "triangles"),
        (count(&is_copy), "instances of meshes"),
        (count(&is_copied_sphere), "spheres"),
        (count(&is_copied_plane), "planes"),
    ] {
        if count > 0 {
            report.warnings.push(format!(
                "{count} {what} are left out: {MAX_COPIES} others of the same shape stand at the same place"
            ));
        }
    }
}

/// Removes the copies of triangles within each mesh, and returns the number of those that had instances.
fn remove_triangles(scene: &mut Scene, is_used: &[bool]) -> u64 {
    // A mesh that is deformed has another shape at another time.
    let objects = scene.animation.iter().flat_map(|animation| &animation.objects);
    let deformed: HashSet<usize> = objects
        .filter_map(|object| match object {
            Animated::Mesh { mesh, .. } => Some(*mesh),
            _ => None,
        })
        .collect();
    let mut removed = 0;
    let table = scene.provenance.as_mut().map(Arc::make_mut);
    let meshes_provenance = table.map_or(&mut [][..], |table| &mut table.meshes[..]);
    for (i, mesh) in scene.meshes.iter_mut().enumerate() {
        let mut copied = copied_triangles(mesh);
        if copied.is_empty() || deformed.contains(&i) || !is_used.get(i).is_some_and(|used| *used) {
            continue;
        }
        let mut is_kept = |triangle: &[u32; 3]| {
            let key = triangle_key(mesh.corners(triangle));
            let Some(count) = copied.get_mut(&key) else { return true };
            *count += 1;
            *count <= MAX_COPIES
        };
        let is_kept: Vec<bool> = mesh.triangles.iter().map(&mut is_kept).collect();
        let mut kept = is_kept.iter();
        Arc::make_mut(mesh).triangles.retain(|_| kept.next() != Some(&false));
        removed += is_kept.iter().filter(|is_kept| !**is_kept).count() as u64;
        if let Some(MeshProvenance { faces, .. }) = meshes_provenance.get_mut(i) {
            Arc::make_mut(faces).retain(is_kept.into_iter());
        }
    }
    removed
}

/// Returns the triangles of a mesh of which there seem to be many copies, with a count of 0 for each.
fn copied_triangles(mesh: &Mesh) -> HashMap<TriangleKey, usize> {
    let count = mesh.triangles.len();
    if count <= MAX_COPIES {
        return HashMap::new();
    }
    let sampled = count.min(SAMPLE);
    let least = if count > SAMPLE { SUSPICIOUS } else { MAX_COPIES + 1 };
    let mut counts: HashMap<TriangleKey, usize> = HashMap::with_capacity(sampled);
    for i in 0..sampled {
        let corners = mesh.triangle_vertices((i * count / sampled) as u32);
        *counts.entry(triangle_key(corners)).or_default() += 1;
    }
    counts.into_iter().filter(|(_, n)| *n >= least).map(|(key, _)| (key, 0)).collect()
}

/// Returns the key of a triangle: the same whichever corner it begins with, and another one for the
/// triangle that faces the other way.
fn triangle_key(corners: [DVec3; 3]) -> TriangleKey {
    let mut key = corners.map(|corner| corner.to_array().map(bits));
    let least = (0..3).min_by_key(|&i| key[i]).unwrap_or(0);
    key.rotate_left(least);
    key
}

/// Returns a hash of the shape of a mesh, on which its triangles may be told apart.
fn content_hash(mesh: &Mesh) -> u64 {
    let mut hasher = DefaultHasher::new();
    mesh.triangles.hash(&mut hasher);
    mesh.positions.iter().for_each(|p| p.to_array().map(bits).hash(&mut hasher));
    hasher.finish()
}

/// Tells for each instance whether it is one too many of its kind.
fn copied_instances(scene: &Scene, moved: &HashSet<usize>) -> Vec<bool> {
    let mut is_copy = vec![false; scene.instances.len()];
    if is_copy.len() <= MAX_COPIES {
        return is_copy;
    }
    // Equal meshes, by the boxes that they fill, which are quickly compared.
    let mesh_bounds = scene.mesh_bounds();
    let mut by_box: HashMap<[u64; 6], Vec<usize>> = HashMap::new();
    for (i, instance) in scene.instances.iter().enumerate() {
        let bounds = mesh_bounds[instance.mesh.0 as usize].transformed(&instance.transform);
        by_box.entry(box_key(&bounds)).or_default().push(i);
    }
    let mut contents: HashMap<u32, u64> = HashMap::new();
    for group in by_box.into_values().filter(|group| group.len() > MAX_COPIES) {
        let mut counts: HashMap<(u64, [u64; 12]), usize> = HashMap::new();
        for i in group.into_iter().filter(|i| !moved.contains(i)) {
            let instance = &scene.instances[i];
            let mesh = &scene.meshes[instance.mesh.0 as usize];
            let content = *contents.entry(instance.mesh.0).or_insert_with(|| content_hash(mesh));
            let transform = instance.transform.to_cols_array().map(bits);
            let count = counts.entry((content, transform)).or_default();
            *count += 1;
            is_copy[i] = *count > MAX_COPIES;
        }
    }
    is_copy
}

/// Tells for each of some keys whether it is one too many of its kind.
fn copies(keys: impl Iterator<Item = [u64; 6]>) -> Vec<bool> {
    let mut counts: HashMap<[u64; 6], usize> = HashMap::new();
    let is_copy = |key| {
        let count = counts.entry(key).or_default();
        *count += 1;
        *count > MAX_COPIES
    };
    keys.map(is_copy).collect()
}

/// Returns the indices of the instances and of the spheres that move.
fn moved(scene: &Scene) -> [HashSet<usize>; 2] {
    let mut moved = [HashSet::new(), HashSet::new()];
    for object in scene.animation.iter().flat_map(|animation| &animation.objects) {
        match object {
            Animated::Instance { instance, .. } => moved[0].insert(*instance),
            Animated::Sphere { sphere, .. } => moved[1].insert(*sphere),
            _ => continue,
        };
    }
    moved
}

/// Tells for each mesh whether it has an instance.
fn meshes_in_use(scene: &Scene) -> Vec<bool> {
    let mut is_used = vec![false; scene.meshes.len()];
    scene.instances.iter().for_each(|instance| is_used[instance.mesh.0 as usize] = true);
    is_used
}

/// Retains what is no copy, and returns the new index of each former one.
fn retain<T>(objects: &mut Vec<T>, is_copy: &[bool]) -> Vec<usize> {
    let mut next = 0;
    let new_index = |is_copy: &bool| {
        next += usize::from(!is_copy);
        next.saturating_sub(1)
    };
    let new_indices = is_copy.iter().map(new_index).collect();
    let mut is_copy = is_copy.iter();
    objects.retain(|_| is_copy.next() != Some(&true));
    new_indices
}

/// Returns the key of a box.
fn box_key(bounds: &Bounds) -> [u64; 6] {
    let [lower, upper] = [bounds.lower.to_array(), bounds.upper.to_array()].map(|p| p.map(bits));
    [lower[0], lower[1], lower[2], upper[0], upper[1], upper[2]]
}

/// Returns the bits of a number; 0 and −0 have the same.
fn bits(x: f64) -> u64 {
    (x + 0.0).to_bits()
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::scene::{Instance, MaterialId, MeshId, Plane, Sphere};

    fn triangle(count: usize) -> Mesh {
        // Each copy with vertices of its own, and beginning at another corner.
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let positions = corners.repeat(count).into();
        let corner = |i: usize| [0, 1, 2].map(|k| (3 * i + (i + k) % 3) as u32);
        Mesh { positions, triangles: (0..count).map(corner).collect(), ..Mesh::default() }
    }

    fn removed(scene: &mut Scene, faces: u64) -> LoadReport {
        let mut report = LoadReport { read: faces, handed_over: faces, ..LoadReport::default() };
        remove_duplicates(scene, &mut report);
        assert!(report.balances(), "{report}");
        report
    }

    #[test]
    fn copies_of_triangles_stay_up_to_a_number() {
        for count in [MAX_COPIES, MAX_COPIES + 1, 5000, 100_000] {
            let mut scene = Scene::default();
            let mesh = scene.add_mesh(triangle(count));
            scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
            let report = removed(&mut scene, count as u64);
            assert_eq!(scene.triangle_count(), MAX_COPIES as u64);
            assert_eq!(report.warnings.len(), usize::from(count > MAX_COPIES));
        }
    }

    #[test]
    fn a_triangle_that_faces_the_other_way_is_no_copy() {
        let mut mesh = triangle(20);
        mesh.triangles.extend(mesh.triangles.clone().iter().map(|&[a, b, c]| [a, c, b]));
        let mut scene = Scene::default();
        let mesh = scene.add_mesh(mesh);
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
        removed(&mut scene, 40);
        assert_eq!(scene.triangle_count(), 40);
    }

    #[test]
    fn instances_of_equal_meshes_are_copies_and_others_stay() {
        let mut scene = Scene::default();
        for _ in 0..100 {
            scene.add_mesh(triangle(1));
        }
        let place = DAffine3::from_translation(DVec3::X);
        for i in 0..100 {
            scene.instances.push(Instance::new(MeshId(i), place, MaterialId(i)));
        }
        // The same box, and another triangle in it.
        let other = Mesh { triangles: vec![[0, 2, 1]], ..triangle(1) };
        let other = scene.add_mesh(other);
        scene.instances.push(Instance::new(other, place, MaterialId(0)));
        let report = removed(&mut scene, 101);
        assert_eq!(scene.instances.len(), MAX_COPIES + 1);
        assert_eq!(report.dropped, [(DropReason::Duplicate, 68)].into());
        assert!(report.is_clean(), "what is still there is not lost");
    }

    #[test]
    fn spheres_and_planes_are_copies_too_and_what_moves_is_not() {
        use crate::scene::animation::Animation;
        let mut scene = Scene::default();
        for i in 0..100 {
            scene.spheres.push(Sphere::new(DVec3::Y, 1.0, MaterialId(i)));
            scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(i)));
        }
        let mut animation = Animation::new(2, 1.0);
        let (node, center, radius) = (None, DVec3::Y, None);
        animation.objects.push(Animated::Sphere { sphere: 99, node, center, radius });
        scene.animation = Some(animation);
        let report = removed(&mut scene, 0);
        assert_eq!((scene.spheres.len(), scene.planes.len()), (MAX_COPIES + 1, MAX_COPIES));
        assert_eq!(scene.spheres[MAX_COPIES].material, MaterialId(99));
        let objects = &scene.animation.unwrap().objects;
        assert!(matches!(objects[0], Animated::Sphere { sphere: MAX_COPIES, .. }));
        assert_eq!(report.warnings.len(), 2);
    }
}
