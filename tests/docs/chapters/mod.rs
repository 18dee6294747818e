//! The tutorial's chapters keep what they show: commands run, pictures are what their commands
//! make, excerpts stand in the sources, links lead somewhere, and both languages show the same.
//!
//! The parts of a chapter, and what is held of each:
//!
//! - Its first line links to the previous chapter, the contents (`../README.md`), the next chapter
//!   and the same one in the other language.
//! - A block of `sh` has one command a line, of `envers`, `python3` or `cargo run --example`
//!   (`book::Command`). All run in order in a folder that has copies of `assets/` and of
//!   `docs/tutorial/`, and succeed.
//! - A PNG that a chapter shows is made by one of its commands (`-o NAME.png`), within 1 of 255.
//!   `ENVERS_BLESS=1 cargo test --test docs chapters` writes them anew, and fails all the same.
//! - A GIF that a chapter shows is made by one of its commands, and has as many frames.
//! - A block of `rust`, `toml` or `python` follows a comment `<!-- from PATH -->` and stands in
//!   that file but for white space. A line of no more than `…` behind the file's comment sign
//!   stands for what is left out.
//! - A block of `text` follows a comment `<!-- printed by COMMAND -->`: that command prints it.

mod book;
mod eclipses;
mod pages;
mod run;
mod vecteur;
