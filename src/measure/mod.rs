//! What measures the renderer: one backend against the other ([`validate`](fn@validate)), all of
//! them on one ray ([`replay`](fn@replay)), one picture against another ([`compare`], [`flip`]),
//! every hit against exact integers ([`oracle`], [`stress`]), and run time against error ([`mod@bench`]).

pub mod bench;
pub mod flip;
mod mismatch;
pub mod oracle;
mod picture;
mod replay;
pub mod stress;
mod validate;

pub use mismatch::{MismatchCause, MismatchClassifier};
pub use picture::{Comparison, Picture, compare};
pub use replay::{Answer, Hidden, Met, Replay, ray_from_text, ray_to_text, replay};
pub use validate::{Causes, Validation, Worst, validate};
