//! One row for each kind of thing that an SVG file may say, and what a pen draws of it.

use super::tests::{file, read, read_with};
use super::*;
use crate::stroke::PxPoint;

/// The strokes in short: places rounded to a tenth of a px, joined by blanks, strokes by bars.
pub(super) fn short(read: &SvgDrawing) -> String {
    let round = |px: f64| libm::round(px * 10.0) / 10.0 + 0.0;
    let place = |at: &PxPoint| format!("{},{}", round(at.x), round(at.y));
    let stroke = |stroke: &[PxPoint]| stroke.iter().map(place).collect::<Vec<_>>().join(" ");
    read.drawing.strokes().map(stroke).collect::<Vec<_>>().join(" | ")
}

pub(super) fn told(read: &SvgDrawing) -> Vec<String> {
    let told = |problem: &SvgProblem| format!("{}:{}: {}", problem.line, problem.column, problem.text);
    read.problems.iter().map(told).collect()
}

/// The line from (0, 50) to (100, 50) with these attributes, behind these elements.
pub(super) fn line(elements: &str, attributes: &str) -> String {
    short(&read(&format!("{elements}<path d='M0 50H100' stroke='#000' {attributes}/>")))
}

#[test]
fn any_paint_but_none_is_ink() {
    let inked = [
        "stroke='currentColor'",
        "stroke='currentcolor'",
        "stroke='CURRENTCOLOR'",
        "style='stroke:currentcolor'",
        "style='STROKE:Red'",
        "color='oklch(0.5 0.1 20)' stroke='currentColor'",
        "stroke='oklch(50% 0.1 20)'",
        "stroke='color(display-p3 1 0 0)'",
        "stroke='color-mix(in srgb, red, blue)'",
        "stroke='device-cmyk(0 1 1 0)'",
        "stroke='#CD853F icc-color(acmecmyk, 0.11, 0.48, 0.83, 0.00)'",
        "stroke='hsl(120deg 100% 25%)'",
        "stroke='rgb(10 20 30 / 50%)'",
        "stroke='var(--none)'",
        "stroke='var(--none, blue)'",
        "style='--ink: green; stroke: var(--ink) !important'",
        "stroke='CanvasText'",
        "stroke='url(#missing)'",
        "stroke='url(#flat)'",
        "stroke='url(other.svg#a)'",
        "stroke='light-dark(black, white)'",
        "class='a'",
        // What is no declaration takes nothing with it.
        "style='fill:;stroke:red'",
        "style='fill none;stroke:red'",
        "style='--a:{};/* x */stroke:red;;'",
        "style='*zoom:1;stroke:red'",
    ];
    let sheet = "<style>/* of: no */ .a { Stroke: CurrentColor; } @media print { path { stroke: none } }</style>\
                 <linearGradient id='flat'><stop stop-color='red'/><stop offset='1'/></linearGradient>";
    for attributes in inked {
        let read = read(&format!("{sheet}<path d='M0 50H100' {attributes}/>"));
        assert_eq!(short(&read), "0,50 100,50", "{attributes}");
    }
    for attributes in
        ["stroke='none'", "stroke='NONE'", "stroke='transparent'", "stroke='initial'", "fill='red'"]
    {
        let read = read(&format!("{sheet}<path d='M0 50H100' {attributes}/>"));
        assert_eq!(short(&read), "", "{attributes}");
    }
}

#[test]
fn colours_of_css_are_colours() {
    let colour =
        |stroke: &str| read(&format!("<path d='M0 50H100' stroke='{stroke}'/>")).pens[0].colour.to_string();
    // rgb(0, 128, 0) each, by the examples of CSS Color Level 4.
    for green in [
        "green",
        "GREEN",
        "hwb(120 0% 49.8039%)",
        "oklch(51.975% 0.17686 142.495)",
        "color(srgb 0 0.50196 0)",
    ] {
        assert_eq!(colour(green), "#008000", "{green}");
    }
    assert_eq!(colour("var(--a, var(--b, #123456))"), "#123456");
}

