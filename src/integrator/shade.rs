//! What the lights and the surfaces themselves give to the rays of a wave.

use glam::{DVec3, Vec3};

use crate::geometry::{Geometry, Ray};
use crate::integrator::bodies::Interiors;
use crate::integrator::counts::Cause;
use crate::integrator::{Counts, Integrator, Wave};
use crate::intersect::Coherence;
use crate::scene::{LightKind, Material, TextureId};
use crate::shading::{self, Reflectance};
use crate::surface::Surface;

/// The light that a wave's rays bring back, and what it takes to work it out.
#[derive(Default)]
pub(super) struct Light {
    /// The radiance along each ray, but for what mirrors and glass show.
    pub radiance: Vec<Vec3>,
    /// Rays of which the radiance is not finite, and is NaN here, with what made it so.
    pub spoilt: Vec<(u32, Cause)>,
    /// The mirrors and the glass that were hit, by ray.
    pub bounces: Vec<(u32, Surface)>,
    lit: Vec<(u32, Surface, Reflectance)>,
    shadow: Shadows,
}

/// Shadow rays, side by side with what waits on them.
#[derive(Default)]
pub(super) struct Shadows {
    /// From the surfaces to one light.
    pub rays: Vec<Ray>,
    /// What each begins in; empty where the scene has nothing that lets light through.
    pub inside: Vec<Interiors>,
    waiting: Vec<(u32, Vec3)>,
    /// Whether anything stands in the way.
    pub blocked: Vec<bool>,
    /// What is left of the light where glass stands in the way.
    pub left: Vec<DVec3>,
}

/// The radiance that a light gives of which the arrival is not finite; no finite factors make NaN.
const NO_LIGHT: Vec3 = Vec3::NAN;

impl Integrator<'_> {
    /// Works out the radiance along each ray of a wave.
    pub(super) fn shade(&self, wave: &Wave, light: &mut Light, counts: &mut Counts) {
        self.meet(wave, light);
        let Light { radiance, spoilt, lit, shadow, .. } = light;
        let mut sum = |i: u32, with: Vec3| add(i, radiance, with, spoilt);
        for light in &self.scene.lights {
            if light.kind == LightKind::Ambient {
                for (i, _, reflectance) in lit.iter() {
                    sum(*i, reflectance.diffuse * light.intensity);
                }
                continue;
            }
            shadow.clear();
            for (i, surface, reflectance) in lit.iter() {
                let Some(arrival) = light.arrival(surface.position) else { continue };
                // On a smooth-shaded mesh the shading normal may see a light that is behind the
                // surface itself.
                let behind = matches!(surface.id.geometry, Geometry::Mesh(_))
                    && surface.facing_normal().dot(arrival.toward) <= 0.0;
                if behind {
                    continue;
                }
                let view = wave.rays[*i as usize].direction;
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
                if !light.casts_shadow() {
                    sum(*i, radiance);
                    continue;
                }
                let ray = surface.shadow_ray(&arrival);
                if self.transmits {
                    let inside = &wave.paths[*i as usize].inside;
                    shadow.inside.push(self.starts_in(surface, &ray, inside));
                }
                shadow.rays.push(ray);
                shadow.waiting.push((*i, radiance));
            }
            if shadow.rays.is_empty() {
                continue;
            }
            shadow.blocked.clear();
            shadow.blocked.resize(shadow.rays.len(), false);
            self.intersector.occluded(&shadow.rays, Coherence::Coherent, &mut shadow.blocked);
            counts.rays.shadow += shadow.rays.len() as u64;
            if self.transmits {
                self.let_through(light.shadow, shadow, counts);
                for (&(i, radiance), &left) in shadow.waiting.iter().zip(&shadow.left) {
                    if left != DVec3::ZERO {
                        sum(i, (radiance.as_dvec3() * left).as_vec3());
                    }
                }
                continue;
            }
            for ((i, radiance), blocked) in shadow.waiting.iter().zip(&shadow.blocked) {
                if !blocked {
                    sum(*i, *radiance);
                }
            }
        }
    }

    /// What the rays meet: background, emission, the surfaces to be lit, mirrors and glass.
    fn meet(&self, wave: &Wave, light: &mut Light) {
        let Light { radiance, spoilt, bounces, lit, .. } = light;
        radiance.clear();
        spoilt.clear();
        bounces.clear();
        lit.clear();
        for (i, (ray, hit)) in wave.rays.iter().zip(&wave.hits).enumerate() {
            let Some(hit) = hit else {
                radiance.push(self.scene.film.background);
                continue;
            };
            let surface = Surface::new(self.scene, ray, hit);
            let material = &self.scene.materials[surface.material.0 as usize];
            let (emission, reflectance) = self.colors(&surface, material);
            let colors = emission.is_finite() && reflectance.diffuse.is_finite();
            if !(colors && surface.position.is_finite()) {
                radiance.push(Vec3::ZERO);
                spoil(i as u32, &mut radiance[i], Cause::Surface, spoilt);
                continue;
            }
            radiance.push(emission);
            if reflectance.diffuse != Vec3::ZERO || reflectance.specular != Vec3::ZERO {
                lit.push((i as u32, surface, reflectance));
            }
            if self.follows && material.is_followed() {
                bounces.push((i as u32, surface));
            }
        }
    }

    /// Emission and reflectance at a point, with textures, vertex colours and checker applied;
    /// what is seen in it and through it takes its shares of the reflectance.
    fn colors(&self, surface: &Surface, material: &Material) -> (Vec3, Reflectance) {
        let texture = |map: Option<TextureId>| {
            map.map_or(Vec3::ONE, |id| self.scene.textures[id.0 as usize].color(surface.uv))
        };
        let diffuse = surface.checker.unwrap_or(material.diffuse);
        let mut reflectance = Reflectance {
            diffuse: diffuse * texture(material.diffuse_map) * surface.tint,
            specular: material.specular,
            shininess: material.shininess,
        };
        if self.follows && material.is_followed() {
            let rest = (Vec3::ONE - material.reflect - material.transmit).max(Vec3::ZERO);
            reflectance.diffuse *= rest;
            reflectance.specular *= rest;
        }
        let emission = if material.emission == Vec3::ZERO {
            Vec3::ZERO
        } else {
            material.emission * texture(material.emission_map)
        };
        (emission, reflectance)
    }
}

impl Shadows {
    fn clear(&mut self) {
        self.rays.clear();
        self.inside.clear();
        self.waiting.clear();
    }
}

/// Adds to the radiance along ray `i`, unless it is spoilt already.
#[inline(always)]
fn add(i: u32, radiance: &mut [Vec3], with: Vec3, spoilt: &mut Vec<(u32, Cause)>) {
    let to = &mut radiance[i as usize];
    let sum = *to + with;
    if sum.is_finite() {
        *to = sum;
    } else if with.is_nan() {
        spoil(i, to, Cause::Light, spoilt);
    } else {
        spoil(i, to, Cause::Sum, spoilt);
    }
}

/// Makes the radiance along ray `i` NaN, so that it stays out of the picture, and keeps what did
/// it first.
#[cold]
fn spoil(i: u32, radiance: &mut Vec3, cause: Cause, spoilt: &mut Vec<(u32, Cause)>) {
    if !radiance.is_nan() {
        spoilt.push((i, cause));
    }
    *radiance = Vec3::NAN;
}
