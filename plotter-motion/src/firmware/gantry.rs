//! The semi-virtual gantry's controller: the published protocol on one side, two DC motors on the other.

use crate::config::DcConfig;
use crate::control::{AxisTrouble, ChosenController, LineController};
use crate::protocol::Order;
use crate::protocol::digits::{Dropped, Receiver, Reply};
use crate::{Axis, Demand, Direction, Drive, LimitSwitches, Machine, SafetyGate, StepPoint};
use core::fmt;
use core::time::Duration;

/// Something that a person at the machine should know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Notice {
    /// Part of a target was dropped; the next byte begins a new one.
    Dropped(Dropped),
    /// A target outside the machine's area was refused.
    OutOfArea {
        /// The target, encoder counts.
        target: StepPoint,
        /// Greatest coordinates, encoder counts.
        most: StepPoint,
    },
    /// A motor or its encoder does what it should not.
    Trouble(AxisTrouble),
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dropped(dropped) => dropped.fmt(f),
            Self::Trouble(trouble) => trouble.fmt(f),
            Self::OutOfArea { target, most } => write!(
                f,
                "target ({}, {}) counts lies outside (0, 0)..=({}, {}): refused it",
                target.x, target.y, most.x, most.y
            ),
        }
    }
}

/// Notices that were not fetched yet; the oldest are kept.
const MOST_NOTICES: usize = 8;

/// The whole controller of the semi-virtual gantry, sans-IO. Source: Öcal's thesis, sections 4.4, 4.5, 5.2
/// and 6.4, and the program in its appendix A.
///
/// Inputs: [`receive`](Self::receive), [`edge`](Self::edge), [`limit_switch`](Self::limit_switch),
/// [`emergency_stop`](Self::emergency_stop), [`tick`](Self::tick) at [`next_tick`](Self::next_tick). After
/// each of them, fetch the bytes for the line ([`transmit`](Self::transmit)) and the motors'
/// [`drive`](Self::drive). Times never go back.
///
/// The host is told of every count, and of `+` when all counts of a reached target are told, so that its
/// position is the controller's when it compares. Where the published program answered a target at which the
/// motors stood already with nothing at all, and so stopped for ever, this one answers at once.
///
/// ```
/// # use plotter_motion::{LimitSwitches, Machine, MachineConfig, SafetyGate, StepPoint};
/// # use plotter_motion::firmware::Gantry;
/// # use plotter_motion::protocol::digits;
/// # use core::time::Duration;
/// let machine = Machine::new(MachineConfig::default())?;
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false); // what switches and button say
/// let mut gantry = Gantry::new(&machine, gate);
/// for byte in digits::encode(StepPoint::new(400, 0))? {
///     gantry.receive(Duration::ZERO, byte);
/// }
/// // a hundredth of a second later the motor is on its way
/// while let Some(now) = gantry.next_tick().filter(|&at| at < Duration::from_millis(10)) {
///     gantry.tick(now);
/// }
/// assert!(gantry.drive().x().value() > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A drive ends when the gantry is told anything, and there is no copy of a gantry, because its gate has
/// none:
///
/// ```compile_fail,E0502
/// # use plotter_motion::{LimitSwitches, Machine, MachineConfig, SafetyGate, firmware::Gantry};
/// # use core::time::Duration;
/// # let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// # let mut gantry = Gantry::new(&Machine::new(MachineConfig::default()).unwrap(), gate);
/// let drive = gantry.drive();
/// gantry.emergency_stop(Duration::ZERO, true);
/// let duty = drive.x();
/// ```
///
/// ```compile_fail,E0599
/// # use plotter_motion::{LimitSwitches, Machine, MachineConfig, SafetyGate, firmware::Gantry};
/// # let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// # let gantry = Gantry::new(&Machine::new(MachineConfig::default()).unwrap(), gate);
/// let copy = gantry.clone();
/// ```
#[derive(Debug, PartialEq)]
pub struct Gantry<C = ChosenController> {
    receiver: Receiver,
    controller: C,
    gate: SafetyGate,
    demand: Demand,
    drive: Drive<'static>,
    most: StepPoint,
    /// The target being approached.
    approached: Option<StepPoint>,
    /// Position as the host has been told.
    told: StepPoint,
    /// Whether the host is to be told that the target is reached.
    tell_reached: bool,
    /// The host waits to be told whether the motors are stopped.
    tell_stopped: bool,
    next_tick: Option<Duration>,
    /// What was told last of a trouble.
    trouble: Option<AxisTrouble>,
    notices: [Option<Notice>; MOST_NOTICES],
}

