//! [`MDraw`]: the conversation with mDraw.

mod line;
mod refusal;

use super::output::Output;
use super::{
    Command, Link, Report, Signal, StartupLines, Status, StepperPlotterSettings, Stop, StoredSettings,
};
use crate::protocol::SUBSTITUTE;
use crate::{PlotOp, Point};
use core::fmt;
use line::Request;
use refusal::Refusal;

/// Most bytes of a line. The original's buffer has 64 with the line end, and begins again at its start.
const MOST_BYTES: usize = 63;
/// Bytes that wait to be sent.
const OUTPUT: usize = 512;
/// Most bytes that one line is answered with.
const MOST_ANSWER: usize = 320;
/// Most commands that one line becomes.
const MOST_COMMANDS: usize = 4;
/// Shorter moves are not made, mm.
const LEAST_MM: f32 = 0.001;
/// Longest delay a step, us.
const MOST_DELAY_US: i32 = 1_000_000;
/// Greatest side of the area, mm.
const MOST_SIDE_MM: i32 = 10_000;

/// The receive side for mDraw. One line at a time; each is answered by one `OK`.
#[derive(Clone, Debug, PartialEq)]
pub struct MDraw {
    settings: StepperPlotterSettings,
    /// What the host has stored; `settings.stored` is what holds until the next restart.
    stored: StoredSettings,
    line: [u8; MOST_BYTES],
    /// Bytes of the line so far, also of those that found no room.
    len: usize,
    /// Whether a byte of it was broken.
    broken: bool,
    /// A line that has come and waits for room.
    pending: Option<Result<Request, Refusal>>,
    /// The motion side carries out a line.
    in_flight: bool,
    /// Lines that came before the one before was answered.
    early: u32,
    /// Where the pen has been sent, mm, in the precision of the original.
    at: (f32, f32),
    delay_us: i32,
    /// Whether X and Y are ways from there: `G91`, up to `G90` or a restart.
    relative: bool,
    /// Whether the servo was last told an angle nearer to that of the pen down.
    pen_down: bool,
    laser_on: bool,
    /// The motion side waits to hear that its stop has been heard of.
    stopped: bool,
    out: Output<OUTPUT>,
}

impl MDraw {
    pub(super) fn new(settings: StepperPlotterSettings) -> Self {
        Self {
            settings,
            stored: settings.stored,
            line: [0; MOST_BYTES],
            len: 0,
            broken: false,
            pending: None,
            in_flight: false,
            early: 0,
            at: (0.0, 0.0),
            delay_us: 0,
            relative: false,
            pen_down: false,
            laser_on: false,
            stopped: false,
            out: Output::new(),
        }
    }

    pub(super) const fn stored(&self) -> StoredSettings {
        self.stored
    }

    pub(super) fn transmit(&mut self) -> Option<u8> {
        self.out.pop()
    }

    /// It knows no lines that are carried out at its start.
    #[expect(clippy::unused_self, reason = "as the other dialect has it")]
    pub(super) fn startup_lines(&self) -> StartupLines {
        StartupLines::default()
    }

    #[expect(clippy::unused_self, reason = "as the other dialect has it")]
    pub(super) const fn set_startup_lines(&mut self, _: &StartupLines) {}

    pub(super) const fn set_homed(&mut self, _: crate::homing::Homed) {}

    /// The port has been opened anew, at `at`.
    pub(super) fn restart(&mut self, at: Point) {
        *self = Self::new(StepperPlotterSettings { stored: self.stored, ..self.settings });
        self.stand_at(at);
    }

    pub(super) fn receive(&mut self, byte: u8) -> Option<Signal> {
        if byte != b'\n' {
            self.broken |= byte == SUBSTITUTE;
            if let Some(slot) = self.line.get_mut(self.len) {
                *slot = byte;
            }
            self.len = self.len.saturating_add(1);
            return None;
        }
        let request = match self.line.get(..core::mem::take(&mut self.len)) {
            _ if core::mem::take(&mut self.broken) => Err(Refusal::Broken),
            Some(line) => Ok(Request::read(line)),
            None => Err(Refusal::TooLong),
        };
        if self.pending.is_none() && !self.in_flight && self.early == 0 {
            self.pending = Some(request);
            return None;
        }
        self.early = self.early.saturating_add(1);
        // The stop button of mDraw must not wait for a long line to end.
        (request == Ok(Request::Laser(Some(0)))).then_some(Signal::LaserOff)
    }

    pub(super) fn work(&mut self, status: &Status, link: &mut Link) {
        while self.out.room() >= MOST_ANSWER
            && let Some(report) = link.reports.pop()
        {
            self.take(report);
        }
        if self.out.room() >= MOST_ANSWER
            && link.commands.room() >= MOST_COMMANDS
            && let Some(request) = self.pending.take()
        {
            if let Err(refusal) = request.and_then(|request| self.carry_out(request, status, link)) {
                self.out.line(format_args!("error: {refusal}"));
            }
            if !self.in_flight {
                self.out.line(format_args!("OK"));
            }
        }
        while self.early > 0 && self.pending.is_none() && !self.in_flight && self.out.room() >= MOST_ANSWER {
            self.early -= 1;
            self.out.line(format_args!("error: {}", Refusal::Early));
            self.out.line(format_args!("OK"));
        }
    }

