//! Any bytes between host and machine, run again on the machine's controller: no panic, an end, and the same
//! twice.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_motion::protocol::Hello;
use plotter_motion::protocol::frame::{Frame, Kind};
use plotter_motion::{Machine, MachineConfig};
use plotter_replay::log::{Event, Header, Record};
use plotter_replay::{AnyController, Player, PlayerSettings, compare::Decoder, player::RecordingTraits};
use std::time::Duration;

// Three bytes make a record: who says it, how long after the last, and what. A host's call and greeting come
// first, so that frames of session 9 are understood; the machine's own are those of a recording.
fuzz_target!(|bytes: &[u8]| {
    let mut records = Vec::new();
    let mut time = Duration::ZERO;
    let mut say = |after_us: u64, event: Event| {
        time += Duration::from_micros(after_us);
        records.push(Record { time, event });
    };
    let hello = |session: u8| {
        let hello = Hello { version: 1, window: 4, payload: 64, session: session.into(), capabilities: 0 };
        let payload = hello.to_bytes();
        let frame = Frame { kind: Kind::Hello, sequence: 0, acknowledged: 0, limit: 4, payload: &payload };
        let (bytes, length) = frame.encode(0).expect("it is short");
        [&[0], &bytes[..length]].concat()
    };
    say(100, Event::Host(vec![0; 20]));
    say(1_000, Event::Controller(hello(0)));
    say(1_000, Event::Host(hello(9)));
    say(1_000, Event::Controller(hello(9)));
    let (mut sequences, mut chunks) = ([0_u8; 2], bytes);
    while let [how, after, rest @ ..] = chunks {
        let length = usize::from(how >> 3).min(rest.len());
        let (payload, left) = rest.split_at(length);
        chunks = left;
        let side = usize::from(how & 1);
        let framed = how & 2 != 0;
        let said = if framed {
            let kind = [Kind::Data, Kind::Acknowledge, Kind::Order][usize::from(after % 3)];
            let sequence = sequences[side];
            sequences[side] = sequence.wrapping_add(u8::from(kind == Kind::Data));
            let frame = Frame { kind, sequence, acknowledged: sequences[1 - side], limit: 200, payload };
            let (bytes, length) = frame.encode(9).expect("it is short");
            bytes[..length].to_vec()
        } else {
            payload.to_vec()
        };
        if said.is_empty() {
            continue;
        }
        say(u64::from(*after) * 50, if side == 0 { Event::Host(said) } else { Event::Controller(said) });
    }
    let machine = Machine::new(MachineConfig::default()).expect("the preset is right");
    let mut traits = RecordingTraits::default();
    records.iter().for_each(|record| traits.look(record));
    let header = Header::new();
    let settings: PlayerSettings = traits.settings(&header, false);
    let player = Player::new(settings);
    let rerun = || -> Vec<_> {
        let controller =
            AnyController::for_recording(&header, &traits, Some(&machine)).map_err(|error| error.to_string());
        controller.into_iter().flat_map(|controller| player.rerun_iter(records.clone(), controller)).collect()
    };
    assert_eq!(rerun(), rerun());
    let mut decoder = Decoder::new(&player.header(&header));
    player.inputs(records.clone()).for_each(|record| drop(decoder.words(&record)));
    if let Ok(controller) = AnyController::for_recording(&header, &traits, Some(&machine)) {
        let _ = player.check(records, controller).to_string();
    }
});
