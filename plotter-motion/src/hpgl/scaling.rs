//! [`Scaling`]: from the numbers of a text to plotter units: `IP`, `IR`, `SC`, `RO`, `PS`.

use super::ReadOptions;
use crate::Vec2;

/// Farthest place from the origin, plotter units: 2^40, or 27,000 km. What would lie beyond lies there, so
/// that no text makes a number that is none.
const FARTHEST_UNITS: f64 = 1_099_511_627_776.0;

/// How user units become plotter units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// The corners P1 and P2 are those of the user's area, however it is stretched.
    Stretched,
    /// The user's area lies within P1 and P2 undistorted, with so much of the room that is left at its left
    /// and below, %.
    Undistorted { left: f64, bottom: f64 },
    /// The user's first corner is P1, and these are the factors.
    Factors { x: f64, y: f64 },
}

/// A user's area, as `SC` says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UserArea {
    pub(super) kind: Kind,
    /// What lies at P1.
    pub(super) first: Vec2,
    /// What lies at P2; not asked with [`Kind::Factors`].
    pub(super) last: Vec2,
}

/// What coordinates mean: where P1 and P2 are, what lies there, and how all of it is turned.
///
/// ```text
/// numbers ── SC, IP ──▶ plotter units ── RO ──▶ plotter units on the sheet
///                       (turned axes)
/// ```
///
/// P1 and P2 are counted along the turned axes, and keep their numbers when the axes turn: they turn with
/// them. What goes by the sheet (`IR`, and `IP` without numbers) goes by the sheet as the turned axes see it,
/// whose width and height change places with each quarter.
///
/// Source: *PCL 5 Printer Language Technical Reference Manual*, part II, chapter 19, on `IP`, `IR` and `RO`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scaling {
    p1: Vec2,
    p2: Vec2,
    /// P1 and P2 when nothing has been said, on the sheet as it lies; and its far corner.
    usual: (Vec2, Vec2),
    sheet: Vec2,
    /// Whether the text has said how big the sheet is.
    sheet_said: bool,
    area: Option<UserArea>,
    /// Quarters of a turn, 0 to 3, counter-clockwise.
    quarters: u8,
}

impl Scaling {
    pub(super) fn new(options: &ReadOptions) -> Self {
        let place = |(x, y): (i32, i32)| Vec2::new(f64::from(x), f64::from(y));
        let usual = (place(options.p1_units), place(options.p2_units));
        let sheet = place(options.sheet_units);
        Self { p1: usual.0, p2: usual.1, usual, sheet, sheet_said: false, area: None, quarters: 0 }
    }

    /// `IN`: everything but the size of the sheet.
    pub(super) fn initialize(&mut self) {
        (self.p1, self.p2) = self.usual;
        self.area = None;
        self.quarters = 0;
    }

    /// `SC`.
    pub(super) fn set_area(&mut self, area: Option<UserArea>) {
        self.area = area;
    }

    /// `RO`.
    pub(super) fn turn(&mut self, quarters: u8) {
        self.quarters = quarters;
    }

    /// `PS`: a sheet of this size as it lies, with P1 and P2 in its corners (or where the plotter puts them).
    pub(super) fn set_sheet(&mut self, sheet: Vec2, p1: Vec2, p2: Vec2) {
        self.usual = (p1, p2);
        self.sheet = sheet;
        self.sheet_said = true;
        (self.p1, self.p2) = self.usual_now();
    }

    /// P1 and P2 when nothing has been said, along the turned axes: P1 is where least is counted of what lay
    /// between the two.
    fn usual_now(&self) -> (Vec2, Vec2) {
        let (p1, p2) = self.usual;
        let [a, b] = [p1, p2].map(|place| self.back(place - self.corner()));
        let ordered = |forwards: bool, a: f64, b: f64| {
            let (low, high) = (libm::fmin(a, b), libm::fmax(a, b));
            if forwards { (low, high) } else { (high, low) }
        };
        // A text's own P1 may be the right or the upper one: it stays so.
        let (x1, x2) = ordered(p1.x <= p2.x, a.x, b.x);
        let (y1, y2) = ordered(p1.y <= p2.y, a.y, b.y);
        (Vec2::new(x1, y1), Vec2::new(x2, y2))
    }

    /// `IP`: P2 comes along where only P1 is given.
    pub(super) fn set_points(&mut self, p1: Option<Vec2>, p2: Option<Vec2>) {
        let (first, last) = match (p1, p2) {
            (None, _) => self.usual_now(),
            (Some(p1), None) => (p1, p1 + (self.p2 - self.p1)),
            (Some(p1), Some(p2)) => (p1, p2),
        };
        (self.p1, self.p2) = (limited(first), limited(last));
    }

    /// `IR`: as `IP`, in percent of the sheet along the turned axes.
    pub(super) fn set_relative_points(&mut self, p1: Option<Vec2>, p2: Option<Vec2>) {
        let is_odd = self.quarters % 2 == 1;
        let sheet = if is_odd { Vec2::new(self.sheet.y, self.sheet.x) } else { self.sheet };
        let place = |share: Vec2| Vec2::new(sheet.x * share.x / 100.0, sheet.y * share.y / 100.0);
        self.set_points(p1.map(place), p2.map(place));
    }

