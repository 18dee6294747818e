//! Adaptive sampling: more samples for pixels that contrast.
//!
//! A first pass takes a few samples of every pixel and records what they hit. Then, with the whole
//! picture there, each pixel is compared with its eight neighbours; so it does not matter how the
//! picture is cut up. A second pass goes on with the pixels whose samples, or neighbours, disagree:
//! step by step, as long as a pixel's own samples do. A sample once taken stays, and all of a pixel
//! count the same.

use glam::Vec3;

use crate::film::Pixel;
use crate::geometry::{LANES, Lanes, PrimitiveId16};
use crate::integrator::radiance::{Radiance16, lane};
use crate::integrator::simd;
use crate::integrator::wave::Wave;
use crate::scene::Scene;
use crate::surface::Surface16;

/// The least cosine of the angle between two normals that agree: 30°.
const MIN_COSINE: f32 = 0.866;

/// The object number of a ray that hits nothing.
const NO_OBJECT: u32 = 0;

/// A record of what the samples of a pixel saw: the first one, and whether any other disagrees with
/// it. 8 bytes.
#[derive(Clone, Copy, Debug, Default)]
pub struct PixelRecord {
    /// The sphere, the plane or the instance: its index and two bits for its kind.
    object: u32,
    /// The normal, in units of 1/127.
    normal: [i8; 3],
    /// True if any two samples disagree.
    pub(super) disagrees: bool,
}

/// The records of a tile's pixels while their samples are taken.
#[derive(Default)]
pub(super) struct PixelRecords {
    /// True once there is anything to compare samples with.
    has_samples: bool,
    /// The records.
    pub records: Vec<PixelRecord>,
    /// The square roots of the radiance that the samples' are compared with.
    roots: Vec<Vec3>,
    /// Memory for the surfaces of sixteen pixels.
    surface: Surface16,
}

impl PixelRecords {
    /// Begins with pixels without samples.
    pub fn clear(&mut self) {
        self.has_samples = false;
        self.records.clear();
        self.roots.clear();
    }

    /// Adds a pixel with its record and the mean of its samples.
    pub fn push(&mut self, record: PixelRecord, mean: Vec3) {
        self.has_samples = true;
        self.records.push(record);
        self.roots.push(root(mean));
    }

    /// Records what the camera rays of a tile hit, or compares it with what was recorded.
    pub fn record_hits(&mut self, arch: pulp::Arch, scene: &Scene, wave: &Wave) {
        simd::dispatch(
            arch,
            #[inline(always)]
            || self.record_blocks(scene, wave),
        );
    }

    #[inline(always)]
    fn record_blocks(&mut self, scene: &Scene, wave: &Wave) {
        let Self { has_samples, records, surface, .. } = self;
        let count = wave.rays.len();
        for (block, hits) in wave.hits.blocks().iter().enumerate() {
            // The objects and normals of sixteen pixels. A scene without smooth normals has none to
            // look up either way.
            surface.set::<true>(scene, &wave.rays, block, hits);
            let mut objects = [NO_OBJECT; LANES];
            let mut normals = [[0i8; LANES]; 3];
            for i in 0..LANES {
                objects[i] = object(&hits.id, i);
            }
            for axis in 0..3 {
                for i in 0..LANES {
                    let scaled = (surface.normal[axis][i] * 127.0) as i8;
                    normals[axis][i] = if objects[i] == NO_OBJECT { 127 } else { scaled };
                }
            }
            // They are compared with the pixels' records, or become them.
            let normal = |i: usize| normals.map(|lanes: Lanes<i8>| lanes[i]);
            let active = (count - block * LANES).min(LANES);
            if *has_samples {
                for (i, record) in records[block * LANES..][..active].iter_mut().enumerate() {
                    let cosine = dot(record.normal.map(f32::from), normal(i).map(f32::from));
                    record.disagrees |= (record.object != objects[i]) | normals_disagree(cosine);
                }
            } else {
                records.extend((0..active).map(|i| PixelRecord {
                    object: objects[i],
                    normal: normal(i),
                    disagrees: false,
                }));
            }
        }
    }

