//! Texts in letters of one line: where they stand, and what is said of letters that are not there.

use super::tests::file;
use super::*;
use crate::stroke::PxPoint;
use plotter_motion::hpgl::letter_strokes;
use std::sync::LazyLock;

/// Steps of the letters' grid to the em: capitals, 12 of them, are 0.7 em high.
const STEPS_PER_EM: f64 = 12.0 / 0.7;
/// What single precision, and the font's own units, leave of a place, px.
const ROUNDING_PX: f64 = 2e-3;

static FONTS: LazyLock<SvgFonts> = LazyLock::new(SvgFonts::single_stroke);

fn read(content: &str) -> SvgDrawing {
    read_svg_with_fonts(file(content).as_bytes(), &SvgOptions::default(), &FONTS).unwrap()
}

/// The strokes of a letter of this size whose ink begins at a place, on the line at `y`.
fn letter_at(letter: char, size_px: f64, x: f64, y: f64) -> Vec<Vec<PxPoint>> {
    let px = size_px / STEPS_PER_EM;
    let strokes: Vec<Vec<Point>> = letter_strokes(letter).unwrap().map(Iterator::collect).collect();
    let left = strokes.iter().flatten().map(|at| at.x).fold(f64::INFINITY, f64::min);
    let place = |at: &Point| PxPoint::new(x + (at.x - left) * px, y - at.y * px);
    strokes.iter().map(|stroke| stroke.iter().map(place).collect()).collect()
}

fn is_near(stroke: &[PxPoint], expected: &[PxPoint]) -> bool {
    let near = |(at, to): (&PxPoint, &PxPoint)| at.distance(*to) < ROUNDING_PX;
    stroke.len() == expected.len() && stroke.iter().zip(expected).all(near)
}

#[test]
fn each_letter_is_drawn_by_its_own_strokes_each_once() {
    let letters = || ('!'..='~').chain('\u{a1}'..='\u{ff}').filter(|letter| *letter != '\u{ad}');
    let text = |letter: char| {
        let escaped = letter.to_string().replace('&', "&amp;").replace('<', "&lt;");
        // 17.14 px: a step is a px.
        format!("<text x='10' y='50' font-size='{STEPS_PER_EM}'>{escaped}</text>")
    };
    let read = read(&letters().map(text).collect::<String>());
    assert_eq!((read.left_out, &read.missing_fonts), (SvgLeftOut::default(), &SvgMissingFonts::default()));
    let mut found = read.drawing.strokes();
    for letter in letters() {
        let ink = letter_strokes(letter).unwrap().flatten().map(|at| at.x).fold(f64::INFINITY, f64::min);
        // Half of the gap of three steps comes before each letter; digits stand where they do on their grid.
        let left = 11.5 + if letter.is_ascii_digit() { ink } else { 0.0 };
        for expected in letter_at(letter, STEPS_PER_EM, left, 50.0) {
            let stroke = found.next().unwrap_or_default();
            assert!(is_near(stroke, &expected), "{letter}: {stroke:?}, not {expected:?}");
        }
    }
    assert_eq!(found.next(), None);
}

#[test]
fn dots_are_dots() {
    let dots = |text: &str| {
        let read = read(&format!("<text x='10' y='90' font-size='40'>{text}</text>"));
        read.drawing.strokes().filter(|stroke| stroke.len() == 1).count()
    };
    for (text, expected) in
        [("i", 1), (".", 1), (":", 2), ("Jiji", 3), ("ä", 2), ("L", 0), ("!?", 2), ("·", 1)]
    {
        assert_eq!(dots(text), expected, "{text}");
    }
}

