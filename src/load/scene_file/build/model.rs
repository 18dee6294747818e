//! The models, and their motion.

use std::path::{Path, PathBuf};

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::SceneBuilder;
use crate::error::{Error, Result};
use crate::load::limits::Limit;
use crate::load::merge::{MergedModel, ModelInstance};
use crate::load::sandbox::OpenedFile;
use crate::load::scene_file::schema::spanned::Spanned;
use crate::load::scene_file::schema::tables::ModelTable;
use crate::load::{self, Loaded, ModelOptions};
use crate::scene::check::MAX_COORDINATE;
use crate::scene::{Material, Scene, ShadingModel, TableKind};

/// The key by which a model is loaded once, however often a scene file names it.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct ModelKey {
    /// The canonical path of the file.
    path: PathBuf,
    /// The name of the animation that it plays.
    animation: Option<String>,
    /// The name of the variant of its materials.
    variant: Option<String>,
    /// The shading model of its materials.
    shading: Option<ShadingModel>,
    /// True if its surfaces that emit light illuminate others.
    illuminates: bool,
}

impl SceneBuilder<'_> {
    /// Adds an instance of a model, as the table of this index describes it; the model is loaded if it has
    /// not been before.
    ///
    /// # Errors
    /// When the file cannot be read or has no such animation or variant, there is no such material,
    /// or the instance is too large or one too many.
    pub fn add_model(&mut self, index: usize, table: &ModelTable) -> Result<()> {
        let name = table.material.as_ref();
        let material = name.map(|name| self.find_material(name)).transpose()?;
        let key = self.load_model(table)?;
        let provenance = self.provenance_of_table(TableKind::Model, index, table.name.as_ref());
        let model = &self.models[&key];
        let source = self.source;
        let span = &table.file.span;
        let still = transform(table);
        if model.max_coordinate(&still) > MAX_COORDINATE {
            return Err(source
                .error(span, "the model reaches beyond 1e15 from 0 as it is placed")
                .help("make its `scale` or `translate` smaller"));
        }
        self.model_objects += model.object_count();
        let limited = self.sandbox.check(Limit::Instances, self.model_objects);
        limited.map_err(|e| source.locate(span, e))?;
        let motion = self.motion(&table.name);
        // A keyed node does all that the table's transform does.
        let is_keyed = motion.is_some_and(|motion| motion.is_keyed);
        let instance = ModelInstance {
            transform: if is_keyed { DAffine3::IDENTITY } else { still },
            node: motion.and_then(|motion| motion.node),
            material,
            casts_shadow: table.casts_shadow.unwrap_or(true),
            has_lights: table.lights.unwrap_or(true),
            provenance,
        };
        model.instantiate(&mut self.scene, &instance, &mut self.report.warnings);
        Ok(())
    }

    /// Loads a model, unless it is loaded already, and merges what it is made of into the scene.
    fn load_model(&mut self, table: &ModelTable) -> Result<ModelKey> {
        let file = self.open_model(&table.file)?;
        let own_variant = table.variant.as_ref().map(|name| &*name.value);
        let key = ModelKey {
            path: file.identity.clone(),
            animation: table.animation.as_ref().map(|name| name.value.clone()),
            variant: own_variant.or(self.variant).map(str::to_owned),
            shading: table.shading.or(self.shading),
            illuminates: table.illuminates.as_ref().is_some_and(|illuminates| illuminates.value),
        };
        if self.models.contains_key(&key) {
            return Ok(key);
        }
        // The model, in a scene of its own.
        let path = file.path.clone();
        let options = ModelOptions {
            animation: key.animation.as_deref(),
            variant: key.variant.as_deref(),
            needs_images: self.image_use.uses_materials_of_model(&path),
            geometry_only: self.geometry_only,
            provenance: self.scene.provenance.is_some(),
            shading: key.shading,
        };
        let Loaded { scene: mut model, report } = load::model(file, self.sandbox, &options)?;
        if let Some(Spanned { span, value }) = &table.variant {
            load::check_variant(value, &report).map_err(|e| self.source.locate(span, e))?;
        }
        // Each of the warnings names the model already.
        self.report.add(report);
        if self.scene.animation.is_none() && model.animation.take().is_some() {
            self.report.warnings.push(format!(
                "{}: its animation is not played: the scene has no [animation]",
                path.display()
            ));
        }
        self.set_illuminates(&mut model, &path, key.illuminates);
        self.models.insert(key.clone(), MergedModel::merge(&mut self.scene, model));
        Ok(key)
    }

    /// Makes the materials of a model that emit light illuminate other surfaces, or not. An unlit
    /// material shows its colour, and is no light.
    fn set_illuminates(&mut self, model: &mut Scene, path: &Path, illuminates: bool) {
        let emits = |material: &Material| material.emission != Vec3::ZERO && !material.unlit;
        for material in &mut model.materials {
            material.illuminates = illuminates && emits(material);
        }
        if illuminates && !self.geometry_only && !model.materials.iter().any(emits) {
            let path = path.display();
            let warning = format!("{path}: nothing emits light, and so it illuminates nothing");
            self.report.warnings.push(warning);
        }
    }

    /// Opens a model file. An error of its name is one of the scene file and is reported there.
    fn open_model(&self, name: &Spanned<String>) -> Result<OpenedFile> {
        let Spanned { span, value: name } = name;
        let source = self.source;
        let opened = match load::extension(&source.resolve_path(name)).as_str() {
            "gltf" | "glb" | "vrm" | "obj" => self.sandbox.open(source.folder(), &[name]),
            "toml" => Err(Error::input("a scene file cannot stand in another one")),
            _ => Err(Error::input("this kind of file is not read")
                .help("a model ends in .gltf, .glb or .obj")),
        };
        opened.map_err(|e| source.unreadable(span, "model", name, &e))
    }
}

