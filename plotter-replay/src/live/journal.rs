//! [`Journal`]: what happens on a session's line, on the screen and in the recording.

use super::State;
use super::line::lock;
use super::machine_log::Recording;
use super::session::Shared;
use super::view::View;
use crate::log::{Event, Record};
use core::time::Duration;
use std::io::Write;
use std::time::Instant;

/// How often the response is sampled, by the clock.
const SAMPLE_EVERY: Duration = Duration::from_millis(20);

/// Keeps what happens, at the time of the line.
pub(super) struct Journal<'a, W: Write> {
    recorder: Option<Recording<W>>,
    began: Instant,
    /// When a sample was due last.
    sampled: Option<Instant>,
    last: Duration,
    shared: &'a Shared,
}

impl<'a, W: Write> Journal<'a, W> {
    pub(super) fn new(recorder: Option<Recording<W>>, shared: &'a Shared) -> Self {
        Self { recorder, began: Instant::now(), sampled: None, last: Duration::ZERO, shared }
    }

    pub(super) fn now(&self) -> Duration {
        self.shared.line.now().unwrap_or_else(|| self.began.elapsed())
    }

    /// Something happened.
    pub(super) fn take(&mut self, event: Event) {
        self.last = self.now().max(self.last);
        let record = Record { time: self.last, event };
        let mut view = lock(&self.shared.view);
        view.push(&record);
        if let Some(recorder) = &mut self.recorder
            && let Err(error) = recorder.write(&record)
        {
            // The drawing goes on; what was written stays.
            view.recording = format!("stopped: {error}");
            view.message(record.time, format!("recording stopped, drawing goes on: {error}"));
            self.recorder = None;
        }
    }

    /// Whether another sample is due.
    pub(super) fn is_due(&mut self) -> bool {
        let clock = Instant::now();
        let is_due = self.sampled.is_none_or(|last| clock.saturating_duration_since(last) >= SAMPLE_EVERY);
        if is_due {
            self.sampled = Some(clock);
        }
        is_due
    }

    /// Takes a sample, behind what else changes on the screen, and writes the recording through.
    pub(super) fn sample(&mut self, change: impl FnOnce(&mut View)) {
        let now = self.now();
        let mut view = lock(&self.shared.view);
        change(&mut view);
        view.sample(now);
        if let Some(recorder) = &mut self.recorder
            && let Err(error) = recorder.tick(now)
        {
            view.recording = format!("stopped: {error}");
            self.recorder = None;
        }
    }

    /// The session is over.
    pub(super) fn end(mut self, end: State, change: impl FnOnce(&mut View)) {
        if let State::Failed(why) = &end {
            self.take(Event::Note(format!("the session failed: {why}")));
        }
        let now = self.now();
        let kept = self.recorder.take().map(|recorder| recorder.finish());
        let mut view = lock(&self.shared.view);
        match kept {
            Some(Err(error)) => view.recording = format!("stopped: {error}"),
            Some(Ok(())) => view.recording = String::from("complete"),
            None => {}
        }
        change(&mut view);
        view.sample(now);
        view.state = end;
        self.shared.finished.notify_all();
    }
}
