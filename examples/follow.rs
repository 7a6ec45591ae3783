//! A camera that follows the lines of a drawing larger than what it sees, and a torch that goes with it.
//!
//! A picture lies under a simulated camera that blurs, on a simulated table that misses. Window by window the line follower says
//! where to go: the published one with its circles and its same hand, or ours with its map. Its moves go through the machine's
//! planner to timed steps; the table adds its errors. At the end the path that the tool really took is compared with the drawing.
//!
//! Look at the path over the drawing, and try the published method on the same figure: it cuts sharp corners, turns round in them, and
//! never knows that it is done.
//!
//! ```text
//! cargo run --release --example follow -- --svg follow.svg
//! cargo run --release --example follow -- drawing.png --table-error 1 --animation follow.html
//! cargo run --release --example follow -- drawing.png --method published --hand left --report follow.json
//! ```

use base64::Engine as _;
use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::{SteppedFigures, SteppedPlot, at, print, read_file, run, write_file};
use plotter_motion::kinematics::MotorScale;
use plotter_motion::{Machine, PlannerSettings, PlotOp, Point, StepGenSettings};
use plotter_vector::follow::{
    CameraSettings, FollowReport, Hand, Judged, Lens, LineFollower, MappingFollower, MappingSettings, Paper,
    PublishedFollower, PublishedSettings, SimulatedCamera, SimulatedTable, Step, TableError, Tool, judge,
};
use plotter_vector::{Gray, PxPoint, Vectorizer, decode};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The machine, where no other is given.
const MACHINE: &str = include_str!("machines/plasma-follower.toml");

/// Windows without anything new, after which the published follower is stopped.
const PUBLISHED_WINDOWS: u64 = 400;

