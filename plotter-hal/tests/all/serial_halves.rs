//! The halves of a serial port: on ports that only block, that are asynchronous, and of other traits; with
//! faults, and with futures that are dropped at any time.

use crate::executor::{block_on, poll_at_most};
use embedded_hal_nb::{nb, serial};
use embedded_io::{ErrorKind, ErrorType, Write};
use plotter_hal::serial_line::{Fault, FaultCounts, Io06Port, NbPort};
use plotter_hal::{SerialLine, SerialRx, SerialTx};
use plotter_motion::firmware::stepper_plotter::{Dialect, Drivers, StepperPlotter, StepperPlotterSettings};
use plotter_motion::{LimitSwitches, SafetyGate, StepPoint};
use proptest::prelude::*;
use std::collections::VecDeque;
use std::time::Duration;

/// What a port does at a call.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Does {
    /// Takes or gives so many bytes.
    Moves(usize),
    /// Is not ready; asynchronously, for a poll.
    Waits,
    Fails(ErrorKind),
}

/// A port with a buffer behind an interrupt: asynchronous, side-effect-free on cancel. Once it has done what
/// it was told it moves a byte at a time.
#[derive(Debug, Default)]
struct Port {
    does: VecDeque<Does>,
    incoming: VecDeque<Result<u8, ErrorKind>>,
    sent: Vec<u8>,
}

impl Port {
    fn doing(does: impl IntoIterator<Item = Does>) -> Self {
        Self { does: does.into_iter().collect(), ..Self::default() }
    }

    fn next(&mut self) -> Does {
        self.does.pop_front().unwrap_or(Does::Moves(1))
    }

    /// One look at what the hardware does.
    fn try_write(&mut self, bytes: &[u8]) -> Option<Result<usize, ErrorKind>> {
        match self.next() {
            Does::Moves(most) => {
                let taken = bytes.len().min(most);
                self.sent.extend(&bytes[..taken]);
                Some(Ok(taken))
            }
            Does::Waits => None,
            Does::Fails(kind) => Some(Err(kind)),
        }
    }

    fn try_read(&mut self, bytes: &mut [u8]) -> Option<Result<usize, ErrorKind>> {
        match self.next() {
            Does::Moves(_) => match self.incoming.pop_front() {
                Some(Ok(byte)) => {
                    bytes[0] = byte;
                    Some(Ok(1))
                }
                Some(Err(kind)) => Some(Err(kind)),
                None => Some(Ok(0)),
            },
            Does::Waits => None,
            Does::Fails(kind) => Some(Err(kind)),
        }
    }
}

impl ErrorType for Port {
    type Error = ErrorKind;
}

/// The blocking form. One that is not ready gives up its turn, as that of a chip's crate does with 0 bytes.
impl Write for Port {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        self.try_write(bytes).unwrap_or(Ok(0))
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

/// Comes back with what `try_it` gives, asked once a poll.
async fn ready<T>(mut try_it: impl FnMut() -> Option<T>) -> T {
    core::future::poll_fn(|_| try_it().map_or(core::task::Poll::Pending, core::task::Poll::Ready)).await
}

impl embedded_io_async::Write for Port {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        ready(|| self.try_write(bytes)).await
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

impl embedded_io_async::Read for Port {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        ready(|| self.try_read(bytes)).await
    }
}

/// A port of `embedded-hal-nb`, and one of `embedded-io` 0.6.
impl serial::ErrorType for Port {
    type Error = serial::ErrorKind;
}

const NB_KINDS: [(serial::ErrorKind, ErrorKind); 5] = [
    (serial::ErrorKind::FrameFormat, ErrorKind::InvalidData),
    (serial::ErrorKind::Parity, ErrorKind::InvalidData),
    (serial::ErrorKind::Noise, ErrorKind::InvalidData),
    (serial::ErrorKind::Overrun, ErrorKind::OutOfMemory),
    (serial::ErrorKind::Other, ErrorKind::Other),
];

fn nb_kind(kind: ErrorKind) -> serial::ErrorKind {
    NB_KINDS.into_iter().find(|&(_, io)| io == kind).map_or(serial::ErrorKind::Other, |(nb, _)| nb)
}

impl serial::Read for Port {
    fn read(&mut self) -> nb::Result<u8, serial::ErrorKind> {
        let mut byte = [0];
        match self.try_read(&mut byte) {
            None | Some(Ok(0)) => Err(nb::Error::WouldBlock),
            Some(Ok(_)) => Ok(byte[0]),
            Some(Err(kind)) => Err(nb::Error::Other(nb_kind(kind))),
        }
    }
}

impl serial::Write for Port {
    fn write(&mut self, byte: u8) -> nb::Result<(), serial::ErrorKind> {
        match self.try_write(&[byte]) {
            None | Some(Ok(0)) => Err(nb::Error::WouldBlock),
            Some(Ok(_)) => Ok(()),
            Some(Err(kind)) => Err(nb::Error::Other(nb_kind(kind))),
        }
    }

