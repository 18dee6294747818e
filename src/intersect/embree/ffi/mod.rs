//! The boundary with the Embree library, and all the unsafe code of this crate: handles, records,
//! entry points, callbacks and the check of their layout.

pub mod abi_check;
pub mod callbacks;
pub mod handles;
pub mod mesh_geometry;
pub mod packet_width;
pub mod queries;
pub mod records;
pub mod user_geometry;
