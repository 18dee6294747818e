//! The command line: subcommands, flags and help.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};

use crate::cli::flag_values::{
    BVH_QUALITIES, BackendChoice, BvhQuality, NamedLimit, SampleRange, TONES, VIEWS, backend,
    backend_choice, choice, duration, finite, goal, sample_range, share, tolerance,
};
use crate::cli::frame_range::FrameRange;
use crate::cli::scene_args::{InputArgs, LoadArgs, TraceArgs};
use crate::film::View;
use crate::geometry::Ray;
use crate::intersect::Backend;
use crate::measure::{ray_from_text, stress::Goal};
use crate::scene::{Tone, check::MAX_SPP};

/// Render 3D scenes and models (glTF, VRM, OBJ), and verify every ray-surface hit.
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

Exit status:
  0  success
  1  a check or the work failed: an output cannot be written, the scene is empty, memory ran out
  2  the command line or an input is wrong, such as an output whose folder does not exist
A signal that stops envers (Ctrl-C, kill) removes its temporary files; a shell shows 130 or 143.";

#[derive(Subcommand)]
pub enum Command {
    /// Render a scene or model to an image
    Render(Render),
    /// Compare Embree with the certified pure-Rust ray tracer, hit by hit and pixel by pixel
    Validate(Validate),
    /// Test the precision of ray intersections where rounding errors are worst
    Stress(Stress),
    /// Measure run time and image error of every backend, precision and number of samples
    Bench(Bench),
    /// Print the contents of a scene or model, and what rendering it needs
    Info(Info),
    /// Compare two images: exit status 0 if they are equal, 1 if they differ
    Diff(Diff),
    /// Print a script that completes the command line in a shell
    Completions(Completions),
    /// Write the manual pages to a folder
    Man(Man),
}

#[derive(Args)]
#[command(after_help = "\
Examples:
  envers render model.glb -o out.png
  envers render scene.toml -o out.png -o out.exr --size 1920x1080 --spp 16
  envers render scene.toml -o out.png --adaptive 1..25
  envers render model.glb -o cutout.png --transparent
  envers render scene.toml -o depth.exr --view depth --stats -
  envers render orbit.toml -o orbit.gif
  envers render orbit.toml --frames 1-120x2 -o out/frame-####.png --skip-existing")]
pub struct Render {
    #[command(flatten)]
    pub trace: TraceArgs,
    /// Output file: .png, .jpg, .webp (lossless) or .exr, for an animation also .gif or .apng; can be
    /// given several times. #### stands for the frame number [default: NAME.png in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Frames of an animation to render: one (7), a range (1-120) or every n-th frame of a range
    /// (1-120x2) [default: all for .gif, .apng and ####, otherwise the first]
    #[arg(long, value_name = "FRAMES", value_parser = FrameRange::from_text, conflicts_with = "time", allow_negative_numbers = true)]
    pub frames: Option<FrameRange>,
    /// Adaptive sampling: MIN samples per pixel, and up to MAX where neighbouring samples differ in
    /// object, normal or colour. 1..25 suits clear shapes, 4..36 fine detail
    #[arg(long, value_name = "MIN..MAX", value_parser = sample_range, conflicts_with = "spp", allow_negative_numbers = true)]
    pub adaptive: Option<SampleRange>,
    /// Colour difference from which adaptive sampling adds samples, from 0 (always) to 1, on about
    /// the scale of a PNG's values [default: the scene's, or 0.1]
    #[arg(long, value_name = "X", value_parser = share, allow_negative_numbers = true)]
    pub threshold: Option<f32>,
    /// Render the background if there is nothing in the scene that a ray can hit; without this flag
    /// that fails with exit status 1
    #[arg(long)]
    pub allow_empty: bool,
    /// Skip frames whose output files exist, to resume an interrupted rendering
    #[arg(long)]
    pub skip_existing: bool,
    /// Ray tracing backend: auto is Embree if its library is on this machine, otherwise rust
    #[arg(long, value_name = "BACKEND", value_parser = backend_choice(), default_value = "auto")]
    pub backend: BackendChoice,
    /// Build quality of Embree's BVH: low builds faster, medium traces faster, auto chooses by the
    /// number of rays. The pure-Rust backend has only one quality
    #[arg(long, value_name = "QUALITY", value_parser = choice(BVH_QUALITIES), default_value = "auto")]
    pub bvh: BvhQuality,
    /// Add a matt ground plane under the scene, to receive its shadows
    #[arg(long)]
    pub ground: bool,
    /// Transparent background: the image gets alpha, the share of each pixel that something covers.
    /// Mirrors and glass still show the background. Not for JPEG and GIF
    #[arg(long)]
    pub transparent: bool,
    /// Quantity to show: beauty is the rendered image, id numbers the objects. Normals, depths and
    /// ids are raw values in EXR and colours in other formats
    #[arg(long, value_name = "VIEW", value_parser = choice(VIEWS), default_value = "beauty")]
    pub view: View,
    /// Exposure in stops: multiplies the radiance by 2^EV in all formats but EXR, which is never
    /// changed [default: the scene's]
    #[arg(long, value_name = "EV", value_parser = finite, allow_negative_numbers = true)]
    pub exposure: Option<f64>,
    /// Tone mapping curve of all formats but EXR, which is never changed [default: the scene's]
    #[arg(long, value_name = "CURVE", value_parser = choice(TONES))]
    pub tone: Option<Tone>,
    /// Store 16-bit instead of 32-bit floats in the EXR; larger values become 65504
    #[arg(long)]
    pub half: bool,
    /// Quality of the JPEG, from 1 (smallest file) to 100 (nearest to the pixels of a PNG)
    /// [default: 90]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=100), allow_negative_numbers = true)]
    pub quality: Option<u8>,
    /// Write statistics (counts, times, memory) as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
}

