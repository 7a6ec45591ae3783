//! [`InkMap`]: which places of the sheet have ink, and since when, however long the drawing is.

use super::numbers::zipped;
use serde_json::{Value, json};
use std::collections::HashMap;

/// Most cells a side. A drawing that needs more gets cells of twice the side, so that the page stays small.
const MOST_CELLS: i32 = 512;
/// Side of a cell at first, mm: the line of a fine pen.
const FINEST_MM: f64 = 0.1;

/// The sheet in square cells, each with the time of its first ink. Cells are as fine as the extent of the
/// drawing allows: when it outgrows the map, each four become one.
#[derive(Clone, Debug, Default)]
pub(super) struct InkMap {
    cells: HashMap<(i32, i32), Cell>,
    /// How often the cells were doubled.
    doubled: u32,
    low: (i32, i32),
    high: (i32, i32),
    last: Option<((i32, i32), bool)>,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    since_us: u64,
    differs: bool,
}

impl InkMap {
    fn side_mm(&self) -> f64 {
        FINEST_MM * f64::from(1_u32.checked_shl(self.doubled).unwrap_or(u32::MAX))
    }

    /// There is ink at a place since a time.
    pub(super) fn push(&mut self, at_us: u64, x_mm: f64, y_mm: f64, differs: bool) {
        let side_mm = self.side_mm();
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a float cast saturates, and no sheet is so large"
        )]
        let cell = |mm: f64| libm::floor(mm / side_mm) as i32;
        let place = (cell(x_mm), cell(y_mm));
        if self.last.replace((place, differs)) == Some((place, differs)) {
            return;
        }
        self.put(place, Cell { since_us: at_us, differs });
        while self.is_too_large() {
            self.doubled = self.doubled.saturating_add(1);
            self.last = None;
            for (place, cell) in core::mem::take(&mut self.cells) {
                self.put((place.0 >> 1, place.1 >> 1), cell);
            }
        }
    }

    fn is_too_large(&self) -> bool {
        let side = |low: i32, high: i32| i64::from(high) - i64::from(low) + 1;
        side(self.low.0, self.high.0).max(side(self.low.1, self.high.1)) > i64::from(MOST_CELLS)
    }

    fn put(&mut self, place: (i32, i32), cell: Cell) {
        if self.cells.is_empty() {
            (self.low, self.high) = (place, place);
        }
        self.low = (self.low.0.min(place.0), self.low.1.min(place.1));
        self.high = (self.high.0.max(place.0), self.high.1.max(place.1));
        let there = self.cells.entry(place).or_insert(cell);
        there.since_us = there.since_us.min(cell.since_us);
        there.differs |= cell.differs;
    }

    /// Rows from below, of each cell 0 for no ink or 1 to 32767 for the share of the time from `first_us` to
    /// `last_us`, plus 32768 if it differs; all high bytes, then all low bytes; zlib, base64.
    pub(super) fn to_json(&self, first_us: u64, last_us: u64) -> Value {
        let size = |low: i32, high: i32| usize::try_from(i64::from(high) - i64::from(low) + 1).unwrap_or(0);
        let (wide, high) = (size(self.low.0, self.high.0), size(self.low.1, self.high.1));
        let span_us = u128::from(last_us.saturating_sub(first_us).max(1));
        let (mut upper, mut lower) = (vec![0_u8; wide * high], vec![0_u8; wide * high]);
        for (place, cell) in &self.cells {
            let since_us = u128::from(cell.since_us.saturating_sub(first_us));
            let share = u16::try_from((since_us * 32_766 / span_us).min(32_766)).unwrap_or(0);
            let value = (share + 1) | if cell.differs { 0x8000 } else { 0 };
            let index = size(self.low.1, place.1).saturating_sub(1) * wide
                + size(self.low.0, place.0).saturating_sub(1);
            let [a, b] = value.to_be_bytes();
            if let (Some(up), Some(down)) = (upper.get_mut(index), lower.get_mut(index)) {
                (*up, *down) = (a, b);
            }
        }
        let side_mm = self.side_mm();
        json!({
            "side_mm": side_mm, "wide": wide, "high": high,
            "x_mm": f64::from(self.low.0) * side_mm, "y_mm": f64::from(self.low.1) * side_mm,
            "cells": zipped(&[&upper, &lower]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_grows_with_the_drawing_and_keeps_the_first_ink() {
        let mut map = InkMap::default();
        for n in 0..200_000_u32 {
            let turn = f64::from(n) * 0.001;
            map.push(u64::from(n) * 10, 100.0 * turn.cos(), 100.0 * turn.sin(), n == 150_000);
        }
        assert!((0.39..0.41).contains(&map.side_mm()), "{}", map.side_mm()); // 200 mm in 512 cells: 0.39 mm
        let ring = map.cells.len();
        assert!((1_500..2_200).contains(&ring), "{ring}"); // 8 r / side = 2000
        // But for corners that were passed by, all of it was there after the first turn.
        let first = map.cells.values().filter(|cell| cell.since_us <= 6_290 * 10).count();
        assert!(first * 10 > ring * 9, "{first} of {ring}");
        assert_eq!(map.cells.values().filter(|cell| cell.differs).count(), 1);
        let json = map.to_json(0, 1_999_990);
        let (wide, high) = (json["wide"].as_u64().unwrap(), json["high"].as_u64().unwrap());
        assert!(wide <= 512 && high <= 512);
        assert!(json["cells"].as_str().unwrap().len() < 30_000);
    }
}
