//! The choice of light that shines on a surface, and its density, for next-event estimation.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::geometry::{Geometry, Hit, PrimitiveId, triangle};
use crate::integrator::emissive_lights::{EmissiveMesh, emission_at, luminance, mean_of_sphere};
use crate::scene::{Environment, Falloff, Light, LightKind, LightShape, Material, Scene};
use crate::surface::Surface;

/// The share of samples that go to all sources alike, whatever their importance.
const EVEN_SHARE: f64 = 0.1;
/// The most sources of which one is chosen by the point that they shine on.
const MAX_LOCAL: usize = 64;

/// A source of light.
enum Source<'a> {
    Light(&'a Light),
    Sphere { light: Light, index: u32 },
    Mesh(EmissiveMesh<'a>),
    Environment(&'a Environment),
}

/// The importance of a source, by which it is chosen: about the irradiance that it gives.
#[derive(Clone, Copy)]
enum Importance {
    /// The irradiance that it gives everywhere.
    Even(f64),
    /// The irradiance that it gives at a distance of 1 from its middle, within some radius of which it is.
    Near { power: f64, center: DVec3, radius: f64, front: Option<DVec3> },
}

impl Importance {
    /// Returns about the irradiance at a point.
    fn at(&self, point: DVec3) -> f64 {
        match *self {
            Self::Even(irradiance) => irradiance,
            Self::Near { power, center, radius, front } => {
                let away = point - center;
                let square = away.length_squared();
                // Nothing of it shines backward.
                let shines = front.is_none_or(|normal| normal.dot(away) > 0.0);
                let found = power / (square + radius * radius).max(f64::MIN_POSITIVE);
                if shines && found.is_finite() { found } else { 0.0 }
            }
        }
    }
}

/// The sources of light of a scene, each with the probability with which it is chosen.
pub struct LightSampler<'a> {
    scene: &'a Scene,
    sources: Vec<Source<'a>>,
    importances: Vec<Importance>,
    /// The probabilities, the same everywhere, and their sums up to each, of a scene with many sources; else empty.
    shares: Vec<f64>,
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
            importances: Vec::new(),
            shares: Vec::new(),
            sums: Vec::new(),
            of_sphere: vec![None; scene.spheres.len()],
            of_instance: vec![None; scene.instances.len()],
            of_environment: None,
        };
        for light in scene.lights.iter().filter(|light| light.kind != LightKind::Ambient) {
            let source = found.sources.len() as u32;
            match light.shape {
                Some(LightShape::Sphere(i)) => found.of_sphere[i as usize] = Some(source),
                Some(LightShape::Instance(i)) => found.of_instance[i as usize] = Some(source),
                None => {}
            }
            found.importances.push(importance_of_light(light));
            found.sources.push(Source::Light(light));
        }
        found.add_surfaces();
        if let Some(environment) = &scene.environment {
            found.of_environment = Some(found.sources.len());
            found.sources.push(Source::Environment(environment));
            let mean = environment.distribution().mean() * luminance(environment.intensity);
            found.importances.push(Importance::Even(PI * mean));
        }
        if found.sources.len() > MAX_LOCAL {
            // As it is to the side of the middle, at the distance of the scene's radius.
            let side = center + DVec3::new(radius, 0.0, 0.0);
            found.shares = found.shares_at(side).collect();
            found.sums = sums(&found.shares);
        }
        found
    }

    /// Adds the spheres and meshes that emit light.
    fn add_surfaces(&mut self) {
        let scene = self.scene;
        let emits = |material: &Material| material.emission != Vec3::ZERO && !material.unlit;
        for (i, sphere) in scene.spheres.iter().enumerate() {
            let material = &scene.materials[sphere.material.0 as usize];
            if emits(material) && self.of_sphere[i].is_none() {
                let emission = mean_of_sphere(scene, i as u32, material);
                let light = Light::sphere(sphere.center, sphere.radius).with_intensity(emission);
                self.of_sphere[i] = Some(self.sources.len() as u32);
                self.importances.push(importance_of_light(&light));
                self.sources.push(Source::Sphere { light, index: i as u32 });
            }
        }
        for (i, instance) in scene.instances.iter().enumerate() {
            let material = &scene.materials[instance.material.0 as usize];
            if emits(material) && self.of_instance[i].is_none() {
                let mesh = EmissiveMesh::new(scene, i, instance);
                if let Some(power) = mesh.power() {
                    let bounds = scene.meshes[instance.mesh.0 as usize].bounds();
                    let bounds = bounds.transformed(&instance.transform);
                    let radius = 0.5 * (bounds.upper - bounds.lower).length();
                    let center = bounds.center();
                    self.of_instance[i] = Some(self.sources.len() as u32);
                    // A half of a closed surface faces any point.
                    let power = 0.5 * power;
                    self.importances.push(Importance::Near { power, center, radius, front: None });
                    self.sources.push(Source::Mesh(mesh));
                }
            }
        }
    }

    /// Returns the probabilities with which the sources are chosen for a point.
    fn shares_at(&self, point: DVec3) -> impl Iterator<Item = f64> {
        let sum: f64 = self.importances.iter().map(|importance| importance.at(point)).sum();
        let even = 1.0 / self.importances.len() as f64;
        self.importances.iter().map(move |importance| {
            let own = if sum > 0.0 { importance.at(point) / sum } else { even };
            (1.0 - EVEN_SHARE) * own + EVEN_SHARE * even
        })
    }

    /// Returns the probability with which a source is chosen for a point.
    fn share_at(&self, index: usize, point: DVec3) -> f64 {
        match self.shares.get(index) {
            Some(share) => *share,
            None => self.shares_at(point).nth(index).unwrap_or(0.0),
        }
    }

    /// Chooses a source for a point, and returns it with its probability.
    fn choose(&self, point: DVec3, choice: f64) -> Option<(usize, f64)> {
        let last = self.sources.len().checked_sub(1)?;
        if !self.sums.is_empty() {
            let index = self.sums.partition_point(|&sum| sum <= choice).min(last);
            return Some((index, self.shares[index]));
        }
        let mut sum = 0.0;
        let mut chosen = None;
        for (index, share) in self.shares_at(point).enumerate() {
            if share > 0.0 && (chosen.is_none() || choice >= sum) {
                chosen = Some((index, share));
            }
            sum += share;
        }
        chosen
    }

    /// Samples a direction to a light from a point: `choice` chooses the light, `part` a part of it, and `u` the
    /// direction. `None` where no light arrives.
    pub fn sample(&self, point: DVec3, choice: f64, part: f64, u: [f64; 2]) -> Option<LightSample> {
        let (index, share) = self.choose(point, choice)?;
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
                let hit = Hit { t: 1.0, u: 0.0, v: 0.0, id: PrimitiveId::sphere(*index) };
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
        let share = self.share_at(source as usize, point);
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

    /// Returns the density per steradian, at a point, of a direction of length 1 to the environment.
    pub fn pdf_of_environment(&self, point: DVec3, direction: DVec3) -> f64 {
        match self.of_environment.map(|index| (index, &self.sources[index])) {
            Some((index, Source::Environment(environment))) => {
                environment.pdf(direction) * self.share_at(index, point)
            }
            _ => 0.0,
        }
    }
}

