//! [`Expansion`]: words that stand for several movements, or change what coordinates mean, made lines that every machine knows.
//!
//! Firmware does without: it carries lines out by [`LineInterpreter`] alone.

use super::interpreter::{LineInterpreter, Outcomes};
use super::{Block, Error, Modes, PenConvention, Problem, ReadOptions, ServoCommand, Word, frame::Frame};
use crate::bezier::Bezier;
use crate::{Point, Vec2};

const MM_PER_INCH: f64 = 25.4;

/// Farthest that a curve's chords may be from it, mm: a tenth of the finest pen's line.
const TOLERANCE_MM: f64 = 0.01;

/// Farthest place of the pen in the coordinates of a scaled drawing, mm: a thousand times what a number can say.
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
    /// `G73`, `G81` to `G89`: down and up again in each place.
    Cycle,
    /// What is not carried out. Its ends are gone to.
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
    Turns { rest: u16 },
    Dot { stage: u8 },
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
            saved: Vec2::default(),
            further: [Vec2::default(); FURTHER],
            chosen: 0,
            frame: Frame::NONE,
            pending: Pending::Nothing,
            block: Block::empty(),
        }
    }

    pub(super) fn is_pending(&self) -> bool {
        self.pending != Pending::Nothing
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
        let result = if asked.local
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
                52 | 53 | 330 | 331 | 382..=385 | 760 => asked.motion = Some(Motion::Undone),
                730 | 810..=890 => asked.motion = Some(Motion::Cycle),
                100 => asked.origin = is_origin,
                150 => self.polar = None,
                160 => {
                    self.polar = Some([0.0; 2]);
                    return false;
                }
                170 => self.plane = Plane::Sheet,
                180 | 190 => {
                    self.plane = Plane::Upright;
                    return false;
                }
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
        let unit_mm = unit_mm(&modes);
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
            Motion::Plain(2 | 3) if self.plane == Plane::Upright => {
                // Seen from above it is a line; its end counts, and its height.
                block.retain(|word| {
                    !is_motion(word) && !matches!(word.letter, b'I' | b'J' | b'K' | b'R' | b'P')
                });
                block.insert(b'G', 1.0);
                line.carry_out(&block, options, out)
            }
            Motion::Plain(number) => {
                if !is_asked && line.modes().motion != number && number != 80 {
                    block.insert(b'G', number.into());
                }
                let turns = block.number(b'P').filter(|turns| *turns > 1.0 && matches!(number, 2 | 3));
                if let (Some(turns), true) = (turns, has(&block, b"IJ")) {
                    let mut first = block;
                    first.retain(|word| !PLACES.contains(&word.letter) && !is_motion(word));
                    let rest = crate::whole::whole(turns.min(MOST_TURNS)).saturating_sub(1);
                    let rest = u16::try_from(rest).unwrap_or_default();
                    (self.block, self.pending) = (block, Pending::Turns { rest });
                    return carry_out_rest(&first, line, options, out);
                }
                line.carry_out(&block, options, out)
            }
            Motion::Curve { is_cubic } => {
                let mut rest = block;
                rest.retain(|word| !PLACES.contains(&word.letter) && !is_motion(word));
                carry_out_rest(&rest, line, options, out)?;
                self.begin_curve(&block, is_cubic, &line.modes())
            }
            Motion::Cycle if moves_along_z(options.pen) => {
                let mut rest = block;
                rest.retain(|word| !PLACES.contains(&word.letter) && !is_motion(word));
                carry_out_rest(&rest, line, options, out)?;
                self.begin_dot(&block, line, options);
                Ok(())
            }
            Motion::Cycle | Motion::Undone if !is_asked => line.leave_out(&block, options, out),
            Motion::Cycle | Motion::Undone => line.carry_out(&block, options, out),
        }
    }

    fn begin_curve(&mut self, block: &Block, is_cubic: bool, modes: &Modes) -> Result<(), Error> {
        let unit_mm = unit_mm(modes);
        let way = |x, y| Some(Vec2::new(block.number(x)?, block.number(y)?) * unit_mm);
        let (from, to) = (modes.position, place(block, modes, [b'X', b'Y']));
        let missing = |expected| Error { at: block.position(), problem: Problem::Missing { expected } };
        let points = if is_cubic {
            let out = way(b'I', b'J').or(self.back.map(|back| back * -1.0));
            let out = out.ok_or_else(|| missing("G5 needs I and J: the way to its first control point"))?;
            let back = way(b'P', b'Q').ok_or_else(|| {
                missing("G5 needs P and Q: the way from its end to its second control point")
            })?;
            self.back = Some(back);
            [from, from + out, to + back, to]
        } else {
            let out =
                way(b'I', b'J').ok_or_else(|| missing("G5.1 needs I and J: the way to its control point"))?;
            let control = from + out;
            [from, from.lerp(control, 2.0 / 3.0), to.lerp(control, 2.0 / 3.0), to]
        };
        self.block = *block;
        self.pending = Pending::Curve(Bezier::new(points.map(|at| at - Point::ORIGIN), TOLERANCE_MM));
        Ok(())
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
            Pending::Curve(curve) => {
                let Some(to) = curve.next() else {
                    self.pending = Pending::Nothing;
                    return None;
                };
                let from = if modes.relative { modes.position - Point::ORIGIN } else { modes.offset };
                block.retain(|_| false);
                block.insert(b'G', 1.0);
                block.set(b'X', (to.x - from.x) / unit_mm(&modes));
                block.set(b'Y', (to.y - from.y) / unit_mm(&modes));
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
        self.pending = Pending::Nothing;
    }
}

