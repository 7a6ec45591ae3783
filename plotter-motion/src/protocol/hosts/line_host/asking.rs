//! What a person asks of a host.

use super::super::language::{Language, OpText};
use super::super::line_queue::Purpose;
use super::super::{NotNow, Request};
use super::{LineHost, Phase, ROOM_FOR_OP, Then};
use crate::{Pen, PlotOp};

impl<L: Language, I: Iterator<Item = PlotOp>> LineHost<L, I> {
    pub(super) fn go_on(&mut self, left: Option<u32>) -> Result<(), NotNow> {
        match self.phase {
            Phase::Unheard => return Err(NotNow::Unheard),
            Phase::Drawing(Some(_)) => {}
            Phase::Drawing(None) | Phase::Done | Phase::Homing(_) => return Err(NotNow::Nothing),
            Phase::Braking | Phase::Forgetting | Phase::Ending(..) => return Err(NotNow::Busy),
            Phase::Stopped | Phase::Locked(_) => return Err(NotNow::Locked),
            Phase::Ready | Phase::Paused | Phase::PenWanted(_) | Phase::SheetWanted => {
                if !self.knows_place {
                    return Err(NotNow::PlaceLost);
                }
                if self.is_interrupted {
                    return Err(NotNow::Busy);
                }
                self.has_room()?;
                self.language.begin();
                self.language.holds(self.trail.sent_holds());
                if self.index > 0 {
                    // The pen goes back to where it was lifted.
                    let mut text = OpText::default();
                    let to = self.trail.sent_end();
                    let written = self.language.write(PlotOp::Travel { to }, &mut text).is_ok();
                    if !(written && self.push(&text, Purpose::ByHand)) {
                        return Err(NotNow::Busy);
                    }
                }
            }
        }
        self.phase = Phase::Drawing(left);
        Ok(())
    }

    /// What is asked by hand may be done.
    pub(super) fn is_free(&self) -> Result<(), NotNow> {
        match self.phase {
            Phase::Unheard => Err(NotNow::Unheard),
            Phase::Stopped | Phase::Locked(_) => Err(NotNow::Locked),
            Phase::Drawing(_) | Phase::Braking | Phase::Forgetting | Phase::Ending(..) | Phase::Homing(_) => {
                Err(NotNow::Draws)
            }
            Phase::Ready | Phase::Paused | Phase::PenWanted(_) | Phase::SheetWanted | Phase::Done => Ok(()),
        }
    }

    /// Whether all lines that one thing takes have room. A language takes what it has written for sent, so that
    /// nothing is written that has none.
    pub(super) const fn has_room(&self) -> Result<(), NotNow> {
        if self.queue.room() < ROOM_FOR_OP { Err(NotNow::Busy) } else { Ok(()) }
    }

    /// Text that a person has asked for, if there is a word for it.
    pub(super) fn by_hand(&mut self, text: &OpText, has_word: bool, purpose: Purpose) -> Result<(), NotNow> {
        match (has_word, self.push(text, purpose)) {
            (true, true) => Ok(()),
            (true, false) => Err(NotNow::Busy),
            (false, _) => Err(NotNow::NoWord),
        }
    }

    /// Unlocked, or found again: a pen that is still down is lifted.
    pub(super) fn wait(&mut self) {
        if self.index > 0 {
            self.end(Then::Pause);
        } else {
            self.phase = Phase::Ready;
        }
    }

    pub(super) const fn waiting(was_paused: bool) -> Phase {
        if was_paused { Phase::Paused } else { Phase::Ready }
    }

