//! Puts an OBJ file in the form that tobj takes. tobj gives up at what it does not expect, without
//! a line number, and loses count where only some vertices of a mesh have normals.
//!
//! The text made here has the vertices first, then the faces, with indices that are known to
//! exist, sorted into [`Part`](super::setting::Part)s whose faces all have the same attributes. Nearly all of it are
//! stretches of the file as it stands. Threads share the file in chunks: they first [survey] them,
//! since a line's meaning depends on what stands before it, and a face may name a vertex that
//! stands after it; and then [sort](super::sorter) their lines, while tobj already reads what they
//! have [done](super::stream).

use std::sync::mpsc;

use rayon::prelude::*;

use super::lines::{end_of_line, is_open, lines};
use super::setting::Place;
use super::sorter::Sorter;
use super::stream::{Rewritten, Stream};
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;

/// About how many bytes a thread works on at a time.
const CHUNK: usize = 1 << 20;
/// About how many bytes are searched at once for what says more than faces do.
const BLOCK: usize = 1 << 12;

/// Rewrites a file for `read`, on a thread of its own, and gives what it makes of it.
///
/// # Errors
/// When a line's numbers are no numbers; the error names the line. What `read` then makes of half
/// a file is dropped.
pub fn rewrite<T: Send>(
    text: &str,
    tally: &mut Diagnostics,
    read: impl FnOnce(&mut Stream) -> T + Send,
) -> Result<(Rewritten, T)> {
    let chunks: Vec<&str> = cut(text, CHUNK).collect();
    let surveys: Vec<Place> = chunks.par_iter().map(|chunk| survey(chunk)).collect();
    let mut here = Place::default();
    let mut places = Vec::with_capacity(chunks.len());
    for there in surveys {
        let next = here.then(&there);
        places.push(std::mem::replace(&mut here, next));
    }
    let (senders, receivers): (Vec<_>, Vec<_>) = chunks.iter().map(|_| mpsc::channel()).unzip();
    let mut stream = Stream::new(text, receivers);
    std::thread::scope(|threads| {
        // It waits for the others, and so must be none of rayon's.
        let reader = threads.spawn(|| {
            let made = read(&mut stream);
            stream.finish(tally).map(|rewritten| (rewritten, made))
        });
        rayon::scope_fifo(|sorters| {
            for ((chunk, place), sender) in chunks.into_iter().zip(places).zip(senders) {
                // Nobody takes it after an error.
                sorters.spawn_fifo(move |_| {
                    let _ = sender.send(Sorter::new(chunk, place, here.counts).sort());
                });
            }
        });
        reader.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// A text cut after lines that the next one does not continue, into pieces of about a `size`.
fn cut(text: &str, size: usize) -> impl Iterator<Item = &str> {
    let mut rest = text;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        // A line feed is never within a character.
        let mut end = size.min(rest.len());
        loop {
            end += end_of_line(rest.as_bytes().get(end..).unwrap_or_default());
            let last = rest.get(..end).unwrap_or_default();
            let last = last.get(last.trim_end().rfind('\n').unwrap_or(0)..).unwrap_or_default();
            if end >= rest.len() || !is_open(last) {
                break;
            }
        }
        let (piece, after) = rest.split_at_checked(end).unwrap_or((rest, ""));
        rest = after;
        Some(piece)
    })
}

/// What holds after a chunk of which nothing before is known.
fn survey(chunk: &str) -> Place {
    let mut place = Place { start: chunk.len(), ..Place::default() };
    for line in cut(chunk, BLOCK).filter(|block| says_more_than_faces(block)).flat_map(lines) {
        let kind = match line.text.as_bytes() {
            [b'f' | b'#', b' ', ..] => continue,
            [b'v', b' ' | b'\t', ..] => 0,
            [b'v', b't', b' ' | b'\t', ..] => 1,
            [b'v', b'n', b' ' | b'\t', ..] => 2,
            _ => {
                let statement = line.statement();
                match statement.keyword.as_ref() {
                    "v" => 0,
                    "vt" => 1,
                    "vn" => 2,
                    _ => {
                        place.setting.follow(&statement);
                        continue;
                    }
                }
            }
        };
        place.counts.add(kind, line.text);
    }
    place.lines = memchr::memchr_iter(b'\n', chunk.as_bytes()).count();
    place
}

/// Whether some lines may be no faces: the keywords of all that [`survey`] looks for begin with
/// letters beyond `f`. Most of a file are faces, and the greatest of many bytes is found at once.
fn says_more_than_faces(block: &str) -> bool {
    block.bytes().fold(0, u8::max) > b'f'
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufRead;

    #[test]
    fn chunks_end_where_lines_do_and_make_the_text() {
        let text = "v 1 2 \\\n3\n".repeat(CHUNK / 4);
        let found: Vec<&str> = cut(&text, CHUNK).collect();
        assert!(found.len() > 2);
        assert_eq!(found.concat(), text);
        assert!(found.iter().all(|chunk| chunk.ends_with("3\n")));
    }

    #[test]
    fn a_file_reads_alike_line_by_line_and_as_a_whole() {
        // A face that is written anew, and a last line without an end.
        let text = "v 0 0 0\nv 1 0 0\nf 1 2 -1\nv 0 1 0\nf 1 2 3";
        let lines = |made: &mut Stream| made.lines().map(Result::unwrap).collect::<Vec<_>>();
        let whole = |made: &mut Stream| std::io::read_to_string(made).unwrap();
        let (_, lines) = rewrite(text, &mut Diagnostics::default(), lines).unwrap();
        let (_, whole) = rewrite(text, &mut Diagnostics::default(), whole).unwrap();
        assert_eq!(lines, ["v 0 0 0", "v 1 0 0", "v 0 1 0", "g 0", "f 1 2 2", "f 1 2 3", ""]);
        assert_eq!(whole.lines().collect::<Vec<_>>(), lines[..6]);
    }

    #[test]
    fn what_stands_among_many_faces_is_surveyed() {
        let faces = "f 1 2 3\n".repeat(BLOCK);
        let text = format!("{faces}usemtl a \\\nbed\n{faces}vt 0 0\n{faces} v 0 0 0\ns 2");
        let place = survey(&text);
        assert_eq!(place.counts.of, [1, 1, 0]);
        assert_eq!(place.setting.material.as_deref(), Some("a  bed"));
        assert_eq!((place.setting.smoothing, place.lines), (Some(2), 3 * BLOCK + 4));
    }

    #[test]
    fn a_file_of_several_chunks_keeps_its_settings_indices_and_line_numbers() {
        let filler = "# nothing\n".repeat(CHUNK / 8);
        let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        let text =
            format!("{vertices}usemtl a\n{filler}f -3 -2 -1\n{filler}{vertices}f 4 5 6\np 1");
        let mut tally = Diagnostics::default();
        let read = |made: &mut Stream| made.lines().map(Result::unwrap).collect::<Vec<_>>();
        let (made, read) = rewrite(&text, &mut tally, read).unwrap();
        let read: Vec<_> = read.iter().filter(|l| !l.starts_with('#')).collect();
        assert_eq!(read[6..], ["g 0", "f 1 2 3", "f 4 5 6"]);
        assert_eq!(made.parts.len(), 1);
        assert_eq!(made.parts[0].setting.material.as_deref(), Some("a"));
        let said = tally.sentences(std::path::Path::new("m"));
        assert!(said[0].ends_with(&format!("line {}", text.lines().count())), "{said:?}");
    }
}
