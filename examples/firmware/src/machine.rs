//! The machine, as constants: `build.rs` reads `examples/machines/*.toml` on the host and checks them there.

#![allow(
    unused_imports,
    clippy::unreadable_literal,
    clippy::excessive_precision,
    reason = "written by build.rs for either controller; floats as their shortest text"
)]

include!(concat!(env!("OUT_DIR"), "/machine.rs"));
