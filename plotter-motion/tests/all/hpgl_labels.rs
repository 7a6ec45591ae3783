//! Labels and symbols: where characters stand, how big they are, and where the pen is afterwards.
#![cfg(feature = "font")]

use crate::shown;

use shown::ops;

/// A capital letter of 80 by 120 units: each step of the letters' grid is 10 units. To the next one 120, to
/// the next line 240.
const LETTERS: &str = "SI0.2,0.3;";

fn label(text: &str) -> String {
    ops(&format!("{LETTERS}{text}"))
}

#[test]
fn a_letter_is_as_big_as_a_capital_and_stands_on_the_pen() {
    // An L: down its left side, and along its foot
    assert_eq!(label("PU1000,1000;LBL\u{3}"), "U1000,1000 U1000,1120 D1000,1000 D1080,1000");
    assert_eq!(
        label("PU1000,1000;LBLL\u{3}"),
        "U1000,1000 U1000,1120 D1000,1000 D1080,1000 U1120,1120 D1120,1000 D1200,1000"
    );
    // 7475A: 0.19 by 0.27 cm when nothing is said
    assert_eq!(ops("LBL\u{3}"), "U0,108 D0,0 D76,0");
    // In percent of 4000 by 3000 units
    assert_eq!(ops("IP0,0,4000,3000;SR2,4;LBL\u{3}"), "U0,120 D0,0 D80,0");
}

#[test]
fn the_pen_goes_on_after_the_last_character() {
    assert_eq!(label("PU1000,1000;LB  \u{3}PD0,0"), "U1000,1000 U1240,1000 D0,0");
    assert_eq!(label("PU1000,1000;LB \u{3};LBL\u{3}"), "U1000,1000 U1120,1120 D1120,1000 D1200,1000");
}

#[test]
fn control_characters_move_the_pen() {
    assert_eq!(label("PU1000,1000;LB  \r\n\u{3}PD0,0"), "U1000,1000 U1000,760 D0,0");
    assert_eq!(label("PU1000,1000;LB  \u{8}\u{3}PD0,0"), "U1000,1000 U1120,1000 D0,0");
    assert_eq!(label("PU1000,1000;LB \t\u{3}PD0,0"), "U1000,1000 U1960,1000 D0,0");
    // A line below is where the line began, also in the next label.
    assert_eq!(label("PU1000,1000;LB  \n\u{3};LB\r\u{3}PD0,0"), "U1000,1000 U1000,760 D0,0");
}

#[test]
fn letters_may_be_turned_slanted_and_spread() {
    assert_eq!(label("DI0,1;LBL \u{3}PD9,9"), "U-120,0 D0,0 D0,80 U0,240 D9,9");
    assert_eq!(
        ops(&format!("IP0,0,4000,3000;{LETTERS}DR3,4;LBL\u{3}")),
        "U-84.853,84.853 D0,0 D56.569,56.569"
    );
    assert_eq!(label("SL0.5;LBL\u{3}"), "U60,120 D0,0 D80,0");
    assert_eq!(label("ES0.5,1;LB  \r\n\u{3}PD9,9"), "U0,-480 D9,9");
    assert_eq!(label("ES0.5;LB  \u{3}PD9,9"), "U360,0 D9,9");
    assert_eq!(label("RO90;LBL\u{3}"), "U-120,0 D0,0 D0,80");
}

#[test]
fn text_may_run_down_left_and_up() {
    assert_eq!(label("DV1;LB  \u{3}PD9,9"), "U0,-480 D9,9");
    assert_eq!(label("DV2;LB  \u{3}PD9,9"), "U-240,0 D9,9");
    assert_eq!(label("DV3;LB  \u{3}PD9,9"), "U0,480 D9,9");
    // A line feed goes to the right of the text's way: down, left, up; with a 1 the other way.
    assert_eq!(label("DV1;LB\n\u{3}PD9,9"), "U-120,0 D9,9");
    assert_eq!(label("DV0,1;LB\n\u{3}PD9,9"), "U0,240 D9,9");
}

#[test]
fn a_label_lies_to_the_pen_as_its_origin_says() {
    // Two characters are 200 units wide and 120 high.
    let start = |origin: u8| {
        let shown = label(&format!("PU1000,1000;LO{origin};LBLL\u{3}"));
        // The first line goes down to the lower left corner of the first L.
        let corner = shown.split(' ').find_map(|op| op.strip_prefix('D')).and_then(|at| at.split_once(','));
        corner.map(|(x, y)| (x.parse::<f64>().expect("x"), y.parse::<f64>().expect("y"))).expect("a line")
    };
    let expected = [
        (1000., 1000.),
        (1000., 940.),
        (1000., 880.),
        (900., 1000.),
        (900., 940.),
        (900., 880.),
        (800., 1000.),
        (800., 940.),
        (800., 880.),
    ];
    for (origin, place) in (1..=9).zip(expected) {
        assert_eq!(start(origin), place, "LO{origin}");
    }
    // Away from the pen by half a capital letter, 40 and 60 units
    let expected = [
        (1040., 1060.),
        (1040., 940.),
        (1040., 820.),
        (900., 1060.),
        (900., 940.),
        (900., 820.),
        (760., 1060.),
        (760., 940.),
        (760., 820.),
    ];
    for (origin, place) in (11..=19).zip(expected) {
        assert_eq!(start(origin), place, "LO{origin}");
    }
}

