//! One machine with every kind of motor driver and a laser, under any sequence of calls, clock and faults:
//! what must hold on its pins at all times.

use crate::logic_analyser;

use logic_analyser::{Analyser, Broken, Fault, Wire};
use plotter_hal::a4988::{A4988, Timing};
use plotter_hal::h_bridge::{self, Decay, Drv8871, Tb6612};
use plotter_hal::{DcAxes, HBridge, Laser, StepperAxes, laser};
use plotter_motion::{Axis, Demand, Duty, LimitSwitches, SafetyGate, StepPair};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::time::Duration;

const TIMING: Timing = Timing::DRV8825;
const DEAD_TIME: Duration = Duration::from_micros(3);
const LASER_TIMEOUT: Duration = Duration::from_micros(50);
/// The drivers read a clock of whole microseconds.
const TICK: Duration = Duration::from_micros(1);

/// What may happen to a machine.
#[derive(Clone, Copy, Debug)]
enum Call {
    Wait {
        ns: u64,
    },
    /// Until a stepper driver wants its tick, and then so late.
    WaitUntilDue {
        late_ns: u64,
    },
    Tick,
    Step {
        x: i8,
        y: i8,
    },
    Cancel,
    Demand {
        x: i8,
        y: i8,
    },
    Beam {
        power: u16,
    },
    Limits {
        x_min: bool,
        x_max: bool,
        y_min: bool,
        y_max: bool,
    },
    Press,
    LetGo,
    Reset,
    Start,
    /// The access so many later fails.
    Fault {
        after: usize,
        kind: usize,
    },
    Repair,
}

fn calls() -> impl Strategy<Value = Vec<Call>> {
    let call = prop_oneof![
        3 => (0..6_000_u64).prop_map(|ns| Call::Wait { ns }),
        1 => (0..3_000_000_u64).prop_map(|ns| Call::Wait { ns }),
        6 => (0..2_000_u64).prop_map(|late_ns| Call::WaitUntilDue { late_ns }),
        4 => Just(Call::Tick),
        8 => (-1..=1_i8, -1..=1_i8).prop_map(|(x, y)| Call::Step { x, y }),
        1 => Just(Call::Cancel),
        4 => (-4..=4_i8, -4..=4_i8).prop_map(|(x, y)| Call::Demand { x, y }),
        2 => prop_oneof![Just(0_u16), 1..=u16::MAX].prop_map(|power| Call::Beam { power }),
        1 => any::<[bool; 4]>().prop_map(|[x_min, x_max, y_min, y_max]| Call::Limits { x_min, x_max, y_min, y_max }),
        1 => Just(Call::Press),
        1 => Just(Call::LetGo),
        1 => Just(Call::Reset),
        2 => Just(Call::Start),
        1 => (0..12_usize, 0..4_usize).prop_map(|(after, kind)| Call::Fault { after, kind }),
        1 => Just(Call::Repair),
    ];
    prop::collection::vec(call, 1..80)
}

type Stepper<'a> = A4988<Wire<'a>, Wire<'a>, Wire<'a>, Wire<'a>>;
type L293d<'a> = DcAxes<HBridge<Wire<'a>, Wire<'a>, Wire<'a>>, HBridge<Wire<'a>, Wire<'a>, Wire<'a>>>;
type Two<'a> = DcAxes<Drv8871<Wire<'a>, Wire<'a>>, Drv8871<Wire<'a>, Wire<'a>>>;
type Tb6612s<'a> =
    DcAxes<Tb6612<Wire<'a>, Wire<'a>, Wire<'a>, Wire<'a>>, Tb6612<Wire<'a>, Wire<'a>, Wire<'a>, Wire<'a>>>;

/// What both motors of a pair have last said of themselves: whether either may have drive that it should not
/// have.
#[derive(Clone, Copy, Debug, Default)]
struct MayRun([bool; 2]);

impl MayRun {
    fn note<Pin, Pwm>(&mut self, outcome: Result<(), plotter_hal::axis::Error<h_bridge::Error<Pin, Pwm>>>) {
        match outcome {
            Ok(()) => self.0 = [false; 2],
            Err(error) => {
                let runs = |error| matches!(error, Some(h_bridge::Error::NotStopped(_)));
                self.0 = [runs(error.x), runs(error.y)];
            }
        }
    }
}

