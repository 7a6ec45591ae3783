//! Circles, arcs and wedges: `CI`, `AA`, `AR`, `AT`, `RT`, `EW`, `WG`; and `CT`, which says how fine they
//! are.

use super::super::Error;
use super::super::piece::{Arc, Piece, rad, turned_deg};
use super::Interpreter;
use super::job::{Job, Round, Shape};
use super::open::Open;
use crate::Vec2;

/// A chord angle up to this is that of a plotter that knows no arcs, and an arc is what is meant, degrees.
const ROUND_DEG: f64 = 5.0;
/// The finest chord angle: a finer one is taken as this, so that a circle never has more than 1000 chords.
const MIN_CHORD_DEG: f64 = 0.36;
/// The greatest angle of an arc, degrees: the whole circle.
const MOST_SWEEP_DEG: f64 = 360.0;

const CHORD_ANGLE: &str = "a chord angle of at most 180 degrees";

impl<const VERTICES: usize> Interpreter<VERTICES> {
    pub(super) fn set_chord_kind(&mut self, open: &Open) -> Result<(), Error> {
        let kind = open.whole(0, 0, 0, 1, "0 for chord angles or 1 for distances of chords")?;
        self.chord_is_distance = kind == 1;
        Ok(())
    }

    /// The chord angle of an arc, degrees; `None` for a true arc.
    fn chord_deg(&self, open: &Open, index: usize, radius: f64) -> Result<Option<f64>, Error> {
        let said = match open.get(index) {
            Some(angle) if !self.chord_is_distance && angle.abs() > 180.0 => {
                return Err(open.bad(index, CHORD_ANGLE));
            }
            Some(distance) if self.chord_is_distance => {
                let share = (distance / radius).abs();
                // A chord that far from its arc would be farther than the centre.
                Some(if share < 1.0 { 2.0 * libm::acos(1.0 - share).to_degrees() } else { 180.0 })
            }
            angle => angle.map(f64::abs),
        };
        let round = said.is_none_or(|angle| angle <= ROUND_DEG);
        if round && self.scaling.keeps_circles() {
            return Ok(None);
        }
        // An ellipse: as near as other curves are.
        let radius_units = self.scaling.way(Vec2::new(radius, radius)).length();
        let finest =
            2.0 * libm::acos(1.0 - (self.tolerance_units / radius_units).clamp(0.0, 1.0)).to_degrees();
        let angle = if round { libm::fmin(finest, ROUND_DEG) } else { said.unwrap_or(ROUND_DEG) };
        Ok(Some(libm::fmax(angle, MIN_CHORD_DEG)))
    }

    pub(super) fn circle(&mut self, open: &Open) -> Result<(), Error> {
        let radius = open.get(0).ok_or(open.missing("a radius in plotter units"))?;
        let chord_deg = self.chord_deg(open, 1, radius)?;
        // Lowered before the circle, the pen has already left its dot at the centre.
        self.leave_dot();
        let centre = self.at;
        if radius == 0.0 {
            self.draw(Piece::Line { from: centre, to: centre });
            return Ok(());
        }
        if self.recording {
            let closed = self.polygon.close(self.pen_down);
            self.record(closed);
        }
        let Some(chord_deg) = chord_deg else {
            // The way to the rim need not be turned: it is as long and as far round everywhere.
            let rim = centre + self.scaling.way(Vec2::new(radius, 0.0));
            let sweep_rad =
                if self.scaling.mirrors() { -core::f64::consts::TAU } else { core::f64::consts::TAU };
            let arc = Arc { centre, from: rim, sweep_rad, to: rim };
            if self.recording {
                for stored in [
                    self.polygon.start_at(rim),
                    self.polygon.push(arc.into(), true),
                    self.polygon.close(true),
                ] {
                    self.record(stored);
                }
            } else {
                for piece in [Piece::Travel { to: rim }, arc.into(), Piece::Travel { to: centre }] {
                    self.draw(piece);
                }
            }
            return Ok(());
        };
        let mut round = Round {
            centre: self.scaling.user(centre),
            shape: Shape::Circle { radius },
            chords: chords(MOST_SWEEP_DEG, chord_deg),
            next: 1,
            at: centre,
        };
        round.at = round.place(0, &self.scaling);
        if self.recording {
            let started = self.polygon.start_at(round.at);
            self.record(started);
        } else {
            self.draw(Piece::Travel { to: round.at });
        }
        self.job = Job::Round(round);
        Ok(())
    }

    pub(super) fn arc(&mut self, open: &Open) -> Result<(), Error> {
        let (Some(centre), Some(sweep_deg)) = (open.pair(0), open.get(2)) else {
            return Err(open.missing("the centre's x and y and an angle"));
        };
        if sweep_deg.abs() > MOST_SWEEP_DEG {
            return Err(open.bad(2, "an angle of at most 360 degrees"));
        }
        let centre = self.target(centre, open.command.letters() == b"AR");
        self.arc_about(centre, sweep_deg, open, 3)
    }