#[test]
fn labels_that_do_not_begin_at_the_pen_give_it_back() {
    // HP-GL/2: only labels that begin at the pen go on with the next one.
    assert_eq!(label("PU1000,1000;LO8;LB  \u{3}PD0,0"), "U1000,1000 D0,0");
    assert_eq!(label("PU1000,1000;LO2;LB  \u{3}PD0,0"), "U1000,1000 U1240,1000 D0,0");
    assert_eq!(label("PU1000,1000;LO5;LB  \r\n  \r\n\u{3}PD0,0"), "U1000,1000 D0,0");
    // Each line of a label is placed by itself: the second is one letter long.
    assert_eq!(
        label("PU1000,1000;LO7;LBLL\r\nL\u{3}"),
        "U1000,1000 U800,1120 D800,1000 D880,1000 U920,1120 D920,1000 D1000,1000 U920,880 D920,760 D1000,760"
    );
}

#[test]
fn a_label_whose_place_depends_on_its_length_is_at_most_150_long() {
    let long = format!("LO8;LB{}\u{3}LO1;LB{}\u{3}", "-".repeat(152), "-".repeat(152));
    let shown = ops(&long);
    assert_eq!(shown.matches('D').count(), 150 + 152);
    assert!(shown.contains("LB has more than 150 characters, and those are left out"));
    assert_eq!(shown.matches('<').count(), 1);
}

#[test]
fn characters_come_in_latin_1_or_utf_8() {
    let degree = label("LB°\u{3}");
    assert_eq!(degree.matches('D').count(), 8);
    let latin = [&b"SI0.2,0.3;LB\xB0\x03"[..], b"SI0.2,0.3;LB\xE9!\x03"];
    let drawn = |text: &[u8]| plotter_motion::hpgl::plot_ops(text).count();
    assert_eq!(drawn(latin[0]), drawn("SI0.2,0.3;LB°\u{3}".as_bytes()));
    assert_eq!(drawn(latin[1]), drawn("SI0.2,0.3;LBé!\u{3}".as_bytes()));
    // What has no strokes is a question mark.
    assert_eq!(label("LB€L\u{3}"), label("LB?L\u{3}"));
}

#[test]
fn characters_up_and_across_are_moves() {
    assert_eq!(label("PU1000,1000;CP2,1;PD0,0"), "U1000,1000 U1240,1240 D0,0");
    assert_eq!(label("PU1000,1000;LB  \u{3}CP;PD0,0"), "U1000,1000 U1000,760 D0,0");
}

#[test]
fn symbols_stand_about_each_place() {
    // A plus is 60 by 60 units about the middle of a capital letter.
    let plus = "U500,530 D500,470 U470,500 D530,500";
    assert_eq!(label("SM+;PU500,500;SM;PU0,0"), format!("U500,500 {plus} U0,0"));
    assert_eq!(label("PU0,500;SM+;PD500,500"), format!("U0,500 D500,500 {plus}"));
}

#[test]
fn a_character_of_ones_own_is_drawn_in_quarters_and_eighths_of_a_capital() {
    // The sigma of the 7470A's manual: as wide and high as a capital letter
    assert_eq!(
        label("PU1000,1000;UC4,7,99,0,1,-4,0,2,-4,-2,-4,4,0,0,1;PD0,0"),
        "U1000,1000 U1080,1105 D1080,1120 D1000,1120 D1040,1060 D1000,1000 D1080,1000 D1080,1015 U1120,1000 D0,0"
    );
    assert_eq!(label("UC99,4,0,-99,0,8,99,-4,0"), "D80,0 U80,120 D0,120");
}

#[test]
fn a_printers_font_has_a_height_in_points() {
    // 12 points are 169.3 units, of which a capital letter is two thirds.
    assert_eq!(ops("SD1,277,2,1,4,12.0,5,0,6,0,7,4148;SS;LBI\u{3}").split(' ').next(), Some("U39.511,0"));
}

#[test]
fn the_line_type_does_not_apply_to_labels() {
    assert_eq!(label("LT2,1,1;LBL\u{3}"), "U0,120 D0,0 D80,0");
}

#[test]
fn what_makes_no_sense_is_named() {
    insta::assert_snapshot!(
        ops("SI1;SI0,1;DI0,0;DV4;LO10;LO22;DT#;LB#;CP1,1,3").replace("> ", ">\n"),
        @r"
    <line 1, column 1 (byte 0): SI lacks a width and a height and is left out>
    <line 1, column 7 (byte 6): SI with 0 is left out: it takes a width and a height that are not 0>
    <line 1, column 13 (byte 12): DI with 0 is left out: it takes a run and a rise that are not both 0>
    <line 1, column 19 (byte 18): DV with 4 is left out: it takes 0 to 3: to the right, down, to the left, up>
    <line 1, column 23 (byte 22): LO with 10 is left out: it takes a label origin: 1 to 9, 11 to 19 or 21>
    <line 1, column 28 (byte 27): LO with 22 is left out: it takes a label origin: 1 to 9, 11 to 19 or 21>
    <line 1, column 39 (byte 38): CP has 3 numbers and takes 2: the others are left out>
    U114,216
    "
    );
}
