//! [`Machine`]: what holds from one line to the next, and what a line makes of it.

use super::arc;
use super::code::{Action, Motion, Spindle, Stop};
use super::interpreter::Outcomes;
use super::line::{Line, Told};
use super::pen_convention::{LaserCommand, PenConvention, ServoCommand};
use super::{DwellUnit, Error, Modes, Problem, ReadOptions, Remark, Word};
use crate::seconds::duration;
use crate::whole::{is_whole, whole};
use crate::{PlotOp, Point, Vec2};

const MM_PER_INCH: f64 = 25.4;

/// What holds from one line to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Machine {
    /// Where the pen is, on the sheet.
    at: Point,
    /// Height of the pen as the text counts it: mm, or what a servo makes of it.
    z: f64,
    /// What is added to a coordinate: `G10` and `G92`; and what of it `G10` has set.
    offset: Vec2,
    origin: Vec2,
    unit_mm: f64,
    relative: bool,
    absolute_centres: bool,
    sheet: bool,
    inverse_time: bool,
    motion: Motion,
    feed_mm_s: Option<f64>,
    spindle: Spindle,
    /// The number after `S`.
    power: f64,
    tool: Option<u8>,
    pen_down: bool,
    /// The pen has been lowered, or the laser switched on, and has not moved since.
    dot_owed: bool,
    /// The pen has just been lifted or lowered, and nothing came after.
    settling: bool,
    /// Share of its power with which the laser burns after the line before.
    beam: f64,
    told_share: Option<f64>,
}

impl Machine {
    pub(super) fn new() -> Self {
        Self {
            at: Point::ORIGIN,
            z: 0.0,
            offset: Vec2::new(0.0, 0.0),
            origin: Vec2::new(0.0, 0.0),
            unit_mm: 1.0,
            relative: false,
            absolute_centres: false,
            sheet: true,
            inverse_time: false,
            motion: Motion::Rapid,
            feed_mm_s: None,
            spindle: Spindle::Off,
            power: 0.0,
            tool: None,
            pen_down: false,
            dot_owed: false,
            settling: false,
            beam: 0.0,
            told_share: None,
        }
    }

    pub(super) fn modes(&self) -> Modes {
        Modes {
            position: self.at,
            offset: self.offset,
            origin: self.origin,
            inches: self.unit_mm != 1.0,
            relative: self.relative,
            motion: match self.motion {
                Motion::Rapid => 0,
                Motion::Line => 1,
                Motion::Arc { left: false } => 2,
                Motion::Arc { left: true } => 3,
                Motion::None => 80,
            },
            feed_mm_s: self.feed_mm_s,
            spindle: match self.spindle {
                Spindle::Off => 5,
                Spindle::Constant => 3,
                Spindle::Dynamic => 4,
            },
            power: self.power,
            tool: self.tool.unwrap_or(0),
            pen_down: self.pen_down,
        }
    }

    /// As switched on, but that the origin set by `G10` stays.
    pub(super) fn reset(&mut self) {
        let origin = self.origin;
        *self = Self { origin, offset: origin, ..Self::new() };
    }

    pub(super) fn stand_at(&mut self, point: Point) {
        self.at = point;
        (self.dot_owed, self.settling) = (false, false);
    }

