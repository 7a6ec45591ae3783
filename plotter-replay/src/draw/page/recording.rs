//! [`RecordingPage`]: a recording as one page with a time slider.

use super::desired::Desired;
use super::envelope::{Envelope, Tally, whole};
use super::few::Few;
use super::ink_map::InkMap;
use super::numbers::packed;
use super::silence::Silences;
use super::trail::{DIFFERS, DRAWN, Trail, TrailPoint, pen_bits};
use super::{along, document, pulse_times, signed, steps};
use crate::log::{Damage, Event, Header, Record, Summary};
use crate::virtual_plotter::CountedBy;
use crate::{PlotterSettings, VirtualPlotter, date, virtual_plotter::Leg};
use core::time::Duration;
use plotter_motion::{Pen, PlotOp, Point, Segment, StepPoint, toolpath::chords};
use serde_json::{Value, json};

const BODY: &str = include_str!("assets/recording.html");
const PROGRAM: &str = include_str!("assets/recording.js");

/// Points of the way that a page holds at most, about 3 bytes each where they are many.
const MOST_WAY_POINTS: usize = 400_000;
/// Characters of the way that a page holds at most: what is more is made coarser.
const MOST_WAY_CHARACTERS: usize = 1_200_000;
/// Points of a way that is exact to the micrometre.
const FEW_POINTS: usize = 20_000;
/// Lines farther than this from what was recorded are not shown as lines, mm: the page then has a map of the
/// ink.
const MOST_LINE_ERROR_MM: f64 = 0.3;
/// Ways of more points are not shown as lines either: a browser would paint them for more than a second.
const MOST_LINE_POINTS: u64 = 40_000;
/// Points of what was meant, at most.
const MOST_DESIRED_POINTS: usize = 30_000;
/// Points of what was not drawn, at most.
const MOST_UNDRAWN_POINTS: usize = 8_000;
/// Targets whose place and time a page holds, at most.
const MOST_TARGETS: usize = 8_192;
/// Anomalies and damaged lines in the table, at most, of each.
const MOST_ROWS: usize = 400;
/// Entries of the header that are shown, and characters of each.
const MOST_FACTS: usize = 40;
const MOST_FACT_CHARS: usize = 120;
/// Pulses after which what was noted is taken over.
const TAKE_OVER_AFTER: u64 = 16_384;
/// Shortest time over which a pulse rate is one.
const LEAST_RATE_US: u64 = 10_000;

/// How a page is made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PageSettings {
    /// How far the line in the page may be from the recorded one, mm; more, and said so in the page, where a
    /// long recording would not fit otherwise. A count of the usual machine by default.
    pub tolerance_mm: f64,
    /// From what contour error on a way is marked as different from what was meant, mm; 0.1 by default, which
    /// an eye sees beside a line of 0.35 mm.
    pub mark_mm: f64,
    /// From what length on a silence of the line is a gap; half a second by default.
    pub gap_after: Duration,
}

impl PageSettings {
    /// The same with another [`PageSettings::tolerance_mm`].
    #[must_use]
    pub const fn with_tolerance_mm(self, tolerance_mm: f64) -> Self {
        Self { tolerance_mm, ..self }
    }

    /// The same with another [`PageSettings::mark_mm`].
    #[must_use]
    pub const fn with_mark_mm(self, mark_mm: f64) -> Self {
        Self { mark_mm, ..self }
    }

    /// The same with another [`PageSettings::gap_after`].
    #[must_use]
    pub const fn with_gap_after(self, gap_after: Duration) -> Self {
        Self { gap_after, ..self }
    }
}

impl Default for PageSettings {
    fn default() -> Self {
        Self { tolerance_mm: 0.02, mark_mm: 0.1, gap_after: Duration::from_millis(500) }
    }
}

/// Makes a page of a recording, in constant memory: records go in one by one, and however many they are, the
/// page stays below 2 MB.
///
/// ```
/// # use plotter_replay::{PageSettings, PlotterSettings, RecordingPage, log::{Event, Header, Record, Summary}};
/// let mut page = RecordingPage::new(PlotterSettings::default(), PageSettings::default());
/// page.push(&Record::at_us(0, Event::Host(vec![2, 0, 0, 0, 0, 1, 0, 0, 0, 0])));
/// page.push(&Record::at_us(900, Event::Controller(b"131+".to_vec())));
/// let html = page.finish("dot.plog", &Header::new(), Summary::default());
/// assert!(html.starts_with("<!DOCTYPE html>") && !html.contains("http://") && !html.contains("https://"));
/// ```
#[derive(Debug)]
pub struct RecordingPage {
    settings: PageSettings,
    plotter: VirtualPlotter,
    way: Trail,
    ink: InkMap,
    meant: Desired,
    has_drawing: bool,
    targets: Few<(u64, StepPoint)>,
    reached: Few<u64>,
    curves: Curves,
    silences: Silences,
    anomalies: Vec<(u64, String)>,
    damage: Vec<Damage>,
    error: ErrorSums,
    pulses: u64,
    pending: u64,
    first: Option<Duration>,
    last: Duration,
    differs: bool,
}

