//! What stands in a frame of an animation, and what of it stood elsewhere in the frame before.

use std::sync::Arc;

#[cfg(feature = "embree")]
use crate::geometry::Bounds;
use crate::scene::{Instance, Mesh, Scene, Sphere};

/// The things that rays can meet, as they stood in the last frame.
#[derive(Default)]
pub(in crate::intersect) struct PreviousFrame {
    meshes: Vec<Arc<Mesh>>,
    /// The boxes of the meshes, each in its own space.
    #[cfg(feature = "embree")]
    boxes: Vec<Bounds>,
    spheres: Vec<Sphere>,
    instances: Vec<Instance>,
}

/// Indices of what stood elsewhere, or was another, in the frame before.
#[derive(Debug, Default, PartialEq, Eq)]
pub(in crate::intersect) struct FrameDiff {
    /// Spheres.
    pub spheres: Vec<u32>,
    /// Instances of meshes.
    pub instances: Vec<u32>,
}

impl PreviousFrame {
    /// Goes on to the scene of another frame. Says what moved, or nothing where the things are not
    /// the same ones.
    pub fn advance(&mut self, scene: &Scene) -> Option<FrameDiff> {
        if !same_meshes(&self.meshes, &scene.meshes) {
            *self = Self {
                meshes: scene.meshes.clone(),
                #[cfg(feature = "embree")]
                boxes: scene.mesh_bounds(),
                spheres: scene.spheres.clone(),
                instances: scene.instances.clone(),
            };
            return None;
        }
        let counts = |spheres: &[Sphere], instances: &[Instance]| (spheres.len(), instances.len());
        let same_counts =
            counts(&self.spheres, &self.instances) == counts(&scene.spheres, &scene.instances);
        let mut both = self.instances.iter().zip(&scene.instances);
        if !(same_counts && both.all(|(a, b)| a.mesh == b.mesh)) {
            self.spheres.clone_from(&scene.spheres);
            self.instances.clone_from(&scene.instances);
            return None;
        }
        let spheres = replace(&mut self.spheres, &scene.spheres);
        let instances = replace(&mut self.instances, &scene.instances);
        Some(FrameDiff { spheres, instances })
    }

    /// The boxes of the meshes, each in its own space.
    #[cfg(feature = "embree")]
    pub fn boxes(&self) -> &[Bounds] {
        &self.boxes
    }
}

fn same_meshes(a: &[Arc<Mesh>], b: &[Arc<Mesh>]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| Arc::ptr_eq(a, b))
}

/// Puts what is new in the place of what it differs from, and says where.
fn replace<T: Clone + PartialEq>(old: &mut [T], new: &[T]) -> Vec<u32> {
    let mut replaced = Vec::new();
    for (i, (old, new)) in (0..).zip(old.iter_mut().zip(new)) {
        if old != new {
            *old = new.clone();
            replaced.push(i);
        }
    }
    replaced
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MaterialId, MeshId};
    use glam::{DAffine3, DVec3};

    fn scene() -> Scene {
        let mut scene = Scene::default();
        scene.add_mesh(Mesh::default());
        for x in [0.0, 1.0, 2.0] {
            let there = DAffine3::from_translation(DVec3::X * x);
            scene.instances.push(Instance::new(MeshId(0), there, MaterialId(0)));
            scene.spheres.push(Sphere::new(DVec3::Y * x, 1.0, MaterialId(0)));
        }
        scene
    }

    #[test]
    fn nothing_is_known_of_a_first_frame() {
        assert_eq!(PreviousFrame::default().advance(&scene()), None);
    }

    #[test]
    fn what_moved_is_told_once() {
        let (mut standing, mut scene) = (PreviousFrame::default(), scene());
        standing.advance(&scene);
        scene.spheres[2].radius = 2.0;
        scene.instances[1].transform = DAffine3::IDENTITY;
        let moved = FrameDiff { spheres: vec![2], instances: vec![1] };
        assert_eq!(standing.advance(&scene), Some(moved));
        assert_eq!(standing.advance(&scene), Some(FrameDiff::default()));
    }

    #[test]
    fn another_mesh_is_not_the_same_one_moved() {
        let (mut standing, mut scene) = (PreviousFrame::default(), scene());
        standing.advance(&scene);
        Arc::make_mut(&mut scene.meshes[0]).positions = vec![[0.0; 3]];
        assert_eq!(standing.advance(&scene), None);
    }

    #[test]
    fn what_is_gone_did_not_move() {
        let (mut standing, mut scene) = (PreviousFrame::default(), scene());
        standing.advance(&scene);
        scene.instances.remove(0);
        assert_eq!(standing.advance(&scene), None);
    }
}
