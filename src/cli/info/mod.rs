//! The subcommand `envers info`.

mod contents;

use std::collections::BTreeMap;
use std::fmt;
use std::process::ExitCode;

use rayon::prelude::*;
use serde::Serialize;

use self::contents::{CameraSummary, Files, GltfFile, ImageSummary, LightSummary, images};
use crate::cli::load_report::{self, LoadSummary};
use crate::cli::paths::{self, InputFiles};
use crate::cli::{args::Info, messages, output, render_stats::Geometry};
use crate::error::Result;
use crate::load::{LoadReport, Loaded};
use crate::scene::animation::{Animated, Animation};
use crate::scene::{Scene, SceneFeatures};

/// The contents of a scene: `info --json`.
#[derive(Serialize)]
struct Summary {
    files: Files,
    /// The glTF files among them.
    gltf: Vec<GltfFile>,
    size: [u32; 2],
    spp: u32,
    /// The most samples of a pixel with adaptive sampling; null without it.
    max_spp: Option<u32>,
    geometry: Geometry,
    /// The stored triangles: those of each mesh once, whatever the number of its instances.
    mesh_triangles: usize,
    /// The stored vertices.
    vertices: usize,
    meshes: usize,
    /// The number of meshes that are closed (watertight).
    closed_meshes: usize,
    /// The names of the materials, which may be empty.
    materials: Vec<String>,
    /// The number of textures: several may show one image.
    textures: usize,
    images: Vec<ImageSummary>,
    lights: Vec<LightSummary>,
    cameras: Vec<CameraSummary>,
    /// The animation that is played; null if nothing is animated.
    animation: Option<AnimationSummary>,
    /// The corners of the box around all but planes; null if there is nothing else.
    bounds: Option<[[f64; 3]; 2]>,
    /// The lengths of its sides, in units of the scene.
    extent: Option<[f64; 3]>,
    /// The kinds of work that the scene needs, with the reason.
    needed: BTreeMap<&'static str, String>,
    /// The kinds of work that are skipped, with the reason.
    skipped: BTreeMap<&'static str, String>,
    /// The load report.
    report: LoadSummary,
    /// The load report's faces, as they are printed.
    #[serde(skip)]
    faces: String,
    /// True if the text has the work that is needed and skipped.
    #[serde(skip)]
    verbose: bool,
    warnings: Vec<String>,
}

/// An animation, and the numbers of objects that it moves.
#[derive(Serialize)]
struct AnimationSummary {
    frames: u32,
    fps: f64,
    seconds: f64,
    spheres: usize,
    instances: usize,
    /// The meshes that are deformed.
    meshes: usize,
    lights: usize,
    cameras: usize,
}

impl AnimationSummary {
    fn new(animation: &Animation) -> Self {
        let count =
            |is_kind: fn(&&Animated) -> bool| animation.objects.iter().filter(is_kind).count();
        Self {
            frames: animation.frames,
            fps: animation.fps,
            seconds: animation.duration(),
            spheres: count(|moved| matches!(moved, Animated::Sphere { .. })),
            instances: count(|moved| matches!(moved, Animated::Instance { .. })),
            meshes: count(|moved| matches!(moved, Animated::Mesh { .. })),
            lights: count(|moved| matches!(moved, Animated::Light { .. })),
            cameras: count(|moved| matches!(moved, Animated::Camera { .. })),
        }
    }
}

impl fmt::Display for AnimationSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let moved = [
            (self.spheres, "sphere"),
            (self.instances, "instance"),
            (self.meshes, "shape"),
            (self.lights, "light"),
            (self.cameras, "camera"),
        ];
        let moved = moved.into_iter().filter(|(count, _)| *count > 0);
        let moved: Vec<String> = moved.map(|(count, noun)| counted(count, noun)).collect();
        let frames = counted(self.frames as usize, "frame");
        let Self { fps, seconds, .. } = self;
        write!(f, "{frames} at {fps} fps ({seconds:.3} s), moving: {}", or_none(&moved))
    }
}

pub fn run(arguments: &Info) -> Result<ExitCode> {
    output::check_json(arguments.json.as_ref())?;
    paths::check_input(&arguments.scene)?;
    let Loaded { scene, report } = arguments.load.options().load(&arguments.scene)?;
    paths::check_outputs(&arguments.json, &InputFiles::of_scene(&scene, &report))?;
    let animation = scene.animation.as_ref().map(AnimationSummary::new);
    // All but the animation is that of the first frame.
    // On a thread of the pool, where parallel loops over many small meshes cost nothing.
    let summary = rayon::scope(|_| {
        scene.at_time(0.0).map(|scene| Summary::new(&scene, &report, animation, arguments))
    })?;
    if output::stdout_is_free(arguments.json.as_ref()) {
        output::print(&summary.to_string())?;
        summary.warnings.iter().for_each(|w| messages::warning(w));
    }
    if let Some(path) = &arguments.json {
        output::write_json(path, &summary)?;
    }
    if arguments.strict {
        load_report::check_strictly(&report, &arguments.scene)?;
    }
    Ok(ExitCode::SUCCESS)
}

