//! Laws of the machine's description.
#![cfg(feature = "toml")]

use plotter_motion::{ConfigError, Machine, MachineConfig, config::TomlError};
use proptest::prelude::*;

/// A file with every kind of key and value, so that a mutation meets them all.
const FILE: &str = r#"
schema = 1
name = "mutant"
drive = "dc"
area = { width_mm = 594.0, height_mm = 420.0 }
serial = { baud = 256000, byte_gap_ms = 10.0, resync_gap_ms = 100.0 }
[control]
controller = "contouring"
published = { kp = 15.0, ki = 0.00001, kd_x = 0.0, kd_y = 10.0 }
[control.contouring]
feed_mm_s = 60.0
accel_mm_s2 = 600.0
loop_hz = 2_500
[sync_stop]
slope_counts = 1e1
[vectorize]
mode = "mixed"
pieces = "arcs"
threshold = "128"
pens = 3
[planner]
s_curve = true
[kinematics]
type = "cartesian"
signs = "tracking-equations"
[belt]
known_motors = "each"
[point_to_point]
equalize = true
[x.stepper]
inverted = true
[x.encoder]
lines_per_turn = 0x64
decoding = "x4"
[y.motor]
resistance_ohm = +1.9
[y.load]
static_n_m = 1.3e-3
"#;

/// A height.
const MAY_BE_NEGATIVE: [&str; 2] = ["pen.down_z_mm", "second_motor.offset_mm"];

/// Numeric keys that the machine has once.
const OF_THE_MACHINE: [&str; 58] = [
    "schema",
    "area.width_mm",
    "area.height_mm",
    "serial.baud",
    "serial.byte_gap_ms",
    "serial.resync_gap_ms",
    "control.latency_periods",
    "control.published.kp",
    "control.published.ki",
    "control.published.kd_x",
    "control.published.kd_y",
    "control.published.duty_limit_x",
    "control.published.duty_limit_y",
    "control.published.duty_limit_y_vertical",
    "control.contouring.feed_mm_s",
    "control.contouring.accel_mm_s2",
    "control.contouring.jerk_mm_s3",
    "control.contouring.loop_hz",
    "control.contouring.bandwidth_hz",
    "control.contouring.observer_hz",
    "control.contouring.arrival_tolerance_counts",
    "control.contouring.settle_ms",
    "sync_stop.slope_counts",
    "sync_stop.offset_counts",
    "planner.path_tolerance_mm",
    "planner.junction_deviation_mm",
    "planner.speed_mm_s",
    "planner.travel_speed_mm_s",
    "planner.accel_mm_s2",
    "planner.jerk_mm_s3",
    "pen.up_deg",
    "pen.down_deg",
    "pen.settle_ms",
    "pen.down_z_mm",
    "laser.full_power",
    "homing.fast_rate_hz",
    "homing.slow_rate_hz",
    "homing.pull_off_mm",
    "homing.release_mm",
    "homing.known_travel_mm",
    "homing.max_travel_mm",
    "z.steps_per_mm",
    "z.speed_mm_s",
    "z.accel_mm_s2",
    "z.travel_mm",
    "z.up_mm",
    "z.down_mm",
    "z.start_rate_hz",
    "second_motor.offset_mm",
    "second_motor.max_skew_mm",
    "stepper_motor.full_steps_per_turn",
    "stepper_motor.microsteps",
    "stepper_motor.holding_n_m",
    "stepper_motor.corner_rate_hz",
    "stepper_motor.max_rate_hz",
    "stepper_motor.inertia_kg_m2",
    "stepper_motor.coulomb_n_m",
    "stepper_motor.viscous_n_m_s",
];

/// Numeric keys of a machine with a belt.
const OF_A_BELT: [&str; 24] = [
    "belt.start_x_mm",
    "belt.start_y_mm",
    "belt.speed_window_mm_s",
    "belt.run_down_ms",
    "belt.unequal_share",
    "belt.x_rail_coulomb_n",
    "belt.x_rail_static_n",
    "belt.y_rail_coulomb_n",
    "belt.y_rail_static_n",
    "point_to_point.allowed_error_mm",
    "point_to_point.period_ms",
    "point_to_point.drive_start",
    "point_to_point.drive_step",
    "point_to_point.drive_step_ms",
    "point_to_point.drive_most",
    "point_to_point.slow_mm",
    "point_to_point.factor_x",
    "point_to_point.factor_y",
    "point_to_point.run_down_ms",
    "point_to_point.unequal_share",
    "point_to_point.equalizer_time_constant_ms",
    "point_to_point.equalizer_pole_rad_s",
    "point_to_point.equalizer_full_speed_mm_s",
    "point_to_point.equalizer_most_trim",
];

/// Numeric keys that each axis has.
const OF_AN_AXIS: [&str; 22] = [
    "counts_per_mm",
    "encoder.lines_per_turn",
    "motor.supply_v",
    "motor.pwm_steps",
    "motor.resistance_ohm",
    "motor.inductance_h",
    "motor.back_emf_v_s",
    "motor.torque_n_m_per_a",
    "motor.inertia_kg_m2",
    "load.inertia_kg_m2",
    "load.coulomb_n_m",
    "load.static_n_m",
    "load.viscous_n_m_s",
    "transmission.backlash_mm",
    "transmission.stiffness_n_per_mm",
    "transmission.damping_n_s_per_mm",
    "transmission.carriage_kg",
    "transmission.rail_friction_n",
    "stepper.steps_per_mm",
    "stepper.backlash_mm",
    "stepper.start_rate_hz",
    "stepper.max_rate_hz",
];