    pub(super) fn carry_out(
        &mut self,
        line: &Line<'_>,
        options: &ReadOptions,
        out: &mut Outcomes,
    ) -> Result<(), Error> {
        self.set_modes(line)?;
        if let ([], Some(Remark::Pen(pen))) = (line.block.words(), line.block.remark()) {
            self.leave_dot(options, out);
            out.give(Ok(PlotOp::SelectPen { pen }));
        }
        if line.tool_change.is_some() {
            let expected = "M6 needs a T before it: which pen";
            let pen = self.tool.ok_or_else(|| Problem::Missing { expected }.at(line.block.position()))?;
            self.leave_dot(options, out);
            out.give(Ok(PlotOp::SelectPen { pen }));
        }
        self.put_pen(line, options, out);
        match line.action {
            Some(Action::Dwell) => self.dwell(line, options, out)?,
            Some(Action::Home) => self.home(line, options, out),
            Some(Action::Offset) => self.set_offset(line),
            Some(Action::NoOffset) => self.offset = self.origin,
            Some(Action::Origin { here }) => self.set_origin(line, here),
            Some(Action::Other) | None => {}
        }
        if let Some(motion) = line.motion {
            self.motion = motion;
        }
        let moved = line.may_move() && self.go(line, options, out)?;
        self.switch_laser(moved, options, out);
        match line.stop {
            Some(Stop::Pause) => self.pause(line, options, out),
            Some(Stop::End) => self.end(options, out),
            None => {}
        }
        let is_mdraw = matches!(
            options.pen,
            PenConvention::Servo { command: ServoCommand::M1, .. }
                | PenConvention::Laser { command: LaserCommand::M4, .. }
        );
        let is_arc = matches!(self.motion, Motion::Arc { .. });
        // mDraw slows its steps down by A.
        let unused = line.unused(is_arc).filter(
            |error| !matches!(error.problem, Problem::Unused { word } if is_mdraw && word.letter == b'A'),
        );
        if let Some(notice) = line.notice.or(unused) {
            out.give(Err(notice));
        }
        Ok(())
    }

    fn set_modes(&mut self, line: &Line<'_>) -> Result<(), Error> {
        if let Some(inches) = line.inches {
            self.unit_mm = if inches { MM_PER_INCH } else { 1.0 };
        }
        self.relative = line.relative.unwrap_or(self.relative);
        self.absolute_centres = line.absolute_centres.unwrap_or(self.absolute_centres);
        self.sheet = line.sheet.unwrap_or(self.sheet);
        if let Some(inverse_time) = line.inverse_time
            && inverse_time != self.inverse_time
        {
            (self.inverse_time, self.feed_mm_s) = (inverse_time, None);
        }
        let refused =
            |word: Word, expected| Problem::BadParameter { word, expected }.at(line.block.place(word));
        if let Some(word) = line.word(b'F').filter(|_| !line.owned) {
            let feed = word.number.filter(|feed| *feed > 0.0);
            let feed = feed.ok_or_else(|| refused(word, "a speed is above 0"))?;
            self.feed_mm_s = (!self.inverse_time).then_some(feed * self.unit_mm / 60.0);
        }
        if let Some(word) = line.word(b'T').filter(|_| !line.owned) {
            let pen = word.number.filter(|number| is_whole(*number));
            let pen = pen.and_then(|number| u8::try_from(whole(number)).ok());
            let pen = pen.ok_or_else(|| refused(word, "a pen is a whole number from 0 to 255"))?;
            self.tool = Some(pen);
        }
        Ok(())
    }

    /// The words by which this text lifts its pen or switches its laser.
    fn put_pen(&mut self, line: &Line<'_>, options: &ReadOptions, out: &mut Outcomes) {
        let asks_s = matches!(line.told, Some(Told::Beep | Told::ServoAngle | Told::Fan(_)))
            || (line.action == Some(Action::Dwell) && !line.has(b"P"));
        let spindle_s = line.number(b'S').filter(|_| !asks_s && !line.owned);
        match options.pen {
            PenConvention::Spindle => {
                if let Some(spindle) = line.spindle {
                    self.set_pen(spindle != Spindle::Off, options, out);
                }
            }
            PenConvention::Servo { command, up, down } => {
                let place = match (command, line.told) {
                    (ServoCommand::M300, Some(Told::Beep)) | (ServoCommand::M280, Some(Told::ServoAngle)) => {
                        line.number(b'S')
                    }
                    (ServoCommand::M1, Some(Told::Degrees(degrees))) => Some(degrees),
                    (ServoCommand::M3, _) if line.spindle != Some(Spindle::Off) => spindle_s,
                    _ => None,
                };
                if let Some(place) = place {
                    self.set_pen(is_nearer(place, down, up), options, out);
                }
            }
            PenConvention::Laser { command, full } => match (command, line.told) {
                (LaserCommand::Spindle, _) => {
                    self.power = spindle_s.unwrap_or(self.power);
                    self.spindle = line.spindle.unwrap_or(self.spindle);
                }
                (LaserCommand::Fan, Some(Told::Fan(on))) => {
                    self.power = line.number(b'S').unwrap_or(full);
                    self.spindle = if on { Spindle::Constant } else { Spindle::Off };
                }
                (LaserCommand::M4, Some(Told::LaserPower(power))) => {
                    (self.power, self.spindle) = (power, Spindle::Constant);
                }
                _ => {}
            },
            PenConvention::Height { .. } | PenConvention::Motion => {}
        }
    }

