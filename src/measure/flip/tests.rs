//! Tests of properties that follow from the paper's construction, and of a few values.

use glam::Vec3;

use super::{Flip, PIXELS_PER_DEGREE, PerceivedImage};
use crate::measure::Picture;
use crate::scene::Transfer;

const SIZE: [u32; 2] = [40, 30];

/// Returns a picture with the colour of each column and row.
fn picture(color: impl Fn(u32, u32) -> Vec3) -> PerceivedImage {
    let [width, height] = SIZE;
    let pixels: Vec<Vec3> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| color(x, y))
        .collect();
    PerceivedImage::new(SIZE, &pixels, PIXELS_PER_DEGREE)
}

fn edge_at(column: u32) -> PerceivedImage {
    picture(move |x, _| if x < column { Vec3::ZERO } else { Vec3::ONE })
}

fn waves(phase: f32) -> PerceivedImage {
    let wave = move |x: u32, y: u32| (x as f32 * 0.7 + y as f32 * 0.3 + phase).sin() * 0.5 + 0.5;
    picture(move |x, y| Vec3::new(wave(x, y), wave(y, x), wave(x, x)))
}

fn largest(flip: &Flip) -> f32 {
    flip.map.iter().copied().fold(0.0, f32::max)
}

#[test]
fn equal_pictures_do_not_differ() {
    let flip = waves(0.0).flip(&waves(0.0));
    assert!(flip.mean == 0.0 && largest(&flip) == 0.0);
}

#[test]
fn either_picture_may_be_the_first() {
    let (a, b) = (waves(0.0), waves(1.0));
    assert_eq!(a.flip(&b), b.flip(&a));
}

#[test]
fn the_mean_is_that_of_the_map() {
    let flip = waves(0.0).flip(&waves(2.0));
    let mean = flip.map.iter().map(|x| f64::from(*x)).sum::<f64>() / flip.map.len() as f64;
    assert!(flip.mean == mean && mean > 0.1, "{mean}");
}

#[test]
fn no_difference_is_above_one() {
    let checks =
        |odd: u32| picture(move |x, y| if (x / 5 + y / 5) % 2 == odd { Vec3::Y } else { Vec3::Z });
    let flip = checks(0).flip(&checks(1));
    assert!(flip.map.iter().all(|x| (0.0..=1.0).contains(x)) && largest(&flip) > 0.9);
}

/// Worked out by hand: the lightness differs by 100, which is 100^0.7 = 25.12 of 41.28, beyond the
/// knee at 16.51, and so 0.95 + 0.05 · (25.12 − 16.51) / (41.28 − 16.51); there are no edges.
#[test]
fn black_against_white() {
    let flip = picture(|_, _| Vec3::ZERO).flip(&picture(|_, _| Vec3::ONE));
    assert!((flip.mean - 0.9674).abs() < 1e-4, "{}", flip.mean);
}

#[test]
fn green_against_blue_is_the_largest_difference() {
    let flip = picture(|_, _| Vec3::Y).flip(&picture(|_, _| Vec3::Z));
    assert!((flip.mean - 1.0).abs() < 1e-5, "{}", flip.mean);
}

#[test]
fn an_edge_that_moves_farther_differs_more() {
    let still = edge_at(20);
    let moved = [20, 21, 23, 27].map(|column| still.flip(&edge_at(column)).mean);
    assert!(moved[0] == 0.0 && moved.is_sorted_by(|a, b| a < b), "{moved:?}");
}

#[test]
fn an_edge_that_moves_differs_where_it_was_and_not_far_away() {
    let flip = edge_at(20).flip(&edge_at(21));
    let row = &flip.map[..SIZE[0] as usize];
    assert!(row[20] > 0.5 && row[0] < 1e-3 && row[39] < 1e-3, "{row:?}");
}

#[test]
fn detail_that_is_too_fine_to_see_differs_less_from_afar() {
    let stripes = |odd: u32, pixels_per_degree: f64| {
        let [width, height] = SIZE;
        let color = |i: u32| if i % width % 2 == odd { Vec3::ONE } else { Vec3::ZERO };
        let pixels: Vec<Vec3> = (0..width * height).map(color).collect();
        PerceivedImage::new(SIZE, &pixels, pixels_per_degree)
    };
    let [near, far] = [20.0, 150.0].map(|p| stripes(0, p).flip(&stripes(1, p)).mean);
    assert!(far < 0.5 * near, "{near} {far}");
}

#[test]
fn channels_are_found_by_name_and_values_clamped() {
    let of = |channels: [&str; 3], values: [f32; 3]| Picture {
        size: [1, 1],
        channels: channels.map(String::from).into(),
        values: values.into(),
    };
    let perceived = |p: &Picture| PerceivedImage::from_picture(p, Transfer::None).unwrap();
    let a = perceived(&of(["B", "G", "R"], [0.25, -3.0, 7.0]));
    let b = perceived(&of(["R", "G", "B"], [1.0, f32::NAN, 0.25]));
    assert_eq!(a.flip(&b).mean, 0.0);
    assert!(
        PerceivedImage::from_picture(&of(["N.X", "N.Y", "N.Z"], [0.0; 3]), Transfer::None)
            .is_none()
    );
}
