//! What the firmwares share: the machine's numbers and the board.
#![no_std]

use small_runtime as _;

pub mod board;
pub mod machine;

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    board::make_safe(info);
    loop {
        cortex_m::asm::bkpt();
    }
}
