//! Laws of dividing a drawing into frames, on drawings made by chance.

use plotter_motion::{PlotOp, Point, Vec2};
use plotter_stitch::{Frame, FrameLayout, Frames, SplitError, split::FramePasses};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

const WIDTH_MM: f64 = 300.0;

fn layout(window_mm: f64) -> FrameLayout {
    FrameLayout { begin_mm: 0.0, frame_mm: 100.0, width_mm: WIDTH_MM, window_mm, clear_mm: 1.0 }
}

/// What a stroke does next, relative to where it is.
#[derive(Clone, Copy, Debug)]
enum Step {
    Line(Vec2),
    Dot,
    /// An arc about a centre there.
    Arc(Vec2, f64),
    Pause,
    Power(f64),
}

fn steps() -> impl Strategy<Value = Step> {
    let way = |reach: f64| (-reach..reach, -reach..reach).prop_map(|(x, y)| Vec2::new(x, y));
    prop_oneof![
        4 => way(60.0).prop_map(Step::Line),
        2 => way(3.0).prop_map(Step::Line),
        1 => way(300.0).prop_map(Step::Line),
        1 => (-80.0..80.0).prop_map(|x| Step::Line(Vec2::new(x, 0.0))),
        1 => (-80.0..80.0).prop_map(|y| Step::Line(Vec2::new(0.0, y))),
        1 => Just(Step::Dot),
        3 => (way(40.0), -TAU..TAU).prop_map(|(centre, sweep)| Step::Arc(centre, sweep)),
        1 => Just(Step::Pause),
        1 => (0.0..1.0).prop_map(Step::Power),
    ]
}

/// Strokes with their pens. The places are on multiples of a quarter millimetre, so that many lie on borders.
fn strokes() -> impl Strategy<Value = Vec<(u8, Point, Vec<Step>)>> {
    let begin =
        (0_u32..1_200, 0_u32..3_600).prop_map(|(x, y)| Point::new(f64::from(x) / 4.0, f64::from(y) / 4.0));
    prop::collection::vec((1_u8..4, begin, prop::collection::vec(steps(), 1..12)), 1..12)
}

/// The operations: each one that draws has a speed of its own, by which its pieces are known again.
fn ops_of(strokes: &[(u8, Point, Vec<Step>)]) -> Vec<PlotOp> {
    let mut ops = Vec::new();
    let mut count = 0_u16;
    for (pen, begin, steps) in strokes {
        ops.push(PlotOp::SelectPen { pen: *pen });
        ops.push(PlotOp::Travel { to: *begin });
        let mut at = *begin;
        for step in steps {
            count += 1;
            let feed_mm_s = Some(f64::from(count));
            let is_on_table = |place: Point| place.y >= 0.0 && (0.0..=WIDTH_MM).contains(&place.x);
            match *step {
                Step::Line(by) => {
                    let to = at + by;
                    if is_on_table(to) {
                        ops.push(PlotOp::Draw { to, feed_mm_s });
                        at = to;
                    }
                }
                Step::Dot => ops.push(PlotOp::Draw { to: at, feed_mm_s }),
                Step::Arc(by, sweep_rad) => {
                    let centre = at + by;
                    let radius = Vec2::new(by.length(), by.length());
                    let to = centre + (at - centre).rotated(sweep_rad);
                    if is_on_table(centre - radius) && is_on_table(centre + radius) && by.length() > 1.0 {
                        ops.push(PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s });
                        at = to;
                    }
                }
                Step::Pause => {
                    ops.push(PlotOp::Dwell { duration: std::time::Duration::from_millis(count.into()) });
                }
                Step::Power(share) => ops.push(PlotOp::LaserPower { share }),
            }
        }
    }
    ops
}

/// A piece of an operation: from where to where, and what draws it, with which pen and power.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    from: Point,
    op: PlotOp,
    pen: u8,
    power: f64,
}

