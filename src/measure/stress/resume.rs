//! The file of finished cases, from which an interrupted sweep can be resumed.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{Row, case::Case};
use crate::error::{Error, Result};

/// The conditions of a run, on which the results of its cases depend.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunConditions {
    pub version: String,
    pub embree: bool,
    pub seed: u64,
    /// The rays of a case.
    pub size: u64,
}

/// A line of the file.
#[derive(Serialize, Deserialize)]
struct Line {
    #[serde(flatten)]
    conditions: RunConditions,
    row: Row,
}

/// The finished cases, and the file in which they are recorded.
pub struct FinishedCases {
    /// The rows by goal, case and method.
    rows: HashMap<[String; 3], Row>,
    conditions: RunConditions,
    file: Option<(PathBuf, File)>,
}

impl FinishedCases {
    /// Reads the finished cases, and opens the file to append others.
    ///
    /// # Errors
    /// When the file cannot be read or written, or has other contents.
    pub fn open(path: Option<&Path>, conditions: RunConditions) -> Result<Self> {
        let Some(path) = path else {
            return Ok(Self { rows: HashMap::new(), conditions, file: None });
        };
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(e) if e.kind() == ErrorKind::NotFound => String::new(),
            Err(e) => return Err(Error::reading(path, &e)),
        };
        // A run that was killed may have left its last line incomplete.
        let (complete, rest) = text.split_at(text.rfind('\n').map_or(0, |end| end + 1));
        // The rows of runs under the same conditions; others stay in the file.
        let mut rows = HashMap::new();
        let incomplete = Some(rest).filter(|rest| !rest.is_empty());
        for (i, line) in complete.lines().chain(incomplete).enumerate() {
            match serde_json::from_str::<Line>(line) {
                Ok(_) if incomplete == Some(line) => {} // Only the end of the line is missing: run again.
                Ok(line) if line.conditions == conditions => {
                    let Row { goal, case, method, .. } = &line.row;
                    rows.insert([goal, case, method].map(String::clone), line.row);
                }
                Ok(_) => {}
                Err(_) if incomplete == Some(line) && line.starts_with("{\"version\":") => {}
                Err(e) => {
                    let message = format!("line {} is not a finished case: {e}", i + 1);
                    return Err(Error::input(message)
                        .at(path)
                        .help("name a file of an earlier run, or one that does not exist"));
                }
            }
        }
        // The file, without an incomplete last line.
        let file = OpenOptions::new().append(true).create(true).open(path);
        let cut = |file: File| file.set_len(complete.len() as u64).map(|()| file);
        let file = file.and_then(cut).map_err(|e| Error::writing(path, &e))?;
        Ok(Self { rows, conditions, file: Some((path.to_owned(), file)) })
    }

    /// Returns the row of a case, if it is finished.
    pub fn row(&self, goal: &str, case: &Case) -> Option<&Row> {
        self.rows.get(&[goal, &case.name, &case.method].map(str::to_owned))
    }

    /// Appends a finished row to the file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn append(&mut self, row: &Row) -> Result<()> {
        let Some((path, file)) = &mut self.file else { return Ok(()) };
        let line = Line { conditions: self.conditions.clone(), row: row.clone() };
        let mut text = serde_json::to_string(&line)
            .map_err(|e| Error::failed(format!("cannot create the JSON: {e}")))?;
        text.push('\n');
        file.write_all(text.as_bytes()).map_err(|e| Error::writing(path, &e))
    }
}
