//! What a whole Grbl keeps and a small one leaves out: start-up lines, and the settings that `$RST` restores.

use super::super::{Command, Link, StartupLines, Status, StepperPlotterSettings};
use super::{Code, Grbl, MOST_COMMANDS, Mode, Pens, Wait, send};
use crate::planner::Keep as _;
use core::fmt::Write as _;

/// The kept settings and start-up lines, and how far these lines have been carried out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Kept {
    pub(super) lines: StartupLines,
    /// What homing has measured last.
    pub(super) homed: Option<crate::homing::Homed>,
    /// The settings that the controller was made with.
    built: StepperPlotterSettings,
    /// The start-up line to carry out next; from [`StartupLines::COUNT`] on there is none.
    next: u8,
    /// The line that has not been answered yet.
    running: Option<u8>,
    /// `$H` is answered after them.
    owes_answer: bool,
}

impl Default for Kept {
    fn default() -> Self {
        Self {
            lines: StartupLines::default(),
            homed: None,
            built: StepperPlotterSettings::default(),
            next: StartupLines::COUNT,
            running: None,
            owes_answer: false,
        }
    }
}

impl Kept {
    pub(super) fn begin_with(&mut self, settings: &StepperPlotterSettings) {
        self.built = *settings;
    }

    /// Forgets how far the start-up lines have been carried out.
    pub(super) fn end(&mut self) {
        (self.next, self.running, self.owes_answer) = (StartupLines::COUNT, None, false);
    }
}

impl<P: Pens> Grbl<P> {
    pub(in super::super) fn startup_lines(&self) -> StartupLines {
        self.kept.get().map(|kept| kept.lines).unwrap_or_default()
    }

    pub(in super::super) fn set_startup_lines(&mut self, lines: &StartupLines) {
        if let Some(kept) = self.kept.get_mut() {
            kept.lines = *lines;
        }
    }

    /// Begins with the first start-up line, unless the machine is locked. Says whether an answer comes after
    /// them.
    pub(super) fn begin_startup(&mut self, owes_answer: bool) -> bool {
        let is_locked = self.alarm.is_some();
        let Some(kept) = self.kept.get_mut().filter(|_| !is_locked) else { return false };
        (kept.next, kept.owes_answer) = (0, owes_answer);
        owes_answer
    }

    /// Carries out the start-up line that is due. Says whether there was one, or an answer that waited for
    /// it.
    pub(super) fn start(&mut self, link: &mut Link) -> bool {
        let is_free = self.wait.is_none() && link.commands.room() >= MOST_COMMANDS;
        let Some(kept) = self.kept.get_mut().filter(|_| is_free) else { return false };
        if kept.next >= StartupLines::COUNT || self.alarm.is_some() {
            kept.next = StartupLines::COUNT;
            let owed = core::mem::take(&mut kept.owes_answer);
            if owed {
                self.out.line(format_args!("ok"));
            }
            return owed;
        }
        let (number, lines) = (kept.next, kept.lines);
        kept.next += 1;
        if !lines.bytes(number).is_empty() {
            kept.running = Some(number);
            let done = self.block(lines.bytes(number), link);
            if done.is_err() || self.wait.is_none() {
                self.answer(done);
            }
        }
        true
    }

    /// Whether start-up lines are to be carried out before the next line of the host.
    pub(super) fn is_starting(&self) -> bool {
        self.kept.get().is_some_and(|kept| kept.next < StartupLines::COUNT || kept.owes_answer)
    }

    /// `$N0=line`: as in Grbl, the line is carried out at once and kept if that succeeds. In an alarm it is
    /// only checked.
    pub(super) fn keep_line(&mut self, number: u8, line: &[u8], link: &mut Link) -> Result<(), Code> {
        if self.kept.get().is_none() {
            return if line.is_empty() { Ok(()) } else { Err(Code::BAD_STATEMENT) };
        }
        if self.alarm.is_some() {
            let before = (self.interpreter, core::mem::replace(&mut self.mode, Mode::Check));
            #[cfg(feature = "third-motor")]
            let heights = self.heights.clone();
            let done = self.block(line, link);
            (self.interpreter, self.mode) = before;
            #[cfg(feature = "third-motor")]
            {
                self.heights = heights;
            }
            done?;
        } else {
            self.block(line, link)?;
        }
        let kept = self.kept.get_mut().and_then(|kept| kept.lines.set(number, line));
        kept.ok_or(Code::OVERFLOW)
    }

    /// Whether both sides can do `$RST=$`.
    pub(super) fn restores(&self, status: &Status) -> bool {
        status.restores && self.kept.get().is_some()
    }

    /// `$RST=$`, and `$RST=*`, which forgets all that has been kept.
    pub(super) fn restore(&mut self, all: bool, link: &mut Link) {
        let Some(kept) = self.kept.get_mut() else { return };
        self.settings = kept.built;
        if all {
            kept.lines = StartupLines::default();
            self.interpreter.restore_origins();
            #[cfg(feature = "third-motor")]
            if let Some(heights) = self.heights.get_mut() {
                heights.restore_origins();
            }
        }
        send(link, Command::Restore);
        self.wait = Some(Wait::Restore);
    }

    /// Answers the line in hand. That is a line of the host, or a start-up line, whose text is told with the
    /// answer.
    pub(super) fn answer(&mut self, done: Result<(), Code>) {
        if let Some(kept) = self.kept.get_mut()
            && let Some(number) = kept.running.take()
        {
            let lines = kept.lines;
            // Writing to this buffer does not fail.
            let _ = write!(self.out, ">{}:", crate::decimal_text::Plain(lines.get(number)));
        }
        match done {
            Ok(()) => self.out.line(format_args!("ok")),
            Err(code) => self.error(code),
        }
    }
}