/// Keys whose number must be whole.
const WHOLE: [&str; 8] = [
    "schema",
    "serial.baud",
    "control.latency_periods",
    "laser.full_power",
    "stepper_motor.full_steps_per_turn",
    "stepper_motor.microsteps",
    "encoder.lines_per_turn",
    "motor.pwm_steps",
];

/// Every numeric key, and whether its number must be whole.
fn numbers() -> impl Iterator<Item = (String, bool)> {
    let of_axes = ["x", "y"]
        .into_iter()
        .flat_map(|axis| OF_AN_AXIS.into_iter().map(move |key| format!("{axis}.{key}")));
    let all = OF_THE_MACHINE.into_iter().chain(OF_A_BELT).map(str::to_owned).chain(of_axes);
    all.map(|key| {
        let is_whole = WHOLE.iter().any(|whole| key.ends_with(whole));
        (key, is_whole)
    })
}

fn with(key: &str, value: &str) -> Result<Machine, TomlError> {
    let schema = if key == "schema" { "" } else { "schema = 1\n" };
    Machine::from_toml(&format!("{schema}{key} = {value}\n"))
}

fn is_out_of_range(outcome: &Result<Machine, TomlError>) -> bool {
    matches!(outcome, Err(TomlError::Invalid { error: ConfigError::OutOfRange { .. }, .. }))
}

#[test]
fn no_number_may_be_infinite_or_negative_or_none() {
    for (key, is_whole) in numbers().filter(|(key, _)| !MAY_BE_NEGATIVE.contains(&key.as_str())) {
        let values: &[&str] = if is_whole { &["-1"] } else { &["nan", "inf", "-inf", "-1e-9"] };
        for value in values {
            match with(&key, value) {
                Err(TomlError::Invalid { at: Some(_), error }) => assert_eq!(error.key(), key),
                other => panic!("{key} = {value}: {other:?}"),
            }
        }
    }
}

/// At the ends of its range a value may contradict another one, but it lies in its range; beyond, it does
/// not.
#[test]
fn the_range_in_a_refusal_is_the_range_that_holds() {
    for (key, is_whole) in
        numbers().filter(|(key, _)| key != "schema" && !MAY_BE_NEGATIVE.contains(&key.as_str()))
    {
        let Err(TomlError::Invalid { error: ConfigError::OutOfRange { least, most, .. }, .. }) =
            with(&key, "-1")
        else {
            panic!("{key}: a negative number is not out of range");
        };
        let written = |value: f64| if is_whole { format!("{value}") } else { format!("{value:e}") };
        for inside in [least, most] {
            assert!(!is_out_of_range(&with(&key, &written(inside))), "{key} = {inside}");
        }
        let above = if is_whole { most + 1.0 } else { most * 1.001 };
        assert!(is_out_of_range(&with(&key, &written(above))), "{key} = {above}");
    }
}

#[test]
fn the_file_before_its_mutation_is_a_machine() {
    assert!(Machine::from_toml(FILE).is_ok(), "{:?}", Machine::from_toml(FILE));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Bytes struck out, written over and put in, at any place: an error with its place, or a machine.
    #[test]
    fn no_mutation_of_a_file_panics(
        cuts in prop::collection::vec((0..FILE.len(), 0..8_usize, "[ -~\n\t\u{e9}\u{1b}]{0,6}"), 1..6),
    ) {
        let mut text = FILE.to_owned();
        for (at, length, put) in cuts {
            let at = at.min(text.len());
            let end = (at + length).min(text.len());
            if text.is_char_boundary(at) && text.is_char_boundary(end) {
                text.replace_range(at..end, &put);
            }
        }
        if let Err(error) = Machine::from_toml(&text) {
            let lines = text.lines().count() + 1;
            prop_assert!(error.place().is_none_or(|at| (1..=lines).contains(&at.line) && at.column >= 1));
            prop_assert!(!error.to_string().is_empty());
        }
    }

    /// Any text at all, under a right first line so that it is read on.
    #[test]
    fn no_text_panics(text in "\\PC{0,200}") {
        let outcome = Machine::from_toml(&format!("schema = 1\n{text}"));
        prop_assert!(outcome.is_ok() || outcome.is_err_and(|error| !error.to_string().is_empty()));
    }

    /// The check is the same with and without TOML.
    #[test]
    fn a_file_is_refused_exactly_when_its_config_is(
        width_mm in 0.1..5_000.0_f64, counts_per_mm in 0.1..200.0_f64, static_n_m in 0.0..0.2_f64,
    ) {
        let text = format!(
            "schema = 1\narea.width_mm = {width_mm:?}\nx.counts_per_mm = {counts_per_mm:?}\n\
             y.load.static_n_m = {static_n_m:?}\n"
        );
        let config = MachineConfig::from_toml(&text).expect("well formed");
        let by_config = Machine::new(config).map_err(|error| error.key());
        let by_file = Machine::from_toml(&text).map_err(|error| match error {
            TomlError::Invalid { error, .. } => error.key(),
            other => panic!("{other}"),
        });
        prop_assert_eq!(by_config, by_file);
    }
}
