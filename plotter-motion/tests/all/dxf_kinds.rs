//! Each kind of entity in a DXF file, and each kind of bad input, a row each.

use plotter_motion::dxf::{Drawing, Pens, ReadOptions};
use plotter_motion::{PlotOp, Vec2};
use std::fmt::Write as _;

/// A file: `KIND code=value code=value …` a line, sections as `[NAME]`; the rest is in millimetres.
fn file(short: &str) -> String {
    let mut text = String::from("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n");
    let mut is_open = false;
    let mut section = |text: &mut String, name: &str| {
        if std::mem::replace(&mut is_open, !name.is_empty()) {
            text.push_str("0\nENDSEC\n");
        }
        if !name.is_empty() {
            let _ = write!(text, "0\nSECTION\n2\n{name}\n");
        }
    };
    if !short.trim_start().starts_with('[') {
        section(&mut text, "ENTITIES");
    }
    for line in short.lines().map(str::trim).filter(|line| !line.is_empty()) {
        if let Some(name) = line.strip_prefix('[') {
            section(&mut text, name.trim_end_matches(']'));
            continue;
        }
        let (kind, rest) = line.split_once(' ').unwrap_or((line, ""));
        let _ = write!(text, "0\n{kind}\n");
        for group in rest.split(" ") {
            if let Some((code, value)) = group.split_once('=') {
                let _ = write!(text, "{code}\n{}\n", value.replace('_', " "));
            }
        }
    }
    section(&mut text, "");
    text.push_str("0\nEOF\n");
    text
}

fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// Operations in short: `t` travels, `d` draws, `a` draws an arc of so many degrees, `p` takes a pen.
fn short(op: PlotOp) -> String {
    match op {
        PlotOp::Travel { to } => format!("t{},{}", number(to.x), number(to.y)),
        PlotOp::Draw { to, .. } => format!("d{},{}", number(to.x), number(to.y)),
        PlotOp::DrawArc { sweep_rad, to, .. } => {
            format!("a{}:{},{}", number(sweep_rad.to_degrees()), number(to.x), number(to.y))
        }
        PlotOp::SelectPen { pen } => format!("p{pen}"),
        other => format!("{other:?}"),
    }
}

fn read_with(text: &[u8], options: ReadOptions) -> (String, Vec<String>) {
    let drawing = Drawing::read(text.iter().copied()).unwrap();
    let (mut ops, mut said) = (Vec::new(), Vec::new());
    for item in drawing.plot_ops(options) {
        match item {
            Ok(op) => ops.push(short(op)),
            Err(error) => said.push(error.to_string()),
        }
    }
    (ops.join(" "), said)
}

fn read(body: &str) -> (String, Vec<String>) {
    read_with(file(body).as_bytes(), ReadOptions::default())
}