    fn take(&mut self, report: Report) {
        // This side neither jogs nor changes settings on the way.
        if matches!(report, Report::Jogged { .. } | Report::Set { .. }) {
            return;
        }
        if report != Report::Done {
            (self.pen_down, self.laser_on) = (false, false);
        }
        let refusal = match report {
            Report::Done | Report::Jogged { .. } | Report::Set { .. } => None,
            Report::Homed { at, result } => {
                self.stand_at(at);
                result.err().map(Refusal::Homing)
            }
            #[cfg(feature = "third-motor")]
            Report::NotHomedZ { at, error } => {
                self.stand_at(at);
                Some(Refusal::HomingZ(error))
            }
            #[cfg(feature = "third-motor")]
            Report::NotSquared { at, error } => {
                self.stand_at(at);
                Some(Refusal::Squaring(error))
            }
            Report::Stopped { at, why } => {
                self.stand_at(at);
                self.stopped = true;
                Some(Refusal::Stopped(why))
            }
        };
        if core::mem::take(&mut self.in_flight) {
            if let Some(refusal) = refusal {
                self.out.line(format_args!("error: {refusal}"));
            }
            self.out.line(format_args!("OK"));
        }
    }

    fn stand_at(&mut self, at: Point) {
        #[expect(clippy::cast_possible_truncation, reason = "the precision of the original")]
        let at = (at.x as f32, at.y as f32);
        self.at = at;
    }

    fn carry_out(&mut self, request: Request, status: &Status, link: &mut Link) -> Result<(), Refusal> {
        match request {
            Request::Nothing => Ok(()),
            Request::Relative(relative) => {
                self.relative = relative;
                Ok(())
            }
            Request::Settings => {
                self.tell_settings();
                Ok(())
            }
            Request::EndStops => {
                let open = |pressed: bool| u8::from(!pressed);
                let limits = status.limits;
                let (y, x) = ((limits.y_max, limits.y_min), (limits.x_max, limits.x_min));
                self.out.line(format_args!("M11 {} {} {} {}", open(y.0), open(y.1), open(x.0), open(x.1)));
                Ok(())
            }
            Request::Position => {
                self.out.line(format_args!("POS X{} Y{}", TwoDecimals(self.at.0), TwoDecimals(self.at.1)));
                Ok(())
            }
            Request::Delay(delay_us) => {
                let delay_us = delay_us.ok_or(Refusal::NoNumber { command: "M3" })?;
                self.delay_us = in_range("M3", delay_us, 0, MOST_DELAY_US)?;
                Ok(())
            }
            Request::PenAngles { up, down } => {
                let up_deg = byte("U", up, self.stored.pen_up_deg, 180)?;
                let down_deg = byte("D", down, self.stored.pen_down_deg, 180)?;
                (self.stored.pen_up_deg, self.stored.pen_down_deg) = (up_deg, down_deg);
                send(link, Command::PenAngles { up_deg, down_deg });
                Ok(())
            }
            Request::Setup { a, b, height, width, speed } => {
                self.stored = StoredSettings {
                    x_direction: byte("A", a, self.stored.x_direction, 1)?,
                    y_direction: byte("B", b, self.stored.y_direction, 1)?,
                    height_mm: side("H", height, self.stored.height_mm)?,
                    width_mm: side("W", width, self.stored.width_mm)?,
                    speed_percent: byte("S", speed, self.stored.speed_percent, 99)?,
                    ..self.stored
                };
                Ok(())
            }
            // From here on something moves.
            _ if status.emergency_stop => Err(Refusal::Stopped(Stop::Emergency)),
            Request::Servo(deg) => {
                let deg = deg.ok_or(Refusal::NoNumber { command: "M1" })?;
                let deg = byte("M1", Some(deg), 0, 180)?;
                let StoredSettings { pen_up_deg, pen_down_deg, .. } = self.stored;
                self.pen_down = deg.abs_diff(pen_down_deg) < deg.abs_diff(pen_up_deg);
                self.command(link, Command::Servo(deg));
                Ok(())
            }
            Request::Laser(power) => {
                let power = power.ok_or(Refusal::NoNumber { command: "M4" })?;
                let power = in_range("M4", power, 0, 255)?;
                self.laser_on = power > 0;
                self.command(link, Command::Plot(PlotOp::LaserPower { share: f64::from(power) / 255.0 }));
                Ok(())
            }
            Request::Home => {
                self.delay_us = 0;
                self.command(link, Command::Plot(PlotOp::LaserPower { share: 0.0 }));
                send(link, Command::Home);
                self.in_flight = true;
                Ok(())
            }
            Request::Move { x, y, delay_us } => {
                let there = |word: Option<Option<f32>>, here: f32, command| match word {
                    None => Ok(here),
                    Some(number) => {
                        let number = number.ok_or(Refusal::NoNumber { command })?;
                        Ok(if self.relative { here + number } else { number })
                    }
                };
                let (x, y) = (there(x, self.at.0, "X")?, there(y, self.at.1, "Y")?);
                let delay_us = in_range("A", delay_us.unwrap_or(self.delay_us), 0, MOST_DELAY_US)?;
                self.travel(x, y, delay_us, link)
            }
        }
    }

