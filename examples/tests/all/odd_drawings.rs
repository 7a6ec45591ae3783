//! Drawings that are wrong, far away, or very many of one thing: a clear word, and nothing else is lost.

use crate::built_example::{Folder, complaint, run_example};
use plotter_examples::drawings::{DrawingFile, Reading};
use std::path::Path;
use std::process::Output;

/// What is said of a drawing that is written as HPGL, and how many strokes, lines and arcs come back.
fn converted(name: &str, text: &str, options: &[&str]) -> (String, usize, usize) {
    let folder = Folder::new();
    let (from, to) = (folder.write(name, text), folder.file("b.plt"));
    let Output { status, stderr, .. } =
        run_example("convert", &[&[from.as_str(), &to][..], options].concat());
    let said = String::from_utf8(stderr).unwrap();
    assert!(status.success(), "{name}: {said}");
    let file = DrawingFile::open(Path::new(&to), None).unwrap();
    let drawing: plotter_motion::drawing::Drawing =
        file.ops(Reading::default()).unwrap().filter_map(Result::ok).collect();
    let segments = drawing.strokes.iter().map(|stroke| stroke.segments.len()).sum();
    (said, drawing.strokes.len(), segments)
}

fn svg(content: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='50mm' height='50mm' viewBox='0 0 50 50' stroke='#000'>{content}</svg>"
    )
}

fn dxf(entities: &str) -> String {
    format!("0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n")
}

/// A line of a DXF from the origin, on a layer.
fn dxf_line(layer: &str, x: &str, y: u32) -> String {
    format!("0\nLINE\n8\n{layer}\n10\n0\n20\n{y}\n11\n{x}\n21\n{y}\n")
}

#[test]
fn what_is_no_place_is_told_and_the_rest_is_drawn() {
    let gcode = |word: &str| format!("G21\nM3\nG1 X10 Y10\nG1 {word} Y20\nG1 X30 Y30\nM5\n");
    let path = |place: &str| svg(&format!("<path d='M10 10L20 {place} L30 30'/><path d='M0 0H9'/>"));
    let lines = |x: &str| dxf(&[dxf_line("a", x, 1), dxf_line("a", "9", 2)].concat());
    let hpgl = |x: &str| format!("IN;SP1;PU0,0;PD400,400;PD{x},800;PD1200,1200;PU;");
    for (name, text, expected, segments) in [
        ("a.gcode", gcode("XNaN"), "line 4, column 4: X lacks its number", 2),
        ("a.gcode", gcode("Xinf"), "line 4, column 4: X lacks its number", 2),
        ("a.gcode", gcode("X1e30"), "line 4, column 4: X has a number with an exponent", 2),
        ("a.gcode", gcode(&format!("X1{}", "0".repeat(30))), "line 4, column 4: X with 1000", 2),
        ("a.svg", path("NaN"), "a path is wrong at NaN: what comes before is drawn", 1),
        ("a.svg", path("1e30"), "1e30 is no place on a sheet: what comes before is drawn", 1),
        ("a.dxf", lines("nan"), "line 5: a LINE is left out: one of its numbers is none", 1),
        ("a.dxf", lines("1e30"), "line 5: a LINE is left out: one of its numbers is none, or beyond 1e9", 1),
        ("a.plt", hpgl("nan"), "NA is no known command", 2),
        ("a.plt", hpgl(&format!("1{}", "0".repeat(30))), "PD holds the number 1000", 2),
    ] {
        let (said, _, drawn) = converted(name, &text, &[]);
        assert!(said.contains(expected), "{name}: {said}");
        assert_eq!(drawn, segments, "{name}: {said}");
    }
}

