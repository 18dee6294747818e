//! The lexer of OBJ and MTL files: byte order marks, encodings, line continuations and comments, none
//! of which tobj reads.

use std::borrow::Cow;

use crate::error::{Error, Result};

/// The number of bytes at the beginning of a file of which a binary file has a zero among them.
const HEAD_LENGTH: usize = 1 << 12;

/// Decodes the text of a file: UTF-8, or UTF-16 with its mark, or else Latin-1, as old exporters wrote;
/// lines that end in a carriage return alone, as on old Macs, end in a line feed.
///
/// # Errors
/// When it is no text at all.
pub fn decode_text(bytes: &[u8]) -> Result<Cow<'_, str>> {
    let text = decode_characters(bytes)?;
    let is_old_mac = !text.contains('\n') && text.contains('\r');
    Ok(if is_old_mac { text.replace('\r', "\n").into() } else { text })
}

fn decode_characters(bytes: &[u8]) -> Result<Cow<'_, str>> {
    let utf16 = |rest: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = rest.as_chunks().0.iter().map(|&pair| unit(pair)).collect();
        String::from_utf16_lossy(&units)
    };
    let bytes = match bytes {
        [0xFF, 0xFE, rest @ ..] => return Ok(utf16(rest, u16::from_le_bytes).into()),
        [0xFE, 0xFF, rest @ ..] => return Ok(utf16(rest, u16::from_be_bytes).into()),
        [0xEF, 0xBB, 0xBF, rest @ ..] => rest,
        _ => bytes,
    };
    if bytes.iter().take(HEAD_LENGTH).any(|&b| b == 0) {
        return Err(Error::input("this is a binary file, not Wavefront OBJ, which is text")
            .help("a compiler's object files end in .obj too"));
    }
    Ok(match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        // Each byte of Latin-1 is the character of its number.
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect::<String>().into(),
    })
}

/// A line as the file has it, line break and all; or several that `\` joins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<'a> {
    /// The text of the line.
    pub text: &'a str,
    /// The offset of the line in the text.
    pub start: usize,
    /// The number of its first line, counted from 1.
    pub number: usize,
}

/// A statement: the first word of a line, and the rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement<'a> {
    /// The first word; empty for a comment or an empty line.
    pub keyword: Cow<'a, str>,
    /// The text behind the first word, trimmed, without a trailing comment.
    pub rest: Cow<'a, str>,
}

/// Returns the lines of a text, with those that end in `\` joined.
pub fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let (mut start, mut next) = (0, 1);
    let has_continuations = memchr::memchr(b'\\', text.as_bytes()).is_some();
    std::iter::from_fn(move || {
        let rest = text.get(start..).filter(|rest| !rest.is_empty())?;
        if !has_continuations {
            let (length, number) = (line_length(rest.as_bytes()), next);
            let line = Line { text: rest.get(..length)?, start, number };
            (start, next) = (start + length, next + 1);
            return Some(line);
        }
        let (mut length, mut count) = (0, 0);
        loop {
            let line = rest.get(length..).unwrap_or_default();
            let end = line_length(line.as_bytes());
            let is_continued = line.get(..end).is_some_and(ends_in_backslash);
            (length, count) = (length + end, count + 1);
            // A comment is not continued.
            if !is_continued || length == rest.len() || rest.trim_start().starts_with('#') {
                break;
            }
        }
        let line = Line { text: rest.get(..length)?, start, number: next };
        (start, next) = (start + length, next + count);
        Some(line)
    })
}

/// Returns the length of the first line of a text, its line break included.
pub fn line_length(text: &[u8]) -> usize {
    memchr::memchr(b'\n', text).map_or(text.len(), |at| at + 1)
}

/// True if a line ends in `\`, spaces aside.
pub fn ends_in_backslash(line: &str) -> bool {
    line.as_bytes().trim_ascii_end().ends_with(b"\\")
}

impl<'a> Line<'a> {
    /// Returns the statement of the line.
    pub fn statement(&self) -> Statement<'a> {
        let line = self.text.trim();
        if line.starts_with('#') {
            return Statement { keyword: "".into(), rest: "".into() };
        }
        if !line.contains('\n') && !line.ends_with('\\') {
            return parse_statement(line);
        }
        let parts = line.lines().map(|part| part.trim().trim_end_matches('\\'));
        let joined = parts.collect::<Vec<_>>().join(" ");
        let Statement { keyword, rest } = parse_statement(&joined);
        let owned = |part: Cow<str>| Cow::Owned(part.into_owned());
        Statement { keyword: owned(keyword), rest: owned(rest) }
    }
}

