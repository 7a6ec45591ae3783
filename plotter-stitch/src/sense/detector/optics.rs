//! The optical head as numbers: how far it sees, how often, and what counts as seen.

use super::coverage::disc_over_line;

/// The optical head: two LEDs that flash one after the other in each tact of the controller, one detector.
///
/// ```text
///        tact k                tact k+1
///   |────a──┼──b────|────a──┼──b────|          a, b: the samples of the two LEDs
///           ^ head position of the tact
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct Optics {
    /// Period of the controller, s.
    pub tact_s: f64,
    /// When the two samples of a tact are taken, from its middle, s; the earlier one first.
    pub led_offset_s: [f64; 2],
    /// Diameter of what the detector sees, mm.
    pub disc_mm: f64,
    /// Width of the pen's line, mm.
    pub line_mm: f64,
    /// A line counts as seen above this share of the disc.
    pub seen_above: f64,
    /// Delay from a sample to the position that is noted for it, s: a line seems to lie farther on.
    pub latency_s: f64,
}

impl Default for Optics {
    /// The textile plotter of Ivanov, Gueorguiev, Georgieva and Nenova, section III: a disc of 0.6 mm, a line
    /// of 0.5 mm, 2 ms; the source has two flashes a tact and does not tell when, nor threshold and delay.
    fn default() -> Self {
        Self {
            tact_s: 0.002,
            led_offset_s: [-0.0005, 0.0005],
            disc_mm: 0.6,
            line_mm: 0.5,
            seen_above: 0.1,
            latency_s: 50e-6,
        }
    }
}

impl Optics {
    /// Way of the head over which a whole line is seen, mm; 0 if it is never seen.
    ///
    /// ```
    /// # use plotter_stitch::Optics;
    /// // A tenth of the disc is a segment 0.0940 mm high: seen from 0.3 + 0.25 - 0.094 = 0.456 mm on, on either side.
    /// assert!((Optics::default().span_mm() - 0.912).abs() < 1e-3);
    /// ```
    #[must_use]
    pub fn span_mm(&self) -> f64 {
        let half_line = self.line_mm / 2.0;
        let seen = |u: f64| disc_over_line(self.disc_mm, -half_line - u, half_line - u) > self.seen_above;
        if !seen(0.0) {
            return 0.0;
        }
        let (mut inside, mut outside) = (0.0, half_line + self.disc_mm / 2.0);
        // Halved 40 times it is known to a millionth of a micrometre.
        for _ in 0..40 {
            let middle = (inside + outside) / 2.0;
            if seen(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside + outside
    }
}
