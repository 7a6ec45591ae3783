//! What lies on the paper along one scan, and how much of the detector's light it takes.

use plotter_motion::{Axis, Point, Vec2};
use plotter_stitch::{Crossing, ReferenceLines};

/// A straight stroke in the coordinates of the marks.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    from: Point,
    /// Of length 1.
    along: Vec2,
    length_mm: f64,
}

impl Stroke {
    pub fn new(from: Point, to: Point) -> Self {
        let way = to - from;
        Self { from, along: way * (1.0 / way.length()), length_mm: way.length() }
    }

    /// A mark: 10 mm to both sides of its crossing.
    pub fn mark(crossing: &Crossing) -> Self {
        let (at, scan) = (crossing.mark_mm, crossing.scan_at_mm);
        match crossing.axis {
            Axis::X => Self::new(Point::new(at, scan - 10.0), Point::new(at, scan + 10.0)),
            Axis::Y => Self::new(Point::new(scan - 10.0, at), Point::new(scan + 10.0, at)),
        }
    }

    /// Straight strokes beside the marks of one axis, one beside each row of them: from beyond the first to
    /// beyond the last, and farther from them by `slant_mm` at their end.
    pub fn beside(lines: &ReferenceLines, axis: Axis, beside_mm: f64, slant_mm: f64) -> Vec<Self> {
        Self::beside_each(lines, axis, || [beside_mm, slant_mm])
    }

    /// The same with a distance and a slant for each row.
    pub fn beside_each(lines: &ReferenceLines, axis: Axis, mut by_mm: impl FnMut() -> [f64; 2]) -> Vec<Self> {
        // Marks within this distance are one row, whatever pattern they have in it, mm.
        const ROW_MM: f64 = 14.0;
        let mut rows: Vec<Vec<Crossing>> = Vec::new();
        for crossing in lines.crossings().filter(|crossing| crossing.axis == axis) {
            match rows.iter_mut().find(|row| (row[0].mark_mm - crossing.mark_mm).abs() < ROW_MM) {
                Some(row) => row.push(crossing),
                None => rows.push(vec![crossing]),
            }
        }
        let stroke = |row: &Vec<Crossing>| {
            let [beside_mm, slant_mm] = by_mm();
            let at_mm =
                row.iter().map(|crossing| crossing.mark_mm).sum::<f64>() / row.len() as f64 + beside_mm;
            let scans = row.iter().map(|crossing| crossing.scan_at_mm);
            let from_mm = scans.clone().fold(f64::INFINITY, f64::min) - 15.0;
            let to_mm = scans.fold(f64::NEG_INFINITY, f64::max) + 15.0;
            match axis {
                Axis::X => Self::new(Point::new(at_mm, from_mm), Point::new(at_mm + slant_mm, to_mm)),
                Axis::Y => Self::new(Point::new(from_mm, at_mm), Point::new(to_mm, at_mm + slant_mm)),
            }
        };
        rows.iter().map(stroke).collect()
    }

    /// A copy of each mark of an axis, that far beside it: what no drawing does, and the worst of all.
    pub fn copies(lines: &ReferenceLines, axis: Axis, beside_mm: f64) -> Vec<Self> {
        let copy =
            |crossing| Self::mark(&Crossing { mark_mm: crossing_mm(&crossing) + beside_mm, ..crossing });
        lines.crossings().filter(|crossing| crossing.axis == axis).map(copy).collect()
    }

    /// On which side of it a place lies, mm.
    pub fn side(&self, place: Point) -> f64 {
        self.along.cross(place - self.from)
    }

    /// Whether it goes so far.
    pub fn covers(&self, place: Point) -> bool {
        (0.0..=self.length_mm).contains(&(place - self.from).dot(self.along))
    }

    /// How much wider a scan sees it than one straight across.
    pub fn widened(&self, scan: Axis) -> f64 {
        let across = match scan {
            Axis::X => self.along.y,
            Axis::Y => self.along.x,
        };
        1.0 / across.abs().max(0.05)
    }
}

fn crossing_mm(crossing: &Crossing) -> f64 {
    crossing.mark_mm
}

