//! Languages of cutters: the one-letter languages CAMM-GL and GP-GL, and what cutters' programs write into
//! HPGL.

use crate::shown;
use plotter_motion::hpgl::cutter::{Dialect, PlotOps, ReadOptions, plot_ops};
use plotter_motion::{PlotOp, Point};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

/// The operations of a text in steps, as `shown::ops` has them.
fn steps(text: &[u8], dialect: Dialect) -> String {
    let place = |at: Point| {
        let step = |mm: f64| (mm / dialect.step_mm() * 1e3).round() / 1e3 + 0.0;
        format!("{},{}", step(at.x), step(at.y))
    };
    let all = plot_ops(text, dialect).map(|op| match op {
        Ok(PlotOp::Travel { to }) => format!("U{}", place(to)),
        Ok(PlotOp::Draw { to, .. }) => format!("D{}", place(to)),
        Ok(PlotOp::DrawArc { centre, sweep_rad, to, .. }) => {
            format!("A{}({}){}", place(to), place(centre), (sweep_rad.to_degrees() * 1e3).round() / 1e3)
        }
        Ok(PlotOp::SelectPen { pen }) => format!("S{pen}"),
        Ok(other) => format!("{other:?}"),
        Err(error) => format!("<{error}>"),
    });
    all.collect::<Vec<_>>().join(" ")
}

/// CAMM-GL mode 1: a text, and what is drawn.
const CAMM_GL: [(&str, &str); 22] = [
    ("H\nM100,200\nD300,200,300,400\n", "U0,0 U100,200 D300,200 D300,400"),
    ("m100 200\r\nd300 200 300 400\r\n", "U100,200 D300,200 D300,400"),
    ("M100,200D300,200", "U100,200 D300,200"),
    ("M100,200;D300,200;", "U100,200 D300,200"),
    ("M10,10\nI5,0,0,5,-5,-5\nR100,0\nI1,1\n", "U10,10 D15,10 D15,15 D10,10 U110,10 D111,11"),
    ("M-.5,+1.25\n", "U-0.5,1.25"),
    ("J3\nM1,2\nD3,4\nJ0\n", "S3 U1,2 D3,4 S0"),
    ("C100,100,50,0,360\n", "U150,100 A150,100(100,100)360"),
    ("C100,100,50,0,360,5\n", "U150,100 A150,100(100,100)360"),
    ("C100,100,50\n", "U150,100 A150,100(100,100)360"),
    ("M150,100\nC100,100,50,0,-90\n", "U150,100 A100,50(100,100)-90"),
    ("C0,0,100,0,180,90\n", "U100,0 D0,100 D-100,0"),
    ("M100,0\nE50,180,270\n", "U100,0 A150,-50(150,0)90"),
    ("A100,100\nG50,90,180\n", "U100,150 A50,100(100,100)90"),
    (
        "L0\nD1,1\nL3\nB40\nD2,2\nL4\n",
        "D1,1 <line 3, column 1 (byte 8): L (line type) is not supported: its lines are drawn solid, here and below> D2,2",
    ),
    (
        "S3\nQ1\nPHi, there; D5\nD1,1\n",
        "<line 3, column 1 (byte 6): P (print letters) is not supported and is left out: have the program turn its letters into lines (D)> D1,1",
    ),
    (
        "X1,100,10\n",
        "<line 1, column 1 (byte 0): X (axis with ticks) is not supported and is left out: have the program write it as lines (D)>",
    ),
    (
        "!FS80;M1,1\n!FS90\nD2,2\n",
        "<line 1, column 1 (byte 0): ! (setting of the machine, as force, tool or speed) means nothing to a pen and is left out, here and below> U1,1 D2,2",
    ),
    (
        "^PU10,10;M1,1\n",
        "<line 1, column 1 (byte 0): ^ (command of mode 2) is not supported and is left out: have the program write one language, HPGL or this> U1,1",
    ),
    (
        "M1\nD2,2,3\n",
        "<line 1, column 1 (byte 0): M has 1 alone, which is left out: give coordinates in pairs> D2,2 <line 2, column 1 (byte 3): D has 3 alone, which is left out: give coordinates in pairs>",
    ),
    (
        "D\nC1,2\nC0,0,-5\nM1.2.3,4\nD5,5\n",
        "<line 1, column 1 (byte 0): D lacks numbers and is left out: it takes pairs of numbers> <line 2, column 1 (byte 2): C lacks numbers and is left out: it takes a centre, a radius and two angles> <line 3, column 1 (byte 7): C with -5 is left out: it takes a radius above 0> <line 4, column 2 (byte 16): M holds a malformed number, and its rest is left out: a number is like `-12` or `0.5`, from -1073741824 to 1073741824> D5,5",
    ),
    (
        "#1\nM1,1\n",
        "<line 1, column 1 (byte 0): `#` does not belong here: a command is a letter and its numbers, separated by commas> U1,1",
    ),
];

