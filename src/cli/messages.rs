//! The messages on stderr: errors, warnings and progress.

use std::io::{IsTerminal, Write};

use indicatif::{ProgressBar, ProgressStyle};

use crate::error::{Error, Location, Remedy};
use crate::load::LoadReport;
use crate::scene::{self, Scene};

/// Prints an error: file, place and message, the line of the file, and the help.
pub fn error(error: &Error) {
    to_stderr(&escape_controls(&format(error)));
}

/// Returns the warnings of a load, and those about lost precision.
pub fn scene_warnings(report: &LoadReport, scene: &Scene) -> Vec<String> {
    let lost = scene::precision_warnings(scene).into_iter().map(|warning| warning.message);
    report.warnings.iter().cloned().chain(lost).collect()
}

/// Returns a kind of object or its index, followed by its name if it has one.
pub fn labelled(kind: &str, name: &str) -> String {
    if name.is_empty() { kind.to_owned() } else { format!("{kind} `{name}`") }
}

/// Prints a warning.
pub fn warning(text: &str) {
    to_stderr(&escape_controls(&format!("warning: {text}\n")));
}

/// Returns a text with control codes escaped. Names in an untrusted file can contain codes that move
/// the cursor, hide text or reverse its direction.
pub fn escape_controls(text: &str) -> String {
    let is_safe = |c: char| match c {
        '\n' | '\t' => true,
        // Codes that change the direction of writing.
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => false,
        c => !c.is_control(),
    };
    let escape = |c: char| if is_safe(c) { c.to_string() } else { c.escape_unicode().to_string() };
    text.chars().map(escape).collect()
}

/// Prints to stderr; errors of writing are ignored.
pub fn to_stderr(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// Creates a progress bar of 1000 steps; a hidden one if `quiet`, or if stderr is not a terminal.
pub fn progress_bar(quiet: bool) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// Shows the share done, in \[0, 1\].
pub fn set_progress(bar: &ProgressBar, share: f32) {
    bar.set_position((share * 1000.0) as u64);
}

/// Returns the text of an error.
fn format(error: &Error) -> String {
    let mut text = format!("error: {error:#}\n");
    // The line of the file, with its number and a mark under the place.
    if let Some(Location::Text { line, column, length, quote }) = error.location() {
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        // Tabs stay tabs, so that the mark is aligned with the text above it.
        let indent: String =
            quote.chars().take(column - 1).map(|c| if c == '\t' { c } else { ' ' }).collect();
        let mark = "^".repeat(*length);
        text += &format!("{margin} |\n{number} | {quote}\n{margin} | {indent}{mark}\n");
    }
    // The advice, and the flag that does what it says.
    let flag = error.remedy().map(flag);
    let help: Vec<&str> = error.advice().into_iter().chain(flag.as_deref()).collect();
    if !help.is_empty() {
        text += &format!("help: {}\n", help.join(": "));
    }
    text
}

/// Returns the flag that remedies an error.
fn flag(remedy: Remedy) -> String {
    match remedy {
        Remedy::AllowOutside => "`--allow-outside`".to_owned(),
        Remedy::RaiseLimit { name, least: Some(least) } => format!("`--limit {name}={least}`"),
        Remedy::RaiseLimit { name, least: None } => format!("`--limit {name}=NUMBER`"),
        Remedy::RustBackend => "`--backend rust`".to_owned(),
        Remedy::ReferenceSamples(samples) => format!("`--reference-spp {samples}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn control_codes_are_escaped() {
        assert_eq!(
            escape_controls("a\u{1b}[2J\tb\u{7}\u{202e}é\n"),
            "a\\u{1b}[2J\tb\\u{7}\\u{202e}é\n"
        );
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
