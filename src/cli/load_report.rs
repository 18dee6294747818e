//! What became of a scene's files on the way to the picture: in JSON, and what was lost as an error.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::load::LoadReport;

/// `report` in `info --json` and `render --stats`.
#[derive(Serialize)]
pub struct LoadSummary {
    faces: Faces,
    unsupported: Vec<String>,
    placeholders: Vec<String>,
    pub variants: BTreeSet<String>,
}

/// Of the faces of all meshes, each read once: `read` = `handed_over` + the sum of `dropped`.
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
        let dropped = dropped.into_iter().map(|(why, count)| (why.name(), count)).collect();
        Self { faces: Faces { read, handed_over, dropped }, unsupported, placeholders, variants }
    }
}

/// Checks the demand of `--strict` on a load.
///
/// # Errors
/// When anything of its files was dropped, is not supported, or has a placeholder; the error lists
/// all of it.
pub fn check_strictly(report: &LoadReport, path: &Path) -> Result<()> {
    let LoadReport { dropped, unsupported, placeholders, .. } = report;
    if report.is_clean() {
        return Ok(());
    }
    let dropped = dropped.iter().map(|(why, count)| format!("dropped: {count} {}", why.name()));
    let unsupported = unsupported.iter().map(|what| format!("not supported: {what}"));
    let placeholders = placeholders.iter().map(|what| format!("placeholder: {what}"));
    let list = dropped.chain(unsupported).chain(placeholders);
    let list: String = list.map(|line| format!("\n  {line}")).collect();
    Err(Error::input(format!("--strict: not all of it can be shown as its files have it{list}"))
        .at(path)
        .help("mend the files, or leave --strict out to go on without"))
}
