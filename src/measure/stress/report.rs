//! What a sweep found: rows, and the table of them.

use std::fmt::{self, Write};

use serde::{Deserialize, Serialize};

/// What is found beside the method that is tested, on the same rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Beside {
    /// Rays of which it says wrongly whether they hit.
    pub misclassified: u64,
    /// The worst error of a distance, in units in the last place; 0 where none was compared.
    pub max_ulp: f64,
}

/// What was counted in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Rays tried.
    pub rays: u64,
    /// Rays that came out wrong: hit for miss, another primitive, a leak, a false shadow, a pixel
    /// that differs.
    pub misclassified: u64,
    /// The worst error of a distance, in units in the last place; null where none was compared.
    pub max_ulp: Option<f64>,
    /// The worst relative error of what else the goal bounds; null where it bounds nothing else.
    pub max_relative: Option<f64>,
    /// The formulas of precision `fast`, where they are not what is tested.
    pub fast: Option<Beside>,
    /// The tutorial's formula, b² − 4ac in f64.
    pub naive: Option<Beside>,
}

/// One row of the report: a cell of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The goal, `SphereDistance` to `Invariance`.
    pub goal: String,
    /// Which rays.
    pub cell: String,
    /// What is tested.
    pub method: String,
    /// What was counted.
    #[serde(flatten)]
    pub tally: Tally,
    /// Whether nothing was wrong and no error beyond the goal's bound.
    pub passed: bool,
}

fn worst(a: f64, b: f64) -> f64 {
    // What is not a number is as wrong as can be; JSON knows no infinity.
    if a.is_nan() || b.is_nan() { f64::MAX } else { a.max(b).min(f64::MAX) }
}

impl Beside {
    /// Counts an answer beside the exact one: `error` is None when only one of them is a hit.
    pub fn count(&mut self, error: Option<f64>) {
        match error {
            Some(error) => self.max_ulp = worst(self.max_ulp, error),
            None => self.misclassified += 1,
        }
    }

    fn merge(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
        let misclassified = a.misclassified + b.misclassified;
        Some(Self { misclassified, max_ulp: worst(a.max_ulp, b.max_ulp) })
    }
}

impl Tally {
    /// Notes that a ray came out wrong, if it did.
    pub fn wrong_if(&mut self, wrong: bool) {
        self.misclassified += u64::from(wrong);
    }

    /// Notes the error of a distance, in ulp.
    pub fn ulp(&mut self, error: f64) {
        self.max_ulp = Some(worst(self.max_ulp.unwrap_or(0.0), error));
    }

    /// Notes a relative error.
    pub fn relative(&mut self, error: f64) {
        self.max_relative = Some(worst(self.max_relative.unwrap_or(0.0), error));
    }

    /// Both together.
    pub fn merge(self, other: Self) -> Self {
        let max = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => Some(worst(a, b)),
            _ => a.or(b),
        };
        Self {
            rays: self.rays + other.rays,
            misclassified: self.misclassified + other.misclassified,
            max_ulp: max(self.max_ulp, other.max_ulp),
            max_relative: max(self.max_relative, other.max_relative),
            fast: Beside::merge(self.fast, other.fast),
            naive: Beside::merge(self.naive, other.naive),
        }
    }
}

/// The rows for a person: a table for each goal, as wide as what it holds.
pub struct Table<'a>(pub &'a [Row]);

impl fmt::Display for Table<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for goal in self.0.chunk_by(|a, b| a.goal == b.goal) {
            sweep(f, goal)?;
            writeln!(f)?;
        }
        let failed = self.0.iter().filter(|row| !row.passed).count();
        let rays: u64 = self.0.iter().map(|row| row.tally.rays).sum();
        let verdict = if failed == 0 { "passed" } else { "FAILED" };
        writeln!(f, "{verdict}: {} rows, {failed} failed, {rays} rays", self.0.len())
    }
}

/// The table of one goal; the columns of what is found beside stand there where something is.
fn sweep(f: &mut fmt::Formatter<'_>, rows: &[Row]) -> fmt::Result {
    let widest =
        |of: fn(&Row) -> &str| rows.iter().map(|row| of(row).chars().count()).max().unwrap_or(0);
    let (cell, method) = (widest(|r| &r.cell).max(4), widest(|r| &r.method).max(6));
    write!(f, "goal  {:cell$}  {:method$}", "cell", "method")?;
    write!(f, "  {:>8}  {:>6}  {:>9}", "rays", "wrong", "worst")?;
    let has = |of: fn(&Tally) -> Option<Beside>| rows.iter().any(|row| of(&row.tally).is_some());
    let (fast, naive) = (has(|t| t.fast), has(|t| t.naive));
    for (title, _) in
        [("fast wrong, ulp", fast), ("b²-4ac wrong, ulp", naive)].iter().filter(|c| c.1)
    {
        write!(f, "  {title:>BESIDE$}")?;
    }
    writeln!(f)?;
    for row in rows {
        let t = &row.tally;
        let mut line = format!(
            "{:4}  {:cell$}  {:method$}  {:>8}  {:>6}  {:>9}",
            row.goal,
            row.cell,
            row.method,
            t.rays,
            t.misclassified,
            error(t.max_ulp, t.max_relative),
        );
        for (found, _) in [(t.fast, fast), (t.naive, naive)].iter().filter(|c| c.1) {
            write!(line, "  {:BESIDE$}", beside(*found, t.rays))?;
        }
        line.truncate(line.trim_end().len());
        if !row.passed {
            write!(line, "  FAILED")?;
        }
        writeln!(f, "{line}")?;
    }
    Ok(())
}

fn error(ulp: Option<f64>, relative: Option<f64>) -> String {
    match (ulp, relative) {
        (Some(ulp), _) if ulp < 1e5 => format!("{ulp:.2} ulp"),
        (Some(ulp), _) => format!("{ulp:.0e} ulp"),
        (None, Some(relative)) => format!("{relative:.1e}"),
        (None, None) => String::new(),
    }
}

/// The width of [`beside`].
const BESIDE: usize = 17;

fn beside(beside: Option<Beside>, rays: u64) -> String {
    let Some(b) = beside else { return String::new() };
    let share = 100.0 * b.misclassified as f64 / rays.max(1) as f64;
    let ulp = if b.max_ulp == 0.0 { String::new() } else { format!("{:.1e}", b.max_ulp) };
    format!("{share:7.3} %  {ulp:>6}")
}