struct Rig<'a> {
    analyser: &'a Analyser,
    gate: SafetyGate,
    demand: Demand,
    steppers: StepperAxes<Stepper<'a>, Stepper<'a>>,
    l293d: L293d<'a>,
    drv8871: Two<'a>,
    tb6612: Tb6612s<'a>,
    laser: Laser<Wire<'a>>,
    may_run: [MayRun; 3],
    laser_may_be_lit: bool,
    /// Rising edges that the steps taken must make: x, y.
    owed: [usize; 2],
    last_step: Option<Duration>,
    /// Of each access so far, whether the stop was latched.
    latched: Vec<bool>,
}

/// Voltages across the six DC motors, by the tables of the datasheets.
fn voltages(levels: &BTreeMap<&'static str, u16>) -> [[i32; 2]; 3] {
    let level = |wire| i32::from(levels.get(wire).copied().unwrap_or(0));
    [
        [
            (level("LX 1A") - level("LX 2A")) * level("LX EN"),
            (level("LY 1A") - level("LY 2A")) * level("LY EN"),
        ],
        [level("DX IN1") - level("DX IN2"), level("DY IN1") - level("DY IN2")],
        [
            (level("TX IN1") - level("TX IN2")) * level("TX PWM") * level("TX STBY"),
            (level("TY IN1") - level("TY IN2")) * level("TY PWM") * level("TY STBY"),
        ],
    ]
}

impl<'a> Rig<'a> {
    fn new(analyser: &'a Analyser) -> Self {
        let wire = |name| analyser.wire(name);
        let timing = TIMING.on_clock(TICK);
        let dead_time = DEAD_TIME + TICK;
        let steppers = StepperAxes::new(
            A4988::new(Axis::X, wire("X STEP"), wire("X DIR"), timing)
                .with_enable(wire("X ENABLE"))
                .with_sleep(wire("X SLEEP")),
            A4988::new(Axis::Y, wire("Y STEP"), wire("Y DIR"), timing)
                .with_enable(wire("Y ENABLE"))
                .with_sleep(wire("Y SLEEP")),
        );
        let l293d = DcAxes::new(
            HBridge::new(Axis::X, wire("LX EN"), wire("LX 1A"), wire("LX 2A")),
            HBridge::new(Axis::Y, wire("LY EN"), wire("LY 1A"), wire("LY 2A")),
            dead_time,
        );
        let drv8871 = DcAxes::new(
            Drv8871::new(Axis::X, wire("DX IN1"), wire("DX IN2"), Decay::Fast),
            Drv8871::new(Axis::Y, wire("DY IN1"), wire("DY IN2"), Decay::Slow),
            dead_time,
        );
        let tb6612 = DcAxes::new(
            Tb6612::new(Axis::X, wire("TX PWM"), wire("TX IN1"), wire("TX IN2"))
                .with_standby(wire("TX STBY")),
            Tb6612::new(Axis::Y, wire("TY PWM"), wire("TY IN1"), wire("TY IN2"))
                .with_standby(wire("TY STBY")),
            dead_time,
        );
        Self {
            analyser,
            gate: SafetyGate::new(LimitSwitches::RELEASED, false),
            demand: Demand::NONE,
            steppers,
            l293d,
            drv8871,
            tb6612,
            laser: Laser::new(wire("LASER"), LASER_TIMEOUT),
            may_run: [MayRun::default(); 3],
            laser_may_be_lit: false,
            owed: [0; 2],
            last_step: None,
            latched: Vec::new(),
        }
    }

    /// The reading of the clock.
    fn now(&self) -> Duration {
        Duration::from_micros(u64::try_from(self.analyser.now.get().as_micros()).unwrap())
    }

    fn rises(&self) -> [usize; 2] {
        ["X STEP", "Y STEP"].map(|wire| self.analyser.rises(wire))
    }