#[derive(Args)]
#[command(after_help = "\
Traces the scene with Embree in the given precision, and with the certified pure-Rust BVH. Compares \
every hit of camera rays and of reflected and refracted rays, every shadow ray from the hits of \
camera rays, and every pixel.

In precision fast the validation passes if every mismatch is explained by the error bounds (the ray \
is close to an edge, to a tangent, or to a tie of two surfaces), at most 1e-4 of the rays mismatch, \
and at most 1e-5 of the pixels differ by more than 1 of 255. In precision certified it passes if no \
bit differs.

With --ray, one ray is traced with every intersector, and the exact one's distance is compared with that of \
the file's decimals before any of them was rounded.

Colours of the heat map: red for an unexplained mismatch, yellow for an explained one, blue for a \
pixel that differs, grey where both hit something, black where both hit nothing.

Examples:
  envers validate scene.toml --precision certified
  envers validate scene.toml --json - --heatmap heat.png
  envers validate scene.toml --ray 0,1.5,6,0,-0.1,-1

Exit status: 0 passed, 1 failed, 2 the command line or the input is invalid.")]
pub struct Validate {
    #[command(flatten)]
    pub trace: TraceArgs,
    /// Trace only this ray (origin and direction), and print the hit that each intersector finds in
    /// each precision, with its error against exact arithmetic
    #[arg(long, value_name = "ox,oy,oz,dx,dy,dz", value_parser = ray_from_text, allow_hyphen_values = true, conflicts_with_all = ["heatmap", "precision", "size", "spp", "max_depth", "camera", "threads"])]
    pub ray: Option<Ray>,
    /// Write the result as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Write an image that shows where hits and pixels differ
    #[arg(long, value_name = "FILE.png")]
    pub heatmap: Option<PathBuf>,
}

#[derive(Args)]
#[command(after_help = "\
Goals:
  G1  distances to spheres are correctly rounded
  G2  tangents of spheres are decided exactly
  G3  BVH traversal finds the same hits as brute force
  G4  closed meshes have no holes
  G5  thin triangles at grazing angles are hit at the right distance
  G6  no surface shadows itself
  G7  scale, threads and tiles do not change an image
  G8  surfaces a few ulp apart are hit in their order
  G9  a lamp on a surface lights what it sees
  G10 no light leaves a closed mesh
  G11 nothing passes through flat caps, or planes given by far points
  G12 hits do not change with the scale of the scene
  G13 millimetres are hit exactly at map coordinates

Examples:
  envers stress --quick
  envers stress --goal G1,G2 --json rows.json --plot error.svg
  envers stress --resume finished.jsonl

Exit status: 0 every test case passed, 1 one failed, 2 the command line or the input is invalid.")]
pub struct Stress {
    /// Test fewer rays: takes less than a minute on two cores
    #[arg(long)]
    pub quick: bool,
    /// Goals to test, such as G1,G2 [default: all]
    #[arg(long, value_name = "GOALS", value_delimiter = ',', value_parser = goal)]
    pub goal: Vec<Goal>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Write the results as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Write a plot of each sphere formula's error over distance
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Record finished test cases in this file, and skip those that it lists already
    #[arg(long, value_name = "FILE.jsonl")]
    pub resume: Option<PathBuf>,
    /// Do not print progress
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Args)]
#[command(after_help = "\
A mode is a backend, a precision, a build quality of Embree's BVH and a number of samples per pixel. \
Every mode is run several times, alternating with the others, and its image is compared with a \
reference that has certified hits and many samples. Writes bench.json, bench.csv, time-vs-error.svg \
and report.html, a page that contains all results, to DIR.

