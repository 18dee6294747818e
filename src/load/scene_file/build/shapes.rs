//! The spheres and planes, and the motion of spheres.

use glam::DVec3;

use super::SceneBuilder;
use crate::error::Result;
use crate::load::scene_file::schema::spanned::{Spanned, Table};
use crate::load::scene_file::schema::tables::{PlaneTable, SphereTable};
use crate::scene::animation::Animated;
use crate::scene::check::MAX_COORDINATE;
use crate::scene::{Checker, Plane, Sphere, TableKind};

impl SceneBuilder<'_> {
    /// Adds the sphere of a table with this index.
    ///
    /// # Errors
    /// When it extends too far from the origin, or there is no such material.
    pub fn add_sphere(&mut self, index: usize, table: &SphereTable) -> Result<()> {
        let (center, Spanned { span, value: radius }) = (table.center.0, &table.radius);
        if center.abs().max_element() + radius.0 > MAX_COORDINATE {
            return Err(self.source.error(span, "the sphere reaches beyond 1e15 from 0"));
        }
        let material = self.material_or_default(table.material.as_ref())?;
        let animated = self.animated_sphere(table);
        self.add_animated(animated);
        self.scene.spheres.push(Sphere {
            casts_shadow: table.casts_shadow.unwrap_or(true),
            ..Sphere::new(center, radius.0, material)
        });
        let provenance = self.provenance_of_table(TableKind::Sphere, index, table.name.as_ref());
        if let Some(all) = self.scene.provenance_mut() {
            all.spheres.push(provenance);
        }
        Ok(())
    }

    /// Returns the animation of the next sphere of the scene, if it has one.
    fn animated_sphere(&self, table: &SphereTable) -> Option<Animated> {
        let motion = self.motion(&table.name)?;
        let radius = motion.curves.radius.as_ref().map(|curve| curve.value.clone());
        if motion.node.is_none() && radius.is_none() {
            return None;
        }
        let center = if motion.is_keyed { DVec3::ZERO } else { table.center.0 };
        let sphere = self.scene.spheres.len();
        Some(Animated::Sphere { sphere, node: motion.node, center, radius })
    }

    /// Adds the plane of a table with this index.
    ///
    /// # Errors
    /// When there is no such material, or it illuminates.
    pub fn add_plane(&mut self, index: usize, table: &PlaneTable) -> Result<()> {
        let material = self.material_or_default(table.material.as_ref())?;
        if let Some(Spanned { span, .. }) = &table.material
            && self.scene.materials[material.0 as usize].illuminates
        {
            let help =
                "illuminate with a light, a sphere or a mesh; or drop the material's `illuminates`";
            return Err(self.source.error(span, "an infinite plane cannot illuminate").help(help));
        }
        let transfer = self.scene.film.transfer;
        let checker = table.checker.as_ref().map(|Table(checker)| Checker {
            colors: checker.colors.0.map(|c| c.to_linear(transfer)),
            size: checker.size.map_or(1.0, |size| size.0),
        });
        self.scene.planes.push(Plane {
            checker,
            texture_size: table.texture_size.map_or(1.0, |size| size.0),
            casts_shadow: table.casts_shadow.unwrap_or(true),
            ..Plane::new(table.point.0, table.normal.0, material)
        });
        let provenance = self.provenance_of_table(TableKind::Plane, index, None);
        if let Some(all) = self.scene.provenance_mut() {
            all.planes.push(provenance);
        }
        Ok(())
    }
}
