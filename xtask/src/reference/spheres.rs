//! S: the tutorial's sphere and 500 others at random, the same ones on every platform.

use std::fmt::Write;

use glam::DVec3;

/// The number of spheres about the tutorial's own.
pub const COUNT: usize = 500;

/// The colours that the spheres are given, linear; the first is the tutorial's blue.
pub const COLORS: [[f64; 3]; 6] = [
    [52.0 / 255.0, 84.0 / 255.0, 216.0 / 255.0],
    [0.85, 0.25, 0.2],
    [0.9, 0.65, 0.15],
    [0.3, 0.7, 0.35],
    [0.6, 0.35, 0.75],
    [0.85, 0.85, 0.8],
];

/// A sphere, in the tutorial's space: x to the right, y down, z into the picture.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// The centre.
    pub center: DVec3,
    /// The radius.
    pub radius: f64,
    /// The index of its colour in [`COLORS`].
    pub color: usize,
}

/// SplitMix64: Steele, Lea, Flood, *Fast Splittable Pseudorandom Number Generators*, OOPSLA 2014.
pub struct SplitMix(pub u64);

impl SplitMix {
    /// The next of all numbers.
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from `low` to below `high`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// The tutorial's sphere, and `count` others: x within 8, y within 4, z from 6 to 30, radii from
/// 0.1 to 0.6 times `scale`. Some lie in the ground, or in each other.
pub fn balls(count: usize, scale: f64) -> Vec<Ball> {
    let mut random = SplitMix(501);
    let mut balls = vec![Ball { center: DVec3::new(0.0, 0.0, 10.0), radius: 1.0, color: 0 }];
    balls.extend((0..count).map(|_| {
        let (x, y) = (random.within(-8.0, 8.0), random.within(-4.0, 4.0));
        let z = random.within(6.0, 30.0);
        let radius = scale * random.within(0.1, 0.6);
        let color = random.next() as usize % COLORS.len();
        Ball { center: DVec3::new(x, y, z), radius, color }
    }));
    balls
}

/// The scene file.
pub fn toml() -> String {
    let mut toml = String::from(HEAD);
    let mut line = |text: std::fmt::Arguments<'_>| {
        writeln!(toml, "{text}").expect("ok: a String takes all that is written");
    };
    for (i, [r, g, b]) in COLORS.iter().enumerate() {
        line(format_args!("\n[[material]]\nname = \"{i}\"\ndiffuse = [{r}, {g}, {b}]"));
        line(format_args!("specular = 1\nshininess = 50"));
    }
    for Ball { center, radius, color } in balls(COUNT, 1.0) {
        let DVec3 { x, y, z } = center;
        line(format_args!("\n[[sphere]]\ncenter = [{x}, {y}, {z}]"));
        line(format_args!("radius = {radius}\nmaterial = \"{color}\""));
    }
    toml
}

const HEAD: &str = r##"# S: the tutorial's sphere among 500 others. Made by xtask make-reference.
[film]
size = [1000, 500]
transfer = "none"            # a PNG byte is 255 times the value, as in the tutorial
background = "#323232"

[camera]
position = [0, 0, 0]
look_at = [0, 0, 1]
up = [0, -1, 0]              # the tutorial's y points down
fov_x = 90

[[plane]]
point = [0, 1, 0]
normal = [0, -1, 0]
material = "ground"

[[light]]
kind = "point"
position = [-20, -25, -15]

[[material]]
name = "ground"
diffuse = 0.5
"##;
