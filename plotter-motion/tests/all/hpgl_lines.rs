//! How lines look and bend: line types, arcs through places, ellipses, curves, ticks and encoded data.

use crate::shown;

use plotter_motion::hpgl::{Interpreter, PlotOps, ReadOptions, plot_ops};
use plotter_motion::{PlotOp, Point};
use shown::ops;

/// P1 to P2 is 5000 units, of which a line pattern is 4 %: 200 units.
const FRAME: &str = "IP0,0,4000,3000;";

fn lines(text: &str) -> String {
    ops(&format!("{FRAME}{text}"))
}

#[test]
fn the_line_types_of_hp_gl_2_are_these() {
    // Percent of 200 units: 50 50, 70 30, 80 10 0 10, 70 10 10 10, 50 and four times 10 10
    assert_eq!(lines("LT2;PD500,0"), "D100,0 U200,0 D300,0 U400,0 D500,0");
    assert_eq!(lines("LT3;PD300,0"), "D140,0 U200,0 D300,0");
    assert_eq!(lines("LT4;PD200,0"), "D160,0 U180,0 D180,0");
    assert_eq!(lines("LT5;PD200,0"), "D140,0 U160,0 D180,0");
    assert_eq!(lines("LT6;PD200,0"), "D100,0 U120,0 D140,0 U160,0 D180,0");
    assert_eq!(lines("LT1;PD300,0"), "D0,0 U200,0 D200,0");
    assert_eq!(lines("LT2;PD100,0;LT;PD200,0;LT99;PD400,0"), "D100,0 D200,0 D300,0");
}

#[test]
fn a_pattern_has_the_length_it_is_given_and_keeps_it() {
    assert_eq!(lines("LT2,2;PD200,0"), "D50,0 U100,0 D150,0");
    assert_eq!(lines("LT2,10,1;PD500,0;PU0,0;LT3;PD400,0"), "D200,0 U400,0 D500,0 U0,0 D280,0");
}

#[test]
fn a_pattern_goes_round_corners_and_begins_anew_with_each_stroke() {
    assert_eq!(lines("LT2;PD50,0,50,100;PU0,0;PD100,0"), "D50,0 D50,50 U0,0 D100,0");
}

#[test]
fn fitted_patterns_begin_and_end_with_half_a_dash() {
    // 500 units, three patterns of 166.7: 25 50 25 % of each
    assert_eq!(lines("LT-2;PD500,0"), "D41.667,0 U125,0 D208.333,0 U291.667,0 D375,0 U458.333,0 D500,0");
}

#[test]
fn line_type_0_marks_only_the_ends() {
    assert_eq!(lines("LT0;PD500,0,500,300"), "U500,0 D500,0 U500,300 D500,300");
}

#[test]
fn a_pattern_of_ones_own_is_taken_in_parts_of_its_sum() {
    assert_eq!(lines("UL3,1,1,2,4;LT3;PD200,0"), "D25,0 U50,0 D100,0");
    assert_eq!(lines("UL3,1,1;UL3;LT3;PD200,0"), "D140,0");
    assert_eq!(
        ops("UL9,1;UL1,-1;LT9;LT1,-1"),
        "<line 1, column 3 (byte 2): UL with 9 is left out: it takes the number of a line type, 1 to 8> \
         <line 1, column 11 (byte 10): UL with -1 is left out: it takes up to 20 lengths, none below 0 and not all 0> \
         <line 1, column 16 (byte 15): LT with 9 is left out: it takes a line type from -8 to 8, or 99 for the one before> \
         <line 1, column 22 (byte 21): LT with -1 is left out: it takes a length above 0>"
    );
}

#[test]
fn an_arc_has_the_pattern_too() {
    // A quarter of a circle of 200 / (pi / 2) units radius is one pattern long: half of it is drawn.
    let text = format!("{FRAME}LT2;PU127.3239545,0;PD;AA0,0,90");
    assert_eq!(ops(&text), "U127.324,0 A90.032,90.032(0,0)45");
}