impl Summary {
    /// Sums up a scene at the first frame.
    fn new(
        scene: &Scene,
        report: &LoadReport,
        animation: Option<AnimationSummary>,
        arguments: &Info,
    ) -> Self {
        let bounds = scene.bounds();
        let bounds = (!bounds.is_empty()).then_some(bounds);
        // The default of `render`: precision fast, on Embree if it is built in.
        let has_f32_rays = cfg!(feature = "embree");
        let features = SceneFeatures::from_scene(scene);
        Self {
            files: Files::new(&arguments.scene, report),
            gltf: report.assets.iter().map(GltfFile::from).collect(),
            size: scene.film.size,
            spp: scene.film.spp,
            max_spp: scene.film.adaptive.map(|adaptive| adaptive.max),
            geometry: Geometry::new(scene),
            mesh_triangles: scene.meshes.iter().map(|m| m.triangles.len()).sum(),
            vertices: scene.meshes.iter().map(|m| m.positions.len()).sum(),
            meshes: scene.meshes.len(),
            closed_meshes: scene.meshes.par_iter().filter(|mesh| mesh.is_closed()).count(),
            materials: scene.materials.iter().map(|material| material.name.clone()).collect(),
            textures: scene.textures.len(),
            images: images(scene),
            lights: scene.lights.iter().map(LightSummary::from).collect(),
            cameras: scene.cameras.iter().map(CameraSummary::from).collect(),
            animation,
            bounds: bounds.map(|bounds| [bounds.lower.into(), bounds.upper.into()]),
            extent: bounds.map(|bounds| bounds.size().into()),
            needed: features.used().map(|(feature, why)| (feature.name(), why)).collect(),
            skipped: features.skipped().map(|(feature, why)| (feature.name(), why)).collect(),
            report: report.into(),
            faces: report.to_string(),
            verbose: arguments.verbose,
            warnings: messages::scene_warnings(report, scene, has_f32_rays),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write_files(f)?;
        // The picture, and the numbers of objects.
        let &Summary { size: [width, height], spp, meshes, mesh_triangles, .. } = self;
        let Geometry { spheres, triangles, planes, instances } = self.geometry;
        let max_spp = self.max_spp.map_or(String::new(), |max| format!(" to {max}"));
        writeln!(f, "image      {width}x{height}, {spp}{max_spp} samples per pixel")?;
        writeln!(f, "spheres    {spheres}")?;
        writeln!(f, "planes     {planes}")?;
        write!(f, "triangles  {triangles} in {instances} instances of {meshes} meshes ")?;
        writeln!(f, "({mesh_triangles} stored)")?;
        if meshes > 0 {
            writeln!(f, "vertices   {} stored", self.vertices)?;
            writeln!(f, "closed     {} of {}", self.closed_meshes, counted(meshes, "mesh"))?;
        }
        writeln!(f, "faces      {}", self.faces)?;
        writeln!(f, "materials  {}", self.materials.len())?;
        writeln!(f, "textures   {}{}", self.textures, self.largest_image())?;
        let lights: Vec<String> = self.lights.iter().map(LightSummary::label).collect();
        writeln!(f, "lights     {}", or_none(&lights))?;
        let cameras: Vec<String> = self.cameras.iter().map(CameraSummary::label).collect();
        writeln!(f, "cameras    {}", or_none(&cameras))?;
        // What only some scenes have.
        let variants: Vec<String> = self.report.variants.iter().map(|v| format!("`{v}`")).collect();
        if !variants.is_empty() {
            writeln!(f, "variants   {}", or_none(&variants))?;
        }
        let animations: Vec<String> = self.gltf.iter().flat_map(GltfFile::animations).collect();
        if !animations.is_empty() {
            writeln!(f, "animations {}", or_none(&animations))?;
        }
        if let Some(motion) = &self.animation {
            writeln!(f, "animation  {motion}")?;
        }
        match self.bounds.zip(self.extent) {
            Some(([a, b], [x, y, z])) => {
                writeln!(f, "bounds     {a:?} to {b:?}")?;
                writeln!(f, "extent     {x} x {y} x {z}")?;
            }
            None => writeln!(f, "bounds     nothing finite")?,
        }
        // The work that the scene needs, and the work that it does not.
        let work = [("needs", &self.needed), ("skips", &self.skipped)];
        for (verb, features) in work.into_iter().filter(|_| self.verbose) {
            for (feature, reason) in features {
                writeln!(f, "{verb:10} {feature}: {}", messages::line(reason))?;
            }
        }
        Ok(())
    }
}

impl Summary {
    /// Writes the sizes of the files, and what glTF files say of themselves.
    fn write_files(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Files { own_bytes, count, bytes, .. } = self.files;
        write!(f, "file       {}", size(own_bytes))?;
        if count > 1 {
            write!(f, ", with those that it names {} in {count} files", size(bytes))?;
        }
        writeln!(f)?;
        for (key, value) in self.gltf.iter().flat_map(GltfFile::origin) {
            writeln!(f, "{key:10} {}", messages::line(value))?;
        }
        Ok(())
    }

    /// Returns the number of images, and the size and the name of the largest, behind the number of
    /// textures.
    fn largest_image(&self) -> String {
        let largest = self.images.iter().rev().max_by_key(|image| image.pixels());
        let Some(ImageSummary { name, width: Some(width), height: Some(height) }) = largest else {
            return String::new();
        };
        let images = counted(self.images.len(), "image");
        messages::line(&format!(" of {images}, the largest {width}x{height} `{name}`"))
    }
}

/// Returns a number of bytes for people.
fn size(bytes: u64) -> String {
    let units = [(1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
    match units.into_iter().find(|(unit, _)| bytes as f64 >= *unit) {
        Some((unit, name)) => format!("{:.1} {name}", bytes as f64 / unit),
        None => counted(bytes as usize, "byte"),
    }
}

/// Returns a count with its noun, in the plural unless it is 1.
fn counted(count: usize, noun: &str) -> String {
    let ending = match noun {
        _ if count == 1 => "",
        "mesh" => "es",
        _ => "s",
    };
    format!("{count} {noun}{ending}")
}

/// Returns a list with commas, or `none`.
fn or_none(list: &[String]) -> String {
    if list.is_empty() { "none".to_owned() } else { messages::line(&list.join(", ")) }
}