#[test]
fn every_kind_of_entity() {
    let rows = [
        ("line", "LINE 10=1 20=2 11=5 21=2", "p1 t1,2 d5,2"),
        ("line in space", "LINE 10=1 20=2 30=9 11=5 21=2 31=3", "p1 t1,2 d5,2"),
        ("point", "POINT 10=3 20=4", "p1 t3,4 d3,4"),
        ("circle", "CIRCLE 10=5 20=5 40=2", "p1 t7,5 a360:7,5"),
        ("arc through 0°", "ARC 10=0 20=0 40=10 50=270 51=90", "p1 t0,-10 a180:0,10"),
        (
            "arc from below is mirrored",
            "ARC 10=0 20=0 40=10 50=0 51=90 230=-1 210=0 220=0",
            "p1 t-10,0 a-90:0,10",
        ),
        ("whole ellipse that is a circle", "ELLIPSE 10=5 20=5 11=3 21=0 40=1", "p1 t8,5 a360:8,5"),
        ("polyline", "LWPOLYLINE 70=0 10=0 20=0 10=4 20=0 10=4 20=3", "p1 t0,0 d4,0 d4,3"),
        (
            "closed, with a bulge",
            "LWPOLYLINE 70=1 10=0 20=0 42=1 10=4 20=0 10=4 20=3",
            "p1 t0,0 a180:4,0 d4,3 d0,0",
        ),
        (
            "polyline of release 12",
            "POLYLINE 66=1 70=0 \n VERTEX 10=0 20=0 42=-1 \n VERTEX 10=4 20=0 \n VERTEX 10=4 20=3 \n SEQEND",
            "p1 t0,0 a-180:4,0 d4,3",
        ),
        (
            "points of a fitted curve that are no part of it",
            "POLYLINE 66=1 70=4 \n VERTEX 10=9 20=9 70=16 \n VERTEX 10=0 20=0 70=8 \n VERTEX 10=4 20=0 70=8 \n SEQEND",
            "p1 t0,0 d4,0",
        ),
        (
            "net",
            "POLYLINE 70=16 71=2 72=2 \n VERTEX 10=0 20=0 70=64 \n VERTEX 10=1 20=0 70=64 \n VERTEX 10=0 20=1 70=64 \n VERTEX 10=1 20=1 70=64 \n SEQEND",
            "p1 t0,0 d0,1 t0,0 d1,0 t1,0 d1,1 t0,1 d1,1",
        ),
        (
            "faces, of which one edge is hidden",
            "POLYLINE 70=64 \n VERTEX 10=0 20=0 70=192 \n VERTEX 10=1 20=0 70=192 \n VERTEX 10=1 20=1 70=192 \n VERTEX 70=128 71=1 72=-2 73=3 \n SEQEND",
            "p1 t0,0 d1,0 t1,1 d0,0",
        ),
        ("straight spline", "SPLINE 71=1 40=0 40=0 40=1 40=1 10=0 20=0 10=5 20=5", "p1 t0,0 d5,5"),
        ("spline through places", "SPLINE 71=3 11=0 21=0 11=2 21=2", "p1 t0,0 d2,2"),
        (
            "solid, whose corners are crossed",
            "SOLID 10=0 20=0 11=4 21=0 12=0 22=4 13=4 23=4",
            "p1 t0,0 d4,0 d4,4 d0,4 d0,0",
        ),
        (
            "face with a hidden edge",
            "3DFACE 10=0 20=0 11=4 21=0 12=4 22=4 13=0 23=4 70=2",
            "p1 t0,0 d4,0 t4,4 d0,4 t0,4 d0,0",
        ),
        ("leader", "LEADER 10=0 20=0 10=4 20=0 10=4 20=3", "p1 t0,0 d4,0 d4,3"),
        ("text", "TEXT 10=2 20=3 40=12 1=L", "p1 t2,15 d2,3 d10,3"),
        (
            "text, turned and centred",
            "TEXT 10=0 20=0 40=12 1=L 50=90 72=4 11=10 21=10",
            "p1 t4,6 d16,6 d16,14",
        ),
        ("text, upside down", "TEXT 10=0 20=0 40=12 1=L 71=4", "p1 t0,-12 d0,0 d8,0"),
        ("text of lines", "MTEXT 10=0 20=0 40=12 71=1 1=L\\PL", "p1 t0,0 d0,-12 d8,-12 t0,-20 d0,-32 d8,-32"),
        ("attribute", "ATTRIB 10=0 20=0 40=12 1=L", "p1 t0,12 d0,0 d8,0"),
        (
            "hidden attribute, and its definition",
            "ATTRIB 10=0 20=0 40=12 1=L 70=1 \n ATTDEF 10=0 20=0 40=12 1=L 2=T",
            "",
        ),
        (
            "hatch of lines",
            "HATCH 30=0 70=0 91=1 92=2 72=0 73=1 93=4 10=0 20=0 10=4 20=0 10=4 20=2 10=0 20=2 97=0 75=0 76=1 78=1 53=0 43=0 44=1 45=0 46=2 79=0 98=0",
            "p1 t0,1 d4,1",
        ),
        (
            "hatch of dashes in a circle by edges",
            "HATCH 70=0 91=1 92=1 93=1 72=2 10=0 20=0 40=2 50=0 51=360 73=1 97=0 75=0 76=1 78=1 53=0 43=0 44=0 45=0 46=9 79=2 49=1 49=-1 98=0",
            "p1 t-2,0 d-1,0 t0,0 d1,0",
        ),
        (
            "dashes",
            "[TABLES]\nLTYPE 2=DASHED 49=2 49=-1\n[ENTITIES]\nLINE 6=Dashed 10=0 20=0 11=9 21=0",
            "p1 t0,0 d2.5,0 t3.5,0 d5.5,0 t6.5,0 d9,0",
        ),
    ];
    for (name, body, expected) in rows {
        let (ops, said) = read(body);
        assert_eq!(ops, expected, "{name}");
        assert_eq!(said, Vec::<String>::new(), "{name}");
    }
}

