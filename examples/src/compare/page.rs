//! The page: tables, the ways of the controllers with their errors magnified, and both coordinates over time.

use super::contest::{Outcome, Plant, STAR, drawing_name};
use crate::shared::escaped;
use core::time::Duration;
use plotter_motion::config::DcConfig;
use plotter_motion::{
    Pen, PenMove, Point,
    testbed::{Drawing, Figures, Moment, Ranking, TestBed},
};
use plotter_replay::{
    Chart,
    draw::{Curve, Panel, Role, Run},
};
use std::fmt::Write as _;

/// What the pictures show of a run: of each stretch of time the moment with the greatest error.
pub(super) struct Trace {
    pub(super) most: usize,
    moments: Vec<Moment>,
    /// Time steps in a stretch; grows with the run, so that memory does not.
    pub(super) every: usize,
    passed: usize,
}

impl Trace {
    /// Moments kept of a line, and of a drawing of many.
    pub(super) const OF_A_LINE: usize = 600;
    pub(super) const OF_A_DRAWING: usize = 8000;

    pub(super) fn new(most: usize) -> Self {
        Self { most, moments: Vec::new(), every: 1, passed: 0 }
    }

    pub(super) fn note(&mut self, moment: &Moment) {
        match self.moments.last_mut().filter(|_| self.passed > 0) {
            Some(last) if last.is_measured == moment.is_measured => *last = worse(last, moment),
            _ => self.moments.push(*moment),
        }
        self.passed = (self.passed + 1) % self.every;
        if self.moments.len() > self.most {
            self.moments = self
                .moments
                .chunks(2)
                .filter_map(|pair| pair.iter().copied().reduce(|a, b| worse(&a, &b)))
                .collect();
            (self.every, self.passed) = (2 * self.every, 0);
        }
    }

    /// Both coordinates over time, desired beside actual, and the distance from the line.
    fn response(&self, title: &str) -> String {
        let end = self.moments.last().map_or(Duration::ZERO, |moment| moment.time);
        let span = (Duration::ZERO, end);
        let curve = |label: &str, role: Role, value: &dyn Fn(&Moment) -> f64| {
            let samples = self.moments.iter().map(|moment| (moment.time, value(moment)));
            Curve::new(label, role, Run::Straight, span, samples.collect::<Vec<_>>())
        };
        let axis = |label: &str, of: fn(Point) -> f64| Panel {
            label: label.to_owned(),
            curves: vec![
                curve("target", Role::Setpoint, &|moment| of(moment.target)),
                curve("desired", Role::Desired, &|moment| of(moment.desired)),
                curve("actual", Role::Actual, &|moment| of(moment.pen)),
            ],
        };
        let error = Panel {
            label: "contour error (µm)".to_owned(),
            curves: vec![curve("distance from the line", Role::Error, &|moment| {
                if moment.is_measured { moment.error_mm * 1e3 } else { 0.0 }
            })],
        };
        Chart {
            title: title.to_owned(),
            panels: vec![axis("X (mm)", |at| at.x), axis("Y (mm)", |at| at.y), error],
        }
        .to_svg()
    }
}

fn worse(one: &Moment, other: &Moment) -> Moment {
    if other.error_mm > one.error_mm { *other } else { *one }
}

/// The page, as it grows plant by plant.
pub(super) struct Page {
    pub(super) html: String,
}

