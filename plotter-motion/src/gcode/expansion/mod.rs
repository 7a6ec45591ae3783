//! [`Expansion`]: words that stand for several movements, or change what coordinates mean, made lines that
//! every machine knows.
//!
//! Firmware does without: it carries lines out by [`LineInterpreter`] alone.

mod curves;
mod words;

pub(super) use words::ends;

use super::interpreter::{LineInterpreter, Outcomes};
use super::nurbs::{Nurbs, Stretch};
use super::stretched_arc::StretchedArc;
use super::{Block, Error, Problem, ReadOptions, frame::Frame};
use crate::bezier::Bezier;
use crate::{PlotOp, Point, Vec2};
use words::{
    carry_out_rest, has, height_unit, is_factor, is_motion, moves_along_z, place, scaling, takes_places,
    without_movement,
};

/// Farthest place of the pen in the coordinates of a scaled drawing, mm: a thousand times what a number can
/// say.
const MOST_MM: f64 = 1e12;

/// Most turns of an arc: so often no pen goes over its line.
const MOST_TURNS: f64 = 1000.0;

/// Coordinate systems beyond `G59`: `G59.1` to `G59.3`.
const FURTHER: usize = 3;

/// Letters that say where a line goes.
const PLACES: &[u8] = b"XYZABCIJKRPQUVWL";

/// What coordinates alone ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    /// `G0` to `G3`, and `G80`.
    Plain(u8),
    /// `G5`, `G5.1`.
    Curve { is_cubic: bool },
    /// `G5.2`: each line is a control point.
    Nurbs,
    /// `G73`, `G81` to `G89`: down and up again in each place.
    Cycle,
    /// A motion that is not carried out; the pen goes to its end.
    Undone,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Plane {
    Sheet,
    Upright,
}

/// Heights of a canned cycle, in the unit of the interpreter's height.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Cycle {
    bottom: f64,
    /// `R`, down to where the tool goes fast.
    near: f64,
    /// The height before the cycle.
    before: f64,
}

/// Movements that are still to be made of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pending {
    Nothing,
    Curve(Bezier),
    /// A stretch of a NURBS curve, and whether all others follow.
    Nurbs {
        stretch: Stretch,
        is_last: bool,
    },
    Turns {
        rest: u16,
    },
    Dot {
        stage: u8,
    },
}

/// What holds from one line to the next of words that are no machine's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Expansion {
    plane: Plane,
    motion: Motion,
    /// `G16`: the last radius and angle, as numbers.
    polar: Option<[f64; 2]>,
    /// `G99`, not `G98`.
    stays_near: bool,
    cycle: Cycle,
    /// From the end of the last cubic back to its second control point, mm.
    back: Option<Vec2>,
    nurbs: Option<Nurbs>,
    /// An arc that is becoming lines, because both axes are scaled by other factors.
    arc: Option<StretchedArc>,
    /// What `G92.2` has put away.
    saved: Vec2,
    /// Origins of the further coordinate systems; the one in force has that of `G59` in its place.
    further: [Vec2; FURTHER],
    /// 1 for `G59.1`; 0 for none of them.
    chosen: usize,
    pub(super) frame: Frame,
    pending: Pending,
    /// The line that is carried out.
    block: Block,
}

/// What a line adds to the movement, by its `G` words.
#[derive(Clone, Copy, Debug, Default)]
struct Asked {
    motion: Option<Motion>,
    system: Option<usize>,
    local: bool,
    restores: bool,
    saves: bool,
    scales: Option<bool>,
    rotates: Option<bool>,
    origin: bool,
    ends_nurbs: bool,
}

impl Expansion {
    pub(super) fn new() -> Self {
        Self {
            plane: Plane::Sheet,
            motion: Motion::Plain(0),
            polar: None,
            stays_near: false,
            cycle: Cycle::default(),
            back: None,
            nurbs: None,
            arc: None,
            saved: Vec2::default(),
            further: [Vec2::default(); FURTHER],
            chosen: 0,
            frame: Frame::NONE,
            pending: Pending::Nothing,
            block: Block::empty(),
        }
    }

    pub(super) fn is_pending(&self) -> bool {
        self.pending != Pending::Nothing || self.arc.is_some()
    }

