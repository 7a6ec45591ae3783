//! Instructions that the controllers take on a Cortex-M4F, counted by QEMU. Prints a line each: what, mean,
//! worst, how many.
//!
//! Counts of instructions are not cycles: a real Cortex-M4 takes two cycles for most loads, up to 14 for a
//! division, and waits for its flash.
#![no_std]
#![no_main]

#[cfg(feature = "ahead")]
mod ahead;
mod counter;
mod drawings;
mod joint;

use core::fmt::Display;
use core::hint::black_box;
use core::time::Duration;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use counter::{Counter, Tally};
use plotter_motion::config::DcConfig;
use plotter_motion::control::{
    Contouring, ContouringSettings, LineController, LineTracking, LineTrackingSettings,
};
use plotter_motion::firmware::{Gantry, GantrySettings};
use plotter_motion::kinematics::{Cartesian, MotorScale};
use plotter_motion::plant::AxisPlant;
use plotter_motion::protocol::digits;
#[cfg(feature = "ahead")]
use plotter_motion::firmware::stepper_plotter::StepsAhead;
use plotter_motion::{Axis, Direction, LimitSwitches, Machine, MachineConfig, PathMode, Planner, PlannerSettings, PlotOp, SafetyGate, StepGen, StepPoint, planner::Action, stepgen::{MotorEvent, StepGenSettings, StepQueue}};
use vcell::VolatileCell;

fn print(what: impl Display, tally: Tally) {
    hprintln!("{}: mean {} worst {} of {}", what, tally.mean(), tally.worst(), tally.count());
}

/// Slope of every kind, in encoder counts.
const TARGETS: [(i32, i32); 8] =
    [(400, 400), (1200, 500), (1200, 1300), (1000, 2000), (300, 1900), (300, 200), (1000, 200), (0, 0)];

/// The gantry with its simulated motors, until every target is reached or a quarter of a minute is over.
fn gantry(counter: &Counter, machine: &Machine, name: &str, controller: impl LineController) {
    const STEP: Duration = Duration::from_micros(100);
    let dc = DcConfig::of(machine);
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut gantry = Gantry::with_settings(GantrySettings::of(machine), controller, gate);
    let mut plants = [&dc.x, &dc.y].map(|axis| AxisPlant::new(axis, STEP.as_secs_f64()));
    let (mut edges, mut ticks) = (Tally::default(), Tally::default());
    let mut targets = TARGETS.into_iter();
    let mut now = Duration::ZERO;
    let mut reached = true;
    while now < Duration::from_secs(15) {
        if reached {
            let Some((x, y)) = targets.next() else { break };
            for byte in digits::encode(StepPoint::new(x, y)).unwrap_or_default() {
                gantry.receive(now, byte);
            }
            reached = false;
        }
        let drive = gantry.drive();
        let mut seen: [Option<Direction>; 2] = [None; 2];
        for ((plant, axis), seen) in plants.iter_mut().zip([Axis::X, Axis::Y]).zip(&mut seen) {
            plant.step(drive.axis(axis), |edge| *seen = Some(edge.direction));
        }
        now += STEP;
        for (axis, seen) in [Axis::X, Axis::Y].into_iter().zip(seen) {
            if let Some(direction) = seen {
                let (duty, instructions) =
                    counter.count(|| edge(black_box(&mut gantry), now, axis, direction));
                black_box(duty);
                edges.add(instructions);
            }
        }
        if gantry.next_tick().is_some_and(|due| due <= now) {
            let (duty, instructions) = counter.count(|| tick(black_box(&mut gantry), now));
            black_box(duty);
            ticks.add(instructions);
        }
        while let Some(reply) = gantry.transmit() {
            reached |= reply == digits::Reply::Reached.byte();
        }
    }
    hprintln!("{}: {} targets left, {} ms", name, targets.len(), now.as_millis());
    hprintln!("{}: {} bytes", name, size_of_val(&gantry));
    for (what, tally) in [("edge to duty", edges), ("tick to duty", ticks)] {
        if tally.count() > 0 {
            print(format_args!("{name} {what}"), tally);
        }
    }
}

/// What the interrupt of an encoder does: from the edge to both timers' compare values.
#[inline(never)]
fn edge<C: LineController>(
    gantry: &mut Gantry<C>,
    now: Duration,
    axis: Axis,
    direction: Direction,
) -> [i32; 2] {
    gantry.edge(now, axis, direction);
    let drive = gantry.drive();
    [drive.x().steps(255), drive.y().steps(255)]
}

