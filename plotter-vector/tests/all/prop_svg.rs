//! Reading SVG: what is written is read back, and no text brings it down.
#![cfg(feature = "svg-in")]

use crate::frechet;

use crate::law_cases::cases;
use frechet::{some_start_is_within, within};
use plotter_vector::{
    Curve, Drawing, Palette, PxPoint, Rgb, SvgOptions, ink::PalettePen, read_svg, svg, svg_in::SvgPens,
    write::svg_in_colour,
};
use proptest::prelude::*;

/// What reading what was written may be off, px: half of the last decimal, and single precision.
const ROUND_TRIP_PX: f64 = 0.001;

/// The same for arcs, px: their ends and radii are rounded, and the reader takes them for cubic curves.
const ARC_ROUND_TRIP_PX: f64 = 0.15;

/// Tolerance with which curves are read, mm, and the pixels of a millimetre: those of the format.
const READ_MM: f64 = 0.001;
const PX_PER_MM: f64 = 96.0 / 25.4;

/// Strokes on a sheet of 4000 x 3000 px; no two neighbouring vertices fall together when they are written.
fn any_strokes() -> impl Strategy<Value = Vec<(u8, Vec<PxPoint>)>> {
    let place = (-100.0..4100.0f64, -100.0..3100.0f64).prop_map(|(x, y)| PxPoint::new(x, y));
    let stroke = prop::collection::vec(place, 1..12).prop_map(|mut stroke| {
        stroke.dedup_by(|one, other| one.distance(*other) < 0.01);
        stroke
    });
    prop::collection::vec((1..=3u8, stroke), 1..20)
}

fn drawing(strokes: &[(u8, Vec<PxPoint>)]) -> Drawing {
    let mut drawing = Drawing::new(4000, 3000);
    for (pen, stroke) in strokes {
        drawing.push_with_pen(*pen, stroke.iter().copied());
    }
    drawing
}

/// Whether the strokes are the same ones in the same order.
fn same(one: &[(u8, Vec<PxPoint>)], other: &Drawing) -> bool {
    one.len() == other.strokes().len()
        && one.iter().zip(other.strokes()).all(|((_, one), other)| {
            one.len() == other.len()
                && one.iter().zip(other).all(|(one, other)| {
                    (one.x - other.x).abs() <= ROUND_TRIP_PX && (one.y - other.y).abs() <= ROUND_TRIP_PX
                })
        })
}

