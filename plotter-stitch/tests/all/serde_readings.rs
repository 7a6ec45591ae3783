//! Readings can be kept and read again.
#![cfg(feature = "serde")]

use plotter_stitch::{FrameReadings, Reading};

#[test]
fn readings_written_as_json_are_read_back_the_same() {
    let reading = Reading { expected_mm: 50.0, found_mm: 50.1, scan_at_mm: -3.0 };
    let readings =
        FrameReadings { x_border1: reading, x_border2: reading, y_left: reading, y_right: reading };
    let text = serde_json::to_string(&readings).unwrap();
    assert!(
        text.starts_with(r#"{"x_border1":{"expected_mm":50.0,"found_mm":50.1,"scan_at_mm":-3.0}"#),
        "{text}"
    );
    assert_eq!(serde_json::from_str::<FrameReadings>(&text).unwrap(), readings);
}
