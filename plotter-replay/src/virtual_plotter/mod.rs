//! [`VirtualPlotter`]: draws what the motors really did, from the log alone.
//!
//! The pulses `1` to `4` are counted into a position, the digits of the host into targets, and each `+` says
//! that the target is reached. There the two are compared, which is the only check that the protocol allows:
//!
//! ```text
//! host        2 0 0 0 0 1 0 0 0 0                        5 0 0 0 0 ...
//! controller                      1 1 3 1 1 3 ... 1 +
//!             └─ target (2, 1) ─┘ └─ the way ────┘ └ position == target?
//! ```
//!
//! The reliable link says the same in frames; there the pen is known, and nothing is lost that one side has
//! not noticed.
//!
//! Grbl's and mDraw's lines are text: they are drawn as what they say, as far as the machine has taken them
//! and says to be.
//!
//! Two tracks are kept: *as counted*, and *resynchronized*, which starts afresh at each reached target. A
//! lost pulse shifts the first for ever and the second until the next `+`.

mod anomaly;
mod drawing;
mod ebb_session;
mod host_digits;
mod leg;
mod lines;
mod linked;
mod noted;
mod settings;
mod slack;

pub use anomaly::{Anomaly, AnomalyKind};
pub use leg::{Leg, TrackPoint};
pub use lines::LineCounts;
pub use noted::Noted;
pub use settings::{CountedBy, PlotterSettings, SettingsError};

use crate::log::{Event, Record};
use crate::player::{Controller as _, EbbBoard};
use core::time::Duration;
use drawing::Drawing;
use host_digits::{Decoded, HostDigits};
use lines::{Lines, Tongue};
use linked::{Linked, Speech};
use plotter_motion::protocol::Order;
use plotter_motion::protocol::digits::Reply;
use plotter_motion::{Axis, Direction, Pen, PenMove, PlotOp, Point, StepPoint, toolpath::chords};
use slack::Slack;

/// A target and where the pulses had led when the controller said that it was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reached {
    /// When.
    pub time: Duration,
    /// The target, encoder counts.
    pub desired: StepPoint,
    /// The position as counted.
    pub actual: StepPoint,
    /// As counted, minus the target.
    pub error: StepPoint,
    /// Counted from the last reached target, minus the target.
    pub resync_error: StepPoint,
}

/// A plotter without paper: fed with the records of a log, it knows where the pen is and what it has drawn.
///
/// ```
/// # use plotter_motion::Point;
/// # use plotter_replay::{PlotterSettings, VirtualPlotter, log::{Event, Record}};
/// let mut plotter = VirtualPlotter::new(PlotterSettings::default());
/// plotter.push(&Record::at_us(0, Event::Host(vec![2, 0, 0, 0, 0, 1, 0, 0, 0, 0])));
/// plotter.push(&Record::at_us(900, Event::Controller(b"131+".to_vec())));
/// plotter.finish();
/// assert_eq!(plotter.position(), Point::new(0.05, 0.025)); // 2 and 1 pulses of 1/40 mm
/// assert!(plotter.anomalies().is_empty());
/// ```
#[derive(Clone, Debug)]
pub struct VirtualPlotter {
    settings: PlotterSettings,
    host: HostDigits,
    linked: Linked,
    /// Of a session of text lines.
    lines: Option<Lines>,
    /// That of a session of the EBB's, until the log has steps of its own.
    board: Option<Box<EbbBoard>>,
    drawing: Option<Drawing>,
    pen: Pen,
    pen_recorded: bool,
    pen_number: u8,
    counted: StepPoint,
    slack: Slack,
    correction: StepPoint,
    // Where the present line begins.
    from: StepPoint,
    next: Option<StepPoint>,
    under_way: u64,
    last_byte: Option<Duration>,
    now: Duration,
    leg: Leg,
    legs: Vec<Leg>,
    points: usize,
    full: bool,
    targets: Vec<(Duration, StepPoint)>,
    target_count: u64,
    reached_count: u64,
    stop_count: u64,
    anomalies: Vec<Anomaly>,
    anomaly_count: u64,
}

