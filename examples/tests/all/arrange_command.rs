//! What `convert` and `stepper` do with a drawing on its way: place, crop, order, begin in the middle.

use crate::built_example::{Folder, complaint, run_example};
use plotter_examples::drawings::{DrawingFile, Reading};
use plotter_motion::Point;
use plotter_motion::drawing::Drawing;
use std::path::Path;

/// Half of the last digit in an SVG, mm.
const DIGIT_MM: f64 = 1e-4;

/// Three lines of two pens, 30 x 20 mm in all.
const LINES: &str =
    "IN;SP1;PU400,400;PD800,400;\nSP2;PU1600,1200;PD1600,400;\nSP1;PU1200,400;PD810,400;\nPU;SP0;";

fn read(path: &str) -> Drawing {
    let file = DrawingFile::open(Path::new(path), None).unwrap();
    file.ops(Reading::default()).unwrap().filter_map(Result::ok).collect()
}

fn arranged_as(text: &str, name: &str, options: &[&str]) -> (Drawing, String) {
    arranged_into("b.svg", text, name, options)
}

fn arranged_into(into: &str, text: &str, name: &str, options: &[&str]) -> (Drawing, String) {
    let folder = Folder::new();
    let (from, to) = (folder.write(name, text), folder.file(into));
    let output = run_example("convert", &[&[from.as_str(), &to][..], options].concat());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    (read(&to), said)
}

fn arranged(options: &[&str]) -> Drawing {
    arranged_as(LINES, "a.plt", options).0
}

fn box_of(drawing: &Drawing) -> [f64; 4] {
    let bounds = drawing.bounds();
    [bounds.least.x, bounds.least.y, bounds.most.x, bounds.most.y]
}

fn near(one: [f64; 4], other: [f64; 4]) -> bool {
    one.iter().zip(other).all(|(one, other)| (one - other).abs() < 2.0 * DIGIT_MM)
}

#[test]
fn a_drawing_is_placed_as_asked() {
    let rows: [(&[&str], [f64; 4]); 9] = [
        (&["--scale", "2"], [20.0, 20.0, 80.0, 60.0]),
        (&["--fit", "A4"], [0.0, 78.5, 210.0, 218.5]),
        (&["--fit", "a4", "--margin", "15", "--landscape"], [15.0, 16.0, 282.0, 194.0]),
        (&["--fit", "100x100"], [0.0, 16.6667, 100.0, 83.3333]),
        (&["--center=100x50"], [35.0, 15.0, 65.0, 35.0]),
        (&["--center=100x50", "--scale", "2"], [20.0, 5.0, 80.0, 45.0]),
        (&["--rotate", "90"], [15.0, 5.0, 35.0, 35.0]),
        (&["--rotate", "90", "--fit", "40x60"], [0.0, 0.0, 40.0, 60.0]),
        (&["--mirror", "x"], [10.0, 10.0, 40.0, 30.0]),
    ];
    for (options, expected) in rows {
        let found = box_of(&arranged(options));
        assert!(near(found, expected), "{options:?}: {found:?}");
    }
    // The line that stands on the right is on the left.
    let mirrored = arranged(&["--mirror", "x"]);
    let stands = mirrored.strokes.iter().find(|stroke| stroke.pen == 2).unwrap();
    assert!((stands.from.x - 10.0).abs() < DIGIT_MM, "{stands:?}");
    let above = arranged(&["--mirror", "y"]);
    assert!(above.strokes.iter().any(|stroke| stroke.from.distance(Point::new(10.0, 30.0)) < DIGIT_MM));
}

