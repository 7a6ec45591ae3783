//! The serial line byte by byte: framing errors, overruns, a port that fails for good; and what the
//! controllers make of it.

use core::time::Duration;
use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write, WriteReady};
use plotter_hal::SerialLine;
use plotter_hal::serial_line::{Fault, FaultCounts};
use plotter_motion::firmware::stepper_plotter::{Dialect, Drivers, StepperPlotter, StepperPlotterSettings};
use plotter_motion::firmware::{Gantry, Notice};
use plotter_motion::protocol::digits::{self, Receiver};
use plotter_motion::{Drive, LimitSwitches, Machine, MachineConfig, SafetyGate, StepPoint};
use proptest::prelude::*;
use std::collections::VecDeque;

/// A port that has received what it will ever receive, and sends a few bytes at a time.
#[derive(Debug, Default)]
struct Port {
    incoming: VecDeque<Result<u8, ErrorKind>>,
    sent: Vec<u8>,
    /// What becomes of the next writes; then all is taken.
    writes: VecDeque<Outcome>,
}

#[derive(Clone, Copy, Debug)]
enum Outcome {
    Taken,
    NotReady,
    ReadyFails,
    Nothing,
    Fails,
}

impl Port {
    fn receiving(incoming: impl IntoIterator<Item = Result<u8, ErrorKind>>) -> Self {
        Self { incoming: incoming.into_iter().collect(), ..Self::default() }
    }
}

impl ErrorType for Port {
    type Error = ErrorKind;
}

impl ReadReady for Port {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        Ok(!self.incoming.is_empty())
    }
}

impl Read for Port {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        let byte = self.incoming.pop_front();
        assert!(byte.is_some(), "it would block");
        bytes[0] = byte.unwrap_or(Err(ErrorKind::Other))?;
        Ok(1)
    }
}

impl WriteReady for Port {
    fn write_ready(&mut self) -> Result<bool, ErrorKind> {
        match self.writes.front() {
            Some(Outcome::NotReady) => {
                self.writes.pop_front();
                Ok(false)
            }
            Some(Outcome::ReadyFails) => {
                self.writes.pop_front();
                Err(ErrorKind::NotConnected)
            }
            _ => Ok(true),
        }
    }
}

