//! [`StepperPlotterSettings`]: what the controller has to know of its machine.

#[cfg(feature = "third-motor")]
use super::{SecondMotor, ZAxis, ZHoming, ZPen};
#[cfg(feature = "third-motor")]
use crate::config::SecondMotorChoice;
use crate::config::SteppersConfig;
use crate::gcode::PenConvention;
use crate::kinematics::{Backlash, Cartesian, MotorScale, ScaleError};
use crate::planner::{AllModes, Modes};
use crate::{
    Axis, Machine, PathMode, PlannerSettings, config::PenLift, homing::HomingAxis, planner::PlanError,
    stepgen::StepGenSettings,
};
use core::fmt;
use core::marker::PhantomData;
use core::time::Duration;

/// The number of a laser's full power, the same as [`PenConvention::GRBL_LASER`] has it.
pub(super) const FULL_POWER: u16 = 1000;

/// Which language the host speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Dialect {
    /// That of Makeblock's mDraw: one line at a time, each answered by `OK` when it is done.
    #[default]
    MDraw,
    /// That of Grbl 1.1: lines are answered by `ok` when they are planned; real-time bytes.
    Grbl,
}

/// What the host may set and the machine must not forget: a firmware keeps it in its EEPROM or flash.
///
/// The default is what mDraw's firmware begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct StoredSettings {
    /// Width of the area, mm.
    pub width_mm: u16,
    /// Height of the area, mm.
    pub height_mm: u16,
    /// Direction of the x motor: 0 if its DIR pin is high on the way to larger coordinates, 1 if low.
    pub x_direction: u8,
    /// That of the y motor.
    pub y_direction: u8,
    /// Speed, 0 to 99 %: the motors make a step each (100 - speed) * 10 us, so 80 % is 5000 pulses/s.
    pub speed_percent: u8,
    /// Servo with the pen up, 0 to 180 degrees.
    pub pen_up_deg: u8,
    /// Servo with the pen down, 0 to 180 degrees.
    pub pen_down_deg: u8,
}

impl Default for StoredSettings {
    fn default() -> Self {
        Self {
            width_mm: 380,
            height_mm: 310,
            x_direction: 0,
            y_direction: 0,
            speed_percent: 80,
            pen_up_deg: 160,
            pen_down_deg: 90,
        }
    }
}

impl StoredSettings {
    /// The speed, in pulses/s.
    ///
    /// ```
    /// # use plotter_motion::firmware::stepper_plotter::StoredSettings;
    /// assert_eq!(StoredSettings::default().speed_hz(), 5000.0); // 80 %: 200 us a step
    /// ```
    #[must_use]
    pub const fn speed_hz(&self) -> f64 {
        let percent = if self.speed_percent < 99 { self.speed_percent } else { 99 };
        1e5 / (100 - percent) as f64
    }
}

/// A stepper plotter and how it is driven.
///
/// The default is the documented machine: 87.58 steps/mm, up to 8000 pulses/s (91.3 mm/s), reached within
/// 1375 steps (21,818 pulses/s², 249 mm/s²), 200 ms for the pen.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StepperPlotterSettings {
    /// The host's language.
    pub dialect: Dialect,
    /// What the host may set.
    pub stored: StoredSettings,
    /// Steps of the x motor to the millimetre.
    pub x_steps_per_mm: f64,
    /// Steps of the y motor to the millimetre.
    pub y_steps_per_mm: f64,
    /// Limits of the motion. Of its speeds and that of [`StoredSettings`] the lesser holds.
    pub planner: PlannerSettings,
    /// How long the machine stands after the pen has moved.
    pub pen_settle: Duration,
    /// Whether a laser takes the place of the pen.
    pub laser: bool,
    /// How a pen is lifted in Grbl's dialect. With `laser` it is [`PenConvention::GRBL_LASER`] instead.
    pub pen: PenConvention,
    /// How long a machine at rest waits for more lines before it starts, so that it knows more than the
    /// first: it would stop at its end otherwise.
    pub gather: Duration,
    /// Play of both axes, in steps of their motors. It takes [`AllModes`](crate::planner::AllModes).
    pub backlash: Backlash,
    /// Grbl's `$22`: `$H` homes, and a machine that is switched on takes no G-code until it has been homed or
    /// unlocked by `$X`. mDraw's `G28` homes in any case.
    pub homing: bool,
    /// How x is homed.
    pub home_x: HomingAxis,
    /// How y is homed.
    pub home_y: HomingAxis,
    /// A third axis. It takes [`ThreeAxes`](crate::planner::ThreeAxes).
    #[cfg(feature = "third-motor")]
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub z: Option<ZAxis>,
    /// A second motor of an axis. It takes [`ThreeAxes`](crate::planner::ThreeAxes).
    #[cfg(feature = "third-motor")]
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub second: Option<SecondMotor>,
}

