//! The gate: what it keeps back, whoever asks.

use super::*;
use crate::{StepPair, safety::Blocked};

const STEP: StepPair = StepPair { x: 1, y: 1 };
const TRAVEL: PlotOp = PlotOp::Travel { to: Point::new(1.0, 0.0) };

fn motion(gate: SafetyGate) -> Motion {
    let settings = StepperPlotterSettings { dialect: Dialect::Grbl, ..StepperPlotterSettings::default() };
    let Ok(motion) = Motion::new(settings, gate) else { panic!("the default can be planned with") };
    motion
}

/// How many steps come of a command.
fn steps_of(motion: &mut Motion, link: &mut Link, command: Command) -> usize {
    assert_eq!(link.commands.push(command), Ok(()));
    let mut steps = 0;
    for ms in 0..2_000 {
        while motion.poll(Duration::from_millis(ms), Drivers::Ready, link).is_some() {
            steps += 1;
        }
    }
    steps
}

#[test]
fn the_gate_refuses_what_is_demanded_between_the_hosts_reset_and_its_going_on() {
    let mut link = Link::default();
    let mut motion = motion(SafetyGate::new(LimitSwitches::RELEASED, false));
    assert!(motion.gate.pass_step(STEP).is_ok());
    motion.signal(Duration::ZERO, Signal::Reset, &mut link);
    assert_eq!(motion.gate.pass_step(STEP), Err(Blocked::Stopped));
    assert_eq!(motion.gate.pass_laser(u16::MAX), Beam::OFF);
    // It is no emergency, for which a person must come to the machine.
    assert!(!motion.status(Duration::ZERO).emergency_stop);
    assert_eq!(steps_of(&mut motion, &mut link, Command::Plot(TRAVEL)), 0);
    assert_eq!(motion.gate.pass_step(STEP), Err(Blocked::Stopped));
    assert_eq!(steps_of(&mut motion, &mut link, Command::GoOn), 0);
    assert!(motion.gate.pass_step(STEP).is_ok());
    assert!(steps_of(&mut motion, &mut link, Command::Plot(TRAVEL)) > 0);
}

#[test]
fn a_button_that_was_pressed_before_the_start_lets_nothing_move() {
    for op in [TRAVEL, PlotOp::Draw { to: Point::ORIGIN, feed_mm_s: None }] {
        let mut link = Link::default();
        let mut motion = motion(SafetyGate::new(LimitSwitches::RELEASED, true));
        let pen_deg = motion.pen_deg();
        assert_eq!(steps_of(&mut motion, &mut link, Command::Plot(op)), 0);
        assert_eq!(motion.pen_deg(), pen_deg, "{op:?}");
        let reported = link.reports.pop();
        assert!(matches!(reported, Some(Report::Stopped { why: Stop::Emergency, .. })), "{reported:?}");
    }
}
