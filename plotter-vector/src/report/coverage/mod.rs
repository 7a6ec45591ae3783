//! [`coverage`]: how far every pixel of the ink lies from the drawing.

mod beyond;
mod pen_segment;
mod pen_widths;
mod segment_index;
mod spots;

use crate::areas::Opening;
use crate::picture::runs::ink_runs;
use crate::{
    picture::{Bitmap, Pixel},
    report::{ErrorReport, ErrorTally},
    stroke::Drawing,
};
pub(crate) use beyond::FARTHEST_PX;
pub use beyond::{Beyond, beyond_ink};
pub(crate) use pen_segment::{Across, PROBE_ROWS, PROBES, PenSegment, segments};
pub(crate) use pen_widths::{JUMP_PX, set_widths};
pub(crate) use segment_index::Index;
pub use spots::{Spot, Spots};
pub(crate) use spots::{SpotRun, SpotTally, add_pixel};

/// Errors of all pixels of the ink that a drawing stands for, whatever way it was made; the inside of an area
/// that is outlined counts, too, which [`Vectorized::error`](crate::trace::Vectorized::error) leaves out.
///
/// A pen w px wide that follows the segment covers what lies up to w / 2 from it; the error of a pixel is
/// what the distance of its centre is more than that. On lines one pixel wide it is the distance itself; from
/// there to 1.5 px the pen covers more and more. The width is that of the line: measured on the ink, across
/// the stroke, where the stroke is not two lines that run into one. Arcs are measured as arcs, cubic curves
/// as chords no farther than 0.005 px from them.
///
/// ```
/// # use plotter_vector::{Bitmap, Drawing, PxPoint, report::coverage};
/// let bar = Bitmap::from_picture("######\n######\n######\n")?;
/// let mut drawing = Drawing::new(6, 3);
/// drawing.push([PxPoint::new(0.5, 1.5), PxPoint::new(2.5, 1.5)]); // three pixels too short
/// let errors = coverage(&bar, &drawing);
/// assert_eq!((errors.pixels, errors.max_px), (18, 10.0_f64.sqrt() - 1.5));
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
#[must_use]
pub fn coverage(ink: &Bitmap, drawing: &Drawing) -> ErrorReport {
    let mut tally = ErrorTally::default();
    add_coverage(ink, drawing, (None, f64::INFINITY), &mut tally);
    tally.report()
}

/// The pieces of a drawing of this ink with the ink's widths, to be looked up by place.
pub(crate) fn with_widths(ink: &Bitmap, drawing: &Drawing, areas: Option<AreaPen<'_>>) -> Index {
    let mut segments = segments(drawing);
    let widths = segments.iter().map(|segment| {
        if segment.has_probes() {
            PROBES.map(|part| segment.width_at(part, ink, 0))
        } else {
            [Across::default(); PROBES.len()]
        }
    });
    let widths: Vec<_> = widths.collect();
    set_widths(&mut segments, &widths, areas);
    Index::new(segments, ink.width(), ink.height())
}

/// The pixel with the greatest error of [`coverage`], the first of several in reading order, and its error,
/// px; none without ink.
///
/// ```
/// # use plotter_vector::{Bitmap, Drawing, Pixel, PxPoint, report::worst_pixel};
/// let dots = Bitmap::from_picture("#....#\n")?;
/// let mut drawing = Drawing::new(6, 1);
/// drawing.push([PxPoint::new(0.5, 0.5)]);
/// assert_eq!(worst_pixel(&dots, &drawing), Some((Pixel::new(5, 0), 5.0)));
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
#[must_use]
pub fn worst_pixel(ink: &Bitmap, drawing: &Drawing) -> Option<(Pixel, f64)> {
    let mut tally = ErrorTally::default();
    add_coverage(ink, drawing, (None, f64::INFINITY), &mut tally);
    tally.worst()
}

/// What told areas from lines, and the pen that draws their outlines and hatching.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AreaPen<'a> {
    pub(crate) opening: &'a Opening,
    pub(crate) pen_px: f64,
    /// Whether lines one pixel wide are their pixels.
    pub(crate) is_raster: bool,
}

/// What of a drawing is not as its ink.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Faults {
    /// What is drawn beside the ink.
    pub(crate) beyond: Beyond,
    /// Ink whose errors count and are greater than what is allowed.
    pub(crate) bare: Spots,
    /// Ink inside of areas that no pen draws.
    pub(crate) insides: Spots,
}