#[cfg(feature = "serde")]
crate::checked_serde::checked_deserialize!(
    StepperPlotterSettings {
        dialect: Dialect,
        stored: StoredSettings,
        x_steps_per_mm: f64,
        y_steps_per_mm: f64,
        planner: PlannerSettings,
        pen_settle: Duration,
        laser: bool,
        pen: PenConvention,
        gather: Duration,
        backlash: Backlash,
        homing: bool,
        home_x: HomingAxis,
        home_y: HomingAxis,
        #[cfg(feature = "third-motor")]
        z: Option<ZAxis>,
        #[cfg(feature = "third-motor")]
        second: Option<SecondMotor>,
    },
    |settings: &StepperPlotterSettings| settings.can_be_driven()
);

impl Default for StepperPlotterSettings {
    fn default() -> Self {
        Self {
            dialect: Dialect::MDraw,
            stored: StoredSettings::default(),
            x_steps_per_mm: 87.58,
            y_steps_per_mm: 87.58,
            planner: PlannerSettings {
                speed_mm_s: 8_000.0 / 87.58,
                travel_speed_mm_s: 8_000.0 / 87.58,
                accel_mm_s2: 21_818.0 / 87.58,
                ..PlannerSettings::default()
            },
            pen_settle: Duration::from_millis(200),
            laser: false,
            pen: PenConvention::Spindle,
            gather: Duration::from_millis(50),
            backlash: Backlash::default(),
            homing: false,
            home_x: HomingAxis::default(),
            home_y: HomingAxis::default(),
            #[cfg(feature = "third-motor")]
            z: None,
            #[cfg(feature = "third-motor")]
            second: None,
        }
    }
}

/// [`StepperPlotterSettings`] with the fields of a machine with two axes, and none of a third motor, whether
/// these are built in or not: for constants that a build script writes.
#[cfg(feature = "third-motor")]
#[doc(hidden)]
#[macro_export]
macro_rules! two_axes {
    ($settings:ident { $($field:ident: $value:expr),* $(,)? }) => {
        $settings { $($field: $value,)* z: None, second: None }
    };
}

#[cfg(not(feature = "third-motor"))]
#[doc(hidden)]
#[macro_export]
macro_rules! two_axes {
    ($settings:ident { $($field:ident: $value:expr),* $(,)? }) => {
        $settings { $($field: $value),* }
    };
}

impl StepperPlotterSettings {
    /// Whether some controller can drive such a machine.
    #[cfg(feature = "serde")]
    fn can_be_driven(&self) -> Result<(), SettingsError> {
        #[cfg(feature = "third-motor")]
        if self.z.is_some() || self.second.is_some() {
            return self.checked::<crate::planner::ThreeAxes>().map(|_| ());
        }
        self.checked::<AllModes>().map(|_| ())
    }

    /// The motors, once they have been checked.
    pub(super) const fn cartesian(&self) -> Cartesian {
        Cartesian::of_checked(self.x_steps_per_mm, self.y_steps_per_mm)
    }

    /// Looks at them once, at the latest when the controller is made: a program whose settings are constants
    /// has them looked at by the compiler, and needs no memory for it.
    ///
    /// ```
    /// # use plotter_motion::{LimitSwitches, SafetyGate, planner::ExactOnly};
    /// # use plotter_motion::firmware::stepper_plotter::{Motion, SettingsError, StepperPlotterSettings};
    /// let checked = StepperPlotterSettings::default().checked::<ExactOnly>()?;
    /// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    /// assert_eq!(Motion::from_checked(&checked, gate).settings().x_steps_per_mm, 87.58);
    /// let wrong = StepperPlotterSettings { x_steps_per_mm: 0.0, ..StepperPlotterSettings::default() };
    /// assert!(wrong.checked::<ExactOnly>().is_err());
    /// # Ok::<(), SettingsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`SettingsError`] for limits that no motion can be planned with, and for a mode that is not among
    /// these.
    pub const fn checked<M: Modes>(self) -> Result<CheckedSettings<M>, SettingsError> {
        let x = MotorScale { steps_per_mm: self.x_steps_per_mm, inverted: false };
        let y = MotorScale { steps_per_mm: self.y_steps_per_mm, inverted: false };
        if let Err(error) = Cartesian::new(x, y) {
            return Err(SettingsError::Scale(error));
        }
        if self.laser && !M::LASER {
            return Err(SettingsError::Planner(PlanError::Mode { quantity: "laser" }));
        }
        if !M::ALL && (self.backlash.x_steps != 0 || self.backlash.y_steps != 0) {
            return Err(SettingsError::Planner(PlanError::Mode { quantity: "backlash" }));
        }
        #[cfg(feature = "third-motor")]
        if let Some(z) = &self.z
            && let Err(error) = z.check(M::Z)
        {
            return Err(SettingsError::Planner(error));
        }
        #[cfg(feature = "third-motor")]
        if self.second.is_some() && !M::Z {
            return Err(SettingsError::Planner(PlanError::Mode { quantity: "second" }));
        }
        let limits = self.limits();
        if let Err(error) = limits.check::<M>() {
            return Err(SettingsError::Planner(error));
        }
        #[cfg(feature = "averaged-steps")]
        if let Err(error) = self.check_average() {
            return Err(SettingsError::Planner(error));
        }
        Ok(CheckedSettings { settings: self, limits, modes: PhantomData })
    }

