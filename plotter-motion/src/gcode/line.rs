//! [`Line`]: the commands of one line, once it is known that they go together.

use super::block::is_among;
use super::code::{Code, EXCLUSIVE, GROUPS, Group};
use super::error::Complaint;
use super::{Block, Problem, SYSTEMS, Word, Words};

/// Letters whose words are worth a notice where no command uses them.
const NOTEWORTHY: &[u8] = b"ABCEIJKRUVW";

/// Letters, `A` the lowest bit, whose words GRBL knows, and of them those whose numbers are not below 0.
const GRBL_LETTERS: u32 = letters(b"FIJKLNPRSTXYZ");
const NOT_NEGATIVE: u32 = letters(b"FNPST");

const fn letters(mut letters: &[u8]) -> u32 {
    let mut bits = 0;
    while let [letter, rest @ ..] = letters {
        (bits, letters) = (bits | bit(*letter), rest);
    }
    bits
}

const fn bit(letter: u8) -> u32 {
    1 << (letter & 31)
}

/// The first `P` of `G10` that is no coordinate system.
const NO_SYSTEM: f64 = (SYSTEMS + 1) as f64;

/// What the words of one line ask for together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'b> {
    pub(super) block: &'b Block,
    /// Of each group what it was asked for, and by which word: one more than where that stands.
    codes: [Option<Code>; GROUPS],
    places: [u8; GROUPS],
    /// mDraw's number without a letter.
    pub(super) bare: f64,
    /// The last word that is known and not carried out.
    pub(super) undone: Option<Word>,
}

impl<'b> Line<'b> {
    pub(super) fn read<C: Complaint>(block: &'b Block, known: Words) -> Result<Self, C> {
        let mut line = Self { block, codes: [None; GROUPS], places: [0; GROUPS], bare: 0.0, undone: None };
        let mut letters = 0_u32;
        // The letter before, and whatever no line begins with.
        let mut before = 0;
        for (&word, place) in block.words().iter().zip(1_u8..) {
            let after = core::mem::replace(&mut before, word.letter);
            if !matches!(word.letter, b'G' | b'M') {
                let bit = bit(word.letter);
                if known.is_grbl() {
                    if GRBL_LETTERS & bit == 0 {
                        return Err(Problem::Unknown { command: word }.at(block.place(word)));
                    }
                    if NOT_NEGATIVE & bit != 0 && word.number.is_some_and(|number| number < 0.0) {
                        let expected = "a number is not below 0 here";
                        return Err(Problem::BadParameter { word, expected }.at(block.place(word)));
                    }
                }
                if word.letter == Word::BARE {
                    if after == b'M' {
                        continue;
                    }
                    return Err(Problem::NoLetter.at(block.place(word)));
                }
                if letters & bit != 0 {
                    // `XNaN` lacks a number first of all. A controller has no room to tell.
                    #[cfg(feature = "alloc")]
                    if known == Words::Any {
                        line.check_numbers()?;
                    }
                    return Err(Problem::Repeated { letter: word.letter }.at(block.place(word)));
                }
                letters |= bit;
                continue;
            }
            let next = block.words().get(usize::from(place)).filter(|_| word.letter == b'M');
            let bare = next.filter(|next| known == Words::Any && next.letter == Word::BARE);
            let code = line.command(word, bare.and_then(|bare| bare.number), known)?;
            let group = code.group();
            if group < EXCLUSIVE
                && let Some(first) = line.word_of(group)
            {
                return Err(Problem::TwoCommands { first, second: word }.at(block.place(word)));
            }
            if let (Some(slot), Some(at)) = (line.codes.get_mut(group), line.places.get_mut(group)) {
                (*slot, *at) = (Some(code), place);
            }
        }
        line.check_numbers()?;
        let has_axis = || b"XYZ".iter().any(|letter| letters & bit(*letter) != 0);
        if let (Some(motion), Some(action)) =
            (line.word_of(Group::Motion as usize), line.word_of(Group::Action as usize))
            && !line.is(Code::NoMotion)
            && !line.is(Code::Dwell)
            && has_axis()
        {
            let (first, second) =
                if motion.column < action.column { (motion, action) } else { (action, motion) };
            return Err(Problem::TwoCommands { first, second }.at(block.place(second)));
        }
        Ok(line)
    }

