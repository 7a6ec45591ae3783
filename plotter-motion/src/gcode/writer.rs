//! [`Writer`]: plot operations in, G-code text out.

use super::{DwellUnit, PenChange, PenControl, WriteError, WriteOptions};
use crate::{Pen, PlotOp, Point};
use core::f64::consts::{PI, TAU};
use core::fmt;
use core::time::Duration;

/// Most decimals: 10⁹ mm with them still fit into 53 bits.
const MOST_DECIMALS: u8 = 6;

/// Most that one G2 or G3 spans, rad: three quarters of a turn.
const MOST_RAD: f64 = 1.5 * PI;

/// Greatest coordinate, mm.
const MOST_MM: f64 = 1e9;

/// Greatest speed, mm/min.
const MOST_MM_MIN: f64 = 1e9;

/// A coordinate as it is written: a whole number of the last decimal.
type Steps = (i64, i64);

/// Writes plot operations as G-code: see the [module](super) for the words.
///
/// - `G21` and `G90` come first, and the pen is lifted; [`Writer::finish`] lifts it and writes `M2`.
/// - One move a line, both coordinates, rounded to [`WriteOptions::decimals`], halves away from zero, without
///   trailing zeros and never with an exponent. Nothing is clamped: a point out of range is refused with
///   [`WriteError::Point`].
/// - A travel is `G0` with the pen up. A line is `G1` with the pen down, with `F` in mm/min where the speed
///   changes. A line to where the pen stands is a dot, or nothing within a stroke.
/// - An arc is `G2` or `G3` with its centre from where it begins.
/// - The power of a laser is written where the next line begins, for [`PenControl::Laser`] only.
/// - Another pen is asked for with the pen up, as [`WriteOptions::pen_change`] says; pen 0 is none to ask
///   for. The pen that draws first is in the holder already: it is named, `(pen 1)`, and nothing waits. A new
///   sheet is `M0 (new sheet)`. A dwell is `G4`.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, gcode};
/// # use core::time::Duration;
/// let options = gcode::WriteOptions { settle: Duration::ZERO, ..Default::default() };
/// let mut writer = gcode::Writer::with_options(String::new(), options);
/// writer.push(PlotOp::Travel { to: Point::new(10.0, 10.0) })?;
/// writer.push(PlotOp::Draw { to: Point::new(20.0, 10.0), feed_mm_s: Some(25.0) })?;
/// writer.arc(Point::new(20.0, 15.0), std::f64::consts::PI, Point::new(20.0, 20.0), Some(25.0))?;
/// let text = writer.finish()?;
/// assert_eq!(text, "G21\nG90\nM5\nG0 X10 Y10\nM3 S90\nG1 X20 Y10 F1500\nG3 X20 Y20 I0 J5\nM5\nM2\n");
/// # Ok::<(), gcode::WriteError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Writer<'a, W> {
    out: W,
    options: WriteOptions<'a>,
    index: u64,
    /// Where the text has put the pen; `None` before the first line.
    pen: Option<Pen>,
    /// The pen that was asked for last, 0 for whichever has drawn without; `None` while none has drawn.
    holder: Option<u8>,
    /// Where the text has put the machine; `None` before the first movement.
    at: Option<Steps>,
    /// The speed in force, hundredths of a mm/min.
    feed: Option<i64>,
    /// Share of its power with which a laser is to burn, and the `S` in force while it does.
    share: f64,
    power: Option<i64>,
}

impl<'a, W: fmt::Write> Writer<'a, W> {
    /// A writer into `out` with the default options.
    pub fn new(out: W) -> Self {
        Self::with_options(out, WriteOptions::default())
    }

    /// A writer into `out`.
    pub fn with_options(out: W, options: WriteOptions<'a>) -> Self {
        Self {
            out,
            options,
            index: 0,
            pen: None,
            holder: None,
            at: None,
            feed: None,
            share: 1.0,
            power: None,
        }
    }

