//! A large picture of few bytes takes a few rows of memory, not its size.
#![cfg(all(feature = "image", target_os = "linux"))]

use crate::own_process::{is_alone, peak_kib};
use plotter_vector::{DecodeError, FileRows, picture::RowSource};
use std::io::Cursor;

/// Most memory that the reading may add, KiB: the rows and the decoder's window.
const MOST_KIB: u64 = 8 << 10;

/// Side of the picture, px: 50 MB at 1 bit a pixel, 400 MB as levels.
const SIDE_PX: u32 = 20_000;

/// A black picture: 1 bit a pixel, so that every byte of it is alike.
fn black_png() -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIDE_PX, SIDE_PX);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    let row = vec![0; SIDE_PX.div_ceil(8) as usize];
    for _ in 0..SIDE_PX {
        std::io::Write::write_all(&mut stream, &row)?;
    }
    stream.finish()?;
    writer.finish()?;
    Ok(bytes)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_bomb_streams_through_a_few_rows() -> Result<(), Box<dyn std::error::Error>> {
    if !is_alone("file_rows_memory::a_bomb_streams_through_a_few_rows") {
        return Ok(());
    }
    let bytes = black_png()?;
    assert!(bytes.len() < 1 << 20, "{} bytes", bytes.len());
    let before = peak_kib();
    let mut scan = FileRows::new(Cursor::new(&bytes))?;
    let mut count = 0;
    while scan.next_row()?.is_some() {
        count += 1;
    }
    assert_eq!(count, SIDE_PX);
    // Held whole it is refused, and that takes nothing either.
    assert!(matches!(plotter_vector::decode(&bytes), Err(DecodeError::TooLarge(_))));
    let taken = peak_kib() - before;
    assert!(taken < MOST_KIB, "{taken} KiB");
    Ok(())
}
