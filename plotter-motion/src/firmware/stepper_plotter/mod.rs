//! The controller of a plotter with two stepper motors, a pen on a servo or a laser, and limit switches,
//! which speaks to mDraw or to any program that streams G-code to Grbl.
//!
//! # Two tasks and a queue
//!
//! ```text
//!            Receive                  Link                   Motion
//!  bytes ──▶ lines, words ──▶ [ commands, 27 ] ──▶ planner ▶ steps ▶ safety gate ──▶ Step, each at its time
//!  bytes ◀── answers      ◀── [ reports, 3   ] ◀── done, homed, stopped             pen_deg, beam
//!                 └────── Signal: hold, resume, reset, laser off ──▶  (at once)       ▲
//!                 ◀────── Status: what it does, where it is ─────────┘     limit switches, emergency stop
//! ```
//!
//! The source runs these as two tasks of an RTOS. So can a firmware with [`Receive`] and [`Motion`]: each is
//! fed by its own calls, and they share nothing but the two queues, the signals (a notification) and a
//! [`Status`] (under a lock). [`StepperPlotter`] is both in one, for a firmware with a single loop, and for
//! the desk:
//!
//! ```
//! # use core::time::Duration;
//! # use plotter_motion::{LimitSwitches, SafetyGate, StepPoint};
//! # use plotter_motion::firmware::stepper_plotter::{Drivers, StepperPlotter, StepperPlotterSettings};
//! let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
//! let mut plotter = StepperPlotter::new(StepperPlotterSettings::default(), gate)?; // mDraw's machine, 87.58 steps/mm
//! let (mut now, mut answers, mut pulses) = (Duration::ZERO, Vec::new(), 0);
//! for line in ["M1 90\n", "G1 X3 Y4\n", "P\n", "G1 X381\n"] {
//!     for byte in line.bytes() {
//!         plotter.receive(now, byte);
//!     }
//!     loop {
//!         // `motors.drivers()` of `plotter-hal` on a machine: a step that they cannot take stays due.
//!         while let Some(step) = plotter.poll(now, Drivers::Ready) {
//!             pulses += 1; // `motors.step(step.pulse, now)`
//!         }
//!         while let Some(byte) = plotter.transmit(now) {
//!             answers.push(byte);
//!         }
//!         // A firmware arms a timer and sets servo and laser here.
//!         let Some(due) = plotter.due() else { break };
//!         now = due;
//!     }
//! }
//! assert_eq!(
//!     String::from_utf8(answers)?,
//!     "OK\r\n\
//!      distance=5.00\r\nOK\r\n\
//!      POS X3.00 Y4.00\r\nOK\r\n\
//!      error: (381.00, 4.00) mm lies outside (0, 0)..=(380, 310) mm: left out\r\nOK\r\n"
//! );
//! assert_eq!((pulses, plotter.position()), (350, StepPoint::new(263, 350))); // 4 mm of 87.58 steps
//! assert_eq!(plotter.pen_deg(), 90);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # mDraw
//!
//! Makeblock's drawing program sends a line, waits for `OK`, and sends the next. So there is nothing to look
//! ahead to: each line of a curve begins and ends at rest. Every line is answered by exactly one `OK`, and a
//! move when it is complete; the answers are those of the plotter's own firmware (xybot), byte for byte.
//!
//! | line | what it does | answer before `OK` |
//! |---|---|---|
//! | `G1 X… Y… A…`, `G0` | to there, mm; `A` delays each step, us, and holds | `distance=…`, also where nothing moves |
//! | `G28` | delay 0, pen up, laser off, homes | |
//! | `M1 …` | servo, degrees; answered at once, motors wait until it has settled | |
//! | `M2 U… D…` | keeps the angles of the pen | |
//! | `M3 …` | delay of each step, us | |
//! | `M4 …` | laser, 0 to 255 | |
//! | `M5 A… B… H… W… S…` | keeps directions, sides, speed; they hold after [`StepperPlotter::restart`] | |
//! | `M10` | | `M10 XY 380 310 0.00 0.00 A0 B0 H0 S80 U160 D90` |
//! | `M11` | | `M11 1 1 1 1`: y upper, y lower, x upper, x lower; 1 is open |
//! | `P` | | `POS X0.00 Y0.00` |
//! | `G91`, `G90` | X and Y of later lines are ways from where the pen is, or places again | |
//! | anything else | nothing | |
//!
//! Where that firmware goes wrong, this one does not follow. What it refuses it says in a line `error: …`
//! before the `OK`, since mDraw knows no other answer and passes over lines without `OK`; nothing moves then,
//! and the position stays right:
//!
//! | | there | here |
//! |---|---|---|
//! | a byte that came broken on the line ([`SUBSTITUTE`](crate::protocol::SUBSTITUTE)) | drawn as it is | `error: a byte …` |
//! | a line of 64 bytes or more | continues at the start of the buffer | `error: more than 63 bytes …` |
//! | beyond 374.1 mm | steps of 16 bits wrap, it runs the other way | drawn, up to the width; beyond the area an error |
//! | a line during a move | carried out within it; the move is lost, the position wrong | an error, in its turn; but `M4 0` darkens the laser at once |
//! | switches of an axis | either end counts as the lower one | each end by itself; x is homed first, then y |
//! | a letter without its number, an angle or power out of range | 0, or whatever the servo makes of it | an error |
//! | a laser at a standstill | burns on | is dark: its power follows the speed |
//! | a new start | forgets the position | keeps it |
//!
//! # Grbl
//!
//! Programs that stream (UGS, bCNC, cncjs, `LaserGRBL`) send many lines ahead, which are planned together:
//! curves are drawn without stops. A line is answered by `ok` or `error:n` when it lies in the queue, so a
//! program may count characters or wait for each answer. Blanks and comments take no room in a line of 80
//! characters. A machine at rest gathers lines for [`StepperPlotterSettings::gather`] before it starts.
//!
//! - The receive buffer has 128 bytes. As in Grbl 1.1h a line that has ended leaves it, also one that waits
//!   for room in the queue: all of the buffer is there for what comes behind that. While a line waits for its
//!   answer below, nothing more is read.
//! - What finds no room in the buffer is lost. Grbl loses single bytes, and draws what is left of a line if
//!   it still is one. Here whole lines are lost, and each is answered by `error:11` in its turn; of lines in
//!   a row that are sent without waiting for any answer the first 127 are.
//! - `G4` is answered when all before it and the pause are over, `M2` and `M30` when all before them is over,
//!   after `[MSG:Pgm End]`; a program waits for the machine by `G4 P0`. What lies in the receive buffer by
//!   then starts at once. `M3` and `M5` are answered when they lie in the queue; Grbl waits there, too.
//! - `Bf` tells how many of 15 blocks are free, those in progress among the others, and how many bytes the
//!   receive buffer takes.
//! - `?` is answered by `<Run|MPos:…|Bf:…|FS:…>` (`Pn` for pressed switches, `WCO` now and then), `!` brakes
//!   along the path and lifts the pen where it stands, `~` lowers it again and goes on, ctrl-X stops at once;
//!   the place stays known, as it is counted by steps really made.
//! - Overrides act on the way, as soon as the phase in progress is over: feeds (`0x90` to `0x94`, 10 to 200
//!   %), travels (`0x95` to `0x97`: 100, 50, 25 %), the laser's power (`0x99` to `0x9D`). The machine's
//!   limits hold whatever they say. They are told as `Ov` when they have changed, and now and then; a reset
//!   ends them. A controller with [`ExactOnly`](crate::planner::ExactOnly) overrides the laser only, and
//!   tells so.
//! - `$J=` moves by hand at its own `F`, from rest or after another jog, while G-code is locked out
//!   (`error:9`); `0x85` or `!` brakes along the path and forgets the jogs that wait, and the place stays
//!   known.
//! - `$$ $# $I $G $N $X $H` are answered. In the check mode (`$C`) lines are answered as if they were carried
//!   out; asleep (`$SLP`), with the pen lifted, the machine takes nothing until a reset; `$RST=#` forgets the
//!   places that `G10`, `G28.1` and `G30.1` have set, `$RST=$` sets back what `$n=` has changed, `$RST=*`
//!   does both and forgets the start-up lines.
//! - `$N0=` and `$N1=` keep a line each ([`StepperPlotter::startup_lines`]), which is carried out at once,
//!   and from then on whenever the machine has been switched on, reset or homed: `>G55:ok`. In an alarm it is
//!   only looked at.
//! - An arc in the plane of `G18` or `G19` is looked at as Grbl does, and is drawn as what it is seen from
//!   above, a line to its end. `G43.1` adds to a height, until `G49`.
//! - `$H` warns (`[MSG:Warning: …]`) of an axis that is not as long between its switches as at the homing
//!   before, which a firmware may have kept ([`StepperPlotter::homed`]), and of one that is shorter than its
//!   side of the area.
//! - With `$22=1` a machine that is switched on is locked until `$H` or `$X`; without it `$H` is `error:5`.
//!   `$n=value` changes what [`Setting`] lists, at rest: out of range it is `error:52` (grblHAL's), beyond
//!   100,000 steps/s `error:12`, for what cannot be changed `error:3`, unless it says what is so already.
//!   What is to be kept is [`StepperPlotter::settings`].
//! - Errors and alarms have Grbl's numbers. A target outside the area is `ALARM:2` and `error:33`: what was
//!   accepted is drawn to its end, and then the pen goes up. A limit switch is `ALARM:1`, the emergency stop
//!   `ALARM:10` (grblHAL's, Grbl has none). In an alarm lines get `error:9` until `$X` or `$H`.
//! - `M0` waits for `~`, with the pen lifted as by `!`; `M1` is no stop. Pens are lifted by `M5` and lowered
//!   by `M3`, or as [`StepperPlotterSettings::pen`] says; `M2` and `M30` lift them too. `M5` acts when its
//!   line comes, `M3` with the line or the dot that follows. A `G4` leaves the pen as it is. With the pen up
//!   the machine travels at its own speed, whatever `F` says.
//! - `G54` to `G59` have an origin each, set by `G10`, and `G28` and `G30` a place, set by `G28.1` and
//!   `G30.1`; a reset keeps them, switching off does not. By `G93` the `F` of a line is one of its time.
//! - Words that Grbl does not know are errors ([`Words::Grbl`](crate::gcode::Words::Grbl)), unless the pen is
//!   lifted by those of another firmware.
//! - With a third axis that words move (feature `third-motor`, `StepperPlotterSettings::z`) Z is one as X
//!   and Y are: lines and arcs end at its height, `?` tells it, `G10`, `G28`, `G30`, `G43.1`, `G92` and
//!   `$J=` have it, `$102`, `$112`, `$122` and `$132` are its own, and outside its travel it is `ALARM:2`.
//!   What rises is timed by its way in space, `F` too; by `G93` it is `error:20`. Without one, Z is what a
//!   text says of its pen, and is told as 0.
//! - Probes and the safety door are not there; a line that needs one is `error:20` or `error:3`.
//!   [`SpindlePen`] leaves out start-up lines, `$RST=$`, `$RST=*`, other planes and lengths as well,
//!   [`ExactOnly`](crate::planner::ExactOnly) `$RST=$` and `$RST=*`.
//!
//! # Late steps
//!
//! A driver needs some microseconds for each step. A main loop that comes late finds several due, and hears
//! from its drivers whether they can take one more ([`Drivers`]): what they cannot take is not counted, stays
//! due, and is made in a later turn. So no step is lost, and the position is that of the motors. Nor does the
//! machine hurry to catch up: a step that is more than 100 us late puts off all that follows by as much.
//! [`StepperPlotter::lateness`] tells how many steps were late, and how late the latest was: with anything
//! but zeros there, the loop is too slow for the speed of the machine.
//!
//! A firmware that plans in its main loop and steps in a timer's interrupt has no such loop: with the feature
//! `step-ahead` [`StepperPlotter::split`] takes the controller apart for that.
//!
//! # Play
//!
//! Where an axis turns round, extra steps take up its play ([`StepperPlotterSettings::backlash`]) while the
//! path goes on. What is told as a place is that of the carriage, also after a stop within the play.
//!
//! # The jerk as a vector
//!
//! With the feature `averaged-steps` the jerk of the whole motion is limited where the settings say so
//! ([`JerkLimit::Vector`](crate::planner::JerkLimit)): the steps are averaged over some hundredths of a
//! second, behind the plan and before the play. So the motors come to rest by that time later: the pen is
//! moved, a pause begins and a line is told as done once they have arrived, also after a hold and a cancelled
//! jog. A stop lets none of the steps on their way be made. Homing is not averaged. A `$n=` that would take
//! more steps on their way than the 4096 that have room is `error:12`.
//!
//! # A third motor
//!
//! With the feature `third-motor` and [`ThreeAxes`](crate::planner::ThreeAxes) a machine has a third axis
//! (`ZAxis`), a second motor on x or y (`SecondMotor`), or both. Their steps are given by the same
//! [`StepperPlotter::poll`]: z's alone ([`Pulse::z`](crate::safety::Pulse)), the second motor's with those
//! of the first. Homing begins with z, upwards, then makes the two motors square, then homes x and y. All of
//! it is the same in two halves.
//!
//! ```
//! # #[cfg(feature = "third-motor")] {
//! # use core::time::Duration;
//! # use plotter_motion::{LimitSwitches, SafetyGate, planner::ThreeAxes};
//! # use plotter_motion::firmware::StepperPlotter;
//! # use plotter_motion::firmware::stepper_plotter::{Dialect, Drivers, Receive, StepperPlotterSettings, ZAxis};
//! let z = ZAxis { steps_per_mm: 400.0, speed_mm_s: 10.0, ..ZAxis::default() };
//! let settings = StepperPlotterSettings { dialect: Dialect::Grbl, z: Some(z), ..StepperPlotterSettings::default() };
//! let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
//! let mut mill = StepperPlotter::<Receive, ThreeAxes>::with_modes(settings, gate)?;
//! let (mut now, mut steps) = (Duration::ZERO, [0, 0, 0]);
//! for byte in b"G0 Z5\nG1 X10 Y10 Z2 F600\n" {
//!     mill.receive(now, *byte);
//! }
//! loop {
//!     while let Some(step) = mill.poll(now, Drivers::Ready) {
//!         let made = [step.pulse.x(), step.pulse.y(), step.pulse.z()];
//!         steps = core::array::from_fn(|axis| steps[axis] + i32::from(made[axis]));
//!     }
//!     while mill.transmit(now).is_some() {} // to the host
//!     let Some(due) = mill.due() else { break };
//!     now = due;
//! }
//! assert_eq!((steps, mill.z_mm()), ([876, 876, 800], Some(2.0)));
//! # }
//! # Ok::<(), plotter_motion::firmware::stepper_plotter::SettingsError>(())
//! ```
//!
//! # Stops
//!
//! Every step passes [`SafetyGate::pass_step`](crate::SafetyGate::pass_step). The emergency stop takes the
//! steps away in the same call, switches the laser off, lifts the pen, and latches: it ends by
//! [`StepperPlotter::reset_emergency_stop`], [`StepperPlotter::restart`] or Grbl's `$X`, and only once the
//! button has been released. A step towards a pressed limit switch is not made, and stops the machine; away
//! from the switch it is free. A motor that is stopped at full speed may turn a little farther than its last
//! step: home the machine if it was fast.
//!
//! A reset by the host (ctrl-X) is the gate's, too: from its byte on no step passes, until [`Command::GoOn`]
//! or [`Command::Unlock`] says that the receive side has heard of it.
//!
//! Sources: Dounaev and Phan, "X-Y Plotter Project"; the firmware xybot and the program mDraw; the Grbl
//! project's wiki on version 1.1.

