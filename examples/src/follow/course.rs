//! Window by window, to the end.

use super::command::{FollowCommand, PUBLISHED_WINDOWS};
use super::ended::{Ended, Over};
use super::files::write_files;
use super::follower::{Eyes, Follower};
use super::leader::Leader;
use super::sheet::{MM_PER_PX, Sheet, sheet};
use super::turned::turned;
use crate::follow::{FollowFrame, FollowGif, FollowMachine, FollowOutcome, MovesFile, WindowSource};
use crate::shared::{WorkShown, at, read_file};
use plotter_motion::{Machine, config::MachineKind};
use plotter_vector::{
    Gray, PxPoint,
    follow::{
        Correction, End, FollowerConfig, Paper, SimulatedCamera, SimulatedTable, Step, TableError, Tool,
        judge,
    },
};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The machine, where no other is given.
const MACHINE: &str = include_str!("../../machines/plasma-follower.toml");

/// Follows, and tells what came of it.
pub(super) fn follow(arguments: &FollowCommand) -> Result<(), String> {
    let name = match (&arguments.from, &arguments.image) {
        (Some(path), _) | (None, Some(path)) => path.display().to_string(),
        (None, None) => "the built-in drawing".into(),
    };
    let sheet = if arguments.from.is_none() { Some(sheet(arguments, &name)?) } else { None };
    let mut course = Course::new(arguments, sheet.as_ref())?;
    let end = course.run()?;
    let end = course.draw(end);
    let Course {
        machine, table, follower, moves_file, film, frames, windows, moves, lost, window_px, ..
    } = course;
    let map = if let Follower::Ours(ours) = &follower { Some(ours.report()) } else { None };
    let reached_none = map.as_ref().is_some_and(|map| map.followed_px == 0.0);
    let over = match &sheet {
        None => Over::Unknown,
        Some(sheet) if sheet.truth.is_empty() => Over::Nothing,
        Some(_) => Over::Lines,
    };
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
        said: end.told(windows, over),
        judged: sheet
            .as_ref()
            .filter(|sheet| !sheet.truth.is_empty())
            .map(|sheet| judge(&sheet.truth, table.strokes(), 2.0)),
        told: sheet.as_ref().map(|sheet| sheet.told.clone()).unwrap_or_default(),
        map,
        motion: machine.finish()?,
    };
    write_files(arguments, sheet, table.strokes(), (&frames, film), window_px, &outcome)?;
    let json = || outcome.json(table.strokes());
    if arguments.from.is_none() || arguments.moves.is_some() {
        arguments.telling.tell(&outcome.table(), json)?;
    } else {
        arguments.telling.tell_aside(&outcome.table(), json)?;
    }
    match end {
        Ended::Said(End::Complete) | Ended::Stopped => Ok(()),
        _ => Err(format!("{name}: {}", outcome.said)),
    }
}

/// A run under way: what sees, what decides, what moves, and what was kept of it.
struct Course<'a> {
    arguments: &'a FollowCommand,
    machine: FollowMachine,
    /// The real machine, where one is led.
    leader: Option<Leader>,
    /// Where it says that its camera looks.
    told: Option<PxPoint>,
    /// By how much its camera is turned, degrees, and the lens' correction, which comes before a window is
    /// turned back.
    turn_deg: f64,
    turned_lens: Option<Correction>,
    eyes: Eyes,
    table: SimulatedTable,
    follower: Follower,
    /// Width and height of the windows that the lens' correction is for.
    corrected_px: Option<(u32, u32)>,
    moves_file: Option<MovesFile>,
    film: Option<FollowGif>,
    frames: Vec<FollowFrame>,
    windows: u64,
    moves: u64,
    lost: u64,
    window_px: u32,
}