#[test]
fn a_page_is_that_of_the_drawing_or_what_is_asked_for() {
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='60mm' viewBox='0 0 100 60'><path d='M0 0H20' stroke='#000'/></svg>";
    let folder = Folder::new();
    let (from, to) = (folder.write("a.svg", svg), folder.file("b.svg"));
    let page = |options: &[&str]| {
        let output = run_example("convert", &[&[from.as_str(), &to][..], options].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(&to).unwrap();
        let width = text.split("width=\"").nth(1).unwrap().split('"').next().unwrap().to_owned();
        (width, box_of(&read(&to)))
    };
    let (width, place) = page(&["--center"]);
    assert!(width == "100mm" && near(place, [40.0, 30.0, 60.0, 30.0]), "{width} {place:?}");
    assert_eq!(page(&["--scale", "2"]).0, "200mm");
    assert_eq!(page(&["--fit", "A3"]).0, "297mm");
    assert_eq!(page(&["--fit", "own", "--landscape"]).0, "100mm");
    let (_, said) = arranged_as(LINES, "a.plt", &["--center=20x10"]);
    assert!(said.contains("the drawing is 30.0 x 20.0 mm, larger than the page of 20.0 x 10.0 mm"), "{said}");
}

#[test]
fn what_lies_outside_is_cut_off() {
    let cropped = arranged(&["--crop", "15,0,10,100"]);
    assert!(near(box_of(&cropped), [15.0, 10.0, 25.0, 10.0]), "{:?}", box_of(&cropped));
    assert!((cropped.length_mm() - 9.75).abs() < 1e-3, "{}", cropped.length_mm());
    // A triangle, between x = 15 and x = 25 at y = 10 where both level lines run.
    let triangle = arranged(&["--crop", "10,0,20,20,30,0"]);
    assert!(near(box_of(&triangle), [15.0, 10.0, 25.0, 10.0]), "{:?}", box_of(&triangle));
    assert!((triangle.length_mm() - 9.75).abs() < 1e-3, "{}", triangle.length_mm());
    // One that goes round twice: what lies within both turns is cut off.
    let twice = arranged(&["--crop", "10,0,10,20,30,20,30,0,10,0,15,0,15,20,25,20,25,0,15,0"]);
    assert!((twice.length_mm() - 10.0).abs() < 1e-3, "{}", twice.length_mm());
}

#[test]
fn strokes_come_in_an_order_with_less_travel_and_are_joined() {
    let ordered = arranged(&["--order", "best"]);
    assert_eq!(ordered.strokes.iter().map(|stroke| stroke.pen).collect::<Vec<_>>(), [1, 1, 2]);
    assert!((ordered.length_mm() - arranged(&[]).length_mm()).abs() < 1e-3);
    // The gap of a quarter of a millimetre is bridged where that is asked for.
    assert_eq!(arranged(&["--merge-mm", "0.3"]).strokes.len(), 2);
    assert_eq!(arranged(&["--order", "fast", "--merge-mm", "0.3"]).strokes.len(), 2);
}

#[test]
fn strokes_are_joined_round_corners_and_in_the_order_of_the_file() {
    // Two squares of four sides that miss each other by 0.03 mm, and a line between them.
    let square = |x: f64| {
        let sides = [
            [0.0, 0.0, 10.0, 0.0],
            [10.0, 0.03, 10.0, 10.0],
            [10.0, 10.03, 0.0, 10.0],
            [0.0, 9.97, 0.0, 0.03],
        ];
        sides.map(|[x1, y1, x2, y2]| format!("<path d='M{} {y1}L{} {y2}'/>", x + x1, x + x2)).concat()
    };
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='60mm' viewBox='0 0 100 60' stroke='#000' fill='none'>{}<path d='M60 5H70'/>{}</svg>",
        square(80.0),
        square(20.0)
    );
    let begins = |options: &[&str]| {
        let drawing = arranged_as(&svg, "a.svg", options).0;
        drawing.strokes.iter().map(|stroke| libm::round(stroke.from.x)).collect::<Vec<f64>>()
    };
    assert_eq!(begins(&["--order", "none"]).len(), 9);
    let joined = begins(&["--order", "none", "--merge-mm", "0.05"]);
    assert!(matches!(joined[..], [80.0..=90.0, 60.0, 20.0..=30.0]), "{joined:?}");
    for effort in ["fast", "best"] {
        assert_eq!(begins(&["--order", effort, "--merge-mm", "0.05"]).len(), 3);
    }
    // The way of the file is shorter than that from end to end, but takes one lift more.
    let text = "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='60mm' viewBox='0 0 100 60' stroke='#000'><path d='M10 30L10 20'/><path d='M10 20L10 10'/><path d='M8.9 10L8 10'/><path d='M11 10L60 10'/></svg>";
    assert_eq!(arranged_as(text, "a.svg", &["--merge-mm", "0.05"]).0.strokes.len(), 3);
}

