//! A camera that follows the lines of a drawing larger than what it sees, and a torch that goes with it.
//!
//! A picture lies under a simulated camera that blurs, on a simulated table that misses. Window by window the line follower says
//! where to go: the published one with its circles and its same hand, or ours with its map. Each move goes through the machine's
//! planner to timed steps; the table adds its errors. At the end the path that the tool really took is compared with the drawing.
//!
//! Look at the path over the drawing, and try the published method on the same figure: it cuts sharp corners, turns round in them, and
//! never knows that it is done.
//!
//! With `--from` the windows come from a camera, or from a folder with pictures, and the moves are printed for the machine.
//!
//! ```text
//! cargo run --release --example follow -- --svg follow.svg
//! cargo run --release --example follow -- drawing.png --table-error 1 --animation follow.gif
//! cargo run --release --example follow -- drawing.png --method published --hand left --report follow.json
//! cargo run --release --features camera --example follow -- --from /dev/video0 --correction camera.json --moves moves.gcode
//! ```

use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::follow::{
    FollowFrame, FollowGif, FollowMachine, FollowOutcome, MovesFile, WindowSource, follow_page, follow_svg,
};
use plotter_examples::shared::{at, print, read_file, run, write_file};
use plotter_motion::{Machine, config::MachineKind};
use plotter_vector::follow::{
    CameraSettings, Correction, End, Hand, Lens, LineFollower, MappingFollower, MappingSettings, Paper,
    PublishedFollower, PublishedSettings, SimulatedCamera, SimulatedTable, Step, TableError, Tool, judge,
};
use plotter_vector::{Gray, PxPoint, Vectorizer, decode, stroke::Bounded};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The machine, where no other is given.
const MACHINE: &str = include_str!("machines/plasma-follower.toml");

/// Windows after which the published follower is stopped.
const PUBLISHED_WINDOWS: u64 = 400;

/// Windows after which ours is stopped: a sheet of 10,000 x 5,000 px full of lines needs fewer.
const WINDOWS: u64 = 2_000_000;

/// Farther than this the true lines are not from the middle of the picture's lines, px: less than what the tool is off.
const TRUTH_PX: f64 = 0.1;

/// Fewest pixels of a window a side.
const LEAST_SIDE_PX: f64 = MappingFollower::LEAST_WINDOW_PX as f64;

/// What helps where the machine reaches none of the lines.
const REACH_REMEDY: &str =
    "all that were seen lie outside of the machine's area; a smaller --mm-per-px or another --start may help";

