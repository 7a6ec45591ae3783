//! Many simulated joints, by the published method and by ours.

#![allow(dead_code, unreachable_pub, reason = "each test takes what it needs")]

use plotter_motion::{Axis, Point, Vec2};
use plotter_stitch::{
    Crossing, FrameTransform, JointEstimate, MarkSearch, Optics, ReferenceLines, RigidFit,
    sense::{PublishedSearch, SearchSettings},
    sheet::{SensedJoint, SensorNoise},
};

/// Greatest rotation of a sheet, rad, and greatest error of rewinding, mm (source, section II).
const ANGLE_RAD: f64 = 0.002;
const SHIFT_MM: f64 = 5.0;

/// Five points of the border, from end to end.
const BORDER: [Point; 5] = [
    Point::new(10.0, 20.0),
    Point::new(505.0, 20.0),
    Point::new(1000.0, 20.0),
    Point::new(1495.0, 20.0),
    Point::new(1990.0, 20.0),
];

/// Marsaglia's xorshift: how the sheets lie.
fn unit(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// How the sheet of one joint lies: any rotation and shift that the source met.
pub fn sheet(joint: u64) -> FrameTransform {
    let mut state = (joint + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    for _ in 0..3 {
        unit(&mut state);
    }
    let mut up_to = |most: f64| most * (2.0 * unit(&mut state) - 1.0);
    FrameTransform::new(up_to(ANGLE_RAD), Vec2::new(up_to(SHIFT_MM), up_to(SHIFT_MM))).unwrap()
}

/// Greatest distance on the border between where lines should meet and where they do, mm.
pub fn discrepancy_mm(truth: &FrameTransform, told: &FrameTransform) -> f64 {
    BORDER
        .map(|place| truth.to_machine(place).distance(told.to_machine(place)))
        .into_iter()
        .fold(0.0, f64::max)
}

fn ends_mm2(truth: &FrameTransform, told: &FrameTransform) -> f64 {
    let square = |place: Point| truth.to_machine(place).distance(told.to_machine(place)).powi(2);
    (square(BORDER[0]) + square(BORDER[4])) / 2.0
}

/// Squares of the errors of angle and shifts, each over its variance, and of all three over their covariance.
pub fn normalized(truth: &FrameTransform, estimate: &JointEstimate) -> [f64; 4] {
    let c = nine(&estimate.covariance);
    let told = &estimate.transform;
    let e = [
        told.angle_rad() - truth.angle_rad(),
        told.shift().x - truth.shift().x,
        told.shift().y - truth.shift().y,
    ];
    // Scaled to one size, then Cramer's rule.
    let s = [c[0], c[4], c[8]].map(f64::sqrt);
    let z = [e[0] / s[0], e[1] / s[1], e[2] / s[2]];
    let (a, b, d) = (c[1] / s[0] / s[1], c[2] / s[0] / s[2], c[5] / s[1] / s[2]);
    let det = 1.0 + 2.0 * a * b * d - a * a - b * b - d * d;
    let all = ((1.0 - d * d) * z[0] * z[0]
        + (1.0 - b * b) * z[1] * z[1]
        + (1.0 - a * a) * z[2] * z[2]
        + 2.0 * ((b * d - a) * z[0] * z[1] + (a * d - b) * z[0] * z[2] + (a * b - d) * z[1] * z[2]))
        / det;
    [z[0] * z[0], z[1] * z[1], z[2] * z[2], all]
}

fn nine(c: &[[f64; 3]; 3]) -> [f64; 9] {
    core::array::from_fn(|i| c[i / 3][i % 3])
}

/// What one method made of a joint; none if it told nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told {
    pub discrepancy_mm: f64,
    /// Mean of the squares at both ends of the border, mm².
    pub ends_mm2: f64,
    pub normalized: [f64; 4],
    pub inliers: u32,
}

/// The published method on one joint.
pub fn published(joint: u64, noise: SensorNoise) -> Option<Told> {
    let crossings: Vec<Crossing> = ReferenceLines::published().crossings().collect();
    let truth = sheet(joint);
    let mut sensed = SensedJoint::new(&crossings, &truth, Optics::default(), noise, joint);
    let mut search =
        PublishedSearch::new([crossings[0], crossings[1], crossings[2], crossings[3]], Optics::default());
    sensed.run(&mut search).ok()?;
    let told = FrameTransform::from_readings(&search.readings().ok()?).ok()?;
    Some(Told { discrepancy_mm: discrepancy_mm(&truth, &told), ..Told::default() })
}

/// Ours on one joint.
pub fn ours(joint: u64, crossings: &[Crossing], noise: SensorNoise, fit: &RigidFit) -> Option<Told> {
    let truth = sheet(joint);
    let mut sensed = SensedJoint::new(crossings, &truth, Optics::default(), noise, joint);
    let mut search = MarkSearch::new(crossings, SearchSettings::default());
    sensed.run(&mut search).ok()?;
    let estimate = fit.estimate(crossings, search.found().ok()?).ok()?;
    Some(Told {
        discrepancy_mm: discrepancy_mm(&truth, &estimate.transform),
        ends_mm2: ends_mm2(&truth, &estimate.transform),
        normalized: normalized(&truth, &estimate),
        inliers: estimate.inlier_count(),
    })
}

/// The same for many joints, on both cores.
pub fn many(joints: u64, each: impl Fn(u64) -> Option<Told> + Sync) -> Outcome {
    let halves = [0, joints / 2, joints];
    let told: Vec<Option<Told>> = std::thread::scope(|scope| {
        let threads: Vec<_> = halves
            .windows(2)
            .map(|range| {
                let (from, to, each) = (range[0], range[1], &each);
                scope.spawn(move || (from..to).map(each).collect::<Vec<_>>())
            })
            .collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    Outcome::of(&told)
}

/// What many joints came to.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    pub joints: usize,
    pub silent: usize,
    /// More than 0.5 mm off.
    pub wrong: usize,
    pub rms_mm: f64,
    /// Of the places at both ends of the border.
    pub ends_rms_mm: f64,
    pub p99_mm: f64,
    pub max_mm: f64,
    /// Means of the normalized squares: 1, 1, 1 and 3 if the covariance is honest.
    pub normalized: [f64; 4],
    /// Share of joints whose error is within what 95 % of them should be (chi-square of 3: 7.815).
    pub within95: f64,
}

impl Outcome {
    fn of(told: &[Option<Told>]) -> Self {
        let answers: Vec<&Told> = told.iter().flatten().collect();
        let mut sorted: Vec<f64> = answers.iter().map(|told| told.discrepancy_mm).collect();
        sorted.sort_by(f64::total_cmp);
        let count = sorted.len().max(1) as f64;
        let mean = |value: &dyn Fn(&Told) -> f64| answers.iter().map(|told| value(told)).sum::<f64>() / count;
        Self {
            joints: told.len(),
            silent: told.len() - answers.len(),
            wrong: sorted.iter().filter(|mm| **mm > 0.5).count(),
            rms_mm: mean(&|told| told.discrepancy_mm.powi(2)).sqrt(),
            ends_rms_mm: mean(&|told| told.ends_mm2).sqrt(),
            p99_mm: sorted.get(sorted.len() * 99 / 100).copied().unwrap_or(f64::NAN),
            max_mm: sorted.last().copied().unwrap_or(f64::NAN),
            normalized: core::array::from_fn(|i| mean(&|told| told.normalized[i])),
            within95: mean(&|told| f64::from(told.normalized[3] < 7.815)),
        }
    }
}

impl core::fmt::Display for Outcome {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let share = |count: usize| 100.0 * count as f64 / self.joints as f64;
        write!(
            f,
            "rms {:.4} p99 {:.4} max {:.4} mm, no answer {:.3} %, over 0.5 mm {:.3} % ({})",
            self.rms_mm,
            self.p99_mm,
            self.max_mm,
            share(self.silent),
            share(self.wrong),
            self.wrong,
        )?;
        let [angle, x, y, all] = self.normalized;
        if all > 0.0 {
            let share = 100.0 * self.within95;
            write!(f, ", z² {angle:.2} {x:.2} {y:.2} all {:.2}, {share:.1} % within 95 %", all / 3.0)?;
        }
        Ok(())
    }
}

/// The least mean square of any unbiased estimate at the border's ends, mm² (Cramér and Rao): each crossing
/// is known to `place_mm`, and all have an offset of `common_mm` in common.
pub fn least_mean_square_mm2(crossings: &[Crossing], place_mm: f64, common_mm: f64) -> f64 {
    // At the ends of the border, from the information of the three unknowns; the slopes at an unturned sheet.
    let mut n = [[0.0_f64; 3]; 3];
    for crossing in crossings {
        let slope = match crossing.axis {
            Axis::X => [-crossing.scan_at_mm / 1e3, 1.0, 0.0],
            Axis::Y => [crossing.scan_at_mm / 1e3, 0.0, 1.0],
        };
        for i in 0..3 {
            for j in 0..3 {
                n[i][j] += slope[i] * slope[j] / (place_mm * place_mm);
            }
        }
    }
    let solve = |v: [f64; 3]| {
        // Gauss with the pivot on the diagonal: the matrix is positive.
        let mut m = n;
        let mut b = v;
        for i in 0..3 {
            for k in i + 1..3 {
                let (pivot, f) = (m[i], m[k][i] / m[i][i]);
                for (entry, pivot) in m[k].iter_mut().zip(pivot) {
                    *entry -= f * pivot;
                }
                b[k] -= f * b[i];
            }
        }
        for i in (0..3).rev() {
            for j in i + 1..3 {
                b[i] -= m[i][j] * b[j];
            }
            b[i] /= m[i][i];
        }
        v.iter().zip(b).map(|(v, b)| v * b).sum::<f64>()
    };
    let at = |place: Point| {
        solve([-place.y / 1e3, 1.0, 0.0]) + solve([place.x / 1e3, 0.0, 1.0]) + 2.0 * common_mm * common_mm
    };
    (at(BORDER[0]) + at(BORDER[4])) / 2.0
}
