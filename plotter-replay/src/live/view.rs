//! [`View`]: what is to be seen of a session, in bounded memory.

use super::State;
use super::progress::{Pace, Plan};
use crate::draw::page::{DRAWN, Trail, TrailPoint, pulse_times};
use crate::log::{Event, Record};
use crate::{PlotterSettings, VirtualPlotter};
use core::time::Duration;
use plotter_motion::{Pen, Point, Segment, StepPoint};
use serde_json::{Value, json};
use std::collections::VecDeque;

/// Points of the way that are kept.
const MOST_WAY_POINTS: usize = 20_000;
/// Samples of the response that are kept: a minute of them.
const MOST_SAMPLES: usize = 3_000;
/// Time over which a speed is measured, as published for the marking board.
const SPEED_OVER: Duration = Duration::from_millis(100);
/// Edges after which the way is looked at.
const EDGES_AT_ONCE: u32 = 64;
/// Messages that are kept.
const MOST_MESSAGES: usize = 50;

/// The response of the machine at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) time: Duration,
    pub(super) at: Point,
    /// The nearest place on the line that is followed.
    pub(super) line: Option<Point>,
    pub(super) target: Option<Point>,
}

/// How far what was asked by hand is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HandProgress {
    /// What was asked by hand and came to the session, done or refused.
    pub taken: u64,
    /// Why the last of it was refused, if it was.
    pub refused: Option<String>,
    /// Whether the machine rests where it was led.
    pub rests: bool,
    /// Where it says to be, mm on the sheet.
    pub at: Point,
}

impl HandProgress {
    pub(super) fn took(&mut self, refused: Option<String>) {
        self.taken = self.taken.saturating_add(1);
        (self.refused, self.rests) = (refused, false);
    }
}

/// What a host of lines tells of its machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Hosted {
    /// Where the machine said to be.
    pub(super) at: Option<Point>,
    pub(super) is_down: bool,
    pub(super) feed_percent: u8,
    /// How long the rest of the drawing takes.
    pub(super) rest: Option<Duration>,
    /// How far along the drawing what is done goes, mm.
    pub(super) way_mm: Option<f64>,
}

/// Everything that a page or a terminal shows.
#[derive(Debug)]
pub(super) struct View {
    pub(super) state: State,
    pub(super) plotter: VirtualPlotter,
    pub(super) way: Trail,
    pub(super) samples: VecDeque<Sample>,
    /// Samples that are gone from the front.
    pub(super) samples_gone: u64,
    pub(super) messages: VecDeque<(Duration, String)>,
    pub(super) plan: Option<Plan>,
    pub(super) done: Plan,
    pub(super) reached: u64,
    pub(super) pace: Pace,
    pub(super) now: Duration,
    /// Signed share of the supply on each motor, if it is known.
    pub(super) duty: Option<[f64; 2]>,
    pub(super) error_mm: f64,
    pub(super) worst_mm: f64,
    /// What became of the recording.
    pub(super) recording: String,
    /// What a host of lines tells of its machine.
    pub(super) hosted: Option<Hosted>,
    /// What a person has to do, if anything.
    pub(super) wants: String,
    /// Moves of what is done by hand: done, and all.
    pub(super) by_hand: Option<(u64, u64)>,
    /// How far what was asked by hand is.
    pub(super) hand: HandProgress,
    /// Counts how often the way was cleared.
    pub(super) cleared: u32,
    from: Point,
    tolerance_mm: f64,
    /// Edges since the way was looked at last.
    edges: u32,
}

/// What a browser has already.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cursor {
    version: Option<(u32, u32)>,
    way: usize,
    samples: u64,
}

impl View {
    pub(super) fn new(settings: PlotterSettings, state: State, plan: Option<Plan>) -> Self {
        let tolerance_mm = 0.5 * settings.x_mm_per_pulse.max(settings.y_mm_per_pulse);
        let mut plotter = VirtualPlotter::new(settings);
        if state == State::Ready {
            // A log is drawn with the pen down until it says otherwise; a drawing that waits for its start is
            // not.
            plotter.push(&Record::at_us(0, Event::Pen(Pen::Up)));
        }
        Self {
            from: plotter.position(),
            state,
            plotter,
            way: Trail::new(tolerance_mm, MOST_WAY_POINTS),
            samples: VecDeque::new(),
            samples_gone: 0,
            messages: VecDeque::new(),
            plan,
            done: Plan::default(),
            reached: 0,
            pace: Pace::default(),
            now: Duration::ZERO,
            duty: None,
            error_mm: 0.0,
            worst_mm: 0.0,
            recording: String::new(),
            hosted: None,
            wants: String::new(),
            by_hand: None,
            hand: HandProgress::default(),
            cleared: 0,
            tolerance_mm,
            edges: 0,
        }
    }

    /// Takes what happened on the line.
    pub(super) fn push(&mut self, record: &Record) {
        self.now = record.time;
        self.plotter.push(record);
        match record.event {
            Event::Controller(_) => {}
            // The way of a machine that tells its edges only: not each by itself.
            Event::Edge { .. } if self.edges < EDGES_AT_ONCE => {
                self.edges += 1;
                return;
            }
            Event::Edge { .. } => {}
            _ => return,
        }
        self.edges = 0;
        let noted = self.plotter.take_noted();
        let settings = *self.plotter.settings();
        for anomaly in noted.anomalies {
            self.message(anomaly.time, anomaly.kind.to_string());
        }
        for leg in &noted.legs {
            self.from = settings.to_sheet(leg.from);
            let line = leg.target.map(|target| Segment::new(self.from, settings.to_sheet(target)));
            for (point, at_us) in leg.points.iter().zip(pulse_times(&leg.points)) {
                let at = settings.to_sheet(point.at);
                self.way.push(TrailPoint {
                    at_us,
                    x_mm: at.x,
                    y_mm: at.y,
                    state: if leg.pen == Pen::Down { DRAWN } else { 0 },
                });
                if let Some(line) = line {
                    self.error_mm = line.distance(at);
                    if leg.pen == Pen::Down {
                        self.worst_mm = self.worst_mm.max(self.error_mm);
                    }
                }
            }
            if leg.reached.is_some() {
                self.from = leg.target.map_or(self.from, |target| settings.to_sheet(target));
            }
        }
    }

