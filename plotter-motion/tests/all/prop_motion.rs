//! Laws that hold for any input.

use crate::law_cases::cases;
use crate::switches::stands_in_the_way;
use core::time::Duration;
use plotter_motion::control::ShaftEstimator;
use plotter_motion::firmware::Gantry;
use plotter_motion::protocol::digits::{self, Receiver, Reply};
use plotter_motion::{
    Axis, Demand, Direction, Duty, LimitSwitches, Machine, MachineConfig, MotionLimits, SafetyGate,
    StepPoint,
    config::{AxisConfig, ControllerChoice, Decoding},
    control::{Pid, PidState},
    encoder::{Phases, QuadratureX1, QuadratureX4},
    profile::SCurve,
    toolpath::from_mm,
};
use proptest::prelude::*;

/// Rounding of sums of a few products in f64, as a share.
const ROUNDING: f64 = 1e-9;

fn direction() -> impl Strategy<Value = Direction> {
    prop_oneof![Just(Direction::Plus), Just(Direction::Minus)]
}

fn axis() -> impl Strategy<Value = Axis> {
    prop_oneof![Just(Axis::X), Just(Axis::Y)]
}

fn target() -> impl Strategy<Value = StepPoint> {
    (0..=digits::GREATEST, 0..=digits::GREATEST).prop_map(|(x, y)| StepPoint::new(x, y))
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn a_planned_motion_keeps_its_limits_and_ends_at_rest(
        length_mm in 0.0..500.0_f64,
        speed_mm_s in 0.1..500.0_f64,
        accel_mm_s2 in 1.0..10_000.0_f64,
        jerk_mm_s3 in 10.0..1e6_f64,
    ) {
        let motion = SCurve::plan(length_mm, MotionLimits { speed_mm_s, accel_mm_s2, jerk_mm_s3 }).unwrap();
        let duration_s = motion.duration_s();
        let mut before = motion.at(0.0);
        for i in 0..=200 {
            let t = duration_s * f64::from(i) / 200.0;
            let point = motion.at(t);
            let dt = duration_s / 200.0;
            prop_assert!(point.speed_mm_s <= speed_mm_s * (1.0 + ROUNDING) && point.speed_mm_s >= -ROUNDING * speed_mm_s);
            prop_assert!(point.accel_mm_s2.abs() <= accel_mm_s2 * (1.0 + ROUNDING));
            prop_assert!(point.distance_mm >= before.distance_mm - ROUNDING * length_mm);
            if i > 0 {
                let step = point.distance_mm - before.distance_mm;
                prop_assert!(step <= speed_mm_s * dt * (1.0 + ROUNDING) + ROUNDING * length_mm, "no jump");
                let change = (point.accel_mm_s2 - before.accel_mm_s2).abs();
                prop_assert!(change <= jerk_mm_s3 * dt * (1.0 + ROUNDING) + ROUNDING * accel_mm_s2);
            }
            before = point;
        }
        let end = motion.at(duration_s);
        prop_assert!((end.distance_mm - length_mm).abs() <= ROUNDING * (1.0 + length_mm));
        prop_assert!(end.speed_mm_s.abs() <= ROUNDING * speed_mm_s);
    }

    #[test]
    fn no_drive_points_into_a_pressed_switch_and_none_flows_while_stopped(
        events in prop::collection::vec(
            (0..4_u8, -1.2..1.2_f32, -1.2..1.2_f32, any::<[bool; 4]>(), any::<bool>()),
            1..60,
        ),
    ) {
        let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        let mut limits = LimitSwitches::default();
        let (mut button, mut latched) = (false, false);
        for (kind, x, y, [x_min, x_max, y_min, y_max], pressed) in events {
            match kind {
                0 => {
                    limits = LimitSwitches { x_min, x_max, y_min, y_max };
                    gate.set_limits(limits);
                }
                1 => {
                    button = pressed;
                    latched |= pressed;
                    gate.emergency_stop(pressed);
                }
                2 => {
                    latched = button;
                    prop_assert_eq!(gate.reset(), !button);
                }
                _ => {}
            }
            let demand = Demand { x: Duty::saturating(x), y: Duty::saturating(y) };
            let drive = gate.pass(demand);
            for axis in Axis::BOTH {
                let duty = drive.axis(axis);
                if latched {
                    prop_assert_eq!(duty, Duty::ZERO);
                }
                if let Some(direction) = duty.direction() {
                    prop_assert!(!stands_in_the_way(limits, axis, direction));
                }
            }
            if !latched && limits == LimitSwitches::default() {
                prop_assert_eq!((drive.x(), drive.y()), (demand.x, demand.y));
            }
        }
    }

    #[test]
    fn a_target_survives_the_line(target in target()) {
        let mut receiver = Receiver::new(Duration::from_millis(100));
        let mut got = None;
        for byte in digits::encode(target).unwrap() {
            got = receiver.push(Duration::ZERO, byte).target;
        }
        prop_assert_eq!(got, Some(target));
    }

    #[test]
    fn after_any_garbage_and_a_silence_the_next_target_is_right(
        garbage in prop::collection::vec((0..50_u64, any::<u8>()), 0..60),
        target in target(),
    ) {
        let gap = Duration::from_millis(100);
        let mut receiver = Receiver::new(gap);
        let mut now = Duration::ZERO;
        for (pause_ms, byte) in garbage {
            now += Duration::from_millis(pause_ms);
            receiver.push(now, byte);
        }
        now += gap + Duration::from_micros(1);
        let mut got = None;
        for byte in digits::encode(target).unwrap() {
            got = receiver.push(now, byte).target;
            now += Duration::from_millis(10);
        }
        prop_assert_eq!(got, Some(target));
    }

    #[test]
    fn coordinates_without_digits_are_refused(x in any::<i32>(), y in any::<i32>()) {
        let good = |v| (0..=digits::GREATEST).contains(&v);
        prop_assert_eq!(digits::encode(StepPoint::new(x, y)).is_ok(), good(x) && good(y));
    }

    #[test]
    fn a_reply_is_the_byte_that_says_it(byte in any::<u8>()) {
        if let Some(reply) = Reply::from_byte(byte) {
            prop_assert_eq!(Reply::from_byte(reply.byte()), Some(reply));
        }
    }

    #[test]
    fn x4_counts_any_walk_of_the_shaft(steps in prop::collection::vec(direction(), 0..300)) {
        let (mut quarter, mut count) = (0_i64, 0_i64);
        let mut decoder = QuadratureX4::new(Phases::of_quarter(quarter));
        for step in steps {
            quarter += i64::from(step.sign());
            count += decoder.update(Phases::of_quarter(quarter)).map_or(0, |d| i64::from(d.sign()));
            prop_assert_eq!(count, quarter);
        }
        prop_assert_eq!(decoder.illegal(), 0);
    }

    #[test]
    fn x1_counts_whole_periods_of_a_shaft_that_does_not_tremble(periods in -50..50_i64) {
        let mut decoder = QuadratureX1::new(Phases::of_quarter(0));
        let mut count = 0;
        let step = periods.signum();
        for i in 1..=4 * periods.abs() {
            count += decoder.update(Phases::of_quarter(step * i)).map_or(0, |d| i64::from(d.sign()));
        }
        prop_assert_eq!(count, periods);
    }

    #[test]
    fn pid_output_stays_in_range_and_the_integral_does_not_wind_up(
        kp in 0.0..100.0_f32, ki in 0.0..1000.0_f32, kd in 0.0..1.0_f32, filter in 0.0..0.1_f32,
        inputs in prop::collection::vec((-1e3..1e3_f32, -1e3..1e3_f32, 0.0..0.1_f32), 1..200),
    ) {
        let pid = Pid { kp, ki, kd, derivative_filter_s: filter, output_min: -2.0, output_max: 3.0 };
        let mut state = PidState::default();
        for (setpoint, measured, dt_s) in inputs {
            let output = pid.update(&mut state, setpoint, measured, dt_s);
            prop_assert!((-2.0..=3.0).contains(&output));
            prop_assert!((-2.0..=3.0).contains(&state.integral()));
        }
    }

    #[test]
    fn steps_and_back_lose_less_than_half_a_step(mm in -1e5..1e5_f64, per_mm in 1.0..1000.0_f64) {
        /// Two roundings of numbers up to 1e8, in steps.
        const ROUNDING_STEPS: f64 = 5e-8;
        let steps = from_mm(mm, per_mm);
        prop_assert!((f64::from(steps) / per_mm - mm).abs() <= (0.5 + ROUNDING_STEPS) / per_mm);
    }

    /// Whatever edges come, however impossible, the estimate stays a number within the interval of its count.
    #[test]
    fn the_estimate_stays_between_the_edges_next_to_it(
        x4 in any::<bool>(),
        events in prop::collection::vec((1e-6..4e-4_f32, -12.0..12.0_f32, 0..4_u8, direction()), 1..300),
    ) {
        let mut config = AxisConfig::default();
        if x4 {
            config.encoder.decoding = Decoding::X4;
        }
        let mut estimator = ShaftEstimator::new(&config, 150.0);
        for (dt_s, volts, kind, direction) in events {
            estimator.predict(dt_s, volts);
            if kind == 0 {
                estimator.edge(direction);
            } else {
                estimator.no_edge();
                let distance = estimator.distance_from(estimator.count());
                prop_assert!((-0.76..=0.76).contains(&distance), "{distance}");
            }
            let model = estimator.model();
            prop_assert!(estimator.speed_counts_s().is_finite() && estimator.disturbance_counts_s2().is_finite());
            prop_assert!(model.accel_per_volt > 0.0 && model.damping_per_s > 0.0 && model.dry_friction >= 0.0);
        }
    }

    /// Any bytes, edges, switches and times: no panic, no drive into a switch or while stopped, and the host
    /// always learns the position.
    #[test]
    fn the_gantry_is_safe_under_any_input(
        published in any::<bool>(),
        events in prop::collection::vec((0..6_u8, 0..20_000_u64, any::<u8>(), axis(), direction()), 1..200),
    ) {
        let mut config = MachineConfig::default();
        if published {
            config.dc_mut().unwrap().control.controller = ControllerChoice::Published;
        }
        let mut gantry = Gantry::new(&Machine::new(config).unwrap(), SafetyGate::new(LimitSwitches::RELEASED, false));
        let mut now = Duration::ZERO;
        let mut told = StepPoint::default();
        let mut limits = LimitSwitches::default();
        let (mut button, mut latched) = (false, false);
        for (kind, wait_us, byte, axis, direction) in events {
            now += Duration::from_micros(wait_us);
            while let Some(due) = gantry.next_tick().filter(|&due| due <= now) {
                gantry.tick(due);
            }
            match kind {
                0 => gantry.receive(now, byte % 12),
                1 => gantry.receive(now, byte),
                2 => gantry.edge(now, axis, direction),
                3 => {
                    limits.set(axis, direction, byte > 99);
                    gantry.limit_switch(now, axis, direction, byte > 99);
                }
                4 => {
                    button = byte > 200;
                    latched |= button;
                    gantry.emergency_stop(now, button);
                }
                _ => {
                    latched = button;
                    gantry.reset_emergency_stop(now);
                }
            }
            while let Some(byte) = gantry.transmit() {
                if let Some(Reply::Pulse(axis, direction)) = Reply::from_byte(byte) {
                    match axis {
                        Axis::X => told.x += direction.sign(),
                        Axis::Y => told.y += direction.sign(),
                    }
                }
            }
            prop_assert_eq!(told, gantry.position());
            for axis in Axis::BOTH {
                let duty = gantry.drive().axis(axis);
                prop_assert!(!latched || duty == Duty::ZERO);
                prop_assert!(!duty.direction().is_some_and(|direction| stands_in_the_way(limits, axis, direction)));
            }
            while gantry.take_notice().is_some() {}
        }
    }
}
