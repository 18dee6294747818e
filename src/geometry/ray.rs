//! A ray, and the surface it left.

use glam::DVec3;

use crate::geometry::{Hit, PrimitiveId};

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

impl Side {
    /// The other side.
    pub fn opposite(self) -> Self {
        match self {
            Side::Front => Side::Back,
            Side::Back => Side::Front,
        }
    }
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

/// How far a ray has come that went straight through surfaces.
///
/// It keeps its origin and direction, and so meets what lies beyond at the very `t` at which it
/// would if nothing had stood there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Continuation {
    /// The `t` of the last surface that it went through.
    pub t: f64,
    /// That surface.
    pub crossed: Departure,
}

impl Continuation {
    /// Whether a crossing at `t` lies behind, in the order in which hits count: by `t`, then by
    /// what is hit. Of the sphere that was gone into, only the far side lies ahead.
    #[inline]
    pub fn excludes(&self, t: f64, id: PrimitiveId) -> bool {
        t < self.t || (t == self.t && id <= self.crossed.id)
    }
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
    pub departure: Option<Departure>,
    /// How far it has come, if it went straight through a surface: it meets only what lies ahead.
    pub continuation: Option<Continuation>,
}

impl Ray {
    /// An unbounded ray that left no surface.
    #[inline]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, tmax: f64::INFINITY, departure: None, continuation: None }
    }

    /// The segment from `origin` to `target`, both ends excluded.
    pub fn segment(origin: DVec3, target: DVec3) -> Self {
        Self { origin, direction: target - origin, tmax: 1.0, departure: None, continuation: None }
    }

    /// The same ray beyond a surface that it met, on whose `side` it goes on.
    pub fn continue_past(&self, hit: &Hit, side: Side) -> Self {
        let through = Departure { id: hit.id, side };
        Self { continuation: Some(Continuation { t: hit.t, crossed: through }), ..*self }
    }

    /// The `t` up to which it has come.
    pub fn start_t(&self) -> f64 {
        self.continuation.map_or(0.0, |past| past.t)
    }

    /// The point at `t`.
    #[inline]
    pub fn position(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
