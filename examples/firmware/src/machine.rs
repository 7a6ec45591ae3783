//! The machine, as constants: `build.rs` reads `examples/machines/*.toml` on the host and checks them there.

include!(concat!(env!("OUT_DIR"), "/machine.rs"));
