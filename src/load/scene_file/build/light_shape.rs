//! The shapes by which lights with an extent are seen: surfaces that emit, and cast no shadow.

use glam::{DAffine3, DMat3, DVec3};

use super::SceneBuilder;
use crate::error::Result;
use crate::geometry::sampling::tangents;
use crate::load::scene_file::schema::light_tables::LightTable;
use crate::load::scene_file::schema::spanned::Spanned;
use crate::scene::animation::Animated;
use crate::scene::{
    Instance, Light, LightKind, LightShape, Material, Mesh, MeshProvenance, Sphere, TableKind,
};

/// The number of corners of the mesh by which a disk is seen: its rim is within 0.0003 of the radius.
const DISK_CORNERS: u32 = 128;

impl SceneBuilder<'_> {
    /// Adds the shape of the light of a table with this index, if the light has one and is visible, and returns it.
    ///
    /// # Errors
    /// When the light changes its intensity, which its shape cannot follow.
    pub fn add_light_shape(
        &mut self,
        index: usize,
        table: &LightTable,
        light: &Light,
    ) -> Result<Option<LightShape>> {
        let is_visible = table.visible.as_ref().is_none_or(|visible| visible.value);
        let shape = Shape::from_kind(&light.kind).filter(|_| is_visible);
        let Some(shape) = shape else { return Ok(None) };
        self.check_steady(table)?;
        // One-sided, as the light is.
        let material = self.scene.add_material(Material {
            name: format!("light {}", light.name).trim_end().to_owned(),
            cull_back_faces: matches!(shape, Shape::Flat { .. }),
            ..Material::emissive(light.intensity)
        });
        let provenance = self.provenance_of_table(TableKind::Light, index, table.name.as_ref());
        // Where a keyed node moves it, it is at the node's origin.
        let motion = self.motion(&table.name);
        let node = motion.and_then(|motion| motion.node);
        let is_keyed = motion.is_some_and(|motion| motion.is_keyed);
        let rest = |center: DVec3| if is_keyed { DVec3::ZERO } else { center };
        let scene = &mut self.scene;
        let (shape, animated) = match shape {
            Shape::Sphere { center, radius } => {
                let sphere = scene.spheres.len();
                let shape = Sphere::new(center, radius, material);
                scene.spheres.push(Sphere { casts_shadow: false, ..shape });
                if let Some(all) = scene.provenance_mut() {
                    all.spheres.push(provenance);
                }
                let (center, radius) = (rest(center), None);
                let animated = node.map(|_| Animated::Sphere { sphere, node, center, radius });
                (LightShape::Sphere(sphere as u32), animated)
            }
            Shape::Flat { mesh, axes, center } => {
                let (instance, mesh) = (scene.instances.len(), scene.add_mesh(mesh()));
                let transform = DAffine3 { matrix3: axes, translation: center };
                let shape = Instance::new(mesh, transform, material);
                scene.instances.push(Instance { casts_shadow: false, ..shape });
                if let Some(all) = scene.provenance_mut() {
                    all.meshes.push(MeshProvenance::default());
                    all.instances.push(provenance);
                }
                let transform = DAffine3 { matrix3: axes, translation: rest(center) };
                let animated = node.map(|node| Animated::Instance { instance, node, transform });
                (LightShape::Instance(instance as u32), animated)
            }
        };
        self.add_animated(animated);
        Ok(Some(shape))
    }

    /// Checks that no track changes the intensity of a light that is visible.
    fn check_steady(&self, table: &LightTable) -> Result<()> {
        let motion = self.motion(&table.name);
        let Some(Spanned { span, .. }) = motion.and_then(|m| m.curves.intensity.as_ref()) else {
            return Ok(());
        };
        let message = "the shape of a visible light cannot change its brightness";
        let key = self.source.key_span("intensity", span);
        let help = "give the light `visible = false`, or leave out this track";
        Err(self.source.error(&key, message).help(help))
    }
}

/// The shape of a light.
enum Shape {
    Sphere {
        center: DVec3,
        radius: f64,
    },
    /// A mesh in the plane z = 0, whose front is toward +z.
    Flat {
        mesh: fn() -> Mesh,
        /// The axes of its space, in world space.
        axes: DMat3,
        center: DVec3,
    },
}

impl Shape {
    /// Returns the shape of a light of this kind, if it has one.
    fn from_kind(kind: &LightKind) -> Option<Self> {
        match *kind {
            LightKind::Rectangle { center, u, v } => {
                let axes = DMat3::from_cols(u, v, u.cross(v).normalize());
                Some(Self::Flat { mesh: square, axes, center })
            }
            LightKind::Disk { center, normal, radius } => {
                let [a, b] = tangents(normal);
                let axes = DMat3::from_cols(a * radius, b * radius, normal);
                Some(Self::Flat { mesh: disk, axes, center })
            }
            LightKind::Sphere { center, radius } => Some(Self::Sphere { center, radius }),
            _ => None,
        }
    }
}

/// Returns the square from -1 to 1.
fn square() -> Mesh {
    Mesh {
        name: "rectangle".to_owned(),
        positions: vec![[-1.0f32, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]
            .into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// Returns the disk of radius 1, as a fan about its centre.
fn disk() -> Mesh {
    let rim = (0..DISK_CORNERS).map(|i| {
        let angle = f64::from(i) / f64::from(DISK_CORNERS) * std::f64::consts::TAU;
        [angle.cos() as f32, angle.sin() as f32, 0.0]
    });
    let triangle = |i: u32| [0, 1 + i, 1 + (i + 1) % DISK_CORNERS];
    Mesh {
        name: "disk".to_owned(),
        positions: std::iter::once([0.0f32; 3]).chain(rim).collect::<Vec<_>>().into(),
        triangles: (0..DISK_CORNERS).map(triangle).collect(),
        ..Mesh::default()
    }
}
