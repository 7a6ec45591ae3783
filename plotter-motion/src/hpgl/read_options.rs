//! [`ReadOptions`]: what an HPGL file leaves open about its plotter.

/// Settings that an HPGL file leaves open: its plotter's scaling points and sheet, and how finely curves are
/// drawn.
///
/// The default is a Hewlett-Packard 7475A with a sheet of A4, for which most files that use `SC` without `IP`
/// were written. Its scaling points P1 and P2 are the corners of a drawing scaled by `SC`. A plotter unit is
/// 0.025 mm; P2 lies on the upper edge of the sheet:
///
/// ```text
/// 7721 ┌───────────────────────────P2─┐    P1 (603, 521)
///      │   ┌───────────────────────┐  │    P2 (10603, 7721)
///      │   │ drawing scaled by SC  │  │
///      │   └───────────────────────┘  │
///      │   P1                         │
///    0 └──────────────────────────────┘
///      0                          11040
/// ```
///
/// Source: *HP 7475A Interfacing and Programming Manual*, chapter 2, on scaling points.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, hpgl};
/// // SC divides the 10,000 units from P1 to P2 by 100: one of its units is 100 plotter units, or 2.5 mm.
/// let text = b"SC0,100,0,72;PU100,0;"; // so 100 of them are 250 mm
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
    /// Greatest distance of lines from the curves `BZ` and `BR`, and from circles stretched to ellipses, mm.
    ///
    /// 0.01 by default, less than half a plotter unit. A curve never has more than 4096 lines; it has that
    /// many if this is not above 0.
    pub tolerance_mm: f64,
    /// Scaling point P1 until `IP` moves it, plotter units.
    pub p1_units: (i32, i32),
    /// Scaling point P2 until `IP` moves it, plotter units.
    pub p2_units: (i32, i32),
    /// Upper right corner of the sheet until `PS` sets it, plotter units; `IR` counts in percent of it.
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
