//! Curves of short chords, each written with some decimals, and how long Grbl's rule takes for them.
#![allow(dead_code, reason = "part of tests, each of which takes what it needs")]

use plotter_motion::{PlannerSettings, PlotOp, Point, Vec2};

/// Lengths of chords, mm.
pub(crate) const CHORDS_MM: [f64; 6] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5];

/// A curve by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curve {
    /// Radius 20 mm.
    Circle,
    /// Archimedean, from 10 to 25 mm, 5 mm a turn.
    Spiral,
    /// 150 mm whose direction swings.
    Free,
}

pub(crate) const CURVES: [Curve; 3] = [Curve::Circle, Curve::Spiral, Curve::Free];

impl Curve {
    /// Places at equal distances along it.
    pub(crate) fn places(self, chord_mm: f64) -> Vec<Point> {
        let centre = Point::new(40.0, 40.0);
        let polar = |radius_mm: f64, angle_rad: f64| centre + Vec2::new(radius_mm, 0.0).rotated(angle_rad);
        let mut places = Vec::new();
        match self {
            Self::Circle => {
                const RADIUS_MM: f64 = 20.0;
                let turn_rad = chord_mm / RADIUS_MM;
                let count = (core::f64::consts::TAU / turn_rad).round();
                let mut at = 0.0;
                while at <= count {
                    places.push(polar(RADIUS_MM, at * core::f64::consts::TAU / count));
                    at += 1.0;
                }
            }
            Self::Spiral => {
                let mut angle_rad = 0.0;
                loop {
                    let radius_mm = 10.0 + 5.0 * angle_rad / core::f64::consts::TAU;
                    if radius_mm > 25.0 {
                        break;
                    }
                    places.push(polar(radius_mm, angle_rad));
                    angle_rad += chord_mm / radius_mm;
                }
            }
            Self::Free => {
                const FINE: u32 = 8;
                let (mut at, mut way_mm) = (centre, 0.0);
                while way_mm < 150.0 {
                    places.push(at);
                    for _ in 0..FINE {
                        let step_mm = chord_mm / f64::from(FINE);
                        let middle_mm = way_mm + 0.5 * step_mm;
                        let direction_rad = 0.9 * (middle_mm / 17.0).sin()
                            + 0.6 * (middle_mm / 11.0 + 1.0).sin()
                            + middle_mm / 60.0;
                        at += Vec2::new(step_mm, 0.0).rotated(direction_rad);
                        way_mm += step_mm;
                    }
                }
            }
        }
        places
    }

    /// The same as a file says them; places that it cannot tell apart are one.
    pub(crate) fn written(self, chord_mm: f64, decimals: i32) -> Vec<Point> {
        let digits = 10.0_f64.powi(decimals);
        let mut places: Vec<Point> = self
            .places(chord_mm)
            .iter()
            .map(|place| Point::new((place.x * digits).round() / digits, (place.y * digits).round() / digits))
            .collect();
        places.dedup();
        places
    }
}

/// One stroke.
pub(crate) fn stroke(places: &[Point]) -> Vec<PlotOp> {
    let mut ops = Vec::new();
    for (index, &to) in places.iter().enumerate() {
        ops.push(if index == 0 { PlotOp::Travel { to } } else { PlotOp::Draw { to, feed_mm_s: None } });
    }
    ops
}

/// Which rule a corner is taken by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    /// The circle of the junction deviation.
    Grbl,
    /// And no faster than on an arc that begins half a segment from the corner.
    Klipper,
}

/// Time of a stroke from rest to rest with a look-ahead without end, s. Accelerations are those along the
/// path.
pub(crate) fn rule_s(places: &[Point], settings: &PlannerSettings, rule: Rule) -> f64 {
    let (accel, cruise2) = (settings.accel_mm_s2, settings.speed_mm_s * settings.speed_mm_s);
    let ways: Vec<Vec2> =
        places.windows(2).map(|ends| ends[1] - ends[0]).filter(|way| way.length() > 0.0).collect();
    let mut speeds2 = vec![0.0; ways.len() + 1];
    for (index, pair) in ways.windows(2).enumerate() {
        let turn_rad = libm::atan2(pair[0].cross(pair[1]), pair[0].dot(pair[1])).abs();
        let (sin_half, cos_half) = (libm::cos(0.5 * turn_rad), libm::sin(0.5 * turn_rad));
        // 1 - s = c^2 / (1 + s)
        let mut most2 =
            accel * settings.junction_deviation_mm * sin_half * (1.0 + sin_half) / (cos_half * cos_half);
        if rule == Rule::Klipper {
            let shorter_mm = pair[0].length().min(pair[1].length());
            most2 = most2.min(0.5 * shorter_mm * accel * sin_half / cos_half);
        }
        // Straight on they are infinite, or no number.
        speeds2[index + 1] = [most2].into_iter().fold(cruise2, f64::min);
    }
    for (index, way) in ways.iter().enumerate().rev() {
        speeds2[index] = f64::min(speeds2[index], speeds2[index + 1] + 2.0 * accel * way.length());
    }
    let mut time_s = 0.0;
    for (index, way) in ways.iter().enumerate() {
        let length_mm = way.length();
        speeds2[index + 1] = f64::min(speeds2[index + 1], speeds2[index] + 2.0 * accel * length_mm);
        let (entry2, exit2) = (speeds2[index], speeds2[index + 1]);
        let top2 = cruise2.min(0.5 * (entry2 + exit2) + accel * length_mm);
        let [entry, exit, top] = [entry2, exit2, top2].map(f64::sqrt);
        let ramps_mm = (2.0 * top2 - entry2 - exit2) / (2.0 * accel);
        time_s += (2.0 * top - entry - exit) / accel + (length_mm - ramps_mm).max(0.0) / top;
    }
    time_s
}
