//! [`Controller`]: what a player runs.

use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::{Axis, Direction, Pen, StepPair, StepPoint};

/// A whole controller as a state machine without port, thread or clock: inputs with their times in; bytes,
/// duty cycles, steps and the pen out.
///
/// Times never decrease. After each input and each tick, the bytes for the line are fetched until there are
/// no more, then the steps. Bytes come in and go out of every controller; of the rest it implements what its
/// machine has: motors with encoders tell [`edge`](Self::edge) and are given [`duty`](Self::duty), stepper
/// motors [`step`](Self::step). What is not implemented does nothing, and a recording in which it did
/// something is not repeated.
///
/// ```
/// # use core::time::Duration;
/// # use plotter_replay::{Controller, Outcome, Player, PlayerSettings};
/// # use plotter_replay::log::{Event, Record};
/// /// Answers each byte with the next one of the alphabet.
/// #[derive(Default)]
/// struct Next(Option<u8>);
/// impl Controller for Next {
///     fn receive(&mut self, _now: Duration, byte: u8) {
///         self.0 = Some(byte + 1);
///     }
///     fn transmit(&mut self) -> Option<u8> {
///         self.0.take()
///     }
/// }
///
/// let at = |us, event| Record { time: Duration::from_micros(us), event };
/// // An answer takes ten bits: 1 ms at 10000 baud.
/// let recorded = [at(0, Event::Host(vec![b'a'])), at(1000, Event::Controller(vec![b'b']))];
/// let player = Player::new(PlayerSettings::default().with_baud(10_000));
/// assert!(player.check(recorded, Next::default()).is_equal());
/// ```
pub trait Controller {
    /// A byte from the host; `now` is when its last bit came.
    fn receive(&mut self, now: Duration, byte: u8);

    /// The next byte for the host, if there is one.
    fn transmit(&mut self) -> Option<u8>;

    /// A motor turned by one encoder count.
    fn edge(&mut self, _now: Duration, _axis: Axis, _sign: Direction) {}

    /// A limit switch or a button changed.
    fn switch(&mut self, _now: Duration, _name: &SwitchName, _pressed: bool) {}

    /// The emergency stop button changed.
    fn emergency_stop(&mut self, _now: Duration, _pressed: bool) {}

    /// When [`Controller::tick`] is to be called next, if ever.
    fn next_tick(&self) -> Option<Duration> {
        None
    }

    /// Runs what is due at `now`; [`Controller::next_tick`] is later than `now` afterwards.
    fn tick(&mut self, _now: Duration) {}

    /// The same for a controller that wants to know when it is asked.
    fn transmit_at(&mut self, _now: Duration) -> Option<u8> {
        self.transmit()
    }

    /// Whether it is asked for a byte only when the line can take one, as an interrupt of a serial port asks:
    /// a frame says what is true when it begins. Else all bytes are fetched at once, and wait.
    fn waits_for_line(&self) -> bool {
        false
    }

    /// When one that [waits for the line](Self::waits_for_line) is to be [ticked](Self::tick) for what it has
    /// to say on a free line, unless something happens before.
    fn next_transmission(&self) -> Option<Duration> {
        None
    }

    /// Duty cycle of a motor, in signed steps of its PWM timer, as `@ drive` records it.
    fn duty(&self, _axis: Axis) -> i32 {
        0
    }

    /// A move that does not come over the line but from the program itself: an `@ target` record, with the
    /// pen of the last `@ pen` record.
    fn target(&mut self, _now: Duration, _pen: Pen, _target: StepPoint) {}

    /// Whether the machine has stepper motors: the log's `@ edge` records are then the steps that it made,
    /// and compared, not encoder counts that it is told.
    fn makes_steps(&self) -> bool {
        false
    }

    /// The next step that is due by `now`, if there is one.
    fn step(&mut self, _now: Duration) -> Option<StepPair> {
        None
    }

    /// Where the controller has the pen, if it moves it: the log's `@ pen` records are then compared.
    fn pen(&self) -> Option<Pen> {
        None
    }
}

impl<C: Controller + ?Sized> Controller for Box<C> {
    fn receive(&mut self, now: Duration, byte: u8) {
        (**self).receive(now, byte);
    }
    fn edge(&mut self, now: Duration, axis: Axis, sign: Direction) {
        (**self).edge(now, axis, sign);
    }
    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        (**self).switch(now, name, pressed);
    }
    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        (**self).emergency_stop(now, pressed);
    }
    fn next_tick(&self) -> Option<Duration> {
        (**self).next_tick()
    }
    fn tick(&mut self, now: Duration) {
        (**self).tick(now);
    }
    fn transmit(&mut self) -> Option<u8> {
        (**self).transmit()
    }
    fn transmit_at(&mut self, now: Duration) -> Option<u8> {
        (**self).transmit_at(now)
    }
    fn waits_for_line(&self) -> bool {
        (**self).waits_for_line()
    }
    fn next_transmission(&self) -> Option<Duration> {
        (**self).next_transmission()
    }
    fn duty(&self, axis: Axis) -> i32 {
        (**self).duty(axis)
    }
    fn target(&mut self, now: Duration, pen: Pen, target: StepPoint) {
        (**self).target(now, pen, target);
    }
    fn makes_steps(&self) -> bool {
        (**self).makes_steps()
    }
    fn step(&mut self, now: Duration) -> Option<StepPair> {
        (**self).step(now)
    }
    fn pen(&self) -> Option<Pen> {
        (**self).pen()
    }
}
