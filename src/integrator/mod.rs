//! The Whitted loop: from the eye to the surfaces, and from there to the lights.
//!
//! Rays go through the intersector in batches. A strip of the picture is worked off tile by tile,
//! in each tile sample by sample: all primary rays of a sample, then for each light all shadow
//! rays with the radiance that waits on them. A pixel's sum therefore has one order, whatever the
//! tiles and threads. Secondary rays, when there are any, form the next wave of the same loop.

mod counts;
mod samples;
mod tiling;

use glam::Vec3;

use crate::film::{Pixel, View};
use crate::geometry::{Geometry, Hit, Ray};
use crate::intersect::{Coherence, Intersector};
use crate::scene::{FilmSettings, LightKind, RayMaker, Scene};
use crate::shading::{self, Reflectance};
use crate::surface::Surface;
pub use counts::{Counts, NotFinite, RayCounts};
pub use samples::sample_positions;
pub use tiling::Tiling;

/// Makes the pixels of one picture.
pub struct Integrator<'a> {
    scene: &'a Scene,
    intersector: &'a dyn Intersector,
    rays: RayMaker,
    view: View,
    tiling: Tiling,
    /// Where in a pixel its samples lie, as offsets from its upper left corner.
    samples: Vec<[f64; 2]>,
}

/// Memory that a thread uses again and again.
#[derive(Default)]
pub struct Scratch {
    at: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    lit: Vec<(u32, Surface, Reflectance)>,
    shadow: Vec<Ray>,
    waiting: Vec<(u32, Vec3)>,
    blocked: Vec<bool>,
    sample: Vec<Vec3>,
}

impl<'a> Integrator<'a> {
    /// An integrator for the scene's film settings; `rays` must be of the same size.
    pub fn new(
        scene: &'a Scene,
        intersector: &'a dyn Intersector,
        rays: RayMaker,
        view: View,
        tiling: Tiling,
    ) -> Self {
        // Debug views are not averages: one sample.
        let spp = if view == View::Beauty { scene.film.spp } else { 1 };
        let samples = sample_positions(&FilmSettings { spp, ..scene.film.clone() });
        Self { scene, intersector, rays, view, tiling, samples }
    }

    /// Makes the rows of the strip that begins at row `first`; `pixels` are whole rows.
    pub fn strip(&self, first: usize, pixels: &mut [Pixel], scratch: &mut Scratch) -> Counts {
        let width = self.scene.film.size[0] as usize;
        let rows = pixels.len() / width;
        let Tiling { columns: widest, block, .. } = self.tiling;
        let mut counts = Counts::default();
        for left in (0..width).step_by(widest) {
            let columns = widest.min(width - left);
            scratch.at.clear();
            for y in (0..rows).step_by(block) {
                for x in (left..left + columns).step_by(block) {
                    for row in y..(y + block).min(rows) {
                        let end = (x + block).min(left + columns);
                        scratch.at.extend((x..end).map(|column| (row * width + column) as u32));
                    }
                }
            }
            for sample in &self.samples {
                self.sample(*sample, first, pixels, scratch, &mut counts);
            }
        }
        if self.view == View::Beauty {
            let share = 1.0 / self.samples.len() as f32;
            pixels.iter_mut().flatten().for_each(|value| *value *= share);
        }
        counts
    }

    /// Adds one sample of each pixel of a tile.
    fn sample(
        &self,
        [dx, dy]: [f64; 2],
        first: usize,
        pixels: &mut [Pixel],
        scratch: &mut Scratch,
        counts: &mut Counts,
    ) {
        let width = self.scene.film.size[0] as usize;
        scratch.rays.clear();
        scratch.rays.extend(scratch.at.iter().map(|&at| {
            let (x, y) = (at as usize % width, first + at as usize / width);
            self.rays.through(x as f64 + dx, y as f64 + dy)
        }));
        scratch.hits.clear();
        scratch.hits.resize(scratch.rays.len(), None);
        self.intersector.closest(&scratch.rays, Coherence::Coherent, &mut scratch.hits);
        counts.rays.primary += scratch.rays.len() as u64;
        counts.hits += scratch.hits.iter().flatten().count() as u64;
        if self.view != View::Beauty {
            for ((&at, ray), hit) in scratch.at.iter().zip(&scratch.rays).zip(&scratch.hits) {
                pixels[at as usize] = self.debug(ray, hit.as_ref());
            }
            return;
        }
        self.shade(scratch, counts);
        for (&at, &radiance) in scratch.at.iter().zip(&scratch.sample) {
            let sum = Vec3::from(pixels[at as usize]) + radiance;
            if sum.is_finite() {
                pixels[at as usize] = sum.to_array();
            } else if !radiance.is_nan() {
                counts.not_finite.sum += 1; // A sample that is NaN was counted where it arose.
            }
        }
    }

