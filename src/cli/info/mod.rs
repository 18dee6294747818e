//! The subcommand `envers info`.

use std::collections::BTreeMap;
use std::fmt;
use std::process::ExitCode;

use serde::Serialize;

use crate::cli::load_report::{self, LoadSummary};
use crate::cli::{args::Info, messages, output, paths, render_stats::Geometry};
use crate::error::Result;
use crate::intersect::Backend;
use crate::load::{LoadReport, Loaded};
use crate::scene::animation::{Animated, Animation};
use crate::scene::{LightKind, Projection, Scene, SceneFeatures};

/// The contents of a scene: `info --json`.
#[derive(Serialize)]
struct Summary {
    size: [u32; 2],
    spp: u32,
    /// The most samples of a pixel with adaptive sampling; null without it.
    max_spp: Option<u32>,
    geometry: Geometry,
    /// The stored triangles: those of each mesh once, whatever the number of its instances.
    mesh_triangles: usize,
    meshes: usize,
    materials: usize,
    textures: usize,
    lights: Vec<String>,
    cameras: Vec<String>,
    /// The animation; null if nothing is animated.
    animation: Option<AnimationSummary>,
    /// The corners of the box around all but planes; null if there is nothing else.
    bounds: Option<[[f64; 3]; 2]>,
    /// The kinds of work that the scene needs, with the reason.
    needed: BTreeMap<&'static str, String>,
    /// The kinds of work that are skipped, with the reason.
    skipped: BTreeMap<&'static str, String>,
    /// The load report.
    report: LoadSummary,
    /// The load report's faces, as they are printed.
    #[serde(skip)]
    faces: String,
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
    let Loaded { scene, report } = arguments.load.options(None).load(&arguments.scene)?;
    let animation = scene.animation.as_ref().map(AnimationSummary::new);
    // All but the animation is that of the first frame.
    // On a thread of the pool, where parallel loops over many small meshes cost nothing.
    let summary =
        rayon::scope(|_| scene.at_time(0.0).map(|scene| Summary::new(&scene, &report, animation)))?;
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
    fn new(scene: &Scene, report: &LoadReport, animation: Option<AnimationSummary>) -> Self {
        let bounds = scene.bounds();
        // The default of `render`: precision fast, on Embree if it is built in.
        let has_f32_rays = Backend::default() != Backend::Rust;
        let features = SceneFeatures::from_scene(scene);
        // The names of kinds, and those that the objects have in their files.
        let lights = scene.lights.iter().map(|l| messages::labelled(light_kind(&l.kind), &l.name));
        let cameras =
            scene.cameras.iter().map(|c| messages::labelled(&projection(&c.projection), &c.name));
        Self {
            size: scene.film.size,
            spp: scene.film.spp,
            max_spp: scene.film.adaptive.map(|adaptive| adaptive.max),
            geometry: Geometry::new(scene),
            mesh_triangles: scene.meshes.iter().map(|m| m.triangles.len()).sum(),
            meshes: scene.meshes.len(),
            materials: scene.materials.len(),
            textures: scene.textures.len(),
            lights: lights.collect(),
            cameras: cameras.collect(),
            animation,
            bounds: (!bounds.is_empty()).then(|| [bounds.lower.into(), bounds.upper.into()]),
            needed: features.used().map(|(feature, why)| (feature.name(), why)).collect(),
            skipped: features.skipped().map(|(feature, why)| (feature.name(), why)).collect(),
            report: report.into(),
            faces: report.to_string(),
            warnings: messages::scene_warnings(report, scene, has_f32_rays),
        }
    }
}

/// Returns the name of a kind of light.
fn light_kind(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Ambient => "ambient",
        LightKind::Directional { .. } => "directional",
        LightKind::Point { .. } => "point",
        LightKind::Spot { .. } => "spot",
    }
}

/// Returns the projection of a camera as a scene file sets it.
fn projection(lens: &Projection) -> String {
    match lens {
        Projection::FovY(angle) => format!("fov_y {:.4}", angle.to_degrees()),
        Projection::FovX(angle) => format!("fov_x {:.4}", angle.to_degrees()),
        Projection::FocalPx { focal, .. } => format!("focal_px {focal}"),
        Projection::OrthoHeight(height) => format!("ortho_height {height}"),
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The picture, and the numbers of objects.
        let &Summary { size: [width, height], spp, meshes, mesh_triangles, .. } = self;
        let Geometry { spheres, triangles, planes, instances } = self.geometry;
        let max_spp = self.max_spp.map_or(String::new(), |max| format!(" to {max}"));
        writeln!(f, "image      {width}x{height}, {spp}{max_spp} samples per pixel")?;
        writeln!(f, "spheres    {spheres}")?;
        writeln!(f, "planes     {planes}")?;
        write!(f, "triangles  {triangles} in {instances} instances of {meshes} meshes ")?;
        writeln!(f, "({mesh_triangles} stored)")?;
        writeln!(f, "faces      {}", self.faces)?;
        writeln!(f, "materials  {}, textures {}", self.materials, self.textures)?;
        writeln!(f, "lights     {}", or_none(&self.lights))?;
        writeln!(f, "cameras    {}", or_none(&self.cameras))?;
        // What only some scenes have.
        let variants: Vec<String> = self.report.variants.iter().map(|v| format!("`{v}`")).collect();
        if !variants.is_empty() {
            writeln!(f, "variants   {}", or_none(&variants))?;
        }
        if let Some(motion) = &self.animation {
            writeln!(f, "animation  {motion}")?;
        }
        match self.bounds {
            Some([a, b]) => writeln!(f, "bounds     {a:?} to {b:?}")?,
            None => writeln!(f, "bounds     nothing finite")?,
        }
        // The work that the scene needs, and the work that it does not.
        for (verb, features) in [("needs", &self.needed), ("skips", &self.skipped)] {
            for (feature, reason) in features {
                writeln!(f, "{verb:10} {feature}: {}", messages::line(reason))?;
            }
        }
        Ok(())
    }
}

/// Returns a count with its noun, in the plural unless it is 1.
fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Returns a list with commas, or `none`.
fn or_none(list: &[String]) -> String {
    if list.is_empty() { "none".to_owned() } else { messages::line(&list.join(", ")) }
}
