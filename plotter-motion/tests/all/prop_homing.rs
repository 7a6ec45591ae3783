//! Homing on simulated axes: from any start, with switches that work and with such that do not.

use crate::law_cases::cases;
use crate::switches::stands_in_the_way;
use core::time::Duration;
use plotter_motion::plant::{StepperPlant, StepperSettings};
use plotter_motion::{
    Axis, Direction, LimitSwitches,
    homing::{Homed, Homing, HomingAxis, HomingError, HomingStatus, HomingStep},
};
use proptest::prelude::*;

/// What is wrong with an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// A switch that never closes, or never opens again.
    Dead(Direction),
    Sticks(Direction),
    /// Both switches on one wire: either of them is read as both.
    SharedWire,
    /// The motor turns the wrong way.
    Inverted,
}

/// An axis between two switches that close at 0 and at `length` and open some steps inside, with stops
/// outside.
#[derive(Clone, Copy, Debug)]
struct SimulatedAxis {
    at: i32,
    length: i32,
    hysteresis: [i32; 2],
    /// From a closing switch to the stop.
    overtravel: i32,
    pressed: [bool; 2],
    fault: Fault,
}

impl SimulatedAxis {
    fn new(at: i32, length: i32, hysteresis: [i32; 2], overtravel: i32, fault: Fault) -> Self {
        let at = at.clamp(-overtravel, length + overtravel);
        let mut axis = Self { at, length, hysteresis, overtravel, pressed: [false; 2], fault };
        axis.switch();
        axis
    }

    fn switch(&mut self) {
        let distances = [self.at, self.length - self.at];
        for ((pressed, open_from), distance) in self.pressed.iter_mut().zip(self.hysteresis).zip(distances) {
            *pressed = distance <= 0 || (*pressed && distance < open_from.max(1));
        }
    }

    fn step(&mut self, direction: Direction) {
        let sign = if self.fault == Fault::Inverted { -direction.sign() } else { direction.sign() };
        let before = self.pressed;
        self.at = (self.at + sign).clamp(-self.overtravel, self.length + self.overtravel);
        self.switch();
        for (index, end) in [Direction::Minus, Direction::Plus].into_iter().enumerate() {
            if self.fault == Fault::Sticks(end) {
                self.pressed[index] |= before[index];
            }
        }
    }

    /// The lower and the upper switch as the controller reads them.
    fn read(&self) -> [bool; 2] {
        match self.fault {
            Fault::Dead(Direction::Minus) => [false, self.pressed[1]],
            Fault::Dead(Direction::Plus) => [self.pressed[0], false],
            Fault::SharedWire => [self.pressed[0] || self.pressed[1]; 2],
            _ => self.pressed,
        }
    }
}

fn read(x: &SimulatedAxis, y: &SimulatedAxis) -> LimitSwitches {
    let ([x_min, x_max], [y_min, y_max]) = (x.read(), y.read());
    LimitSwitches { x_min, x_max, y_min, y_max }
}

/// What must hold of the rates on the way: started and ended at no more than the start rate, and between two
/// steps no faster than the acceleration allows.
struct RateLaw {
    settings: HomingAxis,
    before: Option<HomingStep>,
}

impl RateLaw {
    fn step(&mut self, step: HomingStep) -> Result<(), TestCaseError> {
        let HomingAxis { start_hz, fast_hz, accel_hz_s, .. } = self.settings;
        prop_assert!(step.rate_hz >= 1 && step.rate_hz <= fast_hz.max(1), "{step:?}");
        match self.before.filter(|before| (before.axis, before.direction) == (step.axis, step.direction)) {
            None => {
                prop_assert!(step.rate_hz <= start_hz, "starts at once: {step:?}");
                prop_assert!(self.before.is_none_or(|before| before.rate_hz <= start_hz), "stops at once");
            }
            Some(before) => {
                let square = |hz: u32| f64::from(hz) * f64::from(hz);
                let change = (square(step.rate_hz) - square(before.rate_hz)).abs();
                // Rates are whole: each may be one too low.
                let rounding = 2.0 * f64::from(step.rate_hz.max(before.rate_hz)) + 1.0;
                let jump = before.rate_hz <= start_hz && step.rate_hz <= start_hz;
                prop_assert!(jump || change <= 2.0 * f64::from(accel_hz_s) + rounding, "{before:?} {step:?}");
            }
        }
        self.before = Some(step);
        Ok(())
    }
}

