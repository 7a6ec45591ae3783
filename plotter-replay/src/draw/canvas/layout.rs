//! Layout of a picture: drawing, frame, scale bar and legend, in mm with y down.

use super::{Canvas, CanvasStyle, Layer};
use plotter_motion::Point;

/// Places in the picture, mm from its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    low: Point,
    high: Point,
    margin_mm: f64,
    /// Size of the whole picture.
    pub(super) width_mm: f64,
    pub(super) height_mm: f64,
    /// Height of a letter.
    pub(super) letter_mm: f64,
    /// Thin lines of frame and scale bar.
    pub(super) hair_mm: f64,
    /// Length of the scale bar.
    pub(super) bar_mm: f64,
}

/// Least extent that is shown, mm, also for a drawing without any.
const LEAST_MM: f64 = 0.1;
/// Coordinates are kept within this, mm, so that sums and 32 bit pixels stay exact enough.
const MOST_MM: f64 = 1e6;

impl Layout {
    pub(super) fn new(canvas: &Canvas, style: &CanvasStyle) -> Self {
        let blank = (Point::ORIGIN, Point::new(100.0, 70.0));
        let (low, high) = canvas.bounds(style).unwrap_or(blank);
        let within = |p: Point| Point::new(p.x.clamp(-MOST_MM, MOST_MM), p.y.clamp(-MOST_MM, MOST_MM));
        let (low, high) = (within(low), within(high));
        let margin_mm = if style.margin_mm.is_finite() { style.margin_mm.clamp(0.0, MOST_MM) } else { 0.0 };
        let width_mm = (high.x - low.x).max(LEAST_MM) + 2.0 * margin_mm;
        let drawing_mm = (high.y - low.y).max(LEAST_MM) + 2.0 * margin_mm;
        let letter_mm = (width_mm.max(drawing_mm) / 55.0).min(width_mm / 22.0);
        Self {
            low,
            high,
            margin_mm,
            width_mm,
            height_mm: drawing_mm + 2.5 * letter_mm,
            letter_mm,
            hair_mm: letter_mm / 12.0,
            bar_mm: round_length(width_mm / 5.0),
        }
    }

    /// Where a place on the sheet is in the picture.
    pub(super) fn place(&self, at: Point) -> Point {
        Point::new(at.x - self.low.x + self.margin_mm, self.high.y - at.y + self.margin_mm)
    }

    /// Upper left and lower right of the frame.
    pub(super) fn frame(&self) -> (Point, Point) {
        let inset = self.margin_mm * 0.35 + self.hair_mm;
        let bottom = self.height_mm - 2.5 * self.letter_mm - inset;
        (Point::new(inset, inset), Point::new(self.width_mm - inset, bottom))
    }

    /// Base line of scale bar and legend.
    pub(super) fn base_mm(&self) -> f64 {
        self.height_mm - self.letter_mm
    }

    /// Left end of the scale bar.
    pub(super) fn bar_start(&self) -> Point {
        Point::new(self.frame().0.x, self.base_mm())
    }

    /// Ends of a layer's sample line, and where its label begins, for each layer that is there.
    pub(super) fn legend(&self, canvas: &Canvas, style: &CanvasStyle) -> Vec<(Layer, Point, Point)> {
        let mut x = self.width_mm - self.frame().0.x;
        let mut entries = Vec::new();
        for layer in Layer::shown(style).rev() {
            if canvas.lines(layer).next().is_none() {
                continue;
            }
            let letters: f64 = layer.label().chars().map(|_| 0.62 * self.letter_mm).sum();
            let text = x - letters;
            let start = text - 2.4 * self.letter_mm;
            // Too narrow a picture has no legend rather than one over the scale bar.
            if start < self.bar_start().x + self.bar_mm + 5.0 * self.letter_mm {
                break;
            }
            entries.push((layer, Point::new(start, self.base_mm()), Point::new(text, self.base_mm())));
            x = start - self.letter_mm;
        }
        entries
    }

    /// What the scale bar says.
    pub(super) fn bar_label(&self) -> String {
        format!("{} mm", crate::number::plain(self.bar_mm, 4))
    }
}

/// The greatest of 1, 2, 5 times a power of ten that is at most `length`.
fn round_length(length: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(length.max(1e-3))));
    [5.0, 2.0].into_iter().map(|n| n * power).find(|&round| round <= length).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_have_round_lengths() {
        assert_eq!([59.9, 42.0, 11.0, 1.0, 0.6].map(round_length), [50.0, 20.0, 10.0, 1.0, 0.5]);
    }

    #[test]
    fn the_picture_turns_y_over() {
        let mut canvas = Canvas::new();
        canvas.add(Layer::Ink, [Point::new(10.0, 10.0), Point::new(20.0, 40.0)]);
        let layout = Layout::new(&canvas, &CanvasStyle { margin_mm: 5.0, ..CanvasStyle::default() });
        assert_eq!(layout.place(Point::new(10.0, 40.0)), Point::new(5.0, 5.0));
        assert_eq!(layout.place(Point::new(20.0, 10.0)), Point::new(15.0, 35.0));
        assert_eq!(layout.width_mm, 20.0);
    }
}
