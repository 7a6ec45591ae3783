//! Text of SVG files as outlines: places on the sheet to a hundredth of a millimetre, and what is said of
//! missing fonts.
#![cfg(feature = "svg-text")]

use crate::made_font;

use made_font::{font_with_blank, made_font};
use plotter_vector::{
    SvgOptions, read_svg,
    svg_in::{SvgDrawing, SvgFontError, SvgFonts, SvgPens, read_svg_with_fonts},
};

/// A sheet of 100 x 50 mm in units of a millimetre, with this on it.
fn sheet(content: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' width='100mm' height='50mm' \
         viewBox='0 0 100 50'>\n{content}\n</svg>"
    )
}

fn fonts(families: &[&str]) -> SvgFonts {
    let mut fonts = SvgFonts::default();
    for family in families {
        fonts.add(made_font(family)).unwrap();
    }
    fonts
}

fn read(content: &str) -> SvgDrawing {
    let read = read_svg_with_fonts(sheet(content).as_bytes(), &SvgOptions::default(), &fonts(&["Boxes"]));
    read.unwrap()
}

/// The corners of each stroke, mm from the upper left corner of the sheet, in hundredths.
fn corners(read: &SvgDrawing) -> Vec<Vec<(f64, f64)>> {
    let hundredths = |mm: f64| libm::round(mm * 100.0) / 100.0 + 0.0;
    let place = |at: &plotter_vector::PxPoint| {
        let on_sheet = read.scale.to_sheet(*at);
        (hundredths(on_sheet.x), hundredths(50.0 - on_sheet.y))
    };
    read.drawing.strokes().map(|stroke| stroke.iter().map(place).collect()).collect()
}

/// The box of a letter of 10 mm: 5 mm wide and 7 mm high.
fn box_at(x: f64, y: f64) -> Vec<(f64, f64)> {
    vec![(x, y), (x, y - 7.0), (x + 5.0, y - 7.0), (x + 5.0, y), (x, y)]
}

fn triangle_at(x: f64, y: f64) -> Vec<(f64, f64)> {
    vec![(x, y), (x + 2.5, y - 7.0), (x + 5.0, y), (x, y)]
}

#[test]
fn letters_stand_on_the_base_line_one_advance_apart() {
    let read = read("<text x='10' y='30' font-family='Boxes' font-size='10'>BV B</text>");
    assert_eq!(corners(&read), [box_at(10.0, 30.0), triangle_at(16.0, 30.0), box_at(28.0, 30.0)]);
    assert_eq!((read.left_out.texts, read.left_out.text_line), (0, None));
    // The sheet's own units come to the same millimetres.
    let in_px = "<g transform='scale(0.264583333)'><text x='1in' y='2cm' font-family='Boxes' font-size='10mm'>B</text></g>";
    let found = corners(&self::read(in_px));
    for ((x, y), (to_x, to_y)) in found[0].iter().zip(box_at(25.4, 20.0)) {
        assert!((x - to_x).abs() < 0.011 && (y - to_y).abs() < 0.011, "{found:?}");
    }
}

#[test]
fn anchors_shift_by_the_length_of_the_text() {
    let anchored = |anchor| {
        let text = format!(
            "<text x='50' y='30' font-family='Boxes' font-size='10' text-anchor='{anchor}'>BB</text>"
        );
        corners(&read(&text))
    };
    assert_eq!(anchored("start"), [box_at(50.0, 30.0), box_at(56.0, 30.0)]);
    assert_eq!(anchored("middle"), [box_at(44.0, 30.0), box_at(50.0, 30.0)]);
    assert_eq!(anchored("end"), [box_at(38.0, 30.0), box_at(44.0, 30.0)]);
}

