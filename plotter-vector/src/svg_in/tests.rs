//! Each part of the format and what it becomes; what is refused, and how.

use super::*;
use crate::stroke::PxPoint;

/// A file of 100 x 100 px with this in it.
pub(super) fn file(content: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"100\" height=\"100\">{content}</svg>"
    )
}

pub(super) fn read_with(content: &str, options: SvgOptions) -> SvgDrawing {
    read_svg(file(content).as_bytes(), &options).unwrap()
}

pub(super) fn read(content: &str) -> SvgDrawing {
    read_with(content, SvgOptions::default())
}

/// The strokes, each vertex rounded to a hundredth of a px.
fn strokes(read: &SvgDrawing) -> Vec<Vec<(f64, f64)>> {
    let round = |at: &PxPoint| (libm::round(at.x * 100.0) / 100.0, libm::round(at.y * 100.0) / 100.0);
    read.drawing.strokes().map(|stroke| stroke.iter().map(round).collect()).collect()
}

fn pens_of(read: &SvgDrawing) -> Vec<u8> {
    (0..read.drawing.strokes().len()).map(|index| read.drawing.pen(index)).collect()
}

fn refusal(bytes: &[u8]) -> String {
    read_svg(bytes, &SvgOptions::default()).unwrap_err().to_string()
}

/// The line from (0, 0) to (10, 0).
const LINE: &str = "<path d=\"M0 0H10\" stroke=\"black\"/>";

#[test]
fn shapes_are_drawn_along_their_strokes_in_the_order_of_the_file() {
    let read = read(
        "<rect x='1' y='2' width='3' height='4' fill='none' stroke='#000'/><line x2='5' y2='6' stroke='#000'/>\
         <polygon points='0,0 9,0 9,9' fill='none' stroke='#000'/><polyline points='7,7 8,8' stroke='#000'/>\
         <path d='M1 1 l1 1 m3 0 v4 z l1 0' stroke='#000'/>",
    );
    assert_eq!(
        strokes(&read),
        vec![
            vec![(1.0, 2.0), (4.0, 2.0), (4.0, 6.0), (1.0, 6.0), (1.0, 2.0)],
            vec![(0.0, 0.0), (5.0, 6.0)],
            vec![(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 0.0)],
            vec![(7.0, 7.0), (8.0, 8.0)],
            vec![(1.0, 1.0), (2.0, 2.0)],
            vec![(5.0, 2.0), (5.0, 6.0), (5.0, 2.0)],
            vec![(5.0, 2.0), (6.0, 2.0)],
        ]
    );
}

#[test]
fn a_fill_without_a_stroke_is_its_border() {
    let read = read("<path d='M0 0H9V9'/><path d='M0 0H9V9' fill='none'/><path d='M0 0H9'/>");
    assert_eq!(strokes(&read), vec![vec![(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 0.0)]]);
}

#[test]
fn what_is_hidden_or_in_the_colour_of_the_paper_is_not_drawn() {
    let hidden = "<rect width='9' height='9' fill='#fff'/><g display='none'><path d='M0 0H9' stroke='#000'/></g>\
                  <path d='M0 0H9' stroke='#000' visibility='hidden'/><g opacity='0'><path d='M0 0H9' stroke='#000'/></g>\
                  <path d='M0 0H9' stroke='#000' stroke-opacity='0'/><defs><path d='M0 0H9' stroke='#000'/></defs>";
    assert_eq!(strokes(&read(hidden)), Vec::<Vec<(f64, f64)>>::new());
    assert_eq!(read(hidden).left_out, SvgLeftOut { paper: 1, ..SvgLeftOut::default() });
    let all = read_with(hidden, SvgOptions { paper: None, ..SvgOptions::default() });
    assert_eq!(all.drawing.strokes().len(), 1);
}

#[test]
fn a_white_stroke_leaves_the_border_of_its_fill() {
    let read = read("<rect width='9' height='9' fill='#f00' stroke='#fff'/>");
    assert_eq!(read.pens.iter().map(|pen| pen.name.as_str()).collect::<Vec<_>>(), ["#ff0000"]);
}

#[test]
fn transforms_nest_and_clones_are_drawn() {
    let read = read(
        "<g transform='translate(10 20)'><g id='a' transform='scale(2)'><path d='M1 1H3' stroke='#000'/></g></g>\
         <use xlink:href='#a' x='50'/>",
    );
    assert_eq!(strokes(&read), vec![vec![(12.0, 22.0), (16.0, 22.0)], vec![(52.0, 2.0), (56.0, 2.0)]]);
}

