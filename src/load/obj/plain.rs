//! Tells at a glance the lines that tobj takes as they stand, as nearly all lines of nearly all
//! files: ASCII, with numbers that are surely finite, and faces whose vertices are there.

/// Digits before the point, counting the exponent's, of numbers that are surely finite in f32.
const MOST_DIGITS: u32 = 37;

/// The words after a keyword, if each is a finite number: how many there are.
pub fn numbers(line: &[u8]) -> Option<usize> {
    let mut rest = line;
    let mut count = 0;
    loop {
        rest = rest.trim_ascii_start();
        if rest.is_empty() {
            return Some(count);
        }
        rest = number(rest)?;
        count += 1;
    }
}

/// Skips a number, which a space or the line's end must follow.
fn number(word: &[u8]) -> Option<&[u8]> {
    let unsigned = match word {
        [b'+' | b'-', rest @ ..] => rest,
        _ => word,
    };
    let (whole, rest) = digits(unsigned);
    let (fraction, rest) = match rest {
        [b'.', rest @ ..] => digits(rest),
        _ => (0, rest),
    };
    if whole + fraction == 0 {
        return None;
    }
    let (exponent, rest) = match rest {
        [b'e' | b'E', b'-', rest @ ..] => (0, exponent(rest)?.1),
        [b'e' | b'E', b'+', rest @ ..] | [b'e' | b'E', rest @ ..] => exponent(rest)?,
        _ => (0, rest),
    };
    let ends = rest.first().is_none_or(u8::is_ascii_whitespace);
    (ends && whole + exponent <= MOST_DIGITS).then_some(rest)
}

/// How many digits a text begins with, and what follows them.
fn digits(text: &[u8]) -> (u32, &[u8]) {
    let end = text.iter().position(|b| !b.is_ascii_digit()).unwrap_or(text.len());
    // A number is short: what doesn't fit is no plain number.
    (u32::try_from(end).unwrap_or(MOST_DIGITS + 1), text.get(end..).unwrap_or_default())
}

/// An exponent of one or two digits, and what follows it.
fn exponent(text: &[u8]) -> Option<(u32, &[u8])> {
    let (value, rest) = index(text)?;
    (value < 100).then_some((value, rest))
}

/// A corner's indices: of its position, texture coordinates and normal, 0 for none.
type Corner = [u32; 3];

/// The corners after `f`, if there are three or more that name the same kinds of data, all within
/// the first `counts` of them: how many there are, and whether they
/// name texture coordinates and normals.
pub fn face(line: &[u8], counts: [u32; 3]) -> Option<(u64, [bool; 2])> {
    let mut rest = line;
    let mut count = 0;
    let mut kinds = [false; 3];
    loop {
        rest = rest.trim_ascii_start();
        if rest.is_empty() {
            return (count > 2).then_some((count, [kinds[1], kinds[2]]));
        }
        let (corner, after) = corner(rest)?;
        let named = corner.map(|i| i != 0);
        if count > 0 && named != kinds || corner[0] == 0 {
            return None;
        }
        if corner[0] > counts[0] || corner[1] > counts[1] || corner[2] > counts[2] {
            return None;
        }
        (kinds, rest, count) = (named, after, count + 1);
    }
}

/// `v`, `v/vt`, `v//vn` or `v/vt/vn`, and what follows it: a space or the line's end.
fn corner(word: &[u8]) -> Option<(Corner, &[u8])> {
    let (v, rest) = index(word)?;
    let (corner, rest) = match rest {
        [b'/', b'/', rest @ ..] => {
            let (vn, rest) = named(rest)?;
            ([v, 0, vn], rest)
        }
        [b'/', rest @ ..] => {
            let (vt, rest) = named(rest)?;
            match rest {
                [b'/', rest @ ..] => {
                    let (vn, rest) = named(rest)?;
                    ([v, vt, vn], rest)
                }
                _ => ([v, vt, 0], rest),
            }
        }
        _ => ([v, 0, 0], rest),
    };
    rest.first().is_none_or(u8::is_ascii_whitespace).then_some((corner, rest))
}

/// An index that is not 0, which would stand for none.
fn named(text: &[u8]) -> Option<(u32, &[u8])> {
    index(text).filter(|(index, _)| *index != 0)
}

/// A whole number of digits alone, and what follows it.
fn index(text: &[u8]) -> Option<(u32, &[u8])> {
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
    fn numbers_of_every_plain_form_are_counted() {
        assert_eq!(numbers(b" 1 -2.5\t+.5 6. 1e5 1E-45 2.5e+10 \r\n"), Some(7));
        assert_eq!(numbers(b"\n"), Some(0));
    }

    #[test]
    fn what_is_no_finite_number_is_not_plain() {
        for word in ["x", ".", "-", "1e", "1,5", "nan", "inf", "1e38", "1#", "1.#INF", "\u{a0}1"] {
            assert_eq!(numbers(word.as_bytes()), None, "{word}");
        }
        assert_eq!(numbers(&[b'9'; 38]), None);
    }

    #[test]
    fn plain_numbers_are_finite_and_rust_reads_them() {
        for word in ["+1", "6.", "-.5", "99999e32", "9999999999999999999999999999999999999"] {
            assert_eq!(numbers(word.as_bytes()), Some(1));
            assert!(word.parse::<f32>().unwrap().is_finite(), "{word}");
        }
    }

    #[test]
    fn faces_tell_what_they_name() {
        let face = |text: &str| face(text.as_bytes(), [4, 3, 2]);
        assert_eq!(face(" 1 2 3\r\n"), Some((3, [false, false])));
        assert_eq!(face("1/1 2/2 3/3 4/3"), Some((4, [true, false])));
        assert_eq!(face("1//1 2//2 3//2"), Some((3, [false, true])));
        assert_eq!(face("1/1/1 2/2/2 3/3/2"), Some((3, [true, true])));
    }

    #[test]
    fn faces_that_need_a_closer_look_are_not_plain() {
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
            assert_eq!(face(text.as_bytes(), [4, 3, 2]), None, "{text}");
        }
    }
}