impl Page {
    pub(super) fn new(wrong: f64) -> Self {
        let mut html = String::from(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>Controllers compared</title>\n<style>\n\
             body { font: 16px/1.5 system-ui, sans-serif; max-width: 80rem; margin: 2rem auto; padding: 0 1rem; color: #222 }\n\
             table { border-collapse: collapse; margin: 1rem 0 2rem } td, th { padding: .25rem 1.2rem .25rem 0; border-bottom: 1px solid #ddd; text-align: right; font-variant-numeric: tabular-nums }\n\
             td:nth-child(2), th:nth-child(2) { text-align: left }\n\
             figure { margin: 1rem 0 } figure > svg { width: 100%; height: auto; border: 1px solid #ddd; background: #fff }\n\
             figcaption { color: #555 } .bad { color: #c0392b }\n\
             .grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(22rem, 1fr)); gap: 1.5rem }\n\
             .wide { grid-template-columns: repeat(auto-fill, minmax(34rem, 1fr)) }\n\
             </style></head><body>\n<h1>Controllers compared</h1>\n",
        );
        let _ = writeln!(
            html,
            "<p>Each controller draws eight lines of 60 mm from rest to rest on simulated motors, and is ranked by how far the \
             true pen was from the line (rms over all lines; who does not finish comes last). The description of the \
             machine that controllers are given is wrong by {:.0} % in inertia, friction and motor constants, each in the \
             direction that adds up. <em>Settled</em>: the pen came within 0.05 mm of the target for good.</p>",
            wrong * 100.0
        );
        Self { html }
    }

    pub(super) fn plant(
        &mut self,
        plant: &Plant,
        lines: &Ranking,
        drawn: Option<&Ranking>,
        results: &[Outcome],
    ) {
        let name = escaped(&plant.name);
        let _ = writeln!(self.html, "<h2>{name}</h2>\n<h3>Eight lines of 60 mm</h3>");
        self.table(lines);
        if let Some(drawn) = drawn {
            let _ = writeln!(self.html, "<h3>{}</h3>", escaped(drawing_name(plant)));
            self.table(drawn);
        }
        let _ = writeln!(self.html, "<h3>The way of the pen, errors magnified</h3>\n<div class=\"grid\">");
        for score in lines.scores() {
            let Some(result) = results.iter().find(|result| result.score.entry == score.entry) else {
                continue;
            };
            let star = result.traces.get(..STAR).unwrap_or_default();
            self.phase(&score.entry, plant.drawings.get(..STAR).unwrap_or_default(), star, &plant.bed);
            if drawn.is_some() {
                let (drawing, trace) = (plant.drawings.get(STAR..), result.traces.get(STAR..));
                self.phase(&score.entry, drawing.unwrap_or_default(), trace.unwrap_or_default(), &plant.bed);
            }
        }
        self.html.push_str("</div>\n<h3>Desired beside actual over time</h3>\n<p>Of each controller the line that it drew worst.</p>\n<div class=\"grid wide\">\n");
        for score in lines.scores() {
            let Some(result) = results.iter().find(|result| result.score.entry == score.entry) else {
                continue;
            };
            let figures = result.score.drawings.iter().take(STAR).enumerate();
            let worst = figures.max_by(|(_, (_, one)), (_, (_, other))| one.max_mm.total_cmp(&other.max_mm));
            if let Some((index, (line, Figures { max_mm, .. }))) = worst {
                let title = format!("{}, {line}", result.score.entry);
                if let Some(trace) = result.traces.get(index) {
                    let caption = format!("{title}: {:.2} µm at most", max_mm * 1e3);
                    self.figure(&trace.response(&title), &caption);
                }
            }
        }
        self.html.push_str("</div>\n");
    }

    pub(super) fn table(&mut self, ranking: &Ranking) {
        let published =
            ranking.scores().iter().find(|score| score.entry == "published").map(|s| s.total().rms_mm());
        self.html.push_str(
            "<table><tr><th></th><th>controller</th><th>rms, µm</th><th>max, µm</th><th>finished</th><th>settled</th>\
             <th>time, s</th><th>energy, J</th><th>better than published by</th></tr>\n",
        );
        for (index, score) in ranking.scores().iter().enumerate() {
            let (total, all) = (score.total(), score.drawings.len());
            let count = |n: usize| {
                let class = if n < all { " class=\"bad\"" } else { "" };
                format!("<td{class}>{n} of {all}</td>")
            };
            let times = published.filter(|_| total.rms_mm() > 0.0).map(|rms| rms / total.rms_mm());
            let _ = writeln!(
                self.html,
                "<tr><td>{}</td><td>{}</td><td>{:.3}</td><td>{:.2}</td>{}{}<td>{:.2}</td><td>{:.2}</td><td>{}</td></tr>",
                index + 1,
                escaped(&score.entry),
                total.rms_mm() * 1e3,
                total.max_mm * 1e3,
                count(score.finished()),
                count(score.settled()),
                total.time.as_secs_f64(),
                total.energy_j,
                times.map_or_else(String::new, |times| format!("{times:.1}"))
            );
        }
        self.html.push_str("</table>\n");
    }

    fn phase(&mut self, entry: &str, drawings: &[Drawing], traces: &[Trace], bed: &TestBed) {
        let (svg, magnified) = phase_picture(drawings, traces, bed);
        let names = match drawings {
            [one] => one.name.as_str(),
            _ => "eight lines",
        };
        self.figure(&svg, &format!("{entry}, {names}: distance from the line × {magnified}"));
    }

    fn figure(&mut self, svg: &str, caption: &str) {
        let svg = svg.find("<svg").and_then(|start| svg.get(start..)).unwrap_or_default();
        let _ = writeln!(self.html, "<figure>{svg}<figcaption>{}</figcaption></figure>", escaped(caption));
    }

    pub(super) fn finish(mut self) -> String {
        self.html.push_str("</body></html>\n");
        self.html
    }
}

/// The desired lines, pale, and the way of the pen with its distance from them magnified by a round number,
/// which comes with it: so that the greatest distance is a twelfth of the picture at most.
fn phase_picture(drawings: &[Drawing], traces: &[Trace], bed: &TestBed) -> (String, f64) {
    const WIDTH: f64 = 480.0;
    const MARGIN: f64 = 50.0;
    let dc = DcConfig::of(bed.machine());
    let on_sheet = |step: &PenMove| {
        Point::new(
            f64::from(step.target.x) / dc.x.counts_per_mm,
            f64::from(step.target.y) / dc.y.counts_per_mm,
        )
    };
    let corners = || drawings.iter().flat_map(|drawing| &drawing.moves).map(on_sheet).chain([Point::ORIGIN]);
    let least = corners().fold(Point::ORIGIN, |least, at| Point::new(least.x.min(at.x), least.y.min(at.y)));
    let most = corners().fold(Point::ORIGIN, |most, at| Point::new(most.x.max(at.x), most.y.max(at.y)));
    let size_mm = (most.x - least.x).max(most.y - least.y).max(1e-6);
    let scale = (WIDTH - 2.0 * MARGIN) / size_mm;
    let height = (most.y - least.y) * scale + 2.0 * MARGIN;
    let place = |at: Point| (MARGIN + (at.x - least.x) * scale, height - MARGIN - (at.y - least.y) * scale);
    let measured = || traces.iter().flat_map(|trace| &trace.moments).filter(|moment| moment.is_measured);
    let greatest_mm = measured().map(|moment| moment.error_mm).fold(0.0, f64::max);
    let magnified = round_down(size_mm / 12.0 / greatest_mm.max(1e-9)).max(1.0);

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height:.0}\" viewBox=\"0 0 {WIDTH} {height:.0}\">\n"
    );
    for drawing in drawings {
        let mut from = Point::ORIGIN;
        for step in &drawing.moves {
            let to = on_sheet(step);
            if step.pen == Pen::Down {
                let ((x0, y0), (x1, y1)) = (place(from), place(to));
                let _ = writeln!(
                    svg,
                    "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"#9cc4ec\" stroke-width=\"4\" stroke-linecap=\"round\"/>"
                );
            }
            from = to;
        }
    }
    for trace in traces {
        let mut is_down = false;
        let mut path = String::new();
        for moment in &trace.moments {
            if moment.is_measured {
                let away = moment.pen - moment.nearest;
                let (x, y) = place(moment.nearest + away * magnified);
                let _ = write!(path, "{}{x:.1} {y:.1}", if is_down { 'L' } else { 'M' });
            }
            is_down = moment.is_measured;
        }
        if !path.is_empty() {
            let _ = writeln!(
                svg,
                "<path d=\"{path}\" fill=\"none\" stroke=\"#c0392b\" stroke-width=\"1.2\" stroke-linejoin=\"round\"/>"
            );
        }
    }
    svg.push_str("</svg>\n");
    (svg, magnified)
}

