//! [`Link`]: a line that loses, changes and invents bytes, made into two streams that lose none; sans-IO.
//!
//! Each side sends its stream in numbered frames, at most a window of them ahead of what the other has read.
//! The other says up to where all have come, and which came after a gap. A line keeps the order of its bytes:
//! where a frame was sent before one that has come, and has not come itself, it is lost and sent again at
//! once; the last ones are sent again after a time learned from the answers. Where frames are lost, new ones
//! are made shorter; where none are, longer.
//!
//! ```text
//!   host                                       machine
//!   20 zeros, a target (0, 0) twice  ─────▶    a machine of the digits protocol stands where it stands
//!                                    ◀─────    HELLO: that it knows frames   (none within a second: digits)
//!   HELLO: the session               ─────▶
//!                                    ◀─────    HELLO: it has begun
//!   DATA 0, DATA 1, ...              ─────▶
//!                                    ◀─────    DATA ..., or ACKNOWLEDGE where there is nothing to say
//! ```

mod incoming;
mod orders;
mod outgoing;
mod round_trip;
mod settings;

pub use settings::{LinkCounts, LinkSettings};

use super::frame::{DecodeError, Decoder, Frame, Kind, MOST_BYTES, MOST_PAYLOAD};
use super::{Hello, Order};
use core::time::Duration;
use incoming::Incoming;
use orders::{Given, Taken};
use outgoing::{LEAST_PAYLOAD, Outgoing};

/// Version of the link that this is.
pub const LINK_VERSION: u8 = 1;
/// Zeros by which a host asks whether a machine knows frames: two targets (0, 0) of the digits protocol.
pub const CALL_ZEROS: u8 = 20;
/// Zeros in a row that are a call, should some be lost. No host of digits sends more than a target, ten, at
/// once.
const CALLED_BY_ZEROS: u8 = 12;
/// In a row are those that come no later than this after each other: at 9600 baud a byte takes 1 ms.
const IN_A_ROW: Duration = Duration::from_millis(5);

/// How a link stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum LinkState {
    /// A machine that no host has greeted.
    Idle,
    /// A host that calls, or waits for the machine to begin its session.
    Calling,
    /// A host whose calls were not answered: the machine knows the digits protocol at most.
    DigitsOnly,
    /// Both streams flow.
    Open,
    /// As before, but nothing has come for a while: a cable out of its socket, a machine switched off.
    Interrupted,
    /// A host whose machine has begun anew: what it had of this session is lost. [`Link::call`] calls again.
    Restarted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Host { nonce: u16, calls: u8, zeros_left: u8 },
    Machine,
}

/// A frame on its way out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct OnTheLine {
    bytes: [u8; MOST_BYTES],
    length: usize,
    done: usize,
    /// The number of its payload, if that waits for an answer.
    sequence: Option<u8>,
}

/// One end of the link. `WINDOW` frames of at most `PAYLOAD` bytes wait on the way out, and as many on the
/// way in.
///
/// `WINDOW` is a power of two up to 32, `PAYLOAD` 12 to 240; the ends need not agree. Feed it every byte that
/// comes ([`receive`](Self::receive)); whenever the line can take a byte, ask for one
/// ([`transmit`](Self::transmit)); if it has none, ask again at [`next_wake`](Self::next_wake), or after the
/// next byte that comes or is written or read. Times never go back. It takes `2 * WINDOW * (PAYLOAD + 24)`
/// bytes of memory and about 700, and never more.
///
/// What is sent twice, changed, or comes from an earlier session is never read, and nothing is read twice:
/// the check of a frame, 16 bits and its length, lets pass one damaged frame in 65,536 at worst, and none
/// with a single burst of up to 16 bits.
///
/// ```
/// # use core::time::Duration;
/// # use plotter_motion::protocol::{Link, LinkSettings, LinkState};
/// let mut host = Link::<4, 64>::host(1, LinkSettings::default());
/// let mut machine = Link::<2, 32>::machine(LinkSettings::default());
/// host.write(b"to (900, 600)");
/// for _ in 0..3 {
///     while let Some(byte) = host.transmit(Duration::ZERO) {
///         machine.receive(Duration::ZERO, byte);
///     }
///     while let Some(byte) = machine.transmit(Duration::ZERO) {
///         host.receive(Duration::ZERO, byte);
///     }
/// }
/// assert_eq!((host.state(), machine.state()), (LinkState::Open, LinkState::Open));
/// let mut heard = [0; 32];
/// let length = machine.read(&mut heard);
/// assert_eq!(&heard[..length], b"to (900, 600)");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link<const WINDOW: usize, const PAYLOAD: usize> {
    settings: LinkSettings,
    role: Role,
    state: LinkState,
    session: u16,
    peer: Hello,
    counts: LinkCounts,
    decoder: Decoder,
    /// Zeros in a row that have come, and when the last byte did.
    zeros: u8,
    zero_at: Duration,
    heard: Duration,
    line: OnTheLine,
    spoke: Duration,
    outgoing: Outgoing<WINDOW, PAYLOAD>,
    incoming: Incoming<WINDOW, PAYLOAD>,
    /// The limit that the other side was told last, and whether it waits for an answer.
    told_limit: u8,
    acknowledge: bool,
    greet: bool,
    greeted: Option<Duration>,
    /// A host's order that the machine has not answered, and the machine's last one.
    given: Given,
    taken: Taken,
}

