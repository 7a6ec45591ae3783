//! Measures the distortion of a camera's lens from the picture of a printed grid.
//!
//! Print the grid (`--print-grid`), lay it under the camera, take a picture, and give it. The correction goes
//! into a file; the figures say how far the lens moved the grid's crossings, and how far they are off after
//! the correction. Without a picture a simulated camera with a bad lens takes one.
//!
//! ```text
//! cargo run --release --example calibrate_camera -- --print-grid grid.svg
//! cargo run --release --example calibrate_camera -- picture.png --correction camera.json
//! ```

use clap::Parser;
use plotter_examples::shared::{at, print, read_file, run, write_file};
use plotter_vector::follow::{CameraSettings, Correction, Lens, Paper, SimulatedCamera};
use plotter_vector::{PxPoint, decode};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// Measures a camera's lens on the picture of a square grid.
#[derive(Debug, Parser)]
#[command(
    name = "calibrate_camera",
    after_help = "Examples:\n  \
                  calibrate_camera --print-grid grid.svg --pitch-mm 2\n  \
                  calibrate_camera picture.png --correction camera.json\n  \
                  calibrate_camera --barrel 0.05\n\n\
                  Exit status: 0 measured; 1 no grid in the picture; 2 wrong options."
)]
struct Arguments {
    /// Picture of the grid, as large as the follower's windows [default: one of a simulated camera]
    image: Option<PathBuf>,
    /// Distortion of the simulated camera's lens
    #[arg(long, value_name = "K", default_value = "0.04", allow_negative_numbers = true)]
    barrel: f64,
    /// From line to line of the grid, mm
    #[arg(long, value_name = "MM", default_value = "2")]
    pitch_mm: f64,
    /// Writes the grid to be printed, and ends
    #[arg(long, value_name = "F.svg")]
    print_grid: Option<PathBuf>,
    /// Writes the correction as JSON
    #[arg(long, value_name = "F.json")]
    correction: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run("calibrate_camera", || calibrate(&arguments))
}

fn calibrate(arguments: &Arguments) -> Result<(), String> {
    if !(0.1..=100.0).contains(&arguments.pitch_mm) {
        return Err(format!("--pitch-mm {}: give 0.1 to 100", arguments.pitch_mm));
    }
    if let Some(path) = &arguments.print_grid {
        return write_file(path, grid_svg(arguments.pitch_mm));
    }
    let (picture, name) = match &arguments.image {
        Some(path) => {
            (decode(&read_file(path)?).map_err(|error| at(path, &error))?, path.display().to_string())
        }
        None => {
            if !(-0.3..=0.3).contains(&arguments.barrel) {
                return Err(format!("--barrel {}: give -0.3 to 0.3", arguments.barrel));
            }
            let places = (0..21).map(|i| 20.0 * f64::from(i));
            let lines = |place: f64| {
                let line = |from: [f64; 2], to: [f64; 2]| {
                    (vec![PxPoint::new(from[0], from[1]), PxPoint::new(to[0], to[1])], 3.0)
                };
                [line([0.0, place], [400.0, place]), line([place, 0.0], [place, 400.0])]
            };
            let strokes: Vec<_> = places.flat_map(lines).collect();
            let paper = Paper::drawn(400, 400, &strokes).map_err(|error| error.to_string())?;
            let settings = CameraSettings::default().with_lens(Lens { barrel: arguments.barrel });
            (
                SimulatedCamera::new(&paper, settings).window(PxPoint::new(203.0, 196.0)),
                "a simulated camera".into(),
            )
        }
    };
    let correction = Correction::measured(&picture).map_err(|error| format!("{name}: {error}"))?;
    if let Some(path) = &arguments.correction {
        let text = serde_json::to_string_pretty(&correction).map_err(|error| error.to_string())?;
        write_file(path, text + "\n")?;
    }
    print(&format!(
        "{name}: the lens moves the grid by up to {:.2} px; {:.3} px rms are left after the correction\n  \
         pitch {:.2} px, so a pixel is {:.4} mm\n",
        correction.most_px(),
        correction.rms_px(),
        correction.pitch_px(),
        arguments.pitch_mm / correction.pitch_px()
    ))
}

/// A grid of 41 by 41 lines.
fn grid_svg(pitch_mm: f64) -> String {
    let side = 40.0 * pitch_mm;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{side}mm\" height=\"{side}mm\" viewBox=\"0 0 {side} {side}\" \
         stroke=\"black\" stroke-width=\"{}\">\n",
        0.15 * pitch_mm
    );
    for i in 0..41 {
        let at = pitch_mm * f64::from(i);
        let _ = writeln!(text, "<path d=\"M0 {at}H{side}M{at} 0V{side}\"/>");
    }
    text.push_str("</svg>\n");
    text
}