/// What the controller of the gantry must know of a machine besides what its [`LineController`] does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct GantrySettings {
    /// A silence inside a target after which what came of it is dropped, us.
    pub resync_gap_us: u32,
    /// Greatest coordinates, encoder counts.
    pub most: StepPoint,
}

impl GantrySettings {
    /// Those of a machine.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, StepPoint, firmware::GantrySettings};
    /// let settings = GantrySettings::of(&Machine::new(MachineConfig::default())?);
    /// assert_eq!(settings.resync_gap_us, 100_000);
    /// assert_eq!(settings.most, StepPoint::new(594 * 40, 420 * 40));
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let (config, DcConfig { x, y, .. }) = (machine.config(), DcConfig::of(machine));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a checked machine has at most 60,000 ms"
        )]
        let resync_gap_us = libm::round(config.serial.resync_gap_ms * 1e3) as u32;
        Self {
            resync_gap_us,
            most: StepPoint::new(
                crate::toolpath::from_mm(config.area.width_mm, x.counts_per_mm),
                crate::toolpath::from_mm(config.area.height_mm, y.counts_per_mm),
            ),
        }
    }
}

impl Gantry {
    /// The controller of `machine`, with its motors at rest at the origin and its switches and its button as
    /// the gate has them.
    #[must_use]
    pub fn new(machine: &Machine, gate: SafetyGate) -> Self {
        Self::with_settings(GantrySettings::of(machine), ChosenController::of(machine), gate)
    }
}

impl<C: LineController> Gantry<C> {
    /// The controller from settings, round a controller of its motors that is at rest at the origin: what a
    /// firmware calls, which has no file to read a machine's description from.
    ///
    /// ```
    /// # use plotter_motion::control::{LineTracking, LineTrackingSettings};
    /// # use plotter_motion::firmware::{Gantry, GantrySettings};
    /// # use plotter_motion::{LimitSwitches, SafetyGate, StepPoint};
    /// # use plotter_motion::config::PublishedConfig;
    /// # use plotter_motion::control::SyncStop;
    /// const GANTRY: GantrySettings = GantrySettings { resync_gap_us: 100_000, most: StepPoint::new(23_760, 16_800) };
    /// const TRACKING: LineTrackingSettings = LineTrackingSettings {
    ///     published: PublishedConfig {
    ///         kp: 15.0,
    ///         ki: 0.00001,
    ///         kd_x: 0.0,
    ///         kd_y: 10.0,
    ///         duty_limit_x: 20.0,
    ///         duty_limit_y: 255.0,
    ///         duty_limit_y_vertical: 15.0,
    ///     },
    ///     sync_stop: SyncStop { slope_counts: 10.0, offset_counts: 10.0 },
    /// };
    /// let gate = SafetyGate::new(LimitSwitches::RELEASED, false); // it has neither switches nor a button
    /// let gantry = Gantry::with_settings(GANTRY, LineTracking::with_settings(TRACKING), gate);
    /// assert_eq!(gantry.next_tick(), None); // it answers to edges only
    /// ```
    #[must_use]
    pub fn with_settings(settings: GantrySettings, controller: C, gate: SafetyGate) -> Self {
        Self {
            next_tick: controller.period(),
            controller,
            receiver: Receiver::new(Duration::from_micros(u64::from(settings.resync_gap_us))),
            gate,
            demand: Demand::NONE,
            drive: Drive::default(),
            most: settings.most,
            approached: None,
            told: StepPoint::default(),
            tell_reached: false,
            tell_stopped: false,
            trouble: None,
            notices: [None; MOST_NOTICES],
        }
    }

