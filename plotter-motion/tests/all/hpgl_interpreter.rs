//! The interpreter of HPGL: command by command, in plotter units.

use plotter_motion::hpgl::{Error, Interpreter, Reader, UNITS_PER_MM, Undrained, plot_ops};
use plotter_motion::{PlotOp, Point};

/// Operations in short, in plotter units: `U` travel, `D` draw, `S` pen, `N` page; errors in `<>`.
fn ops(text: &str) -> String {
    let shown: Vec<String> = plot_ops(text.as_bytes())
        .map(|op| match op {
            Ok(PlotOp::Travel { to }) => format!("U{},{}", to.x * UNITS_PER_MM, to.y * UNITS_PER_MM),
            Ok(PlotOp::Draw { to, feed_mm_s }) => {
                let feed = feed_mm_s.map_or_else(String::new, |feed| format!("@{feed}"));
                format!("D{},{}{feed}", to.x * UNITS_PER_MM, to.y * UNITS_PER_MM)
            }
            Ok(PlotOp::SelectPen { pen }) => format!("S{pen}"),
            Ok(PlotOp::NewPage) => "N".to_string(),
            Ok(other) => format!("{other:?}"),
            Err(error) => format!("<{error}>"),
        })
        .collect();
    shown.join(" ")
}

#[test]
fn the_pen_and_the_kind_of_coordinates_last_across_commands() {
    assert_eq!(ops("PA10,10;PD;PA20,10,30,10;PU;PA0,0;"), "U10,10 D20,10 D30,10 U0,0");
    assert_eq!(ops("PU10,10;PR;PD5,0,0,5;PA;PD1,2;PR3,3;PU1,1"), "U10,10 D15,10 D15,15 D1,2 D4,5 U5,6");
    assert_eq!(ops("PUPA10 10PDPA20 10"), "U10,10 D20,10");
}

#[test]
fn a_pen_lowered_and_lifted_leaves_a_dot() {
    assert_eq!(ops("PU5,5;PD;PU;"), "U5,5 D5,5 U5,5");
    assert_eq!(ops("PU5,5;PD;PD;PU9,9;"), "U5,5 D5,5 U9,9");
    assert_eq!(ops("PD5,5,5,5;PU;PU;PD"), "D5,5 D5,5 D5,5");
    assert_eq!(ops("PD5,5;PD;PU;"), "D5,5 U5,5");
    assert_eq!(ops("PU5,5;PD;SP2;PU;"), "U5,5 D5,5 S2");
}

#[test]
fn speed_holds_until_it_is_changed_or_the_plotter_initialized() {
    assert_eq!(ops("PD;VS2;PA1,0;VS2.5;PA2,0;VS;PA3,0"), "D1,0@20 D2,0@25 D3,0");
    assert_eq!(ops("VS2;DF;PD1,0;IN;PD2,0"), "D1,0@20 D2,0");
    // A second number gives the speed to one pen only.
    assert_eq!(ops("VS3,2;SP1;PD1,0;SP2;PD2,0;SP9;VS4;PD3,0"), "S1 D1,0 S2 D2,0@30 S9 D3,0@40");
}

#[test]
fn initializing_lifts_the_pen_where_it_stands() {
    assert_eq!(ops("PD7,7;PR;IN;PA8,8;PD9,9"), "D7,7 U8,8 D9,9");
    assert_eq!(ops("PD7,7;PR;DF;PA8,8"), "D7,7 D8,8");
}

#[test]
fn a_circle_starts_and_ends_right_of_its_centre() {
    assert_eq!(ops("PU100,50;CI40,90;"), "U100,50 U140,50 D100,90 D60,50 D100,10 D140,50 U100,50");
    assert_eq!(ops("PU100,50;CI-40,180;"), "U100,50 U60,50 D140,50 D60,50 U100,50");
}

#[test]
fn a_circle_leaves_the_pen_as_it_was() {
    assert_eq!(ops("PD10,0;CI5,180;PA20,0"), "D10,0 U15,0 D5,0 D15,0 U10,0 D20,0");
    assert_eq!(ops("PD;CI5,180;PU"), "D0,0 U5,0 D-5,0 D5,0 U0,0");
    assert_eq!(ops("CI5,180;PA20,0"), "U5,0 D-5,0 D5,0 U0,0 U20,0");
}

