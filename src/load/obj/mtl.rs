//! The normalization of an MTL file to a text that tobj reads without errors. tobj panics at a colour
//! of fewer than three numbers, and drops the whole file at a number it cannot read.

use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;

use glam::{Mat3, Vec3};

use super::lexer::lines;
use crate::load::diagnostics::Diagnostics;

/// The name of a material whose name is empty, for tobj.
pub const UNNAMED: &str = "(unnamed)";

/// The kind of value that a statement has after its keyword.
#[derive(Clone, Copy)]
enum ValueKind {
    /// Three numbers from 0 up, or one for a grey.
    Color,
    /// A number from 0 up.
    Number,
    /// A whole number from 0 to 10.
    IlluminationModel,
    /// Options and the name of an image.
    Texture,
    /// Any text: it changes nothing here.
    Ignored,
    /// Any text about a feature that is not supported.
    Unsupported(&'static str),
}

/// Returns a statement's keyword as tobj spells it, and the kind of value that it must have.
fn statement_kind(keyword: &str) -> Option<(&'static str, ValueKind)> {
    use ValueKind::{Color, Ignored, IlluminationModel, Number, Texture, Unsupported};
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
        "ps" => ("Ps", Number),
        "pc" => ("Pc", Number),
        "pcr" => ("Pcr", Number),
        "aniso" => ("aniso", Number),
        "anisor" => ("anisor", Number),
        "illum" => ("illum", IlluminationModel),
        "map_kd" => ("map_Kd", Texture),
        "map_ks" => ("map_Ks", Texture),
        "map_ke" => ("map_Ke", Texture),
        "map_ns" => ("map_Ns", Texture),
        "map_d" => ("map_d", Texture),
        "map_pr" => ("map_Pr", Texture),
        "map_pm" => ("map_Pm", Texture),
        "bump" | "map_bump" => ("bump", Texture),
        "norm" | "map_kn" => ("norm", Texture),
        // Ambient light is reflected by the diffuse colour.
        "ka" | "map_ka" | "sharpness" | "map_aat" => ("", Ignored),
        "map_ps" => ("", Unsupported("an image of sheen")),
        "refl" | "map_refl" => ("", Unsupported("an image that is mirrored")),
        "disp" | "map_disp" => ("", Unsupported("displacement")),
        "decal" => ("", Unsupported("a decal")),
        "map_tr" => ("", Unsupported("an image of transparency")),
        "map_tf" | "map_ni" => ("", Unsupported("an image of glass")),
        _ => return None,
    })
}

/// Normalizes the text of the file at `path` to statements that tobj reads, one on each line.
pub fn normalize(text: &str, path: &Path, diagnostics: &mut Diagnostics) -> String {
    let mut out = String::with_capacity(text.len());
    let mut names = HashSet::new();
    for line in lines(text) {
        let statement = line.statement();
        let (keyword, rest) = (statement.keyword.as_ref(), statement.rest.as_ref());
        let place = || format!("{}:{} (`{keyword} {rest}`)", path.display(), line.number);
        if keyword.is_empty() {
            continue;
        }
        // A new material.
        if keyword.eq_ignore_ascii_case("newmtl") {
            let name = if rest.is_empty() { UNNAMED } else { rest };
            let is_repeated = !names.insert(name.to_owned());
            diagnostics.add(
                "{} materials are there twice; the last of a name counts",
                u64::from(is_repeated),
                place,
            );
            let _ = writeln!(out, "newmtl {name}");
            continue;
        }
        // A statement about the present one.
        let Some((key, kind)) = statement_kind(keyword) else {
            diagnostics.add("{} lines are ignored: their first word is none of MTL", 1, place);
            continue;
        };
        if names.is_empty() {
            diagnostics.add("{} lines are ignored: they stand before the first `newmtl`", 1, place);
            continue;
        }
        // Its value, where tobj is to read it.
        match kind.normalize(rest) {
            Ok(Some(value)) => {
                let _ = writeln!(out, "{key} {value}");
            }
            Ok(None) => {}
            Err(Unusable::Malformed(expected)) => {
                diagnostics.add(
                    &format!("{{}} lines are ignored: `{key}` wants {expected}"),
                    1,
                    place,
                );
            }
            Err(Unusable::Unsupported(feature)) => {
                diagnostics.add(&format!("{{}} lines are not read that say {feature}"), 1, place);
            }
        }
    }
    out
}