/// Returns the transform translate · rotate · scale, the rotation about the fixed x axis first, then
/// y, then z.
fn transform(table: &ModelTable) -> DAffine3 {
    let scale = table.scale.map_or(DVec3::ONE, |scale| scale.0);
    let [x, y, z] = table.rotate.map_or([0.0; 3], |angles| angles.0);
    let rotation = rotate(DVec3::Z, z) * rotate(DVec3::Y, y) * rotate(DVec3::X, x);
    let translation = table.translate.map_or(DVec3::ZERO, |t| t.0);
    DAffine3 { matrix3: rotation * DMat3::from_diagonal(scale), translation }
}

/// Returns the rotation about a coordinate axis by an angle in degrees; exact for quarter turns, so
/// that a model that is turned by 90° has walls as upright as before.
fn rotate(axis: DVec3, degrees: f64) -> DMat3 {
    let (sin, cos) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    };
    // What lies along the axis stays, to the bit; the rest is Rodrigues' formula.
    let [x, y, z] = axis.to_array();
    let stays = |along: f64| if along == 1.0 { 1.0 } else { cos };
    DMat3::from_cols(
        DVec3::new(stays(x), z * sin, -y * sin),
        DVec3::new(-z * sin, stays(y), x * sin),
        DVec3::new(y * sin, -x * sin, stays(z)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::scene_file::schema::values::{Point, Rotation, Scale};

    fn table(rotate: [f64; 3], scale: DVec3, translate: DVec3) -> ModelTable {
        ModelTable {
            name: None,
            file: Spanned { span: 0..0, value: String::new() },
            translate: Some(Point(translate)),
            rotate: Some(Rotation(rotate)),
            scale: Some(Scale(scale)),
            material: None,
            casts_shadow: None,
            illuminates: None,
            lights: None,
            animation: None,
            variant: None,
            shading: None,
        }
    }

    #[test]
    fn each_turn_is_counterclockwise_seen_against_its_axis() {
        let turned = |rotate, v| transform(&table(rotate, DVec3::ONE, DVec3::ZERO)).matrix3 * v;
        assert_eq!(turned([90.0, 0.0, 0.0], DVec3::Y), DVec3::Z);
        assert_eq!(turned([0.0, 90.0, 0.0], DVec3::Z), DVec3::X);
        assert_eq!(turned([0.0, 0.0, 90.0], DVec3::X), DVec3::Y);
    }

    #[test]
    fn turns_are_about_fixed_axes_x_first_and_z_last() {
        let matrix = transform(&table([90.0, 0.0, 90.0], DVec3::ONE, DVec3::ZERO)).matrix3;
        // y goes to z by the first turn, and the last one leaves z alone.
        assert_eq!(matrix * DVec3::Y, DVec3::Z);
    }

    #[test]
    fn any_angle_agrees_with_glam() {
        for degrees in [-725.0, -90.0, 0.1, 33.0, 180.0, 359.0] {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let theirs = DMat3::from_axis_angle(axis, f64::to_radians(degrees));
                assert!(rotate(axis, degrees).abs_diff_eq(theirs, 1e-12), "{axis} {degrees}");
            }
        }
    }

    #[test]
    fn scale_comes_first_and_translation_last() {
        let scale = DVec3::new(2.0, -3.0, 4.0);
        let placed = transform(&table([0.0, 0.0, 90.0], scale, DVec3::splat(10.0)));
        assert_eq!(placed.transform_point3(DVec3::ONE), DVec3::new(13.0, 12.0, 14.0));
    }
}
