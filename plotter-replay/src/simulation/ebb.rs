//! An EBB, and the AxiDraw or the machine with two axes that its motors move.

use super::steppers::Steppers;
use super::{Simulation, Told};
use crate::player::EbbBoard;
use core::time::Duration;
use plotter_motion::Machine;
use plotter_motion::kinematics::BeltSigns;

/// How the motors of the AxiDraw move its pen: x + y turns the first one and y - x the second. The sheet is
/// seen from the end of the machine at which the pen begins, with the machine's long axis upwards: the
/// command XM calls that one A and our x B.
const AXIDRAW: BeltSigns = BeltSigns::TrackingEquations;

/// The machine with this description, at its origin, behind an EBB: both motors on one belt as in the
/// AxiDraw, or each with an axis.
pub(crate) fn ebb(machine: &Machine, is_mixed: bool) -> Simulation<EbbBoard, Steppers> {
    let world = Steppers::of(machine).with_belt(is_mixed.then_some(AXIDRAW));
    Simulation::new(EbbBoard::switched_on(), world, machine.config().serial.baud)
}

impl Told for EbbBoard {
    fn told(&self, _: Duration) -> (&'static str, Option<f64>) {
        let doing = match (self.has_motor_power(), self.is_busy()) {
            (false, _) => "without the motors' supply",
            (_, true) => "draws",
            (_, false) => "idle",
        };
        (doing, None)
    }
}
