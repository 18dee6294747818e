//! Measurements of the renderer: one backend compared with the other ([`validate`](fn@validate)),
//! all of them on one ray ([`replay`](fn@replay)), one picture compared with another
//! ([`compare_pictures`], [`flip`]), hits compared with exact integers ([`oracle`], [`stress`]),
//! and a benchmark of run time against error ([`bench`]).

pub mod bench;
mod decimals;
pub mod flip;
mod mismatch;
pub mod oracle;
mod picture;
mod replay;
pub mod stress;
mod trace;
mod validate;

pub use decimals::DecimalAnswer;
pub use mismatch::{MismatchCause, MismatchClassifier};
pub use picture::{Comparison, Picture, compare_pictures};
pub use replay::{Answer, LightOcclusion, Replay, ReplayedHit, ray_from_text, ray_to_text, replay};
pub use validate::{MismatchCounts, Validation, WorstRay, validate};
