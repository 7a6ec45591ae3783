//! What a drawing leaves out is told with its number, its size and its place: judged by distances that are
//! reckoned here, and by pictures of which all is known.

use crate::bare_ink::{PENS_PX, SIDE_PX, WITHIN_PX, distance_px, drawing};
use crate::pen_ink::ink_of;
use plotter_vector::{
    Bitmap, Ours, Pixel, Prefer, Progress, Vectorized, Vectorizer,
    areas::{AreaStyle, Areas, Hatch},
    picture::BitmapRows,
    report::{Spot, Spots},
    trace::SheetErrors,
};

/// How much wider the library may take a pen than it is: it measures the ink, which the pixels make wider,
/// and of short pieces half a width more is believed, px.
const WIDER_PX: f64 = 1.0;

fn is_in(spot: &Spot, at: Pixel) -> bool {
    (spot.from.x..=spot.to.x).contains(&at.x) && (spot.from.y..=spot.to.y).contains(&at.y)
}

fn errors(traced: Vectorized) -> SheetErrors {
    let Vectorized { error: report, beyond, bare, insides, .. } = traced;
    SheetErrors { report, worst: None, beyond, bare, insides }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ink_that_a_pen_leaves_bare_lies_in_a_spot_that_is_told() {
    let (mut checked, mut kept) = (0, 0);
    for (seed, pen_px) in (20_000..20_024).zip(PENS_PX.into_iter().cycle()) {
        let ink: Bitmap = ink_of(SIDE_PX, &drawing(seed), pen_px);
        // One stroke a line, so that something is bare.
        let ours = Ours::default().with_prefer(Prefer::Strokes).with_smallest_mark_px(0);
        let traced = Vectorizer::from(ours).trace(&ink).unwrap();
        let Spots { number, pixels, largest } = &traced.bare;
        assert_eq!(traced.error.max_px > WITHIN_PX, *number > 0, "seed {seed}");
        let told: u64 = largest.iter().map(|spot| spot.pixels).sum();
        assert!(told <= *pixels && *number >= largest.len() as u64, "seed {seed}");
        if *number > Spots::TOLD as u64 {
            continue;
        }
        assert_eq!((told, *number), (*pixels, largest.len() as u64), "seed {seed}");
        let worst_px = largest.iter().map(|spot| spot.max_px).fold(0.0, f64::max);
        assert_eq!(worst_px, if *number > 0 { traced.error.max_px } else { 0.0 }, "seed {seed}");
        for at in ink.ink().filter(|at| !traced.insides.largest.iter().any(|spot| is_in(spot, *at))) {
            let bare_px = distance_px(&traced.drawing, at) - 0.5 * pen_px;
            if bare_px > WITHIN_PX + WIDER_PX {
                assert!(
                    largest.iter().any(|spot| is_in(spot, at)),
                    "seed {seed}, {pen_px} px: {at:?} is {bare_px} px bare"
                );
                checked += 1;
            }
        }
        // By rows the same is told.
        let settings = Vectorizer::from(ours.with_band_rows(48));
        let sheet = settings.vectorize_rows_with_errors(&mut BitmapRows::new(&ink), &mut Progress::silent());
        let by_rows = sheet.unwrap().errors.unwrap();
        let whole = errors(traced);
        assert_eq!((&by_rows.bare, &by_rows.insides), (&whole.bare, &whole.insides), "seed {seed}");
        assert_eq!(by_rows.are_within(WITHIN_PX), whole.are_within(WITHIN_PX));
        kept += u32::from(whole.are_within(WITHIN_PX));
    }
    assert!(checked > 100, "only {checked} pixels were bare");
    assert!(kept < 24, "all were kept");
}

/// Two squares of 100 and 60 px beside a line, as the middles of pixels.
fn squares() -> Bitmap {
    let mut ink = Bitmap::new(300, 300).unwrap();
    for (x, y) in (0..300).flat_map(|y| (0..300).map(move |x| (x, y))) {
        let large = (20..120).contains(&x) && (20..120).contains(&y);
        let small = (160..220).contains(&x) && (30..90).contains(&y);
        let line = (20..280).contains(&x) && (200..204).contains(&y);
        ink.set(Pixel::new(x, y), large || small || line);
    }
    ink
}

#[test]
fn the_inside_of_an_area_that_is_outlined_is_told() {
    let traced = |style| {
        let areas = Areas::default().with_style(style).with_pen_px(2.5);
        Vectorizer::from(Ours::default().with_areas(areas)).trace(&squares()).unwrap()
    };
    let outlined = traced(AreaStyle::Outline);
    let Spots { number, pixels, largest } = &outlined.insides;
    assert_eq!((*number, largest.len()), (2, 2));
    // The pen covers 1.25 px from what it draws, half a one more is allowed, and as much as a pixel is left
    // open by the raster.
    let far = |least_px: f64| {
        let ink = squares();
        let in_square = |at: &Pixel| at.y < 150;
        let far = ink.ink().filter(in_square).filter(|at| distance_px(&outlined.drawing, *at) > least_px);
        far.collect::<Vec<_>>()
    };
    let (most, surely) = (far(1.25 + WITHIN_PX), far(1.25 + WITHIN_PX + 1.0));
    assert!((surely.len() as u64..=most.len() as u64).contains(pixels), "{pixels}, not {}", most.len());
    assert!(surely.iter().all(|at| largest.iter().any(|spot| is_in(spot, *at))), "{largest:?}");
    assert!(largest[0].pixels > 88 * 88 && largest[1].pixels > 48 * 48 && surely.len() > 88 * 88 + 48 * 48);
    assert!(!errors(outlined).are_within(10.0), "however much is allowed");
    // Hatched without gaps nothing is left out, with gaps the ink between the lines is.
    let hatched =
        |pitch_px| traced(AreaStyle::OutlineAndHatch(Hatch::default().with_pitch_px(pitch_px))).insides;
    assert_eq!(hatched(2.5), Spots::default());
    let gaps = hatched(8.0);
    assert!(gaps.number > 20 && (4_000..9_000).contains(&gaps.pixels), "{gaps:?}");
}
