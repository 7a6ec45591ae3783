//! [`Gatherer`]: takes operations, and gives each part of them to the frame or window that it belongs to.

use super::pieces::{Key, Pieces, Tool};
use super::span::{Span, is_sweep};
use super::window::{Side, Window, WindowPart};
use super::zones::{Part, Zone, Zones};
use super::{FrameLayout, SplitError};
use alloc::collections::BTreeMap;
use plotter_motion::{PlotOp, Point};

/// Which frames take what comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    /// This one and the next, with the window after them; what belongs to one before comes too late.
    From(u32),
    /// This one only.
    Only(u32),
}

/// An operation of which something may belong to frames that are not open yet.
#[derive(Clone, Copy, Debug)]
struct Current {
    span: Span,
    /// Whether it goes on from the operation before.
    goes_on: bool,
    /// The zone in which that ended.
    comes_from: Option<Zone>,
    /// The last zone in which it has been taken.
    done: Option<Zone>,
}

/// Takes operations, and holds what of them belongs to the frames that are still open.
#[derive(Clone, Debug)]
pub(super) struct Gatherer {
    layout: FrameLayout,
    zones: Zones,
    wanted: Wanted,
    frames: BTreeMap<u32, Pieces>,
    windows: BTreeMap<u32, Window>,
    /// Number of the operation, from 1.
    op: u64,
    /// Number in the order of the drawing, of lines and pauses; leaves one out where the pen is lifted.
    order: u64,
    at: Point,
    tool: Tool,
    /// Whether the next line goes on from the one before.
    is_down: bool,
    /// The zone in which the stroke is.
    stroke_in: Option<Zone>,
    current: Option<Current>,
    /// The last frame into which something reaches by itself.
    last: Option<u32>,
    is_page_over: bool,
}

impl Gatherer {
    pub(super) fn all(layout: FrameLayout) -> Self {
        Self {
            layout,
            zones: Zones::all(layout),
            wanted: Wanted::From(0),
            frames: BTreeMap::new(),
            windows: BTreeMap::new(),
            op: 0,
            order: 0,
            at: Point::ORIGIN,
            tool: Tool::default(),
            is_down: false,
            stroke_in: None,
            current: None,
            last: None,
            is_page_over: false,
        }
    }

    pub(super) fn only(layout: FrameLayout, frame: u32) -> Self {
        Self { zones: Zones::of_frame(layout, frame), wanted: Wanted::Only(frame), ..Self::all(layout) }
    }

    pub(super) const fn layout(&self) -> &FrameLayout {
        &self.layout
    }

    /// The last frame into which something reaches by itself, not through the window of a border; `None`
    /// while nothing is drawn.
    pub(super) const fn last(&self) -> Option<u32> {
        self.last
    }

    /// Takes the next operation of the drawing.
    pub(super) fn push(&mut self, op: PlotOp) -> Result<(), SplitError> {
        self.op += 1;
        match op {
            PlotOp::Travel { to } => {
                self.check(to)?;
                self.at = to;
                self.lift();
            }
            PlotOp::Draw { .. } | PlotOp::DrawArc { .. } => self.draw(op)?,
            PlotOp::LaserPower { share } => {
                self.check_number(share)?;
                self.tool.power_share = Some(share);
            }
            PlotOp::SelectPen { pen } => {
                self.tool.pen = Some(pen);
                self.lift();
            }
            PlotOp::Dwell { .. } => self.pause(op),
            PlotOp::NewPage => {
                self.is_page_over = self.last.is_some();
                self.lift();
            }
            _ => return Err(SplitError::Unknown { op: self.op }),
        }
        Ok(())
    }

    fn lift(&mut self) {
        self.is_down = false;
        self.stroke_in = None;
        self.order += 1;
    }

    fn draw(&mut self, op: PlotOp) -> Result<(), SplitError> {
        let Some(span) = Span::new(self.at, op) else { return Ok(()) };
        if self.is_page_over {
            return Err(SplitError::SecondPage { op: self.op });
        }
        self.check_span(&span)?;
        self.order += 1;
        self.at = op.target().unwrap_or(self.at);
        let goes_on = core::mem::replace(&mut self.is_down, true);
        self.current = Some(Current { span, goes_on, comes_from: self.stroke_in.take(), done: None });
        self.go_on()?;
        if self.current.is_none() && self.stroke_in.is_none() {
            self.stroke_in = self.zones.end_zone(&span);
        }
        Ok(())
    }