fn parse_statement(line: &str) -> Statement<'_> {
    let line = strip_comment(line).trim();
    let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    Statement { keyword: keyword.into(), rest: rest.trim_start().into() }
}

/// Returns a text without its comment, which begins at a `#` that is first or after a space: names
/// may hold a `#`, and so does Microsoft's `1.#QNAN`.
fn strip_comment(text: &str) -> &str {
    let is_start = |(at, _): &(usize, &str)| {
        text.get(..*at).is_some_and(|before| before.is_empty() || before.ends_with([' ', '\t']))
    };
    match text.match_indices('#').find(is_start) {
        Some((at, _)) => text.get(..at).unwrap_or(text),
        None => text,
    }
}

/// Returns the words of a line of numbers, in which a comment may begin anywhere (`1 2 3# so`), save in
/// Microsoft's `1.#QNAN`, `1.#INF` and `-1.#IND`.
pub fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_start = |at: &usize| {
        let (before, after) = text.split_at_checked(*at).unwrap_or_default();
        let is_number = || {
            // The names, cut short by rounding where they are in capitals.
            let capitals = ["#I", "#Q", "#S", "#J", "#R"];
            let names = ["#inf", "#ind", "#qnan", "#snan"];
            capitals.iter().chain(&names).any(|name| after.starts_with(name))
        };
        !(before.ends_with('.') && is_number())
    };
    let end = memchr::memchr_iter(b'#', text.as_bytes()).find(is_start).unwrap_or(text.len());
    text.get(..end).unwrap_or(text).split_whitespace()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns keyword, rest and number of each line that is neither a comment nor empty.
    fn statements(text: &str) -> Vec<(String, String, usize)> {
        let statement = |line: Line| {
            let Statement { keyword, rest } = line.statement();
            (!keyword.is_empty()).then(|| (keyword.into(), rest.into(), line.number))
        };
        lines(text).filter_map(statement).collect()
    }

    fn statement(keyword: &str, rest: &str, line: usize) -> (String, String, usize) {
        (keyword.into(), rest.into(), line)
    }

    #[test]
    fn comments_and_empty_lines_are_no_statements() {
        assert_eq!(statements("# a\n\n  v 1 2 3 # b\r\n#\n"), [statement("v", "1 2 3", 3)]);
    }

    #[test]
    fn backslash_joins_lines() {
        assert_eq!(
            statements("f 1 \\\r\n 2 \\ \n3\nv"),
            [statement("f", "1  2  3", 1), statement("v", "", 4)]
        );
    }

    #[test]
    fn comment_is_not_continued() {
        assert_eq!(statements("# path C:\\\nv 1"), [statement("v", "1", 2)]);
    }

    #[test]
    fn number_sign_within_a_name_is_no_comment() {
        assert_eq!(statements("usemtl a#1 #b"), [statement("usemtl", "a#1", 1)]);
    }

    #[test]
    fn comment_may_follow_a_number_at_once() {
        let all = |text| words(text).map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(all("1 2 3.# so #"), ["1", "2", "3."]);
        assert_eq!(all("1.#QNAN -1.#IND 2#c"), ["1.#QNAN", "-1.#IND", "2"]);
        assert_eq!(all("1.#J 1.#inf 2.#jot"), ["1.#J", "1.#inf", "2."]);
    }

    #[test]
    fn backslash_at_the_end_of_the_file_ends() {
        assert_eq!(statements("f 1 \\"), [statement("f", "1", 1)]);
    }

    #[test]
    fn lines_together_are_the_text() {
        let text = "a \\\nb\n\n#c\\\nd";
        let found: Vec<_> = lines(text).collect();
        assert_eq!(found.iter().map(|l| l.text).collect::<String>(), text);
        assert!(found.iter().all(|l| text[l.start..].starts_with(l.text)));
    }

    #[test]
    fn encodings() {
        assert_eq!(decode_text(b"\xEF\xBB\xBFv 1").unwrap(), "v 1");
        assert_eq!(decode_text(b"o caf\xE9").unwrap(), "o caf\u{e9}");
        assert_eq!(decode_text(b"\xFF\xFEv\0 \x001\0").unwrap(), "v 1");
        assert!(decode_text(b"\x4c\x01\0\0").is_err());
    }

    #[test]
    fn lines_of_an_old_mac() {
        assert_eq!(decode_text(b"v 1\rv 2\r").unwrap(), "v 1\nv 2\n");
    }
}
