//! [`Look`]: what was found of a picture that is no clean scan.

use core::fmt;

/// What was found of a picture whose ink one level does not tell from its paper: of a photograph, of faint or rough
/// lines, of dirty or ruled paper.
///
/// As text, a line for each thing that was assumed:
///
/// ```
/// # use plotter_vector::ink::Look;
/// let look = Look { ink_levels: 140.0, noise_levels: 2.5, line_px: 5.0, pale_levels: Some(40.0), ..Look::default() };
/// let lines: Vec<String> = look.lines().collect();
/// assert_eq!(lines[0], "ink: dark, 140 levels from the paper, whose noise has 2.5");
/// assert_eq!(lines[2], "left out: marks of 40 levels, much paler than the ink, as ruling and what shines through are");
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
    /// How far from the paper marks lie that were left out because they are much paler than the ink, levels.
    pub pale_levels: Option<f32>,
    /// Specks that were left out: too small, too pale or too short for strokes.
    pub left_out: usize,
    /// The sheet's corners, px, from the upper left clockwise, where something beside it is seen, which was left out.
    pub sheet: Option<[(f32, f32); 4]>,
}

impl Look {
    /// What was assumed, a line each.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        let Self { light_ink, ink_levels, noise_levels, line_px, broken, pale_levels, left_out, sheet } =
            *self;
        let side = if light_ink { "light" } else { "dark" };
        let strokes = if broken { "with grain and gaps" } else { "whole" };
        let of = |[one, two, three, four]: [(f32, f32); 4]| {
            let corner = |(x, y): (f32, f32)| format!("({x:.0}, {y:.0})");
            format!(
                "sheet: from {} over {} and {} to {}; what lies beside it is left out",
                corner(one),
                corner(two),
                corner(three),
                corner(four)
            )
        };
        [
            Some(format!("ink: {side}, {ink_levels:.0} levels from the paper, whose noise has {noise_levels:.1}")),
            (line_px > 0.0).then(|| format!("lines: {line_px:.0} px wide, {strokes}")),
            pale_levels.map(|levels| {
                format!("left out: marks of {levels:.0} levels, much paler than the ink, as ruling and what shines through are")
            }),
            (left_out > 0).then(|| format!("left out: {left_out} specks")),
            sheet.map(of),
        ]
        .into_iter()
        .flatten()
    }
}

impl fmt::Display for Look {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.lines().try_for_each(|line| writeln!(f, "{line}"))
    }
}
