//! Laws of the reliable link.

#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    reason = "a test may panic, and its numbers are small"
)]

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::firmware::{Gantry, LinkedGantry};
use plotter_motion::protocol::frame::{DecodeError, Decoder, Frame, Kind};
use plotter_motion::protocol::{Hello, Link, LinkSettings, LinkState, Message, MessageDecoder, Order};
use plotter_motion::{LimitSwitches, Machine, MachineConfig, Pen, SafetyGate, StepPoint};
use proptest::collection::vec;
use proptest::prelude::*;

fn kinds() -> impl Strategy<Value = Kind> {
    prop_oneof![Just(Kind::Hello), Just(Kind::Data), Just(Kind::Acknowledge), Just(Kind::Order)]
}

fn messages() -> impl Strategy<Value = Message> {
    let point = (any::<i32>(), any::<i32>()).prop_map(|(x, y)| StepPoint::new(x, y));
    prop_oneof![
        (any::<bool>(), point.clone())
            .prop_map(|(down, by)| { Message::Target { pen: if down { Pen::Down } else { Pen::Up }, by } }),
        (any::<u32>(), any::<u32>(), any::<u32>(), point.clone())
            .prop_map(|(boot, taken, reached, position)| Message::Status { boot, taken, reached, position }),
        point.prop_map(Message::Moved),
        any::<u32>().prop_map(Message::Reached),
        any::<u32>().prop_map(Message::Refused),
        (any::<u32>(), prop_oneof![Just(Order::GoOn), Just(Order::Hold), Just(Order::Stop)])
            .prop_map(|(order, state)| Message::Stands { order, state }),
    ]
}

/// What happens to a byte.
#[derive(Clone, Copy, Debug)]
enum Fault {
    Lost,
    Is(u8),
    After(u8),
}

fn faults() -> impl Strategy<Value = Fault> {
    prop_oneof![Just(Fault::Lost), any::<u8>().prop_map(Fault::Is), any::<u8>().prop_map(Fault::After)]
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn a_frame_comes_back_whatever_was_before_it(
        kind in kinds(), sequence: u8, acknowledged: u8, limit: u8, session: u16,
        payload in vec(any::<u8>(), 0..=240), noise in vec(any::<u8>(), 0..300),
    ) {
        let frame = Frame { kind, sequence, acknowledged, limit, payload: &payload };
        let session = if kind == Kind::Hello { 0 } else { session };
        let (bytes, length) = frame.encode(session).unwrap();
        let bytes = &bytes[..length];
        prop_assert!(length <= payload.len() + 9 && bytes.iter().position(|&byte| byte == 0) == Some(length - 1));
        let mut decoder = Decoder::new();
        for &byte in noise.iter().chain(&[0]) {
            let _ = decoder.push(byte, session);
        }
        let (last, before) = bytes.split_last().unwrap();
        for &byte in before {
            prop_assert_eq!(decoder.push(byte, session), None);
        }
        prop_assert_eq!(decoder.push(*last, session), Some(Ok(frame)));
    }

    #[test]
    fn a_burst_of_up_to_sixteen_bits_is_found(
        payload in vec(any::<u8>(), 0..=240), place in any::<prop::sample::Index>(), burst in 1_u16..,
    ) {
        let frame = Frame { kind: Kind::Data, sequence: 1, acknowledged: 2, limit: 3, payload: &payload };
        let (mut bytes, length) = frame.encode(5).unwrap();
        let at = place.index(length - 2); // the zero at the end stays
        let [low, high] = burst.to_le_bytes();
        bytes[at] ^= low;
        bytes[at + 1] ^= if at + 1 < length - 1 { high } else { 0 };
        prop_assume!(bytes[at] != 0 && bytes[at + 1] != 0 || at + 1 == length - 1);
        let mut decoder = Decoder::new();
        let mut came = bytes[..length].iter().filter_map(|&byte| decoder.push(byte, 5).map(|frame| frame.is_ok()));
        prop_assert!(!came.any(|is_ok| is_ok) || (low == 0 && (high == 0 || at + 1 == length - 1)));
    }

    #[test]
    fn a_frame_of_another_session_is_none(payload in vec(any::<u8>(), 0..=240), session: u16, other: u16) {
        prop_assume!(session != other);
        let frame = Frame { kind: Kind::Data, sequence: 1, acknowledged: 2, limit: 3, payload: &payload };
        let (bytes, length) = frame.encode(session).unwrap();
        let mut decoder = Decoder::new();
        let mut last = None;
        for &byte in &bytes[..length] {
            last = decoder.push(byte, other).map(|frame| frame.map(|_| ()));
        }
        prop_assert_eq!(last, Some(Err(DecodeError::Check)));
    }

    #[test]
    fn messages_come_back(sent in vec(messages(), 0..20)) {
        let mut decoder = MessageDecoder::default();
        let mut came = Vec::new();
        for message in &sent {
            let (bytes, length) = message.encode();
            came.extend(bytes[..length].iter().filter_map(|&byte| decoder.push(byte)).map(Result::unwrap));
        }
        prop_assert_eq!(came, sent);
    }

    #[test]
    fn a_hello_comes_back(version in 1_u8.., window in 1_u8.., payload in 1_u8.., session: u16, capabilities: u32) {
        let hello = Hello { version, window, payload, session, capabilities };
        prop_assert_eq!(Hello::from_bytes(&hello.to_bytes()), Some(hello));
    }

    /// Neither end can be made to panic, to speak for ever, or to read what nobody wrote.
    #[test]
    fn any_bytes_are_borne(bytes in vec(any::<u8>(), 0..2000), host: bool) {
        let settings = LinkSettings::default();
        let mut link = if host { Link::<4, 32>::host(9, settings) } else { Link::<4, 32>::machine(settings) };
        let mut decoder = MessageDecoder::default();
        for (n, &byte) in bytes.iter().enumerate() {
            let now = Duration::from_millis(n as u64);
            link.receive(now, byte);
            let _ = decoder.push(byte);
            link.write(&[byte; 3]);
            let spoken = std::iter::from_fn(|| link.transmit(now)).take(2000).count();
            prop_assert!(spoken < 2000);
            let _ = link.next_wake();
        }
        prop_assert_eq!(link.read(&mut [0; 64]), 0);
    }

    /// Whatever is lost, changed or invented: what is read is what was written, in order and once.
    #[test]
    fn a_stream_stays_a_stream(faults in vec((faults(), 15_usize..80), 30..60), length in 1_usize..600) {
        let settings = LinkSettings { most_calls: 200, ..LinkSettings::default() };
        let mut host = Link::<4, 32>::host(9, settings);
        let mut machine = Link::<2, 48>::machine(settings);
        let sent: Vec<u8> = (0..length).map(|n| (n * 7) as u8).collect();
        let (mut written, mut came, mut now) = (0, Vec::new(), Duration::ZERO);
        // a fault, and so many bytes without one
        let faults = faults.iter().flat_map(|&(fault, clean)| std::iter::once(Some(fault)).chain(vec![None; clean]));
        let mut fault = faults.cycle();
        for _ in 0..400_000 {
            written += host.write(&sent[written..]);
            let mut deliver = |to: &mut Link<2, 48>, byte: u8, now| match fault.next().flatten() {
                Some(Fault::Lost) => {}
                Some(Fault::Is(other)) => to.receive(now, other),
                Some(Fault::After(other)) => {
                    to.receive(now, other);
                    to.receive(now, byte);
                }
                None => to.receive(now, byte),
            };
            if let Some(byte) = host.transmit(now) {
                deliver(&mut machine, byte, now);
            }
            if let Some(byte) = machine.transmit(now) {
                host.receive(now, byte);
            }
            let mut read = [0; 16];
            let length = machine.read(&mut read);
            came.extend_from_slice(&read[..length]);
            now += Duration::from_micros(400);
            if came.len() == sent.len() && host.is_flushed() {
                break;
            }
        }
        prop_assert!(sent.starts_with(&came) || came.starts_with(&sent));
        prop_assert_eq!(came, sent);
    }
}

