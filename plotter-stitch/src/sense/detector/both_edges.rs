//! Ours: the middle between both edges of what was seen, or the centroid of how dark it was.

use super::{FindLine, Optics, Order, ScanError, Sighting, Tact};

/// A line may flicker where its edge is about the threshold: gaps up to here are not its end, mm.
const FLICKER_MM: f64 = 0.1;

/// How much longer or shorter than a clean line a rough one may be seen, mm: four times what two edges vary
/// by 0.02 mm each. To it comes what sampling does not tell.
const ROUGH_MM: f64 = 0.12;

/// What the head's and the detector's own noise make of the middle of hits, mm: each edge is unsteady by some
/// 0.01 mm.
const EDGES_NOISE_MM: f64 = 0.006;

/// What the detector's own noise makes of a centroid, mm: 0.02 of the disc in each of some 30 samples.
const CENTROID_NOISE_MM: f64 = 0.003;

/// Standard deviation of a centroid for each millimetre between samples; found by simulation at 0.015 to 0.3
/// mm.
const CENTROID_SPACING: f64 = 0.08;

/// Finds a line as the middle between where it begins and where it ends.
///
/// Each tact has two samples, at two places, since the head moves on between them:
///
/// ```text
///  place of sample = position + velocity · (time of the LED's flash from the middle of the tact)
///
///  seen above 0.1       ┌──────────────┐             an edge lies somewhere between the last sample that did not
///       . . . . . . . . │ . . . . . .  │ . .         see the line and the first one that did: half way, on average
///                  edge ^      ^at     ^ edge
/// ```
///
/// With a spacing d of samples each edge is known to d / √12, their middle to d / √24: 0.061 mm at 0.3 m/s,
/// 0.006 mm in a second pass ten times slower. Near an edge an unsteady head may see the line, lose it and
/// see it again, so all samples that saw it count: the middle is the mean of their places. Of a single hit in
/// a tact the place follows from its neighbours: a line begins with the second sample and ends with the
/// first.
///
/// Where the detector tells *how much* is covered, each sample counts by what exceeds the threshold, which
/// makes it the centroid; the coverage of a line is symmetric about its middle, so it is unbiased, and an
/// error of one sample weighs little.
///
/// The head's delay carries the line along by velocity · latency; a second pass the other way takes that out.
///
/// ```
/// use plotter_stitch::{FindLine, Optics, sense::{BothEdges, Tact}};
///
/// // 30 mm/s: the samples of a tact lie 0.015 mm before and after its position.
/// let mut edges = BothEdges::new(&Optics::default(), 30.0);
/// let mut found = None;
/// for k in -20..=20_i32 {
///     let hits = match k { -8..=6 => 2, 7 => 1, _ => 0 }; // seen from -0.495 to 0.405 mm
///     found = found.or(edges.push(Tact { position_mm: 0.06 * f64::from(k), hits, covered: None })?);
/// }
/// let line = found.unwrap();
/// assert!((line.at_mm - (-0.045)).abs() < 1e-12);
/// assert!(line.like_a_line);
/// # Ok::<(), plotter_stitch::ScanError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BothEdges {
    order: Order,
    seen_above: f64,
    /// From the middle of a tact to its samples, mm.
    offsets_mm: [f64; 2],
    /// Between two samples, mm.
    spacing_mm: f64,
    span_mm: f64,
    last_sample_mm: Option<f64>,
    dark: Option<Dark>,
}

/// What is under the head.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Dark {
    /// Half way between the last sample before it and its first, mm.
    begins_mm: f64,
    /// Its last sample, mm.
    last_mm: f64,
    /// Half way between its last sample and the first after it, mm.
    ends_mm: Option<f64>,
    /// Sums over its samples of how much they count, and of that times the place from `begins_mm`.
    sums: [f64; 2],
    /// Whether each sample so far had a number.
    has_signal: bool,
}

