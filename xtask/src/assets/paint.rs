//! Pictures for textures, painted point by point.

use glam::{DVec2, DVec3};
use image::ImageEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};

/// A PNG file of `width` × `height` pixels; `color` gives the colour in \[0, 1\], as the file
/// stores it, at (u, v) in the unit square, v running down. Each pixel is the mean of 16 points.
fn png(width: u32, height: u32, color: impl Fn(DVec2) -> DVec3) -> Vec<u8> {
    let mut bytes = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let sum: DVec3 = (0..16)
                .map(|i| {
                    let within = DVec2::new(f64::from(i % 4), f64::from(i / 4)) / 4.0 + 0.125;
                    let pixel = DVec2::new(f64::from(x), f64::from(y)) + within;
                    color(pixel / DVec2::new(f64::from(width), f64::from(height)))
                })
                .sum();
            bytes
                .extend((sum / 16.0).to_array().map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8));
        }
    }
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Best, FilterType::Adaptive)
        .write_image(&bytes, width, height, image::ExtendedColorType::Rgb8)
        .expect("ok: a Vec takes all that is written");
    file
}

/// A colour from its bytes.
fn hex(rgb: u32) -> DVec3 {
    DVec3::new(f64::from(rgb >> 16), f64::from(rgb >> 8 & 255), f64::from(rgb & 255)) / 255.0
}

/// 0 below `a`, 1 above `b`, smooth between.
fn step(a: f64, b: f64, x: f64) -> f64 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A number in \[0, 1) for each cell, the same every time.
fn random(x: i64, y: i64) -> f64 {
    let mut h = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as u64).wrapping_add(0x51ed);
    h = (h ^ h >> 31).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ h >> 29).wrapping_mul(0x94d0_49bb_1331_11eb);
    (h >> 40) as f64 / (1 << 24) as f64
}

/// Smooth noise in \[0, 1\] over cells of side 1, which repeats after `period` cells.
fn noise(p: DVec2, period: [i64; 2]) -> f64 {
    let cell = p.floor();
    let at = |dx: i64, dy: i64| {
        let wrapped = [cell.x as i64 + dx, cell.y as i64 + dy];
        random(wrapped[0].rem_euclid(period[0]), wrapped[1].rem_euclid(period[1]))
    };
    let (fx, fy) = (step(0.0, 1.0, p.x - cell.x), step(0.0, 1.0, p.y - cell.y));
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    mix(mix(at(0, 0), at(1, 0), fx), mix(at(0, 1), at(1, 1), fx), fy)
}

/// Wood whose grain runs along u: two boards.
pub fn wood() -> Vec<u8> {
    png(128, 64, |p| {
        let board = (p.y * 2.0).floor();
        // Whole waves only, so that the picture repeats.
        let warp = noise(p * DVec2::new(4.0, 6.0), [4, 6]);
        let rings = noise(DVec2::new(p.x * 3.0, p.y * 24.0 + 3.0 * warp), [3, 24]);
        let fibre = noise(p * DVec2::new(12.0, 64.0), [12, 64]);
        let tone = 0.55 * rings + 0.25 * fibre + 0.2 * board;
        let color = hex(0x6b3f22).lerp(hex(0xb98352), tone);
        let within = (p.y * 2.0).fract();
        let joint = step(0.0, 0.03, within.min(1.0 - within));
        color * (0.35 + 0.65 * joint)
    })
}

/// A glazed tile, white and blue, as on walls in Portugal.
pub fn tile() -> Vec<u8> {
    png(96, 96, |p| {
        let (white, blue, pale) = (hex(0xf2eee2), hex(0x2a4fa8), hex(0x8fb0dc));
        // The pattern is the same in all eight parts of the tile.
        let q = (p - 0.5).abs();
        let (x, y) = (q.max_element(), q.min_element());
        let corner = DVec2::new(0.5 - x, 0.5 - y).length();
        let ring = |d: f64, r: f64, w: f64| step(w + 0.01, w, (d - r).abs());
        let mut color = white;
        color = color.lerp(pale, step(0.31, 0.30, corner));
        color = color.lerp(blue, ring(corner, 0.3, 0.022).max(ring(corner, 0.37, 0.008)));
        // A star in the middle, a flower in each corner.
        color = color.lerp(blue, step(0.225, 0.215, x + 0.6 * y));
        color = color.lerp(white, step(0.145, 0.135, x + 0.6 * y));
        color = color.lerp(blue, step(0.06, 0.05, q.length()));
        color = color.lerp(blue, step(0.135, 0.125, corner));
        color = color.lerp(white, step(0.05, 0.04, corner));
        let grout = step(0.488, 0.492, x);
        color.lerp(hex(0xb9b2a4), grout)
    })
}

/// A landscape at dusk, to hang on a wall.
pub fn landscape() -> Vec<u8> {
    png(192, 128, |p| {
        let (x, y) = (p.x, p.y);
        let sky = hex(0x3b5b94).lerp(hex(0xf3c98b), step(-0.1, 0.62, y));
        let sun = DVec2::new((x - 0.68) * 1.5, y - 0.47).length();
        let mut color = sky.lerp(hex(0xffefc4), 0.6 * step(0.3, 0.05, sun));
        color = color.lerp(hex(0xfff6dc), step(0.068, 0.062, sun));
        let bump = |at: f64, wide: f64| 1.0 / (1.0 + ((x - at) / wide) * ((x - at) / wide));
        let hill = |color: DVec3, top: f64, rgb: u32| {
            color.lerp(hex(rgb), step(top - 0.004, top + 0.004, y))
        };
        color = hill(color, 0.62 - 0.22 * bump(0.2, 0.16) - 0.12 * bump(0.95, 0.2), 0x8d86a6);
        color = hill(color, 0.68 - 0.13 * bump(0.5, 0.22) - 0.04 * bump(0.0, 0.2), 0x59648a);
        if y > 0.7 {
            // The lake shows the sky, and the sun as a broken stripe.
            let depth = y - 0.7;
            let ripple = noise(DVec2::new(x * 10.0, y * 70.0), [10, 70]);
            let water = hex(0xd9a982).lerp(hex(0x2e4b7c), step(0.0, 0.3, depth + 0.08 * ripple));
            let stripe = step(0.05 + depth * 0.2, 0.0, (x - 0.68).abs()) * step(0.35, 0.6, ripple);
            color = water.lerp(hex(0xfff0cc), 0.8 * stripe);
        }
        hill(color, 1.02 - 0.3 * bump(0.08, 0.13) - 0.1 * bump(0.9, 0.3), 0x2b3a3a)
    })
}

