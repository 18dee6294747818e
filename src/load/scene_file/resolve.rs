//! From tables to a scene: names become indices, files are read, and what several keys say
//! together is checked.

use std::collections::HashMap;

use glam::Vec3;

use super::animation::{self, Rig, Rigs};
use super::camera;
use super::color::Color;
use super::light;
use super::model::Models;
use super::mover;
use super::names::Names;
use super::pictures::Pictures;
use super::shown::Shown;
use super::source::{Source, Span};
use super::spanned::{At, Table};
use super::tables::{
    CameraTable, FilmTable, LightTable, MapAlpha, MapFilter, MaterialTable, PlaneTable, SceneTable,
    SphereTable,
};
use super::values::SampleRange;
use crate::error::Result;
use crate::load::Options;
use crate::load::guard::Guard;
use crate::load::suggest;
use crate::scene::animation::Mover;
use crate::scene::check::{self, MAX_COORDINATE};
use crate::scene::{
    Adaptive, AlphaMode, Channel, Checker, Coverage, FilmSettings, Material, MaterialId, NormalMap,
    Plane, Scene, Sphere, TextureId, Transfer,
};

/// So many materials that are too bright are named; the others are counted.
const MAX_NAMED: u64 = 100;

/// The scene that the tables of a file describe.
pub fn scene(
    source: &Source<'_>,
    tables: SceneTable,
    guard: &Guard,
    options: &Options,
) -> Result<Scene> {
    if tables.camera.0.is_empty() && tables.model.0.is_empty() {
        let end = source.text.trim_end().len();
        return Err(source
            .error(&(end..end), "there is neither a [camera] nor a [[model]]")
            .help("a scene needs one of them: nothing says what to look at"));
    }
    let film = film(source, &tables.film.0)?;
    let names = Names::of(source, &tables)?;
    let (animation, rigs) = animation::animation(source, &tables, &names)?;
    let mut resolver = Resolver {
        source,
        guard,
        names: &names,
        shown: Shown::of(source, &tables, options.reads_all_pictures()),
        variant: options.variant.as_deref(),
        rigs: &rigs,
        scene: Scene { film, animation, ..Scene::default() },
        materials: HashMap::new(),
        plain: None,
        pictures: Pictures::default(),
        too_bright: 0,
    };
    tables.camera.0.iter().try_for_each(|c| resolver.camera(c))?;
    tables.material.0.iter().try_for_each(|m| resolver.material(m))?;
    tables.sphere.0.iter().try_for_each(|s| resolver.sphere(&s.value.0))?;
    tables.plane.0.iter().try_for_each(|p| resolver.plane(&p.value.0))?;
    tables.light.0.iter().try_for_each(|l| resolver.light(&l.value.0))?;
    let mut models = Models::default();
    tables.model.0.iter().try_for_each(|m| models.place(&mut resolver, &m.value.0))?;
    let mut scene = resolver.scene;
    resolver.pictures.decode(source, guard, &mut scene)?;
    if let more @ 1.. = resolver.too_bright.saturating_sub(MAX_NAMED) {
        let file = source.shown(&(0..0));
        scene.warnings.push(format!("{file}: {more} more materials scatter more than they get"));
    }
    Ok(scene)
}

fn film(source: &Source<'_>, table: &FilmTable) -> Result<FilmSettings> {
    let default = FilmSettings::default();
    if let Some(At { span, value }) = &table.size {
        check::check_size(value.0).map_err(|e| source.place(span, e))?;
    }
    let transfer = table.transfer.unwrap_or(default.transfer);
    let (spp, adaptive) = samples(source, table)?;
    Ok(FilmSettings {
        size: table.size.as_ref().map_or(default.size, |size| size.value.0),
        spp,
        adaptive,
        transfer,
        exposure: table.exposure.map_or(default.exposure, |ev| ev.0),
        tone: table.tone.unwrap_or(default.tone),
        background: table.background.map_or(default.background, |c| c.linear(transfer)),
        sample_position: table.sample_position.unwrap_or(default.sample_position),
        max_depth: table.max_depth.map_or(default.max_depth, |depth| depth.0),
        cutoff: table.cutoff.map_or(default.cutoff, |share| share.0),
    })
}

/// How many samples every pixel has, and where one may have more.
fn samples(source: &Source<'_>, table: &FilmTable) -> Result<(u32, Option<Adaptive>)> {
    let threshold = table.threshold.as_ref();
    let Some(At { span, value: SampleRange([min, max]) }) = &table.adaptive else {
        return match threshold {
            None => Ok((table.spp.map_or(FilmSettings::default().spp, |spp| spp.0), None)),
            Some(At { span, .. }) => Err(source
                .error(span, "`threshold` is about adaptive samples, and there are none")
                .help("add `adaptive = [1, 25]`, or leave `threshold` out")),
        };
    };
    if table.spp.is_some() {
        return Err(source
            .error(span, "`spp` and `adaptive` both say how many samples a pixel has")
            .help("leave one of them out"));
    }
    check::check_samples(*min, *max).map_err(|e| source.place(span, e))?;
    let threshold = threshold.map_or(Adaptive::THRESHOLD, |share| share.value.0 as f32);
    Ok((*min, Some(Adaptive { max: *max, threshold })))
}

