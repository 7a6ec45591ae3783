//! Frame by frame, and what the joints are like.

use super::command::{LongSheetCommand, MOST_FRAMES, Method};
use crate::drawings::{Diagnostics, Severity};
use crate::long_sheet::{
    JointFigures, LongSheetMachine, LongSheetReport, LongSheetRun, TextilePattern, long_sheet_svg,
};
use crate::shared::{WorkShown, at, read_file, write_file};
use plotter_motion::{Machine, MachineConfig, PlotOp, config::MachineKind};
use plotter_stitch::{
    sheet::{JoinFrames, SheetConfig},
    split::FramePasses,
};

pub(super) fn draw_sheet(arguments: &LongSheetCommand) -> Result<(), String> {
    let (machine, sheet) = machine(arguments)?;
    let mut sheet = LongSheetMachine::new(&machine, &sheet)?;
    if let Some(edges_mm) = arguments.paper_edges {
        /// As a roll lies that was mounted by hand, rad.
        const TURN_RAD: f64 = 0.0005;
        sheet = sheet.on_paper(edges_mm, TURN_RAD, arguments.seed)?;
    }
    sheet.sheet.feed.folds = arguments.folds;
    match &arguments.file {
        None => {
            let pattern = TextilePattern {
                length_mm: 1e3 * arguments.length_m,
                width_mm: sheet.layout.width_mm,
                chord_mm: arguments.chord_mm,
            };
            let name = format!("textile pattern of {} m", arguments.length_m);
            draw(arguments, &sheet, &name, || pattern.ops())
        }
        Some(path) => {
            let (drawing, reading) = (arguments.drawing.open(path)?, arguments.drawing.reading());
            let mut said = Diagnostics::default();
            // Nothing is drawn of a drawing with errors: read it once before.
            for found in drawing.ops(reading)?.filter_map(Result::err) {
                if found.severity == Severity::Error {
                    return Err(format!("{}: {found}", drawing.name()));
                }
                said.push(found);
            }
            draw(arguments, &sheet, drawing.name(), || {
                drawing.ops(reading).into_iter().flatten().filter_map(Result::ok)
            })?;
            said.complain(drawing.name());
            Ok(())
        }
    }
}

pub(super) fn machine(arguments: &LongSheetCommand) -> Result<(Machine, SheetConfig), String> {
    match &arguments.machine {
        Some(path) => {
            let text = String::from_utf8(read_file(path)?)
                .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
            let (machine, sheet) = Machine::from_toml_with(&text).map_err(|error| at(path, &error))?;
            machine.require(MachineKind::Steppers, "long_sheet").map_err(|error| at(path, &error))?;
            Ok((machine, sheet))
        }
        None => {
            let machine =
                Machine::new(MachineConfig::textile_plotter()).map_err(|error| error.to_string())?;
            Ok((machine, SheetConfig::textile_plotter()))
        }
    }
}

pub(super) fn draw<I: Iterator<Item = PlotOp>>(
    arguments: &LongSheetCommand,
    sheet: &LongSheetMachine,
    name: &str,
    drawing: impl FnMut() -> I,
) -> Result<(), String> {
    match arguments.method {
        Method::Published => {
            let mut sheet = sheet.clone();
            sheet.sheet.anchor_mm = 0.0;
            let method = sheet.published_join();
            draw_with(arguments, sheet, "published", method, name, drawing)
        }
        Method::Ours => {
            let method = sheet.strip_join();
            draw_with(arguments, sheet.clone(), "ours", method, name, drawing)
        }
    }
}

fn draw_with<M: JoinFrames, I: Iterator<Item = PlotOp>>(
    arguments: &LongSheetCommand,
    sheet: LongSheetMachine,
    method: &str,
    join: M,
    name: &str,
    drawing: impl FnMut() -> I,
) -> Result<(), String> {
    let layout = sheet.layout;
    let mut sheet = LongSheetRun::new(sheet, join, arguments.seed)?;
    let mut frames = FramePasses::new(drawing, layout);
    let bar = match arguments.frames {
        Some(all) => WorkShown::of(arguments.telling, "drawing", all.into(), "frames"),
        None => WorkShown::endless(arguments.telling, "drawing", "frames"),
    };
    if arguments.change.is_some() {
        sheet.shown.0 = arguments.change_frame;
    }
    let in_file = |error: plotter_stitch::SplitError| format!("{name}: {error}");
    let first = frames.next().transpose().map_err(in_file)?;
    sheet.first(first.as_ref())?;
    drop(first);
    let mut joints: Vec<JointFigures> = Vec::new();
    let most = arguments.frames.unwrap_or(MOST_FRAMES) as usize;
    while joints.len() + 1 < most {
        let frame = frames.next().transpose().map_err(in_file)?;
        if frame.is_none() && arguments.frames.is_none() {
            break;
        }
        joints.push(sheet.next(frame.as_ref())?);
        bar.next();
    }
    bar.finish();

    let report = LongSheetReport::new(name, method, arguments.seed, layout.frame_mm, &joints, &sheet.frames);
    if let Some(path) = &arguments.svg {
        let title = format!("{name}, {method}: {:.3} mm at the worst joint", report.joint_worst_mm);
        write_file(path, long_sheet_svg(&title, &joints, &sheet.frames))?;
    }
    if let Some(path) = &arguments.change {
        let change = sheet.shown.1.as_ref().ok_or_else(|| {
            format!("--change-frame {}: the drawing has {} frames", arguments.change_frame, joints.len() + 1)
        })?;
        write_file(path, change.svg())?;
    }
    if let Some(path) = &arguments.report {
        let text = serde_json::to_string_pretty(&report).map_err(|error| error.to_string())?;
        write_file(path, text + "\n")?;
    }
    arguments
        .telling
        .tell(&report.table(), || serde_json::to_string_pretty(&report).map_err(|error| error.to_string()))
}
