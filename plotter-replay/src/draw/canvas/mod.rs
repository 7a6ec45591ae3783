//! [`Canvas`]: what was drawn, beside what was meant, as a picture.

mod layout;
#[cfg(feature = "image")]
mod lettering;
#[cfg(feature = "image")]
mod png;
mod sketch;
mod svg;

#[cfg(feature = "image")]
pub use png::PngError;
pub use sketch::Sketch;

use crate::VirtualPlotter;
use plotter_motion::{PlotOp, Point, toolpath::chords};

/// Farthest that an arc's chords may be from it, mm: a tenth of what an eye sees on paper.
const CHORD_ERROR_MM: f64 = 0.01;

/// Meanings of lines on a canvas. They are drawn in this order, the last on top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// The desired line: broad and pale under the ink, or thin over it.
    Desired,
    /// Moves with the pen up: dashed.
    Travel,
    /// The line that the motors drew: ink.
    Ink,
    /// The same with another pen than the first, by its number from 2 to 8.
    Pen(u8),
    /// The same, counted afresh from each reached target; only where that differs.
    Resynced,
    /// Ink that is not where it was meant to be.
    Differs,
    /// A desired line that was not drawn: dashed.
    Undrawn,
}

impl Layer {
    const ALL: [Self; 13] = [
        Self::Desired,
        Self::Travel,
        Self::Ink,
        Self::Pen(2),
        Self::Pen(3),
        Self::Pen(4),
        Self::Pen(5),
        Self::Pen(6),
        Self::Pen(7),
        Self::Pen(8),
        Self::Resynced,
        Self::Differs,
        Self::Undrawn,
    ];

    /// The ink of a pen; beyond the eighth they have the colours of the second to the eighth again.
    #[must_use]
    pub const fn of_pen(number: u8) -> Self {
        if number < 2 { Self::Ink } else { Self::Pen((number - 2) % 7 + 2) }
    }

    /// The layers in the order in which they are drawn.
    fn shown(style: &CanvasStyle) -> impl DoubleEndedIterator<Item = Self> + use<> {
        let mut order = Self::ALL;
        if style.desired == DesiredLine::Over {
            order.rotate_left(1);
            // What was not drawn stays on top.
            let last = order.len().saturating_sub(1);
            order.swap(last.saturating_sub(1), last);
        }
        let travel = style.travel == Visibility::Shown;
        order.into_iter().filter(move |&layer| travel || layer != Self::Travel)
    }

    fn label(self) -> &'static str {
        match self {
            Self::Desired => "desired",
            Self::Travel => "pen up",
            Self::Ink => "drawn",
            Self::Pen(number) => match number {
                2 => "pen 2",
                3 => "pen 3",
                4 => "pen 4",
                5 => "pen 5",
                6 => "pen 6",
                7 => "pen 7",
                _ => "pen 8",
            },
            Self::Resynced => "resynchronized",
            Self::Differs => "differs",
            Self::Undrawn => "not drawn",
        }
    }

    fn is_dashed(self) -> bool {
        matches!(self, Self::Travel | Self::Undrawn)
    }

    /// Red, green, blue.
    fn colour(self, style: &CanvasStyle) -> [u8; 3] {
        match self {
            Self::Desired if style.desired == DesiredLine::Over => [0x3d, 0x9b, 0xff],
            Self::Desired => [0x9c, 0xc4, 0xec],
            Self::Travel => [0x9a, 0xa8, 0x9a],
            Self::Ink => [0x1a, 0x1a, 0x2e],
            Self::Pen(number) => match number {
                2 => [0x1a, 0x7f, 0x37],
                3 => [0x82, 0x50, 0xdf],
                4 => [0x0f, 0x7b, 0x8a],
                5 => [0xb3, 0x18, 0x7a],
                6 => [0x7a, 0x5c, 0x1e],
                7 => [0x5a, 0x6b, 0x00],
                _ => [0x3c, 0x5a, 0x99],
            },
            Self::Resynced => [0xd9, 0x5f, 0x02],
            Self::Differs => [0xd1, 0x24, 0x2f],
            Self::Undrawn => [0xd9, 0x77, 0x06],
        }
    }
}

