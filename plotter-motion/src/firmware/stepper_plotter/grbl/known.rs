//! The words that Grbl knows.

use super::codes::Code;
use crate::gcode::{Block, LaserCommand, PenConvention, ServoCommand};

/// Tenfold, the numbers after `G` and `M` that Grbl 1.1 knows; after `M` also 6, by which a person changes the pen. Whether a plotter
/// carries them out the interpreter says.
static GENERAL: [u16; 38] = [
    0, 10, 20, 30, 40, 100, 170, 180, 190, 200, 210, 280, 281, 300, 301, 382, 383, 384, 385, 400, 431, 490,
    530, 540, 550, 560, 570, 580, 590, 610, 800, 900, 910, 911, 920, 921, 930, 940,
];
static MISCELLANEOUS: [u16; 10] = [0, 10, 20, 30, 40, 50, 60, 80, 90, 300];

/// Whether Grbl knows the words of a line: the interpreter knows those of other firmwares too, and a program that tries them out is told
/// that this is none of those.
///
/// Where the pen is lifted by words of another firmware, its drawings have others of its words, too.
pub(super) fn check(block: &Block, pen: PenConvention) -> Result<(), Code> {
    let is_foreign = matches!(
        pen,
        PenConvention::Servo { command: ServoCommand::M300 | ServoCommand::M280 | ServoCommand::M1, .. }
            | PenConvention::Laser { command: LaserCommand::Fan | LaserCommand::M4, .. }
    );
    for word in block.words() {
        let is_known = match word.letter {
            b'F' | b'N' | b'P' | b'S' | b'T' if word.number.is_some_and(|number| number < 0.0) => {
                return Err(Code::NEGATIVE);
            }
            // What is no whole number, or none, the interpreter refuses.
            b'G' => word.tenths().is_none_or(|tenths| is_among(tenths, &GENERAL)),
            b'M' => word.tenths().is_none_or(|tenths| tenths % 10 > 0 || is_among(tenths, &MISCELLANEOUS)),
            b'F' | b'I'..=b'L' | b'N' | b'P' | b'R'..=b'T' | b'X'..=b'Z' => true,
            _ => false,
        };
        if !is_known && !is_foreign {
            return Err(Code::UNSUPPORTED);
        }
    }
    Ok(())
}

#[expect(
    clippy::manual_contains,
    reason = "the search that `contains` calls is made for long texts and takes 240 bytes of flash"
)]
fn is_among(tenths: u16, known: &[u16]) -> bool {
    known.iter().any(|one| *one == tenths)
}
