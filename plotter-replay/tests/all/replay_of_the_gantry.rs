//! A simulated session of the whole machine, recorded, drawn and run again.

use crate::house;

use house::{house, machine};
use plotter_motion::plant::{Bench, BenchSettings};
use plotter_motion::{Axis, Machine, Pen, PenMove, StepPoint, config::ControllerChoice};
use plotter_replay::log::{Event, Header, Reader, Record, SwitchName, Writer};
use plotter_replay::{
    BenchRecorder, Canvas, Chart, Outcome, Player, PlayerSettings, PlotterSettings, VirtualPlotter,
    compare::Ways,
    draw::Layer,
    golden,
    player::{Answer, EdgeSource, MachineController},
};
use std::time::Duration;

/// The house, and a dot in it.
fn moves() -> impl Iterator<Item = PenMove> {
    let inside = StepPoint::new(300, 300);
    let dot = [Pen::Up, Pen::Down].map(|pen| PenMove { pen, target: inside });
    let mut moves = house();
    moves.splice(moves.len() - 1..moves.len() - 1, dot);
    moves.into_iter()
}

fn session(machine: &Machine) -> Vec<u8> {
    recording(machine, moves())
}

fn recording(machine: &Machine, moves: impl Iterator<Item = PenMove>) -> Vec<u8> {
    let mut bench = Bench::new(machine, BenchSettings::default(), moves);
    let header = Header::new().with_number("baud", 256_000).with_text("protocol", "digits");
    let mut recorder = BenchRecorder::new(Writer::new(Vec::new(), &header).unwrap());
    while !bench.host().is_done() {
        bench.step(|time, event| recorder.record(time, event));
    }
    let (sent, reached) = bench.host().progress();
    assert_eq!(sent, reached);
    recorder.finish().unwrap()
}

fn records(log: &[u8]) -> Vec<Record> {
    Reader::new(log).unwrap().map(|record| record.unwrap()).collect()
}

