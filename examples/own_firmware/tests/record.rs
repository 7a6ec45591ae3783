//! How the golden log was made: the firmware and two motors of a line each, simulated. Who has a machine
//! records its line instead (`plotter-replay record`), and puts that beside the tests.
//!
//! ```text
//! cargo test --test record -- --ignored
//! ```

use own_firmware::OwnFirmware;
use plotter_motion::protocol::{Wire, digits};
use plotter_motion::{Axis, Direction, StepPoint};
use plotter_replay::log::{self, Event, Header, Record};
use std::path::Path;
use std::time::Duration;

/// A motor that turns by a count each 400 us with full duty, slower with less.
struct Motor {
    travelled: f64,
}

const STEP: Duration = Duration::from_micros(100);

#[test]
#[ignore = "writes the golden log anew, from the motors on: cargo test --test record -- --ignored"]
fn record_a_square() {
    let mut firmware = OwnFirmware::default();
    let mut motors = [Motor { travelled: 0.0 }, Motor { travelled: 0.0 }];
    let mut wire = Wire::new(256_000);
    let mut records: Vec<Record> = Vec::new();
    let mut answers: Vec<(Duration, u8)> = Vec::new();
    let mut duties = [0; 2];
    let mut now = Duration::ZERO;
    for (x, y) in [(40, 0), (40, 40), (0, 40), (0, 0)] {
        for byte in digits::encode(StepPoint::new(x, y)).unwrap() {
            now += STEP;
            records.push(Record { time: now, event: Event::Host(vec![byte]) });
            firmware.receive(now, byte);
        }
        loop {
            while let Some(byte) = firmware.transmit() {
                answers.push((wire.send(now), byte));
            }
            for (axis, duty) in Axis::BOTH.into_iter().zip(&mut duties) {
                if firmware.duty(axis) != *duty {
                    *duty = firmware.duty(axis);
                    records.push(Record { time: now, event: Event::Drive { axis, duty: *duty } });
                }
            }
            if answers.last().is_some_and(|&(at, byte)| byte == b'+' && at <= now) {
                break;
            }
            now += STEP;
            for (axis, motor) in Axis::BOTH.into_iter().zip(&mut motors) {
                motor.travelled += f64::from(firmware.duty(axis)) / 255.0 / 4.0;
                if motor.travelled.abs() >= 1.0 {
                    let sign = if motor.travelled > 0.0 { Direction::Plus } else { Direction::Minus };
                    motor.travelled -= f64::from(sign.sign());
                    records.push(Record { time: now, event: Event::Edge { axis, sign } });
                    firmware.edge(axis, sign);
                }
            }
        }
        records.extend(
            answers.drain(..).map(|(time, byte)| Record { time, event: Event::Controller(vec![byte]) }),
        );
    }
    records.sort_by_key(|record| record.time);
    let header = Header::new()
        .with_number("baud", 256_000)
        .with_text("protocol", "digits")
        .with_text("machine", "own-firmware");
    let mut writer = log::create(Path::new("tests/golden/square.plog"), &header).unwrap();
    records.iter().for_each(|record| writer.write(record).unwrap());
    writer.finish().unwrap();
}
