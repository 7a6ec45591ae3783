//! What lies under the camera, where that is known.

use super::command::FollowCommand;
use crate::shared::{at, read_file};
use plotter_vector::{Gray, PxPoint, Vectorizer, decode, follow::Paper, stroke::Bounded};

/// Farther than this the true lines are not from the middle of the picture's lines, px: less than what the
/// tool is off.
const TRUTH_PX: f64 = 0.1;

/// A drawing with a bit of everything: loops within loops, crossings, sharp tips, hatching.
fn built_in() -> Result<Paper, String> {
    let circle = |x: f64, y: f64, r: f64| -> Vec<PxPoint> {
        let at = |i: i32| f64::from(i) * std::f64::consts::TAU / 120.0;
        (0..=120).map(|i| PxPoint::new(x + r * libm::cos(at(i)), y + r * libm::sin(at(i)))).collect()
    };
    let line = |places: &[(f64, f64)]| places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect::<Vec<_>>();
    let mut strokes = vec![
        (circle(260.0, 260.0, 180.0), 5.0),
        (circle(260.0, 260.0, 110.0), 4.0),
        (circle(310.0, 260.0, 40.0), 3.0),
        (line(&[(40.0, 262.0), (480.0, 255.0)]), 4.0),
        (line(&[(520.0, 90.0), (560.0, 430.0), (610.0, 95.0), (650.0, 425.0), (690.0, 100.0)]), 5.0),
        (line(&[(560.0, 480.0), (820.0, 480.0), (820.0, 620.0), (560.0, 620.0), (560.0, 480.0)]), 5.0),
    ];
    for i in 0..9 {
        let x = 120.0 + 11.0 * f64::from(i);
        strokes.push((line(&[(x, 500.0), (x + 120.0, 640.0)]), 4.0));
    }
    Paper::drawn(880, 700, &strokes).map_err(|error| error.to_string())
}

/// What lies under the camera, where that is known.
pub(super) struct Sheet {
    pub(super) picture: Gray,
    /// The middles of its lines.
    pub(super) truth: Vec<Vec<PxPoint>>,
}

pub(super) fn sheet(arguments: &FollowCommand, name: &str) -> Result<Sheet, String> {
    let picture = match &arguments.image {
        Some(path) => decode(&read_file(path)?).map_err(|error| at(path, &error))?,
        None => built_in()?.picture().map_err(|error| error.to_string())?,
    };
    let vectorizer = Vectorizer { ours: Bounded { tolerance_px: TRUTH_PX }, ..Vectorizer::default() };
    let traced = vectorizer.vectorize(&picture).map_err(|error| format!("{name}: {error}"))?;
    let truth = traced.drawing.chords(0.05).strokes().map(<[PxPoint]>::to_vec).collect();
    Ok(Sheet { picture, truth })
}
