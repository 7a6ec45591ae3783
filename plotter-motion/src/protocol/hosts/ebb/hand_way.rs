//! [`HandWay`]: a straight way by hand, in pieces of constant speed that grow and shrink by a ramp.

use crate::StepPoint;

/// How long a piece is, ms: its speed differs from that of the one before by the acceleration over this time,
/// at 1000 mm/s² by 25 mm/s. Shorter ones would not reach the board in time over a slow computer.
const PIECE_MS: u16 = 25;
/// Longest last piece, ms.
const LAST_MS: f64 = 200.0;
/// Two ways go the same way whose directions differ by less: the cosine of 0.8°.
const SAME_WAY: f64 = 0.9999;

/// A way that is under way, or is about to begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HandWay {
    from: StepPoint,
    to: StepPoint,
    length_mm: f64,
    speed_mm_s: f64,
    accel_mm_s2: f64,
    done_mm: f64,
    now_mm_s: f64,
    /// Where the pieces so far have led.
    at: StepPoint,
}

/// A piece: its duration, ms, its steps, and where it leads.
pub(super) type Piece = (u32, [i32; 2], StepPoint);

impl HandWay {
    pub(super) fn new(
        from: StepPoint,
        to: StepPoint,
        length_mm: f64,
        speed_mm_s: f64,
        accel_mm_s2: f64,
    ) -> Self {
        Self { from, to, length_mm, speed_mm_s, accel_mm_s2, done_mm: 0.0, now_mm_s: 0.0, at: from }
    }

    /// Where it ends.
    pub(super) const fn to(&self) -> StepPoint {
        self.to
    }

    /// Goes on to another end, of which the way from the old one is so long, where that lies straight ahead;
    /// says whether it does.
    pub(super) fn lengthen(&mut self, to: StepPoint, by_mm: f64) -> bool {
        let way = |a: StepPoint, b: StepPoint| {
            [f64::from(b.x.saturating_sub(a.x)), f64::from(b.y.saturating_sub(a.y))]
        };
        let ([ax, ay], [bx, by]) = (way(self.from, self.to), way(self.to, to));
        let lengths = libm::hypot(ax, ay) * libm::hypot(bx, by);
        if ax * bx + ay * by < SAME_WAY * lengths {
            return false;
        }
        (self.to, self.length_mm) = (to, self.length_mm + by_mm);
        true
    }

