//! What is counted while a picture is made.

use super::adaptive::STEPS;

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
    /// Pixels that got more samples, at each step of an adaptive picture.
    pub refined: [u64; STEPS],
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
pub(super) enum Cause {
    Light,
    Surface,
    Sum,
}

impl Cause {
    pub(super) fn count(self, counts: &mut Counts) {
        let to = &mut counts.not_finite;
        *match self {
            Cause::Light => &mut to.light,
            Cause::Surface => &mut to.surface,
            Cause::Sum => &mut to.sum,
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
        self.not_finite.light += other.not_finite.light;
        self.not_finite.surface += other.not_finite.surface;
        self.not_finite.sum += other.not_finite.sum;
    }
}