impl VirtualPlotter {
    /// A plotter at position (0, 0) that draws every way, unless the log records the pen.
    #[must_use]
    pub fn new(settings: PlotterSettings) -> Self {
        let origin = settings.begins_at.map_or(StepPoint::default(), |at| settings.to_counts(at));
        let lines = |tongue| Lines::new(tongue, settings.pen, settings.begins_at);
        let lines = match settings.counted_by {
            CountedBy::Grbl => Some(lines(Tongue::Grbl)),
            CountedBy::MDraw => Some(lines(Tongue::MDraw)),
            CountedBy::Marlin => Some(lines(Tongue::Marlin)),
            CountedBy::Hpgl => Some(lines(Tongue::Hpgl)),
            CountedBy::Answers | CountedBy::Edges | CountedBy::Link | CountedBy::Ebb => None,
        };
        // Lines, or the machine, say where the pen is lifted.
        let is_up = lines.is_some() || settings.counted_by == CountedBy::Ebb;
        let pen = if is_up { Pen::Up } else { Pen::Down };
        Self {
            settings,
            host: HostDigits::new(settings.resync_gap),
            linked: Linked::new(if settings.counted_by == CountedBy::Link {
                Speech::Calling(0)
            } else {
                Speech::Digits
            }),
            lines,
            board: (settings.counted_by == CountedBy::Ebb).then(|| Box::new(EbbBoard::switched_on())),
            drawing: None,
            pen,
            pen_recorded: false,
            pen_number: 0,
            counted: origin,
            slack: Slack::default(),
            correction: StepPoint::default(),
            from: origin,
            next: None,
            under_way: 0,
            last_byte: None,
            now: Duration::ZERO,
            leg: new_leg(pen, origin, origin, StepPoint::default(), 0),
            legs: Vec::new(),
            points: 0,
            full: false,
            targets: Vec::new(),
            target_count: 0,
            reached_count: 0,
            stop_count: 0,
            anomalies: Vec::new(),
            anomaly_count: 0,
        }
    }

    /// Takes the drawing that was sent, in mm on the sheet: it tells which ways are drawn. Arcs are the
    /// chords that [`plotter_motion::toolpath::targets`] makes of them. What the log itself records of the
    /// pen counts more.
    #[must_use]
    pub fn with_drawing(self, ops: impl IntoIterator<Item = PlotOp>) -> Self {
        let settings = self.settings;
        let tolerance_mm = 0.5 * settings.x_mm_per_pulse.min(settings.y_mm_per_pulse);
        self.with_moves(chords(ops, tolerance_mm).filter_map(|op| {
            let drawn = matches!(op, PlotOp::Draw { .. });
            let pen = if drawn { Pen::Down } else { Pen::Up };
            Some(PenMove { pen, target: settings.to_counts(op.target()?) })
        }))
    }

    /// The same with the moves that a drawing was sent as.
    #[must_use]
    pub fn with_moves(mut self, moves: impl IntoIterator<Item = PenMove>) -> Self {
        self.drawing = Some(Drawing::new(moves.into_iter().collect()));
        self.pen = Pen::Up;
        self.leg.pen = Pen::Up;
        self
    }

    /// Takes the next record.
    pub fn push(&mut self, record: &Record) {
        self.run_board(record.time);
        self.now = record.time;
        match &record.event {
            Event::Host(bytes) => bytes.iter().for_each(|&byte| self.host_byte(byte)),
            Event::Controller(bytes) => bytes.iter().for_each(|&byte| self.controller_byte(byte)),
            Event::Pen(pen) => {
                self.pen_recorded = true;
                self.set_pen(*pen);
            }
            Event::Target { x, y } => self.target_taken(StepPoint::new(*x, *y)),
            Event::Edge { axis, sign } if self.settings.counted_by == CountedBy::Edges => {
                self.listen();
                self.count(*axis, *sign);
            }
            Event::Edge { axis, sign }
                if self.lines.is_some() || self.settings.counted_by == CountedBy::Ebb =>
            {
                self.board = None; // a simulated one has made these
                if self.slack.moves(self.settings.play, *axis, *sign) {
                    self.count(*axis, *sign);
                    self.line_step();
                }
            }
            Event::Estop(pressed) => {
                if let Some(board) = &mut self.board {
                    board.emergency_stop(record.time, *pressed);
                }
            }
            // Edges come again as pulse bytes; the others do not move the pen.
            Event::Edge { .. } | Event::Drive { .. } | Event::Switch { .. } | Event::Note(_) => {}
        }
    }

    /// The log is over: takes what is left of it.
    pub fn finish(&mut self) {
        self.finish_board();
        self.finish_lines();
        let decoded = self.host.finish();
        self.take(decoded);
        let digits = self.host.partial();
        if !digits.is_empty() {
            self.host.drop_partial();
            self.note(self.now, AnomalyKind::PartialTargetAtEnd { digits });
        }
        self.end_leg(None);
    }

