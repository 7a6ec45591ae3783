//! Window by window, to the end.

use super::command::{FollowCommand, PUBLISHED_WINDOWS};
use super::ended::Ended;
use super::files::write_files;
use super::follower::{Eyes, Follower};
use super::sheet::sheet;
use crate::follow::{FollowFrame, FollowGif, FollowMachine, FollowOutcome, MovesFile, WindowSource};
use crate::shared::{WorkShown, at, read_file};
use plotter_motion::{Machine, config::MachineKind};
use plotter_vector::{
    follow::CameraSettings, follow::Correction, follow::End, follow::Paper, follow::SimulatedCamera,
    follow::SimulatedTable, follow::Step, follow::TableError, follow::Tool, follow::judge,
};
use std::path::{Path, PathBuf};

/// The machine, where no other is given.
pub(super) const MACHINE: &str = include_str!("../../machines/plasma-follower.toml");

pub(super) fn follow(arguments: &FollowCommand) -> Result<(), String> {
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

    let bar = WorkShown::endless(arguments.telling, "following", "windows");
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
        bar.set(windows);
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
    bar.finish();
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
        arguments.telling.tell(&outcome.table(), || outcome.json(table.strokes()))?;
    } else {
        arguments.telling.tell_aside(&outcome.table(), || outcome.json(table.strokes()))?;
    }
    match end {
        Ended::Said(End::Complete) | Ended::Stopped => Ok(()),
        _ => Err(format!("{name}: {}", outcome.said)),
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
