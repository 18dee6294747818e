//! The faces of an OBJ file: their lines, and the names that the statements before them give.

use super::ObjFace;

/// The lines and the names of all faces of an OBJ file, for runs of faces that are alike.
#[derive(Clone, Debug, Default)]
pub struct ObjFaces {
    /// The runs, by ascending number of their faces.
    runs: Vec<Run>,
    labels: Vec<ObjLabels>,
    /// The number of faces.
    count: u32,
}

/// The names that statements give to the faces after them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjLabels {
    /// The name of the object.
    pub object: Option<String>,
    /// The names of the groups.
    pub groups: Vec<String>,
    /// The name of the material.
    pub material: Option<String>,
}

/// Faces of the same names in lines that follow one another.
#[derive(Clone, Copy, Debug)]
struct Run {
    first_face: u32,
    first_line: u32,
    /// The index of the names.
    labels: u32,
}

impl ObjFaces {
    /// Adds the next face, which is in a `line` and has these `labels`.
    pub fn add(&mut self, line: u32, labels: &ObjLabels) {
        let face = self.count;
        self.count = face.saturating_add(1);
        let is_new = self.labels.last() != Some(labels);
        if is_new {
            self.labels.push(labels.clone());
        }
        let follows = |run: &Run| line.wrapping_sub(run.first_line) == face - run.first_face;
        if is_new || !self.runs.last().is_some_and(follows) {
            let labels = self.labels.len() as u32 - 1;
            self.runs.push(Run { first_face: face, first_line: line, labels });
        }
    }

    /// Returns a face by its number.
    pub fn face(&self, face: u32) -> Option<ObjFace<'_>> {
        let after = self.runs.partition_point(|run| run.first_face <= face);
        let run = self.runs.get(after.checked_sub(1)?).filter(|_| face < self.count)?;
        let ObjLabels { object, groups, material } = self.labels.get(run.labels as usize)?;
        Some(ObjFace {
            object: object.as_deref(),
            groups,
            material: material.as_deref(),
            face,
            line: run.first_line + (face - run.first_face),
        })
    }
}
