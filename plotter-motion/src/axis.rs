//! The two axes of a plotter and the two ways to turn a motor.

/// One of the two motors, and the direction it moves the pen in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Axis {
    /// To the right.
    X,
    /// Up.
    Y,
}

/// Direction of a motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Direction {
    /// Towards larger coordinates.
    Plus,
    /// Towards smaller coordinates.
    Minus,
}

impl Axis {
    /// Both axes, x first.
    pub const BOTH: [Self; 2] = [Self::X, Self::Y];
}

impl Direction {
    /// 1 or -1.
    #[must_use]
    pub const fn sign(self) -> i32 {
        match self {
            Self::Plus => 1,
            Self::Minus => -1,
        }
    }
}
