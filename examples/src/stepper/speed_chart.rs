//! [`SpeedChart`]: speed over time in bounded memory, and its picture.

use plotter_motion::Pen;
use plotter_replay::{
    Chart,
    draw::{Curve, Panel, Role, Run},
};
use std::time::Duration;

/// Most stretches of time that are told apart: more than the picture has columns.
const MOST: usize = 4096;

/// Shortest stretch, s.
const SHORTEST_S: f64 = 0.005;

/// Least and greatest values of a stretch of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Stretch {
    /// With the pen up, and down; mm/s.
    speeds: [Option<(f64, f64)>; 2],
    /// Along the path, mm/s².
    accels: Option<(f64, f64)>,
}

fn grown(range: Option<(f64, f64)>, value: f64) -> Option<(f64, f64)> {
    Some(range.map_or((value, value), |(least, most)| (least.min(value), most.max(value))))
}

fn joined(one: Option<(f64, f64)>, other: Option<(f64, f64)>) -> Option<(f64, f64)> {
    match (one, other) {
        (Some(one), Some(other)) => Some((one.0.min(other.0), one.1.max(other.1))),
        (one, other) => one.or(other),
    }
}

/// Speed and acceleration over time. The stretches of which only the least and the greatest value are kept
/// grow with the drawing, so that memory does not.
#[derive(Clone, Debug)]
pub struct SpeedChart {
    stretch_s: f64,
    stretches: Vec<Stretch>,
}

impl Default for SpeedChart {
    fn default() -> Self {
        Self { stretch_s: SHORTEST_S, stretches: Vec::new() }
    }
}

impl SpeedChart {
    /// Takes a moment.
    pub fn push(&mut self, moment: crate::machine::Moment, pen: Pen) {
        let mut index = whole(moment.time_s / self.stretch_s);
        while index >= MOST {
            self.stretches = self
                .stretches
                .chunks(2)
                .map(|pair| {
                    pair.iter().fold(Stretch::default(), |sum, stretch| Stretch {
                        speeds: [
                            joined(sum.speeds[0], stretch.speeds[0]),
                            joined(sum.speeds[1], stretch.speeds[1]),
                        ],
                        accels: joined(sum.accels, stretch.accels),
                    })
                })
                .collect();
            self.stretch_s *= 2.0;
            index = whole(moment.time_s / self.stretch_s);
        }
        if self.stretches.len() <= index {
            self.stretches.resize(index + 1, Stretch::default());
        }
        if let Some(stretch) = self.stretches.get_mut(index) {
            let speed = &mut stretch.speeds[usize::from(pen == Pen::Down)];
            *speed = grown(*speed, moment.speed_mm_s);
            stretch.accels = grown(stretch.accels, moment.along_mm_s2);
        }
    }

    /// The picture: speed with the pen down and up below their limits, and the acceleration along the path
    /// between its.
    #[must_use]
    pub fn to_svg(&self, title: &str, limits: &plotter_motion::PlannerSettings) -> String {
        let end = self.time(self.stretches.len());
        let span = (Duration::ZERO, end);
        let level = |label: &str, value: f64| {
            Curve::new(label, Role::Setpoint, Run::Straight, span, [(Duration::ZERO, value), (end, value)])
        };
        let speed = |label: &str, role: Role, pen: usize| {
            let ranges = self.stretches.iter().map(move |stretch| stretch.speeds[pen]);
            Curve::new(label, role, Run::Straight, span, self.samples(ranges))
        };
        let mut speeds = vec![level("greatest speed", limits.speed_mm_s)];
        if limits.travel_speed_mm_s != limits.speed_mm_s {
            speeds.push(level("greatest travel speed", limits.travel_speed_mm_s));
        }
        speeds.push(speed("pen up", Role::Desired, 0));
        speeds.push(speed("pen down", Role::Actual, 1));
        let accels = self.stretches.iter().map(|stretch| stretch.accels);
        let accels = vec![
            level("greatest acceleration", limits.accel_mm_s2),
            level("greatest braking", -limits.accel_mm_s2),
            Curve::new("along the path", Role::Actual, Run::Straight, span, self.samples(accels)),
        ];
        Chart {
            title: title.to_owned(),
            panels: vec![
                Panel { label: String::from("speed (mm/s)"), curves: speeds },
                Panel { label: String::from("acceleration (mm/s²)"), curves: accels },
            ],
        }
        .to_svg()
    }

    fn time(&self, index: usize) -> Duration {
        #[expect(clippy::cast_precision_loss, reason = "at most 4096")]
        let seconds = index as f64 * self.stretch_s;
        Duration::from_secs_f64(seconds)
    }

    /// Least and greatest value of every stretch; 0 where there is none.
    fn samples(
        &self,
        ranges: impl Iterator<Item = Option<(f64, f64)>>,
    ) -> impl Iterator<Item = (Duration, f64)> {
        ranges.enumerate().flat_map(|(index, range)| {
            let (least, most) = range.unwrap_or_default();
            let (begin, next) = (self.time(index), self.time(index + 1));
            [(begin, least), (begin + (next - begin) / 2, most)]
        })
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast saturates")]
fn whole(number: f64) -> usize {
    number as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_needs_no_more_room_than_a_minute_and_peaks_stay() {
        let mut chart = SpeedChart::default();
        for second in 0..86_400 {
            let speed_mm_s = if second == 40_000 { 99.0 } else { 1.0 };
            chart.push(
                crate::machine::Moment { time_s: f64::from(second), speed_mm_s, along_mm_s2: 0.0 },
                Pen::Down,
            );
        }
        assert!(chart.stretches.len() <= MOST);
        let most = chart.stretches.iter().filter_map(|stretch| stretch.speeds[1]).map(|(_, most)| most);
        assert!(most.fold(0.0, f64::max) >= 99.0);
    }
}
