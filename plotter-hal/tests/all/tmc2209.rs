//! The TMC2209's registers byte by byte, on a simulated chip at the end of a single wire: with noise, with a
//! chip that is silent or does not take what it is told, and as a limit switch.

use crate::faulty::Levels;
use embedded_hal::digital::PinState;
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write};
use plotter_hal::serial_line::Fault;
use plotter_hal::tmc2209::{
    Chopper, Error, Register, Replies, Settings, SettingsError, Tmc2209, crc, read_datagram, write_datagram,
};
use plotter_hal::{LimitSwitch, SwitchSettings};
use plotter_motion::{LimitSwitches, SafetyGate, StepPair, safety::Blocked};
use proptest::prelude::*;
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

/// What is wrong with a chip.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wrong {
    Nothing,
    Silent,
    /// It counts no write.
    Deaf,
    /// A bit of every reply is flipped.
    Noisy,
    /// The line is never quiet.
    Endless,
    PortFails,
    /// The port takes nothing.
    PortStuck,
}

/// A chip with address 1 on one wire: what is sent to it comes back, and then its reply.
#[derive(Debug)]
struct Chip {
    wrong: Wrong,
    registers: BTreeMap<u8, u32>,
    taken: u8,
    /// Writes in their order.
    log: Vec<(u8, u32)>,
    heard: Vec<u8>,
    wire: VecDeque<u8>,
}

impl Chip {
    fn new(wrong: Wrong) -> Self {
        // So that the count of writes wraps on the way.
        let taken = 253;
        Self {
            wrong,
            registers: BTreeMap::new(),
            taken,
            log: Vec::new(),
            heard: Vec::new(),
            wire: VecDeque::new(),
        }
    }

    fn listen(&mut self) {
        let length = if self.heard.get(2).is_some_and(|register| register & 0x80 != 0) { 8 } else { 4 };
        if self.heard.len() < length {
            return;
        }
        let datagram: Vec<u8> = self.heard.drain(..).collect();
        let (check, body) = datagram.split_last().unwrap();
        assert_eq!((crc(body), body[0], body[1]), (*check, 0x05, 1), "{datagram:02x?}");
        if length == 8 {
            if self.wrong != Wrong::Deaf {
                self.taken = self.taken.wrapping_add(1);
                let value = u32::from_be_bytes(body[3..].try_into().unwrap());
                self.registers.insert(body[2] & 0x7F, value);
                self.log.push((body[2] & 0x7F, value));
            }
            return;
        }
        let value = if body[2] == 0x02 {
            self.taken.into()
        } else {
            self.registers.get(&body[2]).copied().unwrap_or(0)
        };
        let [a, b, c, d] = value.to_be_bytes();
        let mut reply = vec![0x05, 0xFF, body[2], a, b, c, d];
        reply.push(crc(&reply));
        match self.wrong {
            Wrong::Silent => return,
            Wrong::Noisy => reply[6] ^= 1,
            _ => {}
        }
        self.wire.extend(reply);
    }
}

impl ErrorType for Chip {
    type Error = ErrorKind;
}

impl Write for Chip {
    /// Three bytes at a time, as a small buffer does.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        match self.wrong {
            Wrong::PortFails => return Err(ErrorKind::NotConnected),
            Wrong::PortStuck => return Ok(0),
            _ => {}
        }
        let taken = bytes.len().min(3);
        for byte in &bytes[..taken] {
            self.wire.push_back(*byte);
            self.heard.push(*byte);
        }
        self.listen();
        Ok(taken)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

impl ReadReady for Chip {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        Ok(!self.wire.is_empty() || self.wrong == Wrong::Endless)
    }
}

impl Read for Chip {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        bytes[0] = if self.wrong == Wrong::Endless { 0x55 } else { self.wire.pop_front().unwrap() };
        Ok(1)
    }
}

#[test]
fn datagrams_are_those_of_the_datasheet() {
    assert_eq!(read_datagram(0, Register::Gconf), [0x05, 0x00, 0x00, 0x48]);
    assert_eq!(read_datagram(3, Register::DrvStatus)[..3], [0x05, 0x03, 0x6F]);
    let write = write_datagram(2, Register::Chopconf, 0x1234_5678);
    assert_eq!(write[..7], [0x05, 0x02, 0xEC, 0x12, 0x34, 0x56, 0x78]);
    assert_eq!(crc(&write[..7]), write[7]);
    // Section 4.2: one byte after the other through x^8 + x^2 + x + 1, low bit first; 1 alone is x^7 times
    // it.
    assert_eq!(crc(&[0x80]), 0x07);
    assert_eq!(crc(&[]), 0);
}

#[test]
fn settings_become_registers_by_the_datasheets_tables() {
    // 500 mA on 110 mOhm: 32 * 1.414 * 500 * 0.13 / 180 = 16.3, so 15 of 31 in the finer range; 250 mA: 8.2,
    // so 7.
    assert_eq!(
        Settings::default().registers().unwrap(),
        [
            (Register::Gconf, 0x0000_01C0),
            (Register::IholdIrun, 0x0001_0F07),
            (Register::Sgthrs, 0),
            (Register::Tcoolthrs, 0),
            (Register::Chopconf, 0x1402_0053),
        ]
    );
    // 1500 mA: 27.1 of 32 in the coarser range, and 600 mA in the same one: 10.8.
    let strong = Settings::default()
        .with_run_ma(1500)
        .with_hold_ma(600)
        .with_microsteps(256)
        .with_interpolates(false)
        .with_chopper(Chopper::SpreadCycle)
        .with_stall_threshold(80)
        .with_stall_from_hz(12_000);
    assert_eq!(
        strong.registers().unwrap(),
        [
            (Register::Gconf, 0x0000_01C4),
            (Register::IholdIrun, 0x0001_1A09),
            (Register::Sgthrs, 80),
            (Register::Tcoolthrs, 1000), // 12 MHz by 12,000 steps/s of a 256th
            (Register::Chopconf, 0x0000_0053),
        ]
    );
}

