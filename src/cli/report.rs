//! Messages to a person, on stderr.

use std::io::{IsTerminal, Write};

use indicatif::{ProgressBar, ProgressStyle};

use crate::error::{Error, Place, Remedy};
use crate::scene::{Scene, precision_warnings};

/// Prints an error: file, place and message; the line in question; the way out.
pub fn error(error: &Error) {
    to_stderr(&printable(&format(error)));
}

/// The warnings about lost precision, with the flag that avoids them.
pub fn precision_warnings(scene: &Scene, f32_rays: bool) -> impl Iterator<Item = String> {
    precision_warnings::precision_warnings(scene, f32_rays).into_iter().map(|warning| {
        let certified = "; --precision certified has no such limit";
        warning.message + if warning.is_of_fast_only { certified } else { "" }
    })
}

/// Prints a warning.
pub fn warning(text: &str) {
    to_stderr(&printable(&format!("warning: {text}\n")));
}

/// A text as a terminal may have it. Names in a stranger's file can hold codes that move the cursor,
/// hide text or turn it around; these are spelt out.
pub fn printable(text: &str) -> String {
    let is_safe = |c: char| match c {
        '\n' | '\t' => true,
        // What turns the direction of writing.
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => false,
        c => !c.is_control(),
    };
    let spelt = |c: char| if is_safe(c) { c.to_string() } else { c.escape_unicode().to_string() };
    text.chars().map(spelt).collect()
}

/// Prints to stderr; that nobody reads it is no reason to stop.
pub fn to_stderr(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// A bar of 1000 steps; none where nobody asked for it or would see it.
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

fn format(error: &Error) -> String {
    let mut text = String::from("error: ");
    if let Some(path) = error.path() {
        text += &format!("{}:", path.display());
    }
    if let Some(place) = error.place_in_file() {
        text += &format!("{place}:");
    }
    if error.path().is_some() || error.place_in_file().is_some() {
        text.push(' ');
    }
    text += error.message();
    text.push('\n');
    if let Some(Place::Text { line, column, length, quote }) = error.place_in_file() {
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        // Tabs stay tabs, so that the mark stands under what it means.
        let lead: String =
            quote.chars().take(column - 1).map(|c| if c == '\t' { c } else { ' ' }).collect();
        let mark = "^".repeat(*length);
        text += &format!("{margin} |\n{number} | {quote}\n{margin} | {lead}{mark}\n");
    }
    let flag = error.remedy().map(flag);
    let help: Vec<&str> = error.advice().into_iter().chain(flag.as_deref()).collect();
    if !help.is_empty() {
        text += &format!("help: {}\n", help.join(": "));
    }
    text
}

/// The flag of the command that is a way out of an error.
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
    use crate::scene::{Instance, MaterialId, Mesh, Sphere};
    use glam::{DAffine3, DVec3};

    #[test]
    fn warnings_of_fast_precision_name_the_flag_that_avoids_them() {
        let mut scene = Scene::default();
        let mesh = scene.add_mesh(Mesh {
            positions: vec![[0.0; 3], [0.0, 1e-4, 0.0], [0.0, 0.0, 1e-4]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
        scene.spheres.push(Sphere::new(DVec3::ZERO, 0.5, MaterialId(0)));
        let found: Vec<String> = precision_warnings(&scene, true).collect();
        assert!(found.len() == 1 && found[0].contains("--precision certified"), "{found:?}");
    }
    use std::path::Path;

    #[test]
    fn codes_for_the_terminal_are_spelt_out() {
        assert_eq!(printable("a\u{1b}[2J\tb\u{7}\u{202e}é\n"), "a\\u{1b}[2J\tb\\u{7}\\u{202e}é\n");
    }

    #[test]
    fn error_quotes_the_line_and_marks_the_place() {
        let source = "[[sphere]]\n\tcentre = [0, 0, 0]\n";
        let error = Error::input("unknown key `centre`")
            .at(Path::new("s.toml"))
            .place(Place::in_text(source, 12..18))
            .help("did you mean `center`?");
        let expected = "error: s.toml:2:2: unknown key `centre`\n  |\n2 | \tcentre = [0, 0, 0]\n  \
                        | \t^^^^^^\nhelp: did you mean `center`?\n";
        assert_eq!(format(&error), expected);
    }
}
