//! A pen on an RC servo: 50 pulses a second, whose width says the angle.
//!
//! ```text
//!      │◀ 1.5 ms ▶│                                 │◀ 2 ms ▶│
//!      ┌──────────┐                                 ┌──────────────┐
//!  ────┘          └────────────────────── ··· ──────┘              └────────
//!      │◀────────────────── 20 ms ─────────────────▶│
//!
//!  angle  up ──────┐                                 raised at once,
//!                  └──┐                              lowered by so many degrees a second,
//!            down     └──────────╌╌╌╌╌╌╌╌╌           and settled some time after the last pulse
//!                     │◀ settle ▶│                   has changed
//! ```
//!
//! Source: Dounaev and Phan, "X-Y Plotter Project". Its servo takes 50 Hz and 1 to 2 ms (section 2.1.2). Its
//! motors wait 200 ms after the pen has moved, because otherwise each dot gets a tail (section 3.3). The
//! pulse width for an angle differs from one servo to the next: it is measured at two angles
//! ([`ServoPoint`]), and a straight line goes through both.

use crate::debounce::has_come;
use core::fmt;
use core::time::Duration;
use embedded_hal::delay::DelayNs;
use embedded_hal::pwm::{self, SetDutyCycle};
use plotter_motion::Machine;
use plotter_motion::config::SteppersConfig;

/// A measured point of a servo: pulse width and angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoPoint {
    /// The angle, degrees.
    pub deg: f32,
    /// Width of the pulse that turns it there, us.
    pub pulse_us: f32,
}

/// A servo, and what the pen on it does.
///
/// ```
/// # use plotter_hal::{PenServoSettings, ServoPoint};
/// // One whose pulses of 0.9 and 2.1 ms were found to be 45 and 135 degrees, and that lays its pen down gently.
/// let settings = PenServoSettings::default()
///     .with_calibration([ServoPoint { deg: 45.0, pulse_us: 900.0 }, ServoPoint { deg: 135.0, pulse_us: 2100.0 }])
///     .with_up_deg(120.0)
///     .with_lowering_deg_s(100.0);
/// assert_eq!(settings.down_deg, 90.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PenServoSettings {
    /// Two angles, at least 10 degrees apart, and their pulses of 400 to 2600 us. It is never turned beyond
    /// them.
    pub calibration: [ServoPoint; 2],
    /// From one pulse to the next, as the PWM has been set up, us.
    pub frame_us: u32,
    /// Angle with the pen up, degrees.
    pub up_deg: f32,
    /// Angle with the pen down, degrees.
    pub down_deg: f32,
    /// How fast it is turned in the sense that lowers the pen, 1 degree/s or more; infinity is at once, as it
    /// is always raised.
    pub lowering_deg_s: f32,
    /// From the last change of the pulse until the pen is taken to stand still. The last pulse may begin a
    /// frame later.
    pub settle: Duration,
}

impl PenServoSettings {
    /// The same with another [`PenServoSettings::calibration`].
    #[must_use]
    pub const fn with_calibration(self, calibration: [ServoPoint; 2]) -> Self {
        Self { calibration, ..self }
    }

    /// The same with another [`PenServoSettings::down_deg`].
    #[must_use]
    pub const fn with_down_deg(self, down_deg: f32) -> Self {
        Self { down_deg, ..self }
    }

    /// The same with another [`PenServoSettings::frame_us`].
    #[must_use]
    pub const fn with_frame_us(self, frame_us: u32) -> Self {
        Self { frame_us, ..self }
    }

    /// The same with another [`PenServoSettings::lowering_deg_s`].
    #[must_use]
    pub const fn with_lowering_deg_s(self, lowering_deg_s: f32) -> Self {
        Self { lowering_deg_s, ..self }
    }

    /// The same with another [`PenServoSettings::settle`].
    #[must_use]
    pub const fn with_settle(self, settle: Duration) -> Self {
        Self { settle, ..self }
    }

    /// The same with another [`PenServoSettings::up_deg`].
    #[must_use]
    pub const fn with_up_deg(self, up_deg: f32) -> Self {
        Self { up_deg, ..self }
    }
}

