//! [`StoredSettings`] as bytes, for the EEPROM or the flash of a machine.
//!
//! ```text
//!  version   width mm   height mm   x, y direction   speed %   pen up deg   pen down deg   CRC-16
//!  1         2          2           1  1             1         1            1              2          12 bytes
//! ```
//!
//! Numbers of two bytes have their low byte first. The check is CRC-16/X-25 (`crc` 3, catalogue name
//! `CRC-16/IBM-SDLC`) over all that is before it: any fault within two bytes that lie side by side is found.
//! A memory that nobody has written, or that has been erased, has no version that this could be.
//!
//! A firmware writes them when [`StepperPlotter::stored`] has changed, into another place than those before
//! where a write may be cut off by the loss of power: what is damaged is refused, and the older ones still
//! hold.
//!
//! [`StepperPlotter::stored`]: crate::firmware::StepperPlotter::stored

use super::StoredSettings;
use crate::homing::Homed;
use core::fmt;
use crc::{CRC_16_IBM_SDLC, Crc, Table};

/// Of the layout above.
const VERSION: u8 = 1;
/// Of what homing has measured.
const HOMED_VERSION: u8 = 1;
/// Bytes before the check.
const CHECKED: usize = StoredSettings::BYTES - 2;
/// Greatest speed, % (see [`StoredSettings::speed_percent`]).
const MOST_PERCENT: u8 = 99;
/// Greatest angle of a servo, degrees.
const MOST_DEG: u8 = 180;

/// Without a table, which would take 512 bytes of flash to save microseconds at the start.
static CRC: Crc<u16, Table<0>> = Crc::<u16, Table<0>>::new(&CRC_16_IBM_SDLC);

/// Why bytes are no settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StoredError {
    /// Nothing has been stored: all bytes are 0, or 255 as in erased memory.
    Blank,
    /// There are too few bytes.
    Short {
        /// How many there are.
        bytes: usize,
    },
    /// They are damaged, or something else.
    Damaged,
    /// They are whole, and of a program that is older or newer.
    Version {
        /// Its version of the layout.
        found: u8,
    },
    /// They are whole, and a value is one that no host can have set.
    OutOfRange {
        /// The field of [`StoredSettings`].
        field: &'static str,
        /// Its value.
        value: u8,
    },
}

impl fmt::Display for StoredError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Blank => f.write_str("stored settings: none have been stored yet"),
            Self::Short { bytes } => {
                write!(f, "stored settings: {bytes} bytes are fewer than {}", StoredSettings::BYTES)
            }
            Self::Damaged => f.write_str("stored settings: damaged, or something else"),
            Self::Version { found } => {
                let which = if *found < VERSION { "an older" } else { "a newer" };
                write!(f, "stored settings: of version {found}, by {which} program; this one reads {VERSION}")
            }
            Self::OutOfRange { field, value } => {
                write!(f, "stored settings: {field} cannot be {value}")
            }
        }
    }
}

impl core::error::Error for StoredError {}

impl Homed {
    /// How many bytes it takes: a version, two numbers of four with their low byte first, a check of two.
    pub const BYTES: usize = 11;

    /// As bytes, to be kept beside [`StoredSettings`].
    ///
    /// ```
    /// # use plotter_motion::homing::Homed;
    /// let homed = Homed { x_steps: 34_000, y_steps: 28_000 };
    /// let bytes = homed.to_bytes();
    /// assert_eq!(bytes[..9], [1, 0xD0, 0x84, 0, 0, 0x60, 0x6D, 0, 0]);
    /// assert_eq!(Homed::from_bytes(&bytes), Some(homed));
    /// assert_eq!(Homed::from_bytes(&[0xFF; 11]), None); // erased memory
    /// ```
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let [x0, x1, x2, x3] = self.x_steps.to_le_bytes();
        let [y0, y1, y2, y3] = self.y_steps.to_le_bytes();
        let [c0, c1] = CRC.checksum(&[HOMED_VERSION, x0, x1, x2, x3, y0, y1, y2, y3]).to_le_bytes();
        [HOMED_VERSION, x0, x1, x2, x3, y0, y1, y2, y3, c0, c1]
    }

    /// From such bytes; what follows them is not looked at. None where they are too few, of another version,
    /// damaged or have never been written: the machine then finds out again.
    #[must_use]
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let &[version, x0, x1, x2, x3, y0, y1, y2, y3, c0, c1] = bytes.first_chunk::<{ Self::BYTES }>()?;
        let check = CRC.checksum(&[version, x0, x1, x2, x3, y0, y1, y2, y3]);
        let is_whole = version == HOMED_VERSION && check == u16::from_le_bytes([c0, c1]);
        is_whole.then_some(Self {
            x_steps: u32::from_le_bytes([x0, x1, x2, x3]),
            y_steps: u32::from_le_bytes([y0, y1, y2, y3]),
        })
    }
}

