//! A controller in two halves: planning ahead in the main loop, stepping on time in a timer's interrupt.
//!
//! ```text
//!  main loop, or a task of low priority          │  timer's interrupt
//!                                                │
//!  bytes ──▶ Planning ─── StepsAhead ───────────▶│──▶ Stepping ──▶ SafetyGate ──▶ Pulse, each at its time
//!  bytes ◀── answers  ◀── steps made, switches ──│◀──              servo, beam
//! ```
//!
//! [`StepperPlotter::poll`](super::StepperPlotter::poll) plans and steps in one call, so a main loop that is
//! away for a while makes its steps late. Taken apart by
//! [`StepperPlotter::split`](super::StepperPlotter::split), the same controller is asked for its steps ahead
//! of their time, and they wait in [`StepsAhead`], where a main loop that is away does no harm. All else is
//! the same: what is answered, and when, what the host is told of the place, which is that of the steps
//! really made, and every step at its tick.
//!
//! # When the steps run out
//!
//! A main loop that is away for longer than there are steps does not stop the motors dead. The machine is
//! never faster than it can brake on the steps that are there: before they are too few, the times between
//! them are stretched, it comes to rest on the path, and speeds up again when there are more, with no more
//! than its acceleration on lines, and where it curves with what turning leaves of that.
//! [`Planning::underruns`] tells of it. A limit of the jerk does not hold then. A memory that is too small
//! for the greatest speed does the same: the machine is slower, and says so.
//!
//! # Stops
//!
//! The emergency stop, a limit switch and a reset by the host end the steps in the interrupt, whatever waits:
//! [`Stepping`] has the machine's [`SafetyGate`](crate::SafetyGate). A feed hold and the end of a jog brake
//! along the path behind the steps that wait, as Grbl's do behind its segments.
//!
//! ```
//! # use core::time::Duration;
//! # use plotter_motion::{LimitSwitches, SafetyGate, StepPoint};
//! # use plotter_motion::firmware::stepper_plotter::{Dialect, Drivers, StepperPlotter, StepperPlotterSettings, StepsAhead};
//! let settings = StepperPlotterSettings { dialect: Dialect::Grbl, ..StepperPlotterSettings::default() };
//! let plotter = StepperPlotter::new(settings, SafetyGate::new(LimitSwitches::RELEASED, false))?;
//! let mut memory = StepsAhead::<4096>::new(); // in a firmware a static cell
//! let (mut planning, mut stepping) = plotter.split(&mut memory);
//! for byte in b"G1 X10 F2400\n" {
//!     planning.receive(Duration::ZERO, *byte);
//! }
//! let mut steps = 0;
//! for now_us in (0..1_000_000_u32).step_by(10) {
//!     let now = Duration::from_micros(now_us.into());
//!     if now_us % 30_000 == 0 { // a main loop that comes every 30 ms
//!         while planning.plan(now) {}
//!         while planning.transmit(now).is_some() {} // to the host
//!     }
//!     while let Some(pulse) = stepping.tick(now_us, Drivers::Ready) {
//!         steps += i32::from(pulse.x()); // `motors.step(pulse, now)` of `plotter-hal`
//!     }
//! }
//! assert_eq!(steps, 876); // 10 mm of 87.58 steps
//! assert_eq!(planning.position(), StepPoint::new(876, 0));
//! assert_eq!((planning.lateness().steps(), planning.underruns().slowed_steps), (0, 0));
//! # Ok::<(), plotter_motion::firmware::stepper_plotter::SettingsError>(())
//! ```

pub(super) mod energy;
pub(super) mod makes;
mod planning;
mod shared;
mod stepping;
mod words;

pub use planning::Planning;
pub use shared::StepsAhead;
pub use stepping::Stepping;

/// How often a machine had fewer steps than it needs to brake. With anything but zeros here, the main loop is
/// away for too long, or the memory is too small for the speed of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Underruns {
    /// Steps that were made more slowly than planned.
    pub slowed_steps: u32,
    /// How often the machine came to rest where it was not to.
    pub stops: u32,
}
