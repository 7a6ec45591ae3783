//! Laws of areas: splitting ink by width, outlines, hatching.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "places on pictures of 200 px"
)]

use crate::segment_distance;

use crate::law_cases::cases;
use plotter_vector::{
    Bitmap, Pixel, PxPoint,
    areas::{AreaPath, AreaStyle, Areas, Hatch, Outlines, inset_outlines, split_by_width},
};
use proptest::prelude::*;
use segment_distance::segment_distance;

/// What a disc must be wider by than a line to be an area wherever its centre lies, px.
const DISC_MARGIN_PX: f64 = 3.0;

/// How far a line that runs into a disc may reach into it, px.
const ROOT_PX: f64 = 2.0;

/// What the path of a pen's centre may be nearer to the paper by than half the pen, px: rounding by
/// interpolation.
const INSET_TOLERANCE_PX: f64 = 0.5;

/// What a place may be farther by than half a pen from the hatching that covers it, px.
const COVER_TOLERANCE_PX: f64 = 1.0;

fn pixels(width: u32, height: u32) -> impl Iterator<Item = Pixel> {
    (0..height).flat_map(move |y| (0..width).map(move |x| Pixel::new(x, y)))
}

/// A picture of what is ink.
fn picture(width: u32, height: u32, is_ink: impl Fn(PxPoint) -> bool) -> Bitmap {
    let mut picture = Bitmap::new(width, height).unwrap();
    pixels(width, height).for_each(|pixel| picture.set(pixel, is_ink(pixel.into())));
    picture
}

/// A line of some width with round ends; a disc when both are the same.
#[derive(Clone, Copy, Debug)]
struct Stroke {
    from: PxPoint,
    to: PxPoint,
    width_px: f64,
    is_paper: bool,
}

fn place(width: f64, height: f64) -> impl Strategy<Value = PxPoint> {
    (0.0..width, 0.0..height).prop_map(|(x, y)| PxPoint::new(x, y))
}

/// Lines, thick and thin, some of them scratched out again.
fn drawings(width: u32, height: u32, widest_px: f64) -> impl Strategy<Value = Bitmap> {
    let (w, h) = (f64::from(width), f64::from(height));
    let stroke = (place(w, h), place(w, h), 1.0..widest_px, 0..4)
        .prop_map(|(from, to, width_px, paper)| Stroke { from, to, width_px, is_paper: paper == 0 });
    proptest::collection::vec(stroke, 1..7).prop_map(move |strokes| {
        picture(width, height, |at| {
            let covers = |s: &&Stroke| segment_distance(at, s.from, s.to) <= s.width_px / 2.0;
            strokes.iter().rev().find(covers).is_some_and(|stroke| !stroke.is_paper)
        })
    })
}

