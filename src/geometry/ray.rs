//! A ray, and the surface it left.

use glam::DVec3;

use crate::geometry::PrimitiveId;

/// The side of a surface: the geometric normal's, or the other one.
///
/// A sphere's geometric normal points outward, so `Front` is outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The side that the geometric normal points to.
    Front,
    /// The other side; the inside of a sphere.
    Back,
}

/// What a ray was spawned from, so that it is not stopped by the very surface it leaves.
///
/// No distance is skipped: the primitive is left out by identity, and a sphere that is left
/// toward its inside is still met at its far root.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Departure {
    /// The primitive that was left.
    pub id: PrimitiveId,
    /// The side into which the ray goes.
    pub side: Side,
}

/// A half-line from `origin` along `direction`, up to `tmax`.
///
/// It meets what it crosses at `t` with 0 < t < `tmax`, both strictly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, in world space.
    pub origin: DVec3,
    /// Where it goes, of any length but zero; `t` is in units of that length.
    pub direction: DVec3,
    /// Where it ends, in units of |direction|; infinite for rays that see, 1 for shadow rays.
    pub tmax: f64,
    /// The surface it left, if any.
    pub from: Option<Departure>,
}

impl Ray {
    /// An unbounded ray that left no surface.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, tmax: f64::INFINITY, from: None }
    }

    /// The segment from `origin` to `target`, both ends excluded.
    pub fn between(origin: DVec3, target: DVec3) -> Self {
        Self { origin, direction: target - origin, tmax: 1.0, from: None }
    }

    /// The point at `t`.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
