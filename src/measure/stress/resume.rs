//! Finished cells in a file, so that a long sweep can be taken up again.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::report::Row;
use crate::error::{Error, Result};

/// What a row depends on besides its cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    pub version: String,
    pub embree: bool,
    pub seed: u64,
    /// Rays of a cell.
    pub size: u64,
}

/// One line of the file.
#[derive(Serialize, Deserialize)]
struct Line {
    #[serde(flatten)]
    conditions: Conditions,
    row: Row,
}

type Key = (String, String, String);

/// The rows that are finished, and the file that they are kept in.
pub struct Finished {
    rows: HashMap<Key, Row>,
    conditions: Conditions,
    file: Option<(PathBuf, File)>,
}

impl Finished {
    /// Reads what is finished, and opens the file for what will be.
    ///
    /// # Errors
    /// When the file cannot be read or written, or holds something else.
    pub fn open(path: Option<&Path>, conditions: Conditions) -> Result<Self> {
        let Some(path) = path else {
            return Ok(Self { rows: HashMap::new(), conditions, file: None });
        };
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(e) if e.kind() == ErrorKind::NotFound => String::new(),
            Err(e) => return Err(Error::io("read", path, &e)),
        };
        // A run that was killed may have left its last line unfinished.
        let (whole, rest) = text.split_at(text.rfind('\n').map_or(0, |end| end + 1));
        let mut rows = HashMap::new();
        let unfinished = Some(rest).filter(|rest| !rest.is_empty());
        for (i, line) in whole.lines().chain(unfinished).enumerate() {
            match serde_json::from_str::<Line>(line) {
                Ok(_) if unfinished == Some(line) => {} // Only its end of line is missing: again.
                Ok(line) if line.conditions == conditions => {
                    rows.insert(key(&line.row.goal, &line.row.cell, &line.row.method), line.row);
                }
                Ok(_) => {}
                Err(_) if unfinished == Some(line) && line.starts_with("{\"version\":") => {}
                Err(e) => {
                    return Err(Error::input(format!("line {} is no finished cell: {e}", i + 1))
                        .at(path)
                        .help(
                            "name a file of `envers stress --resume`, or one that is not there",
                        ));
                }
            }
        }
        let file = OpenOptions::new()
            .append(true)
            .create(true)
            .open(path)
            .and_then(|file| file.set_len(whole.len() as u64).map(|()| file))
            .map_err(|e| Error::io("write", path, &e))?;
        Ok(Self { rows, conditions, file: Some((path.to_owned(), file)) })
    }

    /// The row of a cell, if it is finished.
    pub fn row(&self, goal: &str, cell: &str, method: &str) -> Option<&Row> {
        self.rows.get(&key(goal, cell, method))
    }

    /// Keeps a finished row.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn keep(&mut self, row: &Row) -> Result<()> {
        let Some((path, file)) = &mut self.file else { return Ok(()) };
        let line = Line { conditions: self.conditions.clone(), row: row.clone() };
        let mut text = serde_json::to_string(&line)
            .map_err(|e| Error::failed(format!("the JSON cannot be made: {e}")))?;
        text.push('\n');
        file.write_all(text.as_bytes()).map_err(|e| Error::io("write", path, &e))
    }
}

fn key(goal: &str, cell: &str, method: &str) -> Key {
    (goal.to_owned(), cell.to_owned(), method.to_owned())
}
