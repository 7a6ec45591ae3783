//! The pages, as a person sees them: in a browser without a window.
//!
//! Needs Debian's package `chromium`, or another one named in `CHROMIUM`; screenshots go to
//! `BROWSER_SCREENSHOTS`:
//!
//! ```text
//! cargo test --release -p plotter-replay --features cli,live --test all browser:: -- --ignored --test-threads 1 --nocapture
//! ```
#![cfg(unix)]

use crate::devtools;

use devtools::Browser;
use serde_json::json;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_plotter-replay");
/// Two figures with a way between them, nine targets; some four seconds at the usual speed.
const FIGURES: &str =
    "PU400,400;PD2400,400,2400,2400,400,2400,400,400;PU800,800;PD2000,800,1400,2000,800,800;";

/// A program that ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Running {
    fn start(arguments: &[&str], here: &Path) -> (Self, impl FnMut() -> String + use<>) {
        let mut child = Command::new(PROGRAM)
            .args(arguments)
            .current_dir(here)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        (Self(child), move || lines.next().expect("the program ended").unwrap())
    }

    /// Status and standard error.
    fn finish(&mut self) -> (Option<i32>, String) {
        // A drawing of half a minute, on a busy computer.
        let until = Instant::now() + Duration::from_secs(180);
        let status = loop {
            if let Some(status) = self.0.try_wait().unwrap() {
                break status;
            }
            assert!(Instant::now() < until, "it does not end");
            std::thread::sleep(Duration::from_millis(20));
        };
        let mut said = String::new();
        let _ = std::io::Read::read_to_string(&mut self.0.stderr.take().unwrap(), &mut said);
        (status.code(), said)
    }
}

/// A machine that takes its bytes fast, and a drawing.
fn set_up(here: &Path) {
    std::fs::write(
        here.join("machine.toml"),
        "schema = 1\nname = \"test-bed\"\n[serial]\nbyte_gap_ms = 1.0\n",
    )
    .unwrap();
    draw(here, 1);
}

/// The figures so many times.
fn draw(here: &Path, times: usize) {
    let drawing = format!("IN;SP1;{}PU0,0;", FIGURES.repeat(times));
    std::fs::write(here.join("drawing.hpgl"), drawing).unwrap();
}

fn number(text: &str) -> f64 {
    text.split_whitespace().next().unwrap().parse().unwrap_or_else(|_| panic!("{text} is no number"))
}

/// A recording that was made by the program itself, with two lost bytes and a silence put in by hand.
fn recording(here: &Path) {
    let (mut live, _) = Running::start(
        &[
            "live",
            "--simulate",
            "machine.toml",
            "--link",
            "digits",
            "--speed",
            "2",
            "drawing.hpgl",
            "--start",
            "-o",
            "good.plog",
        ],
        here,
    );
    assert_eq!(live.finish().0, Some(0));
    let log = std::fs::read_to_string(here.join("good.plog")).unwrap();
    let mut lines: Vec<&str> = log.lines().collect();
    let third = lines.len() / 3;
    let lost = (third..).find(|&n| lines[n].contains(" < ")).unwrap();
    lines.remove(lost);
    let cut = &lines[lines.len() / 2][..8]; // a damaged line
    lines.insert(lines.len() / 2, cut);
    std::fs::write(here.join("bad.plog"), lines.join("\n") + "\n").unwrap();
}

