//! The boundary with the Embree library, and all the unsafe code of this crate: handles, records,
//! entry points, callbacks and the check of their layout.

mod abi_check;
mod callbacks;
mod handles;
mod library;
mod mesh_geometry;
mod packet_width;
pub mod queries;
mod records;
mod user_geometry;

pub use abi_check::check as check_abi;
pub use callbacks::{CallbackPacket, Filter, UserPrimitive, UserPrimitives};
#[cfg(feature = "cli")]
pub use handles::peak_memory;
pub use handles::{CommittedScene, DeviceHandle, OpenScene, OwnedGeometry};
pub use library::open;
#[cfg(feature = "cli")]
pub use library::path as library_path;
pub use mesh_geometry::new_mesh_geometry;
pub use packet_width::{Kernel, PacketWidth};
pub use records::{Candidate, INVALID, LaneMask, RayHitRecord};
pub use user_geometry::{PrimitiveTable, new_geometry, update_geometry};
