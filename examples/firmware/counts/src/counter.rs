//! Counts instructions with the SysTick timer.
//!
//! QEMU with `-icount shift=8` lets 256 ns pass for every instruction, whatever it is; the timer of
//! `mps2-an386` runs at 25 MHz, so an instruction is 6.4 of its ticks.

use core::hint::black_box;
use core::sync::atomic::{Ordering, compiler_fence};
use cortex_m::peripheral::{SYST, syst::SystClkSource};

/// The timer has 24 bits: 2.6 million instructions.
const MOST_TICKS: u32 = 0xFF_FFFF;

/// The timer.
pub struct Counter {
    /// What counting itself takes.
    empty: u32,
}

impl Counter {
    /// Starts the timer.
    pub fn new(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(MOST_TICKS);
        timer.clear_current();
        timer.enable_counter();
        let mut counter = Self { empty: 0 };
        counter.empty = counter.count(|| ()).1;
        counter
    }

    /// The instructions that `run` takes.
    #[inline(always)]
    pub fn count<T>(&self, run: impl FnOnce() -> T) -> (T, u32) {
        let before = SYST::get_current();
        compiler_fence(Ordering::SeqCst);
        let result = black_box(run());
        compiler_fence(Ordering::SeqCst);
        let ticks = before.wrapping_sub(SYST::get_current()) & MOST_TICKS;
        (result, ((ticks * 10 + 32) / 64).saturating_sub(self.empty))
    }
}

/// Mean and worst of many counts.
#[derive(Clone, Copy, Default)]
pub struct Tally {
    sum: u64,
    count: u32,
    worst: u32,
}

impl Tally {
    /// Takes a count.
    pub fn add(&mut self, instructions: u32) {
        self.sum += u64::from(instructions);
        self.count += 1;
        self.worst = self.worst.max(instructions);
    }

    /// Takes those of another tally.
    pub fn join(&mut self, other: Self) {
        self.sum += other.sum;
        self.count += other.count;
        self.worst = self.worst.max(other.worst);
    }

    /// How many there were.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Mean, rounded up.
    pub fn mean(&self) -> u64 {
        self.sum.div_ceil(u64::from(self.count.max(1)))
    }

    /// The greatest.
    pub fn worst(&self) -> u32 {
        self.worst
    }
}
