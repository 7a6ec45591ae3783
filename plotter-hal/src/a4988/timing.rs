//! [`Timing`]: how long a chip must see its inputs.

use core::time::Duration;

/// Shortest times between the edges that a chip with STEP and DIR sees.
///
/// Every field may be made longer, for a slow optocoupler or a long wire. A pulse lasts for the longer of
/// `high` and `hold`, because DIR changes only while STEP is low.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Timing {
    /// STEP high.
    pub high: Duration,
    /// STEP low.
    pub low: Duration,
    /// From a change of DIR, MS1, MS2 or MS3 to the rise of STEP.
    pub setup: Duration,
    /// From the rise of STEP to a change of DIR, MS1, MS2 or MS3.
    pub hold: Duration,
    /// From the end of sleep to the first rise of STEP.
    pub wake: Duration,
}

impl Timing {
    /// Allegro A4988, and the A4983 before it.
    ///
    /// A4988-DS, Figure 1 "Logic Interface Timing Diagram" and its table (page 6): STEP high `t_A` and low
    /// `t_B` 1 us, setup `t_C` and hold `t_D` 200 ns. Section "Sleep Mode": allow 1 ms before a step, for the
    /// charge pump.
    pub const A4988: Self = Self {
        high: Duration::from_micros(1),
        low: Duration::from_micros(1),
        setup: Duration::from_nanos(200),
        hold: Duration::from_nanos(200),
        wake: Duration::from_millis(1),
    };

    /// Texas Instruments DRV8825.
    ///
    /// SLVSA73F, section 6.6 "Timing Requirements": `t_WH(STEP)` and `t_WL(STEP)` 1.9 us, `t_SU(STEP)` and
    /// `t_H(STEP)` 650 ns, `t_WAKE` 1.7 ms. There `f_STEP` is at most 250 kHz as well, a period of 4 us, so
    /// that STEP is low for 2.1 us after the shortest pulse.
    pub const DRV8825: Self = Self {
        high: Duration::from_nanos(1_900),
        low: Duration::from_nanos(2_100),
        setup: Duration::from_nanos(650),
        hold: Duration::from_nanos(650),
        wake: Duration::from_micros(1_700),
    };

    /// Trinamic TMC2209, on its internal clock; the TMC2208 and TMC2225 alike.
    ///
    /// Rev. 1.09, section 13.1 "Timing": `t_SH` and `t_SL` a period of the clock and 20 ns, so 103 ns at
    /// 12 MHz and 110 ns down to 11.1 MHz; `t_DSU` and `t_DSH` 20 ns. It has no SLEEP.
    pub const TMC2209: Self = Self {
        high: Duration::from_nanos(110),
        low: Duration::from_nanos(110),
        setup: Duration::from_nanos(20),
        hold: Duration::from_nanos(20),
        wake: Duration::ZERO,
    };

    /// The same on a clock that counts in whole ticks of `tick`: each time is longer by one. Two readings
    /// that differ by 1 us on a clock of microseconds may be 1 ns apart.
    ///
    /// ```
    /// # use core::time::Duration;
    /// # use plotter_hal::a4988::Timing;
    /// let timing = Timing::A4988.on_clock(Duration::from_micros(1));
    /// assert_eq!(timing.high, Duration::from_micros(2));
    /// assert_eq!(timing.setup, Duration::from_nanos(1200));
    /// ```
    #[must_use]
    pub const fn on_clock(self, tick: Duration) -> Self {
        Self {
            high: self.high.saturating_add(tick),
            low: self.low.saturating_add(tick),
            setup: self.setup.saturating_add(tick),
            hold: self.hold.saturating_add(tick),
            wake: self.wake.saturating_add(tick),
        }
    }

    /// The same in nanoseconds, for the interrupt; 4.29 s at most.
    #[inline(always)]
    pub(super) const fn in_ns(&self) -> TimingNs {
        let (high, hold) = (ns(self.high), ns(self.hold));
        TimingNs {
            pulse: if high > hold { high } else { hold },
            low: ns(self.low),
            setup: ns(self.setup),
            wake: ns(self.wake),
        }
    }
}

/// Whole nanoseconds: of 32 bits, so that the interrupt has little to add up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TimingNs {
    /// STEP high: long enough for DIR to hold within it.
    pub(super) pulse: u32,
    pub(super) low: u32,
    pub(super) setup: u32,
    pub(super) wake: u32,
}

impl TimingNs {
    /// After waiting so long, nothing is in the way of anything.
    pub(super) fn longest(&self) -> u32 {
        self.pulse.max(self.low).max(self.setup).max(self.wake)
    }
}

#[inline(always)]
const fn ns(time: Duration) -> u32 {
    let ns = time.as_nanos();
    #[expect(clippy::cast_possible_truncation, reason = "checked")]
    if ns < u32::MAX as u128 { ns as u32 } else { u32::MAX }
}
