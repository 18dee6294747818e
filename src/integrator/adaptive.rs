//! More samples where neighbouring ones disagree.
//!
//! A first pass takes a few samples of every pixel and keeps what they saw. Then, with the whole
//! picture there, each pixel is held against its eight neighbours; so it does not matter how the
//! picture is cut up. A second pass goes on with the pixels whose samples, or neighbours, disagree:
//! step by step, as long as a pixel's own samples do. A sample once taken stays, and all of a pixel
//! count the same.

use glam::Vec3;
use rayon::prelude::*;

use crate::film::Pixel;
use crate::geometry::{LANES, Lanes, PrimitiveId16};
use crate::integrator::radiance::{DARK, Radiance, at, put};
use crate::integrator::{Counts, Integrator, Scratch, Wave};
use crate::scene::Scene;
use crate::surface::Surface16;

/// How many steps a picture can have: a side of 256 samples has five odd factors, two steps each.
pub const STEPS: usize = 12;

/// Pixels that are refined together.
const TILE: usize = 1024;

/// The least cosine of the angle between two normals that agree: 30°.
const COSINE: f32 = 0.866;

/// What stands for no hit among the kinds of things, and for the normal there.
const NOTHING: u32 = 0;

/// What the samples of a pixel saw: the first one, and whether any other disagrees with it. 8 bytes.
#[derive(Clone, Copy, Debug, Default)]
pub struct PixelRecord {
    /// The sphere, the plane or the instance: its index and two bits for which of them it is.
    thing: u32,
    /// The normal, in units of 1/127.
    normal: [i8; 3],
    disagrees: bool,
}

/// What the samples of a tile's pixels saw, while they are taken.
#[derive(Default)]
pub(super) struct PixelRecords {
    /// Whether there is anything yet to be compared with.
    has_begun: bool,
    pub seen: Vec<PixelRecord>,
    /// The square roots of the radiance that the samples' are compared with.
    roots: Vec<Vec3>,
    surfaces: Surface16,
}

impl PixelRecords {
    /// Begins with pixels of which no sample was taken.
    pub fn begin(&mut self) {
        self.has_begun = false;
        self.seen.clear();
        self.roots.clear();
    }

    /// Compares the radiance of a sample of each pixel.
    pub fn take_colors(&mut self, samples: &[Radiance], threshold: f32) {
        let lane = |i: usize| root(at(&samples[i / LANES], i % LANES));
        if !self.has_begun {
            self.roots.extend((0..self.seen.len()).map(lane));
            self.has_begun = true;
            return;
        }
        for (i, (seen, &a)) in self.seen.iter_mut().zip(&self.roots).enumerate() {
            let b = lane(i);
            let close = |a: f32, b: f32| (a - b).abs() < threshold;
            seen.disagrees |= !(close(a.x, b.x) & close(a.y, b.y) & close(a.z, b.z));
        }
    }
}

/// The square root of each channel; what is not a number stays so, and disagrees with everything.
fn root(radiance: Vec3) -> Vec3 {
    radiance.map(f32::sqrt)
}

/// Notes what the primary rays of a tile hit, or compares it with what was noted.
pub(super) struct Note<'a> {
    pub scene: &'a Scene,
    pub wave: &'a Wave,
    pub notes: &'a mut PixelRecords,
}

impl pulp::WithSimd for Note<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { scene, wave, notes: PixelRecords { has_begun, seen, surfaces, .. } } = self;
        let count = wave.rays.len();
        for (block, found) in wave.hits.blocks().iter().enumerate() {
            // A scene without smooth normals has none to look up either way.
            surfaces.set::<true>(scene, &wave.rays, block, found);
            let mut things = [NOTHING; LANES];
            let mut normals = [[0i8; LANES]; 3];
            for i in 0..LANES {
                things[i] = thing(&found.id, i);
            }
            for axis in 0..3 {
                for i in 0..LANES {
                    let scaled = (surfaces.normal[axis][i] * 127.0) as i8;
                    normals[axis][i] = if things[i] == NOTHING { 127 } else { scaled };
                }
            }
            let normal = |i: usize| normals.map(|lanes: Lanes<i8>| lanes[i]);
            let here = (count - block * LANES).min(LANES);
            if *has_begun {
                for (i, seen) in seen[block * LANES..][..here].iter_mut().enumerate() {
                    let cosine = dot(seen.normal.map(f32::from), normal(i).map(f32::from));
                    seen.disagrees |= (seen.thing != things[i]) | is_bent(cosine);
                }
            } else {
                let new = |i| PixelRecord { thing: things[i], normal: normal(i), disagrees: false };
                seen.extend((0..here).map(new));
            }
        }
    }
}