/// Carries out what is left of a line, if anything is.
fn carry_out_rest(
    block: &Block,
    line: &mut LineInterpreter,
    options: &ReadOptions,
    out: &mut Outcomes<Error>,
) -> Result<(), Error> {
    if block.words().is_empty() && block.remark().is_none() {
        Ok(())
    } else {
        line.carry_out(block, options, out)
    }
}

/// The factors of `G51`, and the centre that they count from: by P or I and J about X and Y, or by X and Y about the origin.
fn scaling(block: &Block, modes: &Modes) -> Result<(Point, f64, f64), Error> {
    let (p, i, j) = (block.number(b'P'), block.number(b'I'), block.number(b'J'));
    let (x, y, centre) = if p.or(i).or(j).is_some() {
        // Older controls count thousandths.
        let factor = |number: f64| if number.abs() >= 100.0 { number / 1000.0 } else { number };
        let each = |one: Option<f64>| factor(one.or(p).unwrap_or(1.0));
        (each(i), each(j), place(block, modes, [b'X', b'Y']))
    } else {
        let each = |letter| block.number(letter).unwrap_or(1.0);
        (each(b'X'), each(b'Y'), Point::ORIGIN + modes.offset)
    };
    if x == 0.0 || x.abs() != y.abs() || !(1e-6..=1e6).contains(&x.abs()) {
        let word = *block.words().iter().find(|word| is_factor(**word)).unwrap_or(&Word {
            letter: b'G',
            number: Some(51.0),
            column: block.position().column,
        });
        let expected =
            "both axes are scaled by the same number, or by that number and its negative, and not by 0";
        return Err(Error { at: block.place(word), problem: Problem::BadParameter { word, expected } });
    }
    Ok((centre, x, y))
}

fn is_factor(word: Word) -> bool {
    matches!(word.letter, b'P' | b'I' | b'J' | b'X' | b'Y')
}

fn is_motion(word: &Word) -> bool {
    word.letter == b'G'
        && matches!(
            word.tenths(),
            Some(0 | 10 | 20 | 30 | 50..=53 | 330 | 331 | 382..=385 | 730 | 760 | 800..=890)
        )
}

/// Whether the words of the line belong to a command that is no movement.
fn takes_places(block: &Block) -> bool {
    block.words().iter().any(|word| match (word.letter, word.tenths()) {
        (b'G', Some(tenths)) => {
            matches!(tenths, 40 | 100 | 280 | 281 | 300 | 301 | 290 | 430 | 431 | 920..=923)
        }
        _ => false,
    })
}

fn has(block: &Block, letters: &[u8]) -> bool {
    block.words().iter().any(|word| letters.contains(&word.letter))
}

/// Whether this line ends the program.
pub(super) fn ends(block: &Block) -> bool {
    let is_end = |word: &Word| word.letter == b'M' && matches!(word.tenths(), Some(20 | 300));
    // mDraw keeps the angles of its pen by M2.
    block.words().iter().any(is_end) && !has(block, b"UD")
}

fn moves_along_z(pen: PenConvention) -> bool {
    matches!(pen, PenConvention::Height { .. } | PenConvention::Servo { command: ServoCommand::Z, .. })
}

fn unit_mm(modes: &Modes) -> f64 {
    if modes.inches { MM_PER_INCH } else { 1.0 }
}

fn height_unit(modes: &Modes, options: &ReadOptions) -> f64 {
    if let PenConvention::Height { .. } = options.pen { unit_mm(modes) } else { 1.0 }
}

/// The place that two letters name; it is that of the pen where they are not there.
fn place(block: &Block, modes: &Modes, [x, y]: [u8; 2]) -> Point {
    let origin = if modes.relative { modes.position } else { Point::ORIGIN + modes.offset };
    let along = |letter, origin: f64, at: f64| {
        block.number(letter).map_or(at, |number| origin + number * unit_mm(modes))
    };
    Point::new(along(x, origin.x, modes.position.x), along(y, origin.y, modes.position.y))
}
