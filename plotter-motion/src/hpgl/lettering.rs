//! [`Lettering`]: how labels look and where they stand: `SI`, `SR`, `DI`, `DR`, `SL`, `DV`, `LO`, `ES`, `SD`.

use super::scaling::Scaling;
use crate::{Point, Vec2};

/// Plotter units in a cm.
const UNITS_PER_CM: f64 = 400.0;
/// Width and height of a capital letter when nothing is said, cm: 7475A, on A4.
const USUAL_SIZE_CM: Vec2 = Vec2::new(0.19, 0.27);
/// As `SR` without numbers has it, % of the way from P1 to P2.
const USUAL_SIZE_PERCENT: Vec2 = Vec2::new(0.75, 1.5);
/// From one character to the next, in widths of a capital letter, and from line to line, in heights.
const CELL: Vec2 = Vec2::new(1.5, 2.0);
/// Points of a printer in an inch, and units in one.
const POINTS_PER_INCH: f64 = 72.0;
const UNITS_PER_INCH: f64 = 1016.0;
/// A capital letter's height as a share of the point size, and width as a share of its height.
const CAPITAL_SHARE: f64 = 2.0 / 3.0;
const CAPITAL_WIDTH: f64 = 0.7;

/// Height of a capital letter in the steps of [`letter_strokes`](crate::hpgl::letter_strokes).
pub const LETTER_HEIGHT: f64 = 12.0;
/// Width of a capital letter in the steps of [`letter_strokes`](crate::hpgl::letter_strokes).
pub const LETTER_WIDTH: f64 = 8.0;
/// From one letter to the next in the steps of [`letter_strokes`](crate::hpgl::letter_strokes): one and a
/// half widths, as labels have them when nothing is said.
pub const LETTER_ADVANCE: f64 = 1.5 * LETTER_WIDTH;

/// Characters that are kept where the place of a label depends on its length: as many as a 7550A keeps.
pub(super) const MOST_KEPT: usize = 150;

/// The place that two characters stand for, in steps.
pub(super) fn place_of(x: u8, y: u8) -> Point {
    Point::new(f64::from(x) - f64::from(b'0'), f64::from(y) - f64::from(b'e'))
}

/// Of what the size of characters is a part.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Size {
    /// cm
    Absolute(Vec2),
    /// % of the way from P1 to P2
    Relative(Vec2),
}

/// Which way characters follow each other.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Direction {
    Absolute(Vec2),
    /// % of the way from P1 to P2
    Relative(Vec2),
}

/// What the text says about labels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lettering {
    size: Size,
    direction: Direction,
    /// Tangent of the angle from the upright.
    pub(super) slant: f64,
    /// Quarters of a turn clockwise from the direction of the letters to the next letter: `DV`.
    path: u8,
    /// Whether lines follow each other the other way.
    reversed: bool,
    /// 1 to 9, and 11 to 19: see [`Lettering::shift`].
    origin: u8,
    /// More room between characters and lines, as a share of what there is.
    pub(super) extra: Vec2,
    /// Where a carriage return goes.
    pub(super) line_start: Vec2,
}

/// Sizes of a label on the sheet, plotter units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Metrics {
    /// Width of a capital letter, along the line.
    pub(super) right: Vec2,
    /// Height of a capital letter, slanted.
    pub(super) up: Vec2,
    /// As `up`, upright.
    upright: Vec2,
    /// To the next character.
    pub(super) advance: Vec2,
    /// To the next line.
    pub(super) feed: Vec2,
}

impl Lettering {
    pub(super) fn new() -> Self {
        Self {
            size: Size::Absolute(USUAL_SIZE_CM),
            direction: Direction::Absolute(Vec2::new(1.0, 0.0)),
            slant: 0.0,
            path: 0,
            reversed: false,
            origin: 1,
            extra: Vec2::default(),
            line_start: Vec2::default(),
        }
    }

    /// `DF` and `IN`: all but the place of the pen.
    pub(super) fn initialize(&mut self) {
        *self = Self { line_start: self.line_start, ..Self::new() };
    }

    /// `SI`, cm.
    pub(super) fn set_size(&mut self, cm: Option<Vec2>) {
        self.size = Size::Absolute(cm.unwrap_or(USUAL_SIZE_CM));
    }

    /// `SR`, %.
    pub(super) fn set_relative_size(&mut self, percent: Option<Vec2>) {
        self.size = Size::Relative(percent.unwrap_or(USUAL_SIZE_PERCENT));
    }

