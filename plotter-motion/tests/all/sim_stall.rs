//! One motor is held fast in the middle of a line: the other waits, and both go on when it is freed.

use crate::closed_loop;

use closed_loop::{Loop, SETTLED_MM, draw_line, machine};
use core::time::Duration;
use plotter_motion::{
    Axis, StepPoint,
    config::{ControllerChoice, SyncStopConfig},
    control::SyncStop,
};

const HELD_FROM: Duration = Duration::from_millis(200);
const HELD_UNTIL: Duration = Duration::from_millis(700);
/// Time for the other motor to come to rest.
const AT_REST: Duration = Duration::from_millis(300);

/// Holds `axis` during the line to `target`; returns the greatest deviation, mm, how far the other axis went
/// while it should wait, mm, and how far from the target the pen ended.
fn stalled(choice: ControllerChoice, axis: Axis, target: StepPoint) -> (f64, f64, f64, bool) {
    let config = machine(choice);
    let held = usize::from(axis == Axis::Y);
    let mut waited_at: Option<f64> = None;
    let mut crept = 0.0_f64;
    let result = draw_line(Loop::new(&config, &config), target, Duration::from_secs(10), |closed_loop| {
        let now = closed_loop.now;
        closed_loop.axes[held].stall((HELD_FROM..HELD_UNTIL).contains(&now));
        if (AT_REST..HELD_UNTIL).contains(&now) {
            let other = closed_loop.axes[1 - held].position_mm();
            crept = crept.max((other - *waited_at.get_or_insert(other)).abs());
        }
    });
    assert!(waited_at.is_some());
    (result.max_mm, crept, result.short_mm, result.arrived_s.is_some())
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn either_motor_waits_for_the_other_and_the_line_shows_no_trace_of_it() {
    /// While it waits, the free motor must not go on.
    const CREEP_MM: f64 = 0.1;
    let rule = SyncStop::new(SyncStopConfig::default());
    println!("| held | line | deviation mm | allowed mm | the other crept mm |");
    for target in [StepPoint::new(2000, 1300), StepPoint::new(-700, 2300), StepPoint::new(2400, -200)] {
        for axis in Axis::BOTH {
            let slope = target.y as f32 / target.x as f32;
            // the rule's threshold lies along y; across the line it is less
            let allowed_mm = f64::from(rule.threshold_counts(slope) / (1.0 + slope * slope).sqrt()) / 40.0;
            let (deviation_mm, crept_mm, short_mm, arrived) =
                stalled(ControllerChoice::Contouring, axis, target);
            println!("| {axis:?} | {target:?} | {deviation_mm:.4} | {allowed_mm:.4} | {crept_mm:.4} |");
            assert!(arrived && short_mm < SETTLED_MM, "{axis:?} {target:?}: {short_mm} mm short");
            assert!(deviation_mm <= allowed_mm, "{axis:?} {target:?}: {deviation_mm} mm of {allowed_mm}");
            assert!(crept_mm <= CREEP_MM, "{axis:?} {target:?}: crept {crept_mm} mm");
        }
    }
}

#[test]
fn under_the_published_rule_x_stands_still_while_y_is_held() {
    let (_, crept_mm, _, _) = stalled(ControllerChoice::Published, Axis::Y, StepPoint::new(2000, 1300));
    /// What friction still stops after the rest that the test allows: none.
    const STANDS_MM: f64 = 1e-9;
    assert!(crept_mm < STANDS_MM, "x crept {crept_mm} mm");
}
