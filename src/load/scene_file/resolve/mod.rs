//! From tables to a scene: names become indices, files are read, and what several keys say
//! together is checked.

mod material;

use std::collections::HashMap;

use super::animation::{self, Rig, Rigs};
use super::camera;
use super::film;
use super::light;
use super::model::Models;
use super::mover;
use super::names::Names;
use super::pictures::Pictures;
use super::shown::Shown;
use super::source::{Source, Span};
use super::spanned::{At, Table};
use super::tables::{CameraTable, LightTable, PlaneTable, SceneTable, SphereTable};
use crate::error::Result;
use crate::load::sandbox::Sandbox;
use crate::load::{LoadOptions, LoadReport, Loaded};
use crate::scene::animation::Animated;
use crate::scene::check::MAX_COORDINATE;
use crate::scene::{Checker, MaterialId, Plane, Scene, Sphere};

/// So many materials that are too bright are named; the others are counted.
const MAX_NAMED: u64 = 100;

/// The scene that the tables of a file describe.
pub fn scene(
    source: &Source<'_>,
    tables: SceneTable,
    guard: &Sandbox,
    options: &LoadOptions,
) -> Result<Loaded> {
    if tables.camera.0.is_empty() && tables.model.0.is_empty() {
        let end = source.text.trim_end().len();
        return Err(source
            .error(&(end..end), "there is neither a [camera] nor a [[model]]")
            .help("a scene needs one of them: nothing says what to look at"));
    }
    let film = film::film(source, &tables.film.0)?;
    let names = Names::of(source, &tables)?;
    let (animation, rigs) = animation::animation(source, &tables, &names)?;
    let mut resolver = Resolver {
        source,
        guard,
        names: &names,
        shown: Shown::of(source, &tables),
        variant: options.variant.as_deref(),
        rigs: &rigs,
        scene: Scene { film, animation, ..Scene::default() },
        report: LoadReport::default(),
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
    let Resolver { mut scene, mut report, .. } = resolver;
    resolver.pictures.decode(source, guard, &mut scene)?;
    if let more @ 1.. = resolver.too_bright.saturating_sub(MAX_NAMED) {
        let file = source.shown(&(0..0));
        report.warnings.push(format!("{file}: {more} more materials scatter more than they get"));
    }
    Ok(Loaded { scene, report })
}

/// What is under way while a scene is put together.
pub struct Resolver<'a> {
    /// The file.
    pub source: &'a Source<'a>,
    /// The bounds of the load.
    pub guard: &'a Sandbox,
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
    /// The load report so far.
    pub report: LoadReport,
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

    fn moves(&mut self, mover: Option<Animated>) {
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
