//! Meshes as user geometry, in boxes that no exact ray can miss with its f32 copy: all of them in
//! precision `certified`, and in `fast` those that f32 does not resolve.

mod instances;
mod meshes;
mod triangle_table;

pub use instances::Blas;
pub use meshes::UserMeshes;
pub use triangle_table::TriangleTable;
