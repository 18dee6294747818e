//! The indices of faces. Nearly all faces of nearly all files can be handed to tobj unchanged,
//! which a scan tells; the others are parsed: those with negative indices, indices of nothing, or
//! corners that name different attributes.

use std::fmt::Write;
use std::num::{IntErrorKind, ParseIntError};

use smallvec::SmallVec;

use super::lexer::words;
use crate::error::{Error, Result};

/// The absolute indices of a corner's position, texture coordinates and normal, from 1; 0 for none.
pub type Corner = [u32; 3];

/// The attributes that the corners of a face name beside their positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Attributes {
    /// True if they name texture coordinates.
    pub uvs: bool,
    /// True if they name normals.
    pub normals: bool,
}

/// The index for something that cannot be there.
const OUT_OF_RANGE: u32 = u32::MAX;

/// Parses the corners after `f`; negative indices count back from the last of `so_far`.
///
/// # Errors
/// When a word is no corner.
pub fn parse_face(text: &str, so_far: [u32; 3]) -> Result<SmallVec<[Corner; 8]>> {
    words(text).map(|word| parse_corner(word, so_far)).collect()
}

/// Parses `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn parse_corner(word: &str, so_far: [u32; 3]) -> Result<Corner> {
    let broken = || {
        Error::input(format!("`{word}` is no corner of a face"))
            .help("`v`, `v/vt`, `v//vn` or `v/vt/vn`, each a whole number")
    };
    let mut corner = [0; 3];
    let mut parts = word.split('/');
    for (index, count) in corner.iter_mut().zip(so_far) {
        let part = parts.next().unwrap_or_default();
        if part.is_empty() {
            continue;
        }
        let number: i64 = part.parse().or_else(|error: ParseIntError| match error.kind() {
            IntErrorKind::PosOverflow | IntErrorKind::NegOverflow => Ok(0),
            _ => Err(broken()),
        })?;
        let absolute =
            if number < 0 { number.saturating_add(i64::from(count) + 1) } else { number };
        *index = u32::try_from(absolute).ok().filter(|&i| i > 0).unwrap_or(OUT_OF_RANGE);
    }
    if parts.next().is_some() || corner[0] == 0 {
        return Err(broken());
    }
    Ok(corner)
}

/// Writes a face whose corners name these attributes.
pub fn write_face(corners: &[Corner], attributes: Attributes, out: &mut String) {
    out.push('f');
    for [v, vt, vn] in corners {
        let Attributes { uvs, normals } = attributes;
        let _ = match (uvs, normals) {
            (false, false) => write!(out, " {v}"),
            (true, false) => write!(out, " {v}/{vt}"),
            (false, true) => write!(out, " {v}//{vn}"),
            (true, true) => write!(out, " {v}/{vt}/{vn}"),
        };
    }
    out.push('\n');
}

/// A face that tobj reads unchanged.
#[derive(Debug, PartialEq)]
pub struct PlainFace {
    /// The number of its corners, at least 3.
    pub corners: u64,
    /// The attributes that all of them name.
    pub attributes: Attributes,
}

/// Scans the corners after `f`; none unless there are three or more that name the same attributes, by
/// indices from 1 up to the `counts` of a file.
pub fn scan_face(line: &[u8], counts: [u32; 3]) -> Option<PlainFace> {
    let mut rest = line;
    let mut corners = 0;
    let mut is_named = [false; 3];
    loop {
        rest = rest.trim_ascii_start();
        if rest.is_empty() {
            let attributes = Attributes { uvs: is_named[1], normals: is_named[2] };
            return (corners > 2).then_some(PlainFace { corners, attributes });
        }
        let (corner, after) = scan_corner(rest)?;
        let names = corner.map(|i| i != 0);
        if corners > 0 && names != is_named || corner[0] == 0 {
            return None;
        }
        if corner[0] > counts[0] || corner[1] > counts[1] || corner[2] > counts[2] {
            return None;
        }
        (is_named, rest, corners) = (names, after, corners + 1);
    }
}

/// Scans `v`, `v/vt`, `v//vn` or `v/vt/vn`, and returns the rest after it: a space or the line's end.
fn scan_corner(word: &[u8]) -> Option<(Corner, &[u8])> {
    let (v, rest) = scan_digits(word)?;
    let (corner, rest) = match rest {
        [b'/', b'/', rest @ ..] => {
            let (vn, rest) = scan_nonzero(rest)?;
            ([v, 0, vn], rest)
        }
        [b'/', rest @ ..] => {
            let (vt, rest) = scan_nonzero(rest)?;
            match rest {
                [b'/', rest @ ..] => {
                    let (vn, rest) = scan_nonzero(rest)?;
                    ([v, vt, vn], rest)
                }
                _ => ([v, vt, 0], rest),
            }
        }
        _ => ([v, 0, 0], rest),
    };
    rest.first().is_none_or(u8::is_ascii_whitespace).then_some((corner, rest))
}

/// Scans an index that is not 0, which is no index.
fn scan_nonzero(text: &[u8]) -> Option<(u32, &[u8])> {
    scan_digits(text).filter(|(index, _)| *index != 0)
}

/// Scans a whole number of digits alone, and returns it with the rest after it.
pub fn scan_digits(text: &[u8]) -> Option<(u32, &[u8])> {
    let mut value = 0u32;
    let mut end = 0;
    while let Some(digit) = text.get(end).filter(|b| b.is_ascii_digit()) {
        value = value.checked_mul(10)?.checked_add(u32::from(digit - b'0'))?;
        end += 1;
    }
    (end > 0).then(|| (value, text.get(end..).unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plain_face_tells_its_corners_and_their_attributes() {
        let scanned = |text: &str| {
            let PlainFace { corners, attributes } = scan_face(text.as_bytes(), [4, 3, 2]).unwrap();
            (corners, [attributes.uvs, attributes.normals])
        };
        assert_eq!(scanned(" 1 2 3\r\n"), (3, [false, false]));
        assert_eq!(scanned("1/1 2/2 3/3 4/3"), (4, [true, false]));
        assert_eq!(scanned("1//1 2//2 3//2"), (3, [false, true]));
        assert_eq!(scanned("1/1/1 2/2/2 3/3/2"), (3, [true, true]));
    }

    #[test]
    fn faces_that_must_be_parsed_are_not_plain() {
        for text in [
            "1 2",
            "0 1 2",
            "1 2 5",
            "1/4 2/1 3/1",
            "1//3 2//1 3//1",
            "-1 2 3",
            "1/1 2 3",
            "1/ 2/ 3/",
            "1/0 2/0 3/0",
            "1/1/ 2/1/ 3/1/",
            "1 2 3#",
            "1 2 99999999999",
            "1 2 x",
            "1/1/1/1 2 3",
        ] {
            assert_eq!(scan_face(text.as_bytes(), [4, 3, 2]), None, "{text}");
        }
    }
}
