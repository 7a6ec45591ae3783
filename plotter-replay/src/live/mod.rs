//! A machine watched and driven while it draws, in a browser or a terminal.
//!
//! ```text
//!  drawing ──▶ Session ──▶ Line ──▶ machine on a serial port, or SimulatedMachine, in its own time
//!                │  ▲
//!      recording ◀┘  └──▶ Server ──▶ browser (127.0.0.1 only)     or a terminal
//! ```
//!
//! A [`Session`] owns the line: it sends the drawing target by target, records every byte, and keeps what is
//! to be seen in bounded memory. A [`Server`] or [`terminal::run`] shows that and hands on commands. The
//! emergency stop goes past the session's own loop: whoever presses it writes it on the line at once
//! ([`plotter_motion::protocol::Order::Stop`]).

mod by_hand;
mod commands;
mod desk;
mod drawing_step;
mod engine;
mod hosted;
mod journal;
mod line;
mod machine_line;
mod machine_log;
mod net_line;
mod pace;
mod page;
mod progress;
mod sender;
mod server;
mod session;
mod session_settings;
mod shape;
mod showing;
mod simulated;
mod tcp_line;
mod telling_belt;
pub mod terminal;
mod timetable;
mod view;

pub use commands::{Command, Hand, State};
pub use drawing_step::{DrawingStep, drawing_steps};
#[cfg(feature = "cli")]
pub(crate) use hosted::MARK;
pub use line::{Line, PortLine};
pub use machine_line::MachineLine;
pub use machine_log::{MachineLog, Recording};
pub use net_line::NetLine;
pub use page::LivePage;
pub use progress::Plan;
pub use server::{Server, ServerError};
pub use session::Session;
pub use session_settings::{LinkChoice, SessionSettings};
pub use shape::Shape;
pub use showing::Showing;
pub use simulated::{SimulatedMachine, Spoken, Telemetry, Watch};
pub use tcp_line::TcpLine;
pub use timetable::Timetable;
pub use view::HandProgress;