    /// Takes of the current operation what belongs to the open frames.
    pub(super) fn go_on(&mut self) -> Result<(), SplitError> {
        let Some(current) = self.current else { return Ok(()) };
        let mut zones = self.zones;
        let until = match self.wanted {
            Wanted::Only(_) => None,
            Wanted::From(first) => Some(zones.limit(current.done, first.saturating_add(1))),
        };
        let is_new = |zone: Zone| {
            current.done.is_none_or(|done| zone > done) && until.is_none_or(|until| zone <= until)
        };
        zones.parts(
            &current.span,
            |part| if is_new(part.zone) { self.take(&current, part) } else { Ok(()) },
        )?;
        self.zones = zones;
        let goes_beyond = until.filter(|until| zones.goes_beyond(&current.span, *until));
        self.current = goes_beyond.map(|until| Current { done: Some(until), ..current });
        Ok(())
    }

    /// Whether the current operation goes beyond the open frames: one must be closed before the next
    /// operation.
    pub(super) const fn is_beyond(&self) -> bool {
        self.current.is_some()
    }

    /// Takes a part of an operation.
    fn take(&mut self, current: &Current, part: Part) -> Result<(), SplitError> {
        let (Part { zone, t0, t1 }, Current { span, goes_on, comes_from, .. }) = (part, current);
        let goes_on = *goes_on || t0 > 0.0;
        let comes_from = comes_from.filter(|_| goes_on && t0 <= 0.0);
        // The stroke has been in another zone at the start of this operation.
        if let Some(Zone::Border(border)) = comes_from.filter(|before| *before != zone) {
            let exit = self.side(border, span.at(0.0));
            if let Some(window) = self.windows.get_mut(&border) {
                window.leave(exit);
            }
        }
        if t1 >= 1.0 {
            self.stroke_in = Some(zone);
        }
        let keys = (Key::new(self.order, t0), Key::new(self.order, t1));
        let push = |frames: &mut BTreeMap<u32, Pieces>, frame: u32| {
            frames.entry(frame).or_default().push(keys, span.at(t0), self.tool, span.part(t0, t1));
        };
        match zone {
            Zone::Frame(frame) => {
                if self.is_wanted(frame)? {
                    push(&mut self.frames, frame);
                }
                if self.layout.window_mm <= 0.0 {
                    self.note_breaks(frame, span, part, comes_from);
                }
            }
            // The border has been decided: all goes to the frame after it, which reaches as far.
            Zone::Border(border) if self.is_divided(border) => {
                if self.is_wanted(border)? {
                    push(&mut self.frames, border);
                }
            }
            Zone::Border(border) => {
                let new = WindowPart { span: *span, t0, t1, order: self.order, tool: self.tool };
                let entry = goes_on.then(|| self.side(border, span.at(t0)));
                let exit = (t1 < 1.0).then(|| self.side(border, span.at(t1)));
                let window = self.windows.entry(border).or_default();
                if comes_from == Some(zone) {
                    window.go_on(new);
                } else {
                    window.begin_run(new, entry);
                }
                if let Some(exit) = exit {
                    window.leave(exit);
                }
            }
        }
        Ok(())
    }

    /// Without windows each frame notes where lines come over its borders.
    fn note_breaks(&mut self, frame: u32, span: &Span, part: Part, comes_from: Option<Zone>) {
        let middle_mm = self.layout.border_mm(frame) + 0.5 * self.layout.frame_mm;
        let mut note = |frame: u32, place: Point, is_end: bool| {
            if let Some(pieces) = self.frames.get_mut(&frame) {
                if is_end { pieces.break_at_end(place) } else { pieces.break_at_begin(place) }
            }
        };
        for t in [part.t0, part.t1].into_iter().filter(|t| *t > 0.0 && *t < 1.0) {
            let place = span.at(t);
            note(frame, place, place.y > middle_mm);
        }
        if let Some(Zone::Frame(before)) =
            comes_from.filter(|zone| *zone != Zone::Frame(frame) && part.t0 <= 0.0)
        {
            let place = span.at(0.0);
            note(frame, place, place.y > middle_mm);
            note(before, place, place.y <= middle_mm);
        }
    }

    fn side(&self, border: u32, place: Point) -> Side {
        if place.y < self.layout.border_mm(border) { Side::Before } else { Side::After }
    }

    /// Whether the frame takes something; an error if it comes too late.
    fn is_wanted(&self, frame: u32) -> Result<bool, SplitError> {
        match self.wanted {
            Wanted::From(first) if frame < first => Err(SplitError::OutOfOrder { op: self.op, frame }),
            Wanted::From(_) => Ok(true),
            Wanted::Only(only) => Ok(frame == only),
        }
    }