impl StoredSettings {
    /// How many bytes they take.
    pub const BYTES: usize = 12;

    /// As bytes, for the EEPROM or the flash: see [`StoredError`] for what is refused.
    ///
    /// ```
    /// # use plotter_motion::firmware::stepper_plotter::StoredSettings;
    /// let bytes = StoredSettings::default().to_bytes();
    /// // version 1, 380 by 310 mm, neither motor inverted, 80 %, 160 and 90 degrees, the check
    /// assert_eq!(bytes, [1, 0x7C, 0x01, 0x36, 0x01, 0, 0, 80, 160, 90, 0x6E, 0x3B]);
    /// assert_eq!(StoredSettings::from_bytes(&bytes), Ok(StoredSettings::default()));
    /// ```
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let Self { width_mm, height_mm, x_direction, y_direction, speed_percent, pen_up_deg, pen_down_deg } =
            *self;
        let ([w0, w1], [h0, h1]) = (width_mm.to_le_bytes(), height_mm.to_le_bytes());
        let checked: [u8; CHECKED] =
            [VERSION, w0, w1, h0, h1, x_direction, y_direction, speed_percent, pen_up_deg, pen_down_deg];
        let [c0, c1] = CRC.checksum(&checked).to_le_bytes();
        let [a, b, c, d, e, f, g, h, i, j] = checked;
        [a, b, c, d, e, f, g, h, i, j, c0, c1]
    }

    /// From such bytes; what follows them is not looked at.
    ///
    /// # Errors
    ///
    /// [`StoredError`]; a firmware then begins with the settings that it was built with, and tells a person
    /// unless it is [`StoredError::Blank`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, StoredError> {
        let Some((bytes, _)) = bytes.split_first_chunk::<{ Self::BYTES }>() else {
            return Err(StoredError::Short { bytes: bytes.len() });
        };
        if bytes.iter().all(|&byte| byte == 0) || bytes.iter().all(|&byte| byte == u8::MAX) {
            return Err(StoredError::Blank);
        }
        let [
            version,
            w0,
            w1,
            h0,
            h1,
            x_direction,
            y_direction,
            speed_percent,
            pen_up_deg,
            pen_down_deg,
            c0,
            c1,
        ] = *bytes;
        let (checked, _) = bytes.split_at(CHECKED);
        if CRC.checksum(checked) != u16::from_le_bytes([c0, c1]) {
            return Err(StoredError::Damaged);
        }
        if version != VERSION {
            return Err(StoredError::Version { found: version });
        }
        for (field, value, most) in [
            ("x_direction", x_direction, 1),
            ("y_direction", y_direction, 1),
            ("speed_percent", speed_percent, MOST_PERCENT),
            ("pen_up_deg", pen_up_deg, MOST_DEG),
            ("pen_down_deg", pen_down_deg, MOST_DEG),
        ] {
            if value > most {
                return Err(StoredError::OutOfRange { field, value });
            }
        }
        let (width_mm, height_mm) = (u16::from_le_bytes([w0, w1]), u16::from_le_bytes([h0, h1]));
        Ok(Self { width_mm, height_mm, x_direction, y_direction, speed_percent, pen_up_deg, pen_down_deg })
    }
}
