//! `follow --live`: a machine that is led over lines by what its camera sees, and says when it is there.
#![cfg(all(feature = "live", unix))]

use crate::built_example;

use built_example::{complaint, run_example};
use plotter_replay::log::{Event, open};
use plotter_vector::PxPoint;
use plotter_vector::follow::{CameraSettings, Paper, SimulatedCamera};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::time::{Duration, Instant};

/// A step of the machine's motors, px: 80 to the millimetre, 10 px to the millimetre.
const STEP_PX: f64 = 0.125;
/// Longer than any of these takes on a computer that is busy with other things.
const FOR_EVER: Duration = Duration::from_secs(600);
const AS_FAST_AS_IT_GOES: &str = "1000000";

/// A machine of 40 x 30 mm, whose pen waits for next to nothing; keys of its table `[follower]`.
fn machine(folder: &Path, follower: &str) -> String {
    let text = include_str!("../../machines/plasma-follower.toml")
        .replace("width_mm = 1000.0", "width_mm = 40.0")
        .replace("height_mm = 500.0", "height_mm = 30.0")
        .replace("settle_ms = 800.0", "settle_ms = 20.0");
    let (before, table) = text.split_once("[follower]").unwrap();
    let (_, behind) = table.split_once("# The laser").unwrap();
    let path = folder.join("machine.toml");
    std::fs::write(&path, format!("{before}[follower]\n{follower}\n# The laser{behind}")).unwrap();
    path.to_str().unwrap().to_owned()
}