impl BothEdges {
    /// For a scan with that velocity, mm/s; negative towards smaller coordinates.
    #[must_use]
    pub fn new(optics: &Optics, velocity_mm_s: f64) -> Self {
        Self::with_span(optics, velocity_mm_s, optics.span_mm())
    }

    /// The same for one who has asked for [`Optics::span_mm`] before.
    #[must_use]
    pub(crate) fn with_span(optics: &Optics, velocity_mm_s: f64, span_mm: f64) -> Self {
        Self {
            order: Order::new(velocity_mm_s),
            seen_above: optics.seen_above,
            offsets_mm: optics.led_offset_s.map(|offset_s| offset_s * velocity_mm_s),
            spacing_mm: libm::fabs(velocity_mm_s * optics.tact_s) / 2.0,
            span_mm,
            last_sample_mm: None,
            dark: None,
        }
    }

    fn sample(&mut self, at_mm: f64, seen: bool, covered: Option<f64>) -> Option<Sighting> {
        let before_mm = self.last_sample_mm.unwrap_or(at_mm - self.order.sign * self.spacing_mm);
        self.last_sample_mm = Some(at_mm);
        if !seen {
            let dark = self.dark.as_mut()?;
            dark.ends_mm.get_or_insert((before_mm + at_mm) / 2.0);
            // Only what goes on after the gap makes it a flicker.
            return if libm::fabs(at_mm - dark.last_mm) > FLICKER_MM { self.finish() } else { None };
        }
        let dark = self.dark.get_or_insert(Dark {
            begins_mm: (before_mm + at_mm) / 2.0,
            last_mm: at_mm,
            ends_mm: None,
            sums: [0.0; 2],
            has_signal: true,
        });
        (dark.last_mm, dark.ends_mm) = (at_mm, None);
        dark.has_signal &= covered.is_some();
        let counts = covered.map_or(1.0, |covered| (covered - self.seen_above).max(0.0));
        dark.sums[0] += counts;
        dark.sums[1] += counts * (at_mm - dark.begins_mm);
        None
    }
}

impl FindLine for BothEdges {
    fn push(&mut self, tact: Tact) -> Result<Option<Sighting>, ScanError> {
        self.order.check(&tact)?;
        let seen = match tact.covered {
            Some(covered) => covered.map(|covered| covered > self.seen_above),
            // One hit: the line begins with the second sample, or ends with the first.
            None => match (tact.hits, self.dark.is_some_and(|dark| dark.ends_mm.is_none())) {
                (0, _) => [false, false],
                (1, false) => [false, true],
                (1, true) => [true, false],
                _ => [true, true],
            },
        };
        let mut ended = None;
        for index in 0..2 {
            let at_mm = tact.position_mm + self.offsets_mm[index];
            ended = ended.or(self.sample(at_mm, seen[index], tact.covered.map(|covered| covered[index])));
        }
        Ok(ended)
    }

    fn finish(&mut self) -> Option<Sighting> {
        let dark = self.dark.take()?;
        let ends_mm = dark.ends_mm.unwrap_or(dark.last_mm + self.order.sign * self.spacing_mm / 2.0);
        let span_mm = libm::fabs(ends_mm - dark.begins_mm);
        let like_a_line = libm::fabs(span_mm - self.span_mm) <= ROUGH_MM + self.spacing_mm;
        let [sum, moment] = dark.sums;
        let at_mm = if sum > 0.0 { dark.begins_mm + moment / sum } else { (dark.begins_mm + ends_mm) / 2.0 };
        let sigma_mm = if dark.has_signal {
            libm::hypot(CENTROID_NOISE_MM, CENTROID_SPACING * self.spacing_mm)
        } else {
            libm::hypot(EDGES_NOISE_MM, self.spacing_mm / libm::sqrt(24.0))
        };
        Some(Sighting { at_mm, span_mm, sigma_mm, like_a_line })
    }
}
