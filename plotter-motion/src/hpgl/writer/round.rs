//! Circles and arcs of [`Writer`]: as the plotter's own, and as chords where it has none that are near
//! enough.

use super::super::arc::{ArcUnits, FLAT_UNITS, GREATEST_UNITS, chord_angle_deg, chords};
use super::{Coordinates, Stroke, UNITS_PER_MM, WriteError, Writer, speed_steps};
use crate::{Point, StepPoint, toolpath::from_mm};
use core::f64::consts::{FRAC_PI_2, TAU};
use core::fmt;

/// Greatest radius of an arc that is left to the plotter, units: beyond it the centre may lie where the
/// numbers of old plotters end.
const MAX_RADIUS_UNITS: f64 = 32_767.0;

impl<W: fmt::Write> Writer<W> {
    /// Writes a circle round `centre` as `CI`, which the plotter itself divides into chords: PU to the
    /// centre, the circle, and the pen is up at the centre again. Above 13 mm it gets a chord angle, so that
    /// the chords stay within half a unit of it; above 650 mm half a degree, the least there is.
    ///
    /// ```
    /// # use plotter_motion::{Point, hpgl};
    /// let mut writer = hpgl::Writer::new(String::new());
    /// writer.circle(Point::new(10.0, 10.0), 2.5)?;
    /// assert_eq!(writer.finish()?, "IN;\nSP1;\nPU400,400;\nCI100;\nPU;\nSP0;\n");
    /// # Ok::<(), hpgl::WriteError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`WriteError::Point`] if the centre or the circle's rightmost point lies out of range, or the radius
    /// is not a number.
    pub fn circle(&mut self, centre: Point, radius_mm: f64) -> Result<(), WriteError> {
        let index = self.index;
        self.index += 1;
        let units = self.units(index, centre)?;
        self.units(index, Point::new(centre.x + radius_mm.abs(), centre.y))?;
        self.choose_pen()?;
        self.lift()?;
        let radius = from_mm(radius_mm.abs(), UNITS_PER_MM);
        write!(self.out, "PU{},{};\nCI{radius}", units.x, units.y)?;
        self.end_round(f64::from(radius))?;
        self.at = Some(units);
        Ok(())
    }

    /// Draws an arc about `centre` from where the pen stands to `to`, counter-clockwise for a sweep above 0:
    /// as `AA`, which the plotter itself divides into chords.
    ///
    /// The circle is the one about `centre` through `to`; where the pen stands ought to be on it. `AA` has
    /// its centre in whole units and begins where the pen is, so each piece of at most a quarter takes the
    /// centre for which both its middle and its end come out best, and the pen is sent to the end as it
    /// should be: errors do not add up. Chord angles are as with [`Writer::circle`]. Arcs that rise less than
    /// a quarter of a unit over their chord are lines; those of more than 819 mm radius, and pieces that no
    /// centre brings within one unit, are chords within half a unit of them.
    ///
    /// ```
    /// # use plotter_motion::{PlotOp, Point, hpgl};
    /// let mut writer = hpgl::Writer::new(String::new());
    /// writer.push(PlotOp::Travel { to: Point::new(15.0, 10.0) })?;
    /// writer.arc(Point::new(10.0, 10.0), 90.0_f64.to_radians(), Point::new(10.0, 15.0), None)?;
    /// let text = writer.finish()?;
    /// assert_eq!(text, "IN;\nSP1;\nPU600,400;\nPD;\nAA400,400,90;\nPD400,600;\nPU;\nSP0;\n");
    /// # Ok::<(), hpgl::WriteError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`WriteError::Point`] if the end, the centre or the way round lies out of range, and for a centre
    /// where the sweep is no angle of at most a whole turn.
    pub fn arc(
        &mut self,
        centre: Point,
        sweep_rad: f64,
        to: Point,
        feed_mm_s: Option<f64>,
    ) -> Result<(), WriteError> {
        let index = self.index;
        self.index += 1;
        let units = self.units(index, to)?;
        let speed = feed_mm_s.map(|feed| speed_steps(index, feed)).transpose()?;
        let refused = |to: Point| WriteError::Point { index, to, limit_units: self.options.limit_units };
        if !centre.is_finite() || !(-TAU..=TAU).contains(&sweep_rad) {
            return Err(refused(centre));
        }
        let out = to - centre;
        let radius = out.length() * UNITS_PER_MM;
        // Whatever it passes lies no farther out than the whole circle does, most of which is not drawn.
        let place = |back_rad: f64| centre + out.rotated(-back_rad);
        let quarters = libm::ceil(sweep_rad.abs() / FRAC_PI_2 - 1e-9).max(1.0);
        let flat = radius * (1.0 - libm::cos(0.5 * sweep_rad / quarters)) < FLAT_UNITS;
        let by_plotter = radius <= MAX_RADIUS_UNITS && self.units(index, centre).is_ok() && !flat;
        let parts = if by_plotter {
            quarters
        } else if flat {
            1.0
        } else {
            f64::from(chords(radius, sweep_rad))
        };
        let back = |part: f64| sweep_rad * (1.0 - part / parts);
        let mut part = 1.0;
        while part < parts {
            self.units(index, place(back(part)))?;
            part += 1.0;
        }
        self.choose_pen()?;
        self.change_speed(speed)?;
        let mut part = 1.0;
        while part <= parts {
            let end = if part < parts { self.units(index, place(back(part)))? } else { units };
            let middle = place(back(part - 0.5));
            if by_plotter {
                self.quarter(centre, middle, sweep_rad / parts, end, radius)?;
            } else {
                self.draw(end, self.speed)?;
            }
            part += 1.0;
        }
        Ok(())
    }

