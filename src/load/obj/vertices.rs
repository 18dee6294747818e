//! A line of vertex data that needs a closer look: weights, colours, numbers in odd spellings.

use smallvec::SmallVec;

use super::lines::words;
use crate::error::{Error, Result};

/// The keywords of positions, texture coordinates and normals.
pub const KINDS: [&str; 3] = ["v", "vt", "vn"];

/// Writes vertex data of a kind for tobj; in a file where a position is `colored`, all are.
/// Whether all of its numbers are finite.
///
/// # Errors
/// When they are no numbers, or too few.
pub fn write(kind: usize, text: &str, colored: bool, out: &mut String) -> Result<bool> {
    // How many numbers tobj wants, and how many there must be.
    let (wanted, least) = [(3, 3), (2, 1), (3, 3)][kind];
    let words: SmallVec<[&str; 8]> = words(text).collect();
    let numbers: SmallVec<[f32; 8]> = words.iter().map(|w| number(w)).collect::<Result<_>>()?;
    if numbers.len() < least {
        let message = format!("`{}` has {} numbers, and needs {least}", KINDS[kind], numbers.len());
        return Err(Error::input(message));
    }
    let is_position = kind == 0;
    let weight = numbers.get(3).filter(|_| is_position && numbers.len() == 4);
    if weight == Some(&0.0) {
        return Err(Error::input("the vertex has weight 0").help("`v x y z`"));
    }
    let wanted = if is_position && numbers.len() >= 6 { 6 } else { wanted };
    out.push_str(KINDS[kind]);
    for (word, number) in words.iter().zip(&numbers).take(wanted) {
        match weight {
            // tobj takes a weight or a colour.
            Some(weight) => push(out, &(number / weight).to_string()),
            // The file's own digits, lest anything be lost; what isn't finite is dealt with later.
            None if number.is_finite() => push(out, word),
            None => push(out, "nan"),
        }
    }
    for _ in numbers.len()..wanted {
        push(out, "0");
    }
    if is_position && colored && wanted == 3 {
        out.push_str(" 1 1 1");
    }
    out.push('\n');
    Ok(numbers.iter().all(|x| x.is_finite()))
}

fn push(out: &mut String, word: &str) {
    out.push(' ');
    out.push_str(word);
}

/// A number; NaN in any spelling is one, and so is what lies beyond f32. What begins as a number
/// and goes on as none (`3.1+e2`) counts as one that is not finite: nobody can tell which it is.
fn number(word: &str) -> Result<f32> {
    // Microsoft's old C library wrote 1.#QNAN, 1.#INF and -1.#IND.
    if word.contains(".#") {
        return Ok(f32::NAN);
    }
    let begins = word.trim_start_matches(['+', '-', '.']).starts_with(|c: char| c.is_ascii_digit());
    let comma = word.contains(',');
    match word.parse() {
        Ok(number) => Ok(number),
        Err(_) if begins && !comma => Ok(f32::NAN),
        Err(_) => {
            let error = Error::input(format!("`{word}` is no number"));
            Err(if comma { error.help("decimals have a point, not a comma") } else { error })
        }
    }
}
