//! A machine behind the reliable link, recorded and run again: the same frames, byte by byte and microsecond
//! by microsecond, over a good line and a bad one; and the same answers where the recorder knew nothing of
//! its motors.

use crate::house;
use crate::linked_session;

use house::{house, machine};
use linked_session::{BOOT, LinkedSession};
use plotter_motion::protocol::Order;
use plotter_motion::{
    Machine,
    config::{AreaConfig, ControllerChoice},
};
use plotter_replay::log::{Event, Header, Reader, Record, Writer};
use plotter_replay::transport::Faults;
use plotter_replay::{
    AnyController, BenchRecorder, Outcome, Player, PlayerSettings, golden,
    player::{EdgeSource, LinkedController, LinkedMachine, RecordingTraits},
};
use std::time::Duration;

const MINUTE: Duration = Duration::from_secs(60);

fn records(log: &[u8]) -> Vec<Record> {
    Reader::new(log).unwrap().map(|record| record.unwrap()).collect()
}

fn header() -> Header {
    Header::new()
        .with_number("baud", 256_000)
        .with_text("protocol", "link")
        .with_text("controller", "contouring")
}

/// What a recorder in the machine has, as a log; and what one at the host has.
fn recorded(machine: &Machine, faults: &Faults, seed: u64) -> (Vec<u8>, Vec<Record>) {
    let mut recorder =
        BenchRecorder::new(Writer::new(Vec::new(), &header().with_number("boot", BOOT.into())).unwrap());
    let mut heard = Vec::new();
    let mut session = LinkedSession::new(machine, faults, seed, house());
    session.run(
        MINUTE,
        |time, event| recorder.record(time, event),
        |time, event| heard.push(Record { time, event }),
    );
    (recorder.finish().unwrap(), heard)
}

/// A hundredth of all bytes damaged, and a cable that is out for a second.
fn bad() -> Faults {
    let cut = vec![Duration::from_millis(300)..Duration::from_millis(1_300)];
    Faults { cut, ..Faults::mixed(0.01) }
}