    /// Works out the radiance along each ray of the batch, into `scratch.sample`.
    fn shade(&self, scratch: &mut Scratch, counts: &mut Counts) {
        let Scratch { rays, hits, lit, shadow, waiting, blocked, sample, .. } = scratch;
        sample.clear();
        lit.clear();
        for (i, (ray, hit)) in rays.iter().zip(hits.iter()).enumerate() {
            let Some(hit) = hit else {
                sample.push(self.scene.film.background);
                continue;
            };
            let surface = Surface::new(self.scene, ray, hit);
            let (emission, reflectance) = self.colors(&surface);
            let colors = emission.is_finite() && reflectance.diffuse.is_finite();
            if !(colors && surface.position.is_finite()) {
                sample.push(Vec3::ZERO);
                spoil(&mut sample[i], &mut counts.not_finite.surface);
                continue;
            }
            sample.push(emission);
            if reflectance.diffuse != Vec3::ZERO || reflectance.specular != Vec3::ZERO {
                lit.push((i as u32, surface, reflectance));
            }
        }
        for light in &self.scene.lights {
            if light.kind == LightKind::Ambient {
                for (i, _, reflectance) in lit.iter() {
                    add(&mut sample[*i as usize], reflectance.diffuse * light.intensity, counts);
                }
                continue;
            }
            shadow.clear();
            waiting.clear();
            for (i, surface, reflectance) in lit.iter() {
                let Some(arrival) = light.arrival(surface.position) else { continue };
                // On a smooth-shaded mesh the shading normal may see a light that is behind the
                // surface itself.
                let behind = matches!(surface.id.geometry, Geometry::Mesh(_))
                    && surface.facing_normal().dot(arrival.toward) <= 0.0;
                if behind {
                    continue;
                }
                let view = rays[*i as usize].direction;
                let share = shading::direct(reflectance, surface.normal, view, arrival.toward);
                if share == Vec3::ZERO {
                    continue;
                }
                let radiance = match (arrival.intensity.is_finite(), share.is_finite()) {
                    (false, _) => NO_LIGHT,
                    (true, false) => Vec3::INFINITY,
                    (true, true) => share * arrival.intensity,
                };
                if radiance == Vec3::ZERO {
                    continue;
                }
                if light.casts_shadow() {
                    shadow.push(surface.shadow_ray(&arrival));
                    waiting.push((*i, radiance));
                } else {
                    add(&mut sample[*i as usize], radiance, counts);
                }
            }
            if shadow.is_empty() {
                continue;
            }
            blocked.clear();
            blocked.resize(shadow.len(), false);
            self.intersector.occluded(shadow, Coherence::Coherent, blocked);
            counts.rays.shadow += shadow.len() as u64;
            for ((i, radiance), blocked) in waiting.iter().zip(blocked.iter()) {
                if !blocked {
                    add(&mut sample[*i as usize], *radiance, counts);
                }
            }
        }
    }

    /// Emission and reflectance at a point, with textures, vertex colours and checker applied.
    fn colors(&self, surface: &Surface) -> (Vec3, Reflectance) {
        let material = &self.scene.materials[surface.material.0 as usize];
        let texture = |map: Option<crate::scene::TextureId>| {
            map.map_or(Vec3::ONE, |id| self.scene.textures[id.0 as usize].color(surface.uv))
        };
        let diffuse = surface.checker.unwrap_or(material.diffuse);
        let reflectance = Reflectance {
            diffuse: diffuse * texture(material.diffuse_map) * surface.tint,
            specular: material.specular,
            shininess: material.shininess,
        };
        let emission = if material.emission == Vec3::ZERO {
            Vec3::ZERO
        } else {
            material.emission * texture(material.emission_map)
        };
        (emission, reflectance)
    }

    /// The value of a debug view.
    fn debug(&self, ray: &Ray, hit: Option<&Hit>) -> Pixel {
        match (self.view, hit) {
            (View::Depth, None) => [f32::INFINITY; 3],
            (_, None) | (View::Beauty, _) => [0.0; 3],
            (View::Normal, Some(hit)) => {
                Surface::new(self.scene, ray, hit).normal.as_vec3().to_array()
            }
            (View::Depth, Some(hit)) => {
                // Infinite is what nothing is.
                [(hit.t * ray.direction.length()).min(f64::from(f32::MAX)) as f32; 3]
            }
            (View::Id, Some(hit)) => {
                let geometry = match hit.id.geometry {
                    Geometry::Spheres => 1.0,
                    Geometry::Planes => 2.0,
                    Geometry::Mesh(i) => 3.0 + i as f32,
                };
                [geometry, hit.id.primitive as f32, hit.id.instance as f32]
            }
        }
    }
}

/// The radiance that a light gives of which the arrival is not finite; no finite factors make NaN.
const NO_LIGHT: Vec3 = Vec3::NAN;

/// Adds to the radiance of a sample, unless it is spoilt already.
fn add(sample: &mut Vec3, radiance: Vec3, counts: &mut Counts) {
    let sum = *sample + radiance;
    if sum.is_finite() {
        *sample = sum;
    } else if radiance.is_nan() {
        spoil(sample, &mut counts.not_finite.light);
    } else {
        spoil(sample, &mut counts.not_finite.sum);
    }
}

/// Makes a sample NaN, so that it stays out of the picture, and counts what did it, once.
fn spoil(sample: &mut Vec3, cause: &mut u64) {
    *cause += u64::from(!sample.is_nan());
    *sample = Vec3::NAN;
}
