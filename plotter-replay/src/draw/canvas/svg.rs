//! A canvas as SVG, in mm.

use super::layout::Layout;
use super::{Canvas, CanvasStyle, Layer};
use crate::draw::thin::thin;
use crate::number::plain;
use core::fmt::Write as _;
use plotter_motion::Point;

impl Canvas {
    /// The picture as SVG: a `viewBox` in mm, fitted to the lines, with frame, scale bar and legend.
    #[must_use]
    pub fn to_svg(&self, style: &CanvasStyle) -> String {
        let layout = Layout::new(self, style);
        let mut svg = String::new();
        // Writing to a `String` cannot fail.
        let _ = self.write_svg(&mut svg, style, &layout);
        svg
    }

    fn write_svg(&self, svg: &mut String, style: &CanvasStyle, layout: &Layout) -> core::fmt::Result {
        let (width, height) = (mm(layout.width_mm), mm(layout.height_mm));
        writeln!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
             viewBox=\"0 0 {width} {height}\">"
        )?;
        writeln!(svg, "<title>plot: desired and drawn lines</title>")?;
        writeln!(svg, "<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>")?;
        write_furniture(svg, layout)?;
        for layer in Layer::shown(style) {
            self.write_layer(svg, layer, style, layout)?;
        }
        for (layer, start, text) in self.legend(layout, style) {
            let y = mm(start.y - 0.3 * layout.letter_mm);
            writeln!(
                svg,
                "<path d=\"M{} {y}H{}\" {}/>",
                mm(start.x),
                mm(text.x - 0.4 * layout.letter_mm),
                pen(
                    layer,
                    (layout.letter_mm / 8.0).min(line_width(layer, style)).max(layout.hair_mm),
                    layout,
                    style
                )
            )?;
            write_text(svg, layout, text, layer.label())?;
        }
        writeln!(svg, "</svg>")
    }

    fn legend(&self, layout: &Layout, style: &CanvasStyle) -> Vec<(Layer, Point, Point)> {
        layout.legend(self, style)
    }

    fn write_layer(
        &self,
        svg: &mut String,
        layer: Layer,
        style: &CanvasStyle,
        layout: &Layout,
    ) -> core::fmt::Result {
        let mut lines = self.lines(layer).peekable();
        if lines.peek().is_none() {
            return Ok(());
        }
        write!(svg, "<path {} d=\"", pen(layer, line_width(layer, style), layout, style))?;
        for line in lines {
            let mut letter = 'M';
            for at in thin(line.iter().map(|&at| layout.place(at)), style.tolerance_mm) {
                write!(svg, "{letter}{} {}", mm(at.x), mm(at.y))?;
                letter = if letter == 'M' { 'L' } else { ' ' };
            }
            // A line to where the pen stands: with round ends a dot.
            if letter == 'L' {
                write!(svg, "h0")?;
            }
        }
        writeln!(svg, "\"/>")
    }
}

/// Width of a layer's lines, mm; something that can be seen for any style.
pub(super) fn line_width(layer: Layer, style: &CanvasStyle) -> f64 {
    let width = match layer {
        Layer::Desired => style.desired_width_mm,
        Layer::Ink | Layer::Pen(_) | Layer::Differs => style.ink_width_mm,
        Layer::Travel | Layer::Resynced | Layer::Undrawn => style.ink_width_mm / 2.0,
    };
    if width.is_finite() { width.clamp(1e-3, 1e3) } else { 0.3 }
}

fn pen(layer: Layer, width_mm: f64, layout: &Layout, style: &CanvasStyle) -> String {
    let [r, g, b] = layer.colour(style);
    let dash = if layer.is_dashed() {
        format!(" stroke-dasharray=\"{} {}\"", mm(layout.letter_mm * 0.5), mm(layout.letter_mm * 0.4))
    } else {
        String::new()
    };
    format!(
        "fill=\"none\" stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-width=\"{}\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\"{dash}",
        mm(width_mm)
    )
}

fn write_furniture(svg: &mut String, layout: &Layout) -> core::fmt::Result {
    let (upper, lower) = layout.frame();
    writeln!(
        svg,
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#d0d0d0\" stroke-width=\"{}\"/>",
        mm(upper.x),
        mm(upper.y),
        mm((lower.x - upper.x).max(0.0)),
        mm((lower.y - upper.y).max(0.0)),
        mm(layout.hair_mm)
    )?;
    let start = layout.bar_start();
    let tick = 0.4 * layout.letter_mm;
    writeln!(
        svg,
        "<path d=\"M{x} {y0}V{y}H{end}V{y0}\" fill=\"none\" stroke=\"#555\" stroke-width=\"{}\"/>",
        mm(layout.hair_mm * 1.5),
        x = mm(start.x),
        y0 = mm(start.y - tick),
        y = mm(start.y),
        end = mm(start.x + layout.bar_mm),
    )?;
    let label = Point::new(start.x + layout.bar_mm + 0.5 * layout.letter_mm, start.y);
    write_text(svg, layout, label, &layout.bar_label())
}

fn write_text(svg: &mut String, layout: &Layout, at: Point, text: &str) -> core::fmt::Result {
    writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\" fill=\"#555\">{text}</text>",
        mm(at.x),
        mm(at.y),
        mm(layout.letter_mm)
    )
}

fn mm(value: f64) -> String {
    plain(value, 3)
}