#[test]
fn pens_are_changed_on_the_way_where_that_is_asked_for() {
    // Lines of 10 mm, 1 mm above each other, of two pens by turns.
    let text = "IN;SP1;PU0,0;PD400,0;SP2;PU0,40;PD400,40;SP1;PU0,80;PD400,80;SP2;PU0,120;PD400,120;PU;";
    for into in ["b.plt", "b.gcode", "b.svg"] {
        let pens = |options: &[&str]| {
            let drawing = arranged_into(into, text, "a.plt", options).0;
            (drawing.strokes.iter().map(|stroke| stroke.pen).collect::<Vec<_>>(), drawing.travel_mm())
        };
        let (by_pen, far_mm) = pens(&["--order", "best"]);
        assert_eq!(by_pen, [1, 1, 2, 2], "{into}");
        assert_eq!(pens(&["--order", "none", "--merge-mm", "0.05"]).0, [1, 2, 1, 2], "{into}");
        let (by_turns, near_mm) = pens(&["--order", "best", "--across-pens"]);
        assert_eq!(by_turns, [1, 2, 1, 2], "{into}");
        assert!((far_mm - 5.0).abs() < 1e-3 && (near_mm - 3.0).abs() < 1e-3, "{into}: {far_mm} {near_mm}");
    }
}

#[test]
fn more_pens_than_a_palette_has_come_back_from_a_picture() {
    // Twenty pens, each of which draws twice.
    let line = |k: u32| format!("SP{};PU0,{};PD400,{};", k % 20 + 1, 40 * k, 40 * k);
    let text = format!("IN;{}PU;", (0..40).map(line).collect::<String>());
    let pens = |options: &[&str]| {
        let (drawing, said) = arranged_as(&text, "a.plt", options);
        (drawing.strokes.iter().map(|stroke| u32::from(stroke.pen)).collect::<Vec<_>>(), said)
    };
    assert_eq!(pens(&[]), ((0..40).map(|k| k % 20 + 1).collect(), String::new()));
    assert_eq!(pens(&["--order", "fast"]).0, (0..40).map(|k| k / 2 + 1).collect::<Vec<_>>());
}

#[test]
fn colours_without_a_pen_are_counted() {
    let line = |k: u32| format!("<path d='M0 {k}H9' stroke='#{:06x}'/>", 0x10101 * (k % 20));
    let lines: String = (0..40).map(line).collect();
    let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' width='50mm' height='50mm'>{lines}</svg>");
    let (drawing, said) = arranged_as(&svg, "a.svg", &[]);
    assert_eq!(drawing.strokes.len(), 40);
    let expected = "colours beyond the 16 pens: 4, with 8 shapes, which the pen of the nearest colour draws";
    assert!(said.contains(expected), "{said}");
    let folder = Folder::new();
    let (from, to) = (folder.write("a.svg", svg), folder.file("b.plt"));
    let told = run_example("convert", &[&from, &to, "--json"]).stdout;
    let told: serde_json::Value = serde_json::from_slice(&told).unwrap();
    assert!(told["diagnostics"][0]["text"].as_str().unwrap().starts_with(expected), "{told}");
}

#[test]
fn nothing_is_drawn_twice() {
    // The second line covers half of the first one; the third one is of another pen.
    let text = "IN;SP1;PU0,0;PD800,0;PU1200,0;PD400,0;SP2;PU0,0;PD800,0;PU;";
    let (once, _) = arranged_as(text, "a.plt", &["--drop-doubles"]);
    let of_pen = |pen| once.of_pen(pen).length_mm();
    assert!((of_pen(1) - 30.0).abs() < 1e-3 && (of_pen(2) - 20.0).abs() < 1e-3, "{once:?}");
}

/// A circle of 20 mm in 72 lines about (50, 50) mm.
fn round() -> String {
    let text = String::from("IN;SP1;PU2800,2000;PD");
    let places: Vec<String> = (1..=72)
        .map(|k| {
            let angle = f64::from(5 * (k % 72)).to_radians();
            format!("{:.0},{:.0}", 2000.0 + 800.0 * angle.cos(), 2000.0 + 800.0 * angle.sin())
        })
        .collect();
    text + &places.join(",") + ";PU;"
}

#[test]
fn lines_become_arcs_or_fewer_lines() {
    let segments = |options: &[&str]| {
        let (drawing, _) = arranged_as(&round(), "a.plt", options);
        drawing.strokes.iter().map(|stroke| stroke.segments.len()).sum::<usize>()
    };
    assert_eq!(segments(&[]), 72);
    // A whole turn, as SVG writes it: two arcs, or one for each part that rounding to HPGL's units sets
    // apart.
    let arcs = segments(&["--arcs=0.05"]);
    assert!((2..=4).contains(&arcs), "{arcs}");
    // A chord of 10 degrees is 0.08 mm off, one of 20 degrees 0.3 mm.
    let few = segments(&["--simplify-mm", "0.2"]);
    assert!((18..=36).contains(&few), "{few}");
}

