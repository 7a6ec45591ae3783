//! What the optical head reads at a frame change: where the four reference lines lie now.
//!
//! ```text
//!                    X_border1                          X_border2
//!        Y_left ──┊      │                                  │      ┊── Y_right
//!                 ┊      │   frame about to be drawn        │      ┊
//!   scan along Y  ┊      │                                  │      ┊  scan along Y
//!   at x = 0      ┊      │                                  │      ┊  at x = X_border2 + 50
//!   (0,0) ●┄┄┄┄┄┄┄┊┄┄┄┄┄┄│┄┄┄┄┄┄┄ scan along X at y = 0 ┄┄┄┄│┄┄┄┄┄▶
//! ```

/// One reference line and where it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reading {
    /// The line's own coordinate in the frame, across the line: x of a border, y of a Y marker, mm.
    pub expected_mm: f64,
    /// The machine's coordinate in that direction at which the head found it, mm.
    pub found_mm: f64,
    /// The machine's other coordinate, which stood still during the scan, mm.
    pub scan_at_mm: f64,
}

impl Reading {
    /// How much farther the line was found than expected, mm.
    #[must_use]
    pub fn shift_mm(self) -> f64 {
        self.found_mm - self.expected_mm
    }
}

/// The readings of the published procedure, in its order.
///
/// Source: Ivanov, Gueorguiev, Georgieva, Nenova, "Sketch drawing on infinite paper sheets", section IV.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrameReadings {
    /// The left border, scanned along x.
    pub x_border1: Reading,
    /// The right border, scanned along x.
    pub x_border2: Reading,
    /// The Y marker left of the field, scanned along y.
    pub y_left: Reading,
    /// The Y marker right of the field, scanned along y.
    pub y_right: Reading,
}

/// One of the four reference lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mark {
    /// The left border.
    XBorder1,
    /// The right border.
    XBorder2,
    /// The left Y marker.
    YLeft,
    /// The right Y marker.
    YRight,
}

impl Mark {
    /// All four, in the order of the procedure.
    pub const ALL: [Self; 4] = [Self::XBorder1, Self::XBorder2, Self::YLeft, Self::YRight];

    /// Whether it is a border, scanned along x; otherwise it is a Y marker, scanned along y.
    #[must_use]
    pub const fn is_border(self) -> bool {
        matches!(self, Self::XBorder1 | Self::XBorder2)
    }
}

impl core::fmt::Display for Mark {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::XBorder1 => "x border 1",
            Self::XBorder2 => "x border 2",
            Self::YLeft => "left y marker",
            Self::YRight => "right y marker",
        })
    }
}

impl FrameReadings {
    /// The reading of one line.
    #[must_use]
    pub const fn reading(&self, mark: Mark) -> Reading {
        match mark {
            Mark::XBorder1 => self.x_border1,
            Mark::XBorder2 => self.x_border2,
            Mark::YLeft => self.y_left,
            Mark::YRight => self.y_right,
        }
    }
}