    /// Does what a person asks.
    pub(super) fn asked_for(&mut self, request: Request) -> Result<(), NotNow> {
        let mut text = OpText::default();
        match request {
            Request::GoOn => self.go_on(None),
            Request::Next => self.go_on(Some(1)),
            Request::Pause => match (self.phase, L::HOLD) {
                (Phase::Drawing(_) | Phase::Ending(_, false), Some((hold, _)))
                    if self.trail.under_way() > 0 =>
                {
                    self.interrupt_ending();
                    self.urgent(hold);
                    self.urgent(L::QUERY.unwrap_or(hold));
                    self.phase = Phase::Braking;
                    Ok(())
                }
                (Phase::Drawing(_) | Phase::Ending(_, false), None) => {
                    self.interrupt_ending();
                    self.hold_back();
                    self.end(Then::Pause);
                    Ok(())
                }
                (Phase::Drawing(_), _) => {
                    self.phase = Phase::Drawing(Some(0));
                    Ok(())
                }
                (Phase::Ending(..) | Phase::Braking | Phase::Forgetting, _) => Ok(()),
                _ => Err(NotNow::Nothing),
            },
            Request::Stop => {
                self.urgent.clear();
                if L::STOP.is_empty() {
                    // What is on its way is drawn to its end, and answered then.
                    self.interrupt_ending();
                    self.hold_back();
                } else {
                    self.forget();
                }
                self.phase = if self.phase == Phase::Unheard { Phase::Unheard } else { Phase::Stopped };
                Ok(())
            }
            Request::Unlock => match self.phase {
                Phase::Locked(_) | Phase::Stopped => {
                    self.has_room()?;
                    let has_word = self.language.unlock(&mut text);
                    if has_word {
                        self.by_hand(&text, true, Purpose::Unlocking)
                    } else {
                        self.wait();
                        Ok(())
                    }
                }
                _ => Err(NotNow::Nothing),
            },
            Request::Home => {
                let was_paused = match self.phase {
                    Phase::Locked(_) | Phase::Stopped => self.index > 0,
                    Phase::Ready => false,
                    _ => {
                        self.is_free()?;
                        self.index > 0
                    }
                };
                self.has_room()?;
                let has_word = self.language.home(&mut text);
                self.by_hand(&text, has_word, Purpose::Homing)?;
                self.phase = Phase::Homing(was_paused);
                Ok(())
            }
            Request::ByHand(op) => {
                self.is_free()?;
                self.has_room()?;
                self.language.write(op, &mut text).map_err(|_| NotNow::OutOfRange)?;
                self.by_hand(&text, true, Purpose::ByHand)?;
                self.led = Some(0);
                self.pen = match op {
                    PlotOp::Draw { .. } | PlotOp::DrawArc { .. } => Pen::Down,
                    PlotOp::Travel { .. } => Pen::Up,
                    _ => self.pen,
                };
                Ok(())
            }
            Request::Jog { by, feed_mm_s } => {
                self.is_free()?;
                if !(by.length() <= 1e6 && feed_mm_s > 0.0 && feed_mm_s <= 1e6) {
                    return Err(NotNow::OutOfRange);
                }
                self.has_room()?;
                self.ends_jog = false;
                let has_word = self.language.jog(self.at.unwrap_or_default(), by, feed_mm_s, &mut text);
                self.by_hand(&text, has_word, Purpose::Jog)?;
                self.led = Some(0);
                Ok(())
            }
            Request::EndJog => {
                self.is_free()?;
                self.queue.drop_jogs();
                self.urgent(L::END_JOG.ok_or(NotNow::NoWord)?);
                self.ends_jog = self.jogs;
                Ok(())
            }
            Request::StandsAt(place) => {
                self.is_free()?;
                if !(place.x.abs() <= 1e6 && place.y.abs() <= 1e6) {
                    return Err(NotNow::OutOfRange);
                }
                self.has_room()?;
                let has_word = self.language.stands_at(place, &mut text);
                self.by_hand(&text, has_word, Purpose::ByHand)?;
                self.knows_place = true;
                Ok(())
            }
            Request::Feed { percent } => {
                let percent = percent.clamp(10, 200);
                let made = self.language.feed(self.feed_percent, percent, &mut text).ok_or(NotNow::NoWord)?;
                text.as_bytes().iter().for_each(|&byte| self.urgent(byte));
                self.feed_percent = made;
                Ok(())
            }
            Request::PenDownAt(number) => {
                if self.language.pen_down_at(number) {
                    Ok(())
                } else {
                    Err(NotNow::NoWord)
                }
            }
        }
    }
}
