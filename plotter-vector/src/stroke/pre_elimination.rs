//! [`PreElimination`]: the published first pass, which drops pixels on straight stretches.

use crate::picture::Pixel;

/// Drops a pixel B when the way from A, ten pixels before, to C, ten pixels after, hardly turns at B.
///
/// With AB and BC the displacements, tan γ = |AB × BC| / (AB · BC); B goes when tan γ is below the tolerance
/// and the way does not turn back. Products in place of the published slopes give the same angle and hold on
/// vertical lines too. What is dropped is gone: A is the tenth of the pixels that are *still there* before B,
/// so on a slow curve A falls back until the turn shows, where ten pixels of the raster alone would never
/// show it. The first and the last pixel always stay, and so do those that have no tenth pixel before or
/// after: there is nothing to judge them by.
///
/// Source: Öcal's thesis on a two-axis gantry, section 3.2, eq. 3.1 to 3.3.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct PreElimination {
    /// Distance of A and C from B along the figure, px.
    pub reach: usize,
    /// Tangent of the smallest angle that counts as a turn.
    pub tan_gamma: f64,
}

impl PreElimination {
    /// The same with another [`PreElimination::reach`].
    #[must_use]
    pub const fn with_reach(self, reach: usize) -> Self {
        Self { reach, ..self }
    }

    /// The same with another [`PreElimination::tan_gamma`].
    #[must_use]
    pub const fn with_tan_gamma(self, tan_gamma: f64) -> Self {
        Self { tan_gamma, ..self }
    }
}

impl Default for PreElimination {
    /// As published: 10 px, and 0.15, the tangent of 8.5°.
    fn default() -> Self {
        Self { reach: 10, tan_gamma: 0.15 }
    }
}

impl PreElimination {
    /// Indices of the pixels that stay, rising.
    ///
    /// ```
    /// # use plotter_vector::{Pixel, stroke::PreElimination};
    /// let corner: Vec<Pixel> =
    ///     (0..40).map(|x| Pixel::new(x, 0)).chain((1..40).map(|y| Pixel::new(39, y))).collect();
    /// let kept = PreElimination::default().keep(&corner);
    /// assert!(kept.contains(&39)); // the corner
    /// assert!(!kept.contains(&20) && !kept.contains(&65)); // the middle of either arm
    /// ```
    #[must_use]
    pub fn keep(&self, pixels: &[Pixel]) -> Vec<usize> {
        let last = pixels.len().saturating_sub(1);
        let mut kept: Vec<usize> = Vec::new();
        for (index, b) in pixels.iter().enumerate() {
            let before = kept.len().checked_sub(self.reach).and_then(|a| kept.get(a));
            let a = before.and_then(|a| pixels.get(*a));
            let c = index.checked_add(self.reach).and_then(|c| pixels.get(c));
            let judged = a.zip(c).filter(|_| index != 0 && index != last);
            if judged.is_none_or(|(a, c)| self.turns(*a, *b, *c)) {
                kept.push(index);
            }
        }
        kept
    }

    /// Whether the way from `a` over `b` to `c` turns at `b` by the smallest angle that counts.
    fn turns(&self, a: Pixel, b: Pixel, c: Pixel) -> bool {
        let (ab, bc) = (b - a, c - b);
        let cross = ab.cross(bc);
        let dot = ab.dot(bc);
        dot <= 0.0 || libm::fabs(cross) >= self.tan_gamma * dot
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(length: u32, at: impl Fn(u32) -> (u32, u32)) -> Vec<Pixel> {
        (0..length).map(at).map(|(x, y)| Pixel::new(x, y)).collect()
    }

    #[test]
    fn a_vertical_line_keeps_what_cannot_be_judged_only() {
        let ends: Vec<usize> = (0..10).chain(40..50).collect();
        assert_eq!(PreElimination::default().keep(&line(50, |i| (7, i))), ends);
    }

    #[test]
    fn a_step_of_one_pixel_in_ten_is_below_the_tolerance_and_two_are_not() {
        // tan γ of (10, 0) and (10, 1) is 0.1; of (10, 0) and (10, 2) it is 0.2.
        let gentle = line(41, |i| (i, u32::from(i > 20)));
        assert!(!PreElimination::default().keep(&gentle).contains(&20));
        let steep = line(41, |i| (i, 2 * u32::from(i > 20)));
        assert!(PreElimination::default().keep(&steep).contains(&20));
    }

    #[test]
    fn a_way_that_turns_back_keeps_its_turning_point() {
        let mut there_and_back = line(15, |i| (i, 0));
        there_and_back.extend(line(15, |i| (13 - i.min(13), 0)));
        assert!(PreElimination::default().keep(&there_and_back).contains(&14));
    }

    #[test]
    fn nothing_and_a_dot_stay_as_they_are() {
        assert!(PreElimination::default().keep(&[]).is_empty());
        assert_eq!(PreElimination::default().keep(&[Pixel::new(3, 3)]), [0]);
    }
}