impl Default for PenServoSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Least and greatest pulse width, us: beyond what common servos understand, 1000 to 2000 us, on either side,
/// as some turn farther.
const PULSES_US: (f32, f32) = (400.0, 2600.0);
/// Least distance of the two calibrated angles, degrees: nearer ones would multiply the error of reading them
/// over the whole range.
const LEAST_APART_DEG: f32 = 10.0;
/// Shortest and longest frame, us: 300 Hz, as digital servos take, to 25 Hz, half of the usual rate.
const FRAMES_US: (u32, u32) = (3_333, 40_000);
/// Least lowering speed, degrees/s: at it a pen takes more than a minute for 70 degrees, so a lower one is a
/// mistake.
const SLOWEST_DEG_S: f32 = 1.0;
/// Least number of PWM steps between up and down. With fewer the pen would be lowered in jerks, and its
/// places would be off by an eighth of the stroke or more.
const LEAST_STEPS: u16 = 4;

impl PenServoSettings {
    /// 1 to 2 ms for 0 to 180 degrees every 20 ms; up at 160 and down at 90 degrees, as mDraw's
    /// machine has it; lowered at once; 200 ms until the motors move. Source: Dounaev and Phan, "X-Y Plotter
    /// Project", sections 2.1.2 and 3.3.
    pub const DEFAULT: Self = Self {
        calibration: [ServoPoint { deg: 0.0, pulse_us: 1000.0 }, ServoPoint { deg: 180.0, pulse_us: 2000.0 }],
        frame_us: 20_000,
        up_deg: 160.0,
        down_deg: 90.0,
        lowering_deg_s: f32::INFINITY,
        settle: Duration::from_millis(200),
    };

    /// What a checked machine says of its pen, `[pen]` in its file; the rest as by default.
    ///
    /// ```
    /// # use plotter_hal::PenServoSettings;
    /// # use plotter_motion::{Machine, MachineConfig};
    /// let machine = Machine::new(MachineConfig::stepper_plotter())?;
    /// assert_eq!(PenServoSettings::of(&machine), PenServoSettings::default());
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let pen = &SteppersConfig::of(machine).pen;
        #[expect(clippy::cast_possible_truncation, reason = "0 to 270 degrees")]
        let deg = |deg: f64| deg as f32;
        Self {
            up_deg: deg(pen.up_deg),
            down_deg: deg(pen.down_deg),
            settle: Duration::from_secs_f64(pen.settle_ms / 1e3),
            ..Self::default()
        }
    }

    /// Looks at them for a PWM of so many steps in a frame: a program whose settings are constants has the
    /// compiler do that.
    ///
    /// ```
    /// # use plotter_hal::PenServoSettings;
    /// assert!(PenServoSettings::DEFAULT.checked(20_000).is_ok());
    /// assert!(PenServoSettings::DEFAULT.checked(100).is_err()); // two steps from up to down
    /// ```
    ///
    /// # Errors
    ///
    /// [`SettingsError`] for a servo that cannot be right, with what would be.
    pub const fn checked(self, pwm_steps: u16) -> Result<CheckedPenServo, SettingsError> {
        match self.check(pwm_steps) {
            Ok(()) => Ok(CheckedPenServo { settings: self, pwm_steps }),
            Err(error) => Err(error),
        }
    }

    /// Pulse at an angle, us.
    const fn pulse_us(&self, deg: f32) -> f32 {
        let [a, b] = self.calibration;
        a.pulse_us + (deg - a.deg) / (b.deg - a.deg) * (b.pulse_us - a.pulse_us)
    }

    /// The nearest step of a PWM with `full` steps to the pulse at an angle.
    const fn steps(&self, deg: f32, full: u16) -> u16 {
        // In whole ns, so that nothing is lost before the one rounding.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 2600 us")]
        let pulse_ns = (self.pulse_us(deg) * 1e3 + 0.5) as u32;
        let frame_ns = self.frame_us as u64 * 1_000;
        let Some(steps) = (pulse_ns as u64 * full as u64 + frame_ns / 2).checked_div(frame_ns) else {
            return 0;
        };
        #[expect(clippy::cast_possible_truncation, reason = "it is less than the full")]
        let steps = if steps < full as u64 { steps as u16 } else { full };
        steps
    }

    /// The angle between those of the calibration that is nearest to `deg`; up for one that is no number.
    const fn within(&self, deg: f32) -> f32 {
        let [a, b] = self.calibration;
        if deg.is_nan() { self.up_deg } else { deg.max(a.deg.min(b.deg)).min(a.deg.max(b.deg)) }
    }

    const fn check_pulse(point: ServoPoint) -> Result<(), SettingsError> {
        let (least, most) = PULSES_US;
        if point.pulse_us >= least && point.pulse_us <= most {
            Ok(())
        } else {
            Err(SettingsError::Pulse { pulse_us: point.pulse_us })
        }
    }

    const fn check_angle(&self, deg: f32) -> Result<(), SettingsError> {
        let [a, b] = self.calibration;
        if self.within(deg) == deg {
            Ok(())
        } else {
            Err(SettingsError::Angle { deg, least_deg: a.deg.min(b.deg), most_deg: a.deg.max(b.deg) })
        }
    }

    const fn check(&self, full: u16) -> Result<(), SettingsError> {
        let [a, b] = self.calibration;
        if let (Err(error), _) | (_, Err(error)) = (Self::check_pulse(a), Self::check_pulse(b)) {
            return Err(error);
        }
        let apart_deg = (b.deg - a.deg).abs();
        if !(apart_deg >= LEAST_APART_DEG && apart_deg <= 360.0) || a.pulse_us == b.pulse_us {
            return Err(SettingsError::Calibration { apart_deg, apart_us: (b.pulse_us - a.pulse_us).abs() });
        }
        let (least_us, most_us) = FRAMES_US;
        if self.frame_us < least_us || self.frame_us > most_us {
            return Err(SettingsError::Frame { frame_us: self.frame_us });
        }
        if let (Err(error), _) | (_, Err(error)) =
            (self.check_angle(self.up_deg), self.check_angle(self.down_deg))
        {
            return Err(error);
        }
        if self.lowering_deg_s.is_nan() || self.lowering_deg_s < SLOWEST_DEG_S {
            return Err(SettingsError::Lowering { deg_s: self.lowering_deg_s });
        }
        let steps = self.steps(self.up_deg, full).abs_diff(self.steps(self.down_deg, full));
        if steps < LEAST_STEPS {
            return Err(SettingsError::Coarse { pwm_steps: full, pen_steps: steps });
        }
        Ok(())
    }
}

