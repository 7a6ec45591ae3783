//! Pictures of every kind and every damage, read whole and by rows.
#![cfg(feature = "image")]

mod damaged;
mod formats;
mod metadata;
mod mutated;
mod pictures;

use plotter_vector::{
    DecodeError, FileRows,
    picture::{Row, RowSource, gray_on_white},
};
use std::io::Cursor;

/// A picture as levels.
#[derive(Clone, Debug, PartialEq)]
struct Levels {
    width: u32,
    height: u32,
    levels: Vec<u8>,
}

/// What the rows of a source are, and the error that ended them.
fn rows(scan: &mut impl RowSource) -> (Levels, Option<DecodeError>) {
    let (width, height) = (scan.width(), scan.height());
    let mut levels = Vec::new();
    let end = loop {
        match scan.next_row() {
            Ok(Some(Row::Grey(row))) => {
                assert_eq!(row.len(), width as usize);
                levels.extend_from_slice(row);
            }
            Ok(Some(Row::Bits(words))) => {
                assert_eq!(words.len(), width.div_ceil(64) as usize);
                let bit = |x: usize| words[x / 64] >> (x % 64) & 1 == 1;
                levels.extend((0..width as usize).map(|x| if bit(x) { 0 } else { 255 }));
                assert!((width as usize..words.len() * 64).all(|x| !bit(x)), "ink right of the picture");
            }
            Ok(None) => break None,
            Err(error) => break Some(error),
        }
    };
    (Levels { width, height, levels }, end)
}

/// The picture read by rows.
fn by_rows(bytes: &[u8]) -> Result<Levels, DecodeError> {
    let (levels, error) = rows(&mut FileRows::new(Cursor::new(bytes))?);
    error.map_or(Ok(levels), Err)
}

/// The picture decoded by the crate `image` alone, as it is stored and on white paper.
fn by_image(bytes: &[u8]) -> image::ImageResult<Levels> {
    let picture = image::load_from_memory(bytes)?;
    let levels = match &picture {
        image::DynamicImage::ImageLuma8(gray) => gray.as_raw().clone(),
        // Its iterator panics where there are rows without columns.
        _ if picture.width() == 0 => Vec::new(),
        other => image::GenericImageView::pixels(other).map(|(_, _, pixel)| gray_on_white(pixel.0)).collect(),
    };
    Ok(Levels { width: picture.width(), height: picture.height(), levels })
}
