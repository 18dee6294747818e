//! The comparison of two intersectors: tracing with both, row by row, and counting differences.

mod differences;
mod secondary_rays;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use super::Validation;
use crate::film::{Film, View};
use crate::geometry::{Hit, PrimitiveId, Ray};
use crate::integrator::sample_positions;
use crate::intersect::{Coherence, Intersector, Precision};
use crate::measure::mismatch::MismatchClassifier;
use crate::measure::trace::{closest, occluded, ulps_between};
use crate::render::Renderer;
use crate::scene::{RayGenerator, Scene};
use crate::surface::Surface;
use crate::write::{Settings, bytes_per_pixel, png_bytes};
use differences::{CameraRay, Differences, RED, Severity, YELLOW};
use secondary_rays::SecondaryRayComparer;

/// The two intersectors to compare, and what to trace with them.
pub struct Comparer<'a> {
    pub scene: &'a Scene,
    /// The precision of the tested intersector.
    pub precision: Precision,
    pub tested: &'a dyn Intersector,
    /// The margin of the tested intersector's rays in precision `fast`; see [`MismatchClassifier`].
    pub margin: f64,
    /// The certified intersector.
    pub reference: &'a dyn Intersector,
    /// The index of the camera.
    pub camera: usize,
}

/// The colour of a pixel that differs without a mismatch.
const BLUE: [f32; 3] = [0.2, 0.4, 1.0];
/// The colour of a pixel in which both hit something.
const GREY: [f32; 3] = [0.15; 3];