    fn call(&mut self, call: Call) {
        let before = self.rises();
        let now = self.now();
        match call {
            Call::Wait { ns } => self.wait(Duration::from_nanos(ns)),
            Call::WaitUntilDue { late_ns } => {
                let due = self.steppers.due().unwrap_or_default();
                self.wait(due.saturating_sub(self.analyser.now.get()) + Duration::from_nanos(late_ns));
                self.tick();
            }
            Call::Tick => self.tick(),
            Call::Step { x, y } => {
                if let Ok(pulse) = self.gate.pass_step(StepPair { x, y }) {
                    // A refusal leaves all as it was; any other error has lost what was owed.
                    let was_owed = self.owed;
                    match self.steppers.step(pulse, now) {
                        Ok(()) => {
                            self.owed[0] += usize::from(x.unsigned_abs());
                            self.owed[1] += usize::from(y.unsigned_abs());
                        }
                        Err(error) if error.x.or(error.y).is_some_and(is_refusal) => self.owed = was_owed,
                        Err(_) => self.owed = self.rises(),
                    }
                }
            }
            Call::Cancel => {
                if let Some(StepPair { x, y }) = self.steppers.cancel() {
                    self.owed[0] -= usize::from(x.unsigned_abs());
                    self.owed[1] -= usize::from(y.unsigned_abs());
                }
            }
            Call::Demand { x, y } => {
                let duty = |quarters: i8| Duty::saturating(f32::from(quarters) / 4.0);
                self.demand = Demand { x: duty(x), y: duty(y) };
                self.drive();
            }
            Call::Beam { power } => {
                let outcome = self.laser.shine(now, self.gate.pass_laser(power));
                self.note_laser(outcome);
            }
            Call::Limits { x_min, x_max, y_min, y_max } => {
                self.gate.set_limits(LimitSwitches { x_min, x_max, y_min, y_max });
            }
            Call::Press => {
                self.gate.emergency_stop(true);
                self.stop();
            }
            Call::LetGo => self.gate.emergency_stop(false),
            Call::Reset => {
                self.gate.reset();
            }
            Call::Start => {
                self.may_run[0].note(self.l293d.start());
                self.may_run[1].note(self.drv8871.start());
                self.may_run[2].note(self.tb6612.start());
                match self.steppers.start(now) {
                    Err(error) if error.x.or(error.y).is_some_and(is_refusal) => {}
                    _ => self.owed = self.rises(),
                }
            }
            Call::Fault { after, kind } => {
                self.analyser.set_fault(Fault::at(self.analyser.accesses() + after)[kind]);
            }
            Call::Repair => self.analyser.set_fault(Fault::None),
        }
        // The firmware tells the laser of each step that was made, and looks after it.
        let outcome = if self.rises() == before {
            self.laser.tick(self.now())
        } else {
            self.last_step = Some(self.analyser.now.get());
            self.laser.moved(self.now())
        };
        self.note_laser(outcome);
        self.latched.resize(self.analyser.accesses(), self.gate.is_stopped());
    }

    fn wait(&self, time: Duration) {
        self.analyser.now.set(self.analyser.now.get() + time);
    }

    fn tick(&mut self) {
        let now = self.now();
        if self.steppers.tick(now).is_err() {
            self.owed = self.rises();
        }
        self.drive();
    }

    /// The DC motors get what the gate lets through now.
    fn drive(&mut self) {
        let (now, drive) = (self.now(), self.gate.pass(self.demand));
        self.may_run[0].note(self.l293d.drive(drive, now));
        self.may_run[1].note(self.drv8871.drive(drive, now));
        self.may_run[2].note(self.tb6612.drive(drive, now));
    }

    /// Whoever latches the gate stops the drivers as well.
    fn stop(&mut self) {
        let _ = self.steppers.stop();
        self.owed = self.rises();
        self.may_run[0].note(self.l293d.stop());
        self.may_run[1].note(self.drv8871.stop());
        self.may_run[2].note(self.tb6612.stop());
        let outcome = self.laser.off();
        self.note_laser(outcome);
    }

    fn note_laser(&mut self, outcome: Result<(), laser::Error<Broken>>) {
        self.laser_may_be_lit = matches!(outcome, Err(laser::Error::NotOff(_)));
    }

