//! The words and signs of Rust source text.

/// The tokens of a text that matter for paths: words, `::`, and single signs; comments, strings and
/// white space left out.
pub fn tokens(text: &str) -> Vec<&str> {
    let bytes = text.as_bytes();
    let is_word = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b >= 0x80;
    // Where `end` stands next from a place on, and its own length.
    let after = |from: usize, end: &str| {
        text[from..].find(end).map_or(text.len(), |length| from + length + end.len())
    };
    let (mut tokens, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let rest = &text[at..];
        let start = at;
        at = if rest.starts_with("//") {
            after(at, "\n")
        } else if rest.starts_with("/*") {
            after(at, "*/")
        } else if rest.starts_with("r\"") || rest.starts_with("r#") {
            let hashes = rest[1..].bytes().take_while(|b| *b == b'#').count();
            if rest.as_bytes().get(1 + hashes) == Some(&b'"') {
                after(at + 2 + hashes, &format!("\"{}", "#".repeat(hashes)))
            } else {
                at + 2
            }
        } else if rest.starts_with('"') {
            let mut end = at + 1;
            while end < bytes.len() && bytes[end] != b'"' {
                end += if bytes[end] == b'\\' { 2 } else { 1 };
            }
            end + 1
        } else if let Some(quoted) = rest.strip_prefix('\'') {
            // A character, which a quote closes, or a lifetime.
            let length = match quoted.chars().next() {
                Some('\\') => rest[3..].find('\'').map(|n| n + 4),
                Some(c) => quoted[c.len_utf8()..].starts_with('\'').then(|| c.len_utf8() + 2),
                None => None,
            };
            at + length.unwrap_or(1)
        } else if is_word(bytes[at]) {
            let length = rest.bytes().take_while(|b| is_word(*b)).count();
            tokens.push(&rest[..length]);
            at + length
        } else if rest.starts_with("::") {
            tokens.push("::");
            at + 2
        } else {
            if !bytes[at].is_ascii_whitespace() {
                tokens.push(&rest[..1]);
            }
            at + 1
        };
        debug_assert!(at > start);
    }
    tokens
}
