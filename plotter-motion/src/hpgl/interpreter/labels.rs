//! Labels, symbols, characters of the text's own, and ticks: `LB`, `BL`, `PB`, `SM`, `UC`, `DL`, `CP`, `XT`,
//! `YT`; the sets that characters are taken from: `CS`, `CA`, `SS`, `SA`.

use super::super::character_set::CharacterSet;
use super::super::lettering::MOST_KEPT;
use super::super::piece::Piece;
use super::super::scaling::limited;
use super::super::{Error, Position};
use super::Interpreter;
use super::job::Job;
use super::open::Open;
use super::text_job::TextJob;
use crate::Vec2;

const BACKSPACE: u8 = 8;
const TAB: u8 = 9;
const LINE_FEED: u8 = 10;
const CARRIAGE_RETURN: u8 = 13;
const SHIFT_OUT: u8 = 14;
const SHIFT_IN: u8 = 15;
/// What stands for a character that is not in Latin-1.
const UNKNOWN: u8 = b'?';
/// In place of a first byte: the character that it began has been dealt with.
const CONTINUED: u8 = 0x80;
/// Characters from one stop of the tabulator to the next, and how near to a stop one stands on it.
const TAB_COLUMNS: f64 = 8.0;
const SAME_COLUMN: f64 = 1e-6;
/// Steps of the grid of `UC` in a capital letter's width and height.
///
/// Source: *HP 7470A Interfacing and Programming Manual*, on `UC`: a sigma of the size of a capital letter is
/// 4 steps wide and 8 high.
const CHARACTER_GRID: (f64, f64) = (4.0, 8.0);
/// From here on, with either sign, a number of `UC` lowers or lifts the pen.
const PEN_CONTROL: f64 = 99.0;

impl<const VERTICES: usize> Interpreter<VERTICES> {
    /// One more byte of a label, in Latin-1 or UTF-8.
    pub(super) fn label_byte(&mut self, byte: u8) {
        match (self.lead.take(), byte) {
            (Some(lead @ ..0xE0), 0x80..=0xBF) if lead != CONTINUED => {
                let character = ((lead & 3) << 6) | (byte & 0x3F);
                if character >= 0xA0 {
                    self.keep(character.into());
                }
            }
            (Some(lead), 0x80..=0xBF) => {
                if lead != CONTINUED {
                    self.keep(UNKNOWN.into());
                }
                self.lead = Some(CONTINUED);
            }
            (lead, _) => {
                self.lone_lead(lead);
                if matches!(byte, 0xC2 | 0xC3 | 0xE0..=0xF4) {
                    self.lead = Some(byte);
                } else {
                    self.character(byte);
                }
            }
        }
        if self.lettering.is_usual() {
            self.draw_kept();
        }
    }

    /// What might have been the first byte of several is a letter by itself.
    fn lone_lead(&mut self, lead: Option<u8>) {
        if let Some(lead) = lead.filter(|lead| *lead != CONTINUED) {
            self.character(lead);
        }
    }

    /// A byte that is a character by itself, in the set that holds.
    fn character(&mut self, byte: u8) {
        match byte {
            BACKSPACE | LINE_FEED | CARRIAGE_RETURN | TAB => self.control(byte),
            SHIFT_OUT | SHIFT_IN => self.sets.is_alternate = byte == SHIFT_OUT,
            // Other control characters mean nothing.
            0..=31 | 127..=159 => {}
            _ => self.keep(self.sets.set().character(byte)),
        }
    }

    fn keep(&mut self, character: u16) {
        if let Some(slot) = self.kept.get_mut(self.kept_count) {
            *slot = character;
            self.kept_count += 1;
        } else if self.kept_count == MOST_KEPT {
            // Counted once more, so that it is said once.
            self.kept_count += 1;
            self.say_too_long();
        }
    }

    fn say_too_long(&mut self) {
        self.report = self.latest.map(|(command, at)| Error::LabelTooLong { at, command });
    }

    /// One more byte of a label that is drawn later.
    pub(super) fn buffer_byte(&mut self, byte: u8) {
        if let Some(slot) = self.buffered.get_mut(self.buffered_count) {
            *slot = byte;
            self.buffered_count += 1;
        } else if self.buffered_count == MOST_KEPT {
            self.buffered_count += 1;
            self.say_too_long();
        }
    }

    /// Goes on with the label that was kept, if it is being drawn; says whether it was.
    pub(super) fn play(&mut self) -> bool {
        let Some(next) = self.playing else { return false };
        let count = self.buffered_count.min(MOST_KEPT);
        if let Some(byte) = self.buffered.get(..count).and_then(|bytes| bytes.get(next)).copied() {
            self.playing = Some(next + 1);
            self.label_byte(byte);
        } else {
            self.playing = None;
            self.end_label();
        }
        true
    }

