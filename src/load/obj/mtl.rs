//! Puts an MTL file in the form that tobj takes. tobj panics at a colour of fewer than three
//! numbers, and drops the whole file at a number it cannot read.

use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;

use super::lines::lines;
use glam::{Mat3, Vec3};

use crate::load::diagnostics::Diagnostics;

/// The name, for tobj, of a material whose name is empty.
pub const UNNAMED: &str = "(unnamed)";

/// What a statement is followed by.
#[derive(Clone, Copy)]
enum Value {
    /// Three numbers from 0 up, or one for a grey.
    Color,
    /// A number from 0 up.
    Number,
    /// A whole number from 0 to 10.
    Model,
    /// Options and the name of a picture.
    Picture,
    /// Whatever: it changes nothing here.
    Silent,
    /// What has no counterpart here; said of which thing.
    Unread(&'static str),
}

/// A statement's keyword as tobj takes it, and what must follow it.
fn meaning(keyword: &str) -> Option<(&'static str, Value)> {
    use Value::{Color, Model, Number, Picture, Silent, Unread};
    // Programs differ in the case that they write.
    Some(match keyword.to_ascii_lowercase().as_str() {
        "kd" => ("Kd", Color),
        "ks" => ("Ks", Color),
        "ke" => ("Ke", Color),
        "tf" => ("Tf", Color),
        "ns" => ("Ns", Number),
        "ni" => ("Ni", Number),
        "d" => ("d", Number),
        "tr" => ("Tr", Number),
        "pr" => ("Pr", Number),
        "pm" => ("Pm", Number),
        "illum" => ("illum", Model),
        "map_kd" => ("map_Kd", Picture),
        "map_ks" => ("map_Ks", Picture),
        "map_ke" => ("map_Ke", Picture),
        "map_ns" => ("map_Ns", Picture),
        "map_d" => ("map_d", Picture),
        "map_pr" => ("map_Pr", Picture),
        "map_pm" => ("map_Pm", Picture),
        "bump" | "map_bump" => ("bump", Picture),
        "norm" | "map_kn" => ("norm", Picture),
        // Ambient light is reflected by the diffuse colour.
        "ka" | "map_ka" | "sharpness" | "map_aat" => ("", Silent),
        "ps" | "map_ps" => ("", Unread("sheen")),
        "pc" | "pcr" => ("", Unread("a clear coat")),
        "aniso" | "anisor" => ("", Unread("anisotropy")),
        "refl" | "map_refl" => ("", Unread("a picture that is mirrored")),
        "disp" | "map_disp" => ("", Unread("displacement")),
        "decal" => ("", Unread("a decal")),
        "map_tr" => ("", Unread("a picture of transparency")),
        "map_tf" | "map_ni" => ("", Unread("a picture of glass")),
        _ => return None,
    })
}

/// The statements that tobj is to read, of the file at `path`.
pub fn clean(text: &str, path: &Path, tally: &mut Diagnostics) -> String {
    let mut out = String::with_capacity(text.len());
    let mut names = HashSet::new();
    for line in lines(text) {
        let statement = line.statement();
        let (keyword, rest) = (statement.keyword.as_ref(), statement.rest.as_ref());
        let at = || format!("{}:{} (`{keyword} {rest}`)", path.display(), line.number);
        if keyword.is_empty() {
            continue;
        }
        if keyword.eq_ignore_ascii_case("newmtl") {
            let name = if rest.is_empty() { UNNAMED } else { rest };
            let again = u64::from(!names.insert(name.to_owned()));
            tally.add("{} materials are there twice; the last of a name counts", again, at);
            let _ = writeln!(out, "newmtl {name}");
            continue;
        }
        let Some((key, value)) = meaning(keyword) else {
            tally.add("{} lines are ignored: their first word is none of MTL", 1, at);
            continue;
        };
        if names.is_empty() {
            tally.add("{} lines are ignored: they stand before the first `newmtl`", 1, at);
            continue;
        }
        match value.read(rest) {
            Ok(Some(value)) => {
                let _ = writeln!(out, "{key} {value}");
            }
            Ok(None) => {}
            Err(Unusable::Broken(right)) => {
                tally.add(&format!("{{}} lines are ignored: `{key}` wants {right}"), 1, at);
            }
            Err(Unusable::Unread(what)) => {
                tally.add(&format!("{{}} lines are not read that say {what}"), 1, at);
            }
        }
    }
    out
}

/// Why a value is not used.
enum Unusable {
    /// It is not what this says.
    Broken(&'static str),
    /// There is nothing here that is like this.
    Unread(&'static str),
}

impl Value {
    /// What tobj is to read of the words after a keyword, if anything.
    fn read(self, text: &str) -> Result<Option<String>, Unusable> {
        let number = |word: &str| word.parse::<f32>().ok().filter(|x| x.is_finite() && *x >= 0.0);
        let read = match self {
            Self::Silent => return Ok(None),
            Self::Unread(what) => {
                // Programs write 0 for what is not there.
                let is_off = text.split_whitespace().all(|w| number(w) == Some(0.0));
                return if is_off { Ok(None) } else { Err(Unusable::Unread(what)) };
            }
            Self::Color if text.starts_with("xyz ") => {
                xyz(text).map(|c| format!("{} {} {}", c.x, c.y, c.z))
            }
            Self::Color => {
                let numbers: Option<Vec<f32>> = text.split_whitespace().map(number).collect();
                match numbers.as_deref() {
                    Some([grey]) => Some(format!("{grey} {grey} {grey}")),
                    Some([r, g, b, ..]) => Some(format!("{r} {g} {b}")),
                    _ => None,
                }
            }
            // `d -halo 0.5` has its number last.
            Self::Number => {
                text.split_whitespace().next_back().and_then(number).map(|x| x.to_string())
            }
            Self::Model => {
                let model = text.parse::<f32>().ok().filter(|x| (0.0..=10.0).contains(x));
                model.map(|model| (model as u8).to_string())
            }
            Self::Picture => (!text.is_empty()).then(|| text.to_owned()),
        };
        read.map(Some).ok_or(Unusable::Broken(match self {
            Self::Color => "three numbers from 0 up, or one",
            Self::Number => "a number from 0 up",
            Self::Model => "a whole number from 0 to 10",
            _ => "the name of a picture",
        }))
    }
}

/// `xyz` and a colour in CIE XYZ (D65): linear Rec. 709, by the matrix of IEC 61966-2-1.
fn xyz(text: &str) -> Option<Vec3> {
    let to_rec_709 = Mat3::from_cols_array_2d(&[
        [3.240_6, -0.968_9, 0.055_7],
        [-1.537_2, 1.875_8, -0.204_0],
        [-0.498_6, 0.041_5, 1.057_0],
    ]);
    let number = |word: &str| word.parse().ok().filter(|x: &f32| x.is_finite());
    let numbers: Option<Vec<f32>> = text.split_whitespace().skip(1).map(number).collect();
    // What no screen can show is brought to its edge.
    let color = |x, y, z| (to_rec_709 * Vec3::new(x, y, z)).max(Vec3::ZERO);
    match numbers?[..] {
        [x] => Some(color(x, x, x)),
        [x, y, z, ..] => Some(color(x, y, z)),
        _ => None,
    }
    .filter(|color| color.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cleaned(text: &str) -> (String, Vec<String>) {
        let mut tally = Diagnostics::default();
        let clean = clean(text, Path::new("a.mtl"), &mut tally);
        (clean, tally.sentences(Path::new("a.obj")))
    }

    #[test]
    fn broken_lines_do_not_reach_tobj() {
        let text = "newmtl a\nKd 1\nKs 1 2\nNs x\nTf spectral a.rfl\nd -halo 0.5\nillum 99\nbump\n";
        let (clean, said) = cleaned(text);
        assert_eq!(clean, "newmtl a\nKd 1 1 1\nd 0.5\n");
        assert_eq!(said.len(), 5);
        let first = "a.obj: lines are ignored: `Ks` wants three numbers from 0 up, or one, at \
                     a.mtl:3 (`Ks 1 2`)";
        assert_eq!(said[0], first);
    }

    #[test]
    fn white_in_xyz_is_white() {
        let white = xyz("xyz 0.9505 1 1.089").unwrap();
        assert!((white - Vec3::ONE).abs().max_element() < 1e-3, "{white}");
        assert_eq!((xyz("xyz 1 1"), xyz("xyz nan")), (None, None));
    }

    #[test]
    fn keywords_in_any_case() {
        assert_eq!(cleaned("NEWMTL a\nkd 1 1 1\nMAP_KD b").0, "newmtl a\nKd 1 1 1\nmap_Kd b\n");
    }

    #[test]
    fn what_is_not_read_is_said_unless_it_is_zero() {
        let (clean, said) = cleaned("newmtl a\nPs 0\naniso 0.0\nPc 0.5\nrefl -type sphere a.png");
        assert_eq!(clean, "newmtl a\n");
        assert!(said.len() == 2 && said[0].contains("clear coat"), "{said:?}");
    }

    #[test]
    fn statements_that_belong_nowhere_are_said() {
        let (clean, said) = cleaned("Kd 1 1 1\nnewmtl a\nnewmtl a\nfoo");
        assert_eq!(clean, "newmtl a\nnewmtl a\n");
        assert_eq!(said.len(), 3, "{said:?}");
    }
}
