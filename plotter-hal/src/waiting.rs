//! Waiting asynchronously for what is due, by the traits of `embedded-hal-async`; with the feature `async`.
//!
//! ```text
//!  loop {
//!      driver.tick(clock())?;                                  does what is due
//!      wait_until_due(driver.due(), clock, delay).await;       and nothing else until then
//!  }
//! ```
//!
//! No driver knows a clock or an executor. A clock is a function that tells the time since the start, as in
//! `|| Duration::from_micros(Instant::now().as_micros())` with embassy, and a delay is the executor's
//! `DelayNs`. Switches, the emergency stop and encoders have forms that wait for their pins
//! ([`LimitSwitch::changed`](crate::LimitSwitch::changed),
//! [`EstopInput::changed`](crate::EstopInput::changed), [`Quadrature::counted`](crate::Quadrature::counted)).
//! They wait for a *level*, never for an edge: an edge may come while nobody waits, and a level is still
//! there. Each of them can be dropped at any time, and asked again.

use core::future::{pending, poll_fn};
use core::pin::pin;
use core::task::Poll;
use core::time::Duration;
use embedded_hal_async::delay::DelayNs;

/// Comes back when it is `due`, with the time then. What is due never ([`None`]) never comes: wait for it
/// together with what may happen before.
///
/// A delay that ends early by the clock is asked again, and one that is longer than it can be told is cut
/// into pieces.
///
/// ```
/// # use core::convert::Infallible;
/// # use embedded_hal::pwm::{ErrorType, SetDutyCycle};
/// # use std::cell::Cell;
/// # struct Pwm(Vec<u16>);
/// # impl ErrorType for Pwm { type Error = Infallible; }
/// # impl SetDutyCycle for Pwm {
/// #     fn max_duty_cycle(&self) -> u16 { 20_000 }
/// #     fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> { self.0.push(duty); Ok(()) }
/// # }
/// # struct Delay<'a>(&'a Cell<Duration>);
/// # impl plotter_hal::embedded_hal_async::delay::DelayNs for Delay<'_> {
/// #     async fn delay_ns(&mut self, ns: u32) { self.0.set(self.0.get() + Duration::from_nanos(ns.into())); }
/// # }
/// # fn block_on<T>(future: impl Future<Output = T>) -> T {
/// #     let mut future = std::pin::pin!(future);
/// #     loop {
/// #         let mut context = std::task::Context::from_waker(std::task::Waker::noop());
/// #         if let std::task::Poll::Ready(value) = future.as_mut().poll(&mut context) { return value; }
/// #     }
/// # }
/// use core::time::Duration;
/// use plotter_hal::waiting::wait_until_due;
/// use plotter_hal::{PenServo, PenServoSettings};
///
/// # let time = Cell::new(Duration::ZERO);
/// # let (clock, mut delay) = (|| time.get(), Delay(&time));
/// let mut pen = PenServo::new(Pwm(Vec::new()), PenServoSettings::default())?;
/// # block_on(async {
/// pen.raise(clock())?;
/// while let Some(due) = pen.due() {
///     let now = wait_until_due(Some(due), clock, &mut delay).await;
///     pen.tick(now)?;
/// }
/// assert_eq!(clock(), Duration::from_millis(200)); // it has settled
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// # })?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub async fn wait_until_due(
    due: Option<Duration>,
    clock: impl Fn() -> Duration,
    delay: &mut impl DelayNs,
) -> Duration {
    let Some(due) = due else { return pending().await };
    loop {
        let now = clock();
        let left = due.saturating_sub(now);
        if left.is_zero() {
            return now;
        }
        delay.delay_ns(u32::try_from(left.as_nanos()).unwrap_or(u32::MAX)).await;
    }
}

/// The one of two that came first.
pub(crate) enum First<A, B> {
    A(A),
    B(B),
}

/// Waits for the first of two; the other one is dropped. The first one is asked first.
pub(crate) async fn first<A, B>(a: impl Future<Output = A>, b: impl Future<Output = B>) -> First<A, B> {
    let (mut a, mut b) = (pin!(a), pin!(b));
    poll_fn(|context| match a.as_mut().poll(context) {
        Poll::Ready(a) => Poll::Ready(First::A(a)),
        Poll::Pending => b.as_mut().poll(context).map(First::B),
    })
    .await
}

/// Lets the other tasks have a turn.
pub(crate) fn turn() -> impl Future<Output = ()> {
    let mut is_over = false;
    poll_fn(move |context| {
        if core::mem::replace(&mut is_over, true) {
            return Poll::Ready(());
        }
        context.waker().wake_by_ref();
        Poll::Pending
    })
}
