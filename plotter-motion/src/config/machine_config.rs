//! [`MachineConfig`]: a machine's description, with the documented gantry as default.

#[cfg(feature = "serde")]
use super::FileConfig;
use super::{DriveConfig, MachineName, TransmissionConfig};

/// What a machine's description says, not yet checked: [`Machine::new`](crate::Machine::new) does that.
///
/// What all machines have stands here; what only one kind of motors needs stands in [`MachineConfig::drive`].
/// The default is the semi-virtual gantry: two small DC motors on an L293D, 40 encoder counts to the
/// millimetre, so that an encoder count is an HPGL plotter unit.
///
/// As a file it has the tables of `docs/machine-config.md`, of which a machine reads those of its motors.
///
/// ```
/// # use plotter_motion::{MachineConfig, config::DriveConfig};
/// let mut config = MachineConfig::stepper_plotter();
/// if let DriveConfig::Steppers(steppers) = &mut config.drive {
///     steppers.planner.speed_mm_s = 30.0;
/// }
/// assert_eq!(config.steppers().map(|steppers| steppers.planner.speed_mm_s), Some(30.0));
/// assert_eq!(config.dc(), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "FileConfig", into = "FileConfig")
)]
#[non_exhaustive]
pub struct MachineConfig {
    /// Version of this format: 1.
    pub schema: u32,
    /// Name of the machine.
    pub name: MachineName,
    /// The reachable area.
    pub area: AreaConfig,
    /// The serial line.
    pub serial: SerialConfig,
    /// Its motors, how they move the pen, and how they are led.
    pub drive: DriveConfig,
}

impl MachineConfig {
    /// The same with another [`MachineConfig::name`].
    #[must_use]
    pub const fn with_name(self, name: MachineName) -> Self {
        Self { name, ..self }
    }

    /// The same with another [`MachineConfig::area`].
    #[must_use]
    pub const fn with_area(self, area: AreaConfig) -> Self {
        Self { area, ..self }
    }

    /// The same with another [`MachineConfig::serial`].
    #[must_use]
    pub const fn with_serial(self, serial: SerialConfig) -> Self {
        Self { serial, ..self }
    }

    /// The same with another [`MachineConfig::drive`].
    #[must_use]
    pub const fn with_drive(self, drive: DriveConfig) -> Self {
        Self { drive, ..self }
    }
}

/// The reachable area: a rectangle from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct AreaConfig {
    /// To the right, mm.
    pub width_mm: f64,
    /// Up, mm.
    pub height_mm: f64,
}

/// The serial line between host and controller, 8N1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct SerialConfig {
    /// Bits a second.
    pub baud: u32,
    /// The host's pause after each byte, ms.
    pub byte_gap_ms: f64,
    /// A silence inside a target after which the controller drops what it has of it, ms.
    pub resync_gap_ms: f64,
}

impl SerialConfig {
    /// The same with another [`SerialConfig::baud`].
    #[must_use]
    pub const fn with_baud(self, baud: u32) -> Self {
        Self { baud, ..self }
    }

    /// The same with another [`SerialConfig::byte_gap_ms`].
    #[must_use]
    pub const fn with_byte_gap_ms(self, byte_gap_ms: f64) -> Self {
        Self { byte_gap_ms, ..self }
    }

    /// The same with another [`SerialConfig::resync_gap_ms`].
    #[must_use]
    pub const fn with_resync_gap_ms(self, resync_gap_ms: f64) -> Self {
        Self { resync_gap_ms, ..self }
    }
}

/// Controllers of the motors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum ControllerChoice {
    /// PID line tracking as published: x leads, y follows the slope.
    Published,
    /// Contouring: a planned speed along the line, and its errors along and across it.
    #[default]
    Contouring,
}

/// How the motors are led along a line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct ControlConfig {
    /// The controller.
    pub controller: ControllerChoice,
    /// How many periods of the loop pass before a simulated motor gets what the controller asked for.
    pub latency_periods: u32,
    /// The published controller's gains and limits.
    pub published: PublishedConfig,
    /// The contouring controller's speeds and bandwidths.
    pub contouring: ContouringConfig,
}

/// Gains of the published sum-form PID, in duty steps (of 255) per encoder count, and its duty limits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct PublishedConfig {
    /// Proportional gain of both axes.
    pub kp: f32,
    /// Sum gain of both axes.
    pub ki: f32,
    /// Difference gain of x.
    pub kd_x: f32,
    /// Difference gain of y.
    pub kd_y: f32,
    /// Duty limit of x, of 255.
    pub duty_limit_x: f32,
    /// Duty limit of y, of 255.
    pub duty_limit_y: f32,
    /// Duty limit of y on vertical lines, of 255.
    pub duty_limit_y_vertical: f32,
}