/// What the interrupt of the control loop does.
#[inline(never)]
fn tick<C: LineController>(gantry: &mut Gantry<C>, now: Duration) -> [i32; 2] {
    gantry.tick(now);
    let drive = gantry.drive();
    [drive.x().steps(255), drive.y().steps(255)]
}

#[inline(never)]
fn push(planner: &mut Planner<16>, op: PlotOp) -> bool {
    planner.push(op).is_ok()
}

#[inline(never)]
fn next_action(planner: &mut Planner<16>) -> Option<Action> {
    planner.next_action()
}

/// Plans a drawing with a ring that is kept full; `each` gets the actions. Counts what a block takes, from
/// pushing it to its last phase.
fn plan(
    counter: &Counter,
    settings: PlannerSettings,
    mut ops: impl Iterator<Item = PlotOp>,
    mut each: impl FnMut(Action),
) -> Tally {
    let mut blocks = Tally::default();
    let Ok(mut planner) = Planner::<16>::new(settings) else { return blocks };
    let (mut finished, mut block, mut filled) = (false, 0, false);
    loop {
        while !finished && planner.has_room() {
            match ops.next() {
                Some(op) => {
                    let (_, instructions) = counter.count(|| push(black_box(&mut planner), op));
                    // The first sixteen are not one block's.
                    block += if filled { instructions } else { 0 };
                }
                None => finished = planner.finish().is_ok(),
            }
        }
        filled = true;
        let (action, instructions) = counter.count(|| next_action(black_box(&mut planner)));
        block += instructions;
        let Some(action) = action else { return blocks };
        if matches!(action, Action::Course(_)) {
            blocks.add(core::mem::take(&mut block));
        }
        each(action);
    }
}

#[inline(never)]
fn prepare(planner: &mut Planner<16>) -> bool {
    planner.prepare()
}

/// As [`plan`], by a main loop that does other things between parts of a search: what each part takes.
fn parts(counter: &Counter, settings: PlannerSettings, mut ops: impl Iterator<Item = PlotOp>) -> Tally {
    let mut parts = Tally::default();
    let Ok(mut planner) = Planner::<16>::new(settings) else { return parts };
    let mut finished = false;
    loop {
        while !finished && planner.has_room() {
            finished = match ops.next() {
                Some(op) => !push(&mut planner, op),
                None => planner.finish().is_ok(),
            };
        }
        loop {
            let (more, instructions) = counter.count(|| prepare(black_box(&mut planner)));
            parts.add(instructions);
            if !more {
                break;
            }
        }
        let (action, instructions) = counter.count(|| next_action(black_box(&mut planner)));
        parts.add(instructions);
        if action.is_none() {
            return parts;
        }
    }
}

/// What the main loop does for a step: reckon it, and put it into the queue.
#[inline(never)]
fn fill(steps: &mut StepGen<Cartesian>, queue: &mut StepQueue<64>) -> bool {
    steps.next_event().is_some_and(|event| queue.push(event).is_ok())
}

/// Registers of a board, as plain memory: direction pins, step pins, and the timer's compare value.
struct Registers {
    direction: VolatileCell<u32>,
    step: VolatileCell<u32>,
    compare: VolatileCell<u32>,
}

impl Registers {
    fn new() -> Self {
        let register = || VolatileCell::new(0);
        Self { direction: register(), step: register(), compare: register() }
    }
}

/// What the timer's interrupt does: the event that is due, through the safety gate to the pins, and the timer
/// set to the next. Gives the events that are no steps to the main loop.
#[inline(never)]
fn interrupt(queue: &mut StepQueue<64>, gate: &SafetyGate, registers: &Registers) -> Option<MotorEvent> {
    let due = queue.pop()?;
    if let Some(after_ticks) = queue.next_after_ticks() {
        registers.compare.set(registers.compare.get().wrapping_add(after_ticks));
    }
    let MotorEvent::Step(step) = due.event else { return Some(due.event) };
    if let Ok(pulse) = gate.pass_step(step) {
        registers.direction.set(u32::from(pulse.x() < 0) | u32::from(pulse.y() < 0) << 1);
        registers.step.set(u32::from(pulse.x() != 0) | u32::from(pulse.y() != 0) << 1);
    }
    None
}

