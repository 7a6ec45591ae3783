//! Instructions for coordinates and line types: `IN`, `DF`, `IP`, `IR`, `SC`, `RO`, `PS`, `IW`, `LT`, `UL`,
//! `PW`, `PT`, `WU`, `TL`.

use super::super::character_set::CharacterSets;
use super::super::line_type::{LineType, Pattern};
use super::super::scaling::{Kind, UserArea};
use super::super::window::Window;
use super::super::{Error, UNITS_PER_MM};
use super::open::Open;
use super::{Interpreter, PENS};
use crate::Vec2;

/// Width of a pen while nothing is said, mm: that of HP-GL/2.
pub(super) const USUAL_WIDTH_MM: f64 = 0.35;
/// Thickness of a pen while `PT` gives none, mm.
const USUAL_THICKNESS_MM: f64 = 0.3;
/// Width where `PW` gives none in percent of the way from P1 to P2.
const USUAL_WIDTH_PERCENT: f64 = 0.1;
/// The thinnest pen, mm: what is filled with a thinner one is filled with this.
const THINNEST_MM: f64 = 0.01;
/// Length of a tick to either side where none is said, %.
pub(super) const USUAL_TICK_PERCENT: (f64, f64) = (0.5, 0.5);
/// Length of a line pattern where none is said, % of the way from P1 to P2.
const USUAL_PATTERN_PERCENT: f64 = 4.0;

/// Sheets that a 7475A tells apart by number: P1, P2, and the far corner.
///
/// Source: *HP 7475A Interfacing and Programming Manual*, chapter 2.
const A4: [Vec2; 3] = [Vec2::new(603.0, 521.0), Vec2::new(10_603.0, 7_721.0), Vec2::new(11_040.0, 7_721.0)];
const A3: [Vec2; 3] = [Vec2::new(170.0, 602.0), Vec2::new(15_370.0, 10_602.0), Vec2::new(16_158.0, 11_040.0)];
/// `PS` below this is the number of a sheet, from it on a length; and below [`A4_FROM`] it is A3.
const LENGTH_FROM: f64 = 128.0;
const A4_FROM: f64 = 4.0;

impl<const VERTICES: usize> Interpreter<VERTICES> {
    /// `IN`: everything but the size of the sheet and the place of the pen.
    pub(super) fn initialize(&mut self) {
        self.lift();
        self.leave_polygon();
        self.scaling.initialize();
        self.feeds_mm_s = [None; PENS];
        self.feed_mm_s = None;
        self.set_defaults();
        self.widths_mm = [USUAL_WIDTH_MM; PENS];
        self.width_mm = USUAL_WIDTH_MM;
        self.width_in_percent = false;
        self.own.clear();
        self.buffered_count = 0;
    }

    /// `DF`
    pub(super) fn set_defaults(&mut self) {
        self.relative = false;
        self.scaling.set_area(None);
        self.set_window_corners(None);
        self.patterns = core::array::from_fn(Pattern::usual);
        self.pattern_length = 0.0;
        self.path.set_line_type(LineType::Solid);
        self.line_type_before = LineType::Solid;
        self.chord_is_distance = false;
        self.tick_percent = USUAL_TICK_PERCENT;
        self.symbol = None;
        self.lettering.initialize();
        self.sets = CharacterSets::default();
        self.lead = None;
        self.set_usual_fill();
    }

    pub(super) fn set_points(&mut self, open: &Open) -> Result<(), Error> {
        if open.none_or(2, "the x and y of P1, or of P1 and P2")? && open.given() == 3 {
            return Err(open.missing("the y of P2"));
        }
        let (p1, p2) = (open.pair(0), open.pair(2));
        match open.command.letters() {
            b"IP" => self.scaling.set_points(p1, p2),
            _ => self.scaling.set_relative_points(p1, p2),
        }
        Ok(())
    }

