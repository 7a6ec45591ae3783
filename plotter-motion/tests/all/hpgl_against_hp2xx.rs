//! HPGL files in the manner of programs, and of programs where they are at hand, as this reader and as hp2xx
//! draw them.
//!
//! hp2xx (H. W. Werntges and M. Kroeker, 3.4.4) is a reader that shares no code with this one. It writes what
//! it has understood as plain `PU` and `PD`, from which the lines are taken here. Every place of every line
//! must lie near a line of the other reader, in both directions.
//!
//! Before, the text is changed where the two would be right to differ, alike for both:
//!
//! - labels become blanks, which move the pen but draw nothing, and symbols are left out: each reader has its
//!   own letters;
//! - after `IN`, P1, P2 and the size of letters are set to those of a 7475A with A4, where hp2xx supposes a
//!   plotter for A0, and pen 1 is taken, there and on each page, without which hp2xx draws nothing;
//! - what is filled is left out (`FP`, `RA`, `RR`, `WG`): hp2xx begins its hatching at the polygon's lowest
//!   place, not at the anchor, and takes the width of a pen in mm for one in plotter units. Filling is pinned
//!   in `hpgl_polygons.rs`.

// Without the font, labels are left out, and do not move the pen.
#![cfg(feature = "font")]

use crate::real_files::{all, name_of};
use plotter_motion::hpgl::{Coordinates, Event, Reader, UNITS_PER_MM, WriteOptions, Writer, plot_ops};
use plotter_motion::{PlotOp, Point, Segment, toolpath::chords};
use std::collections::HashMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fs, io};

/// Farthest that a line may be from one of the other reader, plotter units.
pub(crate) const TOLERANCE_UNITS: f64 = 1.0;
/// What hp2xx rounds: it reckons with numbers of 24 bits, of which those beyond 32,768 resolve 0.004 units.
const ROUNDING_UNITS: f64 = 0.01;
/// How far the lines made of arcs are from them, mm: a hundredth of a unit.
const CHORDS_MM: f64 = 0.01 / UNITS_PER_MM;
/// Places are taken this far from each other along each line, plotter units.
const EVERY_UNITS: f64 = 4.0;
/// The square on the sheet that hp2xx is told to draw, and whose lower left corner is the origin of what it
/// writes.
const FROM_UNITS: i32 = -20_000;
const TO_UNITS: i32 = 60_000;
/// What hp2xx would suppose otherwise.
const PLOTTER: &[u8] = b";IP603,521,10603,7721;SI0.19,0.27;SP1;";
/// Left out in all files.
const FILLED: [&str; 4] = ["FP", "RA", "RR", "WG"];

/// A file that the two do not draw alike: what is left out of it, or how far they may be from each other, and
/// why.
struct Exception {
    file: &'static str,
    left_out: &'static [&'static str],
    tolerance_units: f64,
}

const EXCEPTIONS: [Exception; 4] = [
    // hp2xx draws each curve as 50 lines that end on it, which lie up to 0.75 · 7620 / 50² = 2.29 units
    // beside it: 7620 is the greatest second difference of its points. Ours lie within 0.4 units
    // (`ReadOptions::tolerance_mm`).
    Exception { file: "hp2xx_bz.hp", left_out: &[], tolerance_units: 2.29 },
    // `IW` without numbers cuts at the edge of the sheet for hp2xx, which knows one; a mark lies beyond.
    Exception { file: "hp2xx_iw.hp", left_out: &["IW"], tolerance_units: TOLERANCE_UNITS },
    // For hp2xx, letters of so many cm grow with `IP`; `SI` is in cm whatever P1 and P2 are. `IP` has no
    // other effect here.
    Exception { file: "hp2xx_lo.hp", left_out: &["IP"], tolerance_units: TOLERANCE_UNITS },
    // Once turned, hp2xx does not turn back: it takes `RO0` after `RO90` for nothing, and all that follows is
    // turned. And its window is wrong: of PU4200,700;PD5800,1500 in IW4400,700,5600,1500, a diagonal through
    // two corners' sides, it draws nothing, and of a chord that enters from outside the outer end.
    Exception {
        file: "hpgl_rendering_feature_exercise.plt",
        left_out: &["RO", "IW"],
        tolerance_units: TOLERANCE_UNITS,
    },
];

