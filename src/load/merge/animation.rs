//! The animation of an instance of a model: the model's own, within the space that the instance moves
//! with.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::{MergedModel, ModelInstance, SceneIndices};
use crate::scene::animation::{Animated, Animation, Joint, Node, NodeId};

/// An animation to which that of an instance of a model is added.
pub(super) struct InstanceAnimation<'a> {
    /// The model.
    pub model: &'a MergedModel,
    /// The instance.
    pub instance: &'a ModelInstance,
    /// The indices of its objects in the scene.
    pub indices: &'a SceneIndices,
    /// The animation of the scene.
    pub animation: &'a mut Animation,
}

/// The indices of a model's objects that its own animation moves.
#[derive(Default)]
struct AnimatedObjects {
    instances: HashSet<usize>,
    spheres: HashSet<usize>,
    lights: HashSet<usize>,
    cameras: HashSet<usize>,
    /// The joints of skins as the instance places them, by the address of the model's.
    joints: HashMap<*const Joint, Arc<[Joint]>>,
}

impl InstanceAnimation<'_> {
    /// Adds the animation of the instance.
    pub fn add(mut self) {
        let model = self.model;
        let mut animated = AnimatedObjects::default();
        if let Some(own) = &model.model.animation {
            // The model's nodes, of which the outermost stand in the instance's space.
            let first_node = self.animation.nodes.len() as u32;
            self.animation.nodes.extend(own.nodes.iter().map(|node| match node.parent {
                Some(NodeId(parent)) => {
                    Node { parent: Some(NodeId(parent + first_node)), ..node.clone() }
                }
                None => Node {
                    parent: self.instance.node,
                    base: self.instance.transform * node.base,
                    motion: node.motion.clone(),
                },
            }));
            // The objects that move with these nodes.
            for object in &own.objects {
                let object = self.own_object(object.clone(), first_node, &mut animated);
                self.animation.objects.extend(object);
            }
        }
        // All other objects move with the instance.
        if let Some(node) = self.instance.node {
            self.add_still_objects(node, &animated);
        }
    }

    /// Returns one of the animated objects of the model with the indices of the scene, and marks its object as
    /// animated; none if the object is left out of the scene, or is animated already.
    fn own_object(
        &self,
        mut object: Animated,
        first_node: u32,
        animated: &mut AnimatedObjects,
    ) -> Option<Animated> {
        let shift = |node: &mut NodeId| node.0 += first_node;
        match &mut object {
            // All indices become those of the scene, and so do those of the nodes.
            Animated::Sphere { sphere, node, .. } => {
                animated.spheres.insert(*sphere);
                *sphere += self.indices.first_sphere;
                node.iter_mut().for_each(shift);
            }
            Animated::Instance { instance, node, .. } => {
                animated.instances.insert(*instance);
                *instance += self.indices.first_instance;
                shift(node);
            }
            Animated::Light { light, node, .. } => {
                animated.lights.insert(*light);
                *light += self.indices.first_light;
                node.iter_mut().for_each(shift);
                // The lights of an instance can be left out.
                if !self.instance.has_lights {
                    return None;
                }
            }
            Animated::Camera { camera, node, .. } => {
                animated.cameras.insert(*camera);
                // So can a camera, if its scale leaves it no upward direction.
                *camera = self.indices.cameras[*camera]?;
                node.iter_mut().for_each(shift);
            }
            Animated::Mesh { mesh, deformation } => {
                *mesh += self.model.first_mesh;
                // Another instance has the same mesh, and so the same shape.
                let is_same =
                    |m: &Animated| matches!(m, Animated::Mesh { mesh: m, .. } if m == mesh);
                if self.animation.objects.iter().any(is_same) {
                    return None;
                }
                // Joints that stand still in the model move with the instance.
                let place = |joint: &mut Joint| match &mut joint.node {
                    Some(node) => shift(node),
                    None => {
                        joint.transform = self.instance.transform * joint.transform;
                        joint.node = self.instance.node;
                    }
                };
                if let Some(skin) = &mut deformation.skin {
                    place(&mut skin.space);
                    // The meshes of a skin share its joints, as they do in the model.
                    let own = skin.joints.clone();
                    let placed = animated.joints.entry(own.as_ptr()).or_insert_with(|| {
                        let mut joints = own.to_vec();
                        joints.iter_mut().for_each(place);
                        joints.into()
                    });
                    skin.joints = placed.clone();
                }
            }
        }
        Some(object)
    }

    /// Makes the objects that the model's own animation leaves where they are move with the node of
    /// the instance.
    fn add_still_objects(&mut self, node: NodeId, animated: &AnimatedObjects) {
        let Self { model: MergedModel { model, .. }, indices, animation, .. } = self;
        let transform = self.instance.transform;

        // All of them stand in the space of the node as the instance's transform places them there.
        for (i, instance) in still(&model.instances, &animated.instances) {
            animation.objects.push(Animated::Instance {
                instance: indices.first_instance + i,
                node,
                transform: transform * instance.transform,
            });
        }
        let node = Some(node);
        for (i, sphere) in still(&model.spheres, &animated.spheres) {
            animation.objects.push(Animated::Sphere {
                sphere: indices.first_sphere + i,
                node,
                center: transform.transform_point3(sphere.center),
                radius: None,
            });
        }
        if self.instance.has_lights {
            for (i, light) in still(&model.lights, &animated.lights) {
                animation.objects.push(Animated::Light {
                    light: indices.first_light + i,
                    node,
                    rest: light.transformed(&transform),
                    direction: None,
                    intensity: None,
                });
            }
        }
        for (i, camera) in still(&model.cameras, &animated.cameras) {
            if let Some((camera, rest)) = indices.cameras[i].zip(camera.transformed(&transform)) {
                let (aim, lens) = (None, None);
                animation.objects.push(Animated::Camera { camera, node, rest, aim, lens });
            }
        }
    }
}

/// Returns the objects that are not animated, with their indices.
fn still<'a, T>(
    objects: &'a [T],
    animated: &'a HashSet<usize>,
) -> impl Iterator<Item = (usize, &'a T)> {
    objects.iter().enumerate().filter(|(i, _)| !animated.contains(i))
}
