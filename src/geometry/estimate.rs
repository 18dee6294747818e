//! The distance of a hit with a bound on its error.

/// A distance in f64 with a bound on its error: the exact t lies within `error` of `t`.
///
/// A certain miss is [`Estimate::MISS`]; where f64 cannot tell a hit from a miss the error is
/// infinite ([`Estimate::UNKNOWN`]). One comparison of the bounds with a limit serves all three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The distance, in units of |direction|; of either sign.
    pub t: f64,
    /// The bound of its absolute error, in the same units.
    pub error: f64,
}

impl Estimate {
    /// A certain miss: no hit at any t > 0.
    pub const MISS: Self = Self { t: f64::INFINITY, error: 0.0 };
    /// An undecided intersection: hit or miss, at any distance.
    pub const UNKNOWN: Self = Self { t: 0.0, error: f64::INFINITY };

    /// [`Estimate::MISS`] for a certain miss, (`t`, `error`) for a certain hit, and otherwise
    /// [`Estimate::UNKNOWN`]; by selects rather than branches.
    #[inline(always)]
    pub(super) fn select(is_miss: bool, is_hit: bool, t: f64, error: f64) -> Self {
        Self {
            t: if is_miss { f64::INFINITY } else { if is_hit { t } else { 0.0 } },
            error: if is_miss { 0.0 } else { if is_hit { error } else { f64::INFINITY } },
        }
    }

    /// The lower bound of the exact t.
    #[inline(always)]
    pub fn lower(&self) -> f64 {
        self.t - self.error
    }

    /// The upper bound of the exact t.
    #[inline(always)]
    pub fn upper(&self) -> f64 {
        self.t + self.error
    }

    /// True if the hit, should there be one, certainly lies outside (0, `limit`\].
    #[inline(always)]
    pub fn is_outside(&self, limit: f64) -> bool {
        self.upper() <= 0.0 || self.lower() > limit || self.t == f64::INFINITY
    }
}
