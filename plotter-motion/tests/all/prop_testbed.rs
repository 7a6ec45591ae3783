//! Laws of what the control test bed is made of: planned lines, learning, worn transmissions, latency.

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::control::{
    AxisController, AxisState, ContourController, ContourState, CrossCoupled, CrossCoupledSettings,
    LearnedBin, Learning, LearningSettings, LineController, PerAxis, PlannedLine, PlannedPid,
    PointToPointSettings, TwoAxes,
};
use plotter_motion::plant::{AxisPlant, DriveDelay};
use plotter_motion::{
    Axis, Demand, Direction, Duty, LimitSwitches, Machine, MachineConfig, SafetyGate, StepPoint,
    config::{AxisConfig, LoadConfig, TransmissionConfig},
};
use proptest::prelude::*;

#[expect(clippy::unwrap_used, reason = "a test may panic")]
fn machine() -> Machine {
    Machine::new(MachineConfig::default()).unwrap()
}

fn cross_coupled(machine: &Machine) -> CrossCoupled<TwoAxes<PlannedPid>> {
    let axes = TwoAxes::<PlannedPid>::of(machine).with_feed_forward();
    CrossCoupled::new(axes, CrossCoupledSettings::of(machine))
}

#[derive(Clone, Copy, Debug)]
enum Input {
    Target(i32, i32),
    Edge(Axis, Direction),
    Tick,
}

fn input() -> impl Strategy<Value = Input> {
    let coordinate = || prop_oneof![4 => 0..100_000_i32, 1 => any::<i32>()];
    let axis = prop_oneof![Just(Axis::X), Just(Axis::Y)];
    let direction = prop_oneof![Just(Direction::Plus), Just(Direction::Minus)];
    prop_oneof![
        1 => (coordinate(), coordinate()).prop_map(|(x, y)| Input::Target(x, y)),
        4 => (axis, direction).prop_map(|(axis, direction)| Input::Edge(axis, direction)),
        8 => Just(Input::Tick),
    ]
}

fn inputs() -> impl Strategy<Value = Vec<(Duration, Input)>> {
    let pause = prop_oneof![
        8 => (0..5_000_u64).prop_map(Duration::from_micros),
        1 => (0..1_000_000_u64).prop_map(Duration::from_secs),
        1 => Just(Duration::MAX),
    ];
    prop::collection::vec((pause, input()), 1..200)
}

/// Whatever may flow: the demand is in range, and a target far away is answered with a duty within a second.
fn stays_alive(
    mut controller: impl LineController,
    inputs: &[(Duration, Input)],
) -> Result<(), TestCaseError> {
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut now = Duration::ZERO;
    for &(pause, input) in inputs {
        now = now.saturating_add(pause);
        let demand = match input {
            Input::Target(x, y) => controller.start(now, StepPoint::new(x, y)),
            Input::Edge(axis, direction) => controller.edge(now, axis, direction),
            Input::Tick => controller.tick(now),
        };
        for duty in [demand.x, demand.y] {
            prop_assert!((-1.0..=1.0).contains(&duty.value()), "{demand:?} after {input:?}");
        }
        controller.applied(gate.pass(demand));
    }
    let away = |coordinate: i32| if coordinate < 50_000 { 99_999 } else { 0 };
    let at = controller.position();
    let mut demand = controller.start(now, StepPoint::new(away(at.x), away(at.y)));
    prop_assert!(!controller.has_arrived());
    for _ in 0..2_500 {
        controller.applied(gate.pass(demand));
        if demand != Demand::NONE {
            return Ok(());
        }
        now = now.saturating_add(Duration::from_micros(400));
        demand = controller.tick(now);
    }
    prop_assert!(false, "no duty");
    Ok(())
}

/// A control law that answers anything at all, also with no number.
struct Wild(f32);

