//! Lines and what lies on them: where wide lines meet, many lines through a point, heads of notes, silhouettes.
#![allow(clippy::unwrap_used, reason = "a failure shows")]

use crate::pen_ink::{Line, ink_of};
use plotter_vector::{Bitmap, Drawing, Pixel, PxPoint, Vectorizer};

const SIDE_PX: u32 = 320;

fn at(x: f64, y: f64) -> PxPoint {
    PxPoint::new(x, y)
}

/// The ink of lines of several pens.
fn inked(lines: &[(f64, &[Line])]) -> Bitmap {
    let mut ink = Bitmap::new(SIDE_PX, SIDE_PX).unwrap();
    for (pen_px, lines) in lines {
        ink_of(SIDE_PX, lines, *pen_px).ink().for_each(|at| ink.set(at, true));
    }
    ink
}

fn strokes(ink: &Bitmap) -> Drawing {
    Vectorizer::default().trace(ink).unwrap().drawing
}

/// Whether one stroke goes from one place to another, no farther than a pixel from the straight way.
fn has_line(drawing: &Drawing, [from, to]: Line) -> bool {
    let off = |at: &PxPoint| ((to - from).cross(*at - from) / (to - from).length()).abs();
    drawing.strokes().any(|stroke| {
        let reaches = |end: PxPoint| {
            // Along the line: where exactly a stroke ends is another matter.
            stroke.windows(2).any(|pair| {
                let [a, b] = [pair[0], pair[1]].map(|at| (at - from).dot(to - from) / (to - from).length());
                let end = (end - from).dot(to - from) / (to - from).length();
                off(&pair[0]) <= 1.0 && off(&pair[1]) <= 1.0 && a.min(b) <= end + 9.0 && a.max(b) >= end - 9.0
            })
        };
        reaches(from) && reaches(to)
    })
}

#[test]
fn where_walls_meet_beside_thin_lines_are_no_rings() {
    let thin: Vec<Line> =
        (0..8).map(|n| 20.5 + 8.0 * f64::from(n)).map(|y| [at(20.0, y), at(300.0, y)]).collect();
    let walls = [[at(40.0, 150.0), at(280.0, 150.0)], [at(160.0, 150.0), at(160.0, 290.0)]];
    let drawing = strokes(&inked(&[(3.0, &thin), (16.0, &walls)]));
    assert_eq!(drawing.strokes().len(), 10);
    assert!(walls.iter().chain(&thin).all(|line| has_line(&drawing, *line)), "{drawing:?}");
    assert_eq!(drawing.vertices(), 20);
}

#[test]
fn twelve_lines_through_a_point_are_twelve() {
    let spoke = |n: u32| {
        let (sine, cosine) = libm::sincos(f64::from(n) * core::f64::consts::PI / 12.0);
        [at(160.5 + 140.0 * cosine, 160.5 + 140.0 * sine), at(160.5 - 140.0 * cosine, 160.5 - 140.0 * sine)]
    };
    let lines: Vec<Line> = (0..12).map(spoke).collect();
    let drawing = strokes(&inked(&[(3.0, &lines)]));
    assert_eq!(drawing.strokes().len(), 12);
    assert!(lines.iter().all(|line| has_line(&drawing, *line)), "{drawing:?}");
}

