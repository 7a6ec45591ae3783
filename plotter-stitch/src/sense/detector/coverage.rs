//! How much of the detector's disc a pen line covers.

use core::f64::consts::PI;

/// Share of a disc that lies over a straight line of ink, 0 to 1, exactly.
///
/// `disc_mm` is the disc's diameter; the ink goes from `from_mm` to `to_mm` across the line, both measured
/// from the disc's centre. What lies left of x in a disc of radius r is a circular segment, and the line is
/// what lies left of one edge less what lies left of the other:
///
/// ```text
/// F(x) = (r² acos(-x/r) + x √(r² - x²)) / π r²,   covered = F(to) - F(from)
/// ```
///
/// A disc without area, edges in the wrong order and numbers that are none cover nothing.
///
/// Source: area of a circular segment, any table of plane figures.
///
/// ```
/// # use plotter_stitch::sense::disc_over_line;
/// assert_eq!(disc_over_line(0.6, -1.0, 1.0), 1.0); // all of it
/// assert_eq!(disc_over_line(0.6, 0.0, 1.0), 0.5); // the right half
/// assert_eq!(disc_over_line(0.6, 0.4, 0.9), 0.0); // beside it
/// // A line of 0.5 mm in the middle leaves two segments 0.05 mm high: each has 0.0398 of the disc.
/// assert!((disc_over_line(0.6, -0.25, 0.25) - 0.9204).abs() < 1e-4);
/// ```
#[must_use]
pub fn disc_over_line(disc_mm: f64, from_mm: f64, to_mm: f64) -> f64 {
    let radius = disc_mm / 2.0;
    // A NaN fails every comparison.
    if !(radius > 0.0 && from_mm < to_mm) || from_mm >= radius || to_mm <= -radius {
        return 0.0;
    }
    let left_of = |x: f64| {
        let x = (x / radius).clamp(-1.0, 1.0);
        (libm::acos(-x) + x * libm::sqrt(1.0 - x * x)) / PI
    };
    (left_of(to_mm) - left_of(from_mm)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::disc_over_line;

    /// Sum of thin strips across the disc, mm².
    fn by_strips(disc_mm: f64, from_mm: f64, to_mm: f64) -> f64 {
        const STRIPS: u32 = 100_000;
        let radius = disc_mm / 2.0;
        let width = disc_mm / f64::from(STRIPS);
        let inside =
            |x: f64| if (from_mm..to_mm).contains(&x) { 2.0 * (radius * radius - x * x).sqrt() } else { 0.0 };
        let area: f64 = (0..STRIPS).map(|i| width * inside((f64::from(i) + 0.5) * width - radius)).sum();
        area / (core::f64::consts::PI * radius * radius)
    }

    #[test]
    fn the_formula_is_the_sum_of_its_strips() {
        /// A strip is 6e-6 mm wide, and two of them are cut by the line's edges: 4e-5 of the disc at the
        /// most.
        const STRIP: f64 = 4e-5;
        for (from, to) in [(-0.25, 0.25), (0.0, 0.5), (-0.1, 0.05), (0.2, 0.7), (-0.9, -0.29)] {
            assert!(
                (disc_over_line(0.6, from, to) - by_strips(0.6, from, to)).abs() < STRIP,
                "{from} to {to}"
            );
        }
    }

    #[test]
    fn what_is_no_line_covers_nothing() {
        for (disc, from, to) in [
            (0.0, -1.0, 1.0),
            (-0.6, -1.0, 1.0),
            (f64::NAN, -1.0, 1.0),
            (0.6, 0.2, 0.1),
            (0.6, f64::NAN, 0.1),
        ] {
            assert_eq!(disc_over_line(disc, from, to), 0.0, "{disc} {from} {to}");
        }
        assert_eq!(disc_over_line(0.6, f64::NEG_INFINITY, f64::INFINITY), 1.0);
    }
}
