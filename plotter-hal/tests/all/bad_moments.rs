//! A whole board, with its controller, drivers and switches, to which something happens in the middle of a
//! drawing, at any moment: a port expander is silent, or the supply sags until the processor starts anew.
//! The motors stop, it is told, and nothing moves before a person has looked.

use core::time::Duration;
use embedded_hal::digital::{self, InputPin, OutputPin};
use plotter_hal::a4988::Timing;
use plotter_hal::{
    A4988, EstopChange, EstopInput, LimitSwitch, LimitSwitchGroup, NoPin, StepperAxes, SwitchSettings,
};
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{Activity, Dialect, StepperPlotterSettings};
use plotter_motion::{Axis, Direction, SafetyGate, StepPoint};
use proptest::prelude::*;
use std::cell::Cell;
use std::rc::Rc;

/// The expander did not answer.
#[derive(Debug, PartialEq)]
struct NoAnswer;

impl digital::Error for NoAnswer {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

/// A wire, how often it rose, and whether its chip answers.
#[derive(Clone, Debug, Default)]
struct Wire {
    high: Rc<Cell<bool>>,
    rises: Rc<Cell<u32>>,
    /// What keeps it from answering; a wire of the processor itself has nothing.
    silent: Rc<Cell<bool>>,
}

impl Wire {
    fn set(&self, high: bool) -> Result<(), NoAnswer> {
        if self.silent.get() {
            return Err(NoAnswer);
        }
        if high && !self.high.get() {
            self.rises.set(self.rises.get() + 1);
        }
        self.high.set(high);
        Ok(())
    }

    fn read(&self) -> Result<bool, NoAnswer> {
        if self.silent.get() { Err(NoAnswer) } else { Ok(self.high.get()) }
    }
}

impl digital::ErrorType for Wire {
    type Error = NoAnswer;
}

impl OutputPin for Wire {
    fn set_low(&mut self) -> Result<(), NoAnswer> {
        self.set(false)
    }

    fn set_high(&mut self) -> Result<(), NoAnswer> {
        self.set(true)
    }
}

impl InputPin for Wire {
    fn is_high(&mut self) -> Result<bool, NoAnswer> {
        self.read()
    }

    fn is_low(&mut self) -> Result<bool, NoAnswer> {
        self.read().map(|high| !high)
    }
}

/// The copper of a board, which stays when its processor starts anew.
#[derive(Clone, Default)]
struct Copper {
    step: [Wire; 2],
    dir: [Wire; 2],
    enable: Wire,
    limits: [Wire; 4],
    button: Wire,
}

/// What is on the expander.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Expander {
    Directions,
    Enable,
    Limits,
    All,
}

impl Copper {
    /// Switches and button are closed to ground; `on` says what hangs on the expander, whose silence is given
    /// back.
    fn new(on: Expander) -> (Self, Rc<Cell<bool>>) {
        let silent = Rc::new(Cell::new(false));
        let there = |is_there: bool| Wire {
            silent: if is_there { silent.clone() } else { Rc::default() },
            ..Wire::default()
        };
        let is = |what| on == what || on == Expander::All;
        let copper = Self {
            step: [Wire::default(), Wire::default()],
            dir: [there(is(Expander::Directions)), there(is(Expander::Directions))],
            enable: there(is(Expander::Enable)),
            limits: core::array::from_fn(|_| there(is(Expander::Limits))),
            button: Wire::default(),
        };
        (copper, silent)
    }

    fn rises(&self) -> [u32; 2] {
        [self.step[0].rises.get(), self.step[1].rises.get()]
    }

    /// Without a processor each pin is an input, and its resistor holds it at rest.
    fn lose_power(&self) {
        self.step.iter().for_each(|wire| wire.high.set(false));
        self.enable.high.set(true);
    }
}

type Motor = A4988<Wire, Wire, Wire, NoPin>;

