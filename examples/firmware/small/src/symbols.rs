//! The names under which the compiler looks for the routines.
//!
//! Source: "Run-time ABI for the Arm Architecture" (Arm, IHI 0043): `__aeabi_*`; the other names are those of
//! GCC's library.
#![allow(unsafe_code, reason = "a name that the linker knows, and assembly, are unsafe by themselves")]

use crate::float::{self, Order};
use crate::whole::divide_u64;
use core::arch::global_asm;

macro_rules! routines {
    ($($name:ident($($argument:ident: $kind:ty),*) -> $result:ty { $body:expr })*) => {
        // SAFETY: each name has the arguments and the result that the ABI gives it.
        $(#[unsafe(no_mangle)]
        extern "C" fn $name($($argument: $kind),*) -> $result {
            $body
        })*
    };
}

routines! {
    __aeabi_dadd(a: u64, b: u64) -> u64 { float::add(a, b) }
    __aeabi_dsub(a: u64, b: u64) -> u64 { __aeabi_dadd(a, b ^ 1 << 63) }
    __aeabi_dmul(a: u64, b: u64) -> u64 { float::multiply(a, b) }
    __aeabi_ddiv(a: u64, b: u64) -> u64 { float::divide(a, b) }
    __aeabi_dcmpeq(a: u64, b: u64) -> u32 { u32::from(float::compare(a, b) as i32 == 0) }
    __aeabi_dcmplt(a: u64, b: u64) -> u32 { u32::from((float::compare(a, b) as i32) < 0) }
    __aeabi_dcmple(a: u64, b: u64) -> u32 { u32::from(float::compare(a, b) as i32 <= 0) }
    __aeabi_dcmpgt(a: u64, b: u64) -> u32 { u32::from(float::compare(a, b) as i32 == 1) }
    __aeabi_dcmpge(a: u64, b: u64) -> u32 { u32::from((float::compare(a, b) as u32) < 2) }
    __aeabi_dcmpun(a: u64, b: u64) -> u32 { u32::from(float::compare(a, b) == Order::None) }
    __aeabi_i2d(number: i32) -> u64 { float::from_i64(number.into()) }
    __aeabi_ui2d(number: u32) -> u64 { float::from_u64(number.into()) }
    __aeabi_l2d(number: i64) -> u64 { float::from_i64(number) }
    __aeabi_ul2d(number: u64) -> u64 { float::from_u64(number) }
    __aeabi_d2lz(number: u64) -> i64 { float::to_i64(number) }
    __aeabi_d2ulz(number: u64) -> i64 { float::to_i64(number) }
    __aeabi_d2iz(number: u64) -> i32 { float::to_i64(number) as i32 }
    __aeabi_d2uiz(number: u64) -> i32 { float::to_i64(number) as i32 }
    __aeabi_f2ulz(number: f32) -> i64 { float::to_i64(float::widen(number.to_bits())) }
    __aeabi_f2lz(number: f32) -> i64 { float::to_i64(float::widen(number.to_bits())) }
    __aeabi_ul2f(number: u64) -> u32 { float::single_from_u64(number) }
    __aeabi_d2f(number: u64) -> u32 { float::narrow(number) }
    __aeabi_f2d(number: u32) -> u64 { float::widen(number) }
    __udivmoddi4(number: u64, divisor: u64, rest: Option<&mut u64>) -> u64 {{
        let (quotient, left) = divide_u64(number, divisor);
        if let Some(rest) = rest {
            *rest = left;
        }
        quotient
    }}
    __divmoddi4(number: i64, divisor: i64, rest: Option<&mut i64>) -> i64 {{
        let (quotient, left) = divide_u64(number.unsigned_abs(), divisor.unsigned_abs());
        let signed = |magnitude: u64, sign: i64| if sign < 0 { magnitude.wrapping_neg() } else { magnitude }.cast_signed();
        if let Some(rest) = rest {
            *rest = signed(left, number);
        }
        signed(quotient, number ^ divisor)
    }}
}

// Words as long as there are any, then bytes; a Cortex-M4 reads and writes words anywhere.
global_asm!(
    ".syntax unified",
    ".thumb",
    ".macro routine name",
    ".global \\name",
    ".type \\name, %function",
    ".thumb_func",
    "\\name:",
    ".endm",
    ".section .text.small_runtime_copy, \"ax\", %progbits",
    "routine __aeabi_memcpy",
    "routine __aeabi_memcpy4",
    "routine __aeabi_memcpy8",
    "routine memcpy",
    "mov r12, r0",
    "1: subs r2, #4",
    "ittt hs",
    "ldrhs r3, [r1], #4",
    "strhs r3, [r12], #4",
    "bhs 1b",
    "adds r2, #4",
    "2: subs r2, #1",
    "ittt hs",
    "ldrbhs r3, [r1], #1",
    "strbhs r3, [r12], #1",
    "bhs 2b",
    "bx lr",
    ".section .text.small_runtime_set, \"ax\", %progbits",
    "routine __aeabi_memclr",
    "routine __aeabi_memclr4",
    "routine __aeabi_memclr8",
    "movs r2, #0",
    "routine __aeabi_memset",
    "routine __aeabi_memset4",
    "routine __aeabi_memset8",
    "uxtb r2, r2",
    "orr r2, r2, r2, lsl #8",
    "orr r2, r2, r2, lsl #16",
    "1: subs r1, #4",
    "itt hs",
    "strhs r2, [r0], #4",
    "bhs 1b",
    "adds r1, #4",
    "2: subs r1, #1",
    "itt hs",
    "strbhs r2, [r0], #1",
    "bhs 2b",
    "bx lr",
    ".section .text.small_runtime_compare, \"ax\", %progbits",
    "routine memcmp",
    "mov r12, r0",
    "movs r0, #0",
    "1: cbz r2, 2f",
    "ldrb r0, [r12], #1",
    "ldrb r3, [r1], #1",
    "subs r2, #1",
    "subs r0, r0, r3",
    "beq 1b",
    "2: bx lr",
    // By more than 31 bits, and by a number below zero, a register shifts to nothing.
    ".section .text.small_runtime_left, \"ax\", %progbits",
    "routine __aeabi_llsl",
    "lsls r1, r2",
    "sub r3, r2, #32",
    "lsl r3, r0, r3",
    "orrs r1, r3",
    "rsb r3, r2, #32",
    "lsr r3, r0, r3",
    "orrs r1, r3",
    "lsls r0, r2",
    "bx lr",
    ".section .text.small_runtime_right, \"ax\", %progbits",
    "routine __aeabi_llsr",
    "lsrs r0, r2",
    "sub r3, r2, #32",
    "lsr r3, r1, r3",
    "orrs r0, r3",
    "rsb r3, r2, #32",
    "lsl r3, r1, r3",
    "orrs r0, r3",
    "lsrs r1, r2",
    "bx lr",
    ".section .text.small_runtime_signed, \"ax\", %progbits",
    "routine __aeabi_lasr",
    "lsrs r0, r2",
    "rsb r3, r2, #32",
    "lsl r3, r1, r3",
    "orrs r0, r3",
    "subs r3, r2, #32",
    "itt pl",
    "asrpl r3, r1, r3",
    "orrpl r0, r3",
    "asrs r1, r2",
    "bx lr",
    ".purgem routine",
);