#[test]
fn spacing_shifts_and_places_of_letters_count() {
    let text = |attributes: &str, content: &str| {
        let text =
            format!("<text x='10' y='30' font-family='Boxes' font-size='10' {attributes}>{content}</text>");
        corners(&read(&text))
    };
    assert_eq!(text("letter-spacing='2'", "BB"), [box_at(10.0, 30.0), box_at(18.0, 30.0)]);
    assert_eq!(text("word-spacing='3'", "B B"), [box_at(10.0, 30.0), box_at(25.0, 30.0)]);
    assert_eq!(text("dx='1 4' dy='0 2'", "BB"), [box_at(11.0, 30.0), box_at(21.0, 32.0)]);
    assert_eq!(
        text("", "B<tspan x='40' y='20'>V</tspan><tspan dy='-5'>B</tspan>"),
        [box_at(10.0, 30.0), triangle_at(40.0, 20.0), box_at(46.0, 15.0)]
    );
    // A size of its own: half of it is half as wide and high.
    let small = text("", "<tspan font-size='5'>B</tspan>B");
    assert_eq!(small[0][2], (12.5, 26.5));
    assert_eq!(small[1], box_at(13.0, 30.0));
}

#[test]
fn transforms_and_colours_are_those_of_other_shapes() {
    let read = read(
        "<g transform='translate(20 0) rotate(90)'><text x='10' y='0' font-family='Boxes' font-size='10' fill='red'>B\
         <tspan fill='none' stroke='blue'>B</tspan></text></g><text font-family='Boxes' fill='white' y='9'>B</text>",
    );
    // Turned to the right: along is down, up is right.
    assert_eq!(corners(&read)[0], [(20.0, 10.0), (27.0, 10.0), (27.0, 15.0), (20.0, 15.0), (20.0, 10.0)]);
    assert_eq!(corners(&read)[1][0], (20.0, 16.0));
    let pens: Vec<&str> = read.pens.iter().map(|pen| pen.name.as_str()).collect();
    assert_eq!((pens, read.left_out.paper), (vec!["#ff0000", "#0000ff"], 1));
}

#[test]
fn an_em_is_16_px_where_the_file_says_nothing() {
    let px = |content: &str| {
        let text =
            format!("<svg xmlns='http://www.w3.org/2000/svg' width='200' height='100'>{content}</svg>");
        let fonts = fonts(&["Boxes"]);
        let read = read_svg_with_fonts(text.as_bytes(), &SvgOptions::default(), &fonts).unwrap();
        let at = read.drawing.stroke(0)[2];
        (libm::round(at.x * 10.0) / 10.0, libm::round(at.y * 10.0) / 10.0)
    };
    // The upper right corner of the letter.
    assert_eq!(px("<text y='50'>B</text>"), (8.0, 38.8));
    assert_eq!(px("<text y='50' font-size='2em'>B</text>"), (16.0, 27.6));
    assert_eq!(px("<text y='50' font-size='150%'>B</text>"), (12.0, 33.2));
    assert_eq!(px("<text y='50' font-size='4ex'>B</text>"), (16.0, 27.6));
    assert_eq!(px("<text y='50' font-size='medium'>B</text>"), (8.0, 38.8));
    assert_eq!(px("<g font-size='20'><text y='50' font-size='.5em'>B</text></g>"), (5.0, 43.0));
    // Named sizes are their own, wherever they stand; only these two count from the size around them.
    assert_eq!(px("<g font-size='20'><text y='50' font-size='x-small'>B</text></g>"), (6.0, 41.6));
    assert_eq!(
        px("<g font-size='20'><text y='50' style='fill:red;font-size: XX-Large'>B</text></g>"),
        (16.0, 27.6)
    );
    assert_eq!(
        px("<style>text {font-size: medium !important}</style><g font-size='20'><text y='50'>B</text></g>"),
        (8.0, 38.8)
    );
    assert_eq!(px("<g font-size='20'><text y='50' font-size='larger'>B</text></g>"), (12.0, 33.2));
    assert_eq!(px("<g font-size='24'><text y='50' font-size='smaller'>B</text></g>"), (10.0, 36.0));
    // The same without text and without fonts.
    let rect = "<svg xmlns='http://www.w3.org/2000/svg' width='10em' height='4em'><rect width='2em' height='2ex' stroke='red'/></svg>";
    let read = read_svg(rect.as_bytes(), &SvgOptions::default()).unwrap();
    assert_eq!((read.drawing.width_px(), read.drawing.height_px()), (160, 64));
    let at = read.drawing.stroke(0)[2];
    assert_eq!((at.x, at.y), (32.0, 16.0));
}

