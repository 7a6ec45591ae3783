//! [`Line`]: the commands of one line, once it is known that they go together.

use super::block::is_among;
use super::code::{Action, Code, Motion, Spindle, Stop};
use super::{Block, Error, Problem, Word};

/// Letters whose words are worth a notice where no command uses them.
const NOTEWORTHY: &[u8] = b"ABCEIJKRUVW";

/// A servo or a laser that is told a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Told {
    /// `M300 S…`.
    Beep,
    /// `M280 S…`.
    ServoAngle,
    /// `M106 S…`, `M107`.
    Fan(bool),
    /// mDraw's `M1 …`.
    Degrees(f64),
    /// mDraw's `M4 …`.
    LaserPower(f64),
}

/// What the words of one line ask for together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'b> {
    pub(super) block: &'b Block,
    pub(super) motion: Option<Motion>,
    pub(super) action: Option<Action>,
    pub(super) inches: Option<bool>,
    pub(super) relative: Option<bool>,
    pub(super) absolute_centres: Option<bool>,
    pub(super) sheet: Option<bool>,
    pub(super) inverse_time: Option<bool>,
    pub(super) spindle: Option<Spindle>,
    pub(super) stop: Option<Stop>,
    pub(super) told: Option<Told>,
    pub(super) tool_change: Option<Word>,
    pub(super) machine_coordinates: bool,
    /// The words belong to a command that means nothing to a plotter.
    pub(super) owned: bool,
    pub(super) notice: Option<Error>,
}

impl<'b> Line<'b> {
    pub(super) fn read(block: &'b Block) -> Result<Self, Error> {
        let mut line = Self {
            block,
            motion: None,
            action: None,
            inches: None,
            relative: None,
            absolute_centres: None,
            sheet: None,
            inverse_time: None,
            spindle: None,
            stop: None,
            told: None,
            tool_change: None,
            machine_coordinates: false,
            owned: false,
            notice: None,
        };
        // Of each group the word that it has had: one more than where it stands.
        let mut groups = [0_u8; 11];
        let word_at = |place: u8| block.words().get(usize::from(place).wrapping_sub(1)).copied();
        let mut letters = 0_u32;
        let mut words = block.words().iter().copied().zip(1..).peekable();
        while let Some((word, place)) = words.next() {
            if !matches!(word.letter, b'G' | b'M') {
                let bit = 1 << (word.letter & 31);
                if word.letter == Word::BARE {
                    return Err(Problem::NoLetter.at(block.place(word)));
                }
                if letters & bit != 0 {
                    return Err(Problem::Repeated { letter: word.letter }.at(block.place(word)));
                }
                letters |= bit;
                continue;
            }
            let bare = words.next_if(|(next, _)| word.letter == b'M' && next.letter == Word::BARE);
            let code = line.command(word, bare.and_then(|(bare, _)| bare.number))?;
            if let Some(first) = code.group().and_then(|group| groups.get_mut(group))
                && let Some(first) = word_at(core::mem::replace(first, place))
            {
                return Err(Problem::TwoCommands { first, second: word }.at(block.place(word)));
            }
        }
        line.check_numbers()?;
        let [motion, action, ..] = groups;
        if let (Some(motion), Some(action)) = (word_at(motion), word_at(action))
            && !matches!(line.motion, Some(Motion::None))
            && line.action != Some(Action::Dwell)
            && b"XYZ".iter().any(|letter| letters & (1 << (letter & 31)) != 0)
        {
            let (first, second) =
                if motion.column < action.column { (motion, action) } else { (action, motion) };
            return Err(Problem::TwoCommands { first, second }.at(block.place(second)));
        }
        Ok(line)
    }

