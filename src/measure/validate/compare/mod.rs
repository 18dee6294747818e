//! Tracing with both, row by row, and counting.

#[cfg(test)]
mod tests;
mod witness;

use rayon::prelude::*;

use super::{Causes, Validation, Worst};
use crate::film::{Film, View};
use crate::geometry::{Hit, Ray};
use crate::integrator::sample_positions;
use crate::intersect::{Coherence, Intersector, Precision};
use crate::measure::mismatch::{MismatchCause, MismatchClassifier};
use crate::measure::replay::ray_to_text;
use crate::render::Renderer;
use crate::scene::{RayGenerator, Scene};
use crate::surface::Surface;
use crate::write::{Settings, png_bytes};
use witness::Witness;

pub struct Comparer<'a> {
    pub scene: &'a Scene,
    pub precision: Precision,
    /// Who is held against the judge.
    pub subject: &'a dyn Intersector,
    /// How far its rays may be off, in precision `fast`; see [`MismatchClassifier`].
    pub margin: f64,
    pub judge: &'a dyn Intersector,
    pub camera: usize,
}

/// What was found in one row.
#[derive(Default)]
struct Tally {
    primary: u64,
    shadow: u64,
    secondary: u64,
    causes: Causes,
    max_ulp: u64,
    worst: Option<(Severity, Worst)>,
}

/// How bad a difference is: 2 unexplained, 1 explained, 0 of t alone; and the error of t in ulp.
type Severity = (u8, u64);

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const YELLOW: [f32; 3] = [1.0, 1.0, 0.0];
const BLUE: [f32; 3] = [0.2, 0.4, 1.0];
const GREY: [f32; 3] = [0.15; 3];

/// The pixel that a ray is of, and its mark in the heat map.
struct Place<'m> {
    pixel: [u32; 2],
    /// The ray from the eye, which is what can be replayed.
    ray: &'m Ray,
    mark: &'m mut [f32; 3],
}

impl Comparer<'_> {
    pub fn run(&self) -> Validation {
        let size = self.scene.film.size;
        let rays = self.scene.cameras[self.camera].ray_generator(size);
        let mut heatmap = Film::new(size, View::Beauty);
        let width = size[0] as usize;
        let tallies: Vec<Tally> = heatmap
            .pixels
            .par_chunks_mut(width)
            .enumerate()
            .map(|(y, row)| self.row(&rays, y, row))
            .collect();
        let (pictures, secondary) = self.pictures(&mut heatmap);
        let sum = tallies.into_iter().fold(secondary, Tally::and);
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

    /// Traces a row with both; marks in `row` what they make of it.
    fn row(&self, maker: &RayGenerator, y: usize, row: &mut [[f32; 3]]) -> Tally {
        let mut tally = Tally::default();
        for [dx, dy] in sample_positions(&self.scene.film) {
            let rays: Vec<Ray> =
                (0..row.len()).map(|x| maker.ray(x as f64 + dx, y as f64 + dy)).collect();
            let (found, truth) = (closest(self.subject, &rays), closest(self.judge, &rays));
            tally.primary += rays.len() as u64;
            for (x, ray) in rays.iter().enumerate() {
                if truth[x].is_some() && row[x] == [0.0; 3] {
                    row[x] = GREY;
                }
                let place = Place { pixel: [x as u32, y as u32], ray, mark: &mut row[x] };
                let (found, truth) = (found[x].as_ref(), truth[x].as_ref());
                self.nearest(ray, Some(place), found, truth, &mut tally);
            }
            self.shadows(y, &rays, &truth, row, &mut tally);
        }
        tally
    }

    /// Compares what subject and judge say of a ray: from the eye, if it has a place, or from a
    /// mirror or glass.
    fn nearest(
        &self,
        ray: &Ray,
        place: Option<Place<'_>>,
        found: Option<&Hit>,
        truth: Option<&Hit>,
        tally: &mut Tally,
    ) {
        let same = found.map(|h| h.id) == truth.map(|h| h.id);
        let ulp =
            found.zip(truth).filter(|_| same).map(|(a, b)| a.t.to_bits().abs_diff(b.t.to_bits()));
        tally.max_ulp = tally.max_ulp.max(ulp.unwrap_or(0));
        match self.precision {
            Precision::Certified if found.map(bits) != truth.map(bits) => {
                tally.mismatch(place, None, false, ulp);
            }
            Precision::Fast if !same => {
                let cause = self.disputes().primary(ray, found, truth);
                tally.mismatch(place, cause, false, ulp);
            }
            _ => {
                if let Some(place) = place.filter(|_| ulp > Some(0)) {
                    tally.note((0, ulp.unwrap_or(0)), &place, None, false, ulp);
                }
            }
        }
    }

    /// Compares the shadow rays from the judge's hits to each light.
    fn shadows(
        &self,
        y: usize,
        rays: &[Ray],
        hits: &[Option<Hit>],
        row: &mut [[f32; 3]],
        tally: &mut Tally,
    ) {
        let surfaces: Vec<(usize, Surface)> = (0..)
            .zip(rays.iter().zip(hits))
            .filter_map(|(x, (ray, hit))| Some((x, Surface::new(self.scene, ray, hit.as_ref()?))))
            .collect();
        let casting = |l: &&crate::scene::Light| l.casts_shadow();
        for light in self.scene.lights.iter().filter(casting) {
            let (columns, shadow): (Vec<usize>, Vec<Ray>) = surfaces
                .iter()
                .filter_map(|(x, s)| Some((*x, s.shadow_ray(&light.incident(s.position)?))))
                .unzip();
            let (found, truth) = (occluded(self.subject, &shadow), occluded(self.judge, &shadow));
            tally.shadow += shadow.len() as u64;
            for i in (0..shadow.len()).filter(|&i| found[i] != truth[i]) {
                let cause = match self.precision {
                    Precision::Fast => self.disputes().shadow(&shadow[i], truth[i]),
                    Precision::Certified => None,
                };
                let x = columns[i];
                let place = Place { pixel: [x as u32, y as u32], ray: &rays[x], mark: &mut row[x] };
                tally.mismatch(Some(place), cause, true, None);
            }
        }
    }

    fn disputes(&self) -> MismatchClassifier<'_> {
        MismatchClassifier { scene: self.scene, margin: self.margin }
    }

    /// Renders the picture twice and compares; so also the rays that mirrors and glass send on.
    fn pictures(&self, heatmap: &mut Film) -> (Differing, Tally) {
        let settings = Settings::from_film(&self.scene.film);
        let renderer = Renderer::new(self.scene).camera(self.camera);
        let film = |intersector: &dyn Intersector| renderer.render_with(intersector).film;
        let witness = Witness::new(self);
        let (a, b) = (film(self.subject), film(&witness));
        let values = |film: &Film| film.pixels.as_flattened().to_vec();
        let differ = |(x, y): &(f32, f32)| x.to_bits() != y.to_bits();
        let values = values(&a).into_iter().zip(values(&b)).filter(differ).count() as u64;
        let (a, b) = (png_bytes(&a, &settings), png_bytes(&b, &settings));
        let mut differing = Differing { values, pixels: 0, max_channel: 0 };
        for ((p, q), mark) in a.chunks(3).zip(b.chunks(3)).zip(&mut heatmap.pixels) {
            let largest = p.iter().zip(q).map(|(x, y)| x.abs_diff(*y)).max().unwrap_or(0);
            differing.max_channel = differing.max_channel.max(largest);
            if largest > 1 {
                differing.pixels += 1;
                if *mark != RED && *mark != YELLOW {
                    *mark = BLUE;
                }
            }
        }
        (differing, witness.tally())
    }
}