/// The reason why a value is not used.
enum Unusable {
    /// The value is malformed; with the description of a valid one.
    Malformed(&'static str),
    /// The value is of a feature that is not supported; with its name.
    Unsupported(&'static str),
}

impl ValueKind {
    /// Returns a value as tobj is to read it; none if it is ignored.
    fn normalize(self, text: &str) -> Result<Option<String>, Unusable> {
        let number = |word: &str| word.parse::<f32>().ok().filter(|x| x.is_finite() && *x >= 0.0);
        let read = match self {
            Self::Ignored => return Ok(None),
            Self::Unsupported(feature) => {
                // Programs write 0 for what is not there.
                let is_off = text.split_whitespace().all(|w| number(w) == Some(0.0));
                return if is_off { Ok(None) } else { Err(Unusable::Unsupported(feature)) };
            }
            Self::Color if text.starts_with("xyz ") => {
                parse_xyz(text).map(|c| format!("{} {} {}", c.x, c.y, c.z))
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
            Self::IlluminationModel => {
                let model = text.parse::<f32>().ok().filter(|x| (0.0..=10.0).contains(x));
                model.map(|model| (model as u8).to_string())
            }
            Self::Texture => (!text.is_empty()).then(|| text.to_owned()),
        };
        read.map(Some).ok_or(Unusable::Malformed(match self {
            Self::Color => "three numbers from 0 up, or one",
            Self::Number => "a number from 0 up",
            Self::IlluminationModel => "a whole number from 0 to 10",
            _ => "the name of an image",
        }))
    }
}

/// Parses `xyz` and a colour in CIE XYZ (D65), and returns it in linear Rec. 709, by the matrix of
/// IEC 61966-2-1.
fn parse_xyz(text: &str) -> Option<Vec3> {
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

    fn normalized(text: &str) -> (String, Vec<String>) {
        let mut diagnostics = Diagnostics::default();
        let text = normalize(text, Path::new("a.mtl"), &mut diagnostics);
        (text, diagnostics.warnings(Path::new("a.obj")))
    }

    #[test]
    fn broken_lines_do_not_reach_tobj() {
        let text = "newmtl a\nKd 1\nKs 1 2\nNs x\nTf spectral a.rfl\nd -halo 0.5\nillum 99\nbump\n";
        let (text, said) = normalized(text);
        assert_eq!(text, "newmtl a\nKd 1 1 1\nd 0.5\n");
        assert_eq!(said.len(), 5);
        let first = "a.obj: lines are ignored: `Ks` wants three numbers from 0 up, or one, at \
                     a.mtl:3 (`Ks 1 2`)";
        assert_eq!(said[0], first);
    }

    #[test]
    fn white_in_xyz_is_white() {
        let white = parse_xyz("xyz 0.9505 1 1.089").unwrap();
        assert!((white - Vec3::ONE).abs().max_element() < 1e-3, "{white}");
        assert_eq!((parse_xyz("xyz 1 1"), parse_xyz("xyz nan")), (None, None));
    }

    #[test]
    fn keywords_in_any_case() {
        assert_eq!(normalized("NEWMTL a\nkd 1 1 1\nMAP_KD b").0, "newmtl a\nKd 1 1 1\nmap_Kd b\n");
    }

    #[test]
    fn unsupported_features_are_reported_unless_they_are_zero() {
        let (text, said) =
            normalized("newmtl a\ndisp 0\nmap_Ps 0.0\nmap_Tr 0.5\nrefl -type sphere a.png");
        assert_eq!(text, "newmtl a\n");
        assert!(said.len() == 2 && said[0].contains("transparency"), "{said:?}");
    }

    #[test]
    fn misplaced_and_unknown_statements_are_reported() {
        let (text, said) = normalized("Kd 1 1 1\nnewmtl a\nnewmtl a\nfoo");
        assert_eq!(text, "newmtl a\nnewmtl a\n");
        assert_eq!(said.len(), 3, "{said:?}");
    }
}