/// The next lower of 1, 2 and 5 times a power of ten.
fn round_down(number: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(number)));
    [5.0, 2.0, 1.0].into_iter().map(|n| n * power).find(|&round| round <= number).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnifications_are_round() {
        assert_eq!([1.0, 1.9, 4.99, 5.0, 999.0].map(round_down), [1.0, 1.0, 2.0, 5.0, 500.0]);
    }

    #[test]
    fn a_long_run_keeps_no_more_than_a_picture_shows_and_every_peak() {
        let mut trace = Trace::new(Trace::OF_A_LINE);
        let at = Point::ORIGIN;
        for step in 0..100_000 {
            let error_mm = if step == 77_777 { 9.0 } else { 0.0 };
            let time = Duration::from_micros(10 * step);
            trace.note(&Moment {
                time,
                target: at,
                desired: at,
                pen: at,
                nearest: at,
                error_mm,
                is_measured: true,
            });
        }
        let kept = trace.moments.len();
        assert!(kept <= Trace::OF_A_LINE && kept > Trace::OF_A_LINE / 4, "{kept}");
        assert!(trace.moments.is_sorted_by_key(|moment| moment.time));
        assert!(trace.moments.last().unwrap().time > Duration::from_millis(990));
        assert!(trace.moments.iter().any(|moment| moment.error_mm == 9.0), "the peak stays");
    }
}
