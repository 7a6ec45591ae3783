//! [`Grbl`]: the conversation with a program that streams G-code to Grbl 1.1.

mod block;
mod codes;
#[cfg(feature = "third-motor")]
mod heights;
mod homed;
mod kept;
mod line_buffer;
mod listing;
mod overrides;
mod pens;
mod rx_buffer;
mod status_report;
mod words;

use super::command_queue::COMMANDS_OF_A_LINE as MOST_COMMANDS;
use super::output::Output;
use super::{Activity, Command, Link, Report, Signal, Status, StepperPlotterSettings, Stop, StoredSettings};
use crate::decimal_text::{Plain, Thousandths, Whole};
use crate::gcode::LineInterpreter;
use crate::planner::Keep as _;
use crate::{PlotOp, Point};
use codes::{Alarm, Code};
#[cfg(feature = "third-motor")]
use core::fmt;
use core::marker::PhantomData;
use kept::Kept;
use line_buffer::LineBuffer;
use listing::{About, Listing};
use overrides::Overrides;
pub use pens::{AnyPen, Pens, SpindlePen};
use rx_buffer::RxBuffer;

/// Most bytes that are written at one time: an alarm with its message, and the line's answer. Derived from
/// the longest answers, which the test below writes.
const MOST_ANSWER: usize = 208;
/// Room for bytes that wait to be sent: the longest answer and the end of the one before.
const OUTPUT: usize = 224;
/// So many reports come without the offset, or without the overrides, before one tells them again. Grbl does
/// so every 10 to 30 reports, depending on whether it moves.
const REPORTS_WITHOUT_OFFSET: u8 = 10;

/// What the line in hand waits for before it is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wait {
    /// `$H`.
    Home,
    /// `G4`: until all before it and the pause are over; `M0`: until a person goes on.
    Finish,
    /// `M2`, `M30`: until all before them is over.
    End,
    /// `$n=value`.
    Set,
    /// `$RST=$`, `$RST=*`.
    Restore,
}

/// What is done with lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// Lines are carried out.
    Work,
    /// `$C`: lines are answered as if they were carried out, and nothing moves.
    Check,
    /// `$SLP`: lines wait for a reset, which drops them.
    Sleep,
}

/// The receive side for programs that stream to Grbl. Each line is answered by one `ok` or `error`, in their
/// order.
#[derive(Clone, Debug, PartialEq)]
pub struct Grbl<P: Pens = AnyPen> {
    pens: PhantomData<P>,
    settings: StepperPlotterSettings,
    rx: RxBuffer,
    line: LineBuffer,
    interpreter: LineInterpreter,
    mode: Mode,
    wait: Option<Wait>,
    listing: Option<(Listing, u8)>,
    alarm: Option<Alarm>,
    /// The motion side waits for word that its stop was received.
    stopped: bool,
    status_wanted: bool,
    reports_to_offset: u8,
    reports_to_overrides: u8,
    overrides: Overrides,
    /// The last command for the motion side is a jog.
    jogs: bool,
    greeting: bool,
    kept: P::Kept<Kept>,
    #[cfg(feature = "third-motor")]
    heights: P::Kept<heights::Heights>,
    out: Output<OUTPUT>,
}

impl<P: Pens> Grbl<P> {
    pub(super) fn new(settings: StepperPlotterSettings) -> Self {
        let mut kept = P::Kept::<Kept>::default();
        if let Some(kept) = kept.get_mut() {
            kept.begin_with(&settings);
        }
        Self::keeping(settings, kept)
    }

    fn keeping(settings: StepperPlotterSettings, kept: P::Kept<Kept>) -> Self {
        Self {
            pens: PhantomData,
            settings,
            rx: RxBuffer::new(),
            line: LineBuffer::new(),
            interpreter: LineInterpreter::new(),
            mode: Mode::Work,
            wait: None,
            listing: None,
            alarm: settings.homing.then_some(Alarm::LOCKED),
            stopped: false,
            status_wanted: false,
            reports_to_offset: 0,
            reports_to_overrides: 0,
            overrides: Overrides::default(),
            jogs: false,
            greeting: true,
            kept,
            #[cfg(feature = "third-motor")]
            heights: P::Kept::default(),
            out: Output::new(),
        }
    }