    /// Where the pen is: as the machine says, where it does.
    pub(super) fn position(&self) -> Point {
        self.hosted.as_ref().and_then(|hosted| hosted.at).unwrap_or_else(|| self.plotter.position())
    }

    pub(super) fn is_down(&self) -> bool {
        match &self.hosted {
            Some(hosted) => hosted.is_down,
            None => self.plotter.pen() == Pen::Down,
        }
    }

    pub(super) fn message(&mut self, time: Duration, text: String) {
        if self.messages.len() >= MOST_MESSAGES {
            self.messages.pop_front();
        }
        self.messages.push_back((time, text));
    }

    pub(super) fn sample(&mut self, now: Duration) {
        self.now = now;
        let (at, target) = (self.position(), self.plotter.next_target());
        let line = target.map(|target| Segment::new(self.from, target).nearest(at));
        if self.samples.len() >= MOST_SAMPLES {
            self.samples.pop_front();
            self.samples_gone = self.samples_gone.saturating_add(1);
        }
        self.samples.push_back(Sample { time: now, at, line, target });
    }

    /// Forgets what was drawn.
    pub(super) fn clear(&mut self) {
        self.way = Trail::new(self.tolerance_mm, MOST_WAY_POINTS);
        self.worst_mm = 0.0;
        self.cleared = self.cleared.wrapping_add(1);
    }

    /// The place (0, 0) of the motors lies here on the sheet from now on; what was drawn before is forgotten,
    /// on the screen only.
    pub(super) fn set_origin(&mut self, p1: Point) {
        self.plotter.set_p1(p1);
        self.from = self.plotter.position();
        self.clear();
    }

    /// Speed of both motors, mm/s, over the last tenth of a second.
    pub(super) fn speed_mm_s(&self) -> [f64; 2] {
        let Some(last) = self.samples.back() else {
            return [0.0; 2];
        };
        let since = last.time.saturating_sub(SPEED_OVER);
        let Some(first) = self.samples.iter().rev().find(|sample| sample.time <= since) else {
            return [0.0; 2];
        };
        let time_s = last.time.saturating_sub(first.time).as_secs_f64();
        [(last.at.x - first.at.x) / time_s, (last.at.y - first.at.y) / time_s]
    }

    pub(super) fn remaining(&self) -> Option<Duration> {
        match &self.hosted {
            Some(hosted) => hosted.rest,
            None => self.pace.remaining(self.plan?, self.done),
        }
    }

    /// What is new for a browser that has what `cursor` says.
    pub(super) fn update(&self, cursor: &mut Cursor) -> Value {
        let version = (self.way.rounds(), self.cleared);
        let is_afresh = cursor.version.replace(version) != Some(version);
        if is_afresh {
            cursor.way = 0;
        }
        let points = self.way.settled();
        let um = |mm: f64| libm::round(mm * 1e3);
        let flat = |point: &TrailPoint| [um(point.x_mm), um(point.y_mm), f64::from(point.state)];
        let way: Vec<f64> = points.iter().skip(cursor.way).flat_map(flat).collect();
        cursor.way = points.len();
        let known = usize::try_from(cursor.samples.saturating_sub(self.samples_gone)).unwrap_or(usize::MAX);
        let samples: Vec<Value> = self.samples.iter().skip(known).map(sample_json).collect();
        cursor.samples = self.samples_gone.saturating_add(self.samples.len() as u64);
        let (at, next) = (self.position(), self.plotter.next_target());
        let p1 = self.plotter.settings().p1;
        json!({
            "state": self.state.name(),
            "failure": match &self.state { State::Failed(why) => Some(why), _ => None },
            "time_s": self.now.as_secs_f64(),
            "at": [at.x, at.y],
            "counts": counts(self.plotter.raw_counts()),
            "next": next.map(|next| [next.x, next.y]),
            "pen": if self.is_down() { "down" } else { "up" },
            "wants": self.wants,
            "by_hand": self.by_hand.map(|(done, all)| [done, all]),
            "p1": [p1.x, p1.y],
            "way_mm": self.hosted.as_ref().and_then(|hosted| hosted.way_mm),
            "feed_percent": self.hosted.as_ref().map(|hosted| hosted.feed_percent),
            "speed_mm_s": self.speed_mm_s(),
            "duty": self.duty,
            "error_mm": self.error_mm,
            "worst_mm": self.worst_mm,
            "targets": self.plan.map(|plan| plan.targets),
            "sent": self.done.targets,
            "reached": self.reached,
            "remaining_s": self.remaining().map(|rest| rest.as_secs_f64()),
            "anomalies": self.plotter.anomaly_count(),
            "recording": self.recording,
            "messages": self.messages.iter().map(|(time, text)| json!([time.as_secs_f64(), text])).collect::<Vec<_>>(),
            "afresh": is_afresh,
            "way": way,
            "last": self.way.last().map(|point| flat(&point)),
            "samples": samples,
        })
    }
}

fn counts(at: StepPoint) -> [i32; 2] {
    [at.x, at.y]
}

fn sample_json(sample: &Sample) -> Value {
    let pair = |at: Point| [at.x, at.y];
    json!([sample.time.as_secs_f64(), pair(sample.at), sample.line.map(pair), sample.target.map(pair)])
}