    /// Forgets what was drawn; position, pen and targets stay.
    pub fn clear(&mut self) {
        self.legs.clear();
        self.points = 0;
        self.full = false;
        self.leg = self.begin_leg();
    }

    /// Takes the ways so far out, so that a recording of any length is gone through in constant memory; the
    /// one under way goes on from where the pen is. Position, pen and targets stay.
    pub fn take_legs(&mut self) -> Vec<Leg> {
        // What of the present way comes later belongs to the same line.
        let from = self.from;
        let target = self.leg.target;
        self.end_leg(None);
        self.leg.from = from;
        self.leg.target = target;
        self.points = 0;
        self.full = false;
        core::mem::take(&mut self.legs)
    }

    /// Gives away all ways, targets and anomalies so far, the beginning of the way under way too, and forgets
    /// them: so a recording of any length is followed in constant memory. Position, pen, counts and the
    /// target under way stay.
    ///
    /// ```
    /// # use plotter_replay::{PlotterSettings, VirtualPlotter, log::{Event, Record}};
    /// let mut plotter = VirtualPlotter::new(PlotterSettings::default());
    /// plotter.push(&Record::at_us(900, Event::Controller(b"111".to_vec())));
    /// assert_eq!(plotter.take_noted().legs[0].points.len(), 4); // the start and three pulses
    /// assert!(plotter.take_noted().legs.is_empty());
    /// assert_eq!(plotter.raw_counts().x, 3);
    /// ```
    pub fn take_noted(&mut self) -> Noted {
        self.end_leg(None);
        self.points = 0;
        self.full = false;
        Noted {
            legs: core::mem::take(&mut self.legs),
            targets: core::mem::take(&mut self.targets),
            anomalies: core::mem::take(&mut self.anomalies),
        }
    }

    /// The lines of the drawing that the host passed over or has not come to: from, to, mm on the sheet. Only
    /// with a drawing, and only with the pen down.
    pub fn undrawn(&self) -> impl Iterator<Item = (Point, Point)> {
        let settings = self.settings;
        let lines = self.drawing.iter().flat_map(Drawing::undrawn);
        lines.map(move |(from, to)| (settings.to_sheet(from), settings.to_sheet(to)))
    }

    /// Scale, origin and limits.
    #[must_use]
    pub fn settings(&self) -> &PlotterSettings {
        &self.settings
    }

    /// Position (0, 0) of the motors lies at another place of the sheet from now on, mm.
    pub fn set_p1(&mut self, p1: Point) {
        self.settings.p1 = p1;
    }

    /// Where the pen is on the sheet, mm: the resynchronized track.
    #[must_use]
    pub fn position(&self) -> Point {
        self.settings.to_sheet(self.resynced_counts())
    }

    /// Position as counted.
    #[must_use]
    pub fn raw_counts(&self) -> StepPoint {
        self.counted
    }

    /// Position counted from the last reached target.
    #[must_use]
    pub fn resynced_counts(&self) -> StepPoint {
        plus(self.counted, self.correction)
    }

    /// The next coordinate, mm on the sheet: the target under way.
    #[must_use]
    pub fn next_target(&self) -> Option<Point> {
        self.next.map(|target| self.settings.to_sheet(target))
    }

    /// Whether the pen is down.
    #[must_use]
    pub fn pen(&self) -> Pen {
        self.pen
    }

    /// Pulses a millimetre, x and y: the finest step of the drawing.
    #[must_use]
    pub fn resolution_per_mm(&self) -> (f64, f64) {
        (1.0 / self.settings.x_mm_per_pulse, 1.0 / self.settings.y_mm_per_pulse)
    }

    /// The ways so far, each to one target; the one under way comes last once [`VirtualPlotter::finish`] was
    /// called.
    #[must_use]
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// Whether the line speaks the reliable link: the way is then known where the machine told it, every
    /// 20 ms and at each target.
    #[must_use]
    pub fn is_linked(&self) -> bool {
        self.linked.speech == Speech::Frames
    }

    /// Targets that the host sent, encoder counts, with the time of their last digit.
    #[must_use]
    pub fn targets(&self) -> &[(Duration, StepPoint)] {
        &self.targets
    }

