//! The conditions that several checks share, with their messages.

use glam::{DVec3, Vec3};

use super::MAX_COORDINATE;
use crate::error::{Error, Result};

/// Requires a condition: where it does not hold, an input error with this message.
pub(in crate::scene) fn require(holds: bool, message: impl FnOnce() -> String) -> Result<()> {
    if holds { Ok(()) } else { Err(Error::input(message())) }
}

/// Requires that `p` is finite and within [`MAX_COORDINATE`].
pub(super) fn require_position(label: impl FnOnce() -> String, p: DVec3) -> Result<()> {
    require(p.is_finite() && p.abs().max_element() <= MAX_COORDINATE, || {
        format!("{}: must be finite and within 1e15 of the origin, found {p}", label())
    })
}

/// Requires that `v` has length 1, to within rounding.
pub(super) fn require_unit_length(label: impl FnOnce() -> String, v: DVec3) -> Result<()> {
    require((v.length() - 1.0).abs() < 1e-6, || {
        format!("{}: must have length 1, found {v}", label())
    })
}

/// Requires that the components of `c` are finite and not negative.
pub(super) fn require_color(label: impl FnOnce() -> String, c: Vec3) -> Result<()> {
    require(c.is_finite() && c.min_element() >= 0.0, || {
        format!("{}: must be finite and not negative, found {c}", label())
    })
}

/// Requires that `index` is less than `count`.
pub(super) fn require_index(
    label: impl FnOnce() -> String,
    kind: &str,
    index: u32,
    count: usize,
) -> Result<()> {
    require((index as usize) < count, || {
        format!("{}: there is no {kind} {index}, only {count} of them", label())
    })
}
