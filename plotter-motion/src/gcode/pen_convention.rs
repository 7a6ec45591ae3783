//! [`PenConvention`]: by which words a text lifts its pen.

/// By which words a text lifts and lowers its pen. The language has none of its own.
///
/// [`Detection`](super::Detection) finds it out from a text.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum PenConvention {
    /// `M3` or `M4` lowers, `M5` lifts, whatever stands after `S`: GRBL with a servo for its spindle. `G0`
    /// with the pen down draws.
    Spindle,
    /// `M3`, `M4` and `M5` in another sense: one of them lifts, one lowers, whatever stands after `S`; the
    /// third does neither. A servo that lets the pen fall when it is switched off has `up: 3, down: 5`.
    SpindleWords {
        /// The number after `M` that lifts: 3, 4 or 5.
        up: u8,
        /// The one that lowers.
        down: u8,
    },
    /// The Z axis: the pen is down at this height and below. A line that changes Z on its way marks if the
    /// pen is down at both of its ends.
    Height {
        /// The height, mm.
        threshold_mm: f64,
    },
    /// A servo that is told where to go. The pen is down if that is nearer to `down` than to `up`.
    Servo {
        /// By which word.
        command: ServoCommand,
        /// With the pen up, as the text has it; mostly degrees.
        up: f64,
        /// With the pen down.
        down: f64,
    },
    /// A laser marks while its power is above 0. That of a spindle is dark in `G0`, as in GRBL's laser mode
    /// (`$32=1`).
    Laser {
        /// By which word it is switched.
        command: LaserCommand,
        /// The number of full power.
        full: f64,
    },
    /// No word at all: `G0` travels, everything else draws.
    Motion,
}

impl PenConvention {
    /// The Unicorn plotter, with the angles it comes with.
    pub const UNICORN: Self = Self::Servo { command: ServoCommand::M300, up: 50.0, down: 30.0 };

    /// mDraw, with the angles it comes with.
    pub const MDRAW: Self = Self::Servo { command: ServoCommand::M1, up: 160.0, down: 90.0 };

    /// A laser on GRBL, with the power it comes with (`$30`).
    pub const GRBL_LASER: Self = Self::Laser { command: LaserCommand::Spindle, full: 1000.0 };
}

/// Where a servo's place stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum ServoCommand {
    /// `M300 S…`: the Unicorn plotter.
    M300,
    /// `M280 P… S…`: Marlin.
    M280,
    /// `M3 S…`, also `M4`: GRBL with a servo that `M5` does not lift.
    M3,
    /// `M1 …`, without a letter: mDraw.
    M1,
    /// `Z…`: Makeblock's XY plotter.
    Z,
}

/// How a laser is switched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum LaserCommand {
    /// `M3 S…` and `M4 S…`, `M5`, and `S` in any line: GRBL. By `M4` it is dark where the machine stands.
    Spindle,
    /// `M106 S…` and `M107`, as a printer's fan.
    Fan,
    /// `M4 …`, without a letter: mDraw.
    M4,
}
