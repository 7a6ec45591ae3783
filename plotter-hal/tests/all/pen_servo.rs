//! The pen duty by duty, with faults put in at every access.

use crate::faulty;

use core::time::Duration;
use embedded_hal::pwm::SetDutyCycle;
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::delay::{CheckedDelay, Transaction as Wait};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
use faulty::{Broken, Output};
use plotter_hal::pen_servo::{Error, Refused, SettingsError};
use plotter_hal::{PenServo, PenServoSettings, ServoPoint};
use proptest::prelude::*;
use std::fmt::Write;
use std::io::ErrorKind;

/// Steps of the PWM in these tests: 1 us each.
const FULL: u16 = 20_000;
/// Duties of the default settings: 1000 + 160/180 · 1000 and 1000 + 90/180 · 1000 us.
const UP: u16 = 1889;
const DOWN: u16 = 1500;

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

fn gentle() -> PenServoSettings {
    PenServoSettings::default().with_lowering_deg_s(500.0)
}

#[expect(clippy::unwrap_used, reason = "a test may panic")]
fn pen(output: &Output, settings: PenServoSettings) -> PenServo<faulty::Pwm<'_>> {
    PenServo::new(output.pwm(FULL), settings).unwrap()
}

#[test]
fn switched_on_it_goes_up_before_anything_else() {
    let output = Output::default();
    let mut pen = pen(&output, PenServoSettings::default());
    assert_eq!((pen.is_settled(), pen.due()), (false, Some(ms(0))));
    pen.lower(ms(0)).unwrap();
    pen.tick(ms(0)).unwrap();
    assert_eq!(output.duties(), [UP, DOWN]);
}

