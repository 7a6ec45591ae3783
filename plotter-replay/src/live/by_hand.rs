//! What a person does by hand to a machine of targets: its part of the [`Engine`].

use super::engine::Engine;
use super::line::lock;
use super::{Hand, State};
use crate::log::Event;
use core::time::Duration;
use plotter_motion::protocol::hosts::NotNow;
use plotter_motion::{Axis, Pen, PenMove, PlotOp, Point, StepPoint, Vec2};
use std::io::Write;

/// A key that is held is said again so often, and is let go when nobody has said so for this long, in the
/// time of the line: three of the page's words, ten a second.
const HELD_FOR: Duration = Duration::from_millis(300);
/// Moves by hand that may wait while a key is held: what the machine has no time for is not made up.
const MOST_HELD: u64 = 2;

impl<W: Write> Engine<'_, W> {
    /// Does what a person asks by hand.
    pub(super) fn hand(&mut self, hand: Hand) -> Result<(), NotNow> {
        let state = lock(&self.shared.view).state.clone();
        if hand == Hand::EndJog {
            if self.held_until.is_some() {
                self.held_until = Some(Duration::ZERO);
            }
            return Ok(());
        }
        match state {
            State::Ready | State::Watching | State::Paused => {}
            State::Running => return Err(NotNow::Draws),
            _ => return Err(NotNow::Locked),
        }
        if let Hand::Hold(direction) = hand {
            return self.hold(direction);
        }
        if self.held_until.is_some() {
            return Err(NotNow::Busy);
        }
        if self.desk.is_idle() {
            // A motor that was turned by a hand, or that stopped a count beside its target.
            let (at, told) = (self.desk.at(), self.counted());
            let near = i32::try_from(self.settings.host.tolerance_counts.max(1)).unwrap_or(i32::MAX);
            if at.x.abs_diff(told.x).max(at.y.abs_diff(told.y)) > near.unsigned_abs() {
                self.desk.stands_at(told);
            }
        }
        self.allowed_mm = None;
        match hand {
            Hand::Next => {
                if !self.desk.has_drawing() {
                    return Err(NotNow::Nothing);
                }
                self.desk.only_next();
                self.go_on();
                let mut view = lock(&self.shared.view);
                view.wants.clear();
                view.state = State::Running;
                Ok(())
            }
            Hand::Jog(by, _) => {
                if self.waits() >= MOST_HELD {
                    return Ok(());
                }
                let at = self.desk.at();
                let by = self.counts(by);
                self.lead(vec![StepPoint::new(at.x.saturating_add(by.x), at.y.saturating_add(by.y))])
            }
            Hand::Pulse(axis, direction) => {
                let mut at = self.desk.at();
                let place = if axis == Axis::X { &mut at.x } else { &mut at.y };
                *place = place.saturating_add(direction.sign());
                self.lead(vec![at])
            }
            Hand::GoTo(to) => self.draw(vec![PlotOp::Travel { to }]),
            Hand::DrawTo(to, _) => {
                self.draw(vec![PlotOp::Draw { to, feed_mm_s: None }])?;
                self.desk.lower(Pen::Down);
                Ok(())
            }
            Hand::Pen(pen) => {
                self.desk.lower(pen);
                self.take(Event::Pen(pen));
                let at = self.desk.at();
                if self.host.is_linked() { self.lead(vec![at]) } else { Ok(()) }
            }
            Hand::Shape { shape, speed_mm_s, allowed_mm } => {
                self.draw(shape.ops(speed_mm_s))?;
                self.allowed_mm = allowed_mm;
                Ok(())
            }
            Hand::StandsAt(place) => {
                let (at, place) = (self.desk.at(), self.counts(place - Point::ORIGIN));
                let origin = StepPoint::new(at.x.saturating_sub(place.x), at.y.saturating_sub(place.y));
                self.set_origin(origin)
            }
            Hand::Origin(origin) => self.set_origin(origin),
            Hand::Home | Hand::Unlock | Hand::PenDownAt(_) | Hand::Feed(_) | Hand::Hold(_) | Hand::EndJog => {
                Err(NotNow::NoWord)
            }
        }
    }

    /// Where the machine's answers say that its motors are.
    fn counted(&self) -> StepPoint {
        lock(&self.shared.view).plotter.raw_counts()
    }

    /// Moves by hand that are not reached.
    fn waits(&self) -> u64 {
        let (done, all) = self.desk.count();
        if self.desk.has_by_hand() { all.saturating_sub(done) } else { 0 }
    }

    fn counts(&self, by: Vec2) -> StepPoint {
        let plotter = self.settings.plotter;
        plotter.to_counts(plotter.p1 + by)
    }

    /// Leads the machine to these counts, the pen as it is by hand.
    fn lead(&mut self, places: Vec<StepPoint>) -> Result<(), NotNow> {
        let pen = self.desk.pen();
        self.give(places.into_iter().map(|target| PenMove { pen, target }).collect())
    }

    /// Draws these operations by hand, and lifts the pen.
    fn draw(&mut self, ops: Vec<PlotOp>) -> Result<(), NotNow> {
        let origin = self.desk.origin();
        let mut moves = Vec::new();
        for op in ops {
            let Some(to) = op.target() else { continue };
            let at = self.counts(to - Point::ORIGIN);
            let target = StepPoint::new(at.x.saturating_add(origin.x), at.y.saturating_add(origin.y));
            let pen = if matches!(op, PlotOp::Travel { .. }) { Pen::Up } else { Pen::Down };
            moves.push(PenMove { pen, target });
        }
        self.give(moves)?;
        self.desk.lower(Pen::Up);
        Ok(())
    }

    fn give(&mut self, moves: Vec<PenMove>) -> Result<(), NotNow> {
        if !moves.iter().all(|next| self.desk.reaches(next.target)) {
            return Err(NotNow::OutOfRange);
        }
        if !self.desk.hand(moves) {
            return Err(NotNow::Busy);
        }
        self.go_on();
        Ok(())
    }

    /// The drawing's origin P1 is at these counts from now on.
    fn set_origin(&mut self, origin: StepPoint) -> Result<(), NotNow> {
        if !self.desk.is_idle() {
            return Err(NotNow::Busy);
        }
        self.desk.set_origin(origin);
        let settings = self.settings.plotter;
        let moved = settings.to_sheet(origin) - settings.p1;
        let now = self.now();
        let words = format!("P1X {}, P1Y {}: the origin of the drawing", origin.x, origin.y);
        self.take(Event::Note(format!("host: {words}")));
        let mut view = lock(&self.shared.view);
        view.set_origin(settings.p1 - moved);
        view.message(now, words);
        Ok(())
    }

    /// Whether all of the drawing lies where the machine reaches it, from the origin that it has.
    pub(super) fn fits(&self) -> Result<(), String> {
        let Some((low, high)) = self.settings.bounds else { return Ok(()) };
        let origin = self.desk.origin();
        let shifted =
            |at: StepPoint| StepPoint::new(at.x.saturating_add(origin.x), at.y.saturating_add(origin.y));
        if self.desk.reaches(shifted(low)) && self.desk.reaches(shifted(high)) {
            return Ok(());
        }
        Err(String::from(
            "from this origin the drawing leads outside the machine: set another one, P1X 0 and P1Y 0 by default",
        ))
    }

    /// A key is held: one long move that way, on which the machine's own ramp grows.
    fn hold(&mut self, direction: Vec2) -> Result<(), NotNow> {
        if !self.settings.ramps {
            return Err(NotNow::NoWord);
        }
        let until = self.now().saturating_add(HELD_FOR);
        if self.held_until.is_some() {
            if self.held_until != Some(Duration::ZERO) {
                self.held_until = Some(until);
            }
            return Ok(());
        }
        if !self.desk.is_idle() {
            return Ok(()); // it still comes to rest after the last time
        }
        let (at, Some(most)) = (self.counted(), self.settings.most) else { return Err(NotNow::NoWord) };
        let room = |along: f64, at: i32, most: i32| match along {
            a if a > 0.0 => most.saturating_sub(at),
            a if a < 0.0 => at,
            _ => i32::MAX,
        };
        let far = room(direction.x, at.x, most.x).min(room(direction.y, at.y, most.y)).max(0);
        let step = |along: f64| match along {
            a if a > 0.0 => far,
            a if a < 0.0 => -far,
            _ => 0,
        };
        if far == 0 || far == i32::MAX {
            return Err(NotNow::OutOfRange);
        }
        self.lead(vec![StepPoint::new(at.x + step(direction.x), at.y + step(direction.y))])?;
        self.held_until = Some(until);
        Ok(())
    }

    /// Ends a long move when its key is let go, or nobody says any more that it is held.
    pub(super) fn let_go(&mut self, host_now: Duration) {
        let Some(until) = self.held_until else { return };
        if !self.desk.has_by_hand() {
            self.held_until = None; // it has come to its end
        } else if self.now() >= until {
            let (pen, target) = (self.desk.pen(), self.counted());
            if self.host.redirect(host_now, PenMove { pen, target }) {
                self.desk.redirected(target);
                self.held_until = None;
            } else {
                self.held_until = Some(Duration::ZERO);
            }
        }
    }

    /// A move by hand is reached: says so if that is farther from where it was led than was allowed.
    pub(super) fn check_shape(&mut self, target: StepPoint) {
        let Some(allowed_mm) = self.allowed_mm else { return };
        let now = self.now();
        let mut view = lock(&self.shared.view);
        let (at, meant) = (view.plotter.position(), view.plotter.settings().to_sheet(target));
        let off_mm = at.distance(meant);
        if off_mm > allowed_mm {
            view.message(
                now,
                format!(
                    "came to rest {off_mm:.3} mm from ({:.3}, {:.3}) mm: {allowed_mm} mm are allowed",
                    meant.x, meant.y
                ),
            );
        }
    }
}