/// Follows the lines of a picture with a simulated camera on a simulated table.
#[derive(Debug, Parser)]
#[command(
    name = "follow",
    after_help = "Examples:\n  \
                  follow --svg follow.svg\n  \
                  follow drawing.png --table-error 1 --play 3 --animation follow.html\n  \
                  follow drawing.png --camera blur=2,noise=8,rim=0.5,barrel=0.03,size=240\n  \
                  follow drawing.png --method published --hand left --report follow.json\n\n\
                  Exit status: 0 followed to the end; 1 no line, lost on the way, or a file that cannot be read; 2 wrong options. \
                  The published method never ends by itself: it is stopped after --windows."
)]
struct Arguments {
    /// Picture with dark lines on light paper: PNG, JPEG, TIFF, PBM or PGM [default: a drawing of its own]
    image: Option<PathBuf>,
    /// Which follower
    #[arg(long, value_enum, default_value = "ours")]
    method: Method,
    /// What is wrong with the camera: blur (px), noise (levels), rim (share of light at the corners), barrel (of the lens), size (px)
    #[arg(long, value_name = "K=V,..", value_parser = camera, default_value = "blur=1.5,noise=4,rim=0.6,barrel=0,size=300")]
    camera: Box<CameraSettings>,
    /// Standard deviation of the table's error over 150 px of way, px
    #[arg(long, value_name = "PX", value_parser = error_px, default_value = "0", allow_negative_numbers = true)]
    table_error: f64,
    /// What each axis of the table loses where it turns round, px [default: 3 times the table's error]
    #[arg(long, value_name = "PX", value_parser = error_px, allow_negative_numbers = true)]
    play: Option<f64>,
    /// On which hand the published follower turns off
    #[arg(long, value_enum, default_value = "right")]
    hand: Side,
    /// Where the camera stands at first, px [default: the middle of the picture]
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    start: Option<[f64; 2]>,
    /// The thinnest line, px, which the published follower must be told
    #[arg(long, value_name = "PX", default_value = "4", value_parser = clap::value_parser!(u32).range(1..=100))]
    thinnest: u32,
    /// Most windows [default: 2000000, for the published follower 400]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    windows: Option<u64>,
    /// Size of a camera's pixel on the paper, mm
    #[arg(long, value_name = "MM", value_parser = pixel_mm, default_value = "0.1")]
    mm_per_px: f64,
    /// The machine's TOML file [default: machines/plasma-follower.toml]
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// Of the camera's noise and the table's errors
    #[arg(long, value_name = "N", default_value = "1")]
    seed: u64,
    /// Writes the path over the drawing, with the windows
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    /// Writes a page that plays what the camera did
    #[arg(long, value_name = "F.html")]
    animation: Option<PathBuf>,
    /// Writes the figures and the path as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Circles around the current place, always the same hand
    Published,
    /// A map of the lines, each followed once
    Ours,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Side {
    Left,
    Right,
}

fn number(text: &str, range: std::ops::RangeInclusive<f64>) -> Result<f64, String> {
    let number: f64 = text.trim().parse().map_err(|_| format!("{text:?} is no number"))?;
    let (low, high) = (range.start(), range.end());
    if range.contains(&number) { Ok(number) } else { Err(format!("{number} is not from {low} to {high}")) }
}

fn error_px(text: &str) -> Result<f64, String> {
    number(text, 0.0..=30.0)
}

fn pixel_mm(text: &str) -> Result<f64, String> {
    number(text, 0.001..=10.0)
}

fn place(text: &str) -> Result<[f64; 2], String> {
    let (x, y) = text.split_once(',').ok_or("give X,Y")?;
    Ok([number(x, -1e5..=1e5)?, number(y, -1e5..=1e5)?])
}

fn camera(text: &str) -> Result<Box<CameraSettings>, String> {
    let mut camera = CameraSettings::default();
    for part in text.split(',').filter(|part| !part.trim().is_empty()) {
        let (key, value) = part.split_once('=').ok_or_else(|| format!("{part:?}: give KEY=VALUE"))?;
        let said = |error| format!("{}: {error}", key.trim());
        match key.trim() {
            "blur" => camera.blur_px = number(value, 0.0..=20.0).map_err(said)?,
            "noise" => camera.noise_levels = number(value, 0.0..=100.0).map_err(said)?,
            "rim" => camera.rim_light = number(value, 0.05..=1.0).map_err(said)?,
            "barrel" => camera.lens = Lens { barrel: number(value, -0.3..=0.3).map_err(said)? },
            "size" => {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in range")]
                let side = number(value, 16.0..=2000.0).map_err(said)? as u32;
                (camera.width_px, camera.height_px) = (side, side);
            }
            other => return Err(format!("{other:?} is none of blur, noise, rim, barrel, size")),
        }
    }
    Ok(Box::new(camera))
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if let Some(path) =
        arguments.animation.as_deref().filter(|path| path.extension().is_none_or(|e| e != "html"))
    {
        eprintln!("follow: {}: the animation is a page: name it F.html", path.display());
        return ExitCode::from(2);
    }
    run("follow", || follow(&arguments))
}

/// A drawing with a bit of everything: loops within loops, crossings, sharp tips, hatching.
fn built_in() -> Result<Paper, String> {
    let circle = |x: f64, y: f64, r: f64| -> Vec<PxPoint> {
        let at = |i: i32| f64::from(i) * std::f64::consts::TAU / 120.0;
        (0..=120).map(|i| PxPoint::new(x + r * libm::cos(at(i)), y + r * libm::sin(at(i)))).collect()
    };
    let line = |places: &[(f64, f64)]| places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect::<Vec<_>>();
    let mut strokes = vec![
        (circle(260.0, 260.0, 180.0), 5.0),
        (circle(260.0, 260.0, 110.0), 4.0),
        (circle(310.0, 260.0, 40.0), 3.0),
        (line(&[(40.0, 262.0), (480.0, 255.0)]), 4.0),
        (line(&[(520.0, 90.0), (560.0, 430.0), (610.0, 95.0), (650.0, 425.0), (690.0, 100.0)]), 5.0),
        (line(&[(560.0, 480.0), (820.0, 480.0), (820.0, 620.0), (560.0, 620.0), (560.0, 480.0)]), 5.0),
    ];
    for i in 0..9 {
        let x = 120.0 + 11.0 * f64::from(i);
        strokes.push((line(&[(x, 500.0), (x + 120.0, 640.0)]), 4.0));
    }
    Paper::drawn(880, 700, &strokes).map_err(|error| error.to_string())
}

/// A moment of the run.
struct Frame {
    at: PxPoint,
    tool: Tool,
}

fn follow(arguments: &Arguments) -> Result<(), String> {
    let (picture, name) = match &arguments.image {
        Some(path) => {
            (decode(&read_file(path)?).map_err(|error| at(path, &error))?, path.display().to_string())
        }
        None => (built_in()?.picture().map_err(|error| error.to_string())?, "the built-in drawing".into()),
    };
    let size = [f64::from(picture.width()), f64::from(picture.height())];
    let traced = Vectorizer::default().vectorize(&picture).map_err(|error| format!("{name}: {error}"))?;
    let truth: Vec<Vec<PxPoint>> = traced.drawing.chords(0.05).strokes().map(<[PxPoint]>::to_vec).collect();
    let mut motion = Motion::new(arguments, size)?;

    let settings = CameraSettings { seed: arguments.seed, ..*arguments.camera };
    let mut camera = SimulatedCamera::new(&Paper::of(&picture), settings);
    let play_px = arguments.play.unwrap_or(3.0 * arguments.table_error);
    let error = TableError { random_px: arguments.table_error, play_px, seed: arguments.seed };
    let [x, y] = arguments.start.unwrap_or([0.5 * size[0], 0.5 * size[1]]);
    let start = PxPoint::new(x.clamp(0.0, motion.area_px[0]), y.clamp(0.0, motion.area_px[1]));
    let mut table = SimulatedTable::new(start, error);

    let mut ours = MappingFollower::new(MappingSettings {
        area: Some([PxPoint::new(0.0, 0.0), PxPoint::new(motion.area_px[0], motion.area_px[1])]),
        max_windows: arguments.windows.unwrap_or(2_000_000),
        ..MappingSettings::default()
    });
    let hand = if arguments.hand == Side::Left { Hand::Left } else { Hand::Right };
    let published =
        PublishedSettings { hand, thinnest_px: arguments.thinnest, ..PublishedSettings::default() };
    let mut published = PublishedFollower::new(published);
    let most = arguments.windows.unwrap_or(PUBLISHED_WINDOWS);

    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("following: {pos} windows, {elapsed}") {
        bar.set_style(style);
    }
    let (mut windows, mut moves, mut lost) = (0_u64, 0_u64, 0_u64);
    let mut frames = Vec::new();
    let end = loop {
        let window = camera.window(table.place());
        let step = match arguments.method {
            Method::Ours => ours.observe(&window, table.commanded()),
            Method::Published if windows >= most => break None,
            Method::Published => published.observe(&window, table.commanded()),
        };
        windows += 1;
        bar.set_position(windows);
        match step {
            Step::Move { path, tool } => {
                moves += 1;
                for to in path {
                    motion.go(to, tool)?;
                    table.go(to, tool);
                    frames.push(Frame { at: table.place(), tool });
                }
            }
            Step::LineLost { at, tries, why } => {
                lost += 1;
                if arguments.method == Method::Published && tries > 8 {
                    return Err(format!("{name}: no line in view at ({:.1}, {:.1}) px: {why}", at.x, at.y));
                }
            }
            Step::Done(end) => break Some(end),
        }
    };
    bar.finish_and_clear();
    let judged = judge(&truth, table.strokes(), 2.0);
    let finished = end == Some(plotter_vector::follow::End::Complete);
    let outcome = Outcome {
        name: &name,
        windows,
        moves,
        lost,
        lifts: table.strokes().len().saturating_sub(1),
        finished,
        said: end.map_or_else(
            || format!("stopped after {windows} windows; it never ends by itself"),
            |end| end.to_string(),
        ),
        judged,
        map: (arguments.method == Method::Ours).then(|| ours.report()),
        motion: motion.finish()?,
    };
    if let Some(path) = &arguments.svg {
        write_file(path, svg(&picture, table.strokes(), &frames, settings.width_px)?)?;
    }
    if let Some(path) = &arguments.animation {
        write_file(path, page(&picture, &frames, settings.width_px, &outcome)?)?;
    }
    if let Some(path) = &arguments.report {
        write_file(path, outcome.json(table.strokes())?)?;
    }
    print(&outcome.table())?;
    if finished || end.is_none() { Ok(()) } else { Err(format!("{name}: {}", outcome.said)) }
}

/// The machine that makes the moves: its planner and its steps.
struct Motion {
    plot: SteppedPlot,
    mm_per_px: f64,
    height_px: f64,
    /// What the camera can reach of the picture, px.
    area_px: [f64; 2],
    speed_mm_s: f64,
}

impl Motion {
    fn new(arguments: &Arguments, size: [f64; 2]) -> Result<Self, String> {
        let (text, named) = match &arguments.machine {
            Some(path) => {
                (String::from_utf8(read_file(path)?).map_err(|error| at(path, &error))?, path.as_path())
            }
            None => (MACHINE.to_owned(), Path::new("machines/plasma-follower.toml")),
        };
        let machine = Machine::from_toml(&text).map_err(|error| at(named, &error))?;
        let config = machine.config();
        let motor = |steps_per_mm| MotorScale { steps_per_mm, inverted: false };
        let motors = [motor(config.x.stepper.steps_per_mm), motor(config.y.stepper.steps_per_mm)];
        let finest = motors[0].steps_per_mm.max(motors[1].steps_per_mm);
        let settings = PlannerSettings { resolution_mm: 0.5 / finest, ..PlannerSettings::of(&machine) };
        let reach = [config.area.width_mm, config.area.height_mm].map(|mm| mm / arguments.mm_per_px);
        Ok(Self {
            plot: SteppedPlot::new(settings, StepGenSettings::of(&machine), motors)?,
            mm_per_px: arguments.mm_per_px,
            height_px: size[1].min(reach[1]),
            area_px: [size[0].min(reach[0]), size[1].min(reach[1])],
            speed_mm_s: settings.speed_mm_s,
        })
    }

