//! A simulated machine of each dialect has a golden log: with the same bytes from its host at the same times
//! it does the same again, motors, switches and lost steps among it; and its controller does so on the log.
//!
//! ```text
//! UPDATE_GOLDEN=1 cargo test -p plotter-replay --features cli,live --test all golden_simulated::
//! ```

use plotter_motion::config::{JerkChoice, PathChoice};
use plotter_motion::{Machine, MachineConfig, StepPoint, protocol::digits};
use plotter_replay::live::{Line, MachineLog, SimulatedMachine, Spoken};
use plotter_replay::log::{self, Header};
use plotter_replay::simulation::Script;
use plotter_replay::{AnyController, Player, PlayerSettings, golden};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What a host sends, each when it has heard what the one before waits for.
type Talk = Vec<(Vec<u8>, &'static str)>;

fn talk(lines: &[(&str, &'static str)]) -> Talk {
    lines.iter().map(|&(line, answer)| (line.as_bytes().to_vec(), answer)).collect()
}

fn golden_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/simulated.{name}.plog"))
}

/// The log of a session, in the machine's time.
fn record(machine: &Machine, spoken: Spoken, header: &Header, script: &str, talk: &Talk) -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("machine.plog");
    let log = MachineLog::new(log::create(&path, header).unwrap());
    let simulated = SimulatedMachine::speaking(machine, spoken).unwrap();
    let simulated = simulated.with_script(Script::parse(script).unwrap());
    let line = simulated.logged(log.clone()).line(1e6);
    let mut heard = String::new();
    let mut bytes = [0; 64];
    for (said, answer) in talk {
        line.send(said).unwrap();
        heard.clear();
        while !heard.contains(answer) {
            let count = line.receive(&mut bytes, Duration::from_millis(1)).unwrap();
            heard.push_str(&String::from_utf8_lossy(&bytes[..count]));
            assert!(line.now() < Some(Duration::from_secs(100)), "{answer:?} does not come: {heard:?}");
        }
    }
    log.finish().unwrap();
    std::fs::read(path).unwrap()
}

/// A session of each dialect, as short as it can be read: its name, machine, header, script and host.
fn sessions() -> Vec<(&'static str, Machine, Spoken, Header, &'static str, Talk)> {
    let mut small = MachineConfig::stepper_plotter();
    (small.area.width_mm, small.area.height_mm) = (20.0, 10.0);
    (
        small.steppers_mut().unwrap().homing.known_travel_mm,
        small.steppers_mut().unwrap().homing.max_travel_mm,
    ) = (0.0, 30.0);
    (small.steppers_mut().unwrap().homing.fast_rate_hz, small.steppers_mut().unwrap().homing.pull_off_mm) =
        (4_000.0, 0.1);
    let steppers = small.steppers_mut().unwrap();
    for axis in [&mut steppers.x, &mut steppers.y] {
        axis.steps_per_mm = 20.0;
    }
    let steppers = Machine::new(small).unwrap();
    let mut config = MachineConfig::marking_board();
    config.dc_mut().unwrap().control.controller = plotter_motion::config::ControllerChoice::Published;
    let board = Machine::new(config).unwrap();
    let header = |machine: &Machine, protocol: &str, mm_per_pulse: f64| {
        let baud = machine.config().serial.baud;
        let header = Header::new().with_number("baud", baud.into()).with_text("protocol", protocol);
        header.with_decimal("x_mm_per_pulse", mm_per_pulse).with_decimal("y_mm_per_pulse", mm_per_pulse)
    };
    let grbl = talk(&[
        ("", "Grbl 1.1h"),
        ("$22=1\n", "ok"),
        ("$H\n", "ok"),
        ("G1 X2 Y1 F600\nM3\nX4\nG4 P0\n?", ">"),
        ("", "ok"),
        // held, and pushed
        ("G1 X6\nM5\nG4 P0\n", "ok\r\nok\r\nok"),
        ("G0 X90\n", "error:"),
        ("?", ">"),
    ]);
    let mdraw =
        talk(&[("G28\n", "OK"), ("M1 90\n", "OK"), ("G1 X2 Y1\n", "OK"), ("M11\n", "OK"), ("P\n", "OK")]);
    let target = |x, y| digits::encode(StepPoint::new(x, y)).unwrap().to_vec();
    let digits = vec![(target(7_037, 4_630), "+"), (target(7_037, 4_676), "+")];
    let board_header = header(&board, "counts", 1.0 / 46.3)
        .with_text("belt_signs", "direction-table")
        .with_decimal("p1_x_mm", 150.0)
        .with_decimal("p1_y_mm", 100.0)
        .with_decimal("reached_tolerance_counts", 42.0);
    let ebb = talk(&[
        ("V\rEM,1,1\rSP,0,50\r", "OK\r\nOK"),
        ("XM,100,40,20\rLM,40000000,20,4000,40000000,-30,8000,3\r", "OK\r\nOK"),
        ("SM,20,0,0\rSM,20,0,0\rQS\r", "80,-10"),
        ("SP,1,150\rQM\rHM,1000\rSM,10,0,0\rSM,10,0,0\rQS\r", "0,0"),
    ]);
    let ebb_header = header(&steppers, "ebb", 0.05).with_text("belt_signs", "tracking-equations");
    let marlin = talk(&[
        ("", "(simulated)\n"),
        ("M115\n", "ok\n"),
        ("G28\n", "ok\n"),
        ("M3\nG1 X2 Y1 F600\nG1 X4\nM5\nM400\nM114\n", "Count"),
        ("N1 G0 X1*99\n", "Resend: 1\n"),
        ("M110 N0\n", "ok\n"),
    ]);
    let hpgl = talk(&[
        ("IN;SP1;PU80,40;PD160,40,160,80;PU;OA;", "160,80,0\r"),
        ("XX;OE;", "1\r"),
        ("PU0,0;SP0;OS;", "\r"),
        ("\u{1b}.E", "\r"),
    ]);
    let script = "1.55 hold x\n1.6 let x\n1.65 lose y 16\n";
    vec![
        ("ebb", steppers, Spoken::Ebb { is_mixed: true }, ebb_header, "0.2 stop\n0.21 free\n", ebb),
        ("grbl", steppers, Spoken::Grbl, header(&steppers, "grbl", 0.05), script, grbl),
        ("mdraw", steppers, Spoken::MDraw, header(&steppers, "mdraw", 0.05), "", mdraw),
        ("marlin", steppers, Spoken::Marlin, header(&steppers, "marlin", 0.05), "", marlin),
        ("hpgl", steppers, Spoken::Hpgl, header(&steppers, "hpgl", 0.05), "", hpgl),
        ("counts", board, Spoken::Digits, board_header, "", digits),
    ]
}

#[test]
fn every_dialect_does_again_what_its_golden_log_has() {
    for (name, machine, spoken, header, script, talk) in sessions() {
        let path = golden_file(name);
        let made = record(&machine, spoken, &header, script, &talk);
        if golden::Mode::from_env() == golden::Mode::Renew {
            std::fs::write(&path, &made).unwrap();
        }
        let kept = std::fs::read(&path).unwrap();
        assert!(made == kept, "{name}: the simulated machine does otherwise than in its golden log");
        assert_eq!(record(&machine, spoken, &header, script, &talk), made, "{name}: not twice alike");
        golden::assert_replays(&path, || AnyController::for_header(&header, Some(&machine)).unwrap());
        let records: Vec<_> = log::open(&path).unwrap().map(Result::unwrap).collect();
        assert!((100..6_000).contains(&records.len()), "{name}: {} records", records.len());
        let settings = PlayerSettings::for_recording(&header, &records);
        let controller = AnyController::for_header(&header, Some(&machine)).unwrap();
        let outcome = Player::new(settings).check(records, controller);
        assert!(outcome.is_equal(), "{name}: {outcome}");
    }
}

/// Within a tolerance it is limited as a vector if the file does not say otherwise.
#[test]
fn a_machine_that_limits_the_jerk_as_a_vector_does_again_what_its_log_has() {
    let (_, steppers, spoken, header, script, talk) = sessions().swap_remove(1);
    let mut config = *steppers.config();
    (config.steppers_mut().unwrap().planner.mode, config.steppers_mut().unwrap().planner.s_curve) =
        (PathChoice::Tolerance, true);
    let averaged = Machine::new(config).unwrap();
    config.steppers_mut().unwrap().planner.jerk_limit = Some(JerkChoice::Path);
    let along = Machine::new(config).unwrap();
    let made = [&averaged, &along].map(|machine| record(machine, spoken, &header, script, &talk));
    assert_eq!(record(&averaged, spoken, &header, script, &talk), made[0], "not twice alike");
    assert!(made[0] != made[1]);
    let records: Vec<_> = log::Reader::new(&made[0][..]).unwrap().map(Result::unwrap).collect();
    let settings = PlayerSettings::for_recording(&header, &records);
    let is_equal = |machine| {
        let controller = AnyController::for_header(&header, Some(machine)).unwrap();
        Player::new(settings).check(records.clone(), controller).is_equal()
    };
    assert!(is_equal(&averaged) && !is_equal(&along));
}
