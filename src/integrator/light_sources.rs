//! The sources of light of a scene: its lights, and the samples that stand for those with an extent.
//!
//! The samples are fixed: those for one sample of a pixel are the same for all pixels, so that there is
//! no noise, and those for its next sample lie between them. Sobol's sequence has both.

use glam::DVec3;

use crate::geometry::sampling::sobol_point;
use crate::integrator::counts::FeatureCounts;
use crate::integrator::emissive_lights::{EmissiveLights, EmissivePoint};
use crate::scene::{IncidentLight, Light, Scene, Shadow};

/// A light, or one of the samples that stand for a light with an extent.
#[derive(Clone, Copy)]
pub(super) enum LightSource<'a> {
    /// A light without an extent.
    Light(&'a Light),
    /// A sample of a light with an extent.
    Sample {
        /// The light.
        light: &'a Light,
        /// The sample's point of the unit square.
        u: [f64; 2],
        /// The share of the light that the sample stands for.
        share: f32,
        /// True if the light is an emissive sphere.
        is_emissive: bool,
    },
    /// A point of a surface that emits light.
    Emissive(&'a EmissivePoint),
}

impl LightSource<'_> {
    /// The light that arrives at `point` if nothing blocks it.
    pub fn incident(&self, point: DVec3) -> Option<IncidentLight> {
        match self {
            Self::Light(light) => light.incident(point),
            Self::Sample { light, u, share, .. } => {
                let incident = light.sample(point, *u)?.incident;
                Some(IncidentLight { intensity: incident.intensity * *share, ..incident })
            }
            Self::Emissive(emissive) => emissive.incident(point),
        }
    }

    /// The shadows that it casts.
    pub fn shadow(&self) -> Shadow {
        match self {
            Self::Light(light) | Self::Sample { light, .. } => light.shadow,
            Self::Emissive(_) => Shadow::Tinted,
        }
    }

    /// True if it casts shadows.
    pub fn casts_shadow(&self) -> bool {
        match self {
            Self::Light(light) | Self::Sample { light, .. } => light.casts_shadow(),
            Self::Emissive(_) => true,
        }
    }

    /// True if shadow rays end at it.
    pub fn is_bounded(&self) -> bool {
        match self {
            Self::Light(light) | Self::Sample { light, .. } => light.is_bounded(),
            Self::Emissive(_) => true,
        }
    }

    /// Counts the points that a sample has lit.
    pub fn count(&self, points: u64, counts: &mut FeatureCounts) {
        match self {
            Self::Light(_) => {}
            Self::Sample { is_emissive: false, .. } => counts.area_lights += points,
            Self::Sample { is_emissive: true, .. } | Self::Emissive(_) => {
                counts.emissive_lights += points;
            }
        }
    }
}

/// The lights of a scene, with all that illuminates.
pub(super) struct LightSources<'a> {
    lights: &'a [Light],
    emissive: EmissiveLights,
    /// The number of samples of a pixel.
    pixel_samples: u32,
}

impl<'a> LightSources<'a> {
    /// No sources.
    pub fn none() -> Self {
        Self { lights: &[], emissive: EmissiveLights::default(), pixel_samples: 1 }
    }

    /// The sources of a scene, for pictures of this many samples per pixel.
    pub fn new(scene: &'a Scene, pixel_samples: usize) -> Self {
        let pixel_samples = pixel_samples as u32;
        let emissive = EmissiveLights::new(scene, pixel_samples);
        Self { lights: &scene.lights, emissive, pixel_samples }
    }

    /// Returns the sources for sample `sample` of every pixel: first the lights without an extent, in
    /// the scene's order, and then the samples of all others.
    pub fn of_sample(&self, sample: usize) -> impl Iterator<Item = LightSource<'_>> {
        let plain = self.lights.iter().filter(|light| !light.has_extent()).map(LightSource::Light);
        let (sample, total) = (sample as u32, self.pixel_samples);
        let lights = self.lights.iter().filter(|light| light.has_extent());
        let lights = lights.map(|light| (light, false));
        let lights = lights.chain(self.emissive.spheres.iter().map(|light| (light, true)));
        let samples = lights.flat_map(move |(light, is_emissive)| {
            let count = light.samples;
            let share = 1.0 / count as f32;
            (0..count).map(move |i| {
                let u = sobol_point(sample * count + i, total * count);
                LightSource::Sample { light, u, share, is_emissive }
            })
        });
        let points = self.emissive.points_of_sample(sample).map(LightSource::Emissive);
        plain.chain(samples).chain(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the points of the square of sample `sample` of a scene with one disk of 16 samples.
    fn points(sample: usize, pixel_samples: usize) -> Vec<[f64; 2]> {
        let mut scene = Scene::default();
        scene.lights.push(Light::point(DVec3::ZERO));
        scene.lights.push(Light::disk(DVec3::ZERO, DVec3::Y, 1.0));
        scene.lights.push(Light::point(DVec3::ZERO));
        let sources = LightSources::new(&scene, pixel_samples);
        let of_disk = |source: LightSource<'_>| match source {
            LightSource::Sample { u, .. } => Some(u),
            _ => None,
        };
        let all: Vec<_> = sources.of_sample(sample).collect();
        assert!(
            all.len() == 18
                && all[..2].iter().all(|source| matches!(source, LightSource::Light(_)))
        );
        all.into_iter().filter_map(of_disk).collect()
    }

    #[test]
    fn the_samples_of_a_pixel_are_together_one_even_set() {
        // Sixteen samples of sixteen points: one in each cell of a grid of sixteen by sixteen.
        let mut cells = vec![0; 256];
        for sample in 0..16 {
            for [x, y] in points(sample, 16) {
                let [x, y] = [x, y].map(|x| (x * 16.0) as usize);
                cells[y * 16 + x] += 1;
            }
        }
        assert!(cells.iter().all(|&n| n == 1));
        // A single sample has its points in the middle of their strata.
        let mut columns: Vec<f64> = points(0, 1).iter().map(|u| u[0] * 16.0).collect();
        columns.sort_by(f64::total_cmp);
        let middles: Vec<f64> = (0..16).map(|i| f64::from(i) + 0.5).collect();
        assert_eq!(columns, middles);
    }
}