/// The program of a board, as those of the firmwares are.
struct Program {
    plotter: StepperPlotter,
    motors: StepperAxes<Motor, Motor>,
    limits: LimitSwitchGroup<Wire, Wire, Wire, Wire>,
    button: EstopInput<Wire>,
    look: Duration,
    failed: bool,
    told: Vec<String>,
    answers: String,
}

const LOOK: Duration = Duration::from_millis(1);
const TURN: Duration = Duration::from_micros(50);
const DRAWING: &str = "G1 X60 Y35 F2400\nG1 X20 Y50\nG1 X5 Y5\n";

impl Program {
    /// Starts; `was_reset` is what the processor says of its last end: a watchdog, or a supply that sagged.
    fn start(copper: &Copper, homing: bool, was_reset: bool) -> (Self, Duration) {
        let motor = |axis: Axis, at: usize| {
            A4988::new(axis, copper.step[at].clone(), copper.dir[at].clone(), Timing::A4988)
                .with_enable(copper.enable.clone())
        };
        let mut motors = StepperAxes::new(motor(Axis::X, 0), motor(Axis::Y, 1));
        let settings = SwitchSettings::default();
        let [x_min, x_max, y_min, y_max] = copper.limits.clone().map(|pin| LimitSwitch::new(pin, settings));
        let mut limits = LimitSwitchGroup { x_min, x_max, y_min, y_max };
        let mut button = EstopInput::new(copper.button.clone(), settings);
        let (mut failed, mut free, mut now) = (motors.start(Duration::ZERO).is_err(), false, Duration::ZERO);
        while now < Duration::from_millis(50) {
            failed |= limits.tick(now).is_err();
            free |= button.tick(now) == Ok(Some(EstopChange::FreeSinceStart));
            now += LOOK;
        }
        let gate = SafetyGate::new(limits.limits(), was_reset || failed || !free);
        let settings =
            StepperPlotterSettings { dialect: Dialect::Grbl, homing, ..StepperPlotterSettings::default() };
        let mut plotter = StepperPlotter::new(settings, gate).unwrap();
        plotter.emergency_stop(now, button.is_pressed());
        let (told, answers) = (Vec::new(), String::new());
        (Self { plotter, motors, limits, button, look: now, failed, told, answers }, now)
    }

    fn fail(&mut self, now: Duration, why: String) {
        if !self.failed {
            self.failed = true;
            self.told.push(why);
            if let Err(error) = self.motors.stop() {
                self.told.push(error.to_string());
            }
            self.plotter.emergency_stop(now, true);
        }
    }

    fn send(&mut self, now: Duration, text: &str) {
        text.bytes().for_each(|byte| self.plotter.receive(now, byte));
    }

    /// A turn of the main loop.
    fn turn(&mut self, now: Duration) {
        if let Err(error) = self.motors.tick(now) {
            self.fail(now, error.to_string());
        }
        while let Some(step) = self.plotter.poll(now, self.motors.drivers()) {
            if let Err(error) = self.motors.step(step.pulse, now) {
                self.fail(now, error.to_string());
                break;
            }
        }
        if now >= self.look {
            self.look = now + LOOK;
            let before = self.limits.limits();
            if let Err(error) = self.limits.tick(now) {
                self.fail(now, error.to_string());
            }
            let after = self.limits.limits();
            for axis in Axis::BOTH {
                for end in [Direction::Minus, Direction::Plus] {
                    if before.blocks(axis, end) != after.blocks(axis, end) {
                        self.plotter.limit_switch(now, axis, end, after.blocks(axis, end));
                    }
                }
            }
            match self.button.tick(now) {
                Ok(Some(_)) => self.plotter.emergency_stop(now, self.button.is_pressed() || self.failed),
                Ok(None) => {}
                Err(error) => self.fail(now, error.to_string()),
            }
        }
        while let Some(byte) = self.plotter.transmit(now) {
            self.answers.push(char::from(byte));
        }
    }

