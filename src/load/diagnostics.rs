//! What an importer reads, drops or changes, counted by reason, so that nothing is lost in silence
//! and a broken file doesn't print a million lines.

use std::collections::HashMap;
use std::path::Path;

use crate::load::report::{DropReason, LoadReport};
use crate::scene::Scene;

/// Counts, by reason, with the first place of each.
#[derive(Debug, Default)]
pub struct Diagnostics {
    entries: Vec<Entry>,
    /// Where among them each reason stands.
    known: HashMap<String, usize>,
    /// How many sentences of each kind there are.
    sentences: [u64; 3],
    report: LoadReport,
}

/// The most sentences of a kind that are said of a file; who wants more can mend these first.
const MAX_SENTENCES: u64 = 100;

#[derive(Debug)]
struct Entry {
    kind: Kind,
    reason: String,
    count: u64,
    first: String,
}

/// Where, beside the warnings, a sentence belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Note,
    Unsupported,
    Placeholder,
}

impl Diagnostics {
    /// Counts faces that were read.
    pub fn read(&mut self, faces: u64) {
        self.report.read += faces;
    }

    /// Counts faces that were read and are dropped; `place` says where the first of them is.
    pub fn drop(&mut self, reason: DropReason, faces: u64, place: impl FnOnce() -> String) {
        if faces > 0 {
            *self.report.dropped.entry(reason).or_default() += faces;
            self.add(reason.sentence(), faces, place);
        }
    }

    /// Adds `count` to a reason that something is changed, or is odd. The text has `{}` where the
    /// number belongs; `place` says where.
    pub fn add(&mut self, reason: &str, count: u64, place: impl FnOnce() -> String) {
        self.count(Kind::Note, reason, count, place);
    }

    /// As [`Diagnostics::add`], of a feature that a file uses and that is not supported.
    pub fn unsupported(&mut self, reason: &str, count: u64, place: impl FnOnce() -> String) {
        self.count(Kind::Unsupported, reason, count, place);
    }

    /// Adds a sentence that stands alone, once however often it is said.
    pub fn say(&mut self, sentence: impl Into<String>) {
        self.count(Kind::Note, &sentence.into(), 1, String::new);
    }

    /// As [`Diagnostics::add`], of pictures or materials in whose place a placeholder stands.
    pub fn placeholders(&mut self, reason: &str, count: u64, place: impl FnOnce() -> String) {
        self.count(Kind::Placeholder, reason, count, place);
    }

    /// As [`Diagnostics::say`], of a picture or materials in whose place a placeholder stands.
    pub fn placeholder(&mut self, sentence: impl Into<String>) {
        self.count(Kind::Placeholder, &sentence.into(), 1, String::new);
    }

    fn count(&mut self, kind: Kind, reason: &str, count: u64, place: impl FnOnce() -> String) {
        if count == 0 {
            return;
        }
        if let Some(&known) = self.known.get(reason) {
            self.entries[known].count += count;
            return;
        }
        self.sentences[kind as usize] += 1;
        if self.sentences[kind as usize] <= MAX_SENTENCES {
            let first = place();
            self.known.insert(reason.to_owned(), self.entries.len());
            self.entries.push(Entry { kind, reason: reason.to_owned(), count, first });
        }
    }

    /// Adds what another one has counted, which comes after.
    pub fn append(&mut self, later: Self) {
        for (own, all) in self.sentences.iter_mut().zip(later.sentences) {
            *own += all.saturating_sub(MAX_SENTENCES);
        }
        for entry in later.entries {
            self.count(entry.kind, &entry.reason, entry.count, || entry.first);
        }
        self.report.add(later.report);
    }

