//! How good a tree is worth building.

/// How much work Embree puts into its trees.
///
/// In precision `certified` the hits are the same with either. In `fast`, which of several
/// triangles is hit is open where f32 cannot tell, and may differ with the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// By Morton codes: built faster, traced slower.
    Low,
    /// By the surface-area heuristic.
    #[default]
    Medium,
}

/// From how many rays for each primitive on the better tree pays: measured, as docs/performance.md
/// says.
const RAYS_PER_PRIMITIVE: u64 = 32;

impl BuildQuality {
    /// What it is called: `low` or `medium`.
    pub const fn name(self) -> &'static str {
        match self {
            BuildQuality::Low => "low",
            BuildQuality::Medium => "medium",
        }
    }

    /// What takes the least time for so many rays to come among so many primitives.
    pub const fn for_rays(rays: u64, primitives: u64) -> Self {
        if rays < primitives.saturating_mul(RAYS_PER_PRIMITIVE) {
            BuildQuality::Low
        } else {
            BuildQuality::Medium
        }
    }
}
