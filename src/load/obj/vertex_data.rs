//! The lines of vertex data. Nearly all of them can be handed to tobj unchanged, which a scan
//! tells; the others are parsed and rewritten: weights, colours, numbers in odd spellings.

use smallvec::SmallVec;

use super::indices::scan_digits;
use super::lexer::words;
use crate::error::{Error, Result};

/// The keywords of positions, texture coordinates and normals.
pub const KINDS: [&str; 3] = ["v", "vt", "vn"];

/// Rewrites vertex data of a kind for tobj, and returns true if all numbers are finite. A position
/// without a colour gets this one, in a file that has colours.
///
/// # Errors
/// When they are no numbers, or too few.
pub fn rewrite(kind: usize, text: &str, color: Option<[f32; 3]>, out: &mut String) -> Result<bool> {
    // The numbers that tobj wants, and those that there must be.
    let (wanted, least) = [(3, 3), (2, 1), (3, 3)][kind];
    let words: SmallVec<[&str; 8]> = words(text).collect();
    let numbers: SmallVec<[f64; 8]> =
        words.iter().map(|w| parse_number(w)).collect::<Result<_>>()?;
    if numbers.len() < least {
        let message = format!("`{}` has {} numbers, and needs {least}", KINDS[kind], numbers.len());
        return Err(Error::input(message));
    }
    // A position has 3 numbers, a weight, or a colour.
    let is_position = kind == 0;
    let weight = numbers.get(3).filter(|_| is_position && numbers.len() == 4);
    if weight == Some(&0.0) {
        return Err(Error::input("the vertex has weight 0").help("`v x y z`"));
    }
    let wanted = if is_position && numbers.len() >= 6 { 6 } else { wanted };
    // As many numbers as tobj wants.
    out.push_str(KINDS[kind]);
    for (word, number) in words.iter().zip(&numbers).take(wanted) {
        match weight {
            // tobj takes a weight or a colour.
            Some(weight) => push_word(out, &(number / weight).to_string()),
            // The file's own digits, lest anything be lost; what isn't finite is dealt with later.
            None if number.is_finite() => push_word(out, word),
            None => push_word(out, "nan"),
        }
    }
    for _ in numbers.len()..wanted {
        push_word(out, "0");
    }
    if is_position && wanted == 3 {
        color.into_iter().flatten().for_each(|x| push_word(out, &x.to_string()));
    }
    out.push('\n');
    Ok(numbers.iter().all(|x| x.is_finite()))
}

fn push_word(out: &mut String, word: &str) {
    out.push(' ');
    out.push_str(word);
}

/// Parses a number; NaN in any spelling is one, and so is what lies beyond f32. What begins as a number
/// and goes on as none (`3.1+e2`) counts as one that is not finite: nobody can tell which it is.
fn parse_number(word: &str) -> Result<f64> {
    if is_not_finite(word) {
        return Ok(f64::NAN);
    }
    let begins_as_number =
        word.trim_start_matches(['+', '-', '.']).starts_with(|c: char| c.is_ascii_digit());
    let has_comma = word.contains(',');
    match word.parse() {
        Ok(number) if f64::abs(number) <= f64::from(f32::MAX) => Ok(number),
        Ok(_) => Ok(f64::NAN),
        Err(_) if begins_as_number && !has_comma => Ok(f64::NAN),
        Err(_) => {
            let error = Error::input(format!("`{word}` is no number"));
            Err(if has_comma { error.help("decimals have a point, not a comma") } else { error })
        }
    }
}

/// True if a word is what some C library writes for a number that is not finite: `-nan(ind)` and
/// `nan(0x8000)`, `1.#QNAN` and `-1.#IND` of Microsoft's old one (cut short to `1.#J` by rounding),
/// `NaNQ` of AIX, `inf` and `Infinity`.
fn is_not_finite(word: &str) -> bool {
    // What may stand behind the name: its kind or its bits.
    let is_kind = |rest: &str| {
        matches!(rest, "" | "q" | "s" | "inity") || rest.starts_with('(') && rest.ends_with(')')
    };
    let name = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    let names = ["nan", "inf", "ind", "qnan", "snan"];
    word.contains(".#") || names.iter().any(|n| name.strip_prefix(n).is_some_and(is_kind))
}

