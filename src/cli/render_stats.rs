//! The JSON of `render --stats`.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use serde::Serialize;

use crate::cli::load_report::LoadSummary;
use crate::integrator::{Counts, NotFinite, RayCounts, sample_steps};
use crate::intersect::BuildQuality;
use crate::load::LoadReport;
use crate::render::{Elapsed, Statistics};
use crate::scene::{AdaptiveSampling, Feature, Scene, SceneFeatures};

/// The sums of all frames, and the times of the command.
pub struct RenderTotals {
    /// The sums of the statistics.
    pub statistics: Statistics,
    /// The number of frames.
    pub frames: usize,
    /// The number of encoded images.
    pub images: u64,
    /// True if all frames are black.
    pub is_black: bool,
    /// The time to encode and write images.
    pub write: Elapsed,
}

/// The statistics of a rendering: `render --stats`.
#[derive(Serialize)]
pub struct RenderStats {
    pub backend: Backend,
    pub precision: &'static str,
    pub threads: usize,
    pub size: [u32; 2],
    pub spp: u32,
    /// The refinement by adaptive sampling; null without it.
    pub adaptive: Option<Adaptive>,
    /// The number of rendered frames; all counts and times are sums over them.
    pub frames: usize,
    pub geometry: Geometry,
    pub build: Build,
    pub rays: RayCounts,
    /// The amount of work of each counted kind.
    pub work: BTreeMap<&'static str, u64>,
    /// The reason why each skipped kind of work was not needed.
    pub skipped: BTreeMap<&'static str, String>,
    /// The numbers of samples that were left out because they are not finite, by cause.
    pub not_finite: NotFinite,
    pub seconds: Seconds,
    /// The seconds of all processors that worked for the process; null where the system does not tell.
    pub cpu_seconds: Option<Seconds>,
    /// The number of all rays over the time to render.
    pub mrays_per_second: f64,
    /// The peak memory of the process; null where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// The peak memory of Embree; null without Embree.
    pub embree_peak_memory_bytes: Option<u64>,
    /// The load report.
    pub report: LoadSummary,
    pub warnings: Vec<String>,
}

/// The refinement by adaptive sampling.
#[derive(Serialize)]
pub struct Adaptive {
    /// The most samples of a pixel.
    pub max: u32,
    /// The colour difference from which a pixel is refined.
    pub threshold: f32,
    /// The numbers of samples after each step; every pixel has those of the first.
    pub steps: Vec<usize>,
    /// The numbers of pixels that were refined in each step after the first, in all frames.
    pub refined: Vec<u64>,
}

/// The ray tracing backend.
#[derive(Serialize)]
pub struct Backend {
    pub name: &'static str,
    pub version: String,
    /// The library of Embree that is used: its path, or the name by which the system found it; null
    /// without Embree.
    pub library: Option<String>,
}

/// The numbers of primitives.
#[derive(Serialize)]
pub struct Geometry {
    pub spheres: usize,
    /// The triangles of all instances of meshes.
    pub triangles: u64,
    pub planes: usize,
    pub instances: usize,
}

impl Geometry {
    pub fn new(scene: &Scene) -> Self {
        Self {
            spheres: scene.spheres.len(),
            triangles: scene.triangle_count(),
            planes: scene.planes.len(),
            instances: scene.instances.len(),
        }
    }

    /// True if there is nothing that a ray can hit.
    pub fn is_empty(&self) -> bool {
        self.spheres == 0 && self.planes == 0 && self.triangles == 0
    }
}

/// The work of building the intersectors of all frames.
#[derive(Serialize)]
pub struct Build {
    /// The meshes whose BLAS was built.
    pub meshes: u64,
    /// The meshes whose BLAS was reused from an earlier frame.
    pub reused: u64,
    /// The build quality of Embree's BVH, `low` or `medium`; null without Embree.
    pub bvh: Option<&'static str>,
    /// The number of times that a TLAS was built.
    pub top_levels_built: u64,
    /// The number of frames for which the TLAS of the frame before was updated.
    pub top_levels_kept: u64,
    /// The instances that were added to a TLAS that was built.
    pub instances_placed: u64,
    /// The instances that moved in a TLAS that was updated.
    pub instances_moved: u64,
    /// The spheres that moved in a TLAS that was updated.
    pub spheres_moved: u64,
}

/// The times of the stages, in seconds.
#[derive(Serialize)]
pub struct Seconds {
    pub load: f64,
    pub build: f64,
    pub render: f64,
    pub write: f64,
    pub total: f64,
}

impl Seconds {
    /// Collects the seconds of one kind, by the clock or of the processors.
    fn new(
        totals: &RenderTotals,
        [load, total]: [Elapsed; 2],
        of: fn(Elapsed) -> Duration,
    ) -> Self {
        let Statistics { build, render, .. } = totals.statistics;
        let [load, build, render, write, total] =
            [load, build, render, totals.write, total].map(|elapsed| of(elapsed).as_secs_f64());
        Self { load, build, render, write, total }
    }
}

