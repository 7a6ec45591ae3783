//! A stepper plotter: two motors that lose steps where real ones do, four limit switches, a sheet of paper.

use super::{Act, ActError, Seen, Simulation, Told, World};
use crate::log::{Event, SwitchName};
use crate::player::{ControllerError, limit};
use core::time::Duration;
use plotter_motion::config::SteppersConfig;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{Activity, Dialect, StepperPlotterSettings};
use plotter_motion::kinematics::BeltSigns;
use plotter_motion::plant::StepperPlant;
use plotter_motion::{Axis, Direction, LimitSwitches, Machine, Pen, Point, SafetyGate};

/// How far it goes on at once.
const SLICE: Duration = Duration::from_millis(1);
/// A pressed switch opens so many steps behind where it closed, as the contact of one does; without it a
/// trembling rotor would press it many times.
const SWITCH_PLAY: f64 = 4.0;
/// How far behind its switch the carriage of an axis meets its stop, mm.
const BEHIND_SWITCH_MM: f64 = 3.0;

/// The machine with this description, at its origin, whose host speaks `dialect`.
pub(crate) fn steppers(
    machine: &Machine,
    dialect: Dialect,
) -> Result<Simulation<StepperPlotter, Steppers>, ControllerError> {
    let settings = StepperPlotterSettings::of(machine, dialect);
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let plotter = StepperPlotter::new(settings, gate)
        .map_err(|error| ControllerError { message: error.to_string() })?;
    Ok(Simulation::new(plotter, Steppers::of(machine), machine.config().serial.baud))
}

impl Told for StepperPlotter {
    fn told(&self, now: Duration) -> (&'static str, Option<f64>) {
        let status = self.status(now);
        let doing = match status.activity {
            _ if status.emergency_stop => "stopped by its button",
            Activity::Idle => "idle",
            Activity::Run => "draws",
            Activity::Jog => "is moved by hand",
            Activity::Hold { .. } => "is held",
            Activity::Home => "homes",
            Activity::Stopped => "stopped",
        };
        let laser = self.settings().laser.then(|| f64::from(status.laser) * 100.0 / 65_535.0);
        (doing, laser)
    }
}

/// One axis.
#[derive(Clone, Copy, Debug)]
struct Way {
    steps_per_mm: f64,
    /// From the lower switch to the origin, and from the lower to the upper switch, steps.
    origin: f64,
    length: f64,
    /// By how much the carriage is behind its motor for what was done to it.
    slipped: f64,
    held: bool,
    /// Switches at both ends: closed by the carriage, held by a hand, cut off.
    closed: [bool; 2],
    by_hand: [bool; 2],
    cut: [bool; 2],
}

impl Way {
    fn of(machine: &Machine, axis: Axis) -> Self {
        let config = machine.config();
        let steppers = SteppersConfig::of(machine);
        let (stepper, size_mm) = match axis {
            Axis::X => (steppers.x, config.area.width_mm),
            Axis::Y => (steppers.y, config.area.height_mm),
        };
        let homing = steppers.homing;
        // Both ends lie beyond the area, and farther apart than homing relies on.
        let length_mm = (size_mm + 2.0 * homing.pull_off_mm).max(homing.known_travel_mm + homing.pull_off_mm);
        Self {
            steps_per_mm: stepper.steps_per_mm,
            origin: homing.pull_off_mm * stepper.steps_per_mm,
            length: length_mm * stepper.steps_per_mm,
            slipped: 0.0,
            held: false,
            closed: [false; 2],
            by_hand: [false; 2],
            cut: [false; 2],
        }
    }

    /// Where the carriage is when its motor has made `steps` from the start, steps from the lower switch.
    fn carriage(&self, steps: f64) -> f64 {
        steps - self.slipped + self.origin
    }

    /// Whether a step that way comes to nothing.
    fn is_blocked(&self, steps: f64, sign: Direction) -> bool {
        let (at, behind) = (self.carriage(steps), BEHIND_SWITCH_MM * self.steps_per_mm);
        self.held
            || match sign {
                Direction::Minus => at <= -behind,
                Direction::Plus => at >= self.length + behind,
            }
    }

