//! [`PaperEdge`]: the rough edge of simulated paper.

use super::noise::Noise;

/// Distance between the bends of an edge, mm.
const BEND_MM: f64 = 400.0;

/// The edge of a roll of paper: straight on the whole, and a little wavy.
///
/// Between places 400 mm apart, at which it is off by normal numbers, it runs straight. The same seed gives
/// the same paper.
///
/// ```
/// use plotter_stitch::sheet::PaperEdge;
///
/// let edge = PaperEdge::new(0.1, 1);
/// assert_eq!(edge.off_mm(1e6), PaperEdge::new(0.1, 1).off_mm(1e6));
/// assert_eq!(PaperEdge::new(0.0, 1).off_mm(1e6), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperEdge {
    sigma_mm: f64,
    seed: u64,
}

impl PaperEdge {
    /// An edge whose bends are off by a standard deviation of `sigma_mm`.
    #[must_use]
    pub const fn new(sigma_mm: f64, seed: u64) -> Self {
        Self { sigma_mm, seed }
    }

    /// How far it lies from a straight edge, mm, at `along_mm` on the sheet.
    #[must_use]
    pub fn off_mm(&self, along_mm: f64) -> f64 {
        let bend = libm::floor(along_mm / BEND_MM);
        let share = along_mm / BEND_MM - bend;
        let at = |bend: f64| {
            // Each bend has numbers of its own, wherever one begins to look.
            let mut random = Noise::new(self.seed ^ bend.to_bits());
            Noise::new(random.bits()).normals(self.sigma_mm)[0]
        };
        at(bend) * (1.0 - share) + at(bend + 1.0) * share
    }
}
