//! [`Outgoing`]: payloads on their way out, until the other side has them.

use super::round_trip::RoundTrip;
use core::time::Duration;

/// A payload on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Slot<const PAYLOAD: usize> {
    bytes: [u8; PAYLOAD],
    length: u8,
    /// Times sent.
    sent: u8,
    /// Number of its last transmission among all.
    order: u32,
    /// When that was through; the end of time while it is not.
    through: Duration,
    lost: bool,
    came: bool,
}

/// At most `WINDOW` payloads that are not known to have come; into the last one more can be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Outgoing<const WINDOW: usize, const PAYLOAD: usize> {
    slots: [Slot<PAYLOAD>; WINDOW],
    /// The oldest number that is not known to have come.
    first: u8,
    /// The number that is written into.
    open: u8,
    /// The first number that may not be sent yet.
    limit: u8,
    transmissions: u32,
    /// How long payloads are made, and can be made at most.
    payload: u8,
    most_payload: u8,
    round_trip: Option<RoundTrip>,
    /// How often in a row nothing came.
    failures: u8,
}

/// Shortest payload that frames are made down to where many are lost.
pub(super) const LEAST_PAYLOAD: u8 = 12;

impl<const WINDOW: usize, const PAYLOAD: usize> Outgoing<WINDOW, PAYLOAD> {
    #[expect(clippy::cast_possible_truncation, reason = "a link's window is 32 at most, its payload 240")]
    const SIZES: (u8, u8) = (WINDOW as u8, PAYLOAD as u8);

    pub(super) const fn new() -> Self {
        let empty = Slot {
            bytes: [0; PAYLOAD],
            length: 0,
            sent: 0,
            order: 0,
            through: Duration::ZERO,
            lost: false,
            came: false,
        };
        Self {
            slots: [empty; WINDOW],
            first: 0,
            open: 0,
            limit: 0,
            transmissions: 0,
            payload: Self::SIZES.1,
            most_payload: Self::SIZES.1,
            round_trip: None,
            failures: 0,
        }
    }

    fn slot(&mut self, sequence: u8) -> Option<&mut Slot<PAYLOAD>> {
        self.slots.get_mut(usize::from(sequence) % WINDOW)
    }

    /// The numbers that wait for their answer, oldest first.
    fn waiting(&self) -> impl Iterator<Item = u8> + use<WINDOW, PAYLOAD> {
        let first = self.first;
        (0..self.open.wrapping_sub(first)).map(move |ahead| first.wrapping_add(ahead))
    }

    const fn has_open_slot(&self) -> bool {
        self.open.wrapping_sub(self.first) < Self::SIZES.0
    }

    /// The other side takes payloads of this length, and before anything has come this many of them.
    pub(super) fn agree(&mut self, window: u8, payload: u8) {
        self.most_payload = Self::SIZES.1.min(payload.max(LEAST_PAYLOAD));
        self.payload = self.payload.min(self.most_payload);
        if self.first == 0 && self.limit == 0 {
            self.limit = window.min(32);
        }
    }

    /// Appends a byte to the stream, if there is room.
    pub(super) fn write(&mut self, byte: u8) -> bool {
        if !self.has_open_slot() {
            return false;
        }
        let payload = self.payload;
        let Some(slot) = self.slot(self.open) else { return false };
        let Some(place) = slot.bytes.get_mut(usize::from(slot.length)) else { return false };
        *place = byte;
        slot.length += 1;
        if slot.length >= payload {
            self.close();
        }
        true
    }

    /// The open slot takes no more.
    fn close(&mut self) {
        self.open = self.open.wrapping_add(1);
        self.clear_open();
    }

    fn clear_open(&mut self) {
        if self.has_open_slot()
            && let Some(slot) = self.slot(self.open)
        {
            (slot.length, slot.sent, slot.lost, slot.came) = (0, 0, false, false);
        }
    }

    /// How many bytes are sure to find room.
    pub(super) fn room(&self) -> usize {
        let free = Self::SIZES.0.saturating_sub(self.open.wrapping_sub(self.first));
        let open = self.slots.get(usize::from(self.open) % WINDOW).filter(|_| free > 0);
        let used = open.map_or(0, |slot| usize::from(slot.length));
        (usize::from(free) * usize::from(self.payload)).saturating_sub(used)
    }