    /// Moves the pen as a control character says, after what stands before it.
    fn control(&mut self, character: u8) {
        self.draw_kept();
        let metrics = self.lettering.metrics(&self.scaling);
        let start = self.lettering.line_start;
        self.at = limited(match character {
            BACKSPACE => self.at - metrics.advance,
            CARRIAGE_RETURN => start,
            LINE_FEED => {
                self.lettering.line_start = limited(start + metrics.feed);
                self.at + metrics.feed
            }
            _ => {
                let length = libm::fmax(metrics.advance.length_squared(), f64::MIN_POSITIVE);
                let column = (self.at - start).dot(metrics.advance) / length;
                let stop = TAB_COLUMNS * (libm::floor(column / TAB_COLUMNS + SAME_COLUMN) + 1.0);
                self.at + metrics.advance * (stop - column)
            }
        });
    }

    /// Draws the characters that are kept, and empties the store when they are drawn.
    fn draw_kept(&mut self) {
        let count = self.kept_count.min(MOST_KEPT);
        if count == 0 {
            return;
        }
        self.leave_dot();
        let metrics = self.lettering.metrics(&self.scaling);
        let first = self.at + self.lettering.shift(&metrics, count);
        self.job = Job::Text(TextJob::new(metrics, first));
        if self.lettering.goes_on() {
            #[expect(clippy::cast_precision_loss, reason = "at most 150")]
            let count = count as f64;
            self.at = limited(self.at + metrics.advance * count);
        }
    }

    pub(super) fn end_label(&mut self) {
        let lead = self.lead.take();
        self.lone_lead(lead);
        self.draw_kept();
        if !self.lettering.goes_on() {
            self.at = self.label_from;
        }
    }

    /// A symbol about where the pen is.
    pub(super) fn draw_symbol(&mut self, symbol: u8) {
        let metrics = self.lettering.metrics(&self.scaling);
        let first = self.at - (metrics.right + metrics.up) * 0.5;
        self.kept_count = 0;
        self.keep(self.sets.set().character(symbol));
        self.job = Job::Text(TextJob::new(metrics, first));
    }

    pub(super) fn begin_character(&mut self) {
        self.leave_dot();
        self.character_down = false;
        self.character_at = self.at;
    }

    /// One more number of `UC`: the pen's control, or half of a step.
    pub(super) fn character_number(&mut self, open: &mut Open, value: f64, at: Position) {
        match open.x.take() {
            None if value >= PEN_CONTROL => self.character_down = true,
            None if value <= -PEN_CONTROL => self.character_down = false,
            None => open.x = Some((value, at)),
            Some((x, _)) => {
                let metrics = self.lettering.metrics(&self.scaling);
                let step = metrics.right * (x / CHARACTER_GRID.0) + metrics.up * (value / CHARACTER_GRID.1);
                let from = self.character_at;
                self.character_at = limited(from + step);
                if self.character_down {
                    let piece = Piece::Line { from, to: self.character_at };
                    self.give(super::Item::Piece { piece, patterned: false, feed_mm_s: self.feed() });
                }
            }
        }
    }

    pub(super) fn end_character(&mut self, open: &Open) -> Result<(), Error> {
        self.at = limited(self.at + self.lettering.metrics(&self.scaling).advance);
        match open.x {
            Some((x, at)) => Err(Error::OddCoordinates { at, command: open.command, x }),
            None => Ok(()),
        }
    }

