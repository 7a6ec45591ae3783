//! Every key of a machine's description with its unit, its range and what would be right.
//!
//! This is the only list of keys: the check of a [`MachineConfig`], the reader of TOML files and the test of
//! the page `docs/machine-config.md` all read it.

use super::belt_rules::BELT;
use super::transmission::{LATENCY, X_TRANSMISSION, Y_TRANSMISSION};
use super::{FileConfig, Key};

/// A key of this crate.
pub(super) type MachineKey = Key<FileConfig>;

pub(super) const fn number(
    key: &'static str,
    read: fn(&FileConfig) -> f64,
    range: (f64, f64),
    unit: &'static str,
    remedy: &'static str,
) -> MachineKey {
    Key::number(key, read, range, unit, remedy)
}

pub(super) const fn whole(
    key: &'static str,
    read: fn(&FileConfig) -> f64,
    range: (f64, f64),
    unit: &'static str,
    remedy: &'static str,
) -> MachineKey {
    Key::whole(key, read, range, unit, remedy)
}

const SIGN_OF_GAIN: &str = "for a motor that runs away swap its wires, not the sign";
const DUTY_OF_255: &str = "duty counts in steps of 255, as the published gains do";

/// Keys that the machine has once.
static MACHINE: [MachineKey; 61] = [
    whole("schema", |c| f64::from(c.schema), (1.0, 1.0), "", "write `schema = 1`"),
    Key::text("name", super::MachineName::MAX_BYTES),
    Key::choice("drive", &["dc", "stepper"]),
    number("area.width_mm", |c| c.area.width_mm, (1.0, 100_000.0), "mm", "an A2 sheet lying is 594 wide"),
    number("area.height_mm", |c| c.area.height_mm, (1.0, 100_000.0), "mm", "an A2 sheet lying is 420 high"),
    whole(
        "serial.baud",
        |c| f64::from(c.serial.baud),
        (300.0, 4_000_000.0),
        "baud",
        "the documented gantry uses 256000",
    ),
    number(
        "serial.byte_gap_ms",
        |c| c.serial.byte_gap_ms,
        (0.0, 1_000.0),
        "ms",
        "the documented gantry waits 10",
    ),
    number(
        "serial.resync_gap_ms",
        |c| c.serial.resync_gap_ms,
        (0.1, 60_000.0),
        "ms",
        "ten times serial.byte_gap_ms is a good choice",
    ),
    Key::choice("control.controller", &["published", "contouring"]),
    number(
        "control.published.kp",
        |c| f64::from(c.control.published.kp),
        (0.0, 10_000.0),
        "steps/count",
        SIGN_OF_GAIN,
    ),
    number(
        "control.published.ki",
        |c| f64::from(c.control.published.ki),
        (0.0, 10_000.0),
        "steps/count",
        SIGN_OF_GAIN,
    ),
    number(
        "control.published.kd_x",
        |c| f64::from(c.control.published.kd_x),
        (0.0, 10_000.0),
        "steps/count",
        SIGN_OF_GAIN,
    ),
    number(
        "control.published.kd_y",
        |c| f64::from(c.control.published.kd_y),
        (0.0, 10_000.0),
        "steps/count",
        SIGN_OF_GAIN,
    ),
    number(
        "control.published.duty_limit_x",
        |c| f64::from(c.control.published.duty_limit_x),
        (0.0, 255.0),
        "steps",
        DUTY_OF_255,
    ),
    number(
        "control.published.duty_limit_y",
        |c| f64::from(c.control.published.duty_limit_y),
        (0.0, 255.0),
        "steps",
        DUTY_OF_255,
    ),
    number(
        "control.published.duty_limit_y_vertical",
        |c| f64::from(c.control.published.duty_limit_y_vertical),
        (0.0, 255.0),
        "steps",
        DUTY_OF_255,
    ),
    number(
        "control.contouring.feed_mm_s",
        |c| c.control.contouring.feed_mm_s,
        (0.01, 10_000.0),
        "mm/s",
        "a pen draws well at 20 to 200",
    ),
    number(
        "control.contouring.accel_mm_s2",
        |c| c.control.contouring.accel_mm_s2,
        (0.1, 1.0e6),
        "mm/s^2",
        "ten times feed_mm_s reaches the feed within a tenth of a second",
    ),
    number(
        "control.contouring.jerk_mm_s3",
        |c| c.control.contouring.jerk_mm_s3,
        (1.0, 1.0e9),
        "mm/s^3",
        "thirty times accel_mm_s2 reaches full acceleration within 33 ms",
    ),
    number(
        "control.contouring.loop_hz",
        |c| c.control.contouring.loop_hz,
        (10.0, 100_000.0),
        "Hz",
        "a controller on a small chip runs 500 to 5000 times a second",
    ),
    number(
        "control.contouring.bandwidth_hz",
        |c| c.control.contouring.bandwidth_hz,
        (0.1, 10_000.0),
        "Hz",
        "10 to 100 suit small DC motors",
    ),
    number(
        "control.contouring.observer_hz",
        |c| c.control.contouring.observer_hz,
        (0.1, 10_000.0),
        "Hz",
        "three times bandwidth_hz is a good choice",
    ),
    number(
        "control.contouring.arrival_tolerance_counts",
        |c| c.control.contouring.arrival_tolerance_counts,
        (0.01, 1_000.0),
        "counts",
        "an exact arrival may never come: allow a quarter of a count at the least",
    ),
    number(
        "control.contouring.settle_ms",
        |c| c.control.contouring.settle_ms,
        (0.0, 10_000.0),
        "ms",
        "a few periods of the position loop are enough",
    ),
    number(
        "sync_stop.slope_counts",
        |c| c.sync_stop.slope_counts,
        (0.0, 100_000.0),
        "counts",
        "the published rule has 10",
    ),
    number(
        "sync_stop.offset_counts",
        |c| c.sync_stop.offset_counts,
        (1.0, 100_000.0),
        "counts",
        "below one count no motor could ever start; the published rule has 10",
    ),
    Key::choice("planner.mode", &["exact", "tolerance"]),
    Key::switch("planner.s_curve"),
    Key::choice("planner.accel_limit", &["vector", "axes"]),
    Key::choice("planner.jerk_limit", &["vector", "path"]),
    number(
        "planner.path_tolerance_mm",
        |c| c.planner.path_tolerance_mm,
        (0.0001, 10.0),
        "mm",
        "0.05 cannot be seen beside a pen's line",
    ),
    number(
        "planner.junction_deviation_mm",
        |c| c.planner.junction_deviation_mm,
        (0.0001, 10.0),
        "mm",
        "0.01 suits a belt drive; less is slower in corners",
    ),
    number(
        "planner.speed_mm_s",
        |c| c.planner.speed_mm_s,
        (0.01, 10_000.0),
        "mm/s",
        "a pen draws well at 20 to 200",
    ),
    number(
        "planner.travel_speed_mm_s",
        |c| c.planner.travel_speed_mm_s,
        (0.01, 10_000.0),
        "mm/s",
        "the documented stepper plotter reaches 91",
    ),
    number(
        "planner.accel_mm_s2",
        |c| c.planner.accel_mm_s2,
        (0.1, 1.0e6),
        "mm/s^2",
        "the documented stepper plotter needs 250",
    ),
    number(
        "planner.accel_x_mm_s2",
        |c| c.planner.accel_x_mm_s2,
        (0.1, 1.0e6),
        "mm/s^2",
        "what the motor x can do, without `accel_limit = \"axes\"` it is not read",
    ),
    number(
        "planner.accel_y_mm_s2",
        |c| c.planner.accel_y_mm_s2,
        (0.1, 1.0e6),
        "mm/s^2",
        "what the motor y can do, without `accel_limit = \"axes\"` it is not read",
    ),
    number(
        "planner.jerk_mm_s3",
        |c| c.planner.jerk_mm_s3,
        (1.0, 1.0e9),
        "mm/s^3",
        "thirty times accel_mm_s2 reaches full acceleration within 33 ms",
    ),
    number("pen.up_deg", |c| c.pen.up_deg, (0.0, 270.0), "deg", "a common servo turns from 0 to 180"),
    number("pen.down_deg", |c| c.pen.down_deg, (0.0, 270.0), "deg", "a common servo turns from 0 to 180"),
    number(
        "pen.settle_ms",
        |c| c.pen.settle_ms,
        (0.0, 10_000.0),
        "ms",
        "200 were found to be enough for a small servo",
    ),
    Key::choice("pen.lifted_by", &["spindle", "height"]),
    number(
        "pen.down_z_mm",
        |c| c.pen.down_z_mm,
        (-1000.0, 1000.0),
        "mm",
        "0 where a text lifts to a Z above it and lowers to 0 or below",
    ),
    Key::switch("laser.enabled"),
    whole(
        "laser.full_power",
        |c| f64::from(c.laser.full_power),
        (1.0, 65_535.0),
        "",
        "255 for mDraw, 1000 for most other senders",
    ),
    number(
        "homing.fast_rate_hz",
        |c| c.homing.fast_rate_hz,
        (1.0, 1.0e6),
        "pulses/s",
        "the documented stepper plotter has 8000",
    ),
    number(
        "homing.slow_rate_hz",
        |c| c.homing.slow_rate_hz,
        (1.0, 1.0e6),
        "pulses/s",
        "half the rate that the motors may start with is a good choice",
    ),
    number(
        "homing.pull_off_mm",
        |c| c.homing.pull_off_mm,
        (0.01, 100.0),
        "mm",
        "on the switch itself no origin is possible: 1 is a good choice",
    ),
    number(
        "homing.release_mm",
        |c| c.homing.release_mm,
        (0.01, 1_000.0),
        "mm",
        "a switch opens within a few millimetres",
    ),
    number(
        "homing.known_travel_mm",
        |c| c.homing.known_travel_mm,
        (0.0, 100_000.0),
        "mm",
        "a little less than the shorter axis; 0 if its length is not known",
    ),
    number(
        "homing.max_travel_mm",
        |c| c.homing.max_travel_mm,
        (1.0, 100_000.0),
        "mm",
        "a little more than the longer axis",
    ),
    whole(
        "stepper_motor.full_steps_per_turn",
        |c| f64::from(c.stepper_motor.full_steps_per_turn),
        (4.0, 10_000.0),
        "",
        "a motor of 1.8 degrees has 200",
    ),
    whole(
        "stepper_motor.microsteps",
        |c| f64::from(c.stepper_motor.microsteps),
        (1.0, 256.0),
        "",
        "an A4988 makes up to 16",
    ),
    number(
        "stepper_motor.holding_n_m",
        |c| c.stepper_motor.holding_n_m,
        (1.0e-6, 1_000.0),
        "N m",
        "a common motor of 42 mm has 0.2 to 0.5",
    ),
    number(
        "stepper_motor.corner_rate_hz",
        |c| c.stepper_motor.corner_rate_hz,
        (1.0, 1.0e7),
        "pulses/s",
        "the rate from which the data sheet's torque curve falls, in microsteps",
    ),
    number(
        "stepper_motor.max_rate_hz",
        |c| c.stepper_motor.max_rate_hz,
        (1.0, 1.0e7),
        "pulses/s",
        "the rate at which the data sheet's torque curve ends, in microsteps",
    ),
    number(
        "stepper_motor.inertia_kg_m2",
        |c| c.stepper_motor.inertia_kg_m2,
        (1.0e-12, 10.0),
        "kg m^2",
        "the rotor's and the mass times the square of the pulley's radius",
    ),
    number(
        "stepper_motor.coulomb_n_m",
        |c| c.stepper_motor.coulomb_n_m,
        (0.0, 1_000.0),
        "N m",
        "friction is given as a size, without sign: 0 for none",
    ),
    number(
        "stepper_motor.viscous_n_m_s",
        |c| c.stepper_motor.viscous_n_m_s,
        (0.0, 100.0),
        "N m s",
        "friction is given as a size, without sign: 0 for none",
    ),
    number(
        "stepper_motor.damping_n_m_s",
        |c| c.stepper_motor.damping_n_m_s,
        (0.0, 100.0),
        "N m s",
        "0 is a motor whose swing nothing damps but friction",
    ),
    Key::table("vectorize"),
];

