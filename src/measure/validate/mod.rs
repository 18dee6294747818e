//! The comparison of Embree with the certified pure-Rust BVH, hit by hit and pixel by pixel.

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

/// The numbers of mismatches by cause. In precision `fast` the first three are explained by its
/// margins ([`MismatchClassifier`](crate::measure::MismatchClassifier) derives them); in `certified`
/// no mismatch is explained, and every one is `other`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MismatchCounts {
    /// The ray passes the edge of a triangle within the margin.
    pub edge: u64,
    /// The ray touches a sphere, to within the rounding of f64.
    pub tangency: u64,
    /// Two surfaces lie, along the ray, within the margin of each other, or a surface lies within the
    /// margin of the end of a shadow ray.
    pub tie: u64,
    /// Unexplained: an error in one of the two backends.
    pub other: u64,
}

impl MismatchCounts {
    /// Returns the number of explained mismatches.
    pub fn explained(&self) -> u64 {
        self.edge + self.tangency + self.tie
    }

    /// Returns the count of one cause; none stands for unexplained.
    #[cfg(any(feature = "embree", test))]
    fn count_mut(&mut self, cause: Option<MismatchCause>) -> &mut u64 {
        match cause {
            Some(MismatchCause::Edge) => &mut self.edge,
            Some(MismatchCause::Tangency) => &mut self.tangency,
            Some(MismatchCause::Tie) => &mut self.tie,
            None => &mut self.other,
        }
    }
}

/// The ray with the worst difference: an unexplained mismatch before an explained one, then the
/// largest error of t; of equal ones the first in the picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorstRay {
    /// The column and row of its pixel, from the upper left.
    pub pixel: [u32; 2],
    /// The cause of the mismatch: `other`, `edge`, `tangency` or `tie`; null where only t differs.
    pub cause: Option<&'static str>,
    /// True if the mismatch is that of a shadow ray from the hit, rather than of the ray itself.
    #[serde(rename = "shadow")]
    pub is_shadow_ray: bool,
    /// The difference of t, in units in the last place; null unless both hit the same primitive, and
    /// for shadow rays.
    pub t_error_ulp: Option<u64>,
    /// The camera ray, as [`ray_to_text`](crate::measure::ray_to_text) writes it.
    pub ray: String,
}

/// The result of a validation.
#[derive(Clone, Debug, Serialize)]
pub struct Validation {
    /// The precision of Embree; the reference is always certified.
    pub precision: &'static str,
    /// The number of rays traced with both: camera rays, shadow rays from their hits, and secondary
    /// rays.
    pub rays_compared: u64,
    /// The number of camera rays.
    pub primary_rays: u64,
    /// The number of secondary rays, off mirrors and through glass. They are not shown in the heat
    /// map, and never the worst ray.
    pub secondary_rays: u64,
    /// The number of rays on which the two hit different primitives, or only one of them hits any; in
    /// `certified` also of rays with any bit of t, u or v different.
    pub primitive_mismatches: u64,
    /// The mismatches by cause.
    pub causes: MismatchCounts,
    /// The number of unexplained mismatches: `causes.other`.
    pub unexplained_mismatches: u64,
    /// The largest difference of t, in units in the last place, where both hit the same primitive.
    pub max_t_error_ulp: u64,
    /// The number of pixels.
    pub pixels: u64,
    /// The number of pixels with a channel of the PNG that differs by more than 1 of 255.
    pub pixels_differing: u64,
    /// The largest difference of a channel of the PNG, of 255.
    pub max_channel_difference: u8,
    /// The number of values of the EXR that differ in any bit.
    pub values_differing: u64,
    /// The worst ray; null where there is no difference.
    pub worst: Option<WorstRay>,
    /// True if the validation passed. In `fast`: no mismatch is unexplained, at most 1e-4 of the rays
    /// are explained mismatches, and at most 1e-5 of the pixels differ. In `certified`: no bit
    /// differs.
    pub passed: bool,
    /// The heat map: red for an unexplained mismatch, yellow for an explained one, blue for a pixel
    /// that differs, grey where both hit something, black where both hit nothing.
    #[serde(skip)]
    pub heatmap: Film,
}

impl fmt::Display for Validation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.passed { "passed" } else { "FAILED" };
        let MismatchCounts { edge, tangency, tie, other } = self.causes;
        let Self { precision, rays_compared, primitive_mismatches, max_t_error_ulp, .. } = self;
        write!(
            f,
            "{verdict}: {precision}: {rays_compared} rays compared, {primitive_mismatches} mismatches \
             ({edge} edge, {tangency} tangency, {tie} tie, {other} other), t within \
             {max_t_error_ulp} ulp\n        "
        )?;
        let Self { pixels, pixels_differing, max_channel_difference, values_differing, .. } = self;
        write!(f, "{pixels_differing} of {pixels} pixels differ, by at most ")?;
        write!(f, "{max_channel_difference} of 255; {values_differing} EXR values differ")
    }
}

impl fmt::Display for WorstRay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.pixel;
        write!(f, "worst ray, of pixel ({x}, {y}): ")?;
        let what = if self.is_shadow_ray { "its shadow ray" } else { "its hit" };
        match (self.cause, self.t_error_ulp) {
            (Some(cause), None) => write!(f, "{what} differs ({cause})"),
            (Some(cause), Some(ulp)) => write!(f, "{what} differs ({cause}), t by {ulp} ulp"),
            (None, ulp) => write!(f, "t differs by {} ulp", ulp.unwrap_or(0)),
        }
    }
}

/// Renders a scene with Embree in `precision` and with the certified pure-Rust BVH, and compares
/// every hit, every shadow ray from the hits of camera rays, and every pixel. `threads` 0 means all
/// there are.
///
/// # Errors
/// When the scene is not valid, has no such camera, or Embree cannot be started or is not built in.
#[cfg_attr(not(feature = "embree"), expect(unused_variables))]
pub fn validate(
    scene: &Scene,
    precision: Precision,
    camera: usize,
    threads: usize,
) -> Result<Validation> {
    #[cfg(not(feature = "embree"))]
    return Err(crate::error::Error::input(
        "this envers was built without Embree: nothing to compare",
    )
    .help("build with the feature `embree` (run scripts/setup first)"));

    #[cfg(feature = "embree")]
    {
        use crate::intersect::{Bvh, Embree};
        use crate::render;

        scene.check()?;
        render::check_camera(scene, camera)?;
        render::in_pool(threads, || {
            let embree = Embree::build(scene, precision, rayon::current_num_threads())?;
            let comparer = compare::Comparer {
                scene,
                precision,
                tested: &embree,
                margin: embree.margin(),
                reference: &Bvh::build(scene, Precision::Certified),
                camera,
            };
            Ok(comparer.run())
        })
    }
}
