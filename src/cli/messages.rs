//! The messages on stderr: errors, warnings and progress.

use std::io::{IsTerminal, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::error::{Error, Location, Remedy};
use crate::load::LoadReport;
use crate::scene::{self, Scene};

/// Prints an error: file, place and message, the line of the file, and the help.
pub fn error(error: &Error) {
    to_stderr(&format(error));
}

/// Returns the warnings of a load, those about lost precision and, with `f32_rays` (as on Embree in precision
/// `fast`), that about meshes which coincide.
pub fn scene_warnings(report: &LoadReport, scene: &Scene, f32_rays: bool) -> Vec<String> {
    let lost = scene::precision_warnings(scene).into_iter().map(|warning| warning.message);
    let coincident = f32_rays.then(|| scene::coincident_meshes(scene)).flatten().map(|pair| {
        pair + ": which of them is seen, precision fast on Embree decides ray by ray; \
                --precision certified shows the first"
    });
    report.warnings.iter().cloned().chain(lost).chain(coincident).collect()
}

/// Returns a kind of object or its index, followed by its name if it has one.
pub fn labelled(kind: &str, name: &str) -> String {
    if name.is_empty() { kind.to_owned() } else { format!("{kind} `{name}`") }
}

/// Prints a warning.
pub fn warning(text: &str) {
    to_stderr(&format!("warning: {}\n", line(text)));
}

/// The most characters of a line of a message that are printed.
const MAX_LINE: usize = 2000;

/// Returns a text as one line of bounded length, with characters escaped that cannot be seen. Names in
/// an untrusted file can be of any length, and contain codes that move the cursor, begin a line that
/// looks like another message, hide text or reverse its direction.
pub fn line(text: &str) -> String {
    let escaped = |text: &str| text.chars().map(escape).collect::<String>();
    // Of a text that is too long once it is escaped, the beginning and the end.
    let head = first_beyond(text.char_indices(), MAX_LINE * 3 / 4).map(|(at, _)| at);
    let tail = first_beyond(text.char_indices().rev(), MAX_LINE / 4);
    match head.zip(tail.map(|(at, c)| at + c.len_utf8())) {
        Some((head, tail)) if head < tail => {
            format!("{} … {}", escaped(&text[..head]), escaped(&text[tail..]))
        }
        _ => escaped(text),
    }
}

/// Returns the first character, with its position, that does not fit into `limit` printed ones.
fn first_beyond(
    mut chars: impl Iterator<Item = (usize, char)>,
    limit: usize,
) -> Option<(usize, char)> {
    let mut length = 0;
    chars.find(|&(_, c)| {
        length += if is_visible(c) { 1 } else { escape(c).len() };
        length > limit
    })
}

/// Returns a character as it is printed.
fn escape(c: char) -> String {
    if is_visible(c) { String::from(c) } else { c.escape_unicode().to_string() }
}

/// True if a character can be seen, or is a space or a tab.
fn is_visible(c: char) -> bool {
    match c {
        '\t' => true,
        // Soft hyphens, fillers and other characters without width, marks and codes of the direction of
        // writing, separators of lines and paragraphs, tags, byte order marks.
        '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' => {
            false
        }
        '\u{180b}'..='\u{180f}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' => false,
        '\u{2060}'..='\u{206f}' | '\u{2800}' | '\u{3164}' | '\u{feff}' | '\u{ffa0}' => false,
        '\u{fff0}'..='\u{fffb}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e0fff}' => false,
        c => !c.is_control(),
    }
}

/// Prints to stderr; errors of writing are ignored.
pub fn to_stderr(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// True if progress is shown: unless the command is `quiet`, on a terminal.
fn shows_progress(quiet: bool) -> bool {
    !quiet && std::io::stderr().is_terminal()
}

/// Creates a progress bar of 1000 steps, which is hidden where no progress is shown.
pub fn progress_bar(quiet: bool) -> ProgressBar {
    if !shows_progress(quiet) {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// Creates a sign that work goes on of which no share is known; it is hidden where no progress is shown.
pub fn spinner(quiet: bool, what: &'static str) -> Spinner {
    if !shows_progress(quiet) {
        return Spinner(ProgressBar::hidden());
    }
    let bar = ProgressBar::new_spinner().with_message(what);
    // At once, and then from time to time.
    bar.tick();
    bar.enable_steady_tick(Duration::from_millis(100));
    Spinner(bar)
}

/// A sign on stderr that work goes on, until it is dropped.
pub struct Spinner(ProgressBar);

impl Drop for Spinner {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Shows the share done, in \[0, 1\].
pub fn set_progress(bar: &ProgressBar, share: f32) {
    bar.set_position((share * 1000.0) as u64);
}

/// Returns the text of an error, each line of it escaped.
fn format(error: &Error) -> String {
    // File, place and message, and the list that it announces.
    let mut place = String::new();
    if let Some(path) = error.path() {
        place += &format!("{}:", path.display());
    }
    if let Some(location) = error.location() {
        place += &format!("{location}:");
    }
    let space = if place.is_empty() { "" } else { " " };
    let mut text = format!("error: {}{space}{}\n", line(&place), line(error.message()));
    error.list().iter().for_each(|item| text += &format!("  {}\n", line(item)));
    // The line of the file, with its number and a mark under the place.
    if let Some(Location::Text { line: number, length, quote, before, .. }) = error.location() {
        let number = number.to_string();
        let margin = " ".repeat(number.len());
        // Tabs stay tabs, so that the mark is aligned with the text above it.
        let split = quote.char_indices().nth(*before).map_or(quote.len(), |(at, _)| at);
        let (ahead, rest) = (line(&quote[..split]), line(&quote[split..]));
        let indent: String = ahead.chars().map(|c| if c == '\t' { c } else { ' ' }).collect();
        let mark = "^".repeat(*length);
        text += &format!("{margin} |\n{number} | {ahead}{rest}\n{margin} | {indent}{mark}\n");
    }
    // The advice, and the flag that does what it says, or that is another way out.
    let flag = error.remedy().map(flag);
    let separator = if error.remedy() == Some(Remedy::RustBackend) { "; " } else { ": " };
    let help: Vec<&str> = error.advice().into_iter().chain(flag.as_deref()).collect();
    if !help.is_empty() {
        text += &format!("help: {}\n", line(&help.join(separator)));
    }
    text
}

/// Returns the flag that remedies an error.
fn flag(remedy: Remedy) -> String {
    match remedy {
        Remedy::AllowOutside => "`--allow-outside`".to_owned(),
        Remedy::RaiseLimit { name, least: Some(least) } => format!("`--limit {name}={least}`"),
        Remedy::RaiseLimit { name, least: None } => format!("`--limit {name}=NUMBER`"),
        Remedy::RustBackend => "`--backend rust` works without Embree".to_owned(),
        Remedy::ReferenceSamples(samples) => format!("`--reference-spp {samples}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn what_cannot_be_seen_is_escaped() {
        assert_eq!(line("a\u{1b}[2J\tb\u{7}\u{202e}é\n"), "a\\u{1b}[2J\tb\\u{7}\\u{202e}é\\u{a}");
        for c in "\r\n\u{85}\u{ad}\u{200b}\u{200d}\u{2028}\u{2029}\u{2066}\u{feff}\u{e0041}".chars()
        {
            assert_eq!(line(&format!("a{c}b")), format!("a{}b", c.escape_unicode()));
        }
        assert_eq!(line("Größe 大 \u{1f600}"), "Größe 大 \u{1f600}");
    }

    #[test]
    fn long_lines_are_cut_in_their_middle() {
        let cut = line(&format!("begin {} end", "x".repeat(1 << 20)));
        assert!(cut.starts_with("begin x") && cut.ends_with("x end") && cut.chars().count() < 2100);
        assert!(line(&"\u{200b}".repeat(1 << 20)).len() < 2100, "escapes count by their length");
        let whole = "é".repeat(MAX_LINE);
        assert_eq!(line(&whole), whole);
    }

    #[test]
    fn names_begin_no_line_of_their_own() {
        let error = Error::input("`a\nerror: b` is odd")
            .at(Path::new("x\ny"))
            .listing(vec!["c\nwarning: d".to_owned()])
            .help("e\nhelp: f");
        let lines = format(&error);
        assert_eq!(lines.lines().count(), 3, "{lines}");
    }

    #[test]
    fn error_quotes_the_line_and_marks_the_place() {
        let source = "[[sphere]]\n\tcentre = [0, 0, 0]\n";
        let error = Error::input("unknown key `centre`")
            .at(Path::new("s.toml"))
            .with_location(Location::in_text(source, 12..18))
            .help("did you mean `center`?");
        let expected = "error: s.toml:2:2: unknown key `centre`\n  |\n2 | \tcentre = [0, 0, 0]\n  \
                        | \t^^^^^^\nhelp: did you mean `center`?\n";
        assert_eq!(format(&error), expected);
    }
}
