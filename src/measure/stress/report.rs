//! The results of a sweep: a row for each case, and the table of them.

use std::fmt::{self, Write};

use serde::{Deserialize, Serialize};

/// The errors of a formula that is not tested but compared, on the same rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BaselineStats {
    /// The number of rays for which hit and miss are confused.
    pub misclassified: u64,
    /// The largest error of a distance, in units in the last place; 0 where none was compared.
    pub max_ulp: f64,
}

/// The errors found in a case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseStats {
    /// The number of rays.
    pub rays: u64,
    /// The number of wrong results: hit for miss, another primitive, a leak, a false shadow, a pixel
    /// that differs.
    pub misclassified: u64,
    /// The largest error of a distance, in units in the last place; null where none was compared.
    pub max_ulp: Option<f64>,
    /// The largest relative error of any other quantity that the goal bounds; null where it bounds
    /// none.
    pub max_relative: Option<f64>,
    /// The errors of the formulas of precision `fast`, where they are not tested themselves.
    pub fast: Option<BaselineStats>,
    /// The errors of the textbook formula, b² − 4ac in f64.
    #[serde(rename = "naive")]
    pub textbook: Option<BaselineStats>,
}

/// The results of a case: a row of the report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The goal, `G1` to `G13`.
    pub goal: String,
    /// The name of the case.
    #[serde(rename = "cell")]
    pub case: String,
    /// The name of the method that is tested.
    pub method: String,
    /// The errors found.
    #[serde(flatten)]
    pub stats: CaseStats,
    /// True if nothing was misclassified and no error is beyond the goal's bound.
    pub passed: bool,
}

/// Returns the larger of two errors; a NaN counts as the largest, and infinities, which JSON cannot
/// store, as `f64::MAX`.
fn larger_error(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::MAX } else { a.max(b).min(f64::MAX) }
}

/// Merges two values where both exist.
fn merge_options<T: Copy>(a: Option<T>, b: Option<T>, merge: impl Fn(T, T) -> T) -> Option<T> {
    a.zip(b).map(|(a, b)| merge(a, b)).or(a).or(b)
}

impl BaselineStats {
    /// Counts the result for a ray: its error in ulp, or none when only one of it and the exact
    /// result is a hit.
    pub fn count(&mut self, error: Option<f64>) {
        match error {
            Some(error) => self.max_ulp = larger_error(self.max_ulp, error),
            None => self.misclassified += 1,
        }
    }

    fn merge(self, other: Self) -> Self {
        let misclassified = self.misclassified + other.misclassified;
        Self { misclassified, max_ulp: larger_error(self.max_ulp, other.max_ulp) }
    }
}

impl CaseStats {
    /// Counts a result that may be wrong.
    pub fn count_wrong(&mut self, is_wrong: bool) {
        self.misclassified += u64::from(is_wrong);
    }

    /// Counts the results that differ from the expected ones.
    pub fn count_different<T: PartialEq>(&mut self, found: &[T], expected: &[T]) {
        let different = found.iter().zip(expected).filter(|(found, expected)| found != expected);
        self.misclassified += different.count() as u64;
    }

    /// Counts the error of a distance, in ulp.
    pub fn count_ulp(&mut self, error: f64) {
        self.max_ulp = Some(larger_error(self.max_ulp.unwrap_or(0.0), error));
    }

    /// Counts a relative error.
    pub fn count_relative(&mut self, error: f64) {
        self.max_relative = Some(larger_error(self.max_relative.unwrap_or(0.0), error));
    }

    /// Counts a result of the formulas of precision `fast`; see [`BaselineStats::count`].
    pub fn count_fast(&mut self, error: Option<f64>) {
        self.fast.get_or_insert_default().count(error);
    }

