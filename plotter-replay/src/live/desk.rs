//! [`Desk`]: which target a machine gets next, from the drawing and by hand, and which ones are out.

use super::drawing_step::DrawingStep;
use super::line::lock;
use plotter_motion::{Pen, PenMove, StepPoint};
use std::collections::VecDeque;
use std::iter::Peekable;
use std::sync::{Arc, Mutex};

/// Moves by hand that wait: a circle of ten thousand points, and more.
const MOST_BY_HAND: usize = 20_000;

/// Steps of a drawing, in their order.
pub(super) type Steps = Box<dyn Iterator<Item = DrawingStep> + Send>;

/// Moves that lie ready for a host, which takes them as it has room.
#[derive(Clone, Debug, Default)]
pub(super) struct Tray(Arc<Mutex<VecDeque<PenMove>>>);

impl Iterator for Tray {
    type Item = PenMove;

    fn next(&mut self) -> Option<PenMove> {
        lock(&self.0).pop_front()
    }
}

/// What the desk has done when it was asked for more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fed {
    /// What there is to give is given; more comes when something of it is reached.
    Given,
    /// All is reached before a pen that a person puts in.
    Pen(u8),
    /// All is reached before a new sheet.
    Sheet,
    /// The one step that was asked for is reached.
    Paused,
    /// The drawing is over.
    Over,
}

/// A move that the machine is told and has not reached.
#[derive(Clone, Copy, Debug)]
struct Given {
    next: PenMove,
    is_by_hand: bool,
}

pub(super) struct Desk {
    tray: Tray,
    given: VecDeque<Given>,
    drawing: Option<Peekable<Steps>>,
    /// Moves of the drawing that the machine has given back.
    again: VecDeque<PenMove>,
    by_hand: VecDeque<PenMove>,
    /// Moves of what was asked by hand last: done, and all.
    count: (u64, u64),
    /// All moves by hand that were reached, those that lead back among them.
    reached: u64,
    /// Where the drawing's pen is, and whether it was led elsewhere by hand.
    drawn_to: StepPoint,
    is_away: bool,
    /// The origin P1 of the drawing, encoder counts.
    origin: StepPoint,
    /// How the pen is led by hand.
    pen: Pen,
    /// The pen in the holder: the one that draws first is in it already.
    holder: Option<u8>,
    /// Where the last move that was given ends.
    at: StepPoint,
    /// Greatest counts that the machine reaches.
    most: Option<StepPoint>,
    only_next: bool,
    /// Whether the machine is asked for what it has not begun.
    withdraws: bool,
}

impl Desk {
    pub(super) fn new(drawing: Option<Steps>, at: StepPoint, most: Option<StepPoint>) -> Self {
        Self {
            tray: Tray::default(),
            given: VecDeque::new(),
            drawing: drawing.map(Iterator::peekable),
            again: VecDeque::new(),
            by_hand: VecDeque::new(),
            count: (0, 0),
            reached: 0,
            drawn_to: StepPoint::default(),
            is_away: false,
            origin: StepPoint::default(),
            pen: Pen::Up,
            holder: None,
            at,
            most,
            only_next: false,
            withdraws: false,
        }
    }

    /// What a host takes its moves from.
    pub(super) fn tray(&self) -> Tray {
        self.tray.clone()
    }

    pub(super) const fn has_drawing(&self) -> bool {
        self.drawing.is_some()
    }

    /// Whether anything by hand waits or is under way.
    pub(super) fn has_by_hand(&self) -> bool {
        !self.by_hand.is_empty() || self.given.iter().any(|given| given.is_by_hand)
    }

    /// Whether the machine has nothing that it is to reach.
    pub(super) fn is_idle(&self) -> bool {
        self.given.is_empty() && self.by_hand.is_empty()
    }

    /// Moves of what was asked by hand last: done, and all.
    pub(super) const fn count(&self) -> (u64, u64) {
        self.count
    }

    pub(super) const fn origin(&self) -> StepPoint {
        self.origin
    }

    pub(super) const fn pen(&self) -> Pen {
        self.pen
    }

    /// Where the motors stand when all that was given is reached.
    pub(super) fn at(&self) -> StepPoint {
        self.by_hand.back().map_or(self.at, |last| last.target)
    }

    pub(super) const fn lower(&mut self, pen: Pen) {
        self.pen = pen;
    }

    /// Where the motors stand is told from elsewhere.
    pub(super) const fn stands_at(&mut self, at: StepPoint) {
        self.at = at;
    }

    /// The drawing's origin from now on; what of it is out stays where it was.
    pub(super) const fn set_origin(&mut self, origin: StepPoint) {
        self.origin = origin;
        self.is_away = true;
    }

    /// Only the next step of the drawing is wanted.
    pub(super) const fn only_next(&mut self) {
        self.only_next = true;
    }

    /// All of the drawing is wanted.
    pub(super) const fn all(&mut self) {
        self.only_next = false;
    }

