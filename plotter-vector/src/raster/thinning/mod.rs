//! [`Thinning`]: ink of any width to lines one pixel wide.

mod deletion;
mod sweep;
mod tips;

use crate::picture::Bitmap;
use core::ops::Range;
use sweep::{Step, Sweeper};

/// Which published algorithm peels the ink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum ThinningMethod {
    /// Algorithm A1 of Z. Guo and R. W. Hall, "Parallel thinning with two-subiteration algorithms",
    /// Communications of the ACM 32 (1989), pp. 359-373.
    ///
    /// As published, each half of a pass keeps the topology. It peels diagonal sides slower than level ones
    /// (0.7 px a pass), so that round ends of diagonal strokes would recede by the whole width; after each
    /// pass the corners of diagonal edges are deleted as well, of one diagonal direction in odd passes and of
    /// the other in even ones, which makes it 1.06 px.
    #[default]
    GuoHall,
    /// T. Y. Zhang and C. Y. Suen, "A fast parallel algorithm for thinning digital patterns", Communications
    /// of the ACM 27 (1984), pp. 236-239, mended.
    ///
    /// As published it deletes squares of 2 x 2 as a whole and eats diagonal lines two pixels wide from their
    /// ends. Here pixels with two neighbours stay (Lü and Wang, Communications of the ACM 29 (1986), pp.
    /// 239-242), and so does one pixel of a square.
    ZhangSuen,
}

/// Settings of thinning: peels ink from all sides, one layer a pass, until lines one pixel wide are left.
///
/// ```
/// use plotter_vector::{Bitmap, raster::Thinning};
/// let bar = Bitmap::from_picture("#######\n#######\n#######\n")?;
/// let thinned = Thinning::default().thin(&bar);
/// assert_eq!(thinned.skeleton.to_string(), ".......\n.#####.\n.......\n");
/// assert!(thinned.converged);
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
///
/// # What is promised
///
/// For every picture, with every setting:
///
/// - The skeleton is part of the ink, and has the same topology: in each 8-connected component of the ink
///   lies exactly one of the skeleton, in each 4-connected component of the paper's exactly one of the
///   skeleton's.
/// - It is *local*: a pixel of the result depends only on ink at most [`Thinning::rows_of_context`] rows and
///   columns away, and moving the ink moves the skeleton. It is not the same for turned or transposed ink:
///   where a side has an even width, one of the two middle pixels must be taken.
///
/// And when [`Thinned::converged`] says so:
///
/// - It is one pixel wide: no pixel with two or more neighbours can be deleted without changing the topology.
///   Stairs become diagonals, the corner of an L and the middle of a T are cut. Squares of 2 x 2 are left
///   only where the topology needs them, as where four branches leave one at its corners.
/// - Thinning it again changes nothing.
///
/// # Ends of strokes
///
/// Both algorithms keep every tip that comes up, so that the corners of a square end and the hairs of a
/// ragged edge grow into branches. Here a tip (one neighbour, or two side by side) is deleted after each half
/// of a pass while there is thick ink beside it: a pixel with ink on all four sides, at most two columns and
/// two rows away. So ends are peeled as fast as sides are, and a stroke ends about half its width before its
/// ink; where it tapers to a point its tip is thin from the start, and stays. Branches of up to 3 px beside
/// thick ink go as corners do.
///
/// Of 840 straight strokes with square ends and 840 with round ends, 2 to 15 px wide, and 120 wedges 9 px
/// wide at the base, at all angles
/// (`cargo test --release -p plotter-vector --test all thinning_ends:: -- --nocapture`):
///
/// | | Guo & Hall | Zhang & Suen |
/// | --- | --- | --- |
/// | farthest from the ink's end beyond half the width, square ends | 2.4 px | 2.3 px |
/// | the same, round ends | 2.4 px | 4.4 px |
/// | more than two ends, square | 26 of 840 | 30 of 840 |
/// | the same, round | 2 of 840 | 0 of 840 |
/// | lost at the point of a wedge | 0 px | 0 px |
///
/// # Cost
///
/// In place, with six bits for each word of 64 pixels and a few rows besides. Words without ink, and words
/// where nothing has changed, are not looked at: 1.4 ms a megapixel for a sheet with 5 % ink in lines 4 to
/// 10 px wide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Thinning {
    /// Which algorithm.
    pub method: ThinningMethod,
    /// Most passes. A pass takes about a pixel from each side, and one more (Guo & Hall: two more) finds that
    /// nothing is left to do: lines w px wide need w / 2 + 3.
    pub max_passes: u32,
}