    /// Whether the steps can be averaged, if they are to be.
    #[cfg(feature = "averaged-steps")]
    pub(super) const fn check_average(&self) -> Result<(), PlanError> {
        let limits = self.limits();
        if limits.vector_jerk().is_none() {
            return Ok(());
        }
        if self.laser {
            return Err(PlanError::Averaging { quantity: "a laser" });
        }
        #[cfg(feature = "third-motor")]
        if self.z.is_some() {
            return Err(PlanError::Averaging { quantity: "a third axis" });
        }
        limits.check_room(self.x_steps_per_mm, self.y_steps_per_mm, crate::stepgen::AVERAGED_STEPS)
    }

    /// What a checked machine with stepper motors says of itself. Sides and angles are rounded to whole ones.
    ///
    /// ```
    /// # use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
    /// # use plotter_motion::{Machine, MachineConfig};
    /// let machine = Machine::new(MachineConfig::stepper_plotter())?;
    /// let settings = StepperPlotterSettings::of(&machine, Dialect::Grbl);
    /// assert_eq!((settings.stored.width_mm, settings.planner.speed_mm_s), (380, 45.0));
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine, dialect: Dialect) -> Self {
        let (area, config) = (machine.config().area, SteppersConfig::of(machine));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let whole = |value: f64| libm::round(value) as u16;
        let degrees = |deg: f64| u8::try_from(whole(deg)).unwrap_or(180).min(180);
        let steps = StepGenSettings::of(machine);
        Self {
            dialect,
            stored: StoredSettings {
                width_mm: whole(area.width_mm),
                height_mm: whole(area.height_mm),
                x_direction: config.x.inverted.into(),
                y_direction: config.y.inverted.into(),
                pen_up_deg: degrees(config.pen.up_deg),
                pen_down_deg: degrees(config.pen.down_deg),
                ..StoredSettings::default()
            },
            x_steps_per_mm: config.x.steps_per_mm,
            y_steps_per_mm: config.y.steps_per_mm,
            planner: PlannerSettings::of(machine),
            pen_settle: steps.pen_settle,
            laser: steps.laser,
            pen: match config.pen.lifted_by {
                PenLift::Spindle => PenConvention::Spindle,
                PenLift::Height => PenConvention::Height { threshold_mm: config.pen.down_z_mm },
            },
            backlash: Backlash::of(machine),
            home_x: HomingAxis::of(machine, Axis::X),
            home_y: HomingAxis::of(machine, Axis::Y),
            ..Self::default()
        }
    }

    /// With what the machine says of a third axis and of two motors on an axis, for a controller with
    /// [`ThreeAxes`](crate::planner::ThreeAxes).
    ///
    /// ```
    /// # use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
    /// # use plotter_motion::{Machine, MachineConfig};
    /// let mut config = MachineConfig::stepper_plotter();
    /// if let Some(steppers) = config.steppers_mut() {
    ///     steppers.z.enabled = true;
    /// }
    /// let machine = Machine::new(config)?;
    /// let settings = StepperPlotterSettings::of(&machine, Dialect::Grbl).with_third_motor_of(&machine);
    /// assert_eq!(settings.z.map(|z| (z.steps_per_mm, z.travel_mm)), Some((400.0, 30.0)));
    /// assert_eq!((settings.second, StepperPlotterSettings::of(&machine, Dialect::Grbl).z), (None, None));
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub fn with_third_motor_of(self, machine: &Machine) -> Self {
        let config = SteppersConfig::of(machine);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let whole = |value: f64| libm::round(value) as u32;
        let (z, homing) = (config.z, config.homing);
        let home = ZHoming {
            start_hz: whole(z.start_rate_hz),
            slow_hz: whole(homing.slow_rate_hz.min(z.start_rate_hz)),
            pull_off_steps: whole(homing.pull_off_mm * z.steps_per_mm).max(1),
            release_steps: whole(homing.release_mm * z.steps_per_mm).max(1),
            most_steps: whole((z.travel_mm + homing.pull_off_mm + homing.release_mm) * z.steps_per_mm),
        };
        let of_z = ZAxis {
            steps_per_mm: z.steps_per_mm,
            speed_mm_s: z.speed_mm_s,
            accel_mm_s2: z.accel_mm_s2,
            travel_mm: z.travel_mm,
            pen: z.lifts_pen.then_some(ZPen { up_mm: z.up_mm, down_mm: z.down_mm }),
            home: z.homes.then_some(home),
        };
        let axis = match config.second_motor.axis {
            SecondMotorChoice::None => None,
            SecondMotorChoice::X => Some((Axis::X, self.x_steps_per_mm)),
            SecondMotorChoice::Y => Some((Axis::Y, self.y_steps_per_mm)),
        };
        let second = axis.map(|(axis, steps_per_mm)| SecondMotor {
            axis,
            offset_steps: crate::toolpath::from_mm(config.second_motor.offset_mm, steps_per_mm),
            most_skew_steps: whole(config.second_motor.max_skew_mm * steps_per_mm),
        });
        Self { z: z.enabled.then_some(of_z), second, ..self }
    }

    /// Whether [`ExactOnly`](crate::planner::ExactOnly) is enough for them: the path is exact, the jerk has
    /// no limit, and there is no play. Such a controller takes every vertex as it is, whatever
    /// [`PlannerSettings::allowance_mm`] says.
    ///
    /// ```
    /// # use plotter_motion::firmware::stepper_plotter::StepperPlotterSettings;
    /// assert!(StepperPlotterSettings::default().is_plain());
    /// ```
    #[must_use]
    pub fn is_plain(&self) -> bool {
        let PlannerSettings { path, jerk_mm_s3, .. } = self.planner;
        path == PathMode::Exact && jerk_mm_s3.is_none() && self.backlash == Backlash::default()
    }

    /// Speeds with the pen down and up, mm/s. mDraw's user chooses a greatest rate.
    pub(super) const fn speeds_mm_s(&self) -> (f64, f64) {
        let most_mm_s = match self.dialect {
            Dialect::MDraw => self.stored.speed_hz() / self.x_steps_per_mm.max(self.y_steps_per_mm),
            Dialect::Grbl => f64::INFINITY,
        };
        (self.planner.speed_mm_s.min(most_mm_s), self.planner.travel_speed_mm_s.min(most_mm_s))
    }

    /// The limits that are planned with.
    pub(super) const fn limits(&self) -> PlannerSettings {
        let (draw_mm_s, travel_mm_s) = self.speeds_mm_s();
        match self.dialect {
            // There each move is told its speed: only the receive side knows what the servo means.
            Dialect::MDraw => {
                let speed_mm_s = draw_mm_s.max(travel_mm_s);
                PlannerSettings { speed_mm_s, travel_speed_mm_s: speed_mm_s, ..self.planner }
            }
            Dialect::Grbl => self.planner,
        }
    }

    /// By which words a G-code text lifts the pen.
    pub(super) fn convention(&self) -> PenConvention {
        #[cfg(feature = "third-motor")]
        if self.z.is_some_and(|z| z.pen.is_none()) && !self.laser {
            return PenConvention::Motion;
        }
        if self.laser { PenConvention::GRBL_LASER } else { self.pen }
    }
}

