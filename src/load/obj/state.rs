//! The parser state at a position in an OBJ file, as the statements before it determine it.

use super::indices::Attributes;
use super::lexer::Statement;

/// The key by which faces are grouped into meshes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct FaceGroup {
    /// The settings that the faces have.
    pub settings: FaceSettings,
    /// The attributes that their corners name.
    pub attributes: Attributes,
}

impl FaceGroup {
    /// Returns the name of the material; empty for none.
    pub fn material_name(&self) -> &str {
        self.settings.material.as_deref().unwrap_or_default()
    }
}

/// The settings that statements make for the faces after them; `None` where there was no statement
/// yet.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct FaceSettings {
    /// The name of the object or group.
    pub name: Option<String>,
    /// The name of the material; empty for no material.
    pub material: Option<String>,
    /// The smoothing group; 0 for no smoothing.
    pub smoothing: Option<u32>,
}

impl FaceSettings {
    /// Applies a statement if it makes a setting, and returns true if so.
    pub fn apply(&mut self, statement: &Statement) -> bool {
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
}

/// The numbers of vertex data lines in a part of a file.
#[derive(Clone, Copy, Debug, Default)]
pub struct VertexCounts {
    /// The numbers of positions, texture coordinates and normals.
    pub counts: [u32; 3],
    /// True if any position has a colour.
    pub has_colors: bool,
}

impl VertexCounts {
    /// Counts a line of vertex data of a kind: position, texture coordinates or normal.
    pub fn add(&mut self, kind: usize, line: &str) {
        if let Some(count) = self.counts.get_mut(kind) {
            *count = count.saturating_add(1);
        }
        // A colour makes six numbers, whatever their form.
        self.has_colors |= kind == 0 && {
            let spaces = line.bytes().fold(0u32, |n, b| n + u32::from((b == b' ') | (b == b'\t')));
            spaces > 5 && line.split('#').next().unwrap_or(line).split_whitespace().count() > 6
        };
    }
}

/// The parser state at a position in the file.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// The offset of the position, in bytes.
    pub offset: usize,
    /// The number of lines before it.
    pub lines: usize,
    /// The numbers of vertex data before it.
    pub vertices: VertexCounts,
    /// The settings for the faces after it.
    pub settings: FaceSettings,
}

impl State {
    /// Advances to the end of a chunk, whose own state is that at its end if the file began with
    /// it.
    pub fn advance(&mut self, chunk: State) {
        self.offset += chunk.offset;
        self.lines += chunk.lines;
        for (count, more) in self.vertices.counts.iter_mut().zip(chunk.vertices.counts) {
            *count = count.saturating_add(more);
        }
        self.vertices.has_colors |= chunk.vertices.has_colors;
        let FaceSettings { name, material, smoothing } = chunk.settings;
        let settings = &mut self.settings;
        settings.name = name.or(settings.name.take());
        settings.material = material.or(settings.material.take());
        settings.smoothing = smoothing.or(settings.smoothing);
    }
}