/// What is hit in lane `i`; a mesh counts as one thing wherever it stands.
#[inline(always)]
fn thing(ids: &PrimitiveId16, i: usize) -> u32 {
    let kind = ids.geometry[i].min(PrimitiveId16::MESHES);
    let index = if kind == PrimitiveId16::MESHES { ids.instance[i] } else { ids.primitive[i] };
    if kind == PrimitiveId16::NONE { NOTHING } else { index << 2 | kind }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Whether normals disagree, by the product of them in units of 1/127.
#[inline(always)]
fn is_bent(cosine: f32) -> bool {
    cosine < COSINE * 127.0 * 127.0
}

/// A row of the picture after the first pass, value by value.
#[derive(Default)]
struct Row {
    things: Vec<u32>,
    normals: [Vec<f32>; 3],
    roots: [Vec<f32>; 3],
    /// Whether a pixel's samples or neighbours disagree.
    doubtful: Vec<bool>,
}

impl Row {
    fn read(&mut self, pixels: &[Pixel], seen: &[PixelRecord], share: f32) {
        self.things.clear();
        self.things.extend(seen.iter().map(|seen| seen.thing));
        self.doubtful.clear();
        self.doubtful.extend(seen.iter().map(|seen| seen.disagrees));
        for axis in 0..3 {
            self.normals[axis].clear();
            self.normals[axis].extend(seen.iter().map(|seen| f32::from(seen.normal[axis])));
            self.roots[axis].clear();
            self.roots[axis].extend(pixels.iter().map(|pixel| (pixel[axis] * share).sqrt()));
        }
    }

    /// Whether pixel `x` and pixel `at` of another row disagree.
    #[inline(always)]
    fn differs(&self, x: usize, other: &Self, at: usize, threshold: f32) -> bool {
        let normal = |row: &Self, x: usize| [0, 1, 2].map(|axis| row.normals[axis][x]);
        let mut differs =
            (self.things[x] != other.things[at]) | is_bent(dot(normal(self, x), normal(other, at)));
        for (a, b) in self.roots.iter().zip(&other.roots) {
            let close = (a[x] - b[at]).abs() < threshold;
            differs |= !close;
        }
        differs
    }
}

/// Marks the pixels of a row that disagree with one beside them, or of the row below.
struct Mark<'a> {
    row: &'a mut Row,
    below: Option<&'a mut Row>,
    threshold: f32,
}

impl pulp::WithSimd for Mark<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { row, below, threshold } = self;
        let width = row.things.len();
        let mut marks = vec![false; width];
        for (x, mark) in marks[1..].iter_mut().enumerate() {
            *mark = row.differs(x, row, x + 1, threshold);
        }
        for x in 1..width {
            row.doubtful[x - 1] |= marks[x];
            row.doubtful[x] |= marks[x];
        }
        let Some(below) = below else { return };
        for shift in 0..3usize.min(width + 1) {
            // From pixel `from` of the row to pixel `to` of the one below.
            let [from, to] = [1usize.saturating_sub(shift), shift.saturating_sub(1)];
            let count = width - from.max(to);
            for (x, mark) in marks[..count].iter_mut().enumerate() {
                *mark = row.differs(x + from, below, x + to, threshold);
            }
            for x in 0..count {
                row.doubtful[x + from] |= marks[x];
                below.doubtful[x + to] |= marks[x];
            }
        }
    }
}

