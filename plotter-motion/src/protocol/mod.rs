//! What goes over the serial line, sans-IO: bytes in, meaning out, and back.

pub mod digits;
mod host;
mod wire;

pub use host::{Host, HostEvent, HostNotice, HostSettings};
pub use wire::Wire;
