//! [`Finder`]: which language a machine speaks.

use super::Words;
use core::fmt;
use core::time::Duration;

/// A language that a machine answers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Tongue {
    /// GRBL's, also GRBLHAL's and `FluidNC`'s.
    Grbl,
    /// Marlin's, and that of other firmware of printers.
    Marlin,
    /// That of Makeblock's XY plotter with mDraw's firmware.
    MDraw,
    /// That of the EBB, the board of the `AxiDraw`.
    Ebb,
    /// HPGL's, with the device control of HP's pen plotters.
    Hpgl,
}

impl fmt::Display for Tongue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Grbl => "Grbl",
            Self::Marlin => "Marlin",
            Self::MDraw => "mDraw",
            Self::Ebb => "EBB",
            Self::Hpgl => "HPGL",
        })
    }
}

/// What a [`Finder`] wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// More bytes, or this time to come.
    Until(Duration),
    /// These bytes on the line.
    Send(&'static [u8]),
    /// It is this one.
    Found(Tongue),
    /// It is none of them, or nothing is there.
    Nothing,
}

/// How long a board that was reset by the opening of its port has for its greeting.
const GREETING: Duration = Duration::from_secs(5);
/// How long a machine has for an answer.
const ANSWER: Duration = Duration::from_millis(700);
/// What is asked, each once, none of which moves anything in any of the languages: GRBL's report, Marlin's
/// firmware, mDraw's machine, EBB's version, the identity of a pen plotter.
const QUESTIONS: [&[u8]; 5] = [b"?", b"\nM115\n", b"M10\n", b"\rV\r", b"\x1b.(;OI;"];

/// Finds out which language a machine speaks: it listens for a greeting first, then asks once in each;
/// sans-IO.
///
/// ```
/// # use plotter_motion::protocol::hosts::{Finder, Finding, Tongue};
/// # use core::time::Duration;
/// let mut finder = Finder::new(Duration::ZERO);
/// assert_eq!(finder.poll(Duration::from_secs(1)), Finding::Until(Duration::from_secs(5)));
/// b"Grbl 1.1h ['$' for help]\r\n".iter().for_each(|&byte| finder.receive(byte));
/// assert_eq!(finder.poll(Duration::from_secs(1)), Finding::Found(Tongue::Grbl));
/// ```
#[derive(Clone, Debug)]
pub struct Finder {
    heard: Words<1_024>,
    /// Until when it waits, and what it asks then.
    until: Duration,
    asks: usize,
    /// How many questions there are.
    last: usize,
}

impl Finder {
    /// One that begins to listen now, when the port is open.
    #[must_use]
    pub fn new(now: Duration) -> Self {
        Self { heard: Words::default(), until: now.saturating_add(GREETING), asks: 0, last: QUESTIONS.len() }
    }

    /// One that asks at once, of a machine whose greeting has passed: at another baud rate.
    #[must_use]
    pub fn asking(now: Duration) -> Self {
        Self { until: now, ..Self::new(now) }
    }

    /// One that asks at once, in one language.
    #[must_use]
    pub fn only(now: Duration, tongue: Tongue) -> Self {
        let (asks, last) = match tongue {
            Tongue::Grbl => (0, 1),
            Tongue::Marlin => (1, 2),
            Tongue::MDraw => (2, 3),
            Tongue::Ebb => (3, 4),
            Tongue::Hpgl => (4, 5),
        };
        Self { asks, last, ..Self::asking(now) }
    }

    /// Takes a byte of the machine; more than a thousand are not looked at.
    pub fn receive(&mut self, byte: u8) {
        let _ = self.heard.push(byte);
    }

    /// What is to be done now.
    pub fn poll(&mut self, now: Duration) -> Finding {
        if let Some(tongue) = recognized(self.heard.as_bytes(), self.asks) {
            return Finding::Found(tongue);
        }
        if now < self.until {
            return Finding::Until(self.until);
        }
        let asked = QUESTIONS.get(self.asks).filter(|_| self.asks < self.last);
        let Some(question) = asked else { return Finding::Nothing };
        self.asks += 1;
        self.until = now.saturating_add(ANSWER);
        Finding::Send(question)
    }
}