/// Homes to the end; what came out, and the steps it took.
fn home(
    settings: HomingAxis,
    x: &mut SimulatedAxis,
    y: &mut SimulatedAxis,
    refused: &mut dyn FnMut() -> bool,
) -> Result<(Result<Homed, HomingError>, u64), TestCaseError> {
    let mut homing = Homing::new(settings, settings);
    let mut law = RateLaw { settings, before: None };
    let mut steps = 0_u64;
    // Per axis: down, up, back; once more where the known length was wrong; and off the switches.
    let most = 2
        * 6
        * (u64::from(settings.most_steps)
            + 4 * u64::from(settings.release_steps + settings.pull_off_steps)
            + 8);
    loop {
        let limits = read(x, y);
        match homing.update(limits) {
            HomingStatus::Step(step) => {
                prop_assert!(
                    !stands_in_the_way(limits, step.axis, step.direction),
                    "into a switch: {step:?}"
                );
                prop_assert_eq!(
                    homing.update(limits),
                    HomingStatus::Step(step),
                    "asking again changes nothing"
                );
                if refused() {
                    continue; // an emergency stop: the step is not made
                }
                law.step(step)?;
                match step.axis {
                    Axis::X => x.step(step.direction),
                    Axis::Y => y.step(step.direction),
                }
                homing.made();
                steps += 1;
                prop_assert!(steps <= most, "no end");
            }
            HomingStatus::Done(homed) => return Ok((Ok(homed), steps)),
            HomingStatus::Failed(error) => {
                prop_assert_eq!(
                    homing.update(LimitSwitches::default()),
                    HomingStatus::Failed(error),
                    "stays so"
                );
                return Ok((Err(error), steps));
            }
        }
    }
}

fn settings() -> impl Strategy<Value = HomingAxis> {
    (1..4_000_u32, 1..20_000_u32, 1..4_000_u32, 0..200_000_u32, 1..200_u32, 150..400_u32, 0..6_000_u32)
        .prop_map(|(start_hz, fast_hz, slow_hz, accel_hz_s, pull_off_steps, release_steps, known_steps)| {
            HomingAxis {
                start_hz,
                fast_hz,
                slow_hz,
                accel_hz_s,
                pull_off_steps,
                release_steps,
                known_steps,
                most_steps: 7_000,
            }
        })
}

fn axis(fault: impl Strategy<Value = Fault>) -> impl Strategy<Value = SimulatedAxis> {
    let start = prop_oneof![-100..6_500_i32, Just(-100), Just(0), Just(6_500)];
    (start, 1_000..6_000_i32, 0..60_i32, 0..60_i32, 0..80_i32, fault).prop_map(
        |(at, length, lower, upper, overtravel, fault)| {
            SimulatedAxis::new(at, length, [lower, upper], overtravel, fault)
        },
    )
}

fn end() -> impl Strategy<Value = Direction> {
    prop_oneof![Just(Direction::Minus), Just(Direction::Plus)]
}

