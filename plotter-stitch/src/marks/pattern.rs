//! [`ReferenceLines::with_pattern`]: marks that no stroke of a drawing imitates.

use crate::{MarkGroup, ReferenceLines};
use plotter_motion::Axis;

/// Two marks of an axis are moved by distances that differ by at least this, mm: what a fast pass needs, 0.3
/// mm, to both sides of a stroke, and a little. Ten marks then stay within 3 mm of their places, which is
/// what the ways of the scans leave.
const STEP_MM: f64 = 0.65;

/// Scans nearer than this to one another cross the same stroke, 8 mm to both sides of each, and no two
/// strokes lie side by side, mm.
const SAME_STROKE_MM: f64 = 20.0;

/// Primes with a number whose powers give each remainder but 0 once.
const PRIMES: [(u16, u16); 5] = [(5, 2), (7, 3), (11, 2), (17, 3), (23, 5)];

impl ReferenceLines {
    /// The same marks, each moved across its length by another distance: rows of ten by up to 3 mm to either
    /// side. [`strip16`](Self::strip16) and the others of ours have it already.
    ///
    /// Marks in straight rows are imitated by one straight stroke beside each row: wherever a scan meets a
    /// mark it meets that stroke, always as far beside, and the sheet seems to lie there. Marks on both sides
    /// of the field are imitated by lines that go across the paper, as far from each other as they are. Here
    /// mark n of an axis stands at gⁿ mod p steps of 0.65 mm, for a prime p above the number of marks. Each
    /// remainder comes once, so that a stroke along the rows has the distance of at most one mark; and the
    /// way from one mark to another comes once, so that a slanted or bent one has hardly more. Scans that
    /// cross one stroke still do.
    ///
    /// Source: L. R. Welch's construction of Costas arrays, in S. W. Golomb and H. Taylor, "Constructions and
    /// properties of Costas arrays" (1984).
    ///
    /// ```
    /// # use plotter_motion::Axis;
    /// # use plotter_stitch::{MarkGroup, ReferenceLines};
    /// let row = MarkGroup { axis: Axis::Y, at_mm: vec![18.0], scans_mm: vec![-32.0, 0.0, 2000.0, 2032.0] };
    /// let rows = ReferenceLines { marks: vec![row], ..ReferenceLines::published() };
    /// let marks: Vec<_> = rows.with_pattern().crossings().map(|crossing| crossing.mark_mm).collect();
    /// // Powers of 2 mod 5 are 1, 2, 4, 3: from 2.5 steps of 0.65 mm before 18 mm on.
    /// for (mark_mm, at_mm) in marks.iter().zip([17.025, 17.675, 18.975, 18.325]) {
    ///     assert!((mark_mm - at_mm).abs() < 1e-9);
    /// }
    /// ```
    #[must_use]
    pub fn with_pattern(&self) -> Self {
        let strokes_of = |axis: Axis| -> usize {
            let of = self.marks.iter().filter(|group| group.axis == axis);
            of.map(|group| group.at_mm.len() * strokes(&group.scans_mm).count()).sum()
        };
        let mut marks = alloc::vec::Vec::new();
        let mut next = Axis::BOTH.map(|axis| Powers::above(strokes_of(axis)));
        for group in &self.marks {
            let powers = &mut next[usize::from(group.axis != Axis::BOTH[0])];
            for &at_mm in &group.at_mm {
                for scans_mm in strokes(&group.scans_mm) {
                    marks.push(MarkGroup {
                        axis: group.axis,
                        at_mm: [at_mm + powers.next_mm()].into(),
                        scans_mm: scans_mm.into(),
                    });
                }
            }
        }
        Self { marks, ..self.clone() }
    }
}

/// The scans over one stroke, stroke by stroke.
fn strokes(scans_mm: &[f64]) -> impl Iterator<Item = &[f64]> {
    scans_mm.chunk_by(|one, next| libm::fabs(next - one) < SAME_STROKE_MM)
}

/// Powers of a number, as distances.
struct Powers {
    prime: u16,
    root: u16,
    remainder: u16,
}

impl Powers {
    fn above(count: usize) -> Self {
        let [.., last] = PRIMES;
        let (prime, root) = PRIMES.into_iter().find(|(prime, _)| usize::from(*prime) > count).unwrap_or(last);
        Self { prime, root, remainder: 1 }
    }

    fn next_mm(&mut self) -> f64 {
        let by_mm = STEP_MM * (f64::from(self.remainder) - 0.5 * f64::from(self.prime));
        self.remainder = self.remainder * self.root % self.prime;
        by_mm
    }
}

#[cfg(test)]
mod tests {
    use crate::ReferenceLines;
    use plotter_motion::Axis;
    use std::vec::Vec;

    /// What is nearer than this to a stroke's place could be it, mm: what two fast passes differ by.
    const NEAR_MM: f64 = 0.3;

    /// The row in which a mark stood, its scan, and by how much it was moved; scans over one stroke once.
    fn moved(lines: &ReferenceLines, axis: Axis) -> Vec<(f64, f64, f64)> {
        assert_eq!(lines.check(), Ok(()));
        let rows_mm: &[f64] = match axis {
            Axis::X => &[-10.0, 2_010.0],
            Axis::Y => &[-34.0, -8.0, 18.0, 44.0, 70.0],
        };
        let of_row = |mark_mm: f64| {
            let row_mm = rows_mm.iter().copied().find(|row_mm| (mark_mm - row_mm).abs() < 3.0).unwrap();
            (row_mm, mark_mm - row_mm)
        };
        let mut moved: Vec<_> = lines
            .crossings()
            .filter(|crossing| crossing.axis == axis)
            .map(|crossing| (of_row(crossing.mark_mm), crossing.scan_at_mm))
            .map(|((row_mm, by_mm), scan_at_mm)| (row_mm, scan_at_mm, by_mm))
            .collect();
        moved.dedup_by(|one, other| one.0 == other.0 && (one.1 - other.1).abs() < 20.0);
        moved
    }

    #[test]
    fn no_stroke_along_the_rows_is_beside_two_marks_alike() {
        for lines in [ReferenceLines::strip16(), ReferenceLines::strip24(), ReferenceLines::strip32()] {
            for axis in [Axis::X, Axis::Y] {
                let moved = moved(&lines, axis);
                for (index, (.., one)) in moved.iter().enumerate() {
                    assert!(moved[index + 1..].iter().all(|(.., other)| (one - other).abs() > 2.0 * NEAR_MM));
                }
            }
        }
    }

    /// Lines across the paper, as far from one another as the marks and all of one slant, are each beside
    /// both marks that they pass at most once in the ten.
    #[test]
    fn slanted_strokes_are_beside_few_marks_alike() {
        let moved = moved(&ReferenceLines::strip16(), Axis::Y);
        assert_eq!(moved.len(), 10);
        for one in &moved {
            for other in moved.iter().filter(|other| other.1 != one.1) {
                let slope = (other.2 - one.2) / (other.1 - one.1);
                let is_beside =
                    |mark: &&(f64, f64, f64)| (mark.2 - one.2 - slope * (mark.1 - one.1)).abs() < NEAR_MM;
                // The two that define it, and no other.
                assert_eq!(moved.iter().filter(is_beside).count(), 2);
            }
        }
    }
}