#[test]
fn a_circle_is_an_arc_unless_it_asks_for_chords_and_then_has_as_many() {
    let count = |text: &[u8], arcs: bool| {
        let is_arc = |op: &PlotOp| matches!(op, PlotOp::DrawArc { .. });
        let is_line = |op: &PlotOp| matches!(op, PlotOp::Draw { .. });
        plot_ops(text).flatten().filter(|op| if arcs { is_arc(op) } else { is_line(op) }).count()
    };
    // 5 degrees are what a plotter takes that knows no arcs: up to there, an arc is meant.
    for round in ["CI400", "CI400,5", "CI400,0", "CI-400,-1", "PD;CI400,0.5"] {
        assert_eq!(count(round.as_bytes(), true), 1, "{round}");
    }
    assert_eq!((count(b"CI400,7", false), count(b"CI400,7", true)), (52, 0));
    assert_eq!(count(b"CI400,-10", false), 36);
    assert_eq!(count(b"CI400,60", false), 6);
    assert_eq!(count(b"CI0", false), 1);
    // A distance of chords instead: 1 - cos(30 degrees) of the radius is a chord angle of 60 degrees.
    assert_eq!(count(b"CT1;CI1000,133.97", false), 7);
    assert_eq!(count(b"CT1;CI1000,133.98", false), 6);
    assert_eq!(count(b"CT1;CI1000,0.9", true), 1);
}

#[test]
fn a_whole_circle_is_one_arc_from_the_right() {
    let ops: Vec<PlotOp> = plot_ops(b"PU100,50;CI-40").flatten().collect();
    let (centre, rim) = (Point::new(2.5, 1.25), Point::new(1.5, 1.25));
    assert_eq!(
        ops[1..],
        [
            PlotOp::Travel { to: rim },
            PlotOp::DrawArc { centre, sweep_rad: std::f64::consts::TAU, to: rim, feed_mm_s: None },
            PlotOp::Travel { to: centre },
        ]
    );
}

#[test]
fn an_arc_goes_from_where_the_pen_stands_and_leaves_it_at_its_end() {
    let rounded = |text: &str| -> String {
        let shown = plot_ops(text.as_bytes()).map(|op| match op {
            Ok(op) => {
                let to = op.target().unwrap_or_default();
                let pen = if matches!(op, PlotOp::Draw { .. }) { "D" } else { "U" };
                format!("{pen}{:.1},{:.1}", to.x * UNITS_PER_MM + 0.01, to.y * UNITS_PER_MM + 0.01)
            }
            Err(error) => format!("<{error}>"),
        });
        shown.collect::<Vec<_>>().join(" ")
    };
    assert_eq!(rounded("PU100,0;PD;AA0,0,90,45;PD5,5"), "U100.0,0.0 D70.7,70.7 D0.0,100.0 D5.0,5.0");
    // Clockwise, about a centre given from the pen, and with the pen up straight to the end.
    assert_eq!(rounded("PU100,0;PD;AR-100,0,-180,90"), "U100.0,0.0 D0.0,-100.0 D-100.0,0.0");
    assert_eq!(rounded("PU100,0;AA0,0,90;PR;PD1,1"), "U100.0,0.0 U0.0,100.0 D1.0,101.0");
    assert_eq!(
        rounded("AA1,2;AA1,2,400;AA1,2,3,200"),
        "<line 1, column 1 (byte 0): AA lacks the centre's x and y and an angle and is left out> \
         <line 1, column 13 (byte 12): AA with 400 is left out: it takes an angle of at most 360 degrees> \
         <line 1, column 25 (byte 24): AA with 200 is left out: it takes a chord angle of at most 180 degrees>"
    );
}

#[test]
fn what_a_cutter_is_told_is_a_notice() {
    let text = b"TB26,0,3000,2000;IN;FC18,1,1;FD90;PU1,1;PD2,2;PU;PG;@@";
    let said: Vec<_> = plot_ops(text).filter_map(Result::err).collect();
    assert!(said.len() == 4 && said.iter().all(Error::is_notice), "{said:?}");
    assert_eq!(
        said[1].to_string(),
        "line 1, column 21 (byte 20): FC (blade offset of a cutter) is not supported and is left out"
    );
}