fn fault() -> impl Strategy<Value = Fault> {
    prop_oneof![
        end().prop_map(Fault::Dead),
        end().prop_map(Fault::Sticks),
        Just(Fault::SharedWire),
        Just(Fault::Inverted),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

    #[test]
    fn both_axes_are_homed_from_anywhere(
        settings in settings(), mut x in axis(Just(Fault::None)), mut y in axis(Just(Fault::None)), stops in any::<u64>(),
    ) {
        let (lengths, mut bits) = ([x.length, y.length], stops | 1);
        // one step in eight is not made
        let mut refused = || {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            bits.is_multiple_of(8)
        };
        // A known length that is too great is met at speed: the laws of rates hold where it is not.
        let known_steps = settings.known_steps.min(x.length.min(y.length).unsigned_abs());
        let (homed, _) = home(HomingAxis { known_steps, ..settings }, &mut x, &mut y, &mut refused)?;
        let [x_steps, y_steps] = lengths.map(i32::unsigned_abs);
        prop_assert_eq!(homed, Ok(Homed { x_steps, y_steps }));
        prop_assert_eq!([x.at, y.at].map(i32::unsigned_abs), [settings.pull_off_steps; 2]);
    }

    #[test]
    fn an_axis_that_is_shorter_than_known_is_homed_once_more(
        settings in settings(), mut x in axis(Just(Fault::None)), mut y in axis(Just(Fault::None)),
    ) {
        // At one rate everywhere, so that the laws of rates say nothing about the surprise.
        let settings = HomingAxis { fast_hz: 100, start_hz: 100, slow_hz: 100, known_steps: 6_900, ..settings };
        let [x_steps, y_steps] = [x.length, y.length].map(i32::unsigned_abs);
        let (homed, _) = home(settings, &mut x, &mut y, &mut || false)?;
        prop_assert_eq!(homed, Ok(Homed { x_steps, y_steps }));
    }

    #[test]
    fn what_is_wrong_with_an_axis_is_named(
        settings in settings(), mut x in axis(fault()), mut y in axis(fault()), on_x in any::<bool>(),
    ) {
        let fault = if on_x { y.fault = Fault::None; x.fault } else { x.fault = Fault::None; y.fault };
        let known_steps = settings.known_steps.min(900);
        let faulty = if on_x { &x } else { &y };
        let (stands_on, on_stop) = (faulty.pressed, faulty.at);
        let (homed, _) = home(HomingAxis { known_steps, ..settings }, &mut x, &mut y, &mut || false)?;
        let Err(error) = homed else { panic!("{fault:?} goes unseen: {homed:?}") };
        prop_assert_eq!(error.axis(), if on_x { Axis::X } else { Axis::Y });
        let named = match (fault, error) {
            (Fault::Dead(dead), HomingError::Missing { end, .. }) => end == dead,
            (Fault::Sticks(stuck), HomingError::Stuck { end, .. }) => end == stuck,
            // It stuck before it was asked to, so the other one came with it.
            (Fault::Sticks(_), HomingError::Both { .. }) | (Fault::SharedWire, HomingError::Both { .. }) => true,
            // The end that it meets is not the one it was sent to; or it stands on a switch and goes farther
            // onto it.
            (Fault::Inverted, HomingError::Wrong { end, .. }) => end == Direction::Plus || stands_on[0],
            (Fault::Inverted, HomingError::Stuck { .. }) => stands_on[0] || stands_on[1],
            _ => false,
        };
        prop_assert!(named, "{fault:?} from {on_stop}: {error}");
    }

    /// Whatever the switches do, it ends.
    #[test]
    fn it_ends_whatever_the_switches_do(
        settings in settings(), switches in prop::collection::vec(any::<[u8; 4]>(), 1..400),
    ) {
        let mut homing = Homing::new(settings, settings);
        let mut steps = 0_u32;
        for [x_min, x_max, y_min, y_max] in switches.iter().cycle() {
            let pressed = |byte: &u8| *byte > 200;
            let limits = LimitSwitches {
                x_min: pressed(x_min), x_max: pressed(x_max), y_min: pressed(y_min), y_max: pressed(y_max),
            };
            match homing.update(limits) {
                HomingStatus::Step(step) => prop_assert!(!stands_in_the_way(limits, step.axis, step.direction)),
                _ => break,
            }
            homing.made();
            steps += 1;
            prop_assert!(steps < 200_000, "no end");
        }
    }
}

/// The documented machine with simulated motors: the rates of homing lose no step, and the known length saves
/// time.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_stepper_plotter_is_homed_without_losing_a_step() {
    let homed_after_s = |known_steps| {
        let settings = HomingAxis { known_steps, ..HomingAxis::default() };
        let mut plant = StepperPlant::new(StepperSettings::default(), StepperSettings::default());
        let [mut x, mut y] = [(20_000, 27_150), (26_500, 26_500)]
            .map(|(at, length)| SimulatedAxis::new(at, length, [6, 9], 200, Fault::None));
        let mut homing = Homing::new(settings, settings);
        let mut now = Duration::ZERO;
        loop {
            match homing.update(read(&x, &y)) {
                HomingStatus::Step(HomingStep { axis, direction, rate_hz }) => {
                    now += Duration::from_secs(1) / rate_hz;
                    plant.pulse(now, axis, direction);
                    match axis {
                        Axis::X => x.step(direction),
                        Axis::Y => y.step(direction),
                    }
                    homing.made();
                }
                HomingStatus::Done(homed) => {
                    plant.x.settle();
                    plant.y.settle();
                    assert_eq!(homed, Homed { x_steps: 27_150, y_steps: 26_500 });
                    assert_eq!((plant.x.lost_steps(), plant.y.lost_steps()), (0, 0));
                    return now.as_secs_f64();
                }
                HomingStatus::Failed(error) => panic!("{error}"),
            }
        }
    };
    let (unknown_s, known_s) = (homed_after_s(0), homed_after_s(24_000));
    println!("homed in {unknown_s:.1} s, with a known length in {known_s:.1} s");
    assert!(known_s < 0.8 * unknown_s);
}

