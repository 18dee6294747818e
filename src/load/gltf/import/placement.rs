//! The placement of meshes and implicit shapes at nodes.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};

use super::implicit_shapes::ImplicitShape;
use super::instancing::MeshInstance;
use super::mesh::PrimitiveMesh;
use super::nodes::SceneNode;
use super::{ImportedPrimitive, Importer, provenance};
use crate::error::Result;
use crate::scene::animation::Animated;
use crate::scene::{Instance, MaterialId, Plane, Sphere};

impl Importer<'_> {
    /// Adds instances of a primitive to the scene, in the space of a node.
    pub(super) fn add_mesh(
        &mut self,
        primitive: &ImportedPrimitive,
        node: &SceneNode,
        instances: &[MeshInstance],
        by: &str,
    ) -> Result<()> {
        let (mesh, is_skinned) = self.mesh_at_node(primitive, node)?;
        if is_skinned {
            let instanced = u64::from(instances.len() > 1);
            let reason = "{} skinned meshes stand once, whatever the instances of their node";
            self.diagnostics.unsupported(reason, instanced, || by.to_owned());
            // The joints place the mesh, whatever the transform of the node.
            let instance = Instance::new(mesh, DAffine3::IDENTITY, primitive.material);
            self.scene.instances.push(instance);
            self.record_instance(primitive, node, None);
            return Ok(());
        }
        for (i, &MeshInstance { transform, color }) in (0..).zip(instances) {
            let material = self.colored(primitive.material, color);
            let instance = Instance::new(mesh, node.to_world * transform, material);
            // An instance that moves may be flat at one time and not at another.
            if let Some(animated) = node.animated {
                self.clip.objects.push(Animated::Instance {
                    instance: self.scene.instances.len(),
                    node: animated,
                    transform: node.to_animated * transform,
                });
            } else if instance.is_flat() {
                let reason = "{} meshes are not drawn where their scale is 0 along some direction";
                self.diagnostics.add(reason, 1, || by.to_owned());
                continue;
            }
            self.scene.instances.push(instance);
            self.record_instance(primitive, node, (instances.len() > 1).then_some(i));
        }
        Ok(())
    }

    /// Returns the id of a material in the colour and alpha of an instance.
    fn colored(&mut self, material: MaterialId, color: [f32; 4]) -> MaterialId {
        if color == [1.0; 4] || self.materials.geometry_only {
            return material;
        }
        let key = (material, color.map(f32::to_bits));
        *self.colored.entry(key).or_insert_with(|| {
            let [r, g, b, alpha] = color;
            let mut colored = self.scene.materials[material.0 as usize].clone();
            colored.multiply_base(Vec3::new(r, g, b));
            if let Some(coverage) = &mut colored.coverage {
                coverage.alpha = (coverage.alpha * alpha).min(1.0);
            }
            self.scene.add_material(colored)
        })
    }

    /// Adds the implicit shape of a node to the scene, with the material of an index in the file.
    pub(super) fn add_shape(
        &mut self,
        shape: ImplicitShape,
        material: Option<usize>,
        node: &SceneNode,
    ) -> Result<()> {
        let path = format!("nodes[{}].extensions.KHR_implicit_shapes", node.index);
        // The material is that which the node names beside the shape.
        let by = format!("{path}.material");
        let (scene, diagnostics) = (&mut self.scene, &mut self.diagnostics);
        let material_index = material;
        let (material, _) = self.materials.material(material, &by, scene, diagnostics)?;

        // Spheres and planes are added as what they are.
        let mesh = match shape {
            ImplicitShape::Sphere(radius) => {
                if node.animated.is_some() {
                    self.clip.objects.push(Animated::Sphere {
                        sphere: scene.spheres.len(),
                        node: node.animated,
                        center: node.to_animated.translation,
                        radius: None,
                    });
                }
                scene.spheres.push(Sphere::new(node.to_world.translation, radius, material));
                if let Some(table) = scene.provenance_mut() {
                    table.spheres.push(provenance::of_node(node, None, material_index));
                }
                return Ok(());
            }
            ImplicitShape::Plane => {
                let is_animated = u64::from(node.animated.is_some());
                let reason = "{} planes stand still on nodes that move";
                diagnostics.unsupported(reason, is_animated, || path.clone());
                // The plane faces along Y of its node, however that is scaled.
                let normal = node.to_world.matrix3.inverse().transpose() * DVec3::Y;
                match normal.try_normalize() {
                    Some(normal) => {
                        let point = node.to_world.translation;
                        scene.planes.push(Plane::new(point, normal, material));
                        if let Some(table) = scene.provenance_mut() {
                            table.planes.push(provenance::of_node(node, None, material_index));
                        }
                    }
                    None => diagnostics.add("{} planes have no direction", 1, || path),
                }
                return Ok(());
            }
            ImplicitShape::Mesh(mesh) => *mesh,
        };

        // All other shapes are meshes, placed like those of the file.
        let mesh = PrimitiveMesh {
            mesh: Arc::new(mesh),
            morph_targets: [].into(),
            influences: None,
            faces: Arc::default(),
        };
        let primitive = ImportedPrimitive { mesh, material, material_index, indices: None };
        self.add_mesh(&primitive, node, &[MeshInstance::PLAIN], &path)
    }
}