#[test]
fn closed_strokes_are_filled_and_hide_what_is_below() {
    let (filled, _) = arranged_as(&round(), "a.plt", &["--hatch", "2", "--hatch-angle", "0"]);
    // 20 lines or so, together as long as the area of the circle through the distance: 400 π / 2 mm, beside
    // its outline of 40 π.
    let lines_mm = filled.length_mm() - 40.0 * std::f64::consts::PI;
    assert!((lines_mm - 200.0 * std::f64::consts::PI).abs() < 15.0, "{lines_mm}");
    // Half of it: what is cropped was filled before.
    let options = ["--hatch", "2", "--hatch-angle", "0", "--crop", "50,0,100,100"];
    let half_mm = arranged_as(&round(), "a.plt", &options).0.length_mm() - 20.0 * std::f64::consts::PI;
    assert!((half_mm - 100.0 * std::f64::consts::PI).abs() < 15.0, "{half_mm}");
    let crossed = round().replace("IN;SP1;", "IN;SP1;PU0,2000;PD4000,2000;");
    let (hidden, _) = arranged_as(&crossed, "a.plt", &["--occlude"]);
    let line_mm = hidden.length_mm() - arranged_as(&round(), "a.plt", &[]).0.length_mm();
    assert!((line_mm - 60.0).abs() < 0.05, "{line_mm}");
    let (_, said) = arranged_as(LINES, "a.plt", &["--hatch", "1"]);
    assert!(said.contains("--hatch: no stroke is closed"), "{said}");
}

#[test]
fn what_is_seen_of_a_hidden_shape_is_hatched() {
    // Two squares of 40 mm: the second one, of another pen, hides the right half of the first one. A third is
    // drawn in the second, a hole.
    let square = |pen: u32, x: u32, y: u32, side: u32| {
        let (right, upper) = (x + side, y + side);
        format!("SP{pen};PU{x},{y};PD{right},{y},{right},{upper},{x},{upper},{x},{y};PU;")
    };
    let text = format!("IN;{}{}", square(1, 400, 400, 1600), square(2, 1200, 400, 1600));
    let hatched_mm = |text: &str| {
        let of = |options: &[&str]| arranged_into("b.plt", text, "a.plt", options).0;
        let (plain, both) = (of(&["--occlude"]), of(&["--occlude", "--hatch", "2", "--hatch-angle", "0"]));
        [1, 2].map(|pen| both.of_pen(pen).length_mm() - plain.of_pen(pen).length_mm())
    };
    // 20 lines each, of 20 mm and of 40 mm: area through distance.
    let [lower, upper] = hatched_mm(&text);
    assert!((lower - 400.0).abs() < 0.1 && (upper - 800.0).abs() < 0.1, "{lower} {upper}");
    let holed = text.clone() + &square(2, 1600, 800, 800);
    let [lower, upper] = hatched_mm(&holed);
    assert!((lower - 400.0).abs() < 0.1 && (upper - 600.0).abs() < 0.1, "{lower} {upper}");
}

#[test]
fn a_picture_is_hatched_where_its_shapes_are_seen() {
    // Squares of 40 mm, the second over the right half of the first one.
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100'>\
               <path d='M10 10H50V50H10Z' fill='#f00'/><path d='M30 10H70V50H30Z' fill='#00f'/></svg>";
    let hatch = ["--hatch", "2", "--hatch-angle", "0"];
    // Whatever its size on the sheet, the distance is 2 mm; turned by a quarter the lines are still level.
    for (placed, scale) in [
        (&[][..], 1.0),
        (&["--scale", "0.5"], 0.5),
        (&["--fit", "120x200", "--rotate", "90", "--mirror", "y"], 3.0),
    ] {
        let of = |options: &[&str]| arranged_into("b.plt", svg, "a.svg", options).0;
        let plain = of(&[&["--occlude"], placed].concat());
        let both = of(&[&["--occlude"], &hatch[..], placed].concat());
        let lines_mm = [1, 2].map(|pen| both.of_pen(pen).length_mm() - plain.of_pen(pen).length_mm());
        let area_mm2 = [20.0 * 40.0, 40.0 * 40.0].map(|area| area * scale * scale);
        for (length_mm, area_mm2) in lines_mm.iter().zip(area_mm2) {
            // A row more or less.
            let row_mm = 80.0 * scale;
            assert!((length_mm - area_mm2 / 2.0).abs() <= row_mm, "{placed:?}: {lines_mm:?} {area_mm2}");
        }
        let level = both.strokes.iter().filter(|stroke| stroke.segments.len() == 1);
        assert!(
            level.clone().count() > 10
                && level.clone().all(|stroke| (stroke.to().y - stroke.from.y).abs() < 0.03),
            "{placed:?}"
        );
    }
    let open = svg.replace("fill='", "fill='none' stroke-dasharray='1' stroke='");
    let (_, said) = arranged_as(&open, "a.svg", &["--occlude", "--hatch", "2"]);
    assert!(said.contains("--hatch: no stroke is closed"), "{said}");
}

