//! The movement of a line.

use super::{ALONG_X, Machine, SHEET, is_nearer};
use crate::gcode::code::{Code, Group};
use crate::gcode::error::Complaint;
use crate::gcode::interpreter::Outcomes;
use crate::gcode::line::Line;
use crate::gcode::{PenConvention, Problem, ReadOptions, ServoCommand, Words, arc};
use crate::{PlotOp, Point};

impl Machine {
    /// The movement of a line, if it has one.
    pub(super) fn go<C: Complaint>(
        &mut self,
        line: &Line<'_>,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) -> Result<bool, C> {
        let at = line.block.position();
        let is_arc = self.is_arc();
        let moves = line.has(b"XY") || (is_arc && self.lies(options) && line.has(b"IJR"));
        if !moves && !line.has(b"Z") {
            return Ok(false);
        }
        let to = self.place(line);
        if self.motion == Code::NoMotion {
            if line.undone.is_none() {
                return Err(Problem::NoMotion.at(at));
            }
            // A spline and its like have been reported: what follows it is to begin where it would have
            // ended.
            if moves {
                self.leave_dot(options, out);
                self.give(PlotOp::Travel { to }, out);
                (self.at, self.settling) = (to, false);
            }
            return Ok(false);
        }
        let arc = if is_arc { self.arc(line, to, options)? } else { None };
        // A pen that goes up on the way does so before, one that goes down after it: it marks from end to end
        // or not at all.
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
    pub(in crate::gcode) const fn height_told(&self) -> f64 {
        self.z
    }

    /// Goes to the end of a movement that is left out, with the pen up.
    pub(in crate::gcode) fn leave_out<C: Complaint>(
        &mut self,
        line: &Line<'_>,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) -> Result<(), C> {
        self.set_modes(line)?;
        self.set_plane(line);
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
    pub(in crate::gcode) fn travel<C: Complaint>(&mut self, line: &Line<'_>) -> Result<Option<Point>, C> {
        self.set_modes(line)?;
        Ok(line.has(b"XY").then(|| self.place(line)))
    }

    /// The place that the coordinates of a line name.
    pub(super) fn place(&self, line: &Line<'_>) -> Point {
        let origin = if line.is(Code::MachineCoordinates) {
            Point::ORIGIN
        } else if self.relative {
            self.at
        } else {
            self.work_origin()
        };
        self.named(line, &origin, self.at, [b'X', b'Y'])
    }

    pub(super) fn work_origin(&self) -> Point {
        let offset = self.offset();
        Point::new(offset.x, offset.y)
    }

    /// The place that two letters name, from an origin; `place` is kept where they are not there.
    #[cfg_attr(target_os = "none", inline(never))]
    fn named(&self, line: &Line<'_>, origin: &Point, mut place: Point, [x, y]: [u8; 2]) -> Point {
        for (letter, place, origin) in [(x, &mut place.x, origin.x), (y, &mut place.y, origin.y)] {
            if let Some(number) = line.number(letter) {
                *place = number * self.unit_mm + origin;
            }
        }
        place
    }

    /// Whether the Z of a line puts the pen down.
    pub(super) fn height(&mut self, line: &Line<'_>, options: &ReadOptions) -> Option<bool> {
        if line.is(Code::MachineCoordinates) && line.has(b"Z") {
            // Zero is the top there.
            return Some(false);
        }
        line.number(b'Z')?;
        self.z = self.height_to(line, options);
        match options.pen {
            PenConvention::Height { threshold_mm } => Some(self.z + self.length_mm <= threshold_mm),
            PenConvention::Servo { command: ServoCommand::Z, up, down } => Some(is_nearer(self.z, down, up)),
            _ => None,
        }
    }

    /// The height at the end of a line.
    fn height_to(&self, line: &Line<'_>, options: &ReadOptions) -> f64 {
        let Some(z) = line.number(b'Z') else { return self.z };
        let z = z * self.height_unit(options);
        if self.relative { self.z + z } else { z }
    }

    /// What a height counts, mm; 1 where it is a servo's place.
    pub(super) fn height_unit(&self, options: &ReadOptions) -> f64 {
        if let PenConvention::Servo { command: ServoCommand::Z, .. } = options.pen {
            1.0
        } else {
            self.unit_mm
        }
    }

    /// Centre and sweep of an arc to `to`. One that stands on the sheet is a line there; Grbl is asked
    /// whether it is an arc.
    fn arc<C: Complaint>(
        &self,
        line: &Line<'_>,
        to: Point,
        options: &ReadOptions,
    ) -> Result<Option<(Point, f64)>, C> {
        let (at, left) = (line.block.position(), self.motion == Code::CounterClockwise);
        let lies = self.lies(options);
        if !lies && options.words == Words::Any {
            return Ok(None);
        }
        let z = self.height_to(line, options);
        // Both axes in the order in which the plane turns left.
        let (from, to, letters) = match self.plane {
            _ if lies => (self.at, to, [b'I', b'J']),
            ALONG_X => (Point::new(self.z, self.at.x), Point::new(z, to.x), [b'K', b'I']),
            _ => (Point::new(self.at.y, self.z), Point::new(to.y, z), [b'J', b'K']),
        };
        let centre = match (line.number(b'R'), line.has(&letters)) {
            (Some(radius), false) => arc::centre(from, to, radius * self.unit_mm, left, at)?,
            (None, true) => {
                let origin = if self.absolute_centres { self.work_origin() } else { from };
                self.named(line, &origin, from, letters)
            }
            _ => return Err(Problem::ArcForm.at(at)),
        };
        let sweep_rad = arc::sweep_rad(from, to, centre, left, at)?;
        Ok(lies.then_some((centre, sweep_rad)))
    }

    /// What a line says of the plane of arcs, and of the length of the tool.
    pub(super) fn set_plane(&mut self, line: &Line<'_>) {
        self.plane = line.whole_of(Group::Plane).unwrap_or(self.plane);
        match line.of(Group::Length) {
            Some(Code::Length) => self.length_mm = line.number(b'Z').unwrap_or_default() * self.unit_mm,
            Some(_) => self.length_mm = 0.0,
            None => {}
        }
    }

    /// Whether arcs lie in the sheet.
    fn lies(&self, options: &ReadOptions) -> bool {
        options.words == Words::GrblOnSheet || self.plane == SHEET
    }

    /// Words that the movement of a line uses beside its end.
    pub(super) fn words_of_arc(&self, options: &ReadOptions) -> &'static [u8] {
        match self.is_arc() {
            false => b"",
            // To Grbl the third belongs to the plane, too.
            true if self.lies(options) && options.words == Words::Any => b"IJR",
            true => b"IJKR",
        }
    }

    pub(super) fn is_arc(&self) -> bool {
        matches!(self.motion, Code::Clockwise | Code::CounterClockwise)
    }

    pub(super) fn mark<C: Complaint>(
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
}
