//! The command `convert`: round trips between all languages, and what it says of what they lack.

use crate::built_example;
use crate::made_font;

use crate::real_files::all;
use built_example::{Folder, complaint, data, run_example, run_with_input};
use made_font::made_font;
use plotter_examples::drawings::{DrawingFile, Reading};
use plotter_motion::{PlotOp, Point, toolpath::chords};
use std::path::Path;

/// A plotter unit, mm.
const UNIT_MM: f64 = 0.025;

impl Folder {
    /// Converts a file into one of another name; gives its path, its text and what was said.
    fn convert(&self, from: &str, to: &str, options: &[&str]) -> (String, String, String) {
        let path = self.file(to);
        let output = run_example("convert", &[&[from, &path][..], options].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{from} to {to}: {said}");
        let text = std::fs::read_to_string(&path).unwrap();
        (path, text, said)
    }
}

/// A stroke: its pen, and its places with arcs as chords within a thousandth of a millimetre.
type Stroke = (u8, Vec<Point>);

fn strokes(path: &str) -> Vec<Stroke> {
    let file = DrawingFile::open(Path::new(path), None).unwrap();
    let (mut strokes, mut pen, mut at, mut is_down) = (Vec::<Stroke>::new(), 1, Point::ORIGIN, false);
    for op in chords(file.ops(Reading::default()).unwrap().flatten(), 1e-3) {
        match op {
            PlotOp::Travel { .. } => is_down = false,
            PlotOp::Draw { to, .. } => {
                if !std::mem::replace(&mut is_down, true) {
                    strokes.push((pen, vec![at]));
                }
                strokes.last_mut().unwrap().1.push(to);
            }
            PlotOp::SelectPen { pen: next } => (pen, is_down) = (next, false),
            _ => {}
        }
        at = op.target().unwrap_or(at);
    }
    strokes
}

/// Farthest that a place of one drawing is from the same stroke of the other, mm, either way.
fn farthest_mm(one: &[Stroke], other: &[Stroke]) -> f64 {
    assert_eq!(one.len(), other.len());
    let way = |from: &[Stroke], to: &[Stroke]| {
        let mut most = 0.0_f64;
        for ((pen, places), (other_pen, others)) in from.iter().zip(to) {
            assert_eq!(pen, other_pen);
            for place in places {
                let segments = others.windows(2).map(|ends| plotter_motion::Segment::new(ends[0], ends[1]));
                most = most.max(segments.map(|line| line.distance(*place)).fold(f64::INFINITY, f64::min));
            }
        }
        most
    };
    way(one, other).max(way(other, one))
}

const DRAWING: &str = "IN;SP1;PU400,400;PD800,400,811,1203;PU1000,1000;CI300;SP2;PU100,2000;PD;AA500,2000,-135;PD0,0;\
                       PU3000,100;PD3000,100;PU;SP0;";

#[test]
fn hpgl_and_gcode_keep_points_to_a_plotter_unit() {
    let folder = Folder::new();
    let original = folder.write("a.plt", DRAWING);
    let (gcode, text, said) = folder.convert(&original, "b.gcode", &[]);
    assert_eq!(said, "");
    assert!(text.contains("\nG3 ") && text.contains("\nG2 ") && text.contains("(pen 2)"), "{text}");
    assert!(farthest_mm(&strokes(&original), &strokes(&gcode)) < 0.002);
    let (back, text, said) = folder.convert(&gcode, "c.plt", &[]);
    assert_eq!(said, "");
    assert!(text.contains("CI300;") || text.contains("AA"), "{text}");
    assert!(farthest_mm(&strokes(&original), &strokes(&back)) < UNIT_MM);
}

#[test]
fn svg_and_hpgl_keep_strokes_and_pens() {
    let folder = Folder::new();
    let original = folder.write("a.plt", DRAWING);
    let (svg, text, said) = folder.convert(&original, "b.svg", &[]);
    assert_eq!(said, "");
    assert!(
        text.contains("<g id=\"pen-1\"") && text.contains("<g id=\"pen-2\"") && text.contains('A'),
        "{text}"
    );
    assert!(farthest_mm(&strokes(&original), &strokes(&svg)) < 0.01);
    let (back, text, _) = folder.convert(&svg, "c.plt", &[]);
    assert!(text.contains("AA"), "arcs stay arcs: {text}");
    assert!(farthest_mm(&strokes(&original), &strokes(&back)) < 1.5 * UNIT_MM);
    let (again, ..) = folder.convert(&back, "d.svg", &[]);
    assert!(farthest_mm(&strokes(&svg), &strokes(&again)) < 1.5 * UNIT_MM);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_language_becomes_every_other_one() {
    let folder = Folder::new();
    // Two pens, of which one is not the next; an arc, a circle, a curve, letters, a dot; a sheet that is put out at the end.
    let hpgl = "IN;SP1;PU400,400;PD800,400,811,1203;PU1000,1000;CI300;PU500,2000;PD;AA900,2000,-135;PU3000,100;PD;PU;SP4;\
                PU2000,2000;SI0.5,0.7;LBHi!\x03;PU3000,3000;PD;BZ3500,3000,3500,3500,4000,3500;PU;SP0;PG;";
    let original = folder.write("a.plt", hpgl);
    let suffixes = ["plt", "gcode", "svg", "txt"];
    let files = suffixes.map(|suffix| match suffix {
        "plt" => original.clone(),
        _ => folder.convert(&original, &format!("a.{suffix}"), &[]).0,
    });
    let pens = |path: &str| strokes(path).iter().map(|(pen, _)| *pen).collect::<Vec<u8>>();
    let all_in =
        |path: &str| strokes(path).into_iter().map(|(_, places)| (1, places)).collect::<Vec<Stroke>>();
    assert_eq!(pens(&original).last(), Some(&4));
    for (from, file) in suffixes.iter().zip(&files) {
        for to in suffixes.iter().filter(|to| *to != from) {
            let (other, text, said) = folder.convert(file, &format!("{from}.{to}"), &[]);
            let one_pen = [from, to].iter().any(|suffix| **suffix == "txt");
            let most = farthest_mm(&all_in(file), &all_in(&other));
            assert!(most < 1.5 * UNIT_MM, "{from} to {to}: {most}");
            assert!(one_pen || pens(&other) == pens(&original), "{from} to {to}");
            assert!(!text.contains("new sheet") && !said.contains("sheet"), "{from} to {to}: {said}");
            let loses_pens = **to == *"txt";
            assert_eq!(said.contains("one pen"), loses_pens, "{from} to {to}: {said}");
        }
    }
}

#[test]
fn a_sheet_is_asked_for_once_something_is_drawn_on_it() {
    let folder = Folder::new();
    let original = folder.write("a.plt", "IN;PG;PU400,400;PD800,400;PG;PG;PU;PU0,400;PD400,400;PU;PG;");
    let (_, text, _) = folder.convert(&original, "a.gcode", &[]);
    assert_eq!(text.matches("M0 (new sheet)").count(), 1, "{text}");
    let (_, _, said) = folder.convert(&original, "a.svg", &[]);
    assert!(said.contains("line 1: the target has no sheets"), "{said}");
}

#[test]
fn nobody_waits_for_the_pen_that_draws_first() {
    let folder = Folder::new();
    let original = folder.write("a.plt", "IN;SP3;PU400,400;PD800,400;SP5;PD800,800;PU;SP0;");
    let (gcode, text, _) = folder.convert(&original, "a.gcode", &[]);
    assert!(text.contains("\n(pen 3)\n") && text.matches("M0").count() == 1, "{text}");
    let (_, back, _) = folder.convert(&gcode, "b.plt", &[]);
    assert!(back.contains("SP3;") && back.contains("SP5;"), "{back}");
}

#[test]
fn thesis_text_is_counts_and_chords() {
    let folder = Folder::new();
    let original = folder.write("a.plt", "IN;SP2;PU400,400;PD800,400;PD;AA800,800,90;PU;");
    let (thesis, text, said) = folder.convert(&original, "b.txt", &["--tolerance-mm", "0.1"]);
    assert!(text.starts_with("PU, 00400, 00400\nPD, 00800, 00400\nPD, "), "{text}");
    assert!(text.ends_with("PD, 01200, 00800\n") && text.lines().count() < 12, "{text}");
    assert!(said.contains("notice: ") && said.contains("one pen") && said.lines().count() == 1, "{said}");
    let (_, back, _) = folder.convert(&thesis, "c.plt", &[]);
    assert!(back.starts_with("IN;\nSP1;\nPU400,400;\nPD800,400,"), "{back}");
    let negative = folder.write("n.plt", "IN;PU0,0;\nPD400,0;\nPD400,-40;\nPD400,80;\nPD0,80;");
    let (_, text, said) = folder.convert(&negative, "n.txt", &[]);
    // Neither the line that leaves the counts nor the one that comes back.
    assert_eq!(text, "PD, 00400, 00000\nPU, 00400, 00080\nPD, 00000, 00080\n");
    assert!(said.contains("line 3: point (400, -40) lies outside 0..=99999"), "{said}");
    assert!(complaint("convert", &[&negative, &folder.file("m.txt"), "--strict"]).contains("line 3: point"));
}

#[test]
fn pens_of_gcode_are_lifted_as_asked() {
    let folder = Folder::new();
    let original = folder.write("a.plt", "IN;PU400,400;PD800,400;CI200;PU;");
    for (options, up, down) in [
        (&[][..], "M5", "M3 S90"),
        (&["--gcode-pen", "z"], "G0 Z5", "G1 Z0"),
        (&["--gcode-pen", "unicorn"], "M300 S50", "M300 S30"),
        (&["--gcode-pen", "mdraw"], "M1 160", "M1 90"),
        (&["--pen-up", "M280 P0 S60", "--pen-down", "M280 P0 S30"], "M280 P0 S60", "M280 P0 S30"),
    ] {
        let (gcode, text, _) = folder.convert(&original, "b.nc", options);
        assert!(text.contains(up) && text.contains(down), "{text}");
        assert_eq!(text.contains("G3 "), !options.contains(&"mdraw"), "{text}");
        assert!(farthest_mm(&strokes(&original), &strokes(&gcode)) < 0.02, "{options:?}");
    }
    let (_, text, _) = folder.convert(&original, "c.nc", &["--gcode-pen", "z"]);
    let plain = folder.write("d.nc", text.replace("Z5", "Z2").replace("Z0", "Z-1"));
    let (_, text, _) = folder.convert(&plain, "e.plt", &["--convention", "z"]);
    assert!(text.contains("PU400,400;\n") && text.contains("PD800,400;\n"), "{text}");
}

#[test]
fn what_svg_has_and_plotters_lack_is_said() {
    let folder = Folder::new();
    let svg = folder.write(
        "a.svg",
        "<svg xmlns='http://www.w3.org/2000/svg' width='4in' height='96' viewBox='0 0 384 96'>\n\
         <text x='3' y='9'>words</text>\n\
         <path d='M0 96 L96 0' stroke='red'/><path d='M96 96 C150 96 96 0 192 0' stroke='blue' fill='none'/></svg>",
    );
    let (_, text, said) = folder.convert(&svg, "a.hpgl", &[]);
    assert!(text.starts_with("IN;\nSP1;\nPU0,0;\nPD1016,1016;\n"), "{text}");
    assert!(text.contains("SP2;\nPU1016,0;\n"), "{text}");
    assert!(said.contains("a.svg: line 2: a text is left out: give a font with --font FILE"), "{said}");
}

#[test]
fn texts_of_svg_are_set_in_the_fonts_that_are_given() {
    let folder = Folder::new();
    let svg = folder.write(
        "a.svg",
        "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='50mm' viewBox='0 0 100 50'>\n\
         <text x='10' y='40' font-size='10' font-family='Boxes'>B</text>\n\
         <text y='40' font-family='Other'>V☃</text></svg>",
    );
    std::fs::create_dir(folder.0.path().join("sub")).unwrap();
    let font = folder.write("sub/boxes.ttf", made_font("Boxes"));
    folder.write("sub/broken.otf", "no font");
    let (_, text, said) = folder.convert(&svg, "a.plt", &["--font", &font]);
    assert!(text.contains("PU400,400;\nPD400,680,600,680,600,400,400,400;"), "{text}");
    assert!(
        said.contains(
            "line 3: a text is left out: no font Other is given, and no font given has ☃; give one with"
        ),
        "{said}"
    );
    // A folder is as good as its files, and says which are none.
    let (_, by_folder, said) = folder.convert(&svg, "b.plt", &["--font", folder.0.path().to_str().unwrap()]);
    assert_eq!(by_folder, text);
    assert!(
        said.contains("left out of the fonts: a file") && said.contains("broken.otf: this is no font"),
        "{said}"
    );
    let out = folder.file("c.plt");
    let said = |font: &str| complaint("convert", &[&svg, &out, "--font", font]);
    assert!(said("no/such.ttf").contains("--font: no/such.ttf: cannot be read"));
    assert!(said(&svg).contains("a.svg: this is no font with a name; give a TrueType or OpenType file"));
    assert!(said(&folder.write("web.woff2", "wOF2\0\x01\0\0")).contains("this is a web font (WOFF)"));
    std::fs::create_dir(folder.0.path().join("empty")).unwrap();
    assert!(said(&folder.file("empty")).contains("this folder holds no font"));
}

#[test]
fn places_out_of_reach_are_left_out_of_every_language() {
    let folder = Folder::new();
    let far = folder.write(
        "far.svg",
        "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0H40V900000H9V8' stroke='red' fill='none'/></svg>",
    );
    for to in ["a.plt", "a.nc", "a.txt", "b.svg"] {
        let (_, text, said) = folder.convert(&far, to, &[]);
        assert!(said.contains("error: ") && !text.contains("inf"), "{to}: {said}");
    }
}

#[test]
fn pipes_are_read_and_written() {
    let folder = Folder::new();
    let original = folder.write("a.plt", DRAWING);
    let (_, expected, _) = folder.convert(&original, "a.gcode", &[]);
    let file = std::fs::File::open(&original).unwrap();
    let output = run_with_input("convert", &["-", "-", "--from", "hpgl", "--to", "gcode"], file);
    assert!(output.status.success());
    assert_eq!(String::from_utf8(output.stdout).unwrap(), expected);
}

#[test]
fn what_cannot_be_converted_is_said_and_no_file_is_touched() {
    let folder = Folder::new();
    let out = folder.write("out.plt", "keep me");
    assert!(complaint("convert", &["no/such.plt", &out]).starts_with("convert: no/such.plt: cannot be read"));
    assert!(complaint("convert", &[&data("flag.png"), &out]).contains("none of HPGL"));
    let empty = folder.write("empty.nc", "G21\nG90\nM5\nG0 X10\n");
    assert!(complaint("convert", &[&empty, &out]).contains("nothing is drawn by it, read as gcode"));
    assert_eq!(std::fs::read_to_string(&out).unwrap(), "keep me");
    let some = folder.write("some.nc", "M3\nG1 X10 F600\n");
    assert!(complaint("convert", &[&some, "/no/such/a.plt"]).contains("cannot be written"));
    for bad in [
        &[&some, "a.unknown"][..],
        &[&some, &some],
        &[&some, &out, "--tolerance-mm", "0"],
        &[&some, &out, "--pen-up", "M5"],
    ] {
        assert_eq!(run_example("convert", bad).status.code(), Some(2), "{bad:?}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_real_file_becomes_the_same_strokes_in_the_other_languages() {
    let folder = Folder::new();
    for kind in ["hpgl", "gcode"] {
        for file in all(kind) {
            let (path, name) = (file.to_str().unwrap(), file.file_name().unwrap().to_string_lossy());
            let original = strokes(path);
            let (gcode, ..) = folder.convert(path, "a.gcode", &[]);
            let (hpgl, ..) = folder.convert(&gcode, "b.plt", &[]);
            let (svg, ..) = folder.convert(path, "c.svg", &[]);
            let most = farthest_mm(&original, &strokes(&gcode));
            assert!(most < 0.002, "{name} as G-code: {most}");
            let most = farthest_mm(&original, &strokes(&hpgl));
            assert!(most < 1.5 * UNIT_MM, "{name} as HPGL: {most}");
            // Its pens are groups, in which all strokes of a pen stand together.
            assert_eq!(strokes(&svg).len(), original.len(), "{name} as SVG");
        }
    }
}

#[test]
fn gcode_in_words_of_its_own_becomes_gcode_in_the_same_or_in_others() {
    let folder = Folder::new();
    let macros = folder.write(
        "a.gcode",
        "G21 G90\nPEN_UP\nG1 X10 Y10\nPEN_DOWN\nG1 X30\nPEN_UP\nG1 X40\nPEN_DOWN\nG1 Y20\nPEN_UP\n",
    );
    let out = folder.file("b.gcode");
    let converted = |input: &str, up: &str, down: &str| {
        let output = run_example("convert", &[input, &out, "--pen-up", up, "--pen-down", down]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read_to_string(&out).unwrap()
    };
    let same = converted(&macros, "PEN_UP", "PEN_DOWN");
    assert_eq!((same.matches("PEN_DOWN").count(), same.matches("G1").count()), (2, 2), "{same}");
    // Words that are not in the drawing are those to write.
    let spindle = folder.write("c.gcode", "G0 X1 Y1\nM3\nG1 X30\nM5\nG0 X40\nM3\nG1 Y20\nM5\n");
    let other = converted(&spindle, "M280 P0 S60", "M280 P0 S30");
    assert_eq!((other.matches("M280 P0 S30").count(), other.matches("G1").count()), (2, 2), "{other}");
}