#[test]
fn a_plot_goes_on_at_a_line_with_its_pen() {
    let folder = Folder::new();
    let (from, to) = (folder.write("a.plt", LINES), folder.file("b.plt"));
    for (line, expected) in [("2", "SP2;\nPU1600,1200;"), ("3", "SP1;\nPU1200,400;\nPD810,400;")] {
        let output = run_example("convert", &[&from, &to, "--from-line", line]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(&to).unwrap();
        assert!(text.contains(expected) && !text.contains("PD800,400"), "{line}: {text}");
    }
    // In the middle of a stroke: from where the pen is, with the speed and the power that hold there.
    let gcode = folder.write("a.gcode", "G21 G90\nM4 S500\nG1 X10 Y0 F600\nX20\nX30\nM5\n");
    let output = run_example(
        "convert",
        &[&gcode, &folder.file("c.gcode"), "--from-line", "5", "--gcode-pen", "laser"],
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(folder.file("c.gcode")).unwrap();
    assert!(text.contains("G0 X20 Y0\nM4 S500\nG1 X30 Y0 F600"), "{text}");
}

#[test]
fn a_plot_goes_on_at_a_layer() {
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' width='100mm' height='60mm' \
               viewBox='0 0 100 60' stroke='#000'><g inkscape:groupmode='layer' inkscape:label='one'><path d='M0 60H20'/></g>\
               <g inkscape:groupmode='layer' inkscape:label='two'><path d='M0 50H20'/></g></svg>";
    for layer in ["two", "TWO", "2"] {
        let (drawing, _) = arranged_as(svg, "a.svg", &["--from-layer", layer]);
        assert_eq!(drawing.strokes.len(), 1);
        assert!(drawing.strokes[0].from.distance(Point::new(0.0, 10.0)) < DIGIT_MM);
    }
    let folder = Folder::new();
    let from = folder.write("a.svg", svg);
    let said = complaint("convert", &[&from, &folder.file("b.svg"), "--from-layer", "three"]);
    assert!(said.ends_with("--from-layer: the drawing has no layer three: it has one, two"), "{said}");
}

#[test]
fn the_stepper_plans_what_was_arranged() {
    let folder = Folder::new();
    let from = folder.write("a.plt", LINES);
    let output = run_example("stepper", &[&from, "--scale", "3", "--estimate"]);
    let text = String::from_utf8(output.stdout).unwrap();
    let down = text.lines().find(|line| line.contains("pen down")).unwrap();
    assert!(down.contains("119.2 mm") || down.contains("119.3 mm"), "{text}");
}

#[test]
fn what_cannot_be_done_is_said_in_one_line() {
    let folder = Folder::new();
    let (from, to) = (folder.write("a.plt", LINES), folder.file("b.svg"));
    for (options, expected) in [
        (&["--margin", "5"][..], "--margin and --landscape belong to a page: give --fit or --center"),
        (&["--center"], "the drawing has no page of its own: give one, as --center=A4"),
        (&["--fit", "20x20", "--margin", "10"], "0.0 x 0.0 mm are left of the page within its margins"),
        (&["--from-layer", "1"], "--from-layer: the drawing has no layer 1: it has none"),
        (
            &["--from-line", "99"],
            "--from-line 99: the file has 4 lines, and line 3 is the last one that draws",
        ),
        (
            &["--from-line", "4"],
            "--from-line 4: nothing is drawn from there on: line 3 is the last one that draws",
        ),
        (&["--crop", "500,500,1,1"], "nothing is drawn"),
    ] {
        let said = complaint("convert", &[&[from.as_str(), &to][..], options].concat());
        assert!(said.contains(expected), "{options:?}: {said}");
        assert!(!Path::new(&to).exists());
    }
    for options in [
        &["--scale", "0"][..],
        &["--fit", "A9"],
        &["--crop", "1,2,3"],
        &["--crop", "1,2,3,4,5,6,7"],
        &["--order", "quick"],
        &["--from-line", "0"],
        &["--scale", "2", "--fit", "A4"],
    ] {
        let output = run_example("convert", &[&[from.as_str(), &to][..], options].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}");
    }
}
