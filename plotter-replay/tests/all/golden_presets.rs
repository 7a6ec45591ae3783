//! Every preset machine has golden logs: what its controller said and did once, it must say and do again,
//! byte by byte and microsecond by microsecond.
//!
//! ```text
//! UPDATE_GOLDEN=1 cargo test --release -p plotter-replay --test all golden_presets::    # from the motors on
//! ```
//!
//! The machines are those of `examples/machines`, where they lie beside this crate; one with a belt has no
//! serial line, and a log of its own.
#![cfg(feature = "cli")] // machines as files

use crate::house;
use crate::linked_session;

use linked_session::LinkedSession;
use plotter_motion::plant::{Bench, BenchSettings};
use plotter_motion::{
    LimitSwitches, Machine, Pen, PenMove, SafetyGate, StepPoint,
    config::{ControllerChoice, MachineKind, TransmissionConfig},
    kinematics::Backlash,
};
use plotter_replay::compare::Ways;
use plotter_replay::log::{self, Event, Header, Record, Writer};
use plotter_replay::transport::Faults;
use plotter_replay::{
    AnyController, BenchRecorder, Player, PlayerSettings, PlotterSettings, VirtualPlotter, golden,
};
use std::path::{Path, PathBuf};
use std::time::Duration;

fn directory(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The presets by name; none where this crate is alone.
fn presets() -> Vec<(String, Machine)> {
    let Ok(files) = std::fs::read_dir(directory("../examples/machines")) else {
        println!("left out: there are no machines beside this crate");
        return Vec::new();
    };
    let mut presets: Vec<_> = files
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|suffix| suffix == "toml"))
        .map(|path| {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            (name, Machine::from_toml(&std::fs::read_to_string(&path).unwrap()).unwrap())
        })
        .collect();
    presets.retain(|(_, machine)| {
        let config = machine.config();
        // Of what the belts do, a controller and so its log know nothing; worn ones are for the test bed.
        machine.kind() != MachineKind::Belt
            && config.dc().is_none_or(|dc| dc.x.transmission == TransmissionConfig::default())
    });
    presets.sort_by(|a, b| a.0.cmp(&b.0));
    presets
}

/// What is recorded of a machine: name of the log, its header, the machine.
fn sessions(name: &str, machine: &Machine) -> Vec<(String, Header, Machine)> {
    let header =
        Header::new().with_number("baud", u64::from(machine.config().serial.baud)).with_text("machine", name);
    match machine.kind() {
        MachineKind::Steppers => {
            let steppers = machine.config().steppers().unwrap();
            let [x, y] = [steppers.x, steppers.y].map(|axis| 1.0 / axis.steps_per_mm);
            let mut header = header.with_decimal("x_mm_per_pulse", x).with_decimal("y_mm_per_pulse", y);
            let play = Backlash::of(machine);
            if play != Backlash::default() {
                header = header.with_number("x_play_steps", play.x_steps.into());
                header = header.with_number("y_play_steps", play.y_steps.into());
            }
            let session = |protocol| {
                (format!("{name}.{protocol}"), header.clone().with_text("protocol", protocol), *machine)
            };
            ["mdraw", "grbl"].map(session).to_vec()
        }
        _ => [("published", ControllerChoice::Published), ("contouring", ControllerChoice::Contouring)]
            .map(|(controller, choice)| {
                let mut config = *machine.config();
                config.dc_mut().unwrap().control.controller = choice;
                // The published pause of 10 ms after each byte changes nothing but the length.
                config.serial.byte_gap_ms = 0.5;
                let header =
                    header.clone().with_text("protocol", "digits").with_text("controller", controller);
                (format!("{name}.{controller}"), header, Machine::new(config).unwrap())
            })
            .to_vec(),
    }
}

/// Up, down and to the right, and home.
fn tick_mark() -> [PenMove; 4] {
    let moves = [(Pen::Up, 0, 24), (Pen::Down, 12, 8), (Pen::Down, 48, 56), (Pen::Up, 0, 0)];
    moves.map(|(pen, x, y)| PenMove { pen, target: StepPoint::new(x, y) })
}

/// A tick mark.
fn record(header: &Header, machine: &Machine) -> Vec<u8> {
    let writer = Writer::new(Vec::new(), header).unwrap();
    if machine.kind() == MachineKind::Steppers {
        return record_stepper(header, machine, writer);
    }
    let mut bench = Bench::new(machine, BenchSettings::default(), tick_mark().into_iter());
    let mut recorder = BenchRecorder::new(writer);
    while !bench.host().is_done() && bench.now() < Duration::from_secs(20) {
        bench.step(|time, event| recorder.record(time, event));
    }
    recorder.finish().unwrap()
}

