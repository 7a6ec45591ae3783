//! Stored settings as bytes: written and read again, damaged, of another version, or anything at all.

use crc::{CRC_16_IBM_SDLC, Crc};
use plotter_motion::firmware::stepper_plotter::StoredError;
use plotter_motion::firmware::stepper_plotter::StoredSettings;
use proptest::prelude::*;

fn settings() -> impl Strategy<Value = StoredSettings> {
    let sides = (any::<u16>(), any::<u16>());
    (sides, 0..=1_u8, 0..=1_u8, 0..=99_u8, 0..=180_u8, 0..=180_u8).prop_map(
        |((width_mm, height_mm), x_direction, y_direction, speed_percent, pen_up_deg, pen_down_deg)| {
            StoredSettings {
                width_mm,
                height_mm,
                x_direction,
                y_direction,
                speed_percent,
                pen_up_deg,
                pen_down_deg,
            }
        },
    )
}

/// Bytes whose check is right, as another program may have written them.
fn checked(mut bytes: [u8; 12]) -> [u8; 12] {
    let check = Crc::<u16>::new(&CRC_16_IBM_SDLC).checksum(&bytes[..10]);
    bytes[10..].copy_from_slice(&check.to_le_bytes());
    bytes
}

#[test]
fn a_memory_that_nobody_has_written_is_blank() {
    for byte in [0x00, 0xFF] {
        assert_eq!(StoredSettings::from_bytes(&[byte; 64]), Err(StoredError::Blank));
    }
    for bytes in 0..StoredSettings::BYTES {
        assert_eq!(StoredSettings::from_bytes(&[0xFF; 12][..bytes]), Err(StoredError::Short { bytes }));
    }
}

#[test]
fn an_older_and_a_newer_program_are_told_apart() {
    for (version, word) in [(0, "older"), (2, "newer"), (255, "newer")] {
        let mut bytes = StoredSettings::default().to_bytes();
        bytes[0] = version;
        let error = StoredSettings::from_bytes(&checked(bytes)).unwrap_err();
        assert_eq!(error, StoredError::Version { found: version });
        assert!(error.to_string().contains(word), "{error}");
    }
}

#[test]
fn a_value_that_no_host_can_have_set_is_refused_and_named() {
    for (place, value, field) in [
        (5, 2, "x_direction"),
        (6, 2, "y_direction"),
        (7, 100, "speed_percent"),
        (8, 181, "pen_up_deg"),
        (9, 181, "pen_down_deg"),
    ] {
        let mut bytes = StoredSettings::default().to_bytes();
        bytes[place] = value;
        assert_eq!(
            StoredSettings::from_bytes(&checked(bytes)),
            Err(StoredError::OutOfRange { field, value })
        );
        bytes[place] = value - 1;
        assert!(StoredSettings::from_bytes(&checked(bytes)).is_ok(), "{field}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_was_written_is_read(settings in settings(), after in prop::collection::vec(any::<u8>(), 0..20)) {
        let mut bytes = settings.to_bytes().to_vec();
        bytes.extend(after);
        prop_assert_eq!(StoredSettings::from_bytes(&bytes), Ok(settings));
    }

    /// Any fault within two bytes side by side.
    #[test]
    fn what_is_damaged_is_refused(settings in settings(), place in 0..12_usize, fault in 1..=u16::MAX) {
        let mut bytes = settings.to_bytes();
        let [first, second] = fault.to_le_bytes();
        bytes[place] ^= first;
        match bytes.get_mut(place + 1) {
            Some(byte) => *byte ^= second,
            None => prop_assume!(first != 0),
        }
        prop_assert_eq!(StoredSettings::from_bytes(&bytes), Err(StoredError::Damaged));
    }

    #[test]
    fn any_bytes_are_settings_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..40), is_checked in any::<bool>()) {
        let bytes = match <[u8; 12]>::try_from(bytes.as_slice().get(..12).unwrap_or_default()) {
            Ok(twelve) if is_checked => checked(twelve).to_vec(),
            _ => bytes,
        };
        match StoredSettings::from_bytes(&bytes) {
            Ok(settings) => prop_assert_eq!(&settings.to_bytes()[..], &bytes[..12]),
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}