#[cfg(feature = "ahead")]
/// Late steps of both halves, with the main loop away for 20 ms in every 100 ms, at so many steps a second of
/// each motor.
fn in_two_halves(
    counter: &Counter,
    memory: &mut StepsAhead<{ ahead::WORDS }>,
    rate: u32,
    mode: &str,
    planner: PlannerSettings,
    drawings: &[&str],
) {
    let speed_mm_s = f64::from(rate) / 87.58;
    let planner = PlannerSettings { speed_mm_s, travel_speed_mm_s: speed_mm_s, accel_mm_s2: 10_000.0, ..planner };
    let (mut plan, mut tick) = (Tally::default(), Tally::default());
    // The emulator takes as long for a slow processor's instructions.
    let part = if cfg!(feature = "rp2040") { 2 } else { 1 };
    for drawing in drawings {
        let figures = match *drawing {
            "hatch" => drawn_so(counter, planner, memory, || drawings::hatch().take(8 / part)),
            "spiral" => drawn_so(counter, planner, memory, || drawings::spiral().take(300 / part)),
            "zigzag" => drawn_so(counter, planner, memory, || drawings::zigzag().take(80)),
            _ => drawn_so(counter, planner, memory, || drawings::strokes().take(64)),
        };
        tell(format_args!("{mode} {drawing} at {rate}"), &figures);
        plan.join(figures.plan);
        tick.join(figures.tick);
    }
    print(format_args!("ahead {mode} call of plan"), plan);
    print(format_args!("ahead {mode} step interrupt"), tick);
}

#[cfg(feature = "ahead")]
/// What comes of a drawing in two halves, beside one piece that draws the same here.
fn drawn_so<I: Iterator<Item = PlotOp>>(
    counter: &Counter,
    planner: PlannerSettings,
    memory: &mut StepsAhead<{ ahead::WORDS }>,
    ops: impl Fn() -> I,
) -> ahead::Figures {
    let alone = ahead::in_one(planner, ahead::Written::new(ops()));
    ahead::draw(counter, planner, memory, ahead::Written::new(ops()), alone)
}

#[cfg(feature = "ahead")]
fn tell(what: impl Display, figures: &ahead::Figures) {
    let ahead::Figures { steps, late, slowed, is_same, instructions, busy, ms, .. } = figures;
    let each = instructions / u64::from((*steps).max(1));
    hprintln!(
        "ahead {}: {} steps in {} ms, {} late, {} slowed, same {}, {} instructions a step, busy {} of 1000",
        what, steps, ms, late, slowed, is_same, each, busy
    );
}

/// The drawings on which planning is measured, whole, as a desktop has written them: a line with a name and
/// the row of steps that the desktop's controller in one piece makes in each mode, then the drawing's lines.
#[cfg(feature = "drawings")]
fn whole_drawings(counter: &Counter) {
    const TEXT: &str = include_str!(env!("PLOTTER_DRAWINGS"));
    let mut memory = StepsAhead::<{ ahead::WORDS }>::new();
    let exact = PlannerSettings { accel_mm_s2: 2000.0, ..PlannerSettings::default() };
    let (path, jerk_mm_s3) = (PathMode::Tolerance { path_tolerance_mm: 0.1 }, Some(50_000.0));
    let modes = [
        ("exact", exact),
        ("tolerance", PlannerSettings { path, ..exact }),
        ("s-curve", PlannerSettings { jerk_mm_s3, ..exact }),
        ("tolerance s-curve", PlannerSettings { path, jerk_mm_s3, ..exact }),
    ];
    for drawing in TEXT.split(';').skip(1) {
        let Some((head, lines)) = drawing.split_once('\n') else { continue };
        let (mut plan, mut tick) = (Tally::default(), Tally::default());
        let mut words = head.split('\t');
        let name = words.next().unwrap_or_default();
        for ((mode, planner), sum) in modes.into_iter().zip(words) {
            let alone = u64::from_str_radix(sum, 16).unwrap_or_default();
            let figures = ahead::draw(counter, planner, &mut memory, ahead::lines(lines), alone);
            tell(format_args!("{mode}, {name}"), &figures);
            plan.join(figures.plan);
            tick.join(figures.tick);
        }
        print(format_args!("ahead {name} call of plan"), plan);
        print(format_args!("ahead {name} step interrupt"), tick);
    }
}

