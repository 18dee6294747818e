//! Rewrites an OBJ file for tobj, which gives up at what it does not expect, without a line
//! number, and loses count where only some vertices of a mesh have normals.
//!
//! The text made here has the vertices first, then the faces with absolute indices that are known
//! to exist, sorted into [`Part`]s whose faces all have the same attributes.

use std::collections::HashMap;
use std::fmt::Write;

use super::lines::{Statement, statements};
use crate::error::{Error, Place, Result};
use crate::load::tally::Tally;
use crate::scene::DropReason;

/// Faces that become one mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Part {
    /// The object's or group's name.
    pub name: String,
    /// The material that it names; empty for none.
    pub material: String,
    /// Its smoothing group, when its faces have no normals of their own; 0 for none.
    pub smoothing: u32,
    has_uvs: bool,
    has_normals: bool,
}

/// An OBJ file rewritten.
#[derive(Debug, Default)]
pub struct Rewritten {
    /// What tobj is to read; its groups are named by their part's number.
    pub text: String,
    /// The parts.
    pub parts: Vec<Part>,
    /// The material libraries that the file names.
    pub libraries: Vec<String>,
}

/// How many of each kind of vertex data there are, so far or in all.
#[derive(Clone, Copy, Default)]
struct Counts {
    positions: i64,
    uvs: i64,
    normals: i64,
    colored: bool,
}

/// Rewrites a file.
///
/// # Errors
/// When a line's numbers are no numbers; the error names the line.
pub fn rewrite(text: &str, tally: &mut Tally) -> Result<Rewritten> {
    let mut total = Counts::default();
    statements(text).for_each(|s| total.add(&s));
    let mut rewriter = Rewriter {
        tally,
        total,
        so_far: Counts::default(),
        vertices: String::with_capacity(text.len() / 2),
        current: Part::default(),
        faces: Vec::new(),
        part_of: HashMap::new(),
        made: Rewritten::default(),
    };
    for statement in statements(text) {
        rewriter.statement(&statement).map_err(|e| e.place(Place::Line(statement.line)))?;
    }
    Ok(rewriter.finish())
}

impl Counts {
    fn add(&mut self, statement: &Statement) {
        match statement.keyword.as_ref() {
            "v" => {
                self.positions += 1;
                self.colored |= statement.rest.split_whitespace().nth(5).is_some();
            }
            "vt" => self.uvs += 1,
            "vn" => self.normals += 1,
            _ => {}
        }
    }
}

struct Rewriter<'t> {
    tally: &'t mut Tally,
    total: Counts,
    so_far: Counts,
    vertices: String,
    current: Part,
    /// The faces of each part, in its order.
    faces: Vec<String>,
    part_of: HashMap<Part, usize>,
    made: Rewritten,
}

/// A corner of a face: absolute indices from 1, 0 for none.
type Corner = [i64; 3];

