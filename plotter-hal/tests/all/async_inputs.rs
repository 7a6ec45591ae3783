//! Switches, button and encoders that are waited for: on pins whose levels are a list over simulated time,
//! with an executor by hand, pins that fail, and futures that are dropped at any time.

use core::pin::{Pin, pin};
use core::task::{Context, Poll, Waker};
use embedded_hal::digital::{self, ErrorType, InputPin};
use embedded_hal_async::{delay::DelayNs, digital::Wait};
use plotter_hal::waiting::wait_until_due;
use plotter_hal::{
    EstopChange, EstopInput, LimitSwitch, LimitSwitchGroup, PulseInput, Quadrature, SwitchSettings,
    estop_input, limit_switch, pulse_counter, quadrature,
};
use plotter_motion::config::Decoding;
use plotter_motion::{Axis, Demand, Direction, Duty, LimitSwitches, SafetyGate};
use proptest::prelude::*;
use std::cell::Cell;
use std::convert::Infallible;
use std::time::Duration;

const US: Duration = Duration::from_micros(1);
const MS: Duration = Duration::from_millis(1);
/// How often the executor comes round.
const ROUND: Duration = Duration::from_micros(250);
/// Normally closed: pressed is high; 20 ms to be released.
const SWITCH: fn() -> SwitchSettings = SwitchSettings::default;

/// The pin could not be read.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Broken;

impl digital::Error for Broken {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

#[derive(Debug, Default)]
struct Time(Cell<Duration>);

impl Time {
    fn clock(&self) -> impl Fn() -> Duration + '_ {
        || self.0.get()
    }

    /// Runs a future until it is done or it is `end`, round by round; then drops it.
    fn run<T>(&self, end: Duration, future: impl Future<Output = T>) -> Option<T> {
        let mut future = pin!(future);
        let mut context = Context::from_waker(Waker::noop());
        loop {
            if let Poll::Ready(value) = future.as_mut().poll(&mut context) {
                return Some(value);
            }
            if self.0.get() >= end {
                return None;
            }
            self.0.set(self.0.get() + ROUND);
        }
    }

    fn until(&self, at: Duration) -> impl Future<Output = ()> + '_ {
        core::future::poll_fn(move |_| if self.0.get() >= at { Poll::Ready(()) } else { Poll::Pending })
    }
}

struct Delay<'a>(&'a Time);

impl DelayNs for Delay<'_> {
    async fn delay_ns(&mut self, ns: u32) {
        self.0.until(self.0.0.get() + Duration::from_nanos(ns.into())).await;
    }
}

/// A pin on simulated time: its level from each time on, in order; `None` cannot be read.
struct Levels<'a> {
    time: &'a Time,
    levels: Vec<(Duration, Option<bool>)>,
}

impl<'a> Levels<'a> {
    fn new(time: &'a Time, levels: impl IntoIterator<Item = (Duration, Option<bool>)>) -> Self {
        Self { time, levels: levels.into_iter().collect() }
    }

    fn low(time: &'a Time) -> Self {
        Self::new(time, [(Duration::ZERO, Some(false))])
    }

    fn level(&self) -> Result<bool, Broken> {
        let now = self.time.0.get();
        self.levels.iter().rev().find(|(from, _)| *from <= now).and_then(|(_, level)| *level).ok_or(Broken)
    }

    /// Waits for a level, which an interrupt sees however short it is.
    async fn wait_for(&mut self, wanted: bool) -> Result<(), Broken> {
        let from = self.time.0.get();
        core::future::poll_fn(|_| {
            let seen = self.level();
            let has_been = self
                .levels
                .iter()
                .any(|&(at, level)| level == Some(wanted) && at > from && at <= self.time.0.get());
            match seen {
                Err(broken) => Poll::Ready(Err(broken)),
                Ok(level) if level == wanted || has_been => Poll::Ready(Ok(())),
                Ok(_) => Poll::Pending,
            }
        })
        .await
    }
}

impl ErrorType for Levels<'_> {
    type Error = Broken;
}

impl InputPin for Levels<'_> {
    fn is_high(&mut self) -> Result<bool, Broken> {
        self.level()
    }

    fn is_low(&mut self) -> Result<bool, Broken> {
        self.level().map(|level| !level)
    }
}