#[test]
fn lines_go_straight_through_the_heads_of_notes() {
    let staff: Vec<Line> =
        (0..5).map(|n| 100.5 + 16.0 * f64::from(n)).map(|y| [at(20.0, y), at(300.0, y)]).collect();
    let mut ink = inked(&[(3.0, &staff)]);
    // One head on a line, one between two lines, which touches both; turned by 20 degrees, with stems.
    let (sine, cosine) = libm::sincos(-0.35);
    let heads = [at(100.0, 132.5), at(200.0, 124.5)];
    for (x, y) in (0..SIDE_PX).flat_map(|y| (0..SIDE_PX).map(move |x| (x, y))) {
        let is_head = heads.iter().any(|head| {
            let way = PxPoint::from(Pixel::new(x, y)) - *head;
            let (along, across) = (way.x * cosine + way.y * sine, way.y * cosine - way.x * sine);
            libm::hypot(along / 11.0, across / 8.0) <= 1.0
        });
        let is_stem = heads.iter().any(|head| {
            let way = PxPoint::from(Pixel::new(x, y)) - *head;
            (way.x - 9.5).abs() <= 1.5 && (-60.0..0.0).contains(&way.y)
        });
        if is_head || is_stem {
            ink.set(Pixel::new(x, y), true);
        }
    }
    let drawing = strokes(&ink);
    assert!(staff.iter().all(|line| has_line(&drawing, *line)), "{drawing:?}");
    // Five lines, two stems and the outlines of two heads.
    assert_eq!(drawing.strokes().len(), 9, "{drawing:?}");
    let closed = drawing.strokes().filter(|stroke| stroke.first() == stroke.last()).count();
    assert_eq!(closed, 2);
}

#[test]
fn a_silhouette_is_outlined_at_any_size() {
    // An animal of a body, a neck and legs that get thinner.
    let parts = |scale: f64| -> Vec<(f64, Line)> {
        let line = |width: f64, from: (f64, f64), to: (f64, f64)| {
            (width * scale, [at(from.0 * scale, from.1 * scale), at(to.0 * scale, to.1 * scale)])
        };
        let mut parts = Vec::new();
        for n in 0..20 {
            let part = f64::from(n) / 20.0;
            parts.push(line(36.0 - 6.0 * part, (45.0 + 40.0 * part, 60.0), (50.0 + 40.0 * part, 60.0)));
            parts.push(line(24.0 - 12.0 * part, (92.0 + 20.0 * part, 50.0 - 30.0 * part), (93.0, 50.0)));
            for (x, lean) in [(42.0, -6.0), (50.0, 5.0), (85.0, -3.0), (95.0, 4.0)] {
                let foot = (x + lean * part, 70.0 + 40.0 * part);
                parts.push(line(13.0 - 8.0 * part, foot, (foot.0 + 0.1, foot.1 + 2.0)));
            }
        }
        parts
    };
    for scale in [1.0, 2.0] {
        let mut ink = Bitmap::new(SIDE_PX, SIDE_PX).unwrap();
        for (width, line) in parts(scale) {
            ink_of(SIDE_PX, &[line], width).ink().for_each(|at| ink.set(at, true));
        }
        let drawing = strokes(&ink);
        let closed = drawing.strokes().filter(|stroke| stroke.first() == stroke.last()).count();
        assert_eq!((drawing.strokes().len(), closed), (1, 1), "{scale}: {drawing:?}");
    }
}

#[test]
fn ends_of_lines_that_the_pen_joins_are_one_stroke() {
    // The sides of a sharp tip, drawn down and up, and two dashes with paper between them.
    let tip = [[at(60.0, 250.0), at(80.0, 60.0)], [at(80.0, 60.0), at(100.0, 250.0)]];
    let dashes = [[at(150.0, 100.0), at(200.0, 100.0)], [at(208.0, 100.0), at(260.0, 100.0)]];
    let lines: Vec<Line> = tip.into_iter().chain(dashes).collect();
    assert_eq!(strokes(&inked(&[(5.0, &lines)])).strokes().len(), 3);
}

#[test]
fn dashes_of_a_thin_pen_stay_apart_beside_wide_lines() {
    let wide: Vec<Line> =
        (0..5).map(|n| 40.0 + 30.0 * f64::from(n)).map(|y| [at(20.0, y), at(300.0, y)]).collect();
    let dashes: Vec<Line> = (0..9)
        .map(|n| 24.0 + 30.0 * f64::from(n))
        .map(|x| [at(x, 220.0 + 0.2 * x), at(x + 25.0, 225.0 + 0.2 * x)])
        .collect();
    // The pen's round ends leave 3 px of paper and less between dashes.
    let drawing = strokes(&inked(&[(6.0, &wide), (2.0, &dashes)]));
    assert_eq!(drawing.strokes().len(), 14, "{drawing:?}");
}