#[test]
fn arcs_through_places_go_the_way_of_the_middle() {
    assert_eq!(ops("PU100,0;PD;AT0,100,-100,0"), "U100,0 A-100,0(0,0)180");
    assert_eq!(ops("PU100,0;PD;AT0,-100,0,100"), "U100,0 A0,100(0,0)-270");
    assert_eq!(ops("PU100,0;PD;RT-100,100,-200,0;PU0,0"), "U100,0 A-100,0(0,0)180 U0,0");
    // Back to the start: a circle. On a line: lines.
    assert_eq!(ops("PU100,0;PD;AT-100,0,100,0"), "U100,0 A100,0(0,0)360");
    assert_eq!(ops("PU0,0;PD;AT1,1,2,2"), "U0,0 D1,1 D2,2");
    assert_eq!(ops("PU100,0;AT0,100,-100,0;PD0,0"), "U100,0 U-100,0 D0,0");
    assert_eq!(
        ops("AT1,2,3"),
        "<line 1, column 1 (byte 0): AT lacks a place on the arc and its end and is left out>"
    );
}

#[test]
fn a_scale_that_is_not_alike_both_ways_makes_ellipses() {
    let text = b"IP0,0,1000,2000;SC0,10,0,10;PU5,5;CI2,90;CI2";
    assert!(
        ops("IP0,0,1000,2000;SC0,10,0,10;PU5,5;CI2,90")
            .ends_with("U700,1000 D500,1400 D300,1000 D500,600 D700,1000 U500,1000")
    );
    // Without an angle, within a hundredth of a mm of the ellipse with the half axes 200 and 400 units
    let drawn: Vec<Point> = plot_ops(text)
        .skip(7)
        .flatten()
        .filter(|op| matches!(op, PlotOp::Draw { .. }))
        .filter_map(PlotOp::target)
        .collect();
    assert!(drawn.len() > 72);
    for at in drawn {
        let (x, y) = (at.x * 40.0 - 500.0, at.y * 40.0 - 1000.0);
        assert!(((x / 200.0).powi(2) + (y / 400.0).powi(2) - 1.0).abs() < 1e-9);
    }
    // Mirrored, the arc runs the other way on the sheet.
    assert_eq!(ops("IP0,0,100,100;SC10,0,0,10;PU5,5;PD;AR-2,0,90"), "U50,50 A70,70(70,50)-90");
}

#[test]
fn curves_are_lines_within_the_tolerance() {
    let options = ReadOptions { tolerance_mm: 0.25, ..ReadOptions::default() };
    let text = b"PD;BZ0,400,400,400,400,0,400,-400,800,-400,800,0;PU;BR1,1,2,2,10,0";
    let interpreter: Interpreter = Interpreter::with_options(options);
    let drawn: Vec<Point> = PlotOps::with_interpreter(text.iter().copied(), interpreter)
        .flatten()
        .filter_map(PlotOp::target)
        .collect();
    // Second differences of 400 √2 units for a tolerance of 10: n = √(0.75 · 566 / 10) = 6.5, two curves of 7
    // lines
    assert_eq!(drawn.len(), 7 + 7 + 1);
    assert_eq!(
        (drawn[6], drawn[13], drawn[14]),
        (Point::new(10.0, 0.0), Point::new(20.0, 0.0), Point::new(20.25, 0.0))
    );
    assert_eq!(
        ops("BZ1,2,3"),
        "<line 1, column 1 (byte 0): BZ lacks three places for each curve and is left out>"
    );
}

#[test]
fn ticks_are_percent_of_p1_to_p2() {
    // 0.5 % of 3000 and of 4000 units to both sides; then 1 % and 2 %; then only one side
    assert_eq!(lines("PU1000,1000;XT;YT"), "U1000,1000 U1000,985 D1000,1015 U980,1000 D1020,1000");
    assert_eq!(
        lines("PU1000,1000;TL1,2;XT;TL1;YT;PD0,0"),
        "U1000,1000 U1000,940 D1000,1030 U1000,1000 D1040,1000 U1000,1000 D0,0"
    );
}

#[test]
fn encoded_data_are_a_polyline() {
    // 5-bit digits: `7`, pen up to (200, 100) absolute (400: 16 + 12 · 32; 200: 8 + 6 · 32), then 10 right
    // and 10 down
    assert_eq!(ops("PE7<=OkGest;PA0,0"), ops("PU200,100;PD210,90;PA0,0"));
    assert_eq!(ops("PE7:a<=OkGe;"), "S1 U200,100");
    assert_eq!(
        ops("PE7O;PE!;PE7s;PU1,1"),
        "<line 1, column 1 (byte 0): PE lacks the last byte of its last number and is left out> \
         <line 1, column 8 (byte 7): `!` does not belong into PE, whose rest is left out: its data are digits from `?` on \
         and the flags `<`, `=`, `>`, `:` and `7`; end them with `;`> \
         <line 1, column 10 (byte 9): PE has an x of 10 without a y, which is left out: give coordinates in pairs> U1,1"
    );
}
