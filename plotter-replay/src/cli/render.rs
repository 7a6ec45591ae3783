//! `render`: pictures and a page of what the motors did.

use super::beginning::{beginning, place};
use super::commands::{Contents, Done, Verdict, cannot, read_all, say, say_damage, say_first};
use super::drawing::{DrawingFile, USUAL_COUNTS_PER_MM};
use crate::{
    CanvasStyle, Chart, PageSettings, RecordingPage, VirtualPlotter,
    draw::{Layer, Sketch, Visibility},
    virtual_plotter::Leg,
};
use clap::Args;
use plotter_motion::{Pen, PlotOp, Point};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Most operations of a drawing that are kept, of some 40 bytes each.
const MOST_OPS: usize = 8_000_000;
/// Records after which what was drawn goes on to the canvas.
const HAND_ON_AFTER: u64 = 4_096;

#[derive(Debug, Args)]
pub(crate) struct Render {
    /// The log; packed if its name ends in .gz.
    log: PathBuf,
    /// Write plotted.svg, plotted.png, response.svg and recording.html into this directory [default: the
    /// current one, unless a single file is asked for].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the plotted drawing as SVG.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Write the plotted drawing as PNG.
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// Write the response of both motors as SVG.
    #[arg(long, value_name = "FILE")]
    chart: Option<PathBuf>,
    /// Write a page for a browser, which plays the recording and needs no network.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// The drawing that was sent, in HPGL, G-code or the thesis' text. It tells when the pen is down,
    /// and what should have been drawn.
    #[arg(long, value_name = "FILE")]
    drawing: Option<PathBuf>,
    /// Mark ink farther than this from its line, mm.
    #[arg(long, value_name = "MM", default_value_t = PageSettings::default().mark_mm, value_parser = length)]
    mark_mm: f64,
    /// Position of the pen when the log begins, mm [default: the first that the machine reports, else
    /// the origin].
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    origin: Option<Point>,
    /// Show travel, too.
    #[arg(long)]
    travel: bool,
    /// Longer side of the PNG, pixels.
    #[arg(long, value_name = "PX", default_value_t = 1_600, value_parser = clap::value_parser!(u32).range(64..=8192))]
    size: u32,
}

