//! [`Modes`]: what holds from one line to the next.

use crate::{Point, Vec2};

/// Coordinate systems: `G54` to `G59`.
pub(crate) const SYSTEMS: u8 = 6;

/// Modes that hold from one line to the next, as a controller reports them.
///
/// ```
/// # use plotter_motion::gcode::{Interpreter, Reader};
/// let (mut reader, mut interpreter) = (Reader::new(), Interpreter::new());
/// for byte in *b"G91 G1 X10 F600\n" {
///     if let Some(block) = reader.push(byte) {
///         interpreter.push(block)?;
///     }
/// }
/// let modes = interpreter.modes();
/// assert_eq!((modes.motion, modes.relative, modes.feed_mm_s), (1, true, Some(10.0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modes {
    /// Where the pen is, mm on the sheet.
    pub position: Point,
    /// Offset that is added to coordinates, mm: `G10` and `G92`.
    pub offset: Vec2,
    /// Part of the offset that `G10` has set for the coordinate system in force, mm.
    pub origin: Vec2,
    /// Coordinate system in force: 0 for `G54` to 5 for `G59`.
    pub system: u8,
    /// In which plane arcs lie: 17, 18 or 19, the number of its `G`.
    pub plane: u8,
    /// Tool length that `G43.1` adds to the height of the pen, mm; `G49` ends it.
    pub length_mm: f64,
    /// `G20`, not `G21`.
    pub inches: bool,
    /// `G91`, not `G90`.
    pub relative: bool,
    /// `G93`, not `G94`.
    pub inverse_time: bool,
    /// 0, 1, 2, 3 or 80, the number of its `G`.
    pub motion: u8,
    /// `F`, mm/s; none before the first.
    pub feed_mm_s: Option<f64>,
    /// 3, 4 or 5, the number of its `M`.
    pub spindle: u8,
    /// The number after `S`: power of a laser, or what a spindle is told that lifts and lowers the pen.
    pub power: f64,
    /// `T`, 0 before the first.
    pub tool: u8,
    /// Whether the pen has been lowered, by a spindle's words, a servo's or a height.
    pub pen_down: bool,
}

pub(crate) const MM_PER_INCH: f64 = 25.4;

impl Modes {
    /// Length of the unit of coordinates, mm.
    pub(crate) const fn unit_mm(&self) -> f64 {
        if self.inches { MM_PER_INCH } else { 1.0 }
    }
}
