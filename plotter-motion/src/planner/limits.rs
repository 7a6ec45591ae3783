//! [`Limits`]: a planner's settings as it reckons with them for every block.

use super::PlannerSettings;
use super::ring::narrow;
use crate::extremes::least;
use crate::geom::single;

/// What is the same for every block, computed once. Small numbers are `f32`, which small processors reckon with in hardware. Limits
/// and their squares are rounded down; a speed made of them may be 2·10⁻⁷ of itself too much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub(super) settings: PlannerSettings,
    /// 1/a and 1/2a.
    pub(super) per_accel: f32,
    pub(super) per_twice_accel: f32,
    /// a and 2a.
    pub(super) accel: f32,
    pub(super) twice_accel: f32,
    /// Squares of the speeds with the pen down and up.
    pub(super) speed2: f32,
    pub(super) travel2: f32,
    pub(super) junction_deviation_mm: f32,
    pub(super) resolution_mm: f32,
}

impl Limits {
    pub(super) fn of(settings: &PlannerSettings) -> Self {
        let PlannerSettings { speed_mm_s, travel_speed_mm_s, accel_mm_s2, .. } = *settings;
        let accel = narrow(accel_mm_s2);
        Self {
            settings: *settings,
            per_accel: 1.0 / accel,
            per_twice_accel: 0.5 / accel,
            accel,
            // so much less that no product with a length is rounded above the true one
            twice_accel: 2.0 * accel * (1.0 - f32::EPSILON),
            speed2: narrow(speed_mm_s * speed_mm_s),
            travel2: narrow(travel_speed_mm_s * travel_speed_mm_s),
            junction_deviation_mm: narrow(settings.junction_deviation_mm),
            resolution_mm: narrow(settings.resolution_mm),
        }
    }

    /// Square of a speed that is asked for, no more than this one; none if it is so slow that the square, or a share of it, were no number
    /// with all its bits, or not finite.
    pub(super) fn speed2(speed_mm_s: f64, most2: f32) -> Option<f32> {
        const LEAST_MM_S: f32 = 1e-16;
        let speed = single(speed_mm_s);
        (LEAST_MM_S..f32::INFINITY).contains(&speed).then(|| least(speed * speed, most2))
    }
}

/// Squares of the shares of the speeds that operations ask for, as a person at the machine sets them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shares {
    pub(super) draw2: f32,
    pub(super) travel2: f32,
}

impl Default for Shares {
    fn default() -> Self {
        Self { draw2: 1.0, travel2: 1.0 }
    }
}

/// Which share holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Share {
    Draw,
    #[default]
    Travel,
    /// None: it is as fast as was asked for.
    Jog,
}

impl Shares {
    /// The square of a speed that was asked for, as it is then; no more than the machine's.
    pub(super) fn of(&self, share: Share, feed2: f32, limits: &Limits) -> f32 {
        match share {
            Share::Draw => least(feed2 * self.draw2, limits.speed2),
            Share::Travel => least(feed2 * self.travel2, limits.travel2),
            Share::Jog => least(feed2, limits.travel2),
        }
    }
}

/// What the greatest speed on a block is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wish {
    pub(super) feed_mm_s: f32,
    /// Square of the greatest speed that its form allows.
    pub(super) form2: f32,
    pub(super) share: Share,
}

impl Wish {
    /// Square of the greatest speed at these shares.
    pub(super) fn cruise2(&self, shares: &Shares, limits: &Limits) -> f32 {
        least(shares.of(self.share, self.feed_mm_s * self.feed_mm_s, limits), self.form2)
    }
}