impl Wait for Levels<'_> {
    async fn wait_for_high(&mut self) -> Result<(), Broken> {
        self.wait_for(true).await
    }

    async fn wait_for_low(&mut self) -> Result<(), Broken> {
        self.wait_for(false).await
    }

    async fn wait_for_rising_edge(&mut self) -> Result<(), Broken> {
        panic!("an edge may have come before: drivers wait for levels")
    }

    async fn wait_for_falling_edge(&mut self) -> Result<(), Broken> {
        panic!("an edge may have come before: drivers wait for levels")
    }

    async fn wait_for_any_edge(&mut self) -> Result<(), Broken> {
        panic!("an edge may have come before: drivers wait for levels")
    }
}

#[test]
fn what_is_due_comes_at_its_time_and_what_is_never_due_does_not_come() {
    let time = Time::default();
    let end = Duration::from_secs(20);
    // Longer than a delay can be told.
    let due = Duration::from_secs(10);
    let came = time.run(end, wait_until_due(Some(due), time.clock(), &mut Delay(&time))).unwrap();
    assert!(came >= due && came < due + ROUND * 4, "{came:?}");
    let late = time.run(end, wait_until_due(Some(MS), time.clock(), &mut Delay(&time)));
    assert_eq!(late, Some(time.0.get()), "it is over: at once");
    assert_eq!(time.run(end, wait_until_due(None, time.clock(), &mut Delay(&time))), None);
}

/// A delay that comes back after half of its time, by its own clock.
struct Hasty<'a>(&'a Time);

impl DelayNs for Hasty<'_> {
    async fn delay_ns(&mut self, ns: u32) {
        self.0.until(self.0.0.get() + Duration::from_nanos((ns / 2).into())).await;
    }
}

#[test]
fn a_delay_that_ends_early_is_asked_again() {
    let time = Time::default();
    let came = time.run(MS * 100, wait_until_due(Some(MS * 10), time.clock(), &mut Hasty(&time))).unwrap();
    assert!(came >= MS * 10 && came < MS * 11, "{came:?}");
}

#[test]
fn a_switch_is_free_after_its_time_and_pressed_at_once() {
    let time = Time::default();
    let pin =
        Levels::new(&time, [(Duration::ZERO, Some(false)), (MS * 50, Some(true)), (MS * 51, Some(false))]);
    let mut switch = LimitSwitch::new(pin, SWITCH());
    let mut next =
        || time.run(MS * 200, switch.changed(time.clock(), &mut Delay(&time))).map(|it| (it, time.0.get()));
    let (free, at) = next().unwrap();
    assert_eq!(free, Ok(false));
    assert!(at >= MS * 20 && at < MS * 21, "{at:?}");
    let (pressed, at) = next().unwrap();
    assert_eq!((pressed, at), (Ok(true), MS * 50));
    let (free, at) = next().unwrap();
    assert_eq!(free, Ok(false));
    assert!(at >= MS * 71 && at < MS * 72, "{at:?}");
    assert_eq!(next(), None, "nothing happens any more");
}

#[test]
fn a_press_that_is_over_before_it_can_be_read_counts() {
    let spike = [(Duration::ZERO, Some(false)), (MS * 50 + US, Some(true)), (MS * 50 + US * 2, Some(false))];
    let time = Time::default();
    let mut switch = LimitSwitch::new(Levels::new(&time, spike), SWITCH());
    let mut next = || time.run(MS * 200, switch.changed(time.clock(), &mut Delay(&time)));
    assert_eq!([next(), next(), next(), next()], [Some(Ok(false)), Some(Ok(true)), Some(Ok(false)), None]);

    let time = Time::default();
    let mut button = EstopInput::new(Levels::new(&time, spike), SWITCH());
    let mut gate = SafetyGate::new(LimitSwitches::RELEASED, button.is_pressed());
    let mut changes = Vec::new();
    while let Some(change) = time.run(MS * 200, button.changed(time.clock(), &mut Delay(&time))) {
        gate.emergency_stop(button.is_pressed());
        if change == Ok(EstopChange::FreeSinceStart) {
            assert!(gate.reset());
        }
        changes.push(change.unwrap());
    }
    assert_eq!(changes, [EstopChange::FreeSinceStart, EstopChange::Pressed, EstopChange::Released]);
    assert!(gate.is_stopped());
}

