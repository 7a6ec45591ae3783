//! [`Judgement`]: how well a drawing meets the strokes that a picture was drawn from.

use crate::corpus::Truth;
use crate::judged_drawing::CENTRE_PX;
use crate::{LinePiece, NearestLineIndex};
use plotter_vector::{Bitmap, Drawing, PxPoint, Rgb, ink::PalettePen};
use serde::Serialize;

/// Longest piece of a line that one distance stands for, px.
const PIECE_PX: f64 = 0.5;

/// What is no farther than this from the other side counts as found, px.
const FOUND_PX: f64 = 1.0;

/// The same on pictures that are not sharp, px: a pen of 3 px, the usual one, from its
/// middle to its rim.
const FOUND_ROUGHLY_PX: f64 = 1.5;

/// What is nearer than this to a stroke is meant to be that stroke, px: within the lines of the corpus.
const MEANT_PX: f64 = 3.0;

/// Longest lines that are compared, px: ten times those of a dense A0 sheet at 600 dots per inch.
const MOST_PX: f64 = 1e8;

/// Figures of a drawing, compared with the truth.
///
/// The truth *T* and the drawing *D* are cut into pieces of at most ½ px, those of a segment equal. A piece
/// stands for its length *l* with its middle *p*, and *d*(*p*, *X*) is the distance of that from the nearest
/// point of the lines *X*. Greatest distances are known to a quarter of a pixel in the worst case, for ends
/// lie so far from the last middle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// Vertices of all strokes, a closed one's first counted again at its end, a dot's once.
    pub vertices: usize,
    /// Strokes.
    pub strokes: usize,
    /// Length of the strokes, px.
    pub pen_down_px: f64,
    /// From each stroke's end to the next one's beginning, px.
    pub pen_up_px: f64,
    /// Mean of both directed mean distances, px: ½ (Σ<sub>T</sub> *l d*(*p*, *D*) / Σ<sub>T</sub> *l* +
    /// Σ<sub>D</sub> *l d*(*p*, *T*) / Σ<sub>D</sub> *l*).
    pub mean_px: f64,
    /// Hausdorff distance, px: the greatest *d*(*p*, *D*) of *T* and *d*(*p*, *T*) of *D*.
    pub hausdorff_px: f64,
    /// Share of the truth's length that is drawn: Σ<sub>T</sub> *l* [*d*(*p*, *D*) ≤ 1] / Σ<sub>T</sub> *l*.
    pub recall: f64,
    /// Share of the drawing's length that is true: Σ<sub>D</sub> *l* [*d*(*p*, *T*) ≤ 1] / Σ<sub>D</sub> *l*.
    pub precision: f64,
    /// Recall with 1.5 px in place of 1.
    pub recall_1_5_px: f64,
    /// Precision with 1.5 px in place of 1.
    pub precision_1_5_px: f64,
    /// Strokes, as a share of the true ones.
    pub strokes_of_true: f64,
    /// At the junctions of the truth, where there are any.
    pub junctions: Option<JunctionFigures>,
    /// Share of the drawing's length that lies less than 3 px from the truth and whose pen has, of all
    /// colours of the truth, the nearest stroke's as its nearest; `None` where the truth has a single colour,
    /// or the drawing's are not known.
    pub right_pen: Option<f64>,
    /// Greatest distance of an ink pixel's centre from the drawing, px. On lines 1 px wide, what is promised;
    /// on wider ones half of their width is in it.
    pub ink_max_px: Option<f64>,
}

/// Figures at junctions. The deviation at a junction is the greatest distance, either way, of the pieces
/// whose middle is in a disc of 1.5 *w* + 4 px about it, *w* the width of the widest pen; the disc's radius,
/// where one side has none there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct JunctionFigures {
    /// How many there are.
    pub count: usize,
    /// Mean of the deviations, px.
    pub mean_px: f64,
    /// Share of them at which it is at most 1 px.
    pub within_1_px: f64,
    /// Share of them at which it is at most 1.5 px.
    pub within_1_5_px: f64,
}