    /// Writes one operation.
    ///
    /// # Errors
    ///
    /// A point or speed that cannot be written is refused and left out; the writer goes on with the next
    /// operation as if it had not been there.
    pub fn push(&mut self, op: PlotOp) -> Result<(), WriteError> {
        let index = self.index;
        self.index += 1;
        match op {
            PlotOp::Travel { to } => {
                let to = self.steps(index, to)?;
                self.put(Pen::Up)?;
                self.travel(to)?;
            }
            PlotOp::Draw { to, feed_mm_s } => {
                let (to, feed) = (self.steps(index, to)?, self.feed(index, feed_mm_s)?);
                self.begin_line(to != self.at.unwrap_or_default(), feed)?;
                self.line(to, feed)?;
            }
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                self.index = index;
                self.arc(centre, sweep_rad, to, feed_mm_s)?;
            }
            PlotOp::LaserPower { share } => {
                if !(0.0..=1.0).contains(&share) {
                    return Err(WriteError::Power { index, share });
                }
                self.share = share;
            }
            PlotOp::SelectPen { pen } => {
                self.put(Pen::Up)?;
                if pen > 0 && self.holder != Some(pen) {
                    let is_first = self.holder.replace(pen).is_none();
                    match self.options.pen_change {
                        PenChange::Pause if is_first => writeln!(self.out, "(pen {pen})")?,
                        PenChange::Pause => writeln!(self.out, "M0 (pen {pen})")?,
                        PenChange::Tool => writeln!(self.out, "T{pen} M6")?,
                    }
                }
            }
            PlotOp::Dwell { duration } => {
                self.start()?;
                self.dwell(duration)?;
            }
            PlotOp::NewPage => {
                self.put(Pen::Up)?;
                self.out.write_str("M0 (new sheet)\n")?;
            }
        }
        Ok(())
    }

    /// Draws an arc about `centre` from where the pen stands to `to`, counter-clockwise for a sweep above 0:
    /// as `G3`, or `G2`. One of more than three quarters of a turn is written as two halves, for where both
    /// ends are nearly one place the text would hardly say which way round is meant. An arc that rises less
    /// than half the last decimal over its chord is a line.
    ///
    /// The circle is the one about `centre` through `to`; where the pen stands ought to be on it.
    ///
    /// # Errors
    ///
    /// As [`Writer::push`]; and [`WriteError::Point`] of the centre where the sweep is no angle of at most a
    /// whole turn.
    pub fn arc(
        &mut self,
        centre: Point,
        sweep_rad: f64,
        to: Point,
        feed_mm_s: Option<f64>,
    ) -> Result<(), WriteError> {
        let index = self.index;
        self.index += 1;
        let (end, feed) = (self.steps(index, to)?, self.feed(index, feed_mm_s)?);
        let middle = self.steps(index, centre)?;
        if !(-TAU..=TAU).contains(&sweep_rad) {
            return Err(self.refused(index, centre));
        }
        let out = to - centre;
        let parts = if sweep_rad.abs() > MOST_RAD { 2.0 } else { 1.0 };
        let half_step = 0.5 / self.scale();
        let rise = out.length() * (1.0 - libm::cos(0.5 * sweep_rad / parts));
        let half_way = self.steps(index, centre + out.rotated(-0.5 * sweep_rad))?;
        let ends = [half_way, end];
        let here = self.at.unwrap_or_default();
        let moves = if parts < 2.0 { end != here } else { ends.iter().any(|to| *to != here) };
        self.begin_line(moves, feed)?;
        for to in ends.into_iter().skip(usize::from(parts < 2.0)) {
            let from = self.at.unwrap_or_default();
            if rise < half_step || from == to {
                self.line(to, feed)?;
                continue;
            }
            self.out.write_str(if sweep_rad > 0.0 { "G3" } else { "G2" })?;
            self.coordinates(('X', 'Y'), to)?;
            self.coordinates(('I', 'J'), (middle.0 - from.0, middle.1 - from.1))?;
            self.end_line(feed)?;
            self.at = Some(to);
        }
        Ok(())
    }

    /// Lifts the pen where it is, if it is not lifted; the operations that come next lower it as they need
    /// it.
    ///
    /// # Errors
    ///
    /// As [`Writer::finish`].
    pub fn lift(&mut self) -> Result<(), WriteError> {
        self.put(Pen::Up)
    }

    /// Output so far: a host that sends lines as they come takes them out of here.
    pub fn out_mut(&mut self) -> &mut W {
        &mut self.out
    }

    /// Ends the drawing: pen up, end of the program. Gives the sink back.
    ///
    /// # Errors
    ///
    /// [`WriteError::Output`] when the sink refuses the text, [`WriteError::Height`] when the pen has no
    /// height.
    pub fn finish(mut self) -> Result<W, WriteError> {
        self.put(Pen::Up)?;
        self.out.write_str("M2\n")?;
        Ok(self.out)
    }

    fn decimals(&self) -> u8 {
        self.options.decimals.min(MOST_DECIMALS)
    }

    /// Steps in a mm.
    fn scale(&self) -> f64 {
        (0..self.decimals()).fold(1.0, |scale, _| scale * 10.0)
    }

    /// Whether a coordinate can be written; not so what is no number.
    fn is_within(&self, coordinate_mm: f64) -> bool {
        coordinate_mm.abs() <= self.options.limit_mm.min(MOST_MM)
    }

    fn refused(&self, index: u64, to: Point) -> WriteError {
        WriteError::Point { index, to, limit_mm: self.options.limit_mm }
    }

    fn steps(&self, index: u64, to: Point) -> Result<Steps, WriteError> {
        if !(self.is_within(to.x) && self.is_within(to.y)) {
            return Err(self.refused(index, to));
        }
        Ok((whole(to.x * self.scale()), whole(to.y * self.scale())))
    }

    fn feed(&self, index: u64, feed_mm_s: Option<f64>) -> Result<i64, WriteError> {
        let feed_mm_s = feed_mm_s.unwrap_or(self.options.feed_mm_s);
        let feed_mm_min = 60.0 * feed_mm_s;
        let feed = if feed_mm_min.abs() <= MOST_MM_MIN { whole(feed_mm_min * 100.0) } else { 0 };
        if feed > 0 { Ok(feed) } else { Err(WriteError::Feed { index, feed_mm_s }) }
    }

    fn start(&mut self) -> Result<(), WriteError> {
        if self.pen.is_none() {
            // First what may be refused: then nothing has been written.
            if let PenControl::Height { up_mm, down_mm } = self.options.pen {
                for height_mm in [up_mm, down_mm] {
                    if !self.is_within(height_mm) {
                        return Err(WriteError::Height { height_mm });
                    }
                }
            }
            self.out.write_str("G21\nG90\n")?;
            self.pen = Some(Pen::Up);
            self.write_pen(Pen::Up)?;
        }
        Ok(())
    }

    fn put(&mut self, pen: Pen) -> Result<(), WriteError> {
        self.start()?;
        if self.pen != Some(pen) {
            self.pen = Some(pen);
            self.write_pen(pen)?;
            if !matches!(self.options.pen, PenControl::Laser { .. }) {
                self.dwell(self.options.settle)?;
            }
        }
        Ok(())
    }

    /// The laser as it has to burn for a line, or for a dot, which does not move.
    fn burn(&mut self, full: u32, moves: bool, feed: i64) -> fmt::Result {
        let power = whole(self.share * f64::from(full));
        let is_dot = self.pen != Some(Pen::Down) && !moves;
        if is_dot {
            // GRBL's laser is dark until the machine is told to draw.
            self.out.write_str("G1")?;
            self.end_line(feed)?;
        }
        if self.pen != Some(Pen::Down) {
            self.pen = Some(Pen::Down);
            writeln!(self.out, "{} S{power}", if is_dot { "M3" } else { "M4" })?;
            if is_dot {
                self.dwell(self.options.settle)?;
            }
        } else if !moves || self.power == Some(power) {
            return Ok(());
        } else {
            writeln!(self.out, "S{power}")?;
        }
        self.power = Some(power);
        Ok(())
    }

    fn write_pen(&mut self, pen: Pen) -> fmt::Result {
        match (self.options.pen, pen) {
            (PenControl::Spindle { .. } | PenControl::Laser { .. }, Pen::Up) => self.out.write_str("M5\n"),
            (PenControl::Spindle { down }, Pen::Down) => writeln!(self.out, "M3 S{down}"),
            (PenControl::Height { up_mm, .. }, Pen::Up) => {
                self.out.write_str("G0 Z")?;
                self.number(whole(up_mm * self.scale()), self.decimals())?;
                self.out.write_str("\n")
            }
            (PenControl::Height { down_mm, .. }, Pen::Down) => {
                self.out.write_str("G1 Z")?;
                self.number(whole(down_mm * self.scale()), self.decimals())?;
                // Lowered at the speed of drawing, the last one or the usual one: the first G1 needs one.
                let feed = self.feed.or_else(|| self.feed(0, None).ok());
                match feed {
                    Some(feed) => self.end_line(feed),
                    None => self.out.write_str("\n"),
                }
            }
            // What `burn` does.
            (PenControl::Laser { .. }, Pen::Down) => Ok(()),
            (PenControl::Commands { up, .. }, Pen::Up) => writeln!(self.out, "{up}"),
            (PenControl::Commands { down, .. }, Pen::Down) => writeln!(self.out, "{down}"),
        }
    }

    fn dwell(&mut self, duration: Duration) -> fmt::Result {
        if duration.is_zero() {
            return Ok(());
        }
        let millis = i64::try_from(duration.as_millis()).unwrap_or(i64::MAX);
        self.out.write_str("G4 P")?;
        self.number(millis, if self.options.dwell_unit == DwellUnit::Seconds { 3 } else { 0 })?;
        self.out.write_str("\n")
    }

    /// The pen down where it stands, at the origin if nothing else was said, for a line or for a dot, which
    /// does not move.
    fn begin_line(&mut self, moves: bool, feed: i64) -> Result<(), WriteError> {
        self.start()?;
        self.holder.get_or_insert(0);
        if self.at.is_none() {
            self.travel((0, 0))?;
        }
        match self.options.pen {
            PenControl::Laser { full } => Ok(self.burn(full, moves, feed)?),
            _ => self.put(Pen::Down),
        }
    }

    fn travel(&mut self, to: Steps) -> fmt::Result {
        self.out.write_str("G0")?;
        self.coordinates(('X', 'Y'), to)?;
        self.at = Some(to);
        self.out.write_str("\n")
    }

    fn line(&mut self, to: Steps, feed: i64) -> fmt::Result {
        if self.at == Some(to) {
            return Ok(());
        }
        self.out.write_str("G1")?;
        self.coordinates(('X', 'Y'), to)?;
        self.at = Some(to);
        self.end_line(feed)
    }

    fn coordinates(&mut self, (x, y): (char, char), steps: Steps) -> fmt::Result {
        let decimals = self.decimals();
        write!(self.out, " {x}")?;
        self.number(steps.0, decimals)?;
        write!(self.out, " {y}")?;
        self.number(steps.1, decimals)
    }

    /// The speed, if it is another one, and the end of the line.
    fn end_line(&mut self, feed: i64) -> fmt::Result {
        if self.feed != Some(feed) {
            self.feed = Some(feed);
            self.out.write_str(" F")?;
            self.number(feed, 2)?;
        }
        self.out.write_str("\n")
    }

    /// A whole number of the last decimal, without trailing zeros.
    fn number(&mut self, steps: i64, decimals: u8) -> fmt::Result {
        let scale = (0..decimals).fold(1_u64, |scale, _| scale * 10);
        let (whole, mut part) = (steps.unsigned_abs() / scale, steps.unsigned_abs() % scale);
        write!(self.out, "{}{whole}", if steps < 0 { "-" } else { "" })?;
        let mut digits = usize::from(decimals);
        while part > 0 && part.is_multiple_of(10) {
            part /= 10;
            digits -= 1;
        }
        if part > 0 { write!(self.out, ".{part:0digits$}") } else { Ok(()) }
    }
}

