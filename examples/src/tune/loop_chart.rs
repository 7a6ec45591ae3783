//! [`LoopChart`]: loops as pictures: steps, Bode's and Nyquist's.

use crate::shared::escaped;
use plotter_motion::control::tuning::Complex;
use std::fmt::Write as _;

const WIDTH: f64 = 1120.0;
const PANEL_WIDTH: f64 = 460.0;
const PANEL_HEIGHT: f64 = 300.0;
const LEFT: f64 = 76.0;
const GAP_X: f64 = 84.0;
const GAP_Y: f64 = 74.0;
const TOP: f64 = 44.0;

/// One loop.
#[derive(Clone, Debug)]
pub struct LoopCurve {
    /// What the legend calls it.
    pub name: String,
    /// Time, ms, and place, mm, of a step of the setpoint.
    pub step: Vec<(f64, f64)>,
    /// Frequency, Hz, and what the cut loop makes of it; with rising frequency.
    pub response: Vec<(f64, Complex)>,
}

/// The loops of one axis.
#[derive(Clone, Debug)]
pub struct LoopChart {
    /// Headline.
    pub title: String,
    /// How far the setpoint steps, mm.
    pub step_mm: f64,
    /// The sensitivity whose circle is drawn.
    pub max_sensitivity: f64,
    /// The loops; the first is drawn thick and pale.
    pub curves: Vec<LoopCurve>,
}

/// Told apart by people with any kind of sight (Okabe and Ito).
const COLOURS: [&str; 6] = ["#999999", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"];

/// A picture of several axes, one below the other.
#[must_use]
pub fn loop_charts_svg(charts: &[LoopChart]) -> String {
    let block = TOP + 2.0 * (PANEL_HEIGHT + GAP_Y);
    #[expect(clippy::cast_precision_loss, reason = "two axes")]
    let height = block * charts.len() as f64 + 10.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>\n"
    );
    let mut top = 0.0;
    for (index, chart) in charts.iter().enumerate() {
        chart.draw(&mut svg, top, index);
        top += block;
    }
    svg.push_str("</svg>\n");
    svg
}

/// A rectangle with scales.
struct Panel<'a> {
    svg: &'a mut String,
    id: String,
    left: f64,
    top: f64,
    x: (f64, f64),
    y: (f64, f64),
}

impl Panel<'_> {
    fn x(&self, value: f64) -> f64 {
        self.left + PANEL_WIDTH * (value - self.x.0) / (self.x.1 - self.x.0)
    }

    fn y(&self, value: f64) -> f64 {
        self.top + PANEL_HEIGHT * (self.y.1 - value) / (self.y.1 - self.y.0)
    }

    fn frame(&mut self, title: &str, x_label: &str, x_ticks: &[(f64, String)], y_ticks: &[(f64, String)]) {
        let (left, top) = (self.left, self.top);
        let (right, bottom) = (left + PANEL_WIDTH, top + PANEL_HEIGHT);
        let _ = writeln!(self.svg, "<g stroke=\"#e4e4e4\">");
        for (value, _) in x_ticks {
            let x = self.x(*value);
            let _ = writeln!(self.svg, "<path d=\"M{x:.1} {top}V{bottom}\"/>");
        }
        for (value, _) in y_ticks {
            let y = self.y(*value);
            let _ = writeln!(self.svg, "<path d=\"M{left} {y:.1}H{right}\"/>");
        }
        let _ = writeln!(self.svg, "</g>");
        for (value, text) in x_ticks {
            let (x, y) = (self.x(*value), bottom + 17.0);
            let _ = writeln!(self.svg, "<text x=\"{x:.1}\" y=\"{y}\" text-anchor=\"middle\">{text}</text>");
        }
        for (value, text) in y_ticks {
            let (x, y) = (left - 8.0, self.y(*value) + 4.0);
            let _ = writeln!(self.svg, "<text x=\"{x}\" y=\"{y:.1}\" text-anchor=\"end\">{text}</text>");
        }
        let _ = writeln!(
            self.svg,
            "<rect x=\"{left}\" y=\"{top}\" width=\"{PANEL_WIDTH}\" height=\"{PANEL_HEIGHT}\" fill=\"none\" stroke=\"#888\"/>\n\
             <text x=\"{left}\" y=\"{}\" font-weight=\"bold\">{title}</text>\n\
             <text x=\"{right}\" y=\"{}\" text-anchor=\"end\" fill=\"#555\">{x_label}</text>\n\
             <clipPath id=\"{}\"><rect x=\"{left}\" y=\"{top}\" width=\"{PANEL_WIDTH}\" height=\"{PANEL_HEIGHT}\"/></clipPath>",
            top - 8.0,
            bottom + 34.0,
            self.id
        );
    }

    fn line(&mut self, points: impl Iterator<Item = (f64, f64)>, pen: &str) {
        /// Far outside of the panel nothing needs its exact place.
        const FAR: f64 = 5_000.0;
        let mut path = String::new();
        for (x, y) in points.filter(|(x, y)| x.is_finite() && y.is_finite()) {
            let letter = if path.is_empty() { 'M' } else { 'L' };
            let (x, y) = (self.x(x).clamp(-FAR, FAR), self.y(y).clamp(-FAR, FAR));
            let _ = write!(path, "{letter}{x:.1} {y:.1}");
        }
        let id = &self.id;
        let _ = writeln!(self.svg, "<path d=\"{path}\" fill=\"none\" {pen} clip-path=\"url(#{id})\"/>");
    }
}

