//! From the command line to a scene.

use std::path::PathBuf;

use clap::Args;

use crate::cli::values::{PrecisionName, seconds, size};
use crate::cli::{files, load_report};
use crate::error::{Error, Result};
use crate::load::{Limits, LoadOptions, LoadReport, Loaded, NamedLimit};
use crate::scene::Scene;
use crate::scene::check::{MAX_DEPTH, MAX_SPP};

/// How the files of a scene are loaded; shared by the commands that load one.
#[derive(Args, Clone)]
pub struct Loading {
    /// Show this variant of the materials of a glTF file, in a scene file of each model that has
    /// one of this name and names none itself; `envers info` lists them
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// Let files name others that are anywhere, not only beside and below SCENE
    #[arg(long)]
    pub allow_outside: bool,
    /// Another limit on what SCENE may ask for: bytes, json, nodes, depth, instances, vertices, triangles,
    /// deformed, elements, keys, pictures or pixels; may be given several times
    #[arg(long, value_name = "NAME=NUMBER")]
    pub limit: Vec<NamedLimit>,
}

impl Loading {
    /// The options of a load.
    pub fn options(&self, size: Option<[u32; 2]>) -> LoadOptions {
        let with = |limits: Limits, &NamedLimit(limit, most): &_| limits.with_limit(limit, most);
        let limits = self.limit.iter().fold(Limits::default(), with);
        let (variant, allow_outside) = (self.variant.clone(), self.allow_outside);
        LoadOptions { size, variant, allow_outside, limits }
    }
}

/// What to render and how; shared by the commands that trace rays.
#[derive(Args)]
pub struct Tracing {
    /// A scene file (.toml) or a model (.gltf, .glb, .obj)
    pub scene: PathBuf,
    /// Size of the picture in pixels, such as 1920x1080 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Samples per pixel [default: the scene's; bare models 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SPP)), allow_negative_numbers = true)]
    pub spp: Option<u32>,
    /// How often light is followed off mirrors and through glass, from 0 to 65536 [default: the
    /// scene's, else 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_DEPTH)), allow_negative_numbers = true)]
    pub max_depth: Option<u32>,
    /// Camera, by name or by index from 0 [default: the first]
    #[arg(long, value_name = "NAME|INDEX")]
    pub camera: Option<String>,
    /// One moment of an animation, in seconds [default: the first frame, at 0]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub time: Option<f64>,
    /// How far hits can be trusted: fast is f64 formulas and f32 traversal, certified is proven
    #[arg(long, value_enum, default_value = "fast")]
    pub precision: PrecisionName,
    /// Threads [default: all there are]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    pub threads: Option<u16>,
    #[command(flatten)]
    pub loading: Loading,
    /// Fail, with status 2, where anything of the scene's files is dropped, not supported, or shown
    /// by a placeholder
    #[arg(long)]
    pub strict: bool,
    /// Print no progress and no warnings
    #[arg(short, long)]
    pub quiet: bool,
}

/// A scene that was loaded for tracing, with the flags applied.
pub struct Input {
    pub scene: Scene,
    /// The load report.
    pub report: LoadReport,
    /// The index of the camera.
    pub camera: usize,
}

impl Tracing {
    /// Loads the scene as it is at one moment; see [`Tracing::load_animated`].
    ///
    /// # Errors
    /// As [`Tracing::load_animated`].
    pub fn load(&self) -> Result<Input> {
        let input = self.load_animated()?;
        Ok(Input { scene: input.scene.at_time(0.0)?, ..input })
    }

    /// Loads the scene and applies the flags; says which camera is asked for. Where `--time` asks
    /// for a moment the scene is that.
    ///
    /// # Errors
    /// When the scene cannot be loaded, or the flags do not fit it.
    pub fn load_animated(&self) -> Result<Input> {
        files::check_input(&self.scene)?;
        // Loading and writing keep to them, too. Fails only where the pool is there already.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(self.threads()).build_global();
        let Loaded { mut scene, report } = self.loading.options(self.size).load(&self.scene)?;
        if self.strict {
            load_report::check_strictly(&report, &self.scene)?;
        }
        if let Some(spp) = self.spp {
            (scene.film.spp, scene.film.adaptive) = (spp, None);
        }
        if let Some(depth) = self.max_depth {
            scene.film.max_depth = depth;
        }
        let camera = match &self.camera {
            None => 0,
            Some(wanted) => find_camera(&scene, wanted)?,
        };
        if let Some(time) = self.time {
            if scene.animation.is_none() {
                let error = Error::input("the scene has no animation, and so no --time");
                return Err(error.at(&self.scene).help("leave --time out"));
            }
            scene = scene.at_time(time).map_err(|e| e.at(&self.scene))?;
        }
        Ok(Input { scene, report, camera })
    }

    /// The number of threads; 0 means all.
    pub fn threads(&self) -> usize {
        self.threads.map_or(0, usize::from)
    }
}

fn find_camera(scene: &Scene, wanted: &str) -> Result<usize> {
    if let Some(index) = scene.cameras.iter().position(|c| c.name == wanted) {
        return Ok(index);
    }
    match wanted.parse::<usize>() {
        Ok(index) if index < scene.cameras.len() => Ok(index),
        _ => {
            let names: Vec<String> =
                (0..).zip(&scene.cameras).map(|(i, c)| shown(i, &c.name)).collect();
            Err(Error::input(format!("there is no camera `{wanted}`"))
                .help(format!("the scene has {}", names.join(", "))))
        }
    }
}

fn shown(index: usize, name: &str) -> String {
    if name.is_empty() { index.to_string() } else { format!("{index} `{name}`") }
}