/// The text with the changes that are named above.
pub(crate) fn prepared(text: &[u8], left_out: &[&str]) -> Vec<u8> {
    let mut reader = Reader::new();
    let mut prepared = Vec::new();
    let mut command = String::new();
    let mut initialized = false;
    // Where in `prepared` the command in progress begins.
    let mut begin = 0;
    for byte in text {
        prepared.push(*byte);
        let event = reader.push(*byte);
        match event {
            Some(Ok(Event::Command { command: next, .. })) => {
                // Its first letter may lie behind blanks.
                let letters = prepared.len()
                    - 1
                    - prepared.iter().rev().skip(1).position(u8::is_ascii_alphabetic).unwrap_or(0)
                    - 1;
                if left_out.contains(&command.as_str()) || FILLED.contains(&command.as_str()) {
                    // A command that is left out may have been ended by these letters.
                    let kept = prepared.split_off(letters);
                    prepared.truncate(begin);
                    prepared.push(b';');
                    begin = prepared.len();
                    prepared.extend(kept);
                } else {
                    begin = letters;
                }
                command = next.to_string();
                if command == "IN" {
                    prepared.extend_from_slice(PLOTTER);
                    initialized = true;
                }
                if command == "PG" {
                    prepared.extend_from_slice(b";SP1;");
                }
            }
            Some(Ok(Event::Byte { last: false, .. })) if command == "LB" => {
                if let Some(letter) = prepared.last_mut().filter(|letter| **letter > b' ') {
                    *letter = b' ';
                }
            }
            // A terminator that belongs to the label (`DT#,0`) is drawn too: here none does.
            _ if command == "DT" && prepared.ends_with(b",0") => {
                prepared.pop();
                prepared.push(b'1');
            }
            Some(Ok(Event::Byte { .. })) if command == "SM" => {
                prepared.pop();
                prepared.push(b';');
            }
            _ => {}
        }
    }
    if !initialized {
        prepared.splice(0..0, PLOTTER.iter().copied());
    }
    prepared
}

/// The lines as this reader draws them, plotter units.
fn ours(text: &[u8]) -> Vec<Segment> {
    let mut at = Point::ORIGIN;
    let units = |at: Point| Point::new(at.x * UNITS_PER_MM, at.y * UNITS_PER_MM);
    let mut lines = Vec::new();
    for op in chords(plot_ops(text).flatten(), CHORDS_MM) {
        if let PlotOp::Draw { to, .. } = op {
            lines.push(Segment::new(units(at), units(to)));
        }
        at = op.target().unwrap_or(at);
    }
    lines
}

/// The lines as hp2xx draws them, plotter units; none if it cannot be run.
fn theirs(text: &[u8], folder: &Path) -> io::Result<Vec<Segment>> {
    fs::create_dir_all(folder)?;
    let (from, to) = (FROM_UNITS.to_string(), TO_UNITS.to_string());
    fs::write(folder.join("in.hpgl"), text)?;
    let status = Command::new("hp2xx")
        .args(["-q", "-t", "-m", "hpgl", "-f", "out.hpgl"])
        .args(["-x", &from, "-y", &from, "-X", &to, "-Y", &to, "in.hpgl"])
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()?;
    assert!(status.success(), "hp2xx: {status}");
    let mut lines = Vec::new();
    // One file a page.
    for file in fs::read_dir(folder)? {
        let file = file?.path();
        if !file.file_name().is_some_and(|name| name.to_string_lossy().starts_with("out")) {
            continue;
        }
        let text = fs::read_to_string(&file)?;
        let mut at = Point::ORIGIN;
        for command in text.split(';').map(str::trim) {
            let (letters, numbers) = command.split_at(command.len().min(2));
            let numbers: Vec<f64> = numbers.split(',').filter_map(|number| number.parse().ok()).collect();
            let [x, y] = numbers[..] else { continue };
            let to = Point::new(x + f64::from(FROM_UNITS), y + f64::from(FROM_UNITS));
            if letters == "PD" {
                lines.push(Segment::new(at, to));
            }
            at = to;
        }
    }
    fs::remove_dir_all(folder)?;
    Ok(lines)
}

