//! Surfaces that illuminate: fixed points of meshes that emit light, each of which stands for a part of
//! the mesh, and spheres that emit light as sphere lights.
//!
//! A part of area a is taken for a disk toward the point that it lights. The form factor of a disk at
//! distance d is cos θ · cos θ' · a / (π d² + a), which stays below 1 however near the disk is (Wallace,
//! Elmquist and Haines, *A Ray Tracing Algorithm for Progressive Radiosity*, SIGGRAPH 1989).

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::geometry::sampling::{sobol_point, triangle_weights};
use crate::geometry::{Hit, PrimitiveId, Side, triangle};
use crate::scene::{IncidentLight, Instance, Light, Material, MaterialId, Scene};
use crate::surface::{self, Surface, TextureContext};

/// The number of points that stand for an emissive object.
const POINTS: usize = 64;
/// The most points that stand for all emissive objects, but for one each.
const MAX_POINTS: usize = 1024;
/// The number of samples of a pixel that have points of their own.
const SETS: u32 = 16;
/// The number of texture lookups for all triangles of an emissive mesh, about, but for a few each.
const LOOKUPS: usize = 1 << 16;

/// A point of a surface that emits light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EmissivePoint {
    position: DVec3,
    /// The normal of the front, of length 1.
    normal: DVec3,
    /// The radiance, linear Rec. 709.
    radiance: Vec3,
    /// The area that it stands for.
    area: f64,
    /// True if the back emits light, too.
    is_two_sided: bool,
}

impl EmissivePoint {
    /// The light that arrives at `point` if nothing blocks it.
    pub fn incident(&self, point: DVec3) -> Option<IncidentLight> {
        let toward = self.position - point;
        let distance_squared = toward.length_squared();
        let slope = -self.normal.dot(toward);
        let slope = if self.is_two_sided { slope.abs() } else { slope };
        if slope <= 0.0 {
            return None;
        }
        let cosine = slope / distance_squared.sqrt();
        let share = cosine * self.area / (PI * distance_squared + self.area);
        Some(IncidentLight { toward, is_bounded: true, intensity: self.radiance * share as f32 })
    }
}

/// The emissive objects of a scene that illuminate others.
#[derive(Debug, Default)]
pub(super) struct EmissiveLights {
    /// The spheres, as lights.
    pub spheres: Vec<Light>,
    /// The points of each mesh: a set for each of some samples of a pixel, one after the other.
    meshes: Vec<Vec<EmissivePoint>>,
    /// The number of sets.
    sets: usize,
}

impl EmissiveLights {
    /// Spreads points over the emissive objects of a scene, for pictures of this many samples per pixel.
    pub fn new(scene: &Scene, pixel_samples: u32) -> Self {
        let is_light = |material: &Material| material.is_light();
        if !scene.materials.iter().any(is_light) {
            return Self { sets: 1, ..Self::default() };
        }
        let of = |id: MaterialId| &scene.materials[id.0 as usize];
        let spheres = scene.spheres.iter().enumerate();
        let spheres: Vec<_> = spheres.filter(|(_, s)| is_light(of(s.material))).collect();
        let instances = scene.instances.iter().enumerate();
        let instances: Vec<_> = instances.filter(|(_, i)| is_light(of(i.material))).collect();
        // Many objects share what points there are.
        let objects = spheres.len() + instances.len();
        let count = (MAX_POINTS / objects.max(1)).clamp(1, POINTS) as u32;
        let sets = pixel_samples.clamp(1, SETS);
        let spheres = spheres.into_iter().map(|(i, sphere)| {
            let emission = mean_of_sphere(scene, i as u32, of(sphere.material));
            let light = Light::sphere(sphere.center, sphere.radius);
            light.with_intensity(emission).with_samples(count)
        });
        let meshes = instances.into_iter().map(|(i, instance)| {
            let mesh = EmissiveMesh::new(scene, i, instance);
            (0..count * sets).filter_map(|k| mesh.point(k, count, sets)).collect()
        });
        Self { spheres: spheres.collect(), meshes: meshes.collect(), sets: sets as usize }
    }