/// What the detector sees at one moment: a soft round spot, brightest in its middle as light that is not
/// quite in focus is, and a comparator.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    radius_mm: f64,
    /// Share of the light that must be missing.
    threshold: f64,
}

impl Default for Spot {
    /// Seen from 0.20 mm beside a line's edge on, about where the published disc sees it.
    fn default() -> Self {
        Self { radius_mm: 0.36, threshold: 0.08 }
    }
}

impl Spot {
    pub fn sees(&self, trace: &Trace, at_mm: f64) -> bool {
        trace.darkness(self, at_mm) > self.threshold
    }

    /// Share of the light that falls left of a place, for a brightness 1 - (r/R)²: the integral of (1 -
    /// u²)^(3/2).
    fn left_of(&self, mm: f64) -> f64 {
        let u = (mm / self.radius_mm).clamp(-1.0, 1.0);
        let root = (1.0 - u * u).sqrt();
        0.5 + (u * root * root * root / 4.0 + 0.375 * (u * root + u.asin())) / (0.375 * std::f64::consts::PI)
    }
}

/// Ink and dust along one scan.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// From, to, how dark.
    strips: Vec<[f64; 3]>,
    /// Where, its radius, how far beside the scan.
    grains: Vec<[f64; 3]>,
}

/// A smear fades in so many steps.
const SMEAR_STEPS: u32 = 4;

impl Trace {
    pub fn line(&mut self, [from_mm, to_mm]: [f64; 2], smear_mm: f64) {
        self.strips.push([from_mm, to_mm, 1.0]);
        let edge_mm = if smear_mm < 0.0 { from_mm } else { to_mm };
        let step_mm = smear_mm / f64::from(SMEAR_STEPS);
        for step in 0..SMEAR_STEPS {
            if smear_mm == 0.0 {
                return;
            }
            let (one, other) = (edge_mm + step_mm * f64::from(step), edge_mm + step_mm * f64::from(step + 1));
            let dark = 0.8 - 0.6 * f64::from(step) / f64::from(SMEAR_STEPS - 1);
            self.strips.push([one.min(other), one.max(other), dark]);
        }
    }

    pub fn grain(&mut self, at_mm: f64, size_mm: f64, beside_mm: f64) {
        self.grains.push([at_mm, 0.5 * size_mm, beside_mm]);
    }

    fn darkness(&self, spot: &Spot, at_mm: f64) -> f64 {
        let mut dark = 0.0;
        for [from_mm, to_mm, how] in &self.strips {
            if (from_mm - at_mm) < spot.radius_mm && (at_mm - to_mm) < spot.radius_mm {
                dark += how * (spot.left_of(to_mm - at_mm) - spot.left_of(from_mm - at_mm));
            }
        }
        for [grain_mm, radius_mm, beside_mm] in &self.grains {
            let reach_mm = radius_mm + spot.radius_mm;
            if (grain_mm - at_mm).abs() < reach_mm {
                dark += grain_share(spot.radius_mm, *radius_mm, grain_mm - at_mm, *beside_mm);
            }
        }
        dark.min(1.0)
    }
}

/// Share of the spot's light that falls on a grain, summed over a grid on the grain.
fn grain_share(spot_mm: f64, radius_mm: f64, along_mm: f64, beside_mm: f64) -> f64 {
    const STEPS: i32 = 5;
    let (mut sum, mut inside) = (0.0, 0.0);
    for i in -STEPS..=STEPS {
        for j in -STEPS..=STEPS {
            let (u, v) = (f64::from(i) / f64::from(STEPS), f64::from(j) / f64::from(STEPS));
            if u * u + v * v > 1.0 {
                continue;
            }
            inside += 1.0;
            let square = ((along_mm + u * radius_mm).powi(2) + (beside_mm + v * radius_mm).powi(2))
                / (spot_mm * spot_mm);
            sum += (1.0 - square).max(0.0);
        }
    }
    // The whole spot's light is π R² / 2 where its middle has brightness 1.
    sum / inside * 2.0 * (radius_mm / spot_mm).powi(2)
}
