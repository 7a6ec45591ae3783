//! Which language a machine on a port speaks, and at which speed.

use super::commands::say;
use crate::live::Line;
use core::time::Duration;
use plotter_motion::protocol::hosts::{Finder, Finding, Tongue};
use std::io::Write;
use std::time::Instant;

/// Speeds of lines that machines have, bits a second: boards with a USB port first, then pen plotters, whose
/// switches go down to 1200.
const USUAL_BAUDS: [u32; 9] = [115_200, 9_600, 250_000, 57_600, 38_400, 19_200, 4_800, 2_400, 1_200];

/// A machine that was found.
#[derive(Debug)]
pub(super) struct Found<L> {
    pub(super) line: L,
    pub(super) tongue: Tongue,
    pub(super) baud: u32,
}

/// What is looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// The language, if it is known.
    pub(super) tongue: Option<Tongue>,
    /// The speed that the machine's description has.
    pub(super) baud: u32,
    /// Whether no other speed is tried.
    pub(super) is_fixed: bool,
}

/// Opens the port at one speed after the other, until a machine answers in a language that is known.
///
/// # Errors
///
/// The port's, or that none answers, with what can be done.
pub(super) fn find_machine<L: Line>(
    name: &str,
    wanted: Wanted,
    mut open: impl FnMut(u32) -> Result<L, String>,
    out: &mut impl Write,
) -> Result<Found<L>, String> {
    say(out, &format!("{name}: which language does the machine speak? (--protocol says it)"));
    let _ = out.flush();
    let line = open(wanted.baud)?;
    let clock = Clock::new(&line);
    let finder = match wanted.tongue {
        Some(tongue) => Finder::only(clock.now(&line), tongue),
        None => Finder::new(clock.now(&line)),
    };
    if let Some(tongue) = ask(&line, clock, finder)? {
        return Ok(Found { line, tongue, baud: wanted.baud });
    }
    drop(line); // a port is opened once
    let others = USUAL_BAUDS.into_iter().filter(|&baud| baud != wanted.baud && !wanted.is_fixed);
    for baud in others.clone() {
        let line = open(baud)?;
        let clock = Clock::new(&line);
        let now = clock.now(&line);
        let finder = wanted.tongue.map_or_else(|| Finder::asking(now), |tongue| Finder::only(now, tongue));
        if let Some(tongue) = ask(&line, clock, finder)? {
            say(
                out,
                &format!(
                    "{name}: it answers at {baud} bits a second: write `[serial] baud = {baud}` into its file"
                ),
            );
            return Ok(Found { line, tongue, baud });
        }
    }
    let tried: Vec<String> =
        core::iter::once(wanted.baud).chain(others).map(|baud| baud.to_string()).collect();
    Err(format!(
        "{name}: nothing that is there answers in a language known here, at {} bits a second: is the machine on, its cable \
         plugged in, and no other program at the port? --protocol says which language it is, --baud at which speed",
        tried.join(", ")
    ))
}

/// The time of a line: the clock's, or that of the machine at its end.
#[derive(Clone, Copy, Debug)]
struct Clock {
    began: Instant,
}

impl Clock {
    fn new(_: &impl Line) -> Self {
        Self { began: Instant::now() }
    }

    fn now(self, line: &impl Line) -> Duration {
        line.now().unwrap_or_else(|| self.began.elapsed())
    }
}

/// Asks until it is known, or nothing more can be asked.
fn ask(line: &impl Line, clock: Clock, mut finder: Finder) -> Result<Option<Tongue>, String> {
    let mut bytes = [0; 256];
    loop {
        match finder.poll(clock.now(line)) {
            Finding::Found(tongue) => return Ok(Some(tongue)),
            Finding::Send(question) => line.send(question).map_err(|error| error.to_string())?,
            Finding::Nothing => return Ok(None),
            Finding::Until(_) => {
                let count =
                    line.receive(&mut bytes, Duration::from_millis(50)).map_err(|error| error.to_string())?;
                bytes.get(..count).unwrap_or_default().iter().for_each(|&byte| finder.receive(byte));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::serial::PortError;
    use std::sync::Mutex;

    /// A pen plotter whose switches are set to a speed: at another one nothing makes sense, either way.
    #[derive(Debug)]
    struct Plotter {
        is_right: bool,
        inside: Mutex<(Vec<u8>, Duration)>,
    }

    impl Line for Plotter {
        fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
            let mut inside = self.inside.lock().unwrap();
            if !self.is_right {
                inside.0.extend(bytes.iter().map(|byte| !byte));
            } else if bytes.ends_with(b"OI;") {
                inside.0.extend(b"7475A\r");
            }
            Ok(())
        }
        fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
            let mut inside = self.inside.lock().unwrap();
            inside.1 += wait;
            let count = inside.0.len().min(bytes.len());
            bytes[..count].copy_from_slice(&inside.0[..count]);
            inside.0.drain(..count);
            Ok(count)
        }
        fn now(&self) -> Option<Duration> {
            Some(self.inside.lock().unwrap().1)
        }
    }

    #[test]
    fn the_speed_of_the_line_is_searched_among_the_usual_ones() {
        for (tongue, right) in
            [(None, 9_600), (Some(Tongue::Hpgl), 2_400), (Some(Tongue::Hpgl), 115_200), (None, 300)]
        {
            for is_fixed in [false, true] {
                let mut opened = Vec::new();
                let open = |baud| {
                    opened.push(baud);
                    Ok(Plotter { is_right: baud == right, inside: Mutex::default() })
                };
                let wanted = Wanted { tongue, baud: 115_200, is_fixed };
                let found = find_machine("here", wanted, open, &mut Vec::new());
                let is_there = right != 300 && (!is_fixed || right == 115_200);
                assert_eq!(found.is_ok(), is_there, "{right}, fixed: {is_fixed}");
                match found {
                    Ok(found) => assert_eq!((found.tongue, found.baud), (Tongue::Hpgl, right)),
                    Err(words) => assert!(words.contains("at 115200") && words.contains("--baud"), "{words}"),
                }
                assert_eq!(opened.len() > 1, !is_fixed && right != 115_200);
            }
        }
    }
}
