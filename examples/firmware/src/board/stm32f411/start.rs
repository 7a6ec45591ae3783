//! What the stepper plotter needs of its processor, register by register: with the board's library, which
//! reckons it all at the start, it takes 1.6 KB of program memory more.
//!
//! Source: "STM32F411xC/E reference manual" (ST, RM0383), sections 3.4 (flash), 6 (RCC), 8 (GPIO), 12 and 13
//! (timers), 19 (USART).

use stm32f4xx_hal::pac::{FLASH, GPIOA, GPIOB, RCC, TIM1, TIM2, TIM3, USART2};

/// The oscillator's 16 MHz, divided by 8, times 168, divided by 4; the lower of both peripheral buses at half
/// of it.
const SYSTEM_HZ: u32 = 84_000_000;
const OSCILLATOR_PARTS: u8 = 8;
const OSCILLATOR_TIMES: u16 = 168;
/// Of the multiplied clock too: 48 MHz, which nothing here uses and must not exceed that.
const PARTS_FOR_USB: u8 = 7;
const LOWER_BUS_HZ: u32 = SYSTEM_HZ / 2;
/// All timers count microseconds: those of the lower bus have twice its clock.
const PARTS_OF_A_MICROSECOND: u16 = (SYSTEM_HZ / 1_000_000) as u16;
/// Alternate functions of pins: a timer of the first group, of the second, a serial port.
const TIMER_1: u8 = 1;
const TIMER_3: u8 = 2;
const SERIAL: u8 = 7;

/// 84 MHz from the internal oscillator, and a clock for all that is used.
pub fn clocks(flash: &FLASH, rcc: &RCC) {
    // Two wait states above 60 MHz at 3.3 V.
    flash.acr().write(|w| w.latency().ws2().prften().enabled().icen().enabled().dcen().enabled());
    #[allow(unsafe_code, reason = "the library does not know which factors are good")]
    rcc.pllcfgr().write(|w| {
        // SAFETY: 2 MHz before, 336 MHz after the multiplication, both within the manual's limits.
        unsafe { w.pllm().bits(OSCILLATOR_PARTS).plln().bits(OSCILLATOR_TIMES).pllq().bits(PARTS_FOR_USB) };
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

/// The pins, as the table in the module above has them.
pub fn pins(a: &GPIOA, b: &GPIOB) {
    // Disabled motors before the pin says anything.
    b.bsrr().write(|w| w.bs10().set_());
    #[allow(unsafe_code, reason = "the library does not name the functions of these pins")]
    // SAFETY: the functions are those of the data sheet's table of pins.
    unsafe {
        a.afrl().write(|w| w.afrl2().bits(SERIAL).afrl3().bits(SERIAL));
        a.afrh().write(|w| w.afrh8().bits(TIMER_1));
        b.afrl().write(|w| w.afrl0().bits(TIMER_3));
    }
    a.pupdr().write(|w| w.pupdr10().pull_up().pupdr13().pull_up().pupdr14().pull_down().pupdr15().pull_up());
    b.pupdr().write(|w| {
        w.pupdr4().pull_up().pupdr6().pull_up().pupdr7().pull_up().pupdr8().pull_up().pupdr9().pull_up()
    });
    a.moder()
        .modify(|_, w| w.moder2().alternate().moder3().alternate().moder5().output().moder8().alternate());
    b.moder().modify(|_, w| {
        let w = w.moder0().alternate().moder10().output();
        w.moder12().output().moder13().output().moder14().output().moder15().output()
    });
}

/// Servo, laser and clock: pulses from 0 on, and microseconds.
pub fn timers(servo: &TIM1, laser: &TIM3, clock: &TIM2, servo_us: u16, laser_us: u16) {
    clock.psc().write(|w| w.psc().set(PARTS_OF_A_MICROSECOND - 1));
    servo.psc().write(|w| w.psc().set(PARTS_OF_A_MICROSECOND - 1));
    laser.psc().write(|w| w.psc().set(PARTS_OF_A_MICROSECOND - 1));
    servo.arr().write(|w| w.arr().set(servo_us - 1));
    laser.arr().write(|w| w.arr().set(laser_us - 1));
    servo.ccmr1_output().write(|w| w.oc1pe().enabled().oc1m().pwm_mode1());
    laser.ccmr2_output().write(|w| w.oc3pe().enabled().oc3m().pwm_mode1());
    servo.ccer().write(|w| w.cc1e().set_bit());
    laser.ccer().write(|w| w.cc3e().set_bit());
    // The first of the advanced timers has a switch for all its outputs.
    servo.bdtr().write(|w| w.aoe().set_bit().moe().set_bit());
    // The divider holds from an update on.
    clock.egr().write(|w| w.ug().set_bit());
    servo.egr().write(|w| w.ug().set_bit());
    laser.egr().write(|w| w.ug().set_bit());
    clock.cr1().write(|w| w.cen().set_bit());
    servo.cr1().write(|w| w.arpe().set_bit().cen().set_bit());
    laser.cr1().write(|w| w.arpe().set_bit().cen().set_bit());
}

/// The divider of a serial port for so many bits a second, and whether each bit has 8 samples instead of 16.
const fn divider(baud: u32) -> (u16, bool) {
    if LOWER_BUS_HZ / 16 >= baud {
        (((LOWER_BUS_HZ + baud / 2) / baud) as u16, false)
    } else {
        // Its last four bits are eighths then.
        let sixteenths = (2 * LOWER_BUS_HZ + baud / 2) / baud;
        ((sixteenths & !0xF | (sixteenths & 0xF) >> 1) as u16, true)
    }
}

/// A serial port of 8 bits without parity that sends and listens.
pub fn serial<const BAUD: u32>(port: &USART2) {
    let (divider, is_fast) = const { divider(BAUD) };
    #[allow(unsafe_code, reason = "the library has the divider in two parts")]
    // SAFETY: the register is the divider and nothing else.
    unsafe {
        port.brr().write(|w| w.bits(divider.into()));
    }
    port.cr1().write(|w| w.over8().bit(is_fast).ue().set_bit().te().set_bit().re().set_bit());
}
