//! The flags for loading and tracing a scene, and the scene that they select.

use std::path::PathBuf;

use clap::Args;

use crate::cli::flag_values::{
    INTEGRATORS, NamedLimit, PRECISIONS, SHADING_MODELS, Size, UP_AXES, choice, elevation, finite,
    seconds, size,
};
use crate::cli::{load_report, messages, paths};
use crate::error::{Error, Result};
use crate::intersect::Precision;
use crate::load::{EnvironmentSource, Framing, Limits, LoadOptions, LoadReport, Loaded, UpAxis};

use crate::scene::check::{MAX_DEPTH, MAX_OCCLUSION_RAYS, MAX_SPP};
use crate::scene::{Camera, IntegratorKind, Scene, ShadingModel};

/// The flags for loading a scene's files; shared by the commands that load one.
#[derive(Args, Clone)]
pub struct LoadArgs {
    /// Material variant of a glTF file to use; `envers info` lists them. In a scene file it applies
    /// to every model that has this variant and selects none itself
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// Allow files to refer to files outside the folder of SCENE
    #[arg(long)]
    pub allow_outside: bool,
    /// Show the back faces of one-sided glTF materials (`doubleSided` false), too
    #[arg(long)]
    pub double_sided: bool,
    /// Environment that lights SCENE, instead of its own: an equirectangular image file (.hdr, .exr or any
    /// format of textures), studio, sky or none [default: the scene's; studio for a model]
    #[arg(long, value_name = "FILE|NAME")]
    pub environment: Option<String>,
    /// Shading model of models' materials: pbr (physically based) or phong (Lambert and Phong, as in the
    /// tutorial) [default: pbr for glTF files, phong for most MTL files]
    #[arg(long, value_name = "MODEL", value_parser = choice(SHADING_MODELS))]
    pub shading: Option<ShadingModel>,
    /// Change a limit on what SCENE may use: bytes, json, nodes, depth, instances, vertices,
    /// triangles, deformed, elements, keys, pictures or pixels; can be given several times
    #[arg(long, value_name = "NAME=NUMBER")]
    pub limit: Vec<NamedLimit>,
}

impl LoadArgs {
    /// Returns the options of a load.
    pub fn options(&self) -> LoadOptions {
        LoadOptions {
            variant: self.variant.clone(),
            shading: self.shading,
            environment: self.environment.as_deref().map(EnvironmentSource::from_text),
            allow_outside: self.allow_outside,
            double_sided: self.double_sided,
            limits: limits(&self.limit),
            ..LoadOptions::default()
        }
    }
}

/// Returns the default limits with those that flags change.
pub fn limits(changed: &[NamedLimit]) -> Limits {
    let set = |limits: Limits, &NamedLimit(limit, value): &_| limits.with_limit(limit, value);
    changed.iter().fold(Limits::default(), set)
}

/// The scene and the flags that select what of it to show; shared by the commands that render one.
#[derive(Args)]
pub struct InputArgs {
    /// Scene file (.toml) or model (.gltf, .glb, .vrm, .obj)
    pub scene: PathBuf,
    /// Image size in pixels, such as 1920x1080, or the width alone [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = size, allow_negative_numbers = true)]
    pub size: Option<Size>,
    /// Camera, by name or by index from 0 [default: the first]
    #[arg(long, value_name = "NAME|INDEX")]
    pub camera: Option<String>,
    /// Axis of a bare model that is upward in the picture [default: y]
    #[arg(long, value_name = "AXIS", value_parser = choice(UP_AXES), allow_hyphen_values = true)]
    pub up: Option<UpAxis>,
    /// Angle in degrees, to the right around a bare model, from its front to where the camera stands
    #[arg(long, value_name = "DEGREES", value_parser = finite, conflicts_with = "camera", allow_negative_numbers = true)]
    pub azimuth: Option<f64>,
    /// Angle in degrees by which the camera stands higher than a bare model, from -90 to 90
    #[arg(long, value_name = "DEGREES", value_parser = elevation, conflicts_with = "camera", allow_negative_numbers = true)]
    pub elevation: Option<f64>,
    /// Number of threads [default: one per processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    pub threads: Option<u16>,
    #[command(flatten)]
    pub load: LoadArgs,
    /// Do not print progress and warnings
    #[arg(short, long)]
    pub quiet: bool,
}