impl LoopChart {
    fn draw(&self, svg: &mut String, top: f64, index: usize) {
        let _ = writeln!(
            svg,
            "<text x=\"{LEFT}\" y=\"{}\" font-size=\"17\" font-weight=\"bold\">{}</text>",
            top + 24.0,
            escaped(&self.title)
        );
        let right = LEFT + PANEL_WIDTH + GAP_X;
        let (first, second) = (top + TOP + 22.0, top + TOP + 22.0 + PANEL_HEIGHT + GAP_Y);
        self.steps(svg, (LEFT, first), format!("step{index}"));
        self.nyquist(svg, (right, first), format!("nyquist{index}"));
        self.bode(svg, (LEFT, second), format!("gain{index}"), true);
        self.bode(svg, (right, second), format!("phase{index}"), false);
    }

    fn steps(&self, svg: &mut String, (left, top): (f64, f64), id: String) {
        let last_ms =
            self.curves.iter().filter_map(|curve| curve.step.last()).map(|p| p.0).fold(1.0, f64::max);
        let most = self.curves.iter().flat_map(|curve| &curve.step).map(|p| p.1).fold(self.step_mm, f64::max);
        let y_most = (1.05 * most).min(2.2 * self.step_mm);
        let mut panel = Panel { svg, id, left, top, x: (0.0, last_ms), y: (-0.05 * y_most, y_most) };
        panel.frame("step of the setpoint, mm", "ms", &ticks(0.0, last_ms, 7.0), &ticks(0.0, y_most, 6.0));
        panel.line(
            [(0.0, self.step_mm), (last_ms, self.step_mm)].into_iter(),
            "stroke=\"#222\" stroke-dasharray=\"5 4\"",
        );
        for (curve, pen) in self.pens() {
            panel.line(curve.step.iter().copied(), &pen);
        }
        // The legend lies where all curves have come to rest below it.
        let (x, mut y) = (left + PANEL_WIDTH - 200.0, top + PANEL_HEIGHT - 22.0 * self.rows() - 8.0);
        let _ = writeln!(
            panel.svg,
            "<rect x=\"{}\" y=\"{y}\" width=\"196\" height=\"{}\" fill=\"#fff\" fill-opacity=\"0.85\"/>",
            x - 6.0,
            22.0 * self.rows()
        );
        for (curve, pen) in self.pens() {
            let (name, line) = (escaped(&curve.name), y + 11.0);
            let _ = writeln!(
                panel.svg,
                "<path d=\"M{x} {line}h26\" {pen}/><text x=\"{}\" y=\"{}\">{name}</text>",
                x + 34.0,
                line + 4.5
            );
            y += 22.0;
        }
    }

    fn rows(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        let rows = self.curves.len() as f64;
        rows
    }

    fn nyquist(&self, svg: &mut String, (left, top): (f64, f64), id: String) {
        let half = 1.6;
        let wide = half * PANEL_WIDTH / PANEL_HEIGHT;
        let mut panel =
            Panel { svg, id, left, top, x: (-wide - 0.3, wide - 0.3), y: (-half - 0.4, half - 0.4) };
        let marks: Vec<_> = [-2.0, -1.0, 0.0, 1.0, 2.0].into_iter().map(|v| (v, format!("{v}"))).collect();
        let fits = |range: (f64, f64)| {
            marks
                .iter()
                .filter(move |mark| (range.0..=range.1).contains(&mark.0))
                .cloned()
                .collect::<Vec<_>>()
        };
        let title = format!("Nyquist: the cut loop; dotted: sensitivity {}", plain(self.max_sensitivity));
        let (x_marks, y_marks) = (fits(panel.x), fits(panel.y));
        panel.frame(&title, "real part", &x_marks, &y_marks);
        let circle = |centre: f64, radius: f64| {
            (0..=90).map(move |i| {
                let angle = f64::from(i) * std::f64::consts::TAU / 90.0;
                (centre + radius * libm::cos(angle), radius * libm::sin(angle))
            })
        };
        panel.line(circle(0.0, 1.0), "stroke=\"#bbb\"");
        panel.line(circle(-1.0, 1.0 / self.max_sensitivity), "stroke=\"#222\" stroke-dasharray=\"2 3\"");
        for (curve, pen) in self.pens() {
            panel.line(curve.response.iter().map(|(_, l)| (l.re, l.im)), &pen);
        }
        let (x, y) = (panel.x(-1.0), panel.y(0.0));
        let _ = writeln!(
            panel.svg,
            "<path d=\"M{} {y}h10M{x} {}v10\" stroke=\"#000\" stroke-width=\"1.5\"/>",
            x - 5.0,
            y - 5.0
        );
    }

