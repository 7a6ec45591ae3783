//! Error messages, as people read them.

use core::time::Duration;
use plotter_motion::firmware::Notice;
use plotter_motion::protocol::HostNotice;
use plotter_motion::protocol::digits::{self, Dropped};
use plotter_motion::{Duty, MotionLimits, StepPoint, profile::SCurve};

#[test]
fn messages_name_place_value_and_remedy() {
    let at = StepPoint::new(2993, 100_000);
    let limits = MotionLimits { speed_mm_s: f64::NAN, accel_mm_s2: 1.0, jerk_mm_s3: 1.0 };
    let messages = [
        digits::encode(at).unwrap_err().to_string(),
        Duty::new(1.5).unwrap_err().to_string(),
        SCurve::plan(1.0, limits).unwrap_err().to_string(),
        Dropped::NotADigit { byte: b'x', digits: 4 }.to_string(),
        Dropped::Silence { silence: Duration::from_millis(5210), digits: 9 }.to_string(),
        Dropped::Early { digits: 3 }.to_string(),
        Notice::OutOfArea { target: at, most: StepPoint::new(23_760, 16_800) }.to_string(),
        HostNotice::ReachedElsewhere { target: at, position: StepPoint::new(2993, 9) }.to_string(),
        HostNotice::Silent { target: at }.to_string(),
        HostNotice::Unknown { byte: 0xff }.to_string(),
        HostNotice::GaveUp { target: at, position: StepPoint::new(1, 2) }.to_string(),
    ];
    insta::assert_snapshot!(messages.join("\n"));
}

#[test]
fn a_planned_motion_as_a_table() {
    let limits = MotionLimits { speed_mm_s: 150.0, accel_mm_s2: 3_000.0, jerk_mm_s3: 150_000.0 };
    let table = [0.5, 10.0, 60.0].map(|length_mm| {
        let motion = SCurve::plan(length_mm, limits).unwrap();
        let rows = (0..=8).map(|i| {
            let t = motion.duration_s() * f64::from(i) / 8.0;
            let p = motion.at(t);
            format!("{t:.4} s {:8.4} mm {:8.3} mm/s {:9.2} mm/s2", p.distance_mm, p.speed_mm_s, p.accel_mm_s2)
        });
        rows.collect::<Vec<_>>().join("\n")
    });
    insta::assert_snapshot!(table.join("\n\n"));
}
