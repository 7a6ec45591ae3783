//! The control test bed: a controller of one's own on simulated motors, ranked beside the published ones and
//! ours.
//!
//! ```text
//!  a machine's file ──▶ TestBed ──▶ the machine as it is: motors, loads, friction, play, belt, encoders, latency
//!                          │                      ▲ drive            │ edges
//!                          ▼                      │                  ▼
//!                 the same, described ──▶ controller (LineController) ◀── targets of a drawing
//!                 wrongly on purpose
//!                                            true pen against the line ──▶ Figures ──▶ Ranking
//! ```
//!
//! A controller of one's own is an [`AxisController`](crate::control::AxisController) for each axis, a
//! [`ContourController`](crate::control::ContourController) for both, or a whole
//! [`LineController`](crate::control::LineController); the crate's page has a complete one of thirty lines.
//! With pictures: `examples/my_controller.rs` of the repository, and `compare_controllers` for those that are
//! there.
//!
//! ```
//! use plotter_motion::testbed::{Drawing, Entry, Ranking, TestBed, TestBedSettings};
//! use plotter_motion::{Machine, MachineConfig};
//!
//! let bed = TestBed::new(&Machine::new(MachineConfig::default())?, TestBedSettings::default())?;
//! let mut entries = Entry::standard();
//! entries.retain(|entry| ["published", "feed-forward"].contains(&entry.name()));
//! let ranking = Ranking::run(&entries, &bed, &[Drawing::line(&bed, 30.0, 60.0)]);
//! assert_eq!(ranking.place("feed-forward"), Some(1));
//! assert_eq!(ranking.scores()[0].finished(), 1);
//! # Ok::<(), plotter_motion::ConfigError>(())
//! ```

mod bed;
#[cfg(feature = "alloc")]
mod drawing;
#[cfg(feature = "alloc")]
mod entry;
mod figures;
mod handling_times;
mod late_loop;
mod misjudged;

pub use bed::{Moment, TestBed, TestBedSettings};
#[cfg(feature = "alloc")]
pub use drawing::Drawing;
#[cfg(feature = "alloc")]
pub use entry::{Entry, Ranking, Score};
pub use figures::Figures;
pub use handling_times::HandlingTimes;
pub use late_loop::LateLoop;
pub use misjudged::misjudged;