/// To the nearest, halves away from zero; below 2⁵³ by the limits.
fn whole(number: f64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "a whole number, saturating")]
    let whole = libm::round(number) as i64;
    whole
}

/// Writes a whole drawing as G-code, as [`Writer`] does with its default options.
///
/// # Errors
///
/// The first operation that G-code cannot say ends the writing: the text so far stays in `out`, and is not a
/// whole drawing.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, gcode};
/// let dot = [
///     PlotOp::Travel { to: Point::new(1.0, 2.5) },
///     PlotOp::Draw { to: Point::new(1.0, 2.5), feed_mm_s: None },
/// ];
/// let mut text = String::new();
/// gcode::write_ops(dot, &mut text)?;
/// assert_eq!(text, "G21\nG90\nM5\nG0 X1 Y2.5\nM3 S90\nG4 P0.15\nM5\nG4 P0.15\nM2\n");
/// # Ok::<(), gcode::WriteError>(())
/// ```
pub fn write_ops<W: fmt::Write>(
    ops: impl IntoIterator<Item = PlotOp>,
    out: &mut W,
) -> Result<(), WriteError> {
    let mut writer = Writer::new(out);
    for op in ops {
        writer.push(op)?;
    }
    writer.finish().map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::{String, ToString};
    use std::vec::Vec;

    fn travel(x: f64, y: f64) -> PlotOp {
        PlotOp::Travel { to: Point::new(x, y) }
    }

    fn draw(x: f64, y: f64) -> PlotOp {
        PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None }
    }

    fn quick<'a>() -> WriteOptions<'a> {
        WriteOptions { settle: Duration::ZERO, ..WriteOptions::default() }
    }

    fn written(options: WriteOptions<'_>, ops: &[PlotOp]) -> String {
        let mut writer = Writer::with_options(String::new(), options);
        ops.iter().for_each(|op| writer.push(*op).unwrap());
        writer.finish().unwrap()
    }

    #[test]
    fn numbers_are_as_short_as_can_be() {
        let mut writer = Writer::with_options(String::new(), quick());
        for (x, y) in [(0.0004, -0.0004), (-1.5, 0.1 + 0.2), (99_999.999_6, -1e-300), (1e5, 12.0005)] {
            writer.push(travel(x, y)).unwrap();
        }
        let text = writer.finish().unwrap();
        let lines: Vec<&str> = text.lines().skip(3).collect();
        assert_eq!(lines, ["G0 X0 Y0", "G0 X-1.5 Y0.3", "G0 X100000 Y0", "G0 X100000 Y12.001", "M2"]);
    }

    #[test]
    fn the_pen_is_lifted_as_the_machine_wants_it() {
        let stroke = [travel(1.0, 1.0), draw(2.0, 1.0), draw(2.0, 1.0), draw(2.0, 1.0004), draw(3.0, 1.0)];
        let height = WriteOptions { pen: PenControl::Height { up_mm: 4.5, down_mm: -0.25 }, ..quick() };
        assert_eq!(
            written(height, &stroke),
            "G21\nG90\nG0 Z4.5\nG0 X1 Y1\nG1 Z-0.25 F1800\nG1 X2 Y1\nG1 X3 Y1\nG0 Z4.5\nM2\n"
        );
        let unicorn =
            WriteOptions { pen: PenControl::Commands { up: "M300 S50", down: "M300 S30" }, ..quick() };
        assert_eq!(
            written(unicorn, &stroke),
            "G21\nG90\nM300 S50\nG0 X1 Y1\nM300 S30\nG1 X2 Y1 F1800\nG1 X3 Y1\nM300 S50\nM2\n"
        );
    }

    #[test]
    fn a_laser_is_told_its_power_where_a_line_begins() {
        let power = |share| PlotOp::LaserPower { share };
        let laser = WriteOptions { pen: PenControl::Laser { full: 1000 }, ..WriteOptions::default() };
        let ops = [power(0.5), power(0.25), travel(1.0, 0.0), draw(2.0, 0.0), power(0.5), draw(3.0, 0.0)];
        assert_eq!(
            written(laser, &ops),
            "G21\nG90\nM5\nG0 X1 Y0\nM4 S250\nG1 X2 Y0 F1800\nS500\nG1 X3 Y0\nM5\nM2\n"
        );
        let dot = [travel(1.0, 0.0), draw(1.0, 0.0), draw(2.0, 0.0)];
        assert_eq!(
            written(laser, &dot),
            "G21\nG90\nM5\nG0 X1 Y0\nG1 F1800\nM3 S1000\nG4 P0.15\nG1 X2 Y0\nM5\nM2\n"
        );
        // A line to where it stands is nothing, and needs no power.
        let still = [travel(1.0, 0.0), draw(1.0, 0.0), power(0.5), draw(1.0, 0.0)];
        assert_eq!(written(laser, &still), written(laser, &still[..2]));
        // A pen does not mind.
        assert_eq!(written(quick(), &[power(0.5), draw(1.0, 0.0)]), written(quick(), &[draw(1.0, 0.0)]));
    }

    #[test]
    fn pens_sheets_and_dwells_have_their_words() {
        let dwell = PlotOp::Dwell { duration: Duration::from_millis(1250) };
        let pen = |pen| PlotOp::SelectPen { pen };
        let ops = [pen(1), draw(1.0, 0.0), pen(1), pen(2), draw(2.0, 0.0), pen(0), PlotOp::NewPage, dwell];
        assert_eq!(
            written(quick(), &ops),
            "G21\nG90\nM5\n(pen 1)\nG0 X0 Y0\nM3 S90\nG1 X1 Y0 F1800\nM5\nM0 (pen 2)\nM3 S90\nG1 X2 Y0\nM5\n\
             M0 (new sheet)\nG4 P1.25\nM2\n"
        );
        // Whatever has drawn before was in the holder: another pen is waited for.
        assert!(written(quick(), &[draw(1.0, 0.0), pen(1), draw(2.0, 0.0)]).contains("M5\nM0 (pen 1)\n"));
        let marlin =
            WriteOptions { dwell_unit: DwellUnit::Milliseconds, pen_change: PenChange::Tool, ..quick() };
        assert_eq!(written(marlin, &[pen(3), dwell]), "G21\nG90\nM5\nT3 M6\nG4 P1250\nM2\n");
    }

    #[test]
    fn a_whole_circle_is_two_halves() {
        let mut writer = Writer::with_options(String::new(), quick());
        let right = Point::new(15.0, 10.0);
        writer.push(travel(15.0, 10.0)).unwrap();
        writer.arc(Point::new(10.0, 10.0), -TAU, right, None).unwrap();
        let text = writer.finish().unwrap();
        assert!(text.contains("G2 X5 Y10 I-5 J0 F1800\nG2 X15 Y10 I5 J0\n"), "{text}");
    }

    #[test]
    fn an_arc_that_the_decimals_do_not_show_is_a_line() {
        let mut writer = Writer::with_options(String::new(), quick());
        writer.push(travel(0.0, 0.0)).unwrap();
        let far = Point::new(0.0, 90_000.0);
        let sweep = 1e-5; // 0.9 mm long, 0.001 um high
        let end = far + crate::Vec2::new(0.0, -90_000.0).rotated(sweep);
        writer.arc(far, sweep, end, None).unwrap();
        // To where the pen is: nothing, and never a whole circle.
        writer.arc(Point::new(0.9, 1e-4), 1e-3, Point::new(0.9, 0.0), None).unwrap();
        let text = writer.finish().unwrap();
        assert!(text.contains("G0 X0 Y0\nM3 S90\nG1 X0.9 Y0 F1800\nM5\n"), "{text}");
    }

    #[test]
    fn what_cannot_be_written_is_named_and_leaves_no_trace() {
        let mut writer = Writer::with_options(String::new(), quick());
        let mut refusals: Vec<String> = [
            travel(f64::NAN, 0.0),
            travel(1.0, 200_000.0),
            PlotOp::LaserPower { share: 1.5 },
            PlotOp::Draw { to: Point::ORIGIN, feed_mm_s: Some(0.0) },
            PlotOp::Draw { to: Point::ORIGIN, feed_mm_s: Some(f64::INFINITY) },
        ]
        .into_iter()
        .map(|op| writer.push(op).unwrap_err().to_string())
        .collect();
        let centre = Point::new(5.0, 0.0);
        refusals.push(writer.arc(centre, f64::NAN, Point::ORIGIN, None).unwrap_err().to_string());
        insta::assert_snapshot!(refusals.join("\n"), @r"
        operation 0: point (NaN, 0.000) mm lies outside -100000..=100000 mm: scale or move the drawing, or raise limit_mm if the machine takes it
        operation 1: point (1.000, 200000.000) mm lies outside -100000..=100000 mm: scale or move the drawing, or raise limit_mm if the machine takes it
        operation 2: 1.5 is no power: give a share of full power, 0 to 1
        operation 3: a speed of 0 mm/s cannot be written: give 0.01 mm/s or more
        operation 4: a speed of inf mm/s cannot be written: give 0.01 mm/s or more
        operation 5: point (5.000, 0.000) mm lies outside -100000..=100000 mm: scale or move the drawing, or raise limit_mm if the machine takes it
        ");
        assert_eq!(writer.finish().unwrap(), "G21\nG90\nM5\nM2\n");
        let bad = WriteOptions { pen: PenControl::Height { up_mm: f64::NAN, down_mm: 0.0 }, ..quick() };
        let mut writer = Writer::with_options(String::new(), bad);
        let error = writer.push(travel(0.0, 0.0)).unwrap_err();
        assert_eq!(error.to_string(), "pen: NaN mm is no height: give mm along the Z axis, as 5 and 0");
    }
}
