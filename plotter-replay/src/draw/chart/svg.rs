//! A chart as SVG.

use super::axis::Scale;
use super::{Chart, Curve, Panel, Role, Run, Sample};
use crate::number::plain;
use core::fmt::Write as _;

const WIDTH: f64 = 960.0;
const LEFT: f64 = 78.0;
const RIGHT: f64 = 18.0;
const TOP: f64 = 40.0;
const PANEL: f64 = 210.0;
/// Between panels: the legend of the lower one stands there.
const GAP: f64 = 34.0;
const BOTTOM: f64 = 50.0;

impl Role {
    fn pen(self) -> &'static str {
        match self {
            Self::Setpoint => "stroke=\"#b8b8b8\" stroke-width=\"1.2\"",
            Self::Desired => "stroke=\"#9cc4ec\" stroke-width=\"4\"",
            Self::Actual => "stroke=\"#1a1a2e\" stroke-width=\"1.3\"",
            Self::Error => "stroke=\"#c0392b\" stroke-width=\"1.2\"",
        }
    }
}

impl Chart {
    /// The chart as SVG, 960 wide.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let mut svg = String::new();
        // Writing to a `String` cannot fail.
        let _ = self.write_svg(&mut svg);
        svg
    }

    fn write_svg(&self, svg: &mut String) -> core::fmt::Result {
        let panels = self.panels.iter().fold(0.0, |sum, _| sum + PANEL + GAP);
        let height = plain(TOP + panels + BOTTOM, 1);
        let width = plain(WIDTH, 1);
        writeln!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"13\">"
        )?;
        let title = escape(&self.title);
        writeln!(svg, "<title>{title}</title>")?;
        writeln!(svg, "<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>")?;
        writeln!(svg, "<text x=\"{LEFT}\" y=\"24\" font-size=\"17\" font-weight=\"bold\">{title}</text>")?;
        let times = || self.panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.samples);
        let seconds = || times().map(|(time, _)| time.as_secs_f64());
        let least = seconds().fold(f64::INFINITY, f64::min);
        let most = seconds().fold(f64::NEG_INFINITY, f64::max);
        let time = if least <= most { Scale::within(least, most, 9.0) } else { Scale::within(0.0, 1.0, 9.0) };
        let mut top = TOP + GAP * 0.6;
        for panel in &self.panels {
            panel.write_svg(svg, top, &time)?;
            top += PANEL + GAP;
        }
        let bottom = top - GAP;
        for &tick in &time.ticks {
            let (x, label) = (plain(time_x(&time, tick), 1), plain(tick, time.decimals));
            writeln!(
                svg,
                "<text x=\"{x}\" y=\"{}\" text-anchor=\"middle\" fill=\"#444\">{label}</text>",
                plain(bottom + 18.0, 1)
            )?;
        }
        writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"#444\">time (s)</text>",
            plain((LEFT + WIDTH - RIGHT) / 2.0, 1),
            plain(bottom + 38.0, 1)
        )?;
        writeln!(svg, "</svg>")
    }
}

fn time_x(time: &Scale, seconds: f64) -> f64 {
    LEFT + time.share(seconds) * (WIDTH - LEFT - RIGHT)
}

impl Panel {
    fn write_svg(&self, svg: &mut String, top: f64, time: &Scale) -> core::fmt::Result {
        let values = || self.curves.iter().flat_map(|curve| &curve.samples).map(|&(_, value)| value);
        let least = values().fold(f64::INFINITY, f64::min);
        let most = values().fold(f64::NEG_INFINITY, f64::max);
        let scale = if least <= most { Scale::over(least, most, 5.0) } else { Scale::over(0.0, 1.0, 5.0) };
        let y = |value: f64| top + (1.0 - scale.share(value)) * PANEL;
        let (left, right, bottom) = (LEFT, plain(WIDTH - RIGHT, 1), plain(top + PANEL, 1));
        for &tick in &scale.ticks {
            let at = plain(y(tick), 1);
            writeln!(svg, "<path d=\"M{left} {at}H{right}\" stroke=\"#e6e6e6\"/>")?;
            writeln!(
                svg,
                "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" fill=\"#444\">{}</text>",
                plain(left - 8.0, 1),
                plain(y(tick) + 4.5, 1),
                plain(tick, scale.decimals)
            )?;
        }
        for &tick in &time.ticks {
            let x = plain(time_x(time, tick), 1);
            writeln!(svg, "<path d=\"M{x} {}V{bottom}\" stroke=\"#efefef\"/>", plain(top, 1))?;
        }
        writeln!(
            svg,
            "<rect x=\"{left}\" y=\"{}\" width=\"{}\" height=\"{PANEL}\" fill=\"none\" stroke=\"#888\"/>",
            plain(top, 1),
            plain(WIDTH - LEFT - RIGHT, 1)
        )?;
        let middle = plain(top + PANEL / 2.0, 1);
        writeln!(
            svg,
            "<text x=\"18\" y=\"{middle}\" text-anchor=\"middle\" transform=\"rotate(-90 18 {middle})\">{}</text>",
            escape(&self.label)
        )?;
        let mut x = LEFT + 4.0;
        for curve in &self.curves {
            curve.write_svg(svg, time, &y)?;
            let at = plain(top - 11.0, 1);
            writeln!(
                svg,
                "<path d=\"M{} {at}H{}\" fill=\"none\" {}/><text x=\"{}\" y=\"{}\" fill=\"#444\">{}</text>",
                plain(x, 1),
                plain(x + 24.0, 1),
                curve.role.pen(),
                plain(x + 30.0, 1),
                plain(top - 6.5, 1),
                escape(&curve.label)
            )?;
            // About the width of the label in a sans-serif font of 13.
            x += curve.label.chars().fold(56.0, |sum, _| sum + 6.6);
        }
        Ok(())
    }
}

impl Curve {
    fn write_svg(&self, svg: &mut String, time: &Scale, y: &impl Fn(f64) -> f64) -> core::fmt::Result {
        let mut samples = self.samples.iter();
        let Some(&first) = samples.next() else {
            return Ok(());
        };
        let place = |(at, value): Sample| (plain(time_x(time, at.as_secs_f64()), 1), plain(y(value), 1));
        let (x, level) = place(first);
        write!(svg, "<path fill=\"none\" stroke-linejoin=\"round\" {} d=\"M{x} {level}", self.role.pen())?;
        let mut last = (x, level);
        for &sample in samples {
            let (x, level) = place(sample);
            if (&x, &level) == (&last.0, &last.1) {
                continue;
            }
            match self.run {
                Run::Straight => write!(svg, "L{x} {level}")?,
                Run::Steps => write!(svg, "H{x}V{level}")?,
            }
            last = (x, level);
        }
        writeln!(svg, "\"/>")
    }
}

fn escape(text: &str) -> String {
    // Control characters are not allowed in XML at all.
    let text: String = text.chars().filter(|c| !c.is_control()).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
