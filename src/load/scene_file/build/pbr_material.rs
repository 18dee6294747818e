//! The physically based materials: those that give `metallic` or `roughness`.

use glam::Vec3;

use super::SceneBuilder;
use super::textures::Sampling;
use crate::error::Result;
use crate::load::scene_file::schema::material_table::MaterialTable;
use crate::load::scene_file::schema::spanned::Spanned;
use crate::load::scene_file::schema::values::Share;
use crate::load::scene_file::source::Span;
use crate::load::spelling;
use crate::scene::{
    Channel, Material, MetallicRoughness, MetallicRoughnessMaps, ShadingModel, Transfer,
};

impl MaterialTable {
    /// True if the material is physically based.
    fn is_pbr(&self) -> bool {
        self.metallic.is_some() || self.roughness.is_some()
    }
}

/// Returns the span of a value, if it is given.
fn span<T>(value: &Option<Spanned<T>>) -> Option<&Span> {
    value.as_ref().map(|value| &value.span)
}

impl SceneBuilder<'_> {
    /// Makes a material physically based, if its table gives `metallic` or `roughness`. Its diffuse colour, with
    /// its image, is the base colour.
    ///
    /// # Errors
    /// When a key is of the other shading model, or an image cannot be read.
    pub fn set_pbr(&mut self, table: &MaterialTable, material: &mut Material) -> Result<()> {
        self.check_model(table)?;
        if !table.is_pbr() {
            return Ok(());
        }
        let share = |share: &Option<Spanned<Share>>, default: f32| {
            share.as_ref().map_or(default, |share| share.value.0 as f32)
        };
        let default = MetallicRoughness::default();
        let film_ior = table.iridescence_ior.as_ref().map(|ior| ior.value.0 as f32);
        let thickness = table.iridescence_thickness.as_ref().map(|x| x.value.0 as f32);
        let rotation = table.anisotropy_rotation.as_ref().map(|angle| angle.value.0.to_radians());
        let sheen = table.sheen_color.as_ref().map(|color| color.value);
        let transfer = self.scene.film.transfer;
        let factors = MetallicRoughness {
            base_color: material.diffuse.min(Vec3::ONE),
            metallic: share(&table.metallic, 0.0),
            roughness: share(&table.roughness, 0.5),
            ior: material.ior.max(1.0) as f32,
            transmission: share(&table.transmission, 0.0),
            is_thin: material.thin,
            clearcoat: share(&table.clearcoat, 0.0),
            clearcoat_roughness: share(&table.clearcoat_roughness, 0.0),
            sheen_color: sheen.map_or(Vec3::ZERO, |c| c.to_linear(transfer).min(Vec3::ONE)),
            sheen_roughness: share(&table.sheen_roughness, 0.3),
            anisotropy: share(&table.anisotropy, 0.0),
            anisotropy_rotation: rotation.unwrap_or(0.0) as f32,
            iridescence: share(&table.iridescence, 0.0),
            iridescence_ior: film_ior.unwrap_or(default.iridescence_ior).max(1.0),
            iridescence_thickness: thickness.unwrap_or(default.iridescence_thickness),
            dispersion: table.dispersion.as_ref().map_or(0.0, |x| x.value.0 as f32),
            diffuse_transmission: share(&table.diffuse_transmission, 0.0),
            diffuse_transmission_color: material.diffuse.min(Vec3::ONE),
            ..default
        };
        // The green channel of the map is the roughness, and the blue one the metalness, as in glTF.
        let is_needed = self.image_use.uses_material(&table.name.value);
        let filter = table.filter.unwrap_or_default();
        let data = Sampling { transfer: Transfer::None, filter };
        let map = self.texture(table.metallic_roughness_map.as_ref(), data, is_needed)?;
        let channel = |channel| map.map(|texture| Channel { texture, channel });
        material.shading = ShadingModel::Pbr;
        material.set_metallic_roughness(MetallicRoughnessMaps {
            base_color: material.diffuse_map,
            roughness: channel(1),
            metallic: channel(2),
            ..MetallicRoughnessMaps::new(factors)
        });
        Ok(())
    }

    /// Checks that a material has no key of the shading model that it does not have.
    fn check_model(&self, table: &MaterialTable) -> Result<()> {
        let of_phong = [
            ("specular", span(&table.specular)),
            ("specular_map", span(&table.specular_map)),
            ("shininess", span(&table.shininess)),
            ("reflect", span(&table.reflect)),
            ("transmit", span(&table.transmit)),
        ];
        let of_pbr = [
            ("transmission", span(&table.transmission)),
            ("metallic_roughness_map", span(&table.metallic_roughness_map)),
            ("clearcoat", span(&table.clearcoat)),
            ("clearcoat_roughness", span(&table.clearcoat_roughness)),
            ("sheen_color", span(&table.sheen_color)),
            ("sheen_roughness", span(&table.sheen_roughness)),
            ("anisotropy", span(&table.anisotropy)),
            ("anisotropy_rotation", span(&table.anisotropy_rotation)),
            ("iridescence", span(&table.iridescence)),
            ("iridescence_ior", span(&table.iridescence_ior)),
            ("iridescence_thickness", span(&table.iridescence_thickness)),
            ("dispersion", span(&table.dispersion)),
            ("diffuse_transmission", span(&table.diffuse_transmission)),
        ];
        let (foreign, help) = if table.is_pbr() {
            let names = of_pbr.map(|(key, _)| key);
            let keys = spelling::list(&names);
            let help = "`metallic` and `roughness` make it physically based, with the keys diffuse (its base \
                        colour), ";
            (&of_phong[..], format!("{help}{keys}"))
        } else {
            (&of_pbr[..], "add `roughness`, which makes it physically based".to_owned())
        };
        for (key, span) in foreign {
            if let Some(span) = span {
                let model = if table.is_pbr() { "Phong's" } else { "the physically based" };
                let message =
                    format!("`{key}` is a key of {model} model, and the material has the other");
                let span = self.source.key_span(key, span);
                return Err(self.source.error(&span, message).help(help));
            }
        }
        Ok(())
    }
}
