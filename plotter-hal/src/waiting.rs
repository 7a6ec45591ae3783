//! Asynchronous waiting that belongs to no driver.

use core::future::poll_fn;
use core::task::Poll;

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
