//! Laws of the controllers and the simulated axes under any input.

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::control::{Contouring, LineController, LineTracking};
use plotter_motion::plant::AxisPlant;
use plotter_motion::{
    Axis, Demand, Direction, Duty, LimitSwitches, Machine, MachineConfig, SafetyGate, StepPoint,
    config::{AxisConfig, ControllerChoice, Decoding},
    control::{Pid, PidState},
};
use proptest::prelude::*;

fn direction() -> impl Strategy<Value = Direction> {
    prop_oneof![Just(Direction::Plus), Just(Direction::Minus)]
}

fn axis() -> impl Strategy<Value = Axis> {
    prop_oneof![Just(Axis::X), Just(Axis::Y)]
}

fn decoding() -> impl Strategy<Value = Decoding> {
    prop_oneof![Just(Decoding::X1), Just(Decoding::X2), Just(Decoding::X4)]
}

/// Coordinates that the protocol can say, and those that only a program error can.
fn coordinate() -> impl Strategy<Value = i32> {
    prop_oneof![4 => 0..100_000_i32, 1 => any::<i32>()]
}

/// Steps of time from none to the greatest.
fn pause() -> impl Strategy<Value = Duration> {
    prop_oneof![
        8 => (0..5_000_u64).prop_map(Duration::from_micros),
        1 => (0..1_000_000_u64).prop_map(Duration::from_secs),
        1 => Just(Duration::MAX),
    ]
}

#[expect(clippy::unwrap_used, reason = "a test may panic")]
fn machine(choice: ControllerChoice, decoding: Decoding, settle_ms: f64) -> Machine {
    let mut config = MachineConfig::default();
    config.dc_mut().unwrap().control.controller = choice;
    config.dc_mut().unwrap().control.contouring.settle_ms = settle_ms;
    let dc = config.dc_mut().unwrap();
    for axis in [&mut dc.x, &mut dc.y] {
        axis.encoder.decoding = decoding;
    }
    Machine::new(config).unwrap()
}

#[derive(Clone, Copy, Debug)]
enum Input {
    Target(i32, i32),
    Edge(Axis, Direction),
    Tick,
    /// A look at the clock that has gone back by as much.
    Back(Duration),
}

fn input() -> impl Strategy<Value = Input> {
    prop_oneof![
        1 => (coordinate(), coordinate()).prop_map(|(x, y)| Input::Target(x, y)),
        4 => (axis(), direction()).prop_map(|(axis, direction)| Input::Edge(axis, direction)),
        8 => Just(Input::Tick),
        1 => pause().prop_map(Input::Back),
    ]
}

fn in_range(demand: Demand) -> bool {
    [demand.x, demand.y].iter().all(|duty| (-1.0..=1.0).contains(&duty.value()))
}