/// Speeds and bandwidths of the contouring controller.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct ContouringConfig {
    /// Cruising speed along a line, mm/s.
    pub feed_mm_s: f64,
    /// Greatest acceleration along a line, mm/s^2.
    pub accel_mm_s2: f64,
    /// Greatest jerk along a line, mm/s^3.
    pub jerk_mm_s3: f64,
    /// How often the controller runs, 1/s.
    pub loop_hz: f64,
    /// Natural frequency of the position loop along the line, Hz; across it the loop is 1.6 times as stiff.
    pub bandwidth_hz: f64,
    /// Natural frequency of the estimator of position, speed and load, Hz.
    pub observer_hz: f64,
    /// How near both axes must stand to the target to have arrived, encoder counts.
    pub arrival_tolerance_counts: f64,
    /// How long they must stand there, ms.
    pub settle_ms: f64,
}

/// The rule by which one motor waits for the other: the deviation from the line that is allowed before it
/// does, `slope_counts * |m| + offset_counts` for a line of slope m.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct SyncStopConfig {
    /// Part that grows with the slope, encoder counts.
    pub slope_counts: f64,
    /// Constant part, encoder counts.
    pub offset_counts: f64,
}

/// An axis of a DC motor, or one of the two motors of a belt.
///
/// It and its parts are written out as constants of a firmware (feature `build`), so they can be made field
/// by field outside of this crate, too.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct AxisConfig {
    /// Encoder counts to the millimetre.
    pub counts_per_mm: f64,
    /// The encoder.
    pub encoder: EncoderConfig,
    /// The motor and its driver.
    pub motor: MotorConfig,
    /// The load that the motor moves.
    pub load: LoadConfig,
    /// Simulated transmission between the shaft and the pen.
    pub transmission: TransmissionConfig,
}

/// How the two phases of an encoder are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Decoding {
    /// Rising edges of phase A only, as published.
    #[default]
    X1,
    /// Both edges of phase A.
    X2,
    /// Every edge of both phases.
    X4,
}

impl Decoding {
    /// Counts in one period of a phase.
    #[must_use]
    pub const fn counts_per_line(self) -> u8 {
        match self {
            Self::X1 => 1,
            Self::X2 => 2,
            Self::X4 => 4,
        }
    }

    /// Where, within the interval of a count, a shaft should rest so that no trembling moves it across an
    /// edge: in the middle of the part between the edges that count forwards and backwards, in counts.
    ///
    /// With x1 decoding that part is A's high half, a quarter of a period after the rising edge; with x2 and
    /// x4 half an interval.
    #[must_use]
    pub const fn rest_offset_counts(self) -> f32 {
        match self {
            Self::X1 => 0.25,
            Self::X2 | Self::X4 => 0.5,
        }
    }
}

/// A two-phase incremental encoder on the motor's shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct EncoderConfig {
    /// Periods of a phase in one turn of the shaft.
    pub lines_per_turn: u32,
    /// How they are counted.
    pub decoding: Decoding,
}

/// A DC motor and its H-bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct MotorConfig {
    /// Supply of the H-bridge, V: what full duty puts on the motor.
    pub supply_v: f64,
    /// Steps of the duty from 0 to full (255 for an 8 bit timer).
    pub pwm_steps: u32,
    /// Frequency of a PWM on the bridge's enable pin, Hz: the motor coasts between its pulses. 0 for a bridge
    /// that brakes in between, as with the PWM on its inputs: that one does what the mean of its voltage
    /// does.
    pub enable_pwm_hz: f64,
    /// Armature resistance R, ohm.
    pub resistance_ohm: f64,
    /// Armature inductance L, H.
    pub inductance_h: f64,
    /// Back EMF constant Ke, V s.
    pub back_emf_v_s: f64,
    /// Torque constant Kt, N m/A.
    pub torque_n_m_per_a: f64,
    /// Moment of inertia of the rotor J, kg m^2.
    pub inertia_kg_m2: f64,
}