/// Every pixel its own: black with `ink` of 10.
fn noise(width: u32, height: u32) -> impl Strategy<Value = Bitmap> {
    (1..10_u8).prop_flat_map(move |ink| {
        proptest::collection::vec(0..10_u8, (width * height) as usize).prop_map(move |levels| {
            let at = |place: PxPoint| levels[place.y as usize * width as usize + place.x as usize];
            picture(width, height, |place| at(place) < ink)
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn each_ink_pixel_is_thick_or_thin(
        ink in prop_oneof![drawings(150, 70, 30.0), noise(70, 30)],
        max_line_px in 0_u32..20,
    ) {
        let split = split_by_width(&ink, max_line_px);
        for at in pixels(ink.width(), ink.height()) {
            prop_assert_eq!(split.thick.get(at) || split.thin.get(at), ink.get(at));
            prop_assert!(!(split.thick.get(at) && split.thin.get(at)));
        }
    }

    #[test]
    fn a_disc_wider_than_lines_is_thick_in_any_ink(
        around in drawings(110, 110, 20.0),
        centre in place(20.0, 20.0),
        max_line_px in 0_u32..40,
        more_px in 0.0..20.0_f64,
    ) {
        let centre = PxPoint::new(centre.x + 45.0, centre.y + 45.0);
        let radius = (f64::from(max_line_px) + DISC_MARGIN_PX + more_px) / 2.0;
        let in_disc = |at: PxPoint, less_px| at.distance(centre) <= radius - less_px;
        let alone = picture(110, 110, |at| in_disc(at, 0.0));
        prop_assert_eq!(split_by_width(&alone, max_line_px).thick, alone);
        let ink = picture(110, 110, |at| in_disc(at, 0.0) || around.get(Pixel::new(at.x as u32, at.y as u32)));
        let split = split_by_width(&ink, max_line_px);
        for at in pixels(110, 110).filter(|at| in_disc((*at).into(), ROOT_PX)) {
            prop_assert!(split.thick.get(at), "{:?} of a disc around {:?}, radius {}", at, centre, radius);
        }
    }

    #[test]
    fn a_straight_line_is_thin(
        from in place(150.0, 90.0),
        to in place(150.0, 90.0),
        max_line_px in 1_u32..40,
        share in 0.0..=1.0_f64,
    ) {
        let width_px = f64::from(max_line_px) * share;
        let ink = picture(150, 90, |at| segment_distance(at, from, to) <= width_px / 2.0);
        prop_assert_eq!(split_by_width(&ink, max_line_px).thin, ink);
    }

    #[test]
    fn filled_outlines_are_the_ink(ink in prop_oneof![drawings(130, 40, 20.0), noise(130, 20)]) {
        // Even-odd along each row: the columns at which vertical cracks cross the row's middle.
        let mut crossings = vec![Vec::new(); ink.height() as usize];
        let mut enclosed = 0;
        for outline in Outlines::new(&ink) {
            let corners: Vec<_> = outline.corners().collect();
            prop_assert_eq!(corners.len(), outline.cracks());
            for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                prop_assert_eq!(from.distance(*to), 1.0);
                if from.x == to.x {
                    crossings[from.y.min(to.y) as usize].push(from.x as u32);
                }
            }
            enclosed += outline.enclosed_px();
        }
        let filled = picture(ink.width(), ink.height(), |at| {
            let before = crossings[at.y as usize].iter().filter(|x| f64::from(**x) < at.x);
            before.count() % 2 == 1
        });
        prop_assert_eq!(enclosed, ink.count() as i64);
        prop_assert_eq!(filled, ink);
    }

    #[test]
    fn no_pen_inside_an_outline_inks_the_paper(
        ink in prop_oneof![drawings(70, 60, 40.0), noise(50, 30)],
        pen_px in 0.0..12.0_f64,
    ) {
        for at in inset_outlines(&ink, pen_px / 2.0).flatten() {
            let nearest = nearest_paper(&ink, at);
            prop_assert!(nearest >= pen_px / 2.0 + 0.5 - INSET_TOLERANCE_PX, "{} at {:?}", nearest, at);
        }
    }
}

/// Distance to the nearest centre of a paper pixel, px, outside of the picture too; [`FAR_PX`] when it is
/// farther.
fn nearest_paper(ink: &Bitmap, at: PxPoint) -> f64 {
    let (left, top) = ((at.x - FAR_PX).floor() as i64, (at.y - FAR_PX).floor() as i64);
    let reach = 2 * FAR_PX as i64 + 2;
    let around = (top..top + reach).flat_map(|y| (left..left + reach).map(move |x| (x, y)));
    let is_ink = |(x, y): (i64, i64)| {
        let pixel = u32::try_from(x).ok().zip(u32::try_from(y).ok());
        pixel.is_some_and(|(x, y)| ink.get(Pixel::new(x, y)))
    };
    let centres = around.filter(|place| !is_ink(*place));
    let distances = centres.map(|(x, y)| at.distance(PxPoint::new(x as f64 + 0.5, y as f64 + 0.5)));
    distances.fold(FAR_PX, f64::min)
}

/// How far paper is looked for, px: beyond half the widest pen.
const FAR_PX: f64 = 8.0;

/// Segments of a path; a dot is one of no length.
fn segments(path: &AreaPath) -> Vec<(PxPoint, PxPoint)> {
    let closing = path.sites.first().filter(|_| path.closed);
    let next = path.sites.iter().skip(1).chain(closing);
    path.sites.iter().copied().zip(next.copied()).collect()
}

fn hatches() -> impl Strategy<Value = (Hatch, f64)> {
    (3.0..9.0_f64, 0.5..=1.0_f64, -7.0..7.0_f64, any::<bool>(), prop_oneof![Just(0.0), 5.0..200.0_f64])
        .prop_map(|(pen_px, share, angle_rad, cross, max_join_px)| {
            (
                Hatch::default()
                    .with_pitch_px(pen_px * share)
                    .with_angle_rad(angle_rad)
                    .with_cross(cross)
                    .with_max_join_px(max_join_px),
                pen_px,
            )
        })
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn hatching_stays_inside(ink in drawings(70, 60, 40.0), (hatch, pen_px) in hatches()) {
        let areas = Areas::default().with_style(AreaStyle::Hatch(hatch)).with_pen_px(pen_px);
        for path in areas.paths(&ink).unwrap() {
            for (from, to) in segments(&path) {
                // A straight line is looked at every half pixel.
                let steps = (from.distance(to) * 2.0).ceil().max(1.0) as u32;
                for step in 0..=steps {
                    let share = f64::from(step) / f64::from(steps);
                    let at = PxPoint::new(from.x + share * (to.x - from.x), from.y + share * (to.y - from.y));
                    let nearest = nearest_paper(&ink, at);
                    prop_assert!(
                        nearest >= pen_px / 2.0 + 0.5 - INSET_TOLERANCE_PX,
                        "{} px from the paper at {:?}", nearest, at
                    );
                }
            }
        }
    }

    #[test]
    fn hatching_covers_where_the_pen_can_be(ink in drawings(70, 60, 40.0), (hatch, pen_px) in hatches()) {
        let areas = Areas::default().with_style(AreaStyle::Hatch(hatch)).with_pen_px(pen_px);
        let drawn: Vec<_> = areas.paths(&ink).unwrap().flat_map(|path| segments(&path)).collect();
        for pixel in ink.ink().filter(|pixel| nearest_paper(&ink, (*pixel).into()) > pen_px / 2.0 + 0.5) {
            let nearest = drawn.iter().map(|(from, to)| segment_distance(pixel.into(), *from, *to));
            let nearest = nearest.fold(f64::MAX, f64::min);
            prop_assert!(nearest <= pen_px / 2.0 + COVER_TOLERANCE_PX, "{} px from {:?}", nearest, pixel);
        }
    }

    #[test]
    fn outline_and_hatching_ink_the_area_to_its_rim(ink in drawings(70, 60, 40.0), (hatch, pen_px) in hatches()) {
        // What a pen can reach at all: within half its width of a place where its centre may be.
        let centres: Vec<PxPoint> = ink.ink().map(PxPoint::from)
            .filter(|at| nearest_paper(&ink, *at) > pen_px / 2.0 + 0.5).collect();
        let areas = Areas::default().with_style(AreaStyle::OutlineAndHatch(hatch)).with_pen_px(pen_px);
        let drawn: Vec<_> = areas.paths(&ink).unwrap().flat_map(|path| segments(&path)).collect();
        for pixel in ink.ink() {
            let at = PxPoint::from(pixel);
            if centres.iter().all(|centre| centre.distance(at) > pen_px / 2.0) {
                continue;
            }
            let nearest = drawn.iter().map(|(from, to)| segment_distance(at, *from, *to)).fold(f64::MAX, f64::min);
            prop_assert!(nearest <= pen_px / 2.0 + COVER_TOLERANCE_PX, "{} px from {:?}", nearest, pixel);
        }
    }

    #[test]
    fn each_line_of_the_hatching_is_drawn_once_however_it_is_joined(
        ink in drawings(70, 60, 40.0),
        (hatch, pen_px) in hatches(),
    ) {
        // A pitch above the pen's width: nothing but lines and joins.
        let open = hatch.with_pitch_px(pen_px * 1.3).with_cross(false);
        let straight = |max_join_px| {
            let areas = Areas::default().with_style(AreaStyle::Hatch(open.with_max_join_px(max_join_px))).with_pen_px(pen_px);
            areas.paths(&ink).unwrap().collect::<Vec<_>>()
        };
        let mut lines: Vec<_> = straight(0.0).iter().map(|path| ends(&path.sites[0], &path.sites[1])).collect();
        lines.sort_unstable();
        let joined = straight(hatch.max_join_px);
        let mut found: Vec<_> = joined.iter().flat_map(segments).map(|(from, to)| ends(&from, &to)).collect();
        found.sort_unstable();
        // Each line is among the segments as often as it is a line.
        let mut rest = found.iter();
        for line in &lines {
            prop_assert!(rest.any(|segment| segment == line), "{:?} is not drawn", line);
        }
        prop_assert!(joined.len() <= lines.len());
        let length = |paths: &[AreaPath]| -> f64 {
            paths.iter().flat_map(segments).map(|(from, to)| from.distance(to)).sum()
        };
        let joins = (lines.len() - joined.len()) as f64;
        prop_assert!(length(&joined) <= length(&straight(0.0)) + joins * hatch.max_join_px + 1e-6);
    }
}

/// A segment whichever way it is drawn, comparable.
fn ends(a: &PxPoint, b: &PxPoint) -> [[u64; 2]; 2] {
    let mut ends = [a, b].map(|at| [at.x.to_bits(), at.y.to_bits()]);
    ends.sort_unstable();
    ends
}