#[test]
fn a_family_is_known_by_its_name_and_kinds_take_the_first_font() {
    let drawn = |families: &str| {
        let text = sheet(&format!("<text y='30' font-family=\"{families}\">B</text>"));
        let fonts = fonts(&["First One", "Boxes"]);
        let read = read_svg_with_fonts(text.as_bytes(), &SvgOptions::default(), &fonts).unwrap();
        (read.drawing.strokes().len(), read.missing_fonts.families)
    };
    for known in ["Boxes", "boxes", "'FIRST ONE'", "Arial, Boxes", "sans-serif", "Arial, monospace", ""] {
        assert_eq!(drawn(known), (1, vec![]), "{known}");
    }
    assert_eq!(drawn("Arial, 'Courier New'"), (0, vec!["Arial".to_owned()]));
    assert_eq!(fonts(&["First One", "Boxes"]).families().collect::<Vec<_>>(), ["Boxes", "First One"]);
}

#[test]
fn what_no_font_has_is_left_out_whole_counted_and_named() {
    let file = sheet(
        "<text y='20'>B</text>\n<text y='30' font-family='Missing'>VB</text>\n<text y='40'>B<tspan>☃é</tspan>B</text>\n\
         <text y='40' font-family='Other' visibility='hidden'>B</text><text font-family='Other'> </text>",
    );
    let options = SvgOptions::default();
    let read = read_svg_with_fonts(file.as_bytes(), &options, &fonts(&["Boxes"])).unwrap();
    assert_eq!(read.drawing.strokes().len(), 1);
    assert_eq!((read.left_out.texts, read.left_out.text_line), (2, Some(3)));
    assert_eq!(read.missing_fonts.families[0], "Missing");
    assert_eq!(read.missing_fonts.letters, "☃é");
    // Also where the font shows nothing for what it lacks.
    let mut blank = SvgFonts::default();
    blank.add(font_with_blank("Blank")).unwrap();
    let file = sheet("<text y='9'>☃☃</text><text y='9'>☃</text><text y='9'>B</text>");
    let read = read_svg_with_fonts(file.as_bytes(), &options, &blank).unwrap();
    assert_eq!((read.left_out.texts, read.drawing.strokes().len()), (2, 1));
    assert_eq!(read.missing_fonts.letters, "☃");
}

#[test]
fn without_fonts_all_texts_are_counted_and_their_families_named() {
    let file = sheet(
        "<text y='9' font-family='Boxes, serif'>B</text><path d='M0 0H9' stroke='red'/>\n<text>V</text>",
    );
    let options = SvgOptions::default();
    let none = read_svg_with_fonts(file.as_bytes(), &options, &SvgFonts::default()).unwrap();
    assert_eq!((none.left_out.texts, none.left_out.text_line), (2, Some(2)));
    assert_eq!(none.missing_fonts.families, ["Boxes"]);
    let mut plain = read_svg(file.as_bytes(), &options).unwrap();
    plain.missing_fonts = none.missing_fonts.clone();
    assert_eq!(plain, none);
}

#[test]
fn layers_and_clones_hold_texts() {
    let file = sheet(
        "<g id='names'><text id='t' y='20' font-family='Boxes' font-size='10'>B</text></g>\
         <g id='more'><use xlink:href='#t' x='30'/><path d='M0 0H9' stroke='red'/></g>",
    );
    let options = SvgOptions::default().with_pens(SvgPens::ByLayer);
    let read = read_svg_with_fonts(file.as_bytes(), &options, &fonts(&["Boxes"])).unwrap();
    assert_eq!(corners(&read)[..2], [box_at(0.0, 20.0), box_at(30.0, 20.0)]);
    assert_eq!((0..3).map(|stroke| read.drawing.pen(stroke)).collect::<Vec<_>>(), [1, 2, 2]);
}