#[test]
fn blocks_lie_where_they_are_put() {
    let blocks = "[BLOCKS]\nBLOCK 2=A 10=1 20=1\nLINE 10=1 20=1 11=3 21=1\nCIRCLE 10=1 20=1 40=1\nENDBLK\n\
                  BLOCK 2=B 10=0 20=0\nINSERT 2=a 10=5 20=0 50=90\nENDBLK\nBLOCK 2=*D1 10=0 20=0\nLINE 10=0 20=0 11=7 21=0\nENDBLK\n\
                  BLOCK 2=SELF 10=0 20=0\nLINE 10=0 20=0 11=1 21=0\nINSERT 2=SELF 10=1 20=0\nENDBLK\n[ENTITIES]\n";
    let rows = [
        ("at its base", "INSERT 2=A 10=0 20=0", "p1 t0,0 d2,0 t1,0 a360:1,0"),
        ("larger and turned", "INSERT 2=A 10=0 20=0 41=2 42=2 50=90", "p1 t0,0 d0,4 t0,2 a360:0,2"),
        ("mirrored", "INSERT 2=A 10=0 20=0 41=-1 42=1", "p1 t0,0 d-2,0 t-1,0 a-360:-1,0"),
        ("in a block", "INSERT 2=B 10=1 20=1", "p1 t6,1 d6,3 t6,2 a360:6,2"),
        (
            "rows and columns",
            "INSERT 2=*D1 10=0 20=0 70=2 71=2 44=10 45=5",
            "p1 t0,0 d7,0 t10,0 d17,0 t0,5 d7,5 t10,5 d17,5",
        ),
        ("dimension", "DIMENSION 2=*D1 10=50 20=50 70=0", "p1 t0,0 d7,0"),
    ];
    for (name, body, expected) in rows {
        let (ops, said) = read(&format!("{blocks}{body}"));
        assert_eq!((ops.as_str(), said.len()), (expected, 0), "{name}: {said:?}");
    }
    // A circle that is stretched is chords within the tolerance.
    let (ops, _) = read(&format!("{blocks}INSERT 2=A 10=0 20=0 41=10 42=1"));
    assert!(ops.matches('d').count() > 30 && !ops.contains('a'), "{ops}");
    let (ops, said) = read(&format!("{blocks}INSERT 2=SELF 10=0 20=0"));
    assert_eq!(ops.matches('d').count(), 32);
    assert_eq!(said.len(), 1);
    assert!(
        said[0].contains("the block `SELF` is left out: blocks lie in each other more than 32 deep"),
        "{said:?}"
    );
    let (ops, said) =
        read(&format!("{blocks}INSERT 2=NONE 10=0 20=0\nINSERT 2=NONE 10=0 20=0\nLINE 10=0 20=0 11=1 21=0"));
    assert_eq!(ops, "p1 t0,0 d1,0");
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("the block `NONE` is not in the file"), "{said:?}");
}

