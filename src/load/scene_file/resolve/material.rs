//! The materials of a scene file.

use glam::Vec3;

use super::{MAX_NAMED, Resolver};
use crate::error::Result;
use crate::load::scene_file::color::Color;
use crate::load::scene_file::spanned::{At, Table};
use crate::load::scene_file::tables::{MapAlpha, MapFilter, MaterialTable};
use crate::load::spelling;
use crate::scene::{
    AlphaMode, Channel, Coverage, Material, MaterialId, NormalMap, TextureId, Transfer,
};

/// How a picture is read, if it is.
#[derive(Clone, Copy)]
struct Reading {
    transfer: Transfer,
    filter: MapFilter,
    wanted: bool,
}

impl Resolver<'_> {
    /// A colour as the film reads colours.
    pub(super) fn color(&self, color: Option<Color>, default: Vec3) -> Vec3 {
        color.map_or(default, |c| c.linear(self.scene.film.transfer))
    }

    /// Adds a material.
    pub(super) fn material(&mut self, table: &At<Table<MaterialTable>>) -> Result<()> {
        let table = &table.value.0;
        let At { span, value: name } = &table.name;
        let default = Material::default();
        let wanted = self.shown.material(name);
        let filter = table.filter.unwrap_or_default();
        let colors = Reading { transfer: Transfer::Srgb, filter, wanted };
        let data = Reading { transfer: Transfer::None, ..colors };
        let diffuse_map = self.picture(table.diffuse_map.as_ref(), &colors)?;
        let coverage = self.coverage(table, diffuse_map)?;
        let is_blended = coverage.is_some_and(|c| c.mode == AlphaMode::Blend);
        let normal_map = self.picture(table.normal_map.as_ref(), &data)?;
        let material = Material {
            name: name.clone(),
            diffuse: self.color(table.diffuse.as_ref().map(|c| c.value), default.diffuse),
            diffuse_map,
            specular: self.color(table.specular, default.specular),
            specular_map: self.picture(table.specular_map.as_ref(), &colors)?,
            shininess: table.shininess.map_or(default.shininess, |s| s.0 as f32),
            emission: self.color(table.emission, default.emission),
            emission_map: self.picture(table.emission_map.as_ref(), &colors)?,
            normal_map: normal_map.map(|texture| NormalMap { texture, scale: 1.0 }),
            coverage,
            reflect: self.color(table.reflect.as_ref().map(|c| c.value), default.reflect),
            transmit: self.color(table.transmit.as_ref().map(|c| c.value), default.transmit),
            ior: if is_blended { 1.0 } else { table.ior.map_or(default.ior, |ior| ior.0) },
            absorption: table.absorption.map_or(default.absorption, |a| a.0),
            thin: is_blended || table.thin.unwrap_or(default.thin),
            priority: table.priority.map_or(default.priority, |p| p.0),
            double_sided: table.double_sided.unwrap_or(default.double_sided),
            ..default
        };
        if let Some(At { span, .. }) = &table.diffuse
            && material.diffuse.max_element() > 1.0
        {
            self.too_bright += 1;
            // To find a line takes as long as there are lines before it.
            if self.too_bright <= MAX_NAMED {
                self.report.warnings.push(format!(
                    "{}: the material `{name}` scatters more light than it gets (numbers in \
                     `diffuse` go from 0 to 1; for values from 0 to 255 write \"#rrggbb\")",
                    self.source.shown(span)
                ));
            }
        }
        if let Some(At { span, .. }) = table.transmit.as_ref().or(table.reflect.as_ref())
            && (material.reflect + material.transmit).max_element() > 1.0 + 1e-6
        {
            let message = "`reflect` and `transmit` are more than 1 together";
            let help = "they are shares of one whole; what they leave is diffuse and specular";
            return Err(self.source.error(span, message).help(help));
        }
        let id = self.scene.add_material(material);
        match self.materials.insert(name.clone(), (id, span.clone())) {
            None => Ok(()),
            Some((_, first)) => {
                let message = format!("there is a material `{name}` already");
                let line = self.source.line(&first);
                let help = format!("the first is in line {line}; give each a name of its own");
                Err(self.source.error(span, message).help(help))
            }
        }
    }

    /// The texture for a picture that a material names.
    fn picture(&mut self, file: Option<&At<String>>, read: &Reading) -> Result<Option<TextureId>> {
        let Reading { transfer, filter, wanted } = *read;
        let Self { pictures, source, guard, scene, .. } = self;
        let texture =
            |file| pictures.texture((*source, *guard), file, transfer, filter, wanted, scene);
        file.map(texture).transpose()
    }

    /// What the alpha of a material's picture means, if it means anything.
    fn coverage(
        &self,
        table: &MaterialTable,
        picture: Option<TextureId>,
    ) -> Result<Option<Coverage>> {
        let mode = table.alpha_mode.as_ref();
        let is_mask = mode.is_some_and(|mode| mode.value == MapAlpha::Mask);
        if let Some(At { span, .. }) = table.alpha_cutoff.as_ref().filter(|_| !is_mask) {
            let message = "`alpha_cutoff` is about a mask, and there is none";
            return Err(self.source.error(span, message).help("add `alpha_mode = \"mask\"`"));
        }
        let Some(At { span, value }) = mode else { return Ok(None) };
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
        let Some(texture) = picture else {
            let message = "`alpha_mode` is about the alpha of a picture, and there is none";
            return Err(self.source.error(span, message).help("add a `diffuse_map`"));
        };
        Ok(Some(Coverage { alpha: 1.0, map: Some(Channel { texture, channel: 3 }), mode }))
    }

    /// The material with a name.
    ///
    /// # Errors
    /// When there is none; the message lists those that there are.
    pub fn named(&self, name: &At<String>) -> Result<MaterialId> {
        let At { span, value: name } = name;
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

    /// The material with a name, or a plain grey.
    pub(super) fn named_or_plain(&mut self, name: Option<&At<String>>) -> Result<MaterialId> {
        match name {
            Some(name) => self.named(name),
            None => Ok(*self.plain.get_or_insert_with(|| {
                let plain = Material { name: "default".to_owned(), ..Material::default() };
                self.scene.add_material(plain)
            })),
        }
    }
}