impl<const WINDOW: usize, const PAYLOAD: usize> Link<WINDOW, PAYLOAD> {
    const CHECKED: () = assert!(
        WINDOW.is_power_of_two()
            && WINDOW <= 32
            && PAYLOAD >= LEAST_PAYLOAD as usize
            && PAYLOAD <= MOST_PAYLOAD,
        "WINDOW must be a power of two up to 32, PAYLOAD 12 to 240"
    );

    fn new(role: Role, state: LinkState, settings: LinkSettings) -> Self {
        const { Self::CHECKED };
        Self {
            settings,
            role,
            state,
            session: 0,
            peer: Hello::default(),
            counts: LinkCounts::default(),
            decoder: Decoder::new(),
            zeros: 0,
            zero_at: Duration::ZERO,
            heard: Duration::ZERO,
            line: OnTheLine { bytes: [0; MOST_BYTES], length: 0, done: 0, sequence: None },
            spoke: Duration::ZERO,
            outgoing: Outgoing::new(),
            incoming: Incoming::new(),
            told_limit: 0,
            acknowledge: false,
            greet: state == LinkState::Calling,
            greeted: None,
            given: Given::default(),
            taken: Taken::default(),
        }
    }

    /// The host's end, which calls. `nonce` is the number of the session: one that a host started anew is not
    /// likely to take again, such as the low bits of a clock. The next one is taken if the greeting would
    /// hold an [`Order`] by this one: a machine without a session obeys those as it would in the digits
    /// protocol.
    #[must_use]
    pub fn host(nonce: u16, settings: LinkSettings) -> Self {
        let mut host = Self::new(Role::Host { nonce, calls: 0, zeros_left: 0 }, LinkState::Calling, settings);
        host.role = Role::Host { nonce: host.number(nonce), calls: 0, zeros_left: 0 };
        host
    }

    /// The machine's end, which answers.
    #[must_use]
    pub fn machine(settings: LinkSettings) -> Self {
        Self::new(Role::Machine, LinkState::Idle, settings)
    }

    /// How it stands.
    #[must_use]
    pub const fn state(&self) -> LinkState {
        self.state
    }

    /// Introduction of the other side; `None` before it has come.
    #[must_use]
    pub const fn peer(&self) -> Option<Hello> {
        if self.peer.version > 0 { Some(self.peer) } else { None }
    }

    /// Number of the session; 0 before the first.
    #[must_use]
    pub const fn session(&self) -> u16 {
        self.session
    }

    /// Counts of frames: whole, damaged, repeated and sent again.
    #[must_use]
    pub const fn counts(&self) -> LinkCounts {
        self.counts
    }

    /// A host calls anew, for a session of the number `nonce`; what was written and not read by the machine
    /// is forgotten. A machine takes no notice.
    pub fn call(&mut self, nonce: u16) {
        if self.role != Role::Machine {
            let Self { settings, counts, heard, spoke, given, .. } = *self;
            *self = Self { counts, heard, spoke, given: given.unsent(), ..Self::host(nonce, settings) };
        }
    }

    /// Appends to the stream; says how many of `bytes` found room. A machine has no stream before its first
    /// session; a host's can be begun at once.
    pub fn write(&mut self, bytes: &[u8]) -> usize {
        if self.state == LinkState::Idle {
            return 0;
        }
        bytes.iter().take_while(|&&byte| self.outgoing.write(byte)).count()
    }

    /// How many bytes are sure to find room.
    #[must_use]
    pub fn room(&self) -> usize {
        if self.state == LinkState::Idle { 0 } else { self.outgoing.room() }
    }

    /// Whether all that was written has come.
    #[must_use]
    pub fn is_flushed(&self) -> bool {
        self.outgoing.is_empty()
    }

