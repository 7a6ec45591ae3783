//! [`PlotterSettings`]: where the paper lies under the counts, and what counts as odd.

use crate::log::Header;
use core::fmt;
use core::time::Duration;
use plotter_motion::gcode::PenConvention;
use plotter_motion::kinematics::{Backlash, BeltSigns, MotorPoint};
use plotter_motion::{Point, StepPoint};

/// Scale, origin and limits of a virtual plotter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlotterSettings {
    /// Length of a pulse to the right, mm: finite and above 0.
    pub x_mm_per_pulse: f64,
    /// Length of a pulse up, mm: finite and above 0.
    pub y_mm_per_pulse: f64,
    /// Where position (0, 0) of the motors lies on the sheet, mm: the origin offset P1.
    pub p1: Point,
    /// Which way the two motors of a belt turn; `None` where each moves an axis. Counts are those of the
    /// motors either way, and a belt has one scale, that of x.
    pub belt: Option<BeltSigns>,
    /// The play of each axis of a machine whose log has steps: those that take it up move no carriage. The
    /// log begins with both axes driven towards minus, as homing leaves them.
    pub play: Backlash,
    /// Records that tell the position of the motors.
    pub counted_by: CountedBy,
    /// Where the pen is when the log begins, mm; `None` for the origin of the counts, or where the machine
    /// first says to be.
    pub begins_at: Option<Point>,
    /// By which words lines of Grbl's language lift the pen.
    pub pen: PenConvention,
    /// A silence of the host inside a target after which the rest of it is not expected any more.
    pub resync_gap: Duration,
    /// A silence with a target under way that is reported.
    pub stall_after: Duration,
    /// How far from the target the pulses may lead when the controller says that it is reached, encoder
    /// counts.
    pub reached_tolerance_counts: u32,
    /// Points of the path that are kept, 16 bytes each.
    pub max_points: usize,
    /// Targets, legs and anomalies that are kept, of each.
    pub max_entries: usize,
}

impl PlotterSettings {
    /// The same with another [`PlotterSettings::x_mm_per_pulse`].
    #[must_use]
    pub const fn with_x_mm_per_pulse(self, x_mm_per_pulse: f64) -> Self {
        Self { x_mm_per_pulse, ..self }
    }

    /// The same with another [`PlotterSettings::y_mm_per_pulse`].
    #[must_use]
    pub const fn with_y_mm_per_pulse(self, y_mm_per_pulse: f64) -> Self {
        Self { y_mm_per_pulse, ..self }
    }

    /// The same with another [`PlotterSettings::p1`].
    #[must_use]
    pub const fn with_p1(self, p1: Point) -> Self {
        Self { p1, ..self }
    }

    /// The same with another [`PlotterSettings::belt`].
    #[must_use]
    pub const fn with_belt(self, belt: Option<BeltSigns>) -> Self {
        Self { belt, ..self }
    }

    /// The same with another [`PlotterSettings::play`].
    #[must_use]
    pub const fn with_play(self, play: Backlash) -> Self {
        Self { play, ..self }
    }

    /// The same with another [`PlotterSettings::counted_by`].
    #[must_use]
    pub const fn with_counted_by(self, counted_by: CountedBy) -> Self {
        Self { counted_by, ..self }
    }

    /// The same with another [`PlotterSettings::begins_at`].
    #[must_use]
    pub const fn with_begins_at(self, begins_at: Option<Point>) -> Self {
        Self { begins_at, ..self }
    }

    /// The same with another [`PlotterSettings::pen`].
    #[must_use]
    pub const fn with_pen(self, pen: PenConvention) -> Self {
        Self { pen, ..self }
    }

    /// The same with another [`PlotterSettings::resync_gap`].
    #[must_use]
    pub const fn with_resync_gap(self, resync_gap: Duration) -> Self {
        Self { resync_gap, ..self }
    }

    /// The same with another [`PlotterSettings::stall_after`].
    #[must_use]
    pub const fn with_stall_after(self, stall_after: Duration) -> Self {
        Self { stall_after, ..self }
    }

    /// The same with another [`PlotterSettings::reached_tolerance_counts`].
    #[must_use]
    pub const fn with_reached_tolerance_counts(self, reached_tolerance_counts: u32) -> Self {
        Self { reached_tolerance_counts, ..self }
    }

    /// The same with another [`PlotterSettings::max_points`].
    #[must_use]
    pub const fn with_max_points(self, max_points: usize) -> Self {
        Self { max_points, ..self }
    }

    /// The same with another [`PlotterSettings::max_entries`].
    #[must_use]
    pub const fn with_max_entries(self, max_entries: usize) -> Self {
        Self { max_entries, ..self }
    }
}