#[test]
fn a_sheet_in_mm_has_its_lower_left_corner_at_the_origin() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' width='210mm' height='297mm' viewBox='10 10 21000 29700'>\
                <path d='M1010 29710L21010 10' stroke='#000'/></svg>";
    let read = read_svg(text.as_bytes(), &SvgOptions::default()).unwrap();
    let ends: Vec<Point> = read.drawing.stroke(0).iter().map(|at| read.scale.to_sheet(*at)).collect();
    for (end, (x, y)) in ends.iter().zip([(10.0, 0.0), (210.0, 297.0)]) {
        assert!(end.distance(Point::new(x, y)) < 1e-3, "{end:?}");
    }
    assert_eq!((read.drawing.width_px(), read.drawing.height_px()), (794, 1123));
    assert!((read.width_mm - 210.0).abs() < 1e-4 && (read.height_mm - 297.0).abs() < 1e-4);
}

#[test]
fn inches_and_points_are_physical() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' width='2in' height='72pt'/>";
    let read = read_svg(text.as_bytes(), &SvgOptions::default()).unwrap();
    assert_eq!((read.drawing.width_px(), read.drawing.height_px()), (192, 96));
    assert!((read.width_mm - 50.8).abs() < 1e-5);
}

#[test]
fn a_circle_stays_within_the_tolerance_of_its_radius() {
    let tolerance_mm = 0.05;
    let options = SvgOptions { tolerance_mm, ..SvgOptions::default() };
    let read = read_with("<circle cx='50' cy='50' r='40' fill='none' stroke='#000'/>", options);
    let circle = read.drawing.stroke(0);
    // Chords within the tolerance, and the arc's own cubic within 0.03 % of the radius.
    let allowed = tolerance_mm / (MM_PER_INCH / PX_PER_INCH) + 40.0 * 0.0003;
    let centre = PxPoint::new(50.0, 50.0);
    for pair in circle.windows(2) {
        let middle = PxPoint::new(f64::midpoint(pair[0].x, pair[1].x), f64::midpoint(pair[0].y, pair[1].y));
        for at in [pair[0], middle] {
            assert!((at.distance(centre) - 40.0).abs() <= allowed, "{at:?}");
        }
    }
    assert_eq!(circle.first(), circle.last());
    // A regular polygon within 0.05 mm has 32 sides.
    assert!((28..=44).contains(&circle.len()), "{}", circle.len());
}

#[test]
fn dashes_are_measured_in_the_units_of_the_shape() {
    let dashed = "stroke='#000' stroke-dasharray='2 1'";
    let read = read(&format!(
        "<g transform='scale(10 1)'><path d='M0 0H4' {dashed}/><path d='M0 0V4' {dashed}/></g>"
    ));
    assert_eq!(
        strokes(&read),
        vec![
            vec![(0.0, 0.0), (20.0, 0.0)],
            vec![(30.0, 0.0), (40.0, 0.0)],
            vec![(0.0, 0.0), (0.0, 2.0)],
            vec![(0.0, 3.0), (0.0, 4.0)]
        ]
    );
}

#[test]
fn a_line_of_no_length_is_a_dot_when_its_caps_show() {
    let round = "stroke='#000' stroke-linecap='round'";
    let read =
        read(&format!("<path d='M3 4h0' {round}/><path d='M5 6z' {round}/><path d='M7 8h0' stroke='#000'/>"));
    assert_eq!(strokes(&read), vec![vec![(3.0, 4.0)], vec![(5.0, 6.0)]]);
}

#[test]
fn each_colour_has_a_pen_in_order_of_appearance() {
    let line = |colour: &str| format!("<path d='M0 0H9' stroke='{colour}'/>");
    let read = read(&["red", "#00f", "#ff0000", "rgb(0,0,255)"].map(line).concat());
    assert_eq!(pens_of(&read), [1, 2, 1, 2]);
    let named: Vec<(u8, &str)> = read.pens.iter().map(|pen| (pen.number, pen.name.as_str())).collect();
    assert_eq!(named, [(1, "#ff0000"), (2, "#0000ff")]);
    assert!(crate::ink::Palette::new(read.pens).is_ok());
}

#[test]
fn the_seventeenth_colour_is_drawn_by_the_nearest_pen() {
    let line = |grey: u8| format!("<path d='M0 0H9' stroke='rgb({grey},{grey},{grey})'/>");
    let greys: String = (0..16).map(|step| line(step * 15)).chain([line(44), line(181)]).collect();
    let read = read(&greys);
    assert_eq!(pens_of(&read)[16..], [4, 13]);
    assert_eq!(read.pens.len(), 16);
    // One shape of each.
    assert_eq!(read.without_pen, SvgWithoutPen { kinds: 2, shapes: 2 });
}

