//! Window by window, to the end.

use super::command::{FollowCommand, PUBLISHED_WINDOWS};
use super::ended::{Ended, Over};
use super::files::write_files;
use super::follower::{Eyes, Follower};
use super::sheet::{MM_PER_PX, Sheet, sheet};
use crate::follow::{FollowFrame, FollowGif, FollowMachine, FollowOutcome, MovesFile, WindowSource};
use crate::shared::{WorkShown, at, read_file};
use plotter_motion::{Machine, config::MachineKind};
use plotter_vector::{
    Gray, PxPoint,
    follow::{
        CameraSettings, Correction, End, Paper, SimulatedCamera, SimulatedTable, Step, TableError, Tool,
        judge,
    },
};
use std::path::{Path, PathBuf};

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
        let machine = FollowMachine::new(&machine(arguments)?, mm_per_px, size, arguments.start)?;
        let correction = correction(arguments)?;
        let camera = CameraSettings { seed: arguments.seed, ..*arguments.camera };
        let eyes = match (&arguments.from, sheet) {
            (None, Some(sheet)) => {
                Eyes::Simulated(Box::new(SimulatedCamera::new(&Paper::of(&sheet.picture), camera)))
            }
            (from, _) => {
                Eyes::Real(WindowSource::open(from.as_deref().unwrap_or(Path::new("")), arguments.window)?)
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
        Ok(Self {
            arguments,
            table: SimulatedTable::new(machine.at(), error),
            corrected_px: correction.as_ref().map(Correction::size_px),
            follower: Follower::new(
                arguments,
                machine.area(),
                correction,
                sheet.map(|sheet| sheet.most_windows(camera.width_px)),
            ),
            machine,
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
        if let Some(file) = &mut self.moves_file {
            file.push(&self.machine, &[self.machine.at()], Tool::Up)?;
        }
        self.wait(self.machine.now_s());
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
            match self.follower.observe(&window, self.table.commanded()) {
                Step::Move { path, tool } => self.go(&path, tool)?,
                Step::LineLost { .. } => self.lost += 1,
                Step::Done(end) => break Ended::Said(end),
            }
        };
        shown.finish();
        Ok(end)
    }

    /// The next window, or why there is none.
    fn window(&mut self) -> Result<Gray, Ended> {
        let window = match &mut self.eyes {
            Eyes::Simulated(camera) => camera.window(self.table.place()),
            Eyes::Real(source) => match source.next_window() {
                Ok(Some(window)) => window,
                Ok(None) => return Err(Ended::NoMorePictures(self.table.commanded())),
                Err(error) => return Err(Ended::Failed(error)),
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
        if let Some(film) = &mut self.film {
            film.see(&window, self.frames.len());
        }
        self.windows += 1;
        Ok(window)
    }

    /// Makes a move.
    fn go(&mut self, path: &[PxPoint], tool: Tool) -> Result<(), String> {
        self.moves += 1;
        if let Some(file) = &mut self.moves_file {
            file.push(&self.machine, path, tool)?;
        }
        let (table, frames) = (&mut self.table, &mut self.frames);
        let seconds = self.machine.make(path, tool, &mut |to, tool| {
            table.go(to, tool);
            frames.push(FollowFrame { at: table.place(), tool });
        })?;
        self.wait(seconds);
        Ok(())
    }

    /// Waits until a real machine has made a move, and stands still.
    fn wait(&self, seconds: f64) {
        if let Eyes::Real(source) = &self.eyes {
            source.wait(seconds + 1e-3 * f64::from(self.arguments.settle_ms));
        }
    }
}

pub(super) fn machine(arguments: &FollowCommand) -> Result<Machine, String> {
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

pub(super) fn correction(arguments: &FollowCommand) -> Result<Option<Correction>, String> {
    let Some(path) = &arguments.correction else { return Ok(None) };
    let correction = serde_json::from_slice(&read_file(path)?)
        .map_err(|error| at(path, &format!("is no correction of calibrate_camera: {error}")))?;
    Ok(Some(correction))
}
