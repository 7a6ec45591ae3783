//! Clip paths, masks and filled shapes: the parts of strokes that they take away.

use super::kind_tests::{line, short};
use super::tests::{read, read_with};
use super::*;
use crate::stroke::PxPoint;

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
