//! What an importer drops or changes, counted by reason, so that nothing is lost in silence and a
//! broken file doesn't print a million lines.

use std::path::Path;

/// Counts, by reason, with the first place of each.
#[derive(Debug, Default)]
pub struct Tally(Vec<Entry>);

#[derive(Debug)]
struct Entry {
    reason: String,
    count: u64,
    first: String,
}

impl Tally {
    /// Adds `count` to a reason. The text has `{}` where the number belongs; `place` says where.
    pub fn add(&mut self, reason: &str, count: u64, place: impl FnOnce() -> String) {
        if count == 0 {
            return;
        }
        match self.0.iter_mut().find(|e| e.reason == reason) {
            Some(entry) => entry.count += count,
            None => self.0.push(Entry { reason: reason.to_owned(), count, first: place() }),
        }
    }

    /// Adds a sentence that stands alone, once however often it is said.
    pub fn say(&mut self, sentence: impl Into<String>) {
        let sentence = sentence.into();
        if !self.0.iter().any(|e| e.reason == sentence) {
            self.0.push(Entry { reason: sentence, count: 1, first: String::new() });
        }
    }

    /// Adds what another one has counted, which comes after.
    pub fn append(&mut self, later: Self) {
        for entry in later.0 {
            match self.0.iter_mut().find(|e| e.reason == entry.reason) {
                Some(own) => own.count += entry.count,
                None => self.0.push(entry),
            }
        }
    }

    /// One sentence for each reason, with the file's name before it.
    pub fn sentences(self, file: &Path) -> Vec<String> {
        let sentence = |e: Entry| {
            let text = e.reason.replacen("{}", &e.count.to_string(), 1);
            match (e.first.is_empty(), e.count) {
                (true, _) => format!("{}: {text}", file.display()),
                (false, 1) => format!("{}: {text}, at {}", file.display(), e.first),
                (false, _) => format!("{}: {text}, first at {}", file.display(), e.first),
            }
        };
        self.0.into_iter().map(sentence).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_is_counted_and_keeps_its_first_place() {
        let mut tally = Tally::default();
        tally.add("{} triangles dropped", 2, || "meshes[0]".into());
        tally.add("{} triangles dropped", 3, || "meshes[1]".into());
        let said = tally.sentences(Path::new("a.glb"));
        assert_eq!(said, ["a.glb: 5 triangles dropped, first at meshes[0]"]);
    }

    #[test]
    fn a_sentence_is_said_once() {
        let mut tally = Tally::default();
        tally.say("animations are not played");
        tally.say("animations are not played");
        assert_eq!(tally.sentences(Path::new("a")), ["a: animations are not played"]);
    }

    #[test]
    fn nothing_counted_is_nothing_said() {
        let mut tally = Tally::default();
        tally.add("{} triangles dropped", 0, || unreachable!());
        assert!(tally.sentences(Path::new("a")).is_empty());
    }
}
