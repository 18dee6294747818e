//! Which of several choices are worth making, when each has several costs.

use std::cmp::Ordering;

/// Whether `a` costs no more than `b` in anything, and less in something.
fn dominates<const N: usize>(a: &[f64; N], b: &[f64; N]) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b) && a != b
}

/// For each choice one that dominates it: that costs no more in anything, and less in something. Of
/// several the one that costs least in the first thing, then in the second, and so on; nothing
/// dominates that one. The choices that nothing dominates are the front (Pareto's).
pub fn dominators<const N: usize>(costs: &[[f64; N]]) -> Vec<Option<usize>> {
    let of = |cost: &[f64; N]| {
        (0..costs.len())
            .filter(|&other| dominates(&costs[other], cost))
            .min_by(|&a, &b| costs[a].partial_cmp(&costs[b]).unwrap_or(Ordering::Equal))
    };
    costs.iter().map(of).collect()
}
