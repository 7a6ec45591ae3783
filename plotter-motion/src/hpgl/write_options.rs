//! [`WriteOptions`]: how HPGL text is laid out.

/// How the text is laid out, and what the plotter behind it takes.
///
/// The default suits any HP-GL/2 device and, on sheets below 819 mm, a pen plotter of the HP 7475A's age.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, hpgl};
/// let old = hpgl::WriteOptions { limit_units: 32_767, ..Default::default() }; // 819.175 mm
/// let mut writer = hpgl::Writer::with_options(String::new(), old);
/// assert!(writer.push(PlotOp::Travel { to: Point::new(900.0, 0.0) }).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct WriteOptions {
    /// Greatest number of points in one `PD`, at least 1 (a 0 counts as 1). Old plotters keep a whole
    /// command in a buffer of a few hundred bytes: 20 points are never more than 483 bytes.
    pub points_per_command: u16,
    /// Greatest coordinate, plotter units, and with a minus the least. 8 388 607 (2²³ − 1, or 209 m) is the
    /// range of an HP-GL/2 number; the plotters before it end at 32 767 (819 mm).
    pub limit_units: i32,
    /// The pen that is taken when the operations move before they select one.
    pub pen: u8,
    /// How a drawing begins.
    pub opening: Opening,
    /// How the points of a stroke are given.
    pub coordinates: Coordinates,
}

/// How a drawing begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Opening {
    /// `IN;`: a plotter starts afresh with it, defaults and all.
    #[default]
    Short,
    /// `IN;DF;PA;`: says it three times, for readers that know `IN` as a reset of the pen only.
    Full,
}

/// How the points of a stroke are given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Coordinates {
    /// Places on the sheet.
    #[default]
    Absolute,
    /// `PR;`, then each point from the one before, then `PA;`: shorter for long strokes of small steps.
    Relative,
    /// `PE`: strokes and the ways between them in a few letters each, for HP-GL/2 only. Nine real drawings
    /// take a quarter to two fifths of what they take in plain numbers. The numbers are in the base 32, of
    /// which every byte is a printable one, so that no conversion of a text harms them.
    ///
    /// ```
    /// # use plotter_motion::{PlotOp, Point, hpgl};
    /// let encoded = hpgl::WriteOptions { coordinates: hpgl::Coordinates::Encoded, ..Default::default() };
    /// let mut writer = hpgl::Writer::with_options(String::new(), encoded);
    /// writer.push(PlotOp::Travel { to: Point::new(5.0, 2.5) })?; // 200, 100
    /// writer.push(PlotOp::Draw { to: Point::new(5.25, 2.25), feed_mm_s: None })?; // 10 right, 10 down
    /// assert_eq!(writer.finish()?, "IN;\nSP1;\nPE7<=OkGest;\nPU;\nSP0;\n");
    /// # Ok::<(), hpgl::WriteError>(())
    /// ```
    Encoded,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self {
            points_per_command: 20,
            limit_units: 8_388_607,
            pen: 1,
            opening: Opening::Short,
            coordinates: Coordinates::Absolute,
        }
    }
}
