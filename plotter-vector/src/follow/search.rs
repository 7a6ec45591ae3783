//! [`Search`]: places of the reachable area that no window has shown yet.

use super::whole::{count, floor};
use crate::stroke::PxPoint;

/// Most tiles: beyond, the tiles are larger, and something may be overlooked between windows.
const MAX_TILES: f64 = 4e6;

/// The machine's area in tiles, each smaller than a window, in rows to and fro.
#[derive(Clone, Debug, Default)]
pub(super) struct Search {
    left: f64,
    top: f64,
    tile_px: f64,
    columns: usize,
    rows: usize,
    seen: Vec<bool>,
    next: usize,
}

impl Search {
    /// An area, and the side of what is trusted of a window.
    pub(super) fn new([from, to]: [PxPoint; 2], trusted_px: f64) -> Self {
        let (width, height) = ((to.x - from.x).max(1.0), (to.y - from.y).max(1.0));
        let tile_px = (0.45 * trusted_px).max(4.0).max(libm::sqrt(width * height / MAX_TILES));
        let tiles = |side: f64| count(libm::ceil(side / tile_px)).max(1);
        let (columns, rows) = (tiles(width), tiles(height));
        Self { left: from.x, top: from.y, tile_px, columns, rows, seen: vec![false; columns * rows], next: 0 }
    }

    /// A window has shown all within `reach` px, sideways and up and down.
    pub(super) fn see(&mut self, at: PxPoint, reach_px: (f64, f64)) {
        // Tiles that lie wholly inside; the outermost ones need to be seen up to the border only.
        let span = |middle: f64, reach: f64, first: f64, tiles: usize| {
            let low = libm::ceil((middle - reach - first) / self.tile_px - 1e-9).max(0.0);
            let high = libm::floor((middle + reach - first) / self.tile_px + 1e-9);
            let tiles = i32::try_from(tiles).unwrap_or(i32::MAX);
            (floor(low), floor(high).min(tiles))
        };
        let (left, right) = span(at.x, reach_px.0, self.left, self.columns);
        let (top, low) = span(at.y, reach_px.1, self.top, self.rows);
        for y in top..low {
            for x in left..right {
                let index = usize::try_from(y).unwrap_or(0) * self.columns + usize::try_from(x).unwrap_or(0);
                if let Some(seen) = self.seen.get_mut(index) {
                    *seen = true;
                }
            }
        }
    }

    /// The middle of the next tile that no window has shown; it counts as seen from now on.
    pub(super) fn next(&mut self) -> Option<PxPoint> {
        while self.next < self.seen.len() {
            let (row, along) = (self.next / self.columns, self.next % self.columns);
            let column = if row % 2 == 0 { along } else { self.columns - 1 - along };
            self.next += 1;
            if let Some(seen) = self.seen.get_mut(row * self.columns + column).filter(|seen| !**seen) {
                *seen = true;
                #[expect(clippy::cast_precision_loss, reason = "at most some million tiles")]
                let place = |first: f64, tile: usize| first + (tile as f64 + 0.5) * self.tile_px;
                return Some(PxPoint::new(place(self.left, column), place(self.top, row)));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_is_seen_once() {
        let area = [PxPoint::new(0.0, 0.0), PxPoint::new(500.0, 300.0)];
        let mut search = Search::new(area, 200.0);
        let mut places = 0;
        while let Some(at) = search.next() {
            search.see(at, (100.0, 100.0));
            places += 1;
        }
        assert!((8..=24).contains(&places), "{places}");
        assert_eq!(search.next(), None);
    }
}
