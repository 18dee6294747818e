//! Putting meshes and shapes where their nodes are.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::{Importer, Made};
use crate::error::Result;
use crate::load::gltf::nodes::Placed;
use crate::load::gltf::primitive::Part;
use crate::load::gltf::shapes::{self, Shape};
use crate::scene::animation::Animated;
use crate::scene::{Instance, Plane, Sphere};

impl Importer<'_> {
    /// Puts a mesh at some places of a node.
    pub(super) fn place(
        &mut self,
        part: &Made,
        placed: &Placed,
        places: &[DAffine3],
        by: &str,
    ) -> Result<()> {
        let (mesh, is_bent) = self.shape(part, placed)?;
        if is_bent {
            let once = u64::from(places.len() > 1);
            let reason = "{} skinned meshes stand once, whatever the instances of their node";
            self.tally.unsupported(reason, once, || by.to_owned());
            // Its joints say where it is, whatever node it hangs on.
            let stands = Instance::new(mesh, DAffine3::IDENTITY, part.material);
            self.scene.instances.push(stands);
            return Ok(());
        }
        for place in places {
            let instance = Instance::new(mesh, placed.world * *place, part.material);
            // What moves may be flat at one time and not at another.
            if let Some(node) = placed.mover {
                let (instance, transform) = (self.scene.instances.len(), placed.rest * *place);
                self.clip.movers.push(Animated::Instance { instance, node, transform });
            } else if instance.is_flat() {
                let reason = "{} meshes are not drawn where their scale is 0 along some direction";
                self.tally.add(reason, 1, || by.to_owned());
                continue;
            }
            self.scene.instances.push(instance);
        }
        Ok(())
    }

    /// Puts a shape where its node is.
    pub(super) fn implicit(
        &mut self,
        shape: Shape,
        material: Option<usize>,
        placed: &Placed,
    ) -> Result<()> {
        let at = format!("nodes[{}].extensions.KHR_implicit_shapes", placed.index);
        let by = format!("{at}.material");
        let material = self.materials.get(material, &by, &mut self.scene, &mut self.tally)?.id;
        let mesh = match shape {
            Shape::Sphere(radius) => match shapes::sphere_under(&placed.world, radius) {
                Some((center, radius)) => {
                    if let Some(node) = placed.mover {
                        let (sphere, center) = (self.scene.spheres.len(), placed.rest.translation);
                        let (node, radius) = (Some(node), None);
                        self.clip.movers.push(Animated::Sphere { sphere, node, center, radius });
                    }
                    self.scene.spheres.push(Sphere::new(center, radius, material));
                    return Ok(());
                }
                None => shapes::ball(radius),
            },
            Shape::Plane => {
                let normal = placed.world.matrix3.inverse().transpose() * DVec3::Y;
                let still = u64::from(placed.mover.is_some());
                self.tally
                    .unsupported("{} planes stand still on nodes that move", still, || at.clone());
                match normal.try_normalize() {
                    Some(normal) => {
                        let point = placed.world.translation;
                        self.scene.planes.push(Plane::new(point, normal, material));
                    }
                    None => self.tally.add("{} planes have no direction", 1, || at),
                }
                return Ok(());
            }
            Shape::Mesh(mesh) => *mesh,
        };
        let part = Part { mesh: Arc::new(mesh), morphs: [].into(), influences: None };
        let made = Made { part, material, stored: None };
        self.place(&made, placed, &[DAffine3::IDENTITY], &at)
    }
}