#[test]
fn a_spike_while_it_starts_is_a_button_that_was_pressed_at_power_up() {
    let spike = [(Duration::ZERO, Some(false)), (MS * 5 + US, Some(true)), (MS * 5 + US * 2, Some(false))];
    let time = Time::default();
    let mut button = EstopInput::new(Levels::new(&time, spike), SWITCH());
    let change = time.run(MS * 200, button.changed(time.clock(), &mut Delay(&time)));
    assert_eq!(change, Some(Ok(EstopChange::Released)), "not free since the start");
}

#[test]
fn a_pin_that_fails_while_it_is_waited_for_is_pressed_and_other_tasks_go_on() {
    let broken = [(Duration::ZERO, Some(false)), (MS * 50, None), (MS * 60, Some(false))];
    let time = Time::default();
    let mut switch = LimitSwitch::new(Levels::new(&time, broken), SWITCH());
    let mut next = |end| time.run(end, switch.changed(time.clock(), &mut Delay(&time)));
    assert_eq!(next(MS * 200), Some(Ok(false)));
    assert_eq!(next(MS * 200), Some(Err(limit_switch::Error::Pin(Broken))));
    assert_eq!(time.0.get(), MS * 50);
    let mut failed = 0;
    while let Some(Err(limit_switch::Error::Pin(Broken))) = next(MS * 200) {
        failed += 1;
    }
    assert!(failed > 5, "each waited for its turn: {failed}");
    assert!(time.0.get() >= MS * 80, "free again after 20 ms");

    let time = Time::default();
    let mut button = EstopInput::new(Levels::new(&time, broken), SWITCH());
    let mut next = |end| time.run(end, button.changed(time.clock(), &mut Delay(&time)));
    assert_eq!(next(MS * 200), Some(Ok(EstopChange::FreeSinceStart)));
    assert_eq!(next(MS * 200), Some(Err(estop_input::Error::Pin(Broken))));
    assert!(button.is_pressed());
}

#[test]
fn a_group_says_which_of_its_switches_changed() {
    let time = Time::default();
    let free = || LimitSwitch::new(Levels::low(&time), SWITCH());
    let mut limits = LimitSwitchGroup {
        x_min: free(),
        x_max: LimitSwitch::new(
            Levels::new(&time, [(Duration::ZERO, Some(false)), (MS * 40, Some(true))]),
            SWITCH(),
        ),
        y_min: free(),
        y_max: LimitSwitch::new(
            Levels::new(&time, [(Duration::ZERO, Some(false)), (MS * 70, None)]),
            SWITCH(),
        ),
    };
    let mut next = || time.run(MS * 200, limits.changed(time.clock(), &mut Delay(&time)));
    assert_eq!(next(), Some(Ok(LimitSwitches::RELEASED)));
    let limits_now = next().unwrap().unwrap();
    assert_eq!(
        (limits_now, time.0.get()),
        (LimitSwitches { x_max: true, ..LimitSwitches::RELEASED }, MS * 40)
    );
    let error = next().unwrap().unwrap_err();
    assert_eq!((error.axis(), error.end(), time.0.get()), (Axis::Y, Direction::Plus, MS * 70));
    assert!(limits.limits().y_max, "it counts as pressed");
}

#[test]
fn an_encoder_counts_each_edge_that_is_waited_for() {
    let time = Time::default();
    let cycle = |start: Duration| (0..4_u32).map(move |half| (start + MS * 4 * half, Some(half % 2 == 1)));
    let a = Levels::new(&time, cycle(Duration::ZERO));
    let b = Levels::new(&time, [(Duration::ZERO, Some(false))].into_iter().chain(cycle(MS * 2)));
    let mut encoder = Quadrature::new(a, b, Decoding::X4);
    let mut counted = 0;
    while let Some(direction) = time.run(MS * 100, encoder.counted()) {
        counted += direction.unwrap().sign();
    }
    assert_eq!((counted.abs(), encoder.position(), encoder.illegal()), (6, counted, 0));

    let broken = Levels::new(&time, [(Duration::ZERO, Some(false)), (MS * 200, None)]);
    let mut encoder = Quadrature::new(Levels::low(&time), broken, Decoding::X4);
    let error = time.run(MS * 300, encoder.counted()).unwrap();
    assert_eq!(error, Err(quadrature::Error::Pin(quadrature::PinError::B(Broken))));
}