fn check(records: &[Record], machine: &Machine) -> Outcome {
    let mut traits = RecordingTraits::default();
    records.iter().for_each(|record| traits.look(record));
    let header = traits.header(&header());
    let linked = LinkedMachine::of_header(&header).unwrap();
    assert_eq!(linked, LinkedMachine { boot: BOOT, window: 4, payload: 64 });
    let controller = AnyController::for_recording(&header, &traits, Some(machine)).unwrap();
    Player::new(traits.settings(&header, false)).check(records.iter().cloned(), controller)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_recording_of_frames_replays_equal_over_a_good_line_and_a_bad_one() {
    for controller in [ControllerChoice::Contouring, ControllerChoice::Published] {
        let machine = machine(controller);
        for (faults, seeds) in [(Faults::default(), 0..1), (Faults::mixed(0.01), 1..3), (bad(), 6..7)] {
            for seed in seeds {
                let (log, _) = recorded(&machine, &faults, seed);
                match check(&records(&log), &machine) {
                    Outcome::Equal(compared) => {
                        assert!(compared.bytes > 300 && compared.duties > 100, "{compared}");
                    }
                    Outcome::FirstDifference(difference) => {
                        panic!("{controller:?}, seed {seed}: {difference}")
                    }
                }
            }
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn two_re_runs_are_the_same_to_the_byte_and_so_is_a_re_run_of_one() {
    let machine = machine(ControllerChoice::Contouring);
    let (log, _) = recorded(&machine, &bad(), 3);
    let first = records(&log);
    let rerun = |records: &[Record]| -> Vec<Record> {
        let player = Player::new(PlayerSettings::for_recording(&header(), records));
        let controller = LinkedController::<4, 64>::new(&machine, BOOT);
        player.rerun_iter(records.iter().cloned(), controller).map(Result::unwrap).collect()
    };
    let (second, again) = (rerun(&first), rerun(&first));
    assert_eq!(second, again);
    assert!(check(&second, &machine).is_equal());
    let bytes = |records: &[Record]| -> Vec<(Duration, Event)> {
        let is_line = |r: &&Record| matches!(r.event, Event::Host(_) | Event::Controller(_));
        records.iter().filter(is_line).map(|r| (r.time, r.event.clone())).collect()
    };
    assert_eq!(bytes(&first), bytes(&second));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_recording_without_edges_is_run_again_message_by_message() {
    let machine = machine(ControllerChoice::Contouring);
    for (faults, seeds) in [(Faults::default(), 0..1), (Faults::mixed(0.01), 1..5), (bad(), 11..13)] {
        for seed in seeds {
            let (_, heard) = recorded(&machine, &faults, seed);
            assert_eq!(EdgeSource::from_records(&heard), EdgeSource::Messages);
            match check(&heard, &machine) {
                // the status, and seven targets reached, two bytes each
                Outcome::Equal(compared) => assert!(compared.bytes >= 6 + 7 * 2, "{compared}"),
                Outcome::FirstDifference(difference) => panic!("seed {seed}: {difference}"),
            }
        }
    }
}

/// A machine that is smaller than the one that was recorded refuses a target.
fn smaller(machine: &Machine) -> Machine {
    let mut config = *machine.config();
    config.area = AreaConfig { height_mm: 12.0, ..config.area };
    Machine::new(config).unwrap()
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_differs_is_told_in_words() {
    let machine = machine(ControllerChoice::Contouring);
    let (log, heard) = recorded(&machine, &Faults::default(), 1);
    for records in [records(&log), heard] {
        let mut traits = RecordingTraits::default();
        records.iter().for_each(|record| traits.look(record));
        let header = traits.header(&header());
        let player = Player::new(traits.settings(&header, false));
        let controller = AnyController::for_recording(&header, &traits, Some(&smaller(&machine))).unwrap();
        let Outcome::FirstDifference(difference) = player.check(records.iter().cloned(), controller) else {
            panic!("equal, though the machine is smaller");
        };
        let words = difference.in_words(&player.header(&header), || player.inputs(records.iter().cloned()));
        assert!(words.contains("reached"), "{words}");
        assert!(words.lines().count() >= 20, "{words}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_golden_recording_of_frames_holds_fails_and_is_renewed() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("house.plog");
    let machine = machine(ControllerChoice::Contouring);
    let (log, heard) = recorded(&machine, &Faults::mixed(0.01), 5);
    std::fs::write(&path, log).unwrap();
    let replays = |machine: &Machine, mode| {
        golden::check(&path, || AnyController::for_log(&path, Some(machine)).unwrap(), mode)
    };
    replays(&machine, golden::Mode::Compare).unwrap();
    let other = smaller(&machine);
    let error = replays(&other, golden::Mode::Compare).unwrap_err().to_string();
    assert!(error.contains("first difference at "), "{error}");
    let diff = std::fs::read_to_string(directory.path().join("house.plog.diff")).unwrap();
    assert!(diff.contains("its frame ends at record") && diff.contains("reached"), "{diff}");
    replays(&other, golden::Mode::Renew).unwrap();
    replays(&other, golden::Mode::Compare).unwrap();

    // Without edges it holds and fails as well, and cannot be made anew.
    let mut writer = Writer::new(Vec::new(), &header()).unwrap();
    heard.iter().for_each(|record| writer.write(record).unwrap());
    std::fs::write(&path, writer.finish().unwrap()).unwrap();
    replays(&machine, golden::Mode::Compare).unwrap();
    assert!(replays(&other, golden::Mode::Compare).is_err());
    let error = replays(&machine, golden::Mode::Renew).unwrap_err().to_string();
    assert!(error.contains("no edges"), "{error}");
}

/// An order passes all else by, cuts the frame under way, and is repeated until it is answered.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn orders_on_a_bad_line_replay_equal() {
    let machine = machine(ControllerChoice::Contouring);
    for seed in 0..2 {
        let mut recorder = BenchRecorder::new(Writer::new(Vec::new(), &header()).unwrap());
        let mut heard = Vec::new();
        let mut session = LinkedSession::new(&machine, &Faults::mixed(0.01), seed, house());
        session.orders.extend([
            (150, Order::Stop),
            (600, Order::GoOn),
            (800, Order::Hold),
            (1_300, Order::GoOn),
        ]);
        session.run(
            MINUTE,
            |time, event| recorder.record(time, event),
            |time, event| heard.push(Record { time, event }),
        );
        let inside = records(&recorder.finish().unwrap());
        for records in [inside, heard] {
            let outcome = check(&records, &machine);
            assert!(outcome.is_equal(), "seed {seed}: {outcome}");
        }
    }
}
