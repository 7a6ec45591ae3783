//! Polygons: `PM`, `EP`, `FP`, rectangles, and how they are filled: `FT`, `AC`, `UF`.

use super::super::UNITS_PER_MM;
use super::super::hatch::{Hatch, Lay, Rule};
use super::super::piece::{Piece, turned_deg};
use super::super::polygon::Cursor;
use super::super::{Error, Position};
use super::Interpreter;
use super::job::Job;
use super::open::Open;
use crate::Vec2;

/// Distance of hatching where none is said: a hundredth of the way from P1 to P2.
const USUAL_SPACING_SHARE: f64 = 0.01;
/// The shading where none is said, %.
const USUAL_SHADE_PERCENT: f64 = 50.0;

/// Rasters that `RF` defines.
const RASTERS: usize = 8;
const NO_RASTER: u8 = u8::MAX;

/// How polygons are filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fill {
    kind: Kind,
    /// Distance of hatching as the text says it, in its own units along x; 0 for the usual one.
    spacing: f64,
    angle_deg: f64,
    shade_percent: f64,
    /// Distance of a user-defined fill: the mean of those given, in the text's own units.
    own_spacing: f64,
    /// A place on a line.
    anchor: Vec2,
    /// How much of the paper each raster of `RF` inks, whole %; [`NO_RASTER`] for one that is not defined.
    rasters_percent: [u8; RASTERS],
    /// Dots with ink of the raster that is being told.
    inked: f64,
}

impl Default for Fill {
    fn default() -> Self {
        Self {
            kind: Kind::Solid,
            spacing: 0.0,
            angle_deg: 0.0,
            shade_percent: 0.0,
            own_spacing: 0.0,
            anchor: Vec2::default(),
            rasters_percent: [NO_RASTER; RASTERS],
            inked: 0.0,
        }
    }
}

/// What `FT` knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A pen's width apart, back and forth.
    Solid,
    /// Likewise, all in one direction.
    SolidOneWay,
    Lines,
    Crossed,
    /// Lines so far apart that the pen covers a share of the paper.
    Shaded,
    Own,
}

impl<const VERTICES: usize> Interpreter<VERTICES> {
    pub(super) fn polygon_mode(&mut self, open: &Open) -> Result<(), Error> {
        match open.whole(0, 0, 0, 2, "0 to begin a polygon, 1 to close a part of it, 2 to end it")? {
            0 => {
                self.leave_dot();
                self.overflow_said = false;
                self.recording = true;
                self.polygon.begin(self.at);
            }
            // Without a beginning there is nothing to close.
            mode if self.recording => {
                let closed = self.polygon.close(self.pen_down);
                self.record(closed);
                self.recording = mode == 1;
            }
            _ => {}
        }
        Ok(())
    }

    /// Forgets the polygon.
    pub(super) fn leave_polygon(&mut self) {
        self.recording = false;
        self.polygon.clear();
    }

    pub(super) fn say_overflow(&mut self) {
        if !core::mem::replace(&mut self.overflow_said, true)
            && let Some((command, at)) = self.latest
        {
            let places = u32::try_from(VERTICES).unwrap_or(u32::MAX);
            self.report = Some(Error::PolygonTooLong { at, command, places });
        }
    }

    /// `EP`
    pub(super) fn edge(&mut self) {
        self.leave_dot();
        self.job = Job::Edge(Cursor::default());
    }

    pub(super) fn edge_or_fill(&mut self, edge: bool) -> Result<(), Error> {
        if edge {
            self.edge();
            return Ok(());
        }
        self.fill_with(Rule::EvenOdd)
    }

    pub(super) fn fill_polygon(&mut self, open: &Open) -> Result<(), Error> {
        let rule = open.whole(0, 0, 0, 1, "0 to fill what an odd number of sides surrounds or 1 for all")?;
        self.leave_dot();
        self.fill_with(if rule == 0 { Rule::EvenOdd } else { Rule::Winding })
    }

