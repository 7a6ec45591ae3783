//! What is known about a picture, as a file.

use crate::junctions;
use crate::strokes::Picture;
use serde::Serialize;

#[derive(Debug, Serialize)]
pub(crate) struct Truth<'a> {
    name: &'a str,
    width: u32,
    height: u32,
    convention: &'static str,
    /// All widths that occur, the thinnest first.
    stroke_width: Vec<f64>,
    polylines: Vec<Line<'a>>,
    /// Column, row and number of arms.
    junctions: Vec<(f64, f64, u32)>,
}

#[derive(Debug, Serialize)]
struct Line<'a> {
    width: f64,
    color: String,
    closed: bool,
    points: &'a [(f64, f64)],
}

impl<'a> Truth<'a> {
    pub(crate) fn of(picture: &'a Picture) -> Self {
        let mut widths: Vec<f64> = picture.strokes.iter().map(|stroke| stroke.width_px).collect();
        widths.sort_by(f64::total_cmp);
        widths.dedup();
        let line = |stroke: &'a crate::strokes::Stroke| {
            let [red, green, blue] = stroke.colour;
            Line {
                width: stroke.width_px,
                color: format!("#{red:02x}{green:02x}{blue:02x}"),
                closed: stroke.closed(),
                points: &stroke.points,
            }
        };
        let round = |value: f64| libm::round(value * 1000.0) / 1000.0;
        Self {
            name: picture.name,
            width: picture.width,
            height: picture.height,
            convention: "pixel-centre: pixel (col i,row j) has its centre at (i,j); y down",
            stroke_width: widths,
            polylines: picture.strokes.iter().map(line).collect(),
            junctions: junctions::of(&picture.strokes)
                .into_iter()
                .map(|(x, y, arms)| (round(x), round(y), arms))
                .collect(),
        }
    }
}