    fn set_pen(&mut self, down: bool, options: &ReadOptions, out: &mut Outcomes) {
        if down == self.pen_down {
            return;
        }
        if !down {
            self.leave_dot(options, out);
        }
        (self.pen_down, self.dot_owed, self.settling) = (down, down, true);
    }

    /// Share of its power with which the laser burns while it moves as it does now.
    fn share(&self, options: &ReadOptions) -> f64 {
        let PenConvention::Laser { command, full } = options.pen else { return 0.0 };
        let is_dark = command == LaserCommand::Spindle && matches!(self.motion, Motion::Rapid | Motion::None);
        if self.spindle == Spindle::Off || is_dark {
            return 0.0;
        }
        let share = self.power / full;
        if share > 0.0 { share.min(1.0) } else { 0.0 }
    }

    /// What becomes of a laser at the end of a line: switched on and off without a movement between it leaves a dot.
    fn switch_laser(&mut self, moved: bool, options: &ReadOptions, out: &mut Outcomes) {
        let share = self.share(options);
        if !moved && self.beam != share {
            // What it has burnt while it stood, it has burnt with the power that it had.
            self.leave_dot(options, out);
            let begins = self.beam == 0.0;
            self.dot_owed = begins && self.spindle == Spindle::Constant;
            // A laser needs no time to go out.
            self.settling = begins;
        }
        self.beam = share;
    }

    pub(super) fn leave_dot(&mut self, options: &ReadOptions, out: &mut Outcomes) {
        if core::mem::take(&mut self.dot_owed) {
            self.tell_share(self.beam, options, out);
            out.give(Ok(PlotOp::Draw { to: self.at, feed_mm_s: self.feed_mm_s }));
        }
    }

    fn tell_share(&mut self, share: f64, options: &ReadOptions, out: &mut Outcomes) {
        if matches!(options.pen, PenConvention::Laser { .. }) && self.told_share != Some(share) {
            self.told_share = Some(share);
            out.give(Ok(PlotOp::LaserPower { share }));
        }
    }

    fn dwell(&mut self, line: &Line<'_>, options: &ReadOptions, out: &mut Outcomes) -> Result<(), Error> {
        let unit_s = if options.dwell_unit == DwellUnit::Seconds { 1.0 } else { 1e-3 };
        let Some((word, unit_s)) =
            line.word(b'P').map(|word| (word, unit_s)).or(line.word(b'S').map(|word| (word, 1.0)))
        else {
            return Err(Problem::Missing { expected: "G4 needs a P: how long" }.at(line.block.position()));
        };
        let seconds = word.number.unwrap_or_default() * unit_s;
        let expected = "a time is not below 0";
        let duration = duration(seconds)
            .ok_or_else(|| Problem::BadParameter { word, expected }.at(line.block.place(word)))?;
        let settles = core::mem::take(&mut self.settling) && duration <= options.settle;
        if !settles && !duration.is_zero() {
            self.leave_dot(options, out);
            out.give(Ok(PlotOp::Dwell { duration }));
        }
        Ok(())
    }