/// A program of a host that waits so long after each line that it is done.
fn record_stepper(header: &Header, machine: &Machine, mut writer: Writer<Vec<u8>>) -> Vec<u8> {
    let lines: &[&str] = if header.text("protocol") == Some("grbl") {
        &[
            "?",
            "G21\n",
            "G90\n",
            "G1 X0 Y0.6 F600\n",
            "M3 S1000\n",
            "G1 X0.3 Y0.2\n",
            "G1 X1.2 Y1.4\n",
            "M5\n",
            "G0 X0 Y0\n",
            "G7\n",
        ]
    } else {
        &[
            "M10\n",
            "M1 160\n",
            "G1 X0 Y0.6\n",
            "M1 90\n",
            "G1 X0.3 Y0.2\n",
            "G1 X1.2 Y1.4\n",
            "M1 160\n",
            "G1 X0 Y0\n",
            "M99\n",
        ]
    };
    let inputs = (1..).zip(lines).map(|(second, line)| Record {
        time: Duration::from_secs(second),
        event: Event::Host(line.as_bytes().to_vec()),
    });
    let end = Record {
        time: Duration::from_secs(lines.len() as u64 + 2),
        event: Event::Note("end of the session".into()),
    };
    let player = Player::new(PlayerSettings::from_header(header));
    let controller = AnyController::for_header(header, Some(machine)).unwrap();
    for record in player.rerun_iter(inputs.chain([end]), controller) {
        writer.write(&record.unwrap()).unwrap();
    }
    writer.finish().unwrap()
}

#[test]
fn every_preset_replays_its_golden_logs() {
    for (name, machine) in &presets() {
        for (session, header, machine) in sessions(name, machine) {
            let path = directory("tests/golden").join(format!("{session}.plog"));
            if golden::Mode::from_env() == golden::Mode::Renew {
                std::fs::write(&path, record(&header, &machine)).unwrap();
            }
            golden::assert_replays(&path, || AnyController::for_header(&header, Some(&machine)).unwrap());
            if machine.kind() == MachineKind::Steppers {
                assert_is_drawn(&path, &machine);
            }
        }
    }
}

/// A log of lines with steps is drawn as what was meant: each place is met, and nothing lies beside its line.
fn assert_is_drawn(path: &Path, machine: &Machine) {
    let mut reader = log::open(path).unwrap();
    let mut plotter = VirtualPlotter::new(PlotterSettings::from_header(reader.header()).unwrap());
    reader.by_ref().for_each(|record| plotter.push(&record.unwrap()));
    plotter.finish();
    let [targets, reached] = [plotter.target_count(), plotter.reached_count()];
    assert_eq!([targets, reached], [4; 2], "{}", path.display());
    // A place is met to half a step, and a corner may be left by as much as the planner rounds it.
    let config = machine.config();
    let steps_mm =
        2.0 / config.steppers().unwrap().x.steps_per_mm.min(config.steppers().unwrap().y.steps_per_mm);
    let most_mm = steps_mm + config.steppers().unwrap().planner.path_tolerance_mm;
    let error = plotter.contour_error(Ways::Drawn);
    assert!(error.max_mm <= most_mm, "{}: {error:?}, at most {most_mm} mm", path.display());
}

/// The same tick mark by frames, over a line that damages two bytes in a hundred: what was lost is sent
/// again, and is in the log.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_gantry_behind_the_link_replays_its_golden_log() {
    let path = directory("tests/golden/semi-virtual-gantry.linked.plog");
    let machine = house::machine(ControllerChoice::Contouring);
    if golden::Mode::from_env() == golden::Mode::Renew {
        let header = Header::new()
            .with_number("baud", u64::from(machine.config().serial.baud))
            .with_text("machine", "semi-virtual-gantry")
            .with_text("protocol", "link")
            .with_text("controller", "contouring")
            .with_number("boot", linked_session::BOOT.into());
        let mut session = LinkedSession::new(&machine, &Faults::mixed(0.02), 5, tick_mark().to_vec());
        let mut recorder = BenchRecorder::new(Writer::new(Vec::new(), &header).unwrap());
        session.run(Duration::from_secs(20), |time, event| recorder.record(time, event), |_, _| {});
        assert!(session.host.link().counts().sent_again > 0, "nothing was damaged");
        std::fs::write(&path, recorder.finish().unwrap()).unwrap();
    }
    golden::assert_replays(&path, || AnyController::for_log(&path, None).unwrap());
}

