//! Wires that break while a machine draws: the fault is noticed and reported, and no motor runs away.

#![cfg(feature = "toml")]

use core::time::Duration;
use plotter_motion::control::{AxisTrouble, Contouring, LineController, Trouble};
use plotter_motion::plant::AxisPlant;
use plotter_motion::{
    Axis, Direction, Drive, Duty, LimitSwitches, Machine, MachineConfig, SafetyGate, StepPoint,
    config::Decoding,
    encoder::{Phases, QuadratureX1, QuadratureX4},
};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// None, but edges are looked for once in a tenth of a millisecond, and those since then told together.
    LookedFor,
    /// The wires of the x motor are crossed, from the start.
    CrossedWires,
    /// Phase A gives no edges, phase B stays low or high, every edge comes twice; for a second.
    NoPhaseA,
    PhaseBLow,
    PhaseBHigh,
    EveryEdgeTwice,
    /// The supply has half its voltage for a second.
    HalfTheSupply,
    /// A hand holds the x shaft for a second.
    Held,
}

/// How a drawing of six lines went.
struct Outcome {
    /// What was told first, and how long after the fault made a difference.
    told: Option<(AxisTrouble, Duration)>,
    /// How long after that nothing was driven any more.
    stopped: Option<Duration>,
    reached: usize,
    /// How far the pen was from where the controller thought it to be, and its greatest speed since the
    /// fault.
    astray_mm: f64,
    fastest_mm_s: f64,
}

const STEP: Duration = Duration::from_micros(10);

enum Decoder {
    X1(QuadratureX1),
    X4(QuadratureX4),
}

impl Decoder {
    fn update(&mut self, phases: Phases) -> Option<Direction> {
        match self {
            Self::X1(decoder) => decoder.update(phases),
            Self::X4(decoder) => decoder.update(phases),
        }
    }
}

struct Bench {
    controller: Contouring,
    gate: SafetyGate,
    duties: [Duty; 2],
    next_tick: Duration,
}

impl Bench {
    fn ticks_until(&mut self, now: Duration) {
        while self.next_tick <= now {
            let demand = self.controller.tick(self.next_tick);
            self.apply(demand);
            self.next_tick += self.controller.period().unwrap();
        }
    }

    fn apply(&mut self, demand: plotter_motion::Demand) {
        let drive: Drive = self.gate.pass(demand);
        self.duties = [drive.x(), drive.y()];
        self.controller.applied(drive);
    }
}

/// The next whole tenth of a millisecond.
fn looked_for(at: Duration) -> Duration {
    Duration::from_micros(u64::try_from(at.as_micros()).unwrap().next_multiple_of(100))
}

