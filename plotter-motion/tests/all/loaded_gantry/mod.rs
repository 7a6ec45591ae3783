//! The gantry of examples/machines/loaded-gantry.toml: more to move, and a loop four times as fast.

#![allow(dead_code, reason = "each test uses its part of this")]
#![expect(unreachable_pub, reason = "shared by tests, not an interface")]

use plotter_motion::{MachineConfig, config::Decoding};

/// The loaded gantry, with encoders decoded so.
pub fn loaded_gantry(decoding: Decoding) -> MachineConfig {
    let mut config = decoded(MachineConfig::default(), decoding);
    let contouring = &mut config.dc_mut().unwrap().control.contouring;
    (contouring.jerk_mm_s3, contouring.loop_hz) = (2.0e6, 10_000.0);
    (contouring.bandwidth_hz, contouring.observer_hz) = (60.0, 250.0);
    let dc = config.dc_mut().unwrap();
    for axis in [&mut dc.x, &mut dc.y] {
        axis.load.inertia_kg_m2 = 5.0e-6;
        (axis.load.coulomb_n_m, axis.load.static_n_m) = (2.2e-3, 2.6e-3);
    }
    config
}

/// A gantry of 40 encoder lines a millimetre with its encoders decoded so.
pub fn decoded(mut config: MachineConfig, decoding: Decoding) -> MachineConfig {
    let dc = config.dc_mut().unwrap();
    for axis in [&mut dc.x, &mut dc.y] {
        axis.encoder.decoding = decoding;
        if decoding == Decoding::X4 {
            axis.counts_per_mm = 160.0;
        }
    }
    config
}