impl Rewriter<'_> {
    fn statement(&mut self, statement: &Statement) -> Result<()> {
        let rest = statement.rest.as_ref();
        let line = || format!("line {}", statement.line);
        self.so_far.add(statement);
        match statement.keyword.as_ref() {
            "v" => self.position(rest, statement.line)?,
            "vt" => self.vector("vt", rest, 2, 1, statement.line)?,
            "vn" => self.vector("vn", rest, 3, 3, statement.line)?,
            "f" | "fo" => self.face(rest, statement.line)?,
            "o" | "g" => self.current.name = rest.to_owned(),
            "s" => self.current.smoothing = rest.parse().unwrap_or(0),
            "usemtl" => self.current.material = rest.to_owned(),
            "mtllib" if !rest.is_empty() => self.made.libraries.push(rest.to_owned()),
            "p" | "l" | "curv" | "curv2" | "surf" => {
                self.tally.read(1);
                self.tally.drop(DropReason::UnsupportedMode, 1, line);
            }
            _ => {}
        }
        Ok(())
    }

    /// `x y z`, with a weight (`x y z w`) or a colour (`x y z r g b`) after it.
    fn position(&mut self, rest: &str, line: usize) -> Result<()> {
        let words: Vec<&str> = rest.split_whitespace().collect();
        let numbers = self.numbers(&words, "v", 3, line)?;
        let weight = if numbers.len() == 4 { numbers.get(3).copied() } else { None };
        if weight == Some(0.0) {
            return Err(Error::input("the vertex has weight 0").help("`v x y z`"));
        }
        self.vertices.push('v');
        let shown = if numbers.len() >= 6 { 6 } else { 3 };
        for (word, number) in words.iter().zip(&numbers).take(shown) {
            self.push_number(word, *number);
        }
        if self.total.colored && shown == 3 {
            self.vertices.push_str(" 1 1 1");
        } else if let Some(weight) = weight {
            let _ = write!(self.vertices, " {weight}");
        }
        self.vertices.push('\n');
        Ok(())
    }

    /// A vector of which `most` numbers are used and `least` must be there.
    fn vector(
        &mut self,
        keyword: &str,
        rest: &str,
        most: usize,
        least: usize,
        line: usize,
    ) -> Result<()> {
        let words: Vec<&str> = rest.split_whitespace().collect();
        let numbers = self.numbers(&words, keyword, least, line)?;
        self.vertices.push_str(keyword);
        for (word, number) in words.iter().zip(&numbers).take(most) {
            self.push_number(word, *number);
        }
        for _ in numbers.len()..most {
            self.vertices.push_str(" 0");
        }
        self.vertices.push('\n');
        Ok(())
    }

    fn push_number(&mut self, word: &str, number: f32) {
        self.vertices.push(' ');
        // The file's own digits, lest anything be lost; what isn't finite is dealt with later.
        let digits = word.split('#').next().unwrap_or(word);
        self.vertices.push_str(if number.is_finite() { digits } else { "nan" });
    }

    fn numbers(
        &mut self,
        words: &[&str],
        keyword: &str,
        least: usize,
        line: usize,
    ) -> Result<Vec<f32>> {
        let numbers: Vec<f32> = words.iter().map(|w| number(w)).collect::<Result<_>>()?;
        if numbers.len() < least {
            let message = format!("`{keyword}` has {} numbers, and needs {least}", numbers.len());
            return Err(Error::input(message));
        }
        let bad = numbers.iter().any(|x| !x.is_finite());
        let reason = "{} lines of vertex data have a number that is not finite";
        self.tally.add(reason, u64::from(bad), || format!("line {line}"));
        Ok(numbers)
    }

    fn face(&mut self, rest: &str, line: usize) -> Result<()> {
        let at = || format!("line {line}");
        let corners: Vec<Corner> =
            rest.split_whitespace().map(|word| self.corner(word)).collect::<Result<_>>()?;
        let triangles = corners.len().saturating_sub(2).max(1) as u64;
        self.tally.read(triangles);
        if corners.len() < 3 {
            self.tally.drop(DropReason::Incomplete, triangles, at);
            return Ok(());
        }
        let missing = |c: &Corner| c[0] < 1 || c[0] > self.total.positions;
        if corners.iter().any(missing) {
            self.tally.drop(DropReason::IndexOutOfRange, triangles, at);
            return Ok(());
        }
        // What not every corner has, the face hasn't.
        let [uvs, normals] = [(1, self.total.uvs), (2, self.total.normals)].map(|(i, total)| {
            let in_range = |c: &Corner| c.get(i).is_some_and(|&x| x >= 1 && x <= total);
            let named = corners.iter().any(|c| c.get(i).is_some_and(|&x| x != 0));
            let all = corners.iter().all(in_range);
            (all, named && !all)
        });
        let reason = "{} faces do without normals or texture coordinates: at some corner they name \
                      none that is there";
        self.tally.add(reason, u64::from(uvs.1 || normals.1), at);
        let mut part = self.current.clone();
        (part.has_uvs, part.has_normals) = (uvs.0, normals.0);
        if part.has_normals {
            part.smoothing = 0;
        }
        let next = self.faces.len();
        let number = *self.part_of.entry(part.clone()).or_insert(next);
        if number == next {
            self.faces.push(String::new());
            self.made.parts.push(part.clone());
        }
        let Some(out) = self.faces.get_mut(number) else { return Ok(()) };
        out.push('f');
        for [v, vt, vn] in corners {
            let _ = match (part.has_uvs, part.has_normals) {
                (false, false) => write!(out, " {v}"),
                (true, false) => write!(out, " {v}/{vt}"),
                (false, true) => write!(out, " {v}//{vn}"),
                (true, true) => write!(out, " {v}/{vt}/{vn}"),
            };
        }
        out.push('\n');
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative indices count back from the last so far.
    fn corner(&self, word: &str) -> Result<Corner> {
        let word = word.split('#').next().unwrap_or(word);
        let broken = || {
            Error::input(format!("`{word}` is no corner of a face"))
                .help("`v`, `v/vt`, `v//vn` or `v/vt/vn`, each a whole number")
        };
        let counts = [self.so_far.positions, self.so_far.uvs, self.so_far.normals];
        let mut corner = [0; 3];
        let mut parts = word.split('/');
        for (index, count) in corner.iter_mut().zip(counts) {
            let part = parts.next().unwrap_or_default();
            if part.is_empty() {
                continue;
            }
            let number: i64 = part.parse().map_err(|_| broken())?;
            // What is out of range becomes −1, and is found out later.
            *index = match number {
                n if n < 0 => count.saturating_add(n).saturating_add(1),
                n => n,
            };
            if *index <= 0 {
                *index = -1;
            }
        }
        if parts.next().is_some() || corner[0] == 0 {
            return Err(broken());
        }
        Ok(corner)
    }

    fn finish(mut self) -> Rewritten {
        self.made.text = self.vertices;
        for (i, faces) in self.faces.into_iter().enumerate() {
            let _ = writeln!(self.made.text, "g {i}");
            self.made.text.push_str(&faces);
        }
        self.made
    }
}

/// A number; NaN in any spelling is one, and so is what lies beyond f32.
fn number(word: &str) -> Result<f32> {
    // Microsoft's old C library wrote 1.#QNAN, 1.#INF and -1.#IND.
    if word.contains(".#") {
        return Ok(f32::NAN);
    }
    let clean = word.split('#').next().unwrap_or(word);
    clean.parse().map_err(|_| {
        let comma = if clean.contains(',') { "decimals have a point, not a comma" } else { "" };
        let error = Error::input(format!("`{word}` is no number"));
        if comma.is_empty() { error } else { error.help(comma) }
    })
}
