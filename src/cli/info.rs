//! `envers info`.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use crate::cli::args::Info;
use crate::cli::json::Geometry;
use crate::cli::load_report::{self, LoadSummary};
use crate::cli::{Outcome, Verdict, files, output, report};
use crate::intersect::Backend;
use crate::load::{LoadReport, Loaded};
use crate::scene::animation::{Animated, Animation};
use crate::scene::{LightKind, Projection, Scene, SceneFeatures};

/// `info --json`.
#[derive(Serialize)]
struct Summary {
    size: [u32; 2],
    spp: u32,
    /// The most samples of a pixel, where some get more than others.
    max_spp: Option<u32>,
    geometry: Geometry,
    /// Stored triangles: each mesh once, however often it stands.
    mesh_triangles: usize,
    meshes: usize,
    materials: usize,
    textures: usize,
    lights: Vec<String>,
    cameras: Vec<String>,
    /// What moves, and for how long; null when nothing does.
    animation: Option<Motion>,
    /// The corners of the box around all that is finite; null when nothing is.
    bounds: Option<[[f64; 3]; 2]>,
    /// Which kinds of work the scene needs, and for what.
    needed: BTreeMap<&'static str, String>,
    /// Which it does not need, and why: these are not done.
    skipped: BTreeMap<&'static str, String>,
    /// What became of its files.
    report: LoadSummary,
    /// The same, as it is printed.
    #[serde(skip)]
    faces: String,
    warnings: Vec<String>,
}

/// An animation, and how many of each kind of thing it moves.
#[derive(Serialize)]
struct Motion {
    frames: u32,
    fps: f64,
    seconds: f64,
    spheres: usize,
    instances: usize,
    /// Meshes that change their shape.
    meshes: usize,
    lights: usize,
    cameras: usize,
}

impl Motion {
    fn of(animation: &Animation) -> Self {
        let mut motion = Self {
            frames: animation.frames,
            fps: animation.fps,
            seconds: animation.duration(),
            spheres: 0,
            instances: 0,
            meshes: 0,
            lights: 0,
            cameras: 0,
        };
        for mover in &animation.objects {
            *match mover {
                Animated::Sphere { .. } => &mut motion.spheres,
                Animated::Instance { .. } => &mut motion.instances,
                Animated::Mesh { .. } => &mut motion.meshes,
                Animated::Light { .. } => &mut motion.lights,
                Animated::Camera { .. } => &mut motion.cameras,
            } += 1;
        }
        motion
    }
}

impl fmt::Display for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let moving: Vec<String> = [
            (self.spheres, "sphere"),
            (self.instances, "instance"),
            (self.meshes, "shape"),
            (self.lights, "light"),
            (self.cameras, "camera"),
        ]
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| counted(count, what))
        .collect();
        let moving = or_none(&moving);
        let (frames, fps, seconds) =
            (counted(self.frames as usize, "frame"), self.fps, self.seconds);
        write!(f, "{frames} at {fps} a second ({seconds:.3} s), moving: {moving}")
    }
}

pub fn run(arguments: &Info) -> Outcome {
    output::check_json(arguments.json.as_ref())?;
    files::check_input(&arguments.scene)?;
    let Loaded { scene, report: loaded } =
        arguments.loading.options(None).load(&arguments.scene)?;
    let motion = scene.animation.as_ref().map(Motion::of);
    // The rest is that of the first frame.
    let summary = summarize(&scene.at_time(0.0)?, &loaded, motion);
    if output::stdout_is_free(arguments.json.as_ref()) {
        output::print(&report::printable(&summary.to_string()))?;
        summary.warnings.iter().for_each(|w| report::warning(w));
    }
    if let Some(path) = &arguments.json {
        output::write_json(path, &summary)?;
    }
    if arguments.strict {
        load_report::check_strictly(&loaded, &arguments.scene)?;
    }
    Ok(Verdict::Good)
}

