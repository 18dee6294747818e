//! The `envers` command.
fn main() {}