#[test]
fn it_is_raised_at_once_lowered_slowly_and_settles_after_the_last_pulse() {
    let output = Output::default();
    let mut pen = pen(&output, gentle());
    let mut text = String::new();
    let mut now = ms(0);
    pen.tick(now).unwrap();
    for (from_ms, down) in [(300, true), (900, false)] {
        while let Some(due) = pen.due() {
            now = due;
            pen.tick(now).unwrap();
        }
        writeln!(text, "{:>4} ms  {:>5.1} deg  {} settled", now.as_millis(), pen.deg(), output.duty())
            .unwrap();
        now = ms(from_ms);
        if down {
            pen.lower(now).unwrap()
        } else {
            pen.raise(now).unwrap()
        };
        while !pen.is_settled() {
            writeln!(text, "{:>4} ms  {:>5.1} deg  {}", now.as_millis(), pen.deg(), output.duty()).unwrap();
            now = pen.due().unwrap();
            pen.tick(now).unwrap();
        }
    }
    // 70 degrees at 10 a frame; the motors wait from 440 to 640 ms and from 900 to 1100 ms.
    insta::assert_snapshot!(text, @r"
     200 ms  160.0 deg  1889 settled
     300 ms  160.0 deg  1889
     320 ms  150.0 deg  1833
     340 ms  140.0 deg  1778
     360 ms  130.0 deg  1722
     380 ms  120.0 deg  1667
     400 ms  110.0 deg  1611
     420 ms  100.0 deg  1556
     440 ms   90.0 deg  1500
     640 ms   90.0 deg  1500 settled
     900 ms  160.0 deg  1889
    ");
    assert_eq!(now, ms(1100));
    assert_eq!(pen.lowering_time(), ms(640 - 300));
}

#[test]
fn a_late_tick_lowers_it_later_and_no_faster() {
    let output = Output::default();
    let mut pen = pen(&output, gentle());
    pen.tick(ms(0)).unwrap();
    pen.lower(ms(300)).unwrap();
    pen.tick(ms(5000)).unwrap();
    assert_eq!(pen.deg(), 140.0); // two frames at 10 degrees, not 70
}

#[test]
fn a_new_order_on_the_way_turns_it_round_at_once() {
    let output = Output::default();
    let mut pen = pen(&output, gentle());
    pen.tick(ms(0)).unwrap();
    pen.lower(ms(300)).unwrap();
    pen.tick(ms(320)).unwrap();
    assert_eq!(pen.deg(), 150.0);
    pen.raise(ms(330)).unwrap();
    assert_eq!((pen.deg(), output.duty()), (160.0, UP));
    pen.tick(ms(530)).unwrap();
    assert!(pen.is_settled());
}

#[test]
fn angles_beyond_the_calibration_are_not_reached() {
    let output = Output::default();
    let mut pen = pen(&output, PenServoSettings::default());
    for (deg, duty) in [(270.0, 2000), (-1.0, 1000), (f32::INFINITY, 2000), (f32::NAN, UP)] {
        pen.turn_to(ms(0), deg).unwrap();
        pen.tick(ms(1)).unwrap();
        assert_eq!(output.duty(), duty, "{deg}");
    }
}

#[test]
fn the_waiting_form_needs_a_delay_and_no_clock() {
    let pwm = Pwm::new(&[
        SetDuty::max_duty_cycle(FULL),
        SetDuty::max_duty_cycle(FULL),
        SetDuty::set_duty_cycle(UP),
        SetDuty::max_duty_cycle(FULL),
        SetDuty::set_duty_cycle(1689), // 124 degrees
        SetDuty::max_duty_cycle(FULL),
        SetDuty::set_duty_cycle(DOWN),
    ]);
    let settings = PenServoSettings::default().with_lowering_deg_s(1800.0);
    let mut pen = PenServo::new(pwm, settings).unwrap();
    let mut delay = CheckedDelay::new(&[
        Wait::delay_us(200_000),
        Wait::delay_us(20_000),
        Wait::delay_us(20_000),
        Wait::delay_us(200_000),
    ]);
    pen.finish(Duration::ZERO, &mut delay).unwrap();
    pen.lower(Duration::ZERO).unwrap();
    assert_eq!(pen.finish(Duration::ZERO, &mut delay), Ok(ms(240)));
    assert!(pen.is_settled());
    delay.done();
    pen.release().done();
}

#[test]
fn the_resolution_is_that_of_the_pwm() {
    let output = Output::default();
    let fine = PenServo::new(output.pwm(FULL), PenServoSettings::default()).unwrap();
    assert!((fine.resolution_deg() - 0.18).abs() < 1e-6); // 1 us of 1000 us for 180 degrees
    let coarse = PenServo::new(output.pwm(255), PenServoSettings::default()).unwrap();
    assert!((coarse.resolution_deg() - 14.118).abs() < 1e-3); // 78.4 us
}

#[test]
fn settings_that_cannot_be_are_refused_with_what_would_be_right() {
    let good = PenServoSettings::default();
    let point = |deg, pulse_us| ServoPoint { deg, pulse_us };
    let cases = [
        (good.with_calibration([point(0.0, 100.0), point(180.0, 2000.0)]), FULL),
        (good.with_calibration([point(0.0, f32::NAN), point(180.0, 2000.0)]), FULL),
        (good.with_calibration([point(90.0, 1000.0), point(95.0, 2000.0)]), FULL),
        (good.with_calibration([point(0.0, 1500.0), point(180.0, 1500.0)]), FULL),
        (good.with_frame_us(0), FULL),
        (good.with_up_deg(200.0), FULL),
        (good.with_down_deg(f32::NAN), FULL),
        (good.with_lowering_deg_s(0.0), FULL),
        (good.with_lowering_deg_s(f32::NAN), FULL),
        (good.with_up_deg(91.0), 1000),
        (good, 0),
    ];
    let mut text = String::new();
    for (settings, full) in cases {
        let output = Output::default();
        let Refused { why: refused, pwm } = PenServo::new(output.pwm(full), settings).unwrap_err();
        writeln!(text, "{refused}").unwrap();
        assert_eq!(pwm.max_duty_cycle(), full); // it came back
        assert_eq!(output.accesses(), 0);
    }
    insta::assert_snapshot!(text, @r"
    pen servo: a pulse of 100 us lies outside 400..=2600 us; common servos take 1000 to 2000
    pen servo: a pulse of NaN us lies outside 400..=2600 us; common servos take 1000 to 2000
    pen servo: the calibrated points lie 5 deg and 1000 us apart; 10 to 360 deg and pulses that differ make a line, such as 0 deg at 1000 us and 180 deg at 2000 us
    pen servo: the calibrated points lie 180 deg and 0 us apart; 10 to 360 deg and pulses that differ make a line, such as 0 deg at 1000 us and 180 deg at 2000 us
    pen servo: a frame of 0 us lies outside 3333..=40000 us; 20000 us (50 Hz) suits every servo
    pen servo: 200 deg lies outside the calibrated 0..=180 deg: choose an angle within, or calibrate farther out
    pen servo: NaN deg lies outside the calibrated 0..=180 deg: choose an angle within, or calibrate farther out
    pen servo: a lowering speed of 0 deg/s; 1 or more, 50 to 500 is gentle, infinity is at once
    pen servo: a lowering speed of NaN deg/s; 1 or more, 50 to 500 is gentle, infinity is at once
    pen servo: with 1000 steps of the pwm in a frame, pen up and pen down are 0 steps apart; at least 4 are needed: give the timer more steps, or choose angles farther apart
    pen servo: with 0 steps of the pwm in a frame, pen up and pen down are 0 steps apart; at least 4 are needed: give the timer more steps, or choose angles farther apart
    ");
    assert!(matches!(
        PenServo::new(Output::default().pwm(40), good).map(|_| ()).unwrap_err().why,
        SettingsError::Coarse { pwm_steps: 40, pen_steps: 1 }
    ));
}

#[test]
fn whichever_access_fails_it_is_told_and_tried_again() {
    // Up, and down in seven steps: eight accesses.
    for failing in 0..8 {
        let output = Output::failing_at([failing]);
        let mut pen = pen(&output, gentle());
        let (mut now, mut errors) = (ms(0), 0);
        for order in 0..2 {
            let begun = if order == 0 { pen.tick(now) } else { pen.lower(now) };
            errors += u32::from(begun == Err(Error::Pwm(Broken)));
            while let Some(due) = pen.due() {
                now = now.max(due);
                if pen.tick(now) == Err(Error::Pwm(Broken)) {
                    assert!(!pen.is_settled(), "nobody knows where it is");
                    errors += 1;
                }
            }
        }
        assert_eq!((errors, output.duty(), pen.is_settled()), (1, DOWN, true), "access {failing}");
    }
}

#[test]
fn a_failing_pin_is_named_by_its_own_error() {
    let fault = MockError::Io(ErrorKind::NotConnected);
    let pwm = Pwm::new(&[
        SetDuty::max_duty_cycle(FULL),
        SetDuty::max_duty_cycle(FULL),
        SetDuty::set_duty_cycle(UP).with_error(fault.clone()),
        SetDuty::max_duty_cycle(FULL),
        SetDuty::set_duty_cycle(UP),
    ]);
    let mut pen = PenServo::new(pwm, PenServoSettings::default()).unwrap();
    let error = pen.raise(ms(0)).unwrap_err();
    assert_eq!(error, Error::Pwm(fault));
    assert!(error.to_string().starts_with("pwm of the pen servo: "), "{error}");
    pen.raise(ms(1)).unwrap(); // the same order again
    pen.release().done();
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is ordered and however late the ticks come: it never goes down faster than it may, and it
    /// settles where it was ordered to.
    #[test]
    fn it_never_goes_down_too_fast_and_always_arrives(
        orders in prop::collection::vec((0..400_u64, 0.0..180.0_f32), 1..20),
        lowering_deg_s in 20.0..2000.0_f32,
        failing in prop::collection::vec(0..40_usize, 0..4),
    ) {
        let output = Output::failing_at(failing);
        let settings = PenServoSettings::default().with_lowering_deg_s(lowering_deg_s);
        let mut pen = pen(&output, settings);
        let mut now = ms(0);
        for (pause_ms, deg) in &orders {
            now += ms(*pause_ms);
            let before = pen.deg();
            let _ = pen.turn_to(now, *deg);
            // Down is to smaller angles; two frames are the most that one call makes up for.
            prop_assert!(before - pen.deg() <= lowering_deg_s * 0.04 + 1e-3);
        }
        while let Some(due) = pen.due() {
            now = now.max(due);
            let _ = pen.tick(now);
        }
        let (_, last) = orders[orders.len() - 1];
        prop_assert_eq!(pen.deg(), last);
        prop_assert!((f32::from(output.duty()) - (1000.0 + last / 180.0 * 1000.0)).abs() <= 0.501);
    }
}
