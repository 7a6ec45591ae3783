//! [`MicrostepPins`]: the pins that say how many microsteps make a full step.

use embedded_hal::digital::{self, OutputPin, PinState};

crate::which_pin::which_pin! {
    /// A pin that says how many microsteps make a full step failed.
    MicrostepPinError: digital, Ms1 "MS1: {}", Ms2 "MS2: {}", Ms3 "MS3: {}"
}

/// What can fail at these pins.
pub(super) type MicrostepErrorOf<Ms1, Ms2, Ms3> = MicrostepPinError<
    <Ms1 as digital::ErrorType>::Error,
    <Ms2 as digital::ErrorType>::Error,
    <Ms3 as digital::ErrorType>::Error,
>;

/// Chips, each with its table of resolutions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Chip {
    /// Allegro A4988: MS1, MS2, MS3; 1 to 16 microsteps.
    A4988,
    /// Texas Instruments DRV8825: MODE0, MODE1, MODE2; 1 to 32 microsteps.
    Drv8825,
    /// Trinamic TMC2209: MS1, MS2 and no third pin; 8 to 64 microsteps.
    Tmc2209,
}

impl Chip {
    /// Levels of the first, second and third pin (true: high) for `microsteps` to a full step; `None` for a
    /// number that the chip does not have.
    ///
    /// Sources: A4988-DS, Table 1 "Microstepping Resolution Truth Table" (page 6); SLVSA73F, Table 1
    /// "Stepping Format"; TMC2209 Rev. 1.09, section 3.4 "Configuration Pins", table of MS1 and MS2.
    ///
    /// ```
    /// # use plotter_hal::a4988::Chip;
    /// assert_eq!(Chip::A4988.levels(16), Some([true, true, true]));
    /// assert_eq!(Chip::Drv8825.levels(16), Some([false, false, true]));
    /// assert_eq!(Chip::A4988.levels(32), None);
    /// ```
    #[must_use]
    pub const fn levels(self, microsteps: u16) -> Option<[bool; 3]> {
        const L: bool = false;
        const H: bool = true;
        Some(match (self, microsteps) {
            (Self::A4988 | Self::Drv8825, 1) => [L, L, L],
            (Self::A4988 | Self::Drv8825, 2) => [H, L, L],
            (Self::A4988 | Self::Drv8825, 4) => [L, H, L],
            (Self::A4988 | Self::Drv8825, 8) => [H, H, L],
            (Self::A4988, 16) => [H, H, H],
            (Self::Drv8825, 16) => [L, L, H],
            (Self::Drv8825, 32) => [H, H, H],
            (Self::Tmc2209, 8) => [L, L, L],
            (Self::Tmc2209, 16) => [H, H, L],
            (Self::Tmc2209, 32) => [H, L, L],
            (Self::Tmc2209, 64) => [L, H, L],
            _ => return None,
        })
    }
}

/// The pins MS1, MS2, MS3 of a chip (MODE0, MODE1, MODE2); for
/// [`A4988::set_microsteps`](super::A4988::set_microsteps), which keeps their times. Apart from the driver,
/// because most boards have them wired. [`NoPin`](crate::NoPin) stands for one that the chip does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MicrostepPins<Ms1, Ms2, Ms3> {
    chip: Chip,
    ms1: Ms1,
    ms2: Ms2,
    ms3: Ms3,
}

impl<Ms1, Ms2, Ms3> MicrostepPins<Ms1, Ms2, Ms3> {
    /// The pins of a chip. Leaves them as they are.
    pub const fn new(chip: Chip, ms1: Ms1, ms2: Ms2, ms3: Ms3) -> Self {
        Self { chip, ms1, ms2, ms3 }
    }

    /// Chip of these pins.
    pub const fn chip(&self) -> Chip {
        self.chip
    }

    /// Gives the pins back.
    pub fn release(self) -> (Ms1, Ms2, Ms3) {
        (self.ms1, self.ms2, self.ms3)
    }

    pub(super) fn set(&mut self, [ms1, ms2, ms3]: [bool; 3]) -> Result<(), MicrostepErrorOf<Ms1, Ms2, Ms3>>
    where
        Ms1: OutputPin,
        Ms2: OutputPin,
        Ms3: OutputPin,
    {
        self.ms1.set_state(PinState::from(ms1)).map_err(MicrostepPinError::Ms1)?;
        self.ms2.set_state(PinState::from(ms2)).map_err(MicrostepPinError::Ms2)?;
        self.ms3.set_state(PinState::from(ms3)).map_err(MicrostepPinError::Ms3)
    }
}