/// How much two pictures of one scene differ.
struct Differing {
    /// f32 values of the films that are not the same bits.
    values: u64,
    /// Pixels that differ by more than 1 of 255 in a PNG's channel.
    pixels: u64,
    /// The largest such difference.
    max_channel: u8,
}

impl Tally {
    fn and(mut self, next: Self) -> Self {
        self.primary += next.primary;
        self.shadow += next.shadow;
        self.secondary += next.secondary;
        self.causes.edge += next.causes.edge;
        self.causes.tangency += next.causes.tangency;
        self.causes.tie += next.causes.tie;
        self.causes.other += next.causes.other;
        self.max_ulp = self.max_ulp.max(next.max_ulp);
        if next.worst.as_ref().map(|w| w.0) > self.worst.as_ref().map(|w| w.0) {
            self.worst = next.worst;
        }
        self
    }

    /// Counts a mismatch, and marks its pixel.
    fn mismatch(
        &mut self,
        place: Option<Place<'_>>,
        cause: Option<MismatchCause>,
        shadow: bool,
        ulp: Option<u64>,
    ) {
        *self.causes.of(cause) += 1;
        let Some(place) = place else { return };
        let explained = cause.is_some();
        if !explained {
            *place.mark = RED;
        } else if *place.mark != RED {
            *place.mark = YELLOW;
        }
        let severity = (if explained { 1 } else { 2 }, ulp.unwrap_or(0));
        self.note(severity, &place, Some(cause.map_or("other", MismatchCause::name)), shadow, ulp);
    }

    /// Keeps the ray if none so far is as bad.
    fn note(
        &mut self,
        severity: Severity,
        place: &Place<'_>,
        cause: Option<&'static str>,
        shadow: bool,
        t_error_ulp: Option<u64>,
    ) {
        if self.worst.as_ref().is_none_or(|(worst, _)| *worst < severity) {
            let ray = ray_to_text(place.ray);
            let worst = Worst { pixel: place.pixel, cause, shadow, t_error_ulp, ray };
            self.worst = Some((severity, worst));
        }
    }
}

/// Everything that certified hits must agree in.
fn bits(hit: &Hit) -> (crate::geometry::PrimitiveId, [u64; 3]) {
    (hit.id, [hit.t, hit.u, hit.v].map(f64::to_bits))
}

fn closest(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    intersector.closest(rays, Coherence::Coherent, &mut hits);
    hits
}

fn occluded(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<bool> {
    let mut blocked = vec![false; rays.len()];
    intersector.occluded(rays, Coherence::Coherent, &mut blocked);
    blocked
}
