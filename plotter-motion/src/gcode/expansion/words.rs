//! The meaning of a line's words: whether it moves, and where to.

use super::super::interpreter::{LineInterpreter, Outcomes};
use super::super::{Block, Error, Modes, PenConvention, Problem, ReadOptions, ServoCommand, Word};
use super::PLACES;
use crate::Point;

/// A line without what belongs to its movement.
pub(super) fn without_movement(block: &Block) -> Block {
    let mut rest = *block;
    rest.retain(|word| !PLACES.contains(&word.letter) && !is_motion(word));
    rest
}

/// Carries out what is left of a line, if anything is.
pub(super) fn carry_out_rest(
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

/// The factors of `G51`, and the centre that they count from: by P or I and J about X and Y, or by X and Y
/// about the origin.
pub(super) fn scaling(block: &Block, modes: &Modes) -> Result<(Point, f64, f64), Error> {
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
    if [x, y].iter().any(|factor| !(1e-6..=1e6).contains(&factor.abs())) {
        let word = *block.words().iter().find(|word| is_factor(**word)).unwrap_or(&Word {
            letter: b'G',
            number: Some(51.0),
            column: block.position().column,
        });
        let expected = "an axis is scaled by a number from 0.000001 to 1000000, or by its negative";
        return Err(Error { at: block.place(word), problem: Problem::BadParameter { word, expected } });
    }
    Ok((centre, x, y))
}

pub(super) fn is_factor(word: Word) -> bool {
    matches!(word.letter, b'P' | b'I' | b'J' | b'X' | b'Y')
}

pub(super) fn is_motion(word: &Word) -> bool {
    word.letter == b'G'
        && matches!(
            word.tenths(),
            Some(0 | 10 | 20 | 30 | 50..=53 | 330 | 331 | 382..=385 | 730 | 760 | 800..=890)
        )
}

/// Whether the words of the line belong to a command that is no movement.
pub(super) fn takes_places(block: &Block) -> bool {
    block.words().iter().any(|word| match (word.letter, word.tenths()) {
        (b'G', Some(tenths)) => {
            matches!(tenths, 40 | 100 | 280 | 281 | 300 | 301 | 290 | 430 | 431 | 920..=923)
        }
        _ => false,
    })
}

pub(super) fn has(block: &Block, letters: &[u8]) -> bool {
    block.words().iter().any(|word| letters.contains(&word.letter))
}

/// Whether this line ends the program.
pub(in crate::gcode) fn ends(block: &Block) -> bool {
    let is_end = |word: &Word| word.letter == b'M' && matches!(word.tenths(), Some(20 | 300));
    // mDraw keeps the angles of its pen by M2.
    block.words().iter().any(is_end) && !has(block, b"UD")
}

pub(super) fn moves_along_z(pen: PenConvention) -> bool {
    matches!(pen, PenConvention::Height { .. } | PenConvention::Servo { command: ServoCommand::Z, .. })
}

pub(super) fn height_unit(modes: &Modes, options: &ReadOptions) -> f64 {
    if let PenConvention::Height { .. } = options.pen { modes.unit_mm() } else { 1.0 }
}

/// The place that two letters name; it is that of the pen where they are not there.
pub(super) fn place(block: &Block, modes: &Modes, [x, y]: [u8; 2]) -> Point {
    let origin = if modes.relative { modes.position } else { Point::ORIGIN + modes.offset };
    let along = |letter, origin: f64, at: f64| {
        block.number(letter).map_or(at, |number| origin + number * modes.unit_mm())
    };
    Point::new(along(x, origin.x, modes.position.x), along(y, origin.y, modes.position.y))
}