impl Judgement {
    /// Compares a drawing of straight lines with the truth, and with the picture's ink where that is given.
    /// `pens` are those of the drawing, with their colours, where they are known.
    ///
    /// # Errors
    ///
    /// The drawing has no strokes, or its lines or the true ones are longer than 10⁸ px.
    pub fn new(
        drawing: &Drawing,
        pens: &[PalettePen],
        truth: &Truth,
        ink: Option<&Bitmap>,
    ) -> Result<Self, String> {
        let true_lines = true_lines(truth);
        let true_px: f64 =
            true_lines.iter().flat_map(|line| line.windows(2)).map(|at| at[0].distance(at[1])).sum();
        let longest_px = drawing.pen_down_px().max(true_px);
        if longest_px > MOST_PX || longest_px.is_nan() {
            return Err(format!("{longest_px:.0} px of lines are more than {MOST_PX:.0}: give a part of it"));
        }
        let drawn = NearestLineIndex::new(drawing.strokes());
        let meant = NearestLineIndex::new(true_lines.iter().map(Vec::as_slice));
        let (of_drawing, of_truth) = (measured(&drawn, &meant), measured(&meant, &drawn));
        if of_drawing.is_empty() || of_truth.is_empty() {
            return Err("it draws nothing: there is nothing to compare".into());
        }
        Ok(Self {
            vertices: drawing.vertices(),
            strokes: drawing.strokes().len(),
            pen_down_px: drawing.pen_down_px(),
            pen_up_px: drawing.pen_up_px(),
            mean_px: f64::midpoint(mean_px(&of_truth), mean_px(&of_drawing)),
            hausdorff_px: greatest_px(&of_truth).max(greatest_px(&of_drawing)),
            recall: share(&of_truth, |piece| piece.far_px <= FOUND_PX),
            precision: share(&of_drawing, |piece| piece.far_px <= FOUND_PX),
            recall_1_5_px: share(&of_truth, |piece| piece.far_px <= FOUND_ROUGHLY_PX),
            precision_1_5_px: share(&of_drawing, |piece| piece.far_px <= FOUND_ROUGHLY_PX),
            strokes_of_true: drawing.strokes().len() as f64 / truth.polylines.len() as f64,
            junctions: junctions(truth, &of_truth, &of_drawing),
            right_pen: right_pen(drawing, pens, truth, &of_drawing)?,
            ink_max_px: ink.map(|ink| {
                let far = ink.ink().filter_map(|pixel| drawn.nearest(pixel.into()));
                far.map(|(far_px, _)| far_px).fold(0.0, f64::max)
            }),
        })
    }

    /// The columns of [`Judgement::row`], as the head of a table.
    pub const HEAD: &str = "\
        | picture | vertices | strokes | pen up | mean | greatest | recall | precision | junctions | right pen | ink | \
        strokes of true | recall, precision at 1.5 px | junctions within 1.5 px |\n\
        |---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

    /// The figures as a line of a table.
    #[must_use]
    pub fn row(&self, name: &str) -> String {
        let junctions = self.junctions.map_or(String::new(), |found| {
            format!("{:.2}, {:.0} %", found.mean_px, 100.0 * found.within_1_px)
        });
        let roughly =
            self.junctions.map_or(String::new(), |found| format!("{:.0} %", 100.0 * found.within_1_5_px));
        let or_nothing = |figure: Option<f64>, digits: usize| {
            figure.map_or(String::new(), |figure| format!("{figure:.digits$}"))
        };
        format!(
            "| {name} | {} | {} | {:.0} | {:.3} | {:.2} | {:.4} | {:.4} | {junctions} | {} | {} | {:.2} | {:.4}, {:.4} | {roughly} |\n",
            self.vertices,
            self.strokes,
            self.pen_up_px,
            self.mean_px,
            self.hausdorff_px,
            self.recall,
            self.precision,
            or_nothing(self.right_pen, 4),
            or_nothing(self.ink_max_px, 2),
            self.strokes_of_true,
            self.recall_1_5_px,
            self.precision_1_5_px,
        )
    }
}

