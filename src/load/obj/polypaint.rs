//! ZBrush's polypaint: vertex colours in comments, eight hexadecimal digits for each vertex.

use memchr::memmem;

use super::lexer::line_length;
use crate::load::diagnostics::Diagnostics;

/// The word that begins a line of polypaint.
const KEYWORD: &[u8] = b"#MRGB";

/// The colour of each vertex of a file, in the order of the vertices; empty if the file has none.
#[derive(Debug, Default)]
pub struct Polypaint(Vec<[u8; 3]>);

impl Polypaint {
    /// Reads the `#MRGB` lines of a text: mask, red, green and blue of up to 64 vertices each. The mask
    /// is about ZBrush's tools and changes nothing.
    pub fn read(text: &str, diagnostics: &mut Diagnostics) -> Self {
        let mut colors = Vec::new();
        for at in memmem::find_iter(text.as_bytes(), KEYWORD) {
            let (before, line) = text.split_at_checked(at).unwrap_or_default();
            // The word stands first in its line.
            if !before.trim_end_matches([' ', '\t']).ends_with('\n') && !before.trim().is_empty() {
                continue;
            }
            let line = line.get(..line_length(line.as_bytes())).unwrap_or_default();
            let digits: Vec<u8> = line
                .bytes()
                .skip(KEYWORD.len())
                .filter(|byte| !byte.is_ascii_whitespace())
                .map_while(|byte| (byte as char).to_digit(16).map(|digit| digit as u8))
                .collect();
            let (vertices, rest) = digits.as_chunks();
            colors.extend(vertices.iter().map(|&[_, _, r, s, g, h, b, c]: &[u8; 8]| {
                [(r, s), (g, h), (b, c)].map(|(high, low)| high << 4 | low)
            }));
            // What follows is off by a vertex or more, if digits are missing.
            let words = line.split_ascii_whitespace().skip(1).map(str::len).sum::<usize>();
            let is_broken = !rest.is_empty() || digits.len() != words;
            let reason = "{} lines of polypaint (`#MRGB`) are not of eight hexadecimal digits for each \
                          vertex";
            let place = || format!("line {}", before.matches('\n').count() + 1);
            diagnostics.add(reason, u64::from(is_broken), place);
        }
        Self(colors)
    }

    /// True if the file has none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the number of vertices that have a colour.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the colour of a vertex, by its index in the file: from 0 to 1, and white beyond the
    /// last.
    pub fn color(&self, vertex: u32) -> [f32; 3] {
        let color = self.0.get(vertex as usize).copied().unwrap_or([255; 3]);
        color.map(|x| f32::from(x) / 255.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Vec<[u8; 3]>, usize) {
        let mut diagnostics = Diagnostics::default();
        let Polypaint(colors) = Polypaint::read(text, &mut diagnostics);
        (colors, diagnostics.warnings(std::path::Path::new("a")).len())
    }

    #[test]
    fn lines_continue_one_another_with_and_without_spaces() {
        let text =
            "#MRGB ffff0000FF00ff00\nv 1 2 3\n  #MRGB 000000ff 00102030\r\n# a #MRGB 00000000\n";
        let expected = vec![[255, 0, 0], [0, 255, 0], [0, 0, 255], [16, 32, 48]];
        assert_eq!(read(text), (expected, 0));
    }

    #[test]
    fn broken_lines_are_a_warning() {
        assert_eq!(read("#MRGB ffff00"), (vec![], 1));
        assert_eq!(read("v 0 0 0\n#MRGB ff010203 xy\n"), (vec![[1, 2, 3]], 1));
        assert_eq!(read("#The following MRGB block contains\n#MRGB\n"), (vec![], 0));
    }
}