#[test]
fn a_current_or_a_resolution_that_the_chip_does_not_have_is_refused() {
    // The datasheet's table for 110 mOhm ends at 1.77 A.
    assert!(Settings::default().with_run_ma(1767).registers().is_ok());
    let too_much = Settings::default().with_run_ma(1768);
    assert_eq!(too_much.registers(), Err(SettingsError::Current { current_ma: 1768, sense_mohm: 110 }));
    assert!(Settings::default().with_sense_mohm(0).registers().is_err());
    for microsteps in [0, 3, 15, 512, 65_535] {
        let settings = Settings::default().with_microsteps(microsteps);
        assert_eq!(settings.registers(), Err(SettingsError::Microsteps(microsteps)));
    }
    for (power, microsteps) in [1, 2, 4, 8, 16, 32, 64, 128, 256].into_iter().enumerate() {
        let [.., (_, chopconf)] = Settings::default().with_microsteps(microsteps).registers().unwrap();
        assert_eq!(usize::try_from(chopconf >> 24 & 0xF).unwrap(), 8 - power, "{microsteps}");
    }
    // A motor never holds with more than it steps with.
    let held = Settings::default().with_run_ma(300).with_hold_ma(900);
    let [_, (_, currents), ..] = held.registers().unwrap();
    assert_eq!(currents & 0x1F, currents >> 8 & 0x1F);
}

#[test]
fn a_chip_is_set_over_a_single_wire_and_has_taken_it() {
    let settings = Settings::default().with_stall_threshold(60);
    let mut chip = Tmc2209::new(Chip::new(Wrong::Nothing), 1);
    chip.configure(&settings, &mut NoopDelay).unwrap();
    assert_eq!(chip.read(Register::Sgthrs, &mut NoopDelay), Ok(60));
    let log = chip.release().log;
    assert_eq!(log, settings.registers().unwrap().map(|(register, value)| (register as u8, value)));
}

#[test]
fn whatever_is_wrong_with_a_chip_is_told_and_nothing_waits_for_ever() {
    let cases = [
        (Wrong::Silent, Error::Silent(Register::Ifcnt)),
        (Wrong::Deaf, Error::NotTaken(Register::Gconf)),
        (Wrong::Noisy, Error::Silent(Register::Ifcnt)),
        (Wrong::Endless, Error::Silent(Register::Ifcnt)),
        (Wrong::PortFails, Error::Port(Fault::Gone)),
        (Wrong::PortStuck, Error::Port(Fault::Other)),
    ];
    for (wrong, expected) in cases {
        let mut chip = Tmc2209::new(Chip::new(wrong), 1);
        let error = chip.configure(&Settings::default(), &mut NoopDelay).unwrap_err();
        assert_eq!(error, expected, "{wrong:?}");
        assert!(error.to_string().starts_with("tmc2209: "), "{error}");
    }
    let mut chip = Tmc2209::new(Chip::new(Wrong::Nothing), 1);
    let wrong = Settings::default().with_microsteps(5);
    assert_eq!(chip.configure(&wrong, &mut NoopDelay), Err(Error::Settings(SettingsError::Microsteps(5))));
    assert_eq!(chip.release().log, [], "nothing has been written");
}

#[test]
fn a_stall_is_the_switch_of_the_end_that_the_motor_goes_to() {
    let settings = SwitchSettings::default().with_pressed_at(PinState::High);
    let diag = Levels::new([false, false, true].map(Some));
    let mut stall = LimitSwitch::new(diag, settings);
    let mut gate =
        SafetyGate::new(LimitSwitches { x_min: stall.is_pressed(), ..LimitSwitches::RELEASED }, false);
    let towards = StepPair { x: -1, y: 0 };
    for (at_ms, passes) in [(0, false), (20, true), (21, false)] {
        let pressed = stall.tick(Duration::from_millis(at_ms)).unwrap();
        gate.set_limits(LimitSwitches { x_min: pressed, ..LimitSwitches::RELEASED });
        assert_eq!(gate.pass_step(towards).is_ok(), passes, "{at_ms} ms");
    }
    assert!(matches!(gate.pass_step(towards), Err(Blocked::Limit { .. })));
    assert!(gate.pass_step(StepPair { x: 1, y: 0 }).is_ok(), "away from it");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// A reply is found after any noise, and one with a damaged byte is none.
    #[test]
    fn a_reply_is_found_after_noise_and_never_when_it_is_damaged(
        noise in prop::collection::vec(any::<u8>(), 0..40),
        value in any::<u32>(),
        place in 0..8_usize,
        fault in 1..=u8::MAX,
    ) {
        let [a, b, c, d] = value.to_be_bytes();
        let body = [0x05, 0xFF, Register::SgResult as u8, a, b, c, d];
        let mut reply = body.to_vec();
        reply.push(crc(&body));
        let mut replies = Replies::new(Register::SgResult);
        let found: Vec<u32> = noise.iter().chain(&reply).filter_map(|&byte| replies.push(byte)).collect();
        prop_assert_eq!(found.last(), Some(&value));

        reply[place] ^= fault;
        let mut replies = Replies::new(Register::SgResult);
        prop_assert_eq!(reply.iter().find_map(|&byte| replies.push(byte)), None);
    }
}