Examples:
  envers bench scene.toml --out out/bench
  envers bench scene.toml --out out/bench --spp 1,2,4,8,16,32 --reference-spp 256 --runs 15
  envers bench model.glb --out out/bench --quick")]
pub struct Bench {
    #[command(flatten)]
    pub input: InputArgs,
    /// Folder for the report; created if it does not exist
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Use fewer samples and runs, and an image of at most 320 pixels a side, where no other flag
    /// sets them
    #[arg(long)]
    pub quick: bool,
    /// Samples per pixel [default: 1,4,16; with --quick 1,4]
    #[arg(long, value_name = "N,…", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SPP)), allow_negative_numbers = true)]
    pub spp: Vec<u32>,
    /// Adaptive samples per pixel [default: 1..25,4..36, with --quick 1..9, as far as the reference
    /// has as many samples]
    #[arg(long, value_name = "MIN..MAX,…", value_delimiter = ',', value_parser = sample_range, allow_negative_numbers = true)]
    pub adaptive: Vec<SampleRange>,
    /// Samples per pixel of the reference [default: 64; with --quick 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SPP)), allow_negative_numbers = true)]
    pub reference_spp: Option<u32>,
    /// Number of runs of each mode [default: 5; with --quick 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), allow_negative_numbers = true)]
    pub runs: Option<u32>,
    /// Time limit for all runs of a mode together; a mode that is too slow gets fewer runs, or none
    #[arg(long, value_name = "SECONDS", value_parser = duration, default_value = "60", allow_negative_numbers = true)]
    pub budget: Duration,
    /// Ray tracing backend to measure [default: all that are on this machine]
    #[arg(long, value_name = "BACKEND", value_parser = backend())]
    pub backend: Option<Backend>,
}

#[derive(Args)]
pub struct Info {
    /// Scene file (.toml) or model (.gltf, .glb, .vrm, .obj)
    pub scene: PathBuf,
    #[command(flatten)]
    pub load: LoadArgs,
    /// Fail with exit status 2 if anything in the scene's files is dropped, unsupported or replaced
    /// by a placeholder
    #[arg(long)]
    pub strict: bool,
    /// Also list the work that rendering needs and skips, with the reasons (in JSON always)
    #[arg(short, long)]
    pub verbose: bool,
    /// Write the contents as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
}

#[derive(Args)]
#[command(after_help = "\
Prints the root-mean-square error (RMSE), the peak signal-to-noise ratio (PSNR), the largest \
difference, and FLIP (Andersson et al. 2020): the difference that a viewer perceives when flipping \
between the images, from 0 to 1, at 67 pixels per degree. For FLIP an EXR is shown as sRGB, clamped \
to [0, 1], and an image with alpha on black. Images of views other than beauty have no FLIP.

Alpha is compared like a colour; an image without it counts as opaque.")]
pub struct Diff {
    /// First image: .png, .jpg, .webp or .exr
    pub a: PathBuf,
    /// Second image, of the same size; an .exr can be compared with an .exr only
    pub b: PathBuf,
    /// Largest difference of two values that counts as equal, as a number or a fraction such as 1/255: the
    /// values of all formats but EXR are from 0 to 1, in steps of 1/255
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = tolerance, allow_negative_numbers = true)]
    pub tolerance: f32,
    /// Write the result as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Write an image of the differences, from black (equal) to white (the largest)
    #[arg(long, value_name = "FILE.png")]
    pub heatmap: Option<PathBuf>,
    /// Change a limit on what the images may use: bytes or pixels; can be given several times
    #[arg(long, value_name = "NAME=NUMBER")]
    pub limit: Vec<NamedLimit>,
}

#[derive(Args)]
#[command(after_help = "\
Examples:
  envers completions bash > ~/.local/share/bash-completion/completions/envers
  envers completions zsh > ~/.zfunc/_envers            (with `fpath+=~/.zfunc` before `compinit`)
  envers completions fish > ~/.config/fish/completions/envers.fish

`make install` installs those of bash, zsh and fish.")]
pub struct Completions {
    /// Shell to print the script for
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

#[derive(Args)]
pub struct Man {
    /// Folder for the pages, such as ~/.local/share/man/man1; created if it does not exist
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
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
