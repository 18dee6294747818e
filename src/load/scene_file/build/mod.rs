//! The builder that turns the tables of a scene file into a scene: names become indices, files are
//! read, and keys that depend on one another are checked.

mod animation;
mod camera;
mod environment;
mod film;
mod image_use;
mod light;
mod light_shape;
mod material;
mod model;
mod objects;
mod pbr_material;
mod shapes;
mod textures;
mod tracks;

use std::collections::HashMap;
use std::sync::Arc;

use self::animation::{ObjectMotion, ObjectMotions};
use self::image_use::ImageUse;
use self::model::ModelKey;
use self::objects::NamedObjects;
use self::textures::Textures;
use super::schema::spanned::Spanned;
use super::schema::tables::SceneTable;
use super::source::{Source, Span};
use crate::error::Result;
use crate::load::merge::MergedModel;
use crate::load::sandbox::Sandbox;
use crate::load::{LoadOptions, LoadReport, Loaded};
use crate::scene::animation::Animated;
use crate::scene::{MaterialId, ObjectProvenance, Scene, ShadingModel, TableKind};

/// Builds the scene that the tables of a file describe.
///
/// # Errors
/// When a file that it names cannot be read, or the tables contradict one another.
pub fn build_scene(
    source: &Source<'_>,
    tables: &SceneTable,
    sandbox: &Sandbox,
    options: &LoadOptions,
) -> Result<Loaded> {
    if tables.camera.0.is_empty() && tables.model.0.is_empty() {
        let end = source.text.trim_end().len();
        return Err(source
            .error(&(end..end), "there is neither a [camera] nor a [[model]]")
            .help("a scene needs one of them: nothing says what to look at"));
    }
    // Film, names and motion, on which the objects depend.
    let film = film::film_settings(source, &tables.film.0)?;
    let objects = NamedObjects::from_tables(source, tables)?;
    let (animation, motions) = animation::build_animation(source, tables, &objects)?;
    let provenance = options.provenance.then(Arc::default);
    let mut builder = SceneBuilder {
        source,
        sandbox,
        objects,
        shading: options.shading,
        geometry_only: options.geometry_only,
        image_use: ImageUse::from_tables(source, tables),
        variant: options.variant.as_deref(),
        motions,
        scene: Scene { film, animation, provenance, ..Scene::default() },
        report: LoadReport::default(),
        materials: HashMap::new(),
        default_material: None,
        textures: Textures::default(),
        models: HashMap::new(),
        model_objects: 0,
        too_bright: 0,
    };
    // The objects, materials before those that name them.
    tables.camera.0.iter().try_for_each(|c| builder.add_camera(&c.value.0, &c.span))?;
    tables.material.iter().try_for_each(|m| builder.add_material(m))?;
    tables.sphere.iter().enumerate().try_for_each(|(i, s)| builder.add_sphere(i, s))?;
    tables.plane.iter().enumerate().try_for_each(|(i, p)| builder.add_plane(i, p))?;
    tables.light.iter().enumerate().try_for_each(|(i, l)| builder.add_light(i, l))?;
    if let Some(Spanned { span, value: environment }) = &tables.environment {
        builder.add_environment(&environment.0, span)?;
    }
    tables.model.iter().enumerate().try_for_each(|(i, m)| builder.add_model(i, m))?;
    builder.warn_of_bright_materials();
    let SceneBuilder { mut scene, report, textures, .. } = builder;
    textures::decode_images(textures, source, sandbox, &mut scene)?;
    Ok(Loaded { scene, report })
}

/// A scene while it is built.
struct SceneBuilder<'a> {
    source: &'a Source<'a>,
    sandbox: &'a Sandbox,
    /// The variant of the materials of models that name none.
    variant: Option<&'a str>,
    /// The shading model of the materials of models that say nothing themselves.
    shading: Option<ShadingModel>,
    /// True if all materials are the default material.
    geometry_only: bool,
    image_use: ImageUse,
    objects: NamedObjects,
    motions: ObjectMotions,
    /// The scene so far.
    scene: Scene,
    /// The load report so far.
    report: LoadReport,
    /// The file's own materials by name, each with the span of its name.
    materials: HashMap<String, (MaterialId, Span)>,
    /// The material of objects that name none, once there is such an object.
    default_material: Option<MaterialId>,
    /// The textures of the file's own materials.
    textures: Textures,
    models: HashMap<ModelKey, MergedModel>,
    /// The number of objects that instances of models have added to the scene.
    model_objects: u64,
    /// The number of materials that scatter more light than they get.
    too_bright: u64,
}

impl SceneBuilder<'_> {
    /// Returns the motion of the object with a name, if it has both.
    fn motion(&self, name: &Option<Spanned<String>>) -> Option<&ObjectMotion> {
        self.motions.get(self.objects.index(self.source, name.as_ref()?).ok()?)
    }

    /// Returns the provenance of the object that a table describes; that of nothing if it is not
    /// recorded.
    fn provenance_of_table(
        &mut self,
        kind: TableKind,
        index: usize,
        name: Option<&Spanned<String>>,
    ) -> ObjectProvenance {
        let name = name.map(|name| name.value.clone());
        let table = self.scene.provenance_mut();
        table.map_or_else(Default::default, |table| table.add_table(kind, index, name))
    }

    fn add_animated(&mut self, animated: Option<Animated>) {
        if let (Some(animation), Some(animated)) = (&mut self.scene.animation, animated) {
            animation.objects.push(animated);
        }
    }
}
