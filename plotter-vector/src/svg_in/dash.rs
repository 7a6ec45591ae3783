//! [`Dashes`]: a dashed stroke as the strokes that a pen draws.

use super::SvgError;
use crate::stroke::PxPoint;

/// The pattern of a dashed stroke: lengths in the shape's own unit, drawn and left out by turns.
#[derive(Clone, Debug)]
pub(super) struct Dashes {
    lengths: Vec<f64>,
    /// Where in the pattern a stroke begins: the length's index, and what is left of it.
    index: usize,
    left: f64,
}

impl Dashes {
    /// `None` when the pattern is no pattern: without lengths, with one that is negative or no number, or all
    /// zero. The offset may be negative.
    pub(super) fn new(lengths: &[f32], offset: f32) -> Option<Self> {
        let lengths: Vec<f64> = lengths.iter().copied().map(f64::from).collect();
        let period: f64 = lengths.iter().sum();
        let good = lengths.iter().all(|length| *length >= 0.0) && period > 0.0 && period.is_finite();
        if !good || !offset.is_finite() {
            return None;
        }
        let offset = f64::from(offset);
        let mut along = offset - period * libm::floor(offset / period);
        for (index, length) in lengths.iter().enumerate() {
            if along < *length || (along, *length) == (0.0, 0.0) {
                return Some(Self { index, left: length - along, lengths });
            }
            along -= length;
        }
        let left = lengths.first().copied()?;
        Some(Self { lengths, index: 0, left })
    }

    /// Hands the dashes of a stroke to `draw`, in order. `own_length` measures a way on the sheet in the
    /// shape's own unit. A dash of no length is a dot.
    ///
    /// # Errors
    /// Those of `draw`: it must end the loop when the dashes are too many.
    pub(super) fn draw(
        &self,
        stroke: &[PxPoint],
        own_length: impl Fn(f64, f64) -> f64,
        mut draw: impl FnMut(&[PxPoint]) -> Result<(), SvgError>,
    ) -> Result<(), SvgError> {
        let (mut index, mut left) = (self.index, self.left);
        let mut dash: Vec<PxPoint> = stroke.first().copied().into_iter().collect();
        for (from, to) in stroke.iter().zip(stroke.iter().skip(1)) {
            let way = *to - *from;
            let length = own_length(way.x, way.y);
            let mut done = 0.0;
            // Each turn of the pattern draws something, so that `draw` sees to it that this ends.
            while length - done > left {
                done += left;
                let at = *from + way * (done / length);
                if is_drawn(index) {
                    if dash.last() != Some(&at) {
                        dash.push(at);
                    }
                    draw(&dash)?;
                }
                dash.clear();
                dash.push(at);
                index = if index + 1 < self.lengths.len() { index + 1 } else { 0 };
                left = self.lengths.get(index).copied().unwrap_or(0.0);
            }
            left -= length - done;
            if is_drawn(index) {
                dash.push(*to);
            }
        }
        if is_drawn(index) && dash.len() > 1 { draw(&dash) } else { Ok(()) }
    }
}

/// Lengths are drawn and left out by turns.
fn is_drawn(index: usize) -> bool {
    index.is_multiple_of(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dashed(lengths: &[f32], offset: f32, stroke: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let stroke: Vec<PxPoint> = stroke.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect();
        let mut dashes = Vec::new();
        let draw = |dash: &[PxPoint]| {
            dashes.push(dash.iter().map(|at| (at.x, at.y)).collect());
            Ok(())
        };
        Dashes::new(lengths, offset).unwrap().draw(&stroke, libm::hypot, draw).unwrap();
        dashes
    }

    #[test]
    fn dashes_go_round_corners() {
        let corner = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0)];
        assert_eq!(
            dashed(&[3.0, 0.5], 0.0, &corner),
            vec![
                vec![(0.0, 0.0), (3.0, 0.0)],
                vec![(3.5, 0.0), (4.0, 0.0), (4.0, 2.5)],
                vec![(4.0, 3.0), (4.0, 4.0)]
            ]
        );
    }

    #[test]
    fn an_offset_begins_within_the_pattern_and_may_be_negative() {
        let line = [(0.0, 0.0), (6.0, 0.0)];
        assert_eq!(
            dashed(&[2.0, 2.0], 1.0, &line),
            vec![vec![(0.0, 0.0), (1.0, 0.0)], vec![(3.0, 0.0), (5.0, 0.0)]]
        );
        assert_eq!(
            dashed(&[2.0, 2.0], -1.0, &line),
            vec![vec![(1.0, 0.0), (3.0, 0.0)], vec![(5.0, 0.0), (6.0, 0.0)]]
        );
    }

    #[test]
    fn dashes_of_no_length_are_dots() {
        let line = [(0.0, 0.0), (5.0, 0.0)];
        assert_eq!(
            dashed(&[0.0, 2.0], 0.0, &line),
            vec![vec![(0.0, 0.0)], vec![(2.0, 0.0)], vec![(4.0, 0.0)]]
        );
    }

    #[test]
    fn what_is_no_pattern_is_none() {
        for lengths in [&[][..], &[0.0, 0.0], &[-1.0, 2.0], &[f32::NAN, 1.0], &[f32::INFINITY, 1.0]] {
            assert!(Dashes::new(lengths, 0.0).is_none(), "{lengths:?}");
        }
    }
}
