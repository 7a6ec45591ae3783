//! The command `convert` on SVG pictures: what their authors meant by layers, paper, clip paths and the size of the page.

use crate::built_example::{Folder, complaint, run_example};
use plotter_examples::drawings::{DrawingFile, Reading, SvgReading};
use plotter_motion::PlotOp;
use std::path::Path;

/// What single precision leaves, mm.
const ROUNDING_MM: f64 = 1e-3;

/// A sheet of 100 x 60 mm with this in it.
fn sheet(content: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' width='100mm' \
         height='60mm' viewBox='0 0 100 60' fill='none' stroke='#000'>{content}</svg>"
    )
}

fn converted(content: &str, to: &str, options: &[&str]) -> (String, String) {
    let folder = Folder::new();
    let (from, to) = (folder.write("a.svg", content), folder.file(to));
    let output = run_example("convert", &[&[from.as_str(), &to][..], options].concat());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    (std::fs::read_to_string(to).unwrap(), said)
}

fn refused(content: &str) -> String {
    let folder = Folder::new();
    let (from, to) = (folder.write("a.svg", content), folder.file("b.plt"));
    complaint("convert", &[&from, &to])
}

#[test]
fn the_page_of_an_svg_keeps_its_size() {
    let a4 = "<svg xmlns='http://www.w3.org/2000/svg' width='210mm' height='297mm' viewBox='0 0 210 297' stroke='#000'>\
              <path d='M10 200H100'/></svg>";
    let (once, _) = converted(a4, "b.svg", &[]);
    assert!(once.contains("width=\"210mm\" height=\"297mm\" viewBox=\"0 -297 210 297\""), "{once}");
    assert!(once.contains("M10 97L100 97"), "{once}");
    // And again.
    let (twice, _) = converted(&once, "b.svg", &[]);
    assert_eq!(once, twice);
}