/// The language of what was heard behind so many questions.
fn recognized(heard: &[u8], asked: usize) -> Option<Tongue> {
    let has = |words: &[u8]| heard.windows(words.len()).any(|part| part == words);
    let lines = || heard.split(|&byte| byte == b'\n' || byte == b'\r').map(<[u8]>::trim_ascii);
    if has(b"Grbl") && has(b"\n") || lines().any(|line| line.starts_with(b"<") && line.ends_with(b">")) {
        return Some(Tongue::Grbl);
    }
    let marlin = [b"FIRMWARE_NAME:".as_slice(), b"Marlin", b"echo:", b"Repetier"];
    if marlin.iter().any(|words| has(words)) || lines().any(|line| line == b"start") {
        return Some(Tongue::Marlin);
    }
    if has(b"EBBv") || has(b"EBB ") || has(b"!8 Err") {
        return Some(Tongue::Ebb);
    }
    // It answers every line so, whatever that is; GRBL would say `ok`.
    if has(b"M10 ") || asked >= 2 && lines().any(|line| line == b"OK") {
        return Some(Tongue::MDraw);
    }
    // A name as HP's plotters have them: 7475A.
    let is_name =
        |line: &[u8]| line.len() >= 4 && line.iter().take(4).all(u8::is_ascii_digit) && line.len() <= 8;
    (asked >= 5 && lines().any(is_name)).then_some(Tongue::Hpgl)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is found of a machine that answers so, and how many bytes it was asked.
    fn find(mut answer: impl FnMut(&[u8]) -> &'static [u8], greeting: &[u8]) -> (Finding, usize) {
        let mut finder = Finder::new(Duration::ZERO);
        greeting.iter().for_each(|&byte| finder.receive(byte));
        let (mut now, mut asked) = (Duration::ZERO, 0);
        loop {
            match finder.poll(now) {
                Finding::Until(until) => now = until,
                Finding::Send(bytes) => {
                    asked += bytes.len();
                    answer(bytes).iter().for_each(|&byte| finder.receive(byte));
                }
                end => return (end, asked),
            }
        }
    }

    #[test]
    fn greetings_tell_and_nothing_is_asked() {
        let greetings: [(&[u8], Tongue); 4] = [
            (b"\r\nGrbl 1.1h ['$' for help]\r\n", Tongue::Grbl),
            (b"\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n", Tongue::Grbl),
            (b"\r\nGrbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]\r\n", Tongue::Grbl),
            (b"start\r\necho:Marlin 2.1.2\r\n", Tongue::Marlin),
        ];
        for (greeting, tongue) in greetings {
            assert_eq!(find(|_| b"", greeting), (Finding::Found(tongue), 0));
        }
    }

    #[test]
    fn machines_that_do_not_greet_are_asked_once_in_each_language() {
        let mdraw = |asked: &[u8]| -> &'static [u8] { if asked.contains(&b'\n') { b"OK\r\n" } else { b"" } };
        assert_eq!(find(mdraw, b"").0, Finding::Found(Tongue::MDraw));
        let ebb = |asked: &[u8]| -> &'static [u8] {
            if asked == b"\rV\r" { b"EBBv13_and_above EB Firmware Version 2.8.1\r\n" } else { b"" }
        };
        assert_eq!(find(ebb, b"").0, Finding::Found(Tongue::Ebb));
        let plotter =
            |asked: &[u8]| -> &'static [u8] { if asked.ends_with(b"OI;") { b"7475A\r" } else { b"" } };
        assert_eq!(find(plotter, b"").0, Finding::Found(Tongue::Hpgl));
        let grbl = |asked: &[u8]| -> &'static [u8] {
            if asked == b"?" { b"<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n" } else { b"" }
        };
        assert_eq!(find(grbl, b""), (Finding::Found(Tongue::Grbl), 1));
        assert_eq!(find(|_| b"", b""), (Finding::Nothing, QUESTIONS.iter().map(|asked| asked.len()).sum()));
        assert_eq!(find(|_| b"what?\r\n", b"").0, Finding::Nothing);
    }

    #[test]
    fn one_language_only_is_asked_at_once() {
        let now = Duration::from_secs(3);
        let mut finder = Finder::only(now, Tongue::Hpgl);
        assert_eq!(finder.poll(now), Finding::Send(b"\x1b.(;OI;"));
        let mut silent = finder.clone();
        b"7470A\r".iter().for_each(|&byte| finder.receive(byte));
        assert_eq!(finder.poll(now), Finding::Found(Tongue::Hpgl));
        assert_eq!(silent.poll(now + ANSWER), Finding::Nothing);
        let mut asking = Finder::asking(now);
        assert_eq!(asking.poll(now), Finding::Send(b"?"));
    }
}
