//! [`Lift`]: a pen that a DC motor raises and lowers between two switches.

use crate::safety::EndSwitches;
use crate::seconds::has_come;
use crate::{Duty, Pen};
use core::fmt;
use core::time::Duration;

/// What a lift is driven with, and how long it may take.
///
/// The default is a small geared motor: half of the supply upwards, a third downwards, where the weight
/// helps, a second from end to end, and a fifth of that until the switch it stood in is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftSettings {
    /// Duty on the way up, more than 0.
    pub up: Duty,
    /// Duty on the way down, less than 0.
    pub down: Duty,
    /// From end to end at most.
    pub longest: Duration,
    /// Until the switch that it stood in has opened, at most.
    pub leaves: Duration,
}

impl Default for LiftSettings {
    fn default() -> Self {
        Self {
            up: Duty::saturating(0.5),
            down: Duty::saturating(-0.33),
            longest: Duration::from_secs(1),
            leaves: Duration::from_millis(200),
        }
    }
}

/// What a lift does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum LiftState {
    /// Nobody has asked for anything: where it stands is not known.
    #[default]
    Unknown,
    /// On its way.
    Moving {
        /// What it is to come to.
        to: Pen,
    },
    /// It stands at its end.
    At(Pen),
    /// It was given up, and has no drive until it is asked again.
    Failed(LiftFault),
}

/// Why a lift was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum LiftFault {
    /// The switch that it stood in has not opened: the motor does not turn, or turns the other way.
    NotLeft {
        /// What it was to come to.
        to: Pen,
    },
    /// It has not come to its end in time: it is slow or blocked, or its switch does not close.
    NotReached {
        /// What it was to come to.
        to: Pen,
    },
    /// Both switches are pressed: one of them has no wire.
    BothEnds,
}

impl fmt::Display for LiftFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let end = |to: &Pen| if *to == Pen::Up { "upper" } else { "lower" };
        match self {
            Self::NotLeft { to } => write!(
                f,
                "the lift was driven to its {} switch and has not left the other: see whether its motor turns, and \
                 which way",
                end(to)
            ),
            Self::NotReached { to } => write!(
                f,
                "the lift has not come to its {} switch in time: see whether it is free, and the switch closes",
                end(to)
            ),
            Self::BothEnds => f.write_str("both switches of the lift are pressed: see to their wires"),
        }
    }
}

impl core::error::Error for LiftFault {}

/// Raises and lowers a pen by a DC motor, from one limit switch to the other.
///
/// Say where the pen is to be with [`go`](Self::go), ask [`update`](Self::update) whenever a switch has
/// changed and at [`due`](Self::due), and give what it asks for to the motor through
/// [`SafetyGate::pass_z`](crate::SafetyGate::pass_z), which takes away what would drive into a pressed switch
/// and all of it in an emergency stop. While it is not [where it is to be](Self::is_at), tell a stepper
/// plotter that its drivers are busy, and nothing is drawn before the pen is down: see the example.
///
/// It is not kept at its end by force: a gear, a spring or friction holds it. If it sinks off its switch it
/// is driven back.
///
/// ```
/// # use core::time::Duration;
/// # use plotter_motion::control::{Lift, LiftSettings, LiftState};
/// # use plotter_motion::firmware::StepperPlotter;
/// # use plotter_motion::firmware::stepper_plotter::{Dialect, Drivers, StepperPlotterSettings};
/// # use plotter_motion::{LimitSwitches, Pen, SafetyGate, safety::EndSwitches};
/// let settings = StepperPlotterSettings {
///     dialect: Dialect::Grbl,
///     pen_settle: Duration::ZERO, // the lift says itself when it is there
///     ..StepperPlotterSettings::default()
/// };
/// let mut plotter = StepperPlotter::new(settings, SafetyGate::new(LimitSwitches::RELEASED, false))?;
/// let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// let mut lift = Lift::new(LiftSettings::default());
/// b"M3\nG1 X1 F2000\n".iter().for_each(|byte| plotter.receive(Duration::ZERO, *byte));
///
/// let (mut height_mm, mut first_step) = (2.0, None); // what the motor does: 20 mm/s at full duty
/// for now in (0..1_000).map(Duration::from_millis) {
///     let switches = EndSwitches { lower: height_mm <= 0.0, upper: height_mm >= 2.0 };
///     gate.set_z_limits(switches);
///     let is_down = plotter.pen_deg() == plotter.settings().stored.pen_down_deg;
///     lift.go(now, if is_down { Pen::Down } else { Pen::Up });
///     // `motor.drive(drive.of_z(Axis::X))` of plotter-hal
///     let drive = gate.pass_z(lift.update(now, switches));
///     height_mm += f64::from(drive.z().value()) * 20.0 * 0.001;
///     let drivers = if lift.is_there() { Drivers::Ready } else { Drivers::Busy };
///     while plotter.transmit(now).is_some() {} // to the host: lines wait while answers do
///     if plotter.poll(now, drivers).is_some() {
///         first_step.get_or_insert((lift.state(), height_mm));
///     }
/// }
/// let (state, height_mm) = first_step.unwrap(); // nothing was drawn above the sheet
/// assert!(state == LiftState::At(Pen::Down) && height_mm <= 0.0);
/// # Ok::<(), plotter_motion::firmware::stepper_plotter::SettingsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Lift {
    settings: LiftSettings,
    state: LiftState,
    wanted: Option<Pen>,
    since: Duration,
    /// On this way the switch that it stood in has opened.
    has_left: bool,
}