    /// One more number of `DL`: which character, then where its pen goes.
    pub(super) fn own_number(&mut self, open: &mut Open, value: f64, at: Position) {
        let first = open.given() == 0;
        open.push(value, at);
        let (least, most) = if first { (33.0, 126.0) } else { (-128.0, 127.0) };
        let rounded = libm::round(value);
        if !(least..=most).contains(&rounded) {
            self.own.give_up();
            let expected = if first {
                "the number of a character, 33 to 126"
            } else {
                "steps of the grid from -127 to 127, or -128 to lift the pen"
            };
            self.report = Some(Error::BadParameter { at, command: open.command, value, expected });
            return;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the range above")]
        let has_room = if first { self.own.begin(rounded as u8) } else { self.own.push(rounded as i8) };
        if !has_room {
            self.report = Some(Error::NoRoomForCharacter { at: open.at, command: open.command });
        }
    }

    /// `DL` without numbers forgets all characters of the text's own.
    pub(super) fn end_own(&mut self, open: &Open) {
        if open.given() == 0 {
            self.own.clear();
        }
        self.own.end();
    }

    /// `CS` and `CA`.
    pub(super) fn set_characters(&mut self, open: &Open) -> Result<(), Error> {
        let set = CharacterSet::numbered(open.or(0, 0.0));
        match open.command.letters() {
            b"CS" => self.sets.standard = set.unwrap_or_default(),
            _ => self.sets.alternate = set.unwrap_or_default(),
        }
        let (at, command, set_number) = (open.at, open.command, open.or(0, 0.0));
        set.map(|_| ()).ok_or(Error::UnknownSigns { at, command, set_number })
    }

    /// `CP`: by so many characters and lines up; without numbers, to the start of the next line.
    pub(super) fn move_by_characters(&mut self, open: &Open) {
        self.leave_dot();
        let metrics = self.lettering.metrics(&self.scaling);
        if open.given() == 0 {
            self.control(CARRIAGE_RETURN);
            self.control(LINE_FEED);
        } else {
            let up = -metrics.feed * open.or(1, 0.0);
            self.lettering.line_start = limited(self.lettering.line_start + up);
            self.at = limited(self.at + metrics.advance * open.or(0, 0.0) + up);
        }
        self.draw(Piece::Travel { to: self.at });
    }

    pub(super) fn set_lettering(&mut self, open: &Open) -> Result<(), Error> {
        let pair = open.pair(0);
        let letters = open.command.letters();
        match letters {
            b"SI" | b"SR" => {
                open.none_or(2, "a width and a height")?;
                if pair.is_some_and(|size| size.x == 0.0 || size.y == 0.0) {
                    return Err(open.bad(0, "a width and a height that are not 0"));
                }
                if letters == b"SI" {
                    self.lettering.set_size(pair);
                } else {
                    self.lettering.set_relative_size(pair);
                }
            }
            b"DI" | b"DR" => {
                open.none_or(2, "a run and a rise")?;
                if pair == Some(Vec2::default()) {
                    return Err(open.bad(0, "a run and a rise that are not both 0"));
                }
                if letters == b"DI" {
                    self.lettering.set_direction(pair);
                } else {
                    self.lettering.set_relative_direction(pair);
                }
                self.lettering.line_start = self.at;
            }
            b"SL" => self.lettering.slant = open.or(0, 0.0),
            b"DV" => {
                let path = open.whole(0, 0, 0, 3, "0 to 3: to the right, down, to the left, up")?;
                let reversed = open.whole(1, 0, 0, 1, "0, or 1 for lines the other way")? == 1;
                self.lettering.set_path(path, reversed);
                self.lettering.line_start = self.at;
            }
            b"LO" => {
                let expected = "a label origin: 1 to 9, 11 to 19 or 21";
                let origin = open.whole(0, 1, 1, 21, expected)?;
                if origin % 10 == 0 {
                    return Err(open.bad(0, expected));
                }
                self.lettering.set_origin(if origin == 21 { 1 } else { origin });
                self.lettering.line_start = self.at;
            }
            b"ES" => self.lettering.extra = Vec2::new(open.or(0, 0.0), open.or(1, 0.0)),
            // SD and AD: pairs of a kind and a value, of which the set of characters is the first kind and
            // the height in points the fourth.
            _ => {
                let last = |kind: f64| {
                    let mut pairs = open.numbers().chunks_exact(2).rev();
                    pairs.find_map(|pair| {
                        matches!(pair, [is, _] if *is == kind).then(|| pair.last().copied())?
                    })
                };
                let set = last(1.0).map_or(CharacterSet::default(), CharacterSet::of_printer);
                if letters == b"AD" {
                    self.sets.alternate = set;
                } else {
                    self.sets.standard = set;
                    if let Some(points) = last(4.0).filter(|points| *points > 0.0) {
                        self.lettering.set_points(points);
                    }
                }
            }
        }
        Ok(())
    }

    /// `XT` to both sides of the x axis, `YT` of the y axis; by percent of P1 to P2.
    pub(super) fn tick(&mut self, open: &Open) {
        self.leave_dot();
        let frame = self.scaling.frame();
        let way =
            if open.command.letters() == b"XT" { Vec2::new(0.0, frame.y) } else { Vec2::new(frame.x, 0.0) };
        let way = self.scaling.turned(Vec2::new(libm::fabs(way.x), libm::fabs(way.y)));
        let (to, from) = self.tick_percent;
        let piece = Piece::Line { from: self.at - way * (from / 100.0), to: self.at + way * (to / 100.0) };
        self.give(super::Item::Piece { piece, patterned: false, feed_mm_s: self.feed() });
    }
}
