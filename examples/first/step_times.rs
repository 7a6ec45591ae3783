//! A drawing becomes steps of two motors, each with its time: one line a step, in microseconds.
//!
//! `cargo run --release --example step_times`

use plotter_motion::stepgen::{MotorEvent, timed_events};
use plotter_motion::toolpath::rectangle;
use plotter_motion::{Machine, MachineConfig, Point, StepPair};
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let machine = Machine::new(MachineConfig::stepper_plotter())?;
    let drawing = rectangle(Point::new(10.0, 10.0), 20.0, 10.0);
    let mut out = BufWriter::new(std::io::stdout());
    for timed in timed_events(&machine, drawing)? {
        let timed = timed?;
        if let MotorEvent::Step(StepPair { x, y }) = timed.event {
            writeln!(out, "{} {x} {y}", timed.tick)?;
        }
    }
    Ok(out.flush()?)
}
