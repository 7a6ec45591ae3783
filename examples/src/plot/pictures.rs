//! The files that show something.

use crate::shared::{Figure, write_file};
use plotter_replay::{Canvas, Chart, VirtualPlotter};
use plotter_vector::{Drawing, ErrorReport, report::error_chart, svg};
use std::path::Path;

/// The files that show something.
pub(super) struct Pictures {
    pub(super) drawing: String,
    pub(super) errors: String,
    pub(super) plotted: String,
    plotted_png: Vec<u8>,
    response: String,
}

impl Pictures {
    pub(super) fn new(
        traced: &Drawing,
        error: &ErrorReport,
        promises: &[String],
        plotter: &VirtualPlotter,
    ) -> Result<Self, String> {
        const STROKE_PX: f64 = 1.0;
        let (mut drawing, mut errors) = (String::new(), String::new());
        svg(traced, STROKE_PX, &mut drawing).map_err(|error| error.to_string())?;
        let promises: Vec<&str> = promises.iter().map(String::as_str).collect();
        error_chart(error, "Vectorization error", &promises, &mut errors)
            .map_err(|error| error.to_string())?;
        let canvas = Canvas::from_plotter(plotter, 0.002);
        let style = canvas.fitted_style();
        Ok(Self {
            drawing,
            errors,
            plotted: canvas.to_svg(&style),
            plotted_png: canvas.to_png(&style).map_err(|error| error.to_string())?,
            response: Chart::response("Response", plotter).to_svg(),
        })
    }

    /// All of them with their captions, for the page.
    pub(super) fn figures(&self) -> [Figure<'_>; 5] {
        [
            Figure::Svg(&self.drawing, "The strokes, in pixels of the picture"),
            Figure::Svg(
                &self.plotted,
                "What the motors drew (dark) on what was meant (pale), from the recording",
            ),
            Figure::Svg(
                &self.response,
                "Both coordinates over time, desired beside actual, and the contour error",
            ),
            Figure::Svg(&self.errors, "Distance of the picture's pixels from the strokes"),
            Figure::Png(&self.plotted_png, "The plot once more, as PNG"),
        ]
    }

    pub(super) fn write(&self, out: &Path) -> Result<(), String> {
        write_file(&out.join("drawing.svg"), &self.drawing)?;
        write_file(&out.join("errors.svg"), &self.errors)?;
        write_file(&out.join("plotted.svg"), &self.plotted)?;
        write_file(&out.join("plotted.png"), &self.plotted_png)?;
        write_file(&out.join("response.svg"), &self.response)
    }
}
