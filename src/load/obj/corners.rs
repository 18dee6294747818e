//! The corners of a face that needs a closer look: negative indices, indices of nothing, corners
//! that name different kinds of data.

use std::fmt::Write;
use std::num::{IntErrorKind, ParseIntError};

use smallvec::SmallVec;

use super::lines::words;
use crate::error::{Error, Result};

/// Absolute indices of a position, texture coordinates and a normal, from 1; 0 for none.
pub type Corner = [u32; 3];

/// What stands for an index of something that cannot be there.
const NOWHERE: u32 = u32::MAX;

/// The corners after `f`; negative indices count back from the last of `so_far`.
///
/// # Errors
/// When one of them is none.
pub fn corners(text: &str, so_far: [u32; 3]) -> Result<SmallVec<[Corner; 8]>> {
    words(text).map(|word| corner(word, so_far)).collect()
}

/// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn corner(word: &str, so_far: [u32; 3]) -> Result<Corner> {
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
        let absolute = match number {
            n if n < 0 => n.saturating_add(i64::from(count) + 1),
            n => n,
        };
        *index = u32::try_from(absolute).ok().filter(|&i| i > 0).unwrap_or(NOWHERE);
    }
    if parts.next().is_some() || corner[0] == 0 {
        return Err(broken());
    }
    Ok(corner)
}

/// Writes a face that names texture coordinates and normals where it `has` them.
pub fn write(corners: &[Corner], has: [bool; 2], out: &mut String) {
    out.push('f');
    for [v, vt, vn] in corners {
        let _ = match has {
            [false, false] => write!(out, " {v}"),
            [true, false] => write!(out, " {v}/{vt}"),
            [false, true] => write!(out, " {v}//{vn}"),
            [true, true] => write!(out, " {v}/{vt}/{vn}"),
        };
    }
    out.push('\n');
}
