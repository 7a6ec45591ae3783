//! The board of both firmwares for the ATmega328P.
#![no_std]

pub mod board;