    fn push(&mut self, op: PlotOp) -> Result<(), String> {
        self.plot.push(op, &mut |_| {}).map_err(|error| format!("the machine cannot do that: {error}"))
    }

    fn go(&mut self, to: PxPoint, tool: Tool) -> Result<(), String> {
        // Millimetres, y up.
        let to = Point { x: to.x * self.mm_per_px, y: (self.height_px - to.y) * self.mm_per_px };
        self.push(match tool {
            Tool::Down => PlotOp::Draw { to, feed_mm_s: Some(self.speed_mm_s) },
            Tool::Up => PlotOp::Travel { to },
        })
    }

    fn finish(self) -> Result<SteppedFigures, String> {
        self.plot.finish(&mut |_| {}).map_err(|error| error.to_string())
    }
}

struct Outcome<'a> {
    name: &'a str,
    windows: u64,
    moves: u64,
    lost: u64,
    lifts: usize,
    finished: bool,
    said: String,
    judged: Judged,
    map: Option<FollowReport>,
    motion: SteppedFigures,
}

impl Outcome<'_> {
    fn table(&self) -> String {
        let judged = &self.judged;
        let mut text = format!(
            "{}: {}\n  windows {}, moves {}, pictures without the line {}, lifts {}\n  covered {:.2} % of {:.0} px of lines, followed twice {:.2} %\n  \
             path {:.0} px, off the middle of the lines: rms {:.2} px, at most {:.2} px at ({:.0}, {:.0})\n  \
             machine: {:.1} s in motion, {} steps\n",
            self.name,
            self.said,
            self.windows,
            self.moves,
            self.lost,
            self.lifts,
            100.0 * judged.coverage,
            judged.true_px,
            100.0 * judged.repeated,
            judged.path_px,
            judged.rms_px,
            judged.max_px,
            judged.worst.x,
            judged.worst.y,
            self.motion.motion_s,
            self.motion.steps,
        );
        if let Some(map) = &self.map {
            let _ = writeln!(
                text,
                "  lines {:.1} px wide; play found: {:.2} and {:.2} px",
                map.line_width_px, map.play_px[0], map.play_px[1]
            );
            for (what, places) in
                [("a line leaves the machine's area", &map.leaves), ("an area of ink, left out", &map.areas)]
            {
                if let Some(first) = places.first() {
                    let _ = writeln!(
                        text,
                        "  {what}: {} times, first at ({:.0}, {:.0})",
                        places.len(),
                        first.x,
                        first.y
                    );
                }
            }
        }
        text
    }

    fn json(&self, strokes: &[Vec<PxPoint>]) -> Result<String, String> {
        let pairs = |stroke: &Vec<PxPoint>| -> Vec<[f64; 2]> {
            stroke.iter().map(|at| [at.x, at.y].map(|v| libm::round(1000.0 * v) / 1000.0)).collect()
        };
        let strokes: Vec<Vec<[f64; 2]>> = strokes.iter().map(pairs).collect();
        let value = serde_json::json!({
            "windows": self.windows,
            "moves": self.moves,
            "lost": self.lost,
            "lifts": self.lifts,
            "finished": self.finished,
            "end": self.said,
            "coverage": self.judged.coverage,
            "repeated": self.judged.repeated,
            "rms_px": self.judged.rms_px,
            "max_px": self.judged.max_px,
            "lines_px": self.judged.true_px,
            "path_px": self.judged.path_px,
            "motion_s": self.motion.motion_s,
            "steps": self.motion.steps,
            "map": self.map,
            "path_points": strokes.concat(),
            "strokes": strokes,
        });
        serde_json::to_string(&value).map(|text| text + "\n").map_err(|error| error.to_string())
    }
}

