//! What is counted while a picture is made.

use super::adaptive::STEPS;
use crate::geometry::RayBatch;
use crate::intersect::{Intersector, Query};
use crate::scene::Scene;

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

/// How much was done of the work that not every picture needs. Exactly 0 means that the code for it
/// did not run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FeatureCounts {
    /// Points that were shaded whose texture coordinates were worked out.
    pub uv: u64,
    /// Points for which it was worked out how much of a picture one sample sees.
    pub mipmaps: u64,
    /// Points whose normal a picture was asked for.
    pub normal_maps: u64,
    /// Points of planes that were looked up in a checker.
    pub checkers: u64,
    /// Points of meshes whose vertices were asked for colours.
    pub vertex_colors: u64,
    /// Points of meshes whose vertices were asked for normals.
    pub smooth_normals: u64,
    /// Highlights that were worked out. They are so sixteen at a time: those of rays beside count.
    pub highlights: u64,
    /// Shadow rays that were traced again, to look for glass in their way.
    pub glass: u64,
    /// Sixteens of rays that were tried against planes.
    pub planes: u64,
    /// Sixteens of rays of which a filter looked at each hit that Embree found.
    pub filters: u64,
}

impl FeatureCounts {
    /// Counts the tests of rays against planes, and those by filters.
    pub(super) fn count_tests(
        &mut self,
        scene: &Scene,
        intersector: &dyn Intersector,
        query: Query,
        rays: &RayBatch,
    ) {
        let blocks = rays.blocks().len() as u64;
        self.planes += blocks * u64::from(!scene.planes.is_empty());
        self.filters += blocks * u64::from(intersector.uses_filter(query, rays));
    }
}

/// What was counted while a picture was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rays traced.
    pub rays: RayCounts,
    /// Primary rays that hit something.
    pub hits: u64,
    /// Pixels that got more samples, at each step of an adaptive picture.
    pub refined: [u64; STEPS],
    /// Work that not every picture needs.
    pub work: FeatureCounts,
    /// Samples whose radiance was not finite and was left out.
    pub not_finite: NotFinite,
}

/// Samples whose radiance was not finite, by what made it so: each counts once, for what was met
/// first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NotFinite {
    /// The light that reaches the surface: a light that weakens with the square of the distance
    /// stands very near it.
    pub light: u64,
    /// The surface itself: its position, or what its material, textures and vertex colours make
    /// of its colour.
    pub surface: u64,
    /// Finite values whose product or sum is beyond f32.
    pub sum: u64,
}

impl NotFinite {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.light + self.surface + self.sum
    }
}

/// What made a sample's radiance not finite; see [`NotFinite`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NotFiniteCause {
    Light,
    Surface,
    Sum,
}

impl NotFiniteCause {
    pub(super) fn count(self, counts: &mut Counts) {
        let to = &mut counts.not_finite;
        *match self {
            NotFiniteCause::Light => &mut to.light,
            NotFiniteCause::Surface => &mut to.surface,
            NotFiniteCause::Sum => &mut to.sum,
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
        self.refined.iter_mut().zip(other.refined).for_each(|(to, other)| *to += other);
        self.work += other.work;
        self.not_finite.light += other.not_finite.light;
        self.not_finite.surface += other.not_finite.surface;
        self.not_finite.sum += other.not_finite.sum;
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
    }
}
