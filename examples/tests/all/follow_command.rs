//! The commands `follow` and `calibrate_camera`: what they write and measure, and what they say to bad input.

use crate::built_example;

use built_example::{complaint, data, run_example};
use plotter_examples::follow::FollowMachine;
use plotter_motion::Machine;
use plotter_vector::PxPoint;
use plotter_vector::follow::{
    CameraSettings, LineFollower, MappingFollower, MappingSettings, Paper, SimulatedCamera, Step,
};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

fn report(path: &str) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn said(output: &Output) -> (String, String) {
    (
        String::from_utf8_lossy(&output.stdout).into_owned(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

fn picture(folder: &tempfile::TempDir, name: &str, is_ink: impl Fn(u32, u32) -> bool) -> String {
    let path = folder.path().join(name);
    let image = image::GrayImage::from_fn(400, 300, |x, y| image::Luma([if is_ink(x, y) { 0 } else { 255 }]));
    image.save(&path).unwrap();
    path.to_str().unwrap().to_owned()
}

/// A ring, a cross in it, and a line of its own.
fn drawing(x: u32, y: u32) -> bool {
    let (dx, dy) = (f64::from(x) - 150.0, f64::from(y) - 150.0);
    let radius = dx.hypot(dy);
    (radius - 100.0).abs() < 2.5
        || (radius < 100.0 && (dx.abs() < 2.0 || dy.abs() < 2.0))
        || ((330..334).contains(&x) && (40..260).contains(&y))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_drawing_is_followed_and_every_file_written() {
    let folder = tempfile::tempdir().unwrap();
    let image = picture(&folder, "drawing.png", drawing);
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (svg, page, report) = (file("f.svg"), file("f.html"), file("f.json"));
    let arguments =
        [&image, "--camera", "size=160", "--svg", &svg, "--animation", &page, "--report", &report];
    let output = run_example("follow", &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let value = self::report(&report);
    assert_eq!(value["finished"], true);
    let number = |key: &str| value[key].as_f64().unwrap();
    assert!(number("coverage") > 0.99 && number("rms_px") < 0.5 && number("repeated") < 0.03, "{output:?}");
    assert!(
        number("windows") > 50.0
            && number("moves") <= number("windows")
            && number("max_px") >= number("rms_px")
    );
    // The path is in pixels of the picture: it begins and ends on the drawing's ink, and is as long as its lines.
    let path = value["path_points"].as_array().unwrap();
    let place = |i: usize| [0, 1].map(|axis| path[i][axis].as_f64().unwrap());
    for [x, y] in [place(0), place(path.len() / 2), place(path.len() - 1)] {
        let is_here = |u: u32, v: u32| (f64::from(u) + 0.5 - x).hypot(f64::from(v) + 0.5 - y) < 3.0;
        let near = (0..300).any(|v| (0..400).any(|u| drawing(u, v) && is_here(u, v)));
        assert!(near, "{x} {y}");
    }
    assert!(path.len() > 800 && (number("path_px") / number("lines_px") - 1.0).abs() < 0.05);
    let strokes = value["strokes"].as_array().unwrap();
    assert_eq!(strokes.len() as f64, number("lifts") + 1.0);
    assert_eq!(strokes.iter().map(|stroke| stroke.as_array().unwrap().len()).sum::<usize>(), path.len());
    assert!(std::fs::read_to_string(&svg).unwrap().contains("<polyline"));
    assert!(std::fs::read_to_string(&page).unwrap().contains("requestAnimationFrame"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_published_follower_is_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let image = picture(&folder, "drawing.png", drawing);
    let output =
        run_example("follow", &[&image, "--method", "published", "--hand", "left", "--windows", "20"]);
    assert!(output.status.success());
    assert!(String::from_utf8(output.stdout).unwrap().contains("stopped after 20 windows"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn bad_input_is_told_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let white = picture(&folder, "white.png", |_, _| false);
    assert!(complaint("follow", &[&white]).contains("no line in view at"));
    assert!(complaint("follow", &["missing.png"]).contains("missing.png: cannot be read"));
    assert!(complaint("calibrate_camera", &[&white]).contains("0 crossings of lines"));
    assert!(complaint("calibrate_camera", &[&data("flag.png")]).contains("flag.png: "));
    let output = run_example("follow", &["--camera", "blurr=2"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("none of blur, noise, rim, barrel, size"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn without_lines_nothing_is_covered() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("f.json").to_str().unwrap().to_owned();
    let white = picture(&folder, "white.png", |_, _| false);
    let output = run_example("follow", &[&white, "--report", &file]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let value = report(&file);
    assert_eq!((&value["finished"], &value["coverage"]), (&Value::Bool(false), &Value::Null));
    assert!(!said(&output).0.contains("covered"), "{output:?}");
    // The last window shows none of the area.
    let area = picture(&folder, "area.png", |x, y| (130..270).contains(&x) && (30..170).contains(&y));
    assert!(complaint("follow", &[&area, "--camera", "size=160"]).contains("no line but an area"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_grid_calibrates_the_simulated_camera() {
    let output = run_example("calibrate_camera", &["--barrel", "0.05"]);
    let text = String::from_utf8(output.stdout).unwrap();
    let pitch = text.split("pitch ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    let pitch_px: f64 = pitch.parse().unwrap();
    assert!(output.status.success() && (pitch_px - 20.0).abs() < 0.1, "{text}");
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn the_animation_is_a_picture_of_bounded_size_and_time() {
    let folder = tempfile::tempdir().unwrap();
    let image = picture(&folder, "drawing.png", drawing);
    let path = folder.path().join("f.gif");
    let output =
        run_example("follow", &[&image, "--camera", "size=160", "--animation", path.to_str().unwrap()]);
    assert!(output.status.success(), "{output:?}");
    let bytes = std::fs::read(&path).unwrap();
    let mut decoder = gif::DecodeOptions::new().read_info(bytes.as_slice()).unwrap();
    let (mut count, mut time) = (0, 0);
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        (count, time) = (count + 1, time + u32::from(frame.delay));
    }
    assert!((80..=161).contains(&count) && (1000..2000).contains(&time), "{count} pictures, {time} / 100 s");
    assert!(bytes.len() < 2_000_000, "{}", bytes.len());
    let refused = run_example("follow", &["--animation", "f.mp4"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).1.contains("name it F.gif or F.html"));
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn a_correction_makes_a_bent_picture_straight() {
    let folder = tempfile::tempdir().unwrap();
    // A frame and a line across it.
    let image = picture(&folder, "drawing.png", |x, y| {
        let at = |v: u32, place: u32| (place..place + 5).contains(&v);
        let inside = (40..365).contains(&x) && (30..275).contains(&y);
        inside && (at(x, 40) || at(x, 360) || at(y, 30) || at(y, 270) || at(y, 150))
    });
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (camera, bent, straight) = (file("camera.json"), file("bent.json"), file("straight.json"));
    let measured = run_example("calibrate_camera", &["--barrel", "0.2", "--correction", &camera]);
    assert!(measured.status.success(), "{measured:?}");
    let lens = ["--camera", "barrel=0.2"];
    run_example("follow", &[&[image.as_str(), "--report", &bent], &lens[..]].concat());
    let with = [&[image.as_str(), "--report", &straight, "--correction", &camera], &lens[..]].concat();
    let output = run_example("follow", &with);
    assert!(output.status.success(), "{output:?}");
    let number = |path: &str, key: &str| report(path)[key].as_f64().unwrap();
    println!("{} {}", report(&bent)["end"], number(&bent, "rms_px"));
    assert!(number(&straight, "coverage") > 0.99 && number(&straight, "rms_px") < 0.4, "{output:?}");
    assert!(number(&straight, "repeated") < 0.03 && number(&straight, "max_px") < 4.0, "{output:?}");
    let worse = number(&bent, "rms_px") > 2.0 * number(&straight, "rms_px")
        || number(&bent, "coverage") < 0.95
        || number(&bent, "repeated") > 0.1;
    assert!(
        worse,
        "the lens matters: {:?}",
        std::fs::read_to_string(&bent).map(|text| text[..400].to_owned())
    );
    // The published method takes it too.
    let published = [&with[..], &["--method", "published", "--windows", "3"]].concat();
    assert!(run_example("follow", &published).status.success());
    // It fits windows of one size only.
    let other = complaint("follow", &[&image, "--correction", &camera, "--camera", "size=200"]);
    assert!(other.contains("the correction is for windows of 300 x 300 px"), "{other}");
    assert!(
        complaint("follow", &[&image, "--correction", &image])
            .contains("is no correction of calibrate_camera")
    );
}

/// A machine of 24 x 18 mm, 240 x 180 px, and a drawing that fits.
fn small(folder: &Path) -> (String, Paper) {
    let text = include_str!("../../machines/plasma-follower.toml")
        .replace("width_mm = 1000.0", "width_mm = 24.0")
        .replace("height_mm = 500.0", "height_mm = 18.0");
    let path = folder.join("small.toml");
    std::fs::write(&path, text).unwrap();
    let line = |places: &[(f64, f64)]| places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect::<Vec<_>>();
    let strokes = [(line(&[(60.0, 120.0), (110.0, 60.0), (180.0, 110.0)]), 4.0)];
    (path.to_str().unwrap().to_owned(), Paper::drawn(240, 180, &strokes).unwrap())
}

/// Writes what a camera sees when the machine goes where the follower says, and returns where it was sent.
fn record(windows: &Path, machine: &str, paper: &Paper) -> Vec<PxPoint> {
    let machine = Machine::from_toml(&std::fs::read_to_string(machine).unwrap()).unwrap();
    let mut machine = FollowMachine::new(&machine, 0.1, None, Some([120.0, 90.0])).unwrap();
    let settings = CameraSettings::default()
        .with_width_px(140)
        .with_height_px(120)
        .with_noise_levels(2.0)
        .with_rim_light(1.0);
    let mut camera = SimulatedCamera::new(paper, settings);
    let area = Some(machine.area());
    let mut follower = MappingFollower::new(MappingSettings::default().with_area(area));
    let mut commands = Vec::new();
    for index in 0..2000 {
        let file = windows.join(format!("{index:04}.png"));
        let seen = camera.window(machine.at());
        image::GrayImage::from_raw(140, 120, seen.pixels().to_vec()).unwrap().save(&file).unwrap();
        // The square middle of it, as the command cuts it out.
        let levels = seen.rows().flat_map(|row| &row[10..130]).copied().collect();
        let window = plotter_vector::Gray::new(120, 120, levels).unwrap();
        match follower.observe(&window, machine.at()) {
            Step::Move { path, tool } => {
                machine.make(&path, tool, &mut |_, _| {}).unwrap();
                commands.extend(path);
            }
            Step::LineLost { .. } => {}
            Step::Done(_) => return commands,
        }
    }
    panic!("no end");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_folder_of_pictures_stands_in_for_a_camera() {
    let folder = tempfile::tempdir().unwrap();
    let windows = folder.path().join("windows");
    std::fs::create_dir(&windows).unwrap();
    let (machine, paper) = small(folder.path());
    let commands = record(&windows, &machine, &paper);
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (moves, gcode, written) = (file("m.csv"), file("m.gcode"), file("r.json"));
    let from = ["--from", windows.to_str().unwrap(), "--machine", &machine, "--start", "120,90"];
    let output = run_example("follow", &[&from[..], &["--moves", &moves, "--report", &written]].concat());
    assert!(output.status.success(), "{output:?}");
    let value = report(&written);
    assert_eq!((&value["finished"], &value["coverage"]), (&Value::Bool(true), &Value::Null));
    let text = std::fs::read_to_string(&moves).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("move,tool,x_px,y_px,x_mm,y_mm"));
    let sent: Vec<[f64; 4]> = lines
        .map(|line| line.split(',').skip(2).map(|number| number.parse().unwrap()).collect::<Vec<f64>>())
        .map(|numbers| numbers.try_into().unwrap())
        .collect();
    assert_eq!((sent.len(), sent[0]), (commands.len() + 1, [120.0, 90.0, 12.0, 9.0]), "first to the start");
    for ([x, y, x_mm, y_mm], to) in sent.into_iter().skip(1).zip(&commands) {
        assert!((x - to.x).abs() < 1e-3 && (y - to.y).abs() < 1e-3, "{x} {y} {to:?}");
        assert!((x_mm - 0.1 * to.x).abs() < 1e-3 && (y_mm - (18.0 - 0.1 * to.y)).abs() < 1e-3);
    }
    // Printed, they are the same; as G-code each move is a line.
    let printed = run_example("follow", &from);
    assert!(printed.status.success() && said(&printed).0 == text, "{printed:?}");
    assert!(run_example("follow", &[&from[..], &["--moves", &gcode]].concat()).status.success());
    let text = std::fs::read_to_string(&gcode).unwrap();
    assert!(text.starts_with("G21\nG90\n") && text.ends_with("M2\n"));
    let lines = text.lines().filter(|line| line.starts_with("G0 X") || line.starts_with("G1 X")).count();
    assert!(lines > commands.len() / 2, "{lines} {}", commands.len());
    // A folder that ends too early is an end with a place, a picture too small one with its size.
    let mut pictures: Vec<_> =
        std::fs::read_dir(&windows).unwrap().map(|entry| entry.unwrap().path()).collect();
    pictures.sort();
    pictures.split_off(9).into_iter().for_each(|path| std::fs::remove_file(path).unwrap());
    let ended = run_example("follow", &from);
    assert_eq!(ended.status.code(), Some(1));
    assert!(said(&ended).1.contains("no more pictures after 9"), "{ended:?}");
    let large = run_example("follow", &[&from[..], &["--window", "200"]].concat());
    assert!(
        said(&large).1.contains("a picture of 140 x 120 px, too small for windows of 200 px"),
        "{large:?}"
    );
}

#[test]
fn a_source_without_pictures_is_told() {
    let folder = tempfile::tempdir().unwrap();
    assert!(complaint("follow", &["--from", folder.path().to_str().unwrap()]).contains("no pictures in it"));
    assert!(complaint("follow", &["--from", "/dev/video_missing"]).contains("cannot be opened"));
    if cfg!(target_os = "linux") {
        let told = complaint("follow", &["--from", "/dev/null"]);
        assert!(told.contains("--features camera") || told.contains("cannot be used as a camera"), "{told}");
    }
    let broken = folder.path().join("a.png");
    std::fs::write(&broken, "no picture").unwrap();
    let told = run_example("follow", &["--from", folder.path().to_str().unwrap()]);
    assert!(!told.status.success() && said(&told).1.contains("a.png: "), "{told:?}");
}

#[test]
fn options_that_do_nothing_or_cannot_work_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let image = picture(&folder, "drawing.png", drawing);
    for (arguments, says) in [
        (["--window", "30"], "--window is for --from"),
        (["--camera", "size=60"], "size: 60 is not from 80 to 2000"),
    ] {
        let output = run_example("follow", &[&image, arguments[0], arguments[1]]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(said(&output).1.contains(says), "{output:?}");
    }
}

#[test]
fn lines_that_the_machine_does_not_reach_are_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let image = picture(&folder, "drawing.png", |x, y| (20..380).contains(&x) && (88..92).contains(&y));
    let file = folder.path().join("f.json").to_str().unwrap().to_owned();
    let output = run_example("follow", &[&image, "--mm-per-px", "10", "--report", &file]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let (told, complaint) = said(&output);
    assert!(told.contains("outside of the machine's area:"), "{told}");
    assert!(
        complaint.contains("no line can be reached:") && complaint.contains("--mm-per-px"),
        "{complaint}"
    );
    assert_eq!(report(&file)["finished"], Value::Bool(false));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ours_says_that_it_takes_no_hand() {
    let folder = tempfile::tempdir().unwrap();
    let image = picture(&folder, "drawing.png", |x, y| (100..200).contains(&x) && (148..152).contains(&y));
    let output = run_example("follow", &[&image, "--hand", "left", "--camera", "size=120,rim=1"]);
    assert!(output.status.success() && said(&output).1.contains("--hand is for the published method"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_run_without_a_line_still_writes_its_report() {
    let folder = tempfile::tempdir().unwrap();
    let white = picture(&folder, "white.png", |_, _| false);
    let black = picture(&folder, "black.png", |x, y| (100..300).contains(&x) && (50..250).contains(&y));
    let path = folder.path().join("r.json");
    let path = path.to_str().unwrap();
    for method in ["ours", "published", "connected"] {
        for (image, says) in [(&white, "one colour"), (&black, "no line in view at")] {
            let told = complaint(
                "follow",
                &[image, "--method", method, "--camera", "size=120,rim=1", "--report", path],
            );
            assert!(told.contains(says), "{method}: {told}");
            let value = report(path);
            let text = value.to_string();
            assert!(!text.contains("-0.0") && !text.contains("-0,"), "{text}");
            assert_eq!(
                (&value["finished"], value["path_points"].as_array().unwrap().len()),
                (&Value::Bool(false), 0)
            );
            std::fs::remove_file(path).unwrap();
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_smaller_than_the_drawing_says_where_lines_leave_it() {
    let folder = tempfile::tempdir().unwrap();
    let (machine, _) = small(folder.path());
    let image = picture(&folder, "drawing.png", |x, y| (20..380).contains(&x) && (88..92).contains(&y));
    let path = folder.path().join("r.json");
    let arguments =
        [&image, "--machine", &machine, "--camera", "size=120,rim=1", "--report", path.to_str().unwrap()];
    let output = run_example("follow", &arguments);
    assert!(said(&output).0.contains("a line leaves the machine's area: 1 times, first at (2"), "{output:?}");
    let value = report(path.to_str().unwrap());
    let farthest = value["path_points"].as_array().unwrap().iter().map(|at| at[0].as_f64().unwrap());
    assert!(farthest.fold(0.0, f64::max) < 240.7);
}

/// The paths of the published follower on the built-in drawing with an exact table: `UPDATE_GOLDEN=1` renews the file, to be looked at.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_published_path_is_the_one_that_was_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.svg");
    let arguments = ["--method", "published", "--windows", "12", "--svg", path.to_str().unwrap()];
    assert!(run_example("follow", &arguments).status.success());
    // Without the drawing itself, whose bytes depend on how pictures are packed.
    let now: Vec<String> = std::fs::read_to_string(&path)
        .unwrap()
        .lines()
        .filter(|line| !line.starts_with("<image"))
        .map(str::to_owned)
        .collect();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/follow-published.svg");
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        std::fs::write(&golden, now.join("\n") + "\n").unwrap();
    }
    let then = std::fs::read_to_string(&golden).unwrap();
    let different = then.lines().zip(&now).position(|(then, now)| then != now);
    assert!(
        different.is_none() && then.lines().count() == now.len(),
        "line {different:?} of {}",
        golden.display()
    );
}