    fn look(&mut self, steps: f64) {
        let at = self.carriage(steps);
        let [lower, upper] = &mut self.closed;
        *lower = at <= if *lower { SWITCH_PLAY } else { 0.0 };
        *upper = at >= self.length - if *upper { SWITCH_PLAY } else { 0.0 };
    }

    fn pressed(&self, end: Direction) -> bool {
        let [lower, upper] = [0, 1].map(|end: usize| {
            let is = |of: [bool; 2]| of.get(end).copied().unwrap_or_default();
            (is(self.closed) || is(self.by_hand)) && !is(self.cut)
        });
        if end == Direction::Minus { lower } else { upper }
    }
}

/// What surrounds the controller of a stepper plotter.
#[derive(Clone, Debug)]
pub(crate) struct Steppers {
    plant: StepperPlant,
    /// How the motors move the axes if not each its own.
    belt: Option<BeltSigns>,
    ways: [Way; 2],
    told: LimitSwitches,
    paper_mm: Option<[f64; 2]>,
    on_paper: bool,
    now: Duration,
}

/// The name of a limit switch in a log.
pub(super) const fn name_of(axis: Axis, end: Direction) -> &'static str {
    match (axis, end) {
        (Axis::X, Direction::Minus) => "x-min",
        (Axis::X, Direction::Plus) => "x-max",
        (Axis::Y, Direction::Minus) => "y-min",
        (Axis::Y, Direction::Plus) => "y-max",
    }
}

/// A switch that has changed, as a log has it.
pub(super) fn switch(name: &str, pressed: bool) -> Option<Event> {
    SwitchName::new(name).ok().map(|name| Event::Switch { name, pressed })
}

/// The limit switches that have changed.
pub(super) fn changes(before: LimitSwitches, now: LimitSwitches) -> impl Iterator<Item = Event> {
    let ends = [Direction::Minus, Direction::Plus];
    let all = Axis::BOTH.into_iter().flat_map(move |axis| ends.map(|end| (axis, end)));
    all.filter_map(move |(axis, end)| {
        let pressed = now.blocks(axis, end);
        (pressed != before.blocks(axis, end)).then(|| switch(name_of(axis, end), pressed)).flatten()
    })
}

impl Steppers {
    pub(super) fn of(machine: &Machine) -> Self {
        let motor = SteppersConfig::of(machine).stepper_motor;
        Self {
            plant: StepperPlant::new(motor, motor),
            belt: None,
            ways: Axis::BOTH.map(|axis| Way::of(machine, axis)),
            told: LimitSwitches::RELEASED,
            paper_mm: None,
            on_paper: true,
            now: Duration::ZERO,
        }
    }

    /// The same with both motors on one belt.
    pub(super) fn with_belt(self, belt: Option<BeltSigns>) -> Self {
        Self { belt, ..self }
    }

    /// Where the motors have moved the axes, steps.
    fn moved(&self) -> [f64; 2] {
        let (first, second) = (self.plant.x.position_steps(), self.plant.y.position_steps());
        self.belt.map_or([first, second], |belt| {
            let (x, y) = belt.twice_axes(first, second);
            [x / 2.0, y / 2.0]
        })
    }

    /// What a step of a motor moves the axes by, steps.
    fn moved_by(&self, motor: Axis, sign: Direction) -> [f64; 2] {
        let step = f64::from(sign.sign());
        let (first, second) = if motor == Axis::X { (step, 0.0) } else { (0.0, step) };
        self.belt.map_or([first, second], |belt| {
            let (x, y) = belt.twice_axes(first, second);
            [x / 2.0, y / 2.0]
        })
    }

    fn way(&mut self, axis: Axis) -> &mut Way {
        let [x, y] = &mut self.ways;
        if axis == Axis::X { x } else { y }
    }

    fn at(&self) -> Point {
        let [x, y] = &self.ways;
        let [x_steps, y_steps] = self.moved();
        let mm = |way: &Way, steps: f64| (steps - way.slipped) / way.steps_per_mm;
        Point::new(mm(x, x_steps), mm(y, y_steps))
    }

    fn is_on_paper(&self) -> bool {
        let at = self.at();
        self.paper_mm
            .is_none_or(|[width, height]| (0.0..=width).contains(&at.x) && (0.0..=height).contains(&at.y))
    }
}

