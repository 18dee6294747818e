//! The ray, and the surface that it was spawned on.

use glam::DVec3;

use crate::geometry::{Hit, PrimitiveId};

/// The side of a surface: the front, to which its geometric normal points, or the back.
///
/// A sphere's geometric normal points outward, so `Front` is outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The side that the geometric normal points to.
    Front,
    /// The side that the geometric normal points away from; the inside of a sphere.
    Back,
}

impl Side {
    /// Returns the other side.
    pub fn opposite(self) -> Self {
        match self {
            Side::Front => Side::Back,
            Side::Back => Side::Front,
        }
    }
}

/// The primitive that a ray was spawned on and the side into which it goes, so that the ray does not
/// hit the surface that it leaves.
///
/// No distance is skipped: the primitive is left out by identity, and a sphere that is left
/// toward its inside is still hit at its far root.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Departure {
    /// The primitive that the ray leaves.
    pub id: PrimitiveId,
    /// The side into which the ray goes.
    pub side: Side,
}

/// The progress of a ray that went straight through surfaces.
///
/// Such a ray keeps its origin and direction, and so hits what lies beyond at the very `t` at which
/// it would if nothing had been in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Continuation {
    /// The `t` of the last surface that the ray went through.
    pub t: f64,
    /// The surface at that `t`, and the side on which the ray went on.
    pub crossed: Departure,
}

/// The ends of a shadow ray: a shading point, which a viewer sees, and a light.
///
/// The ray does not hit, at the light, a surface on which the light lies. In precision `certified` a surface
/// through the shading point blocks it that separates the light from the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowEnds {
    /// The direction from the shading point toward the viewer, of any length.
    pub viewer: DVec3,
}

/// A half-line from `origin` along `direction`, up to `tmax`.
///
/// It hits what it crosses at `t` with 0 < t < `tmax`, both strictly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The origin, in world space.
    pub origin: DVec3,
    /// The direction, of any length but zero; `t` is in units of that length.
    pub direction: DVec3,
    /// The end, in units of |direction|; infinite for primary and secondary rays, 1 for shadow rays.
    pub tmax: f64,
    /// The surface that it was spawned on, if any.
    pub departure: Option<Departure>,
    /// Its progress, if it went straight through a surface: it hits only what lies ahead.
    pub continuation: Option<Continuation>,
    /// The ends, if it is a shadow ray.
    pub shadow: Option<ShadowEnds>,
}

impl Ray {
    /// A ray without end, spawned on no surface.
    #[inline]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let (departure, continuation, shadow) = (None, None, None);
        Self { origin, direction, tmax: f64::INFINITY, departure, continuation, shadow }
    }

    /// The segment from `origin` to `target`, both ends excluded.
    pub fn segment(origin: DVec3, target: DVec3) -> Self {
        Self { tmax: 1.0, ..Self::new(origin, target - origin) }
    }

    /// The continuation of this ray beyond a surface that it hit, on whose `side` it goes on.
    pub fn continue_past(&self, hit: &Hit, side: Side) -> Self {
        let crossed = Departure { id: hit.id, side };
        Self { continuation: Some(Continuation { t: hit.t, crossed }), ..*self }
    }

    /// The `t` beyond which the ray hits: 0, or that of the last surface that it went through.
    pub fn start_t(&self) -> f64 {
        self.continuation.map_or(0.0, |continuation| continuation.t)
    }

    /// The point at `t`.
    #[inline]
    pub fn position(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