    /// The size of a printer's font, points.
    pub(super) fn set_points(&mut self, points: f64) {
        let height_cm = points / POINTS_PER_INCH * UNITS_PER_INCH * CAPITAL_SHARE / UNITS_PER_CM;
        self.size = Size::Absolute(Vec2::new(height_cm * CAPITAL_WIDTH, height_cm));
    }

    /// `DI`.
    pub(super) fn set_direction(&mut self, way: Option<Vec2>) {
        self.direction = Direction::Absolute(way.unwrap_or(Vec2::new(1.0, 0.0)));
    }

    /// `DR`.
    pub(super) fn set_relative_direction(&mut self, way: Option<Vec2>) {
        self.direction = Direction::Relative(way.unwrap_or(Vec2::new(1.0, 0.0)));
    }

    /// `DV`.
    pub(super) fn set_path(&mut self, path: u8, reversed: bool) {
        (self.path, self.reversed) = (path, reversed);
    }

    /// `LO`.
    pub(super) fn set_origin(&mut self, origin: u8) {
        self.origin = origin;
    }

    pub(super) fn metrics(&self, scaling: &Scaling) -> Metrics {
        let frame = scaling.frame();
        let percent = |share: Vec2| Vec2::new(frame.x * share.x / 100.0, frame.y * share.y / 100.0);
        let size = match self.size {
            Size::Absolute(cm) => cm * UNITS_PER_CM,
            Size::Relative(share) => percent(share),
        };
        let way = match self.direction {
            Direction::Absolute(way) => way,
            Direction::Relative(share) => percent(share),
        };
        let along = scaling.turned(way.normalized().unwrap_or(Vec2::new(1.0, 0.0)));
        let across = along.perpendicular();
        let cell = Vec2::new(size.x * CELL.x * (1.0 + self.extra.x), size.y * CELL.y * (1.0 + self.extra.y));
        let (to_right, to_top) = (along * cell.x, across * cell.y);
        let (advance, feed) = match self.path {
            1 => (-to_top, -to_right),
            2 => (-to_right, to_top),
            3 => (to_top, to_right),
            _ => (to_right, -to_top),
        };
        Metrics {
            right: along * size.x,
            up: across * size.y + along * (size.y * self.slant),
            upright: across * size.y,
            advance,
            feed: if self.reversed { -feed } else { feed },
        }
    }

    /// Whether the pen stays at the end of a label, where the next one goes on; elsewhere it goes back to
    /// where it was.
    ///
    /// Source: *The HP-GL/2 and HP RTL Reference Guide*, on `LO`: the combinations of `DV` and `LO` that
    /// concatenate.
    pub(super) fn goes_on(&self) -> bool {
        let place = self.origin % 10;
        match self.path {
            1 => matches!(place, 3 | 6 | 9) || self.is_usual(),
            2 => matches!(place, 7..=9) || self.is_usual(),
            3 => matches!(place, 1 | 4 | 7),
            _ => matches!(place, 1..=3),
        }
    }

    /// Whether labels begin where the pen is, however long they are.
    pub(super) fn is_usual(&self) -> bool {
        self.origin == 1
    }

    /// From the pen to the first of `count` characters, for the label to lie to the pen as `LO` says:
    ///
    /// ```text
    ///  3    6    9     above:  the label hangs below the pen
    ///  2    5    8
    ///  1    4    7     below:  it stands on it
    /// left middle right: its left end, middle or right end is at the pen
    /// ```
    ///
    /// From 11 on it keeps away from the pen by half a capital letter; with 1 it simply begins there.
    pub(super) fn shift(&self, metrics: &Metrics, count: usize) -> Vec2 {
        if self.is_usual() || count == 0 {
            return Vec2::default();
        }
        #[expect(clippy::cast_precision_loss, reason = "at most 150 characters")]
        let run = metrics.advance * (count - 1) as f64;
        let (right, up) = (metrics.right, metrics.upright);
        let part =
            |of: Vec2, along: Vec2| of.dot(along) / libm::fmax(along.length_squared(), f64::MIN_POSITIVE);
        // The box round all characters, in widths and heights of one.
        let (run_x, run_y) = (part(run, right), part(run, up));
        let (left, width) = (libm::fmin(0.0, run_x), libm::fabs(run_x) + 1.0);
        let (bottom, height) = (libm::fmin(0.0, run_y), libm::fabs(run_y) + 1.0);
        let place = self.origin % 10;
        let (column, row) = (f64::from((place - 1) / 3), f64::from((place - 1) % 3));
        let away = if self.origin > 10 { 0.5 } else { 0.0 };
        let x = -(left + 0.5 * width * column) + away * (1.0 - column);
        let y = -(bottom + 0.5 * height * row) + away * (1.0 - row);
        right * x + up * y
    }
}