/// The most digits before the point, counting the exponent's, of numbers that are surely finite in
/// f32.
const MAX_DIGITS: u32 = 37;

/// Scans the words after a keyword, and returns their number; none unless each is a finite number that
/// tobj reads unchanged.
pub fn scan_numbers(line: &[u8]) -> Option<usize> {
    let mut rest = line;
    let mut count = 0;
    loop {
        rest = rest.trim_ascii_start();
        if rest.is_empty() {
            return Some(count);
        }
        rest = scan_number(rest)?;
        count += 1;
    }
}

/// Scans a number, and returns the rest after it: a space or the line's end.
fn scan_number(word: &[u8]) -> Option<&[u8]> {
    let unsigned = match word {
        [b'+' | b'-', rest @ ..] => rest,
        _ => word,
    };
    let (whole, rest) = count_digits(unsigned);
    let (fraction, rest) = match rest {
        [b'.', rest @ ..] => count_digits(rest),
        _ => (0, rest),
    };
    if whole + fraction == 0 {
        return None;
    }
    let (exponent, rest) = match rest {
        [b'e' | b'E', b'-', rest @ ..] => (0, scan_exponent(rest)?.1),
        [b'e' | b'E', b'+', rest @ ..] | [b'e' | b'E', rest @ ..] => scan_exponent(rest)?,
        _ => (0, rest),
    };
    let ends = rest.first().is_none_or(u8::is_ascii_whitespace);
    (ends && whole + exponent <= MAX_DIGITS).then_some(rest)
}

/// Counts the digits at the beginning of a text, and returns the rest after them.
fn count_digits(text: &[u8]) -> (u32, &[u8]) {
    let end = text.iter().position(|b| !b.is_ascii_digit()).unwrap_or(text.len());
    // A number is short: what doesn't fit is no plain number.
    (u32::try_from(end).unwrap_or(MAX_DIGITS + 1), text.get(end..).unwrap_or_default())
}

/// Scans an exponent of one or two digits, and returns it with the rest after it.
fn scan_exponent(text: &[u8]) -> Option<(u32, &[u8])> {
    let (value, rest) = scan_digits(text)?;
    (value < 100).then_some((value, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_plain_form_are_counted() {
        assert_eq!(scan_numbers(b" 1 -2.5\t+.5 6. 1e5 1E-45 2.5e+10 \r\n"), Some(7));
        assert_eq!(scan_numbers(b"\n"), Some(0));
    }

    #[test]
    fn what_is_no_finite_number_is_not_plain() {
        for word in ["x", ".", "-", "1e", "1,5", "nan", "inf", "1e38", "1#", "1.#INF", "\u{a0}1"] {
            assert_eq!(scan_numbers(word.as_bytes()), None, "{word}");
        }
        assert_eq!(scan_numbers(&[b'9'; 38]), None);
    }

    #[test]
    fn what_c_libraries_write_for_no_number_is_not_finite() {
        for word in [
            "nan",
            "-nan",
            "+NaN",
            "nan(ind)",
            "-nan(ind)",
            "NAN(IND)",
            "nan(snan)",
            "-nan(0x8000000000000)",
            "nan()",
            "NaNQ",
            "nanS",
            "QNAN",
            "-sNaN",
            "1.#QNAN",
            "-1.#IND",
            "1.#IND00",
            "1.#INF",
            "-1.#INF",
            "1.#QNAN0e+000",
            "1.#J",
            "-1.#R",
            "inf",
            "-inf",
            "+Inf",
            "INFINITY",
            "-Infinity",
            "1e999",
        ] {
            assert!(parse_number(word).is_ok_and(|x| !x.is_finite()), "{word}");
        }
        for word in ["nano", "info", "indigo", "x", "(ind)", "nan(", "", "-"] {
            assert!(parse_number(word).is_err(), "{word}");
        }
    }

    #[test]
    fn plain_numbers_are_finite_and_rust_reads_them() {
        for word in ["+1", "6.", "-.5", "99999e32", "9999999999999999999999999999999999999"] {
            assert_eq!(scan_numbers(word.as_bytes()), Some(1));
            assert!(word.parse::<f32>().unwrap().is_finite(), "{word}");
        }
    }
}