    /// Returns the statistics of both.
    pub fn merge(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            misclassified: self.misclassified + other.misclassified,
            max_ulp: merge_options(self.max_ulp, other.max_ulp, larger_error),
            max_relative: merge_options(self.max_relative, other.max_relative, larger_error),
            fast: merge_options(self.fast, other.fast, BaselineStats::merge),
            textbook: merge_options(self.textbook, other.textbook, BaselineStats::merge),
        }
    }
}

/// The rows as text: a table for each goal, with columns as wide as their contents.
pub struct Table<'a>(pub &'a [Row]);

impl fmt::Display for Table<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for goal in self.0.chunk_by(|a, b| a.goal == b.goal) {
            write_goal(f, goal)?;
            writeln!(f)?;
        }
        let failed = self.0.iter().filter(|row| !row.passed).count();
        let rays: u64 = self.0.iter().map(|row| row.stats.rays).sum();
        let verdict = if failed == 0 { "passed" } else { "FAILED" };
        writeln!(f, "{verdict}: {} rows, {failed} failed, {rays} rays", self.0.len())
    }
}

/// A column for a baseline: its title, and its statistics in a row.
type BaselineColumn = (&'static str, fn(&CaseStats) -> Option<BaselineStats>);

const BASELINES: [BaselineColumn; 2] =
    [("fast wrong, ulp", |stats| stats.fast), ("b²-4ac wrong, ulp", |stats| stats.textbook)];

/// Writes the table of one goal, with columns for the baselines that its cases have.
fn write_goal(f: &mut fmt::Formatter<'_>, rows: &[Row]) -> fmt::Result {
    // The columns are as wide as their contents; a baseline has one only if a case has it.
    let width = |text: fn(&Row) -> &str| {
        rows.iter().map(|row| text(row).chars().count()).max().unwrap_or(0)
    };
    let (case, method) = (width(|r| &r.case).max(4), width(|r| &r.method).max(6));
    let mut baselines = BASELINES.to_vec();
    baselines.retain(|(_, stats)| rows.iter().any(|row| stats(&row.stats).is_some()));

    // The titles.
    write!(f, "goal  {:case$}  {:method$}", "case", "method")?;
    write!(f, "  {:>8}  {:>6}  {:>9}", "rays", "wrong", "max error")?;
    for (title, _) in &baselines {
        write!(f, "  {title:>BASELINE_WIDTH$}")?;
    }
    writeln!(f)?;
    // The rows, without blanks at the end.
    for Row { goal, case: name, method: tested, stats, passed } in rows {
        let CaseStats { rays, misclassified, .. } = stats;
        let mut line = format!("{goal:4}  {name:case$}  {tested:method$}  {rays:>8}  ");
        write!(line, "{misclassified:>6}  {:>9}", max_error(stats))?;
        for (_, baseline) in &baselines {
            write!(line, "  {:BASELINE_WIDTH$}", baseline_text(baseline(stats), *rays))?;
        }
        line.truncate(line.trim_end().len());
        writeln!(f, "{line}{}", if *passed { "" } else { "  FAILED" })?;
    }
    Ok(())
}

/// Returns the largest error of a case as text.
fn max_error(stats: &CaseStats) -> String {
    match (stats.max_ulp, stats.max_relative) {
        (Some(ulp), _) if ulp < 1e5 => format!("{ulp:.2} ulp"),
        (Some(ulp), _) => format!("{ulp:.0e} ulp"),
        (None, Some(relative)) => format!("{relative:.1e}"),
        (None, None) => String::new(),
    }
}

/// The width of [`baseline_text`].
const BASELINE_WIDTH: usize = 17;

/// Returns the share of misclassified rays and the largest error of a baseline as text.
fn baseline_text(baseline: Option<BaselineStats>, rays: u64) -> String {
    let Some(BaselineStats { misclassified, max_ulp }) = baseline else { return String::new() };
    let share = 100.0 * misclassified as f64 / rays.max(1) as f64;
    let ulp = if max_ulp == 0.0 { String::new() } else { format!("{max_ulp:.1e}") };
    format!("{share:7.3} %  {ulp:>6}")
}
