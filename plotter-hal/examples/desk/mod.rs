//! A board on the desk: a clock that somebody sets, pins that print what is done to them, a serial port that
//! hears what it is told.

#![allow(dead_code, reason = "each example uses what it needs")]
#![allow(clippy::print_stdout, reason = "the pins of this board are seen on the screen")]

use core::convert::Infallible;
use core::time::Duration;
use embedded_hal::digital::{self, InputPin, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write, WriteReady};
use plotter_hal::a4988::Timing;
use plotter_hal::{A4988, NoPin, StepperAxes};
use plotter_motion::Axis;
use std::cell::Cell;
use std::collections::VecDeque;
use std::rc::Rc;

/// Time since the board was switched on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clock(Rc<Cell<Duration>>);

impl Clock {
    pub(crate) fn now(&self) -> Duration {
        self.0.get()
    }

    pub(crate) fn set(&self, now: Duration) {
        self.0.set(now);
    }

    /// Prints a line with the time.
    pub(crate) fn say(&self, who: &str, what: &str) {
        println!("{:>9.4} s  {who:<8} {what}", self.now().as_secs_f64());
    }
}

/// A PWM output that prints its duty when it changes.
#[derive(Debug)]
pub(crate) struct Pwm {
    pub(crate) clock: Clock,
    pub(crate) name: &'static str,
    pub(crate) full: u16,
    pub(crate) duty: Option<u16>,
    /// Smaller changes are not printed.
    pub(crate) least_change: u16,
}

impl pwm::ErrorType for Pwm {
    type Error = Infallible;
}

impl SetDutyCycle for Pwm {
    fn max_duty_cycle(&self) -> u16 {
        self.full
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        if self.duty.is_none_or(|before| before.abs_diff(duty) >= self.least_change || duty == 0) {
            self.clock.say(self.name, &format!("duty {duty} of {}", self.full));
            self.duty = Some(duty);
        }
        Ok(())
    }
}

/// An input that is low, but for some times.
#[derive(Clone, Debug)]
pub(crate) struct Switch {
    pub(crate) clock: Clock,
    /// From and until when it is high, ms.
    pub(crate) high_ms: Vec<(u64, u64)>,
}

impl digital::ErrorType for Switch {
    type Error = Infallible;
}

impl InputPin for Switch {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        let now = self.clock.now();
        let within = |&(from, until): &(u64, u64)| {
            (Duration::from_millis(from)..Duration::from_millis(until)).contains(&now)
        };
        Ok(self.high_ms.iter().any(within))
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

/// An output that counts how often it has risen.
#[derive(Clone, Debug, Default)]
pub(crate) struct Line(Rc<Cell<(bool, u32)>>);

impl Line {
    pub(crate) fn rises(&self) -> u32 {
        self.0.get().1
    }
}

impl digital::ErrorType for Line {
    type Error = Infallible;
}

impl OutputPin for Line {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set((false, self.rises()));
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        let (was_high, rises) = self.0.get();
        self.0.set((true, rises + u32::from(!was_high)));
        Ok(())
    }
}

/// Two motors on such outputs, and both STEP lines.
pub(crate) fn motors() -> (Motors, [Line; 2]) {
    let steps = [Line::default(), Line::default()];
    let [x, y] = steps.clone();
    let x = A4988::new(Axis::X, x, Line::default(), Timing::A4988);
    (StepperAxes::new(x, A4988::new(Axis::Y, y, Line::default(), Timing::A4988)), steps)
}

/// A motor, and both.
type Motor = A4988<Line, Line, NoPin, NoPin>;
pub(crate) type Motors = StepperAxes<Motor, Motor>;

/// A serial port at 115200 baud, on which a host sends a text, and prints what it is answered.
#[derive(Debug)]
pub(crate) struct Port {
    clock: Clock,
    incoming: VecDeque<(Duration, Result<u8, ErrorKind>)>,
    answer: String,
}

/// Ten bits at 115200 baud.
const BYTE: Duration = Duration::from_nanos(86_806);

impl Port {
    /// Sends each text from its time on, ms; `?` in it comes broken.
    pub(crate) fn new(clock: &Clock, texts: &[(u64, &str)]) -> Self {
        let incoming = texts.iter().flat_map(|&(from_ms, text)| {
            (1..).zip(text.bytes()).map(move |(number, byte)| {
                let byte = if byte == b'?' { Err(ErrorKind::InvalidData) } else { Ok(byte) };
                (Duration::from_millis(from_ms) + BYTE * number, byte)
            })
        });
        Self { clock: clock.clone(), incoming: incoming.collect(), answer: String::new() }
    }

    /// When the next byte will have come.
    pub(crate) fn next_byte(&self) -> Option<Duration> {
        self.incoming.front().map(|(at, _)| *at)
    }
}

impl ErrorType for Port {
    type Error = ErrorKind;
}

impl ReadReady for Port {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        Ok(self.next_byte().is_some_and(|at| at <= self.clock.now()))
    }
}

impl Read for Port {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        let (Some((_, byte)), Some(place)) = (self.incoming.pop_front(), bytes.first_mut()) else {
            return Ok(0);
        };
        *place = byte?;
        Ok(1)
    }
}

impl WriteReady for Port {
    fn write_ready(&mut self) -> Result<bool, ErrorKind> {
        Ok(true)
    }
}

impl Write for Port {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        for &byte in bytes {
            match byte {
                b'\n' => {
                    self.clock.say("answer", self.answer.trim_end());
                    self.answer.clear();
                }
                _ => self.answer.push(char::from(byte)),
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
