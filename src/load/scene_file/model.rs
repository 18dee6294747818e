//! The models of a scene file.

use std::collections::HashMap;
use std::path::PathBuf;

use glam::{DAffine3, DMat3, DVec3};

use super::resolve::Resolver;
use super::spanned::At;
use super::tables::ModelTable;
use crate::error::{Error, Result};
use crate::load::limits::Limit;
use crate::load::merge::{MergedModel, Placement};
use crate::load::sandbox::OpenedFile;
use crate::load::{self, Choice, Loaded};
use crate::scene::check::MAX_COORDINATE;

/// The model files loaded so far, by their canonical paths, the animations that they play and the
/// variants that they show.
#[derive(Default)]
pub struct Models {
    loaded: HashMap<(PathBuf, Option<String>, Option<String>), MergedModel>,
    /// What stands in the scene so far.
    placed: u64,
}

impl Models {
    /// Places a model in the scene; a file named twice is loaded once.
    pub fn place(&mut self, resolver: &mut Resolver<'_>, table: &ModelTable) -> Result<()> {
        let material = table.material.as_ref().map(|name| resolver.named(name)).transpose()?;
        let file = open(resolver, &table.file)?;
        let (path, same) = (file.path.clone(), file.identity.clone());
        let animation = table.animation.as_ref().map(|name| name.value.clone());
        let own = table.variant.as_ref().map(|name| &*name.value);
        let variant = own.or(resolver.variant).map(str::to_owned);
        let part = match self.loaded.entry((same, animation.clone(), variant.clone())) {
            std::collections::hash_map::Entry::Occupied(known) => known.into_mut(),
            std::collections::hash_map::Entry::Vacant(unknown) => {
                let choice = Choice {
                    animation: animation.as_deref(),
                    variant: variant.as_deref(),
                    pictures: resolver.shown.model(&path),
                };
                let Loaded { scene: mut model, report } =
                    load::model(file, resolver.guard, &choice)?;
                if let Some(At { span, value }) = &table.variant {
                    load::check_variant(value, &report)
                        .map_err(|e| resolver.source.place(span, e))?;
                }
                // Its warnings name the model already.
                resolver.report.add(report);
                let is_still = resolver.scene.animation.is_none();
                if is_still && model.animation.take().is_some() {
                    resolver.report.warnings.push(format!(
                        "{}: its animation is not played: the scene has no [animation]",
                        path.display()
                    ));
                }
                unknown.insert(MergedModel::add(&mut resolver.scene, model))
            }
        };
        let still = transform(table);
        if part.reach(&still) > MAX_COORDINATE {
            let span = &table.file.span;
            return Err(resolver
                .source
                .error(span, "the model reaches beyond 1e15 from 0 as it is placed")
                .help("make its `scale` or `translate` smaller"));
        }
        let rig = resolver.rig(&table.name);
        let placement = Placement {
            transform: if rig.is_some_and(|rig| rig.is_own) { DAffine3::IDENTITY } else { still },
            node: rig.and_then(|rig| rig.node),
            material,
            casts_shadow: table.casts_shadow.unwrap_or(true),
            lights: table.lights.unwrap_or(true),
        };
        let place = |e| resolver.source.place(&table.file.span, e);
        self.placed += part.count();
        resolver.guard.check(Limit::Instances, self.placed).map_err(place)?;
        let warnings = &mut resolver.report.warnings;
        part.place(&mut resolver.scene, &placement, warnings);
        Ok(())
    }
}

/// Opens a model file. What is wrong with the name is the scene file's fault and is reported there;
/// what is wrong in the file, its reader reports.
fn open(resolver: &Resolver<'_>, name: &At<String>) -> Result<OpenedFile> {
    let At { span, value: name } = name;
    let source = resolver.source;
    let fail = |message| source.cannot_have(span, "model", name, &message);
    match load::extension(&source.file(name)).as_str() {
        "gltf" | "glb" | "vrm" | "obj" => {}
        "toml" => return Err(fail(Error::input("a scene file cannot stand in another one"))),
        _ => {
            return Err(fail(
                Error::input("this kind of file is not read")
                    .help("a model ends in .gltf, .glb or .obj"),
            ));
        }
    }
    resolver.guard.open(source.folder(), &[name]).map_err(fail)
}

/// translate · rotate · scale, the rotation about the fixed x axis first, then y, then z.
fn transform(table: &ModelTable) -> DAffine3 {
    let scale = table.scale.map_or(DVec3::ONE, |scale| scale.0);
    let [x, y, z] = table.rotate.map_or([0.0; 3], |angles| angles.0);
    let rotation = turn(DVec3::Z, z) * turn(DVec3::Y, y) * turn(DVec3::X, x);
    let translation = table.translate.map_or(DVec3::ZERO, |t| t.0);
    DAffine3 { matrix3: rotation * DMat3::from_diagonal(scale), translation }
}

/// The rotation about an axis by an angle in degrees; exact for quarter turns, so that a model
/// that is turned by 90° has walls as upright as before.
fn turn(axis: DVec3, degrees: f64) -> DMat3 {
    let (sin, cos) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    };
    let [x, y, z] = axis.to_array();
    // Rodrigues' formula for an axis that is one of the coordinate axes.
    DMat3::from_cols(
        DVec3::new(cos + x * (1.0 - cos), z * sin, -y * sin),
        DVec3::new(-z * sin, cos + y * (1.0 - cos), x * sin),
        DVec3::new(y * sin, -x * sin, cos + z * (1.0 - cos)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::scene_file::values::{Point, Rotation, Scale};

    fn table(rotate: [f64; 3], scale: DVec3, translate: DVec3) -> ModelTable {
        ModelTable {
            name: None,
            file: At { span: 0..0, value: String::new() },
            translate: Some(Point(translate)),
            rotate: Some(Rotation(rotate)),
            scale: Some(Scale(scale)),
            material: None,
            casts_shadow: None,
            lights: None,
            animation: None,
            variant: None,
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
                assert!(turn(axis, degrees).abs_diff_eq(theirs, 1e-12), "{axis} {degrees}");
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
