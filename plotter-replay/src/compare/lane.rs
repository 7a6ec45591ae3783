//! [`Lane`]: two sequences of one kind, compared one by one, and brought together again after each
//! difference.

use crate::log::SwitchName;
use core::fmt;
use core::time::Duration;
use plotter_motion::{Axis, Direction, Pen};
use std::collections::VecDeque;

use super::decode::pulse;

/// How far ahead a sequence is searched for where it goes on like the other.
const LOOK_AHEAD: usize = 128;
/// Entries in a row that must be equal for that.
const SURE: usize = 4;
/// Entries that wait for the other side.
const MOST_WAITING: usize = 1 << 16;

/// One thing that happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Item {
    Byte(u8),
    Edge(Axis, Direction),
    Drive(Axis, i32),
    Switch(SwitchName, bool),
    Estop(bool),
    Pen(Pen),
    Target(i32, i32),
}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |axis: &Axis| if *axis == Axis::X { 'x' } else { 'y' };
        match self {
            Self::Byte(byte) => {
                write!(f, "byte 0x{byte:02x}")?;
                if byte.is_ascii_graphic() { write!(f, " '{}'", char::from(*byte)) } else { Ok(()) }
            }
            Self::Edge(axis, sign) => write!(f, "edge {}", pulse(*axis, *sign)),
            Self::Drive(axis, duty) => write!(f, "drive {} {duty}", name(axis)),
            Self::Switch(switch, pressed) => write!(f, "switch {} {}", switch.as_str(), u8::from(*pressed)),
            Self::Estop(pressed) => write!(f, "estop {}", u8::from(*pressed)),
            Self::Pen(Pen::Up) => write!(f, "pen up"),
            Self::Pen(Pen::Down) => write!(f, "pen down"),
            Self::Target(x, y) => write!(f, "target {x} {y}"),
        }
    }
}

/// An item with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    /// The record, from 0.
    pub(super) record: u64,
    /// The how manieth of its lane it is, from 0: for bytes, the byte's index in its direction.
    pub(super) index: u64,
    pub(super) time: Duration,
    pub(super) item: Item,
}

/// Result of comparing one lane.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub(super) equal: u64,
    /// Equal but for their time.
    pub(super) off_time: u64,
    pub(super) most_off: Duration,
    /// Places where one side has what the other has not.
    pub(super) places: u64,
    /// How much one side has there and the other.
    pub(super) only: [u64; 2],
    /// The first place: what either side has there.
    pub(super) first: Option<[Option<Entry>; 2]>,
}

/// Two sequences of one kind.
#[derive(Clone, Debug, Default)]
pub(super) struct Lane {
    waiting: [VecDeque<Entry>; 2],
    counts: [u64; 2],
    pub(super) tally: Tally,
}

impl Lane {
    /// Takes the next item of a side (0 or 1).
    pub(super) fn push(&mut self, side: usize, record: u64, time: Duration, item: Item) {
        let (Some(waiting), Some(count)) = (self.waiting.get_mut(side), self.counts.get_mut(side)) else {
            return;
        };
        waiting.push_back(Entry { record, index: *count, time, item });
        *count = count.saturating_add(1);
    }

    /// Compares what both have; with `over` nothing more comes.
    pub(super) fn settle(&mut self, tolerance: Duration, over: bool) {
        let [left, right] = &mut self.waiting;
        loop {
            let (Some(a), Some(b)) = (left.front(), right.front()) else {
                let lags = left.len().max(right.len()) > MOST_WAITING;
                if over && (!left.is_empty() || !right.is_empty()) {
                    let all = (left.len(), right.len());
                    skip(&mut self.tally, left, right, all);
                } else if lags {
                    // The other side is far behind, or has nothing of this kind at all.
                    let half = (left.len() / 2, right.len() / 2);
                    skip(&mut self.tally, left, right, half);
                }
                return;
            };
            if a.item == b.item {
                let off = a.time.abs_diff(b.time);
                if off > tolerance {
                    self.tally.off_time = self.tally.off_time.saturating_add(1);
                    self.tally.first.get_or_insert_with(|| [Some(a.clone()), Some(b.clone())]);
                } else {
                    self.tally.equal = self.tally.equal.saturating_add(1);
                }
                self.tally.most_off = self.tally.most_off.max(off);
                left.pop_front();
                right.pop_front();
                continue;
            }
            let enough = LOOK_AHEAD + SURE;
            if !over && (left.len() < enough || right.len() < enough) {
                let lags = left.len().max(right.len()) > MOST_WAITING;
                if !lags {
                    return;
                }
            }
            let by = meeting(left, right);
            skip(&mut self.tally, left, right, by);
        }
    }
}

/// How many to leave out on either side until both go on alike: as few as possible, and rather something else
/// on both sides than something missing on one. The same number of both, if they do not within sight.
fn meeting(left: &VecDeque<Entry>, right: &VecDeque<Entry>) -> (usize, usize) {
    let alike = |i: usize, j: usize| {
        let rest = left.len().saturating_sub(i).min(right.len().saturating_sub(j)).min(SURE);
        rest > 0 && (0..rest).all(|k| left.get(i + k).map(|e| &e.item) == right.get(j + k).map(|e| &e.item))
    };
    for most in 1..=LOOK_AHEAD {
        if alike(most, most) {
            return (most, most);
        }
        for less in 0..most {
            for by in [(most, less), (less, most)] {
                if alike(by.0, by.1) {
                    return by;
                }
            }
        }
    }
    let all = LOOK_AHEAD.min(left.len()).min(right.len()).max(1);
    (all.min(left.len()), all.min(right.len()))
}

fn skip(tally: &mut Tally, left: &mut VecDeque<Entry>, right: &mut VecDeque<Entry>, by: (usize, usize)) {
    tally.places = tally.places.saturating_add(1);
    let first = [(left.front(), by.0), (right.front(), by.1)].map(|(entry, _)| entry.cloned());
    tally.first.get_or_insert(first);
    let [only_left, only_right] = &mut tally.only;
    *only_left = only_left.saturating_add(by.0 as u64);
    *only_right = only_right.saturating_add(by.1 as u64);
    left.drain(..by.0.min(left.len()));
    right.drain(..by.1.min(right.len()));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lane(left: &str, right: &str) -> Tally {
        let mut lane = Lane::default();
        for (side, text) in [left, right].into_iter().enumerate() {
            for (time, byte) in (0..).zip(text.bytes()) {
                lane.push(side, time, Duration::from_micros(time), Item::Byte(byte));
                lane.settle(Duration::MAX, false);
            }
        }
        lane.settle(Duration::MAX, true);
        lane.tally
    }

    #[test]
    fn what_is_missing_does_not_make_all_that_follows_different() {
        let text = "131313131+2424242424+".repeat(20);
        let equal = lane(&text, &text);
        assert_eq!((equal.equal, equal.places, equal.first.is_none()), (420, 0, true));
        let mut missing = text.clone();
        missing.remove(100);
        let tally = lane(&text, &missing);
        assert_eq!((tally.places, tally.only), (1, [1, 0]));
        let more = missing.replacen("+24", "+C24", 1);
        let tally = lane(&text, &more);
        assert_eq!((tally.places, tally.only), (2, [1, 1]));
        let tally = lane(&text, "");
        assert_eq!((tally.places, tally.only), (1, [420, 0]));
        let tally = lane("1111111111", "1111211111");
        assert_eq!((tally.places, tally.only, tally.equal), (1, [1, 1], 9));
        let tally = lane(&"1".repeat(400), &"2".repeat(400));
        assert_eq!((tally.only, tally.equal), ([400, 400], 0));
    }
}
