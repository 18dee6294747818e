//! The results of a benchmark as CSV, and as a table of text.

use std::fmt;

use super::report::{BenchReport, ReferenceSummary, SkippedMode};

impl BenchReport {
    /// Returns the rows as comma-separated values, with a line of column names first.
    pub fn csv(&self) -> String {
        let mut text = "backend,precision,quality,samples,runs,build_ms,render_ms,total_ms,rmse,\
                        max,flip,hits_wrong,standing\n"
            .to_owned();
        for r in &self.modes {
            let (quality, samples, rank) = (r.quality, &r.samples, r.rank.name());
            text += &format!("{},{},{quality},{samples},{},", r.backend, r.precision, r.runs);
            text += &format!("{},{},{},", r.build_ms, r.render_ms, r.total_ms);
            text += &format!("{},{},{},{},{rank}\n", r.rmse, r.max, r.flip, r.wrong_hits);
        }
        text
    }
}

/// The table of the rows, the skipped modes and the time of the reference.
impl fmt::Display for BenchReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "mode                            runs   build ms  render ms   RMSE      max       FLIP      wrong  \
             Pareto"
        )?;
        for r in &self.modes {
            let (mode, runs, rank) = (&r.mode, r.runs, r.rank.name());
            write!(f, "{mode:30} {runs:5} {:10.1} {:10.1}", r.build_ms, r.render_ms)?;
            write!(f, "   {:.2e}  {:.2e}  {:.6} {:7}", r.rmse, r.max, r.flip, r.wrong_hits)?;
            writeln!(f, "  {rank}")?;
        }
        for SkippedMode { mode, reason } in &self.skipped {
            writeln!(f, "{mode:30} skipped: {reason}")?;
        }
        let ReferenceSummary { mode, build_ms, render_ms, .. } = &self.reference;
        let seconds = (build_ms + render_ms) * 1e-3;
        writeln!(f, "reference: {mode}, in {seconds:.2} s")
    }
}