impl Lift {
    /// A lift of which nobody knows where it stands.
    #[must_use]
    pub const fn new(settings: LiftSettings) -> Self {
        Self { settings, state: LiftState::Unknown, wanted: None, since: Duration::ZERO, has_left: false }
    }

    /// The pen is to be up or down. The same as before changes nothing, so it may be said again and again.
    pub fn go(&mut self, now: Duration, to: Pen) {
        if self.wanted != Some(to) {
            self.wanted = Some(to);
            self.begin(now, to);
        }
    }

    /// Tries again what has failed.
    pub fn retry(&mut self, now: Duration) {
        if let (LiftState::Failed(_), Some(to)) = (self.state, self.wanted) {
            self.begin(now, to);
        }
    }

    const fn begin(&mut self, now: Duration, to: Pen) {
        (self.state, self.since, self.has_left) = (LiftState::Moving { to }, now, false);
    }

    /// What the motor is to get, by what its switches say now.
    pub fn update(&mut self, now: Duration, switches: EndSwitches) -> Duty {
        let EndSwitches { lower, upper } = switches;
        if self.wanted.is_some() && lower && upper {
            self.state = LiftState::Failed(LiftFault::BothEnds);
        }
        if let LiftState::At(pen) = self.state
            && !(if pen == Pen::Up { upper } else { lower })
        {
            self.begin(now, pen);
        }
        let LiftState::Moving { to } = self.state else { return Duty::ZERO };
        let (here, there, duty) = match to {
            Pen::Up => (lower, upper, self.settings.up),
            Pen::Down => (upper, lower, self.settings.down),
        };
        self.has_left |= !here;
        let failed = if has_come(self.since.saturating_add(self.settings.longest), now) {
            Some(LiftFault::NotReached { to })
        } else if !self.has_left && has_come(self.since.saturating_add(self.settings.leaves), now) {
            Some(LiftFault::NotLeft { to })
        } else {
            None
        };
        match failed {
            _ if there => self.state = LiftState::At(to),
            Some(fault) => self.state = LiftState::Failed(fault),
            None => return duty,
        }
        Duty::ZERO
    }

    /// When [`update`](Self::update) is to be called next if no switch changes before; none while it stands.
    #[must_use]
    pub fn due(&self) -> Option<Duration> {
        let LiftState::Moving { .. } = self.state else { return None };
        let LiftSettings { longest, leaves, .. } = self.settings;
        Some(self.since.saturating_add(if self.has_left { longest } else { leaves.min(longest) }))
    }

    /// What it does.
    #[must_use]
    pub const fn state(&self) -> LiftState {
        self.state
    }

    /// Whether it stands there.
    #[must_use]
    pub fn is_at(&self, pen: Pen) -> bool {
        self.state == LiftState::At(pen)
    }

    /// Whether it stands where it was asked to be.
    #[must_use]
    pub fn is_there(&self) -> bool {
        self.wanted.is_some_and(|pen| self.is_at(pen))
    }
}
