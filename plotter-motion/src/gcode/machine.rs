//! [`Machine`]: what holds from one line to the next, and what a line makes of it.

use super::arc;
use super::code::{Code, Group};
use super::error::Complaint;
use super::interpreter::Outcomes;
use super::line::Line;
use super::pen_convention::{LaserCommand, PenConvention, ServoCommand};
use super::{DwellUnit, Modes, Problem, ReadOptions, Remark, SYSTEMS, Word, Words};
use crate::seconds::duration;
use crate::whole::{is_whole, whole};
use crate::{PlotOp, Point, Vec2};

const MM_PER_INCH: f64 = 25.4;
/// The number after `G` of the first coordinate system.
const G54: u8 = 54;

/// What holds from one line to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Machine {
    /// Where the pen is, on the sheet.
    at: Point,
    /// Height of the pen as the text counts it: mm, or what a servo makes of it.
    z: f64,
    /// What is added to a coordinate: what `G10` has set for the coordinate system in force, one of `G54` to `G59`, and `G92` for all.
    origins: [Vec2; SYSTEMS as usize],
    system: u8,
    shift: Vec2,
    unit_mm: f64,
    relative: bool,
    absolute_centres: bool,
    sheet: bool,
    /// What `F` counts: mm a minute, lines a minute, which is told with each line, or mm a turn.
    feed: Code,
    lines_per_s: Option<f64>,
    /// Where `G28` and `G30` go.
    homes: [Point; 2],
    motion: Code,
    feed_mm_s: Option<f64>,
    spindle: Code,
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
    /// What has been given leaves the pen on the sheet.
    on_sheet: bool,
    /// It has been told to lift it, and nothing that lifts it has been given since.
    lift_owed: bool,
}

impl Machine {
    pub(super) fn new() -> Self {
        Self {
            at: Point::ORIGIN,
            z: 0.0,
            origins: [Vec2::new(0.0, 0.0); SYSTEMS as usize],
            system: 0,
            shift: Vec2::new(0.0, 0.0),
            unit_mm: 1.0,
            relative: false,
            absolute_centres: false,
            sheet: true,
            feed: Code::FeedPerMinute,
            lines_per_s: None,
            homes: [Point::ORIGIN; 2],
            motion: Code::Rapid,
            feed_mm_s: None,
            spindle: Code::SpindleOff,
            power: 0.0,
            tool: None,
            pen_down: false,
            dot_owed: false,
            settling: false,
            beam: 0.0,
            told_share: None,
            on_sheet: false,
            lift_owed: false,
        }
    }

    pub(super) fn modes(&self) -> Modes {
        Modes {
            position: self.at,
            offset: self.offset(),
            origin: self.origin(self.system),
            system: self.system,
            inches: self.unit_mm != 1.0,
            relative: self.relative,
            inverse_time: self.feed == Code::InverseTime,
            motion: self.motion_number(),
            feed_mm_s: self.feed_mm_s,
            spindle: spindle_number(self.spindle),
            power: self.power,
            tool: self.tool.unwrap_or(0),
            pen_down: self.pen_down,
        }
    }

    pub(super) const fn motion_number(&self) -> u8 {
        match self.motion {
            Code::Rapid => 0,
            Code::Straight => 1,
            Code::Clockwise => 2,
            Code::CounterClockwise => 3,
            _ => 80,
        }
    }

    /// As switched on, but that the places set by `G10`, `G28.1` and `G30.1` stay.
    pub(super) fn reset(&mut self) {
        *self = Self { origins: self.origins, homes: self.homes, ..Self::new() };
    }

    /// Forgets the places set by `G10`, `G28.1`, `G30.1` and `G92`.
    pub(super) fn restore_origins(&mut self) {
        let Self { origins, homes, shift, .. } = Self::new();
        (self.origins, self.homes, self.shift) = (origins, homes, shift);
    }

    /// Where `G28`, or `G30`, goes.
    pub(super) const fn home_place(&self, second: bool) -> Point {
        let [first, other] = self.homes;
        if second { other } else { first }
    }

    /// Where the origin of a coordinate system lies.
    pub(super) fn origin(&self, system: u8) -> Vec2 {
        self.origins.get(usize::from(system)).copied().unwrap_or_default()
    }