#[cfg(feature = "step-ahead")]
mod ahead;
mod area;
mod bytes;
mod command;
mod command_queue;
mod grbl;
mod homing_run;
mod lateness;
mod link;
mod mdraw;
mod motion;
mod output;
mod play;
mod plotter;
mod queue;
mod receive;
mod setting;
mod settings;
#[cfg(feature = "third-motor")]
mod squaring;
mod startup_lines;
mod status;
mod stored_bytes;
#[cfg(feature = "third-motor")]
mod z_axis;

#[cfg(feature = "step-ahead")]
pub use ahead::{Planning, Stepping, StepsAhead, Underruns};
pub use command::{Command, Report, Signal, Stop};
pub use command_queue::{COMMANDS, CommandQueue};
pub use grbl::{AnyPen, Grbl, Pens, SpindlePen};
pub use lateness::{Drivers, Lateness};
pub use link::{Link, REPORTS};
pub use mdraw::MDraw;
pub use motion::{Motion, Step};
pub use plotter::StepperPlotter;
pub use queue::Queue;
pub use receive::{Host, Receive};
pub use setting::{Setting, SettingProblem};
pub use settings::{CheckedSettings, Dialect, SettingsError, StepperPlotterSettings, StoredSettings};
#[cfg(feature = "third-motor")]
pub use squaring::{SecondMotor, SquaringError};
pub use startup_lines::StartupLines;
pub use status::{Activity, Percents, Status};
pub use stored_bytes::StoredError;
#[cfg(feature = "third-motor")]
pub use z_axis::{ZAxis, ZHoming, ZHomingError, ZPen};
