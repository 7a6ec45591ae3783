//! [`Piece`]: a stretch of planned motion as one command.

use super::EbbDialect;
use super::rates::{LowLevelMove, MotorRate, STEP, TICKS_PER_MS};
use crate::StepPoint;
use crate::kinematics::MotorPoint;
use crate::whole::nearest;

/// A motor that is slower at the end of a piece is led to the nearest step, others to the next one on their
/// way, steps/ms. One that stands would else make a step for the last bit of a place.
const SLOW_STEPS_MS: f64 = 0.05;
/// Ticks in a millisecond, as a number to reckon with.
const TICKS: f64 = TICKS_PER_MS as f64;

/// The place of one of both motors.
type Of = fn(&MotorPoint) -> f64;

/// One motor on its way through a piece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Way {
    /// Steps to make, and which way.
    steps: i64,
    sign: f64,
    /// Speed at the start, steps/ms, and acceleration, steps/ms².
    speed: f64,
    accel: f64,
}

/// A stretch of planned motion as one command: both motors at constant acceleration from whole step to whole
/// step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Piece {
    ways: [Way; 2],
    ms: u32,
}

impl Piece {
    /// From where the motors stand along `samples`, one a millisecond, to the end of them; `is_rest` if the
    /// machine stands there. And by how much at most a motor is off meanwhile, steps: from its place, or by a
    /// step more than it is faster or slower than the samples.
    pub(super) fn fit(
        from: StepPoint,
        samples: &[MotorPoint],
        is_rest: bool,
        dialect: EbbDialect,
    ) -> Option<(Self, f64)> {
        let ms = u32::try_from(samples.len().checked_sub(1)?).ok().filter(|&ms| ms > 0)?;
        let mut piece = Self { ways: [Way::default(); 2], ms };
        let mut off: f64 = 0.0;
        let motors: [(i32, Of); 2] = [(from.x, |at| at.x), (from.y, |at| at.y)];
        for (way, (from, of)) in piece.ways.iter_mut().zip(motors) {
            *way = Way::fit(from, samples, of, is_rest, dialect)?;
            off = off.max(way.off(from, samples, of));
        }
        Some((piece, off))
    }

    /// Where the motors stand behind it.
    pub(super) fn end(&self, from: StepPoint) -> StepPoint {
        let [x, y] = self.steps();
        StepPoint::new(from.x.saturating_add(x), from.y.saturating_add(y))
    }

    /// Steps of both motors.
    pub(super) fn steps(&self) -> [i32; 2] {
        self.ways.map(|way| i32::try_from(way.steps).unwrap_or(i32::MAX))
    }

    /// How long it takes.
    pub(super) fn ms(&self) -> u32 {
        self.ms
    }

    /// The command LM for it. Its accumulators begin at 0.
    pub(super) fn low_level(&self) -> LowLevelMove {
        LowLevelMove { motors: self.ways.map(|way| way.rate(self.ms)), clear: 3 }
    }
}

impl Way {
    fn fit(from: i32, samples: &[MotorPoint], of: Of, is_rest: bool, dialect: EbbDialect) -> Option<Self> {
        let count = samples.len().checked_sub(1)?;
        let (first, last) = (of(samples.first()?), of(samples.get(count)?));
        let speed_at_end = last - of(samples.get(count.checked_sub(1)?)?);
        let to = if is_rest || speed_at_end.abs() < SLOW_STEPS_MS {
            last
        } else if speed_at_end > 0.0 {
            libm::ceil(last)
        } else {
            libm::floor(last)
        };
        let steps = nearest(to) - i64::from(from);
        let sign = if steps < 0 { -1.0 } else { 1.0 };
        if steps == 0 {
            return Some(Self { sign, ..Self::default() });
        }
        let ms = as_float(count);
        let mean = as_float(usize::try_from(steps.unsigned_abs()).ok()?) / ms;
        let accel = match dialect {
            EbbDialect::Constant => 0.0,
            EbbDialect::LowLevel if count < 2 => 0.0,
            EbbDialect::LowLevel => {
                // The parabola through both ends and the middle, as far as no motor turns round in it.
                let middle = count / 2;
                let at = as_float(middle);
                let half_way = sign * (of(samples.get(middle)?) - first);
                let planned = 2.0 * (sign * (last - first) / ms - half_way / at) / (ms - at);
                planned.clamp(-2.0 * mean / ms, 2.0 * mean / ms)
            }
        };
        Some(Self { steps, sign, speed: mean - 0.5 * accel * ms, accel })
    }

    /// How far it is at most from its place; or from where it would be on its way in the rhythm of the
    /// samples, and a step. Steps.
    fn off(&self, from: i32, samples: &[MotorPoint], of: Of) -> f64 {
        let (Some(first), Some(last)) = (samples.first().map(of), samples.last().map(of)) else { return 0.0 };
        let count = as_float(samples.len() - 1);
        let ahead_more = as_float(usize::try_from(self.steps.unsigned_abs()).unwrap_or_default())
            - self.sign * (last - first);
        (0_u32..).map(f64::from).zip(samples).fold(0.0, |most, (ms, at)| {
            let way = ms * (self.speed + 0.5 * ms * self.accel);
            let ahead = self.sign * (f64::from(from) - of(at)) + way;
            // The step is made when its whole way is over: up to one is missing before.
            let behind = way.min(1.0) - ahead;
            let rhythm = self.sign * (of(at) - first) + ahead_more * ms / count - way;
            most.max(ahead).max(behind).max(1.0 + rhythm.abs())
        })
    }

    fn rate(&self, ms: u32) -> MotorRate {
        let ticks = i64::from(TICKS_PER_MS) * i64::from(ms);
        let wanted = self.steps.abs() * i64::from(STEP);
        let mut accel = nearest(self.accel / (TICKS * TICKS) * f64::from(STEP));
        if wanted == 0 {
            return MotorRate::default();
        }
        // With the rate rounded up the last step is made in the last tick at the latest. What rounding does
        // to the acceleration must not make a rate less than none, which is the greatest to the board.
        for _ in 0..4 {
            let rate = (wanted - accel * (ticks * (ticks + 1) / 2)).div_euclid(ticks) + 1 + accel / 2;
            let (first, last) = (rate - accel / 2 + accel, rate - accel / 2 + accel * ticks);
            let fits = 0..i64::from(STEP);
            if fits.contains(&first) && fits.contains(&last) && fits.contains(&rate) {
                return MotorRate {
                    rate: u32::try_from(rate).unwrap_or(STEP - 1),
                    steps: i32::try_from(self.steps).unwrap_or(i32::MAX),
                    accel: i32::try_from(accel).unwrap_or_default(),
                };
            }
            accel -= accel.signum() + accel / 1_024;
        }
        let rate = (wanted.div_euclid(ticks) + 1).min(i64::from(STEP) - 1);
        MotorRate {
            rate: u32::try_from(rate).unwrap_or(STEP - 1),
            steps: i32::try_from(self.steps).unwrap_or(i32::MAX),
            accel: 0,
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "steps of one command, far below 2^53")]
fn as_float(count: usize) -> f64 {
    count as f64
}
