//! The steps' timer: an interrupt whenever the clock comes to a time.

use core::cell::Cell;
use critical_section::Mutex;
use stm32f4xx_hal::pac::{Interrupt, TIM2, interrupt};

/// What is done at a time, us: gives when to do it next, if there is such a time.
pub type AtTime = fn(u32) -> Option<u32>;

static AT_TIME: Mutex<Cell<Option<AtTime>>> = Mutex::new(Cell::new(None));

/// The clock's timer, which nobody sets after the start but its compare register, and that only here.
#[allow(unsafe_code, reason = "the loop's clock reads the counter, and nothing else of this timer")]
fn timer() -> TIM2 {
    // SAFETY: reading the counter changes nothing, and the compare register is the interrupt's.
    unsafe { TIM2::steal() }
}

#[interrupt]
fn TIM2() {
    let timer = timer();
    loop {
        timer.sr().modify(|_, w| w.cc1if().clear_bit());
        let now_us = timer.cnt().read().bits();
        let at_time = critical_section::with(|cs| AT_TIME.borrow(cs).get());
        let Some(due_us) = at_time.and_then(|at_time| at_time(now_us)) else { return };
        #[allow(unsafe_code, reason = "any time is good")]
        // SAFETY: as it says.
        timer.ccr1().write(|w| unsafe { w.bits(due_us) });
        // What has come meanwhile raises no flag.
        let late_us = timer.cnt().read().bits().wrapping_sub(due_us);
        if late_us > u32::MAX / 2 {
            return;
        }
    }
}

/// Calls this from the interrupt from here on.
pub fn start(at_time: AtTime) {
    critical_section::with(|cs| AT_TIME.borrow(cs).set(Some(at_time)));
    timer().dier().modify(|_, w| w.cc1ie().set_bit());
    super::gantry::unmask(Interrupt::TIM2);
}

/// Calls it now: there may be something new to do.
pub fn ring() {
    timer().egr().write(|w| w.cc1g().set_bit());
}
