//! Laws of dividing an error.

use plotter_motion::budget::{Budget, BudgetError, BudgetLimits, BudgetPart};
use proptest::prelude::*;

fn mm() -> impl Strategy<Value = f64> {
    prop_oneof![4 => 0.0..2.0_f64, 1 => Just(0.0), 1 => 0.0..1e-9_f64, 1 => 0.0..1e6_f64]
}

fn limits() -> impl Strategy<Value = BudgetLimits> {
    ((mm(), mm(), mm()), (mm(), mm()), 1e-6..=1.0_f64, 0.0..=1.0_f64).prop_map(
        |((least, more, blend_most_mm), (standing_mm, moving_mm), least_speed_share, vectorization_share)| {
            BudgetLimits {
                vectorization_least_mm: least,
                vectorization_most_mm: least + more,
                blend_most_mm,
                standing_mm,
                moving_mm,
                least_speed_share,
                vectorization_share,
            }
        },
    )
}

/// Rounding of the last bits of sums and roots.
const ROUNDING: f64 = 1e-9;

proptest! {
    #[test]
    fn the_parts_make_no_more_than_what_was_asked(limits in limits(), asked_mm in mm()) {
        if let Ok(budget) = Budget::split(asked_mm, &limits) {
            prop_assert!(budget.promised_mm() <= asked_mm, "{budget:?}");
            prop_assert!(budget.vectorization_mm >= limits.vectorization_least_mm);
            prop_assert!(budget.vectorization_mm <= limits.vectorization_most_mm * (1.0 + ROUNDING) + ROUNDING);
            prop_assert!((0.0..=limits.blend_most_mm).contains(&budget.blend_mm));
            prop_assert!(budget.speed_share >= limits.least_speed_share && budget.speed_share <= 1.0);
            // At that speed control makes no more than its part.
            let control_mm = limits.standing_mm + limits.moving_mm * budget.speed_share * budget.speed_share;
            prop_assert!(control_mm <= budget.control_mm * (1.0 + ROUNDING) + ROUNDING, "{control_mm} {budget:?}");
        }
    }

    #[test]
    fn a_greater_error_is_never_slower_nor_finer(limits in limits(), asked in mm(), more in mm()) {
        if let Ok(less) = Budget::split(asked, &limits) {
            let greater = Budget::split(asked + more, &limits);
            let greater = greater.map_err(|error| TestCaseError::fail(format!("{error}")))?;
            let scale = ROUNDING * (1.0 + asked + more);
            prop_assert!(greater.speed_share >= less.speed_share, "{less:?} {greater:?}");
            prop_assert!(greater.vectorization_mm >= less.vectorization_mm - scale, "{less:?} {greater:?}");
            prop_assert!(greater.control_mm >= less.control_mm - scale, "{less:?} {greater:?}");
            prop_assert!(greater.blend_mm >= less.blend_mm - scale, "{less:?} {greater:?}");
        }
    }

    #[test]
    fn what_is_smaller_than_the_smallest_promise_is_refused_and_that_one_is_not(limits in limits(), share in 0.0..1.0_f64) {
        let smallest_mm = Budget::smallest_mm(&limits).map_err(|error| TestCaseError::fail(format!("{error}")))?;
        prop_assume!(smallest_mm > 0.0 && smallest_mm * share > 0.0 && smallest_mm * share < smallest_mm);
        let kept = Budget::split(smallest_mm, &limits);
        prop_assert!(kept.is_ok_and(|budget| budget.promised_mm() <= smallest_mm));
        match Budget::split(smallest_mm * share, &limits) {
            Err(BudgetError::TooSmall { limiting, needs_mm, smallest_mm: said_mm, .. }) => {
                prop_assert_eq!(said_mm, smallest_mm);
                prop_assert!(2.0 * needs_mm >= smallest_mm, "the greatest of two parts");
                prop_assert!(limiting == BudgetPart::Vectorization || limiting == BudgetPart::Control);
            }
            other => prop_assert!(false, "{other:?}"),
        }
    }

    #[test]
    fn no_number_panics(
        numbers in prop::array::uniform8(prop_oneof![prop::num::f64::ANY, mm()]),
    ) {
        let [asked_mm, a, b, c, d, e, f, g] = numbers;
        let limits = BudgetLimits {
            vectorization_least_mm: a,
            vectorization_most_mm: b,
            blend_most_mm: c,
            standing_mm: d,
            moving_mm: e,
            least_speed_share: f,
            vectorization_share: g,
        };
        if let Ok(budget) = Budget::split(asked_mm, &limits) {
            prop_assert!(budget.promised_mm() <= asked_mm && budget.speed_share > 0.0);
        }
    }
}

#[test]
fn a_part_of_the_control_that_rounds_up_is_taken_back() {
    let limits = BudgetLimits {
        vectorization_least_mm: 279_323.079_333_718_8,
        vectorization_most_mm: 279_323.079_333_718_8,
        blend_most_mm: 0.0,
        standing_mm: 0.230_485_683_912_383_86,
        moving_mm: 739_129.464_566_839_2,
        least_speed_share: 0.764_656_380_483_270_2,
        vectorization_share: 0.0,
    };
    let asked_mm = 745_465.016_845_075_1;
    let budget = Budget::split(asked_mm, &limits).unwrap_or_else(|error| panic!("{error}"));
    assert!(budget.promised_mm() <= asked_mm && budget.promised_mm() > asked_mm - 1e-9, "{budget:?}");
}