/// Whether something is in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Visibility {
    /// It is.
    Shown,
    /// It is not.
    #[default]
    Hidden,
}

/// Where the line that was meant lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DesiredLine {
    /// Under the ink, broader than it and pale: ink that strays leaves it bare.
    #[default]
    Under,
    /// Over the ink, thinner than it: what strays stands beside it.
    Over,
}

/// How a canvas looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CanvasStyle {
    /// Width of the drawn line, mm.
    pub ink_width_mm: f64,
    /// Width of the desired line, mm.
    pub desired_width_mm: f64,
    /// Where the desired line lies.
    pub desired: DesiredLine,
    /// Blank paper round the drawing, mm.
    pub margin_mm: f64,
    /// How far a line in the picture may be from the recorded one, mm; a tenth of the pen by default.
    pub tolerance_mm: f64,
    /// Whether moves with the pen up are shown.
    pub travel: Visibility,
    /// Longer side of a PNG, pixels; kept within 64 to 8192.
    pub longest_px: u32,
}

impl Default for CanvasStyle {
    /// A 0.35 mm pen on A4, 1600 pixels: see [`Canvas::fitted_style`] for other sizes.
    fn default() -> Self {
        Self {
            ink_width_mm: 0.35,
            desired_width_mm: 1.0,
            desired: DesiredLine::Under,
            margin_mm: 8.0,
            tolerance_mm: 0.035,
            travel: Visibility::Hidden,
            longest_px: 1_600,
        }
    }
}

/// A sheet with lines on it, in mm, y up.
///
/// ```
/// # use plotter_motion::Point;
/// # use plotter_replay::{Canvas, CanvasStyle, draw::Layer};
/// let mut canvas = Canvas::new();
/// canvas.add(Layer::Ink, [Point::new(0.0, 0.0), Point::new(40.0, 0.0), Point::new(40.0, 20.0)]);
/// let svg = canvas.to_svg(&CanvasStyle::default());
/// assert!(svg.contains("viewBox=\"0 0 56 ")); // 40 mm and twice the margin of 8 mm
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Canvas {
    lines: Vec<(Layer, Vec<Point>)>,
}

impl Canvas {
    /// A blank sheet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// What a virtual plotter has drawn, the targets it had, and, where they differ, the resynchronized
    /// track.
    #[must_use]
    pub fn from_plotter(plotter: &VirtualPlotter, tolerance_mm: f64) -> Self {
        let mut sketch = Sketch::new(*plotter.settings(), tolerance_mm);
        plotter.legs().iter().for_each(|leg| sketch.add(leg));
        sketch.finish()
    }

    /// Adds a line; a single point is a dot. Points that are not finite are left out.
    pub fn add(&mut self, layer: Layer, points: impl IntoIterator<Item = Point>) {
        let points: Vec<_> = points.into_iter().filter(|point| point.is_finite()).collect();
        if !points.is_empty() {
            self.lines.push((layer, points));
        }
    }

    /// Adds the drawn lines of a drawing; arcs as chords within 0.01 mm of them.
    pub fn add_drawing(&mut self, layer: Layer, ops: impl IntoIterator<Item = PlotOp>) {
        let mut at = Point::ORIGIN;
        let mut line = Vec::new();
        for op in chords(ops, CHORD_ERROR_MM) {
            match op {
                PlotOp::Draw { to, .. } => {
                    if line.is_empty() {
                        line.push(at);
                    }
                    line.push(to);
                    at = to;
                }
                op => {
                    self.add(layer, core::mem::take(&mut line));
                    at = op.target().unwrap_or(at);
                }
            }
        }
        self.add(layer, line);
    }

