//! [`timed_events`]: from operations to timed steps in one call.

use super::average::Average;
use super::{BacklashSteps, StepGen, StepGenSettings, TimedEvent};
use crate::kinematics::Cartesian;
use crate::planner::PlanError;
use crate::{Machine, Planner, PlannerSettings, PlotOp};
use core::iter;

/// Blocks of look-ahead: what a desktop has room for, four times those of the firmware.
const BLOCKS: usize = 64;

/// What the motors and the pen of a machine with stepper motors do for a tool path, and when: a [`Planner`]
/// that is kept full, a [`StepGen`] behind it, what averages the steps where the jerk is limited as a vector
/// (feature `averaged-steps`), and [`BacklashSteps`] for the play of its axes. The machine
/// stands at the origin with its pen up, as homing leaves it, and lifts the pen at the end. Operations are
/// taken as they are needed, so that a tool path of any length takes the same memory.
///
/// # Errors
///
/// [`PlanError::Setting`] for a limit of the machine that no motion can be planned with. As an item, an
/// operation that cannot be planned: the machine stops before it, and those after it are not taken, because a
/// line would begin where the tool path has none. The error comes as soon as it is known, before the last
/// events of what is planned.
///
/// ```
/// # use plotter_motion::stepgen::{MotorEvent, timed_events};
/// # use plotter_motion::{Machine, MachineConfig, PlotOp, Point, StepPair};
/// let machine = Machine::new(MachineConfig::stepper_plotter())?; // 87.58 steps/mm
/// let line = [PlotOp::Draw { to: Point::new(10.0, 0.0), feed_mm_s: None }];
/// let mut steps = 0;
/// for timed in timed_events(&machine, line)? {
///     if let MotorEvent::Step(StepPair { x, .. }) = timed?.event {
///         steps += i32::from(x);
///     }
/// }
/// assert_eq!(steps, 876);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn timed_events<I: IntoIterator<Item = PlotOp>>(
    machine: &Machine,
    ops: I,
) -> Result<impl Iterator<Item = Result<TimedEvent, PlanError>> + use<I>, PlanError> {
    let averaged = PlannerSettings::of(machine).planned()?;
    let mut planner = Planner::<BLOCKS>::new(averaged.settings)?;
    let timing = StepGenSettings::of(machine);
    let mut average = Average::of(&averaged, timing.clock_hz);
    let mut steps = StepGen::<Cartesian>::new(Cartesian::of(machine), timing);
    let mut play = BacklashSteps::of(machine, f64::from(timing.clock_hz));
    let mut ops = Some(ops.into_iter());
    Ok(iter::from_fn(move || {
        loop {
            if let Some(event) = play.next_event() {
                return Some(Ok(event));
            }
            // Never busy, nor is the generator below: all events before have been taken.
            if let Some(event) = average.next_event(|| steps.next_event()) {
                play.push(event).ok()?;
                continue;
            }
            while planner.has_room()
                && let Some(left) = &mut ops
            {
                match left.next().map(|op| planner.push(op)) {
                    Some(Ok(())) => {}
                    end => {
                        ops = None;
                        if let Err(error) = end.unwrap_or(Ok(())).and(planner.finish()) {
                            return Some(Err(error));
                        }
                    }
                }
            }
            let Some(action) = planner.next_action() else {
                match average.rest() {
                    Some(event) => play.push(event).ok()?,
                    None => return play.rest().map(Ok),
                }
                continue;
            };
            average.note(&action);
            steps.push(action).ok()?;
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stepgen::{Estimator, MotorEvent};
    use crate::{MachineConfig, Pen, Point, StepPair, toolpath::circle};
    use std::vec::Vec;

    fn machine() -> Machine {
        Machine::new(MachineConfig::stepper_plotter()).unwrap()
    }

    /// Against the time that is told without steps, of more operations than are planned ahead.
    #[test]
    fn the_last_event_is_at_the_time_that_is_estimated() {
        let machine = machine();
        let drawing = || circle(Point::new(50.0, 60.0), 20.0, 500);
        let events: Vec<_> = timed_events(&machine, drawing()).unwrap().collect::<Result<_, _>>().unwrap();
        assert!(events.is_sorted_by_key(|timed| timed.tick));
        let (settings, timing) = (PlannerSettings::of(&machine), StepGenSettings::of(&machine));
        let mut estimator = Estimator::<BLOCKS>::new(settings, timing).unwrap();
        drawing().for_each(|op| estimator.push(op).unwrap());
        let total = estimator.finish().unwrap().total;
        // The pen settles after the last event, by which it was lifted.
        assert_eq!(events.last().unwrap().event, MotorEvent::Pen(Pen::Up));
        let last = core::time::Duration::from_micros(events.last().unwrap().tick) + timing.pen_settle;
        assert!(total.abs_diff(last).as_micros() <= 1, "{last:?}, estimated {total:?}");
    }

    #[test]
    fn the_play_of_an_axis_is_taken_up() {
        let mut config = MachineConfig::stepper_plotter();
        config.steppers_mut().unwrap().x.backlash_mm = 0.1; // 8.758 steps: 9
        let machine = Machine::new(config).unwrap();
        let to = |x| PlotOp::Draw { to: Point::new(x, 0.0), feed_mm_s: None };
        let mut steps = [0, 0];
        for timed in timed_events(&machine, [to(10.0), to(0.0)]).unwrap() {
            if let MotorEvent::Step(StepPair { x, .. }) = timed.unwrap().event {
                steps[usize::from(x < 0)] += i32::from(x);
            }
        }
        // 876 each way, and the play at the start, forwards, and where it turns round.
        assert_eq!(steps, [885, -885]);
    }

    #[test]
    fn nothing_is_drawn_after_an_operation_that_cannot_be_planned() {
        let line = |x| PlotOp::Draw { to: Point::new(x, 0.0), feed_mm_s: None };
        let mut taken = 0;
        let ops = [line(1.0), line(f64::NAN), line(3.0)].into_iter().inspect(|_| taken += 1);
        let (mut steps, mut errors, mut pen) = (0, Vec::new(), Pen::Up);
        for timed in timed_events(&machine(), ops).unwrap() {
            match timed.map(|timed| timed.event) {
                Ok(MotorEvent::Step(StepPair { x, .. })) => steps += i32::from(x),
                Ok(MotorEvent::Pen(now)) => pen = now,
                Ok(_) => {}
                Err(error) => errors.push(error),
            }
        }
        assert_eq!((taken, steps, pen), (2, 88, Pen::Up)); // 1 mm at 87.58 steps/mm
        assert!(matches!(errors[..], [PlanError::Place { .. }]), "{errors:?}");
    }
}
