//! The warnings of an importer, counted by reason, so that nothing is lost silently and a broken
//! file does not print a million lines.

use std::collections::HashMap;
use std::path::Path;

use crate::load::report::{DropReason, LoadReport};
use crate::scene::Scene;

/// The warnings about a file so far, and the faces that were read and dropped.
#[derive(Debug, Default)]
pub struct Diagnostics {
    entries: Vec<CountedWarning>,
    /// The index of the entry of each reason.
    indices: HashMap<String, usize>,
    /// The number of different reasons of each kind.
    reasons: [u64; 3],
    report: LoadReport,
}

/// The most warnings of a kind about a file.
const MAX_WARNINGS: u64 = 100;

/// A warning, and how often there was a reason for it.
#[derive(Debug)]
struct CountedWarning {
    kind: Kind,
    /// The text, with `{}` where the count belongs.
    reason: String,
    count: u64,
    /// The place of the first; empty for a warning about no place.
    first_place: String,
}

/// The kind of a warning: the list of the load report that it is in, apart from the list of all
/// warnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A warning that is in no other list.
    Note,
    Unsupported,
    Placeholder,
}

impl Diagnostics {
    /// Counts faces that were read.
    pub fn read(&mut self, faces: u64) {
        self.report.read += faces;
    }

    /// Counts faces that were read and are dropped, and warns if something that could be seen is lost;
    /// `place` returns the place of the first of them.
    pub fn drop(&mut self, reason: DropReason, faces: u64, place: impl FnOnce() -> String) {
        if faces > 0 {
            *self.report.dropped.entry(reason).or_default() += faces;
            if let Some(warning) = reason.warning() {
                self.add(warning, faces, place);
            }
        }
    }

    /// Adds `count` to a warning that something is changed, or is odd. Its text has `{}` where the number
    /// belongs; `place` returns the place of the first.
    pub fn add(&mut self, reason: &str, count: u64, place: impl FnOnce() -> String) {
        self.count(Kind::Note, reason, count, place);
    }

    /// Adds `count` to a warning about a feature that is not supported, as [`Diagnostics::add`].
    pub fn unsupported(&mut self, reason: &str, count: u64, place: impl FnOnce() -> String) {
        self.count(Kind::Unsupported, reason, count, place);
    }

    /// Adds a warning that is not counted: it is given once, however often it is added.
    pub fn note(&mut self, sentence: impl Into<String>) {
        self.count(Kind::Note, &sentence.into(), 1, String::new);
    }

    /// Adds `count` to a warning about images or materials that have a placeholder, as
    /// [`Diagnostics::add`].
    pub fn placeholders(&mut self, reason: &str, count: u64, place: impl FnOnce() -> String) {
        self.count(Kind::Placeholder, reason, count, place);
    }

    /// Adds a warning about an image or materials that have a placeholder, as [`Diagnostics::note`].
    pub fn placeholder(&mut self, sentence: impl Into<String>) {
        self.count(Kind::Placeholder, &sentence.into(), 1, String::new);
    }

    /// Adds `count` to a warning.
    fn count(&mut self, kind: Kind, reason: &str, count: u64, place: impl FnOnce() -> String) {
        if count == 0 {
            return;
        }
        if let Some(&index) = self.indices.get(reason) {
            self.entries[index].count += count;
            return;
        }
        self.reasons[kind as usize] += 1;
        if self.reasons[kind as usize] <= MAX_WARNINGS {
            self.indices.insert(reason.to_owned(), self.entries.len());
            let (reason, first_place) = (reason.to_owned(), place());
            self.entries.push(CountedWarning { kind, reason, count, first_place });
        }
    }

    /// Appends the diagnostics of a later part of the file.
    pub fn append(&mut self, later: Self) {
        for (own, all) in self.reasons.iter_mut().zip(later.reasons) {
            *own += all.saturating_sub(MAX_WARNINGS);
        }
        for entry in later.entries {
            self.count(entry.kind, &entry.reason, entry.count, || entry.first_place);
        }
        self.report.add(later.report);
    }

