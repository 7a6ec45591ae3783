//! [`PenFigures`]: how well each stroke of a sheet has come onto its own pen.

use super::PenSheet;
use crate::NearestLineIndex;
use crate::judged_drawing::CENTRE_PX;
use plotter_vector::{Drawing, PxPoint};

/// Longest piece of a line that one distance stands for, px.
const PIECE_PX: f64 = 0.5;
/// What is no farther than this from the other side counts as found, px.
const FOUND_PX: f64 = 1.5;
/// What is nearer than this to a stroke is meant to be that stroke, px.
const MEANT_PX: f64 = 3.0;

/// Figures of a drawing beside the sheet. A pen of the drawing stands for that of the sheet along whose
/// strokes most of its length lies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PenFigures {
    /// Share of a pen's true length that its own pen draws within 1.5 px, the mean of the pens.
    pub recall: f64,
    /// The same of the pen that fares worst.
    pub least_recall: f64,
    /// Share of a pen's drawn length that lies within 1.5 px of its own true strokes, the mean of the pens.
    pub precision: f64,
    /// Strokes, as a share of the true ones.
    pub strokes_of_true: f64,
    /// Pens that draw, and those that drew the sheet.
    pub pens: (usize, usize),
    /// Share of the sheets of which the pens that draw are as many as those that drew them.
    pub pens_right: f64,
    /// Share of the drawn length that lies along another pen's stroke.
    pub wrong_pen: f64,
}

impl PenFigures {
    /// The columns of [`PenFigures::row`], as the head of a table.
    pub const HEAD: &str = "\
        | picture | recall, least | precision | strokes of true | pens, true | sheets with all pens | on the wrong pen |\n\
        |---|---|---|---|---|---|---|\n";

    /// The figures as a line of a table.
    #[must_use]
    pub fn row(&self, name: &str) -> String {
        format!(
            "| {name} | {:.4}, {:.3} | {:.4} | {:.3} | {}, {} | {:.2} | {:.2} % |\n",
            self.recall,
            self.least_recall,
            self.precision,
            self.strokes_of_true,
            self.pens.0,
            self.pens.1,
            self.pens_right,
            100.0 * self.wrong_pen
        )
    }

    /// The means of several sheets, the least of least recalls, and all their pens.
    #[must_use]
    pub fn mean(of: &[Self]) -> Self {
        let count = of.len().max(1) as f64;
        let mean = |figure: fn(&Self) -> f64| of.iter().map(figure).sum::<f64>() / count;
        Self {
            recall: mean(|one| one.recall),
            least_recall: of.iter().map(|one| one.least_recall).fold(1.0, f64::min),
            precision: mean(|one| one.precision),
            strokes_of_true: mean(|one| one.strokes_of_true),
            pens: (of.iter().map(|one| one.pens.0).sum(), of.iter().map(|one| one.pens.1).sum()),
            pens_right: mean(|one| one.pens_right),
            wrong_pen: mean(|one| one.wrong_pen),
        }
    }

    /// Compares a drawing with the sheet.
    #[must_use]
    pub fn new(drawing: &Drawing, sheet: &PenSheet) -> Self {
        let lines = |ink: [u8; 3]| -> Vec<Vec<PxPoint>> {
            let own = sheet.strokes().iter().filter(|stroke| stroke.colour == ink);
            let place = |(x, y): &(f64, f64)| PxPoint::new(x + CENTRE_PX, y + CENTRE_PX);
            own.map(|stroke| stroke.points.iter().map(place).collect()).collect()
        };
        let index = |lines: &[Vec<PxPoint>]| NearestLineIndex::new(lines.iter().map(Vec::as_slice));
        let meant: Vec<NearestLineIndex> = sheet.pens.iter().map(|ink| index(&lines(*ink))).collect();
        let numbers = drawing.pens();
        let far =
            |lines: &NearestLineIndex, at: PxPoint| lines.nearest(at).map_or(f64::INFINITY, |(far, _)| far);
        let mut drawn: Vec<Vec<Vec<PxPoint>>> = vec![Vec::new(); meant.len()];
        for number in &numbers {
            let own: Vec<Vec<PxPoint>> = drawing.of_pen(*number).strokes().map(<[PxPoint]>::to_vec).collect();
            let pieces: Vec<_> = index(&own).pieces(PIECE_PX).collect();
            let along = |lines: &NearestLineIndex| -> f64 {
                let near = pieces.iter().filter(|piece| far(lines, piece.middle) <= MEANT_PX);
                near.map(|piece| piece.length_px).sum()
            };
            let most = meant.iter().map(along).enumerate().max_by(|one, other| one.1.total_cmp(&other.1));
            if let Some(slot) = most.and_then(|(pen, _)| drawn.get_mut(pen)) {
                slot.extend(own);
            }
        }
        let mut found = Self { pens: (numbers.len(), meant.len()), least_recall: 1.0, ..Self::default() };
        found.pens_right = if found.pens.0 == found.pens.1 { 1.0 } else { 0.0 };
        let (mut all_px, mut wrong_px) = (0.0, 0.0);
        for (pen, (meant_lines, drawn_lines)) in meant.iter().zip(&drawn).enumerate() {
            let drawn = index(drawn_lines);
            let share = |lines: &NearestLineIndex, others: &NearestLineIndex| {
                let (mut all, mut near) = (0.0, 0.0);
                for piece in lines.pieces(PIECE_PX) {
                    all += piece.length_px;
                    near += if far(others, piece.middle) <= FOUND_PX { piece.length_px } else { 0.0 };
                }
                if all > 0.0 { near / all } else { 0.0 }
            };
            let recall = share(meant_lines, &drawn);
            found.recall += recall / meant.len() as f64;
            found.least_recall = found.least_recall.min(recall);
            found.precision += share(&drawn, meant_lines) / meant.len() as f64;
            for piece in drawn.pieces(PIECE_PX) {
                all_px += piece.length_px;
                let of_other = meant
                    .iter()
                    .enumerate()
                    .any(|(other, lines)| other != pen && far(lines, piece.middle) <= MEANT_PX);
                if of_other && far(meant_lines, piece.middle) > MEANT_PX {
                    wrong_px += piece.length_px;
                }
            }
        }
        found.wrong_pen = if all_px > 0.0 { wrong_px / all_px } else { 0.0 };
        found.strokes_of_true = drawing.strokes().len() as f64 / sheet.strokes().len().max(1) as f64;
        found
    }
}
