//! [`WriteOptions`]: what the machine behind the text understands.

use core::time::Duration;

/// What the machine behind the text understands.
///
/// The default suits GRBL with a pen servo as its spindle.
///
/// ```
/// # use plotter_motion::gcode;
/// let mdraw = gcode::WriteOptions {
///     pen: gcode::PenControl::Commands { up: "M1 160", down: "M1 90" },
///     settle: core::time::Duration::ZERO, // G4 is not carried out
///     ..Default::default()
/// };
/// let text = gcode::Writer::with_options(String::new(), mdraw).finish()?;
/// assert_eq!(text, "G21\nG90\nM1 160\nM2\n");
/// # Ok::<(), gcode::WriteError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct WriteOptions<'a> {
    /// How the pen is lifted and lowered.
    #[cfg_attr(feature = "serde", serde(borrow))]
    pub pen: PenControl<'a>,
    /// How another pen comes into the holder.
    pub pen_change: PenChange,
    /// Speed of lines that ask for none, mm/s. G-code has it in mm/min, and always needs one.
    pub feed_mm_s: f64,
    /// How long the machine stands still after the pen was lifted or lowered; none is written for 0.
    pub settle: Duration,
    /// Unit of the number of a `G4`.
    pub dwell_unit: DwellUnit,
    /// Decimals of coordinates, up to 6. GRBL refuses arcs whose ends lie 0.005 mm unequally far from the
    /// centre, so 3 are needed for arcs.
    pub decimals: u8,
    /// Greatest coordinate, mm, and with a minus the least; at most 10⁹.
    pub limit_mm: f64,
}

impl Default for WriteOptions<'_> {
    fn default() -> Self {
        Self {
            pen: PenControl::Spindle { down: 90 },
            pen_change: PenChange::Pause,
            feed_mm_s: 30.0,
            settle: Duration::from_millis(150),
            dwell_unit: DwellUnit::Seconds,
            decimals: 3,
            limit_mm: 100_000.0,
        }
    }
}

/// How a pen is lifted and lowered.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum PenControl<'a> {
    /// `M5` lifts, `M3 S…` lowers: a servo or a laser where GRBL has its spindle.
    Spindle {
        /// The number after `S` with the pen down.
        down: u32,
    },
    /// The Z axis: `G0 Z…` lifts, `G1 Z…` lowers.
    Height {
        /// With the pen up, mm.
        up_mm: f64,
        /// With the pen down, mm.
        down_mm: f64,
    },
    /// A laser where GRBL has its spindle: `M4 S…` burns, so that corners get no more than lines, and `M5`
    /// ends. A dot, at which `M4` would be dark, is burnt by `M3 S…` for the time to settle; a stroke has
    /// none.
    ///
    /// ```
    /// # use plotter_motion::{PlotOp, Point, gcode};
    /// let laser = gcode::WriteOptions { pen: gcode::PenControl::Laser { full: 1000 }, ..Default::default() };
    /// let mut writer = gcode::Writer::with_options(String::new(), laser);
    /// writer.push(PlotOp::LaserPower { share: 0.25 })?;
    /// writer.push(PlotOp::Travel { to: Point::new(1.0, 2.0) })?;
    /// writer.push(PlotOp::Draw { to: Point::new(3.0, 2.0), feed_mm_s: Some(10.0) })?;
    /// assert_eq!(writer.finish()?, "G21\nG90\nM5\nG0 X1 Y2\nM4 S250\nG1 X3 Y2 F600\nM5\nM2\n");
    /// # Ok::<(), gcode::WriteError>(())
    /// ```
    Laser {
        /// The number after `S` that is full power (`$30`), with which it burns where no
        /// [`PlotOp::LaserPower`](crate::PlotOp::LaserPower) says less.
        full: u32,
    },
    /// Lines that are written as they are.
    Commands {
        /// Lifts.
        up: &'a str,
        /// Lowers.
        down: &'a str,
    },
}

/// How another pen comes into the holder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum PenChange {
    /// `M0 (pen 2)`: the machine waits until somebody has changed it. The first is named only, `(pen 1)`.
    #[default]
    Pause,
    /// `T2 M6`: the machine changes it.
    Tool,
}

/// Unit of the number of a `G4`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum DwellUnit {
    /// Seconds, with decimals: GRBL.
    #[default]
    Seconds,
    /// Milliseconds: Marlin, and Makeblock's XY plotter.
    Milliseconds,
}
