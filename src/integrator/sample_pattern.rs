//! The sample pattern: the positions of a pixel's samples, in the order in which they are taken.

use crate::scene::FilmSettings;

/// The most steps of a pattern: a side of 256 samples has five odd factors, two steps each.
pub(super) const MAX_STEPS: usize = 12;

/// Returns the positions of a pixel's samples, as offsets from its upper left corner; of an adaptive
/// picture those that every pixel has.
///
/// A square number of samples forms a regular grid; any other a lattice of points, evenly spaced
/// along x and by the golden ratio along y.
#[cfg(all(feature = "measure", any(feature = "embree", test)))]
pub fn sample_positions(film: &FilmSettings) -> Vec<[f64; 2]> {
    from_corner(film, regular(film.spp).offsets)
}

/// Returns the numbers of samples that a pixel can have, ascending: the first is that of every pixel;
/// at each of the others it is decided which pixels need more.
pub fn sample_steps(film: &FilmSettings) -> Vec<usize> {
    let SamplePattern { mut steps, first, .. } = SamplePattern::new(film);
    steps.split_off(first)
}

/// Converts offsets from the sample position of a film into offsets from the pixel's corner.
fn from_corner(film: &FilmSettings, mut offsets: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let corner = film.sample_position.offset();
    offsets.iter_mut().flatten().for_each(|x| *x += corner);
    offsets
}

/// The samples of a pixel in the order in which they are taken.
pub(super) struct SamplePattern {
    /// The offsets of the samples from the pixel's corner; while the pattern is built, from the
    /// film's sample position.
    pub offsets: Vec<[f64; 2]>,
    /// The numbers of samples after which one may stop, ascending; a film stores means of that many.
    pub steps: Vec<usize>,
    /// The index of the step up to which every pixel's samples are taken.
    pub first: usize,
}

impl SamplePattern {
    /// Builds the pattern of a film.
    pub fn new(film: &FilmSettings) -> Self {
        let pattern = match film.adaptive {
            None => regular(film.spp),
            Some(adaptive) => progressive(film.spp, adaptive.max),
        };
        Self { offsets: from_corner(film, pattern.offsets), ..pattern }
    }
}

/// Returns regular samples, all of which every pixel has: their mean is 0, and they stay within the
/// pixel's square. In a grid the coarser grids within it come first.
fn regular(spp: u32) -> SamplePattern {
    let side = spp.isqrt();
    if side * side == spp {
        let (cells, steps) = grid(side);
        let center = |k: u32| (f64::from(k) + 0.5) / f64::from(side) - 0.5;
        let offsets = cells.into_iter().map(|cell| cell.map(center)).collect();
        return SamplePattern { first: steps.len() - 1, offsets, steps };
    }
    let n = f64::from(spp);
    let golden_ratio = (5f64.sqrt() - 1.0) / 2.0;
    let lattice = |i: u32| (f64::from(i) * golden_ratio).fract();
    // The lattice's y are not symmetric; their mean is taken out, and the rest drawn together so
    // that no sample leaves the square.
    let mean = (0..spp).map(lattice).sum::<f64>() / n;
    let half_height = (0..spp).map(|i| (lattice(i) - mean).abs()).fold(0.5, f64::max);
    let offset = |i| [(f64::from(i) + 0.5) / n - 0.5, (lattice(i) - mean) * (0.5 / half_height)];
    SamplePattern { offsets: (0..spp).map(offset).collect(), steps: vec![spp as usize], first: 0 }
}

/// Returns the cells of a square grid, in an order that begins with the coarser grids within it, and
/// the number of cells after each step.
///
/// A grid whose side is an odd multiple of another's has the centres of the other's cells. After
/// them come the corners of each such cell, where what the centre missed is found soonest.
fn grid(side: u32) -> (Vec<[u32; 2]>, Vec<usize>) {
    let (mut cells, mut steps) = (Vec::new(), Vec::new());
    // The next coarser grid, and the corners of its cells.
    if let Some(factor) = (3..=side).step_by(2).find(|&factor| side.is_multiple_of(factor)) {
        let (coarse, coarse_steps) = grid(side / factor);
        let (middle, last) = (factor / 2, factor - 1);
        for [dx, dy] in [[middle, middle], [0, 0], [last, last], [0, last], [last, 0]] {
            cells.extend(coarse.iter().map(|[x, y]| [x * factor + dx, y * factor + dy]));
        }
        steps = coarse_steps;
        steps.push(cells.len());
    }
    // The other cells, row by row.
    let mut is_taken = vec![false; side as usize * side as usize];
    let index = |[x, y]: [u32; 2]| y as usize * side as usize + x as usize;
    cells.iter().for_each(|&cell| is_taken[index(cell)] = true);
    let rows = (0..side).flat_map(|y| (0..side).map(move |x| [x, y]));
    cells.extend(rows.filter(|&cell| !is_taken[index(cell)]));
    if steps.last() != Some(&cells.len()) {
        steps.push(cells.len());
    }
    (cells, steps)
}

