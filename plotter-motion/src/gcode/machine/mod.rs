//! [`Machine`]: what holds from one line to the next, and what a line makes of it.

mod movement;
mod pen;

use super::code::{Code, Group};
use super::error::Complaint;
use super::interpreter::Outcomes;
use super::line::Line;
use super::modes::MM_PER_INCH;
use super::pen_convention::{LaserCommand, PenConvention, ServoCommand};
use super::{DwellUnit, Modes, Problem, ReadOptions, Remark, SYSTEMS, Word, Words};
use crate::seconds::duration;
use crate::whole::{is_whole, whole};
use crate::{PlotOp, Point, Vec2};

/// The number after `G` of the first coordinate system.
const G54: u8 = 54;
/// The number after `G` of the plane of the sheet, and of the one along x; the third is that along y.
const SHEET: u8 = 17;
const ALONG_X: u8 = 18;

/// What holds from one line to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Machine {
    /// Where the pen is, on the sheet.
    at: Point,
    /// Height of the pen as the text counts it: mm, or what a servo makes of it.
    z: f64,
    /// What is added to a coordinate: what `G10` has set for the coordinate system in force, one of `G54` to
    /// `G59`, and `G92` for all.
    origins: [Vec2; SYSTEMS as usize],
    system: u8,
    shift: Vec2,
    unit_mm: f64,
    relative: bool,
    absolute_centres: bool,
    /// In which plane arcs lie, the number after `G`.
    plane: u8,
    /// What `G43.1` adds to a height, mm.
    length_mm: f64,
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
            plane: SHEET,
            length_mm: 0.0,
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
            plane: self.plane,
            length_mm: self.length_mm,
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

    pub(super) fn carry_out<C: Complaint>(
        &mut self,
        line: &Line<'_>,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) -> Result<(), C> {
        self.set_modes(line)?;
        if options.words != Words::GrblOnSheet {
            self.set_plane(line);
        }
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
            Some(Code::Offset) => self.set_offset(line, options),
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
            line.unused(self.words_of_arc(options)).filter(|word| !(is_mdraw && word.letter == b'A'))
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
        if let Some(number) = line.whole_of(Group::System) {
            self.system = number.saturating_sub(G54);
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
            if !all && options.words.is_grbl() {
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

    fn set_offset(&mut self, line: &Line<'_>, options: &ReadOptions) {
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
            self.z = line.number(b'Z').unwrap_or_default() * self.height_unit(options);
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
        (self.motion, self.relative, self.plane, self.feed) =
            (Code::Straight, false, SHEET, Code::FeedPerMinute);
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
