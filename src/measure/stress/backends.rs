//! The backends that are tested, and their intersectors.

use super::CaseStats;
use super::case::{Case, RaySampler};
use crate::error::Result;
use crate::geometry::{Hit, Ray};
use crate::intersect::{Backend, Coherence::Incoherent, Intersector, Precision};
use crate::measure::trace::{closest, occluded, ulps_between};
use crate::scene::Scene;

/// The backends of this build, and their names in the report.
pub const BACKENDS: &[(Backend, &str)] = &[
    #[cfg(feature = "embree")]
    (Backend::Embree, "embree"),
    (Backend::Rust, "bvh"),
];

/// The names of all backends of this build.
pub const INTERSECTORS: &str = if cfg!(feature = "embree") { "embree and bvh" } else { "bvh" };

/// Builds the intersectors of this build for a scene.
pub fn intersectors(scene: &Scene, precision: Precision) -> Result<Vec<Box<dyn Intersector + '_>>> {
    BACKENDS.iter().map(|(backend, _)| backend.build(scene, precision, 1)).collect()
}

/// Returns a case for each backend, whose precision `certified` is tested, and `fast` measured.
pub fn on_each_backend(
    name: &str,
    test: impl Fn(&RaySampler, Backend) -> Result<CaseStats> + Copy + 'static,
) -> Vec<Case> {
    let case = |&(backend, backend_name): &(Backend, &str)| {
        let method = format!("certified, {backend_name}");
        Case::new(name, method, move |sampler| test(sampler, backend))
    };
    BACKENDS.iter().map(case).collect()
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
