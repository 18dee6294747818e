//! The counters of rays and of work.

use serde::Serialize;

use crate::geometry::RayBatch;
use crate::integrator::sample_pattern::MAX_STEPS;
use crate::scene::Scene;

/// The numbers of rays traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RayCounts {
    /// Rays from the camera.
    pub primary: u64,
    /// Rays to a light.
    pub shadow: u64,
    /// Rays off a mirror.
    pub reflection: u64,
    /// Rays through a surface.
    pub refraction: u64,
}

impl RayCounts {
    /// Returns the number of all rays.
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.reflection + self.refraction
    }
}

/// The amounts of work that not every picture needs. Exactly 0 means that the code for it did not
/// run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FeatureCounts {
    /// Points whose texture coordinates were computed.
    pub uv: u64,
    /// Points whose footprint was computed, for the level of a mipmap.
    pub mipmaps: u64,
    /// Points whose normal was looked up in a normal map.
    pub normal_maps: u64,
    /// Points of planes whose checker was evaluated.
    pub checkers: u64,
    /// Points of meshes whose vertex colours were interpolated.
    pub vertex_colors: u64,
    /// Points of meshes whose vertex normals were interpolated.
    pub smooth_normals: u64,
    /// Highlights that were computed, sixteen at a time: lanes without one count.
    pub highlights: u64,
    /// Shadow rays that were traced again, through glass.
    pub glass: u64,
    /// Blocks of sixteen rays that were tested against planes.
    pub planes: u64,
    /// Blocks of sixteen rays whose hits in Embree were tested by a filter.
    pub filters: u64,
    /// Hits on one-sided surfaces, whose side was looked at.
    pub culling: u64,
    /// Points on which light of a sample of a light with an extent fell, sixteen at a time.
    pub area_lights: u64,
    /// Points on which light of a point of an emissive surface fell, sixteen at a time.
    pub emissive_lights: u64,
    /// Points whose BSDF was evaluated.
    pub pbr: u64,
    /// Rays that see the environment, and points that it lights.
    pub environment: u64,
}

impl FeatureCounts {
    /// Counts the tests of rays against planes, and those by a filter, if there are any.
    pub(super) fn add_extra_tests(&mut self, scene: &Scene, has_filter: bool, rays: &RayBatch) {
        let blocks = rays.blocks().len() as u64;
        self.planes += blocks * u64::from(!scene.planes.is_empty());
        self.filters += blocks * u64::from(has_filter);
    }
}

/// The counters of one picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// The rays traced.
    pub rays: RayCounts,
    /// The primary rays that hit something.
    pub hits: u64,
    /// The pixels that got more samples, at each step of an adaptive picture.
    pub refined: [u64; MAX_STEPS],
    /// The work that not every picture needs.
    pub work: FeatureCounts,
    /// The samples whose radiance was not finite and was left out.
    pub not_finite: NotFinite,
    /// The rays that were cut off because they had gone straight through too many surfaces.
    pub beyond_layers: u64,
}

/// The numbers of samples whose radiance was not finite, by its cause: each counts once, for the
/// first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct NotFinite {
    /// The light that arrives at the surface: a light with inverse-square falloff is very near it.
    pub light: u64,
    /// The surface itself: its position, or the colour that its material, textures and vertex
    /// colours give it.
    pub surface: u64,
    /// Finite values whose product or sum is beyond f32.
    pub sum: u64,
}

impl NotFinite {
    /// Returns the number of all such samples.
    pub fn total(&self) -> u64 {
        self.light + self.surface + self.sum
    }
}

/// A cause of a sample's radiance not being finite; see [`NotFinite`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NotFiniteCause {
    Light,
    Surface,
    Sum,
}

impl NotFiniteCause {
    /// Counts a sample.
    pub(super) fn count(self, counts: &mut Counts) {
        let not_finite = &mut counts.not_finite;
        *match self {
            NotFiniteCause::Light => &mut not_finite.light,
            NotFiniteCause::Surface => &mut not_finite.surface,
            NotFiniteCause::Sum => &mut not_finite.sum,
        } += 1;
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.rays.primary += other.rays.primary;
        self.rays.shadow += other.rays.shadow;
        self.rays.reflection += other.rays.reflection;
        self.rays.refraction += other.rays.refraction;
        self.hits += other.hits;
        self.refined.iter_mut().zip(other.refined).for_each(|(count, other)| *count += other);
        self.work += other.work;
        self.not_finite.light += other.not_finite.light;
        self.not_finite.surface += other.not_finite.surface;
        self.not_finite.sum += other.not_finite.sum;
        self.beyond_layers += other.beyond_layers;
    }
}

impl std::ops::AddAssign for FeatureCounts {
    fn add_assign(&mut self, other: Self) {
        self.uv += other.uv;
        self.mipmaps += other.mipmaps;
        self.normal_maps += other.normal_maps;
        self.checkers += other.checkers;
        self.vertex_colors += other.vertex_colors;
        self.smooth_normals += other.smooth_normals;
        self.highlights += other.highlights;
        self.glass += other.glass;
        self.planes += other.planes;
        self.filters += other.filters;
        self.culling += other.culling;
        self.area_lights += other.area_lights;
        self.emissive_lights += other.emissive_lights;
        self.pbr += other.pbr;
        self.environment += other.environment;
    }
}
