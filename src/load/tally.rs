//! What an importer drops or changes, counted by reason, so that nothing is lost in silence and a
//! broken file doesn't print a million lines.

use std::collections::HashMap;
use std::path::Path;

/// Counts, by reason, with the first place of each.
#[derive(Debug, Default)]
pub struct Tally {
    entries: Vec<Entry>,
    /// Where among them each reason stands.
    known: HashMap<String, usize>,
    /// How many sentences were one too many.
    left_out: u64,
}

/// The most sentences that are said of a file; who wants more can mend these first.
const MAX_SENTENCES: usize = 100;

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
        self.count(reason, count, place);
    }

    /// Adds a sentence that stands alone, once however often it is said.
    pub fn say(&mut self, sentence: impl Into<String>) {
        self.count(&sentence.into(), 1, String::new);
    }

    fn count(&mut self, reason: &str, count: u64, first: impl FnOnce() -> String) {
        if let Some(&known) = self.known.get(reason) {
            self.entries[known].count += count;
        } else if self.entries.len() < MAX_SENTENCES {
            self.known.insert(reason.to_owned(), self.entries.len());
            self.entries.push(Entry { reason: reason.to_owned(), count, first: first() });
        } else {
            self.left_out += 1;
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
        let left_out = (self.left_out > 0)
            .then(|| format!("{}: {} more warnings are left out", file.display(), self.left_out));
        self.entries.into_iter().map(sentence).chain(left_out).collect()
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
    fn what_is_said_over_and_over_in_other_words_is_counted() {
        let mut tally = Tally::default();
        (0..MAX_SENTENCES + 7).for_each(|i| tally.say(format!("picture {i} is missing")));
        let said = tally.sentences(Path::new("a"));
        assert_eq!(said.len(), MAX_SENTENCES + 1);
        assert_eq!(said.last().unwrap(), "a: 7 more warnings are left out");
    }

    #[test]
    fn nothing_counted_is_nothing_said() {
        let mut tally = Tally::default();
        tally.add("{} triangles dropped", 0, || unreachable!());
        assert!(tally.sentences(Path::new("a")).is_empty());
    }
}