/// The flags for tracing a scene; shared by `render` and `validate`.
#[derive(Args)]
pub struct TraceArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// Samples per pixel [default: the scene's; 16 for a model]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SPP)), allow_negative_numbers = true)]
    pub spp: Option<u32>,
    /// Maximum number of reflections and refractions along a light path, from 0 to 65536 [default:
    /// the scene's, or 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_DEPTH)), allow_negative_numbers = true)]
    pub max_depth: Option<u32>,
    /// Integrator: whitted has no noise, path traces all light by random paths, with noise that falls with the
    /// number of samples (--spp) [default: the scene's, or whitted]
    #[arg(long, value_name = "INTEGRATOR", value_parser = choice(INTEGRATORS))]
    pub integrator: Option<IntegratorKind>,
    /// Seed of the random numbers of the integrator path: another one gives other noise
    /// [default: the scene's, or 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub seed: Option<u32>,
    /// Ambient occlusion: number of rays, from 0 to 1024, by which each surface finds how much of the
    /// environment's and of ambient light arrives there [default: the scene's, or 0]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_OCCLUSION_RAYS)), allow_negative_numbers = true)]
    pub ao: Option<u32>,
    /// Time of an animation to show, in seconds [default: 0, the first frame]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub time: Option<f64>,
    /// Precision of the hits: fast traces in f32 and intersects in f64, certified equals exact
    /// arithmetic
    #[arg(long, value_name = "PRECISION", value_parser = choice(PRECISIONS), default_value = "fast")]
    pub precision: Precision,
    /// Fail with exit status 2 if anything in the scene's files is dropped, unsupported or replaced
    /// by a placeholder
    #[arg(long)]
    pub strict: bool,
}

/// A loaded scene, with the flags applied.
pub struct SceneInput {
    pub scene: Scene,
    /// The load report.
    pub report: LoadReport,
    /// The index of the camera.
    pub camera: usize,
}

impl InputArgs {
    /// Returns the options of the load.
    pub fn options(&self) -> LoadOptions {
        let mut options = self.load.options();
        match self.size {
            Some(Size::Exact(size)) => options.size = Some(size),
            Some(Size::Width(width)) => options.width = Some(width),
            None => {}
        }
        let [azimuth, elevation] = [self.azimuth, self.elevation].map(|a| a.map(f64::to_radians));
        options.framing = Framing { up: self.up, azimuth, elevation };
        options
    }

    /// Loads the scene, with its animation. If `strict`, it must be complete.
    ///
    /// # Errors
    /// When the scene cannot be loaded, is not complete, or has no such camera.
    pub fn load(&self, options: &LoadOptions, strict: bool) -> Result<SceneInput> {
        paths::check_input(&self.scene)?;
        // The number of threads applies to loading and writing, too. Building the global pool fails
        // only if there is one already.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(self.threads()).build_global();
        let spinner = messages::spinner(self.quiet, "loading");
        let Loaded { scene, report } = options.load(&self.scene)?;
        drop(spinner);
        if strict {
            load_report::check_strictly(&report, &self.scene)?;
        }
        let camera = match &self.camera {
            None => 0,
            Some(camera) => find_camera(&scene, camera)?,
        };
        Ok(SceneInput { scene, report, camera })
    }

    /// Returns the number of threads; 0 means one per processor.
    pub fn threads(&self) -> usize {
        self.threads.map_or(0, usize::from)
    }
}

impl TraceArgs {
    /// Loads the scene and applies the flags. With `--time` the scene is that of this time, without
    /// an animation.
    ///
    /// # Errors
    /// When the scene cannot be loaded, or the flags do not fit it.
    pub fn load(&self) -> Result<SceneInput> {
        self.load_with(&self.input.options())
    }

    /// The same, with these options of the load.
    ///
    /// # Errors
    /// The same.
    pub fn load_with(&self, options: &LoadOptions) -> Result<SceneInput> {
        let mut input = self.input.load(options, self.strict)?;
        let (scene, path) = (&mut input.scene, &self.input.scene);
        if let Some(spp) = self.spp {
            (scene.film.spp, scene.film.adaptive) = (spp, None);
        }
        if let Some(integrator) = self.integrator {
            scene.film.integrator = integrator;
        }
        if let Some(seed) = self.seed {
            scene.film.seed = seed;
        }
        if let Some(rays) = self.ao {
            scene.film.ambient_occlusion = rays;
        }
        if let Some(depth) = self.max_depth {
            scene.film.max_depth = depth;
        }
        if let Some(time) = self.time {
            if scene.animation.is_none() {
                let message = "--time needs an animation, and the scene has no animation";
                return Err(Error::input(message).at(path).help("leave out --time"));
            }
            *scene = scene.at_time(time).map_err(|e| e.at(path))?;
        }
        Ok(input)
    }
}

/// Returns the index of a camera, given by its name or index.
fn find_camera(scene: &Scene, camera: &str) -> Result<usize> {
    // A name counts before an index, since a camera may be called like a number.
    let by_name = scene.cameras.iter().position(|c| c.name == camera);
    let by_index = || camera.parse().ok().filter(|&index: &usize| index < scene.cameras.len());
    by_name.or_else(by_index).ok_or_else(|| {
        let cameras = scene.cameras.iter().enumerate();
        let label = |(i, c): (usize, &Camera)| messages::labelled(&i.to_string(), &c.name);
        let labels: Vec<String> = cameras.map(label).collect();
        Error::input(format!("there is no camera `{camera}`"))
            .help(format!("the scene has {}", labels.join(", ")))
    })
}