    pub(super) const fn stored(&self) -> StoredSettings {
        self.settings.stored
    }

    pub(super) fn transmit(&mut self) -> Option<u8> {
        self.out.pop()
    }

    /// The port has been opened anew, at `at`.
    pub(super) fn restart(&mut self, at: Point) {
        let mut kept = core::mem::take(&mut self.kept);
        if let Some(kept) = kept.get_mut() {
            kept.end();
        }
        *self = Self::keeping(self.settings, kept);
        self.interpreter.stand_at(at);
    }

    pub(super) fn receive(&mut self, byte: u8) -> Option<Signal> {
        match byte {
            b'?' => self.status_wanted = true,
            b'!' => return Some(Signal::Hold),
            b'~' => return Some(Signal::Resume),
            0x18 => {
                self.rx.clear();
                self.line.clear();
                (self.wait, self.listing) = (None, None);
                if let Some(kept) = self.kept.get_mut() {
                    kept.end();
                }
                // As in Grbl: a machine that sleeps may have been moved by hand.
                if core::mem::replace(&mut self.mode, Mode::Work) == Mode::Sleep {
                    self.alarm = Some(Alarm::LOCKED);
                }
                (self.overrides, self.reports_to_overrides) = (Overrides::default(), 0);
                return Some(Signal::Reset);
            }
            0x85 => return Some(Signal::JogCancel),
            // Other bytes are for parts that this machine lacks: a door, coolant.
            0x80.. => {
                let signal = self.overrides.take(byte)?;
                self.reports_to_overrides = 0;
                return Some(signal);
            }
            _ => self.rx.push(byte),
        }
        None
    }

    pub(super) fn work(&mut self, status: &Status, link: &mut Link) {
        loop {
            #[cfg(feature = "third-motor")]
            if let Some(heights) = self.heights.get_mut() {
                heights.look(status);
            }
            self.gather();
            if self.out.room() < MOST_ANSWER
                || !(self.tell(status, link) || self.start(link) || self.carry_on(status, link))
            {
                return;
            }
        }
    }

    /// Gathers the line that is coming in.
    ///
    /// As in Grbl, a complete line has left the receive buffer, whatever it waits for. Programs that count
    /// characters rely on that.
    fn gather(&mut self) {
        while self.wait.is_none()
            && self.listing.is_none()
            && !self.line.has_ended()
            && let Some(byte) = self.rx.pop()
        {
            self.line.push(byte);
        }
    }

    /// Writes what is told without being asked. Says whether there was something.
    fn tell(&mut self, status: &Status, link: &mut Link) -> bool {
        if core::mem::take(&mut self.greeting) {
            self.greet();
        } else if let Some(report) = link.reports.pop() {
            if self.kept.get().is_some() {
                self.tell_measured(&report, status);
            }
            self.take(report);
        } else if core::mem::take(&mut self.status_wanted) {
            self.tell_status(status, link);
        } else if let Some((listing, index)) = self.listing {
            let restores = self.restores(status);
            let lines = self.kept.get().map(|kept| &kept.lines);
            let about = About {
                settings: &self.settings,
                interpreter: &self.interpreter,
                #[cfg(feature = "third-motor")]
                heights: heights::told(&self.settings).and(self.heights.get()),
                lines,
                restores,
            };
            if listing.line(index, &about, &mut self.out) {
                self.listing = Some((listing, index.saturating_add(1)));
            } else {
                self.listing = None;
                self.out.line(format_args!("ok"));
            }
        } else {
            return false;
        }
        true
    }

