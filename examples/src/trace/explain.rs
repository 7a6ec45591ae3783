//! [`explain`]: the picture of each step from the levels to the ink.

use super::command::TraceCommand;
use super::traced::Input;
use crate::shared::{at, write_output};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use plotter_vector::{Bitmap, Gray, Pixel, Vectorizer};
use std::path::Path;

/// Writes the ink, and the steps that led to it, where they are asked for.
pub(super) fn explain(
    arguments: &TraceCommand,
    vectorizer: &Vectorizer,
    input: &Input,
) -> Result<(), String> {
    if arguments.ink.is_none() && arguments.explain.is_none() {
        return Ok(());
    }
    let gray = input.gray(arguments.page)?;
    let ink = vectorizer.ink(&gray);
    if let Some(path) = &arguments.ink {
        write_output(path, ink_png(&ink)?)?;
    }
    if let Some(folder) = &arguments.explain {
        std::fs::create_dir_all(folder).map_err(|error| at(folder, &format!("cannot be made: {error}")))?;
        let write = |name: &str, png: Vec<u8>| write_output(&folder.join(name), png);
        write("1-levels.png", png(&gray)?)?;
        if let Some((evened, _)) = vectorizer.threshold.look(&gray) {
            write("2-evened.png", png(&evened)?)?;
        }
        write("3-ink.png", ink_png(&ink)?)?;
    }
    Ok(())
}

fn ink_png(ink: &Bitmap) -> Result<Vec<u8>, String> {
    let pixels = (0..ink.height()).flat_map(|y| (0..ink.width()).map(move |x| Pixel::new(x, y)));
    let levels = pixels.map(|at| if ink.get(at) { 0 } else { u8::MAX }).collect();
    png(&Gray::new(ink.width(), ink.height(), levels).map_err(|error| error.to_string())?)
}

fn png(picture: &Gray) -> Result<Vec<u8>, String> {
    let mut out = Vec::new();
    PngEncoder::new(&mut out)
        .write_image(picture.pixels(), picture.width(), picture.height(), ExtendedColorType::L8)
        .map_err(|error| format!("a picture cannot be written: {error}"))?;
    Ok(out)
}

/// Whether the folder may be asked for: a file of that name stands in the way.
pub(super) fn check(folder: Option<&Path>) -> Result<(), String> {
    match folder {
        Some(folder) if folder.is_file() => {
            Err(at(folder, &"this is a file: name a folder for the pictures of the steps"))
        }
        _ => Ok(()),
    }
}