#[test]
fn a_recording_replays_equal() {
    let machine = machine(ControllerChoice::Contouring);
    let log = session(&machine);
    match Player::default().check(records(&log), MachineController::new(&machine)) {
        Outcome::Equal(compared) => {
            println!("{compared}");
            assert!(compared.bytes > 2_500 && compared.duties > 1_000, "{compared}");
        }
        Outcome::FirstDifference(difference) => panic!("{difference}"),
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_stall_and_an_emergency_stop_replay_equal() {
    for controller in [ControllerChoice::Contouring, ControllerChoice::Published] {
        let machine = machine(controller);
        let mut bench = Bench::new(&machine, BenchSettings::default(), moves());
        let header = Header::new().with_number("baud", 256_000);
        let mut recorder = BenchRecorder::new(Writer::new(Vec::new(), &header).unwrap());
        let at_ms = |now: Duration, ms| now == Duration::from_millis(ms);
        while bench.now() < Duration::from_secs(2) {
            let now = bench.now();
            if at_ms(now, 130) {
                bench.axis_mut(Axis::X).stall(true);
            }
            if at_ms(now, 330) {
                bench.axis_mut(Axis::X).stall(false);
            }
            for (ms, pressed) in [(500, true), (700, false)] {
                if at_ms(now, ms) {
                    recorder.write(now, Event::Estop(pressed));
                    bench.controller_mut().emergency_stop(now, pressed);
                }
            }
            if at_ms(now, 800) {
                let name = SwitchName::new("reset").unwrap();
                recorder.write(now, Event::Switch { name, pressed: true });
                assert!(bench.controller_mut().reset_emergency_stop(now));
            }
            bench.step(|time, event| recorder.record(time, event));
        }
        let log = recorder.finish().unwrap();
        match Player::default().check(records(&log), MachineController::new(&machine)) {
            Outcome::Equal(compared) => assert!(compared.bytes > 500, "{controller:?}: {compared}"),
            Outcome::FirstDifference(difference) => panic!("{controller:?}: {difference}"),
        }
    }
}

/// Recorded once; a controller that answers otherwise is told here.
#[test]
fn the_golden_line_still_replays() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/line.plog");
    if golden::Mode::from_env() == golden::Mode::Renew {
        // From the motors on: another controller moves them in another way.
        let machine = machine(ControllerChoice::Contouring);
        let target = StepPoint::new(80, 40);
        let moves = [PenMove { pen: Pen::Down, target }];
        std::fs::write(path, recording(&machine, moves.into_iter())).unwrap();
    }
    golden::assert_replays(path, || MachineController::new(&machine(ControllerChoice::Contouring)));
}

#[test]
fn another_controller_differs_and_the_place_is_told() {
    let recorded = machine(ControllerChoice::Contouring);
    let mut config = *recorded.config();
    config.dc_mut().unwrap().control.contouring.feed_mm_s *= 0.5;
    let slower = Machine::new(config).unwrap();
    let outcome = Player::default().check(records(&session(&recorded)), MachineController::new(&slower));
    let Outcome::FirstDifference(difference) = outcome else { panic!("equal, though the feed is another") };
    assert!(matches!(difference.expected, Answer::Duty { .. } | Answer::Byte { .. }), "{difference}");
    assert!(difference.context.iter().any(|&(index, _)| index == difference.index), "{difference}");
}

#[test]
fn a_re_run_yields_the_recording() {
    let machine = machine(ControllerChoice::Contouring);
    let recorded = records(&session(&machine));
    let mut again = Vec::new();
    let controller = MachineController::new(&machine);
    Player::default().rerun(recorded.iter().cloned(), controller, |record| again.push(record)).unwrap();
    // Records of one time may stand in another order.
    let sorted = |records: &[Record]| {
        let mut sorted: Vec<_> = records.iter().map(|r| (r.time, format!("{:?}", r.event))).collect();
        sorted.sort();
        sorted
    };
    assert_eq!(sorted(&again), sorted(&recorded));
}

#[test]
fn without_edges_the_answers_are_compared_from_the_pulses() {
    let machine = machine(ControllerChoice::Contouring);
    let without: Vec<_> = records(&session(&machine))
        .into_iter()
        .filter(|record| !matches!(record.event, Event::Edge { .. } | Event::Drive { .. }))
        .collect();
    let edges = EdgeSource::from_records(&without);
    assert_eq!(edges, EdgeSource::Pulses);
    let tolerance = Duration::from_millis(50);
    let player = Player::new(PlayerSettings::default().with_edges(edges).with_tolerance(tolerance));
    match player.check(without, MachineController::new(&machine)) {
        Outcome::Equal(compared) => assert_eq!(compared.bytes, 9), // one answer to each target
        Outcome::FirstDifference(difference) => panic!("{difference}"),
    }
}

#[test]
fn the_virtual_plotter_draws_what_was_commanded() {
    let machine = machine(ControllerChoice::Contouring);
    let mut plotter = VirtualPlotter::new(PlotterSettings::default());
    records(&session(&machine)).iter().for_each(|record| plotter.push(record));
    plotter.finish();
    assert_eq!((plotter.target_count(), plotter.reached_count()), (9, 9));
    assert_eq!(plotter.anomalies(), []);
    let error = plotter.contour_error(Ways::Drawn);
    println!("contour error: rms {:.4} mm, max {:.4} mm", error.rms_mm, error.max_mm);
    // Four encoder counts.
    const MOST_MM: f64 = 0.1;
    assert!(error.max_mm < MOST_MM, "{error:?}");
    let canvas = Canvas::from_plotter(&plotter, 0.02);
    let wanted = moves().filter(|next| next.pen == Pen::Down).count();
    assert_eq!(canvas.lines(Layer::Desired).map(|line| line.len() - 1).sum::<usize>(), wanted);
    if let Some(directory) = std::env::var_os("PLOTTER_PICTURES") {
        let directory = std::path::PathBuf::from(directory);
        let style = canvas.fitted_style();
        std::fs::write(directory.join("house.svg"), canvas.to_svg(&style)).unwrap();
        #[cfg(feature = "image")]
        std::fs::write(directory.join("house.png"), canvas.to_png(&style).unwrap()).unwrap();
        std::fs::write(directory.join("house-response.svg"), Chart::response("house", &plotter).to_svg())
            .unwrap();
        std::fs::write(directory.join("house.plog"), session(&machine)).unwrap();
    }
}

#[test]
fn a_golden_recording_holds_fails_and_is_renewed() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("house.plog");
    let machine = machine(ControllerChoice::Contouring);
    std::fs::write(&path, session(&machine)).unwrap();
    golden::check(&path, || MachineController::new(&machine), golden::Mode::Compare).unwrap();

    let mut config = *machine.config();
    config.dc_mut().unwrap().control.contouring.bandwidth_hz *= 0.8;
    let other = Machine::new(config).unwrap();
    let error = golden::check(&path, || MachineController::new(&other), golden::Mode::Compare).unwrap_err();
    assert!(error.to_string().contains("first difference at "), "{error}");
    let diff = std::fs::read_to_string(directory.path().join("house.plog.diff")).unwrap();
    assert!(diff.contains("duty cycles: ") && diff.contains("    pulse x+"), "{diff}");
    let actual = directory.path().join("house.plog.actual");
    golden::check(&actual, || MachineController::new(&other), golden::Mode::Compare).unwrap();

    golden::check(&path, || MachineController::new(&other), golden::Mode::Renew).unwrap();
    golden::check(&path, || MachineController::new(&other), golden::Mode::Compare).unwrap();
    // What the failure left is gone with it.
    assert!(!diff_exists(directory.path()) && !actual.exists());
}

fn diff_exists(directory: &std::path::Path) -> bool {
    directory.join("house.plog.diff").exists()
}