    /// Whether the machine reaches a place.
    pub(super) fn reaches(&self, at: StepPoint) -> bool {
        let within = |value: i32, most: i32| (0..=most).contains(&value);
        self.most.is_none_or(|most| within(at.x, most.x) && within(at.y, most.y))
    }

    /// Takes moves by hand, which begin at once; says whether there is room for them.
    pub(super) fn hand(&mut self, moves: Vec<PenMove>) -> bool {
        if self.by_hand.len().saturating_add(moves.len()) > MOST_BY_HAND {
            return false;
        }
        if self.is_idle() {
            self.count = (0, 0);
        }
        self.count.1 = self.count.1.saturating_add(moves.len() as u64);
        self.by_hand.extend(moves);
        self.is_away = true;
        true
    }

    /// What waits by hand is forgotten; what is under way is not.
    pub(super) fn drop_by_hand(&mut self) {
        self.by_hand.clear();
        self.count.1 = self.count.0;
    }

    /// The next move by hand, one at a time: a stop leaves nothing behind it.
    pub(super) fn feed_by_hand(&mut self) {
        if self.given.is_empty()
            && !self.withdraws
            && let Some(next) = self.by_hand.pop_front()
        {
            self.give(next, true);
        }
    }

    /// Gives moves of the drawing until so many are out.
    pub(super) fn feed(&mut self, most_ahead: usize) -> Fed {
        if self.withdraws || self.has_by_hand() {
            return Fed::Given;
        }
        let most_ahead = if self.only_next { 1 } else { most_ahead };
        while self.given.len() < most_ahead {
            let Some(drawing) = &mut self.drawing else { return Fed::Given };
            let step = self.again.front().copied().map(DrawingStep::Move).or_else(|| drawing.peek().copied());
            match step {
                None if self.given.is_empty() => return Fed::Over,
                None => return Fed::Given,
                Some(DrawingStep::Move(next)) => {
                    // Put back where it was, unless the drawing goes elsewhere with the pen lifted.
                    if core::mem::take(&mut self.is_away) && next.pen == Pen::Down {
                        let target = self.shifted(self.drawn_to);
                        self.give(PenMove { pen: Pen::Up, target }, true);
                        return Fed::Given;
                    }
                    if self.again.pop_front().is_none() {
                        drawing.next();
                    }
                    // What draws without a word of a pen draws with one that has no number.
                    if next.pen == Pen::Down {
                        self.holder.get_or_insert(0);
                    }
                    let target = self.shifted(next.target);
                    self.give(PenMove { target, ..next }, false);
                    if self.only_next {
                        return Fed::Given;
                    }
                }
                Some(DrawingStep::Pen(pen)) if self.holder.is_none_or(|holder| holder == pen) => {
                    self.holder = Some(pen);
                    drawing.next();
                }
                Some(DrawingStep::Pen(_) | DrawingStep::Sheet) if !self.given.is_empty() => {
                    return Fed::Given;
                }
                Some(DrawingStep::Pen(pen)) => {
                    self.holder = Some(pen);
                    drawing.next();
                    return Fed::Pen(pen);
                }
                Some(DrawingStep::Sheet) => {
                    drawing.next();
                    return Fed::Sheet;
                }
            }
        }
        Fed::Given
    }

    /// A step of the drawing is left out: another host has drawn it.
    pub(super) fn skip(&mut self) {
        while let Some(step) = self.drawing.as_mut().and_then(Iterator::next) {
            match step {
                DrawingStep::Move(next) => {
                    self.drawn_to = next.target;
                    return;
                }
                DrawingStep::Pen(pen) => self.holder = Some(pen),
                DrawingStep::Sheet => {}
            }
        }
    }

    fn shifted(&self, at: StepPoint) -> StepPoint {
        StepPoint::new(at.x.saturating_add(self.origin.x), at.y.saturating_add(self.origin.y))
    }

    fn give(&mut self, next: PenMove, is_by_hand: bool) {
        self.at = next.target;
        self.given.push_back(Given { next, is_by_hand });
        lock(&self.tray.0).push_back(next);
    }

    /// The oldest move that is out is done with, and whether it was one of the drawing; with the answer to
    /// what only the next step asked for.
    pub(super) fn done(&mut self) -> (bool, Option<Fed>) {
        let Some(Given { next, is_by_hand }) = self.given.pop_front() else { return (true, None) };
        if is_by_hand {
            self.reached = self.reached.saturating_add(1);
            self.count.0 = self.count.0.saturating_add(1).min(self.count.1);
            return (false, None);
        }
        let StepPoint { x, y } = next.target;
        self.drawn_to = StepPoint::new(x.saturating_sub(self.origin.x), y.saturating_sub(self.origin.y));
        (true, core::mem::take(&mut self.only_next).then_some(Fed::Paused))
    }

    /// Moves by hand that were reached.
    pub(super) const fn reached_by_hand(&self) -> u64 {
        self.reached
    }

    /// Whether the move that is under way is one by hand.
    pub(super) fn is_led_by_hand(&self) -> bool {
        self.given.front().is_some_and(|given| given.is_by_hand)
    }