#[test]
fn pulses_are_counted_by_the_sign_of_the_drive() {
    let time = Time::default();
    let pulses = (0..10_u32).map(|half| (MS * 3 * half, Some(half % 2 == 1)));
    let mut encoder = PulseInput::new(Axis::X, Levels::new(&time, pulses.chain([(MS * 40, None)])));
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    encoder.driven(gate.pass(Demand { x: Duty::saturating(-0.5), y: Duty::ZERO }));
    for _ in 0..5 {
        assert_eq!(time.run(MS * 100, encoder.pulse()), Some(Ok(())));
    }
    assert_eq!(encoder.counter().position(), -5);
    assert_eq!(time.run(MS * 100, encoder.pulse()), Some(Err(pulse_counter::Error::Pin(Broken))));
    assert_eq!(encoder.counter().position(), -5);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Waited for or looked at every quarter of a millisecond, and dropped at any time: a switch is never
    /// taken for free before it has been free for its whole time, and a press is seen at once.
    #[test]
    fn a_switch_that_is_waited_for_is_one_that_is_looked_at(
        changes in prop::collection::vec((1..40_000_u64, any::<bool>()), 0..30),
        patience in prop::collection::vec(1..60_u32, 1..40),
    ) {
        let time = Time::default();
        let mut at = Duration::ZERO;
        let mut levels = vec![(at, Some(false))];
        for (pause_us, level) in changes {
            // As seen by a look every round: what is shorter is the business of another test.
            at += Duration::from_micros(pause_us).max(ROUND);
            levels.push((at, Some(level)));
        }
        let mut switch = LimitSwitch::new(Levels::new(&time, levels.clone()), SWITCH());
        let mut looked_at = LimitSwitch::new(Levels::new(&time, levels), SWITCH());
        for rounds in patience {
            let end = time.0.get() + ROUND * rounds;
            // Both are looked at in the same rounds.
            let both = async {
                let mut waited = pin!(async { switch.changed(time.clock(), &mut Delay(&time)).await });
                core::future::poll_fn(|context| {
                    let _ = looked_at.tick(time.0.get());
                    Pin::new(&mut waited).as_mut().poll(context)
                }).await
            };
            if let Some(pressed) = time.run(end, both) {
                prop_assert_eq!(pressed, Ok(looked_at.is_pressed()), "at {:?}", time.0.get());
            }
            prop_assert_eq!(switch.is_pressed(), looked_at.is_pressed(), "at {:?}", time.0.get());
        }
    }
}

#[test]
fn a_chip_whose_pins_cannot_fail_fits() {
    struct High;
    impl ErrorType for High {
        type Error = Infallible;
    }
    impl InputPin for High {
        fn is_high(&mut self) -> Result<bool, Infallible> {
            Ok(true)
        }
        fn is_low(&mut self) -> Result<bool, Infallible> {
            Ok(false)
        }
    }
    impl Wait for High {
        async fn wait_for_high(&mut self) -> Result<(), Infallible> {
            Ok(())
        }
        async fn wait_for_low(&mut self) -> Result<(), Infallible> {
            core::future::pending().await
        }
        async fn wait_for_rising_edge(&mut self) -> Result<(), Infallible> {
            core::future::pending().await
        }
        async fn wait_for_falling_edge(&mut self) -> Result<(), Infallible> {
            core::future::pending().await
        }
        async fn wait_for_any_edge(&mut self) -> Result<(), Infallible> {
            core::future::pending().await
        }
    }
    let time = Time::default();
    let mut button = EstopInput::new(High, SWITCH());
    assert_eq!(time.run(MS * 100, button.changed(time.clock(), &mut Delay(&time))), None, "pressed for ever");
    assert!(button.is_pressed());
}
