//! Executes commands: from the first letter over numbers and bytes to the end.

use super::super::encoded::Decoder;
use super::super::{Commands, Error, Extension, Mnemonic, Position};
use super::open::Open;
use super::{Interpreter, Item};
use crate::PlotOp;

/// Whether labels can be drawn.
const FONT: bool = cfg!(feature = "font");

impl<const VERTICES: usize> Interpreter<VERTICES> {
    pub(super) fn begin(&mut self, command: Mnemonic, at: Position) {
        self.open = Some(Open::new(command, at));
        self.latest = Some((command, at));
        let letters = command.letters();
        if self.recording && has_no_place_in_polygons(letters) {
            self.open = None;
            self.complain(Error::NotInPolygon { at, command });
            return;
        }
        match letters {
            b"PU" => self.lift(),
            b"PD" => {
                self.dot_owed |= !self.pen_down && !self.recording;
                (self.pen_down, self.lift_owed) = (true, false);
            }
            b"PA" => self.relative = false,
            b"PR" => self.relative = true,
            b"PE" => self.decoder = Some(Decoder::new(self.bytes)),
            b"UC" => self.begin_character(),
            b"LB" | b"SM" | b"BL" | b"PB" | b"DL" if !FONT => self.leave_out(command, at),
            b"LB" | b"PB" => self.label_from = self.at,
            b"BL" => self.buffered_count = 0,
            b"SM" => self.symbol = None,
            letters if takes(letters).is_some() => {}
            letters if is_quiet(letters) => self.open = None,
            letters if once(letters).is_some_and(|kind| !self.is_new(kind)) => self.open = None,
            _ => self.leave_out(command, at),
        }
    }

    fn leave_out(&mut self, command: Mnemonic, at: Position) {
        self.open = None;
        self.complain(Error::Unsupported { at, command });
    }

    /// Encoded data ended without their `;`, where these commands begin.
    pub(super) fn end_by(&mut self, commands: Commands, at: Position, last: bool, byte: Option<u8>) {
        if let Some(decoder) = &mut self.decoder {
            decoder.forget_number();
        }
        let mut at = at;
        for command in commands.iter() {
            self.end();
            self.begin(command, at);
            at = command.letters().iter().fold(at, |at, letter| at.after(*letter));
        }
        if let Some(byte) = byte {
            self.byte(byte, at);
        } else if last {
            self.end();
        }
    }

    pub(super) fn number(&mut self, value: f64, at: Position) {
        // Nearly all numbers are places for the pen: nothing is moved about for them.
        if let Some(open) = &mut self.open
            && goes(open.command)
        {
            match open.x.take() {
                None => open.x = Some((value, at)),
                Some((x, _)) => self.go_to(x, value),
            }
            return;
        }
        let Some(mut open) = self.open.take() else { return };
        match open.command.letters() {
            b"UC" => self.character_number(&mut open, value, at),
            b"DL" => self.own_number(&mut open, value, at),
            b"RF" => self.raster_number(&mut open, value, at),
            b"BZ" | b"BR" => {
                open.push(value, at);
                self.curve(&mut open);
            }
            _ => open.push(value, at),
        }
        self.open = Some(open);
    }

    pub(super) fn byte(&mut self, byte: u8, at: Position) {
        let Some(command) = self.open.as_ref().map(|open| open.command) else { return };
        match command.letters() {
            b"LB" => self.label_byte(byte),
            b"BL" => self.buffer_byte(byte),
            b"SM" => self.symbol = Some(byte).filter(|byte| *byte > b' '),
            b"PE" => self.encoded_byte(byte, at, command),
            _ => {}
        }
    }

    pub(super) fn end(&mut self) {
        if let Some(Open { command, x, .. }) = self.open
            && goes(command)
        {
            self.open = None;
            if let Some((x, at)) = x {
                self.complain(Error::OddCoordinates { at, command, x });
            }
            return;
        }
        let Some(open) = self.open.take() else { return };
        let (command, at) = (open.command, open.at);
        if let Some(takes) = takes(command.letters())
            && open.given() > takes
        {
            self.complain(Error::TooManyParameters { at, command, given: open.given(), takes });
        }
        if let Err(error) = self.carry_out(&open) {
            self.complain(error);
        }
    }

