//! A marking board: two DC motors on one belt. Its controller has no serial line; who reads digits for it
//! tells it each target, and says `+` when it has arrived.

use super::steppers::{changes, switch};
use super::{Act, ActError, Seen, Simulation, Told, World};
use crate::log::Event;
use crate::player::AnsweringBoard;
use core::time::Duration;
use plotter_motion::config::DcConfig;
use plotter_motion::firmware::MarkingBoardSettings;
use plotter_motion::kinematics::Kinematics as _;
use plotter_motion::plant::{MarkingBoardPlant, MarkingBoardPlantSettings};
use plotter_motion::{Axis, Direction, Duty, LimitSwitches, Machine, Pen, Point, StepPoint};

/// Time step of the motors.
const SLICE: Duration = Duration::from_micros(50);

/// The board of this machine, where it stands when it is switched on.
pub(crate) fn belt(machine: &Machine) -> Simulation<AnsweringBoard, Belt> {
    let config = machine.config();
    let dc = DcConfig::of(machine);
    let silence = Duration::from_secs_f64(config.serial.resync_gap_ms / 1e3);
    let plant = MarkingBoardPlantSettings::of(machine);
    let world = Belt {
        plant: MarkingBoardPlant::new(&plant, SLICE.as_secs_f64()),
        settings: MarkingBoardSettings::of(machine),
        pwm_steps: f64::from(AnsweringBoard::PWM_STEPS),
        mm_per_count: 1.0 / dc.x.counts_per_mm,
        now: Duration::ZERO,
        by_hand: LimitSwitches::RELEASED,
        told: LimitSwitches::RELEASED,
    };
    Simulation::new(AnsweringBoard::new(machine), world, config.serial.baud).reading_digits(silence)
}

impl Told for AnsweringBoard {
    fn told(&self, _: Duration) -> (&'static str, Option<f64>) {
        let doing = match (self.board().gate().is_stopped(), self.board().has_arrived()) {
            (true, _) => "stopped by its button",
            (_, true) => "idle",
            (_, false) => "draws",
        };
        (doing, None)
    }

    fn counting(&self, motor: Axis) -> Option<Direction> {
        self.board().counting(motor)
    }
}

/// What surrounds the controller of a marking board.
#[derive(Debug)]
pub(crate) struct Belt {
    plant: MarkingBoardPlant,
    settings: MarkingBoardSettings,
    pwm_steps: f64,
    mm_per_count: f64,
    now: Duration,
    by_hand: LimitSwitches,
    told: LimitSwitches,
}

impl World for Belt {
    fn slice(&self) -> Duration {
        SLICE
    }

    fn go_on(&mut self, at: Duration, duties: [i32; 2], _: Option<Pen>) -> Vec<Event> {
        let mut events = Vec::new();
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of a duty")]
        let duties = duties.map(|duty| Duty::saturating((f64::from(duty) / self.pwm_steps) as f32));
        while at.saturating_sub(self.now) >= SLICE {
            self.now = self.now.saturating_add(SLICE);
            self.plant.step(duties, |axis| events.push(Event::Edge { axis, sign: Direction::Plus }));
        }
        let (by_carriage, by_hand) = (self.plant.limit_switches(), self.by_hand);
        let now = LimitSwitches {
            x_min: by_carriage.x_min || by_hand.x_min,
            x_max: by_carriage.x_max || by_hand.x_max,
            y_min: by_carriage.y_min || by_hand.y_min,
            y_max: by_carriage.y_max || by_hand.y_max,
        };
        events.extend(changes(self.told, now));
        self.told = now;
        events
    }

    fn act(&mut self, act: &Act) -> Result<Vec<Event>, ActError> {
        match act {
            Act::Press(name) | Act::Release(name) => {
                let pressed = matches!(act, Act::Press(_));
                match crate::player::limit(name) {
                    Some((axis, end)) => {
                        self.by_hand.set(axis, end, pressed);
                        Ok(Vec::new())
                    }
                    None => Ok(vec![Event::Switch { name: name.clone(), pressed }]),
                }
            }
            Act::Button { pressed } => Ok(vec![Event::Estop(*pressed)]),
            Act::Reset => Ok(["reset"].into_iter().filter_map(|name| switch(name, true)).collect()),
            _ => Err(ActError {
                message: String::from("the marking board has press, release, stop, free and reset"),
            }),
        }
    }

    fn look(&self, seen: &mut Seen) {
        seen.at = self.plant.position_mm();
        seen.pressed = self.told;
    }

    fn target(&self, counts: StepPoint) -> Option<StepPoint> {
        let MarkingBoardSettings { belt, start, most, .. } = self.settings;
        let at = Point::new(f64::from(counts.x) * self.mm_per_count, f64::from(counts.y) * self.mm_per_count);
        // (a count at the border is inside, however that is rounded)
        let half = 0.5 * self.mm_per_count;
        let inside = at.x <= most.x + half && at.y <= most.y + half;
        inside.then(|| belt.steps_at(Point::ORIGIN + (at - start)))
    }
}