/// Settings that a servo on a certain PWM can be driven with: what [`PenServoSettings::checked`] gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckedPenServo {
    settings: PenServoSettings,
    pwm_steps: u16,
}

/// The pen. Nothing is known of it when it is switched on: the first thing it does is to go up.
///
/// [`raise`](Self::raise), [`lower`](Self::lower) and [`turn_to`](Self::turn_to) say where it is to go, and
/// [`tick`](Self::tick) takes it there, at [`due`](Self::due) or more often. Or, in a program that may wait,
/// [`finish`](Self::finish) does it all.
///
/// ```
/// use core::time::Duration;
/// use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
/// use plotter_hal::{PenServo, PenServoSettings};
///
/// let pwm = Pwm::new(&[
///     SetDuty::max_duty_cycle(20_000), // 1 us a step
///     SetDuty::max_duty_cycle(20_000),
///     SetDuty::set_duty_cycle(1889), // up: 1000 + 160/180 · 1000 us
///     SetDuty::max_duty_cycle(20_000),
///     SetDuty::set_duty_cycle(1500), // down: 90 degrees
/// ]);
/// let mut pen = PenServo::new(pwm, PenServoSettings::default())?;
/// pen.tick(Duration::ZERO)?;
/// assert_eq!(pen.due(), Some(Duration::from_millis(200)));
/// pen.tick(Duration::from_millis(200))?;
/// assert!(pen.is_settled());
///
/// pen.lower(Duration::from_millis(300))?;
/// assert!(!pen.is_settled()); // the motors wait
/// # pen.release().done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PenServo<Pwm> {
    pwm: Pwm,
    settings: PenServoSettings,
    /// Where it is to go, degrees.
    target_deg: f32,
    /// Where the last pulse that was set has it, degrees.
    at_deg: f32,
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// The PWM has not been set yet.
    Unset,
    /// On the way down, since the last pulse set.
    Moving(Duration),
    /// There, but still trembling.
    Settling(Duration),
    Settled,
}

