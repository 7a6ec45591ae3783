//! Transforms by CSS and attributes, as browsers apply them.

use super::kind_tests::short;
use super::tests::{read, read_with};
use super::*;
use crate::stroke::PxPoint;

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