#[test]
fn what_is_not_carried_out_is_reported_and_the_rest_is_drawn() {
    insta::assert_snapshot!(
        ops("IN;RP2;NR;OE;NP8;PD1,1;ZZ1;PD2,2,3;SP300;SP1,2;VS-1;VS1,9;VS1,2,3;CI;CI5,200;PG;").replace("> ", ">\n"),
        @r#"
    <line 1, column 4 (byte 3): RP (replot) is not supported and is left out>
    <line 1, column 8 (byte 7): NR (not ready) is not supported and is left out>
    D1,1 <line 1, column 24 (byte 23): ZZ is no known command and is left out: check its two letters>
    D2,2 <line 1, column 34 (byte 33): PD has an x of 3 without a y, which is left out: give coordinates in pairs>
    <line 1, column 38 (byte 37): SP with 300 is left out: it takes a whole pen number from 0 to 255>
    <line 1, column 42 (byte 41): SP has 2 numbers and takes 1: the others are left out>
    S1 <line 1, column 50 (byte 49): VS with -1 is left out: it takes a speed above 0 cm/s>
    <line 1, column 57 (byte 56): VS with 9 is left out: it takes a whole pen number from 1 to 8 as its second number>
    <line 1, column 59 (byte 58): VS has 3 numbers and takes 2: the others are left out>
    <line 1, column 67 (byte 66): CI lacks a radius in plotter units and is left out>
    <line 1, column 74 (byte 73): CI with 200 is left out: it takes a chord angle of at most 180 degrees>
    N
    "#
    );
}

#[test]
fn a_reading_error_ends_the_command_but_not_the_drawing() {
    assert_eq!(
        ops("PU1,1;PD2,2,:3,3;PD4,4"),
        "U1,1 D2,2 <line 1, column 13 (byte 12): `:` does not belong into PD, whose rest is left out: separate \
         numbers by commas and end the command with `;`> D4,4"
    );
}

#[test]
fn an_event_is_refused_while_operations_wait() {
    let (mut reader, mut interpreter) = (Reader::new(), Interpreter::new());
    for byte in *b"CI5,180;PU" {
        if let Some(event) = reader.push(byte) {
            let waiting = byte == b'U';
            assert_eq!(interpreter.push(event).is_err(), waiting);
        }
    }
    assert_eq!(interpreter.finish(), Err(Undrained));
    while interpreter.next_op().is_some() {}
    assert_eq!(interpreter.finish(), Ok(()));
}

#[test]
fn a_printers_reset_and_a_new_plot_start_afresh() {
    assert_eq!(ops("\u{1b}%0BSC0,1,0,1,2;PR;\u{1b}E\u{1b}%0BPU1,2"), "U1,2");
    // A new plot is a new sheet where something has been drawn.
    assert_eq!(ops("BP;IN;PD1,0;BP;PU2,0;BP;"), "D1,0 N U2,0");
}

#[test]
fn what_another_language_says_is_not_drawn() {
    assert_eq!(ops("\u{1b}E\u{1b}&l1O\u{1b}%0BPD1,0;\u{1b}%0APD2,0;LBx\u{1b}%0BPD3,0"), "D1,0 D3,0");
}

#[test]
fn defaults_leave_p1_the_turn_and_the_pen() {
    assert_eq!(ops("IP0,0,100,100;RO90;SC0,1,0,1;PD;DF;PA1,0;SC0,1,0,1;PA1,0"), "D0,1 D0,100");
}

#[test]
fn encoded_data_that_became_letters_are_read_as_they_were() {
    // 728, 338 and 106 to the right, in digits of six bits: gnuplot's, as a text editor's Latin-1 or UTF-8
    // has them
    let whole = b"PE<=o\xD5c\xC9S\xC2\xBF;";
    let letters: String = whole.iter().map(|byte| char::from(*byte)).collect();
    let drawn = |text: &[u8]| plot_ops(text).collect::<Result<Vec<_>, _>>().unwrap();
    assert_eq!(drawn(whole).len(), 2);
    assert_eq!(drawn(letters.as_bytes()), drawn(whole));
}

#[test]
fn strictly_the_first_error_is_the_last_outcome() {
    let text = b"PU1,1;RP2;CI;PD2,2;XX";
    let outcomes: Vec<bool> = plot_ops(text).strict().map(|outcome| outcome.is_ok()).collect();
    assert_eq!(outcomes, [true, false, false]); // a travel, a notice, and the circle without a radius
    assert_eq!(plot_ops(text).filter(Result::is_err).count(), 3);
}

#[cfg(not(feature = "font"))]
#[test]
fn without_the_font_labels_are_reported_and_never_read_as_commands() {
    assert_eq!(
        ops("LBPD9,9;\u{3}SM*;PU1,1;"),
        "<line 1, column 1 (byte 0): LB (label) is not supported and is left out> \
         <line 1, column 10 (byte 9): SM (symbol mode) is not supported and is left out> U1,1"
    );
}
