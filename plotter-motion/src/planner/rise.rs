//! [`Rise`]: how a path rises and falls, and what that allows.
//!
//! A block's length is that of its way in space. Along it z changes evenly: with l the length in the plane, h
//! what it rises by and L = √(l² + h²), a speed v along it is v l/L in the plane and v h/L of z. So z's
//! limits become limits along the block, divided by |h|/L.
//!
//! Where one block rises in another way than the next, z's speed jumps. A motor cannot tell a jump from an
//! acceleration if that makes it within one step: with σ = h/L before and τ behind, |v² τ|τ| − v² σ|σ|| is at
//! most 2 a times a step. Many short blocks have many jumps: each is no more than a small share of what the
//! acceleration makes in the time of the shorter block. What the speed in the plane jumps by is held to the
//! junction's deviation in the same way as z's to a step. Before and after a block of z alone the machine
//! stands.
//!
//! With a limited jerk one acceleration holds for all blocks. A block that may have only a k-th of it is told
//! as k times as long, with speeds k times as great: planned with the one acceleration it is then driven with
//! its own, and with a k-th of the jerk. Steps are counted by shares of a block, which no unit changes. The
//! units change at its ends, so the machine stands there.

use super::block::Bend;
use super::limits::Limits;
use super::stretch::Stretch;
use crate::extremes::{greatest, least};
use crate::geom::single;
use crate::root::root;

/// Limits of a third axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ZLimits {
    /// Greatest speed of z, mm/s.
    pub speed_mm_s: f64,
    /// Greatest acceleration of z, mm/s².
    pub accel_mm_s2: f64,
    /// A step of its motor, mm: see [the module](super).
    pub step_mm: f64,
}

impl ZLimits {
    /// Whether a motion can be planned with them.
    pub(crate) const fn check(&self) -> Result<(), super::PlanError> {
        let Self { speed_mm_s, accel_mm_s2, step_mm } = *self;
        let ranges = [
            ("z.speed_mm_s", speed_mm_s, 1e-3, 1e6),
            ("z.accel_mm_s2", accel_mm_s2, 1e-3, 1e9),
            ("z.step_mm", step_mm, 1e-9, 1e3),
        ];
        let mut index = 0;
        while index < ranges.len() {
            let (quantity, value, least, most) = ranges[index];
            if !(value >= least && value <= most) {
                return Err(super::PlanError::Setting { quantity, value, least, most });
            }
            index += 1;
        }
        Ok(())
    }
}

/// What jumps of z's speed may add to its acceleration, as a share of that. With twice as much the motor is
/// felt to be driven 1.05 times as hard as it is said to stand; with half, gentle slopes in short lines are
/// passed at 0.7 of the speed.
const JUMPS_SHARE: f32 = 0.025;
/// Share of the acceleration that a helix has along it, and of the one that turns it: √½ of each, which
/// together are the whole.
pub(crate) const HELIX_SHARE: f32 = 0.707;

/// How the last block ends: what z rises by on a millimetre of path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rise {
    speed: f32,
    accel: f32,
    step_mm: f32,
    /// The height at the end of the path that was pushed, mm.
    pub(super) at_mm: f64,
    /// What the block in hand rises by, mm.
    by_mm: f32,
    slope: f32,
    length_mm: f32,
    /// The heights of a pen that is up and down, mm, where z lifts it.
    pub(super) pen_mm: Option<[f64; 2]>,
}

impl Rise {
    pub(super) fn set_limits(&mut self, limits: &ZLimits) {
        let [speed, accel, step_mm] =
            [limits.speed_mm_s, limits.accel_mm_s2, limits.step_mm].map(super::ring::narrow);
        (self.speed, self.accel, self.step_mm) = (speed, accel, step_mm);
    }

    /// Whether it has been told what the axis can do.
    pub(super) fn has_limits(&self) -> bool {
        self.speed > 0.0
    }

    /// The next block ends at this height. Says whether it is another one.
    pub(super) fn go_to(&mut self, height_mm: f64) -> bool {
        self.by_mm = single(height_mm - self.at_mm);
        self.at_mm = height_mm;
        self.by_mm != 0.0
    }

