//! [`Makes`]: what motors make at one time.

#[cfg(feature = "third-motor")]
use crate::Axis;
use crate::StepPair;

/// What the motors make at one time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Makes {
    /// A step of either motor or of both.
    Pair(StepPair),
    /// A step of the third motor: 1 upwards.
    #[cfg(feature = "third-motor")]
    Z(i8),
    /// Steps of both motors of an axis, each for itself: of its first and of its second one.
    #[cfg(feature = "third-motor")]
    Apart(Axis, [i8; 2]),
}

impl Default for Makes {
    fn default() -> Self {
        Self::Pair(StepPair::default())
    }
}

impl Makes {
    /// The steps of both motors of the two axes.
    pub(super) const fn pair(self) -> StepPair {
        match self {
            Self::Pair(pair) => pair,
            #[cfg(feature = "third-motor")]
            Self::Z(_) | Self::Apart(..) => StepPair { x: 0, y: 0 },
        }
    }
}
