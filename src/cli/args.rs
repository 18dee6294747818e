//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::cli::bench::Bench;
use crate::cli::range::Range;
use crate::cli::values::{
    BackendName, BvhName, PrecisionName, SampleRange, ToneName, ViewName, finite, goal,
    not_negative, sample_range, seconds, share, size,
};
use crate::geometry::Ray;
use crate::load::{Limits, NamedLimit, Options};
use crate::measure::ray_from_text;
use crate::measure::stress::Goal;
use crate::scene::Skips;
use crate::scene::check::{MAX_DEPTH, MAX_SPP};

/// Render scenes with analytic spheres, glTF and OBJ models; check every hit.
#[derive(Parser)]
#[command(name = "envers", disable_version_flag = true, after_help = EXAMPLES)]
pub struct Arguments {
    /// Print the versions of envers and Embree
    #[arg(short = 'V', long)]
    pub version: bool,
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXAMPLES: &str = "\
Examples:
  envers render model.glb -o out.png
  envers render scene.toml -o out.png -o out.exr --spp 16
  envers validate scene.toml
  envers stress --quick
  envers bench scene.toml --out out/bench
  envers diff a.exr b.exr --tolerance 0.004

Exit status: 0 done, 1 a check or the work failed, 2 the command line or the input is wrong.";

#[derive(Subcommand)]
pub enum Command {
    /// Render a scene to PNG or EXR
    Render(Render),
    /// Hold Embree against the pure-Rust intersector, hit by hit and pixel by pixel
    Validate(Validate),
    /// Try every promise about precision where numbers are at their worst
    Stress(Stress),
    /// Hold run time against error, mode by mode
    Bench(Bench),
    /// Say what is in a scene, and what will be skipped
    Info(Info),
    /// Compare two pictures: exit status 0 when they are equal, 1 when they differ
    Diff(Diff),
}

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
    pub fn options(&self, size: Option<[u32; 2]>, skips: Skips) -> Options {
        let with = |limits: Limits, &NamedLimit(limit, most): &_| limits.with(limit, most);
        let limits = self.limit.iter().fold(Limits::default(), with);
        let (variant, allow_outside) = (self.variant.clone(), self.allow_outside);
        Options { size, skips, variant, allow_outside, limits }
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

#[derive(Args)]
#[command(after_help = "\
Examples:
  envers render model.glb -o out.png
  envers render scene.toml -o out.png -o out.exr --size 1920x1080 --spp 16
  envers render scene.toml -o out.png --adaptive 1..25
  envers render scene.toml -o depth.exr --view depth --stats -
  envers render orbit.toml -o orbit.gif
  envers render orbit.toml --frames 1-120x2 -o out/frame-####.png --skip-existing")]
pub struct Render {
    #[command(flatten)]
    pub tracing: Tracing,
    /// Output file, .png or .exr, of an animation also .gif or .apng; may be given several times.
    /// #### stands for the number of the frame [default: NAME.png in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Frames of an animation: one, such as 7, or some, such as 1-120 or 1-120x2 [default: all for
    /// .gif, .apng and ####, otherwise the first]
    #[arg(long, value_name = "FRAMES", value_parser = Range::from_text, conflicts_with = "time", allow_negative_numbers = true)]
    pub frames: Option<Range>,
    /// From MIN to MAX samples per pixel: more than MIN where neighbouring ones disagree in what they
    /// hit, in its normal or in colour. 1..25 suits clear shapes, 4..36 fine detail
    #[arg(long, value_name = "MIN..MAX", value_parser = sample_range, conflicts_with = "spp", allow_negative_numbers = true)]
    pub adaptive: Option<SampleRange>,
    /// From which difference on colours disagree, from 0 (always) to 1, of about what a PNG shows
    /// [default: the scene's, else 0.1]
    #[arg(long, value_name = "X", value_parser = share, allow_negative_numbers = true)]
    pub threshold: Option<f32>,
    /// Leave alone what is there already, to go on where a rendering was interrupted
    #[arg(long)]
    pub skip_existing: bool,
    /// Who finds the hits [default: embree where it is built in]
    #[arg(long, value_enum)]
    pub backend: Option<BackendName>,
    /// How Embree builds its trees: low is built faster, medium traced faster; auto goes by the number
    /// of rays to come. The pure-Rust intersector builds one way only
    #[arg(long, value_enum, default_value = "auto", value_name = "QUALITY")]
    pub bvh: BvhName,
    /// Put matt ground under the scene, on which its shadow falls
    #[arg(long)]
    pub ground: bool,
    /// What the picture shows; normal, depth and id are raw values in EXR, colours in PNG
    #[arg(long, value_enum, default_value = "beauty")]
    pub view: ViewName,
    /// Brighten the PNG by 2 to the power of EV; an EXR is never changed [default: the scene's]
    #[arg(long, value_name = "EV", value_parser = finite, allow_negative_numbers = true)]
    pub exposure: Option<f64>,
    /// Tone curve of the PNG: how it shows what is bright; an EXR is never changed [default: the
    /// scene's]
    #[arg(long, value_enum, value_name = "CURVE")]
    pub tone: Option<ToneName>,
    /// Store 16-bit floats in the EXR rather than 32-bit ones; what is beyond 65504 becomes that
    #[arg(long)]
    pub half: bool,
    /// Write what was counted and timed as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    /// Do this kind of work even where the scene has no need of it: to test that leaving it out
    /// changes nothing; may be given several times
    #[arg(long, value_name = "NAME", hide = true)]
    pub no_skip: Vec<String>,
}

#[derive(Args)]
#[command(after_help = "\
Of Embree in the given precision and the certified pure-Rust intersector, every hit, of the \
eye's rays and of those off mirrors and through glass, every shadow ray from what the eye sees and \
every pixel is compared. fast passes where each mismatch is explained by what f32 \
rays and f64 formulas promise (edge, tangency, tie), on at most 1e-4 of the rays, and at most 1e-5 \
of the pixels differ by more than 1 of 255; certified where nothing differs by any bit.

The heat map: red an unexplained mismatch, yellow an explained one, blue a pixel that differs, grey \
where both hit something, black where both hit nothing.

Examples:
  envers validate scene.toml --precision certified
  envers validate scene.toml --json - --heatmap heat.png
  envers validate scene.toml --ray 0,1.5,6,0,-0.1,-1

Exit status: 0 it passed, 1 it did not, 2 the command line or the input is wrong.")]
pub struct Validate {
    #[command(flatten)]
    pub tracing: Tracing,
    /// Only trace this ray, origin and direction, and say what each intersector makes of it in each
    /// precision, held against exact arithmetic
    #[arg(long, value_name = "ox,oy,oz,dx,dy,dz", value_parser = ray_from_text, allow_hyphen_values = true, conflicts_with_all = ["heatmap", "precision", "size", "spp", "max_depth", "camera", "threads"])]
    pub ray: Option<Ray>,
    /// Write the result as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Write a picture of where the hits differ
    #[arg(long, value_name = "FILE.png")]
    pub heatmap: Option<PathBuf>,
}

#[derive(Args)]
#[command(after_help = "\
Goals: G1 distances to spheres, G2 tangency, G3 trees against brute force, G4 closed meshes, \
G5 grazing triangles, G6 shadows, G7 scale, threads and tiles.

Examples:
  envers stress --quick
  envers stress --goal G1,G2 --json rows.json --plot error.svg
  envers stress --resume finished.jsonl

Exit status: 0 every row passed, 1 one failed, 2 the command line or the input is wrong.")]
pub struct Stress {
    /// Fewer rays of every kind: less than a minute on two cores
    #[arg(long)]
    pub quick: bool,
    /// Which sweeps, such as G1,G2 [default: all]
    #[arg(long, value_name = "GOALS", value_delimiter = ',', value_parser = goal)]
    pub goal: Vec<Goal>,
    /// What the random numbers depend on
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Write the rows as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Write a plot of the error of each sphere formula over distance
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Keep finished cells in this file, and skip those that are there
    #[arg(long, value_name = "FILE.jsonl")]
    pub resume: Option<PathBuf>,
    /// Print no progress
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Args)]
pub struct Info {
    /// A scene file (.toml) or a model (.gltf, .glb, .obj)
    pub scene: PathBuf,
    #[command(flatten)]
    pub loading: Loading,
    /// Fail, with status 2, where anything of the scene's files is dropped, not supported, or shown
    /// by a placeholder
    #[arg(long)]
    pub strict: bool,
    /// Write it as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
}

#[derive(Args)]
#[command(after_help = "\
FLIP (Andersson et al. 2020) says how far the pictures differ to somebody who flips between them, from \
0 to 1, on a screen with 67 pixels in a degree of the view. An EXR is shown clamped to [0, 1], as \
sRGB; views other than beauty have none.")]
pub struct Diff {
    /// A picture, .png or .exr
    pub a: PathBuf,
    /// Another one of the same kind and size
    pub b: PathBuf,
    /// Largest difference of two values that still counts as equal; a PNG's values are n/255
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub tolerance: f32,
    /// Write the result as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Write a picture of the differences: black where equal, white where the largest
    #[arg(long, value_name = "FILE.png")]
    pub heatmap: Option<PathBuf>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_line_is_consistent() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