/// Everything over time.
#[derive(Debug)]
struct Curves {
    actual: [Envelope; 2],
    line: [Envelope; 2],
    target: [Envelope; 2],
    error: Envelope,
    pulses: Tally,
}

/// Contour error, summed up.
#[derive(Debug, Default)]
struct ErrorSums {
    samples: u64,
    squares_mm2: f64,
    max_mm: f64,
    max_at: Duration,
}

impl RecordingPage {
    /// A page without anything yet, of a machine with the scale of `plotter`.
    #[must_use]
    pub fn new(plotter: PlotterSettings, settings: PageSettings) -> Self {
        let usual = PageSettings::default();
        let length = |mm: f64, usual: f64| if mm.is_finite() && mm > 0.0 { mm } else { usual };
        let tolerance_mm = length(settings.tolerance_mm, usual.tolerance_mm);
        let mark_mm = length(settings.mark_mm, usual.mark_mm);
        let pair = || [Envelope::new(), Envelope::new()];
        Self {
            settings: PageSettings { tolerance_mm, mark_mm, ..settings },
            plotter: VirtualPlotter::new(plotter),
            way: Trail::new(tolerance_mm, MOST_WAY_POINTS),
            ink: InkMap::default(),
            meant: Desired::new(tolerance_mm, MOST_DESIRED_POINTS),
            has_drawing: false,
            targets: Few::new(MOST_TARGETS),
            reached: Few::new(MOST_TARGETS),
            curves: Curves {
                actual: pair(),
                line: pair(),
                target: pair(),
                error: Envelope::new(),
                pulses: Tally::new(),
            },
            silences: Silences::new(settings.gap_after),
            anomalies: Vec::new(),
            damage: Vec::new(),
            error: ErrorSums::default(),
            pulses: 0,
            pending: 0,
            first: None,
            last: Duration::ZERO,
            differs: false,
        }
    }

    /// Takes the drawing that was sent, in mm on the sheet: it tells the pen and what should have been drawn.
    /// To be called before the first record.
    #[must_use]
    pub fn with_drawing(mut self, ops: &[PlotOp]) -> Self {
        self.has_drawing = true;
        let mut at = Point::ORIGIN;
        for op in chords(ops.iter().copied(), self.settings.tolerance_mm) {
            let Some(to) = op.target() else { continue };
            if matches!(op, PlotOp::Draw { .. }) {
                self.meant.line(at, to);
            }
            at = to;
        }
        self.plotter = self.plotter.with_drawing(ops.iter().copied());
        self
    }

    /// Takes the next record.
    pub fn push(&mut self, record: &Record) {
        self.first.get_or_insert(record.time);
        self.last = record.time;
        match &record.event {
            Event::Host(_) => self.silences.byte(record.time),
            Event::Controller(bytes) => {
                self.silences.byte(record.time);
                if self.counts_answers() {
                    let pulses =
                        bytes.iter().filter(|byte| matches!(byte, b'1'..=b'4' | b'a'..=b'd')).count() as u64;
                    self.counted(record.time, pulses);
                } else {
                    // A line of text may end a move.
                    self.pending = self.pending.saturating_add(1);
                }
            }
            // Edges come again as answers, but where a machine gives none.
            Event::Edge { .. } if !self.counts_answers() => self.counted(record.time, 1),
            Event::Edge { .. } | Event::Drive { .. } => return,
            _ => {}
        }
        self.plotter.push(record);
        if self.pending >= TAKE_OVER_AFTER {
            self.take_over();
        }
    }

    /// Whether where the motors are is told by the controller's answers.
    fn counts_answers(&self) -> bool {
        matches!(self.plotter.settings().counted_by, CountedBy::Answers | CountedBy::Link)
    }

    fn counted(&mut self, time: Duration, pulses: u64) {
        if pulses > 0 {
            self.pulses = self.pulses.saturating_add(pulses);
            self.curves.pulses.push(micros(time), pulses);
        }
        self.pending = self.pending.saturating_add(pulses);
    }

    /// Takes a damaged line of the log.
    pub fn damage(&mut self, damage: &Damage) {
        if self.damage.len() < MOST_ROWS {
            self.damage.push(damage.clone());
        }
    }

