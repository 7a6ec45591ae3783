//! [`Explored`]: where lines leave what was seen, and was gone to once to see how they go on.

use crate::stroke::PxPoint;

/// A place as near to one that was gone to is the same, and one that is reached, px.
const SAME_PX: f64 = 20.0;

/// Most moves towards such places without reaching one.
const MOST_MOVES: u32 = 14;

/// Most places.
const MOST_PLACES: usize = 1000;

/// The places that were gone to, each once, so that this ends.
#[derive(Clone, Debug, Default)]
pub(super) struct Explored {
    places: Vec<PxPoint>,
    /// Moves since one was reached, or given up.
    moves: u32,
}

impl Explored {
    /// Whether a place is to be gone to, from where the camera is.
    pub(super) fn goes(&mut self, from: PxPoint, to: PxPoint) -> bool {
        if self.places.len() >= MOST_PLACES || self.places.iter().any(|known| known.distance(to) < SAME_PX) {
            return false;
        }
        self.moves += 1;
        if from.distance(to) < SAME_PX || self.moves > MOST_MOVES {
            self.give_up(to);
        }
        true
    }

    /// A place is not gone to again.
    pub(super) fn give_up(&mut self, to: PxPoint) {
        self.moves = 0;
        if self.places.len() < MOST_PLACES {
            self.places.push(to);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_gone_to_once() {
        let mut explored = Explored::default();
        let to = PxPoint::new(100.0, 0.0);
        assert!(explored.goes(PxPoint::new(0.0, 0.0), to) && explored.goes(PxPoint::new(85.0, 0.0), to));
        assert!(!explored.goes(PxPoint::new(99.0, 0.0), PxPoint::new(110.0, 0.0)));
    }

    #[test]
    fn a_place_that_is_not_reached_is_given_up() {
        let (mut explored, from) = (Explored::default(), PxPoint::new(0.0, 0.0));
        let places = [PxPoint::new(100.0, 0.0), PxPoint::new(-100.0, 0.0)];
        let moves = (0..100).filter(|i| explored.goes(from, places[i % 2])).count();
        // Some moves to the first that is given up, then as many again to the other one.
        assert!(moves < 50, "{moves}");
    }
}