#[cfg(feature = "ahead")]
/// The same in all modes; or at several rates in mode exact.
fn all_in_two_halves(counter: &Counter) {
    let mut memory = StepsAhead::<{ ahead::WORDS }>::new();
    let memory = &mut memory;
    let exact = PlannerSettings::default();
    if cfg!(feature = "rp2040") {
        for rate in [2_000, 3_000, 4_000, 6_000] {
            in_two_halves(counter, memory, rate, "exact", exact, &["hatch", "spiral"]);
        }
    } else {
        let path = PathMode::Tolerance { path_tolerance_mm: 0.05 };
        let jerk_mm_s3 = Some(500_000.0);
        // The emulator takes a second for some million instructions: of the other modes two drawings.
        let some = &["spiral", "strokes"];
        in_two_halves(counter, memory, 40_000, "exact", exact, &["hatch", "spiral", "zigzag", "strokes"]);
        in_two_halves(counter, memory, 40_000, "tolerance", PlannerSettings { path, ..exact }, some);
        in_two_halves(counter, memory, 40_000, "s-curve", PlannerSettings { jerk_mm_s3, ..exact }, some);
        let both = PlannerSettings { path, jerk_mm_s3, ..exact };
        in_two_halves(counter, memory, 40_000, "tolerance s-curve", both, some);
    }
    hprintln!("ahead: {} bytes between the halves, {} instructions a microsecond", size_of_val(memory), ahead::PER_US);
}

#[entry]
fn main() -> ! {
    let Some(peripherals) = cortex_m::Peripherals::take() else { loop {} };
    let counter = Counter::new(peripherals.SYST);
    if cfg!(feature = "rp2040") {
        #[cfg(feature = "rp2040")]
        all_in_two_halves(&counter);
        debug::exit(debug::EXIT_SUCCESS);
    }
    #[cfg(feature = "drawings")]
    {
        whole_drawings(&counter);
        debug::exit(debug::EXIT_SUCCESS);
    }
    let Ok(machine) = Machine::new(MachineConfig::default()) else { loop {} };

    gantry(&counter, &machine, "published", LineTracking::with_settings(LineTrackingSettings::of(&machine)));
    gantry(&counter, &machine, "contouring", Contouring::with_settings(ContouringSettings::of(&machine)));

    let exact = PlannerSettings::default();
    let tolerance = PlannerSettings { path: PathMode::Tolerance { path_tolerance_mm: 0.05 }, ..exact };
    let curved = PlannerSettings { jerk_mm_s3: Some(20_000.0), ..exact };
    for (mode, settings) in [("exact", exact), ("tolerance", tolerance), ("s-curve", curved)] {
        let mut all = Tally::default();
        for (drawing, tally) in [
            ("hatch", plan(&counter, settings, drawings::hatch(), |_| ())),
            ("spiral", plan(&counter, settings, drawings::spiral(), |_| ())),
            ("zigzag", plan(&counter, settings, drawings::zigzag(), |_| ())),
            ("strokes", plan(&counter, settings, drawings::strokes(), |_| ())),
        ] {
            print(format_args!("plan {mode} {drawing}"), tally);
            all.join(tally);
        }
        print(format_args!("plan {mode} all"), all);
    }
    let mut all = parts(&counter, curved, drawings::hatch());
    all.join(parts(&counter, curved, drawings::spiral()));
    all.join(parts(&counter, curved, drawings::zigzag()));
    all.join(parts(&counter, curved, drawings::strokes()));
    print("plan s-curve part", all);

    let motor = MotorScale { steps_per_mm: 100.0, inverted: false };
    if let Ok(kinematics) = Cartesian::new(motor, motor) {
        let mut generator = StepGen::new(kinematics, StepGenSettings::default());
        let (gate, registers, mut queue) = (SafetyGate::new(LimitSwitches::RELEASED, false), Registers::new(), StepQueue::new());
        let (mut filled, mut made, mut others) = (Tally::default(), Tally::default(), 0);
        plan(&counter, exact, drawings::strokes(), |action| {
            let _ = generator.push(action);
            loop {
                let (more, instructions) =
                    counter.count(|| fill(black_box(&mut generator), black_box(&mut queue)));
                if !more {
                    break;
                }
                filled.add(instructions);
                let (other, instructions) = counter
                    .count(|| interrupt(black_box(&mut queue), black_box(&gate), black_box(&registers)));
                others += u32::from(other.is_some());
                made.add(instructions);
            }
        });
        hprintln!("step: {} other events, {} bytes of queue", others, size_of_val(&queue));
        print("step reckoned", filled);
        print("step interrupt", made);
    }
    #[cfg(feature = "ahead")]
    all_in_two_halves(&counter);
    for (name, dust) in [("joint from 16 crossings", 0), ("joint with three grains of dust", 3)] {
        let (tally, silent) = joint::joints(&counter, dust);
        hprintln!("{}: {} of {} refused", name, silent, tally.count());
        print(name, tally);
    }
    debug::exit(debug::EXIT_SUCCESS);
    loop {}
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}
