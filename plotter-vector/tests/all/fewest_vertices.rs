//! Whole drawings have hardly a vertex too many, as far as changes of one or two of them can tell: which can
//! be left out within the bound, and which two neighbours can become one.
//!
//! Judged on what comes out, the strokes and the pixels of the picture. Nothing of how they were found is
//! used: a pixel belongs to the piece of a stroke on which it lies nearest, and counts in the order of these
//! places.

use crate::figure::Figure;
use plotter_vector::{Drawing, Gray, Ours, Pixel, PxPoint, Vectorizer, decode, order::OrderEffort};

/// What the bound may be missed by, px: the tracer adds 1e-9, so that a pixel exactly on the bound passes.
/// What is left out must be within the bound for sure.
const ROUNDING_PX: f64 = 1e-7;

static OF_1000: Figure = Figure::of("of 1000 vertices");

type Place = [f64; 2];

fn distance(at: Place, [from, to]: [Place; 2]) -> (f64, f64) {
    let (along, off) = ([to[0] - from[0], to[1] - from[1]], [at[0] - from[0], at[1] - from[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let share =
        if square > 0.0 { ((off[0] * along[0] + off[1] * along[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    let (x, y) = (off[0] - share * along[0], off[1] - share * along[1]);
    ((x * x + y * y).sqrt(), share)
}

/// Middles of the dark pixels, by rows.
struct Ink(Vec<Vec<f64>>);

impl Ink {
    fn of(gray: &Gray) -> Self {
        let row = |y: u32| {
            let xs = (0..gray.width())
                .filter(move |x| gray.get(Pixel::new(*x, y)).is_some_and(|level| level < 128));
            xs.map(|x| f64::from(x) + 0.5).collect()
        };
        Self((0..gray.height()).map(row).collect())
    }

    /// The pixels within the bound of a polyline, in the order in which it passes them.
    fn passed(&self, line: &[Place], bound_px: f64) -> Vec<Place> {
        let low = line.iter().map(|at| at[1]).fold(f64::INFINITY, f64::min) - bound_px;
        let high = line.iter().map(|at| at[1]).fold(0.0, f64::max) + bound_px;
        let rows = self.0.iter().zip(0_u32..).map(|(row, y)| (row, f64::from(y) + 0.5));
        let near = rows.filter(|(_, y)| (low..=high).contains(y));
        let pixels = near.flat_map(|(row, y)| row.iter().map(move |x| [*x, y]));
        let mut passed: Vec<(f64, Place)> = pixels
            .filter_map(|at| {
                let pieces = line.windows(2).zip(0_u8..);
                let nearest = pieces
                    .map(|(ends, piece)| (distance(at, [ends[0], ends[1]]), f64::from(piece)))
                    .min_by(|(a, _), (b, _)| a.0.total_cmp(&b.0))?;
                let ((away_px, share), piece) = nearest;
                (away_px <= bound_px + ROUNDING_PX).then_some((piece + share, at))
            })
            .collect();
        passed.sort_by(|a, b| a.0.total_cmp(&b.0));
        passed.into_iter().map(|(_, at)| at).collect()
    }
}

fn all_within(pixels: &[Place], ends: [Place; 2], bound_px: f64) -> bool {
    pixels.iter().all(|at| distance(*at, ends).0 <= bound_px - ROUNDING_PX)
}

/// Whether the vertex between two pieces is not needed.
fn can_be_left_out(ink: &Ink, [before, vertex, after]: [Place; 3], bound_px: f64) -> bool {
    let passed = ink.passed(&[before, vertex, after], bound_px);
    all_within(&passed, [before, after], bound_px)
}

/// Whether one pixel can stand for the two vertices between three pieces.
fn can_be_one(ink: &Ink, [before, first, second, after]: [Place; 4], bound_px: f64) -> bool {
    let passed = ink.passed(&[before, first, second, after], bound_px);
    (0..passed.len()).any(|index| {
        all_within(&passed[..index], [before, passed[index]], bound_px)
            && all_within(&passed[index..], [passed[index], after], bound_px)
    })
}

/// Vertices, those that can be left out, and pairs that can be one. The first vertex of a ring is like the
/// others.
fn too_many(ink: &Ink, drawing: &Drawing, bound_px: f64) -> [usize; 3] {
    let mut found = [0; 3];
    for stroke in drawing.strokes() {
        let mut line: Vec<Place> = stroke.iter().map(|PxPoint { x, y }| [*x, *y]).collect();
        found[0] += line.len();
        let is_ring = line.len() > 3 && line.first() == line.last();
        if is_ring {
            let around = [line[1], line[2]];
            line.extend(around);
        }
        let places =
            |count: usize| if is_ring { stroke.len() - 1 } else { (line.len() + 1).saturating_sub(count) };
        found[1] += line
            .windows(3)
            .take(places(3))
            .filter(|of| can_be_left_out(ink, [of[0], of[1], of[2]], bound_px))
            .count();
        found[2] += line
            .windows(4)
            .take(places(4))
            .filter(|of| can_be_one(ink, [of[0], of[1], of[2], of[3]], bound_px))
            .count();
    }
    found
}

/// A drawing of the examples; none in a package.
fn picture(name: &str) -> Option<Gray> {
    let path = format!("{}/../examples/data/{name}", env!("CARGO_MANIFEST_DIR"));
    match std::fs::read(path) {
        Ok(picture) => Some(decode(&picture).unwrap()),
        Err(_) => {
            println!("skipped: the drawing {name} of the examples is not here");
            None
        }
    }
}

/// Of a thousand vertices so many may be left out, and so many pairs be one.
const TOO_MANY_OF_1000: f64 = 10.0;

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn hardly_a_vertex_of_a_whole_drawing_can_be_left_out_or_be_one_with_the_next() {
    for name in ["flag.png", "technical.png"] {
        let Some(gray) = picture(name) else { return };
        let ink = Ink::of(&gray);
        for bound_px in [0.5, 0.75, 1.0] {
            let ours = Ours::default().with_tolerance_px(bound_px);
            let vectorizer = Vectorizer::from(ours);
            let as_found = ours.with_order(ours.order.with_effort(OrderEffort::None));
            let as_found = Vectorizer::from(as_found);
            let [_, left_out_before, pairs_before] =
                too_many(&ink, &as_found.vectorize(&gray).unwrap().drawing, bound_px);
            let drawing = vectorizer.vectorize(&gray).unwrap().drawing;
            let [vertices, left_out, pairs] = too_many(&ink, &drawing, bound_px);
            println!(
                "{name}, {bound_px} px: of {vertices} vertices {left_out} can be left out, {pairs} pairs be one; before strokes are joined {left_out_before}, {pairs_before}"
            );
            let of_1000 = 1000.0 * left_out.max(pairs) as f64 / vertices as f64;
            OF_1000.note(of_1000);
            assert!(of_1000 <= TOO_MANY_OF_1000, "{name}, {bound_px} px: {left_out}, {pairs} of {vertices}");
        }
    }
}

/// The judge itself: a vertex on a straight line, and a corner cut off, are seen.
#[test]
fn what_is_too_many_is_seen() {
    let mut gray = vec![255_u8; 40 * 40];
    for at in 5..35 {
        gray[5 * 40 + at] = 0;
        gray[at * 40 + 34] = 0;
    }
    let ink = Ink::of(&Gray::new(40, 40, gray).unwrap());
    let seen = |places: &[[f64; 2]]| {
        let mut drawing = Drawing::new(40, 40);
        drawing.push(places.iter().map(|[x, y]| PxPoint::new(*x, *y)));
        too_many(&ink, &drawing, 0.5)
    };
    let (start, corner, end) = ([5.5, 5.5], [34.5, 5.5], [34.5, 34.5]);
    assert_eq!(seen(&[start, corner, end]), [3, 0, 0]);
    assert_eq!(seen(&[start, [20.5, 5.5], corner, end]), [4, 1, 1]);
    assert_eq!(seen(&[start, [34.0, 5.5], [34.5, 6.0], end]), [4, 0, 1]);
}
