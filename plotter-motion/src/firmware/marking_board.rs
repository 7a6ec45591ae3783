//! The marking board's controller: one belt, two DC motors, encoders that only count up.

use crate::config::OneBeltConfig;
use crate::control::{ChosenController, LineController, SpeedMeter};
use crate::kinematics::{CoreXy, Kinematics};
use crate::{
    Axis, Demand, Direction, Drive, Duty, LimitSwitches, Machine, Pen, PenMove, PlotOp, Point, SafetyGate,
    StepPoint,
    config::ControllerChoice,
    encoder::PulseCounter,
    toolpath::{OutOfReach, chords},
};
use core::time::Duration;

/// What the controller of a marking board must know besides what its [`LineController`] does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MarkingBoardSettings {
    /// Directions and encoder pulses to the millimetre.
    pub belt: CoreXy,
    /// Where the pen is when it is switched on, mm.
    pub start: Point,
    /// Greatest coordinates, mm.
    pub most: Point,
    /// By how much the speed of either motor may differ from their mean, 0 to 1: see
    /// [`SafetyGate::pass_belt`]. If the counts say that the carriage goes towards a pressed switch all the
    /// same, 1 is taken until no switch is pressed.
    pub unequal_share: f32,
    /// How long no pulse must have come from a motor until it is driven the other way. Before that it may
    /// still run down, and its pulses would be counted the wrong way. 0 for the published controller, which
    /// did not wait.
    pub run_down: Duration,
    /// Speed of the pen from which on the speed meters' window has its full length, mm/s. Source: Khan and
    /// McGinn, "2D Controlled Marking Board", section 0.2.5: 100 ms do at 30 mm/s.
    pub speed_window_mm_s: f64,
}

impl MarkingBoardSettings {
    /// Those of a machine with a belt; run-down and share are those of the controller that it names.
    ///
    /// The documented board has 30 ms for the run-down: when no mark has come for 30 ms from a motor that
    /// friction slows down by a counts/s², it has made less than a count in that time and so turns by at most
    /// (1 − a 0.03²/2)/0.03 counts/s now: with a = 500/s² 26 counts/s, which end after two thirds of a count,
    /// with the 1930/s² of the simulated motors after a hundredth.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let (area, config) = (machine.config().area, OneBeltConfig::of(machine));
        let (unequal_share, run_down_ms) = match config.dc.control.controller {
            ControllerChoice::Published => {
                (config.point_to_point.unequal_share, config.point_to_point.run_down_ms)
            }
            ControllerChoice::Contouring => (config.belt.unequal_share, config.belt.run_down_ms),
        };
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let unequal_share = unequal_share as f32;
        Self {
            belt: CoreXy::of(machine),
            start: Point::new(config.belt.start_x_mm, config.belt.start_y_mm),
            most: Point::new(area.width_mm, area.height_mm),
            unequal_share,
            run_down: Duration::from_secs_f64(run_down_ms * 1e-3),
            speed_window_mm_s: config.belt.speed_window_mm_s,
        }
    }

    /// The moves of a tool path in counts of both motors, from where the pen is when it is switched on; arcs
    /// become chords that lie within half a count of them. Operations that do not move the pen are left out.
    ///
    /// # Errors
    ///
    /// [`OutOfReach`] for a point outside the board or one that is not finite. The moves after it follow; the
    /// line that would have begun there is a move with the pen up, so that nothing is drawn that the tool
    /// path does not hold.
    ///
    /// ```
    /// # use plotter_motion::firmware::MarkingBoardSettings;
    /// # use plotter_motion::{Machine, MachineConfig, Point, StepPoint, toolpath::rectangle};
    /// let board = MarkingBoardSettings::of(&Machine::new(MachineConfig::marking_board())?);
    /// let corners = board.moves(rectangle(board.start, 10.0, 20.0)).filter_map(Result::ok);
    /// let targets: Vec<StepPoint> = corners.map(|corner| corner.target).collect();
    /// // up 20 mm, right 10 mm, down, left
    /// let expected = [(0, 0), (-926, 926), (-463, 1389), (463, 463), (0, 0)];
    /// assert_eq!(targets, expected.map(|(first, second)| StepPoint::new(first, second)));
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    pub fn moves<I: IntoIterator<Item = PlotOp>>(
        &self,
        ops: I,
    ) -> impl Iterator<Item = Result<PenMove, OutOfReach>> + use<I> {
        let Self { belt, start, most, .. } = *self;
        let mut lost = false;
        chords(ops, 0.5 / belt.steps_per_mm()).enumerate().filter_map(move |(index, op)| {
            let (pen, point) = match op {
                PlotOp::Travel { to } => (Pen::Up, to),
                PlotOp::Draw { to, .. } => (Pen::Down, to),
                _ => return None,
            };
            let outside = |axis, coordinate: f64, most_mm: f64| {
                let inside = (0.0..=most_mm).contains(&coordinate);
                (!inside).then_some(OutOfReach { index, point, axis, most_mm })
            };
            if let Some(error) =
                outside(Axis::X, point.x, most.x).or_else(|| outside(Axis::Y, point.y, most.y))
            {
                lost = true;
                return Some(Err(error));
            }
            let pen = if core::mem::take(&mut lost) { Pen::Up } else { pen };
            Some(Ok(PenMove { pen, target: belt.steps_at(Point::ORIGIN + (point - start)) }))
        })
    }
}

