//! Where line following still works: followers, cameras and tables, two things changed at a time.
//!
//! Three sweeps over small drawings: how badly the camera is focused against the width of the lines; how
//! badly against its noise; and how much the table misses against the gap between parallel lines. Each run is
//! a cell of a picture: green where the follower made no wrong choice and did all of it, yellow where little
//! is wrong, red where it does not work.
//!
//! ```text
//! cargo run --release --example follow_sweep -- --svg sweep.svg --csv sweep.csv
//! ```

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::follow::{WrongChoices, wrong_choices};
use plotter_examples::shared::{print, run, write_file};
use plotter_vector::PxPoint;
use plotter_vector::follow::{
    CameraSettings, End, Judged, LineFollower, MappingFollower, MappingSettings, Paper, PublishedFollower,
    PublishedSettings, SimulatedCamera, SimulatedTable, Step, TableError, judge,
};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// Size of the drawings, px.
const SIZE_PX: (u32, u32) = (460, 340);

/// Side of the camera's window, px.
const WINDOW_PX: u32 = 240;

/// Windows after which ours is stopped: it needs about 500.
const MOST_WINDOWS: u64 = 4000;

/// A place of a line is followed when the tool passes it within this distance, px.
const REACH_PX: f64 = 2.0;

/// Sweeps blur, noise, width of lines, table error and gaps.
#[derive(Debug, Parser)]
#[command(
    name = "follow_sweep",
    after_help = "Example:\n  follow_sweep --svg sweep.svg --csv sweep.csv --seeds 3\n\n\
                  Green: no wrong choice. Ours: ended by itself, at least 99 % covered, at most 5 % followed twice, at most 0.5 px rms off the \
                  middle. The published ones, which never end: as much way as there are lines, and round what the same hand takes them \
                  round (30 % of the drawing with crossings, one of six parallel lines). \
                  Yellow: at most 2 wrong choices a run; ours at least 90 %, at most 1 px rms. \
                  The numbers in a cell are the wrong choices of all its runs and, below, the least coverage in percent."
)]
struct Arguments {
    /// Writes the picture
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    /// Writes a line for each cell
    #[arg(long, value_name = "F.csv")]
    csv: Option<PathBuf>,
    /// Runs in each cell, of which the worst counts
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Method {
    Published,
    Connected,
    Ours,
}

impl Method {
    const ALL: [Self; 3] = [Self::Ours, Self::Connected, Self::Published];

    const fn name(self) -> &'static str {
        match self {
            Self::Published => "published",
            Self::Connected => "published, joined exits only",
            Self::Ours => "ours",
        }
    }
}

/// What is changed. The rest is as in the tests: 1.5 px of blur, noise of 4 levels, light falling to 60 %,
/// lines of 5 px, a table error of 1 px with 3 px of play; parallel lines are 4 px wide.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Condition {
    blur_px: f64,
    noise_levels: f64,
    line_px: f64,
    table_px: f64,
    play_px: f64,
    /// Of parallel lines; none where they cross.
    gap_px: Option<f64>,
}

const USUAL: Condition =
    Condition { blur_px: 1.5, noise_levels: 4.0, line_px: 5.0, table_px: 1.0, play_px: 3.0, gap_px: None };

/// A sweep of two things: columns and rows.
struct Sweep {
    name: &'static str,
    across: (&'static str, &'static [f64]),
    down: (&'static str, &'static [f64]),
    condition: fn(f64, f64) -> Condition,
}

