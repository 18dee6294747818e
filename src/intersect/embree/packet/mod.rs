//! The packet loop: rays of a batch, traced through Embree as many at a time as a packet is wide.

pub mod packet_hits;
pub mod packet_rays;
mod planes;
pub mod query;
mod rays;

pub use rays::Packet;