impl Thinning {
    /// The same with another [`Thinning::method`].
    #[must_use]
    pub const fn with_method(self, method: ThinningMethod) -> Self {
        Self { method, ..self }
    }

    /// The same with another [`Thinning::max_passes`].
    #[must_use]
    pub const fn with_max_passes(self, max_passes: u32) -> Self {
        Self { max_passes, ..self }
    }
}

/// Guo & Hall, for lines up to 60 px wide (2.5 mm at 600 dots per inch).
///
/// With Guo & Hall ends of wide round strokes lie 2 px nearer to where they belong, see the table above, for
/// a tenth to a fifth more time.
impl Default for Thinning {
    fn default() -> Self {
        Self { method: ThinningMethod::GuoHall, max_passes: 32 }
    }
}

/// What thinning leaves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thinned {
    /// Lines one pixel wide; of the size of the ink.
    pub skeleton: Bitmap,
    /// Passes that were done; the last one of a picture that converged (Guo & Hall: the last two) deleted
    /// nothing.
    pub passes: u32,
    /// Whether nothing is left to delete. If not, some ink is wider than twice [`Thinning::max_passes`], or a
    /// large sheet of noise is not clean everywhere after the fixed number of rounds.
    pub converged: bool,
}

/// How far thinning in place came: see [`Thinned`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[must_use]
pub struct ThinningProgress {
    /// Passes that were done.
    pub passes: u32,
    /// Whether nothing is left to delete.
    pub converged: bool,
}

/// Passes of Guo & Hall's algorithm, by turns.
const GUO_HALL: [&[Step]; 2] = [
    &[Step::GuoHallFirst, Step::Tips, Step::GuoHallSecond, Step::CornersRising, Step::Tips],
    &[Step::GuoHallFirst, Step::Tips, Step::GuoHallSecond, Step::CornersFalling, Step::Tips],
];

/// The same of Zhang & Suen's.
const ZHANG_SUEN: [&[Step]; 2] = [&[Step::ZhangSuenFirst, Step::Tips, Step::ZhangSuenSecond, Step::Tips]; 2];

/// A round of cleaning up: what both algorithms leave too much.
const CLEAN_UP: &[Step] = &[Step::BareLeft, Step::BareRight, Step::BareAbove, Step::BareBelow, Step::Tips];

/// Rounds of cleaning up, a fixed number so that the reach of a pixel is fixed.
///
/// The second round finds nothing left to do in line drawings. Of 1500 pictures of noise, 90 x 40 px, 6
/// needed five and each further round was needed by a tenth as many.
const CLEAN_UP_ROUNDS: u32 = 8;

/// How far a pixel's influence spreads in the steps.
fn reach(steps: &[Step]) -> u32 {
    steps.iter().map(|step| step.reach()).sum()
}

impl Thinning {
    /// The skeleton of `ink`.
    #[must_use]
    pub fn thin(&self, ink: &Bitmap) -> Thinned {
        let mut skeleton = ink.clone();
        let ThinningProgress { passes, converged } = self.thin_in_place(&mut skeleton);
        Thinned { skeleton, passes, converged }
    }

    /// As [`Thinning::thin`], where the picture lies, with a tenth of its memory besides. Several threads can
    /// thin bands of one picture at the same time, see [`Thinning::rows_of_context`].
    pub fn thin_in_place(&self, ink: &mut Bitmap) -> ThinningProgress {
        let rows = 0..ink.height();
        self.thin_rows(ink, rows)
    }