/// Keys that each axis has.
macro_rules! axis_rules {
    ($axis:ident) => {
        [
            number(
                concat!(stringify!($axis), ".counts_per_mm"),
                |c| c.$axis.counts_per_mm,
                (0.001, 100_000.0),
                "counts/mm",
                "the documented gantry has 40",
            ),
            whole(
                concat!(stringify!($axis), ".encoder.lines_per_turn"),
                |c| f64::from(c.$axis.encoder.lines_per_turn),
                (1.0, 1.0e6),
                "",
                "count the slots of the disc",
            ),
            Key::choice(concat!(stringify!($axis), ".encoder.decoding"), &["x1", "x2", "x4"]),
            number(
                concat!(stringify!($axis), ".motor.supply_v"),
                |c| c.$axis.motor.supply_v,
                (0.1, 1_000.0),
                "V",
                "an L293D takes 4.5 to 36",
            ),
            whole(
                concat!(stringify!($axis), ".motor.pwm_steps"),
                |c| f64::from(c.$axis.motor.pwm_steps),
                (1.0, 65_535.0),
                "",
                "an 8 bit timer has 255",
            ),
            number(
                concat!(stringify!($axis), ".motor.enable_pwm_hz"),
                |c| c.$axis.motor.enable_pwm_hz,
                (0.0, 100_000.0),
                "Hz",
                "0 for a PWM on the bridge's inputs; on its enable pin the thesis has 2500",
            ),
            number(
                concat!(stringify!($axis), ".motor.resistance_ohm"),
                |c| c.$axis.motor.resistance_ohm,
                (1.0e-3, 1.0e5),
                "ohm",
                "measure between the motor's terminals: a small motor has 1 to 20",
            ),
            number(
                concat!(stringify!($axis), ".motor.inductance_h"),
                |c| c.$axis.motor.inductance_h,
                (1.0e-9, 10.0),
                "H",
                "a small motor has 1e-5 to 1e-3",
            ),
            number(
                concat!(stringify!($axis), ".motor.back_emf_v_s"),
                |c| c.$axis.motor.back_emf_v_s,
                (1.0e-6, 100.0),
                "V s",
                "supply voltage divided by the no-load speed in rad/s",
            ),
            number(
                concat!(stringify!($axis), ".motor.torque_n_m_per_a"),
                |c| c.$axis.motor.torque_n_m_per_a,
                (1.0e-6, 100.0),
                "N m/A",
                "about the same figure as back_emf_v_s",
            ),
            number(
                concat!(stringify!($axis), ".motor.inertia_kg_m2"),
                |c| c.$axis.motor.inertia_kg_m2,
                (1.0e-12, 10.0),
                "kg m^2",
                "a small rotor has 1e-7 to 1e-5",
            ),
            number(
                concat!(stringify!($axis), ".load.inertia_kg_m2"),
                |c| c.$axis.load.inertia_kg_m2,
                (0.0, 10.0),
                "kg m^2",
                "0 for a motor that turns nothing",
            ),
            number(
                concat!(stringify!($axis), ".load.coulomb_n_m"),
                |c| c.$axis.load.coulomb_n_m,
                (0.0, 1_000.0),
                "N m",
                "friction is given as a size, without sign: 0 for none",
            ),
            number(
                concat!(stringify!($axis), ".load.static_n_m"),
                |c| c.$axis.load.static_n_m,
                (0.0, 1_000.0),
                "N m",
                "friction is given as a size, without sign: 0 for none",
            ),
            number(
                concat!(stringify!($axis), ".load.viscous_n_m_s"),
                |c| c.$axis.load.viscous_n_m_s,
                (0.0, 100.0),
                "N m s",
                "friction is given as a size, without sign: 0 for none",
            ),
            number(
                concat!(stringify!($axis), ".stepper.steps_per_mm"),
                |c| c.$axis.stepper.steps_per_mm,
                (0.001, 100_000.0),
                "steps/mm",
                "the documented stepper plotter has 87.58",
            ),
            Key::switch(concat!(stringify!($axis), ".stepper.inverted")),
            number(
                concat!(stringify!($axis), ".stepper.backlash_mm"),
                |c| c.$axis.stepper.backlash_mm,
                (0.0, 10.0),
                "mm",
                "play is given as a size, without sign: 0 for none",
            ),
            number(
                concat!(stringify!($axis), ".stepper.start_rate_hz"),
                |c| c.$axis.stepper.start_rate_hz,
                (1.0, 1.0e6),
                "pulses/s",
                "the documented stepper plotter has 2000",
            ),
            number(
                concat!(stringify!($axis), ".stepper.max_rate_hz"),
                |c| c.$axis.stepper.max_rate_hz,
                (1.0, 1.0e6),
                "pulses/s",
                "the documented stepper plotter has 8000",
            ),
        ]
    };
}

