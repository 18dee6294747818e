//! What holds at a place of an OBJ file: what was counted and said before it.

use super::lines::Statement;

/// Faces that become one mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Part {
    /// What the file says of them.
    pub setting: Setting,
    /// Whether they name texture coordinates, and normals.
    pub has: [bool; 2],
}

/// What statements before a face say of it; nothing where none has said anything yet.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Setting {
    /// The object's or group's name.
    pub name: Option<String>,
    /// The material that it names; empty for none.
    pub material: Option<String>,
    /// Its smoothing group; 0 for none.
    pub smoothing: Option<u32>,
}

impl Setting {
    /// Follows a statement, if it is one that says something of the faces after it.
    pub fn follow(&mut self, statement: &Statement) -> bool {
        let rest = statement.rest.as_ref();
        match statement.keyword.as_ref() {
            "o" | "g" => self.name = Some(rest.to_owned()),
            "usemtl" => self.material = Some(rest.to_owned()),
            // `off`, too, means none.
            "s" => self.smoothing = Some(rest.parse().unwrap_or(u32::from(rest == "on"))),
            _ => return false,
        }
        true
    }

    /// What holds after `later` as well.
    fn then(&self, later: &Self) -> Self {
        Self {
            name: later.name.as_ref().or(self.name.as_ref()).cloned(),
            material: later.material.as_ref().or(self.material.as_ref()).cloned(),
            smoothing: later.smoothing.or(self.smoothing),
        }
    }
}

/// How many of each kind of vertex data there are.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Positions, texture coordinates and normals.
    pub of: [u32; 3],
    /// Whether a position has a colour.
    pub colored: bool,
}

/// What holds at a place of the file.
#[derive(Clone, Debug, Default)]
pub struct Place {
    /// Where in the text it is.
    pub start: usize,
    /// Lines before it.
    pub lines: usize,
    /// Vertex data before it.
    pub counts: Counts,
    /// What is said of the faces after it.
    pub setting: Setting,
}

impl Counts {
    /// Counts a line of vertex data of a kind: position, texture coordinates or normal.
    pub fn add(&mut self, kind: usize, line: &str) {
        if let Some(count) = self.of.get_mut(kind) {
            *count = count.saturating_add(1);
        }
        // Six numbers, whatever their form.
        self.colored |= kind == 0 && {
            let spaces = line.bytes().fold(0u32, |n, b| n + u32::from((b == b' ') | (b == b'\t')));
            spaces > 5 && line.split('#').next().unwrap_or(line).split_whitespace().count() > 6
        };
    }
}

impl Place {
    /// What holds after what `there` was surveyed of.
    pub fn then(&self, there: &Self) -> Self {
        let of = |k: usize| self.counts.of[k].saturating_add(there.counts.of[k]);
        Self {
            start: self.start + there.start,
            lines: self.lines + there.lines,
            counts: Counts {
                of: std::array::from_fn(of),
                colored: self.counts.colored || there.counts.colored,
            },
            setting: self.setting.then(&there.setting),
        }
    }
}
