//! An executor by hand: a future is polled as often as a test says, or to its end, and can be dropped in
//! between.

use core::pin::pin;
use core::task::{Context, Poll, Waker};

/// Polls a future at most so many times, then drops it: what it gave, if it got to its end.
pub(crate) fn poll_at_most<T>(polls: usize, future: impl Future<Output = T>) -> Option<T> {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    for _ in 0..polls {
        if let Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return Some(value);
        }
    }
    None
}

/// Polls a future to its end, which must come soon: nothing here waits for anything but its turn.
pub(crate) fn block_on<T>(future: impl Future<Output = T>) -> T {
    poll_at_most(100_000, future).expect("the future comes to its end")
}