    /// A block as it is with what it rises by. Gives it and the square of the greatest speed between it and
    /// the one before.
    pub(super) fn take(&mut self, stretch: Stretch, limits: &Limits) -> (Stretch, f32) {
        let by_mm = core::mem::take(&mut self.by_mm);
        let (before, before_mm, mut stretch) = (self.slope, self.length_mm, stretch);
        if by_mm == 0.0 {
            self.slope = 0.0;
        } else {
            let plane_mm = stretch.length_mm;
            let length_mm = root(plane_mm * plane_mm + by_mm * by_mm);
            let (across, slope) = (plane_mm / length_mm, by_mm / length_mm);
            let steep = slope.abs();
            let (mut accel, mut sweep_rad) = (self.accel / steep, 0.0);
            let mut form2 = self.speed * self.speed / (steep * steep);
            match stretch.bend {
                Bend::Line { accel: in_plane } if plane_mm > 0.0 => accel = least(accel, in_plane / across),
                Bend::Arc { sweep_rad: sweep, form2: turning2 } => {
                    sweep_rad = sweep;
                    accel = least(accel, HELIX_SHARE * limits.accel() / across);
                    form2 = least(form2, HELIX_SHARE * turning2 / (across * across));
                }
                _ => {}
            }
            let mut scale = 1.0;
            if limits.has_jerk() {
                let along = limits.along_with_jerk();
                scale = greatest(1.0, along / accel);
                accel = along;
            }
            form2 *= scale * scale;
            stretch.feed2 *= scale * scale;
            stretch.bend = Bend::Rising { accel, sweep_rad, form2 };
            stretch.length_mm = scale * length_mm;
            self.slope = slope;
        }
        self.length_mm = stretch.length_mm;
        if limits.has_jerk() && (before != 0.0 || self.slope != 0.0) {
            return (stretch, 0.0);
        }
        let shorter_mm = least(before_mm, self.length_mm);
        (stretch, self.between2(before, self.slope, shorter_mm, limits))
    }

    /// Square of the greatest speed between two slopes.
    fn between2(&self, before: f32, after: f32, shorter_mm: f32, limits: &Limits) -> f32 {
        #[expect(
            clippy::float_cmp,
            reason = "a straight way is divided into parts that rise alike, to the bit"
        )]
        if before == after {
            return f32::INFINITY;
        }
        if before.abs() >= 1.0 || after.abs() >= 1.0 {
            return 0.0;
        }
        let (before2, after2) = (before * before.abs(), after * after.abs());
        let of_z = least(
            2.0 * self.accel * self.step_mm / (after2 - before2).abs(),
            JUMPS_SHARE * self.accel * shorter_mm / (after - before).abs(),
        );
        let in_plane = (after2.abs() - before2.abs()).abs();
        if in_plane > 0.0 {
            return least(of_z, 2.0 * limits.accel() * limits.junction_deviation_mm() / in_plane);
        }
        of_z
    }

    /// Starts again at another height.
    pub(super) const fn restarted(self) -> Self {
        Self { by_mm: 0.0, slope: 0.0, ..self }
    }
}

/// The heights at which the blocks end that are known ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heights<const N: usize> {
    ends_mm: [f64; N],
    head: usize,
    len: usize,
}

impl<const N: usize> Default for Heights<N> {
    fn default() -> Self {
        Self { ends_mm: [0.0; N], head: 0, len: 0 }
    }
}

impl<const N: usize> Heights<N> {
    pub(super) fn push(&mut self, end_mm: f64) {
        if let Some(slot) = self.ends_mm.get_mut((self.head + self.len) % N) {
            *slot = end_mm;
            self.len = (self.len + 1).min(N);
        }
    }

    pub(super) fn first(&self) -> Option<f64> {
        self.ends_mm.get(self.head).copied().filter(|_| self.len > 0)
    }

    pub(super) fn pop(&mut self) {
        if self.len > 0 {
            (self.head, self.len) = ((self.head + 1) % N, self.len - 1);
        }
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }
}