#[test]
fn nothing_and_a_dot_are_told_apart() {
    let folder = Folder::new();
    let to = folder.file("b.plt");
    for (name, text, expected) in [
        ("a.plt", "", "the file is empty"),
        ("a.svg", "", "the file is empty"),
        ("a.gcode", "\n\n", "looks like none of HPGL, G-code"),
        ("a.plt", "IN;SP1;PU;", "nothing is drawn by it"),
    ] {
        let from = folder.write(name, text);
        for tool in [&["convert", &from, &to][..], &["stepper", &from, "--estimate"]] {
            let said = complaint(tool[0], &tool[1..]);
            assert!(said.contains(expected), "{tool:?}: {said}");
        }
        assert!(!Path::new(&to).exists());
    }
    for (name, text) in [
        ("a.plt", "IN;SP1;PU400,400;PD;PU;".to_owned()),
        ("a.gcode", "G21\nG0 X10 Y10\nM3\nG1 X10 Y10\nM5\n".to_owned()),
        ("a.svg", svg("<path d='M10 10h0' stroke-linecap='round'/>")),
    ] {
        for options in [&[][..], &["--order", "best"], &["--scale", "3"], &["--drop-doubles"]] {
            assert_eq!(converted(name, &text, options), (String::new(), 1, 1), "{name} {options:?}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn thousands_of_dots_in_one_place_stay() {
    // A million takes as long for each: see order_memory of plotter-vector.
    let dots = 20_000;
    let text = format!("IN;SP1;{}PU;", "PU400,400;PD400,400;".repeat(dots));
    for effort in ["fast", "best"] {
        assert_eq!(converted("a.plt", &text, &["--order", effort]), (String::new(), dots, dots));
    }
}

#[test]
fn more_pens_than_there_are_numbers_are_counted() {
    let count = 300;
    let hpgl = |k: u32| format!("SP{k};PU0,{k};PD400,{k};");
    let coloured = |k: u32| format!("<path d='M0 {k}H9' stroke='#{k:06x}'/>");
    let layer = |k: u32| format!("<g id='l{k}'><path d='M0 {k}H9'/></g>");
    let all = |of: &dyn Fn(u32) -> String| (1..=count).map(of).collect::<String>();
    let dxf_layers = dxf(&all(&|k| dxf_line(&format!("L{k}"), "9", k)));
    let cases: [(&str, String, &[&str], &str); 4] = [
        ("a.plt", format!("IN;{}PU;", all(&hpgl)), &[], "and 35 more"),
        ("a.svg", svg(&all(&coloured)), &[], "colours beyond the 16 pens: 284, with 284 shapes"),
        ("a.svg", svg(&all(&layer)), &["--pens", "order"], "layers beyond the 255 pens: 45, with 45 shapes"),
        (
            "a.dxf",
            dxf_layers,
            &[],
            "beyond the 255th has no pen of its own: pen 255 draws it; put several in one layer (45 of them)",
        ),
    ];
    for (name, text, options, expected) in cases {
        let (said, strokes, _) = converted(name, &text, options);
        assert!(said.contains(expected), "{name}: {said}");
        assert_eq!(strokes, count as usize, "{name}");
    }
}

#[test]
fn a_file_of_which_half_makes_sense_is_read_or_told() {
    let lines = |good: usize, bad: usize| {
        let line = |k: usize| if k < good { format!("G1 X{k} Y{k}\n") } else { format!("lorem ipsum {k}\n") };
        // Good and bad ones by turns.
        let order = (0..100).map(|k| 37 * k % 100).filter(|k| *k < good + bad);
        format!("G21\nM3\n{}M5\n", order.map(line).collect::<String>())
    };
    let (said, _, drawn) = converted("a.gcode", &lines(60, 40), &[]);
    assert!(said.contains("and 30 more") && drawn >= 59, "{drawn}: {said}");
    let folder = Folder::new();
    let from = folder.write("a.gcode", lines(40, 60));
    let said = complaint("convert", &[&from, &folder.file("b.plt")]);
    assert!(
        said.contains("its name says gcode, but only 41 % of its beginning makes sense as that: correct it"),
        "{said}"
    );
    let (_, _, drawn) = converted("a.gcode", &lines(40, 60), &["--from", "gcode"]);
    assert!(drawn >= 39, "{drawn}");
}

#[test]
fn a_scale_of_nothing_is_refused() {
    let folder = Folder::new();
    let (from, to) = (folder.write("a.plt", "IN;SP1;PU0,0;PD400,0;PU;"), folder.file("b.plt"));
    for bad in ["0", "NaN", "inf", "-1", "1e-9", "1e30", "two"] {
        for tool in [&["convert", from.as_str(), &to][..], &["stepper", &from, "--estimate"]] {
            let output = run_example(tool[0], &[&tool[1..], &["--scale", bad]].concat());
            let said = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(2), "{tool:?} {bad}: {said}");
            assert!(said.contains("'--scale <F>': give a number"), "{said}");
        }
    }
}