/// How a picture is read, if it is.
#[derive(Clone, Copy)]
struct Reading {
    transfer: Transfer,
    filter: MapFilter,
    wanted: bool,
}

/// What is under way while a scene is put together.
pub struct Resolver<'a> {
    /// The file.
    pub source: &'a Source<'a>,
    /// The bounds of the load.
    pub guard: &'a Guard,
    /// Which pictures something shows.
    pub shown: Shown,
    /// The variant of models that name none.
    pub variant: Option<&'a str>,
    /// Its objects with names.
    pub names: &'a Names,
    /// How they move.
    pub rigs: &'a Rigs,
    /// The scene so far.
    pub scene: Scene,
    /// The file's own materials by name, each with the place of its name.
    materials: HashMap<String, (MaterialId, Span)>,
    /// The material of what names none, once there is such a thing.
    plain: Option<MaterialId>,
    /// The pictures so far.
    pictures: Pictures,
    /// How many materials scatter more light than they get.
    too_bright: u64,
}

impl Resolver<'_> {
    /// How the object with a name moves.
    pub fn rig(&self, name: &Option<At<String>>) -> Option<&Rig> {
        let At { span, value } = name.as_ref()?;
        self.rigs.get(self.names.find(self.source, value, span).ok())
    }

    fn moves(&mut self, mover: Option<Mover>) {
        if let (Some(animation), Some(mover)) = (&mut self.scene.animation, mover) {
            animation.movers.push(mover);
        }
    }

    fn camera(&mut self, table: &At<Table<CameraTable>>) -> Result<()> {
        let At { span, value: Table(table) } = table;
        let width = self.scene.film.size[0];
        let camera = camera::camera(self.source, table, span, self.names, width)?;
        let mover = mover::camera(self, table, &camera)?;
        self.moves(mover);
        self.scene.cameras.push(camera);
        Ok(())
    }

    fn light(&mut self, table: &LightTable) -> Result<()> {
        let light = light::light(self.source, table, self.scene.film.transfer)?;
        let mover = mover::light(self, table, &light)?;
        self.moves(mover);
        self.scene.lights.push(light);
        Ok(())
    }

    fn color(&self, color: Option<Color>, default: Vec3) -> Vec3 {
        color.map_or(default, |c| c.linear(self.scene.film.transfer))
    }

    fn material(&mut self, table: &At<Table<MaterialTable>>) -> Result<()> {
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
                self.scene.warnings.push(format!(
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
                suggest::choice(name, &names, "materials")
            };
            self.source.error(span, format!("there is no material `{name}`")).help(help)
        })
    }

    /// The material with a name, or a plain grey.
    fn named_or_plain(&mut self, name: Option<&At<String>>) -> Result<MaterialId> {
        match name {
            Some(name) => self.named(name),
            None => Ok(*self.plain.get_or_insert_with(|| {
                let plain = Material { name: "default".to_owned(), ..Material::default() };
                self.scene.add_material(plain)
            })),
        }
    }

    fn sphere(&mut self, table: &SphereTable) -> Result<()> {
        let (center, At { span, value: radius }) = (table.center.0, &table.radius);
        if center.abs().max_element() + radius.0 > MAX_COORDINATE {
            return Err(self.source.error(span, "the sphere reaches beyond 1e15 from 0"));
        }
        let material = self.named_or_plain(table.material.as_ref())?;
        let sphere = Sphere {
            casts_shadow: table.casts_shadow.unwrap_or(true),
            ..Sphere::new(center, radius.0, material)
        };
        let mover = mover::sphere(self, table, &sphere);
        self.moves(mover);
        self.scene.spheres.push(sphere);
        Ok(())
    }

    fn plane(&mut self, table: &PlaneTable) -> Result<()> {
        let material = self.named_or_plain(table.material.as_ref())?;
        let transfer = self.scene.film.transfer;
        let checker = table.checker.as_ref().map(|Table(checker)| Checker {
            colors: checker.colors.0.map(|c| c.linear(transfer)),
            size: checker.size.map_or(1.0, |size| size.0),
        });
        let plane = Plane {
            checker,
            texture_size: table.texture_size.map_or(1.0, |size| size.0),
            casts_shadow: table.casts_shadow.unwrap_or(true),
            ..Plane::new(table.point.0, table.normal.0, material)
        };
        self.scene.planes.push(plane);
        Ok(())
    }
}