/// Records of a log that tell the position of the motors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum CountedBy {
    /// The controller's answers on the serial line: the protocol `digits`.
    #[default]
    Answers,
    /// The encoders' edges, for a controller that has no such line: the protocol `counts`. Targets are
    /// recorded as such, and its only answer is `+`, when it has arrived; from a target that was missed the
    /// counts go on.
    Edges,
    /// The machine's messages on the reliable link, or its answers in digits where it knew no other: the
    /// protocol `link`. A log of [`Answers`](Self::Answers) in which a machine greets a host becomes one of
    /// these.
    Link,
    /// Lines of Grbl's language, once they are answered, and what the machine reports of its place; or its
    /// steps, where the log has them: the protocol `grbl`.
    Grbl,
    /// The same of mDraw's language: the protocol `mdraw`.
    MDraw,
    /// The same of Marlin's language: the protocol `marlin`. Its machine tells where its lines lead, and
    /// nothing of its way: what is drawn is known where a line waits for it.
    Marlin,
    /// Commands of HPGL, which no plotter answers, as soon as so many have followed that its buffer cannot
    /// hold them: the protocol `hpgl`. Or its steps, where the log has them.
    Hpgl,
    /// Commands of the EBB, whose steps the simulated board makes of them at the times at which they came:
    /// the protocol `ebb`. Or its steps, where the log has them.
    Ebb,
}

impl Default for PlotterSettings {
    /// The semi-virtual gantry: 40 pulses a millimetre, origin at the lower left, 100 ms inside a target; up
    /// to 8 million points (128 MB).
    fn default() -> Self {
        Self {
            x_mm_per_pulse: 0.025,
            y_mm_per_pulse: 0.025,
            p1: Point::ORIGIN,
            belt: None,
            play: Backlash::default(),
            counted_by: CountedBy::Answers,
            begins_at: None,
            pen: PenConvention::Spindle,
            resync_gap: Duration::from_millis(100),
            stall_after: Duration::from_secs(1),
            reached_tolerance_counts: 0,
            max_points: 8_000_000,
            max_entries: 1_000_000,
        }
    }
}

/// A step of a stepper plotter whose log does not say how long it is, mm: that of the documented machine.
const STEP_MM: f64 = 1.0 / 87.58;

/// A sixteenth of a step of an AxiDraw's motors, mm: 2032 of them move its belt by an inch (its makers'
/// documentation of the command SM).
const AXIDRAW_STEP_MM: f64 = 25.4 / 2032.0;

/// A number in a log's header that makes no sense.
#[derive(Clone, Debug, PartialEq)]
pub struct SettingsError {
    /// The key.
    pub key: &'static str,
    /// The remedy.
    pub expected: &'static str,
}

