//! What the optical head would see at one joint: rough ink, an unsteady head, dust, marks that are not there.

use super::noise::Noise;
use crate::{
    Crossing, FrameTransform, Optics, Search,
    sense::{Ask, SearchError, Tact, disc_over_line},
};
use alloc::vec::Vec;
use core::f64::consts::PI;
use plotter_motion::{Axis, Point, Segment, Vec2};

/// How far the simulated sensing is from an ideal one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct SensorNoise {
    /// Texture of the paper: standard deviation of where either edge of a mark lies at a crossing, mm. It is
    /// the same in each pass.
    pub texture_mm: f64,
    /// Standard deviation of where the head is in a tact, from where it is said to be, mm.
    pub servo_mm: f64,
    /// Offset of the pen from the optical head, in each direction: standard deviation from joint to joint,
    /// mm. All marks of a frame have it in common.
    pub pen_mm: f64,
    /// Standard deviation of a whole mark at a crossing, each for itself, mm.
    pub mark_mm: f64,
    /// Standard deviation of the detector's signal, in shares of the disc. At a fifth of the threshold (0.02)
    /// one joint in two thousand has a sample that sees a line on blank paper.
    pub signal: f64,
    /// Whether the detector gives that signal; otherwise only how often a line was seen.
    pub gives_signal: bool,
    /// Share of the crossings whose mark is missing.
    pub missed: f64,
    /// Share of the crossings with a grain of dust on the way.
    pub dust: f64,
    /// Dust lies within this distance from the mark's place if the sheet had not moved, mm.
    pub dust_within_mm: f64,
    /// Smallest and greatest diameter of dust, mm.
    pub dust_mm: [f64; 2],
}

impl Default for SensorNoise {
    /// Paper, servo and pen 0.02, 0.01 and 0.01 mm, all marks there, no dust, a quiet detector that only
    /// counts: what the results are measured with.
    fn default() -> Self {
        Self {
            texture_mm: 0.02,
            servo_mm: 0.01,
            pen_mm: 0.01,
            mark_mm: 0.0,
            signal: 0.0,
            gives_signal: false,
            missed: 0.0,
            dust: 0.0,
            dust_within_mm: 12.0,
            dust_mm: [0.2, 0.6],
        }
    }
}

impl SensorNoise {
    /// Nothing disturbs.
    #[must_use]
    pub fn none() -> Self {
        Self { texture_mm: 0.0, servo_mm: 0.0, pen_mm: 0.0, ..Self::default() }
    }
}

/// One joint: a sheet that lies somehow, with the marks of the frame before on it, under the head.
///
/// ```
/// use plotter_motion::Vec2;
/// use plotter_stitch::{FrameTransform, MarkSearch, Optics, ReferenceLines, RigidFit};
/// use plotter_stitch::sense::SearchSettings;
/// use plotter_stitch::sheet::{SensedJoint, SensorNoise};
///
/// let crossings: Vec<_> = ReferenceLines::strip16().crossings().collect();
/// let sheet = FrameTransform::new(0.0015, Vec2::new(-3.0, 4.0))?;
/// let mut joint = SensedJoint::new(&crossings, &sheet, Optics::default(), SensorNoise::default(), 7);
///
/// let mut search = MarkSearch::new(&crossings, SearchSettings::default());
/// joint.run(&mut search)?;
/// let estimate = RigidFit::default().estimate(&crossings, search.found()?)?;
/// assert_eq!(estimate.inlier_count(), 16);
/// assert!((estimate.transform.angle_rad() - 0.0015).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SensedJoint {
    optics: Optics,
    noise: SensorNoise,
    places: Vec<Place>,
    /// The drawing's own lines near each scan; empty where there is no drawing.
    ways: Vec<Way>,
    pen: Vec2,
    random: Noise,
}

/// Lines of the drawing near a scan, in the machine's coordinates.
#[derive(Clone, Debug, PartialEq)]
struct Way {
    axis: Axis,
    scan_at_mm: f64,
    lines: Vec<Segment>,
}

/// Lines this near to a mark along its scan are kept: a search begins 50 mm before it, mm.
const WAY_MM: f64 = 120.0;

/// What lies on the way of one scan.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    /// Both edges of the ink, mm along the scan.
    ink_mm: Option<[f64; 2]>,
    dust: Option<Dust>,
}

/// A round grain.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Dust {
    along_mm: f64,
    beside_mm: f64,
    radius_mm: f64,
}

