//! The time since the start, from a timer of 32 bits.

use stm32f4xx_hal::pac::TIM2;

/// Counts microseconds. It must be read once in an hour at least.
pub struct Clock {
    timer: TIM2,
    last_us: u32,
    wrapped: u32,
}

impl Clock {
    /// A timer that counts microseconds.
    pub fn new(timer: TIM2) -> Self {
        Self { timer, last_us: 0, wrapped: 0 }
    }

    pub fn now_us(&mut self) -> u64 {
        let now_us = self.timer.cnt().read().bits();
        if now_us < self.last_us {
            self.wrapped = self.wrapped.wrapping_add(1);
        }
        self.last_us = now_us;
        u64::from(self.wrapped) << 32 | u64::from(now_us)
    }
}