/// Settings that a machine can be driven with, by a controller with these modes: what
/// [`StepperPlotterSettings::checked`] gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckedSettings<M: Modes = AllModes> {
    settings: StepperPlotterSettings,
    /// Those that are planned with.
    pub(super) limits: PlannerSettings,
    modes: PhantomData<M>,
}

impl<M: Modes> CheckedSettings<M> {
    /// The settings.
    #[must_use]
    pub const fn settings(&self) -> &StepperPlotterSettings {
        &self.settings
    }
}

/// Settings that no machine can be driven with.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// The steps to the millimetre.
    Scale(ScaleError),
    /// The limits of the motion.
    Planner(PlanError),
    /// The host's language is another one than the controller is built for.
    Dialect(Dialect),
    /// The pen is lifted by other words than the controller is built for.
    Pen(PenConvention),
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scale(error) => error.fmt(f),
            Self::Planner(error) => error.fmt(f),
            Self::Dialect(dialect) => write!(
                f,
                "the dialect is {dialect:?}: build the controller with a host that speaks it, or with Receive"
            ),
            Self::Pen(pen) => {
                write!(f, "the pen is lifted by {pen:?}: build the controller with Grbl<AnyPen>")
            }
        }
    }
}

impl core::error::Error for SettingsError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Scale(error) => Some(error),
            Self::Planner(error) => Some(error),
            _ => None,
        }
    }
}