    /// As [`Thinning::thin_in_place`], of some rows: what comes of those beside them is anything.
    pub(crate) fn thin_rows(&self, ink: &mut Bitmap, rows: Range<u32>) -> ThinningProgress {
        let height = ink.height();
        // The rows that decide about these in steps that reach so far.
        let within =
            |reach: u32| rows.start.saturating_sub(reach)..rows.end.saturating_add(reach).min(height);
        let of_pass = self.reach_of_pass();
        let mut sweeper = Sweeper::new(ink);
        let turns = self.turns();
        let all_turns = if turns[0] == turns[1] { 1 } else { 2 };
        let (mut passes, mut quiet) = (0, 0);
        for steps in turns.into_iter().cycle() {
            if quiet == all_turns || passes == self.max_passes {
                break;
            }
            passes += 1;
            let to_come = of_pass
                .saturating_mul(self.max_passes - passes)
                .saturating_add(reach(CLEAN_UP) * CLEAN_UP_ROUNDS);
            quiet = if sweeper.pass(ink, within(to_come), steps) { 0 } else { quiet + 1 };
        }
        let peeled = quiet == all_turns;
        // Nothing changed in the last pass of each turn, so more of them would change nothing: leaving early
        // is as good as max_passes of them, which locality asks for. So it is with the rounds of cleaning up.
        sweeper.keep_only(CLEAN_UP);
        let clean = (0..CLEAN_UP_ROUNDS)
            .rev()
            .any(|rounds| !sweeper.pass(ink, within(reach(CLEAN_UP) * rounds), CLEAN_UP));
        ThinningProgress { passes, converged: peeled && clean }
    }

    /// How many rows above and below a pixel decide about it: what a band must bring along so that thinning
    /// it gives the same as thinning the whole picture. It grows with [`Thinning::max_passes`], by 9 rows a
    /// pass (Zhang & Suen: 8), whether the passes are needed or not.
    ///
    /// ```
    /// # use plotter_vector::raster::Thinning;
    /// let narrow = Thinning::default().with_max_passes(8);
    /// assert_eq!(narrow.rows_of_context(), 8 * 9 + 56);
    /// ```
    #[must_use]
    pub fn rows_of_context(&self) -> u32 {
        self.reach_of_pass().saturating_mul(self.max_passes).saturating_add(reach(CLEAN_UP) * CLEAN_UP_ROUNDS)
    }

    fn reach_of_pass(&self) -> u32 {
        self.turns().into_iter().map(reach).max().unwrap_or(0)
    }