    fn carry_out(&mut self, open: &Open) -> Result<(), Error> {
        match open.command.letters() {
            b"IN" => {
                self.initialize();
                Ok(())
            }
            b"DF" => {
                self.leave_polygon();
                self.set_defaults();
                Ok(())
            }
            b"BP" => {
                self.leave_dot();
                if self.marked {
                    self.give(Item::Outcome(Ok(PlotOp::NewPage)));
                }
                self.initialize();
                Ok(())
            }
            b"PG" | b"AF" | b"AH" | b"FR" => {
                self.leave_dot();
                self.give(Item::Outcome(Ok(PlotOp::NewPage)));
                Ok(())
            }
            b"SP" => self.select_pen(open),
            b"VS" => self.set_speed(open),
            b"PW" | b"PT" => self.set_width(open),
            b"WU" => self.set_width_unit(open),
            b"PE" => self.end_encoded(open),
            b"BZ" | b"BR" => match open.given() {
                0 => Ok(()),
                _ => Err(open.missing("three places for each curve")),
            },
            b"CI" => self.circle(open),
            b"AA" | b"AR" => self.arc(open),
            b"AT" | b"RT" => self.arc_through(open),
            b"CT" => self.set_chord_kind(open),
            b"EA" | b"ER" | b"RA" | b"RR" => self.rectangle(open),
            b"EW" | b"WG" => self.wedge(open),
            b"PM" => self.polygon_mode(open),
            b"EP" => {
                self.edge();
                Ok(())
            }
            b"FP" => self.fill_polygon(open),
            b"FT" => self.set_fill(open),
            b"AC" => self.set_anchor(open),
            b"UF" => self.set_fill_pattern(open),
            b"IP" | b"IR" => self.set_points(open),
            b"SC" => self.set_scale(open),
            b"RO" => self.turn(open),
            b"PS" => self.set_sheet(open),
            b"IW" => self.set_window(open),
            b"LT" => self.set_line_type(open),
            b"UL" => self.set_pattern(open),
            b"TL" => self.set_ticks(open),
            b"XT" | b"YT" => {
                self.tick(open);
                Ok(())
            }
            b"LB" => {
                self.end_label();
                Ok(())
            }
            b"CP" => {
                self.move_by_characters(open);
                Ok(())
            }
            b"PB" => {
                self.playing = Some(0);
                Ok(())
            }
            b"DL" => {
                self.end_own(open);
                Ok(())
            }
            b"CS" | b"CA" => self.set_characters(open),
            b"SS" | b"SA" => {
                self.sets.is_alternate = open.command.letters() == b"SA";
                Ok(())
            }
            b"LM" if open.or(0, 0.0) != 0.0 => {
                Err(open.bad(0, "0: characters of one byte; those of two have no strokes here"))
            }
            b"RF" => self.set_raster(open),
            b"UC" => self.end_character(open),
            b"SI" | b"SR" | b"DI" | b"DR" | b"SL" | b"DV" | b"LO" | b"ES" | b"SD" | b"AD" => {
                self.set_lettering(open)
            }
            _ => Ok(()),
        }
    }
}

/// Whether a command's numbers are places for the pen to go to, one after the other.
fn goes(command: Mnemonic) -> bool {
    matches!(command.letters(), b"PU" | b"PD" | b"PA" | b"PR")
}

/// How many numbers a command takes at most; `None` for one that is not carried out.
fn takes(letters: &[u8; 2]) -> Option<u32> {
    Some(match letters {
        b"PU" | b"PD" | b"PA" | b"PR" | b"BZ" | b"BR" | b"UC" | b"SD" | b"AD" | b"BP" => u32::MAX,
        b"IN" | b"DF" | b"PG" | b"AF" | b"AH" | b"FR" | b"DL" | b"RF" | b"SS" | b"SA" => u32::MAX,
        b"LB" | b"BL" | b"PB" | b"PE" | b"SM" | b"EP" | b"XT" | b"YT" => 0,
        b"SP" | b"WU" | b"CT" | b"RO" | b"FP" | b"SL" | b"LO" | b"CS" | b"CA" => 1,
        b"VS" | b"PW" | b"PT" | b"CI" | b"EA" | b"ER" | b"RA" | b"RR" | b"PM" | b"AC" | b"PS" | b"TL"
        | b"CP" | b"LM" | b"SI" | b"SR" | b"DI" | b"DR" | b"DV" | b"ES" => 2,
        b"FT" | b"LT" => 3,
        b"AA" | b"AR" | b"EW" | b"WG" | b"IP" | b"IR" | b"IW" => 4,
        b"AT" | b"RT" => 5,
        b"SC" => 7,
        b"UF" => 20,
        b"UL" => 21,
        _ => return None,
    })
}

/// What says nothing to a machine with one pen that draws what it is told: colours, the order of drawing,
/// accelerations, motion without a stop (which the planner sees to), ends and joins of thick lines, the looks
/// of fonts, questions to the plotter, its display and its cutter. A person who reads what was left out of a
/// drawing wants to read nothing of these.
fn is_quiet(letters: &[u8; 2]) -> bool {
    matches!(
        letters,
        b"AP"
            | b"AS"
            | b"CC"
            | b"CF"
            | b"CM"
            | b"CO"
            | b"CR"
            | b"CV"
            | b"DS"
            | b"DT"
            | b"EC"
            | b"FI"
            | b"FN"
            | b"GC"
            | b"GM"
            | b"GP"
            | b"IM"
            | b"IV"
            | b"KY"
            | b"LA"
            | b"MC"
            | b"MG"
            | b"MT"
            | b"NP"
            | b"OA"
            | b"OC"
            | b"OD"
            | b"OE"
            | b"OF"
            | b"OG"
            | b"OH"
            | b"OI"
            | b"OK"
            | b"OL"
            | b"OO"
            | b"OP"
            | b"OS"
            | b"OT"
            | b"OW"
            | b"PC"
            | b"QL"
            | b"SB"
            | b"ST"
            | b"TR"
            | b"VA"
            | b"VN"
            | b"WD"
    )
}

/// Which kind of what is said once this command is: what a pen has not, and a text may set before each line.
fn once(letters: &[u8; 2]) -> Option<usize> {
    let kind = [b"FS", b"FC", b"FD"].iter().position(|of| *of == letters)?;
    Some(Extension::KINDS + kind)
}

/// What would draw, or use the polygon buffer, while a polygon is put there.
fn has_no_place_in_polygons(letters: &[u8; 2]) -> bool {
    matches!(
        letters,
        b"EA" | b"ER" | b"RA" | b"RR" | b"EW" | b"WG" | b"EP" | b"FP" | b"LB" | b"PB" | b"UC" | b"XT" | b"YT"
    )
}
