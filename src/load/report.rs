//! The load report: warnings, and what became of everything that a scene's files hold.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::PathBuf;

use crate::scene::Scene;

/// A scene, and beside it the report of its load.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Loaded {
    /// The scene, complete and checked.
    pub scene: Scene,
    /// The load report.
    pub report: LoadReport,
}

/// The account of a load: what importers read, handed over, dropped and could not do as the files
/// ask.
///
/// A face is a triangle; a polygon of n corners counts as the n − 2 triangles that it is cut into,
/// and each point, line or curve counts as one. A mesh is read once, however many instances it has
/// in the scene. Of what is read, [`LoadReport::balances`] holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadReport {
    /// The number of bytes of the file that was named.
    pub own_bytes: u64,
    /// Faces of all meshes that were read.
    pub read: u64,
    /// Faces that are in the scene, for rays to hit.
    pub handed_over: u64,
    /// Faces that are not in the scene, by reason; no reason has 0.
    pub dropped: BTreeMap<DropReason, u64>,
    /// Warnings: what could not be done as the files ask, or looks odd; one sentence each.
    pub warnings: Vec<String>,
    /// Features that a file uses and that are not supported; one sentence each, also among the
    /// warnings.
    pub unsupported: Vec<String>,
    /// Images and materials that a placeholder replaces; one sentence each, also among
    /// the warnings.
    pub placeholders: Vec<String>,
    /// The description that each glTF file has of itself.
    pub assets: Vec<Asset>,
    /// The names of the variants of materials that glTF files offer (KHR_materials_variants).
    pub variants: BTreeSet<String>,
    /// The canonical paths of the files that were read.
    pub files: BTreeSet<PathBuf>,
    /// The number of bytes of these files.
    pub bytes: u64,
}

/// The description that a glTF file has of itself: its `asset`, and its animations.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Asset {
    /// The path of the file.
    pub file: PathBuf,
    /// The version of glTF.
    pub version: String,
    /// The program that wrote it.
    pub generator: Option<String>,
    /// The copyright.
    pub copyright: Option<String>,
    /// The animations.
    pub animations: Vec<AssetAnimation>,
}

/// An animation of a glTF file, whether or not it is played.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AssetAnimation {
    /// The name.
    pub name: Option<String>,
    /// The time of its last key in seconds, if the file declares it.
    pub seconds: Option<f64>,
}

/// The reason why a face is not in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DropReason {
    /// Two corners of the face have the same position, so that it covers nothing.
    Degenerate,
    /// The face stands at one place many times. Nothing is lost by that.
    Duplicate,
    /// The face has fewer than three corners.
    Incomplete,
    /// The face names a vertex that is not there.
    IndexOutOfRange,
    /// The mesh has only instances that are scaled to 0 along some direction.
    Flat,
    /// The mesh has no positions.
    NoPositions,
    /// A coordinate of a corner is not a finite number.
    NotFinite,
    /// The primitive is a point, a line, or a curve or curved surface.
    UnsupportedMode,
}

impl DropReason {
    /// The name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Degenerate => "degenerate",
            Self::Duplicate => "duplicate",
            Self::Incomplete => "incomplete",
            Self::IndexOutOfRange => "index-out-of-range",
            Self::Flat => "flat",
            Self::NoPositions => "no-positions",
            Self::NotFinite => "not-finite",
            Self::UnsupportedMode => "unsupported-mode",
        }
    }

    /// The warning about faces that were dropped, with `{}` where their number belongs; none where
    /// nothing that could be seen is lost.
    pub(crate) fn warning(self) -> Option<&'static str> {
        Some(match self {
            Self::Degenerate | Self::Duplicate => return None,
            Self::Incomplete => "{} faces are left out: they have fewer than three corners",
            Self::IndexOutOfRange => "{} faces are left out: they name vertices that are not there",
            Self::Flat => "{} faces are left out: their mesh is scaled to 0 along some direction",
            Self::NoPositions => "{} faces are left out: their vertices have no positions",
            Self::NotFinite => "{} faces are left out: a corner is not a finite number",
            Self::UnsupportedMode => {
                "{} points, lines or curves are left out: only faces are drawn"
            }
        })
    }
}

impl LoadReport {
    /// The number of faces that were dropped, for any reason.
    pub fn dropped_total(&self) -> u64 {
        self.dropped.values().sum()
    }

    /// True if every face that was read was either dropped for a reason or handed over.
    pub fn balances(&self) -> bool {
        self.read == self.handed_over + self.dropped_total()
    }

    /// True if nothing was lost: no face dropped but copies of others, every feature supported, every
    /// image read.
    pub fn is_clean(&self) -> bool {
        let is_copy = |reason: &DropReason| *reason == DropReason::Duplicate;
        self.dropped.keys().all(is_copy)
            && self.unsupported.is_empty()
            && self.placeholders.is_empty()
    }

    /// Adds the report of another file.
    pub fn add(&mut self, other: LoadReport) {
        self.bytes += other.bytes;
        self.read += other.read;
        self.handed_over += other.handed_over;
        for (reason, count) in other.dropped {
            *self.dropped.entry(reason).or_default() += count;
        }
        self.warnings.extend(other.warnings);
        self.unsupported.extend(other.unsupported);
        self.placeholders.extend(other.placeholders);
        self.assets.extend(other.assets);
        self.variants.extend(other.variants);
        self.files.extend(other.files);
    }
}

/// The faces alone: `14 read = 12 handed over + 2 degenerate`.
impl fmt::Display for LoadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} read = {} handed over", self.read, self.handed_over)?;
        self.dropped.iter().try_for_each(|(why, count)| write!(f, " + {count} {}", why.name()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(reason: DropReason) -> LoadReport {
        LoadReport {
            read: 3,
            handed_over: 1,
            dropped: [(reason, 2)].into(),
            ..LoadReport::default()
        }
    }

    #[test]
    fn sums_of_reports_balance_as_they_do() {
        let mut sum = report(DropReason::Degenerate);
        sum.add(report(DropReason::NotFinite));
        sum.add(report(DropReason::Degenerate));
        assert!(sum.balances());
        assert_eq!(sum.to_string(), "9 read = 3 handed over + 4 degenerate + 2 not-finite");
    }

    #[test]
    fn a_face_that_nobody_accounts_for_unbalances_it() {
        assert!(!LoadReport { read: 4, ..report(DropReason::Flat) }.balances());
    }
}