#[test]
fn each_layer_has_a_pen_with_its_name() {
    let layers = format!(
        "<g id='layer1' inkscape:groupmode='layer' inkscape:label='walls'><g id='inner'>{LINE}</g>{LINE}</g>{LINE}\
         <g id='layer2'>{LINE}</g><g id='layer3'/>{LINE}"
    );
    let options = SvgOptions { pens: SvgPens::ByLayer, ..SvgOptions::default() };
    let by_layer = read_with(&layers, options);
    assert_eq!(pens_of(&by_layer), [1, 1, 2, 3, 2]);
    assert_eq!(
        by_layer.pens.iter().map(|pen| pen.name.as_str()).collect::<Vec<_>>(),
        ["walls", "", "layer2"]
    );
    let one = read_with(&layers, SvgOptions { pens: SvgPens::One, ..options });
    assert_eq!(pens_of(&one), [1; 5]);
}

#[test]
fn arcs_stay_arcs_where_they_are_wanted() {
    let body = "<circle cx='50' cy='50' r='40' fill='none' stroke='#000'/>\
                <path d='M0 0H10A5 5 0 0 1 10 10H0' fill='none' stroke='#000'/>\
                <path d='M0 0A5 5 0 0 1 10 0' stroke='#000' fill='none' stroke-dasharray='1'/>";
    let read = read_with(body, SvgOptions { arcs: true, ..SvgOptions::default() });
    let bulges = |index: usize| -> Vec<f64> {
        read.drawing.bulges(index).iter().map(|bulge| libm::round(bulge * 1000.0) / 1000.0).collect()
    };
    // Quarters of a turn: tan(90° / 4).
    assert_eq!(bulges(0), [0.414, 0.414, 0.414, 0.414, 0.0]);
    assert_eq!(bulges(1), [0.0, 0.414, 0.414, 0.0, 0.0]);
    // Half a circle of 15.7 px makes 8 dashes, which are cut out of chords.
    assert_eq!(read.drawing.strokes().len(), 10);
    assert!((2..10).all(|dash| bulges(dash).iter().all(|bulge| *bulge == 0.0)));
    assert!(!read_with(body, SvgOptions::default()).drawing.has_arcs());
}

#[test]
fn what_no_pen_draws_is_counted() {
    let read = read(
        "<clipPath id='c'><rect width='5' height='5'/></clipPath><mask id='m'><rect width='5' height='5'/></mask>\
         <text>ink</text><text> </text><defs><text>none</text></defs>\
         <image width='9' height='9' href='data:image/png;base64,iVBORw0KGgo='/><image href='/etc/passwd'/>\
         <path d='M0 0H9V9' clip-path='url(#c)'/><path d='M0 0H9V9' mask='url(#m)'/>",
    );
    assert_eq!(
        read.left_out,
        SvgLeftOut {
            texts: 1,
            text_line: Some(1),
            images: 2,
            image_line: Some(1),
            clip_paths: 1,
            masks: 1,
            ..SvgLeftOut::default()
        }
    );
    // The black mask hides all of its path.
    assert_eq!(read.drawing.strokes().len(), 1);
}

#[test]
fn gradients_and_patterns_have_a_colour() {
    let read = read(
        "<linearGradient id='g'><stop stop-color='#0f0' stop-opacity='0'/><stop offset='1' stop-color='#00f'/>\
         </linearGradient><pattern id='p' width='2' height='2' patternUnits='userSpaceOnUse'>\
         <rect width='1' height='1'/></pattern>\
         <rect width='9' height='9' fill='url(#g)'/><rect width='9' height='9' fill='url(#p)'/>",
    );
    assert_eq!(read.pens.iter().map(|pen| pen.colour).collect::<Vec<_>>(), [Rgb([0, 0, 255]), Rgb::BLACK]);
}

#[test]
fn style_sheets_and_entities_of_the_file_are_followed() {
    let text = "<!DOCTYPE svg PUBLIC '-//W3C//DTD SVG 1.1//EN' 'http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd' \
                [<!ENTITY red '#ff0000'>]><svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'>\
                <style>.b { stroke: blue }</style><path d='M0 0H9' stroke='&red;'/><path class='b' d='M0 0H9'/></svg>";
    let read = read_svg(text.as_bytes(), &SvgOptions::default()).unwrap();
    assert_eq!(
        read.pens.iter().map(|pen| pen.colour).collect::<Vec<_>>(),
        [Rgb([255, 0, 0]), Rgb([0, 0, 255])]
    );
}