/// GP-GL, with `|` for a byte 3.
const GP_GL: [(&str, &str); 15] = [
    ("H|M100,200|D300,200,300,400|", "U0,0 U100,200 D300,200 D300,400"),
    ("HM100,200D300,200", "U0,0 U100,200 D300,200"),
    ("M10,10|E5,0,0,5|O100,0|E1,1|", "U10,10 D15,10 D15,15 U115,15 D116,16"),
    ("MP100,900|DP100,1800|OP50,0|EP50,2700|", "U0,100 D-100,0 U-50,0 D-50,-50"),
    ("J2|M1,1|", "S2 U1,1"),
    ("W100,100,50,50,0,3600|", "U150,100 A150,100(100,100)360"),
    ("W100,100,50,80,0,900,1|", "U150,100 A100,180(100,100)90"),
    ("M100,0|]50,50,1800,2700|", "U100,0 A150,-50(150,0)90"),
    ("^1000,500|M1,1|D2,2|H|", "U1001,501 D1002,502 U0,0"),
    ("BZ0,0,0,0,0,30,0,30,0|D40,0|", "D7.5,0 D22.5,0 D30,0 D40,0"),
    ("S3|I1|$1|A|V|\\0,0|Z100,100|SO0|TT|FG|M1,1|", "U1,1"),
    (
        "!10,1|!5|*2,14|FX12,1|M1,1|",
        "<line 1, column 1 (byte 0): ! (speed) means nothing to a pen and is left out, here and below> \
         <line 1, column 10 (byte 9): * (acceleration and force) means nothing to a pen and is left out, here and below> \
         <line 1, column 16 (byte 15): FX (force) means nothing to a pen and is left out, here and below> U1,1",
    ),
    (
        "PD5,5|D1,1|",
        "<line 1, column 1 (byte 0): P (print letters) is not supported and is left out: have the program turn its letters into lines (D)> D1,1",
    ),
    (
        "FZ1|D1,1|",
        "<line 1, column 1 (byte 0): FZ is no known command and is left out: check the language and the letters> D1,1",
    ),
    (
        "Y0,1,1,2,2|)0,1,1,2,2,0,0,0|N1|/0,0,900|D1,1|",
        "<line 1, column 1 (byte 0): Y (curve through places) is not supported and is left out: have the program write it as lines (D)> <line 1, column 12 (byte 11): ) (ellipse) is not supported and is left out: have the program write it as lines (D)> <line 1, column 29 (byte 28): N (mark) is not supported and is left out: have the program write it as lines (D)> <line 1, column 32 (byte 31): / (rotation of the drawing) is not supported and is left out: have the program write places as they are on the sheet> D1,1",
    ),
];

#[test]
fn the_one_letter_languages_are_drawn() {
    for (text, expected) in CAMM_GL {
        assert_eq!(steps(text.as_bytes(), Dialect::CammGl), expected, "{text:?}");
    }
    for (text, expected) in GP_GL {
        let text = text.replace('|', "\u{3}");
        let expected = if text.starts_with("BZ") {
            // A line, in as many parts as the bound of a curve asks for.
            assert!(steps(text.as_bytes(), Dialect::GpGl).ends_with("D30,0 D40,0"));
            continue;
        } else {
            expected
        };
        assert_eq!(steps(text.as_bytes(), Dialect::GpGl), expected, "{text:?}");
    }
}

#[test]
fn a_step_is_as_long_as_it_is_said_to_be() {
    let far = |options| {
        let last = PlotOps::with_options(*b"M0,0;D100,0", options).flatten().last();
        last.and_then(PlotOp::target).unwrap().x
    };
    assert_eq!(far(ReadOptions::for_dialect(Dialect::CammGl)), 2.5);
    assert_eq!(far(ReadOptions::for_dialect(Dialect::GpGl)), 10.0);
    assert_eq!(far(ReadOptions::for_dialect(Dialect::Silhouette)), 5.0);
    let mut coarse = ReadOptions::for_dialect(Dialect::CammGl);
    coarse.step_mm = 0.01;
    assert_eq!(far(coarse), 1.0);
}

