//! What homing has measured, held against what is said of the machine.

use super::super::{Report, Status, StepperPlotterSettings};
use super::{Grbl, Pens};
use crate::decimal_text::{Plain, Thousandths, Whole};
use crate::homing::Homed;
use crate::planner::Keep as _;

/// How much an axis may be longer or shorter than at the homing before, mm. A switch is found again within a
/// tenth of a millimetre; half a millimetre is lost steps, another switch or another scale.
const ALIKE_MM: f64 = 0.5;
/// By how much the area may be larger than what can be reached, mm: sides are whole millimetres, and a switch
/// gives way.
const BEYOND_MM: f64 = 0.5;

impl<P: Pens> Grbl<P> {
    pub(in super::super) fn set_homed(&mut self, homed: Homed) {
        if let Some(kept) = self.kept.get_mut() {
            kept.homed = Some(homed);
        }
    }

    /// What is to be said of a homing: by how much two motors of an axis were out of square; an axis that is
    /// not as long as it was, or shorter than its side of the area.
    pub(super) fn tell_measured(&mut self, report: &Report, status: &Status) {
        let Report::Homed { result: Ok(homed), .. } = *report else { return };
        #[cfg(feature = "third-motor")]
        if let Some(steps) = status.skew_steps {
            self.out.line(format_args!(
                "[MSG:Squared: the {} motor was {} steps ahead]",
                Plain(if steps < 0 { "first" } else { "second" }),
                Whole(steps.unsigned_abs().into())
            ));
        }
        #[cfg(not(feature = "third-motor"))]
        let _ = status;
        let Some(kept) = self.kept.get_mut() else { return };
        let before = kept.homed.replace(homed);
        let StepperPlotterSettings { stored, backlash, .. } = self.settings;
        let axes = [
            (
                ("x", 130),
                homed.x_steps,
                before.map(|before| before.x_steps),
                self.settings.home_x.pull_off_steps.saturating_add(backlash.x_steps.into()),
                self.settings.x_steps_per_mm,
                stored.width_mm,
            ),
            (
                ("y", 131),
                homed.y_steps,
                before.map(|before| before.y_steps),
                self.settings.home_y.pull_off_steps.saturating_add(backlash.y_steps.into()),
                self.settings.y_steps_per_mm,
                stored.height_mm,
            ),
        ];
        for ((axis, setting), steps, before, lost_steps, steps_per_mm, side_mm) in axes {
            let reach_mm = f64::from(steps.saturating_sub(lost_steps)) / steps_per_mm;
            if let Some(before) = before
                && f64::from(steps.abs_diff(before)) > ALIKE_MM * steps_per_mm
            {
                self.out.line(format_args!(
                    "[MSG:Warning: {} is {} steps long, was {}]",
                    Plain(axis),
                    Whole(steps.into()),
                    Whole(before.into())
                ));
            } else if f64::from(side_mm) > reach_mm + BEYOND_MM {
                self.out.line(format_args!(
                    "[MSG:Warning: {} reaches {} mm, ${}={}]",
                    Plain(axis),
                    Thousandths::of(reach_mm),
                    Whole(setting),
                    Whole(side_mm.into())
                ));
            }
        }
    }
}
