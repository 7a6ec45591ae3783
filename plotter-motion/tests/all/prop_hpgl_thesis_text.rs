//! Laws of the thesis' text: what is written is read back, and every line has exactly one outcome.

use plotter_motion::hpgl::thesis_text::{Line, MAX_COUNTS, WriteError, read, write_moves};
use plotter_motion::{Pen, PenMove, StepPoint};
use proptest::prelude::*;

fn movements(least: usize) -> impl Strategy<Value = Vec<PenMove>> {
    let movement = (any::<bool>(), 0..=MAX_COUNTS, 0..=MAX_COUNTS).prop_map(|(down, x, y)| PenMove {
        pen: if down { Pen::Down } else { Pen::Up },
        target: StepPoint::new(x, y),
    });
    proptest::collection::vec(movement, least..50)
}

fn written(moves: &[PenMove]) -> Result<String, WriteError> {
    let mut text = String::new();
    write_moves(moves.iter().copied(), &mut text)?;
    Ok(text)
}

proptest! {
    #[test]
    fn what_is_written_is_read_back(moves in movements(0)) {
        let read: Vec<_> = read(written(&moves)?.as_bytes()).collect();
        prop_assert_eq!(read, moves.into_iter().map(|movement| Ok(Line::Move(movement))).collect::<Vec<_>>());
    }

    #[test]
    fn every_line_of_any_text_has_one_outcome(text in "[PUDpd0-9, +;\\-\r\n\\x00\u{e9}]{0,200}") {
        prop_assert_eq!(read(text.as_bytes()).count(), text.split_inclusive('\n').count());
        for error in read(text.as_bytes()).filter_map(Result::err) {
            prop_assert!(error.position().offset <= text.len() as u64);
        }
    }

    #[test]
    fn a_damaged_line_costs_only_itself(moves in movements(1), place in any::<prop::sample::Index>(), byte in any::<u8>()) {
        prop_assume!(byte != b'\n');
        let mut text = written(&moves)?.into_bytes();
        let place = place.index(text.len());
        prop_assume!(text[place] != b'\n');
        let damaged_line = text[..place].iter().filter(|byte| **byte == b'\n').count();
        text[place] = byte;
        let lines: Vec<_> = read(&text).collect();
        prop_assert_eq!(lines.len(), moves.len());
        for (index, (line, movement)) in lines.iter().zip(&moves).enumerate() {
            prop_assert!(index == damaged_line || *line == Ok(Line::Move(*movement)), "{:?}", line);
        }
    }

    #[test]
    fn points_beyond_five_digits_are_never_written(x in any::<i32>(), y in any::<i32>()) {
        let fits = (0..=MAX_COUNTS).contains(&x) && (0..=MAX_COUNTS).contains(&y);
        let mut text = String::new();
        let outcome = write_moves([PenMove { pen: Pen::Up, target: StepPoint::new(x, y) }], &mut text);
        prop_assert_eq!(outcome.is_ok(), fits);
        prop_assert_eq!(text.is_empty(), !fits);
    }
}