/// One motor: its counter, when its last pulse came, and its speed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BoardMotor {
    counter: PulseCounter,
    last_pulse: Option<Duration>,
    meter: SpeedMeter,
}

impl BoardMotor {
    /// Whether a drive in `direction` would reverse a motor that may still turn.
    fn must_wait(&self, now: Duration, run_down: Duration, duty: Duty) -> bool {
        let reverses =
            duty.direction().zip(self.counter.direction()).is_some_and(|(wanted, turning)| wanted != turning);
        reverses && self.last_pulse.is_some_and(|at| now.saturating_sub(at) < run_down)
    }
}

/// The whole controller of the marking board, sans-IO, round a controller of its two motors.
///
/// ```text
///   PenMove ─▶ LineController ─▶ drive of motors ─▶ none that reverses a running motor ─▶ as axes ─▶ SafetyGate ─▶ Drive
///                   ▲                                                                                │
///   pulses ─▶ PulseCounter, latched sign ◀──────────────────────────────────────────────────────────┘
/// ```
///
/// Inputs: [`start`](Self::start), [`pulse`](Self::pulse), [`limit_switches`](Self::limit_switches),
/// [`emergency_stop`](Self::emergency_stop), [`tick`](Self::tick) at [`next_tick`](Self::next_tick). After
/// each of them the motors get [`drive`](Self::drive), the pen goes where [`pen`](Self::pen) says. Times
/// never go back. A move is done when [`has_arrived`](Self::has_arrived) says so.
///
/// ```
/// # use plotter_motion::firmware::MarkingBoard;
/// # use plotter_motion::{LimitSwitches, Machine, MachineConfig, Pen, PenMove, SafetyGate, StepPoint};
/// # use plotter_motion::config::ControllerChoice;
/// # use core::time::Duration;
/// let mut config = MachineConfig::marking_board();
/// if let Some(dc) = config.dc_mut() {
///     dc.control.controller = ControllerChoice::Published;
/// }
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false); // what switches and button say
/// let mut board = MarkingBoard::of(&Machine::new(config)?, gate);
/// board.start(Duration::ZERO, PenMove { pen: Pen::Down, target: StepPoint::new(463, 463) }); // 10 mm to the right
/// board.tick(Duration::from_millis(5));
/// assert!(board.drive().x().value() > 0.0 && board.drive().x() == board.drive().y());
/// board.emergency_stop(Duration::from_millis(6), true);
/// assert_eq!(board.drive().x().value(), 0.0);
/// # Ok::<(), plotter_motion::ConfigError>(())
/// ```
#[derive(Debug, PartialEq)]
pub struct MarkingBoard<C> {
    settings: MarkingBoardSettings,
    controller: C,
    gate: SafetyGate,
    motors: [BoardMotor; 2],
    /// What the controller asked of both motors last.
    demand: Demand,
    drive: Drive<'static>,
    /// The move since a switch was noted last, in counts of both motors.
    since_switch: [i16; 2],
    /// Whether the carriage has gone towards a switch while it was pressed.
    goes_into_switch: bool,
    pen: Pen,
    under_way: bool,
    points_done: u32,
    next_run: Option<Duration>,
    next_sample: Duration,
}

