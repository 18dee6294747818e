//! A distance with its error bound.

/// What f64 arithmetic can say of where a ray meets a primitive: the exact t lies within `error`
/// of `t`.
///
/// A certain miss is [`Estimate::MISS`]; where f64 cannot tell hit from miss the error is infinite
/// ([`Estimate::UNKNOWN`]). So one comparison of the bounds with a limit serves all three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The distance, in units of |direction|; of either sign.
    pub t: f64,
    /// Bound of its absolute error, in the same units.
    pub error: f64,
}

impl Estimate {
    /// Certainly no hit at any t > 0.
    pub const MISS: Self = Self { t: f64::INFINITY, error: 0.0 };
    /// Nothing is certain.
    pub const UNKNOWN: Self = Self { t: 0.0, error: f64::INFINITY };

    /// The exact t is not below this.
    #[inline(always)]
    pub fn lower(&self) -> f64 {
        self.t - self.error
    }

    /// The exact t is not above this.
    #[inline(always)]
    pub fn upper(&self) -> f64 {
        self.t + self.error
    }

    /// Whether the hit, if there is one, certainly lies outside (0, `limit`\].
    #[inline(always)]
    pub fn is_outside(&self, limit: f64) -> bool {
        self.upper() <= 0.0 || self.lower() > limit || self.t == f64::INFINITY
    }
}
