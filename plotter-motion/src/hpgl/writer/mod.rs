//! [`Writer`]: plot operations in, plain HPGL text out.

mod round;

use super::encoded::write_number;
use super::{Coordinates, Opening, UNITS_PER_MM, WriteError, WriteOptions};
use crate::{PlotOp, Point, StepPoint, toolpath::from_mm};
use core::fmt;

/// Thousandths of a cm/s in one mm/s: the grid on which `VS` is written is 0.01 mm/s.
const SPEED_STEPS_PER_MM_S: f64 = 100.0;

/// What has been written of the stroke in progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stroke {
    /// The pen is up.
    None,
    /// The pen is up where a dot is owed: `PD;PU;` if nothing follows, the start of a list if a line does.
    Dot,
    /// The pen is down, and a `PD` with this many points waits for its `;`.
    Open(u16),
    /// The pen is down between two commands.
    Closed,
}

/// Writes plot operations as plain HPGL, which any plotter or viewer reads.
///
/// - `IN;` comes first, then `SPn;` with the pen of the operations, or [`WriteOptions::pen`] if they move
///   before they select one. A first line without a travel starts at the origin, and says so: `PU0,0;`.
/// - One command a line. A stroke is `PUx,y;` and one `PD` with all its points, broken after
///   [`WriteOptions::points_per_command`].
/// - Coordinates are 40 units to the mm, rounded by [`from_mm`]: to nearest, halves away from zero. Nothing
///   is clamped, which would bend a drawing unseen: a point out of range is refused with
///   [`WriteError::Point`], and the caller decides.
/// - A line to where the pen stands is a dot, `PD;PU;`; inside a stroke it is one more, equal, point.
/// - A speed becomes `VS` in cm/s, in steps of 0.01 mm/s, whenever it changes; no speed becomes the bare
///   `VS;`, the plotter's own.
/// - A new sheet is `PG;`, with the pen lifted. A dwell is refused.
/// - [`Writer::finish`] puts the pen away: `PU;SP0;`.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, hpgl};
/// let mut writer = hpgl::Writer::new(String::new());
/// writer.push(PlotOp::Travel { to: Point::new(10.0, 10.0) })?;
/// writer.push(PlotOp::Draw { to: Point::new(20.0, 10.0), feed_mm_s: Some(25.0) })?;
/// writer.push(PlotOp::Draw { to: Point::new(20.0, 10.5), feed_mm_s: Some(25.0) })?;
/// let text = writer.finish()?;
/// assert_eq!(text, "IN;\nSP1;\nPU400,400;\nVS2.5;\nPD800,400,800,420;\nPU;\nSP0;\n");
/// # Ok::<(), hpgl::WriteError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Writer<W> {
    out: W,
    options: WriteOptions,
    index: u64,
    started: bool,
    pen_chosen: bool,
    /// Where the text has put the pen, in plotter units; `None` before the first movement.
    at: Option<StepPoint>,
    stroke: Stroke,
    /// Points in the `PE` in progress; 0 where there is none.
    encoded_points: u16,
    /// The speed in force, in steps of 0.01 mm/s.
    speed: Option<i32>,
}

impl<W: fmt::Write> Writer<W> {
    /// A writer into `out` with the default options.
    pub fn new(out: W) -> Self {
        Self::with_options(out, WriteOptions::default())
    }

    /// A writer into `out`.
    pub fn with_options(out: W, options: WriteOptions) -> Self {
        Self {
            out,
            options,
            index: 0,
            started: false,
            pen_chosen: false,
            at: None,
            stroke: Stroke::None,
            encoded_points: 0,
            speed: None,
        }
    }