fn draw(machine: &Machine, fault: Fault) -> Outcome {
    const PLACES_MM: [(i32, i32); 6] = [(40, 20), (10, 60), (50, 60), (20, 10), (60, 50), (15, 15)];
    let config = machine.config();
    let from = if fault == Fault::CrossedWires { Duration::ZERO } else { Duration::from_millis(150) };
    let to = from + Duration::from_secs(1);
    let mut axes = [&config.dc().unwrap().x, &config.dc().unwrap().y]
        .map(|axis| AxisPlant::new(axis, STEP.as_secs_f64()));
    let mut decoder = match config.dc().unwrap().x.encoder.decoding {
        Decoding::X4 => Decoder::X4(QuadratureX4::new(axes[0].phases())),
        _ => Decoder::X1(QuadratureX1::new(axes[0].phases())),
    };
    let controller = Contouring::new(machine);
    let mut bench = Bench {
        next_tick: controller.period().unwrap(),
        controller,
        gate: SafetyGate::new(LimitSwitches::RELEASED, false),
        duties: [Duty::ZERO; 2],
    };
    let mut outcome = Outcome { told: None, stopped: None, reached: 0, astray_mm: 0.0, fastest_mm_s: 0.0 };
    let mut now = Duration::ZERO;
    let mut differs_since = None;
    let mut last_x = 0.0;
    for (x_mm, y_mm) in PLACES_MM {
        let counts =
            |mm: i32| plotter_motion::toolpath::from_mm(f64::from(mm), config.dc().unwrap().x.counts_per_mm);
        let demand = bench.controller.start(now, StepPoint::new(counts(x_mm), counts(y_mm)));
        bench.apply(demand);
        let begun = now;
        while !bench.controller.has_arrived() && now - begun < Duration::from_secs(4) {
            let is_on = (from..to).contains(&now);
            let mut edges = Vec::new();
            axes[0].stall(is_on && fault == Fault::Held);
            let duty = match fault {
                Fault::CrossedWires => -bench.duties[0].value(),
                Fault::HalfTheSupply if is_on => 0.5 * bench.duties[0].value(),
                _ => bench.duties[0].value(),
            };
            axes[0].turn(Duty::saturating(duty), |change| {
                let mut phases = change.phases;
                match fault {
                    Fault::NoPhaseA if is_on => phases.a = false,
                    Fault::PhaseBLow if is_on => phases.b = false,
                    Fault::PhaseBHigh if is_on => phases.b = true,
                    _ => {}
                }
                if let Some(direction) = decoder.update(phases) {
                    edges.push((now + STEP.mul_f64(change.share_of_step), Axis::X, direction));
                    if is_on && fault == Fault::EveryEdgeTwice {
                        edges.push((now + STEP.mul_f64(change.share_of_step), Axis::X, direction));
                    }
                }
            });
            axes[1].step(bench.duties[1], |edge| {
                edges.push((now + STEP.mul_f64(edge.share_of_step), Axis::Y, edge.direction));
            });
            edges.sort_by_key(|edge| edge.0);
            for (at, axis, direction) in edges {
                let at = if fault == Fault::LookedFor { looked_for(at) } else { at };
                bench.ticks_until(at);
                let demand = bench.controller.edge(at, axis, direction);
                bench.apply(demand);
            }
            now += STEP;
            bench.ticks_until(now);

            let x_mm = axes[0].position_mm();
            let counted = f64::from(bench.controller.position().x);
            // of the shaft: what play and belt keep back no encoder on a motor sees
            let astray_mm =
                (axes[0].position_counts() - counted).abs() / config.dc().unwrap().x.counts_per_mm;
            let makes_a_difference = match fault {
                Fault::None | Fault::LookedFor => false,
                Fault::CrossedWires | Fault::Held | Fault::HalfTheSupply => {
                    (is_on || fault == Fault::CrossedWires) && bench.duties[0].value() != 0.0
                }
                _ => is_on && astray_mm > 2.0 / config.dc().unwrap().x.counts_per_mm,
            };
            if makes_a_difference && differs_since.is_none() {
                differs_since = Some(now);
            }
            if let (Some(trouble), None) = (bench.controller.trouble(), outcome.told) {
                outcome.told = Some((trouble, now.saturating_sub(differs_since.unwrap_or(now))));
            }
            if bench.controller.trouble().is_some_and(|found| found.trouble.stops()) {
                outcome.stopped.get_or_insert(now.saturating_sub(differs_since.unwrap_or(now)));
            }
            outcome.astray_mm = outcome.astray_mm.max(astray_mm);
            if now > from {
                outcome.fastest_mm_s = outcome.fastest_mm_s.max((x_mm - last_x).abs() / STEP.as_secs_f64());
            }
            last_x = x_mm;
        }
        if bench.controller.trouble().is_some_and(|found| found.trouble.stops()) {
            // nothing is driven any more: it runs down, and stays
            for _ in 0..50_000 {
                axes[0].step(bench.duties[0], |_| ());
            }
            assert_eq!(bench.duties[0], Duty::ZERO);
            break;
        }
        outcome.reached += usize::from(bench.controller.has_arrived());
    }
    outcome
}