#[test]
fn texts_are_set_as_in_other_fonts() {
    // The stem of an l, which is 2 steps wide and 5 to the next: at size 120 / 7 a step is a px.
    let size = "font-size='17.142857'";
    let stems = |content: &str| {
        let read = read(content);
        let round = |px: f64| libm::round(px * 100.0) / 100.0 + 0.0;
        read.drawing.strokes().map(|stroke| (round(stroke[0].x), round(stroke[0].y))).collect::<Vec<_>>()
    };
    let rows = [
        (format!("<text x='10' y='50' {size}>ll</text>"), vec![(11.5, 38.0), (16.5, 38.0)]),
        (
            format!("<text x='50' y='50' text-anchor='middle' {size}>ll</text>"),
            vec![(46.5, 38.0), (51.5, 38.0)],
        ),
        (format!("<text x='50' y='50' text-anchor='end' {size}>ll</text>"), vec![(41.5, 38.0), (46.5, 38.0)]),
        (
            format!("<text x='10' y='50' letter-spacing='4' {size}>ll</text>"),
            vec![(11.5, 38.0), (20.5, 38.0)],
        ),
        (format!("<text x='10' y='50' {size}>l l</text>"), vec![(11.5, 38.0), (21.5, 38.0)]),
        (
            format!("<text x='10' y='50' {size}>l<tspan x='40' dy='9'>l</tspan></text>"),
            vec![(11.5, 38.0), (41.5, 47.0)],
        ),
        (
            format!("<text x='10' y='50' {size}>l<tspan font-size='34.285714'>l</tspan></text>"),
            vec![(11.5, 38.0), (18.0, 26.0)],
        ),
        (format!("<text x='10' y='50' rotate='90' {size}>l</text>"), vec![(22.0, 51.5)]),
        (format!("<text transform='translate(10 50) scale(2)' {size}>l</text>"), vec![(13.0, 26.0)]),
        // Twice as long: twice as wide, or farther apart.
        (
            format!("<text x='10' y='50' textLength='20' lengthAdjust='spacingAndGlyphs' {size}>ll</text>"),
            vec![(13.0, 38.0), (23.0, 38.0)],
        ),
        (format!("<text x='10' y='50' textLength='20' {size}>ll</text>"), vec![(11.5, 38.0), (26.5, 38.0)]),
        // Equally wide, 11 steps each, for who asks for it: the l begins 3 steps within its cell.
        (
            format!("<text x='10' y='50' font-family='Courier, monospace' {size}>ll</text>"),
            vec![(14.5, 38.0), (25.5, 38.0)],
        ),
    ];
    for (content, expected) in rows {
        assert_eq!(stems(&content), expected, "{content}");
    }
    // The parser measures lengths of a path to half a unit.
    let along = format!(
        "<path id='p' d='M20 0V90' fill='none'/><text {size}><textPath xlink:href='#p'>ll</textPath></text>"
    );
    for ((x, y), (to_x, to_y)) in stems(&along).into_iter().zip([(32.0, 1.5), (32.0, 6.5)]) {
        assert!((x - to_x).abs() < 0.01 && (y - to_y).abs() < 0.5, "{x} {y}");
    }
}

#[test]
fn letters_that_are_stretched_are_lines_all_the_same() {
    for factor in [0.2, 3.0, 20.0] {
        let length = 10.0 * factor;
        let read = read(&format!(
            "<text y='50' textLength='{length}' lengthAdjust='spacingAndGlyphs' font-size='17.142857'>N</text>"
        ));
        assert_eq!(read.drawing.strokes().map(<[PxPoint]>::len).collect::<Vec<_>>(), [4], "{factor}");
    }
}

#[test]
fn lines_below_letters_are_lines() {
    let read = read("<text x='10' y='50' font-size='17.142857' text-decoration='underline'>L</text>");
    let strokes: Vec<&[PxPoint]> = read.drawing.strokes().collect();
    assert_eq!(strokes.iter().map(|stroke| stroke.len()).collect::<Vec<_>>(), [2, 3]);
    // As long as the letter with its gap, two steps below it.
    assert!((strokes[0][0].distance(strokes[0][1]) - 11.0).abs() < 0.01, "{strokes:?}");
    assert!((strokes[0][0].y - 52.0).abs() < 0.01, "{strokes:?}");
}

#[test]
fn quotation_marks_and_dashes_look_nearly_so() {
    let drawn = |text: &str| {
        let read = read(&format!("<text x='10' y='50' font-size='17.142857'>{text}</text>"));
        (read.drawing, read.left_out.texts)
    };
    for (fine, plain) in
        [("“a” ‘b’ it’s", "\"a\" 'b' it's"), ("1–2 — −3", "1-2 - -3"), ("5′ 3″", "5' 3\""), ("a\u{301}", "á")]
    {
        assert_eq!(drawn(fine), drawn(plain), "{fine}");
        assert_eq!(drawn(fine).1, 0, "{fine}");
    }
    let read = read("<text>\nA</text>\n<text y='9'>5 €, ☃</text>");
    assert_eq!((read.left_out.texts, read.left_out.text_line), (1, Some(3)));
    assert_eq!(read.missing_fonts, SvgMissingFonts { families: vec![], letters: "€☃".to_owned() });
}

