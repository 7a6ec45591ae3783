//! A pen that a simulated DC motor lifts between two switches: it comes to both ends, is not driven beyond,
//! and whatever is broken takes its drive away and is told.

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::config::AxisConfig;
use plotter_motion::control::{Lift, LiftFault, LiftSettings, LiftState};
use plotter_motion::plant::AxisPlant;
use plotter_motion::safety::EndSwitches;
use plotter_motion::{Duty, LimitSwitches, Pen, SafetyGate};
use proptest::prelude::*;

const STEP: Duration = Duration::from_micros(50);
/// From the lower switch to the upper one, mm.
const TRAVEL_MM: f64 = 4.0;

/// What is broken.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    Blocked,
    CrossedWires,
    /// A switch that never closes, and one whose wire is cut, which is as if it were always pressed.
    UpperOpen,
    LowerCut,
}

/// The motor of a gantry as a lift, with its switches.
struct Bench {
    lift: Lift,
    gate: SafetyGate,
    motor: AxisPlant,
    /// Where the motor stood at first, above the lower switch, mm.
    from_mm: f64,
    now: Duration,
    fault: Fault,
    duty: Duty,
    /// How long the motor had a drive in all.
    driven: Duration,
}

impl Bench {
    fn new(from_mm: f64, fault: Fault) -> Self {
        // A spindle: an eighth of a millimetre a turn.
        let axis = AxisConfig { counts_per_mm: 4_000.0, ..AxisConfig::default() };
        Self {
            lift: Lift::new(LiftSettings::default()),
            gate: SafetyGate::new(LimitSwitches::RELEASED, false),
            motor: AxisPlant::new(&axis, STEP.as_secs_f64()),
            from_mm,
            now: Duration::ZERO,
            fault,
            duty: Duty::ZERO,
            driven: Duration::ZERO,
        }
    }

    fn height_mm(&self) -> f64 {
        self.from_mm + self.motor.position_mm()
    }

    fn switches(&self) -> EndSwitches {
        let at_mm = self.height_mm();
        EndSwitches {
            lower: at_mm <= 0.0 || self.fault == Fault::LowerCut,
            upper: at_mm >= TRAVEL_MM && self.fault != Fault::UpperOpen,
        }
    }

    /// A while with the pen wanted there; the motor is looked after once in a millisecond.
    fn run(&mut self, pen: Pen, time: Duration) {
        let end = self.now + time;
        while self.now < end {
            if self.now.as_micros().is_multiple_of(1_000) {
                let switches = self.switches();
                self.gate.set_z_limits(switches);
                self.lift.go(self.now, pen);
                self.duty = self.gate.pass_z(self.lift.update(self.now, switches)).z();
                let into_switch =
                    self.duty.value() > 0.0 && switches.upper || self.duty.value() < 0.0 && switches.lower;
                assert!(!into_switch, "{:?} at {} mm", self.duty, self.height_mm());
            }
            if self.duty != Duty::ZERO {
                self.driven += STEP;
            }
            self.motor.stall(self.fault == Fault::Blocked);
            let sign = if self.fault == Fault::CrossedWires { -1.0 } else { 1.0 };
            self.motor.step(Duty::saturating(sign * self.duty.value()), |_| ());
            self.now += STEP;
        }
    }
}

proptest! {
    #![proptest_config(cases(32))]

    /// From wherever it stands, as often as it is asked, in any rhythm.
    #[test]
    fn it_comes_to_both_ends_from_anywhere(
        from_mm in 0.0..TRAVEL_MM,
        asks in prop::collection::vec((any::<bool>(), 1_u64..400), 1..8),
    ) {
        let mut bench = Bench::new(from_mm, Fault::None);
        for (up, ms) in asks {
            bench.run(if up { Pen::Up } else { Pen::Down }, Duration::from_millis(ms));
        }
        for pen in [Pen::Up, Pen::Down, Pen::Up] {
            bench.run(pen, Duration::from_secs(1));
            prop_assert_eq!(bench.lift.state(), LiftState::At(pen));
            prop_assert!(bench.lift.is_there() && bench.lift.due().is_none());
            let end_mm = if pen == Pen::Up { TRAVEL_MM } else { 0.0 };
            let beyond_mm = (bench.height_mm() - end_mm).abs();
            prop_assert!(beyond_mm < 0.5, "{} mm beyond its switch", beyond_mm);
        }
    }
}

#[test]
fn whatever_is_broken_is_told_and_takes_the_drive_away() {
    let settings = LiftSettings::default();
    for (fault, from_mm, to, found, at_most) in [
        (Fault::Blocked, 0.0, Pen::Up, LiftFault::NotLeft { to: Pen::Up }, settings.leaves),
        (Fault::Blocked, 2.0, Pen::Up, LiftFault::NotReached { to: Pen::Up }, settings.longest),
        (Fault::CrossedWires, 0.0, Pen::Up, LiftFault::NotLeft { to: Pen::Up }, settings.leaves),
        (Fault::UpperOpen, 1.0, Pen::Up, LiftFault::NotReached { to: Pen::Up }, settings.longest),
        (Fault::LowerCut, 4.5, Pen::Down, LiftFault::BothEnds, Duration::ZERO),
    ] {
        let mut bench = Bench::new(from_mm, fault);
        bench.run(to, Duration::from_secs(3));
        assert_eq!(bench.lift.state(), LiftState::Failed(found), "{fault:?}");
        assert!(bench.driven <= at_most + Duration::from_millis(1), "{fault:?}: {:?}", bench.driven);
        assert!(!bench.lift.is_there() && bench.lift.due().is_none());
        assert!(found.to_string().contains("switch"), "{found}");
    }
    // Said again, it is not tried again; asked to, it is, and it comes when it is free.
    let mut bench = Bench::new(0.0, Fault::Blocked);
    bench.run(Pen::Up, Duration::from_secs(1));
    bench.fault = Fault::None;
    bench.run(Pen::Up, Duration::from_secs(1));
    assert_eq!(bench.lift.state(), LiftState::Failed(LiftFault::NotLeft { to: Pen::Up }));
    bench.lift.retry(bench.now);
    bench.run(Pen::Up, Duration::from_secs(1));
    assert_eq!(bench.lift.state(), LiftState::At(Pen::Up));
}

#[test]
fn an_emergency_stop_ends_its_drive_at_once_and_one_that_sinks_is_driven_back() {
    let mut bench = Bench::new(0.0, Fault::None);
    bench.run(Pen::Up, Duration::from_millis(20));
    assert!(bench.driven > Duration::ZERO && bench.lift.state() == LiftState::Moving { to: Pen::Up });
    bench.gate.emergency_stop(true);
    let before = bench.driven;
    bench.run(Pen::Up, Duration::from_millis(100));
    assert!(bench.driven - before <= STEP && bench.duty == Duty::ZERO);
    bench.gate.emergency_stop(false);
    assert!(bench.gate.reset());
    bench.run(Pen::Up, Duration::from_secs(1));
    assert!(bench.lift.is_at(Pen::Up), "{:?}", bench.lift);
    // Something pulls it off its switch.
    bench.from_mm -= 2.0;
    assert!(bench.height_mm() < TRAVEL_MM);
    bench.run(Pen::Up, Duration::from_millis(2));
    assert_eq!(bench.lift.state(), LiftState::Moving { to: Pen::Up });
    bench.run(Pen::Up, Duration::from_secs(1));
    assert!(bench.lift.is_at(Pen::Up) && bench.height_mm() >= TRAVEL_MM);
}
