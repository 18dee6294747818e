//! The bytes of a film, as pictures of 8 bits per channel have them.

use rayon::prelude::*;

use crate::film::{Film, View};
use crate::write::Settings;

/// The bytes of a pixel: red, green and blue, and alpha if the film has any.
pub fn bytes_per_pixel(film: &Film) -> usize {
    if film.alpha.is_some() { 4 } else { 3 }
}

/// Encodes a film as bytes: red, green, blue of each pixel, and alpha if the film has any, row by row.
/// Beside alpha stand the bytes of the colour that is covered (straight or unassociated alpha): its
/// radiance over its alpha. A pixel whose alpha rounds to 0 is all 0.
///
/// Beauty: [`Settings::bytes`]. Normal: each component from \[−1, 1\] to \[0, 255\]. Depth: white at
/// the nearest hit to a dark grey at the farthest. Id: a colour for each object, hashed from its id.
/// Views other than beauty are black where nothing is hit.
pub fn encode(film: &Film, settings: &Settings) -> Vec<u8> {
    let byte = |x: f32| (x * 255.0).round() as u8;
    // The range of the depths, which is mapped to greys.
    let depths = || film.pixels.iter().map(|p| p[0]).filter(|z| z.is_finite());
    let (near, far) = match film.view {
        View::Depth => depths().fold((f32::MAX, 0.0f32), |(a, b), z| (a.min(z), b.max(z))),
        _ => (0.0, 1.0),
    };
    // The colour of a pixel, by the view.
    let has_table = film.view == View::Beauty && settings.tone.is_per_channel();
    let table = has_table.then(|| ByteTable::new(settings));
    let color = |pixel: &[f32; 3]| match film.view {
        View::Beauty => match &table {
            Some(table) => pixel.map(|x| table.byte(x)),
            None => settings.bytes(*pixel),
        },
        View::Normal if *pixel == [0.0; 3] => [0; 3],
        View::Normal => pixel.map(|x| byte((x * 0.5 + 0.5).clamp(0.0, 1.0))),
        View::Depth if !pixel[0].is_finite() => [0; 3],
        View::Depth => [byte(1.0 - 0.85 * (pixel[0] - near) / (far - near).max(1e-30)); 3],
        View::Id if pixel[0] == 0.0 => [0; 3],
        View::Id => id_color(pixel.map(|x| x as u32)),
    };
    // All pixels, on all threads.
    let mut bytes = vec![0; film.pixels.len() * bytes_per_pixel(film)];
    let Some(alpha) = &film.alpha else {
        let (triples, _) = bytes.as_chunks_mut::<3>();
        triples.par_iter_mut().zip(&film.pixels).with_min_len(GRAIN).for_each(|(to, pixel)| {
            *to = color(pixel);
        });
        return bytes;
    };
    let (quadruples, _) = bytes.as_chunks_mut::<4>();
    let pixels = film.pixels.par_iter().zip(alpha);
    quadruples.par_iter_mut().zip(pixels).with_min_len(GRAIN).for_each(|(to, (pixel, &alpha))| {
        let coverage = byte(alpha.clamp(0.0, 1.0));
        if coverage > 0 {
            let [r, g, b] = color(&pixel.map(|x| x / alpha));
            *to = [r, g, b, coverage];
        }
    });
    bytes
}

/// The grain size of the parallel loop: the least number of pixels for one thread.
const GRAIN: usize = 1 << 14;

/// A lookup table for [`Settings::bytes`], where the tone curve is one of single channels.
struct ByteTable {
    /// The thresholds between bytes; see [`byte_thresholds`].
    thresholds: [f32; 256],
    /// The bytes of the least radiances with the same first 16 bits, by these bits.
    by_high_bits: Vec<u8>,
}

impl ByteTable {
    /// Builds the table.
    fn new(settings: &Settings) -> Self {
        let thresholds = byte_thresholds(settings);
        let infinity = f32::INFINITY.to_bits() >> 16;
        let by_high_bits =
            (0..=infinity).map(|bits| search_byte(&thresholds, f32::from_bits(bits << 16)));
        Self { by_high_bits: by_high_bits.collect(), thresholds }
    }

    /// The byte for the radiance of one channel.
    #[inline(always)]
    fn byte(&self, radiance: f32) -> u8 {
        // Negative numbers and NaN give the byte of 0.
        let radiance = if radiance > 0.0 { radiance } else { 0.0 };
        let mut byte = self.by_high_bits[(radiance.to_bits() >> 16) as usize];
        while self.thresholds[usize::from(byte)] <= radiance {
            byte += 1;
        }
        byte
    }
}

/// The least radiances for which the byte of [`Settings::bytes`], which never decreases, exceeds 0, 1, …, 255; NaN
/// where it never does. Looking a byte up is several times faster than computing it.
fn byte_thresholds(settings: &Settings) -> [f32; 256] {
    std::array::from_fn(|byte| {
        // Positive floats are in the order of their bits.
        let (mut below, mut from) = (0, f32::INFINITY.to_bits());
        while from - below > 1 {
            let middle = below + (from - below) / 2;
            let [found, ..] = settings.bytes([f32::from_bits(middle); 3]);
            let exceeds = usize::from(found) > byte;
            *(if exceeds { &mut from } else { &mut below }) = middle;
        }
        let least = f32::from_bits(from);
        if least.is_finite() { least } else { f32::NAN }
    })
}