    /// Carries a line out, or the first part of it.
    pub(super) fn carry_out(
        &mut self,
        whole: &Block,
        line: &mut LineInterpreter,
        options: &ReadOptions,
        out: &mut Outcomes<Error>,
    ) -> Result<(), Error> {
        if self.is_usual(whole, line) {
            return line.carry_out(whole, options, out);
        }
        let mut block = *whole;
        let asked = self.take_commands(&mut block);
        if let Some(system) = asked.system {
            self.choose(system, line);
        }
        let coordinates = block.words().iter().any(|word| matches!(word.letter, b'X' | b'Y' | b'Z'));
        let moves = coordinates || block.words().iter().any(|word| matches!(word.letter, b'I' | b'J' | b'R'));
        if let Some(motion) = asked.motion {
            if let (Motion::Cycle, false) = (motion, self.motion == Motion::Cycle) {
                self.cycle.before = line.height();
            }
            (self.motion, self.back) = (motion, self.back.filter(|_| motion == self.motion));
        }
        // Of a curve that is not ended the rest is not drawn; what follows begins where it would have ended.
        let is_left = !asked.ends_nurbs && (self.motion != Motion::Nurbs || ends(whole));
        let left = if is_left { self.nurbs.take() } else { None };
        if let Some(nurbs) = left {
            line.relocate(nurbs.last());
        }
        let result = if asked.ends_nurbs {
            self.end_nurbs(&block, line, options, out)
        } else if asked.local
            || asked.restores
            || asked.saves
            || asked.scales.is_some()
            || asked.rotates.is_some()
        {
            self.change_coordinates(whole, block, asked, line, options, out)
        } else if asked.origin {
            self.set_further_origin(block, line, options, out)
        } else {
            self.move_by(block, asked.motion.is_some(), moves, line, options, out)
        };
        if let Some(nurbs) = left {
            out.give_first(Ok(PlotOp::Travel { to: nurbs.last() }));
            out.give_first(Err(nurbs.not_ended()));
        }
        if ends(whole) {
            let (further, chosen) = (self.further, self.chosen);
            *self = Self { further, chosen, motion: Motion::Plain(1), ..Self::new() };
            self.choose(0, line);
        }
        result
    }

    /// Whether the machine does with the line what it should: so with nearly all.
    fn is_usual(&mut self, block: &Block, line: &LineInterpreter) -> bool {
        let Motion::Plain(mut motion) = self.motion else { return false };
        let mut is_modal = true;
        for word in block.words() {
            match (word.letter, word.tenths()) {
                (b'G', Some(tenths @ (0 | 10 | 20 | 30))) => {
                    (motion, is_modal) = (u8::try_from(tenths / 10).unwrap_or_default(), false);
                }
                (b'G', Some(40 | 170 | 200 | 210 | 280 | 400 | 490 | 530 | 900 | 910 | 940)) => {}
                (b'G' | b'P', _) => return false,
                (b'M', Some(20 | 300)) => return false,
                _ => {}
            }
        }
        if self.plane != Plane::Sheet || self.polar.is_some() || (is_modal && line.motion() != motion) {
            return false;
        }
        self.motion = Motion::Plain(motion);
        true
    }

    /// Takes the words out of a line that only this stage knows.
    fn take_commands(&mut self, block: &mut Block) -> Asked {
        let mut asked = Asked::default();
        let (p, has_factor) = (block.number(b'P'), block.words().iter().any(|word| is_factor(*word)));
        let is_origin = matches!(block.number(b'L'), Some(2.0 | 20.0)) && matches!(p, Some(7.0..=9.0));
        block.retain(|word| {
            let (b'G', Some(tenths)) = (word.letter, word.tenths()) else { return true };
            match tenths {
                0 | 10 | 20 | 30 | 800 => {
                    asked.motion = Some(Motion::Plain(u8::try_from(tenths / 10).unwrap_or_default()));
                }
                50 | 51 => asked.motion = Some(Motion::Curve { is_cubic: tenths == 50 }),
                52 => asked.motion = Some(Motion::Nurbs),
                53 => asked.ends_nurbs = true,
                330 | 331 | 382..=385 | 760 => asked.motion = Some(Motion::Undone),
                730 | 810..=890 => asked.motion = Some(Motion::Cycle),
                100 => asked.origin = is_origin,
                150 => self.polar = None,
                160 => {
                    self.polar = Some([0.0; 2]);
                    return false;
                }
                170 => self.plane = Plane::Sheet,
                180 | 190 => self.plane = Plane::Upright,
                500 => asked.scales = Some(false),
                510 if has_factor => {
                    asked.scales = Some(true);
                    return false;
                }
                520 => {
                    asked.local = true;
                    return false;
                }
                540..=590 => asked.system = Some(0),
                591..=593 => {
                    asked.system = Some(usize::from(tenths - 590));
                    return false;
                }
                680 => {
                    asked.rotates = Some(true);
                    return false;
                }
                690 => asked.rotates = Some(false),
                922 => asked.saves = true,
                923 => {
                    asked.restores = true;
                    return false;
                }
                980 | 990 => self.stays_near = tenths == 990,
                _ => {}
            }
            true
        });
        if asked.system.is_some_and(|system| system > 0) {
            block.insert(b'G', 59.0);
        }
        asked
    }