impl<Pwm: SetDutyCycle> PenServo<Pwm> {
    /// The pen on the servo on `pwm`, which has been set up for pulses every [`PenServoSettings::frame_us`],
    /// and is first set by [`tick`](Self::tick) or a movement.
    ///
    /// # Errors
    ///
    /// [`Refused`] for a servo that cannot be right, with what would be; the PWM comes back with it.
    pub fn new(pwm: Pwm, settings: PenServoSettings) -> Result<Self, Refused<Pwm>> {
        match settings.checked(pwm.max_duty_cycle()) {
            Ok(checked) => Ok(Self::with(pwm, checked)),
            Err(why) => Err(Refused { why, pwm }),
        }
    }

    /// The same, with settings that have been looked at.
    ///
    /// # Errors
    ///
    /// The PWM, if it has another number of steps than they were looked at for.
    pub fn from_checked(pwm: Pwm, checked: CheckedPenServo) -> Result<Self, Pwm> {
        if pwm.max_duty_cycle() == checked.pwm_steps { Ok(Self::with(pwm, checked)) } else { Err(pwm) }
    }

    fn with(pwm: Pwm, CheckedPenServo { settings, .. }: CheckedPenServo) -> Self {
        let up_deg = settings.up_deg;
        Self { pwm, settings, target_deg: up_deg, at_deg: up_deg, state: State::Unset }
    }

    /// Resolution of the angle, degrees per step of the PWM: angles are rounded to the nearest.
    pub fn resolution_deg(&self) -> f32 {
        let [a, b] = self.settings.calibration;
        #[expect(clippy::cast_precision_loss, reason = "at most 40000")]
        let step_us = self.settings.frame_us as f32 / f32::from(self.pwm.max_duty_cycle());
        ((b.deg - a.deg) / (b.pulse_us - a.pulse_us)).abs() * step_us
    }

