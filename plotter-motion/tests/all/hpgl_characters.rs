//! Labels that are kept, sets of characters, characters of the text's own: `BL`, `PB`, `CS`, `CA`, `SS`,
//! `SA`, `DL`.
#![cfg(feature = "font")]

use crate::shown;

use plotter_motion::PlotOp;
use plotter_motion::hpgl::{Error, plot_ops};
use shown::ops;

/// A capital letter of 80 by 120 units: each step of the letters' grid is 10 units. To the next one 120.
const LETTERS: &str = "SI0.2,0.3;";

fn label(text: &str) -> String {
    ops(&format!("{LETTERS}{text}"))
}

/// What bytes, which need not be text, draw in such letters.
fn drawn(text: &[u8]) -> Vec<Result<PlotOp, Error>> {
    plot_ops(&[LETTERS.as_bytes(), text].concat()).collect()
}

#[test]
fn a_label_that_was_kept_is_drawn_where_the_pen_is_then() {
    // It draws nothing before, as often as is asked afterwards, and a new one takes its place.
    assert_eq!(label("BLL\u{3}PU500,0;"), "U500,0");
    for kept in ["L", "L\r\nL", "é L", ""] {
        let twice = label(&format!("BL{kept}\u{3}PU500,0;PB;PU9,9;DI0,1;PB;PD0,0;"));
        let same = label(&format!("PU500,0;LB{kept}\u{3}PU9,9;DI0,1;LB{kept}\u{3}PD0,0;"));
        assert_eq!(twice, same, "{kept}");
    }
    assert_eq!(label("BLI\u{3}BLL\u{3}PB"), label("LBL\u{3}"));
    // Its place may depend on its length.
    assert_eq!(label("BLLL\u{3}PU1000,1000;LO8;PB;"), label("PU1000,1000;LO8;LBLL\u{3}"));
    assert_eq!(label("BLL\u{3}IN;PB;PD1,1"), "D1,1");
}

#[test]
fn a_label_that_is_kept_has_at_most_150_bytes() {
    let long = label(&format!("BL{}\u{3}PB;", "-".repeat(152)));
    assert_eq!(long.matches('D').count(), 150);
    assert_eq!(long.matches("BL has more than 150 characters").count(), 1);
}

#[test]
fn letters_of_a_language_take_the_place_of_signs() {
    let latin = |text: &str| label(&format!("LB{text}\u{3}"));
    assert_eq!(label("CS33;LB[a]~\u{3}"), latin("ÄaÜß"));
    assert_eq!(label("CS43;LB{|}\u{3}"), latin("äöü"));
    assert_eq!(label("CS37;LB#\\]\u{3}"), latin("£Ñ¿"));
    assert_eq!(label("CS33;CS;LB[]\u{3}"), latin("[]"));
    assert_eq!(label("CS33;DF;SI0.2,0.3;LB[]\u{3}"), latin("[]"));
    // Latin-1 and UTF-8 stay what they are.
    assert_eq!(label("CS33;LBÄ[\u{3}"), latin("ÄÄ"));
    // Roman Extensions: 0xC5 and 0xB6 of Roman-8, without the eighth bit
    assert_eq!(label("CS7;LBE6\u{3}"), latin("éÑ"));
    assert_eq!(drawn(b"SD1,277;SI0.2,0.3;LB\xC5E\x03"), drawn("SD1,21;SI0.2,0.3;LBéE\u{3}".as_bytes()));
    assert_eq!(label("SD1,39;SI0.2,0.3;LB[\u{3}"), latin("Ä"));
}

#[test]
fn the_alternate_set_is_chosen_by_a_command_or_within_a_label() {
    let latin = |text: &str| label(&format!("LB{text}\u{3}"));
    assert_eq!(label("CA33;LB[\u{e}[\u{f}[\u{3}"), latin("[Ä["));
    assert_eq!(label("CA33;SA;LB[\u{3}SS;LB[\u{3}"), latin("Ä["));
    // What is shifted out stays so in the next label.
    assert_eq!(label("CA33;LB\u{e}[\u{3};LB[\u{3}"), latin("ÄÄ"));
    assert_eq!(label("AD1,39;SA;LB[\u{3}"), latin("Ä"));
    // A symbol too; its middle is that of a capital letter.
    assert_eq!(label("CS33;SM[;PU500,500;"), label("CS33;LO5;PU500,500;LB[\u{3}"));
}

#[test]
fn a_set_whose_signs_are_not_known_is_named() {
    assert_eq!(
        ops("CS5;CA99;LM1;LM0"),
        "<line 1, column 1 (byte 0): CS chooses character set 5, whose signs are not known here: labels are drawn in ASCII; known \
         are 0, 6, 7, 9, 30 to 39, and -1 for the characters of DL> <line 1, column 5 (byte 4): CA chooses character set 99, \
         whose signs are not known here: labels are drawn in ASCII; known are 0, 6, 7, 9, 30 to 39, and -1 for the characters \
         of DL> <line 1, column 12 (byte 11): LM with 1 is left out: it takes 0: characters of one byte; \
         those of two have no strokes here>"
    );
}

#[test]
fn characters_of_ones_own_are_drawn_on_a_grid_of_32() {
    // A square with a dot in it, as big as a capital letter: 80 by 120 units.
    let square = "DL65,0,0,32,0,32,32,0,32,0,0,-128,16,16;";
    let shown = "D80,0 D80,120 D0,120 D0,0 U40,60 D40,60";
    assert_eq!(label(&format!("{square}CS-1;LBA\u{3}")), shown);
    // It takes the room of a character, in either set; what nobody has told draws nothing.
    assert_eq!(
        label(&format!("{square}CA-1;LB \u{e}BA\u{3}PD0,0")),
        "U240,0 D320,0 D320,120 D240,120 D240,0 U280,60 D280,60 U360,0 D0,0"
    );
    assert_eq!(label(&format!("{square}SD1,531;SI0.2,0.3;LBA\u{3}")), shown);
    // Turned as letters are.
    assert_eq!(label("DL65,0,0,32,0;CS-1;DI0,1;LBA\u{3}"), "D0,80");
    for forgotten in ["DL65;", "DL;", "IN;SI0.2,0.3;"] {
        assert_eq!(label(&format!("{square}{forgotten}CS-1;LBA\u{3}PD0,0")), "U120,0 D0,0", "{forgotten}");
    }
}

#[test]
fn a_character_that_cannot_be_kept_is_named_and_is_none() {
    let bad = label("DL32,0,0,1,1;DL65,0,0,128,0,5,5;CS-1;LBA\u{3}PD0,0");
    assert!(bad.contains("DL with 32 is left out: it takes the number of a character, 33 to 126"), "{bad}");
    assert!(bad.contains("DL with 128 is left out: it takes steps of the grid from -127 to 127"), "{bad}");
    assert!(bad.ends_with("> U120,0 D0,0"), "{bad}");
    let long = label(&format!("DL65{};CS-1;LBA\u{3}PD0,0", ",1,2".repeat(200)));
    assert!(long.contains("DL has no room for its character"), "{long}");
    assert_eq!(long.matches('<').count(), 1);
    assert!(long.ends_with("U120,0 D0,0"), "{long}");
}

#[test]
fn a_curve_without_stops_is_the_planners_business() {
    assert_eq!(ops("CV1,20;PD400,0;CV0"), "D400,0");
}