impl Integrator<'_> {
    /// Whether some pixels get more samples than others.
    pub fn is_adaptive(&self) -> bool {
        self.threshold.is_some() && self.series.steps.len() > 1
    }

    /// Which pixels of a picture, of which every pixel has its first samples, need more; `pixels`
    /// are the sums of these.
    pub fn pixels_to_refine(&self, pixels: &[Pixel], seen: &[PixelRecord]) -> Vec<bool> {
        let width = self.scene.film.size[0] as usize;
        let share = 1.0 / self.series.steps[0] as f32;
        let threshold = self.threshold.unwrap_or(0.0);
        let height = pixels.len() / width;
        let rows = self.tiling.rows;
        let mut doubtful = vec![false; pixels.len()];
        doubtful.par_chunks_mut(width * rows).enumerate().for_each(|(i, strip)| {
            let [mut row, mut below] = [Row::default(), Row::default()];
            let read = |row: &mut Row, y: usize| {
                let at = y * width..(y + 1) * width;
                row.read(&pixels[at.clone()], &seen[at], share);
            };
            let first = i * rows;
            let end = (first + strip.len() / width).min(height);
            read(&mut row, first.saturating_sub(1));
            for y in first.saturating_sub(1)..end {
                let is_last = y + 1 == height;
                if !is_last {
                    read(&mut below, y + 1);
                }
                let under = (!is_last).then_some(&mut below);
                self.arch.dispatch(Mark { row: &mut row, below: under, threshold });
                if y >= first {
                    strip[(y - first) * width..][..width].copy_from_slice(&row.doubtful);
                }
                std::mem::swap(&mut row, &mut below);
            }
        });
        doubtful
    }

    /// Takes more samples of the doubtful pixels of the strip that begins at row `first`, and makes
    /// sums into means; `pixels`, `seen` and `doubtful` are whole rows.
    pub fn refine(
        &self,
        first: usize,
        (pixels, seen, doubtful): (&mut [Pixel], &[PixelRecord], &[bool]),
        scratch: &mut Scratch,
    ) -> Counts {
        let width = self.scene.film.size[0] as usize;
        let steps = &self.series.steps;
        let mut counts = Counts::default();
        let shares: Vec<f32> = steps.iter().map(|&samples| 1.0 / samples as f32).collect();
        for (pixel, _) in pixels.iter_mut().zip(doubtful).filter(|(_, doubtful)| !**doubtful) {
            pixel.iter_mut().for_each(|value| *value *= shares[0]);
        }
        // Pixels with what their samples saw, in the order in which tiles line up their rays.
        let mut open: Vec<([usize; 2], PixelRecord)> = Vec::new();
        for (left, columns) in self.tiles(width) {
            scratch.tile.set([left, first], [columns, pixels.len() / width], self.tiling.block);
            for [x, y, length] in scratch.tile.runs.iter().map(|run| run.map(|n| n as usize)) {
                let run = (left + x..left + x + length).filter(|x| doubtful[y * width + x]);
                open.extend(run.map(|x| ([x, y], seen[y * width + x])));
            }
        }
        for step in 1..steps.len() {
            counts.refined[step - 1] += open.len() as u64;
            let mut still = Vec::new();
            for part in open.chunks(TILE) {
                scratch.tile.pick(part.iter().map(|([x, y], _)| [*x, first + y]));
                let before = part.iter().map(|([x, y], _)| Vec3::from(pixels[y * width + x]));
                scratch.sum.clear();
                scratch.sum.resize(part.len().div_ceil(LANES), DARK);
                let notes = &mut scratch.notes;
                notes.begin();
                notes.seen.extend(part.iter().map(|(_, seen)| *seen));
                for (i, sum) in before.enumerate() {
                    put(&mut scratch.sum[i / LANES], i % LANES, sum);
                    notes.roots.push(root(sum * shares[step - 1]));
                }
                notes.has_begun = true;
                for sample in &self.series.offsets[steps[step - 1]..steps[step]] {
                    self.sample(*sample, scratch, &mut counts);
                }
                for (i, (&([x, y], _), &seen)) in part.iter().zip(&scratch.notes.seen).enumerate() {
                    let sum = at(&scratch.sum[i / LANES], i % LANES);
                    let goes_on = seen.disagrees && step + 1 < steps.len();
                    let share = if goes_on { 1.0 } else { shares[step] };
                    pixels[y * width + x] = (sum * share).to_array();
                    if goes_on {
                        still.push(([x, y], seen));
                    }
                }
            }
            open = still;
        }
        counts
    }
}