impl Faults {
    /// Both together.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            beyond: self.beyond.and(other.beyond),
            bare: self.bare.and(other.bare),
            insides: self.insides.and(other.insides),
        }
    }

    /// Of lines one pixel wide, which need no width; what is bare is looked for only where some is known to
    /// be.
    pub(crate) fn of_hairlines(ink: &Bitmap, drawing: &Drawing, within_px: f64, has_bare: bool) -> Self {
        let index = Index::new(segments(drawing), ink.width(), ink.height());
        let beyond = index.beyond(ink, 0, &(0..ink.height()));
        let mut faults = Self { beyond, ..Self::default() };
        if has_bare {
            let (mut bare, mut covering) = (Vec::new(), 0);
            for (y, run) in (0..ink.height()).flat_map(|y| ink_runs(ink.row(y)).map(move |run| (y, run))) {
                index.run_errors(run, y, &mut covering, |at, error_px| {
                    if error_px > within_px {
                        add_pixel(&mut bare, at, error_px);
                    }
                });
            }
            faults.bare = SpotTally::of(bare);
        }
        faults
    }
}

/// Adds the errors of [`coverage`] to others, and tells what is not as the ink: more than `within_px` off,
/// drawn beside it, or inside of areas and not drawn. Where areas are drawn as such, the ink inside of them
/// has no errors that count, only that at their edge, and their outline is as wide as its pen.
pub(crate) fn add_coverage(
    ink: &Bitmap,
    drawing: &Drawing,
    (areas, within_px): (Option<AreaPen<'_>>, f64),
    tally: &mut ErrorTally,
) -> Faults {
    let index = with_widths(ink, drawing, areas);
    let rows = 0..ink.height();
    let beyond = index.beyond(ink, 0, &rows);
    let counted = areas.map(|areas| areas.opening.without_insides(ink.clone()));
    let insides = counted.as_ref().map(|counted| ink.clone().without(counted));
    let insides = insides.map(|insides| SpotTally::of(index.bare_runs(&insides, 0, &rows, within_px)));
    let ink = counted.as_ref().unwrap_or(ink);
    let (mut bare, mut covering) = (Vec::new(), 0);
    for y in rows {
        for run in ink_runs(ink.row(y)) {
            // The first of several worst ones in reading order, if none has an error.
            tally.note_worst(Pixel::new(run.start, y), 0.0);
            let exact = index.run_errors(run, y, &mut covering, |at, error_px| {
                tally.add_pixel(at, error_px);
                if error_px > within_px {
                    add_pixel(&mut bare, at, error_px);
                }
            });
            tally.add_exact(exact);
        }
    }
    Faults { beyond, bare: SpotTally::of(bare), insides: insides.unwrap_or_default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::PxPoint;

    #[test]
    fn the_middle_of_a_wide_line_has_no_error() {
        let mut ink = Bitmap::new(200, 9).unwrap();
        (2..7).for_each(|y| (0..200).for_each(|x| ink.set(Pixel::new(x, y), true)));
        let mut drawing = Drawing::new(200, 9);
        drawing.push([PxPoint::new(0.5, 4.5), PxPoint::new(199.5, 4.5)]);
        assert_eq!(coverage(&ink, &drawing).max_px, 0.0);
        let mut high = Drawing::new(200, 9);
        high.push([PxPoint::new(0.5, 3.5), PxPoint::new(199.5, 3.5)]);
        // Its pen ends 1.5 px above, and 0.75 px of what it can be wider: 3 px to the lowest row, less half
        // of 4.5 px.
        assert_eq!(coverage(&ink, &high).max_px, 0.75);
    }

    /// Ink 300 x 80 px.
    fn inked(is_ink: impl Fn(f64, f64) -> bool) -> Bitmap {
        let mut ink = Bitmap::new(300, 80).unwrap();
        for (x, y) in (0..80).flat_map(|y| (0..300).map(move |x| (x, y))) {
            ink.set(Pixel::new(x, y), is_ink(f64::from(x) + 0.5, f64::from(y) + 0.5));
        }
        ink
    }

    #[test]
    fn a_needle_is_covered_where_it_is_thin_and_where_it_is_thick() {
        // From 12 px to nothing within 240 px.
        let needle = inked(|x, y| x > 20.0 && (y - 40.0).abs() <= 6.0 * (260.0 - x) / 240.0);
        let mut drawing = Drawing::new(300, 80);
        drawing.push([PxPoint::new(20.5, 40.0), PxPoint::new(259.5, 40.0)]);
        let errors = coverage(&needle, &drawing);
        assert!(errors.max_px <= 0.5, "{errors:?}");
        // Half of it drawn leaves the other half: its far end is 119.5 px away, less half of what is left of
        // the width.
        let mut half = Drawing::new(300, 80);
        half.push([PxPoint::new(139.5, 40.0), PxPoint::new(259.5, 40.0)]);
        let (at, error_px) = worst_pixel(&needle, &half).unwrap();
        assert!(at.x == 20 && (error_px - 116.0).abs() < 1.5, "{error_px} at {at:?}");
    }

    #[test]
    fn two_lines_that_run_into_one_are_no_wide_line() {
        // Lines of 4 px that are 3 px apart for a third of their way, and then leave each other.
        let off = |x: f64| 1.5 + (x - 120.0).max(0.0) * 0.15;
        let both = inked(|x, y| {
            (20.0..280.0).contains(&x) && (y - 40.0).abs() <= off(x) + 2.0 && (y - 40.0).abs() >= off(x) - 2.0
        });
        let line = |side: f64| [20.5, 120.0, 279.5].map(|x| PxPoint::new(x, 40.0 + side * off(x)));
        let mut whole = Drawing::new(300, 80);
        whole.push(line(-1.0));
        whole.push(line(1.0));
        assert!(coverage(&both, &whole).max_px <= 1.0, "{:?}", coverage(&both, &whole));
        // The middle of both, and one of them: of the other its outer edge is bare.
        let mut one = Drawing::new(300, 80);
        one.push(line(-1.0));
        one.push([PxPoint::new(140.0, 40.0 + off(140.0)), PxPoint::new(279.5, 40.0 + off(279.5))]);
        let error_px = coverage(&both, &one).max_px;
        assert!(error_px >= 2.0, "{error_px}");
    }

    #[test]
    fn a_blot_is_not_covered_by_a_line_beside_thin_ones() {
        let ink = inked(|x, y| {
            (x - 60.0).hypot(y - 40.0) <= 35.0
                || x > 120.0 && [20.5, 40.5, 60.5].iter().any(|at| (y - at).abs() <= 1.5)
        });
        let mut drawing = Drawing::new(300, 80);
        [20.5, 40.5, 60.5]
            .iter()
            .for_each(|y| drawing.push([PxPoint::new(121.5, *y), PxPoint::new(298.5, *y)]));
        drawing.push([PxPoint::new(30.0, 40.0), PxPoint::new(90.0, 40.0)]);
        // From the line to the top of the disc are 35 px, less half of the pen of 3 px and what short strokes
        // may be wider.
        let error_px = coverage(&ink, &drawing).max_px;
        assert!((32.0..=33.5).contains(&error_px), "{error_px}");
    }

    #[test]
    fn a_line_one_pixel_wide_is_measured_by_distance() {
        let ink = Bitmap::from_picture("#..\n.#.\n..#\n").unwrap();
        let mut drawing = Drawing::new(3, 3);
        drawing.push([PxPoint::new(0.5, 1.5), PxPoint::new(2.5, 1.5)]);
        let errors = coverage(&ink, &drawing);
        assert_eq!((errors.pixels, errors.max_px), (3, 1.0));
    }

    #[test]
    fn an_arc_is_measured_as_one() {
        // A ring of radius 60 and 5 px, drawn by its middle: chords of a degree would already show.
        let mut ink = Bitmap::new(140, 140).unwrap();
        for (x, y) in (0..140).flat_map(|y| (0..140).map(move |x| (x, y))) {
            let away = libm::hypot(f64::from(x) - 69.5, f64::from(y) - 69.5);
            ink.set(Pixel::new(x, y), (away - 60.0).abs() <= 2.5);
        }
        let (left, right) = (PxPoint::new(10.0, 70.0), PxPoint::new(130.0, 70.0));
        let mut drawing = Drawing::new(140, 140);
        let (vertices, bulges) = (vec![left, right, left], vec![1.0, 1.0]);
        drawing.push_curve(1, crate::stroke::Curve { vertices, bulges, ..crate::stroke::Curve::default() });
        // Across the slope of a raster edge: half a pixel at most.
        let errors = coverage(&ink, &drawing);
        assert!(errors.max_px <= 0.5, "{}", errors.max_px);
        let mut half = Drawing::new(140, 140);
        let (vertices, bulges) = (vec![left, right], vec![1.0]);
        half.push_curve(1, crate::stroke::Curve { vertices, bulges, ..crate::stroke::Curve::default() });
        let (at, error_px) = worst_pixel(&ink, &half).unwrap();
        // The lowest pixel is as far from both ends, less half the width of the ring.
        assert_eq!(at.y, 131);
        assert!((error_px - (libm::hypot(59.5, 61.5) - 2.5)).abs() < 0.3, "{error_px}");
    }

    #[test]
    fn a_cubic_curve_is_measured_on_its_way() {
        // From (2, 10) over the top, a parabola with its top at (10, 4): as wide as one pixel, drawn by its
        // pixels.
        let at = PxPoint::new;
        let handles = vec![Some([at(22.0 / 3.0, 2.0), at(38.0 / 3.0, 2.0)])];
        let mut drawing = Drawing::new(20, 12);
        drawing.push_curve(
            1,
            crate::stroke::Curve {
                vertices: vec![at(2.0, 10.0), at(18.0, 10.0)],
                handles,
                ..crate::stroke::Curve::default()
            },
        );
        let mut ink = Bitmap::new(20, 12).unwrap();
        ink.set(Pixel::new(9, 3), true); // its centre 0.5 px left and above the top
        let errors = coverage(&ink, &drawing);
        assert!((errors.max_px - 0.5).abs() < 0.03, "{}", errors.max_px);
    }

    #[test]
    fn far_ink_is_measured_across_the_whole_picture() {
        let mut ink = Bitmap::new(1000, 1000).unwrap();
        ink.set(Pixel::new(999, 999), true);
        let mut drawing = Drawing::new(1000, 1000);
        drawing.push([PxPoint::new(0.5, 0.5), PxPoint::new(0.5, 30.5)]);
        let (at, error_px) = worst_pixel(&ink, &drawing).unwrap();
        assert_eq!(at, Pixel::new(999, 999));
        assert!((error_px - libm::hypot(999.0, 969.0)).abs() < 1e-9);
    }

    #[test]
    fn runs_have_the_errors_of_their_pixels() {
        // A slope, level lines and half a ring with ink along its diameter, 1 to 7 px wide, and ink that
        // nothing draws.
        let mut ink = Bitmap::new(200, 60).unwrap();
        for (x, y) in (0..60).flat_map(|y| (0..200).map(move |x| (x, y))) {
            let slope = 5 * y > x + 20 && 5 * y < x + 55;
            let level = (40..45).contains(&y) || y == 50;
            let ring = (libm::hypot(f64::from(x) - 150.0, f64::from(y) - 20.0) - 15.0).abs() < 2.0;
            let diameter = y == 20 && (135..165).contains(&x);
            ink.set(Pixel::new(x, y), slope || level || ring || diameter || (x * 7 + y * 13) % 97 == 0);
        }
        let at = PxPoint::new;
        let mut drawing = Drawing::new(200, 60);
        drawing.push([at(0.5, 7.4), at(198.0, 47.1)]);
        drawing.push([at(3.0, 42.5), at(90.0, 42.0), at(197.0, 43.1)]);
        drawing.push([at(0.5, 50.5), at(199.5, 50.5)]);
        let (vertices, bulges) = (vec![at(135.5, 20.5), at(165.5, 20.5)], vec![1.0]);
        drawing.push_curve(1, crate::stroke::Curve { vertices, bulges, ..crate::stroke::Curve::default() });
        let index = with_widths(&ink, &drawing, None);
        let mut tally = ErrorTally::default();
        ink.ink().for_each(|at| tally.add_pixel(at, index.error_px(at.into(), &mut 0)));
        assert_eq!(coverage(&ink, &drawing), tally.report());
        assert_eq!(worst_pixel(&ink, &drawing), tally.worst());
        let exact = tally.report().histogram.first().map(|bin| bin.pixels);
        assert!(tally.report().max_px > 1.0 && exact > Some(1000), "{:?}", tally.report());
    }

    #[test]
    fn no_ink_has_no_error_and_no_drawing_is_far() {
        let drawing = Drawing::new(4, 4);
        assert_eq!(coverage(&Bitmap::new(4, 4).unwrap(), &drawing), ErrorReport::default());
        let dot = Bitmap::from_picture("....\n...#\n").unwrap();
        assert!(coverage(&dot, &drawing).max_px > 3.0);
    }
}