    /// What `G92` adds to that.
    pub(super) const fn shift(&self) -> Vec2 {
        self.shift
    }

    fn offset(&self) -> Vec2 {
        self.origin(self.system) + self.shift
    }

    pub(super) fn stand_at(&mut self, point: Point) {
        self.at = point;
        (self.dot_owed, self.settling) = (false, false);
        // Whoever moves or stops it lifts the pen.
        (self.on_sheet, self.lift_owed) = (false, false);
    }

    /// Gives an operation, and notes where it leaves the pen.
    #[cfg_attr(target_os = "none", inline(never))]
    fn give<C: Complaint>(&mut self, op: PlotOp, out: &mut Outcomes<C>) {
        match op {
            PlotOp::LaserPower { .. } | PlotOp::Dwell { .. } => {}
            _ => {
                self.on_sheet = matches!(op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. });
                self.lift_owed = false;
            }
        }
        out.give(Ok(op));
    }

    /// Lifts the pen where it stands, if it has been told to and no travel has done so: before the machine stands, or at the end.
    pub(super) fn lift<C: Complaint>(&mut self, out: &mut Outcomes<C>) {
        if self.lift_owed {
            self.give(PlotOp::Travel { to: self.at }, out);
        }
    }

    pub(super) fn carry_out<C: Complaint>(
        &mut self,
        line: &Line<'_>,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) -> Result<(), C> {
        self.set_modes(line)?;
        if let ([], Some(Remark::Pen(pen))) = (line.block.words(), line.block.remark()) {
            self.leave_dot(options, out);
            self.give(PlotOp::SelectPen { pen }, out);
        }
        if line.is(Code::ToolChange) {
            let expected = "M6 needs a T before it: which pen";
            let pen = self.tool.ok_or_else(|| Problem::Missing { expected }.at(line.block.position()))?;
            self.leave_dot(options, out);
            self.give(PlotOp::SelectPen { pen }, out);
        }
        self.put_pen(line, options, out);
        match line.of(Group::Action) {
            Some(Code::Dwell) => self.dwell(line, options, out)?,
            Some(Code::Home) => self.home(line, options, out),
            Some(Code::KeepHome) => {
                let [first, second] = &mut self.homes;
                *(if is_second(line) { second } else { first }) = self.at;
            }
            Some(Code::Offset) => self.set_offset(line),
            Some(Code::NoOffset) => self.shift = Vec2::default(),
            Some(Code::Origin) => self.set_origin(line, false),
            Some(Code::OriginHere) => self.set_origin(line, true),
            _ => {}
        }
        self.motion = line.of(Group::Motion).unwrap_or(self.motion);
        let moved = line.may_move() && self.go(line, options, out)?;
        self.switch_laser(moved, options, out);
        match line.of(Group::Stop) {
            Some(Code::Pause) => self.pause(line, options, out),
            Some(_) => self.end(options, out),
            None => {}
        }
        let is_mdraw = matches!(
            options.pen,
            PenConvention::Servo { command: ServoCommand::M1, .. }
                | PenConvention::Laser { command: LaserCommand::M4, .. }
        );
        if let Some(command) = line.undone {
            out.give(Err(C::undone(command, line.block.place(command))));
        // mDraw slows its steps down by A.
        } else if let Some(word) =
            line.unused(self.is_arc()).filter(|word| !(is_mdraw && word.letter == b'A'))
        {
            out.give(Err(Problem::Unused { word }.at(line.block.place(word))));
        }
        Ok(())
    }

    fn set_modes<C: Complaint>(&mut self, line: &Line<'_>) -> Result<(), C> {
        let inches = line.chooses(Code::Inches, self.unit_mm != 1.0);
        self.unit_mm = if inches { MM_PER_INCH } else { 1.0 };
        self.relative = line.chooses(Code::Relative, self.relative);
        self.absolute_centres = line.chooses(Code::AbsoluteCentres, self.absolute_centres);
        self.sheet = line.chooses(Code::Sheet, self.sheet);
        if let Some(tenths) = line.word_of(Group::System as usize).and_then(Word::tenths) {
            self.system = u8::try_from(tenths / 10).unwrap_or_default().saturating_sub(G54);
        }
        let feed = line.of(Group::Feed).unwrap_or(self.feed);
        if feed == Code::InverseTime || feed != self.feed {
            (self.feed, self.feed_mm_s) = (feed, None);
        }
        self.lines_per_s = None;
        let refused = |word: &Word| {
            let expected = match word.letter {
                b'F' => "a speed is above 0",
                _ => "a pen is a whole number from 0 to 255",
            };
            Problem::BadParameter { word: *word, expected }.at(line.block.place(*word))
        };
        if let Some(word) = line.word(b'F').filter(|_| !line.owned()) {
            let feed = word.number.filter(|feed| *feed > 0.0);
            let feed = feed.ok_or_else(|| refused(word))?;
            match self.feed {
                Code::InverseTime => self.lines_per_s = Some(feed / 60.0),
                Code::FeedPerMinute => self.feed_mm_s = Some(feed * self.unit_mm / 60.0),
                // How fast a spindle turns no plotter knows.
                _ => {}
            }
        }
        if let Some(word) = line.word(b'T').filter(|_| !line.owned()) {
            let pen = word.number.filter(|number| is_whole(*number));
            let pen = pen.and_then(|number| u8::try_from(whole(number)).ok());
            let pen = pen.ok_or_else(|| refused(word))?;
            self.tool = Some(pen);
        }
        Ok(())
    }

    /// The words by which this text lifts its pen or switches its laser.
    fn put_pen<C: Complaint>(&mut self, line: &Line<'_>, options: &ReadOptions, out: &mut Outcomes<C>) {
        let told = line.of(Group::Told);
        let asks_s = matches!(told, Some(Code::Beep | Code::ServoAngle | Code::FanOn | Code::FanOff))
            || (line.is(Code::Dwell) && !line.has(b"P"));
        let spindle_s = line.number(b'S').filter(|_| !asks_s && !line.owned());
        if !matches!(options.pen, PenConvention::Laser { .. }) {
            // Whatever lifts the pen, this is what a controller tells that is asked for its state.
            self.power = spindle_s.unwrap_or(self.power);
            self.spindle = line.of(Group::Spindle).unwrap_or(self.spindle);
        }
        match options.pen {
            PenConvention::Spindle => {
                if let Some(spindle) = line.of(Group::Spindle) {
                    self.set_pen(spindle != Code::SpindleOff, options, out);
                }
            }
            PenConvention::SpindleWords { up, down } => {
                if let Some(spindle) = line.of(Group::Spindle) {
                    let number = spindle_number(spindle);
                    if number == up || number == down {
                        self.set_pen(number == down, options, out);
                    }
                }
            }
            PenConvention::Servo { command, up, down } => {
                let place = match (command, told) {
                    (ServoCommand::M300, Some(Code::Beep)) | (ServoCommand::M280, Some(Code::ServoAngle)) => {
                        line.number(b'S')
                    }
                    (ServoCommand::M1, Some(Code::Degrees)) => Some(line.bare),
                    (ServoCommand::M3, _) if !line.is(Code::SpindleOff) => spindle_s,
                    _ => None,
                };
                if let Some(place) = place {
                    self.set_pen(is_nearer(place, down, up), options, out);
                }
            }
            PenConvention::Laser { command, full } => match (command, told) {
                (LaserCommand::Spindle, _) => {
                    self.power = spindle_s.unwrap_or(self.power);
                    self.spindle = line.of(Group::Spindle).unwrap_or(self.spindle);
                }
                (LaserCommand::Fan, Some(told @ (Code::FanOn | Code::FanOff))) => {
                    self.power = line.number(b'S').unwrap_or(full);
                    self.spindle = if told == Code::FanOn { Code::Constant } else { Code::SpindleOff };
                }
                (LaserCommand::M4, Some(Code::LaserPower)) => {
                    (self.power, self.spindle) = (line.bare, Code::Constant);
                }
                _ => {}
            },
            PenConvention::Height { .. } | PenConvention::Motion => {}
        }
    }

    fn set_pen<C: Complaint>(&mut self, down: bool, options: &ReadOptions, out: &mut Outcomes<C>) {
        if down == self.pen_down {
            return;
        }
        if !down {
            self.leave_dot(options, out);
            self.lift_owed = self.on_sheet;
        }
        (self.pen_down, self.dot_owed, self.settling) = (down, down, true);
    }

    /// Share of its power with which the laser burns while it moves as it does now.
    fn share(&self, options: &ReadOptions) -> f64 {
        let PenConvention::Laser { command, full } = options.pen else { return 0.0 };
        let is_dark = command == LaserCommand::Spindle && matches!(self.motion, Code::Rapid | Code::NoMotion);
        if self.spindle == Code::SpindleOff || is_dark {
            return 0.0;
        }
        let share = self.power / full;
        if share > 0.0 { share.min(1.0) } else { 0.0 }
    }

    /// What becomes of a laser at the end of a line: switched on and off without a movement between it leaves a dot.
    fn switch_laser<C: Complaint>(&mut self, moved: bool, options: &ReadOptions, out: &mut Outcomes<C>) {
        let share = self.share(options);
        if !moved && self.beam != share {
            // What it has burnt while it stood, it has burnt with the power that it had.
            self.leave_dot(options, out);
            let begins = self.beam == 0.0;
            self.dot_owed = begins && self.spindle == Code::Constant;
            // A laser needs no time to go out.
            self.settling = begins;
            // What draws a laser's text with a pen lifts it.
            self.lift_owed |= self.on_sheet && self.spindle == Code::SpindleOff;
        }
        self.beam = share;
    }

    pub(super) fn leave_dot<C: Complaint>(&mut self, options: &ReadOptions, out: &mut Outcomes<C>) {
        if core::mem::take(&mut self.dot_owed) {
            self.tell_share(self.beam, options, out);
            self.give(PlotOp::Draw { to: self.at, feed_mm_s: self.feed_mm_s }, out);
        }
    }

    /// As [`LineInterpreter::put_down`](super::LineInterpreter::put_down).
    pub(super) fn put_down(&mut self) -> Option<PlotOp> {
        // That of a laser stays: it would burn.
        if !(self.pen_down && self.dot_owed) {
            return None;
        }
        self.dot_owed = false;
        Some(PlotOp::Draw { to: self.at, feed_mm_s: None })
    }

    fn tell_share<C: Complaint>(&mut self, share: f64, options: &ReadOptions, out: &mut Outcomes<C>) {
        if matches!(options.pen, PenConvention::Laser { .. }) && self.told_share != Some(share) {
            self.told_share = Some(share);
            self.give(PlotOp::LaserPower { share }, out);
        }
    }

    fn dwell<C: Complaint>(
        &mut self,
        line: &Line<'_>,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) -> Result<(), C> {
        let unit_s = if options.dwell_unit == DwellUnit::Seconds { 1.0 } else { 1e-3 };
        let seconds = line.word(b'S').filter(|_| options.words == Words::Any);
        let Some((word, unit_s)) =
            line.word(b'P').map(|word| (word, unit_s)).or(seconds.map(|word| (word, 1.0)))
        else {
            return Err(Problem::Missing { expected: "G4 needs a P: how long" }.at(line.block.position()));
        };
        let seconds = word.number.unwrap_or_default() * unit_s;
        let expected = "a time is not below 0";
        let duration = duration(seconds)
            .ok_or_else(|| Problem::BadParameter { word: *word, expected }.at(line.block.place(*word)))?;
        let settles = core::mem::take(&mut self.settling) && duration <= options.settle;
        if !settles && !duration.is_zero() {
            self.leave_dot(options, out);
            self.lift(out);
            self.give(PlotOp::Dwell { duration }, out);
        }
        Ok(())
    }

    fn home<C: Complaint>(&mut self, line: &Line<'_>, options: &ReadOptions, out: &mut Outcomes<C>) {
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
            // Grbl goes there by way of the place that is named; printers name axes only.
            if !all && options.words == Words::Grbl {
                self.at = self.place(line);
                self.give(PlotOp::Travel { to: self.at }, out);
            }
            let home = self.home_place(is_second(line));
            self.at.x = if all || line.has(b"X") { home.x } else { self.at.x };
            self.at.y = if all || line.has(b"Y") { home.y } else { self.at.y };
            self.settling = false;
            self.give(PlotOp::Travel { to: self.at }, out);
        }
    }

    fn set_offset(&mut self, line: &Line<'_>) {
        let all = !line.has(b"XYZEABC");
        let (unit_mm, origin) = (self.unit_mm, self.origin(self.system));
        for (letter, at, origin, shift) in
            [(b'X', self.at.x, origin.x, &mut self.shift.x), (b'Y', self.at.y, origin.y, &mut self.shift.y)]
        {
            if all || line.gives(letter) {
                *shift = at - line.number(letter).unwrap_or_default() * unit_mm - origin;
            }
        }
        if all || line.gives(b'Z') {
            self.z = line.number(b'Z').unwrap_or_default();
        }
    }

    fn set_origin(&mut self, line: &Line<'_>, here: bool) {
        // 0 is the one in force.
        let chosen = whole(line.number(b'P').unwrap_or_default());
        let system = chosen.checked_sub(1).and_then(|system| u8::try_from(system).ok());
        let Some(origin) = self.origins.get_mut(usize::from(system.unwrap_or(self.system))) else { return };
        // The offset of G92 stays on top of it.
        for (letter, at, shift, origin) in
            [(b'X', self.at.x, self.shift.x, &mut origin.x), (b'Y', self.at.y, self.shift.y, &mut origin.y)]
        {
            let Some(number) = line.number(letter) else { continue };
            let place = number * self.unit_mm;
            *origin = if here { at - place - shift } else { place };
        }
    }

    /// The movement of a line, if it has one.
    fn go<C: Complaint>(
        &mut self,
        line: &Line<'_>,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) -> Result<bool, C> {
        let at = line.block.position();
        let moves = line.has(b"XY") || (self.is_arc() && line.has(b"IJR"));
        if !moves && !line.has(b"Z") {
            return Ok(false);
        }
        let to = self.place(line);
        if self.motion == Code::NoMotion {
            if line.undone.is_none() {
                return Err(Problem::NoMotion.at(at));
            }
            // A spline and its like have been reported: what follows it is to begin where it would have ended.
            if moves {
                self.leave_dot(options, out);
                self.give(PlotOp::Travel { to }, out);
                (self.at, self.settling) = (to, false);
            }
            return Ok(false);
        }
        let arc = if moves && self.is_arc() { Some(self.arc(line, to)?) } else { None };
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

    /// The height that the text has told.
    pub(super) const fn height_told(&self) -> f64 {
        self.z
    }

    pub(super) fn set_shift(&mut self, shift: Vec2) {
        self.shift = shift;
    }

    /// Exchanges the origin of the last coordinate system for another one.
    pub(super) fn exchange_last_origin(&mut self, origin: &mut Vec2) {
        if let Some(last) = self.origins.last_mut() {
            core::mem::swap(last, origin);
        }
    }

    /// The place where the pen stands has these coordinates from here on.
    pub(super) fn relocate(&mut self, point: Point) {
        self.at = point;
    }

    /// Goes to the end of a movement that is left out, with the pen up.
    pub(super) fn leave_out<C: Complaint>(
        &mut self,
        line: &Line<'_>,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) -> Result<(), C> {
        self.set_modes(line)?;
        self.put_pen(line, options, out);
        self.motion = line.of(Group::Motion).unwrap_or(self.motion);
        if line.has(b"XY") && line.may_move() {
            let to = self.place(line);
            self.leave_dot(options, out);
            self.give(PlotOp::Travel { to }, out);
            (self.at, self.settling) = (to, false);
        }
        if let Some(is_down) = self.height(line, options) {
            self.set_pen(is_down, options, out);
        }
        Ok(())
    }

    /// As [`LineInterpreter::travel`](super::LineInterpreter::travel).
    pub(super) fn travel<C: Complaint>(&mut self, line: &Line<'_>) -> Result<Option<Point>, C> {
        self.set_modes(line)?;
        Ok(line.has(b"XY").then(|| self.place(line)))
    }

    /// The place that the coordinates of a line name.
    fn place(&self, line: &Line<'_>) -> Point {
        let origin = if line.is(Code::MachineCoordinates) {
            Point::ORIGIN
        } else if self.relative {
            self.at
        } else {
            self.work_origin()
        };
        self.named(line, &origin, [b'X', b'Y'])
    }

    fn work_origin(&self) -> Point {
        let offset = self.offset();
        Point::new(offset.x, offset.y)
    }

    /// The place that two letters name, from an origin; it is that of the pen where they are not there.
    #[cfg_attr(target_os = "none", inline(never))]
    fn named(&self, line: &Line<'_>, origin: &Point, [x, y]: [u8; 2]) -> Point {
        let mut place = self.at;
        for (letter, place, origin) in [(x, &mut place.x, origin.x), (y, &mut place.y, origin.y)] {
            if let Some(number) = line.number(letter) {
                *place = number * self.unit_mm + origin;
            }
        }
        place
    }

    /// Whether the Z of a line puts the pen down.
    fn height(&mut self, line: &Line<'_>, options: &ReadOptions) -> Option<bool> {
        if line.is(Code::MachineCoordinates) && line.has(b"Z") {
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
    fn arc<C: Complaint>(&self, line: &Line<'_>, to: Point) -> Result<(Point, f64), C> {
        let (at, left) = (line.block.position(), self.motion == Code::CounterClockwise);
        if !self.sheet {
            return Err(Problem::Plane.at(at));
        }
        let centre = match (line.number(b'R'), line.has(b"IJ")) {
            (Some(radius), false) => arc::centre(self.at, to, radius * self.unit_mm, left, at)?,
            (None, true) => {
                let origin = if self.absolute_centres { self.work_origin() } else { self.at };
                self.named(line, &origin, [b'I', b'J'])
            }
            _ => return Err(Problem::ArcForm.at(at)),
        };
        Ok((centre, arc::sweep_rad(self.at, to, centre, left, at)?))
    }

    fn is_arc(&self) -> bool {
        matches!(self.motion, Code::Clockwise | Code::CounterClockwise)
    }

    fn mark<C: Complaint>(
        &mut self,
        to: Point,
        arc: Option<(Point, f64)>,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) {
        let share = self.share(options);
        let is_rapid = self.motion == Code::Rapid;
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
        if let Some(lines_per_s) = self.lines_per_s {
            let way_mm = match arc {
                Some((centre, sweep_rad)) => self.at.distance(centre) * sweep_rad.abs(),
                None => self.at.distance(to),
            };
            self.feed_mm_s = Some(way_mm * lines_per_s);
        }
        let feed_mm_s = self.feed_mm_s.filter(|_| !is_rapid);
        let op = match arc {
            _ if !marks => PlotOp::Travel { to },
            Some((centre, sweep_rad)) => PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s },
            None => PlotOp::Draw { to, feed_mm_s },
        };
        self.give(op, out);
        (self.at, self.settling) = (to, false);
    }

    /// `M0`: the machine waits for a person, who changes the sheet or the pen if the comment says so.
    fn pause<C: Complaint>(&mut self, line: &Line<'_>, options: &ReadOptions, out: &mut Outcomes<C>) {
        self.settling = false;
        let op = match line.block.remark() {
            Some(Remark::NewSheet) => PlotOp::NewPage,
            Some(Remark::Pen(pen)) => PlotOp::SelectPen { pen },
            None => {
                self.lift(out);
                if let Some(command) = line.word_of(Group::Stop as usize) {
                    out.give(Err(C::undone(command, line.block.place(command))));
                }
                return;
            }
        };
        self.leave_dot(options, out);
        self.give(op, out);
    }

    /// `M2`, `M30`: pen up, and what GRBL sets back then.
    fn end<C: Complaint>(&mut self, options: &ReadOptions, out: &mut Outcomes<C>) {
        self.leave_dot(options, out);
        self.lift_owed = self.on_sheet;
        (self.pen_down, self.spindle, self.beam, self.settling) = (false, Code::SpindleOff, 0.0, false);
        (self.motion, self.relative, self.sheet, self.feed) =
            (Code::Straight, false, true, Code::FeedPerMinute);
        self.system = 0;
    }
}

/// Whether `G30` or `G30.1` asks for it, not `G28`.
fn is_second(line: &Line<'_>) -> bool {
    line.word_of(Group::Action as usize).and_then(Word::tenths) >= Some(300)
}

/// The number after its `M`.
pub(super) const fn spindle_number(spindle: Code) -> u8 {
    match spindle {
        Code::Constant => 3,
        Code::Dynamic => 4,
        _ => 5,
    }
}

fn is_nearer(place: f64, one: f64, other: f64) -> bool {
    (place - one).abs() < (place - other).abs()
}
