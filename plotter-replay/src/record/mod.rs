//! Recording a serial line while it is used.
//!
//! ```text
//!                    ┌────────── Relay ──────────┐
//!   host program ◀──▶│ port or pseudo terminal   │◀──▶ plotter        Tap: the same inside a host program
//!                    └────────────┬──────────────┘
//!                             Recorder ──▶ log, written through five times a second
//! ```
//!
//! What drives the plotter never waits for the disk: the bytes are handed over in memory, and a thread of its
//! own writes them. If the disk is full, the recording ends with a word, and the drawing goes on.

mod bench_recorder;
pub use bench_recorder::BenchRecorder;
mod recorder;
mod relay;
mod tap;

pub use recorder::{Recorded, Recorder};
pub use relay::{RelayEnd, RelayStop, relay};
pub use tap::Tap;