    fn home(&mut self, line: &Line<'_>, options: &ReadOptions, out: &mut Outcomes) {
        let all = !line.has(b"XYZ");
        let lifts = match options.pen {
            PenConvention::Height { .. } | PenConvention::Servo { command: ServoCommand::Z, .. } => {
                all || line.has(b"Z")
            }
            PenConvention::Servo { command: ServoCommand::M1, .. } => true,
            _ => false,
        };
        if lifts {
            self.set_pen(false, options, out);
        }
        if all || line.has(b"XY") {
            self.leave_dot(options, out);
            self.at.x = if all || line.has(b"X") { 0.0 } else { self.at.x };
            self.at.y = if all || line.has(b"Y") { 0.0 } else { self.at.y };
            self.settling = false;
            out.give(Ok(PlotOp::Travel { to: self.at }));
        }
    }

    fn set_offset(&mut self, line: &Line<'_>) {
        let all = !line.has(b"XYZEABC");
        let word = |letter| line.number(letter).or(all.then_some(0.0));
        if let Some(x) = word(b'X') {
            self.offset.x = self.at.x - x * self.unit_mm;
        }
        if let Some(y) = word(b'Y') {
            self.offset.y = self.at.y - y * self.unit_mm;
        }
        self.z = word(b'Z').unwrap_or(self.z);
    }

    fn set_origin(&mut self, line: &Line<'_>, here: bool) {
        // The offset of G92 stays on top of it.
        let own = self.offset + -self.origin;
        let number = |letter| line.number(letter).map(|number| number * self.unit_mm);
        if let Some(x) = number(b'X') {
            self.origin.x = if here { self.at.x - x - own.x } else { x };
        }
        if let Some(y) = number(b'Y') {
            self.origin.y = if here { self.at.y - y - own.y } else { y };
        }
        self.offset = self.origin + own;
    }

    /// The movement of a line, if it has one.
    fn go(&mut self, line: &Line<'_>, options: &ReadOptions, out: &mut Outcomes) -> Result<bool, Error> {
        let at = line.block.position();
        let is_arc = matches!(self.motion, Motion::Arc { .. });
        let moves = line.has(b"XY") || (is_arc && line.has(b"IJR"));
        if !moves && !line.has(b"Z") {
            return Ok(false);
        }
        let to = Point::new(
            self.coordinate(line, b'X', self.at.x, self.offset.x),
            self.coordinate(line, b'Y', self.at.y, self.offset.y),
        );
        if self.motion == Motion::None {
            if line.notice.is_none() {
                return Err(Problem::NoMotion.at(at));
            }
            // A spline and its like have been reported: what follows it is to begin where it would have ended.
            if moves {
                self.leave_dot(options, out);
                out.give(Ok(PlotOp::Travel { to }));
                (self.at, self.settling) = (to, false);
            }
            return Ok(false);
        }
        let arc = match self.motion {
            Motion::Arc { left } if moves => {
                Some(self.arc(line, to, left).map_err(|problem| problem.at(at))?)
            }
            _ => None,
        };
        // A pen that goes up on the way does so before, one that goes down after it: it marks from end to end or not at all.
        let height = self.height(line, options);
        if height == Some(false) {
            self.set_pen(false, options, out);
        }
        if moves {
            self.mark(to, arc, options, out);
        }
        if height == Some(true) {
            self.set_pen(true, options, out);
        }
        Ok(moves)
    }

    fn coordinate(&self, line: &Line<'_>, letter: u8, here: f64, offset: f64) -> f64 {
        match line.number(letter) {
            None => here,
            Some(number) if line.machine_coordinates => number * self.unit_mm,
            Some(number) if self.relative => here + number * self.unit_mm,
            Some(number) => number * self.unit_mm + offset,
        }
    }