    /// Writes one operation.
    ///
    /// # Errors
    ///
    /// A point, speed or dwell that HPGL cannot say is refused and left out; the writer goes on with the next
    /// operation as if it had not been there.
    pub fn push(&mut self, op: PlotOp) -> Result<(), WriteError> {
        let index = self.index;
        self.index += 1;
        match op {
            PlotOp::Travel { to } => {
                let units = self.units(index, to)?;
                self.choose_pen()?;
                self.travel(units)?;
            }
            PlotOp::Draw { to, feed_mm_s } => {
                let units = self.units(index, to)?;
                let speed = feed_mm_s.map(|feed| speed_steps(index, feed)).transpose()?;
                self.choose_pen()?;
                self.draw(units, speed)?;
            }
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                self.index = index;
                self.arc(centre, sweep_rad, to, feed_mm_s)?;
            }
            PlotOp::LaserPower { .. } => {}
            PlotOp::SelectPen { pen } => {
                self.start()?;
                self.put_down_and_up()?;
                writeln!(self.out, "SP{pen};")?;
                self.pen_chosen = true;
            }
            PlotOp::Dwell { duration } => return Err(WriteError::Dwell { index, duration }),
            PlotOp::NewPage => {
                self.start()?;
                self.put_down_and_up()?;
                self.out.write_str("PG;\n")?;
            }
        }
        Ok(())
    }

    fn travel(&mut self, to: StepPoint) -> fmt::Result {
        if self.options.coordinates == Coordinates::Encoded {
            if self.stroke == Stroke::Dot {
                self.lift()?;
            }
            self.encode(to, true)?;
        } else {
            self.lift()?;
            writeln!(self.out, "PU{},{};", to.x, to.y)?;
        }
        self.at = Some(to);
        Ok(())
    }

    /// One point of `PE`. The first of each is a place, the others are steps.
    fn encode(&mut self, to: StepPoint, up: bool) -> fmt::Result {
        let at = self.at.filter(|_| self.encoded_points > 0);
        if at.is_none() {
            self.out.write_str("PE7")?;
        }
        if up {
            self.out.write_char('<')?;
        }
        if at.is_none() {
            self.out.write_char('=')?;
        }
        let from = at.unwrap_or_default();
        for (from, to) in [(from.x, to.x), (from.y, to.y)] {
            write_number(&mut self.out, i64::from(to) - i64::from(from))?;
        }
        self.encoded_points = self.encoded_points.saturating_add(1);
        self.stroke = if up { Stroke::None } else { Stroke::Closed };
        if self.encoded_points >= self.options.points_per_command {
            self.end_encoded()?;
        }
        Ok(())
    }

    fn end_encoded(&mut self) -> fmt::Result {
        if core::mem::take(&mut self.encoded_points) > 0 { self.out.write_str(";\n") } else { Ok(()) }
    }

    /// Ends the drawing: pen up, pen away. Gives the sink back.
    ///
    /// # Errors
    ///
    /// [`WriteError::Output`] when the sink refuses the text.
    pub fn finish(mut self) -> Result<W, WriteError> {
        self.start()?;
        self.lift()?;
        self.out.write_str("PU;\nSP0;\n")?;
        Ok(self.out)
    }

    fn units(&self, index: u64, to: Point) -> Result<StepPoint, WriteError> {
        let limit = self.options.limit_units;
        let units = StepPoint::new(from_mm(to.x, UNITS_PER_MM), from_mm(to.y, UNITS_PER_MM));
        let inside = |value: i32| value.unsigned_abs() <= limit.unsigned_abs() && value != i32::MIN;
        // Not finite is asked apart: a NaN would come out of `from_mm` as an innocent 0.
        if to.is_finite() && inside(units.x) && inside(units.y) {
            Ok(units)
        } else {
            Err(WriteError::Point { index, to, limit_units: limit })
        }
    }

    fn start(&mut self) -> fmt::Result {
        if !self.started {
            self.out.write_str(match self.options.opening {
                Opening::Short => "IN;\n",
                Opening::Full => "IN;\nDF;\nPA;\n",
            })?;
            self.started = true;
        }
        Ok(())
    }

    fn choose_pen(&mut self) -> fmt::Result {
        self.start()?;
        if !self.pen_chosen {
            writeln!(self.out, "SP{};", self.options.pen)?;
            self.pen_chosen = true;
        }
        Ok(())
    }

    /// Where the text has put the pen: at the origin, before the first movement.
    fn from(&mut self) -> Result<StepPoint, fmt::Error> {
        if self.at.is_none() {
            self.travel(StepPoint::default())?;
        }
        Ok(self.at.unwrap_or_default())
    }

    fn draw(&mut self, to: StepPoint, speed: Option<i32>) -> fmt::Result {
        let at = self.from()?;
        self.change_speed(speed)?;
        match self.stroke {
            // Also where points are encoded: not every reader of `PE` knows that a step of no length is a
            // dot.
            Stroke::None if at == to => self.stroke = Stroke::Dot,
            stroke if self.options.coordinates == Coordinates::Encoded => {
                if stroke == Stroke::Dot {
                    self.encode(at, false)?;
                }
                self.encode(to, false)?;
            }
            Stroke::None | Stroke::Closed => self.open_list(at, to)?,
            Stroke::Dot => {
                self.open_list(at, at)?;
                self.add_to_list(at, to)?;
            }
            Stroke::Open(_) => self.add_to_list(at, to)?,
        }
        self.at = Some(to);
        Ok(())
    }

    fn change_speed(&mut self, speed: Option<i32>) -> fmt::Result {
        if speed == self.speed {
            return Ok(());
        }
        // A dot before this line was owed at the old speed.
        self.close_list()?;
        self.speed = speed;
        match speed {
            Some(steps) => self.write_speed(steps),
            None => self.out.write_str("VS;\n"),
        }
    }

    /// The numbers of a point that follows `at`.
    fn numbers(&self, at: StepPoint, to: StepPoint) -> (i64, i64) {
        let from = match self.options.coordinates {
            Coordinates::Absolute | Coordinates::Encoded => StepPoint::default(),
            Coordinates::Relative => at,
        };
        (i64::from(to.x) - i64::from(from.x), i64::from(to.y) - i64::from(from.y))
    }

    fn open_list(&mut self, at: StepPoint, to: StepPoint) -> fmt::Result {
        let (x, y) = self.numbers(at, to);
        if self.options.coordinates == Coordinates::Relative {
            self.out.write_str("PR;\n")?;
        }
        write!(self.out, "PD{x},{y}")?;
        self.stroke = Stroke::Open(1);
        Ok(())
    }

    fn add_to_list(&mut self, at: StepPoint, to: StepPoint) -> fmt::Result {
        match self.stroke {
            Stroke::Open(points) if points < self.options.points_per_command => {
                let (x, y) = self.numbers(at, to);
                write!(self.out, ",{x},{y}")?;
                self.stroke = Stroke::Open(points.saturating_add(1));
                Ok(())
            }
            _ => {
                self.close_list()?;
                self.open_list(at, to)
            }
        }
    }

    /// Ends the command in progress. The pen stays down if it was down.
    fn close_list(&mut self) -> fmt::Result {
        self.end_encoded()?;
        match self.stroke {
            Stroke::Open(_) => {
                self.out.write_str(match self.options.coordinates {
                    Coordinates::Absolute | Coordinates::Encoded => ";\n",
                    Coordinates::Relative => ";\nPA;\n",
                })?;
                self.stroke = Stroke::Closed;
            }
            Stroke::Dot => {
                self.out.write_str("PD;\nPU;\n")?;
                self.stroke = Stroke::None;
            }
            Stroke::None | Stroke::Closed => {}
        }
        Ok(())
    }

    /// Ends the stroke, before a command that itself lifts the pen.
    fn lift(&mut self) -> fmt::Result {
        self.close_list()?;
        self.stroke = Stroke::None;
        Ok(())
    }

    /// Ends the stroke with the pen up, before a command that may leave it down.
    fn put_down_and_up(&mut self) -> fmt::Result {
        self.close_list()?;
        if self.stroke == Stroke::Closed {
            self.out.write_str("PU;\n")?;
        }
        self.stroke = Stroke::None;
        Ok(())
    }

    /// `VS` in cm/s, without trailing zeros.
    fn write_speed(&mut self, steps: i32) -> fmt::Result {
        let (whole, thousandths) = (steps / 1000, steps % 1000);
        match (thousandths % 10, thousandths % 100, thousandths) {
            (_, _, 0) => writeln!(self.out, "VS{whole};"),
            (_, 0, _) => writeln!(self.out, "VS{whole}.{};", thousandths / 100),
            (0, _, _) => writeln!(self.out, "VS{whole}.{:02};", thousandths / 10),
            _ => writeln!(self.out, "VS{whole}.{thousandths:03};"),
        }
    }
}

