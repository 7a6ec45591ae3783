//! One row for each kind of thing that an SVG file may say, and what a pen draws of it.

use super::tests::{file, read, read_with};
use super::*;
use crate::PxPoint;

/// The strokes in short: places rounded to a tenth of a px, joined by blanks, strokes by bars.
fn short(read: &SvgDrawing) -> String {
    let round = |px: f64| libm::round(px * 10.0) / 10.0 + 0.0;
    let place = |at: &PxPoint| format!("{},{}", round(at.x), round(at.y));
    let stroke = |stroke: &[PxPoint]| stroke.iter().map(place).collect::<Vec<_>>().join(" ");
    read.drawing.strokes().map(stroke).collect::<Vec<_>>().join(" | ")
}

fn told(read: &SvgDrawing) -> Vec<String> {
    let told = |problem: &SvgProblem| format!("{}:{}: {}", problem.line, problem.column, problem.text);
    read.problems.iter().map(told).collect()
}

/// The line from (0, 50) to (100, 50) with these attributes, behind these elements.
fn line(elements: &str, attributes: &str) -> String {
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
fn clip_paths_cut_lines_where_they_end() {
    let square = "<clipPath id='c'><rect x='20' y='20' width='60' height='60'/></clipPath>";
    let rows = [
        (square, "clip-path='url(#c)'", "20,50 80,50"),
        (square, "style='clip-path:url(#c)'", "20,50 80,50"),
        // Its place is that of the element, and of its own transform.
        (square, "clip-path='url(#c)' transform='translate(10)'", "30,50 90,50"),
        (
            "<clipPath id='c' transform='translate(10)'><rect x='20' width='60' height='99'/></clipPath>",
            "clip-path='url(#c)'",
            "30,50 90,50",
        ),
        (
            "<clipPath id='c' clipPathUnits='objectBoundingBox'><rect width='.5' height='1'/></clipPath>",
            "clip-path='url(#c)'",
            "",
        ),
        // Two are both, several shapes are one.
        (
            "<clipPath id='d'><rect width='50' height='99'/></clipPath><clipPath id='c' clip-path='url(#d)'><rect x='20' width='60' height='99'/></clipPath>",
            "clip-path='url(#c)'",
            "20,50 50,50",
        ),
        (
            "<clipPath id='c'><rect x='10' width='10' height='99'/><rect x='15' width='15' height='99'/><rect x='50' width='9' height='99'/></clipPath>",
            "clip-path='url(#c)'",
            "10,50 30,50 | 50,50 59,50",
        ),
        // The ring, by either rule.
        (
            "<clipPath id='c'><path clip-rule='evenodd' d='M10 10H90V90H10ZM30 30H70V70H30Z'/></clipPath>",
            "clip-path='url(#c)'",
            "10,50 30,50 | 70,50 90,50",
        ),
        (
            "<clipPath id='c'><path d='M10 10H90V90H10ZM30 30H70V70H30Z'/></clipPath>",
            "clip-path='url(#c)'",
            "10,50 90,50",
        ),
        (
            "<clipPath id='c'><path d='M10 10H90V90H10ZM30 30V70H70V30Z'/></clipPath>",
            "clip-path='url(#c)'",
            "10,50 30,50 | 70,50 90,50",
        ),
        // On its edge is in it.
        (
            "<clipPath id='c'><rect x='20' y='50' width='60' height='9'/></clipPath>",
            "clip-path='url(#c)'",
            "20,50 80,50",
        ),
        ("<clipPath id='c'/>", "clip-path='url(#c)'", ""),
        ("", "clip-path='url(#missing)'", "0,50 100,50"),
        (
            "<clipPath id='c'><circle cx='50' cy='50' r='30'/></clipPath>",
            "clip-path='url(#c)'",
            "20,50 80,50",
        ),
        (
            "<rect id='r' x='20' width='60' height='99' fill='none'/><clipPath id='c'><use href='#r'/></clipPath>",
            "clip-path='url(#c)'",
            "20,50 80,50",
        ),
        // Dashes are cut, too, where they were.
        (square, "clip-path='url(#c)' stroke-dasharray='30 20'", "20,50 30,50 | 50,50 80,50"),
    ];
    for (elements, attributes, expected) in rows {
        assert_eq!(line(elements, attributes), expected, "{elements} {attributes}");
    }
}

#[test]
fn groups_clones_and_nested_sheets_cut_too() {
    let path = "<path d='M0 50H100' stroke='#000'/>";
    let clip = "<clipPath id='c'><rect x='20' y='20' width='60' height='60'/></clipPath>";
    let rows = [
        (format!("{clip}<g clip-path='url(#c)'><g transform='translate(5)'>{path}</g></g>"), "20,50 80,50"),
        (
            format!(
                "{clip}<g clip-path='url(#c)'><g clip-path='url(#c)' transform='translate(30)'>{path}</g></g>"
            ),
            "50,50 80,50",
        ),
        (
            format!("{clip}<defs><g id='g'>{path}</g></defs><use href='#g' clip-path='url(#c)'/>"),
            "20,50 80,50",
        ),
        (format!("<svg x='10' y='10' width='50' height='50'>{path}</svg>"), "10,60 60,60"),
        (
            format!("<svg x='10' y='10' width='50' height='50' overflow='visible'>{path}</svg>"),
            "10,60 110,60",
        ),
        (
            format!(
                "<symbol id='s' viewBox='0 0 50 50'>{path}</symbol><use href='#s' width='50' height='50'/>"
            ),
            "0,50 50,50",
        ),
    ];
    for (content, expected) in rows {
        assert_eq!(short(&read(&content)), expected, "{content}");
        let kept = read_with(&content, SvgOptions { keeps_clipped: true, ..SvgOptions::default() });
        assert_eq!(
            kept.drawing.strokes().map(|stroke| stroke[0].distance(stroke[1])).collect::<Vec<_>>(),
            [100.0]
        );
        assert_eq!(kept.left_out, SvgLeftOut::default());
    }
}

#[test]
fn a_closed_stroke_stays_one_over_its_beginning() {
    let clip = "<clipPath id='c'><rect width='100' height='50'/></clipPath>";
    let square = "<rect x='20' y='20' width='60' height='60' fill='none' stroke='#000' clip-path='url(#c)'/>";
    let read = read(&format!("{clip}{square}"));
    assert_eq!(short(&read), "20,50 20,20 80,20 80,50");
    assert_eq!(read.left_out, SvgLeftOut { clip_paths: 1, ..SvgLeftOut::default() });
}

#[test]
fn arcs_that_are_cut_stay_arcs_of_their_circle() {
    let clip = "<clipPath id='c'><path d='M50 0H100V100H50Z'/></clipPath>";
    let circle = "<circle cx='50' cy='50' r='40' fill='none' stroke='#000' clip-path='url(#c)'/>";
    let read = read_with(&format!("{clip}{circle}"), SvgOptions { arcs: true, ..SvgOptions::default() });
    assert_eq!(read.drawing.strokes().len(), 1);
    let curve = read.drawing.curve(0);
    assert!(curve.has_arcs());
    // Half the circle, 125.66 px.
    assert!((curve.length_px() - 40.0 * core::f64::consts::PI).abs() < 0.05, "{}", curve.length_px());
    assert!(curve.chords(0.01).iter().all(|at| (at.distance(PxPoint::new(50.0, 50.0)) - 40.0).abs() < 0.05));
    assert!(curve.vertices.iter().all(|at| at.x > 50.0 - 1e-6));
}

#[test]
fn a_clip_path_that_cuts_nothing_is_not_told() {
    let marker = "<marker id='a' orient='auto' markerWidth='10' markerHeight='8' refX='5' refY='4'>\
                  <path d='M0 0L5 4L0 8' fill='none' stroke='#000'/></marker>";
    let arrow = "<path d='M10 30H90' stroke='#000' marker-end='url(#a)' marker-start='url(#a)'/>";
    let read = read(&format!("{marker}{arrow}"));
    assert_eq!((read.drawing.strokes().len(), read.left_out), (3, SvgLeftOut::default()));
}

#[test]
fn a_mask_shows_where_it_is_light() {
    let mask = |content: &str| {
        format!(
            "<mask id='m' maskUnits='userSpaceOnUse' x='0' y='0' width='100' height='100'>{content}</mask>"
        )
    };
    let rows = [
        ("<rect x='20' width='60' height='99' fill='white'/>", "20,50 80,50"),
        ("<rect x='20' width='60' height='99' fill='black'/>", ""),
        (
            "<rect width='99' height='99' fill='white'/><rect x='20' width='60' height='99'/>",
            "0,50 20,50 | 80,50 99,50",
        ),
        // Half of white shows, less does not.
        ("<rect x='20' width='60' height='99' fill='white' opacity='.51'/>", "20,50 80,50"),
        ("<rect x='20' width='60' height='99' fill='white' opacity='.49'/>", ""),
        ("<rect x='20' width='60' height='99' fill='#7f7f7f'/>", ""),
        // Green is lighter than blue.
        (
            "<rect x='20' width='30' height='99' fill='#0f0'/><rect x='50' width='30' height='99' fill='#00f'/>",
            "20,50 50,50",
        ),
        // Strokes are painted, too: 20 px about 50.
        ("<path d='M50 0V100' stroke='white' stroke-width='20'/>", "40,50 60,50"),
        (
            "<linearGradient id='g'><stop/><stop offset='1' stop-color='#fff'/></linearGradient><rect width='100' height='100' fill='url(#g)'/>",
            "50,50 100,50",
        ),
        (
            "<radialGradient id='g'><stop stop-color='#fff'/><stop offset='1'/></radialGradient><rect width='100' height='100' fill='url(#g)'/>",
            "25,50 75,50",
        ),
    ];
    for (content, expected) in rows {
        assert_eq!(line(&mask(content), "mask='url(#m)'"), expected, "{content}");
    }
    let alpha = mask("<rect x='20' width='60' height='99'/>").replace("<mask", "<mask mask-type='alpha'");
    assert_eq!(line(&alpha, "mask='url(#m)'"), "20,50 80,50");
    let read = read(&format!(
        "{}<path d='M0 50H100' stroke='#000' mask='url(#m)'/>",
        mask("<rect width='50' height='99' fill='white'/>")
    ));
    assert_eq!(read.left_out, SvgLeftOut { masks: 1, ..SvgLeftOut::default() });
}

#[test]
fn filled_shapes_hide_what_lies_below_when_asked() {
    let line = "<path d='M0 50H100' stroke='#000'/>";
    let rows = [
        (
            format!("{line}<rect x='20' y='20' width='60' height='60' fill='white'/>"),
            "0,50 20,50 | 80,50 100,50",
        ),
        (format!("<rect x='20' y='20' width='60' height='60' fill='white'/>{line}"), "0,50 100,50"),
        (format!("{line}<rect x='20' y='20' width='60' height='60' fill='none'/>"), "0,50 100,50"),
        (
            format!("{line}<rect x='20' y='20' width='60' height='60' fill='white' opacity='.4'/>"),
            "0,50 100,50",
        ),
        (
            format!(
                "{line}<clipPath id='c'><rect width='50' height='99'/></clipPath><rect x='20' y='20' width='60' height='60' fill='white' clip-path='url(#c)'/>"
            ),
            "0,50 20,50 | 50,50 100,50",
        ),
        (
            format!(
                "{line}<rect x='20' y='20' width='10' height='60' fill='white'/><rect x='50' y='20' width='10' height='60' fill='white'/>"
            ),
            "0,50 20,50 | 30,50 50,50 | 60,50 100,50",
        ),
        (format!("{line}<circle cx='50' cy='50' r='200' fill='white'/>"), ""),
        // On its border.
        (
            format!("{line}<rect x='20' y='50' width='60' height='30' fill='white'/>"),
            "0,50 20,50 | 80,50 100,50",
        ),
    ];
    for (content, expected) in rows {
        let hidden = read_with(&content, SvgOptions { occludes: true, ..SvgOptions::default() });
        assert_eq!(short(&hidden), expected, "{content}");
        assert_eq!(hidden.left_out.occluded, usize::from(expected != "0,50 100,50"), "{content}");
        assert_eq!(short(&read(&content)), "0,50 100,50", "{content}");
    }
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
    // Without a number, the next that none has; the same number is the same pen; layers in a group are layers.
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
fn transforms_of_css_are_done_or_told() {
    let rows = [
        ("style='transform:translate(10px,-40px)'", "10,10 110,10", 0),
        ("class='t'", "0,60 100,60", 0),
        ("style='transform:rotate(90deg)'", "-50,0 -50,100", 0),
        ("style='transform:rotate(0.25turn)'", "-50,0 -50,100", 0),
        ("style='transform:scale(50%)'", "0,25 50,25", 0),
        ("style='transform:translateX(1in)'", "96,50 196,50", 0),
        ("style='transform:translate(50%,0)'", "50,50 150,50", 0),
        ("style='transform:scaleX(-1);transform-origin:50px 50px'", "100,50 0,50", 0),
        ("style='transform:scale(-1);transform-origin:center'", "100,50 0,50", 0),
        ("style='transform:none' transform='scale(3)'", "0,50 100,50", 0),
        ("style='transform:rotate(1deg) rotateX(40deg)'", "0,50 100,50", 1),
        ("style='transform-box:middle-box;transform:scale(2)'", "0,100 200,100", 1),
        ("style='rotate:x 30deg'", "0,50 100,50", 1),
        ("style='offset-path:path(\"M0 0H9\")'", "0,50 100,50", 1),
    ];
    for (attributes, expected, problems) in rows {
        let sheet = "<style>.t { transform: translate(0, 10px) }</style>";
        let read = read(&format!("{sheet}<path d='M0 50H100' stroke='#000' {attributes}/>"));
        assert_eq!(
            (short(&read).as_str(), read.problems.len()),
            (expected, problems),
            "{attributes} {:?}",
            read.problems
        );
    }
}

/// As Chromium 156 has them: `getScreenCTM` of each.
const MOVED_LINES: [(&str, [f64; 6]); 19] = [
    ("rotate:90deg", [0.0, 1.0, -1.0, 0.0, 0.0, 0.0]),
    ("rotate:z 90deg", [0.0, 1.0, -1.0, 0.0, 0.0, 0.0]),
    ("rotate:0 0 1 90deg", [0.0, 1.0, -1.0, 0.0, 0.0, 0.0]),
    ("scale:2", [2.0, 0.0, 0.0, 2.0, 0.0, 0.0]),
    ("scale:2 3", [2.0, 0.0, 0.0, 3.0, 0.0, 0.0]),
    ("scale:50%", [0.5, 0.0, 0.0, 0.5, 0.0, 0.0]),
    ("translate:10px 20px", [1.0, 0.0, 0.0, 1.0, 10.0, 20.0]),
    ("translate:10px", [1.0, 0.0, 0.0, 1.0, 10.0, 0.0]),
    ("translate:50% 10%", [1.0, 0.0, 0.0, 1.0, 50.0, 10.0]),
    ("translate:10px;rotate:90deg;scale:2;transform:translate(5px,0)", [0.0, 2.0, -2.0, 0.0, 10.0, 10.0]),
    ("rotate:90deg;transform-origin:center", [0.0, 1.0, -1.0, 0.0, 100.0, 0.0]),
    ("rotate:90deg;transform-origin:50px 50px", [0.0, 1.0, -1.0, 0.0, 100.0, 0.0]),
    ("rotate:90deg;transform-origin:left bottom", [0.0, 1.0, -1.0, 0.0, 100.0, 100.0]),
    ("rotate:90deg;transform-origin:top", [0.0, 1.0, -1.0, 0.0, 50.0, -50.0]),
    ("rotate:90deg;transform-origin:20%", [0.0, 1.0, -1.0, 0.0, 70.0, 30.0]),
    ("scale:2;transform-origin:25% 75%", [2.0, 0.0, 0.0, 2.0, -25.0, -75.0]),
    ("rotate:none", [1.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
    ("rotate: 90DEG", [0.0, 1.0, -1.0, 0.0, 0.0, 0.0]),
    ("ROTATE:90deg", [0.0, 1.0, -1.0, 0.0, 0.0, 0.0]),
];
const MOVED_BOXES: [(&str, [f64; 6]); 15] = [
    ("transform-box:fill-box;rotate:90deg", [0.0, 1.0, -1.0, 0.0, 50.0, 10.0]),
    ("transform-box:fill-box;rotate:90deg;transform-origin:center", [0.0, 1.0, -1.0, 0.0, 80.0, 0.0]),
    (
        "transform-box:fill-box;transform-origin:50% 50%;transform:rotate(90deg)",
        [0.0, 1.0, -1.0, 0.0, 80.0, 0.0],
    ),
    ("transform-box:fill-box;transform-origin:right bottom;scale:2", [2.0, 0.0, 0.0, 2.0, -60.0, -50.0]),
    ("transform-box:fill-box;translate:50% 50%", [1.0, 0.0, 0.0, 1.0, 20.0, 10.0]),
    ("transform-box:fill-box;transform:translate(100%)", [1.0, 0.0, 0.0, 1.0, 40.0, 0.0]),
    (
        "transform-box:stroke-box;stroke-width:10;transform-origin:0 0;scale:2",
        [2.0, 0.0, 0.0, 2.0, -15.0, -25.0],
    ),
    (
        "transform-box:border-box;stroke-width:10;transform-origin:0 0;scale:2",
        [2.0, 0.0, 0.0, 2.0, -15.0, -25.0],
    ),
    ("transform-box:content-box;transform-origin:center;scale:2", [2.0, 0.0, 0.0, 2.0, -40.0, -40.0]),
    ("transform-box:view-box;transform-origin:center;scale:2", [2.0, 0.0, 0.0, 2.0, -50.0, -50.0]),
    ("transform-box:fill-box;transform-origin:10px 5px;scale:2", [2.0, 0.0, 0.0, 2.0, -30.0, -35.0]),
    ("transform-origin:10px 5px;scale:2", [2.0, 0.0, 0.0, 2.0, -10.0, -5.0]),
    ("transform-box:stroke-box;stroke-width:10;translate:100%", [1.0, 0.0, 0.0, 1.0, 50.0, 0.0]),
    ("transform-box:fill-box;transform-origin:top;scale:1 2", [1.0, 0.0, 0.0, 2.0, 0.0, -30.0]),
    ("transform-box:fill-box;transform-origin:bottom left;scale:2", [2.0, 0.0, 0.0, 2.0, -20.0, -50.0]),
];

#[test]
fn elements_are_moved_as_browsers_move_them() {
    let line = |style: &str| format!("<path d='M0 50H100' stroke='#000' style='{style}'/>");
    let box_of = |style: &str| {
        format!("<rect x='20' y='30' width='40' height='20' fill='none' stroke='#000' style='{style}'/>")
    };
    let lines = MOVED_LINES.iter().map(|(style, matrix)| (line(style), line(""), matrix));
    let boxes = MOVED_BOXES.iter().map(|(style, matrix)| (box_of(style), box_of(""), matrix));
    for (content, still, [a, b, c, d, e, f]) in lines.chain(boxes) {
        let moved = read(&content);
        let still = read(&still).drawing.stroke(0).to_vec();
        let expected = still.iter().map(|at| PxPoint::new(a * at.x + c * at.y + e, b * at.x + d * at.y + f));
        let near = moved.drawing.stroke(0).iter().zip(expected).all(|(at, to)| at.distance(to) < 1e-3);
        assert!(near && moved.problems.is_empty(), "{content}: {} {:?}", short(&moved), moved.problems);
    }
}

#[test]
fn boxes_are_those_of_what_is_drawn() {
    const TURNED: &str = "transform-box:fill-box;transform-origin:center;rotate:90deg";
    let rows = [
        // The last rule counts, the stronger one, and what is important; attributes count least.
        ("<style>.a{transform-box:fill-box;transform-origin:center;rotate:90deg}.a{rotate:180deg}#e{scale:2}</style>\
          <path id='e' class='a' d='M20 30H60'/>".to_owned(), "80,30 0,30"),
        ("<style>#e{rotate:90deg!important}</style><path id='e' d='M20 30H60' style='rotate:0deg'/>".to_owned(), "-30,20 -30,60"),
        ("<path d='M20 30H60' transform='rotate(90)' transform-origin='center' style='transform-box:fill-box'/>".to_owned(), "40,10 40,50"),
        ("<path d='M20 30H60' transform='rotate(90)' transform-box='fill-box'/>".to_owned(), "-30,20 -30,60"),
        ("<path d='M20 30H60' rotate='90'/>".to_owned(), "20,30 60,30"),
        ("<path d='M20 30H60' style='--r:90deg;rotate:var(--r)'/>".to_owned(), "-30,20 -30,60"),
        ("<g style='rotate:90deg'><path d='M20 30H60' style='rotate:inherit'/></g>".to_owned(), "-20,-30 -60,-30"),
        // What moves in a film stands still here.
        ("<style>@keyframes k{from{rotate:45deg}}*{transform-box:fill-box}</style><path d='M20 30H60' transform='translate(1 2)'/>".to_owned(), "21,32 61,32"),
        // Of a group with what no pen draws, without marks; of a line that has no height.
        (format!("<g style='{TURNED}'><path d='M20 30H60'/><rect x='10' y='10' width='5' height='5' stroke='none'/></g>"), "25,5 25,45"),
        ("<marker id='m' markerWidth='20' markerHeight='20' overflow='visible'><path d='M-30 -30V30'/></marker>\
                  <g style='transform-box:fill-box;transform-origin:center;scale:2'><path d='M20 30H60' marker-end='url(#m)'/></g>".to_owned(), "0,30 80,30 | 20,-30 20,90"),
        (format!("<path d='M20 30H60' style='{TURNED}'/>"), "40,10 40,50"),
        // One within another: both are turned, about the same place.
        (format!("<g style='{TURNED}'><path d='M20 30H60' style='{TURNED}'/></g>"), "60,30 20,30"),
        (
            "<g style='transform-box:fill-box;transform-origin:center;scale:2'><g style='transform-box:fill-box;translate:100%'>\
             <path d='M20 30H60V50'/></g><path d='M0 0H2'/></g>".to_owned(),
            "70,35 150,35 150,75 | -50,-25 -46,-25",
        ),
        // What is drawn by a reference has its box, too.
        (format!("<defs><path id='r' d='M20 30H60' style='{TURNED}'/></defs><use href='#r' x='5'/>"), "45,10 45,50"),
        (
            "<defs><path id='r' d='M20 30H60V50' style='transform-box:fill-box;transform-origin:center;scale:2'/></defs>\
             <use href='#r' x='5' style='transform-box:fill-box;transform-origin:left top;scale:.5'/>".to_owned(),
            "2.5,20 42.5,20 42.5,40",
        ),
        // Shares are of the nearest view.
        (
            "<svg x='10' y='10' width='50' height='50' viewBox='50 50 200 100' overflow='visible'>\
             <path d='M70 70H110' style='transform-origin:center;translate:10%;scale:2'/></svg>".to_owned(),
            "12.5,32.5 32.5,32.5",
        ),
        // Nothing has no box, and moves nowhere.
        (format!("<g style='{TURNED}'/><path d='M20 30H60' style='display:none;{TURNED}'/><path d='M0 9H9'/>"), "0,9 9,9"),
    ];
    for (content, expected) in rows {
        let read = read(&format!("<g fill='none' stroke='#000'>{content}</g>"));
        assert_eq!(
            (short(&read).as_str(), read.problems.len()),
            (expected, 0),
            "{content} {:?}",
            read.problems
        );
    }
}

#[test]
fn the_sheet_itself_is_moved() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' width='1in' height='96' viewBox='0 0 192 192' \
                style='rotate:90deg'><path d='M0 0H192' stroke='#000'/></svg>";
    assert_eq!(short(&read_svg(text.as_bytes(), &SvgOptions::default()).unwrap()), "96,0 96,96");
}

#[test]
fn layers_and_boxes_may_want_names_of_one_element() {
    let layers = format!(
        "{}<g inkscape:groupmode='layer' inkscape:label='2 b' style='transform-box:fill-box;translate:100%'><path d='M0 9H9' stroke='#000'/></g>",
        "<g inkscape:groupmode='layer' inkscape:label='7 a'><path d='M0 0H9' stroke='#000'/></g>"
    );
    let read = read_with(&layers, SvgOptions { pens: SvgPens::ByLayer, ..SvgOptions::default() });
    assert_eq!(short(&read), "0,0 9,0 | 9,9 18,9");
    assert_eq!((read.drawing.pen(0), read.drawing.pen(1)), (7, 2));
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
