//! The machines, as constants: `build.rs` reads `examples/machines/*.toml` on the host and checks them there.

include!(concat!(env!("OUT_DIR"), "/machine.rs"));

pub use gantry::{BAUD, DECODING, Gantry, PWM_STEPS, X, Y, gantry};
pub use stepper_plotter::{
    BAUD as PLOTTER_BAUD, CHECKED as CHECKED_PLOTTER, LASER, SETTINGS as PLOTTER, StepperPlotter,
};
