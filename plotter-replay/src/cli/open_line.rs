//! [`open_line`]: the line to a machine by its name: a serial port, or a port on a network.

use crate::live::{Line, NetLine, PortLine};
use crate::serial::Port;
use std::sync::Arc;

/// What the name of a port on a network begins with.
const NET: &str = "tcp:";

/// Whether this is the name of a port on a network, which has no speed.
pub(super) fn is_net(name: &str) -> bool {
    name.starts_with(NET)
}

/// Opens the line; `has_handshake`: where a line of its cable says that the machine has no room.
pub(super) fn open_line(name: &str, baud: u32, has_handshake: bool) -> Result<Arc<dyn Line>, String> {
    let opened: Result<Arc<dyn Line>, _> = match name.strip_prefix(NET) {
        Some(address) => NetLine::connect(address).map(|line| Arc::new(line) as _),
        None => {
            let port =
                if has_handshake { Port::open_with_handshake(name, baud) } else { Port::open(name, baud) };
            port.and_then(PortLine::new).map(|line| Arc::new(line) as _)
        }
    };
    opened.map_err(|error| error.to_string())
}