    /// From P1 to P2.
    pub(super) fn frame(&self) -> Vec2 {
        self.p2 - self.p1
    }

    /// Factors to plotter units, and the plotter units of the user's origin, before the turn.
    fn factors(&self) -> (Vec2, Vec2) {
        let Some(UserArea { kind, first, last }) = self.area else {
            return (Vec2::new(1.0, 1.0), Vec2::default());
        };
        // Points that coincide are a unit apart, as the plotters have it.
        let apart = |way: f64| if way == 0.0 { 1.0 } else { way };
        let frame = Vec2::new(apart(self.frame().x), apart(self.frame().y));
        let span = last - first;
        let (factor, at_first) = match kind {
            Kind::Factors { x, y } => (Vec2::new(x, y), self.p1),
            Kind::Stretched => (Vec2::new(frame.x / span.x, frame.y / span.y), self.p1),
            Kind::Undistorted { left, bottom } => {
                let (x, y) = (frame.x / span.x, frame.y / span.y);
                let size = libm::fmin(libm::fabs(x), libm::fabs(y));
                let factor = Vec2::new(libm::copysign(size, x), libm::copysign(size, y));
                let room = frame - Vec2::new(factor.x * span.x, factor.y * span.y);
                let at = self.p1 + Vec2::new(room.x * left / 100.0, room.y * bottom / 100.0);
                (factor, at)
            }
        };
        (factor, at_first - Vec2::new(factor.x * first.x, factor.y * first.y))
    }

    /// Where user coordinates lie.
    pub(super) fn place(&self, user: Vec2) -> Vec2 {
        self.place_of_units(self.units(user))
    }

    /// User coordinates in plotter units along the turned axes.
    pub(super) fn units(&self, user: Vec2) -> Vec2 {
        if self.area.is_none() {
            return user;
        }
        let (factor, origin) = self.factors();
        Vec2::new(origin.x + factor.x * user.x, origin.y + factor.y * user.y)
    }

    /// Where plotter units along the turned axes lie on the sheet.
    pub(super) fn place_of_units(&self, units: Vec2) -> Vec2 {
        limited(self.turned(units) + self.shift())
    }

    /// The way that a user's step is.
    pub(super) fn way(&self, step: Vec2) -> Vec2 {
        if self.area.is_none() {
            return self.turned(step);
        }
        let (factor, _) = self.factors();
        limited(self.turned(Vec2::new(factor.x * step.x, factor.y * step.y)))
    }

    /// The user coordinates of a place.
    pub(super) fn user(&self, place: Vec2) -> Vec2 {
        let at = self.back(place - self.shift());
        let (factor, origin) = self.factors();
        let over = |way: f64, factor: f64| if factor == 0.0 { 0.0 } else { way / factor };
        Vec2::new(over(at.x - origin.x, factor.x), over(at.y - origin.y, factor.y))
    }

    /// How long a step of 1 to the right is, units.
    pub(super) fn x_factor(&self) -> f64 {
        libm::fabs(self.factors().0.x)
    }

    /// Whether circles stay circles.
    pub(super) fn keeps_circles(&self) -> bool {
        /// Relative difference of both factors that still counts as equal: rounding of `f64`, far below a
        /// plotter unit on any sheet.
        const ROUNDING: f64 = 1e-9;
        let (factor, _) = self.factors();
        let (x, y) = (libm::fabs(factor.x), libm::fabs(factor.y));
        libm::fabs(x - y) <= ROUNDING * libm::fmax(x, y)
    }

    /// Whether left and right change places.
    pub(super) fn mirrors(&self) -> bool {
        let (factor, _) = self.factors();
        (factor.x < 0.0) != (factor.y < 0.0)
    }

    /// `way` turned by `RO`.
    pub(super) fn turned(&self, way: Vec2) -> Vec2 {
        match self.quarters {
            1 => way.perpendicular(),
            2 => -way,
            3 => -way.perpendicular(),
            _ => way,
        }
    }

    fn back(&self, way: Vec2) -> Vec2 {
        match self.quarters {
            1 => -way.perpendicular(),
            2 => -way,
            3 => way.perpendicular(),
            _ => way,
        }
    }

    /// The corner of the sheet that the turned origin is moved to; none while the size of the sheet is not
    /// known.
    fn shift(&self) -> Vec2 {
        if self.sheet_said { self.corner() } else { Vec2::default() }
    }

    /// The corner of the sheet that is the lower left one along the turned axes.
    fn corner(&self) -> Vec2 {
        match self.quarters {
            1 => Vec2::new(self.sheet.x, 0.0),
            2 => self.sheet,
            3 => Vec2::new(0.0, self.sheet.y),
            _ => Vec2::default(),
        }
    }
}

/// `place`, or the nearest one that is not too far away.
pub(super) fn limited(place: Vec2) -> Vec2 {
    let limit = |value: f64| value.clamp(-FARTHEST_UNITS, FARTHEST_UNITS);
    Vec2::new(limit(place.x), limit(place.y))
}