    fn is_divided(&self, border: u32) -> bool {
        matches!(self.wanted, Wanted::From(first) if border <= first && first > 0)
    }

    /// A pause belongs to the frame over which the pen stands, or the nearest one that is still open and
    /// drawn in.
    fn pause(&mut self, op: PlotOp) {
        self.order += 1;
        let frame = self.layout.frame_at(self.at.y).min(self.last.unwrap_or(0));
        let frame = match self.wanted {
            Wanted::From(first) => frame.max(first),
            Wanted::Only(only) if only != frame => return,
            Wanted::Only(_) => frame,
        };
        let keys = (Key::new(self.order, 0.0), Key::new(self.order, 1.0));
        self.frames.entry(frame).or_default().push(keys, self.at, self.tool, op);
    }

    fn check_number(&self, value: f64) -> Result<(), SplitError> {
        let farthest = self.layout.farthest_mm();
        // A NaN lies in no range.
        if (-farthest..=farthest).contains(&value) {
            Ok(())
        } else {
            Err(SplitError::NotFinite { op: self.op, value })
        }
    }

    fn check(&self, place: Point) -> Result<(), SplitError> {
        self.check_number(place.x)?;
        self.check_number(place.y)
    }

    /// Refuses what does not lie on the table; remembers how far the drawing reaches.
    fn check_span(&mut self, span: &Span) -> Result<(), SplitError> {
        let op = self.op;
        match span.op() {
            PlotOp::Draw { to, feed_mm_s } => {
                self.check(to)?;
                self.check_number(feed_mm_s.unwrap_or(0.0))?;
            }
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                self.check(to)?;
                self.check(centre)?;
                self.check_number(feed_mm_s.unwrap_or(0.0))?;
                if !is_sweep(sweep_rad) {
                    return Err(SplitError::NotFinite { op, value: sweep_rad });
                }
            }
            _ => {}
        }
        let (begin_mm, width_mm) = (self.layout.begin_mm, self.layout.width_mm);
        let lies_on_table =
            |(least, most): &(Point, Point)| least.x >= 0.0 && most.x <= width_mm && least.y >= begin_mm;
        let mut bounds = span.bounds();
        let end_mm = self.last.map_or(f64::NEG_INFINITY, |last| self.layout.border_mm(last + 1));
        if !lies_on_table(&bounds) || bounds.1.y >= end_mm {
            bounds = span.exact_bounds();
        }
        if !lies_on_table(&bounds) {
            /// What an arc's rounded ends let its bulge reach beyond an edge, mm.
            const ROUNDING_MM: f64 = 1e-6;
            let (least, most) = bounds;
            if least.x < -ROUNDING_MM || most.x > width_mm + ROUNDING_MM {
                let x_mm = if most.x > width_mm { most.x } else { least.x };
                return Err(SplitError::TooWide { op, x_mm, width_mm });
            }
            if least.y < begin_mm - ROUNDING_MM {
                return Err(SplitError::BeforeBegin { op, y_mm: least.y, begin_mm });
            }
        }
        if bounds.1.y >= end_mm {
            self.last = Some(self.layout.frame_at(bounds.1.y));
        }
        Ok(())
    }

    /// Decides the borders of a frame that are not decided yet, and gives it out. More cannot be added to it.
    pub(super) fn close(&mut self, frame: u32) -> super::Frame {
        let mut pieces = self.frames.remove(&frame).unwrap_or_default();
        let begin_mm = self.layout.border_mm(frame);
        if let Some(window) = self.windows.remove(&frame) {
            window.divide(&self.layout, begin_mm, &mut Pieces::default(), &mut pieces);
        }
        let next = frame.saturating_add(1);
        if let Some(window) = self.windows.remove(&next) {
            let mut after = self.frames.remove(&next).unwrap_or_default();
            window.divide(&self.layout, self.layout.border_mm(next), &mut pieces, &mut after);
            if self.wanted != Wanted::Only(frame) && !after.is_empty() {
                self.frames.insert(next, after);
            }
        }
        if self.wanted != Wanted::Only(frame) {
            self.wanted = Wanted::From(next);
        }
        pieces.finish(frame, begin_mm)
    }

    /// Whether something waits for a frame from this one on.
    pub(super) fn holds_from(&self, frame: u32) -> bool {
        self.frames.range(frame..).next().is_some() || self.windows.range(frame..).next().is_some()
    }
}