    /// Puts the origin of a further coordinate system in the place of that of `G59`, and back.
    fn choose(&mut self, system: usize, line: &mut LineInterpreter) {
        for system in [core::mem::replace(&mut self.chosen, system), system] {
            if let Some(origin) = system.checked_sub(1).and_then(|at| self.further.get_mut(at)) {
                line.exchange_last_origin(origin);
            }
        }
    }

    fn set_further_origin(
        &mut self,
        mut block: Block,
        line: &mut LineInterpreter,
        options: &ReadOptions,
        out: &mut Outcomes<Error>,
    ) -> Result<(), Error> {
        let chosen = self.chosen;
        let number = block.number(b'P').unwrap_or_default();
        let system = [7.0, 8.0, 9.0].iter().position(|one| *one == number).map_or(0, |at| at + 1);
        self.choose(system, line);
        block.set(b'P', 6.0);
        let result = line.carry_out(&block, options, out);
        self.choose(chosen, line);
        result
    }

    /// `G50` to `G52`, `G68`, `G69`, `G92.2`, `G92.3`.
    fn change_coordinates(
        &mut self,
        whole: &Block,
        mut block: Block,
        asked: Asked,
        line: &mut LineInterpreter,
        options: &ReadOptions,
        out: &mut Outcomes<Error>,
    ) -> Result<(), Error> {
        if asked.saves {
            self.saved = line.shift();
        }
        let takes_words = asked.local || asked.scales == Some(true) || asked.rotates == Some(true);
        if takes_words {
            block.retain(|word| !PLACES.contains(&word.letter));
        }
        carry_out_rest(&block, line, options, out)?;
        let modes = line.modes();
        let unit_mm = modes.unit_mm();
        if asked.restores {
            line.set_shift(self.saved);
        }
        if asked.local {
            let shift = line.shift();
            let x = whole.number(b'X').map_or(shift.x, |number| number * unit_mm);
            let y = whole.number(b'Y').map_or(shift.y, |number| number * unit_mm);
            line.set_shift(Vec2::new(x, y));
        }
        let at = self.frame.apply(modes.position);
        if let Some(is_on) = asked.scales {
            self.frame.scale(is_on.then(|| scaling(whole, &modes)).transpose()?);
        }
        if let Some(is_on) = asked.rotates {
            let angle_deg = whole.number(b'R').unwrap_or_default();
            let centre = place(whole, &modes, [b'X', b'Y']);
            let centre = if has(whole, b"AB") { place(whole, &modes, [b'A', b'B']) } else { centre };
            self.frame.turn(is_on.then_some((centre, angle_deg.to_radians())));
        }
        // The pen stays where it is; its coordinates are others.
        let place = self.frame.inverse(at);
        if place.x.abs().max(place.y.abs()) > MOST_MM {
            let expected = "the pen stands too far from the centre for so small a factor";
            return Err(Error { at: whole.position(), problem: Problem::Missing { expected } });
        }
        line.relocate(place);
        Ok(())
    }