    fn fill_with(&mut self, rule: Rule) -> Result<(), Error> {
        let Some((command, at)) = self.latest else { return Ok(()) };
        if self.polygon.is_overflown() {
            return Err(Error::NotFilled { at, command });
        }
        let Fill { kind, spacing, angle_deg, shade_percent, own_spacing, anchor, .. } = self.fill;
        let width = self.width_units();
        let hatching = |spacing: f64| {
            let spacing = libm::fabs(spacing) * self.scaling.x_factor();
            if spacing > 0.0 { spacing } else { self.scaling.frame().length() * USUAL_SPACING_SHARE }
        };
        let (spacing, angle_deg) = match kind {
            Kind::Solid | Kind::SolidOneWay => (width, 0.0),
            Kind::Lines | Kind::Crossed => (hatching(spacing), angle_deg),
            Kind::Shaded if shade_percent == 0.0 => return Ok(()),
            Kind::Shaded => (width * 100.0 / shade_percent, angle_deg),
            Kind::Own => (hatching(own_spacing), angle_deg),
        };
        let lay = Lay {
            anchor,
            along: self.scaling.turned(turned_deg(Vec2::new(1.0, 0.0), angle_deg)),
            spacing,
            back_and_forth: kind != Kind::SolidOneWay,
            rule,
            crossed: kind == Kind::Crossed,
        };
        let hatch = Hatch::new(&self.polygon, lay).ok_or(Error::TooFine {
            at,
            command,
            spacing_mm: spacing / UNITS_PER_MM,
        })?;
        let patterned = !matches!(kind, Kind::Solid | Kind::SolidOneWay | Kind::Shaded);
        self.job = Job::Fill(hatch, patterned);
        Ok(())
    }

    pub(super) fn rectangle(&mut self, open: &Open) -> Result<(), Error> {
        let corner = open.pair(0).ok_or(open.missing("the opposite corner's x and y"))?;
        let [first, second] = open.command.letters();
        let edge = *first == b'E';
        let relative = *second == b'R';
        self.leave_dot();
        let from = self.at;
        let corner = self.target(corner, relative);
        self.overflow_said = false;
        self.polygon.begin(from);
        // Along the sheet's axes: every turn of the coordinates is by right angles.
        let corners = [Vec2::new(corner.x, from.y), corner, Vec2::new(from.x, corner.y), from];
        let mut at = from;
        for to in corners {
            let side = self.polygon.push(Piece::Line { from: at, to }, true);
            self.record(side);
            at = to;
        }
        // Without a side there is the start to be drawn on.
        let closed = self.polygon.close(true);
        self.record(closed);
        self.edge_or_fill(edge)
    }

    pub(super) fn set_fill(&mut self, open: &Open) -> Result<(), Error> {
        let expected = "a fill type: 1 and 2 solid, 3 lines, 4 crossed lines, 5 or 10 shaded, 6 own, 11 a raster, 21 a printer's lines";
        let kind = open.whole(0, 1, 1, 22, expected)?;
        let mut fill = self.fill;
        fill.kind = match kind {
            1 => Kind::Solid,
            2 => Kind::SolidOneWay,
            3 => Kind::Lines,
            4 => Kind::Crossed,
            5 | 10 => Kind::Shaded,
            6 => Kind::Own,
            11 => return self.set_raster_fill(open),
            21 => return self.set_printers_lines(open),
            _ => return Err(open.bad(0, expected)),
        };
        match fill.kind {
            Kind::Lines | Kind::Crossed | Kind::Own => {
                if kind <= 4 {
                    fill.spacing = open.or(1, fill.spacing);
                }
                fill.angle_deg = open.or(2, fill.angle_deg);
            }
            Kind::Shaded => {
                fill.shade_percent = open.or(1, USUAL_SHADE_PERCENT);
                if !(0.0..=100.0).contains(&fill.shade_percent) {
                    return Err(open.bad(1, "a shading from 0 to 100 percent"));
                }
            }
            Kind::Solid | Kind::SolidOneWay => {}
        }
        self.fill = fill;
        Ok(())
    }