#[test]
fn the_language_is_told_by_what_a_text_begins_with() {
    let told = |text: &[u8]| Dialect::detect(text).map(|(dialect, _)| dialect);
    for (text, expected) in [
        (&b"H\nM100,100\nD200,200\n"[..], Some(Dialect::CammGl)),
        (b"J1\r\nM100,100\r\nI200,200,300,300\r\n", Some(Dialect::CammGl)),
        (b"H\x03M100,100\x03D200,200\x03", Some(Dialect::GpGl)),
        (b"M100,100\nE200,200\nO5,5\nE7,7\n", Some(Dialect::GpGl)),
        (b"\x1b\x04\x1b\x05TT\x03FW100\x03M100,100\x03D200,200\x03", Some(Dialect::Silhouette)),
        (b"IN;SP1;PU100,100;PD200,200;PA300,300;", None),
        (b"G21\nG90\nG0 X10 Y10\nG1 X20 Y20 F600\nM3 S90\nG1 X30\n", None),
        (b"Dear plotter,\nMy pen is dry. I need ink.\nHow are you? Do draw me a house.\n", None),
        (b"<svg><path d='M1,1 D2,2'/></svg>", None),
        (b"", None),
    ] {
        assert_eq!(told(text), expected, "{:?}", String::from_utf8_lossy(text));
    }
}

#[test]
fn what_cutters_are_told_in_hpgl_is_named_once() {
    insta::assert_snapshot!(
        shown::ops("\u{3}IN;!ST1;!FS80;FS9;PU1,1;!FS90;FS10;PD2,2;FC18,1,1;FD90;FC18;!XY7;!;!10,1;PU;!PG;@@@\u{3}").replace("> ", ">\n"),
        @r"
    <line 1, column 1 (byte 0): byte 0x03 (end of a command in GP-GL) is for cutters and means nothing to a pen: it is left out, here and below>
    <line 1, column 5 (byte 4): !ST (choice of the tool) is for cutters and means nothing to a pen: it is left out, here and below>
    <line 1, column 10 (byte 9): !FS (force) is for cutters and means nothing to a pen: it is left out, here and below>
    <line 1, column 16 (byte 15): FS (pen force select) is not supported and is left out>
    U1,1 D2,2 <line 1, column 43 (byte 42): FC (blade offset of a cutter) is not supported and is left out>
    <line 1, column 52 (byte 51): FD (blade rotation of a cutter) is not supported and is left out>
    <line 1, column 62 (byte 61): !XY (a cutter's own command) is for cutters and means nothing to a pen: it is left out, here and below>
    <line 1, column 78 (byte 77): !PG (feed of the sheet behind the drawing) is for cutters and means nothing to a pen: it is left out, here and below>
    <line 1, column 82 (byte 81): @ (end of a job in DM/PL) is for cutters and means nothing to a pen: it is left out, here and below>
    U2,2
    "
    );
}

proptest! {
    #[test]
    fn any_text_of_a_cutter_is_read_to_its_end(text in vec(select(&b"HMDIREOCAGWJPLBZ^!*]),;.-0159 \x03\n\x1bqxF"[..]), 0..200)) {
        for dialect in [Dialect::CammGl, Dialect::GpGl, Dialect::Silhouette] {
            let mut outcomes = 0;
            for outcome in plot_ops(&text, dialect) {
                match outcome {
                    Ok(op) => prop_assert!(op.target().is_none_or(Point::is_finite), "{op:?}"),
                    Err(error) => prop_assert!(error.at.offset <= text.len() as u64 && !error.to_string().is_empty()),
                }
                outcomes += 1;
            }
            // At most a curve's lines, or a circle's chords, for each byte.
            prop_assert!(outcomes <= 4100 * (text.len() + 1));
        }
        let _ = Dialect::detect(&text);
    }

    #[test]
    fn any_data_without_an_end_are_read(text in vec(select(&b"PEUDASPGMINLT<=:>7?;,.-0159\xc1\xbf\xc3\x1b% "[..]), 0..100)) {
        let mut text = text;
        text.splice(0..0, *b"PDPE");
        for outcome in plotter_motion::hpgl::plot_ops(&text).take(20_000) {
            match outcome {
                Ok(op) => prop_assert!(op.target().is_none_or(Point::is_finite), "{op:?}"),
                Err(error) => prop_assert!(error.position().offset <= text.len() as u64),
            }
        }
    }
}