/// The picture as the source of an image.
fn embedded(picture: &Gray) -> Result<String, String> {
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::GrayImage::from_raw(picture.width(), picture.height(), picture.pixels().to_vec());
    let image = image.ok_or("the picture cannot be held")?;
    image.write_to(&mut png, image::ImageFormat::Png).map_err(|error| error.to_string())?;
    Ok(format!(
        "data:image/png;base64,{}",
        base64::engine::general_purpose::STANDARD.encode(png.into_inner())
    ))
}

fn svg(picture: &Gray, strokes: &[Vec<PxPoint>], frames: &[Frame], window_px: u32) -> Result<String, String> {
    let (width, height) = (picture.width(), picture.height());
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">\n\
         <image href=\"{}\" width=\"{width}\" height=\"{height}\" opacity=\"0.35\"/>\n",
        embedded(picture)?
    );
    let side = f64::from(window_px);
    let mut shown = PxPoint::new(f64::MAX, f64::MAX);
    for frame in frames {
        // As many windows as can be told apart.
        if frame.at.distance(shown) > 0.5 * side {
            shown = frame.at;
            let (left, top) = (shown.x - 0.5 * side, shown.y - 0.5 * side);
            let _ = writeln!(
                text,
                "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{side}\" height=\"{side}\" fill=\"none\" stroke=\"#2a6fb0\" \
                 stroke-opacity=\"0.25\"/>"
            );
        }
    }
    for (i, stroke) in strokes.iter().enumerate() {
        let places: Vec<String> = stroke.iter().map(|at| format!("{:.2},{:.2}", at.x, at.y)).collect();
        let _ = writeln!(
            text,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#d01818\" stroke-width=\"1\" stroke-linejoin=\"round\"/>",
            places.join(" ")
        );
        let next = strokes.get(i + 1).and_then(|next| next.first());
        if let (Some(from), Some(to)) = (stroke.last(), next) {
            let _ = writeln!(
                text,
                "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"#18a018\" stroke-width=\"0.7\" \
                 stroke-dasharray=\"3 3\"/>",
                from.x, from.y, to.x, to.y
            );
        }
    }
    text.push_str("</svg>\n");
    Ok(text)
}

