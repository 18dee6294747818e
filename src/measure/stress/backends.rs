//! The backends that are tested, and their intersectors.

use super::CaseStats;
use super::case::{Case, RaySampler};
use crate::error::Result;
use crate::geometry::{Hit, Ray};
use crate::intersect::{Backend, Coherence::Incoherent, Intersector, Precision};
use crate::measure::trace::{closest, occluded, ulps_between};
use crate::scene::Scene;

/// The name of a backend in the report.
pub fn report_name(backend: Backend) -> &'static str {
    match backend {
        Backend::Rust => "bvh",
        #[cfg(feature = "embree")]
        Backend::Embree => "embree",
    }
}

/// The names of the backends that are tested: all that can be used here.
pub fn intersector_names() -> String {
    let names: Vec<_> = Backend::available().iter().map(|&backend| report_name(backend)).collect();
    names.join(" and ")
}

/// Builds an intersector of each backend for a scene.
pub fn intersectors(scene: &Scene, precision: Precision) -> Result<Vec<Box<dyn Intersector + '_>>> {
    Backend::available().iter().map(|backend| backend.build(scene, precision, 1)).collect()
}

/// Returns a case for each backend, whose precision `certified` is tested, and `fast` measured.
pub fn on_each_backend(
    name: &str,
    test: impl Fn(&RaySampler, Backend) -> Result<CaseStats> + Copy + 'static,
) -> Vec<Case> {
    let case = |&backend: &Backend| {
        let method = format!("certified, {}", report_name(backend));
        Case::new(name, method, move |sampler| test(sampler, backend))
    };
    Backend::available().iter().map(case).collect()
}

/// The intersectors of one backend in both precisions: `certified` is tested, and `fast` measured.
pub struct BothPrecisions<'s> {
    pub certified: Box<dyn Intersector + 's>,
    pub fast: Box<dyn Intersector + 's>,
}

impl<'s> BothPrecisions<'s> {
    /// Builds the intersectors of a scene.
    pub fn build(scene: &'s Scene, backend: Backend) -> Result<Self> {
        let build = |precision| backend.build(scene, precision, 1);
        Ok(Self { certified: build(Precision::Certified)?, fast: build(Precision::Fast)? })
    }

    /// Counts the closest hits that differ from the expected ones, in the primitive or in t.
    pub fn count_hits(&self, rays: &[Ray], expected: &[Option<Hit>], stats: &mut CaseStats) {
        let place = |hit: &Option<Hit>| hit.map(|hit| (hit.id, hit.t));
        for (found, expected) in closest(&*self.certified, rays, Incoherent).iter().zip(expected) {
            stats.count_wrong(place(found) != place(expected));
        }
        for (found, expected) in closest(&*self.fast, rays, Incoherent).iter().zip(expected) {
            stats.count_fast(match (found, expected) {
                (None, None) => Some(0.0),
                (Some(a), Some(b)) if a.id == b.id => Some(ulps_between(a.t, b.t) as f64),
                _ => None,
            });
        }
    }

    /// Counts the rays for which it is wrong whether they are occluded.
    pub fn count_occluded(&self, rays: &[Ray], expected: &[bool], stats: &mut CaseStats) {
        stats.count_different(&occluded(&*self.certified, rays, Incoherent), expected);
        for (found, expected) in occluded(&*self.fast, rays, Incoherent).iter().zip(expected) {
            stats.count_fast((found == expected).then_some(0.0));
        }
    }
}