impl Piece {
    fn to(&self) -> Point {
        self.op.target().unwrap()
    }

    fn sweep_rad(&self) -> f64 {
        if let PlotOp::DrawArc { sweep_rad, .. } = self.op { sweep_rad } else { 0.0 }
    }

    fn length_mm(&self) -> f64 {
        match self.op {
            PlotOp::DrawArc { centre, sweep_rad, .. } => sweep_rad.abs() * self.from.distance(centre),
            _ => self.from.distance(self.to()),
        }
    }
}

/// The pieces by the number of their operation, in the order in which they come.
fn pieces(ops: impl Iterator<Item = PlotOp>, into: &mut BTreeMap<u64, Vec<Piece>>) {
    let mut at = Point::ORIGIN;
    let (mut pen, mut power) = (0, -1.0);
    for op in ops {
        match op {
            PlotOp::Draw { feed_mm_s, .. } | PlotOp::DrawArc { feed_mm_s, .. } => {
                into.entry(feed_mm_s.unwrap().to_bits()).or_default().push(Piece {
                    from: at,
                    op,
                    pen,
                    power,
                });
            }
            PlotOp::SelectPen { pen: new } => pen = new,
            PlotOp::LaserPower { share } => power = share,
            _ => {}
        }
        at = op.target().unwrap_or(at);
    }
}

fn by_passes(ops: &[PlotOp], layout: FrameLayout) -> Result<Vec<Frame>, SplitError> {
    FramePasses::new(|| ops.iter().copied(), layout).collect()
}