    /// Targets that were reached.
    pub fn reached(&self) -> impl Iterator<Item = Reached> {
        self.legs.iter().filter_map(|leg| leg.reached)
    }

    /// How many targets were sent; more than [`VirtualPlotter::targets`] keeps, if they are very many.
    #[must_use]
    pub fn target_count(&self) -> u64 {
        self.target_count
    }

    /// How many targets were reached.
    #[must_use]
    pub fn reached_count(&self) -> u64 {
        self.reached_count
    }

    /// How often the machine told on the line that it was stopped.
    #[must_use]
    pub fn stop_count(&self) -> u64 {
        self.stop_count
    }

    /// Anomalies so far, in their order.
    #[must_use]
    pub fn anomalies(&self) -> &[Anomaly] {
        &self.anomalies
    }

    /// How much did not fit; more than [`VirtualPlotter::anomalies`] keeps, if it is very much.
    #[must_use]
    pub fn anomaly_count(&self) -> u64 {
        self.anomaly_count
    }

    fn host_byte(&mut self, byte: u8) {
        if self.lines.is_some() {
            self.host_line_byte(byte);
            return;
        }
        if self.settings.counted_by == CountedBy::Ebb {
            self.ebb_byte(byte);
            return;
        }
        self.listen();
        // (an order is no digit: it belongs to no target)
        if self.host_link_byte(byte) || Order::from_byte(byte).is_some() {
            return;
        }
        let decoded = self.host.push(self.now, byte);
        self.take(decoded);
    }

    fn controller_byte(&mut self, byte: u8) {
        if self.lines.is_some() {
            self.controller_line_byte(byte);
            return;
        }
        if self.settings.counted_by == CountedBy::Ebb {
            return;
        }
        self.listen();
        if self.controller_link_byte(byte) {
            return;
        }
        let decoded = self.host.align();
        self.take(decoded);
        match Reply::from_byte(byte) {
            Some(Reply::Pulse(axis, direction)) => self.count(axis, direction),
            Some(Reply::Reached) => self.target_reached(),
            Some(Reply::Clear) => {
                self.host.drop_partial();
                self.end_leg(None);
                self.counted = StepPoint::default();
                self.correction = StepPoint::default();
                self.from = StepPoint::default();
                self.leg = self.begin_leg();
            }
            Some(Reply::Stopped) => self.stop_count = self.stop_count.saturating_add(1),
            Some(Reply::GoesOn) => {}
            None => self.note(self.now, AnomalyKind::UnknownReply { byte }),
        }
    }

    fn count(&mut self, axis: Axis, direction: Direction) {
        let coordinate = match axis {
            Axis::X => &mut self.counted.x,
            Axis::Y => &mut self.counted.y,
        };
        *coordinate = coordinate.saturating_add(direction.sign());
        self.add_point();
    }

    /// Notices a silence of the whole line.
    fn listen(&mut self) {
        let silence = self.last_byte.map_or(Duration::ZERO, |last| self.now.saturating_sub(last));
        self.last_byte = Some(self.now);
        if self.under_way > 0 && silence > self.settings.stall_after {
            self.note(self.now, AnomalyKind::Silence { silence });
        }
    }

    fn take(&mut self, decoded: Vec<Decoded>) {
        for one in decoded {
            match one {
                Decoded::Odd(time, kind) => self.note(time, kind),
                Decoded::Target(time, target) => self.new_target(time, target),
            }
        }
    }

    fn new_target(&mut self, time: Duration, target: StepPoint) {
        self.target_count = self.target_count.saturating_add(1);
        if self.targets.len() < self.settings.max_entries {
            self.targets.push((time, target));
        }
        self.next = Some(target);
        self.under_way = self.under_way.saturating_add(1);
        let found = self.drawing.as_mut().map(|drawing| drawing.pen(target));
        if !self.pen_recorded {
            if found == Some(None) {
                self.note(time, AnomalyKind::NotInDrawing { target });
            }
            self.set_pen(found.flatten().unwrap_or(Pen::Down));
        }
        self.leg.target = Some(target);
    }

    /// The controller's own word on its target.
    fn target_taken(&mut self, taken: StepPoint) {
        if self.settings.counted_by == CountedBy::Edges {
            self.last_byte = Some(self.now); // between two moves a controller without a line may rest
        }
        let decoded = self.host.align();
        self.take(decoded);
        match self.next {
            Some(sent) if sent == taken => {}
            Some(sent) => {
                self.note(self.now, AnomalyKind::TargetDiffers { sent, taken });
                self.next = Some(taken);
                self.leg.target = Some(taken);
            }
            None => self.new_target(self.now, taken),
        }
    }