impl SensedJoint {
    /// A joint whose sheet lies so. The same seed makes the same paper, dust and head.
    #[must_use]
    pub fn new(
        crossings: &[Crossing],
        sheet: &FrameTransform,
        optics: Optics,
        noise: SensorNoise,
        seed: u64,
    ) -> Self {
        let mut random = Noise::new(seed);
        // Neighbouring seeds shall have nothing in common.
        random = Noise::new(random.bits());
        let [x, y] = random.normals(noise.pen_mm);
        let pen = Vec2::new(x, y);
        let places = crossings.iter().map(|crossing| {
            let offset_mm = match crossing.axis {
                Axis::X => pen.x,
                Axis::Y => pen.y,
            };
            let centre_mm = crossing.place_mm(sheet) + offset_mm + random.normals(noise.mark_mm)[0];
            let [first_mm, second_mm] = random.normals(noise.texture_mm);
            let ink_mm =
                [centre_mm - optics.line_mm / 2.0 + first_mm, centre_mm + optics.line_mm / 2.0 + second_mm];
            let is_missed = random.unit() < noise.missed;
            let has_dust = random.unit() < noise.dust;
            let radius_mm = random.between(noise.dust_mm[0], noise.dust_mm[1]) / 2.0;
            let dust = Dust {
                along_mm: crossing.mark_mm + random.between(-noise.dust_within_mm, noise.dust_within_mm),
                // It touches the middle half of the disc, so that it is seen.
                beside_mm: random.between(-0.25, 0.25) * optics.disc_mm,
                radius_mm,
            };
            Place { ink_mm: (!is_missed).then_some(ink_mm), dust: has_dust.then_some(dust) }
        });
        let places = places.collect();
        Self { optics, noise, places, ways: Vec::new(), pen, random }
    }

    /// The same joint with the frame's own lines on the sheet, as [`DrawnStrip`](crate::marks::DrawnStrip)
    /// has them.
    #[must_use]
    pub fn with_drawing(mut self, crossings: &[Crossing], sheet: &FrameTransform, lines: &[Segment]) -> Self {
        let near_mm = self.optics.disc_mm + self.optics.line_mm;
        self.ways = crossings
            .iter()
            .map(|crossing| {
                let place = |along_mm: f64| match crossing.axis {
                    Axis::X => Point::new(along_mm, crossing.scan_at_mm),
                    Axis::Y => Point::new(crossing.scan_at_mm, along_mm),
                };
                let scan = Segment::new(place(crossing.mark_mm - WAY_MM), place(crossing.mark_mm + WAY_MM));
                let on_machine = lines.iter().map(|line| {
                    Segment::new(sheet.to_machine(line.from) + self.pen, sheet.to_machine(line.to) + self.pen)
                });
                let lines = on_machine.filter(|line| is_near(line, &scan, near_mm)).collect();
                Way { axis: crossing.axis, scan_at_mm: crossing.scan_at_mm, lines }
            })
            .collect();
        self
    }

    /// Share of the disc that the drawing's lines cover.
    fn drawn(&self, crossing: usize, at_mm: f64) -> f64 {
        let Some(way) = self.ways.get(crossing) else { return 0.0 };
        let head = match way.axis {
            Axis::X => Point::new(at_mm, way.scan_at_mm),
            Axis::Y => Point::new(way.scan_at_mm, at_mm),
        };
        let half_mm = self.optics.line_mm / 2.0;
        let covered = way.lines.iter().map(|line| {
            // A short line is taken for a long one where the head is beside it; beyond its ends its round cap
            // is a strip as well.
            let apart_mm = line.distance(head);
            disc_over_line(self.optics.disc_mm, apart_mm - half_mm, apart_mm + half_mm)
        });
        // Pieces of one stroke meet: what one covers the next one does not cover again.
        covered.fold(0.0, f64::max)
    }

    /// What the head sees in a tact over one of the crossings; at one that is not there it sees blank paper.
    pub fn tact(&mut self, crossing: usize, position_mm: f64, velocity_mm_s: f64) -> Tact {
        let place = self.places.get(crossing).copied().unwrap_or(Place { ink_mm: None, dust: None });
        let servo_mm = self.random.normals(self.noise.servo_mm)[0];
        let signal = self.random.normals(self.noise.signal);
        let covered = [0, 1].map(|led: usize| {
            // The noted position is that of a moment later.
            let delay_s = self.optics.led_offset_s[led] - self.optics.latency_s;
            let at_mm = position_mm + servo_mm + velocity_mm_s * delay_s;
            (self.covered(&place, at_mm) + self.drawn(crossing, at_mm)).min(1.0) + signal[led]
        });
        let hits = covered.map(|covered| u8::from(covered > self.optics.seen_above));
        Tact { position_mm, hits: hits[0] + hits[1], covered: self.noise.gives_signal.then_some(covered) }
    }

