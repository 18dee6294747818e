//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::cli::bench::Bench;
use crate::cli::load::{Loading, Tracing};
use crate::cli::range::Range;
use crate::cli::values::{
    BackendName, BvhName, SampleRange, ToneName, ViewName, finite, goal, not_negative,
    sample_range, share,
};
use crate::geometry::Ray;
use crate::measure::ray_from_text;
use crate::measure::stress::Goal;

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
