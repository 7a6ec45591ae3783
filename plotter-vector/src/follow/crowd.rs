//! [`Crowd`]: which lines are so near to each other that they are one piece of ink.

use crate::PxPoint;

/// Where lines are, in cells as wide as the thickest must be apart.
pub(super) struct Crowd<'a> {
    widths_px: &'a [f64],
    clear_px: f64,
    apart_px: f64,
    columns: usize,
    cells: Vec<Vec<(usize, PxPoint)>>,
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
            for at in places {
                let (column, row) = crowd.cell(*at);
                if let Some(cell) = crowd.cells.get_mut(row * columns + column) {
                    cell.push((line, *at));
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
        let (column, row) = self.cell(at);
        let width_px = |line: usize| self.widths_px.get(line).copied().unwrap_or(0.0);
        let are_near = |other: usize, place: &PxPoint| {
            place.distance(at) < 0.5 * (width_px(line) + width_px(other)) + self.clear_px
        };
        (row.saturating_sub(1)..=row + 1).any(|row| {
            (column.saturating_sub(1)..=(column + 1).min(self.columns - 1)).any(|column| {
                self.cells.get(row * self.columns + column).is_some_and(|cell| {
                    cell.iter().any(|(other, place)| *other != line && are_near(*other, place))
                })
            })
        })
    }
}