    /// Carries out the complete line and answers it. Says whether there was one, and room for all its
    /// commands. As in Grbl, `$G` needs none: it is answered while the planner is full, too.
    fn carry_on(&mut self, status: &Status, link: &mut Link) -> bool {
        if self.wait.is_some()
            || self.is_starting()
            || self.mode == Mode::Sleep
            || !self.line.has_ended()
            || (link.commands.room() < MOST_COMMANDS && !self.line.is_question())
        {
            return false;
        }
        let line = self.line;
        self.line.clear();
        let done = match line.text() {
            None => Err(Code::OVERFLOW),
            Some(b"") => Ok(()),
            Some([b'$', command @ ..]) => self.system(command, status, link),
            Some(_) if self.alarm.is_some() || self.is_jogging(status, link) => Err(Code::LOCKED),
            Some(text) => self.block(text, link),
        };
        match done {
            Ok(()) if self.wait.is_some() || self.listing.is_some() => {}
            Ok(()) => {
                self.answer(Ok(()));
                if self.mode == Mode::Sleep {
                    self.out.line(format_args!("[MSG:Sleeping]"));
                }
            }
            Err(code) => self.answer(Err(code)),
        }
        true
    }

    fn error(&mut self, Code(number): Code) {
        self.out.line(format_args!("error:{}", Whole(number.into())));
    }

    fn greet(&mut self) {
        self.out.line(format_args!("\r\nGrbl 1.1h ['$' for help]"));
        if self.alarm.is_some() {
            self.out.line(format_args!("[MSG:'$H'|'$X' to unlock]"));
        }
        self.begin_startup(false);
    }

    fn alarm(&mut self, alarm: Alarm) {
        // An alarm ends the check mode, and sleep.
        (self.alarm, self.mode) = (Some(alarm), Mode::Work);
        self.out.line(format_args!("ALARM:{}", Whole(alarm.0.into())));
    }

    fn take(&mut self, report: Report) {
        #[cfg(feature = "third-motor")]
        if let Some(heights) = self.heights.get_mut().filter(|_| report != Report::Done) {
            heights.stand_still();
            if let Report::Stopped { .. } = report {
                heights.reset();
            }
        }
        match report {
            Report::Done => {
                let waited = self.wait.take();
                if waited == Some(Wait::End) {
                    (self.overrides, self.reports_to_overrides, self.reports_to_offset) =
                        (Overrides::default(), 0, 0);
                    self.out.line(format_args!("[MSG:Pgm End]"));
                }
                if waited.is_some() {
                    self.answer(Ok(()));
                }
            }
            Report::Homed { at, result } => {
                self.interpreter.stand_at(at);
                match result {
                    Ok(_) => self.alarm = None,
                    Err(error) => {
                        self.alarm(Alarm::of(error));
                        self.out.line(format_args!("[MSG:{error}]"));
                    }
                }
                match (self.wait.take(), result) {
                    (None, _) => {}
                    (Some(_), Ok(_)) if self.begin_startup(true) => {}
                    (Some(_), Ok(_)) => self.answer(Ok(())),
                    (Some(_), Err(_)) => self.error(Code::LOCKED),
                }
            }
            #[cfg(feature = "third-motor")]
            Report::NotHomedZ { at, error } => {
                self.give_up_homing(at, Alarm::of_z(error), format_args!("{error}"));
            }
            #[cfg(feature = "third-motor")]
            Report::NotSquared { at, error } => {
                self.give_up_homing(at, Alarm::of_squaring(error), format_args!("{error}"));
            }
            Report::Jogged { at } => {
                self.interpreter.stand_at(at);
                self.stopped = true;
                self.jogs = false;
            }
            Report::Set { at } => {
                self.interpreter.stand_at(at);
                match self.wait.take() {
                    Some(Wait::Set) => self.answer(Ok(())),
                    Some(Wait::Restore) => {
                        self.answer(Ok(()));
                        self.begin_anew(at);
                    }
                    _ => {}
                }
            }
            Report::Stopped { at, why } => {
                self.jogs = false;
                self.interpreter.reset();
                self.interpreter.stand_at(at);
                self.reports_to_offset = 0;
                self.stopped = true;
                match why {
                    Stop::Emergency => self.alarm(Alarm::EMERGENCY),
                    Stop::Limit { .. } => self.alarm(Alarm::HARD_LIMIT),
                    #[cfg(feature = "third-motor")]
                    Stop::LimitZ { .. } => self.alarm(Alarm::HARD_LIMIT),
                    Stop::Reset { during: Activity::Home } => self.alarm(Alarm::HOMING_RESET),
                    Stop::Reset { during: Activity::Run | Activity::Hold { stands: false } } => {
                        self.alarm(Alarm::ABORT);
                    }
                    Stop::Reset { .. } => {}
                }
                if let Stop::Reset { .. } = why {
                    self.greet();
                } else {
                    self.out.line(format_args!("[MSG:{why}]"));
                }
                if self.wait.take().is_some() {
                    self.answer(Err(Code::LOCKED));
                }
            }
        }
    }

