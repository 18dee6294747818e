//! The load report as JSON, and the check of `--strict` on it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::load::LoadReport;

/// The load report as JSON: `report` in `info --json` and `render --stats`.
#[derive(Serialize)]
pub struct LoadSummary {
    faces: Faces,
    unsupported: Vec<String>,
    placeholders: Vec<String>,
    /// The names of the material variants that the files offer.
    pub variants: BTreeSet<String>,
}

/// The numbers of faces of all meshes: `read` = `handed_over` + the sum of `dropped`.
#[derive(Serialize)]
struct Faces {
    read: u64,
    handed_over: u64,
    dropped: BTreeMap<&'static str, u64>,
}

impl From<&LoadReport> for LoadSummary {
    fn from(report: &LoadReport) -> Self {
        let LoadReport { read, handed_over, dropped, unsupported, placeholders, variants, .. } =
            report.clone();
        let dropped = dropped.into_iter().map(|(reason, count)| (reason.name(), count)).collect();
        Self { faces: Faces { read, handed_over, dropped }, unsupported, placeholders, variants }
    }
}

/// Checks that a load was complete, for `--strict`.
///
/// # Errors
/// When anything in the files was dropped, unsupported or replaced by a placeholder; the error lists
/// all of it.
pub fn check_strictly(report: &LoadReport, path: &Path) -> Result<()> {
    if report.is_clean() {
        return Ok(());
    }
    Err(Error::input("--strict: the files cannot be shown completely")
        .listing(losses(report))
        .at(path)
        .help("correct the files, or leave out --strict to render without these parts"))
}

/// Returns what was dropped, unsupported or replaced by a placeholder, each in a line.
pub fn losses(report: &LoadReport) -> Vec<String> {
    let LoadReport { dropped, unsupported, placeholders, .. } = report;
    let dropped =
        dropped.iter().map(|(reason, count)| format!("dropped: {count} {}", reason.name()));
    let unsupported = unsupported.iter().map(|what| format!("not supported: {what}"));
    let placeholders = placeholders.iter().map(|what| format!("placeholder: {what}"));
    dropped.chain(unsupported).chain(placeholders).collect()
}