    fn target_reached(&mut self) {
        let Some(desired) = self.next.take() else {
            match self.host.drop_partial() {
                0 => self.note(self.now, AnomalyKind::ReachedNothing),
                digits => self.note(self.now, AnomalyKind::ReachedInsideTarget { digits }),
            }
            // Where that was, nobody knows: the pulses are the best guess for where the next line begins.
            self.from = self.resynced_counts();
            self.end_leg(None);
            return;
        };
        let extra = self.under_way.saturating_sub(1);
        self.under_way = 0;
        if extra > 0 {
            self.note(self.now, AnomalyKind::ExtraTargets { count: extra });
        }
        let error = minus(self.counted, desired);
        let resync_error = minus(self.resynced_counts(), desired);
        let tolerance = self.settings.reached_tolerance_counts;
        if resync_error.x.unsigned_abs() > tolerance || resync_error.y.unsigned_abs() > tolerance {
            self.note(self.now, AnomalyKind::ReachedElsewhere { off: resync_error });
        }
        self.reached_count = self.reached_count.saturating_add(1);
        self.from = desired;
        let (time, actual) = (self.now, self.counted);
        self.end_leg(Some(Reached { time, desired, actual, error, resync_error }));
        if self.settings.counted_by != CountedBy::Edges {
            self.correction = minus(desired, self.counted);
        }
        self.leg.correction = self.correction;
    }

    fn set_pen(&mut self, pen: Pen) {
        if pen == self.pen {
            return;
        }
        self.pen = pen;
        if self.leg.points.len() > 1 {
            // What the pen did before belongs to a way of its own.
            let target = self.leg.target;
            self.end_leg(None);
            self.leg.target = target;
        }
        self.leg.pen = pen;
    }

    fn set_pen_number(&mut self, number: u8) {
        if number == self.pen_number {
            return;
        }
        self.pen_number = number;
        if self.leg.points.len() > 1 {
            let target = self.leg.target;
            self.end_leg(None);
            self.leg.target = target;
        }
        self.leg.pen_number = number;
    }

    fn add_point(&mut self) {
        if self.full {
            return;
        }
        if self.points >= self.settings.max_points {
            self.full = true;
            self.note(self.now, AnomalyKind::PathTooLong);
            return;
        }
        self.points = self.points.saturating_add(1);
        let point = self.here();
        self.leg.points.push(point);
    }

    fn here(&self) -> TrackPoint {
        TrackPoint { time_us: u64::try_from(self.now.as_micros()).unwrap_or(u64::MAX), at: self.counted }
    }

    fn begin_leg(&self) -> Leg {
        let mut leg = new_leg(self.pen, self.from, self.counted, self.correction, self.here().time_us);
        leg.target = self.next;
        leg.pen_number = self.pen_number;
        leg
    }

    /// Puts the present way to the others and begins the next.
    fn end_leg(&mut self, reached: Option<Reached>) {
        let next = self.begin_leg();
        let mut leg = core::mem::replace(&mut self.leg, next);
        leg.reached = reached;
        if leg.points.len() <= 1 && leg.reached.is_none() {
            return;
        }
        if self.legs.len() < self.settings.max_entries {
            self.legs.push(leg);
        } else if !self.full {
            self.full = true;
            self.note(self.now, AnomalyKind::PathTooLong);
        }
    }

    fn note(&mut self, time: Duration, kind: AnomalyKind) {
        self.anomaly_count = self.anomaly_count.saturating_add(1);
        if self.anomalies.len() < self.settings.max_entries {
            self.anomalies.push(Anomaly { time, kind });
        }
    }
}

fn new_leg(pen: Pen, from: StepPoint, at: StepPoint, correction: StepPoint, time_us: u64) -> Leg {
    Leg {
        pen,
        pen_number: 0,
        from,
        target: None,
        points: vec![TrackPoint { time_us, at }],
        correction,
        reached: None,
    }
}

fn plus(a: StepPoint, b: StepPoint) -> StepPoint {
    StepPoint::new(a.x.saturating_add(b.x), a.y.saturating_add(b.y))
}

fn minus(a: StepPoint, b: StepPoint) -> StepPoint {
    StepPoint::new(a.x.saturating_sub(b.x), a.y.saturating_sub(b.y))
}