#[test]
fn layers_are_pens_by_their_numbers_or_their_order() {
    let layer = |name: &str| {
        format!("<g inkscape:groupmode='layer' inkscape:label='{name}'><path d='M0 0H9' stroke='#000'/></g>")
    };
    let pens = |content: &str, pens| {
        let read = read_with(content, SvgOptions { pens, ..SvgOptions::default() });
        (0..read.drawing.strokes().len()).map(|stroke| read.drawing.pen(stroke)).collect::<Vec<_>>()
    };
    let three = ["3 thick", "1 thin", "2 medium"].map(layer).concat();
    assert_eq!(pens(&three, SvgPens::ByLayer), [3, 1, 2]);
    assert_eq!(pens(&three, SvgPens::ByOrder), [1, 2, 3]);
    assert_eq!(pens(&three, SvgPens::ByColour), [1, 1, 1]);
    // Without a number, the next that none has; the same number is the same pen; layers in a group are
    // layers.
    let mixed = format!(
        "{}<g>{}{}</g>{}",
        layer("walls"),
        layer("1-doors"),
        layer("!7+D500 roof"),
        layer("1 windows")
    );
    assert_eq!(pens(&mixed, SvgPens::ByLayer), [2, 1, 7, 1]);
    let read = read(&format!("{mixed}{}", layer("% notes")));
    let layers: Vec<(&str, Option<usize>)> =
        read.layers.iter().map(|layer| (layer.name.as_str(), layer.first_stroke)).collect();
    let names = [
        ("walls", Some(0)),
        ("1-doors", Some(1)),
        ("!7+D500 roof", Some(2)),
        ("1 windows", Some(3)),
        ("% notes", None),
    ];
    assert_eq!(layers, names);
    assert_eq!(
        (read.layers[2].pauses, read.layers[2].delay_ms, read.layers[4].is_left_out),
        (true, Some(500), true)
    );
}

#[test]
fn pixels_have_the_size_that_is_asked_for() {
    let px = "<svg xmlns='http://www.w3.org/2000/svg' width='72' height='144'/>";
    let mm = "<svg xmlns='http://www.w3.org/2000/svg' width='210mm' height='297mm' viewBox='0 0 210 297'/>";
    for (text, px_per_inch, width_mm) in
        [(px, 72.0, 25.4), (px, 96.0, 19.05), (px, 90.0, 20.32), (mm, 72.0, 210.0), (mm, 90.0, 210.0)]
    {
        let options = SvgOptions { px_per_inch, ..SvgOptions::default() };
        let read = read_svg(text.as_bytes(), &options).unwrap();
        assert!((read.width_mm - width_mm).abs() < 1e-3, "{} for {width_mm}", read.width_mm);
    }
    let refused = read_svg(px.as_bytes(), &SvgOptions { px_per_inch: 0.0, ..SvgOptions::default() });
    assert!(refused.unwrap_err().to_string().starts_with("px per inch: 0 lies outside 10..=10000"));
}

#[test]
fn what_comes_before_an_error_is_drawn_and_the_error_told() {
    let rows = [
        ("<path d='M0 50H100 L5 x9' stroke='#000'/>", "0,50 100,50", "2:23: a path is wrong at x9"),
        ("<path d='M0 50H100 L5 NaN 7' stroke='#000'/>", "0,50 100,50", "2:23: a path is wrong at NaN"),
        ("<path d='M0 50H100 L5' stroke='#000'/>", "0,50 100,50", "2:22: a path is wrong at its end"),
        (
            "<path d='M0 50H100 L5 -1e30 7 8' stroke='#000'/>",
            "0,50 100,50",
            "2:24: 1e30 is no place on a sheet",
        ),
        ("<path d='M0 50H100 Lnan 3 L1e30 8' stroke='#000'/>", "0,50 100,50", "2:21: a path is wrong at nan"),
        ("<path d='M0 50\nH100 foo' stroke='#000'/>", "0,50 100,50", "3:6: a path is wrong at foo"),
        (
            "<polyline points='0 50 100,50 9 nan 4' fill='none' stroke='#000'/>",
            "0,50 100,50",
            "2:33: a list of places is wrong at nan",
        ),
        (
            "<polyline points='0 50 100,50 9' fill='none' stroke='#000'/>",
            "0,50 100,50",
            "2:19: the last place has an x",
        ),
        ("<line x1='nan' x2='100' y1='50' y2='50' stroke='#000'/>", "0,50 100,50", "2:11: x1 holds nan"),
        (
            "<path transform='scale(nan)' d='M0 50H100' stroke='#000'/>",
            "0,50 100,50",
            "2:18: transform holds scale(nan)",
        ),
    ];
    for (content, expected, problem) in rows {
        let read = read(&format!("\n{content}"));
        assert_eq!(short(&read), expected, "{content}");
        assert!(
            told(&read).first().is_some_and(|told| told.starts_with(problem)),
            "{content}: {:?}",
            told(&read)
        );
    }
}