    /// Takes a byte from the host. A target that comes before the one before is reached takes its place, as
    /// in the published program: so a host can go on after a target that cannot be reached. [`Order::Stop`]
    /// and [`Order::GoOn`] are obeyed at once, whatever came of a target before them, and answered.
    pub fn receive(&mut self, now: Duration, byte: u8) {
        if let Some(order @ (Order::Stop | Order::GoOn)) = Order::from_byte(byte) {
            self.tell_stopped = true;
            return self.stop_by_host(order == Order::Stop);
        }
        let received = self.receiver.push(now, byte);
        if let Some(dropped) = received.dropped {
            self.notice(Notice::Dropped(dropped));
        }
        if let Some(target) = received.target {
            self.go_to(now, target);
        }
    }

    /// Takes a target, in encoder counts; says whether it is in the machine's area. One outside is refused.
    pub fn go_to(&mut self, now: Duration, target: StepPoint) -> bool {
        let StepPoint { x, y } = self.most;
        let inside = (0..=x).contains(&target.x) && (0..=y).contains(&target.y);
        if inside {
            self.approached = Some(target);
            let demand = self.controller.start(now, target);
            self.apply(demand);
        } else {
            self.notice(Notice::OutOfArea { target, most: self.most });
        }
        inside
    }

    /// Takes an edge that an encoder's decoder counted.
    pub fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) {
        let demand = self.controller.edge(now, axis, direction);
        self.apply(demand);
    }

    /// When [`tick`](Self::tick) is to be called next, if ever.
    #[must_use]
    pub const fn next_tick(&self) -> Option<Duration> {
        self.next_tick
    }

    /// Runs the control loop, if it is time. One that was held up runs once, and from then on in its period.
    pub fn tick(&mut self, now: Duration) {
        let (Some(due), Some(period)) = (self.next_tick, self.controller.period()) else {
            return;
        };
        if now < due {
            return;
        }
        // What a loop missed that was held up is not made up for. At the end of time there is no next one.
        self.next_tick =
            due.checked_add(period).filter(|&next| next > now).or_else(|| now.checked_add(period));
        let demand = self.controller.tick(now);
        self.apply(demand);
        let trouble = self.controller.trouble();
        if trouble != self.trouble {
            self.trouble = trouble;
            if let Some(trouble) = trouble {
                self.notice(Notice::Trouble(trouble));
            }
        }
    }

    /// Takes the state of a limit switch.
    pub fn limit_switch(&mut self, _now: Duration, axis: Axis, end: Direction, pressed: bool) {
        let mut limits: LimitSwitches = self.gate.limits();
        limits.set(axis, end, pressed);
        self.gate.set_limits(limits);
        self.apply(self.demand);
    }

    /// Takes the state of the emergency stop button; pressed, it stops both motors at once and latches.
    pub fn emergency_stop(&mut self, _now: Duration, pressed: bool) {
        self.gate.emergency_stop(pressed);
        self.apply(self.demand);
    }

    /// Lets the motors go on after an emergency stop, unless the button is still pressed; says whether it
    /// did.
    pub fn reset_emergency_stop(&mut self, _now: Duration) -> bool {
        let free = self.gate.reset();
        self.apply(self.demand);
        free
    }

    /// Takes the host's own emergency stop: both motors stay off until the host takes it back, whatever is
    /// done at the machine; and what was stopped at the machine stays stopped, whatever the host says.
    /// Position and target are kept.
    pub fn stop_by_host(&mut self, stopped: bool) {
        self.gate.stop_by_host(stopped);
        self.apply(self.demand);
    }

    /// Whether the motors are off by an emergency stop: the button's, or the host's.
    #[must_use]
    pub const fn is_stopped(&self) -> bool {
        self.gate.is_stopped()
    }

    fn apply(&mut self, demand: Demand) {
        self.demand = demand;
        self.drive = self.gate.pass(demand).kept();
        self.controller.applied(self.drive);
        if self.approached.is_some() && self.controller.has_arrived() {
            self.approached = None;
            self.tell_reached = true;
            if let Some(dropped) = self.receiver.restart() {
                self.notice(Notice::Dropped(dropped));
            }
        }
    }

    /// The next byte for the host, if there is one.
    #[must_use]
    pub fn transmit(&mut self) -> Option<u8> {
        if core::mem::take(&mut self.tell_stopped) {
            return Some(if self.is_stopped() { Reply::Stopped } else { Reply::GoesOn }.byte());
        }
        let position = self.controller.position();
        let ahead = |is: i32, told: i32| i64::from(is) - i64::from(told);
        let (x, y) = (ahead(position.x, self.told.x), ahead(position.y, self.told.y));
        let direction = |ahead: i64| if ahead > 0 { Direction::Plus } else { Direction::Minus };
        let reply = if x == 0 && y == 0 {
            if !core::mem::take(&mut self.tell_reached) {
                return None;
            }
            Reply::Reached
        } else if x.abs() >= y.abs() {
            self.told.x += direction(x).sign();
            Reply::Pulse(Axis::X, direction(x))
        } else {
            self.told.y += direction(y).sign();
            Reply::Pulse(Axis::Y, direction(y))
        };
        Some(reply.byte())
    }

    /// Drive of both motors.
    #[must_use]
    pub const fn drive(&self) -> Drive<'_> {
        self.drive
    }

    /// Controller of the motors.
    #[must_use]
    pub const fn controller(&self) -> &C {
        &self.controller
    }

    /// Where the motors stand, encoder counts.
    #[must_use]
    pub fn position(&self) -> StepPoint {
        self.controller.position()
    }

    /// The oldest notice that was not fetched yet.
    pub fn take_notice(&mut self) -> Option<Notice> {
        // All move up by one place. (Turning the row round would take 2 KB of a firmware.)
        let mut moved = None;
        for place in self.notices.iter_mut().rev() {
            core::mem::swap(place, &mut moved);
        }
        moved
    }

    fn notice(&mut self, notice: Notice) {
        if let Some(place) = self.notices.iter_mut().find(|place| place.is_none()) {
            *place = Some(notice);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Duty, MachineConfig, StepPair, safety::Blocked};

    /// What the gate lets through of the whole supply and of a step.
    fn flows(gantry: &Gantry) -> bool {
        let full = Demand { x: Duty::FULL, y: Duty::FULL };
        let step = gantry.gate.pass_step(StepPair { x: 1, y: 1 });
        assert!(matches!(step, Ok(_) | Err(Blocked::Stopped)));
        assert_eq!(gantry.gate.pass(full) != Drive::default(), step.is_ok());
        step.is_ok()
    }

    #[test]
    fn the_gate_refuses_what_is_demanded_after_the_hosts_stop() {
        let Ok(machine) = Machine::new(MachineConfig::default()) else { panic!("the preset is a machine") };
        let mut gantry = Gantry::new(&machine, SafetyGate::new(LimitSwitches::RELEASED, false));
        assert!(flows(&gantry));
        gantry.receive(Duration::ZERO, Order::Stop.byte());
        assert!(!flows(&gantry) && gantry.is_stopped());
        gantry.reset_emergency_stop(Duration::ZERO);
        assert!(!flows(&gantry));
        gantry.receive(Duration::ZERO, Order::GoOn.byte());
        assert!(flows(&gantry) && !gantry.is_stopped());
    }
}
