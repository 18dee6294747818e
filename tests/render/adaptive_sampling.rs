//! Adaptive samples: more where neighbouring ones disagree, wherever tiles and strips begin.

use envers::internals::{Counts, FeatureCounts, Tiling, sample_steps};
use envers::{AdaptiveSampling, Backend, Film, Precision, RenderOptions, Renderer, Scene};

/// The scene with a camera that sees one unit of length for each pixel, 0 in the middle.
fn scene(size: [u32; 2], objects: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let [width, height] = size;
    let text = format!(
        "[film]\nsize = [{width}, {height}]\n\
         [camera]\nposition = [0, 0, 99]\nlook_at = [0, 0, 0]\northo_height = {height}\n{objects}"
    );
    std::fs::write(&path, text).unwrap();
    envers::load(&path).unwrap().scene
}

fn with_samples(scene: &Scene, min: u32, max: u32, threshold: f32) -> Scene {
    let mut scene = scene.clone();
    scene.film.spp = min;
    scene.film.adaptive = Some(AdaptiveSampling { max, threshold });
    scene
}

fn regular(scene: &Scene, spp: u32) -> Scene {
    let mut scene = scene.clone();
    (scene.film.spp, scene.film.adaptive) = (spp, None);
    scene
}

/// The picture, and what was counted, but for work that is counted by the batch.
fn made(scene: &Scene, options: &RenderOptions) -> (Film, Counts) {
    let options = RenderOptions { precision: Precision::Certified, ..options.clone() };
    let rendering = Renderer::new(scene).options(options.clone()).render().unwrap();
    let counts = Counts { work: FeatureCounts::default(), ..rendering.statistics.counts };
    (rendering.film, counts)
}

fn film(scene: &Scene) -> Film {
    made(scene, &RenderOptions::default()).0
}

fn counts(scene: &Scene) -> Counts {
    made(scene, &RenderOptions::default()).1
}

/// Spheres before a lit wall, with shadows, a highlight and a mirror: edges of every kind.
fn varied() -> Scene {
    let mut objects = "
        [[material]]\nname = \"wall\"\ndiffuse = 0.6\n
        [[material]]\nname = \"ball\"\ndiffuse = [0.7, 0.3, 0.2]\nspecular = 0.5\n
        [[material]]\nname = \"mirror\"\nreflect = 0.8\n
        [[plane]]\npoint = [0, 0, -9]\nnormal = [0.1, 0, 1]\nmaterial = \"wall\"\n
        [[light]]\nkind = \"point\"\nposition = [60, 90, 80]\n"
        .to_owned();
    for i in 0..12 {
        let (x, y) = (f64::from(i) * 11.3 - 62.0, f64::from(i * 37 % 50) - 25.0);
        let (radius, material) =
            (f64::from(i % 4) * 2.1 + 0.7, if i % 5 == 0 { "mirror" } else { "ball" });
        objects += &format!(
            "[[sphere]]\ncenter = [{x}, {y}, 0]\nradius = {radius}\nmaterial = \"{material}\"\n"
        );
    }
    scene([150, 70], &objects)
}

/// A wall of squares that are two colours in turn, each as wide as a strip is high.
fn squares() -> Scene {
    let wall = "[[plane]]\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n\
                checker = { colors = [0.2, 0.7], size = 16 }\n\
                [[light]]\nkind = \"ambient\"\n";
    scene([192, 64], wall)
}

#[test]
fn the_picture_is_the_same_on_any_number_of_threads() {
    let scene = with_samples(&varied(), 1, 25, 0.1);
    let one = made(&scene, &RenderOptions { threads: 1, ..RenderOptions::default() });
    assert!(one.1.refined[1] > 0);
    for threads in [2, 5] {
        assert!(
            made(&scene, &RenderOptions { threads, ..RenderOptions::default() }) == one,
            "{threads}"
        );
    }
}

#[test]
fn the_picture_is_the_same_however_it_is_cut_up() {
    for (min, max) in [(1, 25), (4, 20)] {
        let scene = with_samples(&varied(), min, max, 0.1);
        let whole = made(&scene, &RenderOptions::default());
        for (rows, columns, block) in [(1, 1, 1), (5, 7, 3), (3, 1 << 20, 2), (1 << 20, 9, 16)] {
            let tiling = Tiling { rows, columns, block };
            let cut = made(&scene, &RenderOptions { tiling, ..RenderOptions::default() });
            assert!(cut == whole, "{tiling:?}");
        }
    }
}

#[test]
fn the_picture_is_the_same_on_either_backend() {
    let scene = with_samples(&varied(), 1, 25, 0.1);
    let rust =
        made(&scene, &RenderOptions { backend: Some(Backend::Rust), ..RenderOptions::default() });
    assert!(rust == made(&scene, &RenderOptions::default()));
}