impl Comparer<'_> {
    /// Compares all camera, shadow and secondary rays, and the pictures.
    pub fn run(&self) -> Validation {
        // The rows in any order, and their differences added up in the order of the picture.
        let size = self.scene.film.size;
        let rays = self.scene.cameras[self.camera].ray_generator(size);
        let mut heatmap = Film::new(size, View::Beauty);
        let width = size[0] as usize;
        let rows = heatmap.pixels.par_chunks_mut(width).enumerate();
        let rows: Vec<Differences> = rows.map(|(y, row)| self.compare_row(&rays, y, row)).collect();
        let (pictures, secondary) = self.compare_pictures(&mut heatmap);
        let sum = rows.into_iter().fold(secondary, Differences::merge);

        // The verdict: unexplained mismatches fail, explained ones only where there are many.
        let (causes, explained) = (sum.causes, sum.causes.explained());
        let rays_compared = sum.primary + sum.shadow + sum.secondary;
        let pixels = heatmap.pixels.len() as u64;
        let passed = causes.other == 0
            && match self.precision {
                Precision::Fast => {
                    explained as f64 <= 1e-4 * rays_compared as f64
                        && pictures.pixels as f64 <= 1e-5 * pixels as f64
                }
                Precision::Certified => explained == 0 && pictures.values == 0,
            };
        Validation {
            precision: self.precision.name(),
            rays_compared,
            primary_rays: sum.primary,
            secondary_rays: sum.secondary,
            primitive_mismatches: explained + causes.other,
            causes,
            unexplained_mismatches: causes.other,
            max_t_error_ulp: sum.max_ulp,
            pixels,
            pixels_differing: pictures.pixels,
            max_channel_difference: pictures.max_channel,
            values_differing: pictures.values,
            worst: sum.worst.map(|(_, worst)| worst),
            passed,
            heatmap,
        }
    }

    /// Compares the camera rays of a row and their shadow rays, and marks the differences in `row`
    /// of the heat map.
    fn compare_row(&self, camera: &RayGenerator, y: usize, row: &mut [[f32; 3]]) -> Differences {
        let mut differences = Differences::default();
        for [dx, dy] in sample_positions(&self.scene.film) {
            // One ray of each pixel of the row, traced with both intersectors.
            let rays: Vec<Ray> =
                (0..row.len()).map(|x| camera.ray(x as f64 + dx, y as f64 + dy)).collect();
            let [tested, reference] = [self.tested, self.reference]
                .map(|intersector| closest(intersector, &rays, Coherence::Coherent));
            // The hits, pixel by pixel, and then the shadow rays from those of the reference.
            differences.primary += rays.len() as u64;
            for (x, ray) in rays.iter().enumerate() {
                if reference[x].is_some() && row[x] == [0.0; 3] {
                    row[x] = GREY;
                }
                let camera_ray =
                    CameraRay { pixel: [x as u32, y as u32], ray, heatmap_color: &mut row[x] };
                let (tested, reference) = (tested[x].as_ref(), reference[x].as_ref());
                self.compare_hits(ray, Some(camera_ray), tested, reference, &mut differences);
            }
            self.compare_shadows(y, &rays, &reference, row, &mut differences);
        }
        differences
    }

    /// Compares the hits of a ray: a camera ray, or a secondary ray, which has no pixel.
    fn compare_hits(
        &self,
        ray: &Ray,
        camera_ray: Option<CameraRay<'_>>,
        tested: Option<&Hit>,
        reference: Option<&Hit>,
        differences: &mut Differences,
    ) {
        // The difference of t, where both hit the same primitive.
        let same_primitive = tested.map(|h| h.id) == reference.map(|h| h.id);
        let pair = tested.zip(reference).filter(|_| same_primitive);
        let t_error_ulp = pair.map(|(a, b)| ulps_between(a.t, b.t));
        let ulp = t_error_ulp.unwrap_or(0);
        differences.max_ulp = differences.max_ulp.max(ulp);

        // In `certified` every bit counts, in `fast` only which primitive is hit.
        let (is_mismatch, cause) = match self.precision {
            Precision::Certified => (tested.map(bits) != reference.map(bits), None),
            Precision::Fast if same_primitive => (false, None),
            Precision::Fast => (true, self.classifier().classify_hits(ray, tested, reference)),
        };
        if is_mismatch {
            differences.add(camera_ray, cause, false, t_error_ulp);
        } else if let Some(camera_ray) = camera_ray.filter(|_| ulp > 0) {
            let worst = || camera_ray.worst_ray(None, false, t_error_ulp);
            differences.keep_worst(Severity::Distance(ulp), worst);
        }
    }

    /// Compares the shadow rays from the reference's hits to each light.
    fn compare_shadows(
        &self,
        y: usize,
        rays: &[Ray],
        hits: &[Option<Hit>],
        row: &mut [[f32; 3]],
        differences: &mut Differences,
    ) {
        // The surfaces that the reference sees, with their columns.
        let surfaces: Vec<(usize, Surface)> = (0..)
            .zip(rays.iter().zip(hits))
            .filter_map(|(x, (ray, hit))| Some((x, Surface::new(self.scene, ray, hit.as_ref()?))))
            .collect();
        for light in self.scene.lights.iter().filter(|light| light.casts_shadow()) {
            // A shadow ray from each surface that the light may reach, traced with both.
            let shadow_ray = |(x, s): &(usize, Surface)| {
                Some((*x, s.shadow_ray(rays[*x].direction, &light.incident(s.position)?)))
            };
            let (columns, shadow): (Vec<usize>, Vec<Ray>) =
                surfaces.iter().filter_map(shadow_ray).unzip();
            let [tested, reference] = [self.tested, self.reference]
                .map(|intersector| occluded(intersector, &shadow, Coherence::Coherent));
            differences.shadow += shadow.len() as u64;
            for i in (0..shadow.len()).filter(|&i| tested[i] != reference[i]) {
                let classify = || self.classifier().classify_occlusion(&shadow[i], reference[i]);
                let cause = (self.precision == Precision::Fast).then(classify).flatten();
                let x = columns[i];
                let (pixel, heatmap_color) = ([x as u32, y as u32], &mut row[x]);
                let camera_ray = CameraRay { pixel, ray: &rays[x], heatmap_color };
                differences.add(Some(camera_ray), cause, true, None);
            }
        }
    }

    fn classifier(&self) -> MismatchClassifier<'_> {
        MismatchClassifier { scene: self.scene, margin: self.margin }
    }

    /// Renders and compares the pictures of both intersectors, and their secondary rays.
    fn compare_pictures(&self, heatmap: &mut Film) -> (PictureDifference, Differences) {
        let settings = Settings::from_film(&self.scene.film);
        let renderer = Renderer::new(self.scene).camera(self.camera);
        let film = |intersector: &dyn Intersector| renderer.render_with(intersector).film;
        let secondary_rays = SecondaryRayComparer::new(self);
        let (a, b) = (film(self.tested), film(&secondary_rays));

        // The values of the EXR, with any alpha, bit by bit.
        let alpha = a.alpha.iter().flatten().zip(b.alpha.iter().flatten());
        let values = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
        let values = values.chain(alpha).filter(|(x, y)| x.to_bits() != y.to_bits()).count() as u64;
        let mut difference = PictureDifference { values, pixels: 0, max_channel: 0 };
        // The bytes of the PNG; pixels that differ are marked unless a hit or shadow ray explains them.
        let depth = bytes_per_pixel(&a);
        let (a, b) = (png_bytes(&a, &settings), png_bytes(&b, &settings));
        for ((p, q), mark) in a.chunks(depth).zip(b.chunks(depth)).zip(&mut heatmap.pixels) {
            let largest = p.iter().zip(q).map(|(x, y)| x.abs_diff(*y)).max().unwrap_or(0);
            difference.max_channel = difference.max_channel.max(largest);
            if largest > 1 {
                difference.pixels += 1;
                if *mark != RED && *mark != YELLOW {
                    *mark = BLUE;
                }
            }
        }
        (difference, secondary_rays.differences())
    }
}

/// The differences of two pictures of one scene.
struct PictureDifference {
    /// The number of f32 values that differ in any bit.
    values: u64,
    /// The number of pixels with a channel of the PNG that differs by more than 1 of 255.
    pixels: u64,
    /// The largest difference of a channel.
    max_channel: u8,
}

/// Returns all that must be equal in certified hits.
fn bits(hit: &Hit) -> (PrimitiveId, [u64; 3]) {
    (hit.id, [hit.t, hit.u, hit.v].map(f64::to_bits))
}
