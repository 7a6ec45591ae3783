//! What a person asks of the host of an EBB.

use super::super::{NotNow, Request};
use super::{EbbHost, HandWay, Phase, Purpose, Then};
use crate::kinematics::Kinematics;
use crate::protocol::ebb::EbbCommand;
use crate::{Pen, PlotOp, Point, StepPoint};

impl<K: Kinematics + Clone, I: Iterator<Item = PlotOp>> EbbHost<K, I> {
    pub(super) fn pause(&mut self) {
        self.planner.hold();
        self.phase = Phase::Ending(Then::Pause);
    }

    /// A straight move by hand, which goes on with one that is under way in the same direction.
    pub(super) fn move_by_hand(&mut self, to: Point, speed_mm_s: f64) -> Result<(), NotNow> {
        if !(to.x.abs() <= 1e4 && to.y.abs() <= 1e4) {
            return Err(NotNow::OutOfRange);
        }
        let steps = self.motion.kinematics().steps_at(to);
        if let Some(mut way) = self.way {
            let by_mm = self.point(way.to()).distance(to);
            if by_mm > self.longest_ahead(speed_mm_s) || !way.lengthen(steps, by_mm) {
                return Err(NotNow::Busy);
            }
            self.way = Some(way);
            return Ok(());
        }
        if self.line.is_some() || self.goes_to.is_some() {
            return Err(NotNow::Busy);
        }
        let length_mm = self.point(self.by_hand).distance(to);
        let speed_mm_s = speed_mm_s.clamp(0.1, 1e3);
        let accel_mm_s2 = self.settings.planner.accel_mm_s2;
        self.way = Some(HandWay::new(self.by_hand, steps, length_mm, speed_mm_s, accel_mm_s2));
        self.write_by_hand();
        Ok(())
    }

    /// A key that is held asks for a tenth of a second at a time; what is more is a movement of its own.
    fn longest_ahead(&self, speed_mm_s: f64) -> f64 {
        0.5 * speed_mm_s
    }

    /// Speed by hand, for an eye beside the machine.
    pub(super) fn hand_mm_s(&self) -> f64 {
        (0.1 * self.settings.planner.travel_speed_mm_s).min(20.0)
    }

    pub(super) fn go_on(&mut self, left: Option<u32>) -> Result<(), NotNow> {
        if self.way.is_some() && self.is_free().is_ok() {
            return Err(NotNow::Busy);
        }
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
                (self.line, self.next, self.goes_to, self.way) = (None, None, None, None);
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
                if self.way.is_some() {
                    return Err(NotNow::Busy);
                }
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
                let from = self.way.map_or(self.by_hand, |way| way.to());
                let to = self.point(from) + by;
                self.move_by_hand(to, feed_mm_s.min(2.0 * self.hand_mm_s()))
            }
            Request::StandsAt(place) => {
                self.is_free()?;
                if self.way.is_some() || self.goes_to.is_some() {
                    return Err(NotNow::Busy);
                }
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
                if self.line.is_some() || self.goes_to.is_some() || self.way.is_some() {
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