/// Lines that are found by where they are.
struct Lines<'a> {
    lines: &'a [Segment],
    cells: HashMap<(i64, i64), Vec<usize>>,
}

impl<'a> Lines<'a> {
    const CELL_UNITS: f64 = 50.0;

    #[expect(clippy::cast_possible_truncation, reason = "drawings are no larger than sheets")]
    fn cell(at: Point) -> (i64, i64) {
        ((at.x / Self::CELL_UNITS).floor() as i64, (at.y / Self::CELL_UNITS).floor() as i64)
    }

    fn new(lines: &'a [Segment]) -> Self {
        let mut cells: HashMap<_, Vec<usize>> = HashMap::new();
        for (index, line) in lines.iter().enumerate() {
            for at in places(*line, Self::CELL_UNITS / 3.0) {
                let cell = cells.entry(Self::cell(at)).or_default();
                if cell.last() != Some(&index) {
                    cell.push(index);
                }
            }
        }
        Self { lines, cells }
    }

    /// Distance of the nearest line, or more than a third of a cell.
    fn distance(&self, at: Point) -> f64 {
        let (x, y) = Self::cell(at);
        let near = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy)));
        let near = near.filter_map(|cell| self.cells.get(&cell)).flatten();
        let nearest = near.map(|index| self.lines[*index].distance(at)).fold(f64::INFINITY, f64::min);
        if nearest < Self::CELL_UNITS / 3.0 {
            return nearest;
        }
        self.lines.iter().map(|line| line.distance(at)).fold(f64::INFINITY, f64::min)
    }
}

fn places(line: Segment, every: f64) -> impl Iterator<Item = Point> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "lines are no longer than sheets"
    )]
    let steps = (line.length() / every).ceil().max(1.0) as u32;
    (0..=steps).map(move |step| line.from.lerp(line.to, f64::from(step) / f64::from(steps)))
}

/// The place of `of` that is farthest from `from`, and how far it is.
fn farthest(of: &[Segment], from: &[Segment]) -> (f64, Point) {
    let from = Lines::new(from);
    let all = of.iter().flat_map(|line| places(*line, EVERY_UNITS)).map(|at| (from.distance(at), at));
    all.fold((0.0, Point::ORIGIN), |worst, next| if next.0 > worst.0 { next } else { worst })
}

pub(crate) fn has_hp2xx() -> bool {
    let is_there = Command::new("hp2xx").arg("-v").stdin(Stdio::null()).output().is_ok();
    if !is_there {
        let thread = std::thread::current();
        let test = thread.name().unwrap_or("a test");
        let _ = writeln!(io::stderr(), "skipped: {test}: hp2xx is not installed");
    }
    is_there
}

/// The files by name; none where hp2xx is not at hand.
fn files() -> Vec<(String, PathBuf)> {
    if !has_hp2xx() {
        return Vec::new();
    }
    all("hpgl").into_iter().map(|file| (name_of(&file), file)).collect()
}

/// A folder for hp2xx to write to.
pub(crate) fn folder(test: &str) -> PathBuf {
    std::env::temp_dir().join(format!("hpgl_against_hp2xx_{test}_{}", std::process::id()))
}

