//! Laws of ordering.

use crate::law_cases::cases;
use crate::seams::unsplit;
use plotter_vector::{
    Drawing, Order, PxPoint,
    order::{Lettering, OrderEffort, TextBlock},
};
use proptest::prelude::*;

/// Rounding of a sum of a few hundred lengths, px.
const ROUNDING_PX: f64 = 1e-9;

type Place = (u32, u32);

/// Strokes on a small grid, so that many ends meet and some strokes are closed.
fn strokes(side: u32, count: usize) -> impl Strategy<Value = Vec<Vec<Place>>> {
    let open = proptest::collection::vec((0..side, 0..side), 1..5);
    let closed = proptest::collection::vec((0..side, 0..side), 3..6).prop_map(|mut ring| {
        ring.extend(ring.first().copied());
        ring
    });
    proptest::collection::vec(prop_oneof![4 => open, 1 => closed], 0..count)
}

fn drawing_of(strokes: &[Vec<Place>], scale: f64) -> Drawing {
    let mut drawing = Drawing::new(40, 40);
    for stroke in strokes {
        drawing.push(stroke.iter().map(|(x, y)| PxPoint::new(f64::from(*x) * scale, f64::from(*y) * scale)));
    }
    drawing
}

/// What is drawn, whichever way: segments and dots as sorted text, a dot from its place to its place.
fn ink(drawing: &Drawing) -> Vec<String> {
    let mut ink = Vec::new();
    for stroke in drawing.strokes() {
        if let [dot] = stroke {
            ink.push(format!("{dot:?}"));
        }
        for pair in stroke.windows(2) {
            let (there, back) =
                (format!("{:?} {:?}", pair[0], pair[1]), format!("{:?} {:?}", pair[1], pair[0]));
            ink.push(there.min(back));
        }
    }
    ink.sort();
    ink
}

fn exactly_meeting() -> Order {
    Order::default().with_merge_gap_px(0.0)
}

/// From each end to the nearest stroke, and nothing changed afterwards.
fn nearest() -> Order {
    Order::default().with_effort(OrderEffort::Fast).with_budget(0)
}