const SWEEPS: [Sweep; 3] = [
    Sweep {
        name: "blur and width",
        across: ("line, px", &[1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 16.0, 20.0]),
        down: ("blur, px", &[0.0, 1.0, 2.0, 3.0, 4.0]),
        condition: |line_px, blur_px| Condition { line_px, blur_px, ..USUAL },
    },
    Sweep {
        name: "blur and noise",
        across: ("noise, levels", &[0.0, 5.0, 10.0, 20.0, 40.0]),
        down: ("blur, px", &[0.0, 1.0, 2.0, 3.0, 4.0]),
        condition: |noise_levels, blur_px| Condition { noise_levels, blur_px, ..USUAL },
    },
    Sweep {
        name: "table error and gap",
        across: ("gap between lines of 4 px, px", &[1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0]),
        down: ("table error and play, px", &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        condition: |gap, table_px| Condition {
            line_px: 4.0,
            gap_px: Some(gap),
            table_px,
            play_px: table_px,
            ..USUAL
        },
    },
];

/// A ring, a line across it, and a tip of 36 degrees; or six parallel lines.
fn lines(condition: &Condition) -> Vec<Vec<PxPoint>> {
    let line = |places: &[(f64, f64)]| places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect();
    if let Some(gap_px) = condition.gap_px {
        let y = |i: i32| 120.3 + f64::from(i) * (condition.line_px + gap_px);
        return (0..6).map(|i| line(&[(110.2, y(i)), (350.7, y(i) + 18.0)])).collect();
    }
    let round = |i: i32| f64::from(i) * std::f64::consts::TAU / 90.0;
    let ring = (0..=90)
        .map(|i| PxPoint::new(150.4 + 90.0 * libm::cos(round(i)), 170.2 + 90.0 * libm::sin(round(i))))
        .collect();
    vec![ring, line(&[(30.3, 165.4), (270.6, 178.2)]), line(&[(310.2, 280.4), (365.3, 70.8), (430.6, 276.9)])]
}

/// Result of a run, or the worst of several.
#[derive(Clone, Debug)]
struct Outcome {
    complete: bool,
    wrong: WrongChoices,
    judged: Judged,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Colour {
    Green,
    Yellow,
    Red,
}

fn followed(method: Method, condition: &Condition, seed: u64) -> Result<Outcome, String> {
    let lines = lines(condition);
    let strokes: Vec<_> = lines.iter().map(|line| (line.clone(), condition.line_px)).collect();
    let paper = Paper::drawn(SIZE_PX.0, SIZE_PX.1, &strokes).map_err(|error| error.to_string())?;
    let settings = CameraSettings::default()
        .with_width_px(WINDOW_PX)
        .with_height_px(WINDOW_PX)
        .with_blur_px(condition.blur_px)
        .with_noise_levels(condition.noise_levels)
        .with_seed(seed);
    let mut camera = SimulatedCamera::new(&paper, settings);
    let start = lines.first().and_then(|line| line.first()).copied().unwrap_or_default();
    let error = TableError { random_px: condition.table_px, play_px: condition.play_px, seed };
    let mut table = SimulatedTable::new(start, error);
    let far = PxPoint::new(f64::from(SIZE_PX.0), f64::from(SIZE_PX.1));
    let area = Some([PxPoint::new(0.0, 0.0), far]);
    let mut complete = false;
    if method == Method::Ours {
        let settings = MappingSettings::default().with_area(area).with_max_windows(MOST_WINDOWS);
        let mut follower = MappingFollower::new(settings);
        loop {
            match follower.observe(&camera.window(table.place()), table.commanded()) {
                Step::Move { path, tool } => path.into_iter().for_each(|to| table.go(to, tool)),
                Step::LineLost { .. } => {}
                Step::Done(end) => {
                    complete = end == End::Complete;
                    break;
                }
            }
        }
    } else {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 20")]
        let thinnest_px = condition.line_px as u32;
        let settings = PublishedSettings::for_lines(thinnest_px)
            .with_area(area)
            .with_only_connected(method == Method::Connected);
        let mut follower = PublishedFollower::new(settings);
        let length = |lines: &[Vec<PxPoint>]| -> f64 {
            lines.iter().flat_map(|line| line.windows(2)).map(|pair| pair[0].distance(pair[1])).sum()
        };
        let whole = length(&lines);
        // A window takes it on by about 80 px; as much way as there are lines.
        for _ in 0..100 {
            if length(table.strokes()) >= whole {
                complete = true;
                break;
            }
            if let Step::Move { path, tool } =
                follower.observe(&camera.window(table.place()), table.commanded())
            {
                path.into_iter().for_each(|to| table.go(to, tool));
            }
        }
    }
    let wrong = wrong_choices(&lines, condition.line_px, table.strokes());
    Ok(Outcome { complete, wrong, judged: judge(&lines, table.strokes(), REACH_PX) })
}

/// All runs of a cell: the sum of wrong choices, the worst of all else.
fn cell(method: Method, condition: &Condition, seeds: u64) -> Result<Outcome, String> {
    let mut all = followed(method, condition, 1)?;
    for seed in 2..=seeds {
        let one = followed(method, condition, seed)?;
        all.complete &= one.complete;
        all.wrong.shortcuts += one.wrong.shortcuts;
        all.wrong.jumps += one.wrong.jumps;
        all.wrong.turns += one.wrong.turns;
        let (worst, judged) = (&mut all.judged, one.judged);
        worst.coverage = worst.coverage.min(judged.coverage);
        worst.repeated = worst.repeated.max(judged.repeated);
        worst.rms_px = worst.rms_px.max(judged.rms_px);
        worst.max_px = worst.max_px.max(judged.max_px);
    }
    Ok(all)
}

impl Row<'_> {
    fn colour(&self, seeds: u64) -> Colour {
        let Outcome { complete, wrong, judged } = self.outcome;
        let wrong = u64::from(wrong.all());
        // The published ones are to get round what the same hand takes them round, with no promise of more.
        let [least, nearly, rms_px, nearly_rms_px] = match (self.method, self.condition().gap_px) {
            (Method::Ours, _) => [0.99, 0.9, 0.5, 1.0],
            (_, None) => [0.3, 0.3, f64::MAX, f64::MAX],
            (_, Some(_)) => [0.16, 0.16, f64::MAX, f64::MAX],
        };
        let is_once = self.method != Method::Ours || judged.repeated <= 0.05;
        if wrong == 0 && *complete && judged.coverage >= least && is_once && judged.rms_px <= rms_px {
            Colour::Green
        } else if wrong <= 2 * seeds
            && *complete
            && judged.coverage >= nearly
            && judged.rms_px <= nearly_rms_px
        {
            Colour::Yellow
        } else {
            Colour::Red
        }
    }

    fn condition(&self) -> Condition {
        SWEEPS.get(self.sweep).map_or(USUAL, |sweep| (sweep.condition)(self.across, self.down))
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run("follow_sweep", || sweep(&arguments))
}

fn sweep(arguments: &Arguments) -> Result<(), String> {
    let mut cells: Vec<(Method, usize, f64, f64)> = Vec::new();
    for method in Method::ALL {
        for (index, sweep) in SWEEPS.iter().enumerate() {
            for down in sweep.down.1 {
                cells.extend(sweep.across.1.iter().map(|across| (method, index, *across, *down)));
            }
        }
    }
    let bar = ProgressBar::new(cells.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{pos} of {len} cells, {elapsed}") {
        bar.set_style(style);
    }
    let outcomes: Result<Vec<Outcome>, String> = cells
        .par_iter()
        .map(|(method, index, across, down)| {
            let condition = SWEEPS.get(*index).map_or(USUAL, |sweep| (sweep.condition)(*across, *down));
            let outcome = cell(*method, &condition, arguments.seeds);
            bar.inc(1);
            outcome
        })
        .collect();
    bar.finish_and_clear();
    let outcomes = outcomes?;
    let rows: Vec<Row<'_>> = cells
        .iter()
        .zip(&outcomes)
        .map(|((method, sweep, across, down), outcome)| {
            let row = Row {
                method: *method,
                sweep: *sweep,
                across: *across,
                down: *down,
                colour: Colour::Red,
                outcome,
            };
            Row { colour: row.colour(arguments.seeds), ..row }
        })
        .collect();
    if let Some(path) = &arguments.csv {
        write_file(path, csv(&rows))?;
    }
    if let Some(path) = &arguments.svg {
        write_file(path, svg(&rows))?;
    }
    print(&summary(&rows))
}

struct Row<'a> {
    method: Method,
    sweep: usize,
    across: f64,
    down: f64,
    colour: Colour,
    outcome: &'a Outcome,
}

fn csv(rows: &[Row<'_>]) -> String {
    let mut text = String::from(
        "method,sweep,blur_px,noise_levels,line_px,table_px,play_px,gap_px,ended,shortcuts,jumps,turns,coverage,twice,rms_px,max_px,works\n",
    );
    for row in rows {
        let Some(sweep) = SWEEPS.get(row.sweep) else { continue };
        let at = row.condition();
        let (wrong, judged) = (&row.outcome.wrong, &row.outcome.judged);
        let _ = writeln!(
            text,
            "\"{}\",{},{},{},{},{},{},{},{},{},{},{},{:.4},{:.4},{:.3},{:.2},{:?}",
            row.method.name(),
            sweep.name,
            at.blur_px,
            at.noise_levels,
            at.line_px,
            at.table_px,
            at.play_px,
            at.gap_px.map(|gap| gap.to_string()).unwrap_or_default(),
            row.outcome.complete,
            wrong.shortcuts,
            wrong.jumps,
            wrong.turns,
            judged.coverage,
            judged.repeated,
            judged.rms_px,
            judged.max_px,
            row.colour
        );
    }
    text
}

/// How many cells are green, yellow and red.
fn summary(rows: &[Row<'_>]) -> String {
    let mut text = String::from(
        "| sweep | follower | green | yellow | red | wrong choices in all |\n|---|---|---|---|---|---|\n",
    );
    for (index, sweep) in SWEEPS.iter().enumerate() {
        for method in Method::ALL {
            let own = || rows.iter().filter(|row| row.sweep == index && row.method == method);
            let of = |colour| own().filter(|row| row.colour == colour).count();
            let wrong: u32 = own().map(|row| row.outcome.wrong.all()).sum();
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {} | {wrong} |",
                sweep.name,
                method.name(),
                of(Colour::Green),
                of(Colour::Yellow),
                of(Colour::Red)
            );
        }
    }
    text
}

/// Size of a cell, and what a sweep takes of the picture.
const CELL: (f64, f64) = (46.0, 30.0);
const BLOCK: (f64, f64) = (440.0, 300.0);
const EDGE: (f64, f64) = (60.0, 60.0);

fn svg(rows: &[Row<'_>]) -> String {
    let (width, height) = (3.0 * BLOCK.0 + 20.0, 3.0 * BLOCK.1 + 40.0);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"12\" text-anchor=\"middle\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (line, method) in (0_u32..).zip(Method::ALL) {
        for ((column, index), sweep) in (0_u32..).zip(0..).zip(&SWEEPS) {
            let (left, top) = (f64::from(column) * BLOCK.0 + EDGE.0, f64::from(line) * BLOCK.1 + EDGE.1);
            let _ = writeln!(
                text,
                "<text x=\"{left}\" y=\"{}\" text-anchor=\"start\" font-weight=\"bold\">{}: {}</text>",
                top - 38.0,
                method.name(),
                sweep.name
            );
            let across_middle =
                left + 0.5 * CELL.0 * f64::from(u32::try_from(sweep.across.1.len()).unwrap_or(1));
            let _ =
                writeln!(text, "<text x=\"{across_middle}\" y=\"{}\">{}</text>", top - 20.0, sweep.across.0);
            let down_middle = top + 0.5 * CELL.1 * f64::from(u32::try_from(sweep.down.1.len()).unwrap_or(1));
            let beside = left - 34.0;
            let _ = writeln!(
                text,
                "<text x=\"{beside}\" y=\"{down_middle}\" transform=\"rotate(-90 {beside} {down_middle})\">{}</text>",
                sweep.down.0
            );
            for (i, across) in (0_u32..).zip(sweep.across.1) {
                let x = left + CELL.0 * (f64::from(i) + 0.5);
                let _ = writeln!(text, "<text x=\"{x}\" y=\"{}\">{across}</text>", top - 5.0);
            }
            for (j, down) in (0_u32..).zip(sweep.down.1) {
                let y = top + CELL.1 * f64::from(j);
                let _ = writeln!(
                    text,
                    "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{down}</text>",
                    left - 6.0,
                    y + 0.5 * CELL.1 + 4.0
                );
                for (i, across) in (0_u32..).zip(sweep.across.1) {
                    let is_it = |row: &&Row<'_>| {
                        row.method == method
                            && row.sweep == index
                            && row.across == *across
                            && row.down == *down
                    };
                    if let Some(row) = rows.iter().find(is_it) {
                        text.push_str(&drawn(row, left + CELL.0 * f64::from(i), y));
                    }
                }
            }
        }
    }
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"start\">In each cell: wrong choices (shortcuts, jumps to another line, turning back); below, covered %. \
         Green works, yellow nearly, red does not.</text>\n</svg>",
        EDGE.0,
        height - 14.0
    );
    text
}

fn drawn(row: &Row<'_>, x: f64, y: f64) -> String {
    let fill = match row.colour {
        Colour::Green => "#a5d6a7",
        Colour::Yellow => "#fff59d",
        Colour::Red => "#ef9a9a",
    };
    let middle = x + 0.5 * CELL.0;
    format!(
        "<rect x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{}\" fill=\"{fill}\" stroke=\"white\"/>\
         <text x=\"{middle}\" y=\"{}\" font-weight=\"bold\">{}</text><text x=\"{middle}\" y=\"{}\" font-size=\"10\">{:.1} %</text>\n",
        CELL.0,
        CELL.1,
        y + 13.0,
        row.outcome.wrong.all(),
        y + 25.0,
        100.0 * row.outcome.judged.coverage
    )
}