    /// Compares the radiance of a sample of each pixel with that of the first, or records it.
    pub fn compare_radiance(&mut self, samples: &[Radiance16], threshold: f32) {
        let sample_root = |i: usize| root(lane(&samples[i / LANES], i % LANES));
        if !self.has_samples {
            self.roots.extend((0..self.records.len()).map(sample_root));
            self.has_samples = true;
            return;
        }
        for (i, (record, &a)) in self.records.iter_mut().zip(&self.roots).enumerate() {
            let b = sample_root(i);
            let agree = |a: f32, b: f32| (a - b).abs() < threshold;
            record.disagrees |= !(agree(a.x, b.x) & agree(a.y, b.y) & agree(a.z, b.z));
        }
    }
}

/// Returns the square root of each channel. What is NaN stays so, and disagrees with everything.
fn root(radiance: Vec3) -> Vec3 {
    radiance.map(f32::sqrt)
}

/// Returns the object that is hit in lane `i`; an instance of a mesh is one.
#[inline(always)]
fn object(ids: &PrimitiveId16, i: usize) -> u32 {
    let kind = ids.geometry[i].min(PrimitiveId16::MESHES);
    let index = if kind == PrimitiveId16::MESHES { ids.instance[i] } else { ids.primitive[i] };
    if kind == PrimitiveId16::NONE { NO_OBJECT } else { index << 2 | kind }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// True if normals disagree whose dot product, in units of 1/127 each, is `cosine`.
#[inline(always)]
fn normals_disagree(cosine: f32) -> bool {
    cosine < MIN_COSINE * 127.0 * 127.0
}

/// A row of the picture after the first pass, value by value.
#[derive(Default)]
pub(super) struct ContrastRow {
    objects: Vec<u32>,
    normals: [Vec<f32>; 3],
    roots: [Vec<f32>; 3],
    /// True for each pixel whose samples or neighbours disagree.
    pub disagrees: Vec<bool>,
}

impl ContrastRow {
    /// Sets the row to pixels with their records.
    pub fn set(&mut self, pixels: &[Pixel], records: &[PixelRecord]) {
        self.objects.clear();
        self.objects.extend(records.iter().map(|record| record.object));
        self.disagrees.clear();
        self.disagrees.extend(records.iter().map(|record| record.disagrees));
        for axis in 0..3 {
            self.normals[axis].clear();
            self.normals[axis].extend(records.iter().map(|r| f32::from(r.normal[axis])));
            self.roots[axis].clear();
            self.roots[axis].extend(pixels.iter().map(|pixel| pixel[axis].sqrt()));
        }
    }

    /// True if pixel `x` and pixel `other_x` of another row disagree.
    #[inline(always)]
    fn differs(&self, x: usize, other: &Self, other_x: usize, threshold: f32) -> bool {
        let normal = |row: &Self, x: usize| [0, 1, 2].map(|axis| row.normals[axis][x]);
        let cosine = dot(normal(self, x), normal(other, other_x));
        let mut differs = (self.objects[x] != other.objects[other_x]) | normals_disagree(cosine);
        for (a, b) in self.roots.iter().zip(&other.roots) {
            let agree = (a[x] - b[other_x]).abs() < threshold;
            differs |= !agree;
        }
        differs
    }

    /// Marks the pixels that disagree with one beside them, or with one of the row below.
    pub fn mark_contrast(
        &mut self,
        arch: pulp::Arch,
        mut below: Option<&mut Self>,
        threshold: f32,
    ) {
        simd::dispatch(
            arch,
            #[inline(always)]
            || self.mark_pairs(below.as_deref_mut(), threshold),
        );
    }

    #[inline(always)]
    fn mark_pairs(&mut self, below: Option<&mut Self>, threshold: f32) {
        let width = self.objects.len();
        let mut marks = vec![false; width];
        // Neighbours in the row.
        for (x, mark) in marks[1..].iter_mut().enumerate() {
            *mark = self.differs(x, self, x + 1, threshold);
        }
        for x in 1..width {
            self.disagrees[x - 1] |= marks[x];
            self.disagrees[x] |= marks[x];
        }
        // Neighbours below: to the left, straight down, to the right.
        let Some(below) = below else { return };
        for shift in 0..3usize.min(width + 1) {
            let [first, first_below] = [1usize.saturating_sub(shift), shift.saturating_sub(1)];
            let count = width - first.max(first_below);
            for (x, mark) in marks[..count].iter_mut().enumerate() {
                *mark = self.differs(x + first, below, x + first_below, threshold);
            }
            for x in 0..count {
                self.disagrees[x + first] |= marks[x];
                below.disagrees[x + first_below] |= marks[x];
            }
        }
    }
}
