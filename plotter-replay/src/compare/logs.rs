//! [`compare`]: two logs, byte by byte.

use super::difference::{Comparison, FirstDifference, LaneSummary, Place};
use super::lane::{Item, Lane};
use super::{Decoder, difference};
use crate::log::{Event, Header, Record};
use core::time::Duration;
use std::collections::VecDeque;

/// How two logs are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct CompareSettings {
    /// How far times may be off.
    pub tolerance: Duration,
    /// Records that the first difference shows before and after the place.
    pub context: usize,
}

impl CompareSettings {
    /// The same with another [`CompareSettings::tolerance`].
    #[must_use]
    pub const fn with_tolerance(self, tolerance: Duration) -> Self {
        Self { tolerance, ..self }
    }

    /// The same with another [`CompareSettings::context`].
    #[must_use]
    pub const fn with_context(self, context: usize) -> Self {
        Self { context, ..self }
    }
}

impl Default for CompareSettings {
    /// Exact, ten records either side.
    fn default() -> Self {
        Self { tolerance: Duration::ZERO, context: 10 }
    }
}

/// The lanes: bytes of either direction, and each kind of what is beside the line.
const LANES: [&str; 8] = [
    "host bytes",
    "controller bytes",
    "edges",
    "duty cycles",
    "switches",
    "emergency stops",
    "moves of the pen",
    "targets taken",
];

/// Compares two logs: bytes with bytes whether they were written down one by one or together, and all else by
/// its kind. Notes are for people and not compared. After a difference both are brought together again, so
/// that a lost byte is one place and not all that follows.
///
/// Each log is gone through twice, the second time for what was round the first difference; so each is a
/// function that begins it anew. Memory is bounded.
///
/// ```
/// # use plotter_replay::{CompareSettings, compare::compare};
/// # use plotter_replay::log::{Event, Header, Record};
/// let said = |time, bytes: &[u8]| Record::at_us(time, Event::Controller(bytes.to_vec()));
/// let (left, right) = (vec![said(40, b"131")], vec![said(40, b"1"), said(40, b"41")]);
/// let comparison = compare(&Header::new(), || left.clone(), || right.clone(), CompareSettings::default());
/// let first = comparison.first.unwrap();
/// assert_eq!((first.lane, first.index), ("controller bytes", 1));
/// ```
pub fn compare<A: IntoIterator<Item = Record>, B: IntoIterator<Item = Record>>(
    header: &Header,
    left: impl Fn() -> A,
    right: impl Fn() -> B,
    settings: CompareSettings,
) -> Comparison {
    let mut lanes = vec![Lane::default(); LANES.len()];
    let (mut a, mut b) = ((0_u64..).zip(left()).peekable(), (0_u64..).zip(right()).peekable());
    // Both in the order of their times, so that neither gets far ahead.
    loop {
        let side = match (a.peek(), b.peek()) {
            (None, None) => break,
            (Some(_), None) => 0,
            (None, Some(_)) => 1,
            (Some((_, left)), Some((_, right))) => usize::from(right.time < left.time),
        };
        let next = if side == 0 { a.next() } else { b.next() };
        if let Some((index, record)) = next {
            push(&mut lanes, side, index, record, settings.tolerance);
        }
    }
    for lane in &mut lanes {
        lane.settle(settings.tolerance, true);
    }
    let time = |entries: &[Option<_>; 2]| entries.iter().flatten().map(|e: &super::lane::Entry| e.time).min();
    let first = lanes
        .iter()
        .zip(LANES)
        .filter_map(|(lane, name)| Some((lane.tally.first.as_ref()?, name)))
        .min_by_key(|(entries, _)| time(entries));
    let first = first.map(|(entries, lane)| {
        let [a, b] = entries;
        let record = |entry: &Option<super::lane::Entry>| entry.as_ref().map(|entry| entry.record);
        let at = time(entries).unwrap_or(Duration::ZERO);
        let index = a.iter().chain(b).map(|entry| entry.index).min().unwrap_or(0);
        FirstDifference {
            time: at,
            lane,
            index,
            left: place(a, header, left(), record(a), at, settings.context),
            right: place(b, header, right(), record(b), at, settings.context),
        }
    });
    let summaries = lanes
        .iter()
        .zip(LANES)
        .map(|(lane, name)| LaneSummary {
            lane: name,
            equal: lane.tally.equal,
            off_time: lane.tally.off_time,
            most_off: lane.tally.most_off,
            places: lane.tally.places,
            only_left: lane.tally.only.first().copied().unwrap_or(0),
            only_right: lane.tally.only.last().copied().unwrap_or(0),
        })
        .filter(|summary| *summary != LaneSummary { lane: summary.lane, ..LaneSummary::default() })
        .collect();
    Comparison { first, lanes: summaries }
}

fn push(lanes: &mut [Lane], side: usize, index: u64, record: Record, tolerance: Duration) {
    let time = record.time;
    let mut one = |lane: usize, item: Item| {
        if let Some(lane) = lanes.get_mut(lane) {
            lane.push(side, index, time, item);
            lane.settle(tolerance, false);
        }
    };
    match record.event {
        Event::Host(bytes) => bytes.into_iter().for_each(|byte| one(0, Item::Byte(byte))),
        Event::Controller(bytes) => bytes.into_iter().for_each(|byte| one(1, Item::Byte(byte))),
        Event::Edge { axis, sign } => one(2, Item::Edge(axis, sign)),
        Event::Drive { axis, duty } => one(3, Item::Drive(axis, duty)),
        Event::Switch { name, pressed } => one(4, Item::Switch(name, pressed)),
        Event::Estop(pressed) => one(5, Item::Estop(pressed)),
        Event::Pen(pen) => one(6, Item::Pen(pen)),
        Event::Target { x, y } => one(7, Item::Target(x, y)),
        Event::Note(_) => {}
    }
}

/// What a log has at a record, or where the time `at` would be, and what is round it.
fn place(
    entry: &Option<super::lane::Entry>,
    header: &Header,
    records: impl IntoIterator<Item = Record>,
    record: Option<u64>,
    at: Duration,
    context: usize,
) -> Place {
    let mut decoder = Decoder::new(header);
    let mut around: VecDeque<(u64, String)> = VecDeque::new();
    let mut after = None;
    for (index, one) in (0_u64..).zip(records) {
        let words = decoder.words(&one);
        let is_here = match record {
            Some(record) => index == record,
            None => after.is_none() && one.time > at,
        };
        if after.is_none() && !is_here && around.len() >= context {
            around.pop_front();
        }
        if is_here {
            // A record that is there is in the middle; where none is, the next one is already after it.
            after = Some(context.saturating_add(usize::from(record.is_some())));
        }
        if after == Some(0) {
            break;
        }
        around.push_back((index, difference::line(&one, &words)));
        after = after.map(|left| left.saturating_sub(1));
    }
    Place {
        what: entry.as_ref().map(|entry| (entry.item.to_string(), entry.time)),
        record,
        around: around.into(),
    }
}