#[test]
#[ignore = "needs a browser: .ci/browser"]
fn a_recording_plays_in_a_browser() {
    let here = tempfile::tempdir().unwrap();
    set_up(here.path());
    recording(here.path());
    let render = Command::new(PROGRAM)
        .args(["render", "bad.plog", "--drawing", "drawing.hpgl", "--html", "page.html"])
        .current_dir(here.path())
        .output()
        .unwrap();
    assert_eq!(render.status.code(), Some(1), "{render:?}"); // damage found
    let page = here.path().join("page.html");
    let mut browser = Browser::start();
    // Without any network at all.
    browser.ask("Network.enable", json!({}));
    let offline = json!({"offline": true, "latency": 0, "downloadThroughput": -1, "uploadThroughput": -1});
    browser.ask("Network.emulateNetworkConditions", offline);
    browser.open(&format!("file://{}", page.display()));
    browser.screenshot("recording-light");
    browser.scheme("dark");
    browser.screenshot("recording-dark");
    browser.scheme("light");

    let ends_at = number(&browser.value("time"));
    let picture = "document.getElementById('sheet').toDataURL()";
    let at_the_end = browser.eval(picture);
    // The slider moves the pen.
    browser.eval(
        "(() => { const slider = document.getElementById('time'); slider.value = 4000; slider.dispatchEvent(new Event('input')); })()",
    );
    let place = |browser: &mut Browser| (browser.value("position x"), browser.value("position y"));
    let at_4000 = place(&mut browser);
    assert!((number(&browser.value("time")) - 0.4 * ends_at).abs() < 0.02 * ends_at);
    assert_ne!(at_4000, (String::from("0.000 mm"), String::from("0.000 mm")));
    assert_ne!(browser.eval(picture), at_the_end);
    browser.screenshot("recording-middle");
    // So do the keys.
    browser.key("ArrowRight", 39);
    assert_ne!(place(&mut browser), at_4000);
    browser.key("Home", 36);
    let begins_at = number(&browser.value("time"));
    assert!(begins_at < 0.1, "{begins_at}");
    browser.key(" ", 32);
    browser.wait_for("document.getElementById('play').textContent === 'Pause'");
    std::thread::sleep(Duration::from_millis(300));
    browser.key(" ", 32);
    let played_to = number(&browser.value("time"));
    assert!(played_to > begins_at + 0.1, "{played_to}");
    // What is wrong stands in the table, and leads there.
    assert!(
        browser.text("#anomalies-title").contains("damaged lines: 1"),
        "{}",
        browser.text("#anomalies-title")
    );
    assert!(browser.text("#anomalies").contains("bytes were lost"), "{}", browser.text("#anomalies"));
    browser.eval("document.querySelector('#anomalies tr[tabindex]').click()");
    let row = number(&browser.text("#anomalies tr[tabindex] td"));
    assert!((number(&browser.value("time")) - row).abs() < 1e-5, "{row}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

/// The same session, silent for five seconds in its middle, and begun at a time of day.
fn silent_recording(here: &Path) {
    use plotter_replay::log;
    let reader = log::open(&here.join("good.plog")).unwrap();
    let header = reader.header().clone().with_number("began_unix_us", 1_795_629_973_994_029);
    let mut records: Vec<_> = reader.map(Result::unwrap).collect();
    let silence = Duration::from_secs(5);
    let bytes =
        |record: &log::Record| matches!(record.event, log::Event::Host(_) | log::Event::Controller(_));
    let middle = records.len() / 2;
    let after = (middle..).find(|&n| bytes(&records[n]) && records[n].time > records[n - 1].time).unwrap();
    records[after..].iter_mut().for_each(|record| record.time += silence);
    let mut writer = log::create(&here.join("silent.plog"), &header).unwrap();
    records.iter().for_each(|record| writer.write(record).unwrap());
    writer.finish().unwrap();
}

#[test]
#[ignore = "needs a browser: .ci/browser"]
fn a_recording_fits_every_screen_and_shows_nothing_that_nobody_knows() {
    let here = tempfile::tempdir().unwrap();
    set_up(here.path());
    recording(here.path());
    silent_recording(here.path());
    let render = Command::new(PROGRAM)
        .args(["render", "silent.plog", "--drawing", "drawing.hpgl", "--html", "page.html"])
        .current_dir(here.path())
        .output()
        .unwrap();
    assert_eq!(render.status.code(), Some(0), "{render:?}");
    let mut browser = Browser::start();
    let address = format!("file://{}", here.path().join("page.html").display());
    for [width, height] in [[320, 640], [390, 844], [860, 600], [1280, 800]] {
        browser.screen(width, height, width < 500);
        browser.open(&address);
        browser.wait_for("document.body.dataset.ready === 'yes'");
        browser.screenshot(&format!("recording-{width}"));
        assert_eq!(browser.eval("document.documentElement.scrollWidth"), json!(width), "wider than {width}");
        // The player is at hand beside the sheet, and the page's last words are not under it.
        let [_, top, _, bottom] = browser.place(".player");
        assert!(top >= 0.0 && bottom <= f64::from(height) + 0.5, "{width}: the player at {top} to {bottom}");
        browser.eval("scrollTo(0, 1e9)");
        browser.painted();
        let seen = browser.eval(
            "(() => { const box = document.getElementById('exactness').getBoundingClientRect(); \
             const at = document.elementFromPoint(box.left + 20, box.bottom - 4); \
             return box.bottom <= innerHeight && at && at.id; })()",
        );
        assert_eq!(seen, json!("exactness"), "{width}: the end of the page is hidden");
    }
    // Times of day are for people, and all others are on the recording's own clock.
    assert_eq!(browser.value("began"), "2026-11-25 18:06:13 UTC");
    assert_eq!(number(&browser.text("#clock")), number(&format!("{:.3}", number(&browser.value("time")))));
    let row = "[...document.querySelectorAll('#gaps tr[tabindex]')].find((row) => Number(row.children[1].textContent) >= 5)";
    browser.eval(&format!("{row}.click()"));
    let began = number(browser.eval(&format!("{row}.children[0].textContent")).as_str().unwrap());
    assert!((number(&browser.value("time")) - began).abs() < 1e-5, "{began}");
    // In the silence the pen stands, and what nobody knows then is not drawn.
    let clock = browser.text("#clock");
    let end = number(clock.split('/').nth(1).unwrap());
    let at = |browser: &mut Browser, time: f64| {
        let value = (time / end * 10_000.0).round();
        browser.eval(&format!(
            "(() => {{ const slider = document.getElementById('time'); slider.value = {value}; \
             slider.dispatchEvent(new Event('input')); }})()"
        ));
        (browser.value("position x"), browser.value("position y"))
    };
    let (early, late) = (at(&mut browser, began + 1.0), at(&mut browser, began + 4.0));
    assert_eq!(early, late, "the pen drifts while the line is silent");
    browser.screenshot("recording-silent");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "needs a browser: .ci/browser"]
fn a_long_recording_is_a_small_page_that_opens_at_once() {
    let here = tempfile::tempdir().unwrap();
    let Some(log) = std::env::var_os("LONG_RECORDING") else {
        println!("LONG_RECORDING names no recording: left out");
        return;
    };
    let page = here.path().join("page.html");
    let render = Command::new(PROGRAM).arg("render").arg(log).arg("--html").arg(&page).output().unwrap();
    assert_eq!(render.status.code(), Some(0), "{render:?}");
    let bytes = std::fs::metadata(&page).unwrap().len();
    let mut browser = Browser::start();
    let address = format!("file://{}", page.display());
    browser.open(&address); // the first page of a new browser pays for the browser
    // The time of the processor, which what else runs on this computer does not change.
    browser.ask("Performance.enable", json!({"timeDomain": "threadTicks"}));
    let before = browser.busy();
    let opened = browser.open(&address);
    let busy = browser.busy() - before;
    println!(
        "{} pulses: {bytes} bytes, {:.0} ms of the processor, open after {} ms",
        browser.value("pulses"),
        busy * 1e3,
        opened.as_millis()
    );
    browser.screenshot("recording-long");
    assert!(bytes < 2_000_000, "{bytes}");
    assert!(busy < 1.0, "{busy} s");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "needs a browser: .ci/browser"]
fn a_machine_behind_a_pseudo_terminal_is_started_watched_stopped_resumed_and_finishes() {
    let here = tempfile::tempdir().unwrap();
    set_up(here.path());
    draw(here.path(), 5); // not done before it is stopped and paused, however busy the computer is
    let (_machine, mut said) = Running::start(&["simulate", "machine.toml"], here.path());
    let port = said().split_once(" is simulated on ").unwrap().1.to_owned();
    let (mut live, mut said) = Running::start(
        &["live", "--port", &port, "--machine", "machine.toml", "drawing.hpgl", "-o", "session.plog"],
        here.path(),
    );
    assert!(said().contains(&port));
    let address = said().strip_prefix("look at ").unwrap().to_owned();
    let mut browser = Browser::start();
    browser.open(&address);
    browser.wait_for("document.body.dataset.state === 'ready'");
    assert_eq!(browser.text("#kind"), "REAL MACHINE"); // for all that the program knows
    browser.screenshot("live-ready");

    browser.click("#start");
    browser.wait_for("document.body.dataset.state === 'running' && way.length > 3 && last.sent >= 2");
    let first = browser.value("position x") + &browser.value("position y");
    browser.wait_for("last.speed_mm_s[0] !== 0 || last.speed_mm_s[1] !== 0");
    browser.screenshot("live-running");
    assert_ne!(browser.value("position x") + &browser.value("position y"), first);

    // The key stops it in the middle of a line.
    browser.wait_for("Math.hypot(...last.speed_mm_s) > 20");
    browser.key("Escape", 27);
    browser.wait_for("document.body.dataset.state === 'stopped'");
    // The motors have run down when the machine has told nothing new for a while, on a busy computer too.
    browser.wait_for(
        "(window.rest = window.rest?.at === String(last.counts) ? window.rest : { at: String(last.counts), since: performance.now() }) \
         && performance.now() - window.rest.since > 1000",
    );
    let stopped = (browser.value("position x"), browser.value("position y"));
    browser.screenshot("live-stopped");
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!((browser.value("position x"), browser.value("position y")), stopped);
    assert_eq!(browser.eval("Math.hypot(...last.speed_mm_s)"), json!(0));

    browser.click("#resume");
    browser.wait_for("document.body.dataset.state === 'running'");
    browser.key(" ", 32);
    browser.wait_for("document.body.dataset.state === 'paused' && last.speed_mm_s.every((v) => v === 0)");
    browser.key(" ", 32);
    browser.wait_for("document.body.dataset.state === 'done'");
    browser.screenshot("live-done");
    assert_eq!(browser.value("targets done"), "46 of 46");
    assert_eq!(browser.value("reached"), "46");
    assert_eq!(browser.value("anomalies"), "0");
    assert_eq!(browser.complaints, Vec::<String>::new());
    assert_eq!(live.finish(), (Some(0), String::new()));

    let info =
        Command::new(PROGRAM).args(["info", "session.plog"]).current_dir(here.path()).output().unwrap();
    let info = String::from_utf8(info.stdout).unwrap();
    assert!(info.contains("stopped over the line: 1") && info.contains("nothing lost"), "{info}");
}

#[test]
#[ignore = "needs a browser: .ci/browser"]
fn a_port_that_vanishes_is_said_on_the_page_and_the_recording_is_kept() {
    let here = tempfile::tempdir().unwrap();
    set_up(here.path());
    let (machine, mut said) = Running::start(&["simulate", "machine.toml"], here.path());
    let port = said().split_once(" is simulated on ").unwrap().1.to_owned();
    let (mut live, mut said) = Running::start(
        &[
            "live",
            "--port",
            &port,
            "--machine",
            "machine.toml",
            "drawing.hpgl",
            "--start",
            "-o",
            "session.plog",
        ],
        here.path(),
    );
    said();
    let address = said().strip_prefix("look at ").unwrap().to_owned();
    let mut browser = Browser::start();
    browser.open(&address);
    browser.wait_for("last && last.sent >= 1");
    drop(machine);
    browser.wait_for("document.body.dataset.state === 'failed'");
    let banner = browser.text("#banner");
    assert!(banner.contains("recording up to here is kept"), "{banner}");
    browser.screenshot("live-vanished");
    let (status, said) = live.finish();
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains(&port) && said.contains("session.plog"), "{said}");
    let info =
        Command::new(PROGRAM).args(["info", "session.plog"]).current_dir(here.path()).output().unwrap();
    assert_eq!(info.status.code(), Some(0));
    assert!(String::from_utf8(info.stdout).unwrap().contains("notes: 1"));
}

#[test]
#[ignore = "needs a browser: .ci/browser"]
fn the_button_stops_a_simulated_machine_and_the_page_says_that_it_is_one() {
    let here = tempfile::tempdir().unwrap();
    set_up(here.path());
    draw(here.path(), 5); // not done before it is stopped, however busy the computer is
    let (mut live, mut said) =
        Running::start(&["live", "--simulate", "machine.toml", "drawing.hpgl", "--start"], here.path());
    assert!(said().contains("SIMULATED"));
    let address = said().strip_prefix("look at ").unwrap().to_owned();
    let mut browser = Browser::start();
    browser.open(&address);
    assert_eq!(browser.text("#kind"), "SIMULATED MACHINE");
    browser.wait_for("last && Math.hypot(...last.speed_mm_s) > 20");
    // The share of the supply, and what that is.
    let duty = browser.value("duty x");
    assert!(duty.contains(" %, ") && duty.ends_with(" V"), "{duty}");
    // From the click to the first update that has both motors off, by the browser's own clock.
    let ms = browser.eval(
        "new Promise((done) => { const clicked = performance.now(); document.getElementById('stop').click(); \
         const look = () => last.state === 'stopped' && last.duty.every((d) => d === 0) ? done(performance.now() - clicked) : setTimeout(look, 1); look(); })",
    );
    println!("both motors off on the screen {ms} ms after the click");
    assert!(ms.as_f64().unwrap() < 1_000.0);
    browser.scheme("dark");
    browser.screenshot("live-simulated-dark");
    browser.click("#resume");
    // A browser that goes away stops nothing.
    browser.wait_for("document.body.dataset.state === 'running'");
    drop(browser);
    assert_eq!(live.finish(), (Some(0), String::new()));
}

/// The stop is whole on the screen, nothing lies over it, and it is as high as a finger is wide.
fn assert_stop_is_in_reach(browser: &mut Browser, [width, height]: [u32; 2], when: &str) {
    let [left, top, right, bottom] = browser.place("#stop");
    let is_inside = left >= 0.0 && top >= 0.0 && right <= width.into() && bottom <= height.into();
    assert!(is_inside, "{width} x {height}, {when}: {left}..{right}, {top}..{bottom}");
    assert!(bottom - top >= 44.0 && right - left >= 120.0, "{width} x {height}, {when}");
    let (x, y) = ((left + right) / 2.0, (top + bottom) / 2.0);
    let over = browser.eval(&format!("document.elementFromPoint({x}, {y}).id"));
    assert_eq!(over, json!("stop"), "{width} x {height}, {when}");
}

/// Where a finger or the wheel meets a canvas below the controls: its middle, as far as it is on the screen.
fn middle_of_canvas(browser: &mut Browser, selector: &str, height: u32) -> [f64; 2] {
    let ([left, top, right, bottom], [.., below]) = (browser.place(selector), browser.place(".controls"));
    let (top, bottom) = (top.max(below), bottom.min(height.into()));
    assert!(bottom - top > 80.0, "{selector}: only {top} to {bottom} of it is on the screen");
    [(left + right) / 2.0, (top + bottom) / 2.0]
}

#[test]
#[ignore = "needs a browser: .ci/browser"]
fn the_stop_is_in_reach_on_every_screen_and_no_canvas_keeps_the_page_from_scrolling() {
    let here = tempfile::tempdir().unwrap();
    set_up(here.path());
    draw(here.path(), 200); // not done before the last screen
    let (_live, mut said) =
        Running::start(&["live", "--simulate", "machine.toml", "drawing.hpgl", "--start"], here.path());
    said();
    let address = said().strip_prefix("look at ").unwrap().to_owned();
    let mut browser = Browser::start();
    for size in [[320, 568], [320, 640], [390, 844], [568, 320], [860, 600], [1280, 800]] {
        let [width, height] = size;
        for has_touch in [true, false] {
            browser.screen(width, height, has_touch);
            browser.open(&address);
            browser.wait_for("document.body.dataset.state === 'running' && way.length > 3");
            assert_stop_is_in_reach(&mut browser, size, "at first");
            assert_eq!(
                browser.eval("document.documentElement.scrollWidth"),
                json!(width),
                "wider than {width}"
            );
            if has_touch {
                for scheme in ["dark", "light"] {
                    browser.scheme(scheme);
                    browser.screenshot_of_screen(&format!("live-{width}x{height}-{scheme}"));
                }
            }
            // A finger that moves up the drawing, or the wheel over it, scrolls the page; the stop stays.
            browser.eval("document.getElementById('sheet').scrollIntoView({ block: 'center' })");
            browser.painted();
            let before = browser.eval("scrollY").as_f64().unwrap();
            let at = middle_of_canvas(&mut browser, "#sheet", height);
            if has_touch {
                let up = [at[0], at[1] - 30.0];
                browser.swipe([at[0], at[1] + 30.0], up);
            } else {
                browser.wheel(at, 60.0);
            }
            browser.wait_for(&format!("scrollY > {before} + 20"));
            assert_eq!(browser.eval("sheet.view"), json!(null), "the drawing was zoomed instead");
            assert_stop_is_in_reach(&mut browser, size, "after the drawing was dragged");
            browser.eval("scrollTo(0, document.documentElement.scrollHeight)");
            browser.painted();
            assert!(browser.eval("scrollY").as_f64().unwrap() > 100.0);
            assert_stop_is_in_reach(&mut browser, size, "at the lower end");
            if has_touch {
                browser.screenshot_of_screen(&format!("live-{width}x{height}-lower-end"));
            }
            // A tap on it, or a click, stops the machine.
            browser.wait_for("last.duty.some((d) => d !== 0)");
            if has_touch {
                let [left, top, right, bottom] = browser.place("#stop");
                let middle = [(left + right) / 2.0, (top + bottom) / 2.0];
                browser.swipe(middle, middle);
            } else {
                browser.click("#stop");
            }
            browser.wait_for("document.body.dataset.state === 'stopped' && last.duty.every((d) => d === 0)");
            assert_stop_is_in_reach(&mut browser, size, "when it is stopped");
            browser.click("#resume");
            browser.wait_for("document.body.dataset.state === 'running'");
        }
    }
    // With Ctrl the wheel zooms the drawing, and two fingers move and zoom it.
    browser.eval("scrollTo(0, 0)");
    browser.screen(390, 844, true);
    let [x, y] = middle_of_canvas(&mut browser, "#sheet", 844);
    for (kind, half) in [("touchStart", 40.0), ("touchMove", 60.0), ("touchMove", 80.0)] {
        let fingers = json!([{"x": x - half, "y": y, "id": 0}, {"x": x + half, "y": y, "id": 1}]);
        browser.ask("Input.dispatchTouchEvent", json!({"type": kind, "touchPoints": fingers}));
    }
    browser.ask("Input.dispatchTouchEvent", json!({"type": "touchEnd", "touchPoints": []}));
    let zoom = browser.eval("sheet.view.zoom").as_f64().unwrap();
    assert!((zoom - 2.0).abs() < 0.01, "{zoom}");
    let wheel = json!({"type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": -100, "modifiers": 2});
    browser.ask("Input.dispatchMouseEvent", wheel);
    browser.wait_for("sheet.view.zoom > 2.1");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

/// A square, a pen change, a circle; some 20 seconds on the documented machine.
const TWO_PENS: &str = "G21\nG90\nG0 X20 Y20\nM3 S90\nG1 X120 Y20 F2400\nX120 Y100\nX20 Y100\nX20 Y20\nM5\nM0 (pen 2)\nG0 X60 \
                        Y60\nM3 S90\nG2 X60 Y60 I20 J0 F2400\nM5\n";

#[test]
#[ignore = "needs a browser: .ci/browser"]
fn a_grbl_machine_is_led_by_hand_started_paused_changes_its_pen_is_stopped_and_finishes() {
    let here = tempfile::tempdir().unwrap();
    std::fs::write(
        here.path().join("machine.toml"),
        "schema = 1\nname = \"steppers\"\ndrive = \"stepper\"\n[area]\nwidth_mm = 380.0\nheight_mm = 310.0\n[serial]\nbaud = 115200\n",
    )
    .unwrap();
    std::fs::write(here.path().join("drawing.gcode"), TWO_PENS).unwrap();
    let (_machine, mut said) = Running::start(&["simulate", "machine.toml"], here.path());
    let port = said().split_once(" is simulated on ").unwrap().1.to_owned();
    let (mut live, mut said) = Running::start(
        &["live", "--port", &port, "--machine", "machine.toml", "drawing.gcode", "-o", "session.plog"],
        here.path(),
    );
    assert!(said().contains("which language"));
    assert!(said().contains("speaks Grbl"));
    let address = said().strip_prefix("look at ").unwrap().to_owned();
    let mut browser = Browser::start();
    browser.open(&address);
    browser.wait_for("document.body.dataset.state === 'ready'");
    for [width, height] in [[320, 568], [390, 844], [860, 600], [1280, 800]] {
        browser.screen(width, height, true);
        browser.open(&address);
        browser.wait_for("document.body.dataset.state === 'ready'");
        assert_eq!(browser.eval("document.documentElement.scrollWidth"), json!(width), "wider than {width}");
        for scheme in ["dark", "light"] {
            browser.scheme(scheme);
            browser.painted();
            browser.screenshot(&format!("hosted-{width}x{height}-{scheme}"));
        }
    }
    browser.screen(1280, 800, false);
    browser.open(&address);
    browser.wait_for("document.body.dataset.state === 'ready'");
    // Its drawing's time by the machine's limits, before it begins.
    assert!(browser.value("remaining").ends_with(" s"), "{}", browser.value("remaining"));
    // By hand: a step by an arrow key, on and on while a button is held, and back by numbers.
    browser.eval("document.body.focus()");
    browser.key("ArrowRight", 39);
    browser.wait_for("Math.abs(last.at[0] - 10) < 0.02");
    browser.eval("$('step').value = '0'; jog('0 1')");
    browser.wait_for("last.at[1] > 3");
    browser.eval("letGo()");
    browser.wait_for("last.speed_mm_s.every((v) => v === 0)");
    assert!(browser.eval("last.at[1]").as_f64().unwrap() < 60.0);
    browser.eval("$('go-x').value = 0; $('go-y').value = 0");
    browser.click("#go");
    browser.wait_for("Math.hypot(...last.at) < 0.02");

    browser.click("#start");
    browser.wait_for("document.body.dataset.state === 'running' && last.at[0] > 60 && last.pen === 'down'");
    browser.screenshot("hosted-running");
    browser.key(" ", 32);
    browser.wait_for("document.body.dataset.state === 'paused'");
    assert_eq!(browser.value("pen"), "up");
    browser.screenshot("hosted-paused");
    browser.key(" ", 32);
    browser.wait_for("document.body.dataset.state === 'running' && last.at[1] > 40 && last.pen === 'down'");
    // From the click to the first update in which nothing moves, by the browser's own clock.
    let ms = browser.eval(
        "new Promise((done) => { const clicked = performance.now(); document.getElementById('stop').click(); \
         const look = () => last.state === 'stopped' || last.state === 'locked' ? done(performance.now() - clicked) : setTimeout(look, 1); look(); })",
    );
    println!("a Grbl machine is stopped on the screen {ms} ms after the click");
    browser.screenshot("hosted-stopped");
    std::thread::sleep(Duration::from_millis(600));
    if browser.eval("document.body.dataset.state") == json!("locked") {
        browser.click("[data-ask=unlock]");
    } else {
        browser.click("#resume");
    }
    browser.wait_for("document.body.dataset.state === 'paused'");
    browser.click("#resume");
    // The other pen is waited for, by its number.
    browser.wait_for("document.body.dataset.state === 'paused' && last.wants.startsWith('pen 2 is wanted')");
    browser.screenshot("hosted-pen");
    assert!(browser.text("#banner").starts_with("Pen 2 is wanted"));
    browser.click("#resume");
    browser.wait_for("document.body.dataset.state === 'done'");
    browser.screenshot("hosted-done");
    assert_eq!(browser.value("operations done"), "9 of 9");
    assert_eq!(browser.complaints, Vec::<String>::new());
    assert_eq!(live.finish(), (Some(0), String::new()));
    let info =
        Command::new(PROGRAM).args(["info", "session.plog"]).current_dir(here.path()).output().unwrap();
    let info = String::from_utf8(info.stdout).unwrap();
    assert!(info.contains("nothing lost"), "{info}");
}

/// A square with a second pen, some six seconds.
const TARGETS_OF_TWO_PENS: &str = "IN;SP1;PU800,800;PD2800,800,2800,2800;SP2;PD800,2800,800,800;PU0,0;";

#[test]
#[ignore = "needs a browser: .ci/browser"]
fn a_machine_of_targets_is_led_by_hand_on_two_pages_and_changes_its_pen() {
    let here = tempfile::tempdir().unwrap();
    set_up(here.path());
    std::fs::write(here.path().join("drawing.hpgl"), TARGETS_OF_TWO_PENS).unwrap();
    let (_machine, mut said) = Running::start(&["simulate", "machine.toml"], here.path());
    let port = said().split_once(" is simulated on ").unwrap().1.to_owned();
    let (mut live, mut said) = Running::start(
        &[
            "live",
            "--port",
            &port,
            "--machine",
            "machine.toml",
            "drawing.hpgl",
            "--pen",
            "2=crimson",
            "-o",
            "session.plog",
        ],
        here.path(),
    );
    said();
    let address = said().strip_prefix("look at ").unwrap().to_owned();
    let mut browser = Browser::start();
    for [width, height] in [[320, 568], [390, 844], [860, 600], [1280, 800]] {
        browser.screen(width, height, true);
        browser.open(&address);
        browser.wait_for("document.body.dataset.state === 'ready'");
        assert_eq!(browser.eval("document.documentElement.scrollWidth"), json!(width), "wider than {width}");
        for scheme in ["dark", "light"] {
            browser.scheme(scheme);
            browser.painted();
            browser.screenshot(&format!("targets-{width}x{height}-{scheme}"));
        }
    }
    browser.screen(1280, 800, false);
    browser.open(&address);
    // The page is opened twice: both show the same, and lead the same machine.
    let mut other = Browser::start();
    other.open(&address);
    for page in [&mut browser, &mut other] {
        page.wait_for("document.body.dataset.state === 'ready'");
        // The drawing before it begins: its time, and how much of it the slider shows.
        assert!(page.value("remaining").ends_with(" s"), "{}", page.value("remaining"));
        assert_eq!(page.eval("$('preview').hidden"), json!(false));
        assert_eq!(page.eval("getComputedStyle(document.querySelector('.lines')).display"), json!("none"));
    }
    let whole = browser.eval("document.getElementById('sheet').toDataURL()");
    browser.eval("$('order').value = 300; $('order').dispatchEvent(new Event('input'))");
    assert_ne!(browser.eval("document.getElementById('sheet').toDataURL()"), whole);

    browser.eval("document.body.focus()");
    browser.key("ArrowRight", 39);
    for page in [&mut browser, &mut other] {
        page.wait_for("Math.abs(last.at[0] - 10) < 0.03");
    }
    // The published program's keys: a pulse, and one in a direction of chance.
    other.eval("document.body.focus()");
    other.key("3", 51);
    browser.wait_for("Math.abs(last.at[1] - 0.025) < 1e-6");
    browser.key(" ", 32);
    browser.wait_for("Math.abs(Math.abs(last.at[0] - 10) + Math.abs(last.at[1] - 0.025) - 0.025) < 1e-6");
    browser.eval("$('step').value = '0'; jog('0 1')");
    browser.wait_for("last.at[1] > 3");
    browser.eval("letGo()");
    browser.wait_for("last.speed_mm_s.every((v) => v === 0)");
    assert!(browser.eval("last.at[1]").as_f64().unwrap() < 60.0);
    // The origin, by P1X and P1Y; the drawing would lead outside from there.
    browser.eval("$('p1-x').value = 22000; $('p1-y').value = 400");
    browser.click("#p1");
    browser.wait_for("Math.abs(last.p1[0] + 550) < 0.01");
    browser.click("#start");
    browser.wait_for("last.messages.some(([, words]) => words.includes('leads outside'))");
    assert_eq!(browser.eval("document.body.dataset.state"), json!("ready"));
    browser.eval("$('p1-x').value = 0; $('p1-y').value = 0");
    browser.click("#p1");
    browser.wait_for("last.p1[0] === 0");
    // A shape by numbers, with its points counted.
    browser.eval(
        "$('shape').value = 'circle'; $('shape').dispatchEvent(new Event('change')); $('shape-x').value = 5; \
                  $('shape-y').value = 20; $('shape-a').value = 5; $('shape-b').value = 12",
    );
    browser.eval("document.querySelector('#hand details').open = true; $('draw-shape').scrollIntoView({ block: 'center' })");
    browser.painted();
    browser.click("#draw-shape");
    browser.wait_for("last.by_hand && last.by_hand[1] === 13 && last.by_hand[0] > 3 && last.pen === 'down'");
    browser.screenshot("targets-by-hand");
    browser.wait_for("last.by_hand === null && last.pen === 'up'");

    // A button that has the focus keeps the keys to itself.
    browser.eval("document.activeElement.blur()");
    browser.key("+", 187); // the next target only
    for page in [&mut browser, &mut other] {
        page.wait_for("document.body.dataset.state === 'paused' && last.reached === 1");
    }
    other.click("#resume");
    // The other pen is waited for, by its name.
    browser.wait_for(
        "document.body.dataset.state === 'paused' && last.wants.startsWith('pen 2 is wanted (crimson)')",
    );
    browser.screenshot("targets-pen");
    assert!(browser.text("#banner").starts_with("Pen 2 is wanted (crimson)"));
    assert_eq!(browser.eval("getComputedStyle($('banner')).borderLeftColor"), json!("rgb(220, 20, 60)"));
    browser.click("#resume");
    browser.wait_for("document.body.dataset.state === 'running' && Math.hypot(...last.speed_mm_s) > 10");
    // Stopped on one page, let go on the other.
    other.key("Escape", 27);
    browser.wait_for("document.body.dataset.state === 'stopped'");
    browser.click("#resume");
    for page in [&mut browser, &mut other] {
        page.wait_for("document.body.dataset.state === 'done'");
        assert_eq!(page.value("targets done"), "6 of 6");
        assert_eq!(page.complaints, Vec::<String>::new());
    }
    browser.screenshot("targets-done");
    assert_eq!(live.finish(), (Some(0), String::new()));
}
