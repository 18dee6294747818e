//! What measures the renderer: one backend against the other, one picture against another.

mod dispute;
pub mod oracle;
mod picture;
pub mod stress;
mod validate;

pub use dispute::{Cause, Disputes};
pub use picture::{Comparison, Picture, compare};
pub use validate::{Causes, Validation, validate};