    /// The load report of a file that was imported as `scene`, with one warning for each reason,
    /// which begins with the file's name. Meshes without an instance are counted as dropped.
    pub fn finish(mut self, file: &Path, scene: &Scene) -> LoadReport {
        let mut stands = vec![false; scene.meshes.len()];
        for instance in &scene.instances {
            if let Some(stands) = stands.get_mut(instance.mesh.0 as usize) {
                *stands = true;
            }
        }
        for (mesh, stands) in scene.meshes.iter().zip(stands) {
            let faces = mesh.triangles.len() as u64;
            match stands {
                true => self.report.handed_over += faces,
                false => self.drop(DropReason::Flat, faces, || format!("mesh `{}`", mesh.name)),
            }
        }
        for kind in [Kind::Note, Kind::Unsupported, Kind::Placeholder] {
            let count = self.sentences[kind as usize].saturating_sub(MAX_SENTENCES);
            let (reason, first) =
                ("{} more warnings like these are left out".to_owned(), String::new());
            if count > 0 {
                self.entries.push(Entry { kind, reason, count, first });
            }
        }
        for entry in self.entries {
            let kind = entry.kind;
            let sentence = entry.sentence(file);
            match kind {
                Kind::Note => {}
                Kind::Unsupported => self.report.unsupported.push(sentence.clone()),
                Kind::Placeholder => self.report.placeholders.push(sentence.clone()),
            }
            self.report.warnings.push(sentence);
        }
        self.report
    }

    /// What it says, without a scene to say it of.
    #[cfg(test)]
    pub fn sentences(self, file: &Path) -> Vec<String> {
        self.finish(file, &Scene::default()).warnings
    }
}

impl Entry {
    fn sentence(&self, file: &Path) -> String {
        let text = match self.count {
            // One place says it: "1 faces" would be wrong, and "first at" what there are more of.
            1 => self.reason.replacen("{} ", "", 1),
            count => self.reason.replacen("{}", &count.to_string(), 1),
        };
        match (self.first.is_empty(), self.count) {
            (true, _) => format!("{}: {text}", file.display()),
            (false, 1) => format!("{}: {text}, at {}", file.display(), self.first),
            (false, _) => format!("{}: {text}, first at {}", file.display(), self.first),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    #[test]
    fn a_reason_is_counted_and_keeps_its_first_place() {
        let mut tally = Diagnostics::default();
        tally.add("{} normals mended", 2, || "meshes[0]".into());
        tally.add("{} normals mended", 3, || "meshes[1]".into());
        let said = tally.sentences(Path::new("a.glb"));
        assert_eq!(said, ["a.glb: 5 normals mended, first at meshes[0]"]);
    }

    #[test]
    fn a_sentence_is_said_once() {
        let mut tally = Diagnostics::default();
        tally.say("animations are not played");
        tally.say("animations are not played");
        assert_eq!(tally.sentences(Path::new("a")), ["a: animations are not played"]);
    }

    #[test]
    fn what_is_said_over_and_over_in_other_words_is_counted() {
        let mut tally = Diagnostics::default();
        (0..MAX_SENTENCES + 7).for_each(|i| tally.say(format!("picture {i} is missing")));
        let said = tally.sentences(Path::new("a"));
        assert_eq!(said.len() as u64, MAX_SENTENCES + 1);
        assert_eq!(said.last().unwrap(), "a: 7 more warnings like these are left out");
    }

    #[test]
    fn nothing_counted_is_nothing_said() {
        let mut tally = Diagnostics::default();
        tally.add("{} normals mended", 0, || unreachable!());
        tally.drop(DropReason::Degenerate, 0, || unreachable!());
        assert!(tally.sentences(Path::new("a")).is_empty());
    }

    #[test]
    fn the_report_has_what_is_lost_and_not_what_is_only_odd() {
        let mut tally = Diagnostics::default();
        tally.read(3);
        tally.drop(DropReason::NotFinite, 3, || "meshes[0]".into());
        tally.add("{} normals mended", 1, || "meshes[0]".into());
        tally.unsupported("{} meshes are knitted", 1, || "meshes[1]".into());
        tally.placeholder("images[0] is not there");
        let report = tally.finish(Path::new("a"), &Scene::default());
        assert_eq!(report.warnings.len(), 4);
        assert_eq!(report.unsupported, ["a: meshes are knitted, at meshes[1]"]);
        assert_eq!(report.placeholders, ["a: images[0] is not there"]);
        assert_eq!(report.to_string(), "3 read = 0 handed over + 3 not-finite");
    }

    #[test]
    fn faces_of_a_mesh_that_stands_nowhere_are_dropped() {
        let mut tally = Diagnostics::default();
        tally.read(1);
        let mut scene = Scene::default();
        scene.add_mesh(Mesh {
            positions: vec![[0.0; 3]],
            triangles: vec![[0; 3]],
            ..Mesh::default()
        });
        let report = tally.finish(Path::new("a"), &scene);
        assert_eq!(report.dropped, [(DropReason::Flat, 1)].into());
    }
}