/// Follows the lines of a picture with a simulated camera on a simulated table, or what a real camera sees.
#[derive(Debug, Parser)]
#[command(
    name = "follow",
    after_help = "Examples:\n  \
                  follow --svg follow.svg\n  \
                  follow drawing.png --table-error 1 --play 3 --animation follow.gif\n  \
                  follow drawing.png --camera blur=2,noise=8,rim=0.5,barrel=0.03,size=240 --correction camera.json\n  \
                  follow drawing.png --method published --hand left --report follow.json\n  \
                  follow --from pictures/ --moves moves.csv\n\n\
                  Exit status: 0 followed to the end, or the published method, which never ends by itself, until it was stopped; \
                  1 no line, lost on the way, the pictures of --from are at their end, a camera that gives none, or a file that cannot be read; 2 wrong options. \
                  Files are written as far as it came."
)]
struct Arguments {
    /// Picture with dark lines on light paper: PNG, JPEG, TIFF, PBM or PGM [default: a drawing of its own]
    #[arg(conflicts_with = "from")]
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
    /// On which hand the published follower turns off [default: right]; ours goes straight on, and takes no hand
    #[arg(long, value_enum)]
    hand: Option<Side>,
    /// Where the camera stands at first, px [default: the middle of the picture, or of the machine]
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
    /// The lens' correction, as `calibrate_camera` writes it
    #[arg(long, value_name = "F.json")]
    correction: Option<PathBuf>,
    /// Takes the windows from a camera (built with --features camera), or from a folder's pictures in the order of their names
    #[arg(long, value_name = "/dev/videoN|FOLDER", conflicts_with_all = ["camera", "table_error", "play", "seed"])]
    from: Option<PathBuf>,
    /// With --from: side of the square cut out of each picture's middle, px [default: the shorter side]
    #[arg(long, value_name = "PX", requires = "from", value_parser = clap::value_parser!(u32).range(16..=4096))]
    window: Option<u32>,
    /// With --from a camera: pause after each move, until the machine stands still, ms
    #[arg(long, value_name = "MS", default_value = "100", value_parser = clap::value_parser!(u32).range(0..=60_000))]
    settle_ms: u32,
    /// Writes the moves as they come: a table as .csv, otherwise G-code [default with --from: a table on the standard output]
    #[arg(long, value_name = "F.csv|F.gcode")]
    moves: Option<PathBuf>,
    /// Writes the path over the drawing, with the windows
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    /// Writes what the camera did and saw: an animated picture, or a page that plays it
    #[arg(long, value_name = "F.gif|F.html")]
    animation: Option<PathBuf>,
    /// Writes the figures and the path as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Circles around the current place, always the same hand
    Published,
    /// As published, but only exits count that ink joins to the current place
    Connected,
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
                let side = number(value, LEAST_SIDE_PX..=2000.0).map_err(said)? as u32;
                (camera.width_px, camera.height_px) = (side, side);
            }
            other => return Err(format!("{other:?} is none of blur, noise, rim, barrel, size")),
        }
    }
    Ok(Box::new(camera))
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let is_animation =
        |path: &&Path| path.extension().is_some_and(|ending| ending == "gif" || ending == "html");
    if let Some(path) = arguments.animation.as_deref().filter(|path| !is_animation(path)) {
        eprintln!(
            "follow: {}: the animation is a picture or a page: name it F.gif or F.html",
            path.display()
        );
        return ExitCode::from(2);
    }
    // The library of options would let it pass beside an image.
    if arguments.window.is_some() && arguments.from.is_none() {
        eprintln!("follow: --window is for --from; the simulated camera's is --camera size=PX");
        return ExitCode::from(2);
    }
    if arguments.hand.is_some() && arguments.method == Method::Ours {
        eprintln!(
            "follow: --hand is for the published method: ours goes straight on at crossings, and takes every branch"
        );
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

/// What lies under the camera, where that is known.
struct Sheet {
    picture: Gray,
    /// The middles of its lines.
    truth: Vec<Vec<PxPoint>>,
}

/// Where windows come from.
enum Eyes {
    Simulated(Box<SimulatedCamera>),
    Real(WindowSource),
}

/// Either follower, with its correction of the lens.
enum Follower {
    Ours(Box<MappingFollower>),
    Published(PublishedFollower, Option<Box<Correction>>),
}

impl Follower {
    fn new(arguments: &Arguments, area: [PxPoint; 2], correction: Option<Correction>) -> Self {
        if arguments.method == Method::Ours {
            return Self::Ours(Box::new(MappingFollower::new(MappingSettings {
                area: Some(area),
                max_windows: arguments.windows.unwrap_or(WINDOWS),
                correction,
                ..MappingSettings::default()
            })));
        }
        let settings = PublishedSettings {
            hand: if arguments.hand == Some(Side::Left) { Hand::Left } else { Hand::Right },
            only_connected: arguments.method == Method::Connected,
            area: Some(area),
            ..PublishedSettings::for_lines(arguments.thinnest)
        };
        Self::Published(PublishedFollower::new(settings), correction.map(Box::new))
    }

    fn observe(&mut self, window: &Gray, pose: PxPoint) -> Step {
        match self {
            Self::Ours(follower) => follower.observe(window, pose),
            Self::Published(follower, Some(correction)) => {
                follower.observe(&correction.corrected(window), pose)
            }
            Self::Published(follower, None) => follower.observe(window, pose),
        }
    }
}

fn follow(arguments: &Arguments) -> Result<(), String> {
    let name = match (&arguments.from, &arguments.image) {
        (Some(path), _) | (None, Some(path)) => path.display().to_string(),
        (None, None) => "the built-in drawing".into(),
    };
    let sheet = if arguments.from.is_none() { Some(sheet(arguments, &name)?) } else { None };
    let size = sheet.as_ref().map(|sheet| [sheet.picture.width(), sheet.picture.height()].map(f64::from));
    let mut machine = FollowMachine::new(&machine(arguments)?, arguments.mm_per_px, size, arguments.start)?;
    let correction = correction(arguments)?;

    let camera = CameraSettings { seed: arguments.seed, ..*arguments.camera };
    let mut eyes = match (&arguments.from, &sheet) {
        (None, Some(sheet)) => {
            Eyes::Simulated(Box::new(SimulatedCamera::new(&Paper::of(&sheet.picture), camera)))
        }
        (from, _) => {
            Eyes::Real(WindowSource::open(from.as_deref().unwrap_or(Path::new("")), arguments.window)?)
        }
    };
    let random_px = if sheet.is_some() { arguments.table_error } else { 0.0 };
    let play_px = arguments.play.unwrap_or(3.0 * random_px);
    let mut table =
        SimulatedTable::new(machine.at(), TableError { random_px, play_px, seed: arguments.seed });
    let area = machine.area();
    let corrected_px = correction.as_ref().map(Correction::size_px);
    let mut follower = Follower::new(arguments, area, correction);
    let mut moves_file = match (&arguments.moves, &eyes) {
        (None, Eyes::Simulated(_)) => None,
        (path, _) => Some(MovesFile::new(path.as_deref())?),
    };
    let settle_s = 1e-3 * f64::from(arguments.settle_ms);
    if let Some(file) = &mut moves_file {
        file.push(&machine, &[machine.at()], Tool::Up)?;
    }
    if let Eyes::Real(source) = &eyes {
        source.wait(machine.now_s() + settle_s);
    }
    let most = match &follower {
        Follower::Ours(_) => u64::MAX, // it knows itself
        Follower::Published(..) => arguments.windows.unwrap_or(PUBLISHED_WINDOWS),
    };

    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("following: {pos} windows, {elapsed}") {
        bar.set_style(style);
    }
    let is_gif = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "gif");
    let mut film = arguments.animation.as_ref().filter(|path| is_gif(path)).map(|_| FollowGif::default());
    let (mut windows, mut moves, mut lost) = (0_u64, 0_u64, 0_u64);
    let mut frames: Vec<FollowFrame> = Vec::new();
    let mut window_px = camera.width_px;
    let end = loop {
        if windows >= most {
            break Ended::Stopped;
        }
        let window = match &mut eyes {
            Eyes::Simulated(camera) => camera.window(table.place()),
            Eyes::Real(source) => match source.next_window() {
                Ok(Some(window)) => window,
                Ok(None) => break Ended::NoMorePictures(table.commanded()),
                Err(error) => break Ended::Failed(error),
            },
        };
        window_px = window.width();
        if let Some((width, height)) = corrected_px.filter(|size| *size != (window.width(), window.height()))
        {
            break Ended::Failed(format!(
                "the correction is for windows of {width} x {height} px, this one has {} x {}: calibrate with such windows",
                window.width(),
                window.height()
            ));
        }
        if let Some(film) = &mut film {
            film.see(&window, frames.len());
        }
        windows += 1;
        bar.set_position(windows);
        match follower.observe(&window, table.commanded()) {
            Step::Move { path, tool } => {
                moves += 1;
                if let Some(file) = &mut moves_file {
                    file.push(&machine, &path, tool)?;
                }
                let seconds = machine.make(&path, tool, &mut |to, tool| {
                    table.go(to, tool);
                    frames.push(FollowFrame { at: table.place(), tool });
                })?;
                if let Eyes::Real(source) = &eyes {
                    source.wait(seconds + settle_s);
                }
            }
            Step::LineLost { .. } => lost += 1,
            Step::Done(end) => break Ended::Said(end),
        }
    };
    bar.finish_and_clear();
    let map = if let Follower::Ours(ours) = &follower { Some(ours.report()) } else { None };
    let reached_none = map.as_ref().is_some_and(|map| map.followed_px == 0.0);
    let end = if end == Ended::Said(End::Complete) && reached_none { Ended::OutOfReach } else { end };
    if let Some(file) = moves_file {
        file.finish()?;
    }
    let outcome = FollowOutcome {
        name: &name,
        windows,
        moves,
        lost,
        lifts: table.strokes().len().saturating_sub(1),
        finished: end == Ended::Said(End::Complete),
        said: end.told(windows),
        judged: sheet
            .as_ref()
            .filter(|sheet| !sheet.truth.is_empty())
            .map(|sheet| judge(&sheet.truth, table.strokes(), 2.0)),
        map,
        motion: machine.finish()?,
    };
    write_files(arguments, sheet, table.strokes(), (&frames, film), window_px, &outcome)?;
    if arguments.from.is_none() || arguments.moves.is_some() {
        print(&outcome.table())?;
    } else {
        eprint!("{}", outcome.table());
    }
    match end {
        Ended::Said(End::Complete) | Ended::Stopped => Ok(()),
        _ => Err(format!("{name}: {}", outcome.said)),
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
enum Ended {
    Said(End),
    /// All lines that were seen lie outside of the machine's area.
    OutOfReach,
    /// After as many windows as were allowed.
    Stopped,
    /// The folder has no more.
    NoMorePictures(PxPoint),
    /// The camera, or a picture.
    Failed(String),
}

impl Ended {
    fn told(&self, windows: u64) -> String {
        match self {
            Self::Said(end) => end.to_string(),
            Self::OutOfReach => format!("no line can be reached: {REACH_REMEDY}"),
            Self::Stopped => format!("stopped after {windows} windows; it never ends by itself"),
            Self::NoMorePictures(at) => {
                format!(
                    "no more pictures after {windows}; lines may be left; stopped at ({:.1}, {:.1}) px",
                    at.x, at.y
                )
            }
            Self::Failed(error) => error.clone(),
        }
    }
}

fn sheet(arguments: &Arguments, name: &str) -> Result<Sheet, String> {
    let picture = match &arguments.image {
        Some(path) => decode(&read_file(path)?).map_err(|error| at(path, &error))?,
        None => built_in()?.picture().map_err(|error| error.to_string())?,
    };
    let vectorizer = Vectorizer { ours: Bounded { tolerance_px: TRUTH_PX }, ..Vectorizer::default() };
    let traced = vectorizer.vectorize(&picture).map_err(|error| format!("{name}: {error}"))?;
    let truth = traced.drawing.chords(0.05).strokes().map(<[PxPoint]>::to_vec).collect();
    Ok(Sheet { picture, truth })
}

fn machine(arguments: &Arguments) -> Result<Machine, String> {
    let (text, named) = match &arguments.machine {
        Some(path) => {
            (String::from_utf8(read_file(path)?).map_err(|error| at(path, &error))?, path.as_path())
        }
        None => (MACHINE.to_owned(), Path::new("machines/plasma-follower.toml")),
    };
    let machine = Machine::from_toml(&text).map_err(|error| at(named, &error))?;
    machine.require(MachineKind::Steppers, "follow").map_err(|error| at(named, &error))?;
    Ok(machine)
}

fn correction(arguments: &Arguments) -> Result<Option<Correction>, String> {
    let Some(path) = &arguments.correction else { return Ok(None) };
    let correction = serde_json::from_slice(&read_file(path)?)
        .map_err(|error| at(path, &format!("is no correction of calibrate_camera: {error}")))?;
    Ok(Some(correction))
}

fn write_files(
    arguments: &Arguments,
    sheet: Option<Sheet>,
    strokes: &[Vec<PxPoint>],
    (frames, film): (&[FollowFrame], Option<FollowGif>),
    window_px: u32,
    outcome: &FollowOutcome<'_>,
) -> Result<(), String> {
    // Without the drawing: white paper, as large as the way and its windows.
    let picture = match sheet {
        Some(sheet) => sheet.picture,
        None => {
            let far = |part: fn(&FollowFrame) -> f64| frames.iter().map(part).fold(0.0, f64::max);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let side = |px: f64| (px + f64::from(window_px)).clamp(1.0, 8192.0) as u32;
            let (width, height) = (side(far(|frame| frame.at.x)), side(far(|frame| frame.at.y)));
            let levels = vec![u8::MAX; width as usize * height as usize];
            Gray::new(width, height, levels).map_err(|error| error.to_string())?
        }
    };
    if let Some(path) = &arguments.svg {
        write_file(path, follow_svg(&picture, strokes, frames, window_px)?)?;
    }
    if let Some(path) = &arguments.animation {
        match film {
            Some(film) => {
                let gif = film.encode(&picture, frames, window_px).map_err(|error| at(path, &error))?;
                write_file(path, gif)?;
            }
            None => write_file(path, follow_page(&picture, frames, window_px, &outcome.table())?)?,
        }
    }
    if let Some(path) = &arguments.report {
        write_file(path, outcome.json(strokes)?)?;
    }
    Ok(())
}