/// The painting on the vase, a PNG: u runs around it once, v from the rim down to the foot.
pub fn vase() -> Vec<u8> {
    const KEY: [&[u8; 6]; 5] = [b"#####.", b"#...#.", b"#.###.", b"#.....", b"######"];
    png(512, 256, |p| {
        let (clay, dark) = (hex(0xc8703a), hex(0x1d1a1f));
        let band = |a: f64, b: f64| p.y >= a && p.y < b;
        let key = |a: f64, b: f64, around: f64| {
            let row = ((p.y - a) / (b - a) * 5.0) as usize;
            let column = (p.x * around * 6.0).rem_euclid(6.0) as usize;
            KEY[row.min(4)][column] == b'#'
        };
        let is_dark = if band(0.0, 0.07) || band(0.24, 0.255) || band(0.335, 0.35) {
            true
        } else if band(0.1, 0.2) {
            // Tongues on the neck.
            let t = (p.x * 24.0).fract() - 0.5;
            t.abs() < 0.36
                && (p.y < 0.16 || DVec2::new(t / 0.36, (p.y - 0.16) / 0.035).length() < 1.0)
        } else if band(0.265, 0.325) {
            key(0.265, 0.325, 20.0)
        } else if band(0.35, 0.40) {
            // Dots.
            let t = DVec2::new(((p.x * 48.0).fract() - 0.5) * 0.04, p.y - 0.375);
            t.length() < 0.013
        } else if band(0.40, 0.58) {
            // A running wave between two lines.
            let t = (p.x * 10.0).fract();
            let eye = DVec2::new((t - 0.42) * 0.17, p.y - 0.485);
            let crest = 0.555 - 0.13 * step(0.0, 0.42, t) * step(1.0, 0.42, t);
            let line = band(0.40, 0.408) || band(0.565, 0.58);
            line || (p.y > crest) != (eye.length() < 0.024)
        } else if band(0.58, 0.74) {
            band(0.60, 0.66) && key(0.60, 0.66, 16.0) || p.y > 0.68
        } else if band(0.74, 0.92) {
            // Rays that rise from the foot.
            let t = ((p.x * 20.0).fract() - 0.5).abs();
            t < 0.45 * (p.y - 0.75) / 0.17 || p.y < 0.75
        } else {
            true
        };
        if is_dark { dark } else { clay }
    })
}

/// The colour at `x` between stops, each a place and a colour.
fn gradient(x: f64, stops: &[(f64, u32)]) -> DVec3 {
    let mut color = hex(stops[0].1);
    for pair in stops.windows(2) {
        let [(a, _), (b, to)] = [pair[0], pair[1]];
        color = color.lerp(hex(to), ((x - a) / (b - a)).clamp(0.0, 1.0));
    }
    color
}

/// A clear sky for a sphere around everything: v runs from the zenith to the nadir.
pub fn sky() -> Vec<u8> {
    png(4, 256, |p| {
        gradient(
            p.y,
            &[
                (0.0, 0x2f6cb5),
                (0.25, 0x5b96d3),
                (0.42, 0x9cc6ea),
                (0.49, 0xe2eff5),
                (0.52, 0xb9b6ad),
            ],
        )
    })
}

/// The sky after sunset, brightest at the horizon.
pub fn dusk() -> Vec<u8> {
    png(4, 512, |p| {
        gradient(
            p.y,
            &[
                (0.0, 0x0b1030),
                (0.25, 0x1d2552),
                (0.38, 0x51407a),
                (0.44, 0xa8557a),
                (0.47, 0xe8785a),
                (0.492, 0xfbb04f),
                (0.5, 0xffe08a),
                (0.51, 0x3a2b3f),
            ],
        )
    })
}

/// The clouds of a giant planet, in bands that the wind frays: u runs around it.
pub fn planet() -> Vec<u8> {
    png(256, 128, |p| {
        let fray = noise(p * DVec2::new(16.0, 24.0), [16, 24]) - 0.5;
        let swirl = noise(p * DVec2::new(40.0, 80.0), [40, 80]) - 0.5;
        let y = p.y + 0.022 * fray + 0.008 * swirl;
        gradient(
            y,
            &[
                (0.0, 0x8d7d74),
                (0.14, 0xa08a78),
                (0.2, 0xd9c4a5),
                (0.26, 0xc79b72),
                (0.31, 0xe9dcc3),
                (0.37, 0xb06f4a),
                (0.43, 0xc98f63),
                (0.46, 0xf0e6d2),
                (0.55, 0xefe0c4),
                (0.58, 0xa8633f),
                (0.65, 0xc58a60),
                (0.68, 0xe6d3b3),
                (0.75, 0xb98d6a),
                (0.82, 0xd3bd9f),
                (0.9, 0x9a8677),
                (1.0, 0x80736d),
            ],
        )
    })
}
