//! [`Incoming`]: payloads that have come, put in order.

/// A payload that has come and has not been read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Slot<const PAYLOAD: usize> {
    bytes: [u8; PAYLOAD],
    length: u8,
    full: bool,
}

/// The last `WINDOW` payloads of the other side's stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Incoming<const WINDOW: usize, const PAYLOAD: usize> {
    slots: [Slot<PAYLOAD>; WINDOW],
    /// The first number that has not come.
    expected: u8,
    /// The first that has not been read, and how much of it has.
    taken: u8,
    taken_bytes: u8,
}

impl<const WINDOW: usize, const PAYLOAD: usize> Incoming<WINDOW, PAYLOAD> {
    #[expect(clippy::cast_possible_truncation, reason = "a link's window is 32 at most")]
    const WINDOW_U8: u8 = WINDOW as u8;

    pub(super) const fn new() -> Self {
        let empty = Slot { bytes: [0; PAYLOAD], length: 0, full: false };
        Self { slots: [empty; WINDOW], expected: 0, taken: 0, taken_bytes: 0 }
    }

    fn slot(&self, sequence: u8) -> Option<&Slot<PAYLOAD>> {
        self.slots.get(usize::from(sequence) % WINDOW)
    }

    /// Keeps a payload; says whether it is new.
    pub(super) fn keep(&mut self, sequence: u8, payload: &[u8]) -> bool {
        let ahead = sequence.wrapping_sub(self.taken);
        let old = sequence.wrapping_sub(self.expected) >= 128;
        let Some(slot) = self.slots.get_mut(usize::from(sequence) % WINDOW) else { return false };
        let (Some(place), Ok(length)) = (slot.bytes.get_mut(..payload.len()), u8::try_from(payload.len()))
        else {
            return false;
        };
        if old || ahead >= Self::WINDOW_U8 || slot.full || payload.is_empty() {
            return false;
        }
        place.copy_from_slice(payload);
        (slot.length, slot.full) = (length, true);
        while self.expected.wrapping_sub(self.taken) < Self::WINDOW_U8
            && self.slot(self.expected).is_some_and(|slot| slot.full)
        {
            self.expected = self.expected.wrapping_add(1);
        }
        true
    }

    /// All numbers before this have come.
    pub(super) const fn expected(&self) -> u8 {
        self.expected
    }

    /// The other side must not send this number yet.
    pub(super) const fn limit(&self) -> u8 {
        self.taken.wrapping_add(Self::WINDOW_U8)
    }

    /// A bit for each payload that has come after the first that has not: the lowest for the one next to it.
    pub(super) fn after_gap(&self) -> u32 {
        let behind = self.limit().wrapping_sub(self.expected).saturating_sub(1);
        (0..behind)
            .filter(|&ahead| {
                let sequence = self.expected.wrapping_add(1).wrapping_add(ahead);
                self.slot(sequence).is_some_and(|slot| slot.full)
            })
            .fold(0, |bits, ahead| bits | 1 << ahead)
    }

    /// The next byte of the stream.
    pub(super) fn read(&mut self) -> Option<u8> {
        if self.taken == self.expected {
            return None;
        }
        let slot = self.slots.get_mut(usize::from(self.taken) % WINDOW)?;
        let byte = slot.bytes.get(usize::from(self.taken_bytes)).copied();
        self.taken_bytes += 1;
        if self.taken_bytes >= slot.length {
            slot.full = false;
            self.taken = self.taken.wrapping_add(1);
            self.taken_bytes = 0;
        }
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(incoming: &mut Incoming<4, 12>) -> std::vec::Vec<u8> {
        core::iter::from_fn(|| incoming.read()).collect()
    }

    #[test]
    fn what_comes_out_of_order_waits_and_is_told() {
        let mut incoming = Incoming::<4, 12>::new();
        assert!(incoming.keep(1, b"b") && incoming.keep(3, b"d"));
        assert_eq!((incoming.expected(), incoming.limit(), incoming.after_gap()), (0, 4, 0b101));
        assert_eq!(read(&mut incoming), b"");
        assert!(incoming.keep(0, b"a"));
        assert_eq!((incoming.expected(), incoming.after_gap()), (2, 0b1));
        assert_eq!(read(&mut incoming), b"ab");
        assert_eq!(incoming.limit(), 6);
    }

    #[test]
    fn nothing_comes_twice_or_beyond_the_window() {
        let mut incoming = Incoming::<4, 12>::new();
        assert!(incoming.keep(0, b"a"));
        assert!(!incoming.keep(0, b"a")); // not yet read
        assert_eq!(read(&mut incoming), b"a");
        assert!(!incoming.keep(0, b"a")); // read
        assert!(!incoming.keep(5, b"f")); // 1 to 4
        assert!(!incoming.keep(1, b"longer than twelve"));
        assert!(!incoming.keep(1, b""));
        assert_eq!(incoming.expected(), 1);
    }

    #[test]
    fn numbers_go_round() {
        let mut incoming = Incoming::<4, 12>::new();
        for sequence in (0..=255).cycle().take(1000) {
            assert!(incoming.keep(sequence, &[sequence]));
            assert_eq!(read(&mut incoming), [sequence]);
        }
    }
}