    fn covered(&self, place: &Place, at_mm: f64) -> f64 {
        let ink = place
            .ink_mm
            .map_or(0.0, |[from, to]| disc_over_line(self.optics.disc_mm, from - at_mm, to - at_mm));
        let dust = place.dust.map_or(0.0, |dust| {
            let apart_mm = libm::hypot(dust.along_mm - at_mm, dust.beside_mm);
            let radius_mm = self.optics.disc_mm / 2.0;
            common_area(radius_mm, dust.radius_mm, apart_mm) / (PI * radius_mm * radius_mm)
        });
        (ink + dust).min(1.0)
    }

    /// Does what a search asks for until it is done.
    ///
    /// # Errors
    ///
    /// What the search says.
    pub fn run(&mut self, search: &mut impl Search) -> Result<(), SearchError> {
        // The head is never exactly in phase with the marks.
        let phase = self.random.unit();
        loop {
            let ask = search.ask();
            let Ask::Scan { crossing, from, axis, to_mm, velocity_mm_s } = ask else {
                if ask == Ask::Done {
                    return Ok(());
                }
                search.arrived()?;
                continue;
            };
            let from_mm = match axis {
                Axis::X => from.x,
                Axis::Y => from.y,
            };
            let step_mm = velocity_mm_s * self.optics.tact_s;
            let mut position_mm = from_mm + phase * step_mm;
            while search.ask() == ask && (to_mm - position_mm) * step_mm > 0.0 {
                search.tact(self.tact(crossing, position_mm, velocity_mm_s))?;
                position_mm += step_mm;
            }
            search.arrived()?;
        }
    }
}

/// Whether two lines come so near to each other that the boxes around them do.
fn is_near(line: &Segment, scan: &Segment, near_mm: f64) -> bool {
    let apart = |a: [f64; 2], b: [f64; 2]| a[0].min(a[1]) - b[0].max(b[1]);
    let ([ax, ay], [bx, by]) = (ends(line), ends(scan));
    apart(ax, bx).max(apart(bx, ax)).max(apart(ay, by)).max(apart(by, ay)) <= near_mm
}

/// Both ends' x, and both ends' y.
fn ends(line: &Segment) -> [[f64; 2]; 2] {
    [[line.from.x, line.to.x], [line.from.y, line.to.y]]
}

/// Area that two discs have in common, mm².
///
/// Source: the lens of two circles, <https://mathworld.wolfram.com/Circle-CircleIntersection.html>,
/// equation 14.
fn common_area(r: f64, s: f64, apart: f64) -> f64 {
    if apart >= r + s {
        return 0.0;
    }
    let smaller = r.min(s);
    if apart <= libm::fabs(r - s) {
        return PI * smaller * smaller;
    }
    let angle =
        |a: f64, b: f64| libm::acos(((apart * apart + a * a - b * b) / (2.0 * apart * a)).clamp(-1.0, 1.0));
    let kite = (-apart + r + s) * (apart + r - s) * (apart - r + s) * (apart + r + s);
    r * r * angle(r, s) + s * s * angle(s, r) - libm::sqrt(kite.max(0.0)) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_share_a_lens() {
        /// Rounding of some twenty operations on numbers near 1.
        const ROUNDING: f64 = 1e-14;
        assert_eq!(common_area(1.0, 1.0, 2.0), 0.0);
        assert_eq!(common_area(1.0, 0.5, 0.2), PI / 4.0);
        // Two unit circles through each other's centre share 2π/3 - √3/2.
        assert!((common_area(1.0, 1.0, 1.0) - (2.0 * PI / 3.0 - 3.0_f64.sqrt() / 2.0)).abs() < ROUNDING);
    }

    #[test]
    fn without_noise_the_signal_is_the_covered_share() {
        let crossing = Crossing { axis: Axis::X, mark_mm: 20.0, scan_at_mm: 0.0 };
        let optics = Optics { latency_s: 0.0, ..Optics::default() };
        let noise = SensorNoise { gives_signal: true, ..SensorNoise::none() };
        let mut joint = SensedJoint::new(&[crossing], &FrameTransform::IDENTITY, optics, noise, 0);
        // At 300 mm/s the samples lie 0.15 mm before and after the position: the first on the mark, the
        // second 0.3 mm off.
        let tact = joint.tact(0, 20.15, 300.0);
        assert_eq!(tact.hits, 2);
        let [first, second] = tact.covered.unwrap();
        assert!((first - disc_over_line(0.6, -0.25, 0.25)).abs() < 1e-9);
        assert!((second - disc_over_line(0.6, -0.55, -0.05)).abs() < 1e-9);
        assert_eq!(
            joint.tact(0, 22.0, 300.0),
            Tact { position_mm: 22.0, hits: 0, covered: Some([0.0, 0.0]) }
        );
        assert_eq!(joint.tact(1, 20.0, 300.0).hits, 0);
    }
}