#[test]
fn text_along_a_path_follows_it() {
    let along = |path: &str| {
        let text = format!(
            "<path id='p' d='{path}'/><text font-family='Boxes' font-size='10'><textPath xlink:href='#p'>BB</textPath></text>"
        );
        // The border of the path comes first where it has one.
        corners(&read(&text)).into_iter().filter(|stroke| stroke.len() == 5).collect::<Vec<_>>()
    };
    // The parser measures lengths of a path to half a unit at worst.
    let near = |found: &[(f64, f64)], expected: &[(f64, f64)]| {
        let off = |((x, y), (to_x, to_y)): (&(f64, f64), &(f64, f64))| libm::hypot(x - to_x, y - to_y);
        assert!(found.iter().zip(expected).map(off).all(|off_mm| off_mm < 0.1), "{found:?}");
    };
    let right = along("M10 30H90");
    near(&right[0], &box_at(10.0, 30.0));
    near(&right[1], &box_at(16.0, 30.0));
    near(&along("M10 10V45")[0], &[(10.0, 10.0), (17.0, 10.0), (17.0, 15.0), (10.0, 15.0), (10.0, 10.0)]);
    for odd in ["M10 30H12", "M10 30", "M10 30C40 30 40 30 10 30", "M0 0L1e-9 0", "M1 1h0"] {
        assert!(along(odd).len() < 3, "{odd}");
    }
    let nowhere = read("<text font-family='Boxes'><textPath xlink:href='#none'>BB</textPath></text>");
    assert_eq!(nowhere.drawing.strokes().len(), 0);
}

#[test]
fn lines_below_and_through_letters_are_drawn() {
    let read =
        read("<text x='10' y='30' font-family='Boxes' font-size='10' text-decoration='underline'>BB</text>");
    let strokes = corners(&read);
    assert_eq!(strokes.len(), 3);
    let (from, to) =
        strokes[0].iter().fold((100.0_f64, 0.0_f64), |(from, to), (x, _)| (from.min(*x), to.max(*x)));
    assert_eq!((from, to), (10.0, 22.0));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn no_text_and_no_bytes_bring_the_reader_down() {
    let mut fonts = fonts(&["Boxes"]);
    let font = made_font("Cut");
    for length in (0..font.len()).step_by(7) {
        // What is cut off may still be a font; then it is set as far as it goes.
        if fonts.add(font[..length].to_vec()).is_ok() {
            let text = sheet("<text font-family='Cut'>BV ☃</text>");
            assert!(read_svg_with_fonts(text.as_bytes(), &SvgOptions::default(), &fonts).is_ok());
        }
    }
    for position in 0..font.len() {
        let mut wrong = font.clone();
        wrong[position] ^= 0x81;
        let mut fonts = SvgFonts::default();
        if fonts.add(wrong).is_ok() {
            let text = sheet("<text font-size='9' text-decoration='underline'>BV ☃</text>");
            assert!(
                read_svg_with_fonts(text.as_bytes(), &SvgOptions::default(), &fonts).is_ok(),
                "{position}"
            );
        }
    }
    assert_eq!(fonts.add(Vec::new()), Err(SvgFontError::NoFont));
    assert_eq!(fonts.add(b"hello, world".to_vec()), Err(SvgFontError::NoFont));
    assert_eq!(fonts.add(b"wOF2\0\x01\0\0".to_vec()), Err(SvgFontError::WebFont));
    assert_eq!(fonts.add(b"ttcf\0\x01\0\0\xff\xff\xff\xff".to_vec()), Err(SvgFontError::NoFont));
    assert!(SvgFontError::WebFont.to_string().contains("give its .ttf"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn texts_without_measure_are_refused_before_they_are_set() {
    let fonts = fonts(&["Boxes"]);
    let refused = |content: &str| {
        let error =
            read_svg_with_fonts(sheet(content).as_bytes(), &SvgOptions::default(), &fonts).unwrap_err();
        assert!(error.to_string().contains("the texts are too long to be set"), "{error}");
    };
    refused(&format!("<text>{}</text>", "B".repeat(100_000)));
    refused(&format!("<text>{}</text>", "<tspan>B</tspan>".repeat(5000)));
    let clones = "<use xlink:href='#t'/>".repeat(10_000);
    refused(&format!("<text id='t'>{}</text>{clones}", "B".repeat(3000)));
    refused(&format!(
        "<desc id='d'>{}</desc>{}",
        "B".repeat(3000),
        "<text><tref xlink:href='#d'/></text>".repeat(10_000)
    ));
    // What is placed line by line is long, and short work.
    let line = |y: usize| format!("<tspan x='0' y='{y}'>{}</tspan>", "B".repeat(60));
    let page = format!("<text font-size='1'>{}</text>", (0..50).map(line).collect::<String>());
    let read = read_svg_with_fonts(sheet(&page).as_bytes(), &SvgOptions::default(), &fonts).unwrap();
    assert_eq!(read.drawing.strokes().len(), 3000);
}