    /// One `G` or `M` word, and mDraw's number after it.
    fn command(&mut self, word: Word, bare: Option<f64>) -> Result<Code, Error> {
        let at = self.block.place(word);
        if word.number.is_none() {
            return Err(Problem::NoNumber { letter: word.letter }.at(at));
        }
        let unknown = || Problem::Unknown { command: word }.at(at);
        let tenths = word.tenths().ok_or_else(unknown)?;
        let (mut code, mut meaning) =
            if word.letter == b'G' { Code::general(tenths) } else { Code::miscellaneous(tenths) };
        match (tenths, bare) {
            (_, None) => {}
            (10, Some(degrees)) => {
                self.told = Some(Told::Degrees(degrees));
                return Ok(Code::ServoAngle);
            }
            (40, Some(power)) => {
                self.told = Some(Told::LaserPower(power));
                return Ok(Code::Fan(true));
            }
            (30, Some(_)) => code = Code::Quiet, // slower steps
            _ => return Err(Problem::NoLetter.at(at)),
        }
        // mDraw keeps the angles and the sheet of its machine by M2 and M5.
        let has = |letters: &[u8]| self.block.words().iter().any(|word| is_among(word.letter, letters));
        if word.letter == b'M' && ((tenths == 20 && has(b"UD")) || (tenths == 50 && has(b"ABHW"))) {
            code = Code::QuietWithWords;
        }
        // There is one coordinate system: that of G54, which is the first, and the one in force, which is 0.
        if (word.letter, tenths) == (b'G', 100)
            && let (Some(0.0 | 1.0), Some(form @ (2.0 | 20.0))) =
                (self.block.number(b'P'), self.block.number(b'L'))
        {
            (code, meaning) = (Code::Action(Action::Origin { here: form > 2.0 }), None);
        }
        match code {
            Code::Motion(motion) => self.motion = Some(motion),
            Code::Action(action) => self.action = Some(action),
            Code::MachineCoordinates => self.machine_coordinates = true,
            Code::Inches(inches) => self.inches = Some(inches),
            Code::Relative(relative) => self.relative = Some(relative),
            Code::AbsoluteCentres(absolute) => self.absolute_centres = Some(absolute),
            Code::Sheet(sheet) => self.sheet = Some(sheet),
            Code::InverseTime(inverse) => self.inverse_time = Some(inverse),
            Code::Spindle(spindle) => self.spindle = Some(spindle),
            Code::Fan(on) => self.told = Some(Told::Fan(on)),
            Code::Beep => self.told = Some(Told::Beep),
            Code::ServoAngle => self.told = Some(Told::ServoAngle),
            Code::ToolChange => self.tool_change = Some(word),
            Code::Stop(stop) => self.stop = Some(stop),
            Code::Quiet => {}
            Code::QuietWithWords => self.owned = true,
            Code::Unknown => return Err(unknown()),
        }
        if let Some(meaning) = meaning {
            self.notice = Some(Problem::Unsupported { command: word, meaning }.at(at));
        }
        Ok(code)
    }

    /// Whether every word has its number where it needs one.
    fn check_numbers(&self) -> Result<(), Error> {
        if self.owned || matches!(self.action, Some(Action::Home | Action::Other)) {
            return Ok(());
        }
        match self.block.words().iter().find(|word| word.number.is_none()) {
            Some(word) => Err(Problem::NoNumber { letter: word.letter }.at(self.block.place(*word))),
            None => Ok(()),
        }
    }

    pub(super) fn word(&self, letter: u8) -> Option<Word> {
        self.block.words().iter().copied().find(|word| word.letter == letter)
    }

    pub(super) fn number(&self, letter: u8) -> Option<f64> {
        self.word(letter)?.number
    }

    pub(super) fn has(&self, letters: &[u8]) -> bool {
        letters.iter().any(|letter| self.word(*letter).is_some())
    }

    /// Whether the words of the line are there for its motion.
    pub(super) fn may_move(&self) -> bool {
        match self.motion {
            Some(_) => true,
            None => !self.owned && matches!(self.action, None | Some(Action::Dwell)),
        }
    }

    /// The first word that nothing in this line uses, of those that are worth a notice.
    pub(super) fn unused(&self, is_arc: bool) -> Option<Error> {
        if self.owned
            || matches!(
                self.action,
                Some(Action::Home | Action::Offset | Action::Origin { .. } | Action::Other)
            )
        {
            return None;
        }
        let used: &[u8] = if is_arc { b"IJR" } else { b"" };
        let is_unused = |word: &&Word| is_among(word.letter, NOTEWORTHY) && !is_among(word.letter, used);
        let word = *self.block.words().iter().find(is_unused)?;
        Some(Problem::Unused { word }.at(self.block.place(word)))
    }
}