    pub(super) fn set_scale(&mut self, open: &Open) -> Result<(), Error> {
        if !open.none_or(4, "four numbers: the least and greatest x, the least and greatest y")? {
            self.scaling.set_area(None);
            return Ok(());
        }
        let [x1, x2, y1, y2] = [open.or(0, 0.0), open.or(1, 0.0), open.or(2, 0.0), open.or(3, 0.0)];
        let kind = open.whole(4, 0, 0, 2, "0 to stretch, 1 not to, or 2 for factors as its fifth number")?;
        let (kind, last) = match kind {
            0 => (Kind::Stretched, Vec2::new(x2, y2)),
            1 => {
                let percent = |index| match open.or(index, 50.0) {
                    share if (0.0..=100.0).contains(&share) => Ok(share),
                    _ => Err(open.bad(index, "a share from 0 to 100 percent")),
                };
                (Kind::Undistorted { left: percent(5)?, bottom: percent(6)? }, Vec2::new(x2, y2))
            }
            _ => (Kind::Factors { x: x2, y: y2 }, Vec2::default()),
        };
        let expected = "an area with a width and a height";
        match kind {
            Kind::Factors { x, y } if x == 0.0 || y == 0.0 => {
                return Err(open.bad(if x == 0.0 { 1 } else { 3 }, "a factor that is not 0"));
            }
            Kind::Factors { .. } => {}
            _ if x1 == x2 => return Err(open.bad(1, expected)),
            _ if y1 == y2 => return Err(open.bad(3, expected)),
            _ => {}
        }
        self.scaling.set_area(Some(UserArea { kind, first: Vec2::new(x1, y1), last }));
        Ok(())
    }

    pub(super) fn turn(&mut self, open: &Open) -> Result<(), Error> {
        let quarters = match open.or(0, 0.0) {
            0.0 | 360.0 => 0,
            90.0 => 1,
            180.0 => 2,
            270.0 => 3,
            _ => return Err(open.bad(0, "0, 90, 180 or 270 degrees")),
        };
        self.scaling.turn(quarters);
        self.set_window_corners(self.window);
        self.lettering.line_start = self.at;
        Ok(())
    }

    /// A length and a width, units; or the number of a sheet on the old plotters. With nothing it stays as it
    /// is.
    pub(super) fn set_sheet(&mut self, open: &Open) -> Result<(), Error> {
        let Some(length) = open.get(0) else { return Ok(()) };
        let width = open.or(1, length);
        if !(length >= 0.0 && width > 0.0 || length == 0.0) {
            return Err(open.bad(usize::from(length >= 0.0), "a length and a width above 0"));
        }
        let [p1, p2, sheet] = match open.get(1) {
            None if length < A4_FROM => A3,
            None if length < LENGTH_FROM => A4,
            _ => [Vec2::default(), Vec2::new(length, width), Vec2::new(length, width)],
        };
        self.scaling.set_sheet(sheet, p1, p2);
        self.set_window_corners(self.window);
        Ok(())
    }

    pub(super) fn set_window(&mut self, open: &Open) -> Result<(), Error> {
        let has_corners = open.none_or(4, "the x and y of two opposite corners")?;
        self.set_window_corners(has_corners.then(|| {
            let corner = |index| self.scaling.units(open.pair(index).unwrap_or_default());
            (corner(0), corner(2))
        }));
        Ok(())
    }

    /// The window keeps its numbers, in plotter units, when the axes turn.
    fn set_window_corners(&mut self, corners: Option<(Vec2, Vec2)>) {
        self.window = corners;
        self.path.window = corners
            .map(|(a, b)| Window::between(self.scaling.place_of_units(a), self.scaling.place_of_units(b)));
    }