    /// Takes what has come of the other side's stream, in order and each byte once; says how much.
    pub fn read(&mut self, into: &mut [u8]) -> usize {
        let places = into.iter_mut();
        places.map_while(|place| self.incoming.read().map(|byte| *place = byte)).count()
    }

    /// Whether a frame is in the middle of its bytes.
    #[must_use]
    pub const fn is_sending(&self) -> bool {
        self.line.done < self.line.length
    }

    /// A host's order to the machine, which takes the place of any before it; its number in this session. A
    /// frame on its way out is cut for it, and it is sent again every [`LinkSettings::least_retry`] until
    /// [`order_taken`](Self::order_taken). A machine gives none.
    ///
    /// [`Order::Stop`] is preceded by `00 21 00`: what can be no frame, and is obeyed by a machine in
    /// whatever session or none.
    pub const fn order(&mut self, order: Order) -> u8 {
        self.given.give(order)
    }

    /// The machine has answered the order of this number.
    pub fn order_taken(&mut self, number: u8) {
        self.given.answered(number);
    }

    /// A machine's next order and its number; 0 for one that has none. It is there as soon as its last byte
    /// has come, whatever waits in the streams.
    pub const fn take_order(&mut self) -> Option<(u8, Order)> {
        self.taken.take()
    }

    // ---- what comes

    /// Takes a byte from the line.
    pub fn receive(&mut self, now: Duration, byte: u8) {
        let in_a_row = now <= self.zero_at.saturating_add(IN_A_ROW);
        self.zeros = if byte != 0 {
            0
        } else if in_a_row {
            self.zeros.saturating_add(1)
        } else {
            1
        };
        self.zero_at = now;
        if self.role == Role::Machine {
            self.taken.byte(byte);
        }
        if self.zeros == CALLED_BY_ZEROS && self.role == Role::Machine {
            self.greet = true;
        }
        // (what a frame says is copied where it lies: all else may change by it)
        let Self { decoder, incoming, session, counts, .. } = self;
        let Frame { kind, acknowledged, limit, payload, sequence } = match decoder.push(byte, *session) {
            None => return,
            Some(Ok(frame)) => frame,
            Some(Err(error)) => {
                counts.damaged = counts.damaged.saturating_add(1);
                // A machine without a session cannot know a frame of one: that host does not know that it was
                // off.
                self.greet |= self.role == Role::Machine && *session == 0 && error == DecodeError::Check;
                return;
            }
        };
        counts.frames = counts.frames.saturating_add(1);
        let after_gap = match kind {
            Kind::Hello => {
                if let Some(hello) = Hello::from_bytes(payload) {
                    self.heard = now;
                    self.greeted_by(hello);
                }
                return;
            }
            Kind::Data => {
                if !incoming.keep(sequence, payload) {
                    counts.repeated = counts.repeated.saturating_add(1);
                }
                self.acknowledge = true;
                0
            }
            Kind::Acknowledge => {
                let bytes = payload.iter().zip([0, 8, 16, 24]);
                bytes.fold(0, |bits, (&byte, shift)| bits | u32::from(byte) << shift)
            }
            Kind::Order => {
                if let Some(order) = payload.first().copied().and_then(Order::from_byte) {
                    self.taken.frame(sequence, order);
                }
                self.heard = now;
                return;
            }
        };
        self.heard = now;
        if matches!(self.state, LinkState::Calling | LinkState::Interrupted) {
            self.begin();
        }
        self.outgoing.acknowledged(now, acknowledged, after_gap, limit);
    }

    /// The session flows: the other side has begun it, or is heard again.
    fn begin(&mut self) {
        self.state = LinkState::Open;
        self.outgoing.agree(self.peer.window, self.peer.payload);
    }

    fn greeted_by(&mut self, hello: Hello) {
        self.peer = hello;
        match self.role {
            Role::Machine => {
                if hello.session == 0 {
                    return;
                }
                if hello.session != self.session {
                    // All of the last session is over, but for the frame on its way: that goes out whole.
                    let Self { settings, counts, heard, spoke, greeted, peer, line, .. } = *self;
                    let line = OnTheLine { sequence: None, ..line };
                    let session = hello.session;
                    let new = Self::new(Role::Machine, LinkState::Open, settings);
                    *self = Self { session, counts, heard, spoke, greeted, peer, line, ..new };
                }
                self.begin();
                self.greet = true;
            }
            Role::Host { nonce, zeros_left, .. } => match self.state {
                LinkState::Calling if self.session == nonce && hello.session == nonce => self.begin(),
                LinkState::Calling => {
                    // It knows frames. Greet it, by a number that its last session did not have.
                    let nonce =
                        if hello.session == nonce { self.number(nonce.wrapping_add(1)) } else { nonce };
                    self.role = Role::Host { nonce, calls: 0, zeros_left };
                    self.session = nonce;
                    self.greet = true;
                }
                LinkState::Open | LinkState::Interrupted if hello.session != self.session => {
                    self.state = LinkState::Restarted;
                }
                _ => {}
            },
        }
    }

