//! The files that are written.

use super::command::FollowCommand;
use super::sheet::Sheet;
use crate::follow::{FollowFrame, FollowGif, FollowOutcome, follow_page, follow_svg};
use crate::shared::{at, write_file};
use plotter_vector::{Gray, PxPoint};

pub(super) fn write_files(
    arguments: &FollowCommand,
    sheet: Option<Sheet>,
    strokes: &[Vec<PxPoint>],
    (frames, film): (&[FollowFrame], Option<FollowGif>),
    window_px: u32,
    outcome: &FollowOutcome<'_>,
) -> Result<(), String> {
    // Without the drawing: white paper, as large as the way and its windows.
    let picture = match sheet {
        Some(sheet) => sheet.picture,
        None => {
            let far = |part: fn(&FollowFrame) -> f64| frames.iter().map(part).fold(0.0, f64::max);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let side = |px: f64| (px + f64::from(window_px)).clamp(1.0, 8192.0) as u32;
            let (width, height) = (side(far(|frame| frame.at.x)), side(far(|frame| frame.at.y)));
            let levels = vec![u8::MAX; width as usize * height as usize];
            Gray::new(width, height, levels).map_err(|error| error.to_string())?
        }
    };
    if let Some(path) = &arguments.svg {
        write_file(path, follow_svg(&picture, strokes, frames, window_px)?)?;
    }
    if let Some(path) = &arguments.animation {
        match film {
            Some(film) => {
                let gif = film.encode(&picture, frames, window_px).map_err(|error| at(path, &error))?;
                write_file(path, gif)?;
            }
            None => write_file(path, follow_page(&picture, frames, window_px, &outcome.table())?)?,
        }
    }
    if let Some(path) = &arguments.report {
        write_file(path, outcome.json(strokes)?)?;
    }
    Ok(())
}
