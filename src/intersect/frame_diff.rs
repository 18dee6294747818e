//! The difference between a frame of an animation and the frame before.

use std::sync::Arc;

#[cfg(feature = "embree")]
use crate::geometry::Bounds;
use crate::scene::{Instance, Mesh, Scene, Sphere};

/// The meshes, spheres and instances of the last frame.
#[derive(Default)]
pub(in crate::intersect) struct PreviousFrame {
    meshes: Vec<Arc<Mesh>>,
    /// The boxes of the meshes in object space.
    #[cfg(feature = "embree")]
    mesh_bounds: Vec<Bounds>,
    spheres: Vec<Sphere>,
    instances: Vec<Instance>,
}

/// The indices of what moved or changed since the frame before.
#[derive(Debug, Default, PartialEq, Eq)]
pub(in crate::intersect) struct FrameDiff {
    /// Spheres.
    pub spheres: Vec<u32>,
    /// Instances of meshes.
    pub instances: Vec<u32>,
}

impl PreviousFrame {
    /// Advances to the scene of another frame, and returns what moved; `None` where the frames do not
    /// have the same meshes, or as many spheres and instances of the same meshes.
    pub fn advance(&mut self, scene: &Scene) -> Option<FrameDiff> {
        if !same_meshes(&self.meshes, &scene.meshes) {
            *self = Self {
                meshes: scene.meshes.clone(),
                #[cfg(feature = "embree")]
                mesh_bounds: scene.mesh_bounds(),
                spheres: scene.spheres.clone(),
                instances: scene.instances.clone(),
            };
            return None;
        }
        let same_meshes =
            self.instances.iter().map(|i| i.mesh).eq(scene.instances.iter().map(|i| i.mesh));
        if !(same_meshes && self.spheres.len() == scene.spheres.len()) {
            self.spheres.clone_from(&scene.spheres);
            self.instances.clone_from(&scene.instances);
            return None;
        }
        let spheres = replace(&mut self.spheres, &scene.spheres);
        let instances = replace(&mut self.instances, &scene.instances);
        Some(FrameDiff { spheres, instances })
    }

    /// The boxes of the meshes in object space.
    #[cfg(feature = "embree")]
    pub fn mesh_bounds(&self) -> &[Bounds] {
        &self.mesh_bounds
    }
}

fn same_meshes(a: &[Arc<Mesh>], b: &[Arc<Mesh>]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| Arc::ptr_eq(a, b))
}

/// Replaces what differs from `new`, and returns its indices.
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
    fn a_first_frame_has_no_difference() {
        assert_eq!(PreviousFrame::default().advance(&scene()), None);
    }

    #[test]
    fn what_moved_is_returned_once() {
        let (mut previous, mut scene) = (PreviousFrame::default(), scene());
        previous.advance(&scene);
        scene.spheres[2].radius = 2.0;
        scene.instances[1].transform = DAffine3::IDENTITY;
        let diff = FrameDiff { spheres: vec![2], instances: vec![1] };
        assert_eq!(previous.advance(&scene), Some(diff));
        assert_eq!(previous.advance(&scene), Some(FrameDiff::default()));
    }

    #[test]
    fn another_mesh_has_not_moved() {
        let (mut previous, mut scene) = (PreviousFrame::default(), scene());
        previous.advance(&scene);
        Arc::make_mut(&mut scene.meshes[0]).positions = vec![[0.0; 3]].into();
        assert_eq!(previous.advance(&scene), None);
    }

    #[test]
    fn what_is_gone_has_not_moved() {
        let (mut previous, mut scene) = (PreviousFrame::default(), scene());
        previous.advance(&scene);
        scene.instances.remove(0);
        assert_eq!(previous.advance(&scene), None);
    }
}