    fn take_over(&mut self) {
        self.pending = 0;
        let noted = self.plotter.take_noted();
        for anomaly in noted.anomalies {
            if self.anomalies.len() < MOST_ROWS {
                self.anomalies.push((micros(anomaly.time), anomaly.kind.to_string()));
            }
        }
        let settings = *self.plotter.settings();
        for (time, target) in noted.targets {
            let time_us = micros(time);
            self.targets.push((time_us, target));
            let on_sheet = settings.to_sheet(target);
            let [x, y] = &mut self.curves.target;
            x.push(time_us, on_sheet.x);
            y.push(time_us, on_sheet.y);
        }
        for leg in &noted.legs {
            self.leg(leg, &settings);
        }
    }

    fn leg(&mut self, leg: &Leg, settings: &PlotterSettings) {
        if let Some(reached) = leg.reached {
            self.reached.push(micros(reached.time));
        }
        let from = settings.to_sheet(leg.from);
        let line = leg.target.map(|target| Segment::new(from, settings.to_sheet(target)));
        let is_drawn = leg.pen == Pen::Down;
        if let (Some(line), true, false) = (line, is_drawn, self.has_drawing) {
            self.meant.line(line.from, line.to);
        }
        let pen = if is_drawn { DRAWN | pen_bits(leg.pen_number) } else { 0 };
        for (point, time_us) in leg.points.iter().zip(pulse_times(&leg.points)) {
            let at = settings.to_sheet(point.at);
            let [x, y] = &mut self.curves.actual;
            x.push(time_us, at.x);
            y.push(time_us, at.y);
            let mut state = pen;
            if let Some(line) = line {
                let nearest = line.nearest(at);
                let [x, y] = &mut self.curves.line;
                x.push(time_us, nearest.x);
                y.push(time_us, nearest.y);
                let error_mm = at.distance(nearest);
                self.curves.error.push(time_us, error_mm);
                if is_drawn {
                    self.error.push(point.time(), error_mm);
                    // Once it differs, it does so until the error is clearly less.
                    let limit = if self.differs { 0.5 } else { 1.0 };
                    self.differs = error_mm > limit * self.settings.mark_mm;
                    state |= if self.differs { DIFFERS } else { 0 };
                }
            }
            if is_drawn {
                self.ink.push(time_us, at.x, at.y, state & DIFFERS != 0);
            }
            self.way.push(TrailPoint { at_us: time_us, x_mm: at.x, y_mm: at.y, state });
        }
    }

    /// The page, of a log called `title` with this header and summary.
    #[must_use]
    pub fn finish(mut self, title: &str, header: &Header, summary: Summary) -> String {
        self.plotter.finish();
        self.take_over();
        let data = self.data(title, header, summary);
        document(title, BODY, PROGRAM, &data.to_string(), "'none'")
    }

    fn data(mut self, title: &str, header: &Header, summary: Summary) -> Value {
        let mut undrawn = Desired::new(self.settings.tolerance_mm, MOST_UNDRAWN_POINTS);
        self.plotter.undrawn().for_each(|(from, to)| undrawn.line(from, to));
        let facts = self.facts(header, summary);
        let stands_in_gaps = self.counts_answers();
        let settings = *self.plotter.settings();
        let (way, way_error_mm) = packed_way(self.way);
        let (meant, meant_error_mm) = self.meant.finish();
        let (first_us, last_us) = (self.first.map_or(0, micros), micros(self.last));
        let points = way.get("count").and_then(Value::as_u64).unwrap_or(0);
        let is_long = way_error_mm > MOST_LINE_ERROR_MM || points > MOST_LINE_POINTS;
        let ink = is_long.then(|| self.ink.to_json(first_us, last_us));
        let (undrawn, _) = undrawn.finish();
        let gap_count = self.silences.count();
        let gaps: Vec<_> =
            self.silences.into_vec().iter().map(|&(start, length)| [micros(start), micros(length)]).collect();
        let damage: Vec<_> =
            self.damage.iter().map(|damage| json!([damage.after.map(micros), damage.to_string()])).collect();
        self.anomalies.sort_by_key(|&(time_us, _)| time_us);
        let targets = self.targets.kept();
        let on_sheet: Vec<_> = targets.iter().map(|&(_, target)| settings.to_sheet(target)).collect();
        let response = |name: &str, axis: usize| {
            let curve = |of: &[Envelope; 2]| of.get(axis).map(|envelope| envelope.to_json(1e-3));
            json!({"label": name, "unit": "mm", "curves": [
                {"role": "target", "label": "target", "run": "steps", "data": curve(&self.curves.target)},
                {"role": "desired", "label": "on the line", "data": curve(&self.curves.line)},
                {"role": "actual", "label": "actual", "data": curve(&self.curves.actual)},
            ]})
        };
        json!({
            "title": title,
            "facts": facts,
            "first_us": first_us,
            "last_us": last_us,
            "mark_mm": self.settings.mark_mm,
            "way_error_mm": way_error_mm,
            "way": way,
            "ink": ink,
            "meant": if meant_error_mm > MOST_LINE_ERROR_MM { along(&[]) } else { along(&meant) },
            "undrawn": along(&undrawn),
            "targets": {
                "every": self.targets.every(),
                "t": steps(targets.iter().map(|&(time_us, _)| signed(time_us))),
                "x": steps(on_sheet.iter().map(|at| whole(at.x * 1e3))),
                "y": steps(on_sheet.iter().map(|at| whole(at.y * 1e3))),
                "count": self.plotter.target_count(),
            },
            "reached": {
                "every": self.reached.every(),
                "t": steps(self.reached.kept().iter().map(|&time_us| signed(time_us))),
                "count": self.plotter.reached_count(),
            },
            "charts": [
                response("X", 0),
                response("Y", 1),
                {"label": "contour error", "unit": "mm", "curves": [
                    {"role": "error", "label": "distance from the line", "data": self.curves.error.to_json(1e-4)},
                ]},
                {"label": "pulses", "unit": "1/s", "curves": [
                    {"role": "actual", "label": "both motors", "run": "bars", "data": self.curves.pulses.to_json(LEAST_RATE_US)},
                ]},
            ],
            "gaps": gaps,
            // A machine that tells each step stands while the line is silent; one of lines draws on.
            "stands_in_gaps": stands_in_gaps,
            "gap_count": gap_count,
            "gap_after_ms": u64::try_from(self.settings.gap_after.as_millis()).unwrap_or(u64::MAX),
            "anomalies": self.anomalies,
            "anomaly_count": self.plotter.anomaly_count(),
            "damage": damage,
            "damage_count": summary.damaged_lines,
        })
    }

