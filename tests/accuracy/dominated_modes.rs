//! The modes of a bench that are worth having.

use envers::measure::bench::dominators;
use proptest::prelude::*;

/// Costs from a few values, so that many are equal.
fn costs() -> impl Strategy<Value = Vec<[f64; 3]>> {
    proptest::collection::vec([0..5, 0..5, 0..5].prop_map(|c: [i32; 3]| c.map(f64::from)), 1..20)
}

fn no_worse(a: &[f64; 3], b: &[f64; 3]) -> bool {
    (0..3).all(|i| a[i] <= b[i])
}

proptest! {
    #[test]
    fn nothing_is_as_good_as_what_is_on_the_front_and_better_in_something(costs in costs()) {
        for (cost, dominator) in costs.iter().zip(dominators(&costs)) {
            let beaten = costs.iter().any(|other| no_worse(other, cost) && !no_worse(cost, other));
            prop_assert_eq!(dominator.is_some(), beaten);
        }
    }

    #[test]
    fn what_dominates_is_on_the_front_and_no_worse(costs in costs()) {
        let dominators = dominators(&costs);
        for (cost, dominator) in costs.iter().zip(&dominators) {
            if let Some(by) = *dominator {
                prop_assert!(no_worse(&costs[by], cost) && &costs[by] != cost);
                prop_assert_eq!(dominators[by], None);
            }
        }
    }

    #[test]
    fn something_is_on_the_front(costs in costs()) {
        prop_assert!(dominators(&costs).contains(&None));
    }
}

#[test]
fn equal_choices_do_not_dominate_each_other() {
    assert_eq!(dominators(&[[1.0, 2.0], [1.0, 2.0]]), [None, None]);
}
