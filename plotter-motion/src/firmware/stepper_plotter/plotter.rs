//! [`StepperPlotter`]: both sides in one.

use super::{
    CheckedSettings, Drivers, Host, Lateness, Link, Motion, Receive, SettingsError, StartupLines, Status,
    Step, StepperPlotterSettings, StoredSettings,
};
use crate::homing::Homed;
use crate::planner::{AllModes, Modes};
use crate::{Axis, Direction, Point, SafetyGate, StepPoint, safety::Beam};
use core::time::Duration;

/// The whole controller of a stepper plotter, sans-IO: the receive side and the motion side joined by their
/// queues.
///
/// Inputs: [`receive`](Self::receive), [`limit_switch`](Self::limit_switch),
/// [`emergency_stop`](Self::emergency_stop). After each of them and at [`due`](Self::due), call
/// [`poll`](Self::poll) until it gives no more steps, and say each time whether the drivers can take one;
/// fetch the answers ([`transmit`](Self::transmit)) and set the servo ([`pen_deg`](Self::pen_deg)) and the
/// laser ([`beam`](Self::beam)). Times never go back.
///
/// For a small processor it is built for one language and fewer ways of planning:
///
/// ```
/// # use plotter_motion::{LimitSwitches, SafetyGate, planner::ExactOnly};
/// # use plotter_motion::firmware::StepperPlotter;
/// # use plotter_motion::firmware::stepper_plotter::{Dialect, Grbl, SettingsError, StepperPlotterSettings};
/// let settings = StepperPlotterSettings { dialect: Dialect::Grbl, ..StepperPlotterSettings::default() };
/// let gate = || SafetyGate::new(LimitSwitches::RELEASED, false); // what switches and button say
/// let small = StepperPlotter::<Grbl, ExactOnly>::with_modes(settings, gate())?;
/// assert!(size_of_val(&small) < size_of::<StepperPlotter>());
/// # let other = StepperPlotter::<Grbl, ExactOnly>::with_modes(StepperPlotterSettings::default(), gate());
/// # assert_eq!(other.err(), Some(SettingsError::Dialect(Dialect::MDraw)));
/// # Ok::<(), SettingsError>(())
/// ```
#[derive(Debug, PartialEq)]
pub struct StepperPlotter<H: Host = Receive, M: Modes = AllModes> {
    pub(super) receive: H,
    pub(super) motion: Motion<M>,
    pub(super) link: Link,
}

impl StepperPlotter {
    /// A machine that has just been switched on: at rest, its pen up, where it stands is (0, 0), its switches
    /// and its button as the gate has them. If the gate is stopped, so is the machine, as after
    /// [`emergency_stop`](Self::emergency_stop).
    ///
    /// # Errors
    ///
    /// [`SettingsError`] for limits that no motion can be planned with.
    pub fn new(settings: StepperPlotterSettings, gate: SafetyGate) -> Result<Self, SettingsError> {
        Self::with_modes(settings, gate)
    }
}

impl<H: Host, M: Modes> StepperPlotter<H, M> {
    /// As [`StepperPlotter::new`], with the language and the modes of its type.
    ///
    /// # Errors
    ///
    /// [`SettingsError`] for a language or a mode that is not among them, and as [`StepperPlotter::new`].
    pub fn with_modes(settings: StepperPlotterSettings, gate: SafetyGate) -> Result<Self, SettingsError> {
        Self::from_checked(&settings.checked()?, gate)
    }

    /// The same, with settings that have been looked at.
    ///
    /// # Errors
    ///
    /// [`SettingsError`] for a language that is not among them.
    pub fn from_checked(checked: &CheckedSettings<M>, gate: SafetyGate) -> Result<Self, SettingsError> {
        H::check(checked.settings())?;
        let receive = H::new(*checked.settings());
        let mut plotter =
            Self { receive, motion: Motion::from_checked(checked, gate), link: Link::default() };
        plotter.motion.begin_stopped(&mut plotter.link);
        Ok(plotter)
    }

    /// Takes a byte from the host.
    pub fn receive(&mut self, now: Duration, byte: u8) {
        if let Some(signal) = self.receive.receive(byte) {
            self.motion.signal(now, signal, &mut self.link);
        }
        self.work(now);
    }