/// Switches that a true rotor presses, met at 20,000 pulses/s where the axis was said to go on: a motor that
/// is stopped from there at once loses steps, and the length is right all the same.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_length_known_wrongly_costs_steps_but_not_the_result() {
    /// How far a rotor lags behind its field in its friction: at most 2 steps at either end.
    const LAG_STEPS: u32 = 4;
    let settings =
        HomingAxis { known_steps: 24_000, fast_hz: 20_000, accel_hz_s: 200_000, ..HomingAxis::default() };
    let mut plant = StepperPlant::new(StepperSettings::default(), StepperSettings::default());
    let (start, length) = ([9_000.0, 20.0], [15_000.0, 10_000.0]);
    let mut homing = Homing::new(settings, settings);
    let mut now = Duration::ZERO;
    let mut lost = 0;
    let homed = loop {
        let [x, y] = [start[0] + plant.x.position_steps(), start[1] + plant.y.position_steps()];
        let limits =
            LimitSwitches { x_min: x <= 0.0, x_max: x >= length[0], y_min: y <= 0.0, y_max: y >= length[1] };
        match homing.update(limits) {
            HomingStatus::Step(HomingStep { axis, direction, rate_hz }) => {
                now += Duration::from_secs(1) / rate_hz;
                plant.pulse(now, axis, direction);
                plant.run_to(now);
                homing.made();
                lost = lost.max(plant.x.lost_steps().abs() + plant.y.lost_steps().abs());
            }
            HomingStatus::Done(homed) => break homed,
            HomingStatus::Failed(error) => panic!("{error}"),
        }
    };
    assert!(lost > 0);
    assert!(
        homed.x_steps.abs_diff(15_000) <= LAG_STEPS && homed.y_steps.abs_diff(10_000) <= LAG_STEPS,
        "{homed:?}"
    );
}

#[test]
fn errors_say_what_to_check() {
    let (axis, end) = (Axis::X, Direction::Plus);
    let texts = [
        HomingError::Missing { axis, end, steps: 40_000 },
        HomingError::Stuck { axis: Axis::Y, end: Direction::Minus, steps: 438 },
        HomingError::Wrong { axis, end },
        HomingError::Both { axis },
        HomingError::Short { axis, steps: 90 },
        HomingError::Early { axis, steps: 64 },
    ]
    .map(|error| error.to_string());
    insta::assert_snapshot!(texts.join("\n"));
}