fn windows() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(5.0), Just(25.0), 0.01..25.0]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// Each operation is found again in the frames, whole or in pieces that meet: nothing is lost or drawn
    /// twice.
    #[test]
    fn joining_the_frames_gives_the_drawing(strokes in strokes(), window_mm in windows()) {
        let ops = ops_of(&strokes);
        let frames = match by_passes(&ops, layout(window_mm)) {
            Err(SplitError::Empty) => return Ok(()),
            frames => frames.unwrap(),
        };
        let (mut drawn, mut meant) = (BTreeMap::new(), BTreeMap::new());
        frames.iter().for_each(|frame| pieces(frame.sheet_ops(), &mut drawn));
        pieces(ops.iter().copied(), &mut meant);
        prop_assert_eq!(drawn.keys().collect::<Vec<_>>(), meant.keys().collect::<Vec<_>>());
        let mut total_mm = (0.0, 0.0);
        for (number, whole) in &meant {
            let whole = whole[0];
            let mut rest = drawn[number].clone();
            // Follow the pieces from the beginning of the operation to its end.
            let mut at = whole.from;
            let mut sweep_rad = 0.0;
            while !rest.is_empty() {
                let next = rest.iter().position(|piece| piece.from == at);
                prop_assert!(next.is_some(), "operation {} has a gap at {:?}: {:?}", number, at, drawn[number]);
                let piece = rest.swap_remove(next.unwrap());
                prop_assert_eq!((piece.pen, piece.power), (whole.pen, whole.power));
                prop_assert!(drawn[number].len() == 1 || piece.length_mm() > 0.0);
                at = piece.to();
                sweep_rad += piece.sweep_rad();
                total_mm.0 += piece.length_mm();
            }
            prop_assert_eq!(at, whole.to());
            /// Of sums of at most a dozen angles.
            const ROUNDING_RAD: f64 = 1e-12;
            prop_assert!((sweep_rad - whole.sweep_rad()).abs() < ROUNDING_RAD);
            total_mm.1 += whole.length_mm();
        }
        prop_assert!((total_mm.0 - total_mm.1).abs() <= 1e-9 * total_mm.1.max(1.0));
    }

    /// A frame draws within its borders and the window, lines meet in the same place on both sides, and
    /// pauses come once.
    #[test]
    fn frames_keep_to_their_place(strokes in strokes(), window_mm in windows()) {
        let ops = ops_of(&strokes);
        let layout = layout(window_mm);
        let Ok(frames) = by_passes(&ops, layout) else { return Ok(()) };
        for (index, frame) in frames.iter().enumerate() {
            prop_assert_eq!(frame.index() as usize, index);
            let low = if index == 0 { f64::NEG_INFINITY } else { layout.border_mm(frame.index()) - window_mm };
            let high = layout.border_mm(frame.index() + 1) + window_mm;
            /// Rounding of a place on a line of 300 mm.
            const ROUNDING_MM: f64 = 1e-9;
            let mut at = Point::ORIGIN;
            for (op, local) in frame.sheet_ops().zip(frame.ops()) {
                if let (Some(to), Some(local)) = (op.target(), local.target()) {
                    prop_assert_eq!(Point::new(local.x, local.y + frame.begin_mm()), to);
                    let mut places = vec![to];
                    if let PlotOp::DrawArc { centre, sweep_rad, .. } = op {
                        places.extend((1..20).map(|n| centre + (at - centre).rotated(sweep_rad * f64::from(n) / 20.0)));
                    }
                    for place in places {
                        prop_assert!(
                            place.y >= low - ROUNDING_MM && place.y <= high + ROUNDING_MM,
                            "frame {} at {:?}", index, place
                        );
                    }
                    at = to;
                }
            }
        }
        for pair in frames.windows(2) {
            let sorted = |places: &[Point]| {
                let mut bits: Vec<_> = places.iter().map(|p| (p.x.to_bits(), p.y.to_bits())).collect();
                bits.sort_unstable();
                bits
            };
            prop_assert_eq!(sorted(pair[0].end_breaks()), sorted(pair[1].begin_breaks()));
        }
        let pauses = |ops: &mut dyn Iterator<Item = PlotOp>| {
            let mut pauses: Vec<_> =
                ops.filter_map(|op| if let PlotOp::Dwell { duration } = op { Some(duration) } else { None }).collect();
            pauses.sort_unstable();
            pauses
        };
        prop_assert_eq!(pauses(&mut frames.iter().flat_map(Frame::sheet_ops)), pauses(&mut ops.iter().copied()));
    }

    /// Where a stroke goes over from one frame to another, and only there, both tell a break point: also
    /// where vertices lie on borders and on the ends of windows.
    #[test]
    fn a_stroke_goes_over_at_break_points_only(
        places in prop::collection::vec((0_u32..60, 0_u32..80), 2..20),
        window_mm in windows(),
    ) {
        let places: Vec<Point> =
            places.iter().map(|(x, y)| Point::new(5.0 * f64::from(*x), 5.0 * f64::from(*y))).collect();
        let travel = PlotOp::Travel { to: places[0] };
        let lines = places[1..].iter().zip(1_u16..);
        let ops: Vec<PlotOp> = std::iter::once(travel)
            .chain(lines.map(|(to, number)| PlotOp::Draw { to: *to, feed_mm_s: Some(f64::from(number)) }))
            .collect();
        let frames = by_passes(&ops, layout(window_mm)).unwrap();
        let mut drawn: BTreeMap<u64, Vec<(usize, Piece)>> = BTreeMap::new();
        for (index, frame) in frames.iter().enumerate() {
            let mut of_frame = BTreeMap::new();
            pieces(frame.sheet_ops(), &mut of_frame);
            for (number, of_op) in of_frame {
                drawn.entry(number).or_default().extend(of_op.into_iter().map(|piece| (index, piece)));
            }
        }
        let mut begins: Vec<Vec<Point>> = vec![Vec::new(); frames.len()];
        let mut ends = begins.clone();
        let mut at = places[0];
        let mut was_in = None;
        for number in 1..places.len() {
            let mut rest = drawn[&f64::from(u16::try_from(number).unwrap()).to_bits()].clone();
            while !rest.is_empty() {
                let (frame, piece) = rest.swap_remove(rest.iter().position(|(_, piece)| piece.from == at).unwrap());
                if let Some(before) = was_in.filter(|before| *before != frame) {
                    prop_assert_eq!(frame.abs_diff(before), 1);
                    ends[frame.min(before)].push(at);
                    begins[frame.max(before)].push(at);
                }
                (at, was_in) = (piece.to(), Some(frame));
            }
        }
        let sorted = |places: &[Point]| {
            let mut bits: Vec<_> = places.iter().map(|p| (p.x.to_bits(), p.y.to_bits())).collect();
            bits.sort_unstable();
            bits
        };
        for (index, frame) in frames.iter().enumerate() {
            prop_assert_eq!(sorted(frame.begin_breaks()), sorted(&begins[index]), "begin of frame {}", index);
            prop_assert_eq!(sorted(frame.end_breaks()), sorted(&ends[index]), "end of frame {}", index);
        }
    }

    /// Strokes that go back by no more than a frame's length give the same frames in one pass as in many.
    #[test]
    fn one_pass_gives_the_frames_of_many(mut strokes in strokes(), window_mm in windows()) {
        strokes.sort_by(|a, b| a.1.y.total_cmp(&b.1.y));
        let layout = layout(window_mm);
        let mut farthest_mm = f64::NEG_INFINITY;
        strokes.retain(|stroke| {
            let mut places = Vec::new();
            let mut at = Point::ORIGIN;
            for op in ops_of(std::slice::from_ref(stroke)) {
                if let PlotOp::DrawArc { centre, .. } = op {
                    let reach = Vec2::new(0.0, at.distance(centre));
                    places.extend([centre + reach, centre - reach]);
                }
                at = op.target().unwrap_or(at);
                places.push(at);
            }
            let least_mm = places[1..].iter().map(|place| place.y).fold(f64::INFINITY, f64::min);
            let most_mm = places.iter().map(|place| place.y).fold(f64::NEG_INFINITY, f64::max);
            let is_near = least_mm > farthest_mm.max(most_mm) - layout.frame_mm;
            if is_near {
                farthest_mm = farthest_mm.max(most_mm);
            }
            is_near
        });
        let ops = ops_of(&strokes);
        let streamed: Result<Vec<_>, _> = Frames::new(ops.iter().copied(), layout).collect();
        let all = |frames: Vec<Frame>| {
            let all = |f: &Frame| (f.ops().collect::<Vec<_>>(), f.begin_breaks().to_vec(), f.end_breaks().to_vec());
            frames.iter().map(all).collect::<Vec<_>>()
        };
        prop_assert_eq!(streamed.map(all), by_passes(&ops, layout).map(all));
    }

    /// Whatever numbers come, there is an answer: frames, or an error that names the operation.
    #[test]
    fn any_numbers_are_answered(
        numbers in prop::collection::vec(
            prop_oneof![Just(f64::NAN), Just(f64::INFINITY), -1e10..1e10_f64, -10.0..500.0_f64, 0.0..300.0_f64], 12
        ),
        window_mm in windows(),
    ) {
        let place = |n: usize| Point::new(numbers[n], numbers[n + 1]);
        let ops = [
            PlotOp::Travel { to: place(0) },
            PlotOp::Draw { to: place(2), feed_mm_s: None },
            PlotOp::DrawArc { centre: place(4), sweep_rad: numbers[6] * 0.01, to: place(7), feed_mm_s: None },
            PlotOp::Draw { to: place(9), feed_mm_s: Some(numbers[11]) },
        ];
        for frame in Frames::new(ops, layout(window_mm)).take(100) {
            match frame {
                Ok(frame) => prop_assert!(frame.ops().all(|op| op.target().is_none_or(Point::is_finite))),
                Err(error) => prop_assert!(error.to_string().contains("operation")),
            }
        }
    }
}
