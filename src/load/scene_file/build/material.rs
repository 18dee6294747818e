//! The materials.

use glam::Vec3;

use super::SceneBuilder;
use super::textures::Sampling;
use crate::error::Result;
use crate::load::scene_file::schema::color::Color;
use crate::load::scene_file::schema::material_table::{MapAlpha, MaterialTable};
use crate::load::scene_file::schema::spanned::Spanned;
use crate::load::spelling;
use crate::scene::{
    AlphaMode, Channel, Coverage, Material, MaterialId, NormalMap, TextureId, Transfer,
};

/// The number of materials that are named in warnings of too bright colours; the others are counted.
const MAX_WARNINGS: u64 = 100;

impl SceneBuilder<'_> {
    /// Adds a material.
    ///
    /// # Errors
    /// When its keys do not fit each other, an image is not there, or the name is taken.
    pub fn add_material(&mut self, table: &MaterialTable) -> Result<()> {
        let Spanned { span, value: name } = &table.name;
        let material = if self.geometry_only {
            Material { name: name.clone(), ..Material::default() }
        } else {
            let mut material = self.material(table)?;
            self.check_energy(table, &material)?;
            self.set_pbr(table, &mut material)?;
            material
        };
        let id = self.scene.add_material(material);
        let Some((_, first)) = self.materials.insert(name.clone(), (id, span.clone())) else {
            return Ok(());
        };
        let message = format!("there is a material `{name}` already");
        let line = self.source.line(&first);
        let help = format!("the first is in line {line}; give each a name of its own");
        Err(self.source.error(span, message).help(help))
    }

    /// Returns the material that a table describes.
    fn material(&mut self, table: &MaterialTable) -> Result<Material> {
        let default = Material::default();
        // The textures, in the order in which their errors are reported.
        let is_needed = self.image_use.uses_material(&table.name.value);
        let filter = table.filter.unwrap_or_default();
        let colors = Sampling { transfer: Transfer::Srgb, filter };
        let diffuse_map = self.texture(table.diffuse_map.as_ref(), colors, is_needed)?;
        let coverage = self.coverage(table, diffuse_map)?;
        let normals = Sampling { transfer: Transfer::None, filter };
        let normal_map = self.texture(table.normal_map.as_ref(), normals, is_needed)?;
        let specular_map = self.texture(table.specular_map.as_ref(), colors, is_needed)?;
        let emission_map = self.texture(table.emission_map.as_ref(), colors, is_needed)?;
        // What is blended is a thin sheet that refracts nothing.
        let is_blended = coverage.is_some_and(|c| c.mode == AlphaMode::Blend);
        let transfer = self.scene.film.transfer;
        let color =
            |color: Option<Color>, default| color.map_or(default, |c| c.to_linear(transfer));
        let emission = color(table.emission, default.emission);
        if let Some(Spanned { span, value: true }) = &table.illuminates
            && emission == Vec3::ZERO
        {
            let message = "a material that illuminates needs the key `emission`, and not 0";
            return Err(self.source.error(&self.source.key_span("illuminates", span), message));
        }
        Ok(Material {
            name: table.name.value.clone(),
            diffuse: color(table.diffuse.as_ref().map(|c| c.value), default.diffuse),
            diffuse_map,
            specular: color(table.specular.as_ref().map(|c| c.value), default.specular),
            specular_map,
            shininess: table.shininess.as_ref().map_or(default.shininess, |s| s.value.0 as f32),
            emission,
            illuminates: table.illuminates.as_ref().is_some_and(|illuminates| illuminates.value),
            emission_map,
            normal_map: normal_map.map(|texture| NormalMap { texture, scale: 1.0 }),
            coverage,
            reflect: color(table.reflect.as_ref().map(|c| c.value), default.reflect),
            transmit: color(table.transmit.as_ref().map(|c| c.value), default.transmit),
            ior: if is_blended { 1.0 } else { table.ior.map_or(default.ior, |ior| ior.0) },
            absorption: table.absorption.map_or(default.absorption, |a| a.0),
            thin: is_blended || table.thin.unwrap_or(default.thin),
            priority: table.priority.map_or(default.priority, |p| p.0),
            double_sided: table.double_sided.unwrap_or(default.double_sided),
            ..default
        })
    }

    /// Checks that a material sends on no more light than it gets; warns where only its diffuse
    /// colour does.
    fn check_energy(&mut self, table: &MaterialTable, material: &Material) -> Result<()> {
        if let Some(Spanned { span, .. }) = &table.diffuse
            && material.diffuse.max_element() > 1.0
        {
            self.too_bright += 1;
            // To find a line takes as long as there are lines before it.
            if self.too_bright <= MAX_WARNINGS {
                let name = &material.name;
                self.report.warnings.push(format!(
                    "{}: the material `{name}` scatters more light than it gets (numbers in \
                     `diffuse` go from 0 to 1; for values from 0 to 255 write \"#rrggbb\")",
                    self.source.location(span)
                ));
            }
        }
        if let Some(Spanned { span, .. }) = table.transmit.as_ref().or(table.reflect.as_ref())
            && (material.reflect + material.transmit).max_element() > 1.0 + 1e-6
        {
            let message = "`reflect` and `transmit` are more than 1 together";
            let help = "they are shares of one whole; what they leave is diffuse and specular";
            return Err(self.source.error(span, message).help(help));
        }
        Ok(())
    }

    /// Returns the coverage by the alpha of a material's diffuse map, if it has any meaning.
    fn coverage(
        &self,
        table: &MaterialTable,
        diffuse_map: Option<TextureId>,
    ) -> Result<Option<Coverage>> {
        let mode = table.alpha_mode.as_ref();
        let is_mask = mode.is_some_and(|mode| mode.value == MapAlpha::Mask);
        if let Some(Spanned { span, .. }) = table.alpha_cutoff.as_ref().filter(|_| !is_mask) {
            let message = "`alpha_cutoff` is about a mask, and there is none";
            return Err(self.source.error(span, message).help("add `alpha_mode = \"mask\"`"));
        }
        let Some(Spanned { span, value }) = mode else { return Ok(None) };
        let mode = match value {
            MapAlpha::Opaque => return Ok(None),
            MapAlpha::Mask => {
                let cutoff = table.alpha_cutoff.as_ref().map_or(0.5, |at| at.value.0 as f32);
                AlphaMode::Mask { cutoff }
            }
            MapAlpha::Blend if table.transmit.is_some() => {
                let message = "`transmit` and a blended alpha both say what is seen through it";
                return Err(self.source.error(span, message).help("leave one of them out"));
            }
            MapAlpha::Blend => AlphaMode::Blend,
        };
        let Some(texture) = diffuse_map else {
            let message = "`alpha_mode` is about the alpha of an image, and there is none";
            return Err(self.source.error(span, message).help("add a `diffuse_map`"));
        };
        Ok(Some(Coverage { alpha: 1.0, map: Some(Channel { texture, channel: 3 }), mode }))
    }

    /// Returns the material with a name.
    ///
    /// # Errors
    /// When there is none; the message lists those that there are.
    pub fn find_material(&self, name: &Spanned<String>) -> Result<MaterialId> {
        let Spanned { span, value: name } = name;
        self.materials.get(name).map(|(id, _)| *id).ok_or_else(|| {
            let materials = &self.scene.materials[..self.materials.len()];
            let names: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
            let help = if names.is_empty() {
                "the file has none: add a [[material]] with this name".to_owned()
            } else {
                spelling::choice(name, &names, "materials")
            };
            self.source.error(span, format!("there is no material `{name}`")).help(help)
        })
    }

    /// Returns the material with a name, or the default material.
    ///
    /// # Errors
    /// When there is no material of this name.
    pub fn material_or_default(&mut self, name: Option<&Spanned<String>>) -> Result<MaterialId> {
        if let Some(name) = name {
            return self.find_material(name);
        }
        let scene = &mut self.scene;
        Ok(*self.default_material.get_or_insert_with(|| {
            scene.add_material(Material { name: "default".to_owned(), ..Material::default() })
        }))
    }

    /// Warns of the materials that are too bright beyond those that were named.
    pub fn warn_of_bright_materials(&mut self) {
        if let more @ 1.. = self.too_bright.saturating_sub(MAX_WARNINGS) {
            let file = self.source.location(&(0..0));
            let warning = format!("{file}: {more} more materials scatter more than they get");
            self.report.warnings.push(warning);
        }
    }
}