fn speed_steps(index: u64, feed_mm_s: f64) -> Result<i32, WriteError> {
    let steps = from_mm(feed_mm_s, SPEED_STEPS_PER_MM_S);
    if steps > 0 && steps < i32::MAX { Ok(steps) } else { Err(WriteError::Feed { index, feed_mm_s }) }
}

/// Writes a whole drawing as plain HPGL, from `IN;` to `PU;SP0;`, as [`Writer`] does.
///
/// # Errors
///
/// The first operation that HPGL cannot say ends the writing: the text so far stays in `out`, and is not a
/// whole drawing.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, hpgl};
/// let dot = [
///     PlotOp::Travel { to: Point::new(1.0, 2.0) },
///     PlotOp::Draw { to: Point::new(1.0, 2.0), feed_mm_s: None },
/// ];
/// let mut text = String::new();
/// hpgl::write_ops(dot, &mut text)?;
/// assert_eq!(text, "IN;\nSP1;\nPU40,80;\nPD;\nPU;\nPU;\nSP0;\n");
/// # Ok::<(), hpgl::WriteError>(())
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
    use core::time::Duration;
    use std::string::{String, ToString};
    use std::vec::Vec;

    fn travel(x: f64, y: f64) -> PlotOp {
        PlotOp::Travel { to: Point::new(x, y) }
    }

    fn draw(x: f64, y: f64) -> PlotOp {
        PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None }
    }

    fn written(ops: &[PlotOp]) -> String {
        let mut text = String::new();
        write_ops(ops.iter().copied(), &mut text).unwrap();
        text
    }

    #[test]
    fn an_empty_drawing_is_still_a_whole_file() {
        assert_eq!(written(&[]), "IN;\nPU;\nSP0;\n");
    }

    #[test]
    fn a_line_without_travel_starts_at_the_origin() {
        assert_eq!(written(&[draw(1.0, 0.0)]), "IN;\nSP1;\nPU0,0;\nPD40,0;\nPU;\nSP0;\n");
    }

    #[test]
    fn the_pen_is_up_while_it_is_changed() {
        let text = written(&[
            PlotOp::SelectPen { pen: 2 },
            draw(1.0, 0.0),
            PlotOp::SelectPen { pen: 3 },
            draw(0.0, 0.0),
        ]);
        assert_eq!(text, "IN;\nSP2;\nPU0,0;\nPD40,0;\nPU;\nSP3;\nPD0,0;\nPU;\nSP0;\n");
    }

    #[test]
    fn long_strokes_are_broken_with_the_pen_down() {
        let options = WriteOptions { points_per_command: 2, ..Default::default() };
        let mut writer = Writer::with_options(String::new(), options);
        for op in [travel(0.0, 0.0), draw(1.0, 0.0), draw(2.0, 0.0), draw(3.0, 0.0)] {
            writer.push(op).unwrap();
        }
        assert_eq!(writer.finish().unwrap(), "IN;\nSP1;\nPU0,0;\nPD40,0,80,0;\nPD120,0;\nPU;\nSP0;\n");
    }

    #[test]
    fn no_line_is_longer_than_promised() {
        const LONGEST_BYTES: usize = 2 + 20 * 24 + 1;
        let far = |i: u32| draw(-26_843_545.0, f64::from(i % 2) - 26_843_545.0);
        let options = WriteOptions { limit_units: i32::MAX, ..Default::default() };
        let mut writer = Writer::with_options(String::new(), options);
        for i in 0..100 {
            writer.push(far(i)).unwrap();
        }
        let text = writer.finish().unwrap();
        assert!(text.lines().all(|line| line.len() <= LONGEST_BYTES), "{text}");
    }

    #[test]
    fn a_dot_that_a_line_follows_keeps_the_pen_down() {
        assert_eq!(
            written(&[travel(1.0, 1.0), draw(1.0, 1.0), draw(2.0, 1.0), draw(2.0, 1.0)]),
            "IN;\nSP1;\nPU40,40;\nPD40,40,80,40,80,40;\nPU;\nSP0;\n"
        );
    }

    #[test]
    fn speed_is_written_when_it_changes_and_taken_back() {
        let fast = |x: f64, feed: f64| PlotOp::Draw { to: Point::new(x, 0.0), feed_mm_s: Some(feed) };
        let text = written(&[fast(1.0, 20.0), fast(2.0, 20.0), fast(3.0, 0.25), draw(4.0, 0.0)]);
        assert_eq!(
            text,
            "IN;\nSP1;\nPU0,0;\nVS2;\nPD40,0,80,0;\nVS0.025;\nPD120,0;\nVS;\nPD160,0;\nPU;\nSP0;\n"
        );
    }

    #[test]
    fn a_new_page_lifts_the_pen() {
        assert_eq!(
            written(&[travel(0.0, 0.0), draw(1.0, 0.0), PlotOp::NewPage, travel(0.0, 0.0), PlotOp::NewPage]),
            "IN;\nSP1;\nPU0,0;\nPD40,0;\nPU;\nPG;\nPU0,0;\nPG;\nPU;\nSP0;\n"
        );
    }

    #[test]
    fn what_cannot_be_written_is_named_and_leaves_no_trace() {
        let mut writer = Writer::new(String::new());
        let refusals: Vec<String> = [
            travel(f64::NAN, 0.0),
            travel(1.0, 300_000.0),
            PlotOp::Draw { to: Point::ORIGIN, feed_mm_s: Some(0.0) },
            PlotOp::Dwell { duration: Duration::from_millis(250) },
        ]
        .into_iter()
        .map(|op| writer.push(op).unwrap_err().to_string())
        .collect();
        insta::assert_snapshot!(refusals.join("\n"), @r"
        operation 0: point (NaN, 0.000) mm lies outside -209715.175..=209715.175 mm: scale or move the drawing, or raise limit_units if the plotter takes it
        operation 1: point (1.000, 300000.000) mm lies outside -209715.175..=209715.175 mm: scale or move the drawing, or raise limit_units if the plotter takes it
        operation 2: a speed of 0 mm/s cannot be written: give 0.01 mm/s or more, or none
        operation 3: HPGL cannot stand still for 250 ms: leave the dwell out
        ");
        assert_eq!(writer.finish().unwrap(), "IN;\nPU;\nSP0;\n");
    }

    #[test]
    fn a_full_sink_is_an_error() {
        struct Full;
        impl fmt::Write for Full {
            fn write_str(&mut self, _: &str) -> fmt::Result {
                Err(fmt::Error)
            }
        }
        assert_eq!(write_ops([], &mut Full), Err(WriteError::Output));
    }

    #[test]
    fn a_circle_is_read_back_round_its_centre_and_the_next_line_starts_there() {
        let mut writer = Writer::new(String::new());
        writer.circle(Point::new(10.0, 10.0), 2.5).unwrap();
        writer.push(draw(11.0, 10.0)).unwrap();
        assert!(writer.circle(Point::new(10.0, 10.0), f64::NAN).is_err());
        let text = writer.finish().unwrap();
        let ops: Vec<PlotOp> = super::super::plot_ops(text.as_bytes()).map(Result::unwrap).collect();
        let rim = Point::new(12.5, 10.0);
        let circle = PlotOp::DrawArc {
            centre: Point::new(10.0, 10.0),
            sweep_rad: core::f64::consts::TAU,
            to: rim,
            feed_mm_s: None,
        };
        assert_eq!(
            ops[2..],
            [travel(12.5, 10.0), circle, travel(10.0, 10.0), draw(11.0, 10.0), PlotOp::SelectPen { pen: 0 }]
        );
    }

    #[test]
    fn relative_lists_are_shorter_numbers() {
        let options = WriteOptions { coordinates: Coordinates::Relative, ..Default::default() };
        let mut writer = Writer::with_options(String::new(), options);
        for op in [travel(100.0, 100.0), draw(100.25, 100.0), draw(100.25, 99.75)] {
            writer.push(op).unwrap();
        }
        assert_eq!(writer.finish().unwrap(), "IN;\nSP1;\nPU4000,4000;\nPR;\nPD10,0,0,-10;\nPA;\nPU;\nSP0;\n");
    }
}
