//! A line of G-code becomes commands for the motion side.

use super::super::{Command, Link, Setting, SettingProblem, StoredSettings, area};
use super::codes::{Alarm, Code, takes_axes};
use super::listing::is_listed;
use super::words::{read, whole};
use super::{Grbl, Mode, Pens, Wait, send};
use crate::PlotOp;
use crate::Point;
use crate::decimal::Decimal;
use crate::gcode::{Block, Modes, Outcomes, SYSTEMS, Word, Words};
use crate::geom::Vec2Single;
#[cfg(feature = "third-motor")]
use crate::planner::Keep as _;

/// Least feed, mm/s: a lower one is raised to it. Chosen so that a step of 0.01 mm still takes no more than
/// ten seconds; a feed of 0 would never end.
const LEAST_FEED_MM_S: f64 = 1e-3;

pub(super) fn no_slower(feed_mm_s: f64) -> f64 {
    if feed_mm_s > LEAST_FEED_MM_S { feed_mm_s } else { LEAST_FEED_MM_S }
}

impl<P: Pens> Grbl<P> {
    /// Carries out a line as a whole, or not at all.
    #[inline(never)] // its memory on the stack is for its own time only, as that of a jog
    pub(super) fn block(&mut self, text: &[u8], link: &mut Link) -> Result<(), Code> {
        let known = P::read(&self.settings, |options| options.words);
        let Some(block) = read(text, known)? else { return Ok(()) };
        let before = self.interpreter;
        #[cfg(feature = "third-motor")]
        let heights = self.heights.clone();
        let done = self.carry_out(&block, link);
        if done.is_err() {
            self.interpreter = before;
            #[cfg(feature = "third-motor")]
            {
                self.heights = heights;
            }
        }
        done
    }

    /// A jog: a movement by hand with the pen up. Only the place is kept; the modes of the line are not.
    #[inline(never)]
    pub(super) fn jog(&mut self, text: &[u8], link: &mut Link) -> Result<(), Code> {
        let block = read(text, Words::GrblOnSheet)?.ok_or(Code::NO_FEED)?;
        let is_allowed = |word: &Word| match word.letter {
            b'G' => matches!(word.tenths(), Some(200 | 210 | 530 | 900 | 910)),
            b'X' | b'Y' | b'Z' | b'F' | b'N' => true,
            _ => false,
        };
        if let Some(word) = block.words().iter().find(|word| !is_allowed(word)) {
            return Err(if matches!(word.letter, b'G' | b'M') { Code::BAD_JOG } else { Code::UNUSED });
        }
        if block.number(b'F').is_none() {
            return Err(Code::NO_FEED);
        }
        let (to, feed_mm_s) = self.interpreter.travel(&block)?;
        #[cfg(feature = "third-motor")]
        let most = self.most();
        #[cfg(feature = "third-motor")]
        if let Some(z) = self.z_axis()
            && let Some(heights) = self.heights.get_mut()
            && let Some(to_z_mm) = heights.jog_target(&block, &self.interpreter.modes())
        {
            let to = to.unwrap_or(self.interpreter.modes().position);
            let reaches = (0.0..=z.travel_mm).contains(&to_z_mm);
            if !reaches || !area::contains(most, &to, &PlotOp::Travel { to }) {
                return Err(Code::JOG_TARGET);
            }
            heights.at_mm = to_z_mm;
            self.interpreter.stand_at(to);
            let speed_mm_s = no_slower(feed_mm_s.unwrap_or(0.0));
            self.command(link, Command::JogZ { to, to_z_mm, speed_mm_s });
            return Ok(());
        }
        let Some(to) = to else { return Ok(()) };
        if !area::contains(self.most(), &to, &PlotOp::Travel { to }) {
            return Err(Code::JOG_TARGET);
        }
        self.interpreter.stand_at(to);
        let speed_mm_s = no_slower(feed_mm_s.unwrap_or(0.0));
        self.command(link, Command::Jog { to, speed_mm_s });
        Ok(())
    }

    /// `$n=value`, without its `$`.
    pub(super) fn change(&mut self, text: &[u8], link: &mut Link) -> Result<(), Code> {
        let setting = setting(text)?;
        match setting.checked(&self.settings) {
            Ok(settings) => self.settings = settings,
            // A program may send back all settings that it has read: that changes none.
            Err(SettingProblem::Fixed) if is_listed(setting, &self.settings) => return Ok(()),
            Err(SettingProblem::Negative) => return Err(Code::NEGATIVE),
            Err(SettingProblem::OutOfRange) => return Err(Code::SETTING_RANGE),
            Err(SettingProblem::StepRate) => return Err(Code::STEP_RATE),
            Err(_) => return Err(Code::BAD_STATEMENT),
        }
        send(link, Command::Set(setting));
        self.wait = Some(Wait::Set);
        Ok(())
    }