impl RenderStats {
    /// Collects the statistics of a rendering; `scene` is that of the first frame, and `times` are the time to load
    /// it and check the outputs, and that of the whole command.
    pub fn new(
        scene: &Scene,
        report: &LoadReport,
        totals: &RenderTotals,
        times: [Elapsed; 2],
        warnings: Vec<String>,
    ) -> Self {
        let RenderTotals { statistics, frames, images, .. } = totals;
        let (Counts { rays, not_finite, .. }, built) = (statistics.counts, statistics.built);
        let seconds = Seconds::new(totals, times, |elapsed| elapsed.wall);
        let cpu_seconds = Seconds::new(totals, times, |elapsed| elapsed.cpu);
        let cpu_seconds = (cpu_seconds.total > 0.0).then_some(cpu_seconds);
        let (name, version) = (statistics.backend, statistics.backend_version.clone());
        // The steps of adaptive sampling, and how many pixels took each after the first.
        let adaptive = scene.film.adaptive.map(|AdaptiveSampling { max, threshold }| {
            let steps = sample_steps(&scene.film);
            let refined = statistics.counts.refined[..steps.len() - 1].to_vec();
            Adaptive { max, threshold, steps, refined }
        });
        // The work that was done, and the reasons for what was not.
        let work = work(scene, statistics, *images);
        let features = SceneFeatures::from_scene(scene);
        let skipped = features.skipped().map(|(feature, reason)| (feature.name(), reason));
        let skipped = skipped.filter(|(name, _)| work.get(name).is_none_or(|&count| count == 0));
        Self {
            backend: Backend { name, version, library: embree_library(statistics) },
            precision: statistics.precision.name(),
            threads: statistics.threads,
            size: scene.film.size,
            spp: scene.film.spp,
            adaptive,
            frames: *frames,
            geometry: Geometry::new(scene),
            build: Build {
                meshes: built.meshes_built,
                reused: built.meshes_reused,
                bvh: statistics.quality.map(BuildQuality::name),
                top_levels_built: built.tlas_built,
                top_levels_kept: built.tlas_updated,
                instances_placed: built.instances_built,
                instances_moved: built.instances_moved,
                spheres_moved: built.spheres_moved,
            },
            rays,
            skipped: skipped.collect(),
            work,
            not_finite,
            mrays_per_second: rays.total() as f64 / seconds.render.max(1e-9) * 1e-6,
            seconds,
            cpu_seconds,
            peak_memory_bytes: peak_memory(),
            embree_peak_memory_bytes: embree_peak_memory(statistics),
            report: report.into(),
            warnings,
        }
    }
}

/// Returns the amount of work of each counted kind; `images` is the number of encoded images.
fn work(scene: &Scene, statistics: &Statistics, images: u64) -> BTreeMap<&'static str, u64> {
    let Statistics { built, counts, .. } = statistics;
    let (rays, done) = (&counts.rays, &counts.work);
    // The pictures that were read, each once however many textures show it.
    let mut textures: Vec<_> = scene.textures.iter().map(|t| &t.image).collect();
    textures.retain(|image| image.is_read());
    textures.sort_by_key(|image| Arc::as_ptr(image));
    textures.dedup_by_key(|image| Arc::as_ptr(image));
    // Counts of what the intersectors hold, of what shading did, and of rays.
    [
        (Feature::Spheres.name(), built.sphere_geometries),
        (Feature::Instances.name(), built.object_space_instances),
        (Feature::Planes.name(), done.planes),
        (Feature::Pictures.name(), textures.len() as u64),
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
        (Feature::Culling.name(), done.culling),
        (Feature::AreaLights.name(), done.area_lights),
        (Feature::EmissiveLights.name(), done.emissive_lights),
        (Feature::Pbr.name(), done.pbr),
        (Feature::Environment.name(), done.environment),
        ("glass-in-shadows", done.glass),
        ("filters", done.filters),
        ("layers", images),
    ]
    .into()
}

/// Returns the library of Embree; none without Embree.
fn embree_library(statistics: &Statistics) -> Option<String> {
    #[cfg(feature = "embree")]
    return statistics
        .quality
        .and_then(|_| crate::intersect::embree_library())
        .map(|path| path.display().to_string());
    #[cfg(not(feature = "embree"))]
    statistics.quality.and(None)
}

/// Returns the peak memory of Embree; none without Embree.
fn embree_peak_memory(statistics: &Statistics) -> Option<u64> {
    #[cfg(feature = "embree")]
    return statistics.quality.map(|_| crate::intersect::embree_peak_memory());
    #[cfg(not(feature = "embree"))]
    statistics.quality.and(None)
}

/// Returns the process's peak memory in bytes, on Linux.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}