    /// Returns the points for sample `sample` of every pixel.
    pub fn points_of_sample(&self, sample: u32) -> impl Iterator<Item = &EmissivePoint> {
        let set = sample as usize % self.sets;
        self.meshes.iter().flat_map(move |points| {
            let count = points.len() / self.sets;
            points[set * count..][..count].iter()
        })
    }
}

/// An instance that illuminates, with its power summed from triangle to triangle.
pub(super) struct EmissiveMesh<'a> {
    scene: &'a Scene,
    instance: &'a Instance,
    /// The index of the instance.
    index: u32,
    material: &'a Material,
    /// True if its front is where its vertices run clockwise.
    is_mirrored: bool,
    /// The number of lookups for each triangle; 0 if the emission is the same everywhere.
    lookups: u32,
    /// The sums of area times luminance, up to each triangle and with it.
    sums: Vec<f64>,
}

impl<'a> EmissiveMesh<'a> {
    pub fn new(scene: &'a Scene, index: usize, instance: &'a Instance) -> Self {
        let material = &scene.materials[instance.material.0 as usize];
        let triangles = scene.meshes[instance.mesh.0 as usize].triangles.len();
        let varies =
            material.emission_map.is_some() || material.coverage.is_some() || material.unlit;
        let lookups = (LOOKUPS / triangles.max(1)).clamp(4, 256).next_power_of_two() as u32;
        let mut mesh = Self {
            scene,
            instance,
            index: index as u32,
            material,
            is_mirrored: instance.transform.matrix3.determinant() < 0.0,
            lookups: if varies { lookups } else { 0 },
            sums: Vec::new(),
        };
        let power = |triangle: u32| {
            let area = 0.5 * triangle::area_normal(mesh.vertices(triangle)).length();
            let power = area * luminance(mesh.emission(triangle));
            if power.is_finite() { power } else { 0.0 }
        };
        let mut sums: Vec<f64> = (0..triangles as u32).into_par_iter().map(power).collect();
        let mut sum = 0.0;
        for power in &mut sums {
            sum += *power;
            *power = sum;
        }
        mesh.sums = sums;
        mesh
    }

    fn id(&self, triangle: u32) -> PrimitiveId {
        PrimitiveId::triangle(self.instance.mesh.0, triangle, self.index)
    }

    /// Returns the vertices of a triangle.
    pub fn vertices(&self, triangle: u32) -> [DVec3; 3] {
        self.scene.triangle_vertices(self.id(triangle))
    }

    /// Returns the mean radiance of a triangle.
    fn emission(&self, triangle: u32) -> Vec3 {
        if self.lookups == 0 {
            return self.material.emission;
        }
        let lookup = |i: u32| {
            let [u, v] = triangle_weights(sobol_point(i, self.lookups));
            let hit = Hit { t: 0.0, u, v, id: self.id(triangle) };
            emission_at(self.scene, self.material, &hit, DVec3::ZERO)
        };
        let sum: Vec3 = (0..self.lookups).map(lookup).sum();
        sum / self.lookups as f32
    }

    /// Returns its power, as the sum of area times luminance; `None` if it emits nothing, or beyond all bounds.
    pub fn power(&self) -> Option<f64> {
        self.sums.last().copied().filter(|&total| total > 0.0 && total.is_finite())
    }

    /// Returns the triangle in which the sum of power reaches a target, and the place in its own power, from 0 to 1.
    fn triangle_at(&self, target: f64) -> (usize, f64) {
        let triangle = self.sums.partition_point(|&sum| sum <= target).min(self.sums.len() - 1);
        let own = self.own_power(triangle);
        let before = self.sums[triangle] - own;
        let rest = if own > 0.0 { ((target - before) / own).clamp(0.0, 1.0) } else { 0.5 };
        (triangle, rest)
    }

    fn own_power(&self, triangle: usize) -> f64 {
        self.sums[triangle] - if triangle == 0 { 0.0 } else { self.sums[triangle - 1] }
    }