    /// Takes away all lines of a layer.
    pub fn remove(&mut self, layer: Layer) {
        self.lines.retain(|&(of, _)| of != layer);
    }

    /// The lines of a layer.
    pub fn lines(&self, layer: Layer) -> impl Iterator<Item = &[Point]> {
        self.lines.iter().filter(move |&&(of, _)| of == layer).map(|(_, line)| line.as_slice())
    }

    /// Lower left and upper right of all lines that `style` shows, mm; `None` for a blank sheet.
    #[must_use]
    pub fn bounds(&self, style: &CanvasStyle) -> Option<(Point, Point)> {
        let travel = style.travel == Visibility::Shown;
        let shown = self.lines.iter().filter(|&&(layer, _)| travel || layer != Layer::Travel);
        shown.flat_map(|(_, line)| line.iter().copied()).fold(None, |bounds, p| {
            let (low, high) = bounds.unwrap_or((p, p));
            Some((Point::new(low.x.min(p.x), low.y.min(p.y)), Point::new(high.x.max(p.x), high.y.max(p.y))))
        })
    }

    /// A style with line widths and margin that suit the size of what is drawn: for a drawing much smaller
    /// than a sheet the 0.35 mm pen of the default would blot.
    #[must_use]
    pub fn fitted_style(&self) -> CanvasStyle {
        let base = CanvasStyle::default();
        let shown = CanvasStyle { travel: Visibility::Shown, ..base };
        let longest_mm = self.bounds(&shown).map_or(0.0, |(low, high)| (high.x - low.x).max(high.y - low.y));
        // The default is made for the long side of A4; never thinner than a hair.
        let scale = (longest_mm / 297.0).clamp(0.01, 4.0);
        CanvasStyle {
            ink_width_mm: base.ink_width_mm * scale,
            desired_width_mm: base.desired_width_mm * scale,
            margin_mm: base.margin_mm * scale,
            ..base
        }
    }

    /// The fitted style, with the desired line thin over the thick one that was drawn.
    #[must_use]
    pub fn comparing_style(&self) -> CanvasStyle {
        let fitted = self.fitted_style();
        let (ink_width_mm, desired_width_mm) = (fitted.ink_width_mm * 2.0, fitted.ink_width_mm * 0.4);
        CanvasStyle { ink_width_mm, desired_width_mm, desired: DesiredLine::Over, ..fitted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drawing_becomes_its_strokes() {
        let p = Point::new;
        let draw = |to| PlotOp::Draw { to, feed_mm_s: None };
        let mut canvas = Canvas::new();
        canvas.add_drawing(
            Layer::Desired,
            [
                PlotOp::Travel { to: p(1.0, 1.0) },
                draw(p(2.0, 1.0)),
                draw(p(2.0, 2.0)),
                PlotOp::NewPage,
                draw(p(3.0, 3.0)),
            ],
        );
        let lines: Vec<_> = canvas.lines(Layer::Desired).collect();
        assert_eq!(lines, [&[p(1.0, 1.0), p(2.0, 1.0), p(2.0, 2.0)][..], &[p(2.0, 2.0), p(3.0, 3.0)]]);
    }

    #[test]
    fn a_blank_sheet_and_a_dot_have_pictures() {
        let style = CanvasStyle::default();
        let mut canvas = Canvas::new();
        assert_eq!(canvas.bounds(&style), None);
        assert!(canvas.to_svg(&style).ends_with("</svg>\n"));
        canvas.add(Layer::Ink, [Point::new(f64::NAN, 1.0)]);
        assert_eq!(canvas.bounds(&style), None);
        canvas.add(Layer::Ink, [Point::new(5.0, 5.0)]);
        assert!(canvas.to_svg(&style).ends_with("</svg>\n"));
        #[cfg(feature = "image")]
        assert!(canvas.to_png(&style).unwrap().starts_with(b"\x89PNG"));
    }
}