impl World for Steppers {
    fn slice(&self) -> Duration {
        SLICE
    }

    fn step(&mut self, at: Duration, axis: Axis, sign: Direction) {
        let (moved, by) = (self.moved(), self.moved_by(axis, sign));
        for (way, (steps, by)) in self.ways.iter_mut().zip(moved.into_iter().zip(by)) {
            let towards = if by < 0.0 { Direction::Minus } else { Direction::Plus };
            if by != 0.0 && way.is_blocked(steps, towards) {
                way.slipped += by;
            }
        }
        self.plant.pulse(at, axis, sign);
    }

    fn go_on(&mut self, at: Duration, _: [i32; 2], pen: Option<Pen>) -> Vec<Event> {
        self.now = at;
        self.plant.run_to(at);
        let moved = self.moved();
        self.ways.iter_mut().zip(moved).for_each(|(way, steps)| way.look(steps));
        let [x, y] = &self.ways;
        let now = LimitSwitches {
            x_min: x.pressed(Direction::Minus),
            x_max: x.pressed(Direction::Plus),
            y_min: y.pressed(Direction::Minus),
            y_max: y.pressed(Direction::Plus),
        };
        let mut events: Vec<Event> = changes(self.told, now).collect();
        self.told = now;
        let on_paper = self.is_on_paper() || pen != Some(Pen::Down);
        if self.paper_mm.is_some() && on_paper != core::mem::replace(&mut self.on_paper, on_paper) {
            events.extend(switch("paper", on_paper));
        }
        events
    }

    fn act(&mut self, act: &Act) -> Result<Vec<Event>, ActError> {
        let place = |end| usize::from(end == Direction::Plus);
        match act {
            Act::Press(name) | Act::Release(name) | Act::Cut(name) => {
                let pressed = matches!(act, Act::Press(_));
                let Some((axis, end)) = limit(name) else {
                    return match act {
                        Act::Cut(_) => {
                            Err(ActError { message: format!("{}: no limit switch", name.as_str()) })
                        }
                        _ => Ok(vec![Event::Switch { name: name.clone(), pressed }]),
                    };
                };
                let way = self.way(axis);
                let which = if matches!(act, Act::Cut(_)) { &mut way.cut } else { &mut way.by_hand };
                if let Some(switch) = which.get_mut(place(end)) {
                    *switch = pressed || matches!(act, Act::Cut(_));
                }
                Ok(Vec::new()) // told when the machine goes on
            }
            Act::Button { pressed } => Ok(vec![Event::Estop(*pressed)]),
            Act::Reset => Ok(["reset"].into_iter().filter_map(|name| switch(name, true)).collect()),
            Act::Restart => Ok(["restart"].into_iter().filter_map(|name| switch(name, true)).collect()),
            Act::Hold { axis, held } => {
                self.way(*axis).held = *held;
                let word = if *held { "held" } else { "let go" };
                let axis = if *axis == Axis::X { "x" } else { "y" };
                Ok(vec![Event::Note(format!("the carriage of axis {axis} is {word}"))])
            }
            Act::Lose { axis, steps } => {
                self.way(*axis).slipped += f64::from(*steps);
                let axis = if *axis == Axis::X { "x" } else { "y" };
                Ok(vec![Event::Note(format!("the carriage of axis {axis} is pushed by {steps} steps"))])
            }
            Act::Paper { width_mm, height_mm } => {
                let size = [*width_mm, *height_mm];
                self.paper_mm = (size != [0.0; 2]).then_some(size);
                Ok(vec![Event::Note(format!("a sheet of {width_mm} x {height_mm} mm lies at the origin"))])
            }
        }
    }

    fn look(&self, seen: &mut Seen) {
        seen.at = self.at();
        seen.pressed = self.told;
        seen.is_off_paper = !self.is_on_paper();
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let slipped = self.ways.map(|way| way.slipped as i64);
        let [x, y] = slipped;
        seen.lost_steps =
            [self.plant.x.lost_steps().saturating_add(x), self.plant.y.lost_steps().saturating_add(y)];
    }
}
