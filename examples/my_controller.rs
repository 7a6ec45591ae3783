//! A controller of your own, ranked beside the published ones and ours: change this file, and run it.
//!
//! `cargo run --release --example my_controller -- --html target/mine.html` draws the pictures too; `--help` says what else.

use plotter_motion::config::DcConfig;
use plotter_motion::control::{AxisController, AxisState, ShaftModel, TwoAxes};
use plotter_motion::testbed::Entry;
use plotter_motion::{Duty, config::AxisConfig};
use std::process::ExitCode;

/// PI on the position and P on the speed, in shares of the supply.
struct Mine {
    by_count: f32,
    by_count_s: f32,
    sum: f32,
}

impl Mine {
    /// From what the machine's file says of an axis, which on the test bed is a quarter wrong.
    fn of(axis: &AxisConfig) -> Self {
        let model = ShaftModel::new(axis);
        let most = model.accel_per_volt * model.supply_v; // acceleration by the whole supply, counts/s^2
        Self { by_count: 40_000.0 / most, by_count_s: 400.0 / most, sum: 0.0 }
    }
}

impl AxisController for Mine {
    fn start(&mut self, _duration_s: f32) {
        self.sum = 0.0;
    }

    fn update(&mut self, state: &AxisState, dt_s: f32) -> Duty {
        self.sum = (self.sum + 50.0 * self.by_count * state.error() * dt_s).clamp(-0.5, 0.5);
        Duty::saturating(self.by_count * state.error() + self.by_count_s * state.speed_error() + self.sum)
    }
}

fn main() -> ExitCode {
    plotter_examples::compare::compare_controllers(vec![Entry::contour("mine", |machine| {
        let dc = DcConfig::of(machine);
        TwoAxes { x: Mine::of(&dc.x), y: Mine::of(&dc.y) }
    })])
}
