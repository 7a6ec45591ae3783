//! A contest of controllers on simulated machines: table, CSV and a page with pictures.

use super::command::CompareCommand;
use super::page::{Page, Trace};
use crate::shared::{WorkShown, at, fit_drawing, lost_ink, read_file, vectorized, write_file};
use plotter_motion::{
    Machine, PlotOp,
    config::MachineKind,
    hpgl,
    testbed::{Drawing, Entry, Ranking, Score, TestBed, TestBedSettings},
};
use plotter_vector::{FileRows, picture::RowSource as _, trace::VectorizeConfig};
use rayon::prelude::*;
use serde_json::json;
use std::fmt::Write as _;
use std::io::Cursor;
use std::path::Path;

/// A machine and what it draws.
pub(super) struct Plant {
    pub(super) name: String,
    pub(super) bed: TestBed,
    pub(super) drawings: Vec<Drawing>,
}

/// What an entry did on a plant, with a trace of each drawing.
pub(super) struct Outcome {
    pub(super) score: Score,
    pub(super) traces: Vec<Trace>,
}

pub(super) fn compare(args: &CompareCommand, more: Vec<Entry>) -> Result<(), String> {
    let entries = entries(&args.only, more)?;
    let plants = plants(args)?;
    // What cannot be written is better known before the work than after it.
    for path in [&args.html, &args.csv].into_iter().flatten() {
        write_file(path, "")?;
    }
    let jobs: Vec<(usize, usize)> =
        (0..plants.len()).flat_map(|plant| (0..entries.len()).map(move |entry| (plant, entry))).collect();
    let bar = WorkShown::of(args.telling, "drawing", jobs.len() as u64, "controllers");
    let wants_traces = args.html.is_some();
    let results: Vec<Outcome> = jobs
        .par_iter()
        .map(|&(plant, entry)| {
            let result = result(&plants[plant], &entries[entry], wants_traces);
            bar.next();
            result
        })
        .collect();
    bar.finish();

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
    args.telling.tell(&text, || {
        let plants = plants.iter().zip(results.chunks(entries.len().max(1)));
        let rows: Vec<_> = plants
            .flat_map(|(plant, results)| results.iter().flat_map(|r| json_rows(plant, &r.score)))
            .collect();
        serde_json::to_string_pretty(&rows).map_err(|error| error.to_string())
    })
}

/// Number of lines of the star, which come first among the drawings of a plant.
pub(super) const STAR: usize = 8;

pub(super) fn drawing_name(plant: &Plant) -> &str {
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

fn plants(args: &CompareCommand) -> Result<Vec<Plant>, String> {
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

pub(super) fn plant(args: &CompareCommand, path: &Path, text: &str) -> Result<Plant, String> {
    let (machine, vectorize) = Machine::from_toml_with(text).map_err(|error| at(path, &error))?;
    machine.require(MachineKind::Gantry, "the contest of controllers").map_err(|error| at(path, &error))?;
    let settings = TestBedSettings { wrong_share: args.wrong, ..TestBedSettings::default() };
    let bed = TestBed::new(&machine, settings).map_err(|error| {
        at(path, &format!("cannot be described so wrongly (--wrong {}): {error}", args.wrong))
    })?;
    let mut drawings = Drawing::star(&bed);
    if let Some(path) = &args.drawing {
        drawings.push(drawing(args, path, &bed, &vectorize)?);
    }
    Ok(Plant { name: machine.config().name.as_str().to_owned(), bed, drawings })
}

pub(super) fn drawing(
    args: &CompareCommand,
    path: &Path,
    bed: &TestBed,
    vectorize: &VectorizeConfig,
) -> Result<Drawing, String> {
    let is_builtin = path.as_os_str() == "builtin";
    let bytes = if is_builtin { include_bytes!("../../data/flag.png").to_vec() } else { read_file(path)? };
    let is_hpgl = path
        .extension()
        .is_some_and(|ending| ["plt", "hpgl"].iter().any(|known| ending.eq_ignore_ascii_case(known)));
    let name =
        if is_builtin { "flag".into() } else { path.file_stem().unwrap_or_default().to_string_lossy() };
    let text = if is_hpgl { bytes } else { traced(args, path, &bytes, bed, vectorize)?.into_bytes() };
    let ops: Vec<PlotOp> =
        hpgl::plot_ops(text.as_slice()).collect::<Result<_, _>>().map_err(|error| at(path, &error))?;
    // A name stands in a table and in CSV.
    let name = name.replace([',', '"', '\n', '\r'], "_");
    Drawing::from_ops(&name, bed, ops).map_err(|error| at(path, &error))
}

/// A picture as HPGL, as the example `plot` makes it with ours on this machine.
fn traced(
    args: &CompareCommand,
    path: &Path,
    bytes: &[u8],
    bed: &TestBed,
    vectorize: &VectorizeConfig,
) -> Result<String, String> {
    let scan = FileRows::new(Cursor::new(bytes)).map_err(|error| at(path, &error))?;
    let scale = fit_drawing((scan.width(), scan.height()), bed.machine(), args.width_mm)?;
    let vectorizer = vectorize.vectorizer(scale.mm_per_px()).map_err(|error| at(path, &error))?;
    let (traced, _) = vectorized(&vectorizer, bytes.to_vec(), 1).map_err(|error| at(path, &error))?;
    let errors = traced.errors.unwrap_or_default();
    lost_ink(&vectorizer, &errors, traced.pen_px, traced.look.is_some()).map_err(|error| at(path, &error))?;
    let mut text = String::new();
    plotter_vector::hpgl(&traced.drawing, scale, &mut text).map_err(|error| error.to_string())?;
    Ok(text)
}

pub(super) fn result(plant: &Plant, entry: &Entry, wants_traces: bool) -> Outcome {
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

/// The same rows as JSON, lengths and times as in the CSV.
fn json_rows(plant: &Plant, score: &Score) -> impl Iterator<Item = serde_json::Value> {
    score.drawings.iter().map(|(line, figures)| {
        json!({
            "controller": score.entry,
            "plant": plant.name,
            "line": line,
            "rms_um": figures.rms_mm() * 1e3,
            "max_um": figures.max_mm * 1e3,
            "settle_s": figures.settled.map(|at| at.as_secs_f64()),
            "time_s": figures.time.as_secs_f64(),
            "finished": figures.is_finished(),
        })
    })
}

/// A name in CSV: in quotes where it would break the row.
fn field(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_a_comma_is_quoted() {
        assert_eq!(field("mine"), "mine");
        assert_eq!(field("mine, \"new\""), "\"mine, \"\"new\"\"\"");
    }
}
