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
//! blocked for a while makes its steps late. [`StepperPlotter::split`](super::StepperPlotter::split) takes
//! the same controller apart: steps are planned ahead of their time and wait in [`StepsAhead`], so a blocked
//! main loop delays none. All else is the same:
//!
//! - answers to the host, and when they are sent;
//! - the position that the host is told, which is that of the steps really made;
//! - the tick of every step.
//!
//! `StepsAhead<N>` holds `N` words of 2 bytes; a step takes one, or a little more. A rule of thumb: `N` is at
//! least the steps that the fastest move makes while the main loop is blocked, and those of braking from full
//! speed.
//!
//! # When the steps run out
//!
//! If the main loop is blocked for longer than the steps last, the motors do not stop dead. The machine is
//! never faster than it can brake within the steps that are waiting. When few are left, the intervals between
//! them are stretched until it rests on the path; when there are more, it speeds up again. On lines it uses
//! its full acceleration, on curves what the centripetal acceleration leaves. [`Planning::underruns`] counts
//! such steps. A jerk limit is not kept in this case. A memory that is too small for the greatest speed does
//! the same: the machine is slower, and the counters say so.
//!
//! # Stops
//!
//! The emergency stop, a limit switch and a reset by the host end the steps in the interrupt, whatever is
//! queued: [`Stepping`] has the machine's [`SafetyGate`](crate::SafetyGate). A feed hold and the end of a jog
//! brake along the path after the steps already queued, as Grbl's do after its segments.
//!
//! ```
//! # use core::time::Duration;
//! # use plotter_motion::{LimitSwitches, SafetyGate, StepPoint};
//! # use plotter_motion::firmware::stepper_plotter::{Dialect, Drivers, StepperPlotter, StepperPlotterSettings, StepsAhead};
//! let settings = StepperPlotterSettings { dialect: Dialect::Grbl, ..StepperPlotterSettings::default() };
//! let plotter = StepperPlotter::new(settings, SafetyGate::new(LimitSwitches::RELEASED, false))?;
//! let mut memory = StepsAhead::<4096>::new(); // in a firmware a static cell
//! let (mut planning, mut stepping) = plotter.split(&mut memory)?;
//! for byte in b"G1 X10 F2400\n" {
//!     planning.receive(Duration::ZERO, *byte);
//! }
//! let mut steps = 0;
//! for now_us in (0..1_000_000_u32).step_by(10) {
//!     let now = Duration::from_micros(now_us.into());
//!     if now_us % 30_000 == 0 { // a main loop that comes every 30 ms; the queue holds all of this line
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

/// How often a machine had fewer steps queued than it needs to brake, since it was made; both counters wrap.
/// Anything but zeros means that the main loop is blocked for too long, or that the memory is too small for
/// the speed of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Underruns {
    /// Steps that were made more slowly than planned.
    pub slowed_steps: u32,
    /// Unplanned stops.
    pub stops: u32,
}
