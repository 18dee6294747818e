//! The properties of the chapters that can be seen without running anything.

use std::fs;

use super::book::{Chapter, LANGUAGES, all, chapters, links, root, tutorial};

/// The chapters of both languages side by side.
fn pairs() -> Vec<(Chapter, Chapter)> {
    let [fr, en] = LANGUAGES.map(chapters);
    assert_eq!(fr.len(), en.len(), "both languages have the same chapters");
    fr.into_iter().zip(en).collect()
}

#[test]
fn both_languages_number_their_chapters_alike() {
    for (i, (fr, en)) in pairs().iter().enumerate() {
        let number = format!("{}-", i + 1);
        assert!(fr.name().starts_with(&number), "{}", fr.place());
        assert!(en.name().starts_with(&number), "{}", en.place());
    }
}

#[test]
fn both_languages_show_the_same_pictures() {
    for (fr, en) in pairs() {
        assert_eq!(fr.pictures(), en.pictures(), "{}", en.place());
    }
}

#[test]
fn both_languages_show_the_same_blocks() {
    for (fr, en) in pairs() {
        let [fr, en] = [&fr, &en].map(|chapter| {
            let blocks = chapter.blocks.iter();
            blocks.map(|b| (&b.language, &b.comment, &b.text)).collect::<Vec<_>>()
        });
        assert_eq!(fr, en);
    }
}

#[test]
fn both_languages_have_the_same_headings() {
    for (fr, en) in pairs() {
        let [levels, same] = [&fr, &en].map(|chapter| {
            let headings = chapter.prose.lines().filter(|line| line.starts_with('#'));
            headings.map(|line| line.bytes().take_while(|b| *b == b'#').count()).collect::<Vec<_>>()
        });
        assert_eq!(levels, same, "{}", en.place());
    }
}

#[test]
fn both_languages_have_as_many_formulas() {
    for (fr, en) in pairs() {
        let [here, there] = [&fr, &en].map(|chapter| chapter.prose.matches("$$").count());
        assert_eq!(here, there, "{}", en.place());
    }
}

/// The web's Markdown takes `\,` for an escaped comma even within a formula, and knows no inline
/// formula that goes on in the next line.
#[test]
fn formulas_survive_markdown() {
    for chapter in all() {
        for line in chapter.prose.lines().filter(|line| line.contains('$')) {
            let eaten = line
                .split('\\')
                .skip(1)
                .any(|rest| rest.starts_with(|c: char| c.is_ascii_punctuation()));
            assert!(
                !eaten,
                "{}: a backslash before punctuation is lost in {line}",
                chapter.place()
            );
            assert!(
                line.matches('$').count() % 2 == 0,
                "{}: open formula: {line}",
                chapter.place()
            );
        }
    }
}

#[test]
fn first_line_leads_to_the_neighbours_the_contents_and_the_other_language() {
    for (language, other) in [("fr", "en"), ("en", "fr")] {
        let (these, those) = (chapters(language), chapters(other));
        for (i, chapter) in these.iter().enumerate() {
            let mut expected = Vec::new();
            expected.extend(i.checked_sub(1).map(|before| these[before].name()));
            expected.push("../README.md".to_owned());
            expected.extend(these.get(i + 1).map(|next| next.name()));
            expected.push(format!("../{other}/{}", those[i].name()));
            let first = chapter.prose.lines().next().unwrap_or_default();
            assert_eq!(links(first), expected, "first line of {}", chapter.place());
        }
    }
}

#[test]
fn contents_list_every_chapter() {
    let contents = fs::read_to_string(tutorial().join("README.md")).expect("it can be read");
    for language in LANGUAGES {
        for chapter in chapters(language) {
            let link = format!("{language}/{}", chapter.name());
            assert!(links(&contents).contains(&&*link), "{link} is not in the contents");
        }
    }
}

/// A heading's anchor, as it is made by what shows Markdown on the web.
fn anchor(heading: &str) -> String {
    let heading = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn links_lead_to_files_and_headings_that_are_there() {
    let mut pages: Vec<_> = all().into_iter().map(|chapter| chapter.path).collect();
    pages.extend(["README.md", "errata.md"].map(|name| tutorial().join(name)));
    for page in pages {
        let text = fs::read_to_string(&page).expect("it can be read");
        for link in links(&text).into_iter().filter(|link| !link.starts_with("http")) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { page.clone() } else { page.with_file_name(file) };
            assert!(target.exists(), "{}: {link} leads nowhere", page.display());
            if !heading.is_empty() {
                let text = fs::read_to_string(&target).expect("a page with headings is a text");
                let mut headings = text.lines().filter(|line| line.starts_with('#')).map(anchor);
                assert!(
                    headings.any(|a| a == heading),
                    "{}: {link}: no such heading",
                    page.display()
                );
            }
        }
    }
}

#[test]
fn every_committed_picture_is_shown() {
    let chapters = all();
    let shown: Vec<_> = chapters.iter().flat_map(Chapter::pictures).collect();
    for entry in fs::read_dir(tutorial().join("images")).expect("the folder is there") {
        let name = entry.expect("it can be read").file_name().display().to_string();
        assert!(shown.contains(&&*name), "no chapter shows {name}");
    }
}

/// A text without its white space.
fn squeezed(text: &str) -> String {
    text.split_whitespace().collect()
}

/// True if a line stands for others that are left out.
fn is_gap(line: &str) -> bool {
    line.trim().trim_start_matches(['/', '#']).trim() == "…"
}

#[test]
fn excerpts_stand_in_their_files() {
    for chapter in all() {
        let quoting = ["rust", "toml", "python"];
        for block in chapter.blocks.iter().filter(|b| quoting.contains(&&*b.language)) {
            let place = chapter.place();
            let file = block.comment.strip_prefix("from ").unwrap_or_else(|| {
                panic!("{place}: no `<!-- from PATH -->` before\n{}", block.text)
            });
            let source = fs::read_to_string(root().join(file))
                .unwrap_or_else(|e| panic!("{place}: {file}: {e}"));
            let source = squeezed(&source);
            let mut rest = &source[..];
            for part in block.text.lines().collect::<Vec<_>>().split(|line| is_gap(line)) {
                let part = squeezed(&part.concat());
                let at = rest.find(&part).unwrap_or_else(|| {
                    panic!("{place}: {file} has no longer, or not in this order:\n{}", block.text)
                });
                rest = &rest[at + part.len()..];
            }
        }
    }
}

#[test]
fn every_block_is_of_a_kind_that_is_held() {
    for chapter in all() {
        for block in &chapter.blocks {
            let known = ["sh", "rust", "toml", "python", "text"].contains(&&*block.language);
            assert!(known, "{}: nothing holds a block of `{}`", chapter.place(), block.language);
        }
    }
}