    /// Samples a point in proportion to the power of the triangles, and returns it as a hit, with its position and its
    /// density per unit of area.
    pub fn sample(&self, part: f64, u: [f64; 2]) -> Option<(Hit, DVec3, f64)> {
        let (triangle, _) = self.triangle_at(part * self.power()?);
        let triangle = triangle as u32;
        let [u, v] = triangle_weights(u);
        let position = triangle::point(self.vertices(triangle), u, v);
        Some((Hit { t: 1.0, u, v, id: self.id(triangle) }, position, self.per_area(triangle)))
    }

    /// Returns the density per unit of area of the sampled points of a triangle.
    pub fn per_area(&self, triangle: u32) -> f64 {
        let area = 0.5 * triangle::area_normal(self.vertices(triangle)).length();
        let share = self.own_power(triangle as usize) / self.power().unwrap_or(f64::INFINITY);
        if area > 0.0 { share / area } else { 0.0 }
    }

    /// Returns the radiance that a point emits against a direction; `None` on a side that emits none.
    pub fn radiance(&self, hit: &Hit, direction: DVec3) -> Option<Vec3> {
        let slope = triangle::area_normal(self.vertices(hit.id.primitive)).dot(direction);
        let is_front = (slope < 0.0) != self.is_mirrored;
        let emits = is_front || !self.material.cull_back_faces;
        emits.then(|| emission_at(self.scene, self.material, hit, DVec3::ZERO))
    }

    /// Returns point `index` of all points of some sets of `count`, spread by power; none if the mesh has
    /// none.
    fn point(&self, index: u32, count: u32, sets: u32) -> Option<EmissivePoint> {
        let [x, y] = sobol_point(index, count * sets);
        let total = self.power()?;
        let (triangle, rest) = self.triangle_at(x * total);
        // The point in the triangle, which stands for its part of the power.
        let vertices = self.vertices(triangle as u32);
        let [u, v] = triangle_weights([rest, y]);
        let normal = triangle::area_normal(vertices).normalize_or_zero();
        let radiance = self.emission(triangle as u32);
        Some(EmissivePoint {
            position: triangle::point(vertices, u, v),
            normal: if self.is_mirrored { -normal } else { normal },
            radiance,
            area: total / (luminance(radiance) * f64::from(count)),
            is_two_sided: !self.material.cull_back_faces,
        })
    }
}

/// Returns the mean radiance of a sphere.
pub(super) fn mean_of_sphere(scene: &Scene, index: u32, material: &Material) -> Vec3 {
    if material.emission_map.is_none() && material.coverage.is_none() {
        return material.emission;
    }
    /// The number of lookups.
    const COUNT: u32 = 4096;
    let lookup = |i: u32| {
        // Uniform on the sphere, by its height.
        let [x, y] = sobol_point(i, COUNT);
        let (sin, cos) = (2.0 * PI * x).sin_cos();
        let (height, radius) = (1.0 - 2.0 * y, 2.0 * (y * (1.0 - y)).sqrt());
        let normal = DVec3::new(radius * cos, height, radius * sin);
        let hit = Hit { t: 0.0, u: 0.0, v: 0.0, id: PrimitiveId::sphere(index) };
        emission_at(scene, material, &hit, normal)
    };
    (0..COUNT).map(lookup).sum::<Vec3>() / COUNT as f32
}

/// Returns the radiance that a material emits at a hit, where the surface has this normal.
pub(super) fn emission_at(scene: &Scene, material: &Material, hit: &Hit, normal: DVec3) -> Vec3 {
    let surface = Surface {
        position: DVec3::ZERO,
        geometric_normal: normal,
        normal,
        side: Side::Front,
        material: scene.material_of(hit.id),
        id: hit.id,
    };
    let context = TextureContext::new(scene, hit, &surface, material.is_textured(), None);
    surface::shading_params(scene, material, &context).emission
}

/// Returns the luminance of a colour, linear Rec. 709.
pub(super) fn luminance(color: Vec3) -> f64 {
    let [r, g, b] = color.to_array().map(f64::from);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