impl MarkingBoard<ChosenController> {
    /// The controller of `machine`, at rest where it is switched on, with its switches and its button as the
    /// gate has them.
    #[must_use]
    pub fn of(machine: &Machine, gate: SafetyGate) -> Self {
        Self::new(MarkingBoardSettings::of(machine), ChosenController::of(machine), gate)
    }
}

impl<C: LineController> MarkingBoard<C> {
    /// The board at rest where it is switched on, its controller at the origin of its counts.
    #[must_use]
    pub fn new(settings: MarkingBoardSettings, controller: C, gate: SafetyGate) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let full_window_counts_s = (settings.speed_window_mm_s * settings.belt.steps_per_mm()) as f32;
        let motor = BoardMotor {
            counter: PulseCounter::default(),
            last_pulse: None,
            meter: SpeedMeter::new(full_window_counts_s),
        };
        Self {
            settings,
            next_run: controller.period(),
            controller,
            gate,
            motors: [motor; 2],
            demand: Demand::NONE,
            drive: Drive::default(),
            since_switch: [0; 2],
            goes_into_switch: false,
            pen: Pen::Up,
            under_way: false,
            points_done: 0,
            next_sample: SpeedMeter::PERIOD,
        }
    }

    /// Takes the next move, in counts of both motors as [`MarkingBoardSettings::moves`] makes them. One that
    /// comes before the last has arrived takes its place.
    pub fn start(&mut self, now: Duration, next: PenMove) {
        self.pen = next.pen;
        self.under_way = true;
        let demand = self.controller.start(now, next.target);
        self.apply(now, demand);
    }

    /// Takes a pulse of the first motor's encoder (`X`) or of the second's (`Y`). One that comes before that
    /// motor was ever driven is not counted: nobody knows which way it was turned.
    pub fn pulse(&mut self, now: Duration, motor: Axis) {
        let [first, second] = &mut self.motors;
        let pulsed = match motor {
            Axis::X => first,
            Axis::Y => second,
        };
        pulsed.counter.pulses(1);
        pulsed.last_pulse = Some(now);
        if let Some(direction) = pulsed.counter.direction() {
            if self.gate.limits().any() {
                self.watch_switches(motor, direction);
            }
            let demand = self.controller.edge(now, motor, direction);
            self.apply(now, demand);
        }
    }

    /// Notes a pulse while a switch is pressed, and whether the carriage has gone towards it by now. The gate
    /// was told how unequal the motors are; motors that differ by more would creep into the switch for as
    /// long as the carriage moves along it.
    fn watch_switches(&mut self, motor: Axis, direction: Direction) {
        let [first, second] = &mut self.since_switch;
        let moved = match motor {
            Axis::X => &mut *first,
            Axis::Y => &mut *second,
        };
        *moved = moved.saturating_add(if direction == Direction::Plus { 1 } else { -1 });
        let (x, y) = self.settings.belt.signs().twice_axes(i32::from(*first), i32::from(*second));
        let LimitSwitches { x_min, x_max, y_min, y_max } = self.gate.limits();
        self.goes_into_switch |= x_min && x < 0 || x_max && x > 0 || y_min && y < 0 || y_max && y > 0;
    }

    /// When [`tick`](Self::tick) is to be called next.
    #[must_use]
    pub fn next_tick(&self) -> Duration {
        self.next_run.map_or(self.next_sample, |run| run.min(self.next_sample))
    }

    /// Samples the speeds and runs the control loop, if it is time. One that was held up runs once, and from
    /// then on in its period.
    pub fn tick(&mut self, now: Duration) {
        if now >= self.next_sample {
            self.next_sample = next(self.next_sample, SpeedMeter::PERIOD, now);
            for motor in &mut self.motors {
                motor.meter.sample(motor.counter.position());
            }
        }
        let (Some(due), Some(period)) = (self.next_run, self.controller.period()) else {
            return;
        };
        if now >= due {
            self.next_run = Some(next(due, period, now));
            let demand = self.controller.tick(now);
            self.apply(now, demand);
        }
    }

    /// Takes the state of all limit switches.
    pub fn limit_switches(&mut self, now: Duration, pressed: LimitSwitches) {
        if pressed != self.gate.limits() {
            self.gate.set_limits(pressed);
            self.since_switch = [0; 2];
            self.goes_into_switch &= pressed.any();
            self.apply(now, self.demand);
        }
    }

    /// Takes the state of the emergency stop button; pressed, it stops both motors at once and latches.
    pub fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        self.gate.emergency_stop(pressed);
        self.apply(now, self.demand);
    }

    /// Lets the motors go on after an emergency stop, unless the button is still pressed; says whether it
    /// did.
    pub fn reset_emergency_stop(&mut self, now: Duration) -> bool {
        let free = self.gate.reset();
        self.apply(now, self.demand);
        free
    }

    fn apply(&mut self, now: Duration, demand: Demand) {
        self.demand = demand;
        let Self { settings: MarkingBoardSettings { belt, unequal_share, run_down, .. }, .. } = *self;
        let [first, second] = &self.motors;
        let waits = |motor: &BoardMotor, duty: Duty| motor.must_wait(now, run_down, duty);
        let unless_it_waits = |motor, duty: Duty| if waits(motor, duty) { 0.0 } else { duty.value() };
        let (x, y) =
            belt.signs().twice_axes(unless_it_waits(first, demand.x), unless_it_waits(second, demand.y));
        let axes = Demand { x: Duty::saturating(0.5 * x), y: Duty::saturating(0.5 * y) };
        let unequal_share = if self.goes_into_switch { 1.0 } else { unequal_share };
        let drive = self.gate.pass_belt(axes, belt.signs(), unequal_share).kept();
        // What the gate took of one axis may have left a motor to be reversed. To take the drive of that
        // motor alone could lead into the switch, so neither gets any until it stands.
        self.drive =
            if waits(first, drive.x()) || waits(second, drive.y()) { Drive::default() } else { drive };
        let [first, second] = &mut self.motors;
        first.counter.driven(self.drive.x());
        second.counter.driven(self.drive.y());
        self.controller.applied(self.drive);
        if self.under_way && self.controller.has_arrived() {
            self.under_way = false;
            self.points_done = self.points_done.saturating_add(1);
        }
    }

    /// Drive of both motors.
    #[must_use]
    pub const fn drive(&self) -> Drive<'_> {
        self.drive
    }

    /// Whether the pen is to be on the sheet: as the move under way has it, and up when it is done or an
    /// emergency stop is latched. The move after it is to be started in the same turn if the pen is to stay
    /// down.
    #[must_use]
    pub const fn pen(&self) -> Pen {
        if self.under_way && !self.gate.is_stopped() { self.pen } else { Pen::Up }
    }

    /// Whether the last move is done.
    #[must_use]
    pub const fn has_arrived(&self) -> bool {
        !self.under_way
    }

    /// How many moves are done since the start.
    #[must_use]
    pub const fn points_done(&self) -> u32 {
        self.points_done
    }

    /// Counts of both motors since the start.
    #[must_use]
    pub fn counts(&self) -> StepPoint {
        let [first, second] = &self.motors;
        StepPoint::new(first.counter.position(), second.counter.position())
    }

    /// Where the pen is by those counts, mm.
    #[must_use]
    pub fn position_mm(&self) -> Point {
        self.settings.start + (self.settings.belt.point_at(self.counts().into()) - Point::ORIGIN)
    }

    /// Speeds of both motors, counts/s.
    #[must_use]
    pub fn speeds_counts_s(&self) -> [f32; 2] {
        self.motors.map(|motor| motor.meter.speed_counts_s())
    }

    /// Direction in which the pulses of a motor are counted; `None` before it was driven.
    #[must_use]
    pub fn counting(&self, motor: Axis) -> Option<Direction> {
        let [first, second] = &self.motors;
        match motor {
            Axis::X => first.counter.direction(),
            Axis::Y => second.counter.direction(),
        }
    }

    /// The safety gate, to look at.
    #[must_use]
    pub const fn gate(&self) -> &SafetyGate {
        &self.gate
    }
}

