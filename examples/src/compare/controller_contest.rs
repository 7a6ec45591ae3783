//! A contest of controllers on simulated machines: table, CSV and a page with pictures.

use crate::shared::{
    at, escaped, fit_drawing, lost_ink, print, read_file, run, vectorized, vectorizer, write_file,
};
use clap::Parser;
use core::time::Duration;
use indicatif::{ProgressBar, ProgressStyle};
use plotter_motion::testbed::{Drawing, Entry, Figures, Moment, Ranking, Score, TestBed, TestBedSettings};
use plotter_motion::{Machine, Pen, PenMove, PlotOp, Point, config::MachineKind, hpgl};
use plotter_replay::{
    Chart,
    draw::{Curve, Panel, Role, Run},
};
use plotter_vector::{FileRows, picture::RowSource as _};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Lets controllers draw on simulated machines whose descriptions are wrong, and ranks them by how near to the lines the pen truly was.
#[derive(Parser)]
#[command(
    name = "compare_controllers",
    after_help = "Examples:\n  cargo run --release --example compare_controllers\n  \
                  cargo run --release --example compare_controllers -- --drawing builtin --html target/controllers.html\n  \
                  cargo run --release --example compare_controllers -- --machine examples/machines/loaded-gantry.toml \
                  --machine mine.toml --csv figures.csv\n\n\
                  A controller of your own: copy examples/my_controller.rs."
)]
struct Args {
    /// A machine's TOML file; may be given several times [default: the loaded gantry, with its encoders decoded x1 and x4]
    #[arg(long, value_name = "FILE")]
    machine: Vec<PathBuf>,
    /// What is drawn besides the eight lines: a picture (PNG, JPEG, PBM, PGM), HPGL (.plt, .hpgl), or `builtin` for a flag as line art
    #[arg(long, value_name = "FILE|builtin")]
    drawing: Option<PathBuf>,
    /// Width of a drawn picture, mm
    #[arg(long, value_name = "MM", default_value_t = 50.0, allow_negative_numbers = true)]
    width_mm: f64,
    /// By which share the description that controllers are given is wrong in each of its figures, 0 to 0.5
    #[arg(long, value_name = "SHARE", default_value_t = 0.25, allow_negative_numbers = true)]
    wrong: f64,
    /// Only these controllers, by their names with commas between them
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Writes a page with tables and pictures, which needs no other file
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Writes the figures of every line
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

/// Runs the command line of `compare_controllers` with the controllers that are always there and `more` of one's own.
pub fn compare_controllers(more: Vec<Entry>) -> ExitCode {
    run("compare_controllers", || compare(&Args::parse(), more))
}

/// A machine and what it draws.
struct Plant {
    name: String,
    bed: TestBed,
    drawings: Vec<Drawing>,
}

/// What an entry did on a plant, with a trace of each drawing.
struct Outcome {
    score: Score,
    traces: Vec<Trace>,
}

fn compare(args: &Args, more: Vec<Entry>) -> Result<(), String> {
    let entries = entries(&args.only, more)?;
    let plants = plants(args)?;
    // What cannot be written is better known before the work than after it.
    for path in [&args.html, &args.csv].into_iter().flatten() {
        write_file(path, "")?;
    }
    let jobs: Vec<(usize, usize)> =
        (0..plants.len()).flat_map(|plant| (0..entries.len()).map(move |entry| (plant, entry))).collect();
    let bar = ProgressBar::new(jobs.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("drawing {bar:40} {pos}/{len} controllers, {elapsed}") {
        bar.set_style(style);
    }
    let wants_traces = args.html.is_some();
    let results: Vec<Outcome> = jobs
        .par_iter()
        .map(|&(plant, entry)| {
            let result = result(&plants[plant], &entries[entry], wants_traces);
            bar.inc(1);
            result
        })
        .collect();
    bar.finish_and_clear();

    let mut text = String::new();
    let mut csv = String::from("controller,plant,line,rms_um,max_um,settle_s,time_s,finished\n");
    let mut page = Page::new(args.wrong);
    for (plant, results) in plants.iter().zip(results.chunks(entries.len().max(1))) {
        let (lines, drawn) = split(plant, results);
        let _ = writeln!(text, "{}: eight lines of 60 mm\n{lines}", plant.name);
        if let Some(drawn) = &drawn {
            let _ = writeln!(text, "{}: {}\n{drawn}", plant.name, drawing_name(plant));
        }
        for result in results {
            csv_rows(&mut csv, plant, &result.score);
        }
        if wants_traces {
            page.plant(plant, &lines, drawn.as_ref(), results);
        }
    }
    if let Some(path) = &args.csv {
        write_file(path, csv)?;
    }
    if let Some(path) = &args.html {
        write_file(path, page.finish())?;
        let _ = writeln!(text, "look at {}", path.display());
    }
    print(&text)
}

/// Number of lines of the star, which come first among the drawings of a plant.
const STAR: usize = 8;

fn drawing_name(plant: &Plant) -> &str {
    plant.drawings.get(STAR).map_or("", |drawing| drawing.name.as_str())
}

/// The ranking by the eight lines, and by the drawing if there is one.
fn split(plant: &Plant, results: &[Outcome]) -> (Ranking, Option<Ranking>) {
    let part = |range: core::ops::Range<usize>| {
        let of = |result: &Outcome| Score {
            entry: result.score.entry.clone(),
            drawings: result.score.drawings.get(range.clone()).unwrap_or_default().to_vec(),
        };
        Ranking::new(results.iter().map(of).collect())
    };
    let all = plant.drawings.len();
    (part(0..STAR.min(all)), (all > STAR).then(|| part(STAR..all)))
}

fn entries(only: &[String], more: Vec<Entry>) -> Result<Vec<Entry>, String> {
    let mut entries = Entry::standard();
    for entry in &more {
        if entries.iter().any(|other| other.name() == entry.name()) {
            return Err(format!("there is a controller `{}` already: give yours another name", entry.name()));
        }
    }
    entries.extend(more);
    let known = || entries.iter().map(Entry::name).collect::<Vec<_>>().join(", ");
    if let Some(name) = only.iter().find(|name| !entries.iter().any(|entry| entry.name() == name.as_str())) {
        return Err(format!("--only {name}: there is no such controller; there are {}", known()));
    }
    if !only.is_empty() {
        entries.retain(|entry| only.iter().any(|name| name == entry.name()));
    }
    Ok(entries)
}

fn plants(args: &Args) -> Result<Vec<Plant>, String> {
    if !(0.0..=0.5).contains(&args.wrong) {
        return Err(format!("--wrong {}: give a share of 0 to 0.5", args.wrong));
    }
    let built_in = [
        ("loaded-gantry.toml", include_str!("../../machines/loaded-gantry.toml")),
        ("loaded-gantry-x4.toml", include_str!("../../machines/loaded-gantry-x4.toml")),
    ];
    if args.machine.is_empty() {
        return built_in.iter().map(|(path, text)| plant(args, Path::new(path), text)).collect();
    }
    args.machine
        .iter()
        .map(|path| {
            let text = String::from_utf8(read_file(path)?)
                .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
            plant(args, path, &text)
        })
        .collect()
}

fn plant(args: &Args, path: &Path, text: &str) -> Result<Plant, String> {
    let machine = Machine::from_toml(text).map_err(|error| at(path, &error))?;
    machine.require(MachineKind::Gantry, "the contest of controllers").map_err(|error| at(path, &error))?;
    let settings = TestBedSettings { wrong_share: args.wrong, ..TestBedSettings::default() };
    let bed = TestBed::new(&machine, settings).map_err(|error| {
        at(path, &format!("cannot be described so wrongly (--wrong {}): {error}", args.wrong))
    })?;
    let mut drawings = Drawing::star(&bed);
    if let Some(path) = &args.drawing {
        drawings.push(drawing(args, path, &bed)?);
    }
    Ok(Plant { name: machine.config().name.as_str().to_owned(), bed, drawings })
}

fn drawing(args: &Args, path: &Path, bed: &TestBed) -> Result<Drawing, String> {
    let is_builtin = path.as_os_str() == "builtin";
    let bytes = if is_builtin { include_bytes!("../../data/flag.png").to_vec() } else { read_file(path)? };
    let is_hpgl = path
        .extension()
        .is_some_and(|ending| ["plt", "hpgl"].iter().any(|known| ending.eq_ignore_ascii_case(known)));
    let name =
        if is_builtin { "flag".into() } else { path.file_stem().unwrap_or_default().to_string_lossy() };
    let text = if is_hpgl { bytes } else { traced(args, path, &bytes, bed)?.into_bytes() };
    let ops: Vec<PlotOp> =
        hpgl::plot_ops(text.as_slice()).collect::<Result<_, _>>().map_err(|error| at(path, &error))?;
    // A name stands in a table and in CSV.
    let name = name.replace([',', '"', '\n', '\r'], "_");
    Drawing::from_ops(&name, bed, ops).map_err(|error| at(path, &error))
}

/// A picture as HPGL, as the example `plot` makes it with ours on this machine.
fn traced(args: &Args, path: &Path, bytes: &[u8], bed: &TestBed) -> Result<String, String> {
    let scan = FileRows::new(Cursor::new(bytes)).map_err(|error| at(path, &error))?;
    let scale = fit_drawing((scan.width(), scan.height()), bed.machine(), args.width_mm)?;
    let vectorizer =
        vectorizer(&bed.machine().config().vectorize, scale.mm_per_px()).map_err(|error| at(path, &error))?;
    let traced = vectorized(&vectorizer, bytes.to_vec()).map_err(|error| at(path, &error))?;
    let errors = traced.errors.unwrap_or_default();
    lost_ink(&vectorizer, &errors, traced.pen_px).map_err(|error| at(path, &error))?;
    let mut text = String::new();
    plotter_vector::hpgl(&traced.drawing, scale, &mut text).map_err(|error| error.to_string())?;
    Ok(text)
}

fn result(plant: &Plant, entry: &Entry, wants_traces: bool) -> Outcome {
    let mut traces = Vec::new();
    let mut drawings = Vec::new();
    for drawing in &plant.drawings {
        let most = if drawing.moves.len() > 1 { Trace::OF_A_DRAWING } else { Trace::OF_A_LINE };
        let mut trace = Trace::new(most);
        let figures = entry.run(&plant.bed, drawing, |moment| {
            if wants_traces {
                trace.note(moment);
            }
        });
        drawings.push((drawing.name.clone(), figures));
        traces.push(trace);
    }
    Outcome { score: Score { entry: entry.name().to_owned(), drawings }, traces }
}

fn csv_rows(csv: &mut String, plant: &Plant, score: &Score) {
    for (line, figures) in &score.drawings {
        let settled = figures.settled.map_or_else(String::new, |at| format!("{:.4}", at.as_secs_f64()));
        let _ = writeln!(
            csv,
            "{},{},{line},{:.4},{:.4},{settled},{:.4},{}",
            field(&score.entry),
            field(&plant.name),
            figures.rms_mm() * 1e3,
            figures.max_mm * 1e3,
            figures.time.as_secs_f64(),
            figures.is_finished()
        );
    }
}

/// A name in CSV: in quotes where it would break the row.
fn field(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

/// What the pictures show of a run: of each stretch of time the moment with the greatest error.
struct Trace {
    most: usize,
    moments: Vec<Moment>,
    /// Time steps in a stretch; grows with the run, so that memory does not.
    every: usize,
    passed: usize,
}

impl Trace {
    /// Moments kept of a line, and of a drawing of many.
    const OF_A_LINE: usize = 600;
    const OF_A_DRAWING: usize = 8000;

    fn new(most: usize) -> Self {
        Self { most, moments: Vec::new(), every: 1, passed: 0 }
    }

    fn note(&mut self, moment: &Moment) {
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
struct Page {
    html: String,
}

impl Page {
    fn new(wrong: f64) -> Self {
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

    fn plant(&mut self, plant: &Plant, lines: &Ranking, drawn: Option<&Ranking>, results: &[Outcome]) {
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

    fn table(&mut self, ranking: &Ranking) {
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

    fn finish(mut self) -> String {
        self.html.push_str("</body></html>\n");
        self.html
    }
}

/// The desired lines, pale, and the way of the pen with its distance from them magnified by a round number, which comes
/// with it: so that the greatest distance is a twelfth of the picture at most.
fn phase_picture(drawings: &[Drawing], traces: &[Trace], bed: &TestBed) -> (String, f64) {
    const WIDTH: f64 = 480.0;
    const MARGIN: f64 = 50.0;
    let config = bed.machine().config();
    let on_sheet = |step: &PenMove| {
        Point::new(
            f64::from(step.target.x) / config.x.counts_per_mm,
            f64::from(step.target.y) / config.y.counts_per_mm,
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
    fn a_name_with_a_comma_is_quoted() {
        assert_eq!(field("mine"), "mine");
        assert_eq!(field("mine, \"new\""), "\"mine, \"\"new\"\"\"");
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