/// All edges of the squares lie between pixels, those of strips and tiles among them: a pixel is
/// refined if one beside it is in another square, and none goes on after that.
#[test]
fn edges_along_the_borders_of_tiles_are_refined_on_both_sides() {
    let scene = with_samples(&squares(), 1, 25, 0.1);
    let [width, height] = scene.film.size.map(|side| side as i32);
    let square = |x: i32, y: i32| (x / 16 + y / 16) % 2;
    let is_at_an_edge = |x: i32, y: i32| {
        let beside = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy]));
        let mut there = beside.filter(|[x, y]| (0..width).contains(x) && (0..height).contains(y));
        there.any(|[a, b]| square(a, b) != square(x, y))
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let expected = pixels.filter(|&[x, y]| is_at_an_edge(x, y)).count() as u64;
    assert_eq!(counts(&scene).refined[..2], [expected, 0]);
}

#[test]
fn a_flat_picture_takes_the_least_samples() {
    let wall = "[[plane]]\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n[[light]]\nkind = \"ambient\"\n";
    let wall = scene([50, 40], wall);
    for (min, max) in [(1, 25), (4, 36), (3, 17)] {
        let counts = counts(&with_samples(&wall, min, max, AdaptiveSampling::THRESHOLD));
        assert_eq!(counts.rays.primary, u64::from(min) * 50 * 40);
        assert!(counts.refined.iter().all(|&pixels| pixels == 0));
    }
}

#[test]
fn threshold_0_gives_every_pixel_the_most_samples() {
    let scene = varied();
    let [width, height] = scene.film.size.map(u64::from);
    for (min, max) in [(1, 9), (1, 16), (3, 17), (4, 36)] {
        let taken = counts(&with_samples(&scene, min, max, 0.0)).rays.primary;
        assert_eq!(taken, u64::from(max) * width * height);
    }
}

#[test]
fn with_the_most_samples_everywhere_it_is_the_regular_picture_to_the_bit() {
    let scene = varied();
    for (min, max) in [(1, 9), (1, 25), (1, 81), (4, 36), (9, 81), (25, 225), (7, 7), (81, 81)] {
        let adaptive = film(&with_samples(&scene, min, max, 0.0));
        assert!(adaptive == film(&regular(&scene, max)), "{min}..{max}");
    }
}

/// Dots much thinner than the distance of samples, at and beside where the first samples lie.
#[test]
fn no_thin_thing_is_lost_that_the_least_samples_find() {
    let mut objects = "[[material]]\nname = \"dot\"\nemission = 1\n".to_owned();
    for i in 0..90 {
        let (x, y) = (i % 15, i / 15);
        let shift = [0.0, 0.25, 0.3][x % 3];
        let at = |k: usize, half: f64| k as f64 * 3.0 + 1.5 + shift - half;
        let [x, y] = [at(x, 24.0), at(y, 12.0)];
        objects +=
            &format!("[[sphere]]\ncenter = [{x}, {y}, 0]\nradius = 0.03\nmaterial = \"dot\"\n");
    }
    let scene = scene([48, 24], &objects);
    for (min, max) in [(1, 9), (1, 16), (1, 100), (4, 36), (4, 64), (4, 5)] {
        let least = film(&regular(&scene, min));
        let found = film(&with_samples(&scene, min, max, 0.1));
        let dots = least.pixels.iter().zip(&found.pixels).filter(|(least, _)| least[0] > 0.0);
        assert!(dots.clone().count() >= 30, "{min}..{max}");
        assert!(dots.clone().all(|(_, found)| found[0] > 0.0), "{min}..{max}");
    }
}

/// 1, 9 and 81 samples are regular squares, and steps of this series.
#[test]
fn as_many_pixels_as_stop_at_a_regular_step_are_those_of_that_regular_picture() {
    let scene = with_samples(&varied(), 1, 81, 0.1);
    assert_eq!(sample_steps(&scene.film), [1, 5, 9, 45, 81]);
    let all = film(&scene);
    let [one, nine, most] = [1, 9, 81].map(|spp| film(&regular(&scene, spp)));
    let pixels = all.pixels.iter().enumerate();
    let same = |i: usize, film: &Film| film.pixels[i] == all.pixels[i];
    let with_five_or_more = counts(&scene).refined[0] as usize;
    let (ones, mosts) = (
        pixels.clone().filter(|(i, _)| same(*i, &one)).count(),
        pixels.clone().filter(|(i, _)| same(*i, &most) || same(*i, &nine)).count(),
    );
    assert!(ones >= all.pixels.len() - with_five_or_more);
    assert!(mosts >= counts(&scene).refined[3] as usize && mosts > 0);
}

#[test]
fn it_is_nearer_to_many_samples_than_as_many_regular_ones_are() {
    let scene = varied();
    let many = film(&regular(&scene, 225));
    let error = |scene: &Scene| {
        let film = film(scene);
        let pairs = film.pixels.as_flattened().iter().zip(many.pixels.as_flattened());
        pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
    };
    let adaptive = with_samples(&scene, 1, 25, AdaptiveSampling::THRESHOLD);
    let taken = counts(&adaptive).rays.primary;
    let pixels = scene.film.size.into_iter().map(u64::from).product::<u64>();
    assert!(taken < 9 * pixels, "{} per pixel", taken / pixels);
    assert!(error(&adaptive) < error(&regular(&scene, 9)));
}
