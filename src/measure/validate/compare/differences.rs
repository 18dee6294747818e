//! The differences that a comparison of two intersectors finds, and the worst ray.

use crate::geometry::Ray;
use crate::measure::validate::{MismatchCounts, WorstRay};
use crate::measure::{mismatch::MismatchCause, replay::ray_to_text};

/// The colour of a pixel with an unexplained mismatch.
pub const RED: [f32; 3] = [1.0, 0.0, 0.0];
/// The colour of a pixel with an explained mismatch.
pub const YELLOW: [f32; 3] = [1.0, 1.0, 0.0];

/// The differences found among some rays.
#[derive(Default)]
pub struct Differences {
    /// The number of camera rays.
    pub primary: u64,
    /// The number of shadow rays.
    pub shadow: u64,
    /// The number of secondary rays.
    pub secondary: u64,
    /// The mismatches by cause.
    pub causes: MismatchCounts,
    /// The largest difference of t, in ulp.
    pub max_ulp: u64,
    /// The worst ray and its severity.
    pub worst: Option<(Severity, WorstRay)>,
}

/// The severity of a difference, in ascending order.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Only t differs, by this many ulp.
    Distance(u64),
    /// An explained mismatch, and the difference of t in ulp.
    Explained(u64),
    /// An unexplained mismatch, and the difference of t in ulp.
    Unexplained(u64),
}

/// A camera ray, and its pixel in the heat map.
pub struct CameraRay<'m> {
    pub pixel: [u32; 2],
    pub ray: &'m Ray,
    /// The colour of the pixel in the heat map.
    pub heatmap_color: &'m mut [f32; 3],
}

impl CameraRay<'_> {
    /// Returns the report of a difference on this ray or a shadow ray from its hit.
    pub fn worst_ray(
        &self,
        cause: Option<&'static str>,
        is_shadow_ray: bool,
        t_error_ulp: Option<u64>,
    ) -> WorstRay {
        let ray = ray_to_text(self.ray);
        WorstRay { pixel: self.pixel, cause, is_shadow_ray, t_error_ulp, ray }
    }
}

impl Differences {
    /// Returns the sum of both, and the worse of their worst rays: the first if they are equal.
    pub fn merge(mut self, other: Self) -> Self {
        self.primary += other.primary;
        self.shadow += other.shadow;
        self.secondary += other.secondary;
        self.causes.edge += other.causes.edge;
        self.causes.tangency += other.causes.tangency;
        self.causes.tie += other.causes.tie;
        self.causes.other += other.causes.other;
        self.max_ulp = self.max_ulp.max(other.max_ulp);
        if let Some((severity, worst)) = other.worst {
            self.keep_worst(severity, || worst);
        }
        self
    }

    /// Counts a mismatch with its explanation, if there is one; given its camera ray, also colours the
    /// pixel, and keeps the ray if it is the worst.
    pub fn add(
        &mut self,
        camera_ray: Option<CameraRay<'_>>,
        cause: Option<MismatchCause>,
        is_shadow_ray: bool,
        t_error_ulp: Option<u64>,
    ) {
        // Every mismatch counts; only those of camera rays can be shown.
        *self.causes.count_mut(cause) += 1;
        let Some(camera_ray) = camera_ray else { return };
        let ulp = t_error_ulp.unwrap_or(0);
        let (severity, name) = match cause {
            Some(cause) => (Severity::Explained(ulp), cause.name()),
            None => (Severity::Unexplained(ulp), "other"),
        };
        // An unexplained mismatch shows whatever else the pixel has.
        if cause.is_none() {
            *camera_ray.heatmap_color = RED;
        } else if *camera_ray.heatmap_color != RED {
            *camera_ray.heatmap_color = YELLOW;
        }
        self.keep_worst(severity, || camera_ray.worst_ray(Some(name), is_shadow_ray, t_error_ulp));
    }

    /// Keeps a ray as the worst if none before is as bad; `ray` is called only then.
    pub fn keep_worst(&mut self, severity: Severity, ray: impl FnOnce() -> WorstRay) {
        if self.worst.as_ref().is_none_or(|(worst, _)| *worst < severity) {
            self.worst = Some((severity, ray()));
        }
    }
}