    // ---- what goes

    /// The next byte for the line, if there is one. The line must take it.
    pub fn transmit(&mut self, now: Duration) -> Option<u8> {
        if !self.order_frame(now) && !self.is_sending() {
            let listens = matches!(self.state, LinkState::Open | LinkState::Interrupted);
            if listens && now.saturating_sub(self.heard) >= self.settings.interrupted_after {
                self.state = LinkState::Interrupted;
            }
            if !(self.greeting(now) || listens && self.frame(now)) {
                return None;
            }
        }
        let byte = self.line.bytes.get(self.line.done).copied();
        self.line.done += 1;
        if !self.is_sending() {
            self.spoke = now;
            if let Some(sequence) = self.line.sequence.take() {
                self.outgoing.through(now, sequence);
            }
        }
        byte
    }

    /// When the next call or greeting is due.
    fn greeting_at(&self) -> Option<Duration> {
        let after = |rest: Duration| self.greeted.map_or(Duration::ZERO, |at| at.saturating_add(rest));
        match self.role {
            Role::Host { zeros_left: 1.., .. } => Some(Duration::ZERO),
            Role::Host { .. } if self.state == LinkState::Calling => {
                Some(if self.greet { Duration::ZERO } else { after(self.settings.call_again) })
            }
            // Not every noise that looks like a call is answered.
            Role::Machine if self.greet => Some(after(self.settings.call_again / 4)),
            _ => None,
        }
    }

    /// Puts a call or a greeting on the line, if one is due.
    fn greeting(&mut self, now: Duration) -> bool {
        if self.greeting_at().is_none_or(|at| now < at) {
            return false;
        }
        if let Role::Host { calls, zeros_left, .. } = &mut self.role {
            if *zeros_left == 0 {
                if *calls >= self.settings.most_calls && self.session != 0 {
                    // It knew frames and says nothing more: from the beginning.
                    (self.session, *calls) = (0, 0);
                }
                if *calls >= self.settings.most_calls {
                    self.state = LinkState::DigitsOnly;
                    return false;
                }
                *calls += 1;
                (self.greet, self.greeted) = (false, Some(now));
                if self.session == 0 {
                    *zeros_left = CALL_ZEROS;
                }
            }
            if *zeros_left > 0 {
                *zeros_left -= 1;
                self.line = OnTheLine { bytes: [0; MOST_BYTES], length: 1, done: 0, sequence: None };
                return true;
            }
        }
        (self.greet, self.greeted) = (false, Some(now));
        self.put(Kind::Hello, 0, &self.hello(self.session).to_bytes())
    }

    fn hello(&self, session: u16) -> Hello {
        let mut payload = u8::try_from(PAYLOAD).unwrap_or(0);
        if self.role != Role::Machine && Order::from_byte(payload).is_some() {
            payload -= 1;
        }
        let window = u8::try_from(WINDOW).unwrap_or(0);
        let capabilities = self.settings.capabilities;
        Hello { version: LINK_VERSION, window, payload, session, capabilities }
    }

    /// The first number of a session, from `from` on, by which a host greets without a byte that is an order.
    /// (256 numbers in a row have `!` as their high byte; all fail only if the capabilities hold such a
    /// byte.)
    fn number(&self, from: u16) -> u16 {
        let numbers = (0..1_024).map(|on| from.wrapping_add(on)).filter(|&number| number > 0);
        let is_quiet = |&number: &u16| {
            let hello = self.hello(number).to_bytes();
            self.encoded(Kind::Hello, 0, &hello).is_some_and(|(bytes, length)| {
                bytes.iter().take(length).all(|&byte| Order::from_byte(byte).is_none())
            })
        };
        numbers.clone().find(is_quiet).unwrap_or_else(|| from.max(1))
    }