/// What a host with payloads of `PAYLOAD` says to a machine until the session is open, and the machine after
/// it.
fn greeted<const PAYLOAD: usize>(host: &mut Link<8, PAYLOAD>) -> (Vec<u8>, LinkedGantry<4, 64>) {
    let machine = Machine::new(MachineConfig::default()).unwrap();
    let mut machine = LinkedGantry::<4, 64>::new(
        Gantry::new(&machine, SafetyGate::new(LimitSwitches::RELEASED, false)),
        1,
        LinkSettings::default(),
    );
    let (mut said, mut now) = (Vec::new(), Duration::ZERO);
    for _ in 0..3 {
        while let Some(byte) = host.transmit(now) {
            machine.receive(now, byte);
            said.push(byte);
        }
        now += Duration::from_millis(100);
        machine.poll(now);
        while let Some(byte) = machine.transmit(now) {
            host.receive(now, byte);
        }
    }
    (said, machine)
}

/// A machine without a session obeys the orders of the digits protocol: a greeting holds none, whatever its
/// number.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn nobody_is_stopped_by_a_greeting() {
    let settings = LinkSettings::default();
    for nonce in 0..=u16::MAX {
        let mut host = Link::<8, 128>::host(nonce, settings);
        let call: Vec<u8> = std::iter::from_fn(|| host.transmit(Duration::ZERO)).collect();
        assert!(call.iter().all(|&byte| byte == 0) && call.len() > 19, "{call:x?}");
        // A machine without a session, and one whose last session had this host's number.
        for session in [0, nonce] {
            let mut host = host.clone();
            let hello = Hello { version: 1, window: 4, payload: 64, session, capabilities: 0 };
            let frame = Frame {
                kind: Kind::Hello,
                sequence: 0,
                acknowledged: 0,
                limit: 4,
                payload: &hello.to_bytes(),
            };
            let (bytes, length) = frame.encode(0).unwrap();
            bytes[..length].iter().for_each(|&byte| host.receive(Duration::ZERO, byte));
            let greeting: Vec<u8> = std::iter::from_fn(|| host.transmit(Duration::ZERO)).collect();
            assert!(greeting.len() > 12);
            assert!(
                greeting.iter().all(|&byte| Order::from_byte(byte).is_none()),
                "{nonce:#x}: {greeting:x?}"
            );
        }
    }
    // The check of this one's greeting would hold 0x21, `!`; so would the payload's length of the other.
    let mut host = Link::<8, 128>::host(0x34bb, settings);
    let (_, machine) = greeted(&mut host);
    assert_eq!((machine.state(), machine.link().session()), (Order::GoOn, host.session()));
    assert_eq!(host.state(), LinkState::Open);
    let mut host = Link::<8, 33>::host(1, settings);
    let (said, machine) = greeted(&mut host);
    assert!(said.len() > 30);
    assert_eq!((machine.state(), host.state()), (Order::GoOn, LinkState::Open));
}
