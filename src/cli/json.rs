//! The shapes of the command's JSON.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;

use crate::cli::load_report::LoadSummary;
use crate::integrator::{self, Counts, RayCounts, sample_steps};
use crate::intersect::BuildQuality;
use crate::load::LoadReport;
use crate::render::Statistics;
use crate::scene::{self, Feature, FilmSettings, Scene, SceneFeatures};

/// `render --stats`.
#[derive(Serialize)]
pub struct Stats {
    pub backend: Backend,
    pub precision: &'static str,
    pub threads: usize,
    pub size: [u32; 2],
    pub spp: u32,
    /// What of the pixels got more samples; null where all have as many.
    pub adaptive: Option<Adaptive>,
    /// How many frames were rendered; what is counted and timed is that of all of them.
    pub frames: usize,
    pub geometry: Geometry,
    pub build: Build,
    pub rays: Rays,
    /// Of each kind of work that is counted, how much was done.
    pub work: BTreeMap<&'static str, u64>,
    /// Why each kind of work that was left out could be.
    pub skipped: BTreeMap<&'static str, String>,
    /// Samples that were left out, by what made them not finite.
    pub not_finite: NotFinite,
    pub seconds: Seconds,
    /// All rays over the seconds of rendering.
    pub mrays_per_second: f64,
    /// The most memory the process had at any time; null where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// What of it Embree had, at its own peak; null without Embree.
    pub embree_peak_memory_bytes: Option<u64>,
    /// What became of the scene's files.
    pub report: LoadSummary,
    pub warnings: Vec<String>,
}

#[derive(Serialize)]
pub struct Adaptive {
    /// The most samples of a pixel.
    pub max: u32,
    /// From which difference on colours disagree.
    pub threshold: f32,
    /// Samples after each step, the first of which every pixel has.
    pub steps: Vec<usize>,
    /// Pixels that went on to each step after the first, of all frames.
    pub refined: Vec<u64>,
}

impl Adaptive {
    fn of(film: &FilmSettings, counts: &Counts) -> Option<Self> {
        let scene::AdaptiveSampling { max, threshold } = film.adaptive?;
        let steps = sample_steps(film);
        let refined = counts.refined[..steps.len() - 1].to_vec();
        Some(Self { max, threshold, steps, refined })
    }
}

#[derive(Serialize)]
pub struct Backend {
    pub name: &'static str,
    pub version: String,
}

#[derive(Serialize)]
pub struct Geometry {
    pub spheres: usize,
    /// Counting each instance of a mesh.
    pub triangles: u64,
    pub planes: usize,
    pub instances: usize,
}

impl Geometry {
    pub fn of(scene: &Scene) -> Self {
        Self {
            spheres: scene.spheres.len(),
            triangles: scene.triangle_count(),
            planes: scene.planes.len(),
            instances: scene.instances.len(),
        }
    }
}

/// What all frames took to build, and what they kept of a frame before.
#[derive(Serialize)]
pub struct Build {
    /// Meshes that were built.
    pub meshes: u64,
    /// Meshes that were there from a frame before.
    pub reused: u64,
    /// How good Embree's trees are: `low` or `medium`; null without Embree.
    pub bvh: Option<&'static str>,
    /// Times that the level above the meshes was built: the spheres, and where each mesh stands.
    pub top_levels_built: u64,
    /// Frames for which it was there, and only what moved was placed again.
    pub top_levels_kept: u64,
    /// Instances of meshes that were placed in a level that was built.
    pub instances_placed: u64,
    /// Instances that moved in one that was kept.
    pub instances_moved: u64,
    /// Spheres that moved in one that was kept.
    pub spheres_moved: u64,
}

impl From<&Statistics> for Build {
    fn from(statistics: &Statistics) -> Self {
        let built = statistics.built;
        Self {
            meshes: built.meshes_built,
            reused: built.meshes_reused,
            bvh: statistics.quality.map(BuildQuality::name),
            top_levels_built: built.tlas_built,
            top_levels_kept: built.tlas_kept,
            instances_placed: built.instances_built,
            instances_moved: built.instances_moved,
            spheres_moved: built.spheres_moved,
        }
    }
}

#[derive(Serialize)]
pub struct Rays {
    pub primary: u64,
    pub shadow: u64,
    pub reflection: u64,
    pub refraction: u64,
}