    /// What stands above it all: name, value.
    fn facts(&self, header: &Header, summary: Summary) -> Vec<(String, String)> {
        let fact = |name: &str, value: String| (name.to_owned(), value);
        let seconds = self.last.saturating_sub(self.first.unwrap_or_default()).as_secs_f64();
        let mut facts = vec![
            fact("duration", format!("{seconds:.3} s")),
            fact("records", summary.records.to_string()),
            fact("pulses", self.pulses.to_string()),
            fact(
                "targets reached",
                format!("{} of {}", self.plotter.reached_count(), self.plotter.target_count()),
            ),
        ];
        if let Some(rms_mm) = self.error.rms_mm() {
            facts.push(fact("contour error, rms", format!("{rms_mm:.4} mm")));
            let at = self.error.max_at.as_secs_f64();
            facts.push(fact("contour error, most", format!("{:.4} mm at {at:.3} s", self.error.max_mm)));
        }
        let (x, y) = self.plotter.resolution_per_mm();
        facts.push(fact("resolution", format!("{x} × {y} pulses/mm")));
        let shortened = |text: String| text.chars().take(MOST_FACT_CHARS).collect::<String>();
        let entries = header.entries().filter(|(key, _)| !key.ends_with("_mm_per_pulse"));
        for (key, value) in entries.take(MOST_FACTS) {
            if let Some(words) =
                (key == "began_unix_us").then(|| date::of_unix_us(header.number(key)?)).flatten()
            {
                facts.push((String::from("began"), words));
                continue;
            }
            facts.push((shortened(key.replace('_', " ")), shortened(value.trim_matches('"').to_owned())));
        }
        facts
    }
}

/// The way in as many characters as a page has for it, and how far it is from the recorded one, mm. A way of
/// few points is exact to the micrometre.
fn packed_way(mut way: Trail) -> (Value, f64) {
    loop {
        let (points, error_mm) = way.clone().finish();
        let unit_um = if points.len() <= FEW_POINTS {
            1
        } else {
            u32::try_from(whole(error_mm * 1e3 / 8.0)).unwrap_or(1)
        };
        let value = packed(&points, unit_um);
        let characters = value.get("bytes").and_then(Value::as_str).map_or(0, str::len);
        if characters <= MOST_WAY_CHARACTERS {
            // Half a unit of place and half a unit of time.
            let rounding_mm = if unit_um > 1 { f64::from(unit_um) * 1e-3 } else { 0.0 };
            return (value, error_mm + rounding_mm);
        }
        way.coarsen();
    }
}

impl ErrorSums {
    fn push(&mut self, time: Duration, error_mm: f64) {
        self.samples = self.samples.saturating_add(1);
        self.squares_mm2 += error_mm * error_mm;
        if error_mm > self.max_mm {
            (self.max_mm, self.max_at) = (error_mm, time);
        }
    }

    fn rms_mm(&self) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "a count below 2^53")]
        let samples = self.samples as f64;
        (self.samples > 0).then(|| libm::sqrt(self.squares_mm2 / samples))
    }
}

fn micros(time: Duration) -> u64 {
    u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
}