#[test]
fn an_element_with_a_number_that_is_no_place_is_left_out_and_told_and_the_rest_is_drawn() {
    let rows = [
        (
            "<line x1='1e30' x2='100' y1='50' y2='50'/>",
            "2:11: x1 holds 1e30, which is no place on a sheet: the line is left out",
        ),
        ("<line x1='0' x2='-1e30' y1='50' y2='50'></line>", "2:19: x2 holds 1e30"),
        (
            "<rect x='1e30' y='1' width='5' height='5'/>",
            "2:10: x holds 1e30, which is no place on a sheet: the rect is left out",
        ),
        ("<rect x='1' y='1' width=' 1e30mm' height='5' rx='1'>\n</rect >", "2:27: width holds 1e30"),
        (
            "<circle cx='9' cy='9' r='99999999999999999999999999999999999'/>",
            "2:26: r holds 999999999999999999999999…",
        ),
        ("<ellipse cx='9' cy='1e400' rx='1' ry='1'/>", "2:21: cy holds 1e400"),
        (
            "<use href='#shape' x='1e13'/>",
            "2:23: x holds 1e13, which is no place on a sheet: the use is left out",
        ),
        ("<g transform='translate(1e30 5)'><path d='M0 0H5'/><g><g/></g></g>", "2:25: transform holds 1e30"),
        ("<path transform='matrix(1 0 0 1 1e30 0)' d='M0 0H5'/>", "2:33: transform holds 1e30"),
        ("<svg x='1e30' width='9' height='9'><path d='M0 0H5'/></svg>", "2:9: x holds 1e30"),
        (
            "<s:svg xmlns:s='http://www.w3.org/2000/svg' viewBox='0 0 1e30 5'><s:path d='M0 0H5'/></s:svg>",
            "2:58: viewBox holds 1e30",
        ),
        (
            "<text x='1 2 1e30' y='5'>svg text</text>",
            "2:14: x holds 1e30, which is no place on a sheet: the text is left out",
        ),
        (
            "<linearGradient id='f' x1='1e30'><stop stop-color='red'/></linearGradient>",
            "2:28: x1 holds 1e30, which is no place on a sheet: it is taken as if it were not there",
        ),
        ("<line x1='&far;' x2='100' y1='50' y2='50'/>", "2:11: x1 holds 1e30"),
        // Others whose size depends on boxes.
        ("<line style='transform-box:fill-box;rotate:9deg' x1='1e30' x2='100'/>", "2:54: x1 holds 1e30"),
    ];
    for (content, problem) in rows {
        let text = file(&format!("\n{content}<path id='shape' d='M0 50H100' stroke='url(#f) #000'/>"));
        let text = format!(
            "<!DOCTYPE svg [<!ENTITY far '1e30'>]>{}",
            text.replacen("<svg", "<svg stroke='#000' fill='none'", 1)
        );
        let read = read_svg(text.as_bytes(), &SvgOptions::default())
            .unwrap_or_else(|error| panic!("{content}: {error}"));
        assert_eq!(short(&read), "0,50 100,50", "{content}");
        let told = told(&read);
        assert!(told.len() == 1 && told[0].starts_with(problem), "{content}: {told:?}");
        assert_eq!(read.left_out.texts, 0, "{content}");
    }
    // Nothing is drawn without a sheet.
    let sheet = file("<path d='M0 50H100'/>").replacen("width=\"", "width=\"1e30", 1);
    assert!(
        matches!(read_svg(sheet.as_bytes(), &SvgOptions::default()), Err(SvgError::Number { line: 1, .. })),
        "{sheet}"
    );
}