    /// Whether there is anything that the machine may not have begun; it is asked for from now on.
    pub(super) fn withdraw(&mut self) -> bool {
        self.withdraws = !self.given.is_empty();
        self.withdraws
    }

    /// The machine has kept so many moves; the others wait again.
    pub(super) fn withdrawn(&mut self, kept: usize) {
        self.withdraws = false;
        lock(&self.tray.0).clear();
        let back = self.given.split_off(kept.min(self.given.len()));
        for given in back.into_iter().rev().filter(|given| !given.is_by_hand) {
            let StepPoint { x, y } = given.next.target;
            let target = StepPoint::new(x.saturating_sub(self.origin.x), y.saturating_sub(self.origin.y));
            self.again.push_front(PenMove { target, ..given.next });
        }
        if let Some(last) = self.given.back() {
            self.at = last.next.target;
        } else {
            self.at = self.shifted(self.drawn_to);
        }
    }

    /// The machine is led elsewhere than to the move by hand that is under way.
    pub(super) fn redirected(&mut self, to: StepPoint) {
        if let Some(given) = self.given.front_mut() {
            given.next.target = to;
        }
        self.at = to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn down(x: i32) -> PenMove {
        PenMove { pen: Pen::Down, target: StepPoint::new(x, 0) }
    }

    fn desk(steps: Vec<DrawingStep>) -> Desk {
        Desk::new(Some(Box::new(steps.into_iter())), StepPoint::default(), Some(StepPoint::new(1_000, 1_000)))
    }

    #[test]
    fn a_pen_is_asked_for_when_all_before_it_is_reached() {
        let mut desk = desk(vec![
            DrawingStep::Pen(1),
            down(1).into(),
            down(2).into(),
            DrawingStep::Pen(2),
            down(3).into(),
            DrawingStep::Sheet,
            down(4).into(),
        ]);
        assert_eq!(desk.feed(8), Fed::Given);
        assert_eq!(desk.tray().collect::<Vec<_>>(), [down(1), down(2)]);
        desk.done();
        assert_eq!(desk.feed(8), Fed::Given);
        assert_eq!(desk.tray().next(), None);
        desk.done();
        assert_eq!(desk.feed(8), Fed::Pen(2));
        assert_eq!(desk.feed(8), Fed::Given);
        desk.done();
        assert_eq!(desk.feed(8), Fed::Sheet);
        desk.feed(8);
        desk.done();
        assert_eq!(desk.feed(8), Fed::Over);
    }

    #[test]
    fn what_the_machine_has_not_begun_comes_again_behind_what_was_done_by_hand() {
        let mut desk = desk((1..=5).map(|x| down(x).into()).collect());
        desk.feed(4);
        assert_eq!(desk.tray().take(3).count(), 3); // one is still in the tray
        desk.done();
        assert!(desk.withdraw());
        assert_eq!(desk.feed(8), Fed::Given);
        desk.withdrawn(1); // the second is under way
        assert_eq!(desk.tray().next(), None);
        desk.done();
        assert!(desk.hand(vec![PenMove { pen: Pen::Up, target: StepPoint::new(500, 0) }]));
        desk.feed_by_hand();
        assert_eq!(desk.tray().next().unwrap().target.x, 500);
        desk.done();
        desk.feed(8);
        // back to where it was, with the pen lifted, then the rest
        assert_eq!(desk.tray().collect::<Vec<_>>(), [PenMove { pen: Pen::Up, target: StepPoint::new(2, 0) }]);
        desk.done();
        desk.feed(8);
        assert_eq!(desk.tray().collect::<Vec<_>>(), [down(3), down(4), down(5)]);
    }

    #[test]
    fn the_origin_moves_the_drawing_and_what_comes_again() {
        let mut desk = desk(vec![down(1).into(), down(2).into()]);
        desk.set_origin(StepPoint::new(100, 10));
        desk.feed(8);
        // the drawing begins at its origin
        assert_eq!(desk.tray().next(), Some(PenMove { pen: Pen::Up, target: StepPoint::new(100, 10) }));
        desk.done();
        desk.feed(1);
        assert_eq!(desk.tray().next(), Some(PenMove { pen: Pen::Down, target: StepPoint::new(101, 10) }));
        desk.withdraw();
        desk.withdrawn(0);
        desk.feed(1);
        assert_eq!(desk.tray().next(), Some(PenMove { pen: Pen::Down, target: StepPoint::new(101, 10) }));
        assert!(desk.reaches(StepPoint::new(1_000, 0)) && !desk.reaches(StepPoint::new(0, -1)));
    }

    #[test]
    fn only_the_next_step_is_drawn_where_it_is_asked_for() {
        let mut desk = desk((1..=3).map(|x| down(x).into()).collect());
        desk.only_next();
        desk.feed(8);
        assert_eq!(desk.tray().collect::<Vec<_>>(), [down(1)]);
        assert_eq!(desk.done(), (true, Some(Fed::Paused)));
        desk.feed(8);
        assert_eq!(desk.tray().collect::<Vec<_>>(), [down(2), down(3)]);
    }
}