    fn run(&mut self, now: &mut Duration, time: Duration) {
        let end = *now + time;
        while *now < end {
            self.turn(*now);
            *now += TURN;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 32, ..ProptestConfig::default() })]

    /// Whatever is on the expander, and whenever it stops to answer.
    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn an_expander_that_is_silent_in_mid_line_stops_the_motors_and_is_told(
        on in prop_oneof![
            Just(Expander::Directions),
            Just(Expander::Enable),
            Just(Expander::Limits),
            Just(Expander::All)
        ],
        after_us in 1_000_u64..2_500_000,
        for_ms in 5_u64..300,
    ) {
        let (copper, silent) = Copper::new(on);
        let (mut program, mut now) = Program::start(&copper, false, false);
        program.send(now, DRAWING);
        program.run(&mut now, Duration::from_micros(after_us));
        prop_assert!(!program.failed && program.told.is_empty());
        silent.set(true);
        // A direction is set when it changes, an ENABLE when motors start and stop: until then nobody can
        // know.
        program.run(&mut now, Duration::from_secs(6));
        let ended = copper.rises();
        if on == Expander::Limits || on == Expander::All {
            prop_assert!(program.failed, "a switch is looked at in each millisecond");
        }
        if program.failed {
            prop_assert_eq!(program.plotter.status(now).activity, Activity::Stopped);
            prop_assert!(program.answers.contains("ALARM:"), "{}", program.answers);
            let cut = program.told.iter().any(|told| told.contains("may have current"));
            let has_enable = on == Expander::Enable || on == Expander::All;
            prop_assert_eq!(cut, has_enable, "{:?}", program.told);
            // What was counted has been made, but for the step that its pins have refused.
            let StepPoint { x, y } = program.plotter.position();
            prop_assert!(x >= 0 && y >= 0);
        } else {
            prop_assert_eq!(program.plotter.position(), StepPoint::new(438, 438));
        }
        // It answers again: nothing goes on by itself, and a host's lines are refused.
        silent.set(false);
        let was_failed = program.failed;
        program.run(&mut now, Duration::from_millis(for_ms));
        if was_failed {
            program.send(now, "G1 X90 F2400\n");
            program.run(&mut now, Duration::from_secs(1));
            prop_assert_eq!(copper.rises(), ended);
            prop_assert!(program.answers.contains("error:9"), "{}", program.answers);
        }
    }

    /// The supply sags at any moment of a drawing, and comes back while the host goes on sending.
    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_brown_out_in_mid_line_leaves_the_motors_off_until_a_person_has_looked(
        after_us in 1_000_u64..2_500_000,
        homing in any::<bool>(),
    ) {
        let (copper, _) = Copper::new(Expander::All);
        let (mut program, mut now) = Program::start(&copper, homing, false);
        program.send(now, "$X\n");
        program.send(now, DRAWING);
        program.run(&mut now, Duration::from_micros(after_us));
        drop(program);
        copper.lose_power();
        let before = copper.rises();
        prop_assert!(copper.enable.high.get());

        // It knows that it was reset, or its switches have to tell where it stands: then it waits to be
        // homed.
        let (mut program, mut now) = Program::start(&copper, homing, !homing);
        program.run(&mut now, Duration::from_millis(10));
        prop_assert!(program.answers.contains("Grbl 1.1"), "the host hears that it has begun anew");
        program.send(now, "G1 X20 Y50\nG1 X5 Y5\n");
        program.run(&mut now, Duration::from_secs(1));
        prop_assert_eq!(copper.rises(), before);
        prop_assert!(!program.answers.contains("ok"), "{}", program.answers);
        prop_assert!(program.answers.matches("error:9").count() == 2, "{}", program.answers);
        // A person has looked.
        program.answers.clear();
        program.send(now, "$X\nG1 X5 F2400\n");
        program.run(&mut now, Duration::from_secs(1));
        prop_assert_eq!(program.plotter.position(), StepPoint::new(438, 0), "{}", program.answers);
        prop_assert_eq!(copper.rises(), [before[0] + 438, before[1]]);
    }
}