    /// Whether all that was written has come.
    pub(super) fn is_empty(&self) -> bool {
        let open = self.slots.get(usize::from(self.open) % WINDOW);
        self.first == self.open && open.is_none_or(|slot| slot.length == 0)
    }

    /// The number to be sent next, and whether it was sent before: what is lost or late, then what is new.
    pub(super) fn due(&mut self, now: Duration, late_after: Duration) -> Option<(u8, bool)> {
        for sequence in self.waiting() {
            let first = self.first;
            let Some(slot) = self.slot(sequence) else { continue };
            let late = now.saturating_sub(slot.through) >= late_after;
            if slot.sent > 0 && !slot.came && (slot.lost || late) {
                if !slot.lost && sequence == first {
                    self.failures = self.failures.saturating_add(1).min(8);
                }
                return Some((sequence, true));
            }
        }
        let limit = self.limit;
        let may = |sequence: u8| limit.wrapping_sub(sequence).wrapping_sub(1) < 127;
        let unsent = self.waiting().find(|&sequence| self.slot(sequence).is_some_and(|slot| slot.sent == 0));
        if let Some(sequence) = unsent {
            return may(sequence).then_some((sequence, false));
        }
        let open = self.open;
        if may(open) && self.has_open_slot() && self.slot(open).is_some_and(|slot| slot.length > 0) {
            self.close();
            return Some((open, false));
        }
        None
    }

    /// The payload of a number, which is sent now.
    pub(super) fn send(&mut self, sequence: u8) -> &[u8] {
        self.transmissions = self.transmissions.wrapping_add(1);
        let order = self.transmissions;
        let Some(slot) = self.slot(sequence) else { return &[] };
        slot.sent = slot.sent.saturating_add(1);
        (slot.lost, slot.order, slot.through) = (false, order, Duration::MAX);
        slot.bytes.get(..usize::from(slot.length)).unwrap_or_default()
    }

    /// The last byte of a number's frame is out.
    pub(super) fn through(&mut self, now: Duration, sequence: u8) {
        if let Some(slot) = self.slot(sequence) {
            slot.through = now;
        }
    }

    /// A number's frame was cut on its way out.
    pub(super) fn cut(&mut self, now: Duration, sequence: u8) {
        if let Some(slot) = self.slot(sequence) {
            (slot.through, slot.lost) = (now, true);
        }
    }

    /// After how long a frame counts as late; longer each time that nothing came.
    pub(super) fn late_after(&self, least: Duration, most: Duration) -> Duration {
        let learned = self.round_trip.map_or(least.saturating_mul(4), RoundTrip::late_after);
        learned.max(least).saturating_mul(1 << self.failures.min(8)).min(most)
    }

    /// When the first of them is late.
    pub(super) fn late_at(&self, late_after: Duration) -> Option<Duration> {
        let slots = self.waiting().filter_map(|sequence| self.slots.get(usize::from(sequence) % WINDOW));
        slots
            .filter(|slot| slot.sent > 0 && !slot.came)
            .map(|slot| if slot.lost { Duration::ZERO } else { slot.through.saturating_add(late_after) })
            .min()
    }

