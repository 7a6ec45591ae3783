//! [`Desired`]: lines that were meant, in a bounded number of points.

use super::envelope::whole;
use super::trail::{DRAWN, Trail, TrailPoint};
use plotter_motion::Point;

/// Lines that were meant, as a trail along their own length.
#[derive(Debug)]
pub(crate) struct Desired {
    trail: Trail,
    length_um: u64,
    at: Option<Point>,
}

impl Desired {
    pub(crate) fn new(tolerance_mm: f64, most: usize) -> Self {
        Self { trail: Trail::new(tolerance_mm, most), length_um: 0, at: None }
    }

    pub(crate) fn line(&mut self, from: Point, to: Point) {
        if self.at.is_none_or(|at| at != from) {
            self.go(from, 0);
        }
        self.go(to, DRAWN);
    }

    fn go(&mut self, to: Point, state: u8) {
        let way_mm = self.at.map_or(0.0, |at| at.distance(to));
        let way_um = u64::try_from(whole(way_mm * 1e3)).unwrap_or(0);
        self.length_um = self.length_um.saturating_add(way_um);
        self.trail.push(TrailPoint { at_us: self.length_um, x_mm: to.x, y_mm: to.y, state });
        self.at = Some(to);
    }

    pub(crate) fn finish(self) -> (Vec<TrailPoint>, f64) {
        self.trail.finish()
    }
}