impl Render {
    /// Runs the command.
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let drawing = self.drawing.as_deref().map(|path| read_drawing(path, out)).transpose()?;
        let single = [&self.svg, &self.png, &self.chart, &self.html].into_iter().any(Option::is_some);
        let directory = self.out.clone().or_else(|| (!single).then(|| PathBuf::from(".")));
        let places = |one: &Option<PathBuf>, name: &str| {
            let in_directory = directory.as_ref().map(|directory| directory.join(name));
            one.clone().into_iter().chain(in_directory).collect::<Vec<_>>()
        };
        let (svgs, pngs) = (places(&self.svg, "plotted.svg"), places(&self.png, "plotted.png"));
        let (charts, pages) = (places(&self.chart, "response.svg"), places(&self.html, "recording.html"));
        let mut drawn = self.read(
            drawing.as_ref(),
            !charts.is_empty(),
            !pages.is_empty(),
            !svgs.is_empty() || !pngs.is_empty(),
        )?;
        if let Some(directory) = &directory {
            std::fs::create_dir_all(directory).map_err(|error| cannot("written", directory, &error))?;
        }
        let mut canvas = drawn.sketch.finish();
        drawn.plotter.undrawn().for_each(|(from, to)| canvas.add(Layer::Undrawn, [from, to]));
        if let Some(drawing) = &drawing {
            canvas.remove(Layer::Desired);
            canvas.add_drawing(Layer::Desired, drawing.ops.iter().copied());
        }
        let travel = if self.travel { Visibility::Shown } else { Visibility::Hidden };
        let style = CanvasStyle { travel, longest_px: self.size, ..canvas.comparing_style() };
        let mut write = |path: &Path, bytes: &[u8]| -> Result<(), String> {
            std::fs::write(path, bytes).map_err(|error| cannot("written", path, &error))?;
            say(out, &format!("wrote {}", path.display()));
            Ok(())
        };
        for path in svgs {
            write(&path, canvas.to_svg(&style).as_bytes())?;
        }
        #[cfg(feature = "image")]
        for path in pngs {
            write(&path, &canvas.to_png(&style).map_err(|error| error.to_string())?)?;
        }
        #[cfg(not(feature = "image"))]
        if self.png.is_some() && !pngs.is_empty() {
            return Err(String::from("--png: this program was built without the feature image"));
        }
        let title = self.log.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        for path in charts {
            write(&path, Chart::response(&title, &drawn.plotter).to_svg().as_bytes())?;
        }
        if let Some(page) = drawn.page.take() {
            let html = page.finish(&title, &drawn.contents.header, drawn.contents.summary);
            for path in pages {
                write(&path, html.as_bytes())?;
            }
        }
        if let Some(words) = &drawn.begins {
            say(out, words);
        }
        if !drawn.drew {
            say(out, "nothing was drawn");
        }
        say_damage(out, &drawn.contents);
        let has_errors = drawing.is_some_and(|drawing| drawing.errors > 0);
        Ok(if has_errors { Verdict::Found } else { Verdict::of(drawn.contents.summary) })
    }

    /// Reads the log once, for everything that is wanted of it.
    fn read(
        &self,
        drawing: Option<&Drawing>,
        is_charted: bool,
        has_page: bool,
        has_picture: bool,
    ) -> Result<Drawn, String> {
        let beginning = beginning(&self.log, self.origin)?;
        let mut plotter = VirtualPlotter::new(beginning.settings);
        let settings = *plotter.settings();
        let page_settings = PageSettings { mark_mm: self.mark_mm, ..PageSettings::default() };
        let mut page = has_page.then(|| RecordingPage::new(settings, page_settings));
        if let Some(drawing) = drawing {
            plotter = plotter.with_drawing(drawing.ops.iter().copied());
            page = page.map(|page| page.with_drawing(&drawing.ops));
        }
        let mut sketch = Sketch::new(settings, CanvasStyle::default().tolerance_mm).marking(self.mark_mm);
        let mut drew = false;
        let mut hand_on = |legs: &[Leg], sketch: &mut Sketch| {
            drew |= legs.iter().any(|leg| leg.pen == Pen::Down && leg.points.len() > 1);
            // Without a picture there is no need to keep its lines.
            if has_picture {
                legs.iter().for_each(|leg| sketch.add(leg));
            }
        };
        let mut records = 0_u64;
        let contents = read_all(&self.log, |item| match item {
            Ok(record) => {
                if let Some(page) = &mut page {
                    page.push(record);
                }
                plotter.push(record);
                records = records.saturating_add(1);
                // The chart needs every point; without one there is no need to keep them.
                if !is_charted && records.is_multiple_of(HAND_ON_AFTER) {
                    hand_on(&plotter.take_noted().legs, &mut sketch);
                }
            }
            Err(damage) => {
                if let Some(page) = &mut page {
                    page.damage(damage);
                }
            }
        })?;
        plotter.finish();
        hand_on(plotter.legs(), &mut sketch);
        Ok(Drawn { plotter, page, sketch, contents, drew, begins: beginning.words })
    }
}

/// Files and figures made of a log.
struct Drawn {
    plotter: VirtualPlotter,
    page: Option<RecordingPage>,
    sketch: Sketch,
    contents: Contents,
    drew: bool,
    /// Where it begins, if that is not the origin.
    begins: Option<String>,
}

/// A drawing, and how much of it could not be read.
struct Drawing {
    ops: Vec<PlotOp>,
    errors: u64,
}

fn read_drawing(path: &Path, out: &mut impl Write) -> Result<Drawing, String> {
    let file = DrawingFile::open(path)?;
    let (mut ops, mut first, mut errors) = (Vec::new(), Vec::new(), 0_u64);
    for item in file.ops(USUAL_COUNTS_PER_MM)? {
        match item {
            Ok(_) if ops.len() >= MOST_OPS => {
                return Err(format!("{}: more than {MOST_OPS} operations", path.display()));
            }
            Ok(op) => ops.push(op),
            Err(error) => {
                errors = errors.saturating_add(1);
                if first.len() < 20 {
                    first.push(error);
                }
            }
        }
    }
    if errors > 0 {
        say(out, &format!("{}: {errors} errors, left out", path.display()));
        say_first(out, &first, errors);
    }
    Ok(Drawing { ops, errors })
}

fn length(text: &str) -> Result<f64, String> {
    let mm: f64 = text.parse().map_err(|_| String::from("expected a number of mm"))?;
    if mm > 0.0 && mm <= 1_000.0 {
        Ok(mm)
    } else {
        Err(String::from("expected a length above 0 and up to 1000 mm"))
    }
}
