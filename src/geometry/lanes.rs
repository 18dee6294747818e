//! Lanes: values of sixteen rays that are stored side by side.

/// The number of lanes of a block: a multiple of every packet width.
pub const LANES: usize = 16;

/// One value for each of sixteen lanes.
pub type Lanes<T> = [T; LANES];