/// The next time in a period, after `now`; what a loop missed that was held up is not made up for.
fn next(due: Duration, period: Duration, now: Duration) -> Duration {
    let regular = due.saturating_add(period);
    if regular > now { regular } else { now.saturating_add(period) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{PointToPoint, PointToPointSettings};
    use std::vec::Vec;

    const MS: Duration = Duration::from_millis(1);

    fn settings() -> MarkingBoardSettings {
        MarkingBoardSettings::of(&Machine::new(crate::MachineConfig::marking_board()).unwrap())
    }

    /// A board on its way to the right, with one pulse of either motor 10 ms ago.
    fn moving() -> MarkingBoard<PointToPoint> {
        let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        let mut board =
            MarkingBoard::new(settings(), PointToPoint::new(PointToPointSettings::default()), gate);
        board.start(Duration::ZERO, PenMove { pen: Pen::Down, target: StepPoint::new(463, 463) });
        board.tick(5 * MS);
        board.pulse(10 * MS, Axis::X);
        board.pulse(10 * MS, Axis::Y);
        board.tick(20 * MS);
        board
    }

    #[test]
    fn an_arc_becomes_lines_and_what_is_out_of_reach_is_not_drawn() {
        let draw = |x, y| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
        let centre = Point::new(150.0, 110.0);
        let half = PlotOp::DrawArc {
            centre,
            sweep_rad: core::f64::consts::PI,
            to: Point::new(150.0, 120.0),
            feed_mm_s: None,
        };
        let ops = [PlotOp::Travel { to: Point::new(150.0, 100.0) }, half, PlotOp::NewPage];
        let moves: Vec<PenMove> = settings().moves(ops).map(Result::unwrap).collect();
        assert!(moves.len() > 10);
        assert_eq!(moves.last().map(|last| last.target), Some(StepPoint::new(-926, 926)));
        let belt = settings().belt;
        for to in &moves {
            let at = belt.point_at(to.target.into()) + (settings().start - Point::ORIGIN);
            assert!((at.distance(centre) - 10.0).abs() < 0.5 * 2.0_f64.sqrt() / 46.3, "{at:?}");
        }
        let ops = [draw(200.0, 100.0), draw(300.1, 100.0), draw(150.0, 100.0), draw(150.0, f64::NAN)];
        let moves: Vec<_> = settings().moves(ops).collect();
        assert_eq!(moves[1].as_ref().unwrap_err().axis, Axis::X);
        assert_eq!(moves[2].as_ref().unwrap().pen, Pen::Up);
        assert_eq!(moves[3].as_ref().unwrap_err().axis, Axis::Y);
    }

    #[test]
    fn a_motor_that_may_still_turn_is_not_reversed() {
        let mut board = moving();
        assert!(board.drive().x().value() > 0.0);
        board.start(20 * MS, PenMove { pen: Pen::Up, target: StepPoint::new(-463, -463) });
        board.tick(25 * MS);
        assert_eq!(board.drive(), Drive::default());
        board.pulse(26 * MS, Axis::X); // run-down, counted forwards
        assert_eq!(board.counts(), StepPoint::new(2, 1));
        board.tick(41 * MS); // 31 ms after the last pulse of the second motor only
        assert_eq!((board.drive().x().value() < 0.0, board.drive().y().value() < 0.0), (false, true));
        board.tick(60 * MS);
        assert!(board.drive().x().value() < 0.0 && board.drive().y().value() < 0.0);
    }

    #[test]
    fn a_switch_that_would_reverse_a_running_motor_stops_both() {
        let mut board = moving();
        // Right and up: motor 2 alone.
        board.start(20 * MS, PenMove { pen: Pen::Down, target: StepPoint::new(0, 926) });
        board.tick(25 * MS);
        assert!(board.drive().x().value() == 0.0 && board.drive().y().value() > 0.0);
        // up alone would need motor 1 backwards, which ran forwards 15 ms ago
        board.limit_switches(25 * MS, LimitSwitches { x_max: true, ..LimitSwitches::default() });
        assert_eq!(board.drive(), Drive::default());
        board.tick(45 * MS);
        assert!(board.drive().x().value() < 0.0 && board.drive().y().value() > 0.0);
    }

    #[test]
    fn points_are_counted_when_they_are_done() {
        let mut board = moving();
        assert_eq!((board.points_done(), board.has_arrived()), (0, false));
        for _ in 0..462 {
            board.pulse(30 * MS, Axis::X);
            board.pulse(30 * MS, Axis::Y);
        }
        board.tick(40 * MS);
        assert_eq!((board.points_done(), board.has_arrived(), board.drive()), (1, true, Drive::default()));
        assert!(board.position_mm().distance(Point::new(160.0, 100.0)) < 1e-9);
    }
}