/// Whatever may flow after `inputs`, `controller` still answers an error with a duty on a further line.
fn runs(controller: &mut impl LineController, inputs: &[(Duration, Input)]) -> Result<(), TestCaseError> {
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut now = Duration::ZERO;
    for &(pause, input) in inputs {
        now = now.saturating_add(pause);
        let demand = match input {
            Input::Target(x, y) => controller.start(now, StepPoint::new(x, y)),
            Input::Edge(axis, direction) => controller.edge(now, axis, direction),
            Input::Tick => controller.tick(now),
            Input::Back(by) => controller.tick(now.saturating_sub(by)),
        };
        prop_assert!(in_range(demand), "{demand:?} after {input:?}");
        controller.applied(gate.pass(demand));
    }
    // Alive: a target far away is answered with a duty within a second.
    let at = controller.position();
    let away = |coordinate: i32| if coordinate < 50_000 { 99_999 } else { 0 };
    let target = StepPoint::new(away(at.x), away(at.y));
    let mut demand = controller.start(now, target);
    prop_assert!(!controller.has_arrived());
    for _ in 0..2_500 {
        controller.applied(gate.pass(demand));
        if demand != Demand::NONE {
            return Ok(());
        }
        now = now.saturating_add(Duration::from_micros(400));
        demand = controller.tick(now);
    }
    prop_assert!(false, "no duty towards {target:?} from {at:?}");
    Ok(())
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn contouring_stays_in_range_and_alive_under_any_input(
        decoding in decoding(),
        settle_ms in prop_oneof![Just(0.0), Just(10.0)],
        inputs in prop::collection::vec((pause(), input()), 1..200),
    ) {
        let mut controller = Contouring::new(&machine(ControllerChoice::Contouring, decoding, settle_ms));
        runs(&mut controller, &inputs)?;
    }

    #[test]
    fn line_tracking_stays_in_range_under_any_input(
        inputs in prop::collection::vec((pause(), input()), 1..200),
    ) {
        let mut controller = LineTracking::new(&machine(ControllerChoice::Published, Decoding::X1, 10.0));
        let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        for (_, input) in inputs {
            let demand = match input {
                Input::Target(x, y) => controller.start(Duration::ZERO, StepPoint::new(x, y)),
                Input::Edge(axis, direction) => controller.edge(Duration::ZERO, axis, direction),
                Input::Tick | Input::Back(_) => controller.tick(Duration::ZERO),
            };
            prop_assert!(in_range(demand), "{demand:?} after {input:?}");
            // whole steps of 255 and within the published limits
            let steps = [demand.x, demand.y].map(|duty| f64::from(duty.value()) * 255.0);
            for (steps, limit) in steps.into_iter().zip([20.0, 255.0]) {
                /// Rounding of a quotient by 255 in f32, in steps.
                const ROUNDING_STEPS: f64 = 1e-4;
                prop_assert!((steps - steps.round()).abs() < ROUNDING_STEPS && steps.abs() <= limit + ROUNDING_STEPS);
            }
            controller.applied(gate.pass(demand));
        }
    }

    /// ×4 counts are the true position, rounded down. ×1 counts differ from it only by what it counts up or
    /// down where a shaft turns round within one half period; without turning round they agree as well.
    #[test]
    fn the_counts_of_an_axis_are_where_its_shaft_is(
        decoding in decoding(),
        drives in prop::collection::vec((-1.0..1.0_f32, 1..400_usize, any::<bool>()), 1..12),
        dt_s in prop_oneof![Just(1e-6), Just(1e-5), Just(1e-4)],
    ) {
        let mut config = AxisConfig::default();
        config.encoder.decoding = decoding;
        let mut axis = AxisPlant::new(&config, dt_s);
        let (mut count, mut turns, mut before) = (0_i32, 0_i32, 0.0);
        for (duty, steps, stalled) in drives {
            axis.stall(stalled);
            for _ in 0..steps {
                let mut last_share = 0.0;
                let mut ordered = true;
                axis.step(Duty::saturating(duty), |edge| {
                    ordered &= (last_share..=1.0).contains(&edge.share_of_step);
                    last_share = edge.share_of_step;
                    count += edge.direction.sign();
                });
                prop_assert!(ordered, "edges come in order, within the step");
                let speed = axis.state().speed_rad_s;
                turns += i32::from(speed * before < 0.0 || (speed == 0.0 && before != 0.0));
                before = speed;
                let ahead = axis.position_counts() + f64::from(decoding.rest_offset_counts()) - f64::from(count);
                match decoding {
                    Decoding::X2 | Decoding::X4 => prop_assert!((0.0..=1.0).contains(&ahead), "{ahead} counts ahead"),
                    _ => {
                        let trembled = f64::from(turns);
                        prop_assert!((-0.5 - trembled..=1.0 + trembled).contains(&ahead), "{ahead}, {turns} turns");
                    }
                }
            }
        }
    }

    #[test]
    fn pid_answers_any_number_with_one_in_range(
        gains in prop::array::uniform4(prop_oneof![-1e3..1e3_f32, any::<f32>()]),
        inputs in prop::collection::vec((any::<f32>(), any::<f32>(), any::<f32>()), 1..50),
    ) {
        let [kp, ki, kd, derivative_filter_s] = gains;
        let pid = Pid { kp, ki, kd, derivative_filter_s, output_min: -2.0, output_max: 3.0 };
        let mut state = PidState::default();
        for (setpoint, measured, dt_s) in inputs {
            prop_assert!((-2.0..=3.0).contains(&pid.update(&mut state, setpoint, measured, dt_s)));
            prop_assert!((-2.0..=3.0).contains(&state.integral()));
        }
    }
}

/// A slope beyond all numbers once made the derivative NaN for good, and the output with it.
#[test]
fn pid_recovers_from_a_step_over_no_time() {
    let pid = Pid { kp: 1.0, ki: 0.0, kd: 1.0, derivative_filter_s: 0.0, output_min: -9.0, output_max: 9.0 };
    let mut state = PidState::default();
    let _ = pid.update(&mut state, 0.0, 0.0, 0.01);
    let _ = pid.update(&mut state, 0.0, 1e3, 1e-40);
    let _ = pid.update(&mut state, 0.0, 2.0, 0.01);
    assert_eq!(pid.update(&mut state, 5.0, 2.0, 0.01), 3.0); // 1 * (5 - 2), the measurement stands
}

#[test]
fn without_settling_time_a_target_is_reached_where_it_is_not_where_it_was_taken() {
    let mut controller = Contouring::new(&machine(ControllerChoice::Contouring, Decoding::X1, 0.0));
    assert!(!controller.has_arrived());
    let _ = controller.start(Duration::ZERO, StepPoint::new(400, 0));
    assert!(!controller.has_arrived());
    let _ = controller.tick(Duration::from_micros(400));
    assert!(!controller.has_arrived());
}
