//! [`Look`]: what was found of a picture that is no clean scan.

use crate::ink::Split;
use core::fmt;

/// What was found of a picture whose ink one level does not tell from its paper: of a photograph, of faint or
/// rough lines, of dirty or ruled paper.
///
/// ```
/// # use plotter_vector::ink::Look;
/// let look = Look { ink_levels: 140.0, noise_levels: 2.5, line_px: 5.0, ..Look::default() };
/// assert_eq!(
///     look.to_string(),
///     "ink: dark, 140 levels from the paper, whose noise has 2.5\nlines: 5 px wide, whole\n"
/// );
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Look {
    /// Whether the ink is lighter than the paper.
    pub light_ink: bool,
    /// How far ink lies from the paper, of 255 levels, where the paper is white.
    pub ink_levels: f32,
    /// Standard deviation of the paper's noise, levels.
    pub noise_levels: f32,
    /// Width of the lines, px; 0 where there are none.
    pub line_px: f32,
    /// Whether strokes have grain and gaps, as those of pencil and chalk.
    pub broken: bool,
    /// Whether the picture was enlarged, each of its own pixels to a block, whose steps were smoothed.
    pub enlarged: bool,
    /// How far from the paper marks lie that were left out because they are much paler than the ink, levels.
    pub pale_levels: Option<f32>,
    /// Specks that were left out: too small, too pale or too short for strokes.
    pub left_out: usize,
    /// The sheet's corners, px, from the upper left clockwise, where something beside it is seen, which was
    /// left out.
    pub sheet: Option<[(f32, f32); 4]>,
}

impl Look {
    /// The split of an evened picture as that of the picture itself; none without ink.
    pub(crate) fn split(&self, split: Option<Split>) -> Option<Split> {
        let found = split.filter(|split| split.ink_pixels > 0);
        found.map(|split| Split { ink_is_dark: !self.light_ink, ..split })
    }

    /// What was assumed, with its subject, in words.
    #[must_use]
    pub fn told(&self) -> Vec<(&'static str, String)> {
        let side = if self.light_ink { "light" } else { "dark" };
        let mut told = Vec::new();
        if self.line_px > 0.0 {
            let (levels, noise, line_px) = (self.ink_levels, self.noise_levels, self.line_px);
            told.push((
                "ink",
                format!("{side}, {levels:.0} levels from the paper, whose noise has {noise:.1}"),
            ));
            let strokes = if self.broken { "with grain and gaps" } else { "whole" };
            told.push(("lines", format!("{line_px:.0} px wide, {strokes}")));
        }
        if self.enlarged {
            told.push(("enlarged", "its own pixels are seen as blocks, whose steps are smoothed".into()));
        }
        if let Some(levels) = self.pale_levels {
            let like = "much paler than the ink, as ruling and what shines through are";
            told.push(("left out", format!("marks of {levels:.0} levels, {like}")));
        }
        if self.left_out > 0 {
            let of = if self.left_out == 1 { "speck" } else { "specks" };
            told.push(("left out", format!("{} {of}", self.left_out)));
        }
        if let Some(corners) = self.sheet {
            let [one, two, three, four] = corners.map(|(x, y)| format!("({x:.0}, {y:.0})"));
            told.push((
                "sheet",
                format!("between {one}, {two}, {three} and {four}; what lies beside it is left out"),
            ));
        }
        told
    }
}

impl fmt::Display for Look {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.told().iter().try_for_each(|(subject, text)| writeln!(f, "{subject}: {text}"))
    }
}
