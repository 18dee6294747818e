//! The rows of a bench as text.

use std::fmt;

use super::report::{LeftOut, Report, Stated};

impl Report {
    /// The rows as comma-separated values, with a line of names first.
    pub fn csv(&self) -> String {
        let mut text =
            "backend,precision,quality,samples,runs,build_ms,render_ms,total_ms,rmse,max,flip,\
                        hits_wrong,standing\n"
                .to_owned();
        for r in &self.modes {
            text += &format!(
                "{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                r.backend,
                r.precision,
                r.quality,
                r.samples,
                r.runs,
                r.build_ms,
                r.render_ms,
                r.total_ms,
                r.rmse,
                r.max,
                r.flip,
                r.hits_wrong,
                r.standing.name()
            );
        }
        text
    }
}

/// The rows for a person.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "mode                            runs   build ms  render ms   RMSE      max       FLIP      wrong  \
             standing"
        )?;
        for r in &self.modes {
            writeln!(
                f,
                "{:30} {:5} {:10.1} {:10.1}   {:.2e}  {:.2e}  {:.6} {:7}  {}",
                r.mode,
                r.runs,
                r.build_ms,
                r.render_ms,
                r.rmse,
                r.max,
                r.flip,
                r.hits_wrong,
                r.standing.name()
            )?;
        }
        for LeftOut { mode, reason } in &self.left_out {
            writeln!(f, "{mode:30} left out: {reason}")?;
        }
        let Stated { mode, build_ms, render_ms, .. } = &self.reference;
        let seconds = (build_ms + render_ms) * 1e-3;
        writeln!(f, "reference: {mode}, in {seconds:.2} s")
    }
}
