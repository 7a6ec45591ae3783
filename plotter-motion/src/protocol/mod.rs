//! Protocols of the serial line, sans-IO: bytes to meaning and back.

pub mod digits;
pub mod ebb;
pub mod frame;
mod hello;
mod host;
pub mod hosts;
mod link;
mod link_host;
mod message;
mod order;
mod wire;

pub use hello::Hello;
pub use host::{Host, HostEvent, HostNotice, HostSettings};
pub use link::{CALL_ZEROS, LINK_VERSION, Link, LinkCounts, LinkSettings, LinkState};
pub use link_host::{LinkHost, LinkProgress, Resume};
pub use message::{MOST_MESSAGE, Message, MessageDecoder, MessageError};
pub use order::Order;
pub use wire::Wire;

/// What a firmware's serial driver hands to a controller in place of a byte that came broken, or of bytes
/// that were lost: the character that ASCII has for it, SUB (0x1A; ECMA-48, section 8.3.148). No host sends
/// it.
///
/// A byte that is just left out makes `X1` of `X12`, or of two targets a third one. With this in its place
/// [`digits::Receiver`] drops the target, and
/// [`StepperPlotter`](crate::firmware::stepper_plotter::StepperPlotter) the line, and both say so.
pub const SUBSTITUTE: u8 = 0x1A;