impl Write for Port {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        match self.writes.pop_front() {
            Some(Outcome::Nothing) => Ok(0),
            Some(Outcome::Fails) => Err(ErrorKind::Other),
            Some(Outcome::Taken | Outcome::NotReady | Outcome::ReadyFails) | None => {
                self.sent.extend(bytes);
                Ok(bytes.len())
            }
        }
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

/// The bytes of a target, of which some came with an error.
#[expect(clippy::expect_used, reason = "a test may panic")]
fn target(to: StepPoint, broken: impl Fn(usize) -> Option<ErrorKind>) -> Vec<Result<u8, ErrorKind>> {
    let bytes = digits::encode(to).expect("within five digits");
    bytes.into_iter().enumerate().map(|(place, byte)| broken(place).map_or(Ok(byte), Err)).collect()
}

/// Runs the gantry up to `end`; it sees no edges, so its motors stand; `end` is before it tells that they are
/// held.
fn run(gantry: &mut Gantry, end: Duration) {
    while let Some(now) = gantry.next_tick().filter(|&at| at <= end) {
        gantry.tick(now);
    }
}

#[test]
fn a_target_with_a_broken_byte_is_not_drawn_and_the_host_can_send_it_again() {
    let to = StepPoint::new(2993, 1395);
    for kind in [ErrorKind::InvalidData, ErrorKind::OutOfMemory, ErrorKind::Other] {
        for broken in 0..digits::TARGET_BYTES {
            let mut gantry = Gantry::new(
                &Machine::new(MachineConfig::default()).unwrap(),
                SafetyGate::new(LimitSwitches::RELEASED, false),
            );
            let mut line =
                SerialLine::new(Port::receiving(target(to, |place| (place == broken).then_some(kind))));
            let mut faults = 0;
            while let Some(received) = line.receive() {
                faults += u32::from(received.fault.is_some());
                gantry.receive(Duration::ZERO, received.byte);
            }
            assert_eq!(faults, 1);
            let notice = gantry.take_notice().map(|notice| notice.to_string()).unwrap_or_default();
            assert_eq!(
                notice,
                format!("byte 0x1a is not a digit (0 to 9): dropped it and {broken} digits before it")
            );
            run(&mut gantry, Duration::from_millis(300));
            assert_eq!(gantry.drive(), Drive::default(), "{broken}: nothing is drawn");

            // No answer came, so the host sends it again.
            let mut line = SerialLine::new(Port::receiving(target(to, |_| None)));
            while let Some(received) = line.receive() {
                gantry.receive(Duration::from_millis(300), received.byte);
            }
            let notices = core::iter::from_fn(|| gantry.take_notice()).count();
            assert_eq!(notices, usize::from(broken < 9), "the rest of the first one is dropped too");
            run(&mut gantry, Duration::from_millis(310));
            assert!(gantry.drive().x().value() > 0.0 && gantry.drive().y().value() > 0.0);
        }
    }
}

#[test]
fn a_line_of_g_code_with_a_broken_byte_is_refused_and_the_next_one_is_drawn() {
    let text = b"G1 X12 Y3 F600\n";
    for dialect in [Dialect::Grbl, Dialect::MDraw] {
        for broken in 0..text.len() {
            let settings = StepperPlotterSettings { dialect, ..StepperPlotterSettings::default() };
            let mut plotter =
                StepperPlotter::new(settings, SafetyGate::new(LimitSwitches::RELEASED, false)).unwrap();
            let incoming = text.iter().enumerate();
            let incoming =
                incoming.map(|(at, &byte)| if at == broken { Err(ErrorKind::InvalidData) } else { Ok(byte) });
            // Where the end of the line was broken the host waits for its answer, and a person presses
            // return.
            let incoming = incoming.chain(b"\nG1 X1 F600\n".iter().map(|&byte| Ok(byte)));
            let mut line = SerialLine::new(Port::receiving(incoming));
            let mut now = Duration::ZERO;
            loop {
                while let Some(received) = line.receive() {
                    plotter.receive(now, received.byte);
                    // mDraw waits for each answer.
                    if dialect == Dialect::MDraw && received.byte == b'\n' {
                        break;
                    }
                }
                while plotter.poll(now, Drivers::Ready).is_some() {}
                line.send(|| plotter.transmit(now)).unwrap();
                match plotter.due() {
                    Some(due) => now = due,
                    None if line.faults().broken > 0 && plotter.position() != StepPoint::default() => break,
                    None => now += Duration::from_millis(1),
                }
                assert!(now < Duration::from_secs(20), "{dialect:?}, {broken}");
            }
            let expected = StepPoint::new(88, 0); // 1 mm of 87.58 steps, and nothing before
            assert_eq!(plotter.position(), expected, "{dialect:?}, byte {broken}");
            let answers = String::from_utf8(line.release().sent).unwrap();
            assert_eq!(answers.matches("error:").count(), 1, "{dialect:?}, byte {broken}: {answers}");
        }
    }
}

#[test]
fn kinds_of_faults_are_told_apart_as_far_as_a_port_says() {
    let kinds = [
        (ErrorKind::InvalidData, Fault::Broken),
        (ErrorKind::OutOfMemory, Fault::Overrun),
        (ErrorKind::BrokenPipe, Fault::Gone),
        (ErrorKind::NotConnected, Fault::Gone),
        (ErrorKind::Other, Fault::Other),
        (ErrorKind::TimedOut, Fault::Other),
    ];
    let mut line = SerialLine::new(Port::receiving(kinds.map(|(kind, _)| Err(kind))));
    for (_, fault) in kinds {
        let received = line.receive().unwrap();
        assert_eq!((received.byte, received.fault), (0x1A, Some(fault)));
    }
    assert_eq!(line.receive(), None);
    assert_eq!(line.faults(), FaultCounts { broken: 1, overrun: 1, gone: 2, other: 2 });
}

#[test]
fn a_port_that_fails_for_ever_does_not_keep_its_reader() {
    let mut line = SerialLine::new(Port::receiving([Err(ErrorKind::Other); 100]));
    let at_once = core::iter::from_fn(|| line.receive()).count();
    assert_eq!(at_once, 8);
    assert_eq!(core::iter::from_fn(|| line.receive()).count(), 8, "and it goes on the next time");
}

#[test]
fn whatever_happens_to_a_write_no_answer_is_lost_or_doubled() {
    let cases = [Outcome::NotReady, Outcome::ReadyFails, Outcome::Nothing, Outcome::Fails];
    for case in cases {
        for place in 0..4 {
            let writes = [Outcome::Taken].repeat(place).into_iter().chain([case]).collect();
            let mut line = SerialLine::new(Port { writes, ..Port::default() });
            let mut answers = b"123+".iter().copied();
            let result = line.send(|| answers.next());
            assert_eq!(result.is_err(), matches!(case, Outcome::ReadyFails | Outcome::Fails), "{case:?}");
            line.send(|| answers.next()).unwrap();
            assert_eq!(line.release().sent, b"123+", "{case:?} at {place}");
        }
    }
}

#[test]
fn a_notice_of_the_gantry_is_one_of_a_dropped_target() {
    let mut gantry = Gantry::new(
        &Machine::new(MachineConfig::default()).unwrap(),
        SafetyGate::new(LimitSwitches::RELEASED, false),
    );
    let mut line = SerialLine::new(Port::receiving([Ok(1), Err(ErrorKind::InvalidData)]));
    while let Some(received) = line.receive() {
        gantry.receive(Duration::ZERO, received.byte);
    }
    let dropped = digits::Dropped::NotADigit { byte: 0x1A, digits: 1 };
    assert_eq!(gantry.take_notice(), Some(Notice::Dropped(dropped)));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Bytes come broken or are lost in an overrun; the host sends each target again until it is taken.
    /// Nothing is ever taken that it has not sent.
    #[test]
    fn only_targets_that_were_sent_are_taken(
        targets in prop::collection::vec((0..100_000_i32, 0..100_000_i32), 1..5),
        noise in prop::collection::vec(prop::option::weighted(0.1, prop_oneof![
            Just((ErrorKind::InvalidData, 1_usize)),
            (1..4_usize).prop_map(|lost| (ErrorKind::OutOfMemory, lost)),
        ]), 200),
    ) {
        let mut receiver = Receiver::new(Duration::from_millis(100));
        let (mut noise, mut now) = (noise.into_iter(), Duration::ZERO);
        for (x, y) in targets {
            let to = StepPoint::new(x, y);
            let mut taken = None;
            while taken.is_none() {
                let mut incoming = Vec::new();
                let mut bytes = digits::encode(to).unwrap().into_iter();
                while let Some(byte) = bytes.next() {
                    match noise.next().flatten() {
                        None => incoming.push(Ok(byte)),
                        Some((kind, lost)) => {
                            incoming.push(Err(kind));
                            bytes.by_ref().take(lost - 1).for_each(drop);
                        }
                    }
                }
                let mut line = SerialLine::new(Port::receiving(incoming));
                now += Duration::from_secs(1);
                while let Some(received) = line.receive() {
                    let got = receiver.push(now, received.byte).target;
                    prop_assert!(got.is_none() || got == Some(to), "{got:?} for {to:?}");
                    taken = taken.or(got);
                }
            }
        }
    }
}
