//! The choice of light that shines on a surface, and its density, for next-event estimation.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::geometry::{Geometry, Hit, triangle};
use crate::integrator::emissive_lights::{EmissiveMesh, emission_at, luminance, mean_of_sphere};
use crate::scene::{Environment, Light, LightKind, LightShape, Material, Scene};
use crate::surface::Surface;

/// The share of samples that go to all sources alike, whatever their power.
const EVEN_SHARE: f64 = 0.1;

/// A source of light.
enum Source<'a> {
    Light(&'a Light),
    Sphere { light: Light, index: u32 },
    Mesh(EmissiveMesh<'a>),
    Environment(&'a Environment),
}

/// The sources of light of a scene, each with the probability with which it is chosen.
pub struct LightSampler<'a> {
    scene: &'a Scene,
    sources: Vec<Source<'a>>,
    /// The probabilities.
    shares: Vec<f64>,
    /// Their sums up to each.
    sums: Vec<f64>,
    /// The source that each sphere, and each instance, is.
    of_sphere: Vec<Option<u32>>,
    of_instance: Vec<Option<u32>>,
    of_environment: Option<usize>,
}

/// A direction to a light.
pub struct LightSample {
    /// The vector to the light, of any length.
    pub toward: DVec3,
    /// True if the light is at its end.
    pub is_bounded: bool,
    /// The radiance divided by the density: f |cos θ| times this is the sample's value.
    pub weighted: Vec3,
    /// The density per steradian; 0 for a light that no scattered ray meets.
    pub pdf: f64,
    /// True if it casts shadows.
    pub casts_shadow: bool,
}

impl<'a> LightSampler<'a> {
    /// The sources of a scene.
    pub fn new(scene: &'a Scene) -> Self {
        let bounds = scene.bounds();
        let (center, radius) = (bounds.center(), 0.5 * (bounds.upper - bounds.lower).length());
        let radius = if radius.is_finite() && radius > 0.0 { radius } else { 1.0 };
        let mut found = Self {
            scene,
            sources: Vec::new(),
            shares: Vec::new(),
            sums: Vec::new(),
            of_sphere: vec![None; scene.spheres.len()],
            of_instance: vec![None; scene.instances.len()],
            of_environment: None,
        };
        // Each source with the irradiance that it gives, about.
        let mut powers = Vec::new();
        for light in scene.lights.iter().filter(|light| light.kind != LightKind::Ambient) {
            let source = found.sources.len() as u32;
            match light.shape {
                Some(LightShape::Sphere(i)) => found.of_sphere[i as usize] = Some(source),
                Some(LightShape::Instance(i)) => found.of_instance[i as usize] = Some(source),
                None => {}
            }
            powers.push(light_power(light, center, radius));
            found.sources.push(Source::Light(light));
        }
        found.add_surfaces(radius, &mut powers);
        if let Some(environment) = &scene.environment {
            found.of_environment = Some(found.sources.len());
            found.sources.push(Source::Environment(environment));
            powers.push(PI * environment.distribution().mean() * luminance(environment.intensity));
        }
        found.set_shares(&powers);
        found
    }

    /// Adds the spheres and meshes that emit light.
    fn add_surfaces(&mut self, radius: f64, powers: &mut Vec<f64>) {
        let scene = self.scene;
        let emits = |material: &Material| material.emission != Vec3::ZERO && !material.unlit;
        let at_distance = |area: f64| area / (radius * radius);
        for (i, sphere) in scene.spheres.iter().enumerate() {
            let material = &scene.materials[sphere.material.0 as usize];
            if emits(material) && self.of_sphere[i].is_none() {
                let emission = mean_of_sphere(scene, i as u32, material);
                let light = Light::sphere(sphere.center, sphere.radius).with_intensity(emission);
                self.of_sphere[i] = Some(self.sources.len() as u32);
                powers.push(luminance(emission) * at_distance(PI * sphere.radius * sphere.radius));
                self.sources.push(Source::Sphere { light, index: i as u32 });
            }
        }
        for (i, instance) in scene.instances.iter().enumerate() {
            let material = &scene.materials[instance.material.0 as usize];
            if emits(material) && self.of_instance[i].is_none() {
                let mesh = EmissiveMesh::new(scene, i, instance);
                if let Some(power) = mesh.power() {
                    self.of_instance[i] = Some(self.sources.len() as u32);
                    powers.push(at_distance(power));
                    self.sources.push(Source::Mesh(mesh));
                }
            }
        }
    }

    fn set_shares(&mut self, powers: &[f64]) {
        let usable = |power: &f64| if power.is_finite() { power.max(0.0) } else { 0.0 };
        let sum: f64 = powers.iter().map(usable).sum();
        let count = powers.len() as f64;
        let share = |power: &f64| {
            let by_power = if sum > 0.0 { usable(power) / sum } else { 1.0 / count };
            (1.0 - EVEN_SHARE) * by_power + EVEN_SHARE / count
        };
        self.shares = powers.iter().map(share).collect();
        let mut sum = 0.0;
        for share in &self.shares {
            sum += share;
            self.sums.push(sum);
        }
    }

    /// Samples a direction to a light from a point: `choice` chooses the light, `part` a part of it, and `u` the
    /// direction. `None` where no light arrives.
    pub fn sample(&self, point: DVec3, choice: f64, part: f64, u: [f64; 2]) -> Option<LightSample> {
        let last = self.sources.len().checked_sub(1)?;
        let index = self.sums.partition_point(|&sum| sum <= choice).min(last);
        let share = self.shares[index];
        match &self.sources[index] {
            Source::Light(light) => {
                let (incident, pdf) = if light.has_extent() {
                    let sample = light.sample(point, u)?;
                    // A light that is not seen is not met by scattered rays.
                    (sample.incident, if light.shape.is_some() { sample.pdf * share } else { 0.0 })
                } else {
                    (light.incident(point)?, 0.0)
                };
                Some(LightSample {
                    toward: incident.toward,
                    is_bounded: incident.is_bounded,
                    weighted: incident.intensity * (PI / share) as f32,
                    pdf,
                    casts_shadow: light.casts_shadow(),
                })
            }
            Source::Sphere { light, index } => {
                let sample = light.sample(point, u)?;
                let toward = sample.incident.toward;
                let sphere = &self.scene.spheres[*index as usize];
                let normal = (point + toward - sphere.center).normalize_or(DVec3::Y);
                let material = &self.scene.materials[sphere.material.0 as usize];
                let hit = Hit {
                    t: 1.0,
                    u: 0.0,
                    v: 0.0,
                    id: crate::geometry::PrimitiveId::sphere(*index),
                };
                let radiance = emission_at(self.scene, material, &hit, normal);
                let pdf = sample.pdf * share;
                let weighted = radiance * (1.0 / pdf) as f32;
                Some(LightSample { toward, is_bounded: true, weighted, pdf, casts_shadow: true })
            }
            Source::Mesh(mesh) => {
                let (hit, position, per_area) = mesh.sample(part, u)?;
                let toward = position - point;
                let pdf =
                    per_area * per_steradian(&mesh.vertices(hit.id.primitive), toward)? * share;
                let radiance = mesh.radiance(&hit, toward)?;
                let weighted = radiance * (1.0 / pdf) as f32;
                Some(LightSample { toward, is_bounded: true, weighted, pdf, casts_shadow: true })
            }
            Source::Environment(environment) => {
                let (toward, pdf) = environment.sample(u);
                let pdf = pdf * share;
                let weighted = environment.radiance(toward) * (1.0 / pdf) as f32;
                Some(LightSample { toward, is_bounded: false, weighted, pdf, casts_shadow: true })
            }
        }
    }

    /// Returns the density per steradian with which [`sample`](Self::sample) returns, from a point, the direction in
    /// which a ray hit a surface: 0 if that is no source.
    pub fn pdf_of_hit(&self, point: DVec3, direction: DVec3, hit: &Hit, surface: &Surface) -> f64 {
        let source = match hit.id.geometry {
            Geometry::Spheres => self.of_sphere[hit.id.primitive as usize],
            Geometry::Planes => None,
            Geometry::Mesh(_) => self.of_instance[hit.id.instance as usize],
        };
        let Some(source) = source else { return 0.0 };
        let share = self.shares[source as usize];
        let pdf = match &self.sources[source as usize] {
            Source::Light(light) => light.pdf(point, direction),
            Source::Sphere { light, .. } => light.pdf(point, direction),
            Source::Mesh(mesh) => {
                let vertices = mesh.vertices(hit.id.primitive);
                let density = per_steradian(&vertices, surface.position - point);
                mesh.per_area(hit.id.primitive) * density.unwrap_or(0.0)
            }
            Source::Environment(_) => 0.0,
        };
        pdf * share
    }

    /// Returns the density per steradian of a direction of length 1 to the environment.
    pub fn pdf_of_environment(&self, direction: DVec3) -> f64 {
        match self.of_environment.map(|i| (&self.sources[i], self.shares[i])) {
            Some((Source::Environment(environment), share)) => environment.pdf(direction) * share,
            _ => 0.0,
        }
    }
}

/// Returns what a density per area is multiplied by to be one per steradian, at the end of a vector to a triangle:
/// d² / |cos θ|. `None` along the triangle's plane.
fn per_steradian(vertices: &[DVec3; 3], toward: DVec3) -> Option<f64> {
    let normal = triangle::area_normal(*vertices).normalize_or_zero();
    let square = toward.length_squared();
    let cosine = (normal.dot(toward) / square.sqrt()).abs();
    (cosine > 1e-9).then(|| square / cosine)
}

/// Returns the irradiance, about, that a light gives at the distance of a scene's radius.
fn light_power(light: &Light, center: DVec3, radius: f64) -> f64 {
    let radiance = luminance(light.intensity);
    let area = match light.kind {
        LightKind::Ambient | LightKind::Directional { .. } => return PI * radiance,
        LightKind::Point { .. } | LightKind::Spot { .. } => {
            // As it is at a point to the side of the middle, which it may stand in.
            let toward = (center - light.position().unwrap_or(center)).normalize_or(DVec3::Y);
            let at = light.position().unwrap_or(center) + toward * radius;
            let incident = light.incident(at);
            return PI * incident.map_or(radiance, |incident| luminance(incident.intensity));
        }
        LightKind::Rectangle { u, v, .. } => 4.0 * u.length() * v.length(),
        LightKind::Disk { radius, .. } | LightKind::Sphere { radius, .. } => PI * radius * radius,
    };
    radiance * area / (radius * radius)
}