#[test]
fn layers_are_pens_and_hidden_ones_are_told() {
    let tables = "[TABLES]\nLAYER 2=7_cut 62=1 70=0\nLAYER 2=mark 62=5 70=0\nLAYER 2=off 62=-3 70=0\nLAYER 2=ice 62=3 70=1\n\
                  LAYER 2=Defpoints 62=7 70=0\n[BLOCKS]\nBLOCK 2=A 10=0 20=0\nLINE 8=0 10=0 20=0 11=1 21=0\nLINE 8=mark 10=0 20=1 11=1 21=1\nENDBLK\n[ENTITIES]\n";
    let body = "LINE 8=mark 10=0 20=0 11=1 21=0\nLINE 8=7_cut 10=0 20=0 11=2 21=0\nLINE 8=MARK 10=0 20=0 11=3 21=0\n\
                LINE 8=off 10=0 20=0 11=4 21=0\nLINE 8=ice 10=0 20=0 11=4 21=0\nLINE 8=Defpoints 10=0 20=0 11=4 21=0\n\
                INSERT 8=7_cut 2=A 10=0 20=0\nINSERT 8=off 2=A 10=0 20=5\nINSERT 8=ice 2=A 10=0 20=9";
    let text = file(&format!("{tables}{body}"));
    let (ops, said) = read_with(text.as_bytes(), ReadOptions::default());
    assert_eq!(ops, "p1 t0,0 d1,0 p2 t0,0 d2,0 p1 t0,0 d3,0 p2 t0,0 d1,0 p1 t0,1 d1,1 t0,6 d1,6");
    assert_eq!(said.len(), 3);
    assert!(
        said[0].ends_with(
            "2 entities of the layer `off`, which is off, frozen or not for plots, are left out: turn it on"
        ),
        "{said:?}"
    );
    let by_number = ReadOptions { pens: Pens::ByLayerNumber, ..ReadOptions::default() };
    assert!(read_with(text.as_bytes(), by_number).0.starts_with("p1 t0,0 d1,0 p7 t0,0 d2,0 p1"));
    let by_colour = ReadOptions { pens: Pens::ByColour, ..ReadOptions::default() };
    let drawing = Drawing::read(text.bytes()).unwrap();
    let mut ops = drawing.plot_ops(by_colour);
    ops.by_ref().for_each(drop);
    assert_eq!(ops.pens().collect::<Vec<_>>(), [(1, [0, 0, 255]), (2, [255, 0, 0])]);
}

#[test]
fn the_model_is_drawn_and_a_sheet_where_there_is_none() {
    let (ops, said) = read("LINE 67=1 10=0 20=0 11=9 21=0\nLINE 10=0 20=0 11=1 21=0");
    assert_eq!(ops, "p1 t0,0 d1,0");
    assert!(said[0].contains("sheets of the paper space is left out"), "{said:?}");
    let (ops, said) = read("VIEWPORT 67=1 10=0 20=0\nLINE 67=1 10=0 20=0 11=9 21=0");
    assert_eq!((ops.as_str(), said.len()), ("p1 t0,0 d9,0", 0));
}

#[test]
fn units_are_those_of_the_file_unless_they_are_said() {
    let unit = |unit: &str| {
        file("LINE 10=1 20=0 11=2 21=0").replace("$INSUNITS\n70\n4", &format!("$INSUNITS\n70\n{unit}"))
    };
    for (code, expected) in
        [("1", "t25.4,0"), ("2", "t304.8,0"), ("5", "t10,0"), ("6", "t1000,0"), ("14", "t100,0")]
    {
        let (ops, said) = read_with(unit(code).as_bytes(), ReadOptions::default());
        assert!(ops.contains(expected) && said.is_empty(), "{code}: {ops} {said:?}");
    }
    let (ops, said) = read_with(unit("0").as_bytes(), ReadOptions::default());
    assert!(ops.contains("t1,0") && said[0].contains("does not say what its unit is"), "{ops} {said:?}");
    let options = ReadOptions { unit_mm: Some(2.0), moved_mm: Vec2::new(1.0, 5.0), ..ReadOptions::default() };
    assert_eq!(read_with(unit("0").as_bytes(), options), ("p1 t3,5 d5,5".into(), vec![]));
}