    fn bode(&self, svg: &mut String, (left, top): (f64, f64), id: String, gain: bool) {
        let hz = || self.curves.iter().flat_map(|curve| &curve.response).map(|(hz, _)| *hz);
        let last = hz().fold(1.0, f64::max);
        let first = 1e-3 * last;
        let y = if gain { (-40.0, 60.0) } else { (-270.0, -45.0) };
        let mut panel = Panel { svg, id, left, top, x: (libm::log10(first), libm::log10(last)), y };
        #[expect(clippy::cast_possible_truncation, reason = "decades")]
        let (low, high) = (panel.x.0.ceil() as i32, panel.x.1.floor() as i32);
        let decades: Vec<_> =
            (low..=high).map(|decade| (f64::from(decade), plain(libm::pow(10.0, decade.into())))).collect();
        if gain {
            let marks: Vec<_> = (-2..=3).map(|i| (20.0 * f64::from(i), format!("{}", 20 * i))).collect();
            panel.frame("Bode: gain, dB", "Hz, up to half the loop's rate", &decades, &marks);
            panel.line([(-9.0, 0.0), (9.0, 0.0)].into_iter(), "stroke=\"#222\" stroke-dasharray=\"5 4\"");
        } else {
            let marks: Vec<_> = (1..=6).map(|i| (-45.0 * f64::from(i), format!("{}", -45 * i))).collect();
            panel.frame("Bode: phase, degrees", "Hz, up to half the loop's rate", &decades, &marks);
            panel.line(
                [(-9.0, -180.0), (9.0, -180.0)].into_iter(),
                "stroke=\"#222\" stroke-dasharray=\"5 4\"",
            );
        }
        for (curve, pen) in self.pens() {
            let phases = unwrapped(&curve.response);
            let points = curve.response.iter().zip(phases).map(|((hz, l), phase)| {
                (libm::log10(*hz), if gain { 20.0 * libm::log10(l.size()) } else { phase })
            });
            panel.line(points, &pen);
        }
    }

    fn pens(&self) -> impl Iterator<Item = (&LoopCurve, String)> {
        self.curves.iter().zip(COLOURS.into_iter().cycle()).enumerate().map(|(index, (curve, colour))| {
            let width = if index == 0 { 3.5 } else { 1.7 };
            (curve, format!("stroke=\"{colour}\" stroke-width=\"{width}\""))
        })
    }
}

/// Phases, degrees, that do not leap from -180 to 180.
fn unwrapped(response: &[(f64, Complex)]) -> Vec<f64> {
    let mut before: Option<f64> = None;
    let next = response.iter().map(|(_, l)| {
        let phase = l.angle_rad().to_degrees();
        // The loop begins between -90 and -270.
        let near = before.unwrap_or(-135.0);
        let phase = phase - 360.0 * libm::round((phase - near) / 360.0);
        before = Some(phase);
        phase
    });
    next.collect()
}

/// Round numbers from `low` to `high`, about `wanted` of them.
fn ticks(low: f64, high: f64, wanted: f64) -> Vec<(f64, String)> {
    let rough = (high - low) / wanted;
    let decade = libm::pow(10.0, libm::floor(libm::log10(rough)));
    let stride = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * decade).find(|s| *s >= rough).unwrap_or(rough);
    let mut marks = Vec::new();
    let mut index = libm::ceil(low / stride);
    while index * stride <= high && marks.len() < 50 {
        marks.push((index * stride, plain(index * stride)));
        index += 1.0;
    }
    marks
}

/// Without zeros behind the last digit.
fn plain(number: f64) -> String {
    let text = format!("{number:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_curve_is_in_every_panel() {
        let curve = |name: &str| LoopCurve {
            name: name.into(),
            step: vec![(0.0, 0.0), (10.0, 2.0)],
            response: vec![(1.0, Complex { re: -1.0, im: -5.0 }), (1000.0, Complex { re: -0.1, im: 0.0 })],
        };
        let chart = LoopChart {
            title: "a < b".into(),
            step_mm: 2.0,
            max_sensitivity: 1.6,
            curves: vec![curve("one"), curve("two")],
        };
        let svg = loop_charts_svg(&[chart.clone(), chart]);
        assert!(svg.contains("a &lt; b") && svg.ends_with("</svg>\n"));
        for colour in &COLOURS[..2] {
            // four panels and the legend, on two axes
            assert_eq!(svg.matches(&format!("stroke=\"{colour}\"")).count(), 10, "{colour}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn phases_go_on_beyond_half_a_turn() {
        let spiral = |i: i32| (f64::from(i), Complex::polar(1.0, -1.6 - 0.3 * f64::from(i)));
        let phases = unwrapped(&(0..20).map(spiral).collect::<Vec<_>>());
        assert!(phases.windows(2).all(|pair| (pair[0] - pair[1] - 0.3_f64.to_degrees()).abs() < 1e-9));
    }
}