#[test]
fn colours_strokes_and_clip_paths_are_those_of_texts() {
    let text = |attributes: &str| format!("<text x='10' y='50' font-size='17.142857' {attributes}>L</text>");
    let colour = |attributes: &str| read(&text(attributes)).pens.first().map(|pen| pen.name.clone());
    assert_eq!(colour("fill='red'").as_deref(), Some("#ff0000"));
    assert_eq!(colour("fill='none' stroke='blue'").as_deref(), Some("#0000ff"));
    assert_eq!(colour("fill='white'"), None);
    assert_eq!(colour("fill='none'"), None);
    assert_eq!(read(&text("fill='white'")).left_out.paper, 1);
    // Down 12 px and 8 px to the right, in dashes of 5 and gaps of 5.
    let dashed = read(&text("stroke='red' fill='none' stroke-dasharray='5'"));
    assert_eq!(dashed.drawing.strokes().len(), 2);
    let clipped = read(&format!(
        "<clipPath id='c'><rect width='99' height='45'/></clipPath>{}",
        text("clip-path='url(#c)'")
    ));
    assert_eq!(clipped.drawing.strokes().map(<[PxPoint]>::len).collect::<Vec<_>>(), [2]);
    // A letter of one line hides nothing.
    let options = SvgOptions { occludes: true, ..SvgOptions::default() };
    let over = file(&format!("<path d='M0 45H99' stroke='#000'/>{}", text("")));
    let over = read_svg_with_fonts(over.as_bytes(), &options, &FONTS).unwrap();
    assert_eq!((over.drawing.strokes().len(), over.left_out.occluded), (2, 0));
}

#[test]
fn the_font_is_the_same_always() {
    let fonts = SvgFonts::single_stroke();
    assert_eq!(fonts.families().collect::<Vec<_>>(), [single_stroke::FAMILY, single_stroke::MONOSPACED]);
    let bytes = single_stroke::font_file(false);
    assert_eq!(bytes, single_stroke::font_file(false));
    assert!(bytes.len() < 64 << 10, "{}", bytes.len());
}

#[test]
fn a_given_font_is_used_for_what_names_it() {
    // The equally wide letters under another name, as long.
    let utf_16 = |text: &str| text.encode_utf16().flat_map(u16::to_be_bytes).collect::<Vec<u8>>();
    let (name, other) = (utf_16(single_stroke::MONOSPACED), utf_16("Letters Of A Hand1"));
    let mut font = single_stroke::font_file(true);
    let at = font.windows(name.len()).position(|bytes| bytes == name).unwrap();
    font[at..at + name.len()].copy_from_slice(&other);
    let mut fonts = SvgFonts::single_stroke();
    fonts.add(font).unwrap();
    let apart = |attributes: &str| {
        let text = file(&format!("<text x='10' y='50' font-size='17.142857' {attributes}>ll</text>"));
        let read = read_svg_with_fonts(text.as_bytes(), &SvgOptions::default(), &fonts).unwrap();
        libm::round(read.drawing.stroke(1)[0].x - read.drawing.stroke(0)[0].x)
    };
    assert_eq!(apart("font-family='Letters Of A Hand1'"), 11.0);
    assert_eq!(apart("font-family='Missing, \"letters of a hand1\"'"), 11.0);
    for not_given in ["", "font-family='Missing'", "font-family='sans-serif'"] {
        assert_eq!(apart(not_given), 5.0, "{not_given}");
    }
}

#[test]
fn a_text_in_hpgl() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' width='60mm' height='20mm' viewBox='0 0 60 20'>\
                <text x='30' y='15' text-anchor='middle' font-size='10'>Grüße 1:2</text></svg>";
    let read = read_svg_with_fonts(text.as_bytes(), &SvgOptions::default(), &FONTS).unwrap();
    let mut written = String::new();
    crate::write::hpgl(&read.drawing, read.scale, &mut written).unwrap();
    insta::assert_snapshot!(written);
}
