//! Embree against the certified pure-Rust intersector: hit by hit and pixel by pixel.

#[cfg(any(feature = "embree", test))]
mod compare;

use std::fmt;

use serde::Serialize;

use crate::error::Result;
use crate::film::Film;
use crate::intersect::Precision;
#[cfg(any(feature = "embree", test))]
use crate::measure::mismatch::MismatchCause;
use crate::scene::Scene;

/// Disagreements, by cause. In precision `fast` the first three are explained by what it promises
/// ([`MismatchClassifier`](crate::measure::MismatchClassifier) derives the margins); in `certified` nothing is, and
/// every disagreement is `other`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Causes {
    /// The ray passes the edge of a triangle within the margin.
    pub edge: u64,
    /// The ray touches a sphere, to within the rounding of f64.
    pub tangency: u64,
    /// Two surfaces lie, along the ray, as close together as the margin, or a surface lies as
    /// close to the end of a shadow ray.
    pub tie: u64,
    /// Nothing explains it: an error in one of the two.
    pub other: u64,
}

impl Causes {
    /// How many of them the promises of `fast` explain.
    pub fn explained(&self) -> u64 {
        self.edge + self.tangency + self.tie
    }

    #[cfg(any(feature = "embree", test))]
    fn of(&mut self, cause: Option<MismatchCause>) -> &mut u64 {
        match cause {
            Some(MismatchCause::Edge) => &mut self.edge,
            Some(MismatchCause::Tangency) => &mut self.tangency,
            Some(MismatchCause::Tie) => &mut self.tie,
            None => &mut self.other,
        }
    }
}

/// The ray that came out worst: an unexplained mismatch before an explained one, and then the
/// largest error of t; of several the first in the picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// Column and row of its pixel, from the upper left.
    pub pixel: [u32; 2],
    /// `other`, `edge`, `tangency` or `tie` where the two disagree; null where they hit the same
    /// and only t differs.
    pub cause: Option<&'static str>,
    /// Whether it is about a shadow ray from what the ray hits, rather than about the ray itself.
    pub shadow: bool,
    /// By how much t differs, in units in the last place; null where the two do not hit the same
    /// primitive, and for shadow rays.
    pub t_error_ulp: Option<u64>,
    /// The ray from the eye as `envers validate SCENE --ray` takes it, every bit of it.
    pub ray: String,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Validation {
    /// In which precision Embree was held against the judge, which is always certified.
    pub precision: &'static str,
    /// Rays traced by both: from the eye, from there to the lights, and those that mirrors and
    /// glass send on.
    pub rays_compared: u64,
    /// Of these, rays from the eye.
    pub primary_rays: u64,
    /// Of these, rays that mirrors and glass send on; they have no place in the heat map, and none
    /// of them is the worst ray.
    pub secondary_rays: u64,
    /// Rays about which the two disagree: which primitive, or whether any; in `certified` also
    /// any bit of t, u or v.
    pub primitive_mismatches: u64,
    /// The same, by cause.
    pub causes: Causes,
    /// Those that nothing explains: `causes.other`.
    pub unexplained_mismatches: u64,
    /// Largest difference of t, in units in the last place, where both hit the same primitive.
    pub max_t_error_ulp: u64,
    /// Pixels compared.
    pub pixels: u64,
    /// Pixels of which a channel of the PNG differs by more than 1 of 255.
    pub pixels_differing: u64,
    /// Largest difference of a channel of the PNG, of 255.
    pub max_channel_difference: u8,
    /// Values of the EXR that differ at all.
    pub values_differing: u64,
    /// The worst ray; null where there is no difference.
    pub worst: Option<Worst>,
    /// In `fast`: no unexplained mismatch, at most 1e-4 of the rays explained ones, at most 1e-5
    /// of the pixels differing. In `certified`: no difference of any bit.
    pub passed: bool,
    /// Where they differ: red an unexplained mismatch, yellow an explained one, blue a pixel that
    /// differs; and grey where they agree that something is hit.
    #[serde(skip)]
    pub heatmap: Film,
}

impl fmt::Display for Validation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Causes { edge, tangency, tie, other } = self.causes;
        write!(
            f,
            "{}: {}: {} rays compared, {} mismatches ({edge} edge, {tangency} tangency, {tie} tie, \
             {other} other), t within {} ulp\n        {} of {} pixels differ, by at most {} of 255; \
             {} EXR values differ",
            if self.passed { "passed" } else { "FAILED" },
            self.precision,
            self.rays_compared,
            self.primitive_mismatches,
            self.max_t_error_ulp,
            self.pixels_differing,
            self.pixels,
            self.max_channel_difference,
            self.values_differing
        )
    }
}

impl fmt::Display for Worst {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.pixel;
        write!(f, "worst ray, of pixel ({x}, {y}): ")?;
        let what = if self.shadow { "its shadow ray" } else { "what it hits" };
        match (self.cause, self.t_error_ulp) {
            (Some(cause), None) => write!(f, "{what} differs ({cause})"),
            (Some(cause), Some(ulp)) => write!(f, "{what} differs ({cause}), t by {ulp} ulp"),
            (None, ulp) => write!(f, "t differs by {} ulp", ulp.unwrap_or(0)),
        }
    }
}

/// Renders a scene with Embree in `precision` and with the certified pure-Rust intersector, and
/// compares every hit, every shadow ray from what the eye sees, and every pixel. `threads` 0 means all there are.
///
/// # Errors
/// When the scene is not valid, has no such camera, or this build has no Embree.
#[cfg(not(feature = "embree"))]
pub fn validate(_: &Scene, _: Precision, _: usize, _: usize) -> Result<Validation> {
    Err(crate::error::Error::input("this envers was built without Embree: nothing to compare")
        .help("build with the feature `embree` (run scripts/setup first)"))
}

/// Renders a scene with Embree in `precision` and with the certified pure-Rust intersector, and
/// compares every hit, every shadow ray from what the eye sees, and every pixel. `threads` 0 means all there are.
///
/// # Errors
/// When the scene is not valid, has no such camera, or Embree cannot be started.
#[cfg(feature = "embree")]
pub fn validate(
    scene: &Scene,
    precision: Precision,
    camera: usize,
    threads: usize,
) -> Result<Validation> {
    use crate::intersect::{Bvh, Embree};
    use crate::render;

    scene.check()?;
    render::check_camera(scene, camera)?;
    render::in_pool(threads, || {
        let embree = Embree::build(scene, precision, rayon::current_num_threads())?;
        let judge = Bvh::build(scene, Precision::Certified);
        let (subject, margin) = (&embree, embree.margin());
        let judge = &judge;
        Ok(compare::Comparer { scene, precision, subject, margin, judge, camera }.run())
    })
}
