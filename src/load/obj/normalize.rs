//! The normalization of an OBJ file to a text that tobj reads without errors.
//!
//! Threads share the file in chunks. Since a line's meaning depends on those before it, and a face
//! may name a vertex that comes after it, the chunks are first [scanned](scan_chunk) for settings
//! and the numbers of vertices; then they are [parsed](super::parse), while tobj already
//! [reads](super::tobj_input) what is parsed.

use std::sync::mpsc;

use rayon::prelude::*;

use super::lexer::{ends_in_backslash, line_length, lines};
use super::parse::ChunkParser;
use super::polypaint::Polypaint;
use super::state::State;
use super::tobj_input::{FileInfo, TobjInput};
use super::vertex_data::KINDS;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;

/// The approximate number of bytes that a thread works on at a time.
const CHUNK: usize = 1 << 20;
/// The approximate number of bytes that are searched at once for lines that are no faces.
const BLOCK: usize = 1 << 12;

/// Normalizes a file for `read`, which runs on a thread of its own, and returns what that returns.
///
/// # Errors
/// When a line's numbers are no numbers; the error names the line. What `read` then makes of half
/// a file is dropped.
pub fn normalize<T: Send>(
    text: &str,
    diagnostics: &mut Diagnostics,
    read: impl FnOnce(&mut TobjInput) -> T + Send,
) -> Result<(FileInfo, T)> {
    // The state at the start of each chunk, and at the end of the file.
    let chunks: Vec<&str> = split(text, CHUNK).collect();
    let scanned: Vec<State> = chunks.par_iter().map(|chunk| scan_chunk(chunk)).collect();
    let mut state = State::default();
    let mut starts = Vec::with_capacity(chunks.len());
    for chunk in scanned {
        starts.push(state.clone());
        state.advance(chunk);
    }
    let mut total = state.vertices;
    // Colours in comments are written beside the positions that they belong to.
    let paint = Polypaint::read(text, diagnostics);
    total.has_colors |= !paint.is_empty();
    let (painted, positions) = (paint.len() as u64, u64::from(total.counts[0]));
    if !paint.is_empty() && painted != positions {
        let said =
            format!("{painted} vertices have a colour in comments (`#MRGB`), of {positions}");
        diagnostics.note(said);
    }
    let paint = &paint;
    // The chunks are parsed in parallel and sent to the reader.
    let (senders, receivers): (Vec<_>, Vec<_>) = chunks.iter().map(|_| mpsc::channel()).unzip();
    let mut input = TobjInput::new(text, receivers);
    std::thread::scope(|threads| {
        // The reader waits for the parsers, and so must be none of rayon's threads.
        let reader = threads.spawn(|| {
            let read = read(&mut input);
            input.into_info(diagnostics).map(|info| (info, read))
        });
        rayon::scope_fifo(|parsers| {
            for ((chunk, start), sender) in chunks.into_iter().zip(starts).zip(senders) {
                parsers.spawn_fifo(move |_| {
                    // After an error there is no receiver.
                    let _ = sender.send(ChunkParser::new(chunk, start, total, paint).parse());
                });
            }
        });
        reader.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Splits a text into pieces of about a `size`, behind lines that the next one does not continue.
fn split(text: &str, size: usize) -> impl Iterator<Item = &str> {
    let mut rest = text;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        // A line feed is never within a character.
        let mut end = size.min(rest.len());
        loop {
            end += line_length(rest.as_bytes().get(end..).unwrap_or_default());
            let last = rest.get(..end).unwrap_or_default();
            let last = last.get(last.trim_end().rfind('\n').unwrap_or(0)..).unwrap_or_default();
            if end >= rest.len() || !ends_in_backslash(last) {
                break;
            }
        }
        let (piece, after) = rest.split_at_checked(end).unwrap_or((rest, ""));
        rest = after;
        Some(piece)
    })
}

/// Returns the state at the end of a chunk, as if the file began with it.
fn scan_chunk(chunk: &str) -> State {
    let mut state = State { offset: chunk.len(), ..State::default() };
    for line in split(chunk, BLOCK).filter(|block| may_have_other_lines(block)).flat_map(lines) {
        let kind = match line.text.as_bytes() {
            [b'f' | b'#', b' ', ..] => continue,
            [b'v', b' ' | b'\t', ..] => 0,
            [b'v', b't', b' ' | b'\t', ..] => 1,
            [b'v', b'n', b' ' | b'\t', ..] => 2,
            _ => {
                let statement = line.statement();
                let Some(kind) = KINDS.iter().position(|kind| *kind == statement.keyword) else {
                    state.settings.apply(&statement);
                    continue;
                };
                kind
            }
        };
        state.vertices.add(kind, line.text);
    }
    state.lines = memchr::memchr_iter(b'\n', chunk.as_bytes()).count();
    state
}

/// True if some lines may be no faces: all keywords that [`scan_chunk`] looks for begin with letters
/// beyond `f`. Most of a file are faces, and the greatest of many bytes is found at once.
fn may_have_other_lines(block: &str) -> bool {
    block.bytes().fold(0, u8::max) > b'f'
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufRead;

    #[test]
    fn chunks_end_where_lines_do_and_make_the_text() {
        let text = "v 1 2 \\\n3\n".repeat(CHUNK / 4);
        let found: Vec<&str> = split(&text, CHUNK).collect();
        assert!(found.len() > 2);
        assert_eq!(found.concat(), text);
        assert!(found.iter().all(|chunk| chunk.ends_with("3\n")));
    }

    #[test]
    fn a_file_reads_alike_line_by_line_and_as_a_whole() {
        // A face that is written anew, and a last line without an end.
        let text = "v 0 0 0\nv 1 0 0\nf 1 2 -1\nv 0 1 0\nf 1 2 3";
        let lines = |input: &mut TobjInput| input.lines().map(Result::unwrap).collect::<Vec<_>>();
        let whole = |input: &mut TobjInput| std::io::read_to_string(input).unwrap();
        let (_, lines) = normalize(text, &mut Diagnostics::default(), lines).unwrap();
        let (_, whole) = normalize(text, &mut Diagnostics::default(), whole).unwrap();
        assert_eq!(lines, ["v 0 0 0", "v 1 0 0", "v 0 1 0", "g 0", "f 1 2 2", "f 1 2 3", ""]);
        assert_eq!(whole.lines().collect::<Vec<_>>(), lines[..6]);
    }

    #[test]
    fn statements_among_many_faces_are_scanned() {
        let faces = "f 1 2 3\n".repeat(BLOCK);
        let text = format!("{faces}usemtl a \\\nbed\n{faces}vt 0 0\n{faces} v 0 0 0\ns 2");
        let state = scan_chunk(&text);
        assert_eq!(state.vertices.counts, [1, 1, 0]);
        assert_eq!(state.settings.material.as_deref(), Some("a  bed"));
        assert_eq!((state.settings.smoothing, state.lines), (Some(2), 3 * BLOCK + 4));
    }

    #[test]
    fn a_file_of_several_chunks_keeps_its_settings_indices_and_line_numbers() {
        let filler = "# nothing\n".repeat(CHUNK / 8);
        let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        let text =
            format!("{vertices}usemtl a\n{filler}f -3 -2 -1\n{filler}{vertices}f 4 5 6\np 1");
        let mut diagnostics = Diagnostics::default();
        let read = |input: &mut TobjInput| input.lines().map(Result::unwrap).collect::<Vec<_>>();
        let (info, read) = normalize(&text, &mut diagnostics, read).unwrap();
        let read: Vec<_> = read.iter().filter(|l| !l.starts_with('#')).collect();
        assert_eq!(read[6..], ["g 0", "f 1 2 3", "f 4 5 6"]);
        assert_eq!(info.groups.len(), 1);
        assert_eq!(info.groups[0].settings.material.as_deref(), Some("a"));
        let said = diagnostics.warnings(std::path::Path::new("m"));
        assert!(said[0].ends_with(&format!("line {}", text.lines().count())), "{said:?}");
    }
}
