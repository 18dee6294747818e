//! The Whitted loop: from the eye to the surfaces, and from there to the lights.
//!
//! Rays go through the intersector in batches. A strip of the picture is worked off tile by tile,
//! in each tile sample by sample: all primary rays of a sample, then for each light all shadow
//! rays with the radiance that waits on them. A pixel's sum therefore has one order, whatever the
//! tiles and threads. Secondary rays, when there are any, form the next wave of the same loop.

use glam::Vec3;

use crate::film::{Pixel, View};
use crate::geometry::{Geometry, Hit, Ray};
use crate::intersect::{Coherence, Intersector};
use crate::scene::{FilmSettings, LightKind, RayMaker, Scene};
use crate::shading::{self, Reflectance};
use crate::surface::Surface;

/// Rows of a strip, the unit of work that threads share.
pub const STRIP_ROWS: usize = 16;
/// Columns of a tile; rays of a tile go through the intersector together.
const TILE_COLUMNS: usize = 64;
/// Side of the squares in which a tile's rays are lined up, so that a packet of 16 is a square.
const BLOCK: usize = 4;

/// How many rays were traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// To a light.
    pub shadow: u64,
    /// Off a mirror.
    pub reflection: u64,
    /// Through a surface.
    pub refraction: u64,
}

impl RayCounts {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.reflection + self.refraction
    }
}

/// What was counted while a picture was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rays traced.
    pub rays: RayCounts,
    /// Primary rays that hit something.
    pub hits: u64,
    /// Samples whose radiance was not finite and was left out.
    pub not_finite: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.rays.primary += other.rays.primary;
        self.rays.shadow += other.rays.shadow;
        self.rays.reflection += other.rays.reflection;
        self.rays.refraction += other.rays.refraction;
        self.hits += other.hits;
        self.not_finite += other.not_finite;
    }
}

/// Makes the pixels of one picture.
pub struct Integrator<'a> {
    scene: &'a Scene,
    intersector: &'a dyn Intersector,
    rays: RayMaker,
    view: View,
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
    ) -> Self {
        // Debug views are not averages: one sample.
        let spp = if view == View::Beauty { scene.film.spp } else { 1 };
        let samples = sample_positions(&FilmSettings { spp, ..scene.film.clone() });
        Self { scene, intersector, rays, view, samples }
    }

    /// Makes the rows of the strip that begins at row `first`; `pixels` are whole rows.
    pub fn strip(&self, first: usize, pixels: &mut [Pixel], scratch: &mut Scratch) -> Counts {
        let width = self.scene.film.size[0] as usize;
        let rows = pixels.len() / width;
        let mut counts = Counts::default();
        for left in (0..width).step_by(TILE_COLUMNS) {
            let columns = TILE_COLUMNS.min(width - left);
            scratch.at.clear();
            for y in (0..rows).step_by(BLOCK) {
                for x in (left..left + columns).step_by(BLOCK) {
                    for row in y..(y + BLOCK).min(rows) {
                        let end = (x + BLOCK).min(left + columns);
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
            if radiance.is_finite() {
                let pixel = &mut pixels[at as usize];
                *pixel = (Vec3::from(*pixel) + radiance).to_array();
            } else {
                counts.not_finite += 1;
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
            sample.push(emission);
            if reflectance.diffuse != Vec3::ZERO || reflectance.specular != Vec3::ZERO {
                lit.push((i as u32, surface, reflectance));
            }
        }
        for light in &self.scene.lights {
            if light.kind == LightKind::Ambient {
                for (i, _, reflectance) in lit.iter() {
                    sample[*i as usize] += reflectance.diffuse * light.intensity;
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
                let radiance = share * arrival.intensity;
                if radiance == Vec3::ZERO {
                    continue;
                }
                if light.casts_shadow {
                    shadow.push(surface.shadow_ray(&arrival));
                    waiting.push((*i, radiance));
                } else {
                    sample[*i as usize] += radiance;
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
                    sample[*i as usize] += radiance;
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
            (View::Depth, Some(hit)) => [(hit.t * ray.direction.length()) as f32; 3],
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
