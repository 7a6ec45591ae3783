//! Writes a recording of as many pulses as asked for: what pages and tools do with long ones is measured on
//! it.
//!
//! A rosette is drawn again and again, each round turned a little, target by target, with the pen up between
//! petals. The motors follow as well as motors do: a pulse to the side now and then, a silence at every
//! thousandth target, one pulse in a million lost on the line.
//!
//! ```text
//! cargo run --release -p plotter-replay --example long_recording -- 10000000 long.plog
//! ```

use plotter_motion::protocol::digits;
use plotter_motion::{Pen, StepPoint};
use plotter_replay::log::{self, Event, Header, Record, WriteError};
use std::process::ExitCode;
use std::time::Duration;

/// Time of a byte at 256000 baud, ns.
const BYTE_NS: u64 = 39_063;
/// Bytes that a record has at most.
const GROUP: usize = 64;
/// Radius and centre of the rosette, encoder counts: 100 mm about (110, 110) mm.
const RADIUS: f64 = 4_000.0;
const CENTRE: f64 = 4_400.0;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [pulses, path] = arguments.as_slice() else {
        eprintln!("usage: long_recording PULSES FILE.plog");
        return ExitCode::from(2);
    };
    let Ok(pulses) = pulses.parse() else {
        eprintln!("{pulses}: expected a number of pulses");
        return ExitCode::from(2);
    };
    match write(pulses, path.as_ref()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{path}: {error}");
            ExitCode::from(2)
        }
    }
}

fn write(pulses: u64, path: &std::path::Path) -> Result<(), WriteError> {
    let header = Header::new()
        .with_number("baud", 256_000)
        .with_text("protocol", "digits")
        .with_text("machine", "rosette");
    let mut writer = log::create(path, &header)?;
    let (mut ns, mut sent, mut at, mut waiting) =
        (0_u64, 0_u64, StepPoint::new(0, 0), Vec::with_capacity(GROUP));
    for step in 0_u64.. {
        if sent >= pulses {
            break;
        }
        let record = |ns: u64, event| Record { time: Duration::from_nanos(ns), event };
        let petal = step.is_multiple_of(60);
        if petal || step % 60 == 1 {
            writer.write(&record(ns, Event::Pen(if petal { Pen::Up } else { Pen::Down })))?;
        }
        let target = rosette(step);
        let Ok(bytes) = digits::encode(target) else { continue };
        ns += if step % 1_000 == 999 { 2_000_000_000 } else { 10 * BYTE_NS };
        writer.write(&record(ns, Event::Host(bytes.to_vec())))?;
        for pulse in way(at, target, step) {
            sent += 1;
            ns += BYTE_NS;
            if !sent.is_multiple_of(1_000_000) {
                waiting.push(pulse);
            }
            if waiting.len() >= GROUP {
                writer.write(&record(ns, Event::Controller(std::mem::take(&mut waiting))))?;
            }
        }
        at = target;
        ns += BYTE_NS;
        waiting.push(b'+');
        writer.write(&record(ns, Event::Controller(std::mem::take(&mut waiting))))?;
    }
    writer.finish().map(|_| ())
}

/// The target of a step, encoder counts.
fn rosette(step: u64) -> StepPoint {
    #[expect(clippy::cast_precision_loss, reason = "far fewer steps than 2^53")]
    let turn = step as f64 * 0.021;
    let radius = RADIUS * libm::cos(turn * 7.003) * (0.6 + 0.4 * libm::sin(turn * 0.000_37));
    let count = |share: f64| plotter_motion::toolpath::from_mm(CENTRE + radius * share, 1.0);
    StepPoint::new(count(libm::cos(turn)), count(libm::sin(turn)))
}

/// The pulses from one place to another: the straight line, with a step aside and back now and then.
fn way(from: StepPoint, to: StepPoint, step: u64) -> impl Iterator<Item = u8> {
    let (dx, dy) = (i64::from(to.x) - i64::from(from.x), i64::from(to.y) - i64::from(from.y));
    let (ax, ay) = (dx.unsigned_abs(), dy.unsigned_abs());
    let x = if dx > 0 { b'1' } else { b'2' };
    let y = if dy > 0 { b'3' } else { b'4' };
    let most = ax.max(ay);
    let aside = if step % 50 == 7 { 8 } else { 1 };
    (0..most).flat_map(move |n| {
        let gone = |all: u64| (n + 1) * all / most - n * all / most;
        let main = std::iter::repeat_n(x, usize::from(gone(ax) == 1))
            .chain(std::iter::repeat_n(y, usize::from(gone(ay) == 1)));
        let stray: &[u8] = match n {
            20 if most > 60 => b"3333333311111111",
            40 if most > 60 => b"4444444422222222",
            _ => b"",
        };
        main.chain(stray.chunks(8).flat_map(move |run| run.iter().copied().take(aside)))
    })
}