/// Lines of up to 4 px, `side` times `side` of them, one to each square of 12 px.
fn scattered(side: u32) -> Drawing {
    let mut random = plotter_motion::SplitMix64::new(7);
    let mut drawing = Drawing::new(12 * side, 12 * side);
    for square in 0..side * side {
        let corner = (f64::from(12 * (square % side)), f64::from(12 * (square / side)));
        let mut place = |from: f64, within: usize| from + random.below(within) as f64;
        let from = PxPoint::new(place(corner.0, 12), place(corner.1, 12));
        drawing.push([from, PxPoint::new(place(from.x, 5), place(from.y, 5))]);
    }
    drawing
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_fast_shortens_the_way_of_the_nearest_up_to_25_000_strokes() {
    let way = |side, order: Order| {
        order.with_one_stroke(false).with_merge_gap_px(0.0).apply(&scattered(side)).pen_up_px()
    };
    let fast = Order::default().with_effort(OrderEffort::Fast);
    let [nearest_px, fast_px, best_px] = [nearest(), fast, Order::default()].map(|order| way(40, order));
    assert!(fast_px < 0.9 * nearest_px && best_px < fast_px, "{best_px}, {fast_px}, {nearest_px} px");
    assert_eq!(way(160, fast), way(160, nearest())); // 25,600: the nearest is all
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn what_is_drawn_is_kept(strokes in strokes(12, 40), one_stroke in any::<bool>()) {
        let drawing = drawing_of(&strokes, 1.0);
        let ordered = unsplit(&exactly_meeting().with_one_stroke(one_stroke).apply(&drawing), &drawing);
        prop_assert_eq!(ink(&ordered), ink(&drawing));
        prop_assert!(ordered.strokes().len() <= drawing.strokes().len());
        // Each joint saves the vertex that both strokes had.
        prop_assert_eq!(
            drawing.vertices() - ordered.vertices(),
            drawing.strokes().len() - ordered.strokes().len()
        );
    }

    #[test]
    fn over_gaps_no_more_is_drawn_than_the_gaps(strokes in strokes(60, 60)) {
        let drawing = drawing_of(&strokes, 0.4);
        let ordered = unsplit(&Order::default().apply(&drawing), &drawing);
        let joints = drawing.strokes().len() - ordered.strokes().len();
        let mut bridges = ink(&ordered);
        for line in ink(&drawing) {
            let found = bridges.iter().position(|other| *other == line);
            prop_assert!(found.is_some(), "{line} is lost");
            bridges.swap_remove(found.unwrap());
        }
        let growth = ordered.pen_down_px() - drawing.pen_down_px();
        prop_assert!(growth <= 0.5 * bridges.len() as f64 + ROUNDING_PX);
        // A stroke closed with itself is a bridge without a joint.
        prop_assert!(bridges.len() <= joints + ordered.strokes().len());
    }

    #[test]
    fn travel_never_grows(strokes in strokes(40, 60), fast in any::<bool>(), budget in 0_u64..3000) {
        let drawing = drawing_of(&strokes, 1.0);
        let effort = if fast { OrderEffort::Fast } else { OrderEffort::Best };
        let ordered = Order::default().with_effort(effort).with_budget(budget).apply(&drawing);
        prop_assert!(ordered.pen_up_px() <= drawing.pen_up_px());
    }

    #[test]
    fn each_pen_keeps_its_ink_and_draws_it_in_one_go(
        strokes in strokes(20, 40),
        pens in proptest::collection::vec(1_u8..4, 40),
    ) {
        let mut mixed = Drawing::new(40, 40);
        for (stroke, pen) in strokes.iter().zip(&pens) {
            mixed.push_with_pen(*pen, drawing_of(core::slice::from_ref(stroke), 1.0).stroke(0).iter().copied());
        }
        let as_drawn = exactly_meeting().apply(&mixed);
        let ordered = unsplit(&as_drawn, &mixed);
        let drawn: Vec<u8> = (0..ordered.strokes().len()).map(|stroke| ordered.pen(stroke)).collect();
        prop_assert!(drawn.is_sorted());
        let of_pen = |drawing: &Drawing, pen: u8| {
            let mut own = Drawing::new(40, 40);
            let strokes = (0..drawing.strokes().len()).filter(|stroke| drawing.pen(*stroke) == pen);
            strokes.for_each(|stroke| own.push(drawing.stroke(stroke).iter().copied()));
            own
        };
        let mut sorted = Drawing::new(40, 40);
        for pen in 1..4 {
            prop_assert_eq!(ink(&of_pen(&ordered, pen)), ink(&of_pen(&mixed, pen)));
            of_pen(&mixed, pen).strokes().for_each(|stroke| sorted.push(stroke.iter().copied()));
        }
        prop_assert!(as_drawn.pen_up_px() <= sorted.pen_up_px());
    }

    #[test]
    fn a_larger_budget_is_never_worse(strokes in strokes(40, 40)) {
        // Lines only, and not joined: the starts of rings are settled after the search.
        let lines: Vec<_> = strokes.into_iter().filter(|stroke| stroke.first() != stroke.last()).collect();
        let drawing = drawing_of(&lines, 1.0);
        let mut least = f64::INFINITY;
        for budget in [0, 1000, 10_000, 1_000_000] {
            let settings = exactly_meeting().with_budget(budget).with_one_stroke(false);
            let travel = settings.apply(&drawing).pen_up_px();
            prop_assert!(travel <= least + ROUNDING_PX);
            least = travel;
        }
    }

    #[test]
    fn the_next_dot_is_the_nearest_one_left(places in proptest::collection::vec((0_u32..30, 0_u32..30), 1..40)) {
        let drawing = drawing_of(&places.iter().map(|place| vec![*place]).collect::<Vec<_>>(), 1.0);
        let ordered = nearest().apply(&drawing);
        let dots: Vec<PxPoint> = ordered.strokes().map(|dot| dot[0]).collect();
        // Unless the given order was better.
        let greedy = dots.iter().enumerate().skip(1).all(|(index, dot)| {
            let pen = dots[index - 1];
            dots[index..].iter().all(|other| pen.distance(*dot) <= pen.distance(*other))
        });
        prop_assert!(greedy || ordered == drawing);
    }

    #[test]
    fn the_next_line_is_the_nearest_one_left_from_either_end(strokes in strokes(40, 40)) {
        let lines: Vec<_> = strokes.into_iter().filter(|stroke| stroke.first() != stroke.last()).collect();
        let drawing = drawing_of(&lines, 1.0);
        let unjoined = nearest().with_one_stroke(false).with_merge_gap_px(0.0);
        let ordered = unjoined.apply(&drawing);
        let ends: Vec<(PxPoint, PxPoint)> =
            ordered.strokes().map(|line| (line[0], line[line.len() - 1])).collect();
        let greedy = ends.iter().enumerate().skip(1).all(|(index, (from, _))| {
            let pen = ends[index - 1].1;
            ends[index..].iter().all(|(one, other)| pen.distance(*from) <= pen.distance(*one).min(pen.distance(*other)))
        });
        // The given order of the joined lines may be shorter.
        let as_given = unjoined.with_effort(OrderEffort::Join).apply(&drawing);
        prop_assert!(greedy || ordered == as_given);
    }

    #[test]
    fn without_a_budget_the_best_is_the_fast(strokes in strokes(40, 40)) {
        let drawing = drawing_of(&strokes, 1.0);
        prop_assert_eq!(Order::default().with_budget(0).apply(&drawing), nearest().apply(&drawing));
    }

    #[test]
    fn the_fast_is_never_worse_than_the_nearest(strokes in strokes(40, 40)) {
        // Lines only, and not joined, as above.
        let lines: Vec<_> = strokes.into_iter().filter(|stroke| stroke.first() != stroke.last()).collect();
        let drawing = drawing_of(&lines, 1.0);
        let nearest = nearest().with_one_stroke(false).with_merge_gap_px(0.0);
        let fast = nearest.with_budget(Order::default().budget);
        let [nearest_px, fast_px] = [nearest, fast].map(|order| order.apply(&drawing).pen_up_px());
        prop_assert!(fast_px <= nearest_px + ROUNDING_PX, "{fast_px} of {nearest_px} px");
    }

    #[test]
    fn a_connected_drawing_takes_the_fewest_strokes(lines in proptest::collection::vec((0_usize..9, 0_usize..9), 1..20)) {
        // Lines between nine nodes of which no three are in one line: an end is met only by ends.
        let places: [Place; 9] = [(0, 0), (7, 1), (3, 9), (12, 5), (9, 14), (1, 17), (16, 11), (5, 4), (14, 2)];
        let lines: Vec<(usize, usize)> = lines.into_iter().filter(|(from, to)| from != to).collect();
        let drawing =
            drawing_of(&lines.iter().map(|(from, to)| vec![places[*from], places[*to]]).collect::<Vec<_>>(), 1.0);
        let mut part: Vec<usize> = (0..9).collect();
        for (from, to) in &lines {
            let (old, new) = (part[*from], part[*to]);
            part.iter_mut().filter(|part| **part == old).for_each(|part| *part = new);
        }
        let degree = |node: usize| lines.iter().filter(|(from, to)| *from == node || *to == node).count();
        let least: usize = (0..9)
            .map(|name| {
                let nodes: Vec<usize> = (0..9).filter(|node| part[*node] == name && degree(*node) > 0).collect();
                let odd = nodes.iter().filter(|node| degree(**node) % 2 == 1).count();
                if nodes.is_empty() { 0 } else { (odd / 2).max(1) }
            })
            .sum();
        let ordered = exactly_meeting().apply(&drawing);
        // The given order may be shorter than any of fewer strokes.
        prop_assert!(ordered.strokes().len() == least || ordered == drawing);
    }

    #[test]
    fn lettering_is_drawn_in_one_go_and_as_it_is_read(
        words in proptest::collection::vec((0_u32..8, 0_u32..8, 2_u32..6, 0_u32..3), 1..6),
        lines in proptest::collection::vec((0_u32..800, 0_u32..800, 0_u32..8), 0..30),
        budget in prop_oneof![Just(0_u64), Just(100_000)],
    ) {
        // Between the lines of lettering, too high for a letter.
        let mut strokes: Vec<Vec<Place>> =
            lines.iter().map(|(from, to, row)| vec![(*from, 100 * row + 20), (*to, 100 * row + 80)]).collect();
        let mut words = words;
        words.sort_unstable();
        words.dedup_by_key(|word| (word.0, word.1));
        for (column, row, letters, shape) in words {
            for letter in 0..letters {
                // Sheared or mirrored L, 12 px high.
                let (x, y) = (100 * column + 11 * letter, 100 * row);
                strokes.push(match shape {
                    0 => vec![(x, y), (x, y + 12), (x + 8, y + 12)],
                    1 => vec![(x + 8, y), (x + 8, y + 12), (x, y + 12)],
                    _ => vec![(x, y), (x + 8, y), (x + 2, y + 12)],
                });
            }
        }
        // Letters first to last in another order than they are read.
        strokes.reverse();
        let drawing = drawing_of(&strokes, 1.0);
        let settings = exactly_meeting().with_lettering(Some(Lettering::default())).with_budget(budget);
        let ordered = unsplit(&settings.apply(&drawing), &drawing);
        prop_assert_eq!(ink(&ordered), ink(&drawing));
        for block in Lettering::default().find(&drawing) {
            let names = |drawing: &Drawing, index: usize| {
                let mut places: Vec<String> = drawing.stroke(index).iter().map(|at| format!("{at:?}")).collect();
                places.sort();
                places
            };
            let read: Vec<_> = block.letters().flatten().map(|stroke| names(&drawing, *stroke)).collect();
            let drawn: Vec<_> = (0..ordered.strokes().len()).map(|index| names(&ordered, index)).collect();
            prop_assert!(drawn.windows(read.len()).any(|run| run == read), "{read:?}\nin {drawn:?}");
        }
    }

    #[test]
    fn no_stroke_is_of_two_letters(strokes in strokes(60, 80)) {
        let drawing = drawing_of(&strokes, 1.0);
        let blocks = Lettering::default().find(&drawing);
        let mut read: Vec<usize> = blocks.iter().flat_map(TextBlock::letters).flatten().copied().collect();
        let count = read.len();
        read.sort_unstable();
        read.dedup();
        prop_assert_eq!(read.len(), count);
    }

    #[test]
    fn lettering_or_not_what_is_drawn_is_kept(strokes in strokes(60, 80)) {
        let drawing = drawing_of(&strokes, 1.0);
        let ordered = exactly_meeting().with_lettering(Some(Lettering::default())).apply(&drawing);
        let ordered = unsplit(&ordered, &drawing);
        prop_assert_eq!(ink(&ordered), ink(&drawing));
    }

    #[test]
    fn an_ordered_drawing_stays_as_it_is(strokes in strokes(40, 30)) {
        let once = Order::default().apply(&drawing_of(&strokes, 1.0));
        let twice = Order::default().apply(&once);
        prop_assert!(twice.pen_up_px() <= once.pen_up_px());
        prop_assert!(twice.strokes().len() <= once.strokes().len());
    }
}

#[test]
fn four_lines_are_drawn_in_the_best_order_nearly_always() {
    let (mut travel, mut least) = (0.0, 0.0);
    let lines = many(4 * 60, |x, y| vec![(x % 40, y % 40), (x / 40 % 40, y / 40 % 40)]);
    for first in 0..60 {
        let mut drawing = Drawing::new(40, 40);
        (4 * first..4 * first + 4).for_each(|line| drawing.push(lines.stroke(line).iter().copied()));
        travel += exactly_meeting().with_one_stroke(false).apply(&drawing).pen_up_px();
        least += least_travel(&drawing, &mut Vec::new());
    }
    assert!(travel <= 1.001 * least, "{travel} of {least}");
}

/// Travel of the best order of lines, by looking at all.
fn least_travel(drawing: &Drawing, drawn: &mut Vec<(usize, PxPoint)>) -> f64 {
    let mut least = if drawn.len() == drawing.strokes().len() { 0.0 } else { f64::INFINITY };
    for index in 0..drawing.strokes().len() {
        let line = drawing.stroke(index);
        for (from, to) in [(line[0], line[1]), (line[1], line[0])] {
            if drawn.iter().all(|(other, _)| *other != index) {
                let way = drawn.last().map_or(0.0, |(_, pen)| pen.distance(from));
                drawn.push((index, to));
                least = least.min(way + least_travel(drawing, drawn));
                drawn.pop();
            }
        }
    }
    least
}

#[test]
fn nothing_and_one_stroke_are_what_they_were() {
    let empty = Drawing::new(3, 4);
    assert_eq!(Order::default().apply(&empty), empty);
    for stroke in
        [vec![(1, 1)], vec![(1, 1), (2, 2)], vec![(1, 1), (1, 1)], vec![(1, 1), (5, 1), (3, 4), (1, 1)]]
    {
        let one = drawing_of(&[stroke], 1.0);
        assert_eq!(Order::default().apply(&one).strokes().len(), 1);
        assert_eq!(ink(&Order::default().apply(&one)), ink(&one));
    }
}

#[test]
fn no_effort_changes_nothing() {
    let drawing = drawing_of(&[vec![(9, 9), (8, 8)], vec![(0, 0), (1, 1)], vec![(8, 8), (7, 7)]], 1.0);
    assert_eq!(Order::default().with_effort(OrderEffort::None).apply(&drawing), drawing);
}

#[test]
fn odd_settings_are_taken_as_nothing() {
    let drawing = drawing_of(&[vec![(9, 9), (8, 8)], vec![(0, 0), (1, 1)], vec![(8, 8), (7, 7)]], 1.0);
    for merge_gap_px in [f64::NAN, f64::NEG_INFINITY, -1.0, f64::INFINITY, f64::MAX] {
        let ordered = Order::default().with_merge_gap_px(merge_gap_px).apply(&drawing);
        assert!(ordered.pen_up_px() <= drawing.pen_up_px());
    }
}

/// Strokes that a fixed sequence of numbers makes.
fn many(count: u32, stroke: impl Fn(u32, u32) -> Vec<Place>) -> Drawing {
    let mut state = 1_u32;
    let mut number = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 16
    };
    let strokes: Vec<Vec<Place>> = (0..count).map(|_| stroke(number(), number())).collect();
    drawing_of(&strokes, 1.0)
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn two_hundred_thousand_strokes_are_ordered_within_the_budget() {
    let noise = many(200_000, |x, y| vec![(x, y), (x + 40, y + y % 40)]);
    let settings = Order::default().with_budget(1_000_000);
    let ordered = settings.apply(&noise);
    assert!(ordered.pen_up_px() < noise.pen_up_px() / 50.0);
    // Counted, not timed.
    assert!(settings.apply(&noise) == ordered, "another order the second time");
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn all_ends_in_one_place_take_no_longer() {
    let star = many(20_000, |x, y| vec![(32_768, 32_768), (x, y), (32_768, 32_768)]);
    let ordered = exactly_meeting().apply(&star);
    assert_eq!(ordered.strokes().len(), 1);
    let dots = many(20_000, |_, _| vec![(5, 5)]);
    assert_eq!(Order::default().apply(&dots).pen_up_px(), 0.0);
    let rays = many(20_001, |x, y| vec![(32_768, 32_768), (x, y)]);
    assert!(Order::default().apply(&rays).strokes().len() <= 20_001 / 2 + 1);
}