/// Tables that other crates read, after those of this one.
static OTHERS: [MachineKey; 2] = [Key::table("sheet"), Key::table("follower")];

static X: [MachineKey; 20] = axis_rules!(x);
static Y: [MachineKey; 20] = axis_rules!(y);

/// All keys, in the order of the documentation.
pub(super) fn rules() -> impl Iterator<Item = &'static MachineKey> {
    #[cfg(feature = "third-motor")]
    let third_motor = &super::third_motor::RULES;
    #[cfg(not(feature = "third-motor"))]
    let third_motor = &[];
    MACHINE
        .iter()
        .chain(third_motor)
        .chain(&LATENCY)
        .chain(&BELT)
        .chain(&OTHERS)
        .chain(&X)
        .chain(&X_TRANSMISSION)
        .chain(&Y)
        .chain(&Y_TRANSMISSION)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::section::Form;
    use std::{eprintln, format, fs, string::String, vec::Vec};

    /// Relative distance between a number and the single-precision number nearest to it.
    const SINGLE_PRECISION: f64 = 6.0e-8;

    /// A file of the repository beside this crate; a crate unpacked alone does not have it.
    fn beside_the_crate(path: &str) -> Option<String> {
        let text = fs::read_to_string(format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"))).ok();
        if text.is_none() {
            eprintln!("{path} is not here: nothing to compare");
        }
        text
    }

    #[test]
    fn no_key_is_listed_twice() {
        let mut keys: Vec<_> = rules().map(Key::key).collect();
        let listed = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), listed);
    }

    #[test]
    fn the_documentation_page_gives_every_key_with_its_range() {
        let Some(page) = beside_the_crate("docs/machine-config.md") else { return };
        for rule in rules() {
            let key = rule.key().replacen("y.", "x.", usize::from(rule.key().starts_with("y.")));
            if matches!(rule.rule.form, Form::Table) {
                assert!(page.contains(&format!("| `{key}.")), "no rows for `{key}`");
                continue;
            }
            let row = page.lines().find(|line| line.contains(&format!("| `{key}` |")));
            let row = row.unwrap_or_else(|| panic!("no row for `{key}`"));
            if let Some(((least_allowed, most_allowed), unit)) = rule.range() {
                let cells: Vec<_> = row.split('|').map(str::trim).collect();
                assert_eq!(cells[2], unit, "unit of `{key}`");
                let (least, most) = cells[3].split_once("..").unwrap_or((cells[3], cells[3]));
                let most = most.replace(',', "");
                assert_eq!((least.parse(), most.parse()), (Ok(least_allowed), Ok(most_allowed)), "`{key}`");
            }
        }
    }

    #[test]
    fn the_documentation_page_gives_every_default() {
        let Some(page) = beside_the_crate("docs/machine-config.md") else { return };
        let default = FileConfig::default();
        for rule in rules().filter(|rule| !rule.key().starts_with("y.")) {
            let Some(value) = rule.value(&default) else { continue };
            let row = page.lines().find(|line| line.contains(&format!("| `{}` |", rule.key()))).unwrap();
            let written: f64 = row.split('|').map(str::trim).nth(4).unwrap().parse().unwrap();
            // Gains are held in single precision: the page says 1e-5, the field the number nearest to it.
            assert!((written - value).abs() <= value.abs() * SINGLE_PRECISION, "default of `{}`", rule.key());
        }
    }
}
