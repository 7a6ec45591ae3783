//! What a person asks of the host of an EBB.

use super::super::{NotNow, Request};
use super::{EbbHost, Phase, Purpose, Then};
use crate::kinematics::Kinematics;
use crate::protocol::ebb::EbbCommand;
use crate::{Pen, PlotOp, Point, StepPoint};

impl<K: Kinematics + Clone, I: Iterator<Item = PlotOp>> EbbHost<K, I> {
    pub(super) fn pause(&mut self) {
        self.planner.hold();
        self.phase = Phase::Ending(Then::Pause);
    }

    /// A straight move by hand at constant speed.
    pub(super) fn move_by_hand(&mut self, to: Point, speed_mm_s: f64) -> Result<(), NotNow> {
        if !(to.x.abs() <= 1e4 && to.y.abs() <= 1e4) {
            return Err(NotNow::OutOfRange);
        }
        if self.line.is_some() || self.goes_to.is_some() {
            return Err(NotNow::Busy);
        }
        let from = self.by_hand;
        let to_steps = self.motion.kinematics().steps_at(to);
        let way = [to_steps.x.saturating_sub(from.x), to_steps.y.saturating_sub(from.y)];
        let ms = libm::ceil(1e3 * self.point(from).distance(to) / speed_mm_s.clamp(0.1, 1e3));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast saturates")]
        let duration_ms = (ms as u32).clamp(10, 1_000_000);
        self.send_command(Purpose::ByHand, EbbCommand::Constant { duration_ms, steps: way });
        self.by_hand = to_steps;
        Ok(())
    }

    /// Speed by hand: the motors start and stop at once.
    pub(super) fn hand_mm_s(&self) -> f64 {
        (0.1 * self.settings.planner.travel_speed_mm_s).min(20.0)
    }

    pub(super) fn go_on(&mut self, left: Option<u32>) -> Result<(), NotNow> {
        match self.phase {
            Phase::Ready | Phase::PenWanted(_) | Phase::SheetWanted => {}
            Phase::Paused => {
                if let Some((pen, at)) = self.held {
                    if self.by_hand != at {
                        let (place, speed) = (self.point(at), self.hand_mm_s());
                        self.move_by_hand(place, speed)?;
                    }
                    if pen == Pen::Down {
                        let lower = EbbCommand::Pen { pen, duration_ms: self.settle_ms() };
                        self.next = Some((lower, at));
                    }
                    self.held = None;
                }
                self.planner.resume();
            }
            Phase::Unheard(_) => return Err(NotNow::Unheard),
            Phase::Stopped | Phase::Asking => return Err(NotNow::Locked),
            Phase::Drawing(_) | Phase::Ending(_) | Phase::Lifted(_) => return Err(NotNow::Draws),
            Phase::Done => return Err(NotNow::Nothing),
        }
        self.phase = Phase::Drawing(left);
        Ok(())
    }

    pub(super) fn is_free(&self) -> Result<(), NotNow> {
        match self.phase {
            Phase::Ready | Phase::Paused | Phase::PenWanted(_) | Phase::SheetWanted | Phase::Done => Ok(()),
            Phase::Unheard(_) => Err(NotNow::Unheard),
            Phase::Stopped | Phase::Asking => Err(NotNow::Locked),
            Phase::Drawing(_) | Phase::Ending(_) | Phase::Lifted(_) => Err(NotNow::Draws),
        }
    }

    /// Does what a person asks.
    pub(super) fn asked_for(&mut self, request: Request) -> Result<(), NotNow> {
        match request {
            Request::GoOn => self.go_on(None),
            Request::Next => self.go_on(Some(1)),
            Request::Pause => match self.phase {
                Phase::Drawing(_) => {
                    self.pause();
                    Ok(())
                }
                Phase::Ending(_) | Phase::Lifted(_) => Ok(()),
                _ => Err(NotNow::Nothing),
            },
            Request::Stop => {
                (self.line, self.next, self.goes_to) = (None, None, None);
                if !matches!(self.phase, Phase::Unheard(_)) {
                    self.phase = Phase::Stopped;
                }
                Ok(())
            }
            Request::Unlock => match self.phase {
                Phase::Stopped => {
                    self.phase = Phase::Asking;
                    Ok(())
                }
                _ => Err(NotNow::Nothing),
            },
            Request::ByHand(op) => {
                self.is_free()?;
                let speed = self.hand_mm_s();
                match op {
                    PlotOp::Travel { to } if self.pen == Pen::Up => self.move_by_hand(to, speed),
                    PlotOp::Draw { to, .. } if self.pen == Pen::Down => self.move_by_hand(to, speed),
                    PlotOp::Travel { to } | PlotOp::Draw { to, .. } => {
                        if !(to.x.abs() <= 1e4 && to.y.abs() <= 1e4) {
                            return Err(NotNow::OutOfRange);
                        }
                        if self.line.is_some() || self.goes_to.is_some() {
                            return Err(NotNow::Busy);
                        }
                        self.goes_to = (self.motion.kinematics().steps_at(to) != self.by_hand).then_some(to);
                        let pen = if self.pen == Pen::Up { Pen::Down } else { Pen::Up };
                        let command = EbbCommand::Pen { pen, duration_ms: self.settle_ms() };
                        self.send_command(Purpose::ByHand, command);
                        Ok(())
                    }
                    _ => Err(NotNow::NoWord),
                }
            }
            Request::Jog { by, feed_mm_s } => {
                self.is_free()?;
                if !(by.length() <= 1e4 && feed_mm_s > 0.0) {
                    return Err(NotNow::OutOfRange);
                }
                let to = self.point(self.by_hand) + by;
                self.move_by_hand(to, feed_mm_s.min(2.0 * self.hand_mm_s()))
            }
            Request::StandsAt(place) => {
                self.is_free()?;
                if !(place.x.abs() <= 1e4 && place.y.abs() <= 1e4) {
                    return Err(NotNow::OutOfRange);
                }
                let at = self.motion.kinematics().steps_at(place);
                let board =
                    [self.by_hand.x.wrapping_add(self.zero.x), self.by_hand.y.wrapping_add(self.zero.y)];
                let [x, y] = board;
                self.zero = StepPoint::new(x.wrapping_sub(at.x), y.wrapping_sub(at.y));
                match &mut self.held {
                    // Where the pen was lifted, it is now said to be elsewhere: it is put back there.
                    Some(_) => self.by_hand = at,
                    None => self.restart_at(at),
                }
                Ok(())
            }
            Request::Feed { percent } => {
                let percent = percent.clamp(10, 200);
                self.planner.override_speeds(f64::from(percent) / 100.0, 1.0);
                self.feed_percent = percent;
                Ok(())
            }
            Request::PenDownAt(position) => {
                self.is_free()?;
                if self.line.is_some() || self.goes_to.is_some() {
                    return Err(NotNow::Busy);
                }
                let [_, down] = &mut self.settings.servo;
                *down = position;
                self.send(Purpose::ByHand, format_args!("SC,5,{position}"));
                Ok(())
            }
            Request::Home | Request::EndJog => Err(NotNow::NoWord),
        }
    }
}