#[test]
fn what_is_seen_of_each_shape_is_hatched() {
    // Squares of 50 px, the second over the right half of the first, a third in the second with the paper's
    // colour, and a clipped one.
    let shapes = "<clipPath id='c'><path d='M0 60H25V100H0'/></clipPath>\
        <path d='M0 0H50V50H0Z' fill='#f00'/><path d='M25 0H75V50H25Z' fill='#00f'/><path d='M30 10H70V40H30Z' fill='#fff'/>\
        <path d='M0 60H50V100H0Z' fill='#f00' clip-path='url(#c)'/><path d='M80 0H99V50Z' stroke='#000' fill='none' stroke-dasharray='3'/>";
    let mut hatching = plotter_motion::drawing::Hatching::default();
    let mm_per_px = 25.4 / 96.0;
    (hatching.distance_mm, hatching.angle_rad) = (2.0 * mm_per_px, 0.0);
    let options = SvgOptions { occludes: true, hatch: Some(hatching), ..SvgOptions::default() };
    let (plain, hatched) =
        (read_with(shapes, SvgOptions { hatch: None, ..options }), read_with(shapes, options));
    let of_pen = |read: &SvgDrawing, pen: u8| {
        let own = |index: &usize| read.drawing.pen(*index) == pen;
        (0..read.drawing.strokes().len())
            .filter(own)
            .map(|index| read.drawing.curve(index).length_px())
            .sum::<f64>()
    };
    let lines_px = [1, 2, 3].map(|pen| of_pen(&hatched, pen) - of_pen(&plain, pen));
    // Area through distance; the square in the second has no ink, but hides.
    let expected = [(25.0 * 50.0 + 25.0 * 40.0) / 2.0, (50.0 * 50.0 - 40.0 * 30.0) / 2.0, 0.0];
    assert!(
        lines_px.iter().zip(expected).all(|(px, expected)| (px - expected).abs() < 0.1),
        "{lines_px:?} {expected:?}"
    );
    assert_eq!((hatched.hatched, plain.hatched), (3, 0));
    let sloping = |angle_rad: f64| {
        let mut hatching = hatching;
        hatching.angle_rad = angle_rad;
        let read = read_with("<path d='M0 0H50V50H0Z'/>", SvgOptions { hatch: Some(hatching), ..options });
        let line = read.drawing.stroke(read.drawing.strokes().len() / 2).to_vec();
        (line[1].y - line[0].y) / (line[1].x - line[0].x)
    };
    // Counter-clockwise from the right on the sheet: upwards, which is against y here.
    assert!((sloping(0.5) + 0.5_f64.tan()).abs() < 1e-6, "{}", sloping(0.5));
    hatching.distance_mm = 0.0;
    let wrong = read_svg(
        file("<path d='M0 0H50V50H0Z'/>").as_bytes(),
        &SvgOptions { hatch: Some(hatching), ..options },
    )
    .unwrap_err();
    assert_eq!(wrong.to_string(), "svg: the distance of hatch lines is 0 mm: choose one above 0 mm");
}

#[test]
fn utf_16_with_its_mark_is_read() {
    let text = file("<path id='ä𝄞' d='M0 50H100' stroke='#000'/>").replacen(
        "<svg",
        "<?xml version='1.0' encoding='UTF-16'?><svg",
        1,
    );
    let units: Vec<u16> = core::iter::once(0xfeff).chain(text.encode_utf16()).collect();
    let low_first: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let high_first: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    for bytes in [&low_first, &high_first] {
        assert_eq!(short(&read_svg(bytes, &SvgOptions::default()).unwrap()), "0,50 100,50");
    }
    let cut = read_svg(&low_first[..41], &SvgOptions::default()).unwrap_err();
    assert_eq!(cut, SvgError::Encoding { byte: 40 });
    assert!(read_svg(&[0xff, 0xfe], &SvgOptions::default()).is_err());
}

#[test]
fn filters_are_counted_wherever_they_stand() {
    let read = read(
        "<filter id='f'/><style>.f{filter:blur(2px)}</style><path class='f' d='M0 50H100' stroke='#000'/>\
                     <path d='M0 60H100' stroke='#000' filter='url(#missing)'/>",
    );
    assert_eq!(short(&read), "0,50 100,50 | 0,60 100,60");
    assert_eq!(read.left_out.filters, 2);
}

#[test]
fn without_a_thread_the_callers_stack_does() {
    let parse = |text: &str| {
        let options = SvgOptions::default();
        super::parse(text.into(), &options, MAX_DEPTH_ON_CALLERS_STACK, [&parser_options(&options); 2], None)
    };
    let nested = |depth: usize| {
        file(&format!(
            "{}<path d='M0 50H100' stroke='#000'/>{}",
            "<g opacity='.9'>".repeat(depth),
            "</g>".repeat(depth)
        ))
    };
    // As small as that of wasm32.
    let on_small_stack = std::thread::Builder::new().stack_size(1 << 20);
    let done = on_small_stack
        .spawn(move || (parse(&nested(45)).map(|read| short(&read)), parse(&nested(60)).is_err()));
    assert_eq!(done.unwrap().join().unwrap(), (Ok("0,50 100,50".to_owned()), true));
}