    /// The number at `chord` is the chord angle.
    fn arc_about(&mut self, centre: Vec2, sweep_deg: f64, open: &Open, chord: usize) -> Result<(), Error> {
        let from = self.at;
        let (centre_user, from_user) = (self.scaling.user(centre), self.scaling.user(from));
        let out_user = from_user - centre_user;
        let chord_deg = self.chord_deg(open, chord, out_user.length())?;
        self.dot_owed &= !self.pen_down;
        self.begin_curve();
        let mirrored = if self.scaling.mirrors() { -sweep_deg } else { sweep_deg };
        let to = match chord_deg {
            None => {
                let to = centre + turned_deg(from - centre, mirrored);
                let arc = Arc { centre, from, sweep_rad: rad(mirrored), to };
                let drawn = self.pen_down || self.recording;
                self.draw(if drawn { arc.into() } else { Piece::Travel { to } });
                to
            }
            Some(chord_deg) => {
                let shape = Shape::Arc { out: out_user, sweep_deg };
                let chords = chords(sweep_deg, chord_deg);
                let round = Round { centre: centre_user, shape, chords, next: 1, at: from };
                let to = round.place(chords, &self.scaling);
                if self.pen_down || self.recording {
                    self.job = Job::Round(round);
                } else {
                    self.draw(Piece::Travel { to });
                }
                to
            }
        };
        self.arrive(to);
        Ok(())
    }

    pub(super) fn arc_through(&mut self, open: &Open) -> Result<(), Error> {
        let (Some(middle), Some(to)) = (open.pair(0), open.pair(2)) else {
            return Err(open.missing("a place on the arc and its end"));
        };
        let relative = open.command.letters() == b"RT";
        let [middle, to] = [middle, to].map(|user| self.target(user, relative));
        let from = self.at;
        // The circle is the user's: through the places as they are numbered.
        let user = |at: Vec2| self.scaling.user(at);
        if from == to && from != middle {
            let centre = self.target((user(from) + user(middle)) * 0.5, false);
            return self.arc_about(centre, MOST_SWEEP_DEG, open, 4);
        }
        match Arc::through(user(from), user(middle), user(to)) {
            Some(arc) => {
                let centre = self.scaling.place(arc.centre);
                self.arc_about(centre, arc.sweep_rad.to_degrees(), open, 4)?;
                self.arrive(to);
                Ok(())
            }
            // On a line: there and, where the place between is beyond, back.
            None => {
                self.move_to(middle);
                self.move_to(to);
                Ok(())
            }
        }
    }

    pub(super) fn wedge(&mut self, open: &Open) -> Result<(), Error> {
        let [Some(radius), Some(start_deg), Some(sweep_deg)] = [open.get(0), open.get(1), open.get(2)] else {
            return Err(open.missing("a radius and two angles"));
        };
        if sweep_deg.abs() > MOST_SWEEP_DEG {
            return Err(open.bad(2, "an angle of at most 360 degrees"));
        }
        let chord_deg = self.chord_deg(open, 3, radius)?;
        self.leave_dot();
        let centre = self.at;
        let centre_user = self.scaling.user(centre);
        let out = turned_deg(Vec2::new(radius, 0.0), start_deg);
        let rim = self.scaling.place(centre_user + out);
        let whole = sweep_deg.abs() >= MOST_SWEEP_DEG;
        self.overflow_said = false;
        self.polygon.begin(if whole { rim } else { centre });
        if !whole {
            let side = self.polygon.push(Piece::Line { from: centre, to: rim }, true);
            self.record(side);
        }
        match chord_deg {
            None => {
                let mirrored = if self.scaling.mirrors() { -sweep_deg } else { sweep_deg };
                let to = centre + turned_deg(rim - centre, mirrored);
                let arc = Arc { centre, from: rim, sweep_rad: rad(mirrored), to };
                let side = self.polygon.push(arc.into(), true);
                self.record(side);
            }
            Some(chord_deg) => {
                // A buffer too small for it makes a wedge coarser.
                let room = u32::try_from(VERTICES.saturating_sub(4)).unwrap_or(u32::MAX);
                let chords = chords(sweep_deg, chord_deg).min(room);
                let shape = Shape::Arc { out, sweep_deg };
                let mut round = Round { centre: centre_user, shape, chords, next: 1, at: rim };
                while let Some(chord) = round.next(&self.scaling) {
                    let side = self.polygon.push(chord, true);
                    self.record(side);
                }
            }
        }
        let closed = self.polygon.close(true);
        self.record(closed);
        self.edge_or_fill(open.command.letters() == b"EW")
    }
}

/// Into how many chords an angle is divided: at most 1000.
fn chords(sweep_deg: f64, chord_deg: f64) -> u32 {
    let chords = libm::ceil(sweep_deg.abs() / chord_deg);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number, clamped")]
    let chords = chords.clamp(1.0, 1000.0) as u32;
    chords
}
