//! The command line of `follow`.

use super::course::follow;
use super::led::Led;
use crate::shared::{ExitStatus, Telling, run};
use clap::{Parser, ValueEnum};
use plotter_replay::cli::free_log;
use plotter_vector::follow::{CameraSettings, Lens, MappingFollower};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Windows after which the published follower is stopped.
pub(super) const PUBLISHED_WINDOWS: u64 = 400;

/// Windows after which ours is stopped: a sheet of 10,000 x 5,000 px full of lines needs fewer.
pub(super) const WINDOWS: u64 = 2_000_000;

/// Fewest pixels of a window a side.
const LEAST_SIDE_PX: f64 = MappingFollower::LEAST_WINDOW_PX as f64;

/// Follows the lines of a picture with a simulated camera on a simulated table, or what a real camera sees;
/// on paper, or with a real machine.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    name = "follow",
    after_help = "Examples:\n  \
                  plotter follow --svg follow.svg\n  \
                  plotter follow drawing.png --table-error 1 --play 3 --animation follow.gif\n  \
                  plotter follow drawing.png --camera blur=2,noise=8,rim=0.5,barrel=0.03,size=240 --correction camera.json\n  \
                  plotter follow drawing.png --method published --hand left --report follow.json\n  \
                  plotter follow --from pictures/ --moves moves.csv\n  \
                  plotter follow --live /dev/ttyUSB0 --machine mine.toml --from /dev/video0 --draw\n  \
                  plotter follow drawing.png --live tcp:127.0.0.1:7000 --protocol grbl\n\n\
                  Exit status: 0 followed to the end, or the published method, which never ends by itself, until it was stopped; \
                  1 no line, lost on the way, the pictures of --from are at their end, a camera that gives none, a machine that does not answer or was \
                  stopped, or a file that cannot be read; 2 wrong options. \
                  Files are written as far as it came.\n\n\
                  In a checkout of the project, `cargo run --release --example follow --` stands for `plotter follow`."
)]
pub struct FollowCommand {
    /// Picture of lines: PNG, JPEG, TIFF, WebP, BMP, GIF, PBM, PGM or PPM [default: a drawing of its own]
    #[arg(conflicts_with = "from")]
    pub(super) image: Option<PathBuf>,
    /// Which follower
    #[arg(long, value_enum, default_value = "ours")]
    pub(super) method: Method,
    /// What is wrong with the camera: blur (px), noise (levels), rim (share of light at the corners), barrel
    /// (of the lens), size (px)
    #[arg(long, value_name = "K=V,..", value_parser = camera, default_value = "blur=1.5,noise=4,rim=0.6,barrel=0,size=300")]
    pub(super) camera: Box<CameraSettings>,
    /// Standard deviation of the table's error over 150 px of way, px
    #[arg(long, value_name = "PX", value_parser = error_px, default_value = "0", allow_negative_numbers = true)]
    pub(super) table_error: f64,
    /// What each axis of the table loses where it turns round, px [default: 3 times the table's error]
    #[arg(long, value_name = "PX", value_parser = error_px, allow_negative_numbers = true)]
    pub(super) play: Option<f64>,
    /// On which hand the published follower turns off [default: right]; ours goes straight on, and takes no
    /// hand
    #[arg(long, value_enum)]
    pub(super) hand: Option<Side>,
    /// Where the camera stands at first, px [default: the middle of the picture, or of the machine]
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    pub(super) start: Option<[f64; 2]>,
    /// The thinnest line, px, which the published follower must be told
    #[arg(long, value_name = "PX", default_value = "4", value_parser = clap::value_parser!(u32).range(1..=100))]
    pub(super) thinnest: u32,
    /// Most windows [default: eight times what the picture's lines need, with --from 2000000, for the published
    /// follower 400]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(super) windows: Option<u64>,
    /// Size of a camera's pixel on the paper, mm [default: as the picture's file says, if a scanner may have
    /// written it, else 0.1]
    #[arg(long, value_name = "MM", value_parser = pixel_mm)]
    pub(super) mm_per_px: Option<f64>,
    /// Of a TIFF with several pictures, which; 1 is the first
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) page: u32,
    /// The machine's TOML file [default: machines/plasma-follower.toml]
    #[arg(long, value_name = "FILE")]
    pub(super) machine: Option<PathBuf>,
    /// Of the camera's noise and the table's errors
    #[arg(long, value_name = "N", default_value = "1")]
    pub(super) seed: u64,
    /// The lens' correction, as `calibrate_camera` writes it
    #[arg(long, value_name = "F.json")]
    pub(super) correction: Option<PathBuf>,
    /// Takes the windows from a camera (built with --features camera), or from a folder's pictures in the
    /// order of their names
    #[arg(long, value_name = "/dev/videoN|FOLDER", conflicts_with_all = ["camera", "table_error", "play", "seed"])]
    pub(super) from: Option<PathBuf>,
    /// With --from: side of the square cut out of each picture's middle, px [default: the shorter side]
    #[arg(long, value_name = "PX", requires = "from", value_parser = clap::value_parser!(u32).range(16..=4096))]
    pub(super) window: Option<u32>,
    /// With --from a camera: pause after each move, until the machine stands still, ms; with --live after it
    /// says to be there
    #[arg(long, value_name = "MS", default_value = "100", value_parser = clap::value_parser!(u32).range(0..=60_000))]
    pub(super) settle_ms: u32,
    /// Leads a real machine, whose tool is lifted; the next window is taken when it says that it is there. A
    /// serial port, tcp:HOST:PORT, or `simulated` for a machine in this program (built with --features live).
    /// Windows are those of --from, whose folder is then waited for: 0.png, 1.png, .. as the moves are
    /// numbered; without it they are cut out of the picture where the machine says to be. Ctrl-C stops it
    #[arg(long, value_name = "PORT", conflicts_with_all = ["table_error", "play"])]
    pub(super) live: Option<String>,
    /// With --live: then draws, or cuts, the lines that were followed, half the kerf of the machine's file
    /// beside them
    #[arg(long, requires = "live")]
    pub(super) draw: bool,
    /// With --live: what the machine speaks: grbl, marlin, mdraw, hpgl, ebb, eggbot [default: found out]
    #[arg(long, value_name = "LANGUAGE", default_value = "auto", hide_default_value = true)]
    pub(super) protocol: String,
    /// With --live simulated: seconds of the machine in one of ours, at most
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = speed)]
    pub(super) speed: f64,
    /// With --live: the recording of the machine's line [default: follow.plog, or the first of follow-2.plog,
    /// follow-3.plog, ... that is not there]
    #[arg(long, value_name = "F.plog", default_value_os_t = free_log("follow"), hide_default_value = true)]
    pub(super) log: PathBuf,
    /// With --live and --from a folder: how long each picture is waited for, s
    #[arg(long, value_name = "S", default_value = "60", value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub(super) picture_s: u32,
    /// Writes the moves as they come: a table as .csv, otherwise G-code [default with --from: a table on the
    /// standard output]
    #[arg(long, value_name = "F.csv|F.gcode")]
    pub(super) moves: Option<PathBuf>,
    /// Writes the path over the drawing, with the windows
    #[arg(long, value_name = "F.svg")]
    pub(super) svg: Option<PathBuf>,
    /// Writes what the camera did and saw: an animated picture, or a page that plays it
    #[arg(long, value_name = "F.gif|F.html")]
    pub(super) animation: Option<PathBuf>,
    /// Writes the figures and the path as JSON
    #[arg(long, value_name = "F.json")]
    pub(super) report: Option<PathBuf>,
    #[command(flatten)]
    pub(super) telling: Telling,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Method {
    /// Circles around the current place, always the same hand
    Published,
    /// As published, but only exits count that ink joins to the current place
    Connected,
    /// A map of the lines, each followed once
    Ours,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Side {
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

fn speed(text: &str) -> Result<f64, String> {
    number(text, 0.01..=1e6)
}

fn pixel_mm(text: &str) -> Result<f64, String> {
    number(text, 0.001..=10.0)
}

pub(super) fn place(text: &str) -> Result<[f64; 2], String> {
    let (x, y) = text.split_once(',').ok_or("give X,Y")?;
    Ok([number(x, -1e5..=1e5)?, number(y, -1e5..=1e5)?])
}

pub(super) fn camera(text: &str) -> Result<Box<CameraSettings>, String> {
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

impl FollowCommand {
    /// Runs the command; its help has the table of exit codes.
    #[must_use]
    pub fn run(self) -> ExitCode {
        let arguments = self;
        let is_animation =
            |path: &&Path| path.extension().is_some_and(|ending| ending == "gif" || ending == "html");
        if let Some(path) = arguments.animation.as_deref().filter(|path| !is_animation(path)) {
            eprintln!(
                "follow: {}: the animation is a picture or a page: name it F.gif or F.html",
                path.display()
            );
            return ExitStatus::WrongUse.into();
        }
        // The library of options would let it pass beside an image.
        if arguments.window.is_some() && arguments.from.is_none() {
            eprintln!("follow: --window is for --from; the simulated camera's is --camera size=PX");
            return ExitStatus::WrongUse.into();
        }
        if let Some(why) = arguments.live.as_ref().and_then(|_| Led::misused(&arguments)) {
            eprintln!("follow: {why}");
            return ExitStatus::WrongUse.into();
        }
        if arguments.hand.is_some() && arguments.method == Method::Ours {
            eprintln!(
                "follow: --hand is for the published method: ours goes straight on at crossings, and takes every branch"
            );
        }
        run("follow", || follow(&arguments))
    }
}
