//! The URIs of a glTF file.

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use crate::error::{Error, Result};

/// The decoder of Base64, with or without its padding, as files have both.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// A parsed URI.
#[derive(Debug, PartialEq, Eq)]
pub enum Uri {
    /// The bytes in the URI itself.
    Data(Vec<u8>),
    /// A file, by the first of these names that exists.
    File(Vec<String>),
}

impl Uri {
    /// Parses a URI.
    ///
    /// # Errors
    /// When it is an address elsewhere, or data that cannot be decoded.
    pub fn parse(uri: &str) -> Result<Self> {
        if let Some((head, data)) = uri.split_at_checked(5)
            && head.eq_ignore_ascii_case("data:")
        {
            return decode_data(data).map(Self::Data);
        }

        // Anything else is a file: the path is the URI without its scheme.
        let path = match scheme(uri) {
            None => uri,
            // An absolute path like any other.
            Some(scheme) if scheme.eq_ignore_ascii_case("file") => {
                let rest = &uri[scheme.len() + 1..];
                rest.strip_prefix("//localhost").or(rest.strip_prefix("//")).unwrap_or(rest)
            }
            Some(scheme) => {
                return Err(Error::input(format!("`{scheme}:` addresses are not read"))
                    .help("name a file beside the model, or embed the data"));
            }
        };

        // The names that it may have.
        let mut names = Vec::new();
        if let Ok(decoded) = percent_decode_str(path).decode_utf8() {
            names.push(decoded.clone().into_owned());
            // Written on Windows.
            if decoded.contains('\\') {
                names.push(decoded.replace('\\', "/"));
            }
        }
        // A name that isn't UTF-8 once decoded, or a file whose own name has a % in it.
        if path.contains('%') {
            names.push(path.to_owned());
        }
        Ok(Self::File(names))
    }
}

/// Decodes the bytes of a data URI, without its `data:`.
fn decode_data(uri: &str) -> Result<Vec<u8>> {
    let (head, payload) = uri
        .split_once(',')
        .ok_or_else(|| Error::input("the data URI has no comma").help("`data:TYPE;base64,DATA`"))?;
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return Ok(percent_decode_str(payload).collect());
    }
    // Percent signs and line breaks are not base64, but stand in some files.
    let clean: Vec<u8> = percent_decode_str(payload).filter(|b| !b.is_ascii_whitespace()).collect();
    BASE64.decode(clean).map_err(|e| Error::input(format!("the base64 data is broken: {e}")))
}

/// Returns the scheme of a URI. One letter is a Windows drive, not a scheme.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let is_allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
    let is_scheme = scheme.len() > 1
        && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
        && scheme.chars().all(is_allowed);
    is_scheme.then_some(scheme)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(uri: &str) -> Vec<String> {
        match Uri::parse(uri).unwrap() {
            Uri::File(names) => names,
            Uri::Data(_) => panic!("{uri} is data"),
        }
    }

    #[test]
    fn base64_needs_no_padding() {
        assert_eq!(decode_data("x/y;base64,QUI").unwrap(), b"AB");
        assert_eq!(decode_data("x/y;base64,QUI=").unwrap(), b"AB");
    }

    #[test]
    fn data_without_base64_is_percent_encoded() {
        assert_eq!(decode_data("text/plain,a%20b%FF").unwrap(), b"a b\xFF");
    }

    #[test]
    fn scheme_is_not_a_drive() {
        assert_eq!(scheme("https://a/b.bin"), Some("https"));
        assert_eq!(scheme("c:/b.bin"), None);
        assert_eq!(scheme("b c.bin"), None);
    }

    #[test]
    fn a_name_is_decoded_once() {
        assert_eq!(names("a%252eb"), ["a%2eb", "a%252eb"]);
        assert_eq!(names("%ff.bin"), ["%ff.bin"]);
        assert_eq!(names("a b.bin"), ["a b.bin"]);
    }

    #[test]
    fn a_windows_path_is_a_path() {
        assert_eq!(names("a\\b%5Cc"), ["a\\b\\c", "a/b/c", "a\\b%5Cc"]);
    }

    #[test]
    fn a_file_uri_is_an_absolute_path() {
        assert_eq!(names("file:///a/b"), ["/a/b"]);
        assert_eq!(names("FILE://localhost/a"), ["/a"]);
        assert_eq!(names("file:/a"), ["/a"]);
    }

    #[test]
    fn an_address_elsewhere_is_refused() {
        for uri in ["http://a/b", "HTTPS://a/b", "ftp://a", "javascript:1", "blob:x"] {
            assert!(Uri::parse(uri).unwrap_err().message().ends_with("addresses are not read"));
        }
    }
}
