//! From the bytes of an OBJ or MTL file to its statements: byte order marks, encodings, line
//! continuations and comments, none of which tobj takes.

use std::borrow::Cow;

use crate::error::{Error, Result};

/// The text of a file: UTF-8, or UTF-16 with its mark, or else Latin-1, as old exporters wrote.
///
/// # Errors
/// When it is no text at all.
pub fn decode(bytes: &[u8]) -> Result<Cow<'_, str>> {
    let units = |rest: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = rest.as_chunks().0.iter().map(|&pair| unit(pair)).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => return decode(rest),
        [0xFF, 0xFE, rest @ ..] => return Ok(units(rest, u16::from_le_bytes).into()),
        [0xFE, 0xFF, rest @ ..] => return Ok(units(rest, u16::from_be_bytes).into()),
        _ => {}
    }
    if bytes.contains(&0) {
        return Err(Error::input("this is a binary file, not Wavefront OBJ, which is text")
            .help("a compiler's object files end in .obj too"));
    }
    Ok(match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        // Each byte of Latin-1 is the character of its number.
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect::<String>().into(),
    })
}

/// A statement of a file: its first word, the rest, and the line on which it starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement<'a> {
    /// The first word.
    pub keyword: Cow<'a, str>,
    /// What follows it, trimmed, without a trailing comment.
    pub rest: Cow<'a, str>,
    /// The line, counted from 1.
    pub line: usize,
}

/// The statements of a text, with lines that end in `\` joined.
pub fn statements(text: &str) -> impl Iterator<Item = Statement<'_>> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        loop {
            let (number, first) = lines.next()?;
            let mut whole = Cow::Borrowed(first.trim());
            // A comment is not continued.
            while !whole.starts_with('#') && whole.ends_with('\\') {
                let joined = whole.to_mut();
                joined.pop();
                let Some((_, next)) = lines.next() else { break };
                joined.push(' ');
                joined.push_str(next.trim());
            }
            if let Some(statement) = split(whole, number + 1) {
                return Some(statement);
            }
        }
    })
}

fn split(line: Cow<'_, str>, number: usize) -> Option<Statement<'_>> {
    let length = strip_comment(&line).len();
    let end = line.find(char::is_whitespace).unwrap_or(length).min(length);
    let part = |range: std::ops::Range<usize>| match &line {
        Cow::Borrowed(line) => Cow::Borrowed(line.get(range).unwrap_or_default().trim()),
        Cow::Owned(line) => Cow::Owned(line.get(range).unwrap_or_default().trim().to_owned()),
    };
    let statement = Statement { keyword: part(0..end), rest: part(end..length), line: number };
    (!statement.keyword.is_empty()).then_some(statement)
}

/// Without a comment. One begins at a `#` that stands first or after a space: names may hold a
/// `#`, and so does Microsoft's `1.#QNAN`.
fn strip_comment(text: &str) -> &str {
    let starts = |(at, _): &(usize, &str)| {
        text.get(..*at).is_some_and(|before| before.is_empty() || before.ends_with([' ', '\t']))
    };
    match text.match_indices('#').find(starts) {
        Some((at, _)) => text.get(..at).unwrap_or(text).trim(),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<(String, String, usize)> {
        statements(text).map(|s| (s.keyword.into_owned(), s.rest.into_owned(), s.line)).collect()
    }

    fn one(keyword: &str, rest: &str, line: usize) -> (String, String, usize) {
        (keyword.into(), rest.into(), line)
    }

    #[test]
    fn comments_and_empty_lines_are_no_statements() {
        assert_eq!(all("# a\n\n  v 1 2 3 # b\r\n#\n"), [one("v", "1 2 3", 3)]);
    }

    #[test]
    fn backslash_joins_lines() {
        assert_eq!(all("f 1 \\\n 2 \\\n3\nv"), [one("f", "1  2  3", 1), one("v", "", 4)]);
    }

    #[test]
    fn comment_is_not_continued() {
        assert_eq!(all("# path C:\\\nv 1"), [one("v", "1", 2)]);
    }

    #[test]
    fn number_sign_within_a_name_is_no_comment() {
        assert_eq!(all("usemtl a#1 #b"), [one("usemtl", "a#1", 1)]);
    }

    #[test]
    fn backslash_at_the_end_of_the_file_ends() {
        assert_eq!(all("f 1 \\"), [one("f", "1", 1)]);
    }

    #[test]
    fn encodings() {
        assert_eq!(decode(b"\xEF\xBB\xBFv 1").unwrap(), "v 1");
        assert_eq!(decode(b"o caf\xE9").unwrap(), "o caf\u{e9}");
        assert_eq!(decode(b"\xFF\xFEv\0 \x001\0").unwrap(), "v 1");
        assert!(decode(b"\x4c\x01\0\0").is_err());
    }
}