    /// What must hold between any two calls.
    fn check(&self) -> Result<(), TestCaseError> {
        let levels = self.analyser.history().pop().unwrap_or_default().1;
        if self.gate.is_stopped() {
            for (pair, may_run) in voltages(&levels).into_iter().zip(self.may_run) {
                for (voltage, may_run) in pair.into_iter().zip(may_run.0) {
                    prop_assert!(voltage == 0 || may_run, "driven while stopped: {:?}", levels);
                }
            }
        }
        if self.analyser.level("LASER") > 0 && !self.laser_may_be_lit {
            let age = self.last_step.map(|at| self.analyser.now.get() - at);
            prop_assert!(!self.gate.is_stopped(), "lit while stopped");
            prop_assert!(age.is_some_and(|age| age < LASER_TIMEOUT + TICK), "lit without motion: {:?}", age);
        }
        let rises = self.rises();
        prop_assert!(rises[0] <= self.owed[0] && rises[1] <= self.owed[1], "a step nobody asked for");
        Ok(())
    }

    /// What must hold over the whole log.
    fn check_log(&self) -> Result<(), TestCaseError> {
        for (step, dir) in [("X STEP", "X DIR"), ("Y STEP", "Y DIR")] {
            prop_assert_eq!(self.analyser.too_short(step, dir, TIMING), Vec::<String>::new());
        }
        let effective =
            self.analyser.log().into_iter().zip(&self.latched).filter(|(access, _)| access.took_effect);
        let mut old: BTreeMap<&'static str, u16> = BTreeMap::new();
        // The last direction of each motor's voltage, and since when there is none.
        let mut last = [[(0, Duration::ZERO); 2]; 3];
        for ((access, &latched), (at, new)) in effective.zip(self.analyser.history()) {
            let was = old.get(access.wire).copied().unwrap_or(0);
            if latched {
                prop_assert!(!(access.wire.ends_with("STEP") && access.to > was), "a step while stopped");
            }
            for inputs in
                ["LX 1A", "LX 2A", "LY 1A", "LY 2A", "TX IN1", "TX IN2", "TY IN1", "TY IN2"].chunks(2)
            {
                let both = inputs.iter().all(|input| new.get(input) == Some(&1));
                prop_assert!(!both, "both inputs high: {:?}", inputs);
            }
            let (before, after) = (voltages(&old), voltages(&new));
            for kind in 0..3 {
                for axis in 0..2 {
                    let (before, after) = (before[kind][axis], after[kind][axis]);
                    let (direction, free_since) = &mut last[kind][axis];
                    prop_assert!(
                        !latched || after.abs() <= before.abs(),
                        "more drive while stopped: {:?}",
                        access
                    );
                    prop_assert!(before.signum() * after.signum() >= 0, "reversed under duty: {:?}", access);
                    if before != 0 && after == 0 {
                        *free_since = at;
                    }
                    if before == 0 && after != 0 {
                        let waited = *direction == after.signum() || at - *free_since >= DEAD_TIME;
                        prop_assert!(waited, "dead time: free since {:?}, {:?}", free_since, access);
                    }
                    if after != 0 {
                        *direction = after.signum();
                    }
                }
            }
            old = new;
        }
        Ok(())
    }
}

fn is_refusal<Pin>(error: plotter_hal::a4988::Error<Pin>) -> bool {
    use plotter_hal::a4988::Error;
    matches!(error, Error::Off | Error::Busy { .. })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is called, whenever, and whatever fails: no motor is driven and no laser lit while the stop
    /// is latched; no laser is lit without motion; no STEP pulse, pause, setup or hold time is shorter than
    /// the chip's; no bridge is reversed under duty or before its dead time; and no step that was taken is
    /// lost, or made twice.
    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn nothing_that_is_called_makes_a_machine_unsafe(calls in calls()) {
        let analyser = Analyser::default();
        let mut rig = Rig::new(&analyser);
        rig.call(Call::Start);
        for call in calls {
            rig.call(call);
            rig.check()?;
        }
        // All that was taken is made in the end, if nothing fails any more.
        rig.call(Call::Repair);
        for _ in 0..8 {
            rig.call(Call::WaitUntilDue { late_ns: 0 });
            rig.call(Call::Wait { ns: 1_000 });
            rig.check()?;
        }
        prop_assert_eq!(rig.rises(), rig.owed);
        rig.check_log()?;
    }
}