impl<'a> Course<'a> {
    /// Where it begins; without a sheet the windows are real.
    fn new(arguments: &'a FollowCommand, sheet: Option<&Sheet>) -> Result<Self, String> {
        let size = sheet.map(|sheet| [sheet.picture.width(), sheet.picture.height()].map(f64::from));
        let found_mm = sheet.map_or(MM_PER_PX, |sheet| sheet.mm_per_px);
        let mm_per_px = arguments.mm_per_px.unwrap_or(found_mm);
        let (described, beside) = machine(arguments)?;
        let machine = FollowMachine::new(&described, mm_per_px, size, arguments.start)?;
        let mut correction = correction(arguments)?;
        let corrected_px = correction.as_ref().map(Correction::size_px);
        let is_real = arguments.from.is_some();
        let is_turned = arguments.live.is_some() && is_real && beside.camera_turn_deg != 0.0;
        let turn_deg = if is_turned { beside.camera_turn_deg } else { 0.0 };
        let turned_lens = if is_turned { correction.take() } else { None };
        let area = match &arguments.live {
            Some(_) => Leader::area(&described, &beside, &machine)?,
            None => machine.area(),
        };
        let camera = arguments.camera.with_seed(arguments.seed);
        let eyes = match (&arguments.from, sheet) {
            (None, Some(sheet)) => {
                Eyes::Simulated(Box::new(SimulatedCamera::new(&Paper::of(&sheet.picture), camera)))
            }
            (from, _) => {
                let from = from.as_deref().unwrap_or(Path::new(""));
                let within = Duration::from_secs(arguments.picture_s.into());
                Eyes::Real(match &arguments.live {
                    Some(_) => WindowSource::awaiting(from, arguments.window, within)?,
                    None => WindowSource::open(from, arguments.window)?,
                })
            }
        };
        let random_px = if sheet.is_some() { arguments.table_error } else { 0.0 };
        let play_px = arguments.play.unwrap_or(3.0 * random_px);
        let error = TableError { random_px, play_px, seed: arguments.seed };
        let moves_file = match (&arguments.moves, &eyes) {
            (None, Eyes::Simulated(_)) => None,
            (path, _) => Some(MovesFile::new(path.as_deref())?),
        };
        let is_gif = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "gif");
        let film = arguments.animation.as_ref().filter(|path| is_gif(path)).map(|_| FollowGif::default());
        let leader = arguments
            .live
            .as_ref()
            .map(|port| Leader::open(&described, &beside, port, arguments))
            .transpose()?;
        Ok(Self {
            arguments,
            table: SimulatedTable::new(machine.at(), error),
            corrected_px,
            follower: Follower::new(
                arguments,
                area,
                correction,
                sheet.map(|sheet| sheet.most_windows(camera.width_px)),
            ),
            machine,
            leader,
            told: None,
            turn_deg,
            turned_lens,
            eyes,
            moves_file,
            film,
            frames: Vec::new(),
            windows: 0,
            moves: 0,
            lost: 0,
            window_px: camera.width_px,
        })
    }

    /// Goes to the start, and from there to the end.
    fn run(&mut self) -> Result<Ended, String> {
        if let Err(error) = self.arrive(&[self.machine.at()], Tool::Up, self.machine.now_s()) {
            return Ok(Ended::Failed(error));
        }
        let most = match &self.follower {
            Follower::Ours(_) => u64::MAX, // it knows itself
            Follower::Published(..) => self.arguments.windows.unwrap_or(PUBLISHED_WINDOWS),
        };
        let shown = WorkShown::endless(self.arguments.telling, "following", "windows");
        let end = loop {
            if self.windows >= most {
                break Ended::Stopped;
            }
            let window = match self.window() {
                Ok(window) => window,
                Err(end) => break end,
            };
            shown.set(self.windows);
            let pose = self.told.unwrap_or_else(|| self.table.commanded());
            let gone = match self.follower.observe(&window, pose) {
                Step::Move { path, tool } => self.go(&path, tool),
                Step::LineLost { .. } => {
                    self.lost += 1;
                    self.stay()
                }
                Step::Done(end) => break Ended::Said(end),
            };
            if let Err(error) = gone {
                break Ended::Failed(error);
            }
        };
        shown.finish();
        Ok(end)
    }

    /// The next window, or why there is none.
    fn window(&mut self) -> Result<Gray, Ended> {
        let window = match &mut self.eyes {
            Eyes::Simulated(camera) => camera.window(self.told.unwrap_or_else(|| self.table.place())),
            Eyes::Real(source) => match source.next_window() {
                Ok(Some(window)) => window,
                Ok(None) => return Err(Ended::NoMorePictures(self.table.commanded())),
                Err(error) => return Err(Ended::Failed(self.with_place(error))),
            },
        };
        let size = (window.width(), window.height());
        self.window_px = size.0;
        if let Some((width, height)) = self.corrected_px.filter(|corrected| *corrected != size) {
            return Err(Ended::Failed(format!(
                "the correction is for windows of {width} x {height} px, this one has {} x {}: calibrate with such windows",
                size.0, size.1
            )));
        }
        let window = if self.turn_deg == 0.0 {
            window
        } else {
            let straight = self.turned_lens.as_ref().map(|lens| lens.corrected(&window));
            turned(straight.as_ref().unwrap_or(&window), self.turn_deg).map_err(Ended::Failed)?
        };
        self.window_px = window.width();
        if let Some(film) = &mut self.film {
            film.see(&window, self.frames.len());
        }
        self.windows += 1;
        Ok(window)
    }

    /// Makes a move.
    fn go(&mut self, path: &[PxPoint], tool: Tool) -> Result<(), String> {
        self.moves += 1;
        let (table, frames) = (&mut self.table, &mut self.frames);
        let seconds = self.machine.make(path, tool, &mut |to, tool| {
            table.go(to, tool);
            frames.push(FollowFrame { at: table.place(), tool });
        })?;
        if path.is_empty() && self.leader.is_some() {
            return self.stay();
        }
        self.arrive(path, tool, seconds)
    }

    /// Another picture from here. It has a number of its own where a machine is led.
    fn stay(&mut self) -> Result<(), String> {
        match self.leader {
            Some(_) => self.arrive(&[self.table.commanded()], Tool::Up, 0.0),
            None => Ok(()),
        }
    }

    /// A move of the plan becomes one of the real machine: a led one is led there, for another the move is
    /// written, and it is waited for as long as that takes.
    fn arrive(&mut self, path: &[PxPoint], tool: Tool, seconds: f64) -> Result<(), String> {
        if let Some(leader) = &self.leader {
            let led = leader.look_at(self.machine.on_sheet(self.machine.at()));
            let told = led.map_err(|error| self.with_place(error))?;
            self.told = Some(self.machine.of_sheet(told));
        }
        if let Some(file) = &mut self.moves_file {
            file.push(&self.machine, path, tool)?;
        }
        if let Eyes::Real(source) = &self.eyes {
            let seconds = if self.leader.is_some() { 0.0 } else { seconds };
            source.wait(seconds + 1e-3 * f64::from(self.arguments.settle_ms));
        }
        Ok(())
    }

    /// What went wrong, with the place and the picture of a machine that is led.
    fn with_place(&self, error: String) -> String {
        let (Some(_), at) = (&self.leader, self.machine.at()) else { return error };
        let sheet = self.machine.on_sheet(at);
        format!(
            "{error} (before picture {}; the camera was led to ({:.1}, {:.1}) px, ({:.3}, {:.3}) mm)",
            self.windows, at.x, at.y, sheet.x, sheet.y
        )
    }

    /// Draws what was followed with the led machine's tool, if that was asked for and all went well.
    fn draw(&mut self, end: Ended) -> Ended {
        let is_over = matches!(end, Ended::Said(End::Complete) | Ended::Stopped);
        let (Some(leader), true, true) = (&self.leader, self.arguments.draw, is_over) else { return end };
        let on_sheet = |line: &Vec<PxPoint>| line.iter().map(|at| self.machine.on_sheet(*at)).collect();
        match leader.draw(self.table.strokes().iter().map(on_sheet).collect()) {
            Ok(()) => end,
            Err(error) => Ended::Failed(format!("the lines were followed, and not all drawn: {error}")),
        }
    }
}

/// The machine, and the camera beside its tool.
pub(super) fn machine(arguments: &FollowCommand) -> Result<(Machine, FollowerConfig), String> {
    let (text, named) = match &arguments.machine {
        Some(path) => {
            (String::from_utf8(read_file(path)?).map_err(|error| at(path, &error))?, path.as_path())
        }
        None => (MACHINE.to_owned(), Path::new("machines/plasma-follower.toml")),
    };
    let (machine, beside) = Machine::from_toml_with(&text).map_err(|error| at(named, &error))?;
    machine.require(MachineKind::Steppers, "follow").map_err(|error| at(named, &error))?;
    Ok((machine, beside))
}

pub(super) fn correction(arguments: &FollowCommand) -> Result<Option<Correction>, String> {
    let Some(path) = &arguments.correction else { return Ok(None) };
    let correction = serde_json::from_slice(&read_file(path)?)
        .map_err(|error| at(path, &format!("is no correction of calibrate_camera: {error}")))?;
    Ok(Some(correction))
}