#[test]
fn two_re_runs_are_the_same_to_the_byte() {
    for (name, machine) in &presets() {
        for (session, header, machine) in sessions(name, machine) {
            let path = directory("tests/golden").join(format!("{session}.plog"));
            let records: Vec<Record> = log::open(&path).unwrap().map(Result::unwrap).collect();
            let settings = PlayerSettings::for_recording(&header, &records);
            let rerun = || {
                let mut writer = Writer::new(Vec::new(), &header).unwrap();
                let controller = AnyController::for_header(&header, Some(&machine)).unwrap();
                for record in Player::new(settings).rerun_iter(records.iter().cloned(), controller) {
                    writer.write(&record.unwrap()).unwrap();
                }
                writer.finish().unwrap()
            };
            assert_eq!(rerun(), rerun(), "{session}");
        }
    }
}

/// Two motors on one belt, 3 mm to the right and 2 mm up, with the controller that the report describes.
#[test]
fn the_marking_board_replays_its_golden_log() {
    use plotter_motion::control::ChosenController;
    use plotter_motion::firmware::{MarkingBoard, MarkingBoardSettings};
    use plotter_motion::{Axis, MachineConfig, Point, Vec2};
    let path = directory("tests/golden/marking-board.plog");
    let header = Header::new().with_text("machine", "marking-board").with_text("controller", "marking-board");
    if golden::Mode::from_env() == golden::Mode::Renew {
        let mut config = MachineConfig::marking_board();
        config.dc_mut().unwrap().control.controller = ControllerChoice::Published;
        let machine = Machine::new(config).unwrap();
        let settings = MarkingBoardSettings::of(&machine);
        let mut board = MarkingBoard::new(
            settings,
            ChosenController::of(&machine),
            SafetyGate::new(LimitSwitches::RELEASED, false),
        );
        let mut writer = Writer::new(Vec::new(), &header).unwrap();
        let mut write = |time, event| writer.write(&Record { time, event }).unwrap();
        let start: Point = settings.start;
        let to = start + Vec2::new(3.0, 2.0);
        let ops = [plotter_motion::PlotOp::Draw { to, feed_mm_s: None }];
        let mut duties = [0; 2];
        let mut travelled = [0.0_f64; 2];
        let mut now = Duration::ZERO;
        for next in settings.moves(ops).map(Result::unwrap) {
            write(now, Event::Pen(next.pen));
            write(now, Event::Target { x: next.target.x, y: next.target.y });
            board.start(now, next);
            // Motors that follow the voltage at once, 30 mm/s with all of it, the second a tenth slower.
            while !board.has_arrived() && now < Duration::from_secs(5) {
                for (axis, duty) in Axis::BOTH.into_iter().zip(&mut duties) {
                    let is = board.drive().axis(axis).steps(255);
                    if is != *duty {
                        *duty = is;
                        write(now, Event::Drive { axis, duty: is });
                    }
                }
                now += Duration::from_micros(500);
                if board.next_tick() <= now {
                    board.tick(now);
                }
                for ((axis, counts), gain) in Axis::BOTH.into_iter().zip(&mut travelled).zip([1.0, 0.9]) {
                    let before = counts.floor();
                    *counts += f64::from(board.drive().axis(axis).value()) * gain * 30.0 * 46.3 * 500e-6;
                    if counts.floor() != before {
                        let sign = if counts.floor() > before {
                            plotter_motion::Direction::Plus
                        } else {
                            plotter_motion::Direction::Minus
                        };
                        write(now, Event::Edge { axis, sign });
                        board.pulse(now, axis);
                    }
                }
            }
        }
        std::fs::write(&path, writer.finish().unwrap()).unwrap();
    }
    golden::assert_replays(&path, || AnyController::for_header(&header, None).unwrap());
}

/// What is reviewed in a diff must be worth reading: short, and each session does what it was told.
#[test]
fn the_golden_logs_are_short_and_end_where_they_should() {
    for (name, machine) in &presets() {
        for (session, ..) in sessions(name, machine) {
            let path = directory("tests/golden").join(format!("{session}.plog"));
            let records: Vec<Record> = log::open(&path).unwrap().map(Result::unwrap).collect();
            assert!((50..5_000).contains(&records.len()), "{session}: {} records", records.len());
            let mut at = StepPoint::default();
            let mut lowered = 0;
            for record in &records {
                match record.event {
                    Event::Edge { axis: plotter_motion::Axis::X, sign } => at.x += sign.sign(),
                    Event::Edge { axis: plotter_motion::Axis::Y, sign } => at.y += sign.sign(),
                    Event::Pen(Pen::Down) => lowered += 1,
                    _ => {}
                }
            }
            // The published controller runs past its targets and is done there.
            let most = if session.ends_with("published") { 200 } else { 1 };
            assert!(at.x.abs() <= most && at.y.abs() <= most, "{session} ends at ({}, {})", at.x, at.y);
            assert!(lowered >= 1 || session.ends_with("grbl"), "{session}: the pen was never down");
        }
    }
}
