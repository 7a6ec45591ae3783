//! Where a scan crosses a mark, and what was found there.

use crate::{FrameTransform, Optics, Sighting};
use plotter_motion::Axis;

/// Two passes that see the same line see it this near to each other, mm: seven times what two slow passes
/// differ by.
const SAME_MM: f64 = 0.15;

/// What a fast pass saw this near to something that a slow pass saw is the same thing, mm: a line's own width
/// and a tact's half.
const NEAR_MM: f64 = 0.8;

/// A pass is a slow one if there is another that is faster by this factor.
const SLOWER: f64 = 2.0;

/// A delay that is known to a third, mm/s to mm: what is left of it in a line that was passed only one way.
const DELAY_LEFT: f64 = 0.33;

/// One scan over one mark.
///
/// ```text
///        y ▲        mark: local x = mark_mm
///          │           ┃
///   scan_at├┄┄┄┄┄┄┄┄┄┄┄╂┄┄┄┄▶ scan along the machine's x
///          │           ┃
///          └────────────────▶ x
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Crossing {
    /// The direction of the scan, and the coordinate by which the mark is known: a scan along x crosses a
    /// line of constant x.
    pub axis: Axis,
    /// That coordinate in the frame about to be drawn, mm.
    pub mark_mm: f64,
    /// The machine's other coordinate, which stands still during the scan, mm.
    pub scan_at_mm: f64,
}

impl Crossing {
    /// Where along the scan the mark lies, mm, if the sheet lies so.
    ///
    /// ```text
    /// along x: x = a / cos α - (v - sy) tan α + sx     for the mark x = a, scanned at y = v
    /// along y: y = b / cos α + (u - sx) tan α + sy     for the mark y = b, scanned at x = u
    /// ```
    ///
    /// ```
    /// # use plotter_motion::{Axis, Vec2};
    /// # use plotter_stitch::{Crossing, FrameTransform};
    /// let crossing = Crossing { axis: Axis::X, mark_mm: 20.0, scan_at_mm: 500.0 };
    /// let turned = FrameTransform::new(0.002, Vec2::new(3.0, 0.0))?;
    /// // A turn of 0.002 rad carries a place 500 mm up by 1 mm to the left.
    /// assert!((crossing.place_mm(&turned) - 22.0).abs() < 1e-4);
    /// # Ok::<(), plotter_stitch::joint::TransformError>(())
    /// ```
    #[must_use]
    pub fn place_mm(&self, sheet: &FrameTransform) -> f64 {
        let (cos, tan) = (libm::cos(sheet.angle_rad()), libm::tan(sheet.angle_rad()));
        let shift = sheet.shift();
        match self.axis {
            Axis::X => self.mark_mm / cos - (self.scan_at_mm - shift.y) * tan + shift.x,
            Axis::Y => self.mark_mm / cos + (self.scan_at_mm - shift.x) * tan + shift.y,
        }
    }
}

/// A place at which a mark may lie.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Found {
    /// Which of the crossings, counted from 0. Of several places found at one, at most one is taken to be the
    /// mark.
    pub crossing: usize,
    /// Machine coordinate along the scan, mm.
    pub at_mm: f64,
    /// Standard deviation of `at_mm` from the sampling alone, mm.
    pub sigma_mm: f64,
}

/// What one pass over a crossing saw, and how fast it went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// Velocity of the head along the scan, mm/s; negative towards smaller coordinates.
    pub velocity_mm_s: f64,
    /// What it saw.
    pub sighting: Sighting,
}