#[test]
fn layers_are_pens_where_that_is_asked_for() {
    let layer = |name: &str, y: u32| {
        format!("<g inkscape:groupmode='layer' inkscape:label='{name}'><path d='M10 {y}H90'/></g>")
    };
    let three = sheet(&format!("{}{}{}", layer("3 thick", 10), layer("1 thin", 20), layer("2 medium", 30)));
    let pens = |options: &[&str]| {
        let (text, _) = converted(&three, "b.plt", options);
        text.split(';')
            .filter_map(|word| word.trim().strip_prefix("SP"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(pens(&["--pens", "layer"])[..3], ["3", "1", "2"]);
    assert_eq!(pens(&["--pens", "order"])[..3], ["1", "2", "3"]);
    assert_eq!(pens(&["--pens", "colour"])[..1], ["1"]);
    let named = sheet(&format!("{}{}", layer("!1+D250+S40 walls", 10), layer("%2 notes", 20)));
    let (text, said) = converted(&named, "b.gcode", &[]);
    assert!(said.contains("layer \"%2 notes\" is left out, as the % in its name asks"), "{said}");
    assert!(said.contains("asks for a pause before it (!) and 40 % of the speed (+S)"), "{said}");
    assert!(text.contains("G4 P0.25"), "{text}");
}

#[test]
fn the_colour_of_the_paper_is_an_option() {
    let white = sheet("<path d='M5 5H40' stroke='white'/>");
    let why = refused(&white);
    assert!(
        why.contains("nothing is drawn by it")
            && why.contains("no ink on white paper")
            && why.contains("--paper"),
        "{why}"
    );
    for paper in ["none", "black", "#102030"] {
        let (text, _) = converted(&white, "b.plt", &["--paper", paper]);
        assert!(text.contains("PU200,2200;"), "{paper}: {text}");
    }
    let folder = Folder::new();
    let from = folder.write("a.svg", &white);
    let wrong = run_example("convert", &[&from, &folder.file("b.plt"), "--paper", "papyrus"]);
    let wrong = String::from_utf8(wrong.stderr).unwrap();
    assert!(wrong.contains("give a colour of CSS"), "{wrong}");
}

#[test]
fn a_picture_of_text_alone_says_what_it_needs() {
    let why = refused(&sheet("<text x='5' y='15'>My Sign</text>"));
    assert!(why.contains("nothing is drawn by it"), "{why}");
    assert!(
        why.contains("line 1: a text is left out: give a font with --font FILE, or --single-stroke"),
        "{why}"
    );
    let why = refused(&sheet("<text x='5' y='15' font-family='Dialog'>My Sign</text>"));
    assert!(why.contains("give a font with --font FILE (Dialog is asked for), or --single-stroke"), "{why}");
}

#[test]
fn texts_are_drawn_in_letters_of_one_line_where_that_is_asked_for() {
    // 17.14 mm: a step of the letters is a mm, and the ink begins one and a half within.
    let text = sheet(
        "<text x='10' y='40' font-family='Dialog' font-size='17.142857' fill='#000' stroke='none'>L.</text>",
    );
    let (plt, said) = converted(&text, "b.plt", &["--single-stroke"]);
    assert!(plt.contains("PU460,1280;") && plt.contains("460,800") && plt.contains("780,800"), "{plt}");
    assert_eq!(said, "");
    // The dot is a dot.
    assert!(plt.contains("PU900,800;\nPD;\nPU;"), "{plt}");
    let (_, said) =
        converted(&sheet("<path d='M0 0H9'/>\n<text y='9'>5 €</text>"), "b.plt", &["--single-stroke"]);
    assert!(
        said.contains("line 2: a text is left out: neither the letters of one line nor a font given has €"),
        "{said}"
    );
}

#[test]
fn clip_paths_cut_unless_all_is_asked_for() {
    let clip = sheet(
        "<clipPath id='c'><circle cx='50' cy='30' r='20'/></clipPath><path d='M0 30H100' clip-path='url(#c)'/>",
    );
    let (cut, said) = converted(&clip, "b.plt", &[]);
    assert!(cut.contains("PU1200,1200;") && cut.contains("2800,1200"), "{cut}");
    assert!(said.contains("a clip path is applied"), "{said}");
    let (whole, said) = converted(&clip, "b.plt", &["--keep-clipped"]);
    assert!(whole.contains("4000,1200") && !said.contains("clip path"), "{whole} {said}");
    let hidden =
        sheet("<path d='M0 30H100'/><rect x='20' y='10' width='60' height='40' fill='#fff' stroke='none'/>");
    let (text, said) = converted(&hidden, "b.plt", &["--occlude"]);
    assert!(text.contains("PD800,1200;") && said.contains("hidden by filled shapes"), "{text} {said}");
}

#[test]
fn pixels_of_older_programs_have_their_size() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' width='720' height='720'><path d='M0 720H72' stroke='#000'/></svg>";
    for (option, length_mm) in [("96", 19.05), ("90", 20.32), ("72", 25.4)] {
        let how = SvgReading { px_per_inch: option.parse().unwrap(), ..SvgReading::default() };
        let folder = Folder::new();
        let path = folder.write("a.svg", text);
        let file = DrawingFile::open(Path::new(&path), None).unwrap().with_svg(&how).unwrap();
        let ops: Vec<PlotOp> = file.ops(Reading::default()).unwrap().map(Result::unwrap).collect();
        let end = ops.iter().filter_map(|op| op.target()).next_back().unwrap();
        assert!((end.x - length_mm).abs() < ROUNDING_MM && end.y.abs() < ROUNDING_MM, "{option}: {end:?}");
    }
}

#[test]
fn what_is_wrong_with_a_path_has_its_place() {
    let (_, said) = converted(&sheet("\n<path d='M5 5H40 L nan 3'/>"), "b.plt", &[]);
    assert!(said.contains("line 2, column 20: a path is wrong at nan: what comes before is drawn"), "{said}");
}
