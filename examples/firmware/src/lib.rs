//! Code that the firmwares share: the machine's constants, the board, the stepper plotter's drivers.
#![no_std]

use small_runtime as _;

pub mod board;
pub mod machine;
pub mod stepper;

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    board::make_safe(info);
    loop {
        cortex_m::asm::bkpt();
    }
}
