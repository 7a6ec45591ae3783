//! [`Truth`]: what is known about a picture, and the file that says it.

use super::junctions;
use super::strokes::{Picture, Stroke};
use plotter_vector::{
    Rgb,
    picture::{Homography, RgbError},
};
use serde::{Deserialize, Serialize};

/// How places are counted in these files.
const CONVENTION: &str = "pixel-centre: pixel (col i,row j) has its centre at (i,j); y down";
/// With what every name of that way of counting begins.
const PIXEL_CENTRE: &str = "pixel-centre";

/// Farthest place and greatest width that a file may tell, px: both sides of the largest picture.
const MOST_PX: f64 = 4_294_967_295.0;

/// The strokes that a picture was drawn from, and where they cross or meet.
///
/// Places are as in its file, column and row: whole numbers are pixel **centres**, so that a
/// [`PxPoint`](plotter_vector::PxPoint) is half a pixel more in both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Name of the picture.
    pub name: String,
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// How places are counted, in words.
    convention: String,
    /// All widths that occur, px, the thinnest first.
    pub stroke_width: Vec<f64>,
    /// The strokes.
    pub polylines: Vec<TrueLine>,
    /// Column, row and number of arms of each place where strokes cross or meet.
    pub junctions: Vec<(f64, f64, u32)>,
    /// Where the drawing is seen in its picture, when that is not pixel on pixel; the places above are the
    /// drawing's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<View>,
}

/// A picture in which a drawing is seen from askew.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// Column and row in the picture from column and row in the drawing, both counted from pixel centres.
    pub homography: Homography,
}

/// A stroke of a known pen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrueLine {
    /// Width of the pen, px.
    pub width: f64,
    /// Colour of the pen, `#rrggbb`.
    pub color: String,
    /// Whether it ends where it begins.
    pub closed: bool,
    /// Vertices: column and row. A single one is a dot.
    pub points: Vec<(f64, f64)>,
}

impl Truth {
    /// What is known about a picture.
    #[must_use]
    pub fn of(picture: &Picture) -> Self {
        let mut widths: Vec<f64> = picture.strokes.iter().map(|stroke| stroke.width_px).collect();
        widths.sort_by(f64::total_cmp);
        widths.dedup();
        let line = |stroke: &Stroke| {
            let [red, green, blue] = stroke.colour;
            TrueLine {
                width: stroke.width_px,
                color: format!("#{red:02x}{green:02x}{blue:02x}"),
                closed: stroke.closed(),
                points: stroke.points.clone(),
            }
        };
        let round = |value: f64| libm::round(value * 1000.0) / 1000.0;
        Self {
            name: picture.name.to_owned(),
            width: picture.width,
            height: picture.height,
            convention: CONVENTION.to_owned(),
            stroke_width: widths,
            polylines: picture.strokes.iter().map(line).collect(),
            junctions: junctions::of(&picture.strokes)
                .into_iter()
                .map(|(x, y, arms)| (round(x), round(y), arms))
                .collect(),
            view: None,
        }
    }

    /// Reads the file.
    ///
    /// # Errors
    ///
    /// What is wrong with it, and where.
    pub fn from_json(bytes: &[u8]) -> Result<Self, String> {
        let truth: Self = serde_json::from_slice(bytes).map_err(|error| {
            format!("is no file of what was drawn: {error}; `draw_corpus` writes one beside each picture")
        })?;
        if !truth.convention.starts_with(PIXEL_CENTRE) {
            return Err(format!(
                "convention: places are counted as {:?}; only {PIXEL_CENTRE:?} is known",
                truth.convention
            ));
        }
        if truth.width == 0 || truth.height == 0 {
            return Err(format!("a picture of {} x {} px has no pixels", truth.width, truth.height));
        }
        let is_place = |(x, y): (f64, f64)| libm::fabs(x) <= MOST_PX && libm::fabs(y) <= MOST_PX;
        for (index, line) in truth.polylines.iter().enumerate() {
            if line.points.is_empty() {
                return Err(format!("polylines[{index}]: no points"));
            }
            if !(line.width > 0.0 && line.width <= MOST_PX) {
                return Err(format!("polylines[{index}].width: {} px is no width of a pen", line.width));
            }
            line.colour().map_err(|error| format!("polylines[{index}].color: {error}"))?;
            if let Some((x, y)) = line.points.iter().find(|at| !is_place(**at)) {
                return Err(format!("polylines[{index}].points: ({x}, {y}) is on no picture"));
            }
        }
        if truth.polylines.is_empty() {
            return Err("polylines: there is no stroke to compare with".into());
        }
        if let Some(view) = &truth.view {
            if view.width == 0 || view.height == 0 {
                return Err(format!("view: a picture of {} x {} px has no pixels", view.width, view.height));
            }
            if view.homography.inverse().is_none() {
                return Err("view.homography: has no inverse, so that nothing could be seen by it".into());
            }
        }
        match truth.junctions.iter().position(|(x, y, _)| !is_place((*x, *y))) {
            Some(index) => Err(format!("junctions[{index}]: is on no picture")),
            None => Ok(truth),
        }
    }

    /// Width of the widest pen, px.
    #[must_use]
    pub fn widest_px(&self) -> f64 {
        self.polylines.iter().map(|line| line.width).fold(0.0, f64::max)
    }
}

impl TrueLine {
    /// Colour of the pen.
    ///
    /// # Errors
    ///
    /// It is none.
    pub fn colour(&self) -> Result<Rgb, String> {
        self.color.parse().map_err(|error: RgbError| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_the_same_after_its_file() {
        for picture in crate::corpus::all() {
            let truth = Truth::of(&picture);
            let file = serde_json::to_vec(&truth).unwrap();
            assert_eq!(Truth::from_json(&file), Ok(truth));
        }
    }

    #[test]
    fn what_is_wrong_with_a_file_is_said() {
        let line = r##"{"width":1,"color":"#000000","closed":false,"points":[[1,2],[3,4]]}"##;
        let file = |convention: &str, lines: &str, junctions: &str| {
            let text = format!(
                r#"{{"name":"x","width":9,"height":9,"convention":"{convention}","stroke_width":[1],"polylines":[{lines}],"junctions":[{junctions}]}}"#
            );
            Truth::from_json(text.as_bytes()).map(|truth| truth.polylines.len())
        };
        assert_eq!(file("pixel-centre: so", line, "[1,2,4]"), Ok(1));
        let said = |found: Result<usize, String>| found.unwrap_err();
        assert!(said(file("corner", line, "")).starts_with("convention"));
        assert!(said(file("pixel-centre", "", "")).contains("no stroke"));
        assert!(
            said(file("pixel-centre", &line.replace("[1,2]", "[1,1e300]"), ""))
                .contains("polylines[0].points")
        );
        assert!(
            said(file("pixel-centre", &line.replace("\"width\":1", "\"width\":0"), "")).contains("width")
        );
        assert!(said(file("pixel-centre", line, "[1e300,2,4]")).contains("junctions[0]"));
        assert!(said(Truth::from_json(b"{}").map(|_| 0)).contains("draw_corpus"));
    }
}
