//! The texture statements of an MTL file: options, then the file's name, which may hold spaces.

use super::file_lookup::unquote;

/// A texture statement.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureMap {
    /// The file's name.
    pub file: String,
    /// True if the image is not repeated, by `-clamp on`.
    pub is_clamped: bool,
    /// The factors of texture coordinates, by `-s`.
    pub scale: [f32; 2],
    /// The offset that is added to them then, by `-o`.
    pub offset: [f32; 2],
    /// The factor of a bump's height, by `-bm`.
    pub bump_scale: Option<f32>,
    /// The channel that is read, by `-imfchan`: 0 to 3, red, green, blue or alpha (`m`, the matte).
    pub channel: Option<u8>,
    /// The options that are not read.
    pub ignored: Vec<String>,
}

impl TextureMap {
    /// Parses the text after `map_Kd` and its kin; none where no file is named.
    pub fn parse(text: &str) -> Option<Self> {
        let mut map = Self {
            file: String::new(),
            is_clamped: false,
            scale: [1.0; 2],
            offset: [0.0; 2],
            bump_scale: None,
            channel: None,
            ignored: Vec::new(),
        };
        let mut file = text.trim();
        while let Some((option, rest)) = split_option(file) {
            let (values, rest) = split_values(option, rest);
            map.apply(option, values);
            file = rest;
        }
        unquote(file).clone_into(&mut map.file);
        (!map.file.is_empty()).then_some(map)
    }

    fn apply(&mut self, option: &str, values: &str) {
        let mut words = values.split_whitespace();
        match option.to_ascii_lowercase().as_str() {
            "-clamp" => self.is_clamped = values == "on",
            // The third number is for solid textures.
            "-s" => parse_numbers(&mut self.scale, words),
            "-o" => parse_numbers(&mut self.offset, words),
            // A gain of 1 over a base of 0, and no turbulence, change nothing.
            "-mm" if values.split_whitespace().map(str::parse).eq([Ok(0.0f32), Ok(1.0)]) => {}
            "-t" if words.all(|w| w.parse() == Ok(0.0f32)) => {}
            "-cc" if values == "off" => {}
            "-bm" if parse_number(values).is_some() => self.bump_scale = parse_number(values),
            "-imfchan" if values.len() == 1 && "rgbm".contains(values) => {
                self.channel = "rgbm".find(values).map(|at| at as u8);
            }
            // Luminance is that of a grey image, whose channels are alike.
            "-imfchan" if values == "l" => self.channel = Some(0),
            // These are about how pixels are mixed and kept.
            "-blendu" | "-blendv" | "-boost" | "-texres" | "-type" => {}
            other => self.ignored.push(format!("{other} {values}")),
        }
    }
}

/// Parses as many numbers as there are.
fn parse_numbers<'a>(numbers: &mut [f32], words: impl Iterator<Item = &'a str>) {
    for (number, word) in numbers.iter_mut().zip(words) {
        if let Some(value) = parse_number(word) {
            *number = value;
        }
    }
}

fn parse_number(text: &str) -> Option<f32> {
    text.parse().ok().filter(|x: &f32| x.is_finite())
}

/// Splits off an option at the beginning of a text; a name may start with a dash, too.
fn split_option(text: &str) -> Option<(&str, &str)> {
    let (option, rest) = split_word(text);
    value_counts(option).map(|_| (option, rest))
}

/// Returns the least and the greatest number of values of an option; vectors may be cut short.
fn value_counts(option: &str) -> Option<(usize, usize)> {
    Some(match option.to_ascii_lowercase().as_str() {
        "-blendu" | "-blendv" | "-bm" | "-boost" | "-cc" | "-clamp" | "-colorspace"
        | "-imfchan" | "-texres" | "-type" => (1, 1),
        "-mm" => (2, 2),
        "-o" | "-s" | "-t" => (1, 3),
        _ => return None,
    })
}

/// Splits off the values of an option at the beginning of a text.
fn split_values<'a>(option: &str, text: &'a str) -> (&'a str, &'a str) {
    let (least, most) = value_counts(option).unwrap_or_default();
    let mut rest = text;
    for i in 0..most {
        let (value, after) = split_word(rest);
        // An image may be called 2: the name is what stands last.
        if i >= least && (value.parse::<f32>().is_err() || after.is_empty()) {
            break;
        }
        rest = after;
    }
    let values = text.get(..text.len() - rest.len()).unwrap_or_default();
    (values.trim(), rest)
}

/// Splits off the first word and the space after it.
fn split_word(text: &str) -> (&str, &str) {
    match text.split_once(char::is_whitespace) {
        Some((word, rest)) => (word, rest.trim_start()),
        None => (text, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> Option<String> {
        TextureMap::parse(text).map(|m| m.file)
    }

    #[test]
    fn options_are_not_the_name() {
        assert_eq!(file("-s 2 2 1 -bm .3 tex.png").unwrap(), "tex.png");
        assert_eq!(file("-o 1 -clamp on a b.png").unwrap(), "a b.png");
        assert_eq!(file("-mm 0 1 \"c d.png\"").unwrap(), "c d.png");
    }

    #[test]
    fn name_may_be_a_number_or_start_with_a_dash() {
        assert_eq!(file("-s 2 2 3").unwrap(), "3");
        assert_eq!(file("-x.png").unwrap(), "-x.png");
    }

    #[test]
    fn values_of_options_are_read() {
        let map = TextureMap::parse("-clamp on -s 2 -o .5 -1 0 a").unwrap();
        assert!(map.is_clamped);
        assert_eq!((map.scale, map.offset), ([2.0, 1.0], [0.5, -1.0]));
        assert!(!TextureMap::parse("-clamp off a").unwrap().is_clamped);
    }

    #[test]
    fn bump_scale_and_channel_are_read() {
        let map = TextureMap::parse("-bm 0.3 -imfchan m a").unwrap();
        assert_eq!((map.bump_scale, map.channel), (Some(0.3), Some(3)));
        let map = TextureMap::parse("-bm x -imfchan z a").unwrap();
        assert_eq!((map.bump_scale, map.channel, map.ignored.len()), (None, None, 2));
    }

    #[test]
    fn options_that_would_change_the_image_are_named() {
        let ignored = |text: &str| TextureMap::parse(text).unwrap().ignored;
        assert_eq!(ignored("-mm 0.1 2 -t 1 a.png"), ["-mm 0.1 2", "-t 1"]);
        assert_eq!(ignored("-mm 0 1 -t 0 0 0 -blendu off -texres 64 a.png"), [""; 0]);
    }

    #[test]
    fn options_without_a_name_name_nothing() {
        assert_eq!(file("-s 2"), None);
        assert_eq!(file(""), None);
    }
}
