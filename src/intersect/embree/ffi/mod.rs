//! The boundary with the Embree library: handles, records, callbacks and the check of their layout.

pub mod abi_check;
pub mod handles;
pub mod memory;
pub mod mesh_geometry;
pub mod packet_width;
pub mod records;
pub mod user_geometry;
