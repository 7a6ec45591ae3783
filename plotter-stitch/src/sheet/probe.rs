//! [`SensedProbe`]: what the optical head sees of the two strokes over a fold.

use super::SensorNoise;
use super::noise::Noise;
use crate::{
    FindLine, Optics, Sighting,
    fold::Seen,
    sense::{BothEdges, Tact, disc_over_line},
};

/// Speed of the scans, mm/s.
const SPEED_MM_S: f64 = 15.0;
/// From where to where they go, mm about the line's place.
const REACH_MM: f64 = 3.0;

/// A line drawn twice in simulated ink, the second time beside the first where the paper has folded.
///
/// Both strokes have rough edges ([`SensorNoise::texture_mm`]), the pen comes back to its place with
/// [`SensorNoise::servo_mm`] and [`SensorNoise::pen_mm`], and dust lies on the share [`SensorNoise::dust`] of
/// the scans.
///
/// ```
/// use plotter_stitch::{FoldTest, FoldVerdict, Optics, sheet::{SensedProbe, SensorNoise}};
///
/// let (optics, noise) = (Optics::default(), SensorNoise::default());
/// let (once, twice) = SensedProbe::new(0.5, optics, noise, 1).scans();
/// assert!(matches!(FoldTest::default().judge(&once, &twice), FoldVerdict::Fold { .. }));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SensedProbe {
    apart_mm: f64,
    optics: Optics,
    noise: SensorNoise,
    random: Noise,
}

/// How many scans there are over the line.
const SCANS: usize = crate::FoldProbe::SCANS as usize;

/// What all scans over a line saw.
type Scans = [Option<Seen>; SCANS];

impl SensedProbe {
    /// Two strokes `apart_mm` from each other, 0 on flat paper. The same seed gives the same paper and head.
    #[must_use]
    pub fn new(apart_mm: f64, optics: Optics, noise: SensorNoise, seed: u64) -> Self {
        let mut random = Noise::new(seed);
        // Neighbouring seeds shall have nothing in common.
        random = Noise::new(random.bits());
        Self { apart_mm, optics, noise, random }
    }

    /// The scans over the first stroke, and over both.
    #[must_use]
    pub fn scans(mut self) -> (Scans, Scans) {
        let [servo, _] = self.random.normals(self.noise.servo_mm);
        let [pen, _] = self.random.normals(self.noise.pen_mm);
        let second_mm = self.apart_mm + servo + pen;
        let mut both = [[None; SCANS]; 2];
        let [once, twice] = &mut both;
        for (once, twice) in once.iter_mut().zip(twice) {
            let first = self.ink(0.0);
            let second = self.ink(second_mm);
            let dust = self.dust();
            *once = self.scan(&[Some(first), None, dust]);
            *twice = self.scan(&[Some(first), Some(second), dust]);
        }
        let [once, twice] = both;
        (once, twice)
    }

    /// Both edges of a stroke.
    fn ink(&mut self, middle_mm: f64) -> [f64; 2] {
        let [left, right] = self.random.normals(self.noise.texture_mm);
        let half_mm = 0.5 * self.optics.line_mm;
        [middle_mm - half_mm + left, middle_mm + half_mm + right]
    }

    /// Dust as wide as it is, somewhere on the way.
    fn dust(&mut self) -> Option<[f64; 2]> {
        let lies_there = self.random.unit() < self.noise.dust;
        let [least_mm, most_mm] = self.noise.dust_mm;
        let width_mm = self.random.between(least_mm, most_mm);
        let begin_mm = self.random.between(-REACH_MM, REACH_MM);
        lies_there.then_some([begin_mm, begin_mm + width_mm])
    }

    fn scan(&mut self, ink: &[Option<[f64; 2]>]) -> Option<Seen> {
        let mut finder = BothEdges::new(&self.optics, SPEED_MM_S);
        let mut seen: Option<Seen> = None;
        let mut see = |sighting: Option<Sighting>| {
            if let Some(Sighting { at_mm, span_mm, .. }) = sighting {
                let (from_mm, to_mm) = (at_mm - 0.5 * span_mm, at_mm + 0.5 * span_mm);
                let all = seen.unwrap_or(Seen { from_mm, to_mm });
                seen = Some(Seen { from_mm: all.from_mm.min(from_mm), to_mm: all.to_mm.max(to_mm) });
            }
        };
        let step_mm = SPEED_MM_S * self.optics.tact_s;
        let mut position_mm = -REACH_MM - step_mm * self.random.unit();
        while position_mm < REACH_MM {
            let tact = self.tact(ink, position_mm);
            // Positions that rise by a step each are never refused.
            see(finder.push(tact).ok().flatten());
            position_mm += step_mm;
        }
        see(finder.finish());
        seen
    }

    fn tact(&mut self, ink: &[Option<[f64; 2]>], position_mm: f64) -> Tact {
        let [servo_mm, _] = self.random.normals(self.noise.servo_mm);
        let signal = self.random.normals(self.noise.signal);
        let mut hits = 0;
        for (offset_s, noise) in self.optics.led_offset_s.into_iter().zip(signal) {
            let at_mm = position_mm + servo_mm + SPEED_MM_S * (offset_s - self.optics.latency_s);
            hits += u8::from(self.covered(ink, at_mm) + noise > self.optics.seen_above);
        }
        Tact { position_mm, hits, covered: None }
    }

    /// Share of the disc that is covered by any of the strips.
    fn covered(&self, ink: &[Option<[f64; 2]>], at_mm: f64) -> f64 {
        let mut strips: [[f64; 2]; 3] = [[f64::INFINITY; 2]; 3];
        for (slot, strip) in strips.iter_mut().zip(ink.iter().flatten()) {
            *slot = *strip;
        }
        strips.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let mut covered = 0.0;
        let mut until_mm = f64::NEG_INFINITY;
        for [from_mm, to_mm] in strips.into_iter().filter(|strip| strip[0].is_finite()) {
            // What an earlier strip covers counts once.
            let from_mm = from_mm.max(until_mm);
            if to_mm > from_mm {
                covered += disc_over_line(self.optics.disc_mm, from_mm - at_mm, to_mm - at_mm);
                until_mm = to_mm;
            }
        }
        covered
    }
}