const MACHINES: [&str; 5] =
    ["loaded-gantry", "semi-virtual-gantry", "loaded-gantry-x4", "marking-board-motors", "worn-gantry"];

fn machine(name: &str) -> Machine {
    let file = format!("{}/../examples/machines/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"));
    Machine::new(MachineConfig::from_toml(&text).unwrap()).unwrap()
}

/// Lets all machines draw with a fault; gives what was told.
fn told(fault: Fault) -> [Option<Trouble>; 5] {
    MACHINES.map(|name| {
        let machine = machine(name);
        let outcome = draw(&machine, fault);
        let told = outcome.told.map(|(found, after)| (found.trouble, after));
        println!(
            "{name}, {fault:?}: {told:?}, stopped {:?}, {} of 6 lines, {:.3} mm astray, {:.0} mm/s",
            outcome.stopped, outcome.reached, outcome.astray_mm, outcome.fastest_mm_s
        );
        if let Some((found, after)) = outcome.told {
            assert_eq!(found.axis, Axis::X);
            assert!(after <= Duration::from_millis(50), "{name}, {fault:?}: {after:?}");
        }
        let waits = outcome.stopped.is_some();
        if fault == Fault::EveryEdgeTwice {
            let soon = outcome.stopped.is_some_and(|after| after <= Duration::from_millis(50));
            assert!(soon, "{name}: {:?}", outcome.stopped);
        }
        assert!(waits || outcome.reached == 6, "{name}, {fault:?}: {} of 6", outcome.reached);
        // never a run-away: not much faster than the feed, and what a motor runs down from it; the worn
        // gantry starts so gently that it takes longer to see that it goes the wrong way
        let (feeds, most_mm) = if name == "worn-gantry" { (2.0, 30.0) } else { (1.6, 20.0) };
        let feed_mm_s = machine.config().dc().unwrap().control.contouring.feed_mm_s;
        assert!(outcome.fastest_mm_s < feeds * feed_mm_s, "{name}, {fault:?}: {} mm/s", outcome.fastest_mm_s);
        assert!(outcome.astray_mm < most_mm, "{name}, {fault:?}: {} mm", outcome.astray_mm);
        told.map(|(trouble, _)| trouble)
    })
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_that_is_well_is_not_complained_of() {
    assert_eq!(told(Fault::None), [None; 5]);
}

/// Edges that are told two and more at a time are no encoder that counts each twice.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_whose_edges_are_looked_for_is_not_stopped() {
    for name in MACHINES {
        let outcome = draw(&machine(name), Fault::LookedFor);
        assert!(outcome.stopped.is_none() && outcome.reached >= 5, "{name}: {:?}", outcome.told);
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn crossed_wires_stop_the_motors() {
    assert_eq!(told(Fault::CrossedWires), [Some(Trouble::WrongWay); 5]);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_silent_encoder_is_taken_for_a_shaft_that_is_held_and_tried_in_short_pushes() {
    for trouble in told(Fault::NoPhaseA) {
        // the x4 decoder still sees phase B, to and fro
        assert!(matches!(trouble, Some(Trouble::Held | Trouble::Encoder)), "{trouble:?}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_lost_phase_and_double_edges_stop_the_motors() {
    for fault in [Fault::PhaseBLow, Fault::PhaseBHigh, Fault::EveryEdgeTwice] {
        for trouble in told(fault) {
            // B high is right as long as the shaft goes forwards
            let is_right = fault == Fault::PhaseBHigh && trouble.is_none();
            assert!(is_right || trouble.is_some_and(Trouble::stops), "{fault:?}: {trouble:?}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn half_the_supply_is_told_and_drawn_with() {
    assert_eq!(told(Fault::HalfTheSupply), [Some(Trouble::Changed); 5]);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_shaft_that_is_held_is_told_and_goes_on_when_it_is_let_go() {
    assert_eq!(told(Fault::Held), [Some(Trouble::Held); 5]);
}
