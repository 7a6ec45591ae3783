//! A circle on axes with play, with and without extra steps.

use crate::auditor;
use crate::drawings;

use auditor::run;
use plotter_motion::kinematics::Backlash;
use plotter_motion::{
    Pen, PlannerSettings, Point, StepPair,
    stepgen::{BacklashSteps, MotorEvent, StepGenSettings, TimedEvent},
};

const STEPS_PER_MM: f64 = 100.0;
/// 0.2 mm, as belts of a cheap plotter have.
const PLAY: Backlash = Backlash { x_steps: 20, y_steps: 20 };
/// Extra steps 0.1 ms apart: 2 ms for all.
const INTERVAL_TICKS: u64 = 100;

/// An axis whose carriage is pushed by one flank of a gap or by the other: it follows the motor where that
/// leaves the gap.
#[derive(Default)]
struct Carriage {
    motor: i32,
    /// Lower flank of the gap, as seen from the motor.
    at: i32,
}

impl Carriage {
    fn step(&mut self, by: i8, play: i32) {
        self.motor += i32::from(by);
        // Driven backwards last, the motor stands at the lower flank.
        self.at = self.at.clamp(self.motor - play, self.motor);
    }
}

/// Farthest that the carriage is from the circle of the drawing while it draws, mm, and where it ends.
fn drawn(take_up: bool) -> (f64, Point) {
    let play = if take_up { PLAY } else { Backlash::default() };
    let mut steps = BacklashSteps::new(play, INTERVAL_TICKS);
    let (mut x, mut y) = (Carriage::default(), Carriage::default());
    let mut farthest = 0.0_f64;
    let mut drawing = false;
    let (x_play, y_play) = (i32::from(PLAY.x_steps), i32::from(PLAY.y_steps));
    let mut apply = |event: TimedEvent| match event.event {
        MotorEvent::Step(StepPair { x: dx, y: dy }) => {
            x.step(dx, x_play);
            y.step(dy, y_play);
            let place = Point::new(f64::from(x.at) / STEPS_PER_MM, f64::from(y.at) / STEPS_PER_MM);
            if drawing {
                farthest = farthest.max((place.distance(Point::new(50.0, 50.0)) - 20.0).abs());
            }
            place
        }
        MotorEvent::Pen(pen) => {
            drawing = pen == Pen::Down;
            Point::new(f64::from(x.at) / STEPS_PER_MM, f64::from(y.at) / STEPS_PER_MM)
        }
        _ => Point::ORIGIN,
    };
    let mut end = Point::ORIGIN;
    let settings = PlannerSettings { speed_mm_s: 20.0, ..PlannerSettings::default() };
    run::<16>(
        settings,
        StepGenSettings::default(),
        STEPS_PER_MM,
        &drawings::circle().ops,
        |_, _, _| {},
        |tick, event| {
            assert_eq!(steps.push(TimedEvent { tick, event }), Ok(()));
            while let Some(event) = steps.next_event() {
                end = apply(event);
            }
        },
    );
    while let Some(event) = steps.rest() {
        end = apply(event);
    }
    (farthest, end)
}

#[test]
fn extra_steps_take_up_the_play() {
    let (with, end) = drawn(true);
    let (without, _) = drawn(false);
    // While the play is taken up the carriage waits: 2 ms at 20 mm/s are 0.04 mm, but across the circle far
    // less.
    assert!(with < 0.03, "{with} mm off with extra steps");
    assert!(without > 0.15, "{without} mm off without");
    assert_eq!(end, Point::new(70.0, 50.0));
}
