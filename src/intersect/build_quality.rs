//! The quality of the trees that Embree builds.

/// The work that Embree puts into its trees.
///
/// In precision `certified` the hits are the same with either. In `fast`, which of several
/// triangles is hit is open where f32 cannot tell, and may differ with the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// Trees by Morton codes: built faster, traced slower.
    Low,
    /// Trees by the surface-area heuristic.
    #[default]
    Medium,
}

/// The number of rays for each primitive from which on the better tree pays: measured, as
/// docs/performance.md says.
const RAYS_PER_PRIMITIVE: u64 = 32;

impl BuildQuality {
    /// The name: `low` or `medium`.
    pub const fn name(self) -> &'static str {
        match self {
            BuildQuality::Low => "low",
            BuildQuality::Medium => "medium",
        }
    }

    /// Returns the quality with which a scene of this many primitives, and this many rays, takes the least
    /// time.
    pub const fn for_rays(rays: u64, primitives: u64) -> Self {
        if rays < primitives.saturating_mul(RAYS_PER_PRIMITIVE) {
            BuildQuality::Low
        } else {
            BuildQuality::Medium
        }
    }
}