/// A piece of a line, and the nearest of the lines of the other side.
#[derive(Clone, Copy, Debug)]
struct Measured {
    piece: LinePiece,
    far_px: f64,
    nearest: usize,
}

fn measured(lines: &NearestLineIndex, others: &NearestLineIndex) -> Vec<Measured> {
    let near = |piece: LinePiece| {
        let (far_px, nearest) = others.nearest(piece.middle)?;
        Some(Measured { piece, far_px, nearest })
    };
    lines.pieces(PIECE_PX).filter_map(near).collect()
}

fn true_lines(truth: &Truth) -> Vec<Vec<PxPoint>> {
    let lines = truth.polylines.iter();
    lines.map(|line| line.points.iter().map(|(x, y)| place(*x, *y)).collect()).collect()
}

fn place(x: f64, y: f64) -> PxPoint {
    PxPoint::new(x + CENTRE_PX, y + CENTRE_PX)
}

fn length_px(pieces: &[Measured]) -> f64 {
    pieces.iter().map(|piece| piece.piece.length_px).sum()
}

/// By length; of dots alone, each counts the same.
fn weighted(pieces: &[Measured], figure: impl Fn(&Measured) -> f64) -> f64 {
    let whole_px = length_px(pieces);
    let sum =
        |weight: &dyn Fn(&Measured) -> f64| pieces.iter().map(|at| weight(at) * figure(at)).sum::<f64>();
    if whole_px > 0.0 {
        sum(&|at| at.piece.length_px) / whole_px
    } else {
        let count: f64 = pieces.iter().map(|_| 1.0).sum();
        sum(&|_| 1.0) / count
    }
}

fn mean_px(pieces: &[Measured]) -> f64 {
    weighted(pieces, |at| at.far_px)
}

fn share(pieces: &[Measured], counts: impl Fn(&Measured) -> bool) -> f64 {
    weighted(pieces, |at| if counts(at) { 1.0 } else { 0.0 })
}

fn greatest_px(pieces: &[Measured]) -> f64 {
    pieces.iter().map(|at| at.far_px).fold(0.0, f64::max)
}

fn junctions(truth: &Truth, of_truth: &[Measured], of_drawing: &[Measured]) -> Option<JunctionFigures> {
    let radius_px = 1.5 * truth.widest_px() + 4.0;
    let mut figures =
        JunctionFigures { count: truth.junctions.len(), mean_px: 0.0, within_1_px: 0.0, within_1_5_px: 0.0 };
    let mut count = 0.0;
    for (x, y, _) in &truth.junctions {
        let centre = place(*x, *y);
        let in_disc = |side: &[Measured]| {
            let near = side.iter().filter(|at| at.piece.middle.distance(centre) <= radius_px);
            near.map(|at| at.far_px).reduce(f64::max).unwrap_or(radius_px)
        };
        let off_px = in_disc(of_truth).max(in_disc(of_drawing));
        figures.mean_px += off_px;
        figures.within_1_px += if off_px <= FOUND_PX { 1.0 } else { 0.0 };
        figures.within_1_5_px += if off_px <= FOUND_ROUGHLY_PX { 1.0 } else { 0.0 };
        count += 1.0;
    }
    figures.mean_px /= count;
    figures.within_1_px /= count;
    figures.within_1_5_px /= count;
    (figures.count > 0).then_some(figures)
}

