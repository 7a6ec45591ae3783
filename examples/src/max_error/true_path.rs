//! [`TruePath`]: where a simulated pen truly was while it was down.

use plotter_motion::{Pen, Point};
use plotter_replay::draw::thin;

/// How far the kept places may be from those that were seen, mm.
const TOLERANCE_MM: f64 = 0.001;

/// Places that are held before they are thinned.
const HELD: usize = 4096;

/// Gathers the places of a pen as one path for each stroke, none of which is farther than 1 um from any
/// place.
#[derive(Clone, Debug, Default)]
pub struct TruePath {
    strokes: Vec<Vec<Point>>,
    held: Vec<Point>,
    pen: Option<Pen>,
}

impl TruePath {
    /// How far a path may be from the places, mm.
    pub const TOLERANCE_MM: f64 = TOLERANCE_MM;

    /// From here on the pen is up or down.
    pub fn put(&mut self, pen: Pen) {
        if self.pen.replace(pen) == Some(pen) {
            return;
        }
        self.thin();
        self.held.clear();
        if pen == Pen::Down {
            self.strokes.push(Vec::new());
        }
    }

    /// The pen is at a place.
    pub fn at(&mut self, place: Point) {
        if self.pen != Some(Pen::Down) || self.held.last() == Some(&place) {
            return;
        }
        self.held.push(place);
        if self.held.len() >= HELD {
            self.thin();
        }
    }

    /// Thins what is held into the stroke in progress; its last place begins what comes next.
    fn thin(&mut self) {
        let Some(stroke) = self.strokes.last_mut() else { return };
        let last = self.held.last().copied();
        let kept = thin(self.held.drain(..), TOLERANCE_MM);
        let is_joined = !stroke.is_empty();
        stroke.extend(kept.into_iter().skip(usize::from(is_joined)));
        self.held.extend(last);
    }

    /// The strokes.
    #[must_use]
    pub fn finish(mut self) -> Vec<Vec<Point>> {
        self.thin();
        self.strokes.retain(|stroke| !stroke.is_empty());
        self.strokes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_become_strokes_while_the_pen_is_down() {
        let mut path = TruePath::default();
        path.at(Point::new(5.0, 5.0));
        for y in [0.0, 3.0] {
            path.put(Pen::Down);
            (0..=20_000).for_each(|i| path.at(Point::new(0.001 * f64::from(i), y)));
            path.put(Pen::Up);
            path.at(Point::new(20.0, 1.0));
        }
        let strokes = path.finish();
        assert_eq!(strokes.len(), 2);
        for (stroke, y) in strokes.iter().zip([0.0, 3.0]) {
            assert_eq!(
                (stroke.first(), stroke.last()),
                (Some(&Point::new(0.0, y)), Some(&Point::new(20.0, y)))
            );
            assert!(stroke.len() < 10, "{}", stroke.len());
        }
    }
}
