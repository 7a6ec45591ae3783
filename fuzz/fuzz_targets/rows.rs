//! Any bytes read by rows, twice, give the same; and what another decoder reads too, it reads the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_vector::{DecodeError, FileRows, decode, decode_colour, picture::{Ground, Row, RowSource, gray_on_white}};
use std::io::Cursor;

/// The levels of all rows, and the error that ended them.
fn levels(scan: &mut impl RowSource) -> (Vec<u8>, Option<DecodeError>) {
    let width = scan.width() as usize;
    let mut levels = Vec::new();
    loop {
        match scan.next_row() {
            Ok(Some(Row::Grey(row))) => levels.extend_from_slice(row),
            Ok(Some(Row::Bits(words))) => {
                let bit = |x: usize| words[x / 64] >> (x % 64) & 1 == 1;
                levels.extend((0..width).map(|x| if bit(x) { 0 } else { 255 }));
                assert!(!(width..words.len() * 64).any(bit), "ink right of the picture");
            }
            Ok(None) => return (levels, None),
            Err(error) => return (levels, Some(error)),
        }
    }
}

fuzz_target!(|bytes: &[u8]| {
    if !plotter_fuzz::is_small(bytes) {
        return;
    }
    let Ok(mut scan) = FileRows::new(Cursor::new(bytes)) else { return };
    let size = (scan.width(), scan.height());
    let (levels, error) = {
        let once = levels(&mut scan);
        scan.rewind().expect("it has been opened before");
        assert_eq!(once, levels(&mut scan));
        once
    };
    let whole = decode(bytes);
    assert_eq!(whole.is_ok(), error.is_none());
    assert_eq!(decode_colour(bytes).is_ok(), error.is_none());
    if let Ok(gray) = whole {
        assert_eq!(gray.pixels(), levels);
    }
    // The other one leaves a picture as it is stored, and lays it on white.
    let notes = scan.notes();
    if error.is_none()
        && notes.orientation.is_upright()
        && notes.ground != Some(Ground::Black)
        && !bytes.starts_with(b"II")
        && !bytes.starts_with(b"MM")
        && let Ok(picture) = image::load_from_memory(bytes)
    {
        assert_eq!((picture.width(), picture.height()), size);
        let other: Vec<u8> = match &picture {
            image::DynamicImage::ImageLuma8(gray) => gray.as_raw().clone(),
            // Its iterator panics where there are rows without columns.
            _ if size.0 == 0 => Vec::new(),
            other => {
                image::GenericImageView::pixels(other).map(|(_, _, pixel)| gray_on_white(pixel.0)).collect()
            }
        };
        assert!(levels == other, "another decoder reads it otherwise");
    }
});