/// What a motor moves, seen at its shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct LoadConfig {
    /// Moment of inertia beyond the rotor's, kg m^2.
    pub inertia_kg_m2: f64,
    /// Coulomb (dry) friction, N m.
    pub coulomb_n_m: f64,
    /// Static friction, N m: what must be overcome to start; at least the Coulomb friction.
    pub static_n_m: f64,
    /// Viscous friction, N m s.
    pub viscous_n_m_s: f64,
}

/// What the current of a motor with the PWM on its bridge's enable pin overcomes beside the supply between
/// two pulses, when it flows back through the clamp diodes, V: 1.3 V above the supply and 1.3 V below ground.
/// Source: Texas Instruments, SLRS008D, "Electrical characteristics", `V_OKH` and `V_OKL` of the L293D.
pub(crate) const CLAMPS_V: f64 = 2.6;

impl AxisConfig {
    /// Encoder counts in one turn of the motor's shaft: one a line with x1 decoding, two with x2, four with
    /// x4.
    ///
    /// ```
    /// # use plotter_motion::config::{AxisConfig, Decoding, EncoderConfig};
    /// let encoder = EncoderConfig { lines_per_turn: 100, decoding: Decoding::X4 };
    /// assert_eq!(AxisConfig { encoder, ..AxisConfig::default() }.counts_per_turn(), 400.0);
    /// ```
    #[must_use]
    pub fn counts_per_turn(&self) -> f64 {
        f64::from(self.encoder.lines_per_turn) * f64::from(self.encoder.decoding.counts_per_line())
    }
}

impl Default for AreaConfig {
    /// A2 lying: 594 x 420 mm.
    fn default() -> Self {
        Self { width_mm: 594.0, height_mm: 420.0 }
    }
}

impl Default for SerialConfig {
    /// 256000 baud and 10 ms after each byte, as published.
    fn default() -> Self {
        Self { baud: 256_000, byte_gap_ms: 10.0, resync_gap_ms: 100.0 }
    }
}

impl Default for ControlConfig {
    fn default() -> Self {
        Self {
            controller: ControllerChoice::Contouring,
            latency_periods: 0,
            published: PublishedConfig::default(),
            contouring: ContouringConfig::default(),
        }
    }
}

impl Default for PublishedConfig {
    /// The published gains: Kp = 15, Ki = 0.00001, Kd = 0 for x and 10 for y; limits 20, 255 and 15.
    fn default() -> Self {
        Self {
            kp: 15.0,
            ki: 0.00001,
            kd_x: 0.0,
            kd_y: 10.0,
            duty_limit_x: 20.0,
            duty_limit_y: 255.0,
            duty_limit_y_vertical: 15.0,
        }
    }
}

impl Default for ContouringConfig {
    fn default() -> Self {
        Self {
            feed_mm_s: 150.0,
            accel_mm_s2: 3_000.0,
            jerk_mm_s3: 150_000.0,
            loop_hz: 2_500.0,
            bandwidth_hz: 50.0,
            observer_hz: 150.0,
            arrival_tolerance_counts: 0.25,
            settle_ms: 10.0,
        }
    }
}

impl Default for SyncStopConfig {
    /// 10 |m| + 10 encoder counts, as published.
    fn default() -> Self {
        Self { slope_counts: 10.0, offset_counts: 10.0 }
    }
}

impl Default for AxisConfig {
    fn default() -> Self {
        Self {
            counts_per_mm: 40.0,
            encoder: EncoderConfig::default(),
            motor: MotorConfig::default(),
            load: LoadConfig::default(),
            transmission: TransmissionConfig::default(),
        }
    }
}

impl Default for EncoderConfig {
    fn default() -> Self {
        Self { lines_per_turn: 500, decoding: Decoding::X1 }
    }
}

impl Default for MotorConfig {
    /// The published motor: J = 5.7e-7 kg m^2, R = 1.9 ohm, Ke = 13.369e-3 V s, Kt = 13.4e-3 N m/A,
    /// L = 6.5e-5 H at 12 V.
    fn default() -> Self {
        Self {
            supply_v: 12.0,
            pwm_steps: 255,
            enable_pwm_hz: 0.0,
            resistance_ohm: 1.9,
            inductance_h: 6.5e-5,
            back_emf_v_s: 13.369e-3,
            torque_n_m_per_a: 13.4e-3,
            inertia_kg_m2: 5.7e-7,
        }
    }
}

impl Default for LoadConfig {
    fn default() -> Self {
        Self { inertia_kg_m2: 0.0, coulomb_n_m: 1.3e-3, static_n_m: 1.3e-3, viscous_n_m_s: 1.0e-6 }
    }
}
