//! Outcome of comparing two logs.

use crate::log::{Event, Record, write_line};
use core::fmt;
use core::time::Duration;

/// Result of comparing two logs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// The first difference; `None` if there is none.
    pub first: Option<FirstDifference>,
    /// Equal and different records, for each kind that occurs.
    pub lanes: Vec<LaneSummary>,
}

/// The first place where two logs differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FirstDifference {
    /// When, by the log that is earlier.
    pub time: Duration,
    /// In what: `controller bytes`, `edges`, ...
    pub lane: &'static str,
    /// The how manieth of them it is, from 0: for bytes, the byte's index in its direction.
    pub index: u64,
    /// Place in the first log.
    pub left: Place,
    /// Place in the second log.
    pub right: Place,
}

/// A place in a log, with its records.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// In words, and when; `None` if it has nothing more.
    pub what: Option<(String, Duration)>,
    /// The record, from 0.
    pub record: Option<u64>,
    /// Records round it with their index, each as its line and what it says.
    pub around: Vec<(u64, String)>,
}

/// How much of one kind is equal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LaneSummary {
    /// The kind.
    pub lane: &'static str,
    /// How many are equal.
    pub equal: u64,
    /// How many are equal but for their time.
    pub off_time: u64,
    /// Greatest difference of the times of two that are equal.
    pub most_off: Duration,
    /// Places where one log has what the other has not.
    pub places: u64,
    /// How many only the first log has, there.
    pub only_left: u64,
    /// How many only the second has.
    pub only_right: u64,
}

impl Comparison {
    /// Whether there is no difference.
    #[must_use]
    pub const fn is_equal(&self) -> bool {
        self.first.is_none()
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.first {
            None => write!(f, "equal")?,
            Some(first) => {
                first.fmt(f)?;
                write!(f, "\nin all:")?;
            }
        }
        if self.lanes.is_empty() {
            write!(f, ", and empty")?;
        }
        for lane in &self.lanes {
            write!(f, "\n  {lane}")?;
        }
        Ok(())
    }
}

impl fmt::Display for FirstDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, lane, index, .. } = self;
        writeln!(f, "first difference at {} us: {lane}, index {index}", time.as_micros())?;
        writeln!(f, "  first:  {}", self.left)?;
        write!(f, "  second: {}", self.right)?;
        for (name, place) in [("first", &self.left), ("second", &self.right)] {
            write!(f, "\nround it in the {name}:")?;
            if place.around.is_empty() {
                write!(f, " nothing")?;
            }
            for (index, line) in &place.around {
                let mark = if Some(*index) == place.record { '>' } else { ' ' };
                write!(f, "\n  {mark} {index:>6}  {line}")?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.what {
            None => write!(f, "nothing more"),
            Some((what, time)) => write!(f, "{what} at {} us", time.as_micros()),
        }
    }
}

impl fmt::Display for LaneSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} equal", self.lane, self.equal)?;
        if self.off_time > 0 {
            write!(f, ", {} at another time", self.off_time)?;
        }
        if self.most_off > Duration::ZERO {
            write!(f, ", up to {} us apart", self.most_off.as_micros())?;
        }
        if self.places > 0 {
            let plural = if self.places == 1 { "" } else { "s" };
            write!(
                f,
                ", different in {} place{plural}: {} only in the first, {} only in the second",
                self.places, self.only_left, self.only_right
            )?;
        }
        Ok(())
    }
}

/// A record as its line in the log without the checksum, long runs of bytes shortened, and what it says.
pub(crate) fn line(record: &Record, words: &str) -> String {
    const MOST: usize = 16;
    let (event, more) = match &record.event {
        Event::Host(bytes) if bytes.len() > MOST => {
            (Event::Host(bytes.iter().take(MOST).copied().collect()), " ...")
        }
        Event::Controller(bytes) if bytes.len() > MOST => {
            (Event::Controller(bytes.iter().take(MOST).copied().collect()), " ...")
        }
        event => (event.clone(), ""),
    };
    let mut line = Vec::new();
    write_line(&mut line, u64::try_from(record.time.as_micros()).unwrap_or(u64::MAX), &event.view());
    let line = String::from_utf8_lossy(&line);
    let covered = line.rsplit_once(" *").map_or(&*line, |(covered, _)| covered);
    let gap = if words.is_empty() { "" } else { "    " };
    format!("{covered}{more}{gap}{words}")
}