    fn travel(&mut self, x: f32, y: f32, delay_us: i32, link: &mut Link) -> Result<(), Refusal> {
        let StoredSettings { width_mm, height_mm, .. } = self.settings.stored;
        let inside = |here: f32, place: f32, most_mm: u16| {
            // Where the pen is already it may stay.
            place == here || (0.0..=f32::from(most_mm)).contains(&place)
        };
        if !inside(self.at.0, x, width_mm) || !inside(self.at.1, y, height_mm) {
            return Err(Refusal::Area { x, y, width_mm, height_mm });
        }
        self.delay_us = delay_us;
        let (dx, dy) = (x - self.at.0, y - self.at.1);
        let distance_mm = libm::sqrtf(dx * dx + dy * dy);
        self.out.line(format_args!("distance={}", TwoDecimals(distance_mm)));
        if distance_mm < LEAST_MM {
            return Ok(());
        }
        let to = Point::new(f64::from(x), f64::from(y));
        let feed_mm_s = Some(self.feed_mm_s(dx, dy, distance_mm));
        // Whether it marks is a matter of the servo, or of the laser's power.
        self.command(link, Command::Plot(PlotOp::Draw { to, feed_mm_s }));
        send(link, Command::Finish);
        self.at = (x, y);
        self.in_flight = true;
        Ok(())
    }

    /// Speed with the extra delay of each step: 1/v = 1/v0 + delay * steps of the longer way to the mm.
    fn feed_mm_s(&self, dx: f32, dy: f32, distance_mm: f32) -> f64 {
        let x_steps = f64::from(dx.abs()) * self.settings.x_steps_per_mm;
        let y_steps = f64::from(dy.abs()) * self.settings.y_steps_per_mm;
        let steps_per_mm = x_steps.max(y_steps) / f64::from(distance_mm);
        let (draw_mm_s, travel_mm_s) = self.settings.speeds_mm_s();
        let marks = if self.settings.laser { self.laser_on } else { self.pen_down };
        let full_mm_s = if marks { draw_mm_s } else { travel_mm_s };
        1.0 / (1.0 / full_mm_s + f64::from(self.delay_us) * 1e-6 * steps_per_mm)
    }

    fn tell_settings(&mut self) {
        let StoredSettings { width_mm, height_mm, x_direction, y_direction, .. } = self.stored;
        let StoredSettings { speed_percent, pen_up_deg, pen_down_deg, .. } = self.stored;
        let (x, y) = (TwoDecimals(self.at.0), TwoDecimals(self.at.1));
        self.out.line(format_args!(
            "M10 XY {width_mm} {height_mm} {x} {y} A{x_direction} B{y_direction} H0 S{speed_percent} U{pen_up_deg} \
             D{pen_down_deg}"
        ));
    }

    /// Sends a command that may come after a stop.
    fn command(&mut self, link: &mut Link, command: Command) {
        if core::mem::take(&mut self.stopped) {
            send(link, Command::GoOn);
        }
        send(link, command);
    }
}

fn send(link: &mut Link, command: Command) {
    let sent = link.commands.push(command);
    debug_assert!(sent.is_ok(), "room was looked at before");
}

fn in_range(command: &'static str, value: i32, least: i32, most: i32) -> Result<i32, Refusal> {
    if (least..=most).contains(&value) { Ok(value) } else { Err(Refusal::Range { command, least, most }) }
}

/// A small number; the one before where none is told.
fn byte(command: &'static str, value: Option<i32>, before: u8, most: u8) -> Result<u8, Refusal> {
    let Some(value) = value else { return Ok(before) };
    let value = in_range(command, value, 0, most.into())?;
    Ok(u8::try_from(value).unwrap_or(before))
}

fn side(command: &'static str, value: Option<i32>, before: u16) -> Result<u16, Refusal> {
    let Some(value) = value else { return Ok(before) };
    let value = in_range(command, value, 1, MOST_SIDE_MM)?;
    Ok(u16::try_from(value).unwrap_or(before))
}

/// A number as the original's library prints it: half a hundredth is added, and the rest is cut off, in
/// single precision.
struct TwoDecimals(f32);

impl fmt::Display for TwoDecimals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 < 0.0 {
            f.write_str("-")?;
        }
        let number = self.0.abs() + 0.005;
        let whole = libm::floorf(number);
        let tenths = (number - whole) * 10.0;
        let hundredths = (tenths - libm::floorf(tenths)) * 10.0;
        write!(f, "{whole:.0}.{:.0}{:.0}", libm::floorf(tenths), libm::floorf(hundredths))
    }
}