    /// The movement of a line.
    fn move_by(
        &mut self,
        mut block: Block,
        is_asked: bool,
        moves: bool,
        line: &mut LineInterpreter,
        options: &ReadOptions,
        out: &mut Outcomes<Error>,
    ) -> Result<(), Error> {
        if self.motion == Motion::Nurbs && !takes_places(&block) && (is_asked || has(&block, b"XYPL")) {
            return self.take_control_point(&block, line, options, out);
        }
        if !moves || takes_places(&block) {
            if let (Motion::Curve { .. }, true) = (self.motion, is_asked) {
                block.retain(|word| !is_motion(word));
            }
            return carry_out_rest(&block, line, options, out);
        }
        if let Some(polar) = &mut self.polar {
            let [radius, angle] = polar;
            *radius = block.number(b'X').unwrap_or(*radius);
            *angle = block.number(b'Y').unwrap_or(*angle);
            if has(&block, b"XY") {
                let (sin, cos) = libm::sincos(angle.to_radians());
                block.set(b'X', *radius * cos);
                block.set(b'Y', *radius * sin);
            }
        }
        match self.motion {
            Motion::Plain(number) => {
                if !is_asked && line.modes().motion != number {
                    block.insert(b'G', number.into());
                }
                let turns = block.number(b'P').filter(|turns| *turns > 1.0 && matches!(number, 2 | 3));
                let lies = self.plane == Plane::Sheet;
                if let (Some(turns), true) = (turns, lies && has(&block, b"IJ")) {
                    let first = without_movement(&block);
                    let rest = crate::whole::whole(turns.min(MOST_TURNS)).saturating_sub(1);
                    let rest = u16::try_from(rest).unwrap_or_default();
                    (self.block, self.pending) = (block, Pending::Turns { rest });
                    return carry_out_rest(&first, line, options, out);
                }
                line.carry_out(&block, options, out)
            }
            Motion::Nurbs => Ok(()),
            Motion::Curve { is_cubic } => {
                carry_out_rest(&without_movement(&block), line, options, out)?;
                self.begin_curve(&block, is_cubic, &line.modes())
            }
            Motion::Cycle if moves_along_z(options.pen) => {
                carry_out_rest(&without_movement(&block), line, options, out)?;
                self.begin_dot(&block, line, options);
                Ok(())
            }
            Motion::Cycle | Motion::Undone if !is_asked => line.leave_out(&block, options, out),
            Motion::Cycle | Motion::Undone => line.carry_out(&block, options, out),
        }
    }

    fn begin_dot(&mut self, block: &Block, line: &LineInterpreter, options: &ReadOptions) {
        let modes = line.modes();
        let unit = height_unit(&modes, options);
        let from = |height: f64| if modes.relative { height } else { 0.0 };
        if let Some(near) = block.number(b'R') {
            self.cycle.near = from(self.cycle.before) + near * unit;
        }
        if let Some(bottom) = block.number(b'Z') {
            self.cycle.bottom = from(self.cycle.near) + bottom * unit;
        }
        self.block = *block;
        self.pending = Pending::Dot { stage: 0 };
    }

    /// The next line of those that the last one stands for.
    pub(super) fn next_block(&mut self, line: &LineInterpreter, options: &ReadOptions) -> Option<Block> {
        let modes = line.modes();
        let mut block = self.block;
        match &mut self.pending {
            Pending::Nothing => return None,
            Pending::Curve(_) | Pending::Nurbs { .. } => {
                let to = self.next_of_curve()?;
                let from = if modes.relative { modes.position - Point::ORIGIN } else { modes.offset };
                block.retain(|_| false);
                block.insert(b'G', 1.0);
                block.set(b'X', (to.x - from.x) / modes.unit_mm());
                block.set(b'Y', (to.y - from.y) / modes.unit_mm());
            }
            Pending::Turns { rest } => {
                // The first part of the line has done what is no movement.
                let is_last = *rest == 0;
                block.retain(|word| {
                    matches!(word.letter, b'I' | b'J')
                        || (is_last && matches!(word.letter, b'X' | b'Y' | b'Z'))
                        || is_motion(word)
                });
                if is_last {
                    self.pending = Pending::Nothing;
                } else {
                    *rest -= 1;
                }
            }
            Pending::Dot { stage } => {
                let retract =
                    if self.stays_near { self.cycle.near } else { self.cycle.before.max(self.cycle.near) };
                let height = match stage {
                    0 => None,
                    1 => Some(self.cycle.bottom),
                    _ => Some(retract),
                };
                block.retain(|word| height.is_none() && matches!(word.letter, b'X' | b'Y'));
                block.insert(b'G', if *stage == 1 { 1.0 } else { 0.0 });
                if let Some(height) = height {
                    let from = if modes.relative { line.height() } else { 0.0 };
                    block.set(b'Z', (height - from) / height_unit(&modes, options));
                }
                *stage += 1;
                if *stage > 2 {
                    self.pending = Pending::Nothing;
                }
            }
        }
        Some(block)
    }

    /// What was begun is left out.
    pub(super) fn forget(&mut self) {
        (self.pending, self.arc) = (Pending::Nothing, None);
    }
}