    /// The other side says up to where all has come, which came after the gap there, and up to where it takes
    /// more.
    pub(super) fn acknowledged(&mut self, now: Duration, until: u8, after_gap: u32, limit: u8) {
        if until.wrapping_sub(self.first) > self.open.wrapping_sub(self.first) {
            return; // an old one
        }
        if limit.wrapping_sub(self.limit) < 128 {
            self.limit = limit;
        }
        let mut latest = None;
        let before = self.first;
        for sequence in self.waiting() {
            let ahead = sequence.wrapping_sub(until).wrapping_sub(1);
            let has_come = until.wrapping_sub(sequence).wrapping_sub(1) < 128
                || (ahead < 32 && after_gap >> ahead & 1 == 1);
            let Some(slot) = self.slot(sequence).filter(|slot| has_come && !slot.came && slot.sent > 0)
            else {
                continue;
            };
            slot.came = true;
            // Which of several transmissions came, nobody knows (P. Karn, C. Partridge, 1987).
            if slot.sent == 1 {
                let (order, took) = (slot.order, now.saturating_sub(slot.through));
                latest = latest.max(Some(order));
                self.round_trip = Some(RoundTrip::after(self.round_trip, took));
                self.payload = self.payload.saturating_add(1).min(self.most_payload);
            }
        }
        let was_full = !self.has_open_slot();
        self.first = until;
        if before != until {
            self.failures = 0;
            if was_full {
                self.clear_open();
            }
        }
        // What was sent before one that came, and did not come, is lost: a line keeps its order.
        let Some(latest) = latest else { return };
        for sequence in self.waiting() {
            if let Some(slot) = self.slot(sequence)
                && slot.sent > 0
                && !slot.came
                && !slot.lost
                && slot.through != Duration::MAX
                && latest.wrapping_sub(slot.order).wrapping_sub(1) < u32::MAX / 2
            {
                slot.lost = true;
                self.payload = (self.payload / 4 * 3).max(LEAST_PAYLOAD);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);
    const LATE: Duration = Duration::from_millis(100);

    fn sent(outgoing: &mut Outgoing<4, 12>, now: Duration) -> Option<std::vec::Vec<u8>> {
        let (sequence, _) = outgoing.due(now, LATE)?;
        let payload = outgoing.send(sequence).to_vec();
        outgoing.through(now, sequence);
        Some(payload)
    }

    fn opened() -> Outgoing<4, 12> {
        let mut outgoing = Outgoing::new();
        outgoing.agree(4, 12);
        outgoing
    }

    fn write(outgoing: &mut Outgoing<4, 12>, bytes: &[u8]) -> usize {
        bytes.iter().take_while(|&&byte| outgoing.write(byte)).count()
    }

    #[test]
    fn what_is_written_goes_together_until_it_is_sent() {
        let mut outgoing = opened();
        assert_eq!(write(&mut outgoing, b"ab"), 2);
        assert_eq!(write(&mut outgoing, b"c"), 1);
        assert_eq!(sent(&mut outgoing, MS).unwrap(), b"abc");
        assert_eq!(sent(&mut outgoing, MS), None);
        assert!(!outgoing.is_empty());
        outgoing.acknowledged(MS * 2, 1, 0, 5);
        assert!(outgoing.is_empty());
    }

    #[test]
    fn a_window_holds_so_much() {
        let mut outgoing = opened();
        assert_eq!(outgoing.room(), 48);
        assert_eq!(write(&mut outgoing, &[7; 100]), 48);
        assert_eq!(outgoing.room(), 0);
        for _ in 0..4 {
            assert_eq!(sent(&mut outgoing, MS).unwrap().len(), 12);
        }
        assert_eq!(sent(&mut outgoing, MS), None);
        outgoing.acknowledged(MS * 2, 2, 0, 6);
        assert_eq!(write(&mut outgoing, &[7; 100]), 24);
    }

    #[test]
    fn what_came_before_one_that_came_is_lost_at_once_and_the_last_one_after_a_time() {
        let mut outgoing = opened();
        write(&mut outgoing, b"aaaaaaaaaaaabbbbbbbbbbbbc");
        for _ in 0..3 {
            sent(&mut outgoing, MS);
        }
        outgoing.acknowledged(MS * 2, 0, 0b1, 4); // 1 came, 0 did not
        assert_eq!(sent(&mut outgoing, MS * 2).unwrap(), b"aaaaaaaaaaaa");
        assert_eq!(sent(&mut outgoing, MS * 3), None);
        assert_eq!(outgoing.late_at(LATE), Some(MS * 101)); // 2
        assert_eq!(sent(&mut outgoing, MS * 101).unwrap(), b"c");
    }

    #[test]
    fn nothing_goes_beyond_what_the_other_side_takes() {
        let mut outgoing = opened();
        write(&mut outgoing, &[7; 48]);
        for _ in 0..4 {
            sent(&mut outgoing, MS);
        }
        outgoing.acknowledged(MS, 4, 0, 4); // has all, has read none
        write(&mut outgoing, b"more");
        assert_eq!(sent(&mut outgoing, MS), None);
        outgoing.acknowledged(MS, 4, 0, 5);
        assert_eq!(sent(&mut outgoing, MS).unwrap(), b"more");
    }

    #[test]
    fn an_acknowledgement_that_cannot_be_changes_nothing() {
        let mut outgoing = opened();
        write(&mut outgoing, b"a");
        sent(&mut outgoing, MS);
        let before = outgoing.clone();
        outgoing.acknowledged(MS, 3, u32::MAX, 9);
        outgoing.acknowledged(MS, 250, 0, 9);
        assert_eq!(outgoing, before);
    }
}