fn summarize(scene: &Scene, report: &LoadReport, animation: Option<Motion>) -> Summary {
    let bounds = scene.bounds();
    // As the default of `render`: precision fast, on Embree where it is built in.
    let mut warnings = report.warnings.clone();
    warnings.extend(report::precision_warnings(scene, Backend::default() != Backend::Rust));
    let needs = SceneFeatures::from_scene(scene);
    Summary {
        size: scene.film.size,
        spp: scene.film.spp,
        max_spp: scene.film.adaptive.map(|adaptive| adaptive.max),
        geometry: Geometry::of(scene),
        mesh_triangles: scene.meshes.iter().map(|m| m.triangles.len()).sum(),
        meshes: scene.meshes.len(),
        materials: scene.materials.len(),
        textures: scene.textures.len(),
        lights: scene.lights.iter().map(|l| named(light_kind(&l.kind), &l.name)).collect(),
        cameras: scene.cameras.iter().map(|c| named(lens(&c.projection), &c.name)).collect(),
        animation,
        bounds: (!bounds.is_empty()).then(|| [bounds.lower.into(), bounds.upper.into()]),
        needed: needs.used().map(|(work, why)| (work.name(), why)).collect(),
        skipped: needs.skipped().map(|(work, why)| (work.name(), why)).collect(),
        report: report.into(),
        faces: report.to_string(),
        warnings,
    }
}

fn named(what: impl std::fmt::Display, name: &str) -> String {
    if name.is_empty() { what.to_string() } else { format!("{what} `{name}`") }
}

fn light_kind(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Ambient => "ambient",
        LightKind::Directional { .. } => "directional",
        LightKind::Point { .. } => "point",
        LightKind::Spot { .. } => "spot",
    }
}

fn lens(lens: &Projection) -> String {
    match lens {
        Projection::FovY(angle) => format!("fov_y {:.4}", angle.to_degrees()),
        Projection::FovX(angle) => format!("fov_x {:.4}", angle.to_degrees()),
        Projection::FocalPx { focal, .. } => format!("focal_px {focal}"),
        Projection::OrthoHeight(height) => format!("ortho_height {height}"),
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size;
        let g = &self.geometry;
        let most = self.max_spp.map_or(String::new(), |max| format!(" to {max}"));
        writeln!(f, "picture    {width}x{height}, {}{most} samples per pixel", self.spp)?;
        writeln!(f, "spheres    {}", g.spheres)?;
        writeln!(f, "planes     {}", g.planes)?;
        writeln!(
            f,
            "triangles  {} in {} instances of {} meshes ({} stored)",
            g.triangles, g.instances, self.meshes, self.mesh_triangles
        )?;
        writeln!(f, "faces      {}", self.faces)?;
        writeln!(f, "materials  {}, textures {}", self.materials, self.textures)?;
        writeln!(f, "lights     {}", or_none(&self.lights))?;
        writeln!(f, "cameras    {}", or_none(&self.cameras))?;
        let variants: Vec<String> = self.report.variants.iter().map(|v| format!("`{v}`")).collect();
        if !variants.is_empty() {
            writeln!(f, "variants   {}", variants.join(", "))?;
        }
        if let Some(motion) = &self.animation {
            writeln!(f, "animation  {motion}")?;
        }
        match self.bounds {
            Some([a, b]) => writeln!(f, "bounds     {a:?} to {b:?}")?,
            None => writeln!(f, "bounds     nothing finite")?,
        }
        let line = |does: &str, (work, why): (&&str, &String)| format!("{does:10} {work}: {why}");
        let needs = self.needed.iter().map(|needed| line("needs", needed));
        let skips = self.skipped.iter().map(|skipped| line("skips", skipped));
        needs.chain(skips).try_for_each(|line| writeln!(f, "{line}"))
    }
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

fn or_none(list: &[String]) -> String {
    if list.is_empty() { "none".to_owned() } else { list.join(", ") }
}
