//! [`Drawing`]: what is drawn on the test bed.

use super::TestBed;
use crate::{
    Pen, PenMove, PlotOp, Point,
    toolpath::{OutOfReach, targets},
};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

/// Moves with a name, from the origin on.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Name in tables.
    pub name: String,
    /// The moves, in encoder counts.
    pub moves: Vec<PenMove>,
}

impl Drawing {
    /// A straight line from the origin, by its direction in degrees, counted from x to y.
    ///
    /// ```
    /// # use plotter_motion::testbed::{Drawing, TestBed, TestBedSettings};
    /// # use plotter_motion::{Machine, MachineConfig, StepPoint};
    /// let bed = TestBed::new(&Machine::new(MachineConfig::default())?, TestBedSettings::default())?;
    /// let up = Drawing::line(&bed, 90.0, 60.0);
    /// assert_eq!(up.moves[0].target, StepPoint::new(0, 2400)); // 60 mm at 40 counts/mm
    /// assert_eq!(up.name, "90 deg");
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn line(bed: &TestBed, heading_deg: f64, length_mm: f64) -> Self {
        let (sin, cos) = libm::sincos(heading_deg.to_radians());
        let target = bed.counts(Point::new(length_mm * cos, length_mm * sin));
        let moves = [PenMove { pen: Pen::Down, target }].into();
        Self { name: format!("{heading_deg} deg"), moves }
    }

    /// Eight lines of 60 mm in all quadrants, flat, steep, along both axes: the measure of
    /// docs/results/control-test-bed.md.
    #[must_use]
    pub fn star(bed: &TestBed) -> Vec<Self> {
        const HEADINGS_DEG: [f64; 8] = [0.0, 30.0, 75.0, 90.0, 135.0, 195.0, 250.0, 315.0];
        /// Length of each line, mm: the documented gantry passes most of it at its feed.
        const LENGTH_MM: f64 = 60.0;
        HEADINGS_DEG.iter().map(|&heading| Self::line(bed, heading, LENGTH_MM)).collect()
    }

    /// Plot operations, as the machine of the test bed makes them: from target to target.
    ///
    /// # Errors
    ///
    /// [`OutOfReach`] for the first place outside the machine's area.
    pub fn from_ops(
        name: &str,
        bed: &TestBed,
        ops: impl IntoIterator<Item = PlotOp>,
    ) -> Result<Self, OutOfReach> {
        let moves = targets(bed.machine(), ops).collect::<Result<_, _>>()?;
        Ok(Self { name: name.into(), moves })
    }
}
