//! A canvas as PNG.

use super::layout::Layout;
use super::lettering;
use super::svg::line_width;
use super::{Canvas, CanvasStyle, Layer};
use crate::draw::thin::thin;
use core::fmt;
use plotter_motion::Point;
use tiny_skia::{Color, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

/// Pixels of the longer side.
const SIDE_PX: core::ops::RangeInclusive<u32> = 64..=8_192;
/// Points farther apart than this share of a pixel are kept: a fifth of a pixel is not seen.
const THIN_PX: f64 = 0.2;

/// Why there is no PNG.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PngError {
    /// There is no memory for so many pixels.
    Memory {
        /// Wide.
        width_px: u32,
        /// High.
        height_px: u32,
    },
    /// The encoder failed.
    Encoder {
        /// Message of the encoder.
        message: String,
    },
}

impl Canvas {
    /// The picture as PNG, antialiased, its longer side `style.longest_px` pixels.
    ///
    /// # Errors
    ///
    /// [`PngError`] if memory or the encoder fails.
    pub fn to_png(&self, style: &CanvasStyle) -> Result<Vec<u8>, PngError> {
        let layout = Layout::new(self, style);
        let longest_px = style.longest_px.clamp(*SIDE_PX.start(), *SIDE_PX.end());
        let px_per_mm = f64::from(longest_px) / layout.width_mm.max(layout.height_mm);
        let (width_px, height_px) =
            (side_px(layout.width_mm * px_per_mm), side_px(layout.height_mm * px_per_mm));
        let mut sheet = Sheet {
            pixels: Pixmap::new(width_px, height_px).ok_or(PngError::Memory { width_px, height_px })?,
            px_per_mm,
            layout,
        };
        sheet.pixels.fill(Color::WHITE);
        sheet.furniture();
        for layer in Layer::shown(style) {
            let places = |line: &[Point]| line.iter().map(|&at| layout.place(at)).collect::<Vec<_>>();
            let lines = self.lines(layer).map(|line| thin(places(line), THIN_PX / px_per_mm));
            sheet.draw(lines, line_width(layer, style), layer.colour(style), layer.is_dashed());
        }
        for (layer, start, text) in layout.legend(self, style) {
            let y = start.y - 0.3 * layout.letter_mm;
            let sample = vec![Point::new(start.x, y), Point::new(text.x - 0.4 * layout.letter_mm, y)];
            let width_mm = (layout.letter_mm / 8.0).min(line_width(layer, style)).max(layout.hair_mm);
            sheet.draw([sample], width_mm, layer.colour(style), layer.is_dashed());
            sheet.write(layer.label(), text);
        }
        sheet.pixels.encode_png().map_err(|error| PngError::Encoder { message: error.to_string() })
    }
}

const FRAME: [u8; 3] = [0xd0; 3];
const WORDS: [u8; 3] = [0x55; 3];

struct Sheet {
    pixels: Pixmap,
    px_per_mm: f64,
    layout: Layout,
}

impl Sheet {
    fn furniture(&mut self) {
        let (upper, lower) = self.layout.frame();
        let corners = [upper, Point::new(lower.x, upper.y), lower, Point::new(upper.x, lower.y), upper];
        self.draw([corners.to_vec()], self.layout.hair_mm, FRAME, false);
        let start = self.layout.bar_start();
        let end = Point::new(start.x + self.layout.bar_mm, start.y);
        let up = |at: Point| Point::new(at.x, at.y - 0.4 * self.layout.letter_mm);
        self.draw([vec![up(start), start, end, up(end)]], self.layout.hair_mm * 1.5, WORDS, false);
        let label = Point::new(end.x + 0.5 * self.layout.letter_mm, end.y);
        self.write(&self.layout.bar_label(), label);
    }

    fn write(&mut self, text: &str, at: Point) {
        let lines = lettering::write(text, at, 0.9 * self.layout.letter_mm);
        self.draw(lines, self.layout.letter_mm / 11.0, WORDS, false);
    }

    /// Draws lines given in mm of the picture; a single point becomes a dot.
    fn draw(
        &mut self,
        lines: impl IntoIterator<Item = Vec<Point>>,
        width_mm: f64,
        colour: [u8; 3],
        dashed: bool,
    ) {
        // A line thinner than a pixel is drawn pale; one pixel is the least that can be seen.
        let width_px = (width_mm * self.px_per_mm).max(1.0);
        let mut path = PathBuilder::new();
        let mut dots = PathBuilder::new();
        for line in lines {
            let mut points =
                line.iter().map(|at| (narrow(at.x * self.px_per_mm), narrow(at.y * self.px_per_mm)));
            let Some((x, y)) = points.next() else { continue };
            if line.len() == 1 {
                dots.push_circle(x, y, narrow(width_px / 2.0));
                continue;
            }
            path.move_to(x, y);
            points.for_each(|(x, y)| path.line_to(x, y));
        }
        let [r, g, b] = colour;
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color_rgba8(r, g, b, 255);
        let dash = [0.5, 0.4].map(|share| narrow(share * self.layout.letter_mm * self.px_per_mm));
        let stroke = Stroke {
            width: narrow(width_px),
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            dash: if dashed { StrokeDash::new(dash.to_vec(), 0.0) } else { None },
            ..Stroke::default()
        };
        if let Some(path) = path.finish() {
            self.pixels.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
        if let Some(dots) = dots.finish() {
            let rule = tiny_skia::FillRule::Winding;
            self.pixels.fill_path(&dots, &paint, rule, Transform::identity(), None);
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "pixels of a picture of at most 8192: 32 bits are plenty"
)]
fn narrow(px: f64) -> f32 {
    px as f32
}

fn side_px(px: f64) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates, and the result is kept within a picture's size"
    )]
    let px = libm::ceil(px) as u32;
    px.clamp(1, *SIDE_PX.end())
}

impl fmt::Display for PngError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Memory { width_px, height_px } => {
                write!(
                    f,
                    "no memory for a picture of {width_px} x {height_px} pixels: make longest_px smaller"
                )
            }
            Self::Encoder { message } => write!(f, "the picture cannot be encoded as PNG: {message}"),
        }
    }
}

impl core::error::Error for PngError {}
