//! The claims of the documentation: the README, the page for library users, the tutorial's chapters and pictures, the committed
//! models, and the reference scenes of the benches.

mod assets;
#[cfg(feature = "cli")]
mod chapters;
mod library;
mod readme;
mod reference_scenes;
mod tutorial;