    /// Puts an order on the line, if one is due; what is on its way there is cut short for one that was not
    /// sent yet.
    fn order_frame(&mut self, now: Duration) -> bool {
        let is_open = matches!(self.state, LinkState::Open | LinkState::Interrupted);
        let Some((order, number)) =
            self.given.due(now, is_open, self.is_sending(), self.settings.least_retry)
        else {
            return false;
        };
        if let Some(sequence) = self.line.sequence.take().filter(|_| self.is_sending()) {
            self.outgoing.cut(now, sequence);
        }
        if !(is_open && self.put(Kind::Order, number, &[order.byte()])) {
            self.line = OnTheLine { bytes: [0; MOST_BYTES], length: 0, done: 0, sequence: None };
        }
        // The zero ends what was cut; a stop by itself is known without its frame, too.
        let ahead: &[u8] = if order == Order::Stop { &[0, Order::Stop.byte(), 0] } else { &[0] };
        self.line.bytes.rotate_right(ahead.len());
        for (place, &byte) in self.line.bytes.iter_mut().zip(ahead) {
            *place = byte;
        }
        self.line.length += ahead.len();
        true
    }

    /// Puts a frame of the session on the line, if one is due.
    fn frame(&mut self, now: Duration) -> bool {
        let LinkSettings { least_retry, most_retry, keep_alive, .. } = self.settings;
        let after_gap = self.incoming.after_gap();
        // What came after a gap, the other side should know before it sends more.
        if !(self.acknowledge && after_gap != 0) {
            let late_after = self.outgoing.late_after(least_retry, most_retry);
            if let Some((sequence, again)) = self.outgoing.due(now, late_after) {
                self.counts.sent_again = self.counts.sent_again.saturating_add(u32::from(again));
                let mut payload = [0; PAYLOAD];
                let sent = self.outgoing.send(sequence);
                let length = sent.len();
                if let Some(place) = payload.get_mut(..length) {
                    place.copy_from_slice(sent);
                }
                return self.put(Kind::Data, sequence, payload.get(..length).unwrap_or_default());
            }
            if !self.acknowledge && !self.limit_is_stale() && now < self.spoke.saturating_add(keep_alive) {
                return false;
            }
        }
        let length = (u32::BITS - after_gap.leading_zeros()).div_ceil(8);
        self.put(Kind::Acknowledge, 0, after_gap.to_le_bytes().get(..length as usize).unwrap_or_default())
    }

    /// Whether so much has been read since the other side was told that it may wait for that.
    fn limit_is_stale(&self) -> bool {
        usize::from(self.incoming.limit().wrapping_sub(self.told_limit)) >= WINDOW.div_ceil(2)
    }

    fn encoded(&self, kind: Kind, sequence: u8, payload: &[u8]) -> Option<([u8; MOST_BYTES], usize)> {
        let (acknowledged, limit) = (self.incoming.expected(), self.incoming.limit());
        let frame = Frame { kind, sequence, acknowledged, limit, payload };
        frame.encode(if kind == Kind::Hello { 0 } else { self.session })
    }

    fn put(&mut self, kind: Kind, sequence: u8, payload: &[u8]) -> bool {
        let Some((mut bytes, mut length)) = self.encoded(kind, sequence, payload) else {
            return false;
        };
        if kind == Kind::Hello {
            // What came over the line before is no part of it, whatever it was.
            bytes.rotate_right(1);
            length += 1;
        } else {
            (self.told_limit, self.acknowledge) = (self.incoming.limit(), false);
        }
        let sequence = (kind == Kind::Data).then_some(sequence);
        self.line = OnTheLine { bytes, length, done: 0, sequence };
        true
    }

    /// When [`transmit`](Self::transmit) has something to say, if nothing comes and nothing is written or
    /// read before.
    #[must_use]
    pub fn next_wake(&self) -> Option<Duration> {
        if self.is_sending() {
            return Some(Duration::ZERO);
        }
        let greeting = self.greeting_at();
        let is_open = matches!(self.state, LinkState::Open | LinkState::Interrupted);
        let order = self.given.due_at(is_open, self.settings.least_retry);
        if !matches!(self.state, LinkState::Open | LinkState::Interrupted) {
            return [greeting, order].into_iter().flatten().min();
        }
        let LinkSettings { least_retry, most_retry, keep_alive, interrupted_after, .. } = self.settings;
        let late_after = self.outgoing.late_after(least_retry, most_retry);
        let interrupted =
            (self.state == LinkState::Open).then(|| self.heard.saturating_add(interrupted_after));
        let speak = Some(self.spoke.saturating_add(keep_alive));
        [greeting, order, self.outgoing.late_at(late_after), interrupted, speak].into_iter().flatten().min()
    }
}
