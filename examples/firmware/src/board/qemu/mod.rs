//! `mps2-an386` of QEMU with a simulated plotter on simulated pins, in simulated time.
//!
//! UART0 is the plotter's serial line. UART1 is the bench's own: it tells what happens on pins and line, and
//! when, and the time stands still while it asks the host how far it may go ([`bench`]). So a run does not
//! depend on how fast anything computes.

pub mod bench;
mod connection;
pub mod gantry;
mod line;
mod pins;
pub mod plotter;
mod registers;

/// Nothing is driven while the processor stands still: the pins are in its memory.
pub fn make_safe(info: &core::panic::PanicInfo<'_>) {
    bench::last_words(format_args!("{info}"));
}
