//! A texture statement of an MTL file: options, then the file's name, which may hold spaces.

/// A texture statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Map<'a> {
    /// The file's name.
    pub file: &'a str,
    /// Whether the picture ends at its edges, by `-clamp on`.
    pub clamp: bool,
    /// Whether there are options that are not read.
    pub ignored: bool,
}

impl<'a> Map<'a> {
    /// Parses what follows `map_Kd` and its kin; nothing where no file is named.
    pub fn parse(text: &'a str) -> Option<Self> {
        let mut map = Self { file: text.trim(), clamp: false, ignored: false };
        while map.file.starts_with('-') {
            let (option, rest) = word(map.file);
            // How many values an option takes at least and at most. The vectors may be cut short.
            let (least, most) = match option {
                "-blendu" | "-blendv" | "-bm" | "-boost" | "-cc" | "-clamp" | "-colorspace"
                | "-imfchan" | "-texres" | "-type" => (1, 1),
                "-mm" => (2, 2),
                "-o" | "-s" | "-t" => (1, 3),
                // No option: a name that starts with a dash.
                _ => break,
            };
            let mut rest = rest;
            for i in 0..most {
                let (value, after) = word(rest);
                if i >= least && value.parse::<f32>().is_err() {
                    break;
                }
                // A picture may be called 2: the name is what stands last.
                if i >= least && after.is_empty() {
                    break;
                }
                if option == "-clamp" {
                    map.clamp = value == "on";
                }
                rest = after;
            }
            // These are about interpolation and channels, and seldom change the picture.
            let harmless = ["-blendu", "-blendv", "-bm", "-clamp", "-colorspace", "-imfchan"];
            map.ignored |= !harmless.contains(&option);
            map.file = rest;
        }
        let quoted = map.file.strip_prefix('"').and_then(|f| f.strip_suffix('"'));
        map.file = quoted.unwrap_or(map.file);
        (!map.file.is_empty()).then_some(map)
    }
}

/// The first word, and what follows it, trimmed.
fn word(text: &str) -> (&str, &str) {
    match text.split_once(char::is_whitespace) {
        Some((word, rest)) => (word, rest.trim()),
        None => (text, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> Option<&str> {
        Map::parse(text).map(|m| m.file)
    }

    #[test]
    fn options_are_not_the_name() {
        assert_eq!(file("-s 2 2 1 -bm .3 tex.png"), Some("tex.png"));
        assert_eq!(file("-o 1 -clamp on a b.png"), Some("a b.png"));
        assert_eq!(file("-mm 0 1 \"c d.png\""), Some("c d.png"));
    }

    #[test]
    fn name_may_be_a_number_or_start_with_a_dash() {
        assert_eq!(file("-s 2 2 3"), Some("3"));
        assert_eq!(file("-x.png"), Some("-x.png"));
    }

    #[test]
    fn clamp_is_read() {
        assert!(Map::parse("-clamp on a").unwrap().clamp);
        assert!(!Map::parse("-clamp off a").unwrap().clamp);
    }

    #[test]
    fn options_without_a_name_name_nothing() {
        assert_eq!(file("-s 2"), None);
        assert_eq!(file(""), None);
    }
}