/// Mostly small, sometimes anything.
fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![60 => 0.1..20.0f32, 10 => -20.0..20.0f32, 1 => prop::num::f32::ANY]
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn what_svg_writes_is_read_back(strokes in any_strokes()) {
        let mut sorted = strokes.clone();
        sorted.sort_by_key(|(pen, _)| *pen);
        let mut text = String::new();
        svg(&drawing(&strokes), 1.0, &mut text).unwrap();
        let read = read_svg(text.as_bytes(), &SvgOptions::default()).unwrap();
        prop_assert_eq!((read.drawing.width_px(), read.drawing.height_px()), (4000, 3000));
        prop_assert!(same(&sorted, &read.drawing), "{:?}\n{:?}", sorted, read.drawing);
    }

    #[test]
    fn what_svg_in_colour_writes_is_read_back_with_its_pens(strokes in any_strokes()) {
        let pen = |number, colour| PalettePen { number, name: String::new(), colour, width_mm: None };
        let palette = Palette::new(vec![pen(1, Rgb::BLACK), pen(2, Rgb([208, 24, 24])), pen(3, Rgb([0, 0, 255]))]);
        let palette = palette.unwrap();
        let mut sorted = strokes.clone();
        sorted.sort_by_key(|(pen, _)| *pen);
        let mut text = String::new();
        svg_in_colour(&drawing(&strokes), &palette, None, 1.0, &mut text).unwrap();
        let read = read_svg(text.as_bytes(), &SvgOptions::default()).unwrap();
        prop_assert!(same(&sorted, &read.drawing));
        for (index, (pen, _)) in sorted.iter().enumerate() {
            let colour = read.pens.iter().find(|found| found.number == read.drawing.pen(index)).map(|pen| pen.colour);
            prop_assert_eq!(colour, palette.pen(*pen).map(|pen| pen.colour));
        }
    }

    #[test]
    fn cubic_curves_that_svg_writes_are_read_back(
        strokes in prop::collection::vec(
            prop::collection::vec((0.0..400.0f64, 0.0..400.0f64, any::<bool>(), 0.0..400.0f64, 0.0..400.0f64), 2..6),
            1..6,
        ),
    ) {
        let mut drawing = Drawing::new(400, 400);
        for stroke in &strokes {
            let vertices: Vec<PxPoint> = stroke.iter().map(|(x, y, ..)| PxPoint::new(*x, *y)).collect();
            let handles = stroke.iter().map(|(x, y, curved, u, v)| {
                curved.then(|| [PxPoint::new(*u, *y), PxPoint::new(*x, *v)])
            });
            drawing.push_curve(1, Curve { handles: handles.collect(), vertices, ..Curve::default() });
        }
        let mut text = String::new();
        svg(&drawing, 1.0, &mut text).unwrap();
        let curved = (0..drawing.strokes().len()).flat_map(|index| drawing.handles(index)).flatten().count();
        prop_assert_eq!(text.matches(" C").count(), curved);
        let options = SvgOptions::default().with_tolerance_mm(READ_MM);
        let read = read_svg(text.as_bytes(), &options).unwrap();
        prop_assert_eq!(read.drawing.strokes().len(), drawing.strokes().len());
        for (index, stroke) in read.drawing.strokes().enumerate() {
            let line = drawing.curve(index).chords(1e-4);
            prop_assert!(within(&line, stroke, ROUND_TRIP_PX + READ_MM * PX_PER_MM), "{:?}", drawing.curve(index));
        }
    }

    #[test]
    fn arcs_that_svg_writes_are_read_back(
        strokes in prop::collection::vec(
            prop::collection::vec((10.0..400.0f64, 10.0..400.0f64, prop_oneof![Just(0.0), -3.7..3.7f64]), 2..6),
            1..6,
        ),
        circles in prop::collection::vec((10.0..400.0f64, 10.0..400.0f64, 1.0..200.0f64), 0..3),
    ) {
        let mut drawing = Drawing::new(800, 800);
        for stroke in &strokes {
            let vertices = stroke.iter().map(|(x, y, _)| PxPoint::new(*x, *y)).collect();
            let bulges = stroke.iter().map(|(.., bulge)| *bulge).collect();
            drawing.push_curve(1, Curve { vertices, bulges, ..Curve::default() });
        }
        for (x, y, radius) in &circles {
            let ends = [-radius, *radius, -radius].map(|off| PxPoint::new(x + off, *y));
            drawing.push_curve(1, Curve { vertices: ends.to_vec(), bulges: vec![1.0, 1.0], ..Curve::default() });
        }
        let mut text = String::new();
        svg(&drawing, 1.0, &mut text).unwrap();
        prop_assert_eq!(text.matches("<circle").count(), circles.len());
        // 0.0004 px; the reader makes cubic curves of arcs first.
        let read = read_svg(text.as_bytes(), &SvgOptions::default().with_tolerance_mm(0.001)).unwrap();
        prop_assert_eq!(read.drawing.strokes().len(), drawing.strokes().len());
        for (index, stroke) in read.drawing.strokes().enumerate() {
            let meant = drawing.curve(index).chords(0.001);
            let near = if index < strokes.len() {
                within(stroke, &meant, ARC_ROUND_TRIP_PX)
            } else {
                let ring = &stroke[..stroke.len() - 1];
                let back: Vec<PxPoint> = meant.iter().rev().copied().collect();
                some_start_is_within(ring, &meant, ARC_ROUND_TRIP_PX) || some_start_is_within(ring, &back, ARC_ROUND_TRIP_PX)
            };
            prop_assert!(near, "{text}");
        }
    }

    #[test]
    fn bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = read_svg(&bytes, &SvgOptions::default());
    }

    #[test]
    fn attributes_are_read_or_refused(
        path in "([MLHVCSQTAZmlhvcsqtaz]? ?-?[0-9]{0,9}\\.?[0-9]{0,3}(e[0-9]{1,2})? ?){0,20}",
        matrix in prop::array::uniform6(any_number()),
        dashes in prop::collection::vec(any_number(), 0..4),
        offset in any_number(),
        sheet in prop::array::uniform4(any_number()),
    ) {
        let list = |numbers: &[f32]| numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(" ");
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{}\"><g transform=\"matrix({})\"><path d=\"M0 0 {path}\" \
             stroke=\"#000\" stroke-dasharray=\"{}\" stroke-dashoffset=\"{offset}\"/></g></svg>",
            list(&sheet), list(&matrix), list(&dashes)
        );
        let options = SvgOptions::default().with_max_vertices(10_000).with_pens(SvgPens::ByLayer);
        if let Ok(read) = read_svg(text.as_bytes(), &options) {
            prop_assert!(read.drawing.vertices() <= 10_000);
            let tall = read.drawing.height_px() > 0;
            prop_assert!(tall && read.pens.len() <= 1);
            for at in read.drawing.strokes().flatten() {
                prop_assert!(at.x.is_finite() && at.y.is_finite());
            }
        }
    }

    #[test]
    fn a_file_cut_off_anywhere_is_refused(at in 0..190usize) {
        let mut text = String::new();
        svg(&drawing(&[(1, vec![PxPoint::new(0.5, 0.5), PxPoint::new(9.5, 0.5)])]), 1.0, &mut text).unwrap();
        let end = at.min(text.trim_end().len() - 1);
        prop_assert!(read_svg(&text.as_bytes()[..end], &SvgOptions::default()).is_err());
    }
}