fn picture(folder: &Path, is_ink: impl Fn(f64, f64) -> bool) -> String {
    let path = folder.join("drawing.png");
    let ink = |x: u32, y: u32| is_ink(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let image = image::GrayImage::from_fn(400, 300, |x, y| image::Luma([if ink(x, y) { 0 } else { 255 }]));
    image.save(&path).unwrap();
    path.to_str().unwrap().to_owned()
}

/// A ring with a line across it.
fn ring(x: f64, y: f64) -> bool {
    let (dx, dy) = (x - 150.0, y - 150.0);
    let radius = dx.hypot(dy);
    (radius - 70.0).abs() < 2.0 || (radius < 70.0 && dy.abs() < 2.0)
}

/// A line with a corner.
fn corner(x: f64, y: f64) -> bool {
    ((148.0..152.0).contains(&y) && (100.0..232.0).contains(&x))
        || ((228.0..232.0).contains(&x) && (100.0..150.0).contains(&y))
}

/// So short that it is followed in the machine's own time.
fn dash(x: f64, y: f64) -> bool {
    (148.0..152.0).contains(&y) && (170.0..230.0).contains(&x)
}

fn report(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn strokes(report: &Value) -> Vec<Vec<PxPoint>> {
    let place = |at: &Value| PxPoint::new(at[0].as_f64().unwrap(), at[1].as_f64().unwrap());
    let strokes = report["strokes"].as_array().unwrap().iter();
    strokes.map(|stroke| stroke.as_array().unwrap().iter().map(place).collect()).collect()
}

/// How far the places of one line are from another, at most.
fn off(line: &[PxPoint], other: &[PxPoint]) -> f64 {
    let nearest = |at: &PxPoint| {
        let to_piece = |pair: &[PxPoint]| {
            let (from, way) = (pair[0], pair[1] - pair[0]);
            let length = way.x * way.x + way.y * way.y;
            let share = if length > 0.0 {
                (((at.x - from.x) * way.x + (at.y - from.y) * way.y) / length).clamp(0.0, 1.0)
            } else {
                0.0
            };
            at.distance(from + way * share)
        };
        other.windows(2).map(to_piece).fold(f64::INFINITY, f64::min)
    };
    line.iter().map(nearest).fold(0.0, f64::max)
}

/// A machine of `plotter simulate` on a port of this computer; lines of a script may be typed to it.
struct Simulated {
    child: Child,
    keyboard: ChildStdin,
    port: String,
}

impl Simulated {
    fn new(machine: &str, dialect: &str, speed: &str) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_plotter"))
            .args(["simulate", machine, "--dialect", dialect, "--tcp", "0", "--speed", speed, "--by-hand"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let keyboard = child.stdin.take().unwrap();
        let mut said = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let first = said.next().unwrap();
        let port =
            first.split(" is simulated on ").nth(1).unwrap_or_else(|| panic!("{first}")).trim().to_owned();
        std::thread::spawn(move || said.for_each(drop)); // lest it waits for somebody to listen
        Self { child, keyboard, port: format!("tcp:{port}") }
    }
}

impl Drop for Simulated {
    fn drop(&mut self) {
        let _ = self.child.kill(); // it may be gone
        let _ = self.child.wait();
    }
}

/// A folder with a machine, and what a run on it leaves there.
struct Run {
    folder: tempfile::TempDir,
    machine: String,
    moves: String,
    report: String,
    log: String,
}

impl Run {
    /// `keys` are lines of the machine's `[follower]`.
    fn new(keys: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        let (moves, report, log) = (file("m.csv"), file("r.json"), file("led.plog"));
        Self { machine: machine(folder.path(), keys), folder, moves, report, log }
    }

    /// Arguments of `follow` for it, and others with a space between them.
    fn arguments<'a>(&'a self, input: &[&'a str], others: &'a str) -> Vec<&'a str> {
        let [moves, report, log] = [&self.moves, &self.report, &self.log];
        let files = ["--machine", &self.machine, "--moves", moves, "--report", report, "--log", log];
        input.iter().copied().chain(files).chain(others.split(' ')).collect()
    }
}

/// Follows a drawing twice, with no machine and with one: the followed lines are the same within a step.
fn follows_as_without(folder: &Path, machine: &str, image: &str, live: &[&str]) {
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (alone, led, log) = (file("alone.json"), file("led.json"), file("led.plog"));
    let usual = [image, "--machine", machine, "--camera", "size=160"];
    let output = run_example("follow", &[&usual[..], &["--report", &alone]].concat());
    assert!(output.status.success(), "{output:?}");
    let began = Instant::now();
    let output = run_example("follow", &[&usual[..], &["--report", &led, "--log", &log], live].concat());
    assert!(output.status.success(), "{live:?}: {output:?}");
    let (alone, led) = (report(Path::new(&alone)), report(Path::new(&led)));
    println!("{live:?}: {} windows, {:?}", led["windows"], began.elapsed());
    assert_eq!(led["finished"], Value::Bool(true), "{live:?}");
    let (alone, led) = (strokes(&alone), strokes(&led));
    assert_eq!(alone.len(), led.len(), "{live:?}");
    for (alone, led) in alone.iter().zip(&led) {
        let off = off(alone, led).max(off(led, alone));
        println!("{live:?}: off by {off} px");
        assert!(off <= STEP_PX + 0.01, "{live:?}: {off} px");
    }
}

#[test]
fn the_line_is_that_of_no_machine_within_a_step_on_a_grbl_machine_behind_a_port() {
    let folder = tempfile::tempdir().unwrap();
    let machine = machine(folder.path(), "");
    let image = picture(folder.path(), dash);
    let simulated = Simulated::new(&machine, "grbl", "10");
    follows_as_without(folder.path(), &machine, &image, &["--live", &simulated.port]);
}

#[test]
fn the_line_is_that_of_no_machine_in_every_language() {
    let folder = tempfile::tempdir().unwrap();
    let machine = machine(folder.path(), "");
    let image = picture(folder.path(), corner);
    for protocol in ["grbl", "marlin", "mdraw", "ebb"] {
        let live = ["--live", "simulated", "--protocol", protocol, "--speed", AS_FAST_AS_IT_GOES];
        follows_as_without(folder.path(), &machine, &image, &live);
    }
}

/// Follows a ring on a machine to which something happens on the way: it ends with these words, what was
/// followed is kept, and nothing was drawn.
fn ends_in_the_middle(happens: impl FnOnce(&mut Simulated), words: [&str; 2]) {
    let report = ends_behind(60, happens, words);
    assert!(report["path_points"].as_array().unwrap().len() > 5, "{report}");
}

/// The same behind so many rows of its list of moves, at which nothing may have been followed yet; the report.
fn ends_behind(least: usize, happens: impl FnOnce(&mut Simulated), words: [&str; 2]) -> Value {
    let run = Run::new("");
    let image = picture(run.folder.path(), ring);
    let mut simulated = Simulated::new(&run.machine, "grbl", "10");
    let others = format!("--camera size=160 --live {} --protocol grbl --draw", simulated.port);
    let arguments = run.arguments(&[&image], &others);
    let rows = || std::fs::read_to_string(&run.moves).map_or(0, |text| text.lines().count());
    let output = std::thread::scope(|scope| {
        let led = scope.spawn(|| run_example("follow", &arguments));
        let until = Instant::now() + FOR_EVER;
        while rows() < least && !led.is_finished() {
            assert!(Instant::now() < until, "it does not begin");
            std::thread::sleep(Duration::from_millis(20));
        }
        happens(&mut simulated);
        led.join().unwrap()
    });
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(words.iter().all(|words| said.contains(words)), "{words:?}: {said}");
    assert!(said.contains("(before picture ") && said.contains(" mm)"), "{said}");
    let value = report(Path::new(&run.report));
    assert_eq!(value["finished"], Value::Bool(false));
    assert!(rows() >= least, "{value}");
    let sent = sent(Path::new(&run.log));
    assert!(sent.contains("G0 X") && !sent.contains("M3"), "{sent}"); // it only looked
    value
}

#[test]
fn an_alarm_in_the_middle_ends_it() {
    let pressed = |simulated: &mut Simulated| writeln!(simulated.keyboard, "press x-min").unwrap();
    ends_in_the_middle(pressed, ["the machine was stopped:", "alarm"]);
}

#[test]
fn a_reset_in_the_middle_ends_it() {
    let reset = |simulated: &mut Simulated| writeln!(simulated.keyboard, "restart").unwrap();
    ends_in_the_middle(reset, ["switched off or reset on its way", "home"]);
}

/// It stands while a window is looked at, and is reset there.
#[test]
fn a_reset_between_two_ways_ends_it() {
    let reset = |simulated: &mut Simulated| writeln!(simulated.keyboard, "restart").unwrap();
    ends_behind(20, reset, ["switched off or reset on its way", "home"]);
}

#[test]
#[cfg(unix)]
fn silence_in_the_middle_ends_it() {
    // Its line stays open, and nobody answers.
    let silenced = |simulated: &mut Simulated| {
        let process = simulated.child.id().to_string();
        assert!(Command::new("kill").args(["-STOP", &process]).status().unwrap().success());
    };
    ends_in_the_middle(silenced, ["nothing comes from the machine", "cable"]);
}

#[test]
fn a_line_that_is_closed_in_the_middle_ends_it() {
    let killed = |simulated: &mut Simulated| simulated.child.kill().unwrap();
    ends_in_the_middle(killed, ["line", "tcp:"]);
}

/// The lines that the host has sent, without its questions between their bytes.
fn sent(log: &Path) -> String {
    let records = open(log).unwrap().map(|record| record.unwrap().event);
    let bytes: Vec<u8> = records
        .filter_map(|event| if let Event::Host(bytes) = event { Some(bytes) } else { None })
        .flatten()
        .filter(|byte| *byte != b'?')
        .collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Places of the lines of G-code that draw, mm, each behind the place where the tool was lowered.
fn drawn(sent: &str) -> Vec<Vec<(f64, f64)>> {
    let number = |line: &str, axis: char| {
        line.split(' ').find_map(|word| word.strip_prefix(axis)).map(|number| number.parse::<f64>().unwrap())
    };
    let (mut at, mut lines) = ((0.0, 0.0), Vec::<Vec<(f64, f64)>>::new());
    for line in sent
        .lines()
        .filter(|line| line.starts_with("G0 ") || line.starts_with("G1 ") || line.starts_with("M3"))
    {
        at = (number(line, 'X').unwrap_or(at.0), number(line, 'Y').unwrap_or(at.1));
        match line.as_bytes() {
            [b'M', ..] => lines.push(vec![at]),
            [b'G', b'1', ..] => lines.last_mut().unwrap().push(at),
            _ => {}
        }
    }
    lines
}

#[test]
fn the_tool_draws_what_the_camera_beside_it_has_followed_half_the_kerf_on_the_right() {
    for kerf_mm in [0.0, 1.0] {
        let run = Run::new(&format!("camera_x_mm = 5.0\ncamera_y_mm = -3.0\nkerf_mm = {kerf_mm:.1}"));
        let line = |x: f64, y: f64| (148.0..152.0).contains(&y) && (100.0..232.0).contains(&x);
        let image = picture(run.folder.path(), line);
        let others =
            format!("--camera size=160 --live simulated --protocol grbl --speed {AS_FAST_AS_IT_GOES} --draw");
        let arguments = run.arguments(&[&image], &others);
        let output = run_example("follow", &arguments);
        assert!(output.status.success(), "{output:?}");
        let (value, sent) = (report(Path::new(&run.report)), sent(Path::new(&run.log)));
        let (drawn, followed) = (drawn(&sent), strokes(&value));
        assert_eq!((drawn.len(), followed.len()), (1, 1), "{sent}");
        // The machine's y runs up, and the picture has all of its height.
        let on_sheet: Vec<PxPoint> =
            followed[0].iter().map(|at| PxPoint::new(0.1 * at.x, 30.0 - 0.1 * at.y)).collect();
        let way = on_sheet[on_sheet.len() - 1].x - on_sheet[0].x;
        let beside = -0.5 * kerf_mm * way.signum();
        let drawn: Vec<PxPoint> = drawn[0].iter().map(|&(x, y)| PxPoint::new(x, y - beside)).collect();
        let off = off(&drawn, &on_sheet).max(off(&on_sheet, &drawn));
        println!("kerf {kerf_mm}: off by {off} mm");
        assert!(off < 0.03 && way.abs() > 12.0, "kerf {kerf_mm}: {off} mm of {way}: {drawn:?}");
    }
}

/// Somebody who takes a picture whenever the machine is there: moves as the table tells them, pictures by the
/// number of the move; the camera is turned.
fn photographs(
    folder: &Path,
    moves: &Path,
    lines: &[Vec<PxPoint>],
    turn_deg: f64,
    is_over: &dyn Fn() -> bool,
) {
    let (sin, cos) = turn_deg.to_radians().sin_cos();
    let (mut taken, until) = (BTreeMap::new(), Instant::now() + FOR_EVER);
    while !is_over() {
        assert!(Instant::now() < until, "it does not end");
        std::thread::sleep(Duration::from_millis(5));
        let text = std::fs::read_to_string(moves).unwrap_or_default();
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let last = whole.lines().skip(1).last().map(|line| line.split(',').collect::<Vec<_>>());
        let Some(words) = last else { continue };
        let number: u32 = words[0].parse().unwrap();
        let at = PxPoint::new(words[2].parse().unwrap(), words[3].parse().unwrap());
        if taken.insert(number, at).is_some() {
            continue;
        }
        // The sheet as it lies under a camera that is turned counterclockwise.
        let seen = |place: &PxPoint| {
            let (right, down) = (place.x - at.x, place.y - at.y);
            PxPoint::new(120.0 + right * cos - down * sin, 120.0 + right * sin + down * cos)
        };
        let strokes: Vec<_> =
            lines.iter().map(|line| (line.iter().map(seen).collect::<Vec<_>>(), 4.0)).collect();
        let paper = Paper::drawn(240, 240, &strokes).unwrap();
        let (width_px, height_px) = (240, 240);
        let settings = CameraSettings::default()
            .with_width_px(width_px)
            .with_height_px(height_px)
            .with_noise_levels(2.0);
        let window = SimulatedCamera::new(&paper, settings).window(PxPoint::new(120.0, 120.0));
        let picture = image::GrayImage::from_raw(240, 240, window.pixels().to_vec()).unwrap();
        picture.save(folder.join(format!("{number:04}.png"))).unwrap();
    }
}

#[test]
fn a_folder_is_waited_for_and_the_camera_may_be_turned() {
    let run = Run::new("camera_turn_deg = 30.0");
    let pictures = run.folder.path().join("pictures");
    std::fs::create_dir(&pictures).unwrap();
    let others = format!(
        "--start 200,150 --live simulated --protocol grbl --speed {AS_FAST_AS_IT_GOES} --settle-ms 0"
    );
    let arguments = run.arguments(&["--from", pictures.to_str().unwrap()], &others);
    let line = |places: &[(f64, f64)]| places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect::<Vec<_>>();
    let lines = [line(&[(140.0, 180.0), (210.0, 120.0), (290.0, 170.0)])];
    let output = std::thread::scope(|scope| {
        let led = scope.spawn(|| run_example("follow", &arguments));
        photographs(&pictures, Path::new(&run.moves), &lines, 30.0, &|| led.is_finished());
        led.join().unwrap()
    });
    assert!(output.status.success(), "{output:?}");
    let followed = strokes(&report(Path::new(&run.report)));
    let whole: Vec<PxPoint> = followed.concat();
    let off = off(&whole, &lines[0]).max(off(&lines[0], &whole));
    println!("off by {off} px");
    assert!(off < 3.0, "{off} px: {whole:?}"); // ends of lines, at most; turned the wrong way it is tens
    // Its pictures are old ones for the next run.
    let refused = run_example("follow", &arguments);
    assert_eq!(refused.status.code(), Some(1));
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(said.contains("was here before the machine was: empty the folder"), "{said}");
}

#[test]
fn what_is_missing_or_wrong_is_said_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let (usual, image) = (machine(folder.path(), ""), picture(folder.path(), corner));
    let log = folder.path().join("led.plog");
    let log = ["--log", log.to_str().unwrap()];
    let wrong = run_example("follow", &["--live", "simulated", "--protocol", "klingon"]);
    assert_eq!(wrong.status.code(), Some(2));
    let said = String::from_utf8_lossy(&wrong.stderr);
    assert!(
        said.contains("--protocol klingon") && said.contains("known are auto, grbl, mdraw, marlin"),
        "{said}"
    );
    let live =
        |arguments: &[&str]| complaint("follow", &[&["--machine", &usual], &log[..], arguments].concat());
    // A port that nobody listens at, and one where nobody answers.
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", taken.local_addr().unwrap());
    let output = run_example("follow", &[&image, "--machine", &usual, "--live", &port, log[0], log[1]]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && said.contains("nothing that is there answers"), "{said}");
    drop(taken);
    assert!(live(&[&image, "--live", &port, "--protocol", "grbl"]).contains("is the machine on"));
    assert!(
        live(&[&image, "--live", "/dev/no-such-plotter", "--protocol", "grbl"])
            .contains("no such serial port")
    );
    // A picture that does not come.
    let pictures = folder.path().join("pictures");
    std::fs::create_dir(&pictures).unwrap();
    let simulated = ["--live", "simulated", "--protocol", "grbl", "--speed", AS_FAST_AS_IT_GOES];
    let from = ["--from", pictures.to_str().unwrap(), "--picture-s", "1"];
    let output =
        run_example("follow", &[&["--machine", &usual], &log[..], &simulated[..], &from[..]].concat());
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(1) && said.contains("no picture 0 (such as 0.png) came within 1 s"),
        "{said}"
    );
    // A camera so far beside the tool that both reach nothing, and a line that leaves the machine.
    let far = machine(folder.path(), "camera_x_mm = 50.0");
    let told = complaint("follow", &[&[&image[..], "--machine", &far], &log[..], &simulated[..]].concat());
    assert!(told.contains("camera and tool both reach") && told.contains("[follower]"), "{told}");
    let near = machine(folder.path(), "camera_x_mm = 10.0");
    let long = picture(folder.path(), |x, y| (148.0..152.0).contains(&y) && (40.0..360.0).contains(&x));
    let output =
        run_example("follow", &[&[&long[..], "--machine", &near], &log[..], &simulated[..]].concat());
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("a line leaves the machine's area: 1 times"), "{output:?}");
    let least = sent(Path::new(log[1]))
        .lines()
        .filter_map(|line| line.strip_prefix("G0 X")?.split(' ').next()?.parse().ok())
        .fold(f64::MAX, f64::min);
    assert!(least >= 0.0, "{least} mm");
}