/// Entities, each of ten of the one before.
fn entity_bomb() -> String {
    let entity = |level: u32| format!("<!ENTITY e{} '{}'>", level + 1, format!("&e{level};").repeat(10));
    let entities: String = (0..9).map(entity).collect();
    format!(
        "<!DOCTYPE svg [<!ENTITY e0 'ink'>{entities}]><svg xmlns='http://www.w3.org/2000/svg'><text>&e9;</text></svg>"
    )
}

/// Groups, each of ten clones of the one before.
fn clone_bomb() -> String {
    let group =
        |level: u32| format!("<g id='g{}'>{}</g>", level + 1, format!("<use href='#g{level}'/>").repeat(10));
    file(&format!("<g id='g0'>{LINE}</g>{}", (0..9).map(group).collect::<String>()))
}

/// Patterns, each filled with the one before.
fn chain(length: u32) -> String {
    let pattern = |level: u32| {
        format!(
            "<pattern id='p{}' width='9' height='9' patternUnits='userSpaceOnUse'>\
             <rect width='9' height='9' fill='url(#p{level})'/></pattern>",
            level + 1
        )
    };
    let patterns: String = (0..length).map(pattern).collect();
    file(&format!("{patterns}<rect width='9' height='9' fill='url(#p{length})'/>"))
}

/// Patterns, each of rectangles that a style sheet fills with the one before.
fn chain_of_rules(length: u32, rectangles: usize) -> String {
    let pattern = |level: u32| {
        let rectangles = format!("<rect class='c{level}' width='9' height='9'/>").repeat(rectangles);
        format!(
            "<style>.c{level}{{fill:url(#p{level})}}</style><pattern id='p{}' width='9' height='9' \
             patternUnits='userSpaceOnUse'>{rectangles}</pattern>",
            level + 1
        )
    };
    file(&format!(
        "{}<rect width='9' height='9' fill='url(#p{length})'/>",
        (0..length).map(pattern).collect::<String>()
    ))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_is_refused_is_told_with_a_remedy() {
    let whole = file(LINE);
    let nested = |depth| file(&format!("{}{}", "<g>".repeat(depth), "</g>".repeat(depth)));
    let texts = [
        String::new(),
        " \n".to_owned(),
        "IN;SP1;PU;".to_owned(),
        whole.split_at(whole.len() - 10).0.to_owned(),
        whole.split_at(whole.len() / 2).0.to_owned(),
        "<html><body/></html>".to_owned(),
        "<svg xmlns='http://www.w3.org/2000/svg' width='0' height='9'/>".to_owned(),
        "<svg xmlns='http://www.w3.org/2000/svg' width='9km' height='1e7mm'/>".to_owned(),
        "<svg xmlns='http://www.w3.org/2000/svg' width='1e7mm' height='9'/>".to_owned(),
        "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9' viewBox='0 0 1e39 5'/>".to_owned(),
        entity_bomb(),
        clone_bomb(),
        file("<g id='a'><use href='#a'/></g>"),
        nested(2000),
        chain(2000),
        chain_of_rules(2000, 1),
        chain_of_rules(9, 10),
    ];
    let mut messages: Vec<String> = texts.iter().map(|text| refusal(text.as_bytes())).collect();
    messages.push(refusal(&[0x1f, 0x8b, 8, 0]));
    messages.push(refusal(b"<svg>\xff</svg>"));
    for tolerance_mm in [0.0, f64::NAN] {
        let options = SvgOptions { tolerance_mm, ..SvgOptions::default() };
        messages.push(read_svg(whole.as_bytes(), &options).unwrap_err().to_string());
    }
    let few = SvgOptions { max_vertices: 100, ..SvgOptions::default() };
    let dashed = file("<path d='M0 0H100' stroke='#000' stroke-dasharray='1e-30'/>");
    messages.push(read_svg(dashed.as_bytes(), &few).unwrap_err().to_string());
    insta::assert_snapshot!(messages.join("\n"));
}

#[test]
fn what_may_be_nested_fits_on_the_stack() {
    let nested = file(&format!("{}{LINE}{}", "<g opacity='.9'>".repeat(900), "</g>".repeat(900)));
    assert_eq!(read_svg(nested.as_bytes(), &SvgOptions::default()).unwrap().drawing.strokes().len(), 1);
    assert!(read_svg(chain(330).as_bytes(), &SvgOptions::default()).is_ok());
}