    /// Whether the Z of a line puts the pen down.
    fn height(&mut self, line: &Line<'_>, options: &ReadOptions) -> Option<bool> {
        if line.machine_coordinates && line.has(b"Z") {
            // Zero is the top there.
            return Some(false);
        }
        let unit = if let PenConvention::Height { .. } = options.pen { self.unit_mm } else { 1.0 };
        let z = line.number(b'Z')? * unit;
        self.z = if self.relative { self.z + z } else { z };
        match options.pen {
            PenConvention::Height { threshold_mm } => Some(self.z <= threshold_mm),
            PenConvention::Servo { command: ServoCommand::Z, up, down } => Some(is_nearer(self.z, down, up)),
            _ => None,
        }
    }

    /// Centre and sweep of an arc to `to`.
    fn arc(&self, line: &Line<'_>, to: Point, left: bool) -> Result<(Point, f64), Problem> {
        if !self.sheet {
            return Err(Problem::Plane);
        }
        let number = |letter| line.number(letter).map(|number| number * self.unit_mm);
        let centre = match (number(b'R'), line.has(b"IJ")) {
            (Some(radius_mm), false) => arc::centre(self.at, to, radius_mm, left)?,
            (None, true) if self.absolute_centres => Point::new(
                number(b'I').map_or(self.at.x, |x| x + self.offset.x),
                number(b'J').map_or(self.at.y, |y| y + self.offset.y),
            ),
            (None, true) => {
                self.at + Vec2::new(number(b'I').unwrap_or_default(), number(b'J').unwrap_or_default())
            }
            _ => return Err(Problem::ArcForm),
        };
        Ok((centre, arc::sweep_rad(self.at, to, centre, left)?))
    }

    fn mark(&mut self, to: Point, arc: Option<(Point, f64)>, options: &ReadOptions, out: &mut Outcomes) {
        let share = self.share(options);
        let is_rapid = self.motion == Motion::Rapid;
        let marks = match options.pen {
            PenConvention::Laser { .. } => share > 0.0,
            PenConvention::Motion => !is_rapid,
            _ => self.pen_down,
        };
        if marks {
            self.dot_owed = false;
            self.tell_share(share, options, out);
        } else {
            self.leave_dot(options, out);
        }
        let feed_mm_s = self.feed_mm_s.filter(|_| !is_rapid);
        out.give(Ok(match arc {
            _ if !marks => PlotOp::Travel { to },
            Some((centre, sweep_rad)) => PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s },
            None => PlotOp::Draw { to, feed_mm_s },
        }));
        (self.at, self.settling) = (to, false);
    }

    /// `M0`: the machine waits for a person, who changes the sheet or the pen if the comment says so.
    fn pause(&mut self, line: &Line<'_>, options: &ReadOptions, out: &mut Outcomes) {
        self.settling = false;
        let op = match line.block.remark() {
            Some(Remark::NewSheet) => PlotOp::NewPage,
            Some(Remark::Pen(pen)) => PlotOp::SelectPen { pen },
            None => {
                let is_stop = |word: &&Word| word.letter == b'M' && matches!(word.tenths(), Some(0 | 10));
                if let Some(command) = line.block.words().iter().find(is_stop).copied() {
                    let pause = Problem::Unsupported { command, meaning: "pause" };
                    out.give(Err(pause.at(line.block.place(command))));
                }
                return;
            }
        };
        self.leave_dot(options, out);
        out.give(Ok(op));
    }

    /// `M2`, `M30`: pen up, and what GRBL sets back then.
    fn end(&mut self, options: &ReadOptions, out: &mut Outcomes) {
        self.leave_dot(options, out);
        (self.pen_down, self.spindle, self.beam, self.settling) = (false, Spindle::Off, 0.0, false);
        (self.motion, self.relative, self.sheet, self.inverse_time) = (Motion::Line, false, true, false);
    }
}

fn is_nearer(place: f64, one: f64, other: f64) -> bool {
    (place - one).abs() < (place - other).abs()
}