    /// One `G` or `M` word, and mDraw's number after it.
    fn command<C: Complaint>(&mut self, word: Word, bare: Option<f64>, known: Words) -> Result<Code, C> {
        let at = self.block.place(word);
        if word.number.is_none() {
            return Err(Problem::NoNumber { letter: word.letter }.at(at));
        }
        let tenths = word.tenths();
        if let (Some(tenths), Some(bare)) = (tenths, bare) {
            self.bare = bare;
            return match tenths {
                10 => Ok(Code::Degrees),
                40 => Ok(Code::LaserPower),
                30 => Ok(Code::Quiet), // slower steps
                _ => Err(Problem::NoLetter.at(at)),
            };
        }
        let found = tenths.and_then(|tenths| Code::of(word.letter, tenths, known));
        let (Some(tenths), Some((code, is_done))) = (tenths, found) else {
            return Err(Problem::Unknown { command: word }.at(at));
        };
        // mDraw keeps the angles and the sheet of its machine by M2 and M5.
        let has = |letters: &[u8]| self.block.words().iter().any(|word| is_among(word.letter, letters));
        if known == Words::Any
            && word.letter == b'M'
            && ((tenths == 20 && has(b"UD")) || (tenths == 50 && has(b"ABHW")))
        {
            return Ok(Code::QuietWithWords);
        }
        // P0 is the coordinate system in force, P1 that of G54, P6 that of G59.
        if (word.letter, tenths) == (b'G', 100)
            && let (Some(0.0..NO_SYSTEM), Some(form @ (2.0 | 20.0))) =
                (self.block.number(b'P'), self.block.number(b'L'))
        {
            return Ok(if form > 2.0 { Code::OriginHere } else { Code::Origin });
        }
        if !is_done {
            self.undone = Some(word);
        }
        Ok(code)
    }

    /// Whether every word has its number where it needs one.
    fn check_numbers<C: Complaint>(&self) -> Result<(), C> {
        if self.owned() || self.is(Code::Home) || self.is(Code::Other) {
            return Ok(());
        }
        match self.block.words().iter().find(|word| word.number.is_none()) {
            Some(word) => Err(Problem::NoNumber { letter: word.letter }.at(self.block.place(*word))),
            None => Ok(()),
        }
    }

    /// What is asked for of a group.
    pub(super) fn of(&self, group: Group) -> Option<Code> {
        self.codes.get(group as usize).copied().flatten()
    }

    /// Whether this is asked for.
    pub(super) fn is(&self, code: Code) -> bool {
        self.codes.get(code.group()).copied().flatten() == Some(code)
    }

    /// Whether this holds from here on, as it did before where nothing of its group is asked for.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn chooses(&self, code: Code, before: bool) -> bool {
        match self.codes.get(code.group()).copied().flatten() {
            Some(chosen) => chosen == code,
            None => before,
        }
    }

    /// The word that asks for something of a group.
    pub(super) fn word_of(&self, group: usize) -> Option<Word> {
        let place = self.places.get(group).copied().unwrap_or_default();
        self.block.words().get(usize::from(place).wrapping_sub(1)).copied()
    }

    /// The whole number after the `G` of a group.
    pub(super) fn whole_of(&self, group: Group) -> Option<u8> {
        self.word_of(group as usize).and_then(Word::tenths).and_then(|tenths| u8::try_from(tenths / 10).ok())
    }

    /// Whether the words belong to a command that means nothing to a plotter.
    pub(super) fn owned(&self) -> bool {
        self.is(Code::QuietWithWords)
    }

    pub(super) fn word(&self, letter: u8) -> Option<&'b Word> {
        self.block.words().iter().find(|word| word.letter == letter)
    }

    pub(super) fn number(&self, letter: u8) -> Option<f64> {
        self.word(letter)?.number
    }

    /// Whether a letter stands there with its number.
    pub(super) fn gives(&self, letter: u8) -> bool {
        self.number(letter).is_some()
    }

    pub(super) fn has(&self, letters: &[u8]) -> bool {
        letters.iter().any(|letter| self.word(*letter).is_some())
    }

    /// Whether the words of the line are there for its motion.
    pub(super) fn may_move(&self) -> bool {
        if self.of(Group::Length).is_some() {
            return false;
        }
        self.of(Group::Motion).is_some()
            || (!self.owned() && matches!(self.of(Group::Action), None | Some(Code::Dwell)))
    }

    /// The first word that nothing in this line uses, of those that are worth a notice.
    pub(super) fn unused(&self, used: &[u8]) -> Option<Word> {
        if self.owned() || !matches!(self.of(Group::Action), None | Some(Code::Dwell | Code::NoOffset)) {
            return None;
        }
        let is_unused = |word: &&Word| is_among(word.letter, NOTEWORTHY) && !is_among(word.letter, used);
        self.block.words().iter().find(is_unused).copied()
    }
}
