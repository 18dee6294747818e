//! Where in a pixel its samples lie.

use crate::scene::FilmSettings;

/// Where the samples of a pixel lie, as offsets from its upper left corner.
pub fn sample_positions(film: &FilmSettings) -> Vec<[f64; 2]> {
    let offset = film.sample_position.offset();
    sample_offsets(film.spp).map(|[x, y]| [x + offset, y + offset]).collect()
}

/// Where the samples of a pixel lie, relative to its sample position; their mean is 0 and they
/// stay within the pixel's square.
///
/// A square number of samples forms a regular grid; any other a lattice of points, evenly spaced
/// along x and by the golden ratio along y.
fn sample_offsets(spp: u32) -> impl Iterator<Item = [f64; 2]> {
    let n = f64::from(spp);
    let side = spp.isqrt();
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let lattice = move |i: u32| (f64::from(i) * golden).fract();
    // The lattice's y are not symmetric; their mean is taken out, and the rest drawn together so
    // that no sample leaves the square.
    let mean = (0..spp).map(lattice).sum::<f64>() / n;
    let reach = (0..spp).map(|i| (lattice(i) - mean).abs()).fold(0.5, f64::max);
    (0..spp).map(move |i| {
        if side * side == spp {
            let place = |k: u32| (f64::from(k) + 0.5) / f64::from(side) - 0.5;
            [place(i % side), place(i / side)]
        } else {
            [(f64::from(i) + 0.5) / n - 0.5, (lattice(i) - mean) * (0.5 / reach)]
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_lies_at_the_sample_position() {
        assert_eq!(sample_offsets(1).collect::<Vec<_>>(), [[0.0, 0.0]]);
    }

    #[test]
    fn four_samples_form_a_grid() {
        let expected = [[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]];
        assert_eq!(sample_offsets(4).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn samples_never_shift_the_picture_nor_leave_the_pixel() {
        for spp in 1..100 {
            let mut mean = [0.0; 2];
            for s in sample_offsets(spp) {
                assert!(s.iter().all(|x| x.abs() <= 0.5), "{spp}: {s:?}");
                mean = [mean[0] + s[0], mean[1] + s[1]];
            }
            assert!(mean.iter().all(|m| m.abs() < 1e-12), "{spp}: {mean:?}");
        }
    }
}