    /// Returns the load report of a file that was imported as `scene`, with one warning for each reason,
    /// which begins with the file's name. Meshes without an instance are counted as dropped.
    pub fn into_report(mut self, file: &Path, scene: &Scene) -> LoadReport {
        // The faces of meshes with and without an instance.
        let mut has_instance = vec![false; scene.meshes.len()];
        for instance in &scene.instances {
            if let Some(has_instance) = has_instance.get_mut(instance.mesh.0 as usize) {
                *has_instance = true;
            }
        }
        for (mesh, has_instance) in scene.meshes.iter().zip(has_instance) {
            let faces = mesh.triangles.len() as u64;
            if has_instance {
                self.report.handed_over += faces;
            } else {
                self.drop(DropReason::Flat, faces, || format!("mesh `{}`", mesh.name));
            }
        }
        // The warnings, and the number of those that were too many.
        for kind in [Kind::Note, Kind::Unsupported, Kind::Placeholder] {
            let count = self.reasons[kind as usize].saturating_sub(MAX_WARNINGS);
            let reason = "{} more warnings like these are left out".to_owned();
            if count > 0 {
                let first_place = String::new();
                self.entries.push(CountedWarning { kind, reason, count, first_place });
            }
        }

        // Each warning is in the list of all, and some are in a list of their kind as well.
        for entry in self.entries {
            let sentence = entry.sentence(file);
            match entry.kind {
                Kind::Note => {}
                Kind::Unsupported => self.report.unsupported.push(sentence.clone()),
                Kind::Placeholder => self.report.placeholders.push(sentence.clone()),
            }
            self.report.warnings.push(sentence);
        }
        self.report
    }

    /// Returns the warnings, for a file without a scene.
    #[cfg(test)]
    pub fn warnings(self, file: &Path) -> Vec<String> {
        self.into_report(file, &Scene::default()).warnings
    }
}

impl CountedWarning {
    /// Returns the warning as a sentence.
    fn sentence(&self, file: &Path) -> String {
        let (text, at) = match self.count {
            // One place says it: "1 faces" would be wrong, and "first at" what there are more of.
            1 => (self.reason.replacen("{} ", "", 1), "at"),
            count => (self.reason.replacen("{}", &count.to_string(), 1), "first at"),
        };
        match &*self.first_place {
            "" => format!("{}: {text}", file.display()),
            place => format!("{}: {text}, {at} {place}", file.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    #[test]
    fn a_reason_is_counted_and_keeps_its_first_place() {
        let mut diagnostics = Diagnostics::default();
        diagnostics.add("{} normals mended", 2, || "meshes[0]".into());
        diagnostics.add("{} normals mended", 3, || "meshes[1]".into());
        let said = diagnostics.warnings(Path::new("a.glb"));
        assert_eq!(said, ["a.glb: 5 normals mended, first at meshes[0]"]);
    }

    #[test]
    fn a_note_is_given_once() {
        let mut diagnostics = Diagnostics::default();
        diagnostics.note("animations are not played");
        diagnostics.note("animations are not played");
        assert_eq!(diagnostics.warnings(Path::new("a")), ["a: animations are not played"]);
    }

    #[test]
    fn notes_beyond_the_most_are_counted() {
        let mut diagnostics = Diagnostics::default();
        (0..MAX_WARNINGS + 7).for_each(|i| diagnostics.note(format!("picture {i} is missing")));
        let said = diagnostics.warnings(Path::new("a"));
        assert_eq!(said.len() as u64, MAX_WARNINGS + 1);
        assert_eq!(said.last().unwrap(), "a: 7 more warnings like these are left out");
    }

    #[test]
    fn a_count_of_zero_is_no_warning() {
        let mut diagnostics = Diagnostics::default();
        diagnostics.add("{} normals mended", 0, || unreachable!());
        diagnostics.drop(DropReason::Degenerate, 0, || unreachable!());
        assert!(diagnostics.warnings(Path::new("a")).is_empty());
    }

    #[test]
    fn the_report_has_what_is_lost_and_not_what_is_only_odd() {
        let mut diagnostics = Diagnostics::default();
        diagnostics.read(3);
        diagnostics.drop(DropReason::NotFinite, 3, || "meshes[0]".into());
        diagnostics.add("{} normals mended", 1, || "meshes[0]".into());
        diagnostics.unsupported("{} meshes are knitted", 1, || "meshes[1]".into());
        diagnostics.placeholder("images[0] is not there");
        let report = diagnostics.into_report(Path::new("a"), &Scene::default());
        assert_eq!(report.warnings.len(), 4);
        assert_eq!(report.unsupported, ["a: meshes are knitted, at meshes[1]"]);
        assert_eq!(report.placeholders, ["a: images[0] is not there"]);
        assert_eq!(report.to_string(), "3 read = 0 handed over + 3 not-finite");
    }

    #[test]
    fn faces_of_a_mesh_without_an_instance_are_dropped() {
        let mut diagnostics = Diagnostics::default();
        diagnostics.read(1);
        let mut scene = Scene::default();
        scene.add_mesh(Mesh {
            positions: vec![[0.0; 3]].into(),
            triangles: vec![[0; 3]],
            ..Mesh::default()
        });
        let report = diagnostics.into_report(Path::new("a"), &scene);
        assert_eq!(report.dropped, [(DropReason::Flat, 1)].into());
    }
}