    /// A raster has no lines: the pen shades as much of the paper as it would ink.
    fn set_raster_fill(&mut self, open: &Open) -> Result<(), Error> {
        let raster = open.whole(1, 1, 1, 8, "a raster from 1 to 8")?;
        let percent = self.fill.rasters_percent.get(usize::from(raster) - 1).copied().unwrap_or(NO_RASTER);
        self.fill.kind = if percent == NO_RASTER { Kind::Solid } else { Kind::Shaded };
        self.fill.shade_percent = percent.into();
        Ok(())
    }

    /// The six patterns of lines that a printer has.
    ///
    /// Source: Hewlett-Packard, *PCL 5 Printer Language Technical Reference Manual*, chapter 13, "HP-defined
    /// cross-hatch patterns".
    fn set_printers_lines(&mut self, open: &Open) -> Result<(), Error> {
        let expected = "lines that lie 1, stand 2, rise 3 or fall 4, or are crossed: upright 5 or slanting 6";
        let (kind, angle_deg) = match open.whole(1, 1, 1, 6, expected)? {
            1 => (Kind::Lines, 0.0),
            2 => (Kind::Lines, 90.0),
            3 => (Kind::Lines, 45.0),
            4 => (Kind::Lines, 135.0),
            5 => (Kind::Crossed, 0.0),
            _ => (Kind::Crossed, 45.0),
        };
        self.fill = Fill { kind, angle_deg, spacing: 0.0, ..self.fill };
        Ok(())
    }

    /// One more number of `RF`: which raster, its width and height, and a pen for each dot.
    pub(super) fn raster_number(&mut self, open: &mut Open, value: f64, at: Position) {
        match open.given() {
            0 => self.fill.inked = 0.0,
            3.. if value != 0.0 => self.fill.inked += 1.0,
            _ => {}
        }
        open.push(value, at);
    }

    /// `RF` without dots forgets a raster, without numbers all of them.
    pub(super) fn set_raster(&mut self, open: &Open) -> Result<(), Error> {
        if open.given() == 0 {
            self.fill.rasters_percent = [NO_RASTER; RASTERS];
            return Ok(());
        }
        let raster = open.whole(0, 1, 1, 8, "a raster from 1 to 8")?;
        let dots = open.given().saturating_sub(3);
        if dots == 0 && open.given() > 1 {
            return Err(open.missing("a pen for each dot of the raster"));
        }
        // Rounded up: a raster with ink has some.
        let percent = libm::ceil(100.0 * self.fill.inked / f64::from(dots.max(1)));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 100")]
        let percent = if dots > 0 { percent as u8 } else { NO_RASTER };
        if let Some(slot) = self.fill.rasters_percent.get_mut(usize::from(raster) - 1) {
            *slot = percent;
        }
        Ok(())
    }

    pub(super) fn set_anchor(&mut self, open: &Open) -> Result<(), Error> {
        self.fill.anchor = if open.none_or(2, "the anchor's x and y")? {
            self.scaling.place(open.pair(0).unwrap_or_default())
        } else {
            Vec2::default()
        };
        Ok(())
    }

    pub(super) fn set_fill_pattern(&mut self, open: &Open) -> Result<(), Error> {
        let gaps = open.numbers();
        if gaps.iter().any(|gap| *gap < 0.0) {
            return Err(open.bad(0, "distances between the lines, none below 0"));
        }
        let total: f64 = gaps.iter().sum();
        #[expect(clippy::cast_precision_loss, reason = "at most 21 numbers")]
        let count = gaps.len().max(1) as f64;
        self.fill.own_spacing = total / count;
        Ok(())
    }

    /// `DF`: solid, with the anchor at the origin.
    pub(super) fn set_usual_fill(&mut self) {
        self.fill = Fill::default();
    }
}