    /// From [`lower`](Self::lower) of a pen that is up until it has settled, if [`tick`](Self::tick) comes in
    /// time: what a controller has to wait before it moves
    /// ([`pen_settle`](plotter_motion::firmware::stepper_plotter::StepperPlotterSettings::pen_settle)).
    pub fn lowering_time(&self) -> Duration {
        let PenServoSettings { up_deg, down_deg, lowering_deg_s, settle, .. } = self.settings;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "360 deg at 1 deg/s at most"
        )]
        let frames =
            libm::ceilf((down_deg - up_deg).abs() / (lowering_deg_s * self.frame().as_secs_f32())) as u32;
        self.frame() * frames + settle
    }

    /// Raises the pen, at once.
    ///
    /// # Errors
    ///
    /// [`Error::Pwm`]; the next call tries again.
    pub fn raise(&mut self, now: Duration) -> Result<(), Error<Pwm::Error>> {
        self.turn_to(now, self.settings.up_deg)
    }

    /// Begins to lower the pen.
    ///
    /// # Errors
    ///
    /// [`Error::Pwm`]; the next call tries again.
    pub fn lower(&mut self, now: Duration) -> Result<(), Error<Pwm::Error>> {
        self.turn_to(now, self.settings.down_deg)
    }

    /// Begins to turn the servo to `deg`, or as near to it as it has been calibrated.
    ///
    /// # Errors
    ///
    /// [`Error::Pwm`]; the next call tries again.
    pub fn turn_to(&mut self, now: Duration, deg: f32) -> Result<(), Error<Pwm::Error>> {
        let target_deg = self.settings.within(deg);
        if target_deg != self.target_deg {
            self.target_deg = target_deg;
            if self.state != State::Unset {
                // From where it is, with the next frame as the first step of a slow way.
                self.state = State::Moving(now);
            }
        }
        self.tick(now)
    }

    /// Does what is due by `now`. Never waits. Called late, it lowers the pen later, and no faster.
    ///
    /// # Errors
    ///
    /// [`Error::Pwm`]; the next call tries again.
    pub fn tick(&mut self, now: Duration) -> Result<(), Error<Pwm::Error>> {
        match self.state {
            // A way down begins from where it is, or from the top of a pen of which nothing is known.
            State::Unset => self.set(now, if self.is_lowered() { self.at_deg } else { self.target_deg }),
            State::Moving(_) if !self.is_slow() => self.set(now, self.target_deg),
            State::Moving(since) => {
                let passed = now.saturating_sub(since);
                if !has_come(self.frame(), passed) {
                    return Ok(());
                }
                self.set(now, self.lowered_deg(passed))
            }
            State::Settling(until) => {
                if has_come(until, now) {
                    self.state = State::Settled;
                }
                Ok(())
            }
            State::Settled => Ok(()),
        }
    }

    /// When to call [`tick`](Self::tick) next; `None` once the pen has settled.
    pub fn due(&self) -> Option<Duration> {
        match self.state {
            State::Unset => Some(Duration::ZERO),
            State::Moving(since) if self.is_slow() => Some(since.saturating_add(self.frame())),
            State::Moving(since) => Some(since),
            State::Settling(until) => Some(until),
            State::Settled => None,
        }
    }

    /// Whether the pen is where it was last told to go, and stands still, as of the last call: the motors may
    /// move.
    pub fn is_settled(&self) -> bool {
        self.state == State::Settled
    }

    /// Angle that the servo has been given last, degrees: on its way up or down the pen is elsewhere.
    pub const fn deg(&self) -> f32 {
        self.at_deg
    }

    /// Waits until the pen has settled; says when that was. A program without a clock calls everything with
    /// [`Duration::ZERO`].
    ///
    /// # Errors
    ///
    /// [`Error::Pwm`]; the next call tries again.
    pub fn finish(&mut self, now: Duration, delay: &mut impl DelayNs) -> Result<Duration, Error<Pwm::Error>> {
        let mut now = now;
        self.tick(now)?;
        // Ends: each turn is a frame on a way of at most 360 degrees, or the time to settle.
        while let Some(due) = self.due() {
            let wait = due.saturating_sub(now);
            if !wait.is_zero() {
                delay.delay_us(u32::try_from(wait.as_micros()).unwrap_or(u32::MAX));
            }
            now = now.saturating_add(wait);
            self.tick(now)?;
        }
        Ok(now)
    }

    /// Gives the PWM back, as it is.
    pub fn release(self) -> Pwm {
        self.pwm
    }

    const fn frame(&self) -> Duration {
        Duration::from_micros(self.settings.frame_us as u64)
    }

    /// Whether it is to be turned in the sense that lowers the pen.
    fn is_lowered(&self) -> bool {
        (self.target_deg - self.at_deg) * (self.settings.down_deg - self.settings.up_deg) > 0.0
    }

    /// Whether it is on a way that takes its time.
    fn is_slow(&self) -> bool {
        self.is_lowered() && self.settings.lowering_deg_s.is_finite()
    }

    /// Where a slow way has got to. A frame or two at a time: a call that comes late must not let the pen
    /// drop.
    fn lowered_deg(&self, passed: Duration) -> f32 {
        let left_deg = self.target_deg - self.at_deg;
        let way_deg = self.settings.lowering_deg_s * passed.min(self.frame() * 2).as_secs_f32();
        if way_deg >= left_deg.abs() {
            self.target_deg
        } else {
            self.at_deg + libm::copysignf(way_deg, left_deg)
        }
    }

    /// Sets the pulse of an angle.
    fn set(&mut self, now: Duration, deg: f32) -> Result<(), Error<Pwm::Error>> {
        let steps = self.settings.steps(deg, self.pwm.max_duty_cycle());
        // As it was before: what was due is still due.
        self.pwm.set_duty_cycle(steps).map_err(Error::Pwm)?;
        self.at_deg = deg;
        self.state = if deg == self.target_deg {
            State::Settling(now.saturating_add(self.settings.settle))
        } else {
            State::Moving(now)
        };
        Ok(())
    }
}