/// Both ways between the two readings of a text.
pub(crate) fn compared(
    name: &str,
    text: &[u8],
    folder: &Path,
    tolerance_units: f64,
) -> io::Result<Result<(), String>> {
    let (ours, theirs) = (ours(text), theirs(text, folder)?);
    let (there, at) = farthest(&ours, &theirs);
    let (back, back_at) = farthest(&theirs, &ours);
    let line = format!(
        "{name}: {} and {} lines; {there:.3} at ({:.0}, {:.0}), {back:.3} at ({:.0}, {:.0})",
        ours.len(),
        theirs.len(),
        at.x,
        at.y,
        back_at.x,
        back_at.y
    );
    eprintln!("{line}");
    // An empty drawing is near to everything.
    let wrong = there.max(back) > tolerance_units + ROUNDING_UNITS || ours.is_empty() != theirs.is_empty();
    Ok(if wrong { Err(line) } else { Ok(()) })
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_line_of_the_real_files_is_where_hp2xx_draws_it() -> io::Result<()> {
    let mut wrong = Vec::new();
    println!("file: lines of ours and of hp2xx; farthest of ours from theirs, of theirs from ours, units");
    for (name, file) in files() {
        let exception = EXCEPTIONS.iter().find(|exception| exception.file == name);
        let text = prepared(&fs::read(&file)?, exception.map_or(&[], |exception| exception.left_out));
        let tolerance = exception.map_or(TOLERANCE_UNITS, |exception| exception.tolerance_units);
        wrong.extend(compared(&name, &text, &folder("real"), tolerance)?.err());
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    Ok(())
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_is_written_is_drawn_by_hp2xx_in_every_layout() -> io::Result<()> {
    let mut wrong = Vec::new();
    for (name, file) in files() {
        let text = fs::read(&file)?;
        for coordinates in [Coordinates::Absolute, Coordinates::Relative, Coordinates::Encoded] {
            let options = WriteOptions { coordinates, ..WriteOptions::default() };
            let mut writer = Writer::with_options(String::new(), options);
            // One page, in pen 1: hp2xx draws nothing with others that it does not know.
            let drawn = plot_ops(&text).flatten().take_while(|op| *op != PlotOp::NewPage);
            for op in drawn.filter(|op| op.target().is_some()) {
                writer.push(op).expect("a real drawing is in range");
            }
            let text = writer.finish().expect("a string takes all");
            let name = format!("{name}, {coordinates:?}");
            wrong.extend(compared(&name, text.as_bytes(), &folder("written"), TOLERANCE_UNITS)?.err());
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    Ok(())
}

/// Texts in the habits of programs and people, written for this test, of which hp2xx reads the whole.
const MANNERS: [(&str, &[u8]); 21] = [
    ("Inkscape", b"IN;SP1;PU0,0;PU400,1200;PD400,2000,1400,2000,1400,1200,400,1200;PU2000,1000;PD2400,1600,2800,1000;PU0,0;SP0;IN; "),
    ("Inkscape, relative", b"IN;SP1;PU0,0;PR;PU400,1200;PD0,800,1000,0,0,-800,-1000,0;PU1600,-200;PD400,600,400,-600;PA;PU0,0;SP0;"),
    ("pstoedit", b"IN;SC;PU;PU;SP1;LT;VS10\nSP2;PU762,1016;PD762,3048;PD2794,3048;PD2794,1016;PD762,1016;\nSP1;PU1000,1200;PD1500,1250;\n\
                   PU;SP;EC;PG1;EC1;OE\n"),
    ("QCad", b"\x1b%-1BBPIN;SP1;PA;PU1000,1000;PD5000,1000;PD5000,4000;PU3000,2500;CI600;PU2000,2000;AA1500,2000,90;PU;SP0;PG;"),
    ("Eagle", b"IN;IP0,0,10160,7620;SC0,100000,0,75000;SP1;VS5;LT;PA;PU 12700,25400;PD 50800,25400;PD 50800 50800;PU;SP2;\
                PA 10000 10000 PD 20000 20000PU;SP0;"),
    ("KiCad", b"IN;VS20;PU;PA;SP1;\nPU 1000,1000;PD 1000,3000;PD 3000,3000;PU 3500,2000;CI 300;PU;PA 500,500;AA 900,500,120.00,5;\nPU;PA 0,0;SP0;\n"),
    ("CorelDRAW", b"\x03;IN;VS32,1;VS32,2;WU0;PW0.350,1;LT;SP1;PU2000 3000;PD2500 3000 2500 3500 2000 3500 2000 3000;PU0 0;SP0;"),
    ("a cutter", b"\x03IN;PA;!ST1;!FS100;VS10;FS80;PU100,200;PD1000,200;PD1000,1000;PU;PA0,0;!PG;SP0;"),
    ("BASIC on a 7475A", b"\x1b.(\x1b.I81;;17:\x1b.N;19:\x1b.@;0:IN;SP1;PA 1000,1000;PD;PA 2000,1000\x1b.L;PA 2000,2000;PU;\x1b.Y\r\nSP 0\r\n\x1b.)"),
    ("signs for separators", b"IN SP1 PA100-200 PD300-200,300+400 PU PA-50+60PD0,0PU"),
    ("vpype", b"IN;DF;PS4;SP1;PU6000,4000;PD6500,4500,7000,4000;PU;PU3000,3000;PD3000,3500;PU;SP0;IN;"),
    ("decimals", b"IN;SP1;PU10.5,.5;PD400.25,.75,800.,+300.5;PR.5,-.5;PA;PU;"),
    ("no separators", b"INSP1PU400 400PD800 400 800 800PUPA1000 1000PDPR100 0 0 100PU"),
    ("lower case", b"in;sp1;pu400,400;pd800,400,800,800;pu;pa1000,1000;ci200;sp0;"),
    ("SC, isotropic", b"IN;IP1000,1000,9000,5000;SC0,100,0,100,1;SP1;PU0,0;PD100,0,100,100,0,100,0,0;PU;"),
    ("SC, isotropic, to the left", b"IN;IP1000,1000,9000,5000;SC0,100,0,100,1,0,0;SP1;PU0,0;PD100,0,100,100,0,100,0,0;PU;"),
    ("SC, isotropic, to the right", b"IN;IP1000,1000,9000,5000;SC0,100,0,100,1,100,50;SP1;PU0,0;PD100,0,100,100,0,100,0,0;PU;"),
    ("SC, by a point and factors", b"IN;IP1000,1000,9000,5000;SC0,40,0,20,2;SP1;PU0,0;PD100,0,100,100,0,100,0,0;PU;"),
    ("SC, mirrored and off", b"IN;IP1000,1000,9000,5000;SC100,0,0,50;SP1;PU0,0;PD100,0,100,50;PU;SC;PU20,20;PD500,600;PU;"),
    ("arcs", b"IN;SP1;PA2000,2000;PD;AA3000,2000,180;AR0,1000,-90;PU;PA6000,3000;PD;AA5000,3000,360;PU;PA500,500;PD;AA500,1500,-45,15;PU;"),
    ("rectangles", b"IN;SP1;PA1000,1000;EA2000,3000;ER500,500;PU3000,3000;EA2500,2500;PU4000,1000;ER-200,700;PU;RO90;PU500,500;PD900,500;PU;"),
];

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn texts_in_the_manner_of_programs_are_where_hp2xx_draws_them() -> io::Result<()> {
    let mut wrong = Vec::new();
    for (name, text) in MANNERS {
        // What is for cutters is named; nothing is wrong with it.
        let complaints = plot_ops(text).filter_map(Result::err).filter(|error| !error.is_notice());
        let complaints: Vec<String> = complaints.map(|error| error.to_string()).collect();
        assert_eq!(complaints, Vec::<String>::new(), "{name}");
        if has_hp2xx() {
            wrong.extend(compared(name, &prepared(text, &[]), &folder("manners"), TOLERANCE_UNITS)?.err());
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    Ok(())
}
