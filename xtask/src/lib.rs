//! Generators of the files of envers: models and drawings, which are committed, and the reference
//! scenes of the benches. It does not depend on envers, so that nothing of envers is compiled for it.

pub mod assets;
mod glb;
pub mod reference;
mod shape;
