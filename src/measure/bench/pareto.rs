//! The Pareto front of choices that have several costs each.

use std::cmp::Ordering;

/// Returns for each choice another that dominates it: one that costs no more in anything, and less
/// in something. Of several it is the one with the smallest first cost, then second, and so on;
/// nothing dominates that one. The choices that nothing dominates are the Pareto front.
pub fn dominators<const N: usize>(costs: &[[f64; N]]) -> Vec<Option<usize>> {
    let dominates = |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).all(|(a, b)| a <= b) && a != b;
    let dominator = |cost: &[f64; N]| {
        let others = (0..costs.len()).filter(|&other| dominates(&costs[other], cost));
        others.min_by(|&a, &b| costs[a].partial_cmp(&costs[b]).unwrap_or(Ordering::Equal))
    };
    costs.iter().map(dominator).collect()
}