/// Settings that no servo can be driven with.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// A pulse that no servo understands.
    Pulse {
        /// Its width, us.
        pulse_us: f32,
    },
    /// Two points that no line goes through.
    Calibration {
        /// Their distance, degrees.
        apart_deg: f32,
        /// Difference of their pulses, us.
        apart_us: f32,
    },
    /// So many us from one pulse to the next.
    Frame {
        /// The time, us.
        frame_us: u32,
    },
    /// An angle of the pen that has not been calibrated.
    Angle {
        /// The angle, degrees.
        deg: f32,
        /// Least angle of the calibration, degrees.
        least_deg: f32,
        /// Greatest one, degrees.
        most_deg: f32,
    },
    /// A speed at which the pen would not come down.
    Lowering {
        /// The speed, degrees/s.
        deg_s: f32,
    },
    /// A PWM that cannot tell pen up from pen down.
    Coarse {
        /// Steps of the PWM in a frame.
        pwm_steps: u16,
        /// Those between up and down.
        pen_steps: u16,
    },
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pulse { pulse_us } => write!(
                f,
                "pen servo: a pulse of {pulse_us} us lies outside 400..=2600 us; common servos take 1000 to 2000"
            ),
            Self::Calibration { apart_deg, apart_us } => write!(
                f,
                "pen servo: the calibrated points lie {apart_deg} deg and {apart_us} us apart; 10 to 360 deg and \
                 pulses that differ make a line, such as 0 deg at 1000 us and 180 deg at 2000 us"
            ),
            Self::Frame { frame_us } => write!(
                f,
                "pen servo: a frame of {frame_us} us lies outside 3333..=40000 us; 20000 us (50 Hz) suits every servo"
            ),
            Self::Angle { deg, least_deg, most_deg } => write!(
                f,
                "pen servo: {deg} deg lies outside the calibrated {least_deg}..={most_deg} deg: choose an angle \
                 within, or calibrate farther out"
            ),
            Self::Lowering { deg_s } => write!(
                f,
                "pen servo: a lowering speed of {deg_s} deg/s; 1 or more, 50 to 500 is gentle, infinity is at once"
            ),
            Self::Coarse { pwm_steps, pen_steps } => write!(
                f,
                "pen servo: with {pwm_steps} steps of the pwm in a frame, pen up and pen down are {pen_steps} steps \
                 apart; at least 4 are needed: give the timer more steps, or choose angles farther apart"
            ),
        }
    }
}

impl core::error::Error for SettingsError {}

/// Settings that cannot be right, and the PWM that came with them.
#[derive(Clone, Copy, PartialEq)]
pub struct Refused<Pwm> {
    /// The fault.
    pub why: SettingsError,
    /// The PWM, untouched.
    pub pwm: Pwm,
}

// A PWM need not be shown for the rest to be.
impl<Pwm> fmt::Debug for Refused<Pwm> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Refused").field("why", &self.why).finish_non_exhaustive()
    }
}

impl<Pwm> fmt::Display for Refused<Pwm> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.why.fmt(f)
    }
}

impl<Pwm> core::error::Error for Refused<Pwm> {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        Some(&self.why)
    }
}

/// The PWM of a pen's servo failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error<Pwm> {
    /// The PWM's own error. The pen is where the last pulse has it, and does not count as settled.
    Pwm(Pwm),
}

impl<Pwm: pwm::Error> fmt::Display for Error<Pwm> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Pwm(cause) = self;
        write!(f, "pwm of the pen servo: {}; the pen may be up or down", cause.kind())
    }
}

impl<Pwm: pwm::Error> core::error::Error for Error<Pwm> {}

crate::which_pin::formats_as_shown!(<Pwm: pwm::Error> Error<Pwm>);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_becomes_the_nearest_step() {
        let settings = PenServoSettings::default();
        assert_eq!(settings.steps(90.0, 20_000), 1500); // 1 us a step
        assert_eq!(settings.steps(90.0, 1000), 75);
        assert_eq!(settings.steps(160.0, 1000), 94); // 1888.9 us are 94.44 steps
        assert_eq!(settings.steps(167.0, 1000), 96); // 1927.8 us are 96.39
        assert_eq!(settings.steps(168.0, 1000), 97); // 1933.3 us are 96.67
        assert_eq!(settings.steps(180.0, u16::MAX), 6554); // 6553.5
    }

    #[test]
    fn a_servo_that_turns_the_other_way_is_calibrated_as_well() {
        let calibration =
            [ServoPoint { deg: 180.0, pulse_us: 1000.0 }, ServoPoint { deg: 0.0, pulse_us: 2000.0 }];
        let settings = PenServoSettings { calibration, ..PenServoSettings::default() };
        assert_eq!(settings.check(20_000), Ok(()));
        assert_eq!(settings.pulse_us(45.0), 1750.0);
        assert_eq!(settings.within(-5.0), 0.0);
        assert_eq!(settings.within(f32::NAN), 160.0);
    }
}