    fn flush(&mut self) -> nb::Result<(), serial::ErrorKind> {
        Ok(())
    }
}

#[derive(Debug)]
struct Port06(Result<u8, embedded_io_06::ErrorKind>, Vec<u8>);

impl embedded_io_06::ErrorType for Port06 {
    type Error = embedded_io_06::ErrorKind;
}

impl embedded_io_06::Read for Port06 {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, embedded_io_06::ErrorKind> {
        bytes[0] = self.0?;
        Ok(1)
    }
}

impl embedded_io_06::ReadReady for Port06 {
    fn read_ready(&mut self) -> Result<bool, embedded_io_06::ErrorKind> {
        Ok(true)
    }
}

impl embedded_io_06::Write for Port06 {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, embedded_io_06::ErrorKind> {
        self.0?;
        self.1.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), embedded_io_06::ErrorKind> {
        Ok(())
    }
}

impl embedded_io_06::WriteReady for Port06 {
    fn write_ready(&mut self) -> Result<bool, embedded_io_06::ErrorKind> {
        Ok(self.1.len() < 2)
    }
}

fn source(bytes: &[u8]) -> impl FnMut() -> Option<u8> {
    let mut bytes = bytes.iter().copied();
    move || bytes.next()
}

#[test]
fn what_has_no_room_is_left_to_its_source() {
    let mut next = source(b"12345");
    let mut tx: SerialTx<_, 2> = SerialTx::new(Port::default());
    assert_eq!(tx.queue(&mut next), 2);
    assert_eq!(tx.queue(&mut next), 2, "full");
    assert_eq!(next(), Some(b'3'));
    tx.write_queued().unwrap();
    assert_eq!((tx.waiting(), tx.queue(&mut next)), (0, 2));
    tx.write_queued().unwrap();
    assert_eq!(tx.release().sent, b"1245");
}

#[test]
fn a_port_that_takes_nothing_now_is_asked_again_later() {
    let mut tx: SerialTx<_, 8> = SerialTx::new(Port::doing([Does::Moves(2), Does::Waits]));
    tx.queue(source(b"abc"));
    tx.write_queued().unwrap();
    assert_eq!(tx.waiting(), 1);
    tx.write_queued().unwrap();
    assert_eq!((tx.waiting(), tx.faults()), (0, FaultCounts::default()));
    assert_eq!(tx.release().sent, b"abc");
}

#[test]
fn a_byte_comes_when_it_comes_and_the_end_is_none() {
    let mut port = Port::doing([Does::Waits, Does::Waits]);
    port.incoming = [Ok(7), Err(ErrorKind::InvalidData)].into();
    let mut rx = SerialRx::new(port);
    assert!(poll_at_most(2, rx.received()).is_none());
    let received = block_on(rx.received()).unwrap();
    assert_eq!((received.byte, received.fault), (7, None));
    let received = block_on(rx.received()).unwrap();
    assert_eq!((received.byte, received.fault), (0x1A, Some(Fault::Broken)));
    assert_eq!(block_on(rx.received()), None);
}

#[test]
fn a_port_that_fails_for_ever_gives_other_tasks_a_turn() {
    let incoming = [Err(ErrorKind::Other); 100].into();
    let mut rx = SerialRx::new(Port { incoming, ..Port::default() });
    let mut polls = Vec::new();
    for _ in 0..17 {
        let needed = (1..5).find(|&most| {
            let came = poll_at_most(most, rx.received());
            came.is_some()
        });
        polls.push(needed.unwrap());
    }
    // A future that was dropped while it waited for its turn has had it.
    assert_eq!(polls, [1, 1, 1, 1, 1, 1, 1, 1, 2, 1, 1, 1, 1, 1, 1, 1, 2]);
    assert_eq!(rx.faults().other, 17);
}

#[test]
fn a_port_that_takes_nothing_though_it_has_waited_has_failed() {
    let mut tx: SerialTx<_, 4> = SerialTx::new(Port::doing([Does::Moves(0)]));
    assert_eq!(block_on(tx.sent(source(b"ab"))), Err(Fault::Other));
    assert_eq!((tx.waiting(), tx.faults().other), (2, 1));
    assert_eq!(block_on(tx.sent(|| None)), Ok(()));
    assert_eq!(tx.release().sent, b"ab");
}

#[test]
fn a_port_of_words_tells_the_kinds_of_faults_and_never_waits() {
    for (kind, fault) in [
        (ErrorKind::InvalidData, Fault::Broken),
        (ErrorKind::OutOfMemory, Fault::Overrun),
        (ErrorKind::Other, Fault::Other),
    ] {
        let mut port = Port::doing([Does::Waits, Does::Moves(1), Does::Moves(1), Does::Fails(kind)]);
        port.incoming = [Ok(b'1'), Ok(b'2')].into();
        let mut line = SerialLine::new(NbPort::new(port));
        assert_eq!(line.receive(), None, "nothing has come");
        assert_eq!(line.receive().map(|received| received.byte), Some(b'1'));
        assert_eq!(line.receive().map(|received| received.byte), Some(b'2'));
        assert_eq!(line.receive().and_then(|received| received.fault), Some(fault));

        let port = Port::doing([Does::Moves(1), Does::Waits, Does::Fails(kind)]);
        let mut line = SerialLine::new(NbPort::new(port));
        let mut next = source(b"123");
        assert_eq!(line.send(&mut next), Err(fault), "the second byte waits, then fails");
        assert_eq!(line.send(&mut next), Ok(()));
        assert_eq!(line.send(&mut next), Ok(()));
        assert_eq!(line.release().release().sent, b"123");
    }
    for (nb, io) in NB_KINDS {
        let mut line = SerialLine::new(NbPort::new(Broken(nb)));
        let seen = line.receive().and_then(|received| received.fault);
        let mut io = SerialRx::new(Port { incoming: [Err(io)].into(), ..Port::default() });
        assert_eq!(seen, block_on(io.received()).and_then(|received| received.fault), "{nb:?}");
    }
}

/// A port of words whose every word is broken.
#[derive(Debug)]
struct Broken(serial::ErrorKind);

impl serial::ErrorType for Broken {
    type Error = serial::ErrorKind;
}

impl serial::Read for Broken {
    fn read(&mut self) -> nb::Result<u8, serial::ErrorKind> {
        Err(nb::Error::Other(self.0))
    }
}

impl serial::Write for Broken {
    fn write(&mut self, _: u8) -> nb::Result<(), serial::ErrorKind> {
        Err(nb::Error::Other(self.0))
    }

