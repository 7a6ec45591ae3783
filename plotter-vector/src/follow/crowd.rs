//! [`Crowd`]: which lines are so near to each other that they are one piece of ink.

use crate::stroke::PxPoint;

/// Where lines are, in cells as wide as the thickest must be apart.
pub(super) struct Crowd<'a> {
    widths_px: &'a [f64],
    clear_px: f64,
    apart_px: f64,
    columns: usize,
    /// Of each place its line and its number in it.
    cells: Vec<Vec<(usize, usize, PxPoint)>>,
}

impl<'a> Crowd<'a> {
    /// Lines of these widths, px; two of them are one piece of ink where their rims are nearer to each other than `clear_px`.
    pub(super) fn of(
        lines: &[Vec<PxPoint>],
        widths_px: &'a [f64],
        (width, height): (usize, usize),
        clear_px: f64,
    ) -> Self {
        let apart_px = widths_px.iter().copied().fold(1.0, f64::max) + clear_px;
        let count = |side: usize| super::whole::count(super::lines::count_f64(side) / apart_px) + 1;
        let (columns, rows) = (count(width), count(height));
        let mut crowd =
            Self { widths_px, clear_px, apart_px, columns, cells: vec![Vec::new(); columns * rows] };
        for (line, places) in lines.iter().enumerate() {
            for (index, at) in places.iter().enumerate() {
                let (column, row) = crowd.cell(*at);
                if let Some(cell) = crowd.cells.get_mut(row * columns + column) {
                    cell.push((line, index, *at));
                }
            }
        }
        crowd
    }

    fn cell(&self, at: PxPoint) -> (usize, usize) {
        let cell = |at: f64| super::whole::count((at / self.apart_px).max(0.0));
        (cell(at.x).min(self.columns - 1), cell(at.y))
    }

    /// Whether another line is so near to a place that both are one piece of ink.
    pub(super) fn is_near(&self, line: usize, at: PxPoint) -> bool {
        let own_px = 0.5 * self.width_px(line);
        self.around(at).any(|(other, _, place)| {
            other != line && place.is_within(own_px + 0.5 * self.width_px(other) + self.clear_px, at)
        })
    }

    /// How far a place is outside of the ink of all lines but those places, by line and number, that are its own; px, at most what
    /// is clear.
    pub(super) fn outside_px(&self, at: PxPoint, is_own: impl Fn(usize, usize) -> bool) -> f64 {
        self.around(at).fold(self.clear_px, |least, (line, index, place)| {
            let half_px = 0.5 * self.width_px(line);
            if place.is_within(half_px + least, at) && !is_own(line, index) {
                least.min(place.distance(at) - half_px)
            } else {
                least
            }
        })
    }

    fn width_px(&self, line: usize) -> f64 {
        self.widths_px.get(line).copied().unwrap_or(0.0)
    }

    /// The places in the cells around one, with their lines and their numbers.
    fn around(&self, at: PxPoint) -> impl Iterator<Item = (usize, usize, PxPoint)> + '_ {
        let (column, row) = self.cell(at);
        (row.saturating_sub(1)..=row + 1).flat_map(move |row| {
            let columns = column.saturating_sub(1)..=(column + 1).min(self.columns - 1);
            let cells = columns.filter_map(move |column| self.cells.get(row * self.columns + column));
            cells.flatten().copied()
        })
    }
}