    pub(super) fn set_line_type(&mut self, open: &Open) -> Result<(), Error> {
        let expected = "a line type from -8 to 8, or 99 for the one before";
        let line_type = match open.get(0) {
            None => LineType::Solid,
            Some(0.0) => LineType::Ends,
            Some(99.0) => {
                let before = self.line_type_before;
                self.path.set_line_type(before);
                return Ok(());
            }
            Some(number) => {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "compared with the number below"
                )]
                let index = number.abs() as usize;
                #[expect(clippy::cast_precision_loss, reason = "compared with the number")]
                let whole = index as f64 == number.abs();
                let pattern = self.patterns.get(index.wrapping_sub(1)).copied();
                let pattern = pattern.filter(|_| whole).ok_or(open.bad(0, expected))?;
                if open.get(1).is_some_and(|length| length <= 0.0) {
                    return Err(open.bad(1, "a length above 0"));
                }
                let in_mm = open.whole(2, 0, 0, 1, "0 for a length in percent or 1 for mm")? == 1;
                self.pattern_length = match open.get(1) {
                    Some(length) if in_mm => length * UNITS_PER_MM,
                    Some(percent) => self.scaling.frame().length() * percent / 100.0,
                    None if self.pattern_length > 0.0 => self.pattern_length,
                    None => self.scaling.frame().length() * USUAL_PATTERN_PERCENT / 100.0,
                };
                let length = self.pattern_length;
                if number < 0.0 {
                    LineType::Fitted { pattern, length }
                } else {
                    LineType::Fixed { pattern, length }
                }
            }
        };
        if line_type == LineType::Solid {
            self.line_type_before = self.path.line_type;
        }
        self.path.set_line_type(line_type);
        Ok(())
    }

    pub(super) fn set_pattern(&mut self, open: &Open) -> Result<(), Error> {
        if open.given() == 0 {
            self.patterns = core::array::from_fn(Pattern::usual);
            return Ok(());
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index that is looked up"
        )]
        let index = (open.or(0, 0.0).abs() as usize).wrapping_sub(1);
        let gaps = open.numbers().get(1..).unwrap_or(&[]);
        let pattern =
            if gaps.is_empty() { Some(Pattern::usual(index)) } else { Pattern::new(gaps.iter().copied()) };
        let pattern = pattern.ok_or(open.bad(1, "up to 20 lengths, none below 0 and not all 0"))?;
        let slot = self.patterns.get_mut(index);
        *slot.ok_or(open.bad(0, "the number of a line type, 1 to 8"))? = pattern;
        Ok(())
    }

    /// `PW` for all pens or one, `PT` for the pen in use.
    pub(super) fn set_width(&mut self, open: &Open) -> Result<(), Error> {
        let thickness = open.command.letters() == b"PT";
        let width = match open.get(0) {
            Some(width) if width < 0.0 => return Err(open.bad(0, "a width of at least 0")),
            Some(width) if thickness || !self.width_in_percent => width,
            None if thickness => USUAL_THICKNESS_MM,
            None if !self.width_in_percent => USUAL_WIDTH_MM,
            percent => {
                self.scaling.frame().length() / UNITS_PER_MM * percent.unwrap_or(USUAL_WIDTH_PERCENT) / 100.0
            }
        };
        let pen = if thickness { usize::from(self.pen).checked_sub(1) } else { self.pen_index(open)? };
        match pen.and_then(|index| self.widths_mm.get_mut(index)) {
            Some(slot) => *slot = width,
            None => {
                self.width_mm = width;
                if !thickness {
                    self.widths_mm = [width; PENS];
                }
            }
        }
        Ok(())
    }

    /// Width of the pen in use, units.
    pub(super) fn width_units(&self) -> f64 {
        let own = usize::from(self.pen).checked_sub(1).and_then(|index| self.widths_mm.get(index));
        libm::fmax(own.copied().unwrap_or(self.width_mm), THINNEST_MM) * UNITS_PER_MM
    }

    pub(super) fn set_width_unit(&mut self, open: &Open) -> Result<(), Error> {
        self.width_in_percent = open.whole(0, 0, 0, 1, "0 for mm or 1 for percent")? == 1;
        Ok(())
    }

    /// With one length, ticks go to one side only.
    pub(super) fn set_ticks(&mut self, open: &Open) -> Result<(), Error> {
        self.tick_percent = match open.get(0) {
            None => USUAL_TICK_PERCENT,
            Some(first) => (first, open.or(1, 0.0)),
        };
        Ok(())
    }
}