    /// One `AA` of at most a quarter about `centre` with its `middle` there, and the line to where it should
    /// have ended.
    fn quarter(
        &mut self,
        centre: Point,
        middle: Point,
        sweep_rad: f64,
        to: StepPoint,
        radius_units: f64,
    ) -> fmt::Result {
        let from = self.from()?;
        let arc = ArcUnits::nearest(from, to, centre, middle, sweep_rad > 0.0);
        let Some(arc) = arc.filter(|arc| arc.error_units <= GREATEST_UNITS) else {
            // Of a few units, or so short a part of a large circle that no centre on the grid is as far from
            // both of its rounded ends: as chords.
            let lines = chords(radius_units, sweep_rad);
            for line in 1..lines {
                let turn = sweep_rad * (f64::from(line) / f64::from(lines) - 0.5);
                let place = centre + (middle - centre).rotated(turn);
                let place = StepPoint::new(from_mm(place.x, UNITS_PER_MM), from_mm(place.y, UNITS_PER_MM));
                self.draw(place, self.speed)?;
            }
            return self.draw(to, self.speed);
        };
        self.end_encoded()?;
        match self.stroke {
            Stroke::None | Stroke::Dot => self.out.write_str("PD;\n")?,
            Stroke::Open(_) | Stroke::Closed => self.close_list()?,
        }
        write!(self.out, "AA{},{},", arc.centre.x, arc.centre.y)?;
        self.write_ten_thousandths(arc.sweep_e4_deg)?;
        self.end_round(radius_units)?;
        self.stroke = Stroke::Closed;
        self.at = Some(to);
        match self.options.coordinates {
            Coordinates::Absolute => self.open_list(from, to),
            Coordinates::Encoded => self.encode(to, false),
            // From where the arc has really ended, relative numbers would lead astray.
            Coordinates::Relative => writeln!(self.out, "PD{},{};", to.x, to.y),
        }
    }

    /// The chord angle, where one is needed, and the end of the command.
    fn end_round(&mut self, radius_units: f64) -> fmt::Result {
        match chord_angle_deg(radius_units) {
            Some(angle_deg) => writeln!(self.out, ",{angle_deg};"),
            None => self.out.write_str(";\n"),
        }
    }

    /// A number without trailing zeros.
    fn write_ten_thousandths(&mut self, number: i32) -> fmt::Result {
        let (whole, mut part) = (number.unsigned_abs() / 10_000, number.unsigned_abs() % 10_000);
        let sign = if number < 0 { "-" } else { "" };
        write!(self.out, "{sign}{whole}")?;
        let mut digits = 4;
        while part > 0 && part % 10 == 0 {
            part /= 10;
            digits -= 1;
        }
        if part > 0 { write!(self.out, ".{part:0digits$}") } else { Ok(()) }
    }
}