impl AxisController for Wild {
    fn update(&mut self, state: &AxisState, _dt_s: f32) -> Duty {
        Duty::saturating(self.0 * state.error())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

    #[test]
    fn planned_lines_stay_in_range_and_alive_under_any_input(inputs in inputs()) {
        let machine = machine();
        stays_alive(PlannedLine::new(&machine, TwoAxes::<PlannedPid>::of(&machine)), &inputs)?;
        stays_alive(PlannedLine::new(&machine, cross_coupled(&machine)), &inputs)?;
        let mut store = vec![LearnedBin::default(); 50];
        let learning = Learning::new(cross_coupled(&machine), LearningSettings::of(&machine), &mut store);
        stays_alive(PlannedLine::new(&machine, learning), &inputs)?;
    }

    #[test]
    fn point_to_point_per_axis_stays_in_range_and_alive_under_any_input(inputs in inputs()) {
        // counts that only a broken encoder has do not belong to a target on a sheet
        let inputs: Vec<_> = inputs.into_iter().filter(|(_, input)| !matches!(input, Input::Target(x, y) if x.max(y) > &99_999 || x.min(y) < &0)).collect();
        stays_alive(PerAxis::new(PointToPointSettings::default()), &inputs)?;
    }

    /// A user's law may be wild; what goes to the motors is not.
    #[test]
    fn a_wild_control_law_cannot_ask_for_more_than_the_supply(gain in any::<f32>(), inputs in inputs()) {
        let machine = machine();
        let mut controller = PlannedLine::new(&machine, TwoAxes { x: Wild(gain), y: Wild(-gain) });
        let mut now = Duration::ZERO;
        for (pause, input) in inputs {
            now = now.saturating_add(pause);
            let demand = match input {
                Input::Target(x, y) => controller.start(now, StepPoint::new(x, y)),
                Input::Edge(axis, direction) => controller.edge(now, axis, direction),
                Input::Tick => controller.tick(now),
            };
            for duty in [demand.x, demand.y] {
                // whole steps of the timer
                let steps = f64::from(duty.value()) * 255.0;
                prop_assert!(steps.abs() <= 255.0 && (steps - steps.round()).abs() < 1e-4);
            }
        }
    }

    /// Whatever was seen, what is learned is a duty, and a store of any length will do.
    #[test]
    fn what_is_learned_is_a_duty(
        length in 0..60_usize,
        runs in prop::collection::vec(
            prop::collection::vec((0.0..0.02_f32, prop::option::of(any::<f32>()), prop::option::of(-1e3..1e3_f32)), 1..40),
            1..5,
        ),
        durations in prop::collection::vec(0.0..0.02_f32, 1..4),
    ) {
        let machine = machine();
        let settings = LearningSettings::of(&machine);
        let mut store = vec![LearnedBin::default(); length];
        for run in runs {
            let mut learning = Learning::new(TwoAxes { x: Wild(0.0), y: Wild(0.0) }, settings, &mut store);
            for &duration in &durations {
                learning.start(duration);
                for &(plan_s, x, y) in &run {
                    let axis = |edge_error| AxisState { edge_error, ..AxisState::default() };
                    let state = ContourState { x: axis(x), y: axis(y), plan_s, dt_s: 4e-4, ..ContourState::default() };
                    let demand = learning.update(&state);
                    prop_assert!(demand.x.value().abs() <= 1.0 && demand.y.value().abs() <= 1.0);
                }
            }
        }
        let _ = Learning::new(TwoAxes { x: Wild(0.0), y: Wild(0.0) }, settings, &mut store);
        for bin in &store {
            prop_assert!(bin.correction().iter().all(|duty| (-1.0..=1.0).contains(duty)), "{bin:?}");
        }
    }

    /// The pen is never farther from the shaft than half the play, and within it it stays where it is.
    #[test]
    fn play_holds_the_pen_between_its_ends(
        backlash_mm in 0.001..2.0_f64,
        drives in prop::collection::vec((-1.0..1.0_f32, 1..400_usize), 1..12),
    ) {
        /// Rounding of places of some hundred mm.
        const ROUNDING_MM: f64 = 1e-9;
        let transmission = TransmissionConfig { backlash_mm, ..TransmissionConfig::default() };
        let config = AxisConfig { transmission, ..AxisConfig::default() };
        let (mut axis, mut tight) = (AxisPlant::new(&config, 1e-5), AxisPlant::new(&AxisConfig::default(), 1e-5));
        let mut pen = axis.position_mm();
        for (duty, steps) in drives {
            for _ in 0..steps {
                axis.step(Duty::saturating(duty), |_| ());
                tight.step(Duty::saturating(duty), |_| ());
                let shaft = tight.position_mm();
                prop_assert_eq!(axis.position_counts(), tight.position_counts(), "the shaft knows nothing of it");
                let apart = (shaft - axis.position_mm()).abs();
                prop_assert!(apart <= backlash_mm / 2.0 + ROUNDING_MM, "{apart}");
                if (shaft - pen).abs() < backlash_mm / 2.0 {
                    prop_assert_eq!(axis.position_mm(), pen);
                }
                pen = axis.position_mm();
            }
        }
    }

}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(24) })]

    /// No belt gains energy from nowhere: three seconds without drive, and all is at rest.
    #[test]
    fn a_belt_swings_about_the_shaft_and_comes_to_rest(
        stiffness_n_per_mm in 5.0..2e4_f64, carriage_kg in 0.05..3.0_f64, backlash_mm in 0.0..0.5_f64,
        damping_n_s_per_mm in 0.02..0.5_f64, rail_friction_n in 0.1..5.0_f64, duty in -1.0..1.0_f32,
    ) {
        let transmission =
            TransmissionConfig { backlash_mm, stiffness_n_per_mm, damping_n_s_per_mm, carriage_kg, rail_friction_n };
        let config = AxisConfig { transmission, ..AxisConfig::default() };
        let mut axis = AxisPlant::new(&config, 1e-5);
        for _ in 0..20_000 {
            axis.step(Duty::saturating(duty), |_| ());
            prop_assert!(axis.position_mm().is_finite() && axis.state().current_a.abs() < 20.0);
        }
        for _ in 0..300_000 {
            axis.step(Duty::ZERO, |_| ());
        }
        // at rest the belt is stretched by no more than the rail's friction holds, and the motor's own
        let held_n = rail_friction_n + config.load.static_n_m / (config.mm_per_rad() / 1e3);
        let apart = (axis.position_counts() / config.counts_per_mm - axis.position_mm()).abs();
        let most = backlash_mm / 2.0 + held_n / stiffness_n_per_mm + 1e-6;
        prop_assert!(apart <= most, "{apart} mm apart, at most {most}");
        prop_assert!(axis.state().speed_rad_s.abs() < 1e-3, "{:?}", axis.state());
    }

    /// What was asked for acts, in its order, after the delay and not before.
    #[test]
    fn latency_keeps_the_order(changes in prop::collection::vec((1..500_u64, -1.0..1.0_f32), 1..20), delay_us in 1..20_000_u64) {
        let delay = Duration::from_micros(delay_us);
        let mut delayed = DriveDelay::new(delay);
        let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        let mut asked = vec![(Duration::ZERO, [Duty::ZERO; 2])];
        let mut now = Duration::ZERO;
        for (pause, x) in changes {
            now += Duration::from_micros(pause);
            let drive = gate.pass(Demand { x: Duty::saturating(x), y: Duty::ZERO });
            asked.push((now, drive.duties()));
            let acts = delayed.pass(now, drive);
            let expected = asked.iter().rev().find(|(at, _)| *at + delay <= now).map_or([Duty::ZERO; 2], |(_, duties)| *duties);
            prop_assert_eq!(acts, expected);
        }
    }
}

/// A carriage on a belt that does not stretch is an inertia at the shaft.
#[test]
fn a_very_stiff_belt_moves_as_a_rigid_one() {
    let rigid =
        TransmissionConfig { carriage_kg: 1.0, rail_friction_n: 0.5, ..TransmissionConfig::default() };
    let stiff = TransmissionConfig { stiffness_n_per_mm: 1e5, damping_n_s_per_mm: 5.0, ..rigid };
    let load = LoadConfig { static_n_m: 1.3e-3, ..LoadConfig::default() };
    let [mut one, mut other] = [rigid, stiff].map(|transmission| {
        AxisPlant::new(&AxisConfig { load, transmission, ..AxisConfig::default() }, 1e-5)
    });
    /// Of some 20 mm: the stretch of the belt and the first steps.
    const APART_MM: f64 = 0.02;
    for _ in 0..20_000 {
        one.step(Duty::saturating(0.1), |_| ());
        other.step(Duty::saturating(0.1), |_| ());
    }
    assert!(one.position_mm() > 5.0);
    assert!(
        (one.position_mm() - other.position_mm()).abs() < APART_MM,
        "{} {}",
        one.position_mm(),
        other.position_mm()
    );
}