    /// The far corner of the area.
    fn most(&self) -> Vec2Single {
        let StoredSettings { width_mm, height_mm, .. } = self.settings.stored;
        Vec2Single { x: f32::from(width_mm), y: f32::from(height_mm) }
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn carry_out(&mut self, block: &Block, link: &mut Link) -> Result<(), Code> {
        let before = self.interpreter.modes();
        let mut outcomes = Outcomes::none();
        let known = P::read(&self.settings, |options| options.words);
        if known.is_grbl() {
            check(block, known, &before)?;
        }
        P::read(&self.settings, |options| self.interpreter.carry_out(block, options, &mut outcomes))?;
        if known.is_grbl() && has_unused(block) {
            return Err(Code::UNUSED);
        }
        self.interpreter.lift(&mut outcomes);
        let mut pauses = false;
        for op in outcomes.iter() {
            match op {
                Ok(_) => {}
                Err(Code::PAUSE) => pauses = true,
                Err(code) => return Err(*code),
            }
        }
        let modes = self.interpreter.modes();
        if modes.offset != before.offset {
            self.reports_to_offset = 0; // the next report tells it
        }
        let moves = outcomes.iter().flatten().any(|op| op.target().is_some());
        #[cfg(feature = "third-motor")]
        let mut targets = self.targets(block, &before, &modes)?;
        #[cfg(feature = "third-motor")]
        let moves = moves || targets.is_any();
        let (mut has_axis, mut dwells, mut ends, mut asks_to_move) = (false, false, false, false);
        for word in block.words() {
            match (word.letter, word.tenths()) {
                (b'X' | b'Y', _) => has_axis = true,
                #[cfg(feature = "third-motor")]
                (b'Z', _) if targets.is_any() => has_axis = true,
                (b'G', Some(10 | 20 | 30)) => asks_to_move = true,
                (b'G', Some(40)) => dwells = true,
                (b'M', Some(20 | 300)) => ends = true,
                _ => {}
            }
        }
        if (asks_to_move || (moves && has_axis))
            && (1..=3).contains(&modes.motion)
            && modes.feed_mm_s.is_none()
        {
            return Err(Code::NO_FEED);
        }
        let most = self.most();
        let mut at = before.position;
        #[cfg(feature = "third-motor")]
        if !self.reaches(&targets) {
            return self.leaves_area(before.position, link);
        }
        for op in outcomes.iter().flatten() {
            if !area::contains(most, &at, op) {
                return self.leaves_area(before.position, link);
            }
            at = op.target().unwrap_or(at);
        }
        if self.mode == Mode::Check {
            if ends {
                self.out.line(format_args!("[MSG:Pgm End]"));
            }
            return Ok(());
        }
        #[cfg(feature = "third-motor")]
        let mut left = outcomes.iter().flatten().filter(|op| op.target().is_some()).count();
        while let Some(op) = outcomes.take() {
            let Ok(mut op) = op else { continue };
            #[cfg(feature = "third-motor")]
            if op.target().is_some() {
                self.send_height(&mut targets, left, link);
                left -= 1;
            }
            if let PlotOp::Draw { feed_mm_s: Some(feed), .. }
            | PlotOp::DrawArc { feed_mm_s: Some(feed), .. } = &mut op
            {
                *feed = no_slower(*feed);
            }
            self.command(link, Command::Plot(op));
        }
        #[cfg(feature = "third-motor")]
        self.send_z_alone(targets, &modes, link);
        if pauses {
            self.command(link, Command::Pause);
        }
        // The wait covers a pen that is going down, too.
        if dwells && let Some(dot) = self.interpreter.put_down() {
            self.command(link, Command::Plot(dot));
        }
        // As in Grbl, these are answered when all is done: programs use them to wait for the machine.
        if ends {
            self.command(link, Command::End);
            self.wait = Some(Wait::End);
        } else if pauses || dwells {
            self.command(link, Command::Finish);
            self.wait = Some(Wait::Finish);
        }
        Ok(())
    }
}

impl<P: Pens> Grbl<P> {
    /// A line that leaves the area is not carried out.
    #[cfg_attr(target_os = "none", inline(always))] // from one place where there are two axes
    fn leaves_area(&mut self, stands_at: Point, link: &mut Link) -> Result<(), Code> {
        // Nothing moves, so there is nothing to stop.
        if self.mode == Mode::Check {
            return Err(Code::TARGET);
        }
        // Lines that were answered by ok are still drawn; then the pen goes up.
        self.command(link, Command::Plot(PlotOp::Travel { to: stands_at }));
        self.alarm(Alarm::SOFT_LIMIT);
        Err(Code::TARGET)
    }
}

/// Checks the words of a line against each other, as Grbl does.
#[inline(never)]
fn check(block: &Block, known: Words, modes: &Modes) -> Result<(), Code> {
    /// The axes of each plane.
    const PLANES: [(u16, &[u8]); 3] = [(170, b"XY"), (180, b"XZ"), (190, b"YZ")];
    /// Bound above the line numbers: Grbl's greatest is 9,999,999.
    const MOST_LINES: f64 = 1e7;
    let has = |letters: &[u8]| block.words().iter().any(|word| letters.contains(&word.letter));
    let asks =
        |tenths: u16| block.words().iter().any(|word| word.letter == b'G' && word.tenths() == Some(tenths));
    let (has_axes, sets) = (has(b"XYZ"), asks(100));
    let is_arc = asks(20) || asks(30);
    // This machine draws a whole circle by its centre alone.
    let (mut has_ends, mut draws_circle) = (true, has(b"IJ"));
    if known == Words::Grbl {
        let plane = PLANES.iter().find(|plane| asks(plane.0));
        let plane = plane.or(PLANES.get(usize::from(modes.plane.wrapping_sub(17))));
        if let Some(&(plane, ends)) = plane {
            (has_ends, draws_circle) = (has(ends), draws_circle && plane == 170);
        }
    }
    let too_many = |letter, most| block.number(letter).is_some_and(|number| number >= most);
    if too_many(b'N', MOST_LINES) {
        return Err(Code::LINE_NUMBER);
    }
    if !has_axes && (sets || asks(920) || (is_arc && !draws_circle)) {
        return Err(Code::NO_AXES);
    }
    if has_axes && is_arc && !has_ends {
        return Err(Code::NO_AXES_IN_PLANE);
    }
    if known == Words::Grbl && (asks(431) || asks(490)) {
        let others = block.words().iter().filter(|word| word.letter == b'G');
        let takes =
            |word: &Word| takes_axes(*word) || word.tenths() == Some(if asks(431) { 490 } else { 431 });
        if others.into_iter().any(takes) {
            return Err(Code::AXIS_CONFLICT);
        }
        if asks(431) && (has(b"XY") || !has(b"Z")) {
            return Err(Code::LENGTH_AXIS);
        }
    }
    if sets && too_many(b'P', f64::from(SYSTEMS + 1)) {
        return Err(Code::NO_SYSTEM);
    }
    if sets && has(b"R") {
        return Err(Code::UNSUPPORTED);
    }
    if is_arc && asks(530) {
        return Err(Code::NOT_STRAIGHT);
    }
    Ok(())
}

/// Whether the line has a word that no command in it uses, among the words that Grbl knows and readers let
/// pass.
fn has_unused(block: &Block) -> bool {
    block.words().iter().any(|word| {
        let users: &[u16] = match word.letter {
            b'L' => &[100],
            b'P' => &[100, 40],
            _ => return false,
        };
        let uses = |user: &Word| user.letter == b'G' && user.tenths().is_some_and(|at| users.contains(&at));
        !block.words().iter().any(uses)
    })
}

/// A setting's number and its value.
fn setting(text: &[u8]) -> Result<Setting, Code> {
    let mut parts = text.splitn(2, |byte| *byte == b'=');
    let (number, value) = (parts.next().unwrap_or(&[]), parts.next().ok_or(Code::BAD_STATEMENT)?);
    let number = whole(number).ok_or(Code::BAD_STATEMENT)?;
    let (first, rest) = value.split_first().ok_or(Code::BAD_NUMBER)?;
    let mut decimal = Decimal::begin(*first).ok_or(Code::BAD_NUMBER)?;
    if !rest.iter().all(|byte| decimal.push(*byte)) {
        return Err(Code::BAD_NUMBER);
    }
    let value = decimal.value().filter(|value| value.is_finite()).ok_or(Code::BAD_NUMBER)?;
    Ok(Setting { number, value })
}