    /// The next step that is due by `now`, if there is one and the motors' drivers can take it. It is for the
    /// drivers to make: it counts as made from here on. While they are busy there is none; it stays due, and
    /// is given when they are ready.
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn poll(&mut self, now: Duration, drivers: Drivers) -> Option<Step<'_>> {
        loop {
            let step = self.motion.next_step(now, drivers, &mut self.link);
            if step.is_some() {
                return step;
            }
            // What has been done is answered, and the next line may be waiting.
            let before = self.link.commands.len();
            self.work(now);
            if self.link.commands.len() <= before {
                return None;
            }
        }
    }

    /// When [`poll`](Self::poll) is to be called next, if nothing comes before; known after it has given no
    /// step and [`transmit`](Self::transmit) no byte.
    #[must_use]
    pub const fn due(&self) -> Option<Duration> {
        self.motion.due()
    }

    /// Takes the state of a limit switch.
    pub fn limit_switch(&mut self, now: Duration, axis: Axis, end: Direction, pressed: bool) {
        self.motion.limit_switch(axis, end, pressed);
        self.work(now);
    }

    /// Takes the state of the limit switches of a third axis.
    #[cfg(feature = "third-motor")]
    pub fn z_switches(&mut self, now: Duration, switches: crate::safety::EndSwitches) {
        self.motion.z_switches(switches);
        self.work(now);
    }

    /// Takes the state of the limit switches of the second motor of an axis. Those that
    /// [`limit_switch`](Self::limit_switch) tells of this axis are the first motor's.
    #[cfg(feature = "third-motor")]
    pub fn second_switches(&mut self, now: Duration, switches: crate::safety::EndSwitches) {
        self.motion.second_switches(switches);
        self.work(now);
    }

    /// How many steps farther than the first the second motor of an axis went when both were made square
    /// last: by how much the gantry was racked.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub fn skew_steps(&self) -> Option<i32> {
        self.motion.skew_steps()
    }

    /// The height of a third axis by the steps really made, mm; none of a machine with two.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub fn z_mm(&self) -> Option<f64> {
        self.motion.z_mm()
    }

    /// By how many steps the third axis stood higher than was believed, as its last homing has found.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub fn z_off_steps(&self) -> Option<i32> {
        self.motion.z_off_steps()
    }

    /// Takes the state of the emergency stop button; pressed, it stops everything at once and latches.
    pub fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        self.motion.emergency_stop(pressed, &mut self.link);
        self.work(now);
    }

    /// Lets the machine go on after an emergency stop, unless the button is still pressed; says whether it
    /// did.
    pub fn reset_emergency_stop(&mut self, now: Duration) -> bool {
        let free = self.motion.reset_emergency_stop();
        self.work(now);
        free
    }

    /// Begins anew with what the host has stored, as after switching on, but where the pen is stays known. An
    /// emergency stop ends if the button has been released. Call it when the host opens the port: mDraw does
    /// so after it has changed settings.
    pub fn restart(&mut self, now: Duration) {
        self.motion.reset_emergency_stop();
        self.link = Link::default();
        self.motion.restart(self.receive.stored(), &mut self.link);
        self.receive.restart(self.motion.position_mm());
        self.work(now);
    }

    /// The next byte for the host, if there is one.
    pub fn transmit(&mut self, now: Duration) -> Option<u8> {
        let byte = self.receive.transmit();
        if byte.is_none() {
            // There is room for more.
            let before = self.link.commands.len();
            self.work(now);
            if self.link.commands.len() > before {
                self.motion.wake(now);
            }
            return self.receive.transmit();
        }
        byte
    }

    /// What the host has stored, to be kept by the firmware.
    #[must_use]
    pub fn stored(&self) -> StoredSettings {
        self.receive.stored()
    }

    /// The lines that Grbl's host has had kept for the start, to be kept by the firmware.
    #[must_use]
    pub fn startup_lines(&self) -> StartupLines {
        self.receive.startup_lines()
    }

    /// What homing has measured last, steps between the switches of each axis: to be kept by the firmware
    /// ([`Homed::to_bytes`]). None before it has homed, nor with
    /// [`ExactOnly`](crate::planner::ExactOnly).
    #[must_use]
    pub fn homed(&self) -> Option<Homed> {
        self.motion.homed()
    }

    /// Takes what an earlier homing has measured and the firmware has kept: right after the controller is
    /// made. Grbl's `$H` warns if the axes are no longer as long.
    pub fn set_homed(&mut self, homed: Homed) {
        self.motion.set_homed(homed);
        self.receive.set_homed(homed);
    }

    /// How many steps the carriage stood away from where it was believed to be, as the last homing has found:
    /// what motors have lost since the one before. None until the machine has homed twice.
    #[must_use]
    pub fn off_steps(&self) -> Option<StepPoint> {
        self.motion.off_steps()
    }

    /// Takes the lines that a firmware has kept: right after the controller is made, before anything else.
    /// They are carried out as soon as the host has been greeted, or once the machine has been homed if it
    /// begins locked.
    pub fn set_startup_lines(&mut self, lines: &StartupLines) {
        self.receive.set_startup_lines(lines);
    }

    /// The settings as they hold now, also those that the host has changed in Grbl's dialect: to be kept by
    /// the firmware, for the next start.
    #[must_use]
    pub fn settings(&self) -> StepperPlotterSettings {
        StepperPlotterSettings { stored: self.stored(), ..*self.motion.settings() }
    }

    /// What the machine does.
    #[must_use]
    pub fn status(&self, now: Duration) -> Status {
        self.motion.status(now)
    }

    /// Servo of the pen, degrees.
    #[must_use]
    pub const fn pen_deg(&self) -> u8 {
        self.motion.pen_deg()
    }

    /// Power of the laser.
    #[must_use]
    pub const fn beam(&self) -> Beam<'_> {
        self.motion.beam()
    }

    /// How late steps have been given since the machine was switched on: whether the firmware's loop is fast
    /// enough, and what became of it if not.
    #[must_use]
    pub const fn lateness(&self) -> Lateness {
        self.motion.lateness()
    }

    /// Where the motors stand: steps really made.
    #[must_use]
    pub const fn position(&self) -> StepPoint {
        self.motion.position()
    }

    /// Where the pen is by the steps really made, mm.
    #[must_use]
    pub fn position_mm(&self) -> Point {
        self.motion.position_mm()
    }

    pub(super) fn work(&mut self, now: Duration) {
        let status = self.motion.status(now);
        self.receive.work(&status, &mut self.link);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_fits_into_a_small_microcontroller() {
        let sizes =
            [size_of::<Receive>(), size_of::<Link>(), size_of::<Motion>(), size_of::<StepperPlotter>()];
        std::println!("{sizes:?}");
        #[cfg(feature = "averaged-steps")]
        let of_average = size_of::<crate::stepgen::Average>();
        #[cfg(not(feature = "averaged-steps"))]
        let of_average = 0;
        assert!(size_of::<StepperPlotter>() - of_average < 8 * 1024, "{sizes:?}");
    }
}