    /// The next piece, and whether it is the last.
    pub(super) fn next(&mut self) -> (Piece, bool) {
        let piece_s = f64::from(PIECE_MS) * 1e-3;
        let rest_mm = (self.length_mm - self.done_mm).max(0.0);
        // So fast at most that from the end of this piece on it can still brake: v² = 2 a (rest - piece).
        let half_mm_s = 0.5 * self.accel_mm_s2 * piece_s;
        let square =
            half_mm_s * half_mm_s + 2.0 * self.accel_mm_s2 * rest_mm - 2.0 * half_mm_s * self.now_mm_s;
        let brakes_mm_s = (libm::sqrt(square.max(0.0)) - half_mm_s).max(0.0);
        let then_mm_s = (self.now_mm_s + self.accel_mm_s2 * piece_s).min(self.speed_mm_s).min(brakes_mm_s);
        let by_mm = 0.5 * (self.now_mm_s + then_mm_s) * piece_s;
        // What is left is less than a piece at this speed, or than a ramp has in two of them.
        let is_last = by_mm >= rest_mm || rest_mm <= self.accel_mm_s2 * piece_s * piece_s;
        let (ms, to) = if is_last {
            let speed = (0.5 * self.now_mm_s).max(0.5 * self.accel_mm_s2 * piece_s).min(self.speed_mm_s);
            let ms = libm::ceil(1e3 * rest_mm / speed.max(0.1)).clamp(10.0, LAST_MS);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "10 to 200, as clamped"
            )]
            let ms = ms as u32;
            (ms, self.to)
        } else {
            (self.done_mm, self.now_mm_s) = (self.done_mm + by_mm, then_mm_s);
            let share = self.done_mm / self.length_mm;
            let along = |from: i32, to: i32| {
                let way = f64::from(to.saturating_sub(from));
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "within the way, which has so many steps"
                )]
                let steps = libm::round(way * share) as i32;
                from.saturating_add(steps)
            };
            (PIECE_MS.into(), StepPoint::new(along(self.from.x, self.to.x), along(self.from.y, self.to.y)))
        };
        let steps = [to.x.saturating_sub(self.at.x), to.y.saturating_sub(self.at.y)];
        self.at = to;
        ((ms, steps, to), is_last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn pieces(mut way: HandWay) -> Vec<(u32, [i32; 2])> {
        let mut all = Vec::new();
        loop {
            let ((ms, steps, _), is_last) = way.next();
            all.push((ms, steps));
            if is_last {
                return all;
            }
            assert!(all.len() < 10_000, "it does not end");
        }
    }

    /// 80 steps to the millimetre; a step more or less in a piece of 25 ms is 0.5 mm/s, twice.
    #[test]
    fn the_speed_grows_and_shrinks_by_the_ramp_and_all_steps_are_made() {
        for (length_mm, speed, accel) in [
            (100.0, 20.0, 200.0),
            (3.0, 20.0, 200.0),
            (0.1, 20.0, 200.0),
            (40.0, 15.0, 30.0),
            (0.0125, 20.0, 50.0),
        ] {
            #[expect(clippy::cast_possible_truncation, reason = "8000 steps at most")]
            let to = StepPoint::new((length_mm * 80.0) as i32, -3);
            let all = pieces(HandWay::new(StepPoint::default(), to, length_mm, speed, accel));
            assert_eq!(all.iter().map(|(_, [x, _])| x).sum::<i32>(), to.x);
            assert_eq!(all.iter().map(|(_, [_, y])| y).sum::<i32>(), to.y);
            let speeds: Vec<f64> =
                all.iter().map(|&(ms, [x, _])| f64::from(x) / 80.0 / f64::from(ms) * 1e3).collect();
            assert!(speeds.iter().all(|&v| v <= speed + 1.1), "{speeds:?}");
            let edge = |v: f64| v <= accel * 0.025 + 1.1;
            assert!(edge(speeds[0]) && edge(speeds[speeds.len() - 1]), "{length_mm}: {speeds:?}");
            for pair in speeds.windows(2) {
                assert!((pair[1] - pair[0]).abs() <= accel * 0.025 + 1.1, "{length_mm}: {speeds:?}");
            }
            let took_s = all.iter().map(|&(ms, _)| f64::from(ms)).sum::<f64>() * 1e-3;
            let ramps_mm = speed * speed / accel;
            let best_s = if length_mm > ramps_mm {
                length_mm / speed + speed / accel
            } else {
                2.0 * libm::sqrt(length_mm / accel)
            };
            assert!(took_s < best_s + 0.2, "{length_mm}: {took_s} for {best_s}");
        }
    }

    #[test]
    fn a_way_goes_on_straight_ahead_without_a_rest_and_not_round_a_corner() {
        let mut way = HandWay::new(StepPoint::default(), StepPoint::new(400, 0), 5.0, 20.0, 200.0);
        for _ in 0..3 {
            way.next();
        }
        assert!(!way.lengthen(StepPoint::new(400, 400), 5.0));
        assert!(!way.lengthen(StepPoint::new(0, 0), 5.0));
        assert!(way.lengthen(StepPoint::new(4_000, 0), 45.0));
        let all = pieces(way);
        // at full speed until shortly before its end
        assert!(all.iter().filter(|(ms, [x, _])| *ms == 25 && (39..=41).contains(x)).count() > 80, "{all:?}");
    }
}