fn page(picture: &Gray, frames: &[Frame], window_px: u32, outcome: &Outcome<'_>) -> Result<String, String> {
    let places: Vec<[f64; 3]> = frames
        .iter()
        .map(|frame| {
            let round = |v: f64| libm::round(10.0 * v) / 10.0;
            [round(frame.at.x), round(frame.at.y), if frame.tool == Tool::Down { 1.0 } else { 0.0 }]
        })
        .collect();
    let places = serde_json::to_string(&places).map_err(|error| error.to_string())?;
    let escaped = outcome.table().replace('&', "&amp;").replace('<', "&lt;");
    Ok(format!(
        r##"<!doctype html><meta charset="utf-8"><title>follow</title>
<style>body{{font:14px sans-serif;margin:1em}}canvas{{max-width:100%;border:1px solid #ccc}}</style>
<canvas id="c" width="{width}" height="{height}"></canvas>
<p><button id="play">pause</button> <input id="t" type="range" min="0" value="0" style="width:60%"></p>
<pre>{escaped}</pre>
<script>
const places={places},side={window_px};
const c=document.getElementById("c"),g=c.getContext("2d"),t=document.getElementById("t"),b=document.getElementById("play");
t.max=places.length;let n=0,on=true;const image=new Image();image.src="{image}";
function draw(){{
  g.clearRect(0,0,c.width,c.height);g.globalAlpha=.4;g.drawImage(image,0,0);g.globalAlpha=1;
  g.lineWidth=1.2;
  for(let i=1;i<n;i++){{g.beginPath();g.strokeStyle=places[i][2]?"#d01818":"#9c9";g.moveTo(places[i-1][0],places[i-1][1]);g.lineTo(places[i][0],places[i][1]);g.stroke();}}
  const p=places[Math.max(0,n-1)];if(p){{g.strokeStyle="#2a6fb0";g.strokeRect(p[0]-side/2,p[1]-side/2,side,side);g.fillStyle="#2a6fb0";g.fillRect(p[0]-2,p[1]-2,4,4);}}
}}
function tick(){{if(on&&n<places.length){{n=Math.min(places.length,n+Math.max(1,places.length/900));n=Math.floor(n);t.value=n;draw();}}requestAnimationFrame(tick);}}
b.onclick=()=>{{if(n>=places.length)n=0;on=!on||n==0;b.textContent=on?"pause":"play";}};
t.oninput=()=>{{n=+t.value;on=false;b.textContent="play";draw();}};
image.onload=()=>{{draw();tick();}};
</script>
"##,
        width = picture.width(),
        height = picture.height(),
        image = embedded(picture)?,
    ))
}