    #[cfg(feature = "third-motor")]
    fn give_up_homing(&mut self, at: Point, alarm: Alarm, why: fmt::Arguments<'_>) {
        self.interpreter.stand_at(at);
        self.alarm(alarm);
        self.out.line(format_args!("[MSG:{why}]"));
        if self.wait.take().is_some() {
            self.error(Code::LOCKED);
        }
    }

    /// A line that begins with `$`.
    fn system(&mut self, command: &[u8], status: &Status, link: &mut Link) -> Result<(), Code> {
        let stands = matches!(status.activity, Activity::Idle | Activity::Stopped);
        let checks = self.mode == Mode::Check;
        let is_idle = !checks && (self.alarm.is_some() || (stands && link.commands.is_empty()));
        match command {
            b"" => self.out.line(format_args!(
                "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]"
            )),
            b"G" => self.tell_modes(),
            b"$" if checks => self.listing = Some((Listing::Settings, 0)),
            b"C" if checks => {
                // Lines that were read in check mode have not been carried out.
                self.mode = Mode::Work;
                self.begin_anew(status.at);
                self.out.line(format_args!("[MSG:Disabled]"));
            }
            b"C" if !is_idle || self.alarm.is_some() => return Err(Code::NOT_IDLE),
            b"C" => {
                self.mode = Mode::Check;
                self.out.line(format_args!("[MSG:Enabled]"));
            }
            // Without an alarm there is nothing to unlock.
            b"X" if !is_idle => {}
            b"$" | b"#" | b"I" | b"N" | b"H" | b"SLP" | b"RST=#" | b"RST=$" | b"RST=*" if !is_idle => {
                return Err(Code::NOT_IDLE);
            }
            [b'H', ..] if !self.settings.homing => return Err(Code::NO_HOMING),
            b"SLP" => {
                if self.alarm.is_none() {
                    let to = self.interpreter.modes().position;
                    self.command(link, Command::Plot(PlotOp::Travel { to }));
                }
                self.mode = Mode::Sleep;
            }
            b"RST=#" => {
                self.out.line(format_args!("[MSG:Restoring defaults]"));
                self.interpreter.restore_origins();
                #[cfg(feature = "third-motor")]
                if let Some(heights) = self.heights.get_mut() {
                    heights.restore_origins();
                }
                self.begin_anew(status.at);
            }
            b"RST=$" | b"RST=*" if self.restores(status) => {
                self.out.line(format_args!("[MSG:Restoring defaults]"));
                self.restore(command == b"RST=*", link);
            }
            b"$" => self.listing = Some((Listing::Settings, 0)),
            b"#" => self.listing = Some((Listing::Offsets, 0)),
            b"I" => self.listing = Some((Listing::Build, 0)),
            b"N" => self.listing = Some((Listing::Startup, 0)),
            [b'N', b'0'..=b'9', b'=', ..] if !is_idle => return Err(Code::NOT_IDLE),
            [b'N', number @ (b'0' | b'1'), b'=', line @ ..] => {
                return self.keep_line(number - b'0', line, link);
            }
            [b'J', ..] if self.alarm.is_some() || checks => return Err(Code::NOT_IDLE),
            [b'J', b'=', ..] if !is_idle && !self.is_jogging(status, link) => return Err(Code::NOT_IDLE),
            [b'J', b'=', jog @ ..] => return self.jog(jog, link),
            [b'0'..=b'9', ..] if !is_idle => return Err(Code::NOT_IDLE),
            [b'0'..=b'9', ..] => return self.change(command, link),
            b"H" | b"X" if status.emergency_button => {
                self.out.line(format_args!("[MSG:{}]", Stop::Emergency));
                return Err(Code::LOCKED);
            }
            b"H" => {
                send(link, Command::Unlock);
                self.stopped = false;
                send(link, Command::Home);
                self.wait = Some(Wait::Home);
            }
            b"X" => {
                if self.alarm.take().is_some() {
                    self.out.line(format_args!("[MSG:Caution: Unlocked]"));
                }
                send(link, Command::Unlock);
                self.stopped = false;
            }
            [b'$' | b'#' | b'C' | b'G' | b'H' | b'I' | b'J' | b'N' | b'R' | b'S' | b'X', ..] => {
                return Err(Code::BAD_STATEMENT);
            }
            // Otherwise the text would be the number of a setting.
            _ => return Err(Code::BAD_NUMBER),
        }
        Ok(())
    }

