//! What a line of G-code draws, by the machine that takes it.

use super::{Lines, Tongue};
use plotter_motion::PlotOp;
use plotter_motion::gcode::{Interpreter, PenConvention, ReadOptions, ServoCommand};

impl Lines {
    /// A line carried out: what it draws, and whether all before is drawn when it is answered.
    pub(super) fn carry_out(&mut self, line: &[u8]) -> Result<(Vec<PlotOp>, bool), ()> {
        let text = line.trim_ascii();
        if self.tongue == Tongue::MDraw {
            return Ok((self.carry_out_mdraw(text), false));
        }
        let (text, is_jog) = match text.strip_prefix(b"$J=") {
            Some(jog) if self.tongue == Tongue::Grbl => (jog, true),
            None if text.first() == Some(&b'$') => return Ok((Vec::new(), false)),
            _ => (text, false),
        };
        let before = self.interpreter;
        if is_jog {
            // It has modes of its own, and the pen stays as it is.
            let (moves, is_wrong) = self.interpret(&[b"G1".as_slice(), text].concat());
            let at = self.interpreter.modes().position;
            self.interpreter = before;
            self.interpreter.stand_at(at);
            let moves = moves.into_iter().filter_map(PlotOp::target).map(|to| PlotOp::Travel { to });
            return if is_wrong { Err(()) } else { Ok((moves.collect(), false)) };
        }
        let (ops, is_wrong) = self.interpret(text);
        // Marlin says of itself what it does not know, and knows far more than draws.
        if is_wrong && self.tongue == Tongue::Grbl {
            return Err(());
        }
        let waiting: &[(u8, u16)] = match self.tongue {
            Tongue::Grbl => &[(b'G', 4), (b'M', 2), (b'M', 30)],
            Tongue::MDraw | Tongue::Hpgl => &[],
            Tongue::Marlin => {
                &[(b'G', 4), (b'G', 28), (b'M', 0), (b'M', 1), (b'M', 3), (b'M', 4), (b'M', 5), (b'M', 400)]
            }
        };
        Ok((ops, has_word(text, waiting)))
    }

    /// What the interpreter makes of a line, and whether it does not understand it.
    fn interpret(&mut self, text: &[u8]) -> (Vec<PlotOp>, bool) {
        let (mut ops, mut is_wrong) = (Vec::new(), false);
        for &byte in text.iter().chain(b"\n") {
            let Some(block) = self.reader.push(byte) else { continue };
            if self.interpreter.push(block).is_err() {
                continue; // cannot be: all of the line before has been taken
            }
            while let Some(op) = self.interpreter.next_op() {
                match op {
                    Ok(op) => ops.push(op),
                    Err(error) => is_wrong |= !error.is_notice(),
                }
            }
        }
        (ops, is_wrong)
    }

    /// The same of a line of mDraw's, whose machine does nothing where it does not understand, and to which
    /// some words are others than elsewhere.
    fn carry_out_mdraw(&mut self, line: &[u8]) -> Vec<PlotOp> {
        let text = String::from_utf8_lossy(line).to_ascii_uppercase();
        let mut words = text.split_whitespace();
        match words.next() {
            Some("G0" | "G00" | "G1" | "G01" | "G90" | "G91" | "M1") => self.interpret(line).0,
            // A laser that burns is a pen that is down.
            Some("M4") => {
                let burns =
                    words.next().and_then(|power| power.parse().ok()).is_some_and(|power: f64| power > 0.0);
                self.interpret(if burns { b"M1 90" } else { b"M1 160" }).0
            }
            Some("M2") => {
                let degrees = |letter: char| {
                    let number = |word: &str| word.strip_prefix(letter)?.parse().ok();
                    text.split_whitespace().find_map(number).filter(|deg: &f64| (0.0..=180.0).contains(deg))
                };
                if let (Some(up), Some(down)) = (degrees('U'), degrees('D')) {
                    let at = self.interpreter.modes().position;
                    let pen = PenConvention::Servo { command: ServoCommand::M1, up, down };
                    self.interpreter =
                        Interpreter::with_options(ReadOptions { pen, ..ReadOptions::default() });
                    self.interpreter.stand_at(at);
                }
                Vec::new()
            }
            _ => Vec::new(),
        }
    }
}

/// Whether a line has one of these words of G-code: a letter in capitals, and a whole number.
fn has_word(line: &[u8], words: &[(u8, u16)]) -> bool {
    line.iter().enumerate().any(|(at, letter)| {
        let letter = letter.to_ascii_uppercase();
        if !words.iter().any(|word| word.0 == letter) {
            return false;
        }
        let digits = line.iter().skip(at + 1).skip_while(|byte| **byte == b' ').map_while(|byte| {
            let digit = u16::from(byte.wrapping_sub(b'0'));
            (digit < 10).then_some(digit)
        });
        let number = digits.fold(None, |number: Option<u16>, digit| {
            Some(number.unwrap_or(0).saturating_mul(10).saturating_add(digit))
        });
        number.is_some_and(|number| words.contains(&(letter, number)))
    })
}

#[cfg(test)]
mod tests {
    use super::has_word;

    #[test]
    fn words_are_found_with_their_whole_number() {
        let waiting = [(b'G', 4), (b'M', 30)];
        for line in [&b"G4 P1"[..], b"G04P0", b"N10 g4", b"M30", b"X1 M 030"] {
            assert!(has_word(line, &waiting), "{line:?}");
        }
        for line in [&b"G40"[..], b"G1 X4", b"M3", b"M300 S4", b"G", b"", b"M99999999930"] {
            assert!(!has_word(line, &waiting), "{line:?}");
        }
    }
}
