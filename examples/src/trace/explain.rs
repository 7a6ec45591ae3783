//! [`explain`]: the picture of each step from the levels to the ink.

use super::command::TraceCommand;
use super::settings::Settings;
use super::traced::Input;
use crate::shared::{at, write_output};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use plotter_vector::{Bitmap, Gray, Pixel, picture::SheetQuad};
use std::path::Path;

/// Writes the ink, and the steps that led to it, where they are asked for; of a sheet that was straightened
/// also where it lies in the photograph.
pub(super) fn explain(
    arguments: &TraceCommand,
    settings: &Settings,
    input: &Input,
    photograph: Option<(&SheetQuad, &Gray)>,
) -> Result<(), String> {
    if arguments.ink.is_none() && arguments.explain.is_none() {
        return Ok(());
    }
    let vectorizer = &settings.vectorizer;
    let gray = input.gray(settings.page)?;
    let ink = vectorizer.ink(&gray);
    if let Some(path) = &arguments.ink {
        write_output(path, ink_png(&ink)?)?;
    }
    if let Some(folder) = &arguments.explain {
        std::fs::create_dir_all(folder).map_err(|error| at(folder, &format!("cannot be made: {error}")))?;
        let write = |name: &str, png: Vec<u8>| write_output(&folder.join(name), png);
        match photograph {
            Some((quad, photograph)) => {
                write("0-sides.png", png(&with_sides(quad, photograph)?)?)?;
                write("1-straightened.png", png(&gray)?)?;
            }
            None => write("1-levels.png", png(&gray)?)?,
        }
        if let Some((evened, _)) = vectorizer.threshold.look(&gray) {
            write("2-evened.png", png(&evened)?)?;
        }
        write("3-ink.png", ink_png(&ink)?)?;
    }
    Ok(())
}

/// The photograph with the sheet's sides drawn into it, black with a white core, so that they show on
/// anything.
fn with_sides(quad: &SheetQuad, photograph: &Gray) -> Result<Gray, String> {
    let (width, height) = (photograph.width(), photograph.height());
    let half = i64::from(width.max(height) / 1000);
    let mut levels = photograph.pixels().to_vec();
    for (reach, level) in [(half + 1, 0), (half / 2, u8::MAX)] {
        for (from, to) in quad.corners.iter().zip(quad.corners.iter().cycle().skip(1)) {
            let steps = from.distance(*to).ceil().max(1.0);
            let mut step = 0.0;
            while step <= steps {
                let at = *from + (*to - *from) * (step / steps);
                #[expect(clippy::cast_possible_truncation, reason = "corners lie near the picture")]
                let (column, row) = (at.x.floor() as i64, at.y.floor() as i64);
                for y in row - reach..=row + reach {
                    for x in column - reach..=column + reach {
                        let inside =
                            (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
                        let index = usize::try_from(y * i64::from(width) + x).ok().filter(|_| inside);
                        if let Some(slot) = index.and_then(|index| levels.get_mut(index)) {
                            *slot = level;
                        }
                    }
                }
                step += 1.0;
            }
        }
    }
    Gray::new(width, height, levels).map_err(|error| error.to_string())
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
