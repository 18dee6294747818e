//! The surroundings of a model, such as a sky dome: what encloses all else and is no part of what a
//! picture should show.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Bounds, triangle};
use crate::scene::{GRAIN, Instance, Mesh, Scene};

/// The ratio of sizes from which on what encloses all else may be its surroundings: a room is smaller.
const MIN_RATIO: f64 = 4.0;
/// The most objects that surroundings have: a box of six pictures, a dome of several parts.
const MAX_PARTS: usize = 64;

/// The objects of a scene that enclose all others.
pub struct Surroundings {
    /// The indices of the instances.
    instances: Vec<usize>,
    /// The box around all others.
    inner: Bounds,
}

/// Returns the surroundings of a scene, if it has some: the fewest of its greatest instances that enclose
/// all that is smaller, to all sides and above. A plain or a hill below does not.
pub fn find(scene: &Scene) -> Option<Surroundings> {
    if scene.instances.len() + scene.spheres.len() < 2 {
        return None;
    }
    // The boxes of the instances, the greatest first.
    let mesh_bounds = scene.mesh_bounds();
    let bounds = |i: &Instance| mesh_bounds[i.mesh.0 as usize].transformed(&i.transform);
    let mut boxes: Vec<(f64, usize, Bounds)> = scene
        .instances
        .iter()
        .enumerate()
        .map(|(i, instance)| (i, bounds(instance)))
        .filter(|(_, bounds)| !bounds.is_empty())
        .map(|(i, bounds)| (bounds.diagonal(), i, bounds))
        .collect();
    boxes.sort_by(|a, b| b.0.total_cmp(&a.0));
    // The box of all that is smaller than each, and of the spheres.
    let spheres = scene.spheres.iter().map(|s| s.bounds()).fold(Bounds::EMPTY, Bounds::union);
    let mut inner = vec![spheres; boxes.len() + 1];
    for k in (0..boxes.len()).rev() {
        inner[k] = inner[k + 1].union(boxes[k].2);
    }
    let mut outer = Bounds::EMPTY;
    (1..=boxes.len().min(MAX_PARTS)).find_map(|parts| {
        let (size, _, bounds) = boxes[parts - 1];
        outer = outer.union(bounds);
        let inner = inner[parts];
        let is_within =
            inner.lower.cmpgt(outer.lower).all() && inner.upper.cmplt(outer.upper).all();
        if inner.is_empty() || !is_within || size < MIN_RATIO * inner.diagonal() {
            return None;
        }
        let instances = boxes[..parts].iter().map(|(_, i, _)| *i).collect();
        let found = Surroundings { instances, inner };
        found.enclose(scene).then_some(found)
    })
}

impl Surroundings {
    /// True if there is something of them to each side of what they enclose, and above it.
    fn enclose(&self, scene: &Scene) -> bool {
        let sides = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let level = sides.map(|[x, z]| DVec3::new(x, 0.05, z));
        let above = sides.map(|[x, z]| DVec3::new(x, 1.0, z));
        let center = self.inner.center();
        let is_hit = |direction: &DVec3| self.distance(scene, center, *direction).is_some();
        level.iter().chain(&above).chain(&[DVec3::new(0.01, 1.0, 0.02)]).all(is_hit)
    }

    /// True if a point is in view of what they enclose.
    pub fn have_within(&self, scene: &Scene, point: DVec3) -> bool {
        let center = self.inner.center();
        self.distance(scene, center, point - center).is_some_and(|distance| distance > 1.0)
    }

    /// Returns the scene that they enclose, in which each of them is a point in its middle: all others keep
    /// their indices.
    pub fn without(&self, scene: &Scene) -> Scene {
        let mut inner = scene.clone();
        let center = self.inner.center().to_array();
        let point =
            Mesh { positions: vec![center].into(), triangles: vec![[0; 3]], ..Mesh::default() };
        let mesh = inner.add_mesh(point);
        for &i in &self.instances {
            let Instance { material, .. } = scene.instances[i];
            inner.instances[i] = Instance::new(mesh, glam::DAffine3::IDENTITY, material);
        }
        inner
    }

    /// Returns the distance at which a ray first hits them, in lengths of its direction.
    fn distance(&self, scene: &Scene, origin: DVec3, direction: DVec3) -> Option<f64> {
        let of_instance = |&i: &usize| {
            let instance = &scene.instances[i];
            let mesh = &scene.meshes[instance.mesh.0 as usize];
            let hit = |i: u32| {
                let corners = mesh.triangle_vertices(i).map(|p| instance.to_world(p));
                triangle::intersect(corners, origin, direction).map(|hit| hit.t)
            };
            let triangles = (0..mesh.triangles.len() as u32).into_par_iter().with_min_len(GRAIN);
            triangles.filter_map(hit).filter(|t| *t > 0.0).min_by(f64::total_cmp)
        };
        self.instances.iter().filter_map(of_instance).min_by(f64::total_cmp)
    }
}
