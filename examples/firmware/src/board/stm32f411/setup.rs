//! Sets up clocks, pins, timers and serial port of the stepper plotter, register by register.
//!
//! Setting them up with `stm32f4xx-hal`, which computes all this at run time, costs 1.6 KB more flash.
//!
//! Source: "STM32F411xC/E reference manual" (ST, RM0383), sections 3.4 (flash), 6 (RCC), 8 (GPIO), 12 and 13
//! (timers), 19 (USART).

use stm32f4xx_hal::pac::{FLASH, GPIOA, GPIOB, RCC, TIM1, TIM2, TIM3, USART2};

/// The system clock, Hz: the internal oscillator's 16 MHz / PLL_M * PLL_N / 4.
const SYSCLK_HZ: u32 = 84_000_000;
/// Divider before the PLL: 16 MHz / 8 = 2 MHz, as the manual recommends against jitter.
const PLL_M: u8 = 8;
/// Factor of the PLL: 2 MHz * 168 = 336 MHz.
const PLL_N: u16 = 168;
/// Divider for USB: 336 MHz / 7 = 48 MHz. Nothing uses it, but it must not exceed 48 MHz.
const PLL_Q: u8 = 7;
/// The slower peripheral bus, APB1, Hz: its greatest frequency is 50 MHz.
const PCLK1_HZ: u32 = SYSCLK_HZ / 2;
/// Prescaler of the timers. All run at 84 MHz (those on APB1 at twice its clock) and count microseconds.
const TICKS_PER_US: u16 = (SYSCLK_HZ / 1_000_000) as u16;
/// Alternate functions of the pins ("STM32F411xC/E data sheet", table 9): AF1 is TIM1 on PA8.
const AF1_TIM1: u8 = 1;
/// AF2 is TIM3 on PB0.
const AF2_TIM3: u8 = 2;
/// AF7 is USART2 on PA2 and PA3.
const AF7_USART2: u8 = 7;

/// Sets the system clock to 84 MHz and switches on the clocks of the peripherals that are used.
pub fn set_up_clocks(flash: &FLASH, rcc: &RCC) {
    // Two wait states above 60 MHz at 3.3 V.
    flash.acr().write(|w| w.latency().ws2().prften().enabled().icen().enabled().dcen().enabled());
    #[allow(unsafe_code, reason = "the library does not know which factors are good")]
    rcc.pllcfgr().write(|w| {
        // SAFETY: 2 MHz before, 336 MHz after the multiplication, both within the manual's limits.
        unsafe { w.pllm().bits(PLL_M).plln().bits(PLL_N).pllq().bits(PLL_Q) };
        w.pllp().div4().pllsrc().hsi()
    });
    rcc.cr().modify(|_, w| w.pllon().on());
    while rcc.cr().read().pllrdy().bit_is_clear() {}
    rcc.cfgr().write(|w| w.ppre1().div2().sw().pll());
    while !rcc.cfgr().read().sws().is_pll() {}
    rcc.ahb1enr().modify(|_, w| w.gpioaen().enabled().gpioben().enabled());
    rcc.apb1enr().write(|w| w.tim2en().enabled().tim3en().enabled().usart2en().enabled());
    rcc.apb2enr().write(|w| w.tim1en().enabled());
    // The registers behind a clock can be used two cycles later (erratum 2.1.13 of this family).
    cortex_m::asm::dsb();
}

/// Sets up the pins by the table of the [board](super).
pub fn set_up_pins(a: &GPIOA, b: &GPIOB) {
    // ENABLE becomes high, motors off, before its pin becomes an output.
    b.bsrr().write(|w| w.bs10().set_());
    #[allow(unsafe_code, reason = "the library does not name the functions of these pins")]
    // SAFETY: the functions are those of the data sheet's table of pins.
    unsafe {
        a.afrl().write(|w| w.afrl2().bits(AF7_USART2).afrl3().bits(AF7_USART2));
        a.afrh().write(|w| w.afrh8().bits(AF1_TIM1));
        b.afrl().write(|w| w.afrl0().bits(AF2_TIM3));
    }
    // As a whole, for no others have a pull. PA13 to PA15 keep those of a reset: the debugger's SWD and JTAG.
    a.pupdr().write(|w| w.pupdr10().pull_up().pupdr13().pull_up().pupdr14().pull_down().pupdr15().pull_up());
    b.pupdr().write(|w| {
        w.pupdr4().pull_up().pupdr6().pull_up().pupdr7().pull_up().pupdr8().pull_up().pupdr9().pull_up()
    });
    // One by one, for the debugger's pins keep their mode.
    a.moder()
        .modify(|_, w| w.moder2().alternate().moder3().alternate().moder5().output().moder8().alternate());
    b.moder().modify(|_, w| {
        let w = w.moder0().alternate().moder10().output();
        w.moder12().output().moder13().output().moder14().output().moder15().output()
    });
}

/// Sets up the PWM of servo and laser, with pulses of zero width, and a free-running clock of microseconds.
///
/// `servo_us` and `laser_us` are the periods of the PWM, us.
pub fn set_up_timers(servo: &TIM1, laser: &TIM3, clock: &TIM2, servo_us: u16, laser_us: u16) {
    clock.psc().write(|w| w.psc().set(TICKS_PER_US - 1));
    servo.psc().write(|w| w.psc().set(TICKS_PER_US - 1));
    laser.psc().write(|w| w.psc().set(TICKS_PER_US - 1));
    servo.arr().write(|w| w.arr().set(servo_us - 1));
    laser.arr().write(|w| w.arr().set(laser_us - 1));
    servo.ccmr1_output().write(|w| w.oc1pe().enabled().oc1m().pwm_mode1());
    laser.ccmr2_output().write(|w| w.oc3pe().enabled().oc3m().pwm_mode1());
    servo.ccer().write(|w| w.cc1e().set_bit());
    laser.ccer().write(|w| w.cc3e().set_bit());
    // Outputs of an advanced timer need MOE, main output enable; AOE sets it again at each update after a
    // break.
    servo.bdtr().write(|w| w.aoe().set_bit().moe().set_bit());
    // A prescaler takes effect at an update event.
    clock.egr().write(|w| w.ug().set_bit());
    servo.egr().write(|w| w.ug().set_bit());
    laser.egr().write(|w| w.ug().set_bit());
    clock.cr1().write(|w| w.cen().set_bit());
    servo.cr1().write(|w| w.arpe().set_bit().cen().set_bit());
    laser.cr1().write(|w| w.arpe().set_bit().cen().set_bit());
}

/// The divider of a serial port for `baud` bits a second, and whether a bit has 8 samples instead of 16.
const fn divider(baud: u32) -> (u16, bool) {
    if PCLK1_HZ / 16 >= baud {
        (((PCLK1_HZ + baud / 2) / baud) as u16, false)
    } else {
        // With 8 samples the fraction, the last four bits, counts eighths.
        let sixteenths = (2 * PCLK1_HZ + baud / 2) / baud;
        ((sixteenths & !0xF | (sixteenths & 0xF) >> 1) as u16, true)
    }
}

/// Sets up the serial port: 8 data bits, no parity, sending and receiving.
pub fn set_up_serial<const BAUD: u32>(port: &USART2) {
    let (divider, is_fast) = const { divider(BAUD) };
    #[allow(unsafe_code, reason = "the library has the divider in two parts")]
    // SAFETY: the register is the divider and nothing else.
    unsafe {
        port.brr().write(|w| w.bits(divider.into()));
    }
    port.cr1().write(|w| w.over8().bit(is_fast).ue().set_bit().te().set_bit().re().set_bit());
}