/// Returns the sums up to each of some numbers.
fn sums(numbers: &[f64]) -> Vec<f64> {
    let add = |sum: &mut f64, number: &f64| {
        *sum += number;
        Some(*sum)
    };
    numbers.iter().scan(0.0, add).collect()
}

/// Returns what a density per area is multiplied by to be one per steradian, at the end of a vector to a triangle:
/// d² / |cos θ|. `None` along the triangle's plane.
fn per_steradian(vertices: &[DVec3; 3], toward: DVec3) -> Option<f64> {
    let normal = triangle::area_normal(*vertices).normalize_or_zero();
    let square = toward.length_squared();
    let cosine = (normal.dot(toward) / square.sqrt()).abs();
    (cosine > 1e-9).then(|| square / cosine)
}

/// Returns the importance of a light.
fn importance_of_light(light: &Light) -> Importance {
    let radiance = luminance(light.intensity);
    match light.kind {
        LightKind::Ambient | LightKind::Directional { .. } => Importance::Even(PI * radiance),
        LightKind::Point { position, falloff, .. } | LightKind::Spot { position, falloff, .. } => {
            match falloff {
                Falloff::None => Importance::Even(PI * radiance),
                Falloff::InverseSquare => Importance::Near {
                    power: PI * radiance,
                    center: position,
                    radius: 0.0,
                    front: None,
                },
            }
        }
        LightKind::Rectangle { center, u, v } => Importance::Near {
            power: radiance * 4.0 * u.length() * v.length(),
            center,
            radius: u.length().max(v.length()),
            front: Some(u.cross(v)),
        },
        LightKind::Disk { center, normal, radius } => Importance::Near {
            power: radiance * PI * radius * radius,
            center,
            radius,
            front: Some(normal),
        },
        LightKind::Sphere { center, radius } => {
            let power = radiance * PI * radius * radius;
            Importance::Near { power, center, radius, front: None }
        }
    }
}
