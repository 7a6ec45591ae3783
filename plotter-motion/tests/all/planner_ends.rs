//! Lines end where and when they should, however long they last and whatever is done near their ends.

use plotter_motion::{
    Planner, PlannerSettings, PlotOp, Point,
    planner::{Action, Phase},
};

const ACCEL_MM_S2: f64 = 360.0;
/// What rounding may add to a limit: some last bits of an `f32`.
const ROUNDING: f64 = 1e-6;
/// Most actions of a line here.
const MANY: usize = 100_000_000;

fn settings() -> PlannerSettings {
    PlannerSettings { speed_mm_s: 45.0, accel_mm_s2: ACCEL_MM_S2, ..PlannerSettings::default() }
}

fn planner(to_mm: f64, feed_mm_s: f64) -> Planner<16> {
    let mut planner = Planner::<16>::new(settings()).unwrap();
    planner.push(PlotOp::Draw { to: Point::new(to_mm, 0.0), feed_mm_s: Some(feed_mm_s) }).unwrap();
    planner.finish().unwrap();
    planner
}

fn phase(action: Action) -> Option<Phase> {
    if let Action::Phase(phase) = action { Some(phase) } else { None }
}

/// 2 m at 0.1 mm/min, which takes two weeks: seconds as `f32` have no halves by then.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_of_two_weeks_ends_where_and_when_it_should() {
    /// Millionths of it: times and places are right to a ten millionth.
    const SHARE: f64 = 1e-6;
    let (length_mm, feed_mm_s) = (2_000.0, 0.1 / 60.0);
    let mut planner = planner(length_mm, feed_mm_s);
    let (mut time_s, mut end_mm, mut fastest, mut slowest) = (0.0_f64, 0.0, 0.0_f32, f32::INFINITY);
    let actions = core::iter::from_fn(|| planner.next_action()).take(MANY);
    for phase in actions.filter_map(phase) {
        time_s += f64::from(phase.duration_s);
        let way_mm = phase.at(phase.duration_s.into()).distance_mm - f64::from(phase.from_mm);
        end_mm = f64::from(phase.from_mm) + way_mm;
        if phase.accel_mm_s2 == 0.0 {
            (fastest, slowest) = (fastest.max(phase.speed_mm_s), slowest.min(phase.speed_mm_s));
        }
    }
    assert!(planner.is_empty(), "{end_mm} mm after {time_s} s");
    assert!((end_mm - length_mm).abs() <= SHARE * length_mm, "{end_mm} mm");
    assert!((time_s * feed_mm_s - length_mm).abs() <= SHARE * length_mm, "{time_s} s");
    assert_eq!(fastest, slowest);
}

/// What is done to a line under way.
fn touches() -> [fn(&mut Planner<16>); 4] {
    [
        |planner| planner.hold(),
        |planner| planner.override_speeds(0.1, 1.0),
        |planner| planner.override_speeds(0.7, 1.0),
        |planner| planner.override_speeds(1.5, 1.0),
    ]
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn no_override_and_no_hold_near_the_end_of_a_line_is_too_hard() {
    // Twice the change of speed of the longest phase, and a little more: then there is little left of the
    // line where something is done.
    let feeds = (0..16).map(|power| 2.0 * ACCEL_MM_S2 * 3.0 / 64.0 + 1e-3 * 1.5_f64.powi(power));
    for feed_mm_s in feeds {
        for length_mm in [10.0, 33.3, 100.0, 1_234.5, 10_000.0] {
            let mut undisturbed = planner(length_mm, feed_mm_s);
            let count = core::iter::from_fn(|| undisturbed.next_action()).count();
            for (touch, does) in touches().into_iter().enumerate() {
                for at in count.saturating_sub(6)..=count {
                    let mut planner = planner(length_mm, feed_mm_s);
                    let mut place_mm = 0.0;
                    for taken in 0..2 * count + 1_000 {
                        if taken == at {
                            does(&mut planner);
                        }
                        match planner.next_action() {
                            Some(action) => {
                                let Some(phase) = phase(action) else { continue };
                                let most = ACCEL_MM_S2 * (1.0 + ROUNDING);
                                assert!(
                                    f64::from(phase.accel_mm_s2).abs() <= most && phase.duration_s > 0.0,
                                    "{length_mm} mm at {feed_mm_s} mm/s, {touch} at {at} of {count}: {phase:?}"
                                );
                                place_mm = phase.at(phase.duration_s.into()).distance_mm;
                            }
                            None if planner.is_held() && !planner.is_empty() => planner.resume(),
                            None => break,
                        }
                    }
                    assert!(planner.is_empty(), "{length_mm} mm, {touch} at {at}");
                    assert!((place_mm - length_mm).abs() <= 4e-7 * length_mm, "{place_mm} of {length_mm} mm");
                }
            }
        }
    }
}