/// The number of thresholds up to `radiance`, by binary search. The index is a byte, and so never out
/// of bounds.
#[inline(always)]
fn search_byte(thresholds: &[f32; 256], radiance: f32) -> u8 {
    let mut byte = 0u8;
    for half in [128, 64, 32, 16, 8, 4, 2, 1] {
        let next = byte + (half - 1);
        byte += if thresholds[usize::from(next)] <= radiance { half } else { 0 };
    }
    byte
}

/// The colour of an id, by a multiplicative hash, and bright enough to see. All triangles of an
/// instance have the same colour.
fn id_color([geometry, primitive, instance]: [u32; 3]) -> [u8; 3] {
    let key = if geometry < 3 { primitive } else { instance };
    let hash = (geometry.wrapping_mul(0x85eb_ca6b) ^ key.wrapping_add(1))
        .wrapping_mul(0x9e37_79b1)
        .rotate_left(15)
        .wrapping_mul(0xc2b2_ae35);
    [hash, hash >> 8, hash >> 16].map(|h| 64 + (h & 0xff) as u8 / 4 * 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Tone, Transfer};

    fn bytes(pixel: [f32; 3], view: View, settings: &Settings) -> Vec<u8> {
        encode(&Film { size: [1, 1], view, pixels: vec![pixel], alpha: None }, settings)
    }

    #[test]
    fn without_transfer_a_byte_is_255_times_the_value_rounded() {
        let settings = Settings { transfer: Transfer::None, ..Settings::default() };
        let pixel = [58.0 / 255.0, 84.4 / 255.0, 215.6 / 255.0];
        assert_eq!(bytes(pixel, View::Beauty, &settings), [58, 84, 216]);
    }

    #[test]
    fn exposure_is_a_factor_of_two_to_its_power() {
        let settings = Settings { transfer: Transfer::None, exposure: -1.0, ..Settings::default() };
        assert_eq!(bytes([1.0, 2.0, 4.0], View::Beauty, &settings), [128, 255, 255]);
    }

    #[test]
    fn every_radiance_gives_the_byte_of_the_formula() {
        for tone in [Tone::None, Tone::Reinhard, Tone::Aces] {
            for (transfer, exposure) in
                [(Transfer::Srgb, 0.0), (Transfer::None, 1.5), (Transfer::Srgb, -140.0)]
            {
                let settings = Settings { exposure, tone, transfer, ..Settings::default() };
                let mut values: Vec<f32> = byte_thresholds(&settings)
                    .iter()
                    .flat_map(|x| [x.next_down(), *x, x.next_up()])
                    .collect();
                values.extend((0..0x7f80).map(|bits| f32::from_bits(bits << 16)));
                values.extend([-1.0, -0.0, f32::NAN, f32::MAX]);
                let pixels: Vec<_> = values.iter().map(|&x| [x; 3]).collect();
                let film = Film {
                    size: [values.len() as u32, 1],
                    view: View::Beauty,
                    pixels,
                    alpha: None,
                };
                let expected: Vec<u8> =
                    values.iter().flat_map(|&x| settings.bytes([x; 3])).collect();
                assert!(encode(&film, &settings) == expected, "{settings:?}");
            }
        }
    }

    #[test]
    fn alpha_is_straight_beside_the_colour_that_is_covered() {
        let settings = Settings { transfer: Transfer::None, ..Settings::default() };
        let pixels = vec![[0.25, 0.125, 0.0], [0.5; 3], [1.0; 3], [0.5; 3]];
        let alpha = Some(vec![0.25, 1.0, 0.001, 0.0]);
        let film = Film { size: [4, 1], view: View::Beauty, pixels, alpha };
        let expected =
            [[255, 128, 0, 64], [128, 128, 128, 255], [0; 4], [0; 4]].as_flattened().to_vec();
        assert_eq!(encode(&film, &settings), expected);
    }

    #[test]
    fn normals_map_to_the_cube_of_colours() {
        let settings = Settings::default();
        assert_eq!(bytes([0.0, 1.0, 0.0], View::Normal, &settings), [128, 255, 128]);
    }

    #[test]
    fn nearest_depth_is_white_and_nothing_is_black() {
        let pixels = vec![[2.0; 3], [5.0; 3], [f32::INFINITY; 3]];
        let film = Film { size: [3, 1], view: View::Depth, pixels, alpha: None };
        assert_eq!(encode(&film, &Settings::default()), [255, 255, 255, 38, 38, 38, 0, 0, 0]);
    }

    #[test]
    fn different_objects_have_different_colours() {
        let colors: std::collections::HashSet<_> =
            (0..100).flat_map(|i| [id_color([1, i, 0]), id_color([3, 7, i])]).collect();
        assert!(colors.len() > 195, "{}", colors.len());
    }
}