    /// As after a reset of a machine at rest.
    fn begin_anew(&mut self, at: Point) {
        self.interpreter.reset();
        self.interpreter.stand_at(at);
        #[cfg(feature = "third-motor")]
        if let Some(heights) = self.heights.get_mut() {
            heights.reset();
            heights.stand_still();
        }
        self.reports_to_offset = 0;
        self.greeting = true;
    }

    /// Whether the machine is moved by hand, or is about to be.
    fn is_jogging(&self, status: &Status, link: &Link) -> bool {
        let waits = self.jogs && !link.commands.is_empty();
        status.activity == Activity::Jog || waits
    }

    /// Sends a command that may come after a stop.
    fn command(&mut self, link: &mut Link, command: Command) {
        self.jogs = command.is_jog();
        if core::mem::take(&mut self.stopped) {
            send(link, Command::GoOn);
        }
        send(link, command);
    }

    fn tell_modes(&mut self) {
        let modes = self.interpreter.modes();
        let feed = modes.feed_mm_s.unwrap_or(0.0) * 60.0 / if modes.inches { 25.4 } else { 1.0 };
        self.out.line(format_args!(
            "[GC:G{} G{} G{} G{} G{} G{} M{} M9 T{} F{} S{}]",
            Whole(modes.motion.into()),
            Whole(54 + u64::from(modes.system)),
            Whole(modes.plane.into()),
            Plain(if modes.inches { "20" } else { "21" }),
            Plain(if modes.relative { "91" } else { "90" }),
            Plain(if modes.inverse_time { "93" } else { "94" }),
            Whole(modes.spindle.into()),
            Whole(modes.tool.into()),
            Thousandths::of(feed).trimmed(),
            Thousandths::of(modes.power).trimmed(),
        ));
    }
}

fn send(link: &mut Link, command: Command) {
    let sent = link.commands.push(command);
    debug_assert!(sent.is_ok(), "room was looked at before");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Direction, homing::HomingError};
    use std::format;

    #[test]
    fn the_longest_answers_find_room() {
        let (axis, end, steps) = (Axis::X, Direction::Minus, u32::MAX);
        let homing = [
            HomingError::Missing { axis, end, steps },
            HomingError::Stuck { axis, end, steps },
            HomingError::Wrong { axis, end },
            HomingError::Both { axis },
            HomingError::Short { axis, steps },
            HomingError::Early { axis, steps },
        ];
        let stops = [Stop::Emergency, Stop::Limit { axis, end }];
        let texts =
            homing.map(|error| format!("{error}")).into_iter().chain(stops.map(|stop| format!("{stop}")));
        for text in texts {
            let answer = format!("ALARM:10\r\n[MSG:{text}]\r\nerror:9\r\n");
            assert!(answer.len() <= MOST_ANSWER, "{} bytes: {answer}", answer.len());
        }
    }
}
