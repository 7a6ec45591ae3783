//! [`ReadOptions`]: what a text does not say about its plotter.

/// The plotter that a text is meant for, as far as the text leaves it open, and how finely curves are drawn.
///
/// The default is a Hewlett-Packard 7475A with a sheet of A4, which is what `SC` without `IP` is mostly meant
/// for:
///
/// ```text
///            P2 (10603, 7721)      the sheet: 0 to 11040, 0 to 7721;
///   ┌───────────┐                  P1 and P2 are where the corners of a
///   │           │                  drawing scaled with SC lie
///   └───────────┘
/// P1 (603, 521)
/// ```
///
/// Source: *HP 7475A Interfacing and Programming Manual*, chapter 2, on scaling points.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, hpgl};
/// let text = b"SC0,100,0,72;PU100,0;"; // a hundredth of the way from P1 to P2 is 100 units, or 2.5 mm
/// let options = hpgl::ReadOptions { p1_units: (0, 0), p2_units: (10_000, 7_200), ..Default::default() };
/// let ops: Vec<_> = hpgl::PlotOps::with_options(text.iter().copied(), options).flatten().collect();
/// assert_eq!(ops, [PlotOp::Travel { to: Point::new(250.0, 0.0) }]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct ReadOptions {
    /// How far lines may be from the curves `BZ` and `BR`, and from circles stretched to ellipses, mm,
    /// above 0. A curve has at most 4096 lines all the same.
    pub tolerance_mm: f64,
    /// The scaling point P1 while `IP` has not moved it, plotter units.
    pub p1_units: (i32, i32),
    /// The scaling point P2, likewise.
    pub p2_units: (i32, i32),
    /// The far corner of the sheet, which `IR` counts from, while `PS` has not said it, plotter units.
    pub sheet_units: (i32, i32),
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            tolerance_mm: 0.01,
            p1_units: (603, 521),
            p2_units: (10_603, 7_721),
            sheet_units: (11_040, 7_721),
        }
    }
}