fn right_pen(
    drawing: &Drawing,
    pens: &[PalettePen],
    truth: &Truth,
    of_drawing: &[Measured],
) -> Result<Option<f64>, String> {
    let colours: Vec<Rgb> = truth.polylines.iter().map(|line| line.colour()).collect::<Result<_, _>>()?;
    if pens.is_empty() || colours.iter().all(|colour| Some(colour) == colours.first()) {
        return Ok(None);
    }
    let nearest_colour = |colour: Rgb| {
        let far = |one: &Rgb| one.oklab().distance(colour.oklab());
        colours.iter().copied().min_by(|one, other| far(one).total_cmp(&far(other)))
    };
    let own: Vec<Option<Rgb>> = (0..drawing.strokes().len())
        .map(|stroke| {
            let pen = pens.iter().find(|pen| pen.number == drawing.pen(stroke))?;
            nearest_colour(pen.colour)
        })
        .collect();
    let is_right = |at: &Measured| {
        let own = own.get(at.piece.line).copied().flatten();
        at.far_px < MEANT_PX && own.is_some() && own == colours.get(at.nearest).copied()
    };
    Ok(Some(share(of_drawing, is_right)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::TrueLine;

    const ROUNDING_PX: f64 = 1e-9;

    fn truth(lines: &[(&str, &[(f64, f64)])], junctions: &[(f64, f64, u32)]) -> Truth {
        let lines = lines.iter().map(|(color, points)| {
            serde_json::json!({ "width": 2.0, "color": color, "closed": false, "points": points })
        });
        let file = serde_json::json!({
            "name": "cross", "width": 40, "height": 40, "convention": "pixel-centre", "stroke_width": [2.0],
            "polylines": lines.collect::<Vec<_>>(), "junctions": junctions,
        });
        Truth::from_json(file.to_string().as_bytes()).unwrap()
    }

    fn drawing(strokes: &[(u8, &[(f64, f64)])]) -> Drawing {
        let mut drawing = Drawing::new(40, 40);
        for (pen, points) in strokes {
            drawing.push_with_pen(*pen, points.iter().map(|(x, y)| PxPoint::new(*x, *y)));
        }
        drawing
    }

    fn judge(drawing: &Drawing, truth: &Truth) -> Judgement {
        Judgement::new(drawing, &[], truth, None).unwrap()
    }

    #[test]
    fn a_line_beside_the_true_one_is_off_by_the_distance_between() {
        let truth = truth(&[("#000000", &[(2.0, 5.0), (32.0, 5.0)])], &[]);
        let found = judge(&drawing(&[(1, &[(2.5, 6.25), (32.5, 6.25)])]), &truth);
        assert!(
            (found.mean_px - 0.75).abs() < ROUNDING_PX && (found.hausdorff_px - 0.75).abs() < ROUNDING_PX
        );
        assert_eq!((found.recall, found.precision, found.junctions), (1.0, 1.0, None));
        assert_eq!((found.vertices, found.strokes, found.pen_down_px), (2, 1, 30.0));
    }

    #[test]
    fn what_is_a_little_more_than_a_pixel_off_is_found_roughly() {
        let truth = truth(&[("#000000", &[(0.0, 5.0), (20.0, 5.0)])], &[]);
        // The right half is 1.25 px below, the left half is there twice.
        let left = (1, &[(0.5, 5.5), (10.5, 5.5)][..]);
        let found = judge(&drawing(&[left, left, (1, &[(10.5, 6.75), (20.5, 6.75)])]), &truth);
        // Half a piece from the right end of the left half is nearer than 1 px to that.
        assert!(
            (found.recall - 0.55).abs() < 0.03 && (found.precision - 2.0 / 3.0).abs() < 0.03,
            "{found:?}"
        );
        assert_eq!((found.recall_1_5_px, found.precision_1_5_px, found.strokes_of_true), (1.0, 1.0, 3.0));
    }

    #[test]
    fn what_is_missing_lowers_recall_and_what_is_too_much_precision() {
        let truth = truth(&[("#000000", &[(0.0, 5.0), (20.0, 5.0)])], &[]);
        // Half of the line, 10 px, and as much somewhere else.
        let half = judge(&drawing(&[(1, &[(0.5, 5.5), (10.5, 5.5)])]), &truth);
        // What lies within a pixel of its end is found.
        assert_eq!((half.recall, half.precision), (0.55, 1.0));
        let more =
            judge(&drawing(&[(1, &[(0.5, 5.5), (20.5, 5.5)]), (1, &[(0.5, 25.5), (20.5, 25.5)])]), &truth);
        assert_eq!((more.recall, more.precision, more.hausdorff_px), (1.0, 0.5, 20.0));
    }

    #[test]
    fn a_junction_that_is_cut_is_off_by_what_is_cut() {
        let cross = truth(
            &[("#000000", &[(0.0, 20.0), (40.0, 20.0)]), ("#000000", &[(20.0, 0.0), (20.0, 40.0)])],
            &[(20.0, 20.0, 4)],
        );
        let straight = [(1, &[(0.5, 20.5), (40.5, 20.5)][..]), (1, &[(20.5, 0.5), (20.5, 40.5)][..])];
        let figures = |mean_px, within_1_px, within_1_5_px| JunctionFigures {
            count: 1,
            mean_px,
            within_1_px,
            within_1_5_px,
        };
        assert_eq!(judge(&drawing(&straight), &cross).junctions, Some(figures(0.0, 1.0, 1.0)));
        // Both lines 1.25 px beside the true ones.
        let beside = [(1, &[(0.5, 21.75), (40.5, 21.75)][..]), (1, &[(21.75, 0.5), (21.75, 40.5)][..])];
        assert_eq!(judge(&drawing(&beside), &cross).junctions, Some(figures(1.25, 0.0, 1.0)));
        // The disc reaches 7 px, and there is nothing of the drawing in it.
        let left_out = [
            (1, &[(0.5, 20.5), (10.5, 20.5)][..]),
            (1, &[(30.5, 20.5), (40.5, 20.5)][..]),
            (1, &[(20.5, 0.5), (20.5, 10.5)][..]),
            (1, &[(20.5, 30.5), (20.5, 40.5)][..]),
        ];
        let found = judge(&drawing(&left_out), &cross).junctions.unwrap();
        assert!(found.mean_px > 9.5 && found.within_1_px == 0.0, "{found:?}");
    }

    #[test]
    fn a_stroke_of_the_wrong_pen_counts_as_much_as_it_is_long() {
        let truth =
            truth(&[("#cc1a1a", &[(0.0, 5.0), (20.0, 5.0)]), ("#1a40cc", &[(0.0, 15.0), (20.0, 15.0)])], &[]);
        let drawn = drawing(&[
            (1, &[(0.5, 5.5), (20.5, 5.5)]),
            (2, &[(0.5, 15.5), (10.5, 15.5)]),
            (1, &[(10.5, 15.5), (20.5, 15.5)]),
        ]);
        let pen = |number, colour| PalettePen { number, name: String::new(), colour, width_mm: None };
        let pens = [pen(1, Rgb([180, 40, 30])), pen(2, Rgb([20, 60, 220]))];
        let judge = |pens: &[PalettePen]| Judgement::new(&drawn, pens, &truth, None).unwrap().right_pen;
        assert_eq!((judge(&pens), judge(&[])), (Some(0.75), None));
    }

    #[test]
    fn ink_without_a_line_is_as_far_as_the_nearest_one() {
        let truth = truth(&[("#000000", &[(0.0, 0.0), (3.0, 0.0)])], &[]);
        let ink = Bitmap::from_picture("####\n....\n...#\n").unwrap();
        let drawn = drawing(&[(1, &[(0.5, 0.5), (3.5, 0.5)])]);
        assert_eq!(Judgement::new(&drawn, &[], &truth, Some(&ink)).unwrap().ink_max_px, Some(2.0));
        assert!(Judgement::new(&Drawing::new(4, 3), &[], &truth, None).is_err());
    }

    #[test]
    fn a_dot_counts_by_its_place() {
        let line = TrueLine { width: 3.0, color: "#000000".into(), closed: false, points: vec![(7.0, 7.0)] };
        let mut truth = truth(&[("#000000", &[(0.0, 0.0), (3.0, 0.0)])], &[]);
        truth.polylines = vec![line];
        let found = judge(&drawing(&[(1, &[(7.5, 8.0)])]), &truth);
        assert_eq!((found.mean_px, found.hausdorff_px, found.vertices), (0.5, 0.5, 1));
    }
}
