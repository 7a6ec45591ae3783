//! Any bytes beside the pixels, in each format that has a place for them, become notes or an error; and notes
//! that are read without the pixels are those that are read with them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_fuzz::{in_jpeg, in_png, in_webp};
use plotter_vector::picture::{FileNotes, RowSource, decode_page_in_colour};
use plotter_vector::{FileRows, decode};
use std::io::Cursor;

/// The file that the bytes are put into, by the first of them; others are a file of their own.
fn file(kind: u8, bytes: &[u8]) -> Vec<u8> {
    match kind % 8 {
        0 => in_jpeg(Some((0xe1, b"Exif\0\0")), bytes),
        1 => in_jpeg(Some((0xe0, b"JFIF\0")), bytes),
        2 => in_jpeg(None, bytes),
        3 => in_png(*b"eXIf", bytes),
        4 => in_png(*b"pHYs", bytes),
        5 => in_webp(bytes),
        _ => bytes.to_vec(),
    }
}

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, bytes)) = bytes.split_first() else { return };
    let bytes = file(*kind, bytes);
    if !plotter_fuzz::is_small(&bytes) {
        return;
    }
    for page in 0..3 {
        let notes = FileNotes::read(Cursor::new(&bytes), page);
        if let Err(error) = &notes {
            assert!(!error.to_string().contains('\n'));
        }
        let rows = FileRows::of_page(Cursor::new(&bytes), page);
        if let Ok(rows) = &rows {
            let mut notes = notes.expect("what is read is noted");
            assert_eq!((notes.width_px, notes.height_px), (rows.width(), rows.height()));
            notes.ground = rows.notes().ground;
            // What is no number equals nothing.
            assert_eq!(format!("{notes:?}"), format!("{:?}", rows.notes()));
            if let Some(Ok(mm_per_px)) = notes.resolution.map(|resolution| resolution.mm_per_px()) {
                assert!((0.001..1.0).contains(&mm_per_px), "{mm_per_px} mm");
            }
            let colour = decode_page_in_colour(&bytes, page);
            let gray = FileRows::of_page(Cursor::new(&bytes), page).and_then(FileRows::into_gray);
            assert_eq!(gray.is_ok(), colour.is_ok());
            if let (Ok(gray), Ok((colour, said))) = (gray, colour) {
                assert_eq!((gray.width(), gray.height()), (colour.width(), colour.height()));
                assert_eq!(said.ground, notes.ground);
            }
        }
    }
    let _ = decode(&bytes);
});