/// The places at which the mark of a crossing may lie, from all that its passes saw.
///
/// What a slow pass saw each way becomes one place, the mean, in which the head's delay cancels. Of one way
/// only it is one too, with the known delay taken off. What a fast pass saw counts only where no slow pass
/// went: the slow ones may have been sent to a grain of dust while the mark lies elsewhere. What was not seen
/// for as long as a line is left out.
///
/// ```
/// # use plotter_stitch::{Optics, Sighting, sense::{Passed, found_at}};
/// let seen = |velocity_mm_s, at_mm| Passed {
///     velocity_mm_s,
///     sighting: Sighting { at_mm, span_mm: 0.91, sigma_mm: 0.004, like_a_line: true },
/// };
/// let passes = [seen(300.0, 20.05), seen(30.0, 20.0115), seen(-30.0, 20.0085)];
/// let found: Vec<_> = found_at(3, &Optics::default(), &passes).collect();
/// assert_eq!(found.len(), 1);
/// assert_eq!(found[0].crossing, 3);
/// assert!((found[0].at_mm - 20.01).abs() < 1e-12);
/// ```
pub fn found_at<'a>(
    crossing: usize,
    optics: &'a Optics,
    passes: &'a [Passed],
) -> impl Iterator<Item = Found> + 'a {
    places(crossing, Delays::known(optics), passes)
}

/// Delay from a sample to the position that is noted for it, s: going up, and going down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Delays {
    pub(crate) up_s: f64,
    pub(crate) down_s: f64,
    /// How well that is known, s.
    pub(crate) sigma_s: f64,
}

impl Delays {
    /// What the optics say, known to a third.
    pub(crate) fn known(optics: &Optics) -> Self {
        Self {
            up_s: optics.latency_s,
            down_s: optics.latency_s,
            sigma_s: DELAY_LEFT * libm::fabs(optics.latency_s),
        }
    }

    fn of(&self, velocity_mm_s: f64) -> f64 {
        if velocity_mm_s < 0.0 { self.down_s } else { self.up_s }
    }
}

/// The places at one crossing, from passes whose delays are known.
pub(crate) fn places<'a>(
    crossing: usize,
    delays: Delays,
    passes: &'a [Passed],
) -> impl Iterator<Item = Found> + 'a {
    let fastest_mm_s = passes.iter().map(|pass| libm::fabs(pass.velocity_mm_s)).fold(0.0, f64::max);
    let slowest_mm_s = passes.iter().map(|pass| libm::fabs(pass.velocity_mm_s)).fold(fastest_mm_s, f64::min);
    let is_slow = move |pass: &Passed| {
        fastest_mm_s < slowest_mm_s * SLOWER || libm::fabs(pass.velocity_mm_s) * SLOWER <= fastest_mm_s
    };
    let place_mm =
        move |pass: &Passed| pass.sighting.at_mm - pass.velocity_mm_s * delays.of(pass.velocity_mm_s);
    passes.iter().enumerate().filter(|(_, pass)| pass.sighting.like_a_line).filter_map(
        move |(index, pass)| {
            let alone = |pass: &Passed| Found {
                crossing,
                at_mm: place_mm(pass),
                sigma_mm: libm::hypot(
                    pass.sighting.sigma_mm,
                    delays.sigma_s * libm::fabs(pass.velocity_mm_s),
                ),
            };
            let apart_mm = |other: &Passed| libm::fabs(place_mm(other) - place_mm(pass));
            if !is_slow(pass) {
                let was_visited = passes.iter().any(|other| is_slow(other) && apart_mm(other) < NEAR_MM);
                return (!was_visited).then(|| alone(pass));
            }
            // All slow passes that saw it, and the first of them speaks for all.
            let same =
                |other: &&Passed| is_slow(other) && other.sighting.like_a_line && apart_mm(other) < SAME_MM;
            if passes.iter().take(index).any(|other| same(&other)) {
                return None;
            }
            let means = [false, true].map(|back| {
                let (mut sum_mm, mut sum_sigma_mm, mut count) = (0.0, 0.0, 0.0);
                for other in passes.iter().filter(same).filter(|other| (other.velocity_mm_s < 0.0) == back) {
                    sum_mm += place_mm(other);
                    sum_sigma_mm += other.sighting.sigma_mm;
                    count += 1.0;
                }
                (count > 0.0).then(|| (sum_mm / count, sum_sigma_mm / count))
            });
            Some(match means {
                [Some((forth_mm, forth_sigma_mm)), Some((back_mm, back_sigma_mm))] => Found {
                    crossing,
                    at_mm: (forth_mm + back_mm) / 2.0,
                    sigma_mm: libm::hypot(forth_sigma_mm, back_sigma_mm) / 2.0,
                },
                _ => alone(pass),
            })
        },
    )
}