    const fn turns(&self) -> [&'static [Step]; 2] {
        match self.method {
            ThinningMethod::GuoHall => GUO_HALL,
            ThinningMethod::ZhangSuen => ZHANG_SUEN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const METHODS: [ThinningMethod; 2] = [ThinningMethod::GuoHall, ThinningMethod::ZhangSuen];

    fn thin(picture: &str, method: ThinningMethod) -> String {
        let thinned =
            Thinning { method, ..Thinning::default() }.thin(&Bitmap::from_picture(picture).unwrap());
        assert!(thinned.converged);
        thinned.skeleton.to_string()
    }

    #[test]
    fn a_crossing_and_a_tee_keep_their_branches() {
        let crossing = "....##....\n....##....\n....##....\n....##....\n##########\n##########\n....##....\n....##....\n....##....\n....##....\n";
        let tee = "###########\n###########\n###########\n....###....\n....###....\n....###....\n";
        for method in METHODS {
            let lines = thin(crossing, method);
            assert!(lines.lines().any(|line| line.matches('#').count() >= 9), "{lines}");
            assert!(lines.lines().filter(|line| line.matches('#').count() == 1).count() >= 6, "{lines}");
            // The middle of a T is cut: its three branches meet at the top of the stem.
            assert_eq!(
                thin(tee, method),
                "...........\n.####.####.\n.....#.....\n.....#.....\n.....#.....\n...........\n"
            );
        }
    }

    #[test]
    fn a_ring_stays_a_ring() {
        let ring = ".####.\n######\n##..##\n##..##\n######\n.####.\n";
        assert_eq!(thin(ring, ThinningMethod::GuoHall), "......\n.###..\n#...#.\n#...#.\n.#..#.\n..##..\n");
        assert_eq!(thin(ring, ThinningMethod::ZhangSuen), "..##..\n.#..#.\n#...#.\n#...#.\n.###..\n......\n");
    }

    #[test]
    fn dots_and_squares_become_dots() {
        for method in METHODS {
            for dot in ["...\n.#.\n...\n", ".....\n..##.\n..##.\n.....\n", "###\n###\n###\n"] {
                assert_eq!(thin(dot, method).matches('#').count(), 1, "{dot}");
            }
        }
    }

    #[test]
    fn a_diagonal_two_pixels_wide_is_not_eaten() {
        let diagonal = "##......\n.##.....\n..##....\n...##...\n....##..\n.....##.\n";
        assert_eq!(
            thin(diagonal, ThinningMethod::GuoHall),
            "#.......\n.#......\n..#.....\n...#....\n....#...\n.....##.\n"
        );
        assert_eq!(
            thin(diagonal, ThinningMethod::ZhangSuen),
            ".#......\n..#.....\n...#....\n....#...\n.....#..\n......#.\n"
        );
    }

    #[test]
    fn the_corner_of_an_ell_is_cut() {
        let ell = "###....\n###....\n###....\n###....\n#######\n#######\n#######\n";
        for method in METHODS {
            assert_eq!(thin(ell, method), ".......\n.#.....\n.#.....\n.#.....\n.#.....\n..####.\n.......\n");
        }
    }

    #[test]
    fn a_square_that_joins_four_branches_stays() {
        let knot = "#..#\n.##.\n.##.\n#..#\n";
        for method in METHODS {
            assert_eq!(thin(knot, method), knot);
        }
    }

    #[test]
    fn some_rows_come_out_as_of_the_whole() {
        let mut ink = Bitmap::new(150, 400).unwrap();
        for y in 0..400_u32 {
            for x in 0..150_u32 {
                let slanted = (x + y / 3) % 50 < 9;
                let level = y % 70 < 6 && x % 97 > 8;
                ink.set(crate::picture::Pixel::new(x, y), (slanted || level) && x * y % 101 != 0);
            }
        }
        for method in METHODS {
            let thinning = Thinning { method, max_passes: 8 };
            let whole = thinning.thin(&ink).skeleton;
            let context = thinning.rows_of_context();
            for rows in [0..40_u32, 170..230, 215..216, 399..400] {
                let first = rows.start.saturating_sub(context);
                let mut band = ink.band(first..rows.end + context);
                let _ = thinning.thin_rows(&mut band, rows.start - first..rows.end - first);
                for y in rows {
                    assert_eq!(band.row(y - first), whole.row(y), "{y}");
                }
            }
        }
    }

    #[test]
    fn empty_sheets_stay_empty() {
        for (width, height) in [(0, 0), (0, 3), (5, 0), (70, 3)] {
            let empty = Bitmap::new(width, height).unwrap();
            let thinned = Thinning::default().thin(&empty);
            assert_eq!(thinned, Thinned { skeleton: empty, passes: 2, converged: true });
        }
    }

    #[test]
    fn lines_one_pixel_wide_stay_as_they_are() {
        for length in [1, 2, 63, 64, 65, 128] {
            for (width, height) in [(length, 1), (1, length)] {
                let line = full(width, height);
                for (method, passes) in METHODS.into_iter().zip([2, 1]) {
                    let thinned = Thinning { method, ..Thinning::default() }.thin(&line);
                    assert_eq!(thinned, Thinned { skeleton: line.clone(), passes, converged: true });
                }
            }
        }
    }

    #[test]
    fn too_few_passes_are_told() {
        let sheet = full(65, 65);
        for method in METHODS {
            let few = Thinning { method, max_passes: 3 }.thin(&sheet);
            assert_eq!((few.passes, few.converged), (3, false));
            let enough = Thinning { method, max_passes: 64 }.thin(&sheet);
            assert!(enough.converged);
            assert!(enough.passes <= 65 / 2 + 4, "{} passes", enough.passes);
        }
    }

    fn full(width: u32, height: u32) -> Bitmap {
        let mut ink = Bitmap::new(width, height).unwrap();
        for y in 0..height {
            (0..width).for_each(|x| ink.set(crate::picture::Pixel::new(x, y), true));
        }
        ink
    }
}
