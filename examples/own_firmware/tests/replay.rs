//! The firmware answers as it did when the recordings were made.
//!
//! ```text
//! cargo test                    does it?
//! UPDATE_GOLDEN=1 cargo test    it is meant to be different: take over what it does now, and look at `git diff`
//! ```

use own_firmware::OwnFirmware;
use plotter_motion::{Axis, Direction};
use plotter_replay::{Controller, golden};
use std::time::Duration;

/// The firmware as the player knows it: all that has to be written.
#[derive(Default)]
struct Player(OwnFirmware);

impl Controller for Player {
    fn receive(&mut self, now: Duration, byte: u8) {
        self.0.receive(now, byte);
    }
    fn edge(&mut self, _: Duration, axis: Axis, sign: Direction) {
        self.0.edge(axis, sign);
    }
    fn transmit(&mut self) -> Option<u8> {
        self.0.transmit()
    }
    fn duty(&self, axis: Axis) -> i32 {
        self.0.duty(axis)
    }
    // It has neither switches nor a control loop with a period.
}

#[test]
fn the_square_is_driven_as_recorded() {
    golden::assert_replays("tests/golden/square.plog", Player::default);
}

/// A firmware that slows down too late: the recording shows it, at the first edge where the duty is another.
#[test]
fn a_change_of_the_firmware_is_found() {
    struct Late(Player);
    impl Controller for Late {
        fn receive(&mut self, now: Duration, byte: u8) {
            self.0.receive(now, byte);
        }
        fn edge(&mut self, now: Duration, axis: Axis, sign: Direction) {
            self.0.edge(now, axis, sign);
        }
        fn transmit(&mut self) -> Option<u8> {
            self.0.transmit()
        }
        fn duty(&self, axis: Axis) -> i32 {
            match self.0.duty(axis) {
                60 => 255,
                duty => duty,
            }
        }
    }
    let directory = std::env::temp_dir().join(format!("own-firmware-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let copy = directory.join("square.plog");
    std::fs::copy("tests/golden/square.plog", &copy).unwrap();
    let error = golden::check(&copy, || Late(Player::default()), golden::Mode::Compare).unwrap_err();
    assert!(error.to_string().contains("recorded: duty 60 on motor x"), "{error}");
    let written = std::fs::read_to_string(directory.join("square.plog.diff")).unwrap();
    assert!(written.contains("    pulse x+") && written.contains("duty cycles: "), "{written}");
    std::fs::remove_dir_all(&directory).unwrap();
}