    fn flush(&mut self) -> nb::Result<(), serial::ErrorKind> {
        Err(nb::Error::Other(self.0))
    }
}

#[test]
fn a_port_of_the_older_traits_is_a_port() {
    let mut line = SerialLine::new(Io06Port::new(Port06(Ok(b'x'), Vec::new())));
    assert_eq!(line.receive().map(|received| received.byte), Some(b'x'));
    let mut next = source(b"123");
    line.send(&mut next).unwrap();
    assert_eq!(next(), Some(b'3'), "it said that it is not ready for a third byte");
    assert_eq!(line.release().release().1, b"12");
    for (kind, fault) in [
        (embedded_io_06::ErrorKind::InvalidData, Fault::Broken),
        (embedded_io_06::ErrorKind::OutOfMemory, Fault::Overrun),
        (embedded_io_06::ErrorKind::BrokenPipe, Fault::Gone),
        (embedded_io_06::ErrorKind::ConnectionAborted, Fault::Gone),
        (embedded_io_06::ErrorKind::ConnectionReset, Fault::Gone),
        (embedded_io_06::ErrorKind::NotConnected, Fault::Gone),
        (embedded_io_06::ErrorKind::TimedOut, Fault::Other),
    ] {
        let mut rx = SerialRx::new(Io06Port::new(Port06(Err(kind), Vec::new())));
        assert_eq!(rx.receive().and_then(|received| received.fault), Some(fault), "{kind:?}");
        let mut tx: SerialTx<_, 1> = SerialTx::new(Io06Port::new(Port06(Err(kind), Vec::new())));
        tx.queue(source(b"1"));
        assert_eq!(tx.write_queued(), Err(fault), "{kind:?}");
    }
}

fn does() -> impl Strategy<Value = Vec<Does>> {
    let kind =
        prop_oneof![Just(ErrorKind::InvalidData), Just(ErrorKind::OutOfMemory), Just(ErrorKind::Other)];
    let does = prop_oneof![
        4 => (1..6_usize).prop_map(Does::Moves),
        4 => Just(Does::Waits),
        1 => kind.prop_map(Does::Fails),
    ];
    prop::collection::vec(does, 0..200)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the port does, and wherever a future is dropped.
    #[test]
    fn an_answer_is_sent_once_whenever_its_sender_is_dropped(
        answers in prop::collection::vec(any::<u8>(), 0..100),
        does in does(),
        polls in prop::collection::vec(0..4_usize, 0..100),
    ) {
        let mut next = source(&answers);
        let mut tx: SerialTx<_, 5> = SerialTx::new(Port::doing(does.iter().copied()));
        for most in polls {
            if most == 0 {
                let _ = (tx.queue(&mut next), tx.write_queued());
            } else {
                let _ = poll_at_most(most, tx.sent(&mut next));
            }
        }
        while block_on(tx.sent(&mut next)).is_err() {}
        prop_assert_eq!(&tx.release().sent, &answers);
    }

    /// The same for bytes that come. One that came broken is told in its place, with all the others.
    #[test]
    fn a_byte_is_received_once_whenever_its_reader_is_dropped(
        bytes in prop::collection::vec(prop::option::weighted(0.9, 0x20..=0x7F_u8), 0..100),
        waits in prop::collection::vec(any::<bool>(), 0..200),
        polls in prop::collection::vec(0..4_usize, 0..300),
    ) {
        let mut port = Port::doing(waits.into_iter().map(|waits| if waits { Does::Waits } else { Does::Moves(1) }));
        port.incoming = bytes.iter().map(|byte| byte.ok_or(ErrorKind::InvalidData)).collect();
        let mut rx = SerialRx::new(port);
        let mut received = Vec::new();
        for most in polls {
            received.extend(poll_at_most(most, rx.received()).flatten());
        }
        while let Some(byte) = block_on(rx.received()) {
            received.push(byte);
        }
        let received: Vec<_> = received.into_iter().map(|it| it.fault.is_none().then_some(it.byte)).collect();
        prop_assert_eq!(received, bytes);
    }

    /// A line of G-code over a bad cable, read by futures that are dropped all the time: it is drawn, or it
    /// is refused as a whole and the machine stands.
    #[test]
    fn noise_and_dropped_readers_never_move_the_machine_elsewhere(
        broken in prop::collection::vec(any::<prop::sample::Index>(), 0..3),
        waits in prop::collection::vec(any::<bool>(), 0..100),
        polls in prop::collection::vec(0..3_usize, 0..200),
    ) {
        let mut text: Vec<_> = b"G1 X12 Y3 F600\n".iter().copied().map(Ok).collect();
        let most = text.len() - 1; // without its end the line is not over
        for index in &broken {
            text[index.index(most)] = Err(ErrorKind::InvalidData);
        }
        let is_whole = text.iter().all(Result::is_ok);
        let mut port = Port::doing(waits.into_iter().map(|waits| if waits { Does::Waits } else { Does::Moves(1) }));
        port.incoming = text.into();
        let mut rx = SerialRx::new(port);
        let settings = StepperPlotterSettings { dialect: Dialect::Grbl, ..StepperPlotterSettings::default() };
        let mut plotter = StepperPlotter::new(settings, SafetyGate::new(LimitSwitches::RELEASED, false)).unwrap();
        let mut now = Duration::ZERO;
        for most in polls {
            if let Some(received) = poll_at_most(most, rx.received()).flatten() {
                plotter.receive(now, received.byte);
            }
        }
        while let Some(received) = block_on(rx.received()) {
            plotter.receive(now, received.byte);
        }
        let mut answers = Vec::new();
        loop {
            while plotter.poll(now, Drivers::Ready).is_some() {}
            answers.extend(core::iter::from_fn(|| plotter.transmit(now)));
            let Some(due) = plotter.due() else { break };
            now = due;
            prop_assert!(now < Duration::from_secs(20));
        }
        let answers = String::from_utf8(answers).unwrap();
        let at = if is_whole { StepPoint::new(1051, 263) } else { StepPoint::default() };
        prop_assert_eq!(plotter.position(), at, "{}", answers);
        prop_assert_eq!(answers.contains("error:"), !is_whole, "{}", answers);
    }
}
