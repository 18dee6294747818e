//! The numbers of faces: which faces of the file a group has, and which line each is in.

use std::ops::Range;

use super::lexer::lines;
use crate::scene::{ObjFaces, ObjLabels};

/// The numbers in the file, or in a chunk of it, of the faces of a group: ranges in the order of the
/// faces.
#[derive(Debug, Default)]
pub struct FaceNumbers(Vec<Range<u32>>);

impl FaceNumbers {
    /// Adds the number of the next face.
    pub fn add(&mut self, number: u32) {
        match self.0.last_mut() {
            Some(last) if last.end == number => last.end = number.saturating_add(1),
            _ => self.0.push(number..number.saturating_add(1)),
        }
    }

    /// Appends the numbers of a chunk, before which there are so many faces in the file.
    pub fn append(&mut self, chunk: Self, before: u32) {
        for Range { start, end } in chunk.0 {
            let range = start.saturating_add(before)..end.saturating_add(before);
            match self.0.last_mut() {
                Some(last) if last.end == range.start => last.end = range.end,
                _ => self.0.push(range),
            }
        }
    }

    /// Returns the numbers.
    pub fn iter(&self) -> impl Iterator<Item = u32> {
        self.0.iter().cloned().flatten()
    }
}

/// Reads the lines and the names of all faces of a text, whether or not they get into a mesh.
pub fn read_faces(text: &str) -> ObjFaces {
    let mut faces = ObjFaces::default();
    let mut labels = ObjLabels::default();
    let name = |rest: &str| (!rest.is_empty()).then(|| rest.to_owned());
    for line in lines(text) {
        // Most lines are vertices.
        if line.text.starts_with(['v', '#']) {
            continue;
        }
        let statement = line.statement();
        let rest = statement.rest.as_ref();
        match statement.keyword.as_ref() {
            "f" | "fo" => faces.add(u32::try_from(line.number).unwrap_or(u32::MAX), &labels),
            "o" => labels.object = name(rest),
            "g" => labels.groups = rest.split_whitespace().map(str::to_owned).collect(),
            "usemtl" => labels.material = name(rest),
            _ => {}
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_chunks_continue_one_another() {
        let chunk = |numbers: &[u32]| {
            let mut chunk = FaceNumbers::default();
            numbers.iter().for_each(|&number| chunk.add(number));
            chunk
        };
        let mut file = FaceNumbers::default();
        file.append(chunk(&[0, 1, 3]), 0);
        file.append(chunk(&[0, 1]), 4);
        assert_eq!(file.0, [0..2, 3..6]);
        assert_eq!(file.iter().collect::<Vec<_>>(), [0, 1, 3, 4, 5]);
    }

    #[test]
    fn faces_have_the_lines_and_the_names_of_the_file() {
        let text =
            "o box\nf 1 2 3\nf 1 2 \\\n3\n# f\nfo 1 2 3\ng a b # c\nusemtl red\nf 1 2\ng\no\nf";
        let faces = read_faces(text);
        let found: Vec<_> = (0..6)
            .map_while(|i| faces.face(i))
            .map(|f| (f.line, f.object, f.groups.join("+"), f.material))
            .collect();
        let expected = [
            (2, Some("box"), "", None),
            (3, Some("box"), "", None),
            (6, Some("box"), "", None),
            (9, Some("box"), "a+b", Some("red")),
            (12, None, "", Some("red")),
        ];
        let expected = expected.map(|(line, o, g, m)| (line, o, g.to_owned(), m));
        assert_eq!(found, expected);
    }
}