impl From<RayCounts> for Rays {
    fn from(counts: RayCounts) -> Self {
        let RayCounts { primary, shadow, reflection, refraction } = counts;
        Self { primary, shadow, reflection, refraction }
    }
}

#[derive(Serialize)]
pub struct NotFinite {
    pub light: u64,
    pub surface: u64,
    pub sum: u64,
}

impl From<integrator::NotFinite> for NotFinite {
    fn from(counts: integrator::NotFinite) -> Self {
        let integrator::NotFinite { light, surface, sum } = counts;
        Self { light, surface, sum }
    }
}

#[derive(Serialize)]
pub struct Seconds {
    pub load: f64,
    pub build: f64,
    pub render: f64,
    pub write: f64,
    pub total: f64,
}

impl Stats {
    pub fn new(
        scene: &Scene,
        frames: usize,
        report: &LoadReport,
        statistics: &Statistics,
        layers: u64,
        [load, write, total]: [f64; 3],
        warnings: Vec<String>,
    ) -> Self {
        let (build, render) = (statistics.build.as_secs_f64(), statistics.render.as_secs_f64());
        let (name, version) = (statistics.backend, statistics.backend_version.clone());
        let Counts { rays, not_finite, .. } = statistics.counts;
        let work = work(scene, statistics, layers);
        Self {
            backend: Backend { name, version },
            precision: statistics.precision.name(),
            threads: statistics.threads,
            size: scene.film.size,
            spp: scene.film.spp,
            adaptive: Adaptive::of(&scene.film, &statistics.counts),
            frames,
            geometry: Geometry::of(scene),
            build: statistics.into(),
            rays: rays.into(),
            skipped: skipped(&SceneFeatures::from_scene(scene), &work),
            work,
            not_finite: not_finite.into(),
            seconds: Seconds { load, build, render, write, total },
            mrays_per_second: rays.total() as f64 / render.max(1e-9) * 1e-6,
            peak_memory_bytes: peak_memory(),
            embree_peak_memory_bytes: embree_peak_memory(statistics),
            report: report.into(),
            warnings,
        }
    }
}

/// How much was done of each kind of work that is counted.
fn work(scene: &Scene, statistics: &Statistics, layers: u64) -> BTreeMap<&'static str, u64> {
    let Statistics { built, counts, .. } = statistics;
    let (rays, done) = (&counts.rays, &counts.work);
    let mut read: Vec<_> = scene.textures.iter().map(|t| &t.image).collect();
    read.retain(|image| image.is_read());
    read.sort_by_key(|image| Arc::as_ptr(image));
    read.dedup_by_key(|image| Arc::as_ptr(image));
    [
        (Feature::Spheres.name(), built.sphere_geometries),
        (Feature::Instances.name(), built.object_space_instances),
        (Feature::Planes.name(), done.planes),
        (Feature::Pictures.name(), read.len() as u64),
        (Feature::Uv.name(), done.uv),
        (Feature::Mipmaps.name(), done.mipmaps),
        (Feature::NormalMaps.name(), done.normal_maps),
        (Feature::AlphaTests.name(), built.masked_instances),
        (Feature::Checkers.name(), done.checkers),
        (Feature::VertexColors.name(), done.vertex_colors),
        (Feature::SmoothNormals.name(), done.smooth_normals),
        (Feature::Highlights.name(), done.highlights),
        (Feature::Shadows.name(), rays.shadow),
        (Feature::Reflection.name(), rays.reflection),
        (Feature::Refraction.name(), rays.refraction),
        ("glass-in-shadows", done.glass),
        ("filters", done.filters),
        ("layers", layers),
    ]
    .into()
}

/// Why each kind of work could be left out, of which none was done.
fn skipped(
    needs: &SceneFeatures,
    work: &BTreeMap<&'static str, u64>,
) -> BTreeMap<&'static str, String> {
    let skipped = needs.skipped().map(|(work, why)| (work.name(), why));
    skipped.filter(|(name, _)| work.get(name).is_none_or(|&count| count == 0)).collect()
}

fn embree_peak_memory(statistics: &Statistics) -> Option<u64> {
    #[cfg(feature = "embree")]
    return statistics.quality.map(|_| crate::intersect::embree_peak_memory());
    #[cfg(not(feature = "embree"))]
    statistics.quality.and(None)
}

/// The process's peak memory, as Linux tells it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}