impl PlotterSettings {
    /// The defaults with what a log's header says: `x_mm_per_pulse`, `y_mm_per_pulse`, `x_play_steps`,
    /// `y_play_steps`, `p1_x_mm`, `p1_y_mm`, `begins_x_mm` and `begins_y_mm`, `resync_gap_ms`,
    /// `reached_tolerance_counts`, `belt_signs` and `protocol`, each optional.
    ///
    /// # Errors
    ///
    /// [`SettingsError`] for a value that is no number or outside its range.
    pub fn from_header(header: &Header) -> Result<Self, SettingsError> {
        let number = |key, expected, fits: fn(f64) -> bool, default| {
            if header.has(key) {
                header.number(key).filter(|&n| fits(n)).ok_or(SettingsError { key, expected })
            } else {
                Ok(default)
            }
        };
        let length = |n| n > 0.0 && n <= 1_000.0;
        let place = |n: f64| n.abs() <= 1e6;
        let pause = |n| (0.0..=3.6e6).contains(&n);
        let base = Self::default();
        let counts = |n: f64| (0.0..=100_000.0).contains(&n);
        let says_nothing = !header.has("belt_signs") && !header.has("x_mm_per_pulse");
        let is_axidraw = header.text("protocol") == Some("ebb") && says_nothing;
        let belt = match header.text("belt_signs") {
            Some("direction-table") => Some(BeltSigns::DirectionTable),
            Some("tracking-equations") => Some(BeltSigns::TrackingEquations),
            // An AxiDraw, if nothing is said of the machine: its makers' programs send both motors forwards for
            // a way to the right, and the first one for a way down.
            None if is_axidraw => Some(BeltSigns::DirectionTable),
            None if !header.has("belt_signs") => None,
            _ => {
                let expected = "direction-table or tracking-equations";
                return Err(SettingsError { key: "belt_signs", expected });
            }
        };
        let counted_by = match header.text("protocol") {
            Some("counts") => CountedBy::Edges,
            Some("link") => CountedBy::Link,
            Some("grbl") => CountedBy::Grbl,
            Some("mdraw") => CountedBy::MDraw,
            Some("marlin") => CountedBy::Marlin,
            Some("hpgl") => CountedBy::Hpgl,
            Some("ebb") => CountedBy::Ebb,
            Some("digits" | "messages") => CountedBy::Answers,
            None if !header.has("protocol") => CountedBy::Answers,
            _ => {
                let expected = "digits, link, counts, grbl, mdraw, marlin, hpgl or ebb: what another one says is not \
                                known here";
                return Err(SettingsError { key: "protocol", expected });
            }
        };
        let is_lines =
            matches!(counted_by, CountedBy::Grbl | CountedBy::MDraw | CountedBy::Marlin | CountedBy::Ebb);
        let scale_mm = |mm: f64| match (is_axidraw, is_lines) {
            (true, _) => AXIDRAW_STEP_MM,
            (false, true) => STEP_MM,
            (false, false) => mm,
        };
        let tolerance = f64::from(base.reached_tolerance_counts);
        let tolerance = number("reached_tolerance_counts", "0 to 100000 counts", counts, tolerance)?;
        let scale = "a length above 0 and up to 1000 mm";
        let most_steps = |n: f64| (0.0..=f64::from(u16::MAX)).contains(&n);
        let play = |key| number(key, "0 to 65535 steps", most_steps, 0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 65535, as checked")]
        let play = Backlash { x_steps: play("x_play_steps")? as u16, y_steps: play("y_play_steps")? as u16 };
        Ok(Self {
            x_mm_per_pulse: number("x_mm_per_pulse", scale, length, scale_mm(base.x_mm_per_pulse))?,
            y_mm_per_pulse: number("y_mm_per_pulse", scale, length, scale_mm(base.y_mm_per_pulse))?,
            p1: Point::new(
                number("p1_x_mm", "a number within 1e6 mm", place, base.p1.x)?,
                number("p1_y_mm", "a number within 1e6 mm", place, base.p1.y)?,
            ),
            belt,
            play,
            counted_by,
            begins_at: if header.has("begins_x_mm") || header.has("begins_y_mm") {
                Some(Point::new(
                    number("begins_x_mm", "a number within 1e6 mm", place, 0.0)?,
                    number("begins_y_mm", "a number within 1e6 mm", place, 0.0)?,
                ))
            } else {
                None
            },
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 to 100000, as checked"
            )]
            reached_tolerance_counts: tolerance as u32,
            resync_gap: Duration::from_secs_f64(
                number("resync_gap_ms", "0 to 3.6e6 ms", pause, base.resync_gap.as_secs_f64() * 1e3)? / 1e3,
            ),
            ..base
        })
    }

    /// Where a position of the motors lies on the sheet, mm.
    ///
    /// ```
    /// # use plotter_motion::{Point, StepPoint};
    /// # use plotter_replay::PlotterSettings;
    /// let settings = PlotterSettings::default().with_p1(Point::new(10.0, 20.0));
    /// assert_eq!(settings.to_sheet(StepPoint::new(40, 80)), Point::new(11.0, 22.0));
    /// ```
    #[must_use]
    pub fn to_sheet(&self, at: StepPoint) -> Point {
        let (x, y) = (f64::from(at.x), f64::from(at.y));
        match self.belt {
            None => Point::new(self.p1.x + x * self.x_mm_per_pulse, self.p1.y + y * self.y_mm_per_pulse),
            Some(signs) => {
                let (x, y) = signs.twice_axes(x, y);
                let half = 0.5 * self.x_mm_per_pulse;
                Point::new(self.p1.x + x * half, self.p1.y + y * half)
            }
        }
    }

    /// The position of the motors at a place on the sheet: to the nearest count.
    #[must_use]
    pub fn to_counts(&self, on_sheet: Point) -> StepPoint {
        let from_p1 = on_sheet - self.p1;
        let (x, y) = match self.belt {
            None => (from_p1.x / self.x_mm_per_pulse, from_p1.y / self.y_mm_per_pulse),
            Some(signs) => signs.motors(from_p1.x / self.x_mm_per_pulse, from_p1.y / self.x_mm_per_pulse),
        };
        MotorPoint { x, y }.rounded()
    }
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "header key {}: expected {}", self.key, self.expected)
    }
}

impl core::error::Error for SettingsError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_overrides_and_is_checked() {
        let header = Header::from_json(r#"{"x_mm_per_pulse":0.1,"p1_y_mm":-5,"resync_gap_ms":50}"#).unwrap();
        let settings = PlotterSettings::from_header(&header).unwrap();
        assert_eq!(settings.to_sheet(StepPoint::new(10, 40)), Point::new(1.0, -4.0));
        assert_eq!(settings.resync_gap, Duration::from_millis(50));
        for bad in [
            r#"{"belt_signs":"corexy"}"#,
            r#"{"x_mm_per_pulse":0}"#,
            r#"{"p1_x_mm":"left"}"#,
            r#"{"resync_gap_ms":-1}"#,
            r#"{"y_play_steps":65536}"#,
        ] {
            let error = PlotterSettings::from_header(&Header::from_json(bad).unwrap()).unwrap_err();
            assert!(bad.contains(error.key), "{error}");
        }
    }

    #[test]
    fn the_counts_of_a_belt_are_its_motors() {
        let header = r#"{"protocol":"counts","belt_signs":"direction-table","x_mm_per_pulse":0.1,"p1_x_mm":150,
            "reached_tolerance_counts":42}"#;
        let settings = PlotterSettings::from_header(&Header::from_json(header).unwrap()).unwrap();
        assert_eq!((settings.counted_by, settings.reached_tolerance_counts), (CountedBy::Edges, 42));
        // motor 2 alone: right and up
        assert_eq!(settings.to_sheet(StepPoint::new(0, 40)), Point::new(152.0, 2.0));
        assert_eq!(settings.to_counts(Point::new(152.0, 2.0)), StepPoint::new(0, 40));
    }
}