#[test]
fn what_is_wrong_has_its_line_and_the_rest_is_drawn() {
    let rows = [
        ("CIRCLE 10=0 20=0", "a CIRCLE is left out: a number that it needs is missing"),
        ("CIRCLE 10=0 20=0 40=0", "a CIRCLE is left out: a size that ought to be above 0 is not (group 40)"),
        ("LINE 10=nan 20=0 11=1 21=1", "a LINE is left out: one of its numbers is none, or beyond 1e9"),
        ("LINE 10=1e12 20=0 11=1 21=1", "a LINE is left out: one of its numbers is none, or beyond 1e9"),
        ("LINE 10=0 20=0", "a LINE is left out: a place that it needs is missing"),
        ("LWPOLYLINE 90=0 70=0", "a LWPOLYLINE is left out: it has no place (10, 20)"),
        (
            "SPLINE 71=3 40=0 40=1 10=0 20=0",
            "a SPLINE is left out: it has too few control points (10, 20) for its degree",
        ),
        ("HATCH 70=0 91=0 75=0", "a HATCH is left out: it has no outline"),
        ("INSERT 10=0 20=0", "a INSERT is left out: the name of its block (2) is missing"),
        ("XLINE 10=0 20=0 11=1 21=0", "XLINE is not drawn: it has no end: draw a LINE"),
        (
            "3DSOLID 1=x\n3DSOLID 1=y",
            "3DSOLID is not drawn (2 of them): it is a solid or a surface: make lines of it first (FLATSHOT, or EXPLODE for a region)",
        ),
        ("TEXT 10=0 20=0 40=5 1=→", "the letter `→` is not in the font of single lines: a gap stands for it"),
    ];
    for (body, expected) in rows {
        let (ops, said) = read(&format!("{body}\nLINE 10=0 20=0 11=1 21=0"));
        assert_eq!(ops, "p1 t0,0 d1,0", "{body}");
        assert_eq!(said, [format!("line 15: {expected}")], "{body}");
    }
}

#[test]
fn damaged_files_keep_what_is_good() {
    let whole = file("LINE 10=0 20=0 11=1 21=0\nLINE 10=0 20=5 11=1 21=5");
    let (ops, said) = read_with(whole.as_bytes().split_at(whole.len() - 30).0, ReadOptions::default());
    assert!(ops.starts_with("p1 t0,0 d1,0"), "{ops}");
    assert!(said.iter().any(|said| said.contains("the file ends here, before its end")), "{said:?}");
    let (ops, said) =
        read_with(whole.replace("LINE\n10", "LINE\nfoo\n10").as_bytes(), ReadOptions::default());
    assert_eq!(ops, "p1 t0,0 d1,0 t0,5 d1,5");
    assert!(said[0].starts_with("line 17: `foo` stands where the number of a group belongs"), "{said:?}");
    for other in [&b"AutoCAD Binary DXF\r\n\x1a\0"[..], b"AC1027\0\0\0\0"] {
        assert!(
            Drawing::read(other.iter().copied()).unwrap_err().to_string().contains("save it as ASCII DXF")
        );
    }
    for nothing in ["", "\n\n", "0\nEOF\n", "999\nhello\n0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n"] {
        assert_eq!(read_with(nothing.as_bytes(), ReadOptions::default()).0, "", "{nothing:?}");
    }
}

/// Ten blocks that hold the next one 32,767 times in a row ask for more lines than there are atoms.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn blocks_that_multiply_have_an_end() {
    let mut body = String::from("[BLOCKS]\n");
    for number in 0..10 {
        let _ = write!(
            body,
            "BLOCK 2=B{number} 10=0 20=0\nINSERT 2=B{} 10=0 20=0 70=32767 71=32767\nENDBLK\n",
            number + 1
        );
    }
    body.push_str(
        "BLOCK 2=B10 10=0 20=0\nLINE 10=0 20=0 11=1 21=0\nENDBLK\n[ENTITIES]\nINSERT 2=B0 10=0 20=0",
    );
    let text = file(&body);
    let drawing = Drawing::read(text.bytes()).unwrap();
    let drawn = drawing.plot_ops(ReadOptions::default()).filter(Result::is_ok).count();
    assert!(drawn < 2 * (1 << 22), "{drawn}");
}