/// Returns samples that begin with `min` regular ones and end as `max` regular ones.
///
/// If the `max` regular samples begin with the `min` ones, the pattern is the `max` samples. Otherwise
/// the `min` samples replace those of the `max` that are nearest to them, and the next to be taken are
/// four around each, far from it.
fn progressive(min: u32, max: u32) -> SamplePattern {
    let (first, full) = (regular(min).offsets, regular(max));
    if full.offsets.starts_with(&first) {
        let first = full.steps.partition_point(|&step| step < first.len());
        return SamplePattern { first, ..full };
    }
    let mut rest = full.offsets;
    let mut remove_nearest = |[x, y]: [f64; 2]| {
        let distance = |[a, b]: [f64; 2]| (a - x) * (a - x) + (b - y) * (b - y);
        let nearest =
            (0..rest.len()).min_by(|&i, &j| distance(rest[i]).total_cmp(&distance(rest[j])));
        nearest.map(|i| rest.remove(i))
    };
    for &offset in &first {
        remove_nearest(offset);
    }
    let (mut offsets, mut steps) = (first.clone(), vec![first.len()]);
    // Four around each of the first.
    if max > 5 * min {
        let d = 0.5 / f64::from(min).sqrt();
        for [dx, dy] in [[-d, -d], [d, d], [-d, d], [d, -d]] {
            offsets.extend(first.iter().filter_map(|[x, y]| remove_nearest([x + dx, y + dy])));
        }
        steps.push(offsets.len());
    }
    offsets.append(&mut rest);
    steps.push(offsets.len());
    SamplePattern { offsets, steps, first: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_lies_at_the_sample_position() {
        assert_eq!(regular(1).offsets, [[0.0, 0.0]]);
    }

    #[test]
    fn four_samples_form_a_grid() {
        let expected = [[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]];
        assert_eq!(regular(4).offsets, expected);
    }

    #[test]
    fn samples_never_shift_the_picture_nor_leave_the_pixel() {
        for spp in 1..100 {
            let mut mean = [0.0; 2];
            for s in regular(spp).offsets {
                assert!(s.iter().all(|x| x.abs() <= 0.5), "{spp}: {s:?}");
                mean = [mean[0] + s[0], mean[1] + s[1]];
            }
            assert!(mean.iter().all(|m| m.abs() < 1e-12), "{spp}: {mean:?}");
        }
    }

    /// Returns samples in one order, to be compared as sets.
    fn sorted(mut samples: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        samples.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
        samples
    }

    #[test]
    fn a_square_number_of_samples_is_every_cell_of_a_grid_once() {
        for side in [1u32, 2, 3, 5, 6, 7, 9, 15, 22] {
            let center = |k: u32| (f64::from(k) + 0.5) / f64::from(side) - 0.5;
            let rows = (0..side).flat_map(|y| (0..side).map(move |x| [center(x), center(y)]));
            assert_eq!(sorted(regular(side * side).offsets), rows.collect::<Vec<_>>(), "{side}");
        }
    }

    #[test]
    fn a_grid_begins_with_the_coarser_ones_within_it() {
        for (coarse, fine) in [(1, 9), (1, 25), (4, 36), (4, 100), (9, 81), (1, 81), (25, 225)] {
            assert!(regular(fine).offsets.starts_with(&regular(coarse).offsets), "{coarse} {fine}");
        }
        assert_eq!(regular(81).steps, [1, 5, 9, 45, 81]);
        let SamplePattern { steps, first, .. } = progressive(9, 81);
        assert_eq!(steps[first..], [9, 45, 81]);
    }

    #[test]
    fn adaptive_samples_begin_with_the_regular_ones_and_are_as_many_as_asked_for() {
        for (min, max) in [(1, 1), (1, 2), (1, 16), (2, 9), (3, 17), (4, 64), (4, 5), (5, 100)] {
            let SamplePattern { offsets, steps, first } = progressive(min, max);
            assert!(offsets.starts_with(&regular(min).offsets), "{min} {max}");
            assert_eq!((offsets.len(), steps[first]), (max as usize, min as usize));
            assert_eq!(steps.last(), Some(&offsets.len()));
            assert!(steps.is_sorted_by(|a, b| a < b), "{steps:?}");
            assert!(offsets.as_flattened().iter().all(|x| x.abs() <= 0.5));
        }
    }

    #[test]
    fn where_a_sample_may_stop_the_mean_is_the_sample_position() {
        for spp in [9, 25, 36, 49, 81, 100, 225] {
            let SamplePattern { offsets, steps, .. } = regular(spp);
            for step in steps {
                for axis in 0..2 {
                    let sum: f64 = offsets[..step].iter().map(|s| s[axis]).sum();
                    assert!(sum.abs() < 1e-11, "{spp} {step}: {sum}");
                }
            }
        }
    }
}
